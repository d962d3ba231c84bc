/* engine/measure against hand-made cases: depths in solids, skin in moving bone, lip in lip, triangles turned over,
 * mirror images. Each measure first finds nothing where there is nothing, then what was put there. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "fake_model.h"
#include "measure/measure.h"
#include "measure/solid.h"
#include "mesh_head.h"

#include <math.h>

#define assert_mm(a, b) assert_float_equal((float)(a), (float)(b), 1e-4f)

static ris_error err;
static ris_bone_frames frames;
static ris_finding found[RIS_MEASURE_COUNT];

static void need(ris_result result)
{
    if (result != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

static int frames_at_rest(void **state)
{
    (void)state;
    for (int b = 0; b < RIS_BONE_SKIN; ++b) {
        for (int k = 0; k < 12; ++k) {
            frames.bone[b][k] = k % 5 == 0 ? 1.0f : 0.0f;
        }
    }
    return 0;
}

/* Text of an OBJ box from low to high; first = number of vertices before it; the top (y) may be missing. */
static void box(char *out, size_t size, const float low[3], const float high[3], int first, bool top,
                bool inward)
{
    static const int face[6][4] = {{1, 4, 3, 2}, {5, 6, 7, 8}, {1, 2, 6, 5},
                                   {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}};
    size_t used = strlen(out);
    for (int v = 0; v < 8; ++v) {
        const bool right = v % 4 == 1 || v % 4 == 2, back = v % 4 >= 2;
        /* z runs down along the first four so that face 1 looks down y */
        used += (size_t)snprintf(out + used, size - used, "v %g %g %g\n", (double)(right ? high[0] : low[0]),
                                 (double)(v < 4 ? low[1] : high[1]), (double)(back ? low[2] : high[2]));
    }
    for (int f = 0; f < 6; ++f) {
        if (f == 1 && !top) {
            continue;
        }
        const int *c = face[f];
        used += (size_t)snprintf(out + used, size - used, "f %d %d %d %d\n", first + c[0],
                                 first + c[inward ? 3 : 1], first + c[2], first + c[inward ? 1 : 3]);
    }
}

static ris_mesh mesh_of(const char *text)
{
    ris_mesh mesh;
    need(ris_mesh_parse_obj("test", text, strlen(text), &mesh, &err));
    return mesh;
}

static ris_solids solids_of(const char *text, const dvec *apex)
{
    ris_solids solids = {0};
    ris_mesh mesh = mesh_of(text);
    need(ris__solids_add(&solids, &mesh, apex, "test", &err));
    ris_mesh_finish(&mesh);
    return solids;
}

static double depth(const ris_solids *solids, double x, double y, double z)
{
    uint32_t solid;
    return ris__solids_depth(solids, dv(x, y, z), &solid);
}

static const float zero[3] = {0, 0, 0}, ten[3] = {10, 10, 10};

/* Depth in a cube is the distance to its nearest side, whichever way its faces look, on 9 x 9 x 9 places, among
 * them such that the rays meet edges. */
static void depth_in_a_cube(void **state)
{
    (void)state;
    for (int inward = 0; inward < 2; ++inward) {
        char text[1024] = "";
        box(text, sizeof text, zero, ten, 0, true, inward);
        ris_solids solids = solids_of(text, NULL);
        assert_int_equal(solids.count, 1);
        for (int i = 0; i < 729; ++i) {
            const double p[3] = {-1.5 + 1.625 * (i % 9), -1.5 + 1.625 * (i / 9 % 9), -1.5 + 1.625 * (i / 81)};
            double expected = 100;
            for (int k = 0; k < 3; ++k) {
                expected = fmin(expected, fmin(p[k], 10 - p[k]));
            }
            assert_mm(depth(&solids, p[0], p[1], p[2]), fmax(expected, 0));
        }
        assert_mm(depth(&solids, 5, 5, 3), 3);
        assert_mm(depth(&solids, 5, 5, -3), 0);
        assert_mm(ris__solids_clearance(&solids, dv(13, 14, 5)), 5);
        ris__solids_finish(&solids);
    }
}

/* Two cubes of one mesh that overlap by 4: inside both the depth is the deeper one, not 0 as by parity, and not that
 * to a wall inside the other. */
