/* A head as its files say it: plain structs, parsed and range-checked, nothing baked.
 * File formats: docs/file-formats.md. All indices 0-based; all pointers owned by the ris_head. */
#pragma once

#include "risorius/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#define RIS_NAME_SIZE 64 /* bytes of a name with its terminator */

/* A polygon mesh (OBJ): vertex order and quads are kept as in the file. */
typedef struct ris_mesh {
    uint32_t vertex_count, uv_count, face_count;
    ris_vec3 *position;    /* mm (vertex_count) */
    float *uv;             /* u, v with v up (uv_count x 2) */
    uint32_t *face_start;  /* first corner of each face, and the corner count at the end (face_count + 1) */
    uint32_t *face_vertex; /* vertex of each corner, counter-clockwise outward (face_start[face_count]) */
    uint32_t *face_uv;     /* uv of each corner, UINT32_MAX = none (face_start[face_count]) */
} ris_mesh;

/* A named set of skin vertices (regions.json). */
typedef struct ris_region {
    char name[RIS_NAME_SIZE];
    uint32_t count;
    uint32_t *vertex; /* ascending, unique (count) */
} ris_region;

typedef enum ris_muscle_kind { RIS_MUSCLE_LINEAR, RIS_MUSCLE_SPHINCTER } ris_muscle_kind;
typedef enum ris_bone {
    RIS_BONE_AUTO,
    RIS_BONE_SKULL,
    RIS_BONE_JAW,
    RIS_BONE_EYE_L,
    RIS_BONE_EYE_R,
    RIS_BONE_SKIN
} ris_bone;

/* One muscle of muscles.json, mirrored records already expanded (KA-38, KA-44). */
/* What a muscle moves: the skin; also the lip in whose ring it ends, which it ties to the bone; or the upper lid
 * of its side and no skin. */
typedef enum ris_acts_on { RIS_ACTS_ON_SKIN, RIS_ACTS_ON_LIP, RIS_ACTS_ON_LID } ris_acts_on;

typedef struct ris_muscle_def {
    char name[RIS_NAME_SIZE]; /* snake-case Latin with .L/.R */
    ris_muscle_kind kind;
    ris_bone bone;     /* AUTO, SKULL or JAW */
    ris_bone end_bone; /* of the last row: SKULL or JAW of a muscle between bones, else AUTO (the skin) */
    float drives[3];   /* what activation 1 adds to jaw.open, jaw.forward, jaw.side */
    ris_acts_on acts_on;
    uint32_t rows, columns;
    ris_vec3 *grid;   /* row 0 = fixed end, mm (rows x columns) */
    ris_vec3 axis[2]; /* sphincter axis a0, a1, mm */
    bool has_axis;
    bool closes_on_line; /* sphincter: contracts towards the axis as a slit (eyelids), not towards a point */
    float thickness_mm[2]; /* min, max */
    float max_shortening;  /* contraction at activation 1, 0..0.30; may be 0 for a passive carrier */
    float radius_mm;       /* influence beyond the muscle depth (R of docs/physics.md) */
    float insertion_start; /* t0 of the insertion profile along the fibre, 0..1 */
    float strength;        /* its say where muscles pull the same skin different ways; 0 counts as 1 */
    float held_at;         /* share of the fibre's length that stays when it shortens; 0 = the fixed end */
    float lip_drag_power; /* > 0: the end pulls the lip corner, drag along the oris is t^power; 0 = no pull */
    float gain;           /* factor on the weight (docs/physics.md) */
    float onset_ms,
        release_ms; /* until 90 % of a sudden change of activation is done, up and down; 0 = at once */
    float fat,
        fat_radius_mm; /* KA-47: how much of the fat over it rises when it shortens, and how far beside it */
    float puff_mm,
        puff_radius_mm; /* wall of the mouth: what a pressure of cheek.puff 1 bulges its middle by, and how far about */
    float
        bowstring; /* share of the way to the straight line between its ends that it goes at activation 1, 0..1 */
    float push_lip
        [2]; /* the lip above the tissue that it gathers: mm towards the slit, forward, per mm of shortening */
    bool attach_auto;
    uint32_t attach_count;
    uint32_t *attach; /* skin vertices when attach_auto is false (attach_count) */
    uint32_t au_count;
    char (*au)[16];                    /* "AU12" (au_count) */
    char *origin, *insertion, *source; /* anatomical text, may be empty, never NULL */
} ris_muscle_def;

typedef enum ris_material {
    RIS_MATERIAL_SKIN,
    RIS_MATERIAL_EYE,
    RIS_MATERIAL_CORNEA,
    RIS_MATERIAL_TEETH,
    RIS_MATERIAL_GUM,
    RIS_MATERIAL_TONGUE,
    RIS_MATERIAL_HAIR
} ris_material;

