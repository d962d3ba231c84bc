/* KA-54: the visemes on the reference head, settled, are the mouths they stand for; KA-51, 52: in speech the lips close for
 * p, b and m between the widest vowels, when these sound. */
#include "loaded_head.h"

#include "anim/clip.h"

#include <math.h>

#define VISEMES 15
static const char *const name[VISEMES] = {"sil", "PP", "FF", "TH", "DD", "kk", "CH", "SS",
                                          "nn",  "RR", "aa", "E",  "I",  "O",  "U"};
enum { SIL, PP, FF, TH, DD, KK, CH, SS, NN, RR, AA, E, I, O, U };

/* mm; z forward */
typedef struct mouth {
    float open, open_most; /* height between the lips at the middle, and the most of it within 16 mm of it */
    float width;           /* between the corners */
    float upper_z, lower_z;
    float upper_y, lower_y; /* lower edge of the upper lip, upper edge of the lower lip */
    float tip_y, tip_z;     /* of the tongue in the frame of the jaw */
} mouth;

static bool *lips, *lower, *cavity;
static uint32_t *ring; /* of the lips, from their border inwards; 6 is where they meet */
static mouth shape[VISEMES];

static void flag(const char *region_name, bool *flags)
{
    const ris_region *region = ris_head_region(model->head, region_name);
    assert_non_null(region);
    for (uint32_t k = 0; k < region->count; ++k) {
        flags[region->vertex[k]] = true;
    }
}

/* One ring further: at 0 the nodes of the lips beside skin that is neither lip nor lining. */
static void grow_rings(uint32_t r)
{
    const ris_mesh *skin = &model->head->skin;
    for (uint32_t f = 0; f < skin->face_count; ++f) {
        const uint32_t first = skin->face_start[f], end = skin->face_start[f + 1];
        for (uint32_t c = first; c < end; ++c) {
            uint32_t edge[2] = {skin->face_vertex[c], skin->face_vertex[c + 1 < end ? c + 1 : first]};
            for (int way = 0; way < 2; ++way) {
                const uint32_t from = edge[way], to = edge[!way];
                if (r == 0 && lips[to] && !lips[from] && !cavity[from]) {
                    ring[to] = 0;
                } else if (r > 0 && ring[from] == r - 1 && ring[to] == UINT32_MAX && lips[to]) {
                    ring[to] = r;
                }
            }
        }
    }
}

/* Height between the lips among nodes that rest within half of at, mm. */
static float gap(float at, float half, mouth *out)
{
    mouth m = {.upper_y = 1e9f, .lower_y = -1e9f, .upper_z = -1e9f, .lower_z = -1e9f};
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (!lips[i] || fabsf(model->rest_position[i].x - at) > half) {
            continue;
        }
        if (lower[i]) {
            m.lower_y = f_max(m.lower_y, x[i].y);
            m.lower_z = f_max(m.lower_z, x[i].z);
        } else {
            m.upper_y = f_min(m.upper_y, x[i].y);
            m.upper_z = f_max(m.upper_z, x[i].z);
        }
    }
    if (out) {
        *out = m;
    }
    return m.upper_y - m.lower_y;
}

static void find_tongue(mouth *out)
{
    static ris_vec4 place[20000];
    for (uint32_t p = 0; p < model->head->part_count; ++p) {
        const ris_part_def *part = &model->head->part[p];
        if (part->material != RIS_MATERIAL_TONGUE) {
            continue;
        }
        assert_true(part->mesh.vertex_count <= 20000);
        const bool bent = ris_sim_part_shape(sim, p, place);
        out->tip_z = -1e9f;
        for (uint32_t i = 0; i < part->mesh.vertex_count; ++i) { /* the foremost point at rest is the tip */
            const ris_vec3 rest = part->mesh.position[i];
            if (rest.z > out->tip_z) {
                out->tip_z = rest.z;
                out->tip_y = (float)i;
            }
        }
        const uint32_t tip = (uint32_t)out->tip_y;
        const ris_vec3 now = bent ? v4_xyz(place[tip]) : part->mesh.position[tip];
        out->tip_y = now.y;
        out->tip_z = now.z;
    }
}