static void components_count_apart(void **state)
{
    (void)state;
    const float low[3] = {6, 0, 0}, high[3] = {16, 10, 10}, far_low[3] = {40, 0, 0}, far_high[3] = {44, 4, 4};
    char text[4096] = "";
    uint32_t solid = 9;
    box(text, sizeof text, zero, ten, 0, true, false);
    box(text, sizeof text, low, high, 8, true, false);
    box(text, sizeof text, far_low, far_high, 16, true, true);
    ris_solids solids = solids_of(text, NULL);
    assert_int_equal(solids.count, 3);
    assert_mm(depth(&solids, 8, 5, 5), 2);
    assert_mm(depth(&solids, 7, 5, 5), 3);
    assert_mm(depth(&solids, 12, 5, 5), 4);
    assert_mm(ris__solids_depth(&solids, dv(42, 1, 2), &solid), 1);
    assert_int_equal(solid, 2);
    ris__solids_finish(&solids);
}

/* A cube without its top is closed for the rays, but its lid is no surface to be near to. */
static void holes_are_capped(void **state)
{
    (void)state;
    char text[1024] = "";
    const dvec above = dv(5, 16, 5);
    box(text, sizeof text, zero, ten, 0, false, false);
    ris_solids solids = solids_of(text, NULL);
    assert_mm(depth(&solids, 5, 9.5, 5), 5);
    assert_mm(depth(&solids, 5, 10.5, 5), 0);
    ris__solids_finish(&solids);
    solids = solids_of(text, &above); /* a roof to the apex: half way up it is half as wide */
    assert_mm(depth(&solids, 5, 13, 5), sqrt(25 + 9));
    assert_mm(depth(&solids, 1, 13, 5), 0);
    ris__solids_finish(&solids);
}

/* n x n vertices in the plane z = 0, spacing mm apart, facing +z. */
static ris_head grid_head(uint32_t n, float spacing)
{
    ris_vec3 *p = malloc(n * n * sizeof *p);
    uint32_t *corners = malloc(n * n * sizeof *corners), *v = malloc(4 * n * n * sizeof *v), faces = 0;
    for (uint32_t i = 0; i < n * n; ++i) {
        p[i] = (ris_vec3){spacing * (float)(i % n), spacing * (float)(i / n), 0};
    }
    for (uint32_t i = 0; i < n * (n - 1); ++i) {
        if (i % n + 1 < n) {
            const uint32_t quad[4] = {i, i + 1, i + n + 1, i + n};
            memcpy(v + 4 * faces, quad, sizeof quad);
            corners[faces++] = 4;
        }
    }
    ris_head head = mesh_head(n * n, p, faces, corners, v, NULL);
    free(p);
    free(corners);
    free(v);
    return head;
}

typedef struct bench {
    ris_model *model;
    ris_measurer *measurer;
    ris_vec4 *x;
} bench;

static bench open_bench(const ris_head *head)
{
    bench b = {0};
    need(ris_model_create(head, &b.model, &err));
    need(ris__measurer_create(b.model, &b.measurer, &err));
    b.x = malloc(b.model->node_count * sizeof *b.x);
    memcpy(b.x, b.model->rest_position, b.model->node_count * sizeof *b.x);
    return b;
}

static void close_bench(bench *b, ris_head *head)
{
    free(b->x);
    ris__measurer_destroy(b->measurer);
    ris_model_destroy(b->model);
    ris_head_finish(head);
}

static const ris_finding *measure(const bench *b, ris_measure which)
{
    need(ris__measure_pose(b->measurer, b->x, &frames, found, NULL, &err));
    return &found[which];
}

/* 3 x 3 vertices 10 mm apart, a block of bone from z = -2 down under them and another, of the jaw, from -4 down. */
static ris_head bone_head(void)
{
    ris_head head = grid_head(3, 10);
    char text[1024] = "";
    box(text, sizeof text, (const float[3]){-50, -50, -40}, (const float[3]){70, 70, -2}, 0, true, false);
    head.skull = mesh_of(text);
    text[0] = '\0';
    box(text, sizeof text, (const float[3]){-50, -50, -40}, (const float[3]){70, 70, -4}, 0, true, false);
    head.mandible = mesh_of(text);
    return head;
}

