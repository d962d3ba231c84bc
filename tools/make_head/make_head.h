/* risorius-make-head: base mesh + recipe -> the files of assets/human (KA-01, KA-03, KA-06).
 * Everything is computed in base millimetres (base mesh units x 100) and turned into head coordinates when written. */
#pragma once

#include "risorius/base.h"

#include <jansson.h>
#include <stdio.h>

#define NONE UINT32_MAX
#define MAX_RINGS 32
#define RING_SIZE 64

typedef struct dvec {
    double x, y, z;
} dvec;

/* The quad mesh of the source, all groups; arrays owned. */
typedef struct base_mesh {
    uint32_t vertex_count, uv_count, quad_count;
    dvec *position;         /* base mm (vertex_count) */
    double *uv;             /* (uv_count x 2) */
    uint32_t (*quad)[4];    /* vertices, counter-clockwise outward (quad_count) */
    uint32_t (*quad_uv)[4]; /* (quad_count) */
} base_mesh;

/* Neighbourhood of the body's quads; arrays owned. */
typedef struct topology {
    const base_mesh *mesh;
    uint32_t body_end;    /* vertices below it belong to the body */
    uint32_t *quad_start; /* CSR: quads around a vertex (vertex_count + 1) */
    uint32_t *quad_of;    /* (quad_start[vertex_count]) */
    uint32_t *edge_start; /* CSR: neighbours of a vertex (vertex_count + 1) */
    uint32_t *neighbour;  /* (edge_start[vertex_count]) */
    uint32_t *mirror;     /* vertex at (-x, y, z), NONE outside the body (vertex_count) */
} topology;

/* An edge loop: vertices in order. open loops end where the quads stop being regular. */
typedef struct edge_loop {
    uint32_t count;
    uint32_t vertex[128];
} edge_loop;

/* Concentric rings around the mouth (both sides) or the left eye, from the outside in. */
typedef struct ring_set {
    uint32_t count;
    edge_loop at[MAX_RINGS];
    uint32_t corner[2]; /* column of the mouth corner; inner and outer corner of the eye */
} ring_set;

typedef struct head_frame {
    dvec origin, up, front; /* base mm and unit axes; x is kept */
} head_frame;

typedef struct region {
    char name[64];
    uint8_t *has; /* by skin vertex */
} region;

/* The cut head; arrays owned. */
typedef struct skin {
    uint32_t vertex_count, quad_count;
    uint32_t *base;      /* base vertex, ascending (vertex_count) */
    uint32_t *index_of;  /* skin vertex of a base vertex or NONE (base vertex_count) */
    uint32_t *mirror;    /* skin vertex at (-x, y, z) (vertex_count) */
    dvec *position;      /* base mm (vertex_count) */
    dvec *normal;        /* outward unit (vertex_count) */
    uint32_t (*quad)[4]; /* skin vertices (quad_count) */
    uint32_t (*quad_uv)[4];
    double *depth_mm, *jaw_weight; /* (vertex_count) */
    uint32_t region_count;
    region regions[64];
    uint8_t *outer; /* 1 = not in mouth cavity or socket (vertex_count) */
} skin;

typedef struct maker {
    json_t *recipe;
    base_mesh mesh;
    topology topo;
    ring_set mouth, eye;
    head_frame frame;
    skin skin;
    const char *out;
    const char *tables;
    ris_error err;
} maker;

/* A growing mesh in base mm for procedural parts. */
typedef struct part {
    uint32_t vertex_count, vertex_room, face_count, face_room;
    dvec *position;
    double (*uv)[2];
    uint32_t (*face)[4]; /* a triangle repeats its last vertex as NONE */
} part;

/* vectors */
static inline dvec v3(double x, double y, double z)
{
    return (dvec){x, y, z};
}
static inline dvec v_add(dvec a, dvec b)
{
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline dvec v_sub(dvec a, dvec b)
{
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline dvec v_mul(dvec a, double s)
{
    return v3(a.x * s, a.y * s, a.z * s);
}
static inline dvec v_mad(dvec a, dvec b, double s)
{
    return v_add(a, v_mul(b, s));
}
static inline dvec v_mix(dvec a, dvec b, double t)
{
    return v_add(v_mul(a, 1 - t), v_mul(b, t));
}
static inline double v_dot(dvec a, dvec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
dvec v_cross(dvec a, dvec b);
double v_length(dvec a);
dvec v_unit(dvec a);
double clamp(double x, double low, double high);
double smoothstep(double low, double high, double x);

/* memory: NULL-checked calloc that stops the tool (tools may exit) */
void *need(size_t count, size_t size);

/* recipe access: each stops the tool with one sentence when the entry is missing or of another type */
json_t *recipe_get(json_t *object, const char *key);
double recipe_number(json_t *object, const char *key);
uint32_t recipe_index(json_t *object, const char *key);
void recipe_numbers(json_t *object, const char *key, double *out, size_t count);
void recipe_range(json_t *object, const char *key, uint32_t out[2]);
_Noreturn void stop(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* base_mesh.c */
void base_mesh_load(base_mesh *mesh, const char *path, double scale);
void base_mesh_finish(base_mesh *mesh);

/* topology.c */
void topology_build(topology *topo, const base_mesh *mesh, uint32_t body_end);
void topology_finish(topology *topo);
uint32_t next_on_loop(const topology *topo, uint32_t from, uint32_t at);
void ring_walk(const topology *topo, uint32_t first, uint32_t second, edge_loop *out);
void rings_load(maker *m);

/* skin.c */
void skin_cut(maker *m);
void skin_finish(skin *s);
void frame_build(maker *m);
dvec to_head(const head_frame *frame, dvec p);
/* Frontmost outer skin point on the line x, y (base mm); stops the tool when there is none. */
dvec skin_project(const skin *s, double x, double y, dvec *normal);
/* Nearest point of the outer skin. */
dvec skin_nearest(const skin *s, dvec p, dvec *normal);

/* regions.c */
void regions_build(maker *m);
const region *region_find(const skin *s, const char *name);

/* fields.c */
void fields_build(maker *m);

/* write.c */
FILE *output_open(const maker *m, const char *name);
void output_close(const maker *m, FILE *file, const char *name);
void write_skin(const maker *m);
void write_fields(const maker *m);
void write_regions(const maker *m);
void write_part(const maker *m, const part *p, const char *name);

/* part.c */
uint32_t part_vertex(part *p, dvec position, double u, double v);
void part_quad(part *p, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
void part_triangle(part *p, uint32_t a, uint32_t b, uint32_t c);
/* The same mesh mirrored in x with its faces turned. */
part part_mirrored(const part *p);
void part_append(part *to, const part *from);
void part_finish(part *p);

/* eye.c, teeth.c, tongue.c, hair.c */
void write_eyes(const maker *m);
void write_teeth(const maker *m);
void write_tongue(const maker *m);
void write_hair(const maker *m);

/* occlude.c */
/* How far each tooth of the left half (teeth of them) has to be set back into its jaw so that the arches meet with a gap of
 * gap_mm instead of passing into each other; 0 for teeth that do not reach the other arch. mm. */
void occlude(const part *lower, const part *upper, uint32_t teeth, double gap_mm, double *lower_back,
             double *upper_back);

/* muscles.c */
void write_muscles(const maker *m);
