/* The lining of the mouth over bone (KA-48 names the mouth; the thesis says nothing of its inside). Library of
 * risorius-lay-lining and of its test. mm; x to the subject's left, y up, z out of the face; the right half is the mirror
 * of the left. */
#pragma once

#include "query/query.h"

#include <stdbool.h>

#define LINING_NONE UINT32_MAX

enum { BODY_SKULL, BODY_MANDIBLE, BODY_UPPER, BODY_LOWER, BODY_TONGUE, BODY_COUNT };

/* The lining's mesh: rings from the lips inwards, columns in a ring from the middle of the upper lip to that of the lower
 * one. Zeroed is empty; lining_finish frees. */
typedef struct lining {
    const ris_head *head;
    const bvh *body;           /* (BODY_COUNT) */
    uint32_t count;            /* vertices of the skin */
    uint32_t *ring, *column;   /* 1.. in the lining, 0 = lips, LINING_NONE elsewhere; 0.. (count) */
    uint32_t *mirror;          /* vertex at (-x, y, z) (count) */
    bool *moves;               /* behind the rim of the lips (count) */
    bool *outside;             /* between teeth and lips or cheeks; else where the tongue is (count) */
    bool *border;              /* has a neighbour on the other side of the teeth (count) */
    uint32_t *start, *other;   /* CSR of neighbours along the edges of faces (count + 1) */
    dvec *from, *cast_at, *at; /* in the file; after the rays; now (count) */
    uint32_t edge_count;
    uint32_t (*edge)[2]; /* edges and both diagonals with a moving end, on the left */
} lining;

/* rings.c */
/* head and bodies (BODY_COUNT trees in the enum's order) must outlive the lining. */
ris_result lining_build(lining *l, const ris_head *head, const bvh *body, ris_error *err);
void lining_finish(lining *l);
/* Do neighbours a and b lie on one side of the teeth? Else the ridge that bears them stands between. */
bool lining_joined(const lining *l, uint32_t a, uint32_t b);

/* lay.c */
ris_result lining_lay(lining *l, ris_error *err);

typedef struct lining_report {
    double vertex_mm,
        midpoint_mm; /* least distance from bone and teeth, < 0 inside; of a midpoint of an edge between joined vertices */
    uint32_t vertex, edge[2]; /* where */
    uint32_t buried, buried_midpoints;
    double moved_mm; /* farthest */
} lining_report;

lining_report lining_measure(const lining *l);
