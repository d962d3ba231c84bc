/* The lining of the mouth (KA-48 names the mouth; the thesis does not say what its inside does). Mucosa is
 * loose: behind the edge of the lips it goes where they go, less with every millimetre. The nodes of
 * mouth_cavity are sorted into rings, counted from the lips; each takes the mean displacement of its
 * neighbours in the ring before, times what is left of it. */
#include "model_impl.h"
#include "vec3.h"

#include <stdlib.h>

#define REACH_MM 20.0f /* along the lining, from the edge of the lips to where they no longer move it */
#define NO_RING UINT32_MAX

typedef struct lining_bake {
    ris_model *model;
    const ris_mesh *skin;
    bool *inside, *lips;
    uint32_t *ring;         /* 0: edge of the lips (node_count) */
    float *along;           /* mm from the edge (node_count) */
    ris_lining_node *found; /* (node_count) */
} lining_bake;

static float left_over(float along_mm)
{
    const float s = f_clamp(along_mm / REACH_MM, 0.0f, 1.0f), bell = 1.0f - s * s;
    return bell * bell;
}

/* Calls visit for both directions of every edge of the skin's faces (quads: no diagonals). */
static void each_edge(lining_bake *b, void (*visit)(lining_bake *, uint32_t, uint32_t, uint32_t),
                      uint32_t ring)
{
    const ris_mesh *skin = b->skin;
    for (uint32_t f = 0; f < skin->face_count; ++f) {
        const uint32_t first = skin->face_start[f], end = skin->face_start[f + 1];
        for (uint32_t c = first; c < end; ++c) {
            const uint32_t v = skin->face_vertex[c], w = skin->face_vertex[c + 1 < end ? c + 1 : first];
            visit(b, v, w, ring);
            visit(b, w, v, ring);
        }
    }
}

static void find_edge_of_lips(lining_bake *b, uint32_t from, uint32_t to, uint32_t ring)
{
    if (b->lips[from] && !b->inside[from] && b->inside[to]) {
        b->ring[from] = ring;
    }
}

/* Next ring, with its sources in the ring before. */
static void grow(lining_bake *b, uint32_t from, uint32_t to, uint32_t ring)
{
    if (b->ring[from] != ring || !b->inside[to] || !(b->model->rest_position[to].w > 0.0f) ||
        (b->ring[to] != NO_RING && b->ring[to] != ring + 1)) {
        return;
    }
    ris_lining_node *node = &b->found[to];
    b->ring[to] = ring + 1;
    for (uint32_t k = 0; k < node->source_count; ++k) {
        if (node->source[k] == from) {
            return;
        }
    }
    if (node->source_count < RIS_LINING_SOURCES) {
        node->source[node->source_count++] = from;
    }
}

/* Distances of a ring; nodes beyond reach leave it. Appends the ring to the model, returns its size. */
static uint32_t settle_ring(lining_bake *b, uint32_t ring)
{
    ris_model *model = b->model;
    const uint32_t before = model->lining_count;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (b->ring[i] != ring) {
            continue;
        }
        ris_lining_node *node = &b->found[i];
        float along = 0.0f, left = 0.0f;
        for (uint32_t k = 0; k < node->source_count; ++k) {
            const uint32_t j = node->source[k];
            const float step = v3_distance(v4_xyz(model->rest_position[i]), v4_xyz(model->rest_position[j]));
            along += b->along[j] + step;
            left += left_over(b->along[j]);
        }
        b->along[i] = along / (float)node->source_count;
        if (!(b->along[i] < REACH_MM)) {
            b->ring[i] = NO_RING - 1;
            continue;
        }
        node->node = i;
        node->keep = left_over(b->along[i]) / left;
        model->lining[model->lining_count++] = *node;
    }
    return model->lining_count - before;
}

static ris_result alloc_lining_bake(lining_bake *b, ris_error *err)
{
    const uint32_t n = b->model->node_count;
    const struct {
        void *field;
        size_t size;
    } arrays[] = {
        {&b->inside, sizeof *b->inside}, {&b->lips, sizeof *b->lips},   {&b->ring, sizeof *b->ring},
        {&b->along, sizeof *b->along},   {&b->found, sizeof *b->found}, {&b->model->lining, sizeof *b->found},
    };
    ris_result result = RIS_OK;
    for (size_t k = 0; k < sizeof arrays / sizeof arrays[0] && result == RIS_OK; ++k) {
        result = ris__model_alloc(arrays[k].field, n, arrays[k].size, "the lining of the mouth", err);
    }
    return result;
}

ris_result ris__bake_lining(ris_bake *bake, ris_error *err)
{
    if (bake->head->tissue.model == RIS_TISSUE_KAEHLER) {
        return RIS_OK;
    }
    lining_bake b = {.model = bake->model, .skin = &bake->head->skin};
    ris_result result = alloc_lining_bake(&b, err);
    if (result == RIS_OK) {
        ris__region_flags(bake->head, "mouth_cavity", b.inside);
        ris__region_flags(bake->head, "lips", b.lips);
        for (uint32_t i = 0; i < b.model->node_count; ++i) {
            b.ring[i] = NO_RING;
        }
        each_edge(&b, find_edge_of_lips, 0);
        uint32_t ring = 0;
        do {
            each_edge(&b, grow, ring);
        } while (settle_ring(&b, ++ring) > 0);
    }
    free(b.inside);
    free(b.lips);
    free(b.ring);
    free(b.along);
    free(b.found);
    return result;
}
