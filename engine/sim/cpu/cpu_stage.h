/* The CPU twins of the device stages: one file each, formulas and order of operations in docs/physics.md. */
#pragma once

#include "risorius/model.h"

/* State of a CPU simulation, (node_count) each, and the baked arrays it reads. */
typedef struct ris_cpu_state {
    const ris_model *model;
    ris_vec4 *position;      /* xyz mm, w inverse mass; written by anchor_shift, verlet, contact */
    ris_vec4 *velocity_half; /* mm/s; written by verlet */
    ris_vec4 *velocity_prev; /* mm/s; written by verlet */
    ris_vec4 *force;         /* g mm/s^2; written by spring_force */
    ris_vec4 *bend;          /* mm; written by bend */
    ris_vec4 *normal;        /* unit; written by normal */
    ris_vec4 *free;          /* position before contact, mm; written by verlet */
    ris_anchor_point *anchor_point;
    ris_vec4 *anchor_delta; /* mm */
    ris_contact_body contact_body[RIS_CONTACT_BODIES];
    ris_inertia inertia;
    uint8_t *list; /* stages of a tick of list_substeps */
    uint32_t list_substeps;
} ris_cpu_state;

void ris__cpu_anchor_shift(ris_cpu_state *state);
void ris__cpu_bend(ris_cpu_state *state);
void ris__cpu_spring_force(ris_cpu_state *state);
void ris__cpu_verlet(ris_cpu_state *state);
void ris__cpu_lip_normal(ris_cpu_state *state);
void ris__cpu_contact(ris_cpu_state *state);
void ris__cpu_normal(ris_cpu_state *state);

/* KA-20: sum of the cross products of the triangles around node i, not normalised. */
ris_vec3 ris__area_normal(const ris_model *model, const ris_vec4 *position, uint32_t i);

/* KA-11, KA-12: tension / length of one spring, so that force = result x (far end - near end). g/s^2 */
float ris__spring_pull(const ris_sim_push *push, float area_ratio, float rest_mm, float length_mm);
