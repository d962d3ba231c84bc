/* Builders of ris_model, in the order ris_model_create calls them. Each fills its fields and says what is
 * wrong with the head. */
#pragma once

#include "query/query.h"
#include "risorius/model.h"

#define RIS_GROUP_MAX 256 /* muscle points in one constraint group */

/* The grid of a muscle below the skin, refined: rows run along the fibres, row 0 is the fixed end. */
typedef struct ris_bake_grid {
    uint32_t rows, columns;
    ris_vec3 *point, *normal; /* normal outwards, unit (rows x columns) */
    float *depth;             /* below the skin, mm (rows x columns) */
    bool *deep;               /* the author drew it below the muscle layer (rows x columns) */
    float *thickness;         /* of each cell, mm ((rows - 1) x (columns - 1)) */
} ris_bake_grid;

/* Head as parsed plus what only the bake needs. */
typedef struct ris_bake {
    ris_model *model;
    const ris_head *head;
    uint32_t *ring_triangle; /* triangle of each ring entry (3 x triangle_count) */
    float *triangle_area;    /* mm^2 (triangle_count) */
    bool *moving;            /* in the simulated region (node_count) */
    bool *
        lining; /* of the mouth, behind the rim of the lips: mouth_cavity without inner_lip_rim (node_count) */
    float *muscle_weight; /* largest binding weight, 0..1 (node_count) */
    ris_bake_grid *grid;  /* (muscle_count) */
    tri_mesh skin;        /* the model's triangles, and boxes over them */
    bvh skin_tree;
} ris_bake;

/* calloc of count x size that reports what it was for; count 0 gives a valid pointer. */
ris_result ris__model_alloc(void *out, size_t count, size_t size, const char *what, ris_error *err);

/* KA-02: triangles, ring, node areas, rest normals; refuses non-manifold or unoriented edges. */
ris_result ris__bake_triangles(ris_bake *bake, ris_error *err);
/* Which nodes move (KA-09) and their mass (KA-13); rest_position. */
ris_result ris__bake_mass(ris_bake *bake, ris_error *err);
/* Of the umbrella of node i, g/s^2: the bending of the tissue, more where edges are short. Springs must be baked. */
float ris__bend_stiffness(const ris_bake *bake, uint32_t i);
/* KA-10, KA-11 and the bending umbrella: spring_start, half_spring. */
ris_result ris__bake_springs(ris_bake *bake, ris_error *err);
/* The list `moving` of nodes with an inverse mass. Springs must be baked. Errors: RIS_ERROR_MEMORY. */
ris_result ris__list_moving(ris_model *model, ris_error *err);
/* jaw_slide_weight. */
ris_result ris__bake_jaw_slide(ris_bake *bake, ris_error *err);
/* KA-38, KA-39: grids below the skin, refined. */
ris_result ris__bake_grids(ris_bake *bake, ris_error *err);
/* One grid of rows x columns without content. */
ris_result ris__grid_create(uint32_t rows, uint32_t columns, ris_bake_grid *out, ris_error *err);
void ris__grid_finish(ris_bake_grid *grid);
/* Normals of the grid points from the cells around them, outward as the skin near by. */
void ris__grid_normals(const ris_bake *bake, const ris_vec3 *point, uint32_t rows, uint32_t columns,
                       ris_vec3 *normal);
/* Nearest skin point whose triangle faces along normal; false if none is within 40 mm. */
bool ris__project_on_skin(const ris_bake *bake, ris_vec3 p, ris_vec3 normal, ris_vec3 *out);
/* Distance from p to the skin that faces along unit normal, on the ray both ways: positive below the skin, negative
 * above. NAN if there is none within 40 mm. triangle may be NULL. */
float ris__depth_along(const ris_bake *bake, ris_vec3 p, ris_vec3 normal, uint32_t *triangle);
/* KA-39: splits rows and columns of the sunken grid of muscle m until it keeps the muscle layer, then sets the thickness
 * of its cells. */