static void skin_in_bone(void **state)
{
    (void)state;
    ris_head head = bone_head();
    bench b = open_bench(&head);
    assert_true(ris__measurer_has(b.measurer, RIS_MEASURE_SKULL));
    assert_false(ris__measurer_has(b.measurer, RIS_MEASURE_EYES));
    assert_int_equal(ris__measurer_tested(b.measurer, RIS_MEASURE_SKULL), 9);
    assert_int_equal(ris__measurer_tested(b.measurer, RIS_MEASURE_SKULL_MIDPOINT), 16);
    for (int m = 0; m < RIS_MEASURE_COUNT; ++m) {
        assert_mm(measure(&b, (ris_measure)m)->value, 0);
    }
    b.x[4].z = -3; /* 1 mm into the skull; the middles of its edges are at -1.5 */
    assert_mm(measure(&b, RIS_MEASURE_SKULL)->value, 1);
    assert_int_equal(found[RIS_MEASURE_SKULL].vertex_count, 1);
    assert_int_equal(found[RIS_MEASURE_SKULL].vertex[0], 4);
    assert_int_equal(found[RIS_MEASURE_SKULL].count, 1);
    assert_string_equal(found[RIS_MEASURE_SKULL].part, "skull");
    assert_mm(found[RIS_MEASURE_SKULL_MIDPOINT].value, 0);
    assert_mm(found[RIS_MEASURE_MANDIBLE].value, 0);
    b.x[4].z = -6;
    assert_mm(measure(&b, RIS_MEASURE_SKULL)->value, 4);
    assert_mm(found[RIS_MEASURE_SKULL_MIDPOINT].value, 1);
    assert_int_equal(found[RIS_MEASURE_SKULL_MIDPOINT].vertex_count, 2);
    assert_mm(found[RIS_MEASURE_MANDIBLE].value, 2);
    float *worst = calloc((size_t)RIS_MEASURE_COUNT * 9, sizeof *worst);
    ris_measure_trace trace = {.worst = worst};
    need(ris__measure_pose(b.measurer, b.x, &frames, found, &trace, &err));
    assert_mm(worst[9 * RIS_MEASURE_SKULL + 4], 4);
    assert_mm(worst[9 * RIS_MEASURE_SKULL + 1], 0);
    assert_mm(worst[9 * RIS_MEASURE_SKULL_MIDPOINT + 4], 1);
    assert_mm(worst[9 * RIS_MEASURE_SKULL_MIDPOINT + 1], 1); /* the other end of its edge */
    free(worst);
    b.x[4].z = NAN;
    assert_mm(measure(&b, RIS_MEASURE_FINITE)->value, 1);
    assert_int_equal(found[RIS_MEASURE_FINITE].vertex[0], 4);
    close_bench(&b, &head);
}

/* The jaw comes up by 7 mm: its block is 3 mm into skin that did not move. Turned by a right angle about x, the block's
 * side that was at y = -50 comes to z = -50 x -1. */
static void bone_in_skin(void **state)
{
    (void)state;
    ris_head head = bone_head();
    bench b = open_bench(&head);
    float *jaw = frames.bone[RIS_BONE_JAW];
    jaw[11] = 7;
    assert_mm(measure(&b, RIS_MEASURE_MANDIBLE)->value, 3);
    assert_int_equal(found[RIS_MEASURE_MANDIBLE].count, 9);
    assert_mm(found[RIS_MEASURE_SKULL].value, 0);
    /* y' = -z, z' = y: what lay from -4 down in z now lies from 4 up in y; of the rows at y = 0, 10, 20 the last two
     * are in by 6 and 16 */
    const float turned[12] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0};
    memcpy(jaw, turned, sizeof turned);
    assert_mm(measure(&b, RIS_MEASURE_MANDIBLE)->value, 16);
    assert_int_equal(found[RIS_MEASURE_MANDIBLE].count, 6);
    frames_at_rest(NULL);
    close_bench(&b, &head);
}

/* What is inside at rest is the zero, told apart, and every bit beyond it counts. */
static void rest_is_the_zero(void **state)
{
    (void)state;
    ris_head head = bone_head();
    for (uint32_t v = 0; v < head.skull.vertex_count; ++v) {
        head.skull.position[v].z += head.skull.position[v].z > -10 ? 3 : 0; /* the top is at z = 1 now */
    }
    bench b = open_bench(&head);
    assert_mm(ris__measurer_rest(b.measurer, RIS_MEASURE_SKULL)->value, 1);
    assert_int_equal(ris__measurer_rest(b.measurer, RIS_MEASURE_SKULL)->count, 9);
    assert_mm(measure(&b, RIS_MEASURE_SKULL)->value, 0);
    b.x[4].z = -0.25f;
    assert_mm(measure(&b, RIS_MEASURE_SKULL)->value, 0.25);
    close_bench(&b, &head);
}

