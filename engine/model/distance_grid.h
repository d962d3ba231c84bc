/* Signed distance of closed triangle meshes on a regular grid, for the contact stage. */
#pragma once

#include "risorius/model.h"

/* Where a grid lies: count samples along each axis from low, cell apart, x fastest. */
typedef struct ris_grid_place {
    ris_vec3 low;
    float cell_mm;
    uint32_t count[3];
} ris_grid_place;

/* Samples that cover low..high; count is at least 2 along each axis. */
ris_grid_place ris__grid_place(ris_vec3 low, ris_vec3 high, float cell_mm);

size_t ris__grid_count(const ris_grid_place *place);

/* Distance to the union of the meshes at every sample, negative inside one, into out (product of counts). Exact
 * within two and a half cells of the surface, farther out a chamfer sum, never short and less than a tenth too long. Faces
 * are counter-clockwise outward; a mesh may be open where no line along z can enter it. */
ris_result ris__distance_grid(const ris_mesh *const *mesh, uint32_t mesh_count, const ris_grid_place *place,
                              float *out, ris_error *err);

/* Rounds off the edges of the distance: a node in the notch between two teeth must find one direction out of it. */
void ris__grid_smooth(const ris_grid_place *place, uint32_t passes, float *value);

/* Distances with the unit direction in which they grow. Interpolated like the distance, the direction of a contact
 * has no jumps at cell borders, on which a node could never come to rest. */
void ris__grid_directions(const ris_grid_place *place, const float *value, ris_vec4 *out);

/* Trilinear blend at p (mm) of a grid from low with per_mm samples a mm; false outside it. Used by the bake and by
 * the contact stage on the CPU; order of operations in docs/physics.md. */
bool ris__grid_blend(const ris_vec4 *grid, ris_vec3 low, float per_mm, const uint32_t count[3], ris_vec3 p,
                     ris_vec4 *out);
/* The same of a placed grid. */
bool ris__grid_sample(const ris_vec4 *grid, const ris_grid_place *place, ris_vec3 p, ris_vec4 *out);