/* A rigid or skin-bound component: eyes, teeth, tongue, lashes, brows (KA-06). */
typedef struct ris_part_def {
    char name[RIS_NAME_SIZE];
    ris_mesh mesh;
    ris_bone bone;  /* SKULL, JAW, EYE_L, EYE_R, or SKIN = rides on the nearest skin triangle */
    ris_vec3 pivot; /* mm, centre of rotation of an eye */
    ris_material material;
    char *color;   /* path of its texture, or NULL */
    ris_vec3 tint; /* linear RGB when there is no texture */
} ris_part_def;

/* The joint of the jaw (KA-05, and its path: docs/physics.md, jaw_pose). */
typedef struct ris_jaw_def {
    ris_vec3 point, axis; /* mm, unit; positive turn opens */
    float open_deg, forward_mm, back_mm, side_mm;
    ris_vec3 incisor; /* mm, between the edges of the lower middle incisors */
    float condyle_mm; /* from point to the middle of a condyle */
    float eminence_deg,
        eminence_mm; /* slope of the articular eminence where it begins, way forward to its crest */
    float slide_mm, slide_start; /* way of the condyles when opened, and the opening at which it begins */
    float bennett_mm;            /* shift of the whole jaw to the working side */
} ris_jaw_def;

/* Least opening at which the teeth pass each other, over the way forward and jaw.side without its sign. */
typedef struct ris_guidance {
    uint32_t forward_count, side_count; /* 0 = the teeth do not guide */
    float *forward_mm;                  /* ascending (forward_count) */
    float *side;                        /* 0..1, ascending (side_count) */
    float *open_deg;                    /* (forward_count x side_count) */
} ris_guidance;

typedef enum ris_landmark_mesh {
    RIS_LANDMARK_SKIN,
    RIS_LANDMARK_SKULL,
    RIS_LANDMARK_MANDIBLE
} ris_landmark_mesh;

/* A named point on a triangle of a mesh (KA-07; landmarks.json). One on bone is paired with the one of its name on
 * the skin; the dowel goes from it to the skin (KA-74). */
typedef struct ris_landmark {
    char name[16]; /* "g", "ch.L": the literature's names */
    ris_landmark_mesh mesh;
    uint32_t vertex[3];
    float weight[3]; /* barycentric */
    ris_vec3 at;     /* mm, at rest */
    ris_vec3 dowel;  /* unit, on bone */
    float depth_mm,
        table_mm; /* on bone: length of the dowel, and what the table of tissue depths says (0 = no row) */
} ris_landmark;

typedef enum ris_tissue_model { RIS_TISSUE_RISORIUS, RIS_TISSUE_KAEHLER } ris_tissue_model;

/* Anchor stiffness of one region; later records override earlier ones. Before stiffness_scale. */
typedef struct ris_anchor_region {
    char region[RIS_NAME_SIZE]; /* "bone" = every node, "muscle" = where a muscle acts, else a region name */
    float normal, tangential;   /* g/s^2 per 25 mm^2 of node area */
} ris_anchor_region;

/* Numbers of the skin model (KA-10..18; docs/physics.md). ris_default_tissue() fills all. */
typedef struct ris_tissue_def {
    ris_tissue_model model;
    float density_kg_m3, skin_mm;     /* KA-13, kaehler mass */
    float modulus[2];                 /* g/s^2: low, high (KA-12) */
    float switch_stretch;             /* 1.5 */
    bool continuous;                  /* continuous biphasic law; false = the thesis's jump */
    float compression;                /* factor on the modulus when shorter than rest */
    float bending;                    /* g/s^2 */
    float stiffness_scale;            /* factor on all stiffness */
    float damping_per_s;              /* gamma / m of the risorius tissue */
    float damping_g_s;                /* gamma of the kaehler tissue */
    float mass_g;                     /* uniform node mass of the risorius tissue */
    float bone_anchor, muscle_anchor; /* kaehler: 30, 10 g/s^2 */
    float muscle_radius_mm;           /* kaehler: 10 mm */
    float constraint_lambda;          /* 30 (KA-33) */
    float bulge, bulge_kaehler;       /* nu of KA-36: 1 keeps the volume; 5 in the thesis */
    uint32_t substeps;                /* per 1/60 s */
    uint32_t anchor_region_count;
    ris_anchor_region anchor_region[32];
} ris_tissue_def;

/* How flesh moves in time. How fast what a pose asks for becomes activation: ms until 90 % of a sudden change is done, 0 = at once (docs/physics.md,
 * activation). All 0 in the kaehler tissue. */
typedef struct ris_dynamics_def {
    float onset_ms, release_ms; /* muscles without times of their own, protrusion, tongue, puffed cheeks */
    float lid_onset_ms, lid_release_ms; /* muscles of the lids, lid channels */
    float jaw_onset_ms, jaw_release_ms; /* muscles between bones, jaw channels */
    /* head_inertia: share of the head's acceleration that the skin feels, and of its weight when the head is tilted */
    float follow_through, gravity;
} ris_dynamics_def;

