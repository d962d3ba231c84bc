/* Small models built in code, without files and without libm: for tests, benchmarks and trying things out. */
#pragma once

#include "risorius/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A height field of quads over a flat or spherical ground, mirror-symmetric in x, y up, z out; node r *
 * columns + c. */
typedef struct ris_scene_def {
    uint32_t columns, rows; /* nodes */
    float spacing_mm;
    float radius_mm;    /* of the sphere, 0 = flat; more than half the diagonal */
    float depth_mm;     /* skin to bone */
    bool pinned_border; /* the border nodes are static */
    bool rig;           /* muscles of a mouth and a brow, and a jaw weight rising downwards */
    ris_tissue_def tissue;
    ris_dynamics_def dynamics;
} ris_scene_def;

/* 49 x 61 nodes 2 mm apart on a sphere of 90 mm with rig, 2,773 of them moving, default tissue; muscles act
 * at once. */
ris_scene_def ris_default_scene_def(void);
/* The head of a scene; release with ris_head_finish. RIS_ERROR_USAGE: impossible sizes. */
ris_result ris_scene_head(const ris_scene_def *def, ris_head *out, ris_error *err);
/* The same, baked; the model owns the head. */
ris_result ris_scene_model(const ris_scene_def *def, ris_model **out, ris_error *err);

/* Masses and springs without a surface. */
typedef struct ris_scene_spring {
    uint32_t a, b;
    float rest_mm;
    float area_ratio; /* stiffness = area_ratio x modulus */
} ris_scene_spring;

typedef struct ris_scene_net_def {
    uint32_t node_count, spring_count;
    const ris_vec3 *position;       /* mm (node_count) */
    const bool *pinned;             /* (node_count), NULL = none */
    const ris_scene_spring *spring; /* (spring_count) */
    const ris_anchor_param *anchor; /* (node_count), NULL = none */
    float mass_g;
    float damping_per_s;
    ris_tissue_def tissue; /* model, law, modulus, substeps, compression */
} ris_scene_net_def;

/* A model of bare springs for the mechanics tests; nothing is checked for stability. */
ris_result ris_scene_net(const ris_scene_net_def *def, ris_model **out, ris_error *err);

#ifdef __cplusplus
}
#endif
