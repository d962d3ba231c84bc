/* Skull, mandible and landmarks under a skin (KA-04, KA-07, KA-08): shapes, meshing, fit, measurement.
 * Library of
 * risorius-make-skull and of its test. mm everywhere; x to the subject's left, y up, z out of the face; the
 * right half
 * is the mirror of the left. */
#pragma once

#include "query/query.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* ---- triangles (tri.c) ---- */

/* Writes v and f records (four decimals) under the name when complete. */
ris_result tri_write_obj(const char *path, const char *comment, const tri_mesh *mesh, ris_error *err);
/* Edges that are not shared by exactly two triangles running opposite ways; 0 = closed oriented manifold. */
ris_result tri_open_edges(const tri_mesh *mesh, uint32_t *out_count, ris_error *err);
/* Largest distance of a vertex from the mirror image of another (0 = exactly symmetric). */
double tri_asymmetry(const tri_mesh *mesh);
double tri_volume(const tri_mesh *mesh); /* mm^3, signed */

/* ---- the outer skin (hull.c) ---- */

/* The skin without eye sockets and mouth cavity, its openings (lids, lips, neck) closed by fans: a closed
 * surface that
 * has an inside. The first skin_triangles triangles are of the skin itself, vertex indices as in skin.obj. */
typedef struct hull {
    tri_mesh mesh;
    uint32_t skin_triangles, skin_vertices;
    bvh tree;
} hull;

ris_result hull_load(const char *directory, hull *out, ris_error *err);
void hull_finish(hull *h);

/* ---- shapes (shape.c) ---- */

typedef enum shape_kind { SHAPE_ELLIPSOID, SHAPE_CAPSULE, SHAPE_BOX, SHAPE_CURVE, SHAPE_PLATE } shape_kind;
typedef enum shape_op { SHAPE_ADD, SHAPE_CUT } shape_op;

#define SHAPE_POINTS 16
#define SHAPE_STEPS 4

/* One signed-distance shape of the left half; x of a sample is taken as |x|. Meaning of the fields by kind:
 * ellipsoid: centre point[0], radius; turn about x, y, z in degrees.
 * capsule: point[0], point[1] with radii size[0][0], size[1][0].
 * box: centre point[0], half sizes radius, rounding; turn.
 * curve: smooth curve through the points; size = half width across, half height along "up" at each point.
 * plate: polygon of points (z, y) rounded by rounding, radius.x = half thickness, about the sheet
 *        x = sheet[0] + sheet[1] y + sheet[2] z. */
typedef struct shape {
    const char *name;
    shape_kind kind;
    shape_op op;
    double blend; /* mm over which it melts into what is there */
    int count;
    dvec point[SHAPE_POINTS];
    double size[SHAPE_POINTS][2];
    dvec radius, turn, up;
    double rounding, sheet[3];
} shape;

/* A shape made ready for sampling. */
typedef struct solid_part {
    shape def;
    double rotation[3][3]; /* world to shape */
    dvec centre;           /* bounding sphere */
    double reach;
    int step_count; /* curve samples */
    dvec step[SHAPE_POINTS * SHAPE_STEPS];
    double step_size[SHAPE_POINTS * SHAPE_STEPS][2];
} solid_part;

#define SOLID_PARTS 160
#define SOLID_WARPS 64

typedef struct solid_warp {
    dvec at, shift; /* surface near at moves by shift */
    double radius;
} solid_warp;

/* Distance of the skin on a coarse grid (positive inside). */
typedef struct depth_grid {
    double low[3], step;
    int count[3];
    float *value;
} depth_grid;

/* A bone: its shapes in order, the warp of the fit, and the least distance to the skin. */
typedef struct solid {
    const char *name;
    int part_count, warp_count;
    solid_part *part; /* (SOLID_PARTS) */
    solid_warp warp[SOLID_WARPS];
    const depth_grid *skin;
    double (*clearance)(dvec p); /* least depth under the skin at p, mm */
} solid;

ris_result solid_init(solid *s, const char *name, ris_error *err);
void solid_finish(solid *s);
void solid_add(solid *s, const shape *def);
/* Signed distance, negative in bone (approximate away from the surface). */
double solid_distance(const solid *s, dvec p);
dvec solid_gradient(const solid *s, dvec p);

ris_result depth_grid_build(depth_grid *g, const hull *h, double step, ris_error *err);
double depth_grid_at(const depth_grid *g, dvec p);
void depth_grid_finish(depth_grid *g);

/* skull_shapes.c, mandible_shapes.c: the anatomy. */
void skull_shapes(solid *s);
void mandible_shapes(solid *s);
double skull_clearance(dvec p);
double mandible_clearance(dvec p);