/* One term of an expression: a channel name (sided or not) and its value. */
typedef struct ris_term {
    char channel[RIS_NAME_SIZE];
    float value;
} ris_term;

typedef struct ris_expression {
    char name[RIS_NAME_SIZE];
    uint32_t term_count;
    ris_term *term;
} ris_expression;

/* The vocabularies: action units of FACS, ARKit's shapes, visemes, the expression library. */
typedef enum ris_word_kind {
    RIS_WORD_UNIT,
    RIS_WORD_SHAPE,
    RIS_WORD_VISEME,
    RIS_WORD_EXPRESSION,
    RIS_WORD_KINDS
} ris_word_kind;

/* What a channel of a model gets. */
typedef struct ris_channel_value {
    uint32_t channel;
    float value; /* file units */
} ris_channel_value;

/* A name of a vocabulary with what it is made of: a unit of channels, all others of units and channels. */
typedef struct ris_word {
    char name[RIS_NAME_SIZE];
    ris_word_kind kind;
    char *title, *source; /* never NULL; source may be empty */
    uint32_t term_count;
    ris_term *term;
    /* on a model (ris_model.vocabulary): the terms as its channels, and how many terms it has no channel for */
    uint32_t value_count, missing_count;
    ris_channel_value *value;
    bool symmetric; /* does the same on both sides */
} ris_word;

typedef struct ris_vocabulary {
    uint32_t word_count;
    ris_word *word; /* by kind, then in the order of its file (word_count) */
} ris_vocabulary;

typedef struct ris_head {
    char *directory; /* as given */
    ris_mesh skin;
    int32_t *base_vertex; /* skin.map: base mesh vertex or -1 (skin.vertex_count), NULL if no map */
    char *color;          /* path of the skin texture, or NULL */
    uint32_t region_count;
    ris_region *region;
    char simulated[RIS_NAME_SIZE]; /* region that is simulated (KA-09) */
    ris_mesh skull, mandible;      /* bones at rest (KA-04); without vertices if the head has none */
    uint32_t landmark_count;
    ris_landmark *landmark; /* of the skin, then of the bones (landmark_count) */
    float *depth_mm;        /* skin to bone (skin.vertex_count) */
    float *jaw_weight;      /* 0 skull .. 1 mandible (skin.vertex_count) */
    uint32_t muscle_count;
    ris_muscle_def *muscle;
    uint32_t part_count;
    ris_part_def *part;
    ris_jaw_def jaw;
    ris_guidance guidance;
    ris_tissue_def tissue;
    ris_dynamics_def dynamics;
    uint32_t expression_count;
    ris_expression *expression;
} ris_head;

/* A jaw with the default path, its hinge through the origin. */
ris_jaw_def ris_default_jaw(void);
/* Default tissue: docs/physics.md, with thesis numbers for the kaehler fields. */
ris_tissue_def ris_default_tissue(void);

/* The times of docs/physics.md, activation. */
ris_dynamics_def ris_default_dynamics(void);

/* Reads directory/head.json and all it names. On failure *out is zeroed and err says file:line:col where it can. */
ris_result ris_head_load(const char *directory, ris_head *out, ris_error *err);

/* Frees everything inside; safe on a zeroed head. */
void ris_head_finish(ris_head *head);

/* Region by name, or NULL. */
const ris_region *ris_head_region(const ris_head *head, const char *name);

/* Landmark by name, on bone or on the skin, or NULL. */
const ris_landmark *ris_head_landmark(const ris_head *head, const char *name, bool on_bone);

/* KA-08: the rigid movement (row-major 3x4, mm) that puts the head into the Frankfort horizontal by its skin landmarks
 * po.L, po.R, or.L, or.R: x through the porions, the mean orbitale as high as the middle between the porions, which
 * becomes the origin. RIS_ERROR_DATA: a landmark is missing, or the four span no plane. */
ris_result ris_head_frankfort(const ris_head *head, double out[12], ris_error *err);

/* Strict OBJ reader (v, vt, f, quads kept). On failure *out is zeroed. */
ris_result ris_mesh_load_obj(const char *path, ris_mesh *out, ris_error *err);
/* Same from memory; name stands for the file in errors. */
ris_result ris_mesh_parse_obj(const char *name, const char *text, size_t size, ris_mesh *out, ris_error *err);
void ris_mesh_finish(ris_mesh *mesh);

/* Refuses NaN, zero-area triangles, isolated vertices, non-manifold or inconsistently oriented edges. name is for the message. */
ris_result ris_mesh_check(const ris_mesh *mesh, const char *name, ris_error *err);

#ifdef __cplusplus
}
#endif
