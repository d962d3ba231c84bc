/* What a held pose breaks, measured on the meshes themselves and never on a contact grid: numbers that are no numbers,
 * skin in bone, teeth and eyes, lips and lids in each other, triangles turned over, asymmetry. Definitions: docs/testing.md,
 * soak. A measurer is const after its making; the rest pose is its zero, and is told besides. mm. */
#pragma once

#include "risorius/model.h"

typedef enum ris_measure {
    RIS_MEASURE_FINITE, /* nodes that are no finite numbers */
    /* depth beyond that at rest, mm: at moving vertices, then at midpoints of edges with a moving end */
    RIS_MEASURE_SKULL,
    RIS_MEASURE_SKULL_MIDPOINT,
    RIS_MEASURE_UPPER_TEETH,
    RIS_MEASURE_UPPER_TEETH_MIDPOINT,
    RIS_MEASURE_MANDIBLE,
    RIS_MEASURE_MANDIBLE_MIDPOINT,
    RIS_MEASURE_LOWER_TEETH,
    RIS_MEASURE_LOWER_TEETH_MIDPOINT,
    RIS_MEASURE_EYES,
    RIS_MEASURE_EYES_MIDPOINT,
    RIS_MEASURE_LIPS, /* vertices of a lip in the other, beyond rest, mm */
    RIS_MEASURE_LIDS, /* the same for the lids of an eye */
    /* triangles turned over that are not so at rest */
    RIS_MEASURE_FLIPPED,       /* of lips and lids */
    RIS_MEASURE_FLIPPED_OTHER, /* of the rest of the moving skin */
    RIS_MEASURE_MIRROR,        /* mirrored pose against mirrored skin, mm; only by ris__measure_mirror */
    RIS_MEASURE_COUNT
} ris_measure;
/* "skull, vertices" ... */
const char *ris__measure_name(ris_measure measure);
/* "mm", "nodes" or "triangles" */
const char *ris__measure_unit(ris_measure measure);

/* The worst place of a measure in one pose. */
typedef struct ris_finding {
    double value;          /* mm or a count; 0 = nothing found */
    uint32_t count;        /* points, nodes or triangles that have something */
    uint32_t vertex_count; /* 0 nowhere, 1 vertex, 2 edge, 3 triangle */
    uint32_t vertex[3];
    const char *part; /* what the skin is in, "" if that means nothing */
    uint32_t piece;   /* which component of it (a tooth), from 1; 0 = it has but one */
} ris_finding;

typedef struct ris_measurer ris_measurer;

/* model must outlive it. What the head lacks (bone, eyes, lips) is not measured. */
ris_result ris__measurer_create(const ris_model *model, ris_measurer **out, ris_error *err);
void ris__measurer_destroy(ris_measurer *measurer);

/* False for what this head cannot show. */
bool ris__measurer_has(const ris_measurer *measurer, ris_measure measure);
/* The same measures at rest, where they are absolute: what is hidden in the zero. */
const ris_finding *ris__measurer_rest(const ris_measurer *measurer, ris_measure measure);
/* Points (penetration), nodes or triangles that a measure looks at. */
uint32_t ris__measurer_tested(const ris_measurer *measurer, ris_measure measure);

/* Where the bones are: row-major 3x4 by ris_bone (JAW, EYE_L, EYE_R are read), as ris_sim_bone_transform writes. */
typedef struct ris_bone_frames {
    float bone[RIS_BONE_SKIN][12];
} ris_bone_frames;

/* Over many poses: where. The caller zeroes it; either may be NULL. */
typedef struct ris_measure_trace {
    float *
        worst; /* highest value at each node; an edge's is at both its ends (RIS_MEASURE_COUNT x node_count) */
    uint32_t *flipped; /* how often each triangle was turned over (triangle_count) */
} ris_measure_trace;

/* position: (node_count). out: RIS_MEASURE_COUNT, without MIRROR. With a node that is no number only FINITE is
 * measured. trace (may be NULL) is added to. */
ris_result ris__measure_pose(const ris_measurer *measurer, const ris_vec4 *position,
                             const ris_bone_frames *frames, ris_finding *out, ris_measure_trace *trace,
                             ris_error *err);

/* The pose of the mirrored face: .L and .R change places, and jaw.side, eye.yaw, head.yaw, head.roll and
 * head.x their sign. */
void ris__measure_mirror_pose(const ris_model *model, const float *pose, float *out);
/* Largest distance between the mirror image of position and mirrored. */
ris_finding ris__measure_mirror(const ris_measurer *measurer, const ris_vec4 *position,
                                const ris_vec4 *mirrored);
/* Nodes without a partner at the mirrored place of the rest pose; they are not compared. */
uint32_t ris__measurer_unpaired(const ris_measurer *measurer);

/* The smallest region that a vertex lies in besides the simulated one, or "". */
const char *ris__measure_region(const ris_model *model, uint32_t vertex);