/* ---- meshing (mesher.c, simplify.c) ---- */

/* Marching tetrahedra of the left half on a grid of the given step, every vertex on the zero level;
 * vertices with x = 0
 * exactly lie on the mirror plane. low and high bound the bone. */
ris_result mesh_half(const solid *s, dvec low, dvec high, double step, tri_mesh *out, ris_error *err);
/* Quadric edge collapse down to target triangles; border vertices (x = 0) stay on the mirror plane. */
ris_result mesh_simplify(tri_mesh *mesh, uint32_t target, ris_error *err);
/* Adds the mirrored half, welding x = 0. */
ris_result mesh_mirror(const tri_mesh *half, tri_mesh *out, ris_error *err);
/* Moves every vertex back onto the zero level after simplification. */
void mesh_project(tri_mesh *half, const solid *s, double limit_mm);
/* Rounds to what the file holds (four decimals). */
void mesh_round(tri_mesh *mesh);
/* Removes components smaller than the largest one. */
ris_result mesh_keep_largest(tri_mesh *mesh, ris_error *err);

/* ---- landmarks (landmarks.c, sites.c) ---- */

#define LANDMARK_LIMIT 160

typedef struct landmark {
    char name[16]; /* with .L/.R */
    uint32_t vertex[3];
    double weight[3];
    dvec at;
    int bone;                  /* skull landmark: 0 skull, 1 mandible */
    dvec normal;               /* skull landmark: unit, towards its skin landmark */
    double depth_mm, table_mm; /* of a pair; table 0 = no table row */
} landmark;

typedef struct landmark_set {
    uint32_t skin_count, bone_count;
    landmark skin[LANDMARK_LIMIT], bone[LANDMARK_LIMIT];
    dvec jaw_point, jaw_axis;
} landmark_set;

/* A tissue-depth site (table 8.3): where its dowel stands. The dowel is the line through seed along out. */
typedef struct site {
    const char *name;
    bool bilateral;
    int bone;
    dvec seed, out;
    double aim;      /* factor on the table value that the fit aims at */
    double radius;   /* of the fit's local warp, mm */
    double table_mm; /* 0 when the table has no such row */
} site;

#define SITE_LIMIT 40
uint32_t sites_default(site out[SITE_LIMIT]);
/* Fills table_mm from assets/tables/tissue_depth.csv; every row must have its site. */
ris_result sites_read_table(const char *path, site *sites, uint32_t count, ris_error *err);
/* Bends the bones locally until the dowels have their depths. */
void fit_sites(solid bone[2], const hull *h, const site *sites, uint32_t count);

ris_result landmarks_place(landmark_set *set, const hull *h, const tri_mesh bone[2], const bvh tree[2],
                           const site *sites, uint32_t count, ris_error *err);
ris_result landmarks_write(const char *path, const landmark_set *set, ris_error *err);
ris_result landmarks_read(const char *path, landmark_set *set, ris_error *err);

/* ---- acceptance (measure.c) ---- */

typedef struct skull_report {
    uint32_t open_edges[2];
    double asymmetry[2];
    double least_depth[2];    /* of a vertex or edge midpoint under the skin, mm; negative = outside */
    double worst_depth_error; /* largest |depth - table| / table */
    char worst_site[16];
    double worst_near_error;      /* the same of the shortest distance from the skin landmark to the bone */
    double orbit_free, nose_free; /* least free length past the rim of the frontal rays, mm */
    double arch_free;             /* free vertical length medial to the arch, mm */
    double condyle_off;           /* distance of the worse condyle from the axis */
    uint32_t crossing;            /* edges of one bone that pierce the other, both ways */
    double joint_gap;             /* least distance of the condyles' vertices from the skull, mm */
    uint32_t roots_bare;          /* teeth whose root, 5 mm above its neck, is not in its bone */
    double depth_spread;          /* largest minus least depth of skull vertices: not a shrunken skin */
    double shrink_share;          /* share of skull vertices within 2 mm of the median depth */
} skull_report;

typedef struct skull_input {
    const hull *skin;
    const tri_mesh *bone;  /* [2] skull, mandible */
    const bvh *tree;       /* [2] */
    const tri_mesh *teeth; /* [2] upper, lower; 16 teeth of equal vertex counts each */
    const landmark_set *landmark;
    dvec jaw_point, jaw_axis; /* the head's hinge; axis is unit */
} skull_input;

/* Edges of either bone that pierce the other. */
uint32_t skull_crossings(const bvh tree[2]);
ris_result skull_measure(const skull_input *in, skull_report *out, ris_error *err);
void skull_print(const skull_report *r);
/* The bounds of docs/skull.md; false with the first broken one in err. */
bool skull_accept(const skull_report *r, ris_error *err);