ris_result ris__refine_grid(const ris_bake *bake, uint32_t m, ris_bake_grid *grid, ris_error *err);
/* KA-23, 24, 40, 41: fibres and segments. */
ris_result ris__bake_muscles(ris_bake *bake, ris_error *err);
/* KA-28: constraint groups of muscle ends. */
ris_result ris__bake_groups(ris_bake *bake, ris_error *err);
/* Skin that slides over the bone close below it. */
ris_result ris__bake_slide(ris_bake *bake, ris_error *err);
/* KA-47: nodes over muscles that gather fat. */
ris_result ris__bake_fat(ris_bake *bake, ris_error *err);
/* How the lips meet over an open jaw. */
ris_result ris__bake_lips(ris_bake *bake, ris_error *err);
/* True for the ring of a lip: a sphincter of several fibres that closes on a point. */
bool ris__muscle_rolls(const ris_muscle *muscle);
/* Nodes over the muscles that wall the mouth. */
ris_result ris__bake_puff(ris_bake *bake, ris_error *err);
/* A node of the skin over a linear muscle. */
typedef struct ris_over_muscle {
    float along, beside_mm,
        out_mm;    /* share of the length; tangential distance; from the muscle's middle to the skin */
    float facing;  /* n of the skin . away from the muscle */
    ris_vec3 pull; /* unit, towards the fixed end */
} ris_over_muscle;
/* False if the node lies on the inner side of the muscle. length: ris__muscle_length. */
bool ris__find_over_muscle(const ris_model *model, const ris_muscle *muscle, uint32_t node, float length,
                           ris_over_muscle *out);
/* Of the mean fibre at rest, mm. */
float ris__muscle_length(const ris_model *model, const ris_muscle *muscle);
/* Which ring of a lip a muscle of the lips ties to the bone. */
ris_result ris__bake_ties(ris_bake *bake, ris_error *err);
/* Nodes of the mouth's lining and what they follow. */
ris_result ris__bake_lining(ris_bake *bake, ris_error *err);
/* The same by intersecting shapes, in the kaehler tissue. */
ris_result ris__bake_shape_groups(ris_bake *bake, ris_error *err);
/* Distances of a group's points from their centroid at rest; the points stand in model->group_point. */
void ris__measure_group(ris_model *model, const ris_group *group);
/* KA-29: the muscle network of the kaehler tissue. */
ris_result ris__bake_network(ris_bake *bake, ris_error *err);
/* KA-42: which nodes a muscle moves, and how much. */
ris_result ris__bake_bindings(ris_bake *bake, ris_error *err);
/* kaehler tissue: the point on its muscle or its bone that a node hangs on, at rest. */
ris_vec3 ris__anchor_at_rest(const ris_model *model, uint32_t node);
/* KA-14, KA-15 and the anchors of the default tissue: bone_anchor, anchor_param. */
ris_result ris__bake_anchors(ris_bake *bake, ris_error *err);
/* Nodes of the eyelids with their weights and closing angles; thinner, firmly held skin there. */
ris_result ris__bake_lids(ris_bake *bake, ris_error *err);
ris_result ris__bake_lid_triangles(ris_bake *bake, ris_error *err);
/* What the contact stage needs: grids, limits, pairs of the lips. After lids (eyes) and before push is done. */
ris_result ris__bake_contact(ris_bake *bake, ris_error *err);
/* Constants of the stages and the stable time step (docs/physics.md). */
ris_result ris__bake_push(ris_bake *bake, ris_error *err);
/* KA-48: the channel table. */
ris_result ris__bake_channels(ris_bake *bake, ris_error *err);
/* KA-55, KA-57: the vocabularies, as channels of this model. */
ris_result ris__bake_vocabulary(ris_bake *bake, ris_error *err);

/* Node -> true for the vertices of a region; flags are added to, (node_count). */
void ris__region_flags(const ris_head *head, const char *name, bool *flags);

/* Point `local` (unscaled affine coordinates) of a segment whose ends are now a, b and whose height is
 * scaled by bulge (KA-37). p0, p1 are the ends the segment's frame was built from. */
ris_vec3 ris__segment_point(const ris_segment *segment, ris_vec3 p0, ris_vec3 p1, ris_vec3 a, ris_vec3 b,
                            float bulge, ris_vec3 local);

/* Distance from the centre to the surface of an eye in a unit direction, looking along unit gaze, mm. */
float ris__eye_surface(const ris_lid_eye *eye, ris_vec3 direction, ris_vec3 gaze);

/* Distance of a contact node from the other lip, mm, negative through it; the direction away from it (not normalised) and how
 * much of it is near (0 = nothing, then the distance means nothing). position and normal (node_count). */
float ris__lip_distance(const ris_model *model, const ris_vec4 *position, const ris_vec4 *normal,
                        const ris_contact_node *contact, ris_vec3 *out_away, float *out_weight);

/* Mean over the fibres of control point `point` (KA-27). */
ris_vec3 ris__muscle_point(const ris_model *model, const ris_muscle *muscle, const ris_vec3 *points,
                           uint32_t point);
