/* Solids of triangle meshes, for exact depths: each connected component is one solid, holes are capped. mm. */
#pragma once

#include "query/query.h"

/* One component. The caps close it for the rays; depths are distances to the surface without them. */
typedef struct ris_solid {
    tri_mesh closed, surface; /* surface is empty when nothing was capped; positions belong to the set */
    bvh closed_tree, surface_tree;
    uint32_t source; /* which ris__solids_add made it */
} ris_solid;

/* Zeroed is empty; ris__solids_finish frees. */
typedef struct ris_solids {
    ris_solid *solid;
    uint32_t count, source_count;
    dvec **position; /* of each source */
} ris_solids;

/* Adds the components of a mesh. Every hole is capped by a fan to the middle of its border, or to apex when that is
 * given (the pivot of an eye: the chamber behind the cornea is then inside). */
ris_result ris__solids_add(ris_solids *solids, const ris_mesh *mesh, const dvec *apex, const char *name,
                           ris_error *err);
void ris__solids_finish(ris_solids *solids);

/* Depth of p: the largest distance to the surface of a component that p is inside of, 0 outside of all. *out_solid is
 * that component. */
double ris__solids_depth(const ris_solids *solids, dvec p, uint32_t *out_solid);
/* Distance to the nearest surface or cap: whoever moves by less stays on his side. */
double ris__solids_clearance(const ris_solids *solids, dvec p);
