/* Exact questions to a triangle mesh: closest point, ray, inside or out (double, over a tree of boxes). For the
 * bake, the tools and the measurements; nothing here runs in a tick. mm. */
#pragma once

#include "risorius/head.h"

#include <math.h>

typedef struct dvec {
    double x, y, z;
} dvec;

static inline dvec dv(double x, double y, double z)
{
    return (dvec){x, y, z};
}
static inline dvec dv_add(dvec a, dvec b)
{
    return dv(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline dvec dv_sub(dvec a, dvec b)
{
    return dv(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline dvec dv_mad(dvec a, double s, dvec b)
{
    return dv(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline double dv_dot(dvec a, dvec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline dvec dv_cross(dvec a, dvec b)
{
    return dv(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double dv_length(dvec a)
{
    return sqrt(dv_dot(a, a));
}
static inline dvec dv_unit(dvec a)
{
    double l = dv_length(a);
    return l > 0 ? dv(a.x / l, a.y / l, a.z / l) : dv(0, 0, 1);
}

/* Triangle soup with shared vertices; outward = counter-clockwise. Zeroed is empty; ris__tri_finish frees. */
typedef struct tri_mesh {
    uint32_t vertex_count, triangle_count;
    dvec *position;     /* (vertex_count) */
    uint32_t *triangle; /* (triangle_count x 3) */
} tri_mesh;

void ris__tri_finish(tri_mesh *mesh);
dvec ris__tri_normal(const tri_mesh *mesh, uint32_t triangle); /* unit */
/* Fan triangulation of a polygon mesh. name stands for it in errors. */
ris_result ris__tri_from_mesh(const ris_mesh *mesh, const char *name, tri_mesh *out, ris_error *err);
/* The same of an OBJ file. */
ris_result ris__tri_load_obj(const char *path, tri_mesh *out, ris_error *err);

typedef struct bvh_node {
    double low[3], high[3];
    uint32_t first, count; /* leaf: triangles order[first ..]; inner: count 0, children first and first + 1 */
} bvh_node;

/* Boxes over a mesh that must outlive it. Zeroed is empty. */
typedef struct bvh {
    const tri_mesh *mesh;
    bvh_node *node;
    uint32_t *order, node_count;
} bvh;

typedef struct bvh_hit {
    bool found;
    uint32_t triangle;
    double distance; /* along a unit ray, or to the closest point */
    dvec at;
} bvh_hit;

ris_result ris__bvh_build(bvh *out, const tri_mesh *mesh, ris_error *err);
void ris__bvh_finish(bvh *tree);
bvh_hit ris__bvh_closest(const bvh *tree, dvec p);
/* The same among triangles whose normal has at least this cosine with unit normal, nearer than within. */
bvh_hit ris__bvh_closest_facing(const bvh *tree, dvec p, dvec normal, double cosine, double within);
/* First hit of the ray with distance in (from, to). direction is unit. */
bvh_hit ris__bvh_ray(const bvh *tree, dvec origin, dvec direction, double from, double to);
/* Parity of a skew ray decides, three rays vote. mesh must be closed. */
bool ris__bvh_inside(const bvh *tree, dvec p);
/* How often the mesh goes round p: 0 outside, 1 inside, more where it overlaps itself. Signed crossings of a skew ray;
 * where two rays disagree (one met an edge) the median of three. mesh must be closed and oriented. */
int32_t ris__bvh_winding(const bvh *tree, dvec p);
/* Distance to the surface, positive inside. */
double ris__bvh_depth(const bvh *tree, dvec p);

/* p where place (row-major 3x4: rotation and shift, as ris_sim_bone_transform gives it) puts it. */
dvec ris__place(const float place[12], dvec p);
/* Edges of one closed mesh that pierce the other, both ways, the first of them placed; counts up to stop. */
uint32_t ris__bvh_crossings(const bvh *moved, const float place[12], const bvh *still, uint32_t stop);
/* Least distance of a vertex of either from the surface of the other. */
double ris__bvh_gap(const bvh *moved, const float place[12], const bvh *still);