/* Crowns of the upper jaw and an eye open at its back with a cornea before it are found by material and bone. */
static void parts_are_found(void **state)
{
    (void)state;
    ris_head head = grid_head(3, 10);
    char text[4096] = "";
    head.part = calloc(3, sizeof *head.part);
    head.part_count = 3;
    box(text, sizeof text, (const float[3]){-20, 0, -9}, (const float[3]){-16, 4, -5}, 0, true, false);
    box(text, sizeof text, (const float[3]){8, 8, -9}, (const float[3]){12, 12, -5}, 8, true, false);
    head.part[0] = (ris_part_def){.name = "crowns", .bone = RIS_BONE_SKULL, .material = RIS_MATERIAL_TEETH};
    head.part[0].mesh = mesh_of(text);
    text[0] = '\0';
    box(text, sizeof text, (const float[3]){-5, -5, -30}, (const float[3]){5, 5, -20}, 0, false, false);
    head.part[1] = (ris_part_def){.name = "ball", .bone = RIS_BONE_EYE_L, .material = RIS_MATERIAL_EYE};
    head.part[1].mesh = mesh_of(text);
    head.part[2] = (ris_part_def){.name = "dome", .bone = RIS_BONE_EYE_L, .material = RIS_MATERIAL_CORNEA};
    head.part[2].mesh = mesh_of("v -4 -4 -18\nv 4 -4 -18\nv 4 4 -18\nv -4 4 -18\nf 1 2 3 4\n");
    head.part[2].pivot = (ris_vec3){0, 0, -25};
    bench b = open_bench(&head);
    b.x[4].z = -6.5f; /* 1.5 mm into the second crown */
    assert_mm(measure(&b, RIS_MEASURE_UPPER_TEETH)->value, 1.5);
    assert_string_equal(found[RIS_MEASURE_UPPER_TEETH].part, "crowns");
    assert_int_equal(found[RIS_MEASURE_UPPER_TEETH].piece, 2);
    assert_mm(found[RIS_MEASURE_EYES].value, 0);
    b.x[0].z = -19; /* behind the cornea, before the ball */
    assert_mm(measure(&b, RIS_MEASURE_EYES)->value, 1);
    assert_string_equal(found[RIS_MEASURE_EYES].part, "dome");
    frames.bone[RIS_BONE_EYE_L][11] = -4; /* the eye sinks away */
    assert_mm(measure(&b, RIS_MEASURE_EYES)->value, 0);
    frames_at_rest(NULL);
    close_bench(&b, &head);
}

static void add_region(ris_head *head, const char *name, uint32_t first, uint32_t count)
{
    head->region = realloc(head->region, (head->region_count + 1) * sizeof *head->region);
    ris_region *region = &head->region[head->region_count++];
    *region = (ris_region){.count = count, .vertex = malloc(count * sizeof(uint32_t))};
    snprintf(region->name, sizeof region->name, "%s", name);
    for (uint32_t k = 0; k < count; ++k) {
        region->vertex[k] = first + k;
    }
}

/* Two sheets of 5 x 5 vertices 2 mm apart: the lower lip at y = 0 looks up, the upper at y = 1 down; faces of the upper
 * are turned if it looks the wrong way. */
static ris_head lips_head(bool wrong)
{
    ris_vec3 p[50];
    uint32_t corners[32], v[128], used = 0;
    for (uint32_t i = 0; i < 50; ++i) {
        p[i] = (ris_vec3){2.0f * (float)(i % 5), i < 25 ? 0.0f : 1.0f, -2.0f * (float)(i % 25 / 5)};
    }
    for (uint32_t s = 0; s < 2; ++s) {
        for (uint32_t i = 0; i < 20; ++i) {
            if (i % 5 < 4) {
                const uint32_t a = 25 * s + i, quad[4] = {a, a + 1, a + 6, a + 5};
                const bool turned = s == 1 && !wrong;
                for (int k = 0; k < 4; ++k) {
                    v[4 * used + (uint32_t)k] = quad[turned ? 3 - k : k];
                }
                corners[used++] = 4;
            }
        }
    }
    ris_head head = mesh_head(50, p, used, corners, v, NULL);
    add_region(&head, "lip_lower", 0, 25);
    add_region(&head, "lip_upper", 25, 25);
    return head;
}