static mouth measure(void)
{
    mouth m;
    const float open = gap(0, 3, &m);
    m.open = open;
    m.open_most = 0;
    for (float at = -14; at <= 14; at += 4) {
        const float here = gap(at, 3, NULL);
        m.open_most = f_max(m.open_most, here);
    }
    float left = -1e9f, right = 1e9f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (ring[i] == 6) {
            left = f_max(left, x[i].x);
            right = f_min(right, x[i].x);
        }
    }
    m.width = left - right;
    find_tongue(&m);
    return m;
}

static int open_head(void **state)
{
    (void)state;
    if (load_head() != 0) {
        return -1;
    }
    lips = calloc(model->node_count, sizeof *lips);
    lower = calloc(model->node_count, sizeof *lower);
    cavity = calloc(model->node_count, sizeof *cavity);
    ring = malloc(model->node_count * sizeof *ring);
    memset(ring, 0xff, model->node_count * sizeof *ring);
    flag("lips", lips);
    flag("lip_lower", lower);
    flag("mouth_cavity", cavity);
    for (uint32_t r = 0; r <= 6; ++r) {
        grow_rings(r);
    }
    for (int v = 0; v < VISEMES; ++v) {
        char text[32];
        snprintf(text, sizeof text, "viseme.%s=1", name[v]);
        need(ris_pose_parse(model, text, pose, &err));
        settle();
        shape[v] = measure();
        print_message(
            "%-3s open %5.2f width %5.2f upper lip z %6.2f, %5.2f before the lower; tongue y %6.2f z %5.2f\n",
            name[v], (double)shape[v].open, (double)shape[v].width, (double)shape[v].upper_z,
            (double)(shape[v].upper_z - shape[v].lower_z), (double)shape[v].tip_y, (double)shape[v].tip_z);
    }
    return 0;
}

static int close_head(void **state)
{
    (void)state;
    free_head();
    free(lips);
    free(lower);
    free(cavity);
    free(ring);
    return 0;
}

/* a opens most, i is widest, u narrowest and most protruded. */
static void vowels_are_in_order(void **state)
{
    (void)state;
    for (int v = 0; v < VISEMES; ++v) {
        assert_true(v == AA || shape[v].open < shape[AA].open - 4);
        assert_true(v == I || shape[v].width < shape[I].width - 1.5f);
        assert_true(v == U || shape[v].width > shape[U].width + 1.5f);
        assert_true(v == U || shape[v].upper_z < shape[U].upper_z - 2);
    }
    assert_true(shape[AA].open > 14 && shape[U].open > 2 && shape[U].open < 7);
    assert_true(shape[I].width > shape[SIL].width + 4 && shape[U].width < shape[SIL].width - 9);
    assert_true(shape[U].upper_z > shape[SIL].upper_z + 6 && shape[U].lower_z > shape[SIL].lower_z + 6);
    assert_true(shape[AA].open > shape[E].open && shape[E].open > shape[I].open);
    assert_true(shape[O].open > shape[U].open + 3 && shape[O].width < shape[E].width - 6);
}

static void consonants_are_told_apart(void **state)
{
    (void)state;
    assert_true(shape[PP].open_most < 0.3f); /* closed from corner to corner */
    /* f: the upper lip before the lower, which covers the edges of the upper teeth 52.3 mm below the ears */
    assert_true(shape[FF].upper_z - shape[FF].lower_z > shape[SIL].upper_z - shape[SIL].lower_z + 0.5f);
    assert_true(shape[FF].open > 1.2f && shape[FF].open < 4 && shape[FF].lower_y > -52.3f);
    assert_true(shape[CH].upper_z > shape[SIL].upper_z + 3 && shape[CH].width < shape[SS].width - 6);
    assert_true(shape[SS].open < 4 && shape[CH].open < 5 && shape[SS].width > shape[SIL].width);
    /* the tongue: between the teeth for th, raised for t, n and r, low for a and k */
    const float incisor_z = model->head->jaw.incisor.z;
    assert_true(shape[TH].tip_z > incisor_z + 4);
    for (int v = 0; v < VISEMES; ++v) {
        assert_true(v == TH || shape[v].tip_z < incisor_z);
    }
    assert_true(shape[DD].tip_y > shape[SIL].tip_y + 3 && shape[NN].tip_y > shape[SIL].tip_y + 3 &&
                shape[RR].tip_y > shape[SIL].tip_y + 3);
    assert_true(shape[AA].tip_y < shape[SIL].tip_y && shape[KK].tip_y < shape[SIL].tip_y);
}

