/* The texture painter: a head mesh in, procedural skin, eye, teeth and tongue textures out.
 * Everything is painted in 3D space (mm), so that UV seams do not show, and from integer hash noise, so that
 * the same mesh gives the same bytes. No photographs are involved. */
#pragma once

#include "risorius/head.h"

/* ---- small vectors ---- */
static inline ris_vec3 vec3(float x, float y, float z)
{
    return (ris_vec3){x, y, z};
}
static inline ris_vec3 vec3_add(ris_vec3 a, ris_vec3 b)
{
    return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline ris_vec3 vec3_sub(ris_vec3 a, ris_vec3 b)
{
    return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline ris_vec3 vec3_scale(ris_vec3 a, float s)
{
    return vec3(a.x * s, a.y * s, a.z * s);
}
static inline float vec3_dot(ris_vec3 a, ris_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline ris_vec3 vec3_cross(ris_vec3 a, ris_vec3 b)
{
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
float ris_paint_length(ris_vec3 a);
ris_vec3 ris_paint_unit(ris_vec3 a);

/* ---- scalar shaping ---- */
float ris_paint_clamp(float x, float low, float high);
float ris_paint_mix(float a, float b, float t);
/* 0 below edge0, 1 above edge1 (edge1 may be the smaller one), cubic between. */
float ris_paint_step(float edge0, float edge1, float x);
/* exp(-(distance / radius)^2) */
float ris_paint_blob(ris_vec3 p, ris_vec3 centre, float radius);
/* The same around the segment a..b. */
float ris_paint_capsule(ris_vec3 p, ris_vec3 a, ris_vec3 b, float radius);

/* ---- noise (noise.c): integer hashes only, equal on every machine ---- */
uint32_t ris_paint_hash(int32_t x, int32_t y, int32_t z, uint32_t seed);
/* Gradient noise, about -1..1, feature size 1. */
float ris_paint_noise(ris_vec3 p, uint32_t seed);
/* Octaves of it, each half as large and 0.55 as strong; about -1..1. */
float ris_paint_fbm(ris_vec3 p, int octaves, uint32_t seed);
/* Cellular noise: distance to the nearest (near) and second (next) feature point of unit cells, and the
 * nearest one's hash. */
typedef struct ris_paint_cell {
    float near, next;
    uint32_t id;
} ris_paint_cell;
ris_paint_cell ris_paint_cells(ris_vec3 p, uint32_t seed);

/* ---- ray casting (occlusion.c) ---- */
typedef struct ris_paint_tree ris_paint_tree;
/* Bounding-volume tree over triangles (corner triples); keeps references to both arrays. NULL when memory
 * is short. */
ris_paint_tree *ris_paint_tree_create(const ris_vec3 *position, const uint32_t *triangle,
                                      uint32_t triangle_count);
void ris_paint_tree_destroy(ris_paint_tree *tree);
/* Distance along the unit direction to the first triangle, or limit if none is nearer. */
float ris_paint_tree_cast(const ris_paint_tree *tree, ris_vec3 origin, ris_vec3 direction, float limit);

/* ---- the surface and what is known of each vertex (surface.c) ---- */
typedef enum ris_paint_shell {
    RIS_SHELL_FACE,
    RIS_SHELL_MOUTH,
    RIS_SHELL_SOCKET,
    RIS_SHELL_OTHER
} ris_paint_shell;

/* Points of the face found on the mesh, mm; index 0 is the subject's left, 1 the right. */
typedef struct ris_paint_landmarks {
    ris_vec3 eye[2], canthus_inner[2], canthus_outer[2], ear[2], lip_corner[2], ala[2], cheek[2];
    ris_vec3 mouth, nose_tip, chin, crown;
    float scale; /* eye-to-mouth height over 67 mm */
} ris_paint_landmarks;

#define RIS_PAINT_RING_MAX 18.0f

typedef struct ris_paint_surface {
    const ris_mesh *mesh;
    uint32_t triangle_count;
    uint32_t *triangle;    /* vertices (triangle_count x 3) */
    uint32_t *triangle_uv; /* uvs (triangle_count x 3) */
    uint8_t *shell;        /* ris_paint_shell of each triangle's UV island (triangle_count) */
    ris_vec3 *normal;      /* (vertex_count) */
    float *lip_ring;       /* edge loops out of the mouth seam, negative inside the mouth (vertex_count) */
    float *lid_ring;       /* the same out of the lid seams (vertex_count) */
    float *curvature;      /* 1/mm, positive in hollows (vertex_count) */
    float *occlusion;      /* share of open sky, 0..1 (vertex_count) */
    float *thinness;       /* 1 where tissue is thin: ears, alae, lids (vertex_count) */
    ris_vec3 *brow;        /* points of the brow hairs (brow_count) */
    uint32_t brow_count;
    ris_vec3 brow_low, brow_high; /* their box */
    bool has_mouth, has_eyes;
    ris_paint_landmarks at;
} ris_paint_surface;

/* Prepares all of the above. extra: further meshes that shade the skin (eyeballs), brow: meshes of the
 * brows; both may be empty. mesh must outlive the surface. Errors: RIS_ERROR_DATA without UVs,
 * RIS_ERROR_MEMORY. */
ris_result ris_paint_surface_init(ris_paint_surface *surface, const ris_mesh *mesh, const ris_mesh *extra,
                                  uint32_t extra_count, const ris_mesh *brow, uint32_t brow_count,
                                  ris_error *err);
void ris_paint_surface_finish(ris_paint_surface *surface);
/* Fills lip_ring, lid_ring, shell and the landmarks (islands.c). */
ris_result ris_paint_find_islands(ris_paint_surface *surface, ris_error *err);
/* Fills occlusion and thinness (occlusion.c). */
ris_result ris_paint_bake_occlusion(ris_paint_surface *surface, const ris_mesh *extra, uint32_t extra_count,
                                    ris_error *err);

/* ---- painting ---- */
/* What the painter knows at one texel. */
typedef struct ris_paint_site {
    ris_vec3 p, n;
    float lip, lid, curvature, occlusion, thinness, brow;
    ris_paint_shell shell;
} ris_paint_site;

#define RIS_PAINT_SMOOTH 0.75f /* height of skin without a wrinkle */

/* Linear RGB albedo 0..1; detail: height (0.5 = mean), oiliness, thinness; height of squeezed skin. */
typedef struct ris_paint_texel {
    float color[3], detail[3], wrinkle;
} ris_paint_texel;

/* skin.c */
ris_paint_texel ris_paint_skin(const ris_paint_surface *surface, const ris_paint_site *site);
/* zones.c: what kind of skin a place is, each weight 0..1 unless said otherwise. */
typedef struct ris_paint_zones {
    float scalp;                  /* stubble density within the hairline */
    float lip, lip_roll;          /* vermilion; the pale rim around it */
    float inner_mouth, inner_lip; /* behind the lip seam; the part of the lips hidden when closed */
    float lid, rim, lash, crease, under_eye, socket, caruncle;
    float ear, nose, ala, cheek, forehead, chin, lower_face, neck, fold, lip_corner, nostril;
} ris_paint_zones;
ris_paint_zones ris_paint_find_zones(const ris_paint_surface *surface, const ris_paint_site *site);
/* wrinkles.c: height of fully squeezed skin, 0..1, RIS_PAINT_SMOOTH where it does not fold. */
float ris_paint_wrinkles(const ris_paint_surface *surface, const ris_paint_site *site,
                         const ris_paint_zones *zones);

/* An RGB image, top row first, 8 bits a channel. */
typedef struct ris_paint_image {
    uint32_t width, height;
    uint8_t *rgb; /* (width x height x 3) */
    uint8_t *
        covered; /* 1 where a triangle was painted, 2 where spread from there; may be NULL (width x height) */
} ris_paint_image;

void ris_paint_image_finish(ris_paint_image *image);
ris_result ris_paint_image_init(ris_paint_image *image, uint32_t width, uint32_t height, ris_error *err);
/* sRGB byte of a linear value. */
uint8_t ris_paint_encode(float linear);
/* Linear value of an sRGB byte. */
float ris_paint_decode(float byte);
/* PNG through a temporary file, renamed at the end. Errors: RIS_ERROR_FAILED. */
ris_result ris_paint_image_save(const ris_paint_image *image, const char *path, ris_error *err);

/* The skin's images: colour (sRGB), detail and wrinkles (linear). */
typedef struct ris_paint_skin_images {
    ris_paint_image color, detail, wrinkles;
} ris_paint_skin_images;
void ris_paint_skin_images_finish(ris_paint_skin_images *images);
/* Paints them over the UV islands, size x size each (atlas.c). */
ris_result ris_paint_atlas(const ris_paint_surface *surface, uint32_t size, ris_paint_skin_images *out,
                           ris_error *err);

/* Sizes of the eyeball the eye texture is made for, mm. */
typedef struct ris_paint_eye {
    float ball_radius_mm, iris_radius_mm, pupil_radius_mm;
} ris_paint_eye;
/* Azimuthal layout: centre = corneal pole, radius 0.5 = back pole (eye.c). */
ris_result ris_paint_eye_image(const ris_paint_eye *eye, uint32_t size, ris_paint_image *out, ris_error *err);
/* mouth.c */
ris_result ris_paint_teeth_image(uint32_t size, ris_paint_image *out, ris_error *err);
ris_result ris_paint_tongue_image(uint32_t size, ris_paint_image *out, ris_error *err);
ris_result ris_paint_gum_image(uint32_t size, ris_paint_image *out, ris_error *err);