static void lip_in_lip(void **state)
{
    (void)state;
    ris_head head = lips_head(false);
    bench b = open_bench(&head);
    assert_int_equal(ris__measurer_tested(b.measurer, RIS_MEASURE_LIPS), 50);
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0);
    b.x[37].y = -0.75f; /* the middle of the upper lip */
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0.75);
    assert_int_equal(found[RIS_MEASURE_LIPS].vertex[0], 37);
    assert_string_equal(found[RIS_MEASURE_LIPS].part, "lip_lower");
    for (uint32_t i = 25; i < 50; ++i) {
        b.x[i].y = -2;
    }
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 2);
    for (uint32_t i = 25; i < 50; ++i) {
        b.x[i].y = -6; /* too deep to be a lip */
    }
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0);
    memcpy(b.x, b.model->rest_position, 50 * sizeof *b.x);
    b.x[29].y = -0.75f; /* a corner of the sheet, moved past the border of the other: beside it, not in it */
    b.x[29].x = 9;
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0);
    close_bench(&b, &head);
    head = lips_head(true); /* two sheets that look the same way are no lips that meet */
    b = open_bench(&head);
    b.x[37].y = -0.75f;
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0);
    close_bench(&b, &head);
}

/* A ridge in the lower lip: above it the normals of its flanks alone would say "behind" for one of the two. */
static void behind_a_ridge(void **state)
{
    (void)state;
    ris_head head = lips_head(false);
    bench b = open_bench(&head);
    for (uint32_t i = 0; i < 25; ++i) {
        b.x[i].y = -2.0f * fabsf(b.x[i].x - 4.0f); /* ridge at x = 4, flanks of 63 degrees */
        b.x[25 + i].y += 20;
    }
    b.x[37] = (ris_vec4){4.1f, 0.3f, -4, b.x[37].w}; /* above the ridge, a little to one side */
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0);
    b.x[37].x = 4; /* 0.3 below the ridge the nearest flank is 0.3 cos(63) away */
    b.x[37].y = -0.3f;
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0.3 / sqrt(5));
    close_bench(&b, &head);
}

/* One crumpled triangle at the end of a sheet shows its back to everything before it; the sheet as a whole does not. */
static void before_a_crumpled_sheet(void **state)
{
    (void)state;
    ris_head head = lips_head(false);
    bench b = open_bench(&head);
    for (uint32_t i = 25; i < 50; ++i) {
        b.x[i].y += 20;
    }
    b.x[12].y =
        1; /* a fold in the middle of the lower lip: its tip leans over the neighbour and looks down */
    b.x[12].x += 3;
    b.x[37] = (ris_vec4){8.6f, 0.95f, -4, b.x[37].w}; /* before the tip */
    assert_mm(measure(&b, RIS_MEASURE_LIPS)->value, 0);
    b.x[37] = (ris_vec4){4, -0.5f, -4, b.x[37].w}; /* still found behind the sheet */
    assert_true(measure(&b, RIS_MEASURE_LIPS)->value > 0.2);
    close_bench(&b, &head);
}

/* Signed area in the plane: an independent witness for the flat grid. */
static uint32_t turned_in_plane(const bench *b)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < b->model->triangle_count; ++t) {
        const uint32_t *v = b->model->triangle + 3 * (size_t)t;
        const ris_vec4 p = b->x[v[0]], q = b->x[v[1]], r = b->x[v[2]];
        count += (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) < 0;
    }
    return count;
}