/* Plays phones and gives the height between the lips (within 12 mm of the middle) after each tick. */
static uint32_t play(const char *phones, float *open, uint32_t room)
{
    char text[2048];
    snprintf(text, sizeof text,
             "{\"format\":\"risorius-clip\",\"version\":1,\"duration_s\":1.6,\"layers\":[{\"speech\":[%s]}]}",
             phones);
    ris_clip *clip;
    need(ris__clip_parse(model, "t.json", text, strlen(text), &clip, &err));
    need(ris_sim_reset(sim, &err));
    const uint32_t count = (uint32_t)(ris_clip_duration_s(clip) / RIS_TICK_S + 0.5);
    assert_true(count < room);
    open[0] = 0;
    for (uint32_t k = 1; k <= count; ++k) {
        ris_clip_sample(clip, k * RIS_TICK_S, pose);
        need(ris_sim_tick(sim, pose, &err));
        need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
        open[k] = gap(0, 12, NULL);
    }
    ris_clip_destroy(clip);
    return count;
}

static float least(const float *open, double from_s, double to_s)
{
    float value = 1e9f;
    for (uint32_t k = (uint32_t)ceil(from_s * 60 - 1e-6); k <= (uint32_t)floor(to_s * 60 + 1e-6); ++k) {
        value = f_min(value, open[k]);
    }
    return value;
}

static float most(const float *open, double from_s, double to_s)
{
    float value = -1e9f;
    for (uint32_t k = (uint32_t)ceil(from_s * 60 - 1e-6); k <= (uint32_t)floor(to_s * 60 + 1e-6); ++k) {
        value = f_max(value, open[k]);
    }
    return value;
}

#define PHONE(symbol, t, end) "{\"phone\":\"" symbol "\",\"t\":" t ",\"end\":" end "}"
#define WORD(p, m, b)                                                                                        \
    PHONE("a", "0.30", "0.45")                                                                               \
    "," PHONE(p, "0.45", "0.54") "," PHONE("a", "0.54", "0.68") "," PHONE(m, "0.68", "0.75") "," PHONE(      \
        "a", "0.75", "0.86") "," PHONE(b, "0.86", "0.92") "," PHONE("a", "0.92", "1.10")

static void lips_close_for_bilabials(void **state)
{
    (void)state;
    static float open[120];
    const double frame = RIS_TICK_S;
    play(WORD("p", "m", "b"), open, 120);
    static const double middle[] = {0.495, 0.715, 0.89};
    for (int k = 0; k < 3; ++k) {
        const float closed = least(open, middle[k] - frame, middle[k] + frame);
        print_message("closure at %.3f s: %.2f mm\n", middle[k], (double)closed);
        assert_true(closed < 0.3f);
    }
    assert_true(most(open, 0.35, 0.45) > 12 && most(open, 0.54, 0.68) > 8 && most(open, 0.75, 0.86) > 3 &&
                most(open, 0.92, 1.1) > 12);
    assert_true(most(open, 1.35, 1.6) < 0.6f); /* the mouth is shut again */
    play(WORD("t", "n", "d"), open, 120);      /* control: the tongue's consonants leave the lips open */
    for (int k = 0; k < 3; ++k) {
        assert_true(least(open, middle[k] - frame, middle[k] + frame) > 4);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vowels_are_in_order),
        cmocka_unit_test(consonants_are_told_apart),
        cmocka_unit_test(lips_close_for_bilabials),
    };
    return cmocka_run_group_tests(tests, open_head, close_head);
}