static void triangles_turned_over(void **state)
{
    (void)state;
    ris_head head = grid_head(7, 10);
    add_region(&head, "lips", 24, 1); /* the middle: its triangles are lip, all others are not */
    bench b = open_bench(&head);
    const uint32_t lip = ris__measurer_tested(b.measurer, RIS_MEASURE_FLIPPED);
    assert_in_range(lip, 4, 8);
    assert_int_equal(lip + ris__measurer_tested(b.measurer, RIS_MEASURE_FLIPPED_OTHER), 72);
    assert_mm(measure(&b, RIS_MEASURE_FLIPPED)->value, 0);
    b.x[24].x += 15; /* across the edges 5 mm before its neighbours' far side */
    const uint32_t turned = turned_in_plane(&b);
    uint32_t *often = calloc(b.model->triangle_count, sizeof *often), sum = 0;
    ris_measure_trace trace = {.flipped = often};
    assert_in_range(turned, 2, 4);
    need(ris__measure_pose(b.measurer, b.x, &frames, found, &trace, &err));
    assert_mm(found[RIS_MEASURE_FLIPPED].value, turned);
    assert_int_equal(found[RIS_MEASURE_FLIPPED].vertex_count, 3);
    assert_mm(found[RIS_MEASURE_FLIPPED_OTHER].value, 0);
    for (uint32_t t = 0; t < b.model->triangle_count; ++t) {
        sum += often[t];
    }
    assert_int_equal(sum, turned);
    free(often);
    for (uint32_t i = 0; i < 49; ++i) { /* all of it upside down is nothing turned over */
        b.x[i] = b.model->rest_position[i];
        b.x[i].x *= -1;
        b.x[i].z = 3;
    }
    assert_mm(measure(&b, RIS_MEASURE_FLIPPED)->value + found[RIS_MEASURE_FLIPPED_OTHER].value, 0);
    close_bench(&b, &head);
}

static void turned_over_at_rest(void **state)
{
    (void)state;
    ris_head head = grid_head(7, 10);
    head.skin.position[24].x += 15;
    add_region(&head, "lips", 24, 1);
    bench b = open_bench(&head);
    assert_mm(measure(&b, RIS_MEASURE_FLIPPED)->value, 0);
    assert_mm(ris__measurer_rest(b.measurer, RIS_MEASURE_FLIPPED)->value, turned_in_plane(&b));
    close_bench(&b, &head);
}

static void mirrored_poses(void **state)
{
    (void)state;
    const float pose[FAKE_COUNT] = {0.25f, 0.5f, 0, 1, 0.75f, 0.125f, 0.5f, 10, -20};
    const float expected[FAKE_COUNT] = {0.5f, 0.25f, 1, 0, 0.75f, 0.125f, -0.5f, 20, -10};
    float out[FAKE_COUNT], back[FAKE_COUNT];
    ris__measure_mirror_pose(&fake_model, pose, out);
    assert_memory_equal(out, expected, sizeof out);
    ris__measure_mirror_pose(&fake_model, out, back);
    assert_memory_equal(back, pose, sizeof back);
}

static void mirrored_skins(void **state)
{
    (void)state;
    ris_head head = grid_head(3, 10);
    for (uint32_t i = 0; i < 9; ++i) {
        head.skin.position[i].x -= 10;
    }
    head.skin.position[8].y += 1; /* has no partner now, nor has vertex 6 */
    bench b = open_bench(&head);
    ris_vec4 other[9];
    memcpy(other, b.x, sizeof other);
    assert_int_equal(ris__measurer_unpaired(b.measurer), 2);
    b.x[3] = (ris_vec4){-11, 12, 5, 0};
    other[5] = (ris_vec4){11, 12, 5, 0};
    assert_mm(ris__measure_mirror(b.measurer, b.x, other).value, 0);
    other[5].y += 3;
    other[5].x += 4;
    const ris_finding f = ris__measure_mirror(b.measurer, b.x, other);
    assert_mm(f.value, 5);
    assert_int_equal(f.vertex[0], 3);
    close_bench(&b, &head);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depth_in_a_cube),       cmocka_unit_test(components_count_apart),
        cmocka_unit_test(holes_are_capped),      cmocka_unit_test(skin_in_bone),
        cmocka_unit_test(bone_in_skin),          cmocka_unit_test(rest_is_the_zero),
        cmocka_unit_test(parts_are_found),       cmocka_unit_test(lip_in_lip),
        cmocka_unit_test(behind_a_ridge),        cmocka_unit_test(before_a_crumpled_sheet),
        cmocka_unit_test(triangles_turned_over), cmocka_unit_test(turned_over_at_rest),
        cmocka_unit_test(mirrored_poses),        cmocka_unit_test(mirrored_skins),
    };
    return cmocka_run_group_tests(tests, frames_at_rest, NULL);
}
