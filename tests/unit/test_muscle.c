/* The host muscle stages against hand-computed numbers: KA-05, 27, 30, 31, 32, 33, 35, 36, 37 and the lip
 * drag. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh_head.h"
#include "model/model_impl.h"
#include "model/vec3.h"
#include "scenes/scenes.h"
#include "sim/rig.h"

#define assert_near(a, b, tolerance) assert_float_equal((float)(a), (float)(b), (float)(tolerance))

static void assert_point(ris_vec3 a, float x, float y, float z, float tolerance)
{
    assert_near(a.x, x, tolerance);
    assert_near(a.y, y, tolerance);
    assert_near(a.z, z, tolerance);
}

static float polyline(const ris_vec3 *p, uint32_t n)
{
    float length = 0.0f;
    for (uint32_t i = 1; i < n; ++i) {
        length += v3_distance(p[i], p[i - 1]);
    }
    return length;
}

static void jaw_rotation(void **state) /* KA-05 */
{
    (void)state;
    const ris_vec3 origin = {0, 0, 0}, axis = {1, 0, 0};
    ris_rigid jaw = ris__rigid_turn(origin, axis, 15.0 * 3.14159265358979323846 / 180.0);
    assert_point(ris__rigid_apply(&jaw, v3(0, -60, 90)), 0.0f, -81.249f, 71.404f, 1e-3f);
    jaw = ris__rigid_turn(v3(0, 5, 10), axis, 15.0 * 3.14159265358979323846 / 180.0);
    assert_point(ris__rigid_apply(&jaw, v3(0, -55, 100)), 0.0f, -76.249f, 81.404f, 1e-3f);
    jaw = ris__rigid_turn(origin, v3(0, 1, 0), 3.14159265358979323846 / 2.0);
    assert_point(ris__rigid_apply(&jaw, v3(0, 0, 1)), 1.0f, 0.0f, 0.0f,
                 1e-6f); /* a yaw of 90 degrees looks to the left */
    jaw = ris__rigid_turn(origin, axis, 0.0);
    assert_true(jaw.identity && jaw.rotation[0] == 1.0f && jaw.rotation[5] == 0.0f &&
                jaw.rotation[8] == 1.0f);
}

static const ris_vec3 bent[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 2, 0}};

static void linear_contraction(void **state) /* KA-31 */
{
    (void)state;
    ris_vec3 q[4];
    ris__contract_linear(bent, 4, 0.5f, q);
    assert_point(q[0], 0, 0, 0, 0);
    assert_point(q[1], 0.5f, 0, 0, 1e-6f);
    assert_point(q[2], 1, 0, 0, 1e-6f);
    assert_point(q[3], 1, 0.5f, 0, 1e-6f);
    assert_near(polyline(q, 4), 1.5, 1e-6);
    ris__contract_linear(bent, 4, 0.25f, q);
    assert_point(q[1], 0.75f, 0, 0, 1e-6f);
    assert_point(q[2], 1, 0.5f, 0, 1e-6f);
    assert_point(q[3], 1, 1.25f, 0, 1e-6f);
    assert_near(polyline(q, 4), 2.0590, 1e-4);
    ris__contract_about(bent, 4, 0.5f, 1.0f / 3.0f, q); /* held at the second point: both ends move */
    assert_point(q[0], 0.5f, 0, 0, 1e-6f);
    assert_point(q[1], 1, 0, 0, 1e-6f);
    assert_point(q[2], 1, 0.5f, 0, 1e-6f);
    assert_point(q[3], 1, 1, 0, 1e-6f);
    ris__contract_linear(bent, 4, 0.9f, q);
    assert_near(polyline(q, 4), 0.3, 1e-6);
    ris__contract_linear(bent, 4, 0.0f, q);
    assert_memory_equal(q, bent, sizeof q);
    float before = 3.0f;
    for (int k = 1; k <= 95; ++k) { /* monotone, never collapsed, fixed end stays */
        ris__contract_linear(bent, 4, (float)k / 100.0f, q);
        const float length = polyline(q, 4);
        assert_true(length <= before + 1e-6f && length > 0.0f);
        assert_point(q[0], 0, 0, 0, 0);
        for (int i = 0; i < 4; ++i) { /* every point on the old polygon */
            assert_true(q[i].y == 0.0f ? q[i].x <= 1.0f : fabsf(q[i].x - 1.0f) < 1e-6f && q[i].y <= 2.0f);
        }
        before = length;
    }
}

/* Fibre (0,0,0) (0,-3,4) (0,0,8): 10 long, its middle half way; a share of 0.5 takes it half the way to (0,0,4). */
static void a_bowstring_straightens(void **state)
{
    (void)state;
    ris_vec3 q[4] = {{0, 0, 0}, {0, -3, 4}, {0, 0, 8}, {0, 0, 8}};
    ris__bowstring(3, 0.0f, q);
    assert_point(q[1], 0, -3, 4, 0);
    ris__bowstring(3, 0.5f, q);
    assert_point(q[0], 0, 0, 0, 0);
    assert_point(q[1], 0, -1.5f, 4, 1e-5f);
    assert_point(q[2], 0, 0, 8, 0);
    ris__bowstring(3, 1.0f, q);
    assert_point(q[1], 0, 0, 4, 1e-5f);
    ris_vec3 crooked[4] = {
        {0, 0, 0}, {0, -2, 0}, {0, -2, 6}, {0, 0, 6}}; /* a fifth and four fifths of the length */
    ris__bowstring(4, 1.0f, crooked);
    assert_point(crooked[1], 0, 0, 1.2f, 1e-5f);
    assert_point(crooked[2], 0, 0, 4.8f, 1e-5f);
}

static void sphincter_contraction(void **state) /* KA-32 */
{
    (void)state;
    const ris_vec3 p = {20, 0, 0}, a0 = {0, 0, -10}, a1 = {0, 0, 10};
    assert_point(ris__contract_sphincter(p, a0, a1, 1, 0, 3, 0.25f), 15, 0, 0, 1e-5f);
    assert_point(ris__contract_sphincter(p, a0, a1, 1, 1, 3, 0.25f), 15, 0, 1.25f, 1e-5f);
    assert_point(ris__contract_sphincter(p, a0, a1, 1, 2, 3, 0.25f), 15, 0, 2.5f, 1e-5f);
    assert_point(ris__contract_sphincter(p, a0, a1, 1, 2, 3, 1), 0, 0, 10, 1e-5f);
    assert_point(ris__contract_sphincter(p, a0, a1, 0, 2, 3, 0.25f), 15, 0, -2.5f,
                 1e-5f); /* a moves z alone */
    assert_point(ris__contract_sphincter(p, a0, a0, 1, 0, 1, 0.5f), 10, 0, -5,
                 1e-5f); /* no axis: towards its point */
}

static void slit_contraction(void **state)
{
    (void)state;
    const ris_vec3 a0 = {-10, 0, 2}, a1 = {10, 0, 2};
    assert_point(ris__contract_slit(v3(5, 8, 2), a0, a1, 0.25f), 5, 6, 2, 1e-5f); /* across the slit */
    assert_point(ris__contract_slit(v3(-5, -8, 6), a0, a1, 0.5f), -5, -4, 4, 1e-5f);
    assert_point(ris__contract_slit(v3(14, 4, 2), a0, a1, 0.25f), 13, 3, 2, 1e-5f); /* beyond: to its end */
    assert_point(ris__contract_slit(v3(10, 0, 2), a0, a1, 0.3f), 10, 0, 2, 1e-5f);  /* the corner stays */
    assert_point(ris__contract_slit(v3(4, 0, 0), a0, a0, 0.5f), -3, 0, 1, 1e-5f);   /* no axis: its point */
}

static void group_resolution(void **state) /* KA-33 */
{
    (void)state;
    const float c[2] = {1, 0}, none[2] = {0, 0}, distance[2] = {0.1f, 0.1f};
    const ris_vec3 rest[2] = {{-0.1f, 0, 0}, {0.1f, 0, 0}};
    ris_vec3 q[2] = {{0, 0, 0}, {1, 0, 0}};
    assert_near(ris__resolve_group(2, c, distance, rest, 30, q).x, 0.03125, 1e-6);
    assert_near(q[0].x, -0.06875, 1e-6);
    assert_near(q[1].x, 0.13125, 1e-6);
    assert_near(fabsf(q[0].x - 0.03125f), 0.1, 1e-5); /* both at their rest distance from the centroid */
    assert_near(fabsf(q[1].x - 0.03125f), 0.1, 1e-5);
    memcpy(q, rest, sizeof q);
    assert_near(ris__resolve_group(2, none, distance, rest, 30, q).x, 0.0, 1e-7);
    assert_near(q[0].x, -0.1, 1e-7);
    q[0] = q[1] = v3(3, 3, 3); /* both on the centroid: the rest directions */
    ris__resolve_group(2, none, distance, rest, 30, q);
    assert_point(q[0], 2.9f, 3, 3, 1e-6f);
    assert_point(q[1], 3.1f, 3, 3, 1e-6f);
}

static void relax_weight(void **state) /* KA-35 */
{
    (void)state;
    assert_near(ris__relax_weight(1.10f, 1), 0.4, 1e-6);
    assert_near(ris__relax_weight(1.25f, 1), 1.0, 1e-6);
    assert_near(ris__relax_weight(0.9f, 1), 0.0, 0.0);
    assert_near(ris__relax_weight(3, 1), 1.0, 0.0);
}

static void bulge_factors(void **state) /* KA-36 */
{
    (void)state;
    const float six[] = {1, 1.9375f, 2.25f, 1.9375f, 1}, four[] = {1, 2.25f, 1};
    for (uint32_t i = 0; i < 5; ++i) {
        assert_near(ris__bulge_factor(RIS_MUSCLE_LINEAR, 5.0f, 0.75f, i, 5), six[i], 1e-6);
        assert_near(ris__bulge_factor(RIS_MUSCLE_SPHINCTER, 5.0f, 0.75f, i, 5), 2.25, 1e-6);
        assert_true(ris__bulge_factor(RIS_MUSCLE_LINEAR, 5.0f, 1.0f, i, 5) == 1.0f);
    }
    for (uint32_t i = 0; i < 3; ++i) {
        assert_near(ris__bulge_factor(RIS_MUSCLE_LINEAR, 5.0f, 0.75f, i, 3), four[i], 1e-6);
    }
    assert_near(ris__bulge_factor(RIS_MUSCLE_SPHINCTER, 5.0f, 1.25f, 0, 5), 0.75, 1e-6);
    assert_near(ris__bulge_factor(RIS_MUSCLE_LINEAR, 5.0f, 1.25f, 2, 5), 0.75, 1e-6);
    assert_near(ris__bulge_factor(RIS_MUSCLE_SPHINCTER, 1.0f, 0.75f, 0, 5), 1.25,
                1e-6); /* the default tissue's nu */
    assert_near(ris__bulge_factor(RIS_MUSCLE_SPHINCTER, 1.0f, 1.25f, 0, 5), 0.75, 1e-6);
    assert_true(ris__bulge_factor(RIS_MUSCLE_SPHINCTER, 5.0f, 5.0f, 0, 5) > 0.0f);
}

/* KA-37: translation and rotation carry the attached point rigidly; antiparallel and vanished segments
 * stay finite. */
static void segment_frames(void **state)
{
    (void)state;
    const ris_segment segment = {{0.5f, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 4, 3}};
    const ris_vec3 p0 = {0, 0, 0}, p1 = {1, 0, 0}, local = {0.25f, 0.5f, -0.5f};
    assert_point(ris__segment_point(&segment, p0, p1, p0, p1, 1, local), 0.75f, 2, -1.5f, 1e-6f);
    assert_point(ris__segment_point(&segment, p0, p1, v3(5, 6, 7), v3(6, 6, 7), 1, local), 5.75f, 8, 5.5f,
                 1e-5f);
    assert_point(ris__segment_point(&segment, p0, p1, p0, v3(0, 1, 0), 1, local), -2, 0.75f, -1.5f,
                 1e-5f); /* x to y */
    assert_point(ris__segment_point(&segment, p0, p1, p0, v3(2, 0, 0), 0.5f, local), 1.5f, 1, -1.5f, 1e-6f);
    assert_point(ris__segment_point(&segment, p0, p1, p0, v3(-1, 0, 0), 1, local), -0.75f, -2, -1.5f, 1e-5f);
    const ris_vec3 gone = ris__segment_point(&segment, p0, p1, p0, p0, 1, local);
    assert_true(isfinite(gone.x) && isfinite(gone.y) && isfinite(gone.z));
}

static void powers_without_libm(void **state)
{
    (void)state;
    for (int k = 0; k <= 10; ++k) {
        const float t = (float)k / 10.0f;
        assert_near(ris__power(t, 6.0f), powf(t, 6.0f), 1e-6);
        assert_near(ris__power(t, 6.5f), 0.5f * (powf(t, 6.0f) + powf(t, 7.0f)), 1e-6);
    }
    assert_near(ris__power(0.98f, 64.0f), powf(0.98f, 64.0f),
                1e-6); /* the largest lip_drag_power of a file */
    assert_true(ris__power(1.0f, 6.3f) == 1.0f && ris__power(0.0f, 6.3f) == 0.0f);
}

typedef struct fixture {
    ris_model *model;
    ris_rig rig;
    float *pose;
} fixture;

static fixture open_rig(ris_tissue_model tissue)
{
    fixture f = {0};
    ris_error err = {0};
    ris_scene_def def = ris_default_scene_def();
    def.tissue.model = tissue;
    def.tissue.substeps = 64; /* the thesis's absolute damping is stiff on a mesh this fine */
    if (ris_scene_model(&def, &f.model, &err) != RIS_OK || ris__rig_init(&f.rig, f.model, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    f.pose = calloc(f.model->channel_count, sizeof *f.pose);
    return f;
}

static void close_rig(fixture *f)
{
    ris__rig_finish(&f->rig);
    ris_model_destroy(f->model);
    free(f->pose);
}

static void run(fixture *f)
{
    ris__jaw_pose(&f->rig, f->pose);
    ris__muscle_contract(&f->rig, f->pose);
    ris__muscle_constrain(&f->rig);
    ris__muscle_relax(&f->rig);
    ris__muscle_bulge(&f->rig);
    ris__muscle_attach(&f->rig);
}

static ris_vec3 target_delta(const fixture *f, uint32_t i)
{
    return v3_sub(v4_xyz(f->rig.point[i].a), v4_xyz(f->model->rest_position[i]));
}

/* KA-30: the neutral pose leaves every bit alone, and a pose put on and taken off returns the anchors. */
static void neutral_is_identity(void **state)
{
    (void)state;
    for (int literal = 0; literal < 2; ++literal) {
        fixture f = open_rig(literal ? RIS_TISSUE_KAEHLER : RIS_TISSUE_RISORIUS);
        const size_t size = f.model->node_count * sizeof(ris_anchor_point);
        ris_anchor_point *rest = malloc(size);
        memcpy(rest, f.rig.point, size);
        run(&f);
        assert_memory_equal(rest, f.rig.point, size);
        for (uint32_t i = 0; i < f.model->node_count; ++i) {
            assert_true(f.rig.delta[i].x == 0.0f && f.rig.delta[i].y == 0.0f && f.rig.delta[i].z == 0.0f);
        }
        f.pose[0] = f.pose[4] = 1.0f;
        f.pose[ris_model_channel(f.model, "jaw.open")] = 0.5f;
        run(&f);
        assert_memory_not_equal(rest, f.rig.point, size);
        memset(f.pose, 0, f.model->channel_count * sizeof *f.pose);
        run(&f);
        assert_memory_equal(rest, f.rig.point, size);
        free(rest);
        close_rig(&f);
    }
}

/* KA-27: the muscle-level point is the mean of its fibres' points. */
static void muscle_points_are_means(void **state)
{
    (void)state;
    fixture f = open_rig(RIS_TISSUE_RISORIUS);
    const ris_muscle *muscle = &f.model->muscle[0];
    assert_int_equal(muscle->fiber_count, 2);
    const ris_vec3 a = f.model->fiber_point[f.model->fiber[0].first_point + 2],
                   b = f.model->fiber_point[f.model->fiber[1].first_point + 2];
    const ris_vec3 mean = ris__muscle_point(f.model, muscle, f.model->fiber_point, 2);
    assert_point(mean, 0.5f * (a.x + b.x), 0.5f * (a.y + b.y), 0.5f * (a.z + b.z), 1e-5f);
    close_rig(&f);
}

/* The corner of a smile moves with the muscle, the drag falls to nothing at the midline and never crosses
 * it, and the deltas of a tick add up to the change of the target. */
static void smile_drags_the_lip(void **state)
{
    (void)state;
    fixture f = open_rig(RIS_TISSUE_RISORIUS);
    f.pose[ris_model_channel(f.model, "zygomaticus_major.L")] = 1.0f;
    run(&f);
    const uint32_t columns = 49, row = 18; /* y = -24: the upper lip's lower edge */
    float last = 0.0f;
    for (uint32_t c = 0; c < columns; ++c) {
        const uint32_t i = row * columns + c;
        const float x = f.model->rest_position[i].x, moved = v3_length(target_delta(&f, i));
        if (x <= 0.0f) {
            assert_true(moved < 1.0f); /* the stretched ring thins, nothing else */
        } else if (x <= 18.0f) {
            assert_true(moved >= last - 0.1f);
            last = moved;
        }
        const ris_vec3 delta = v4_xyz(f.rig.delta[i]), change = target_delta(&f, i);
        assert_point(delta, change.x, change.y, change.z, 1e-6f);
    }
    assert_true(last > 4.0f);
    const uint32_t corner = row * columns + 33;
    assert_true(target_delta(&f, corner).y > 3.0f && target_delta(&f, corner).x > 1.0f);
    run(&f); /* held: nothing more to shift */
    assert_true(f.rig.delta[corner].x == 0.0f && f.rig.delta[corner].y == 0.0f &&
                f.rig.delta[corner].z == 0.0f);
    close_rig(&f);
}

/* KA-05: the jaw moves what hangs on it and nothing else; normals turn along and stay unit. */
static void jaw_carries_the_lower_face(void **state)
{
    (void)state;
    fixture f = open_rig(RIS_TISSUE_RISORIUS);
    f.pose[ris_model_channel(f.model, "jaw.open")] = 1.0f;
    run(&f);
    for (uint32_t i = 0; i < f.model->node_count; ++i) {
        const float w = f.model->jaw_weight[i], moved = v3_length(target_delta(&f, i));
        if (!(f.model->rest_position[i].w > 0.0f)) {
            continue;
        }
        assert_true(w > 0.0f || moved == 0.0f);
        assert_true(w < 1.0f || moved > 5.0f);
        assert_near(v3_length(v4_xyz(f.rig.point[i].b)), 1.0, 1e-5);
        if (w == 1.0f) {
            const ris_vec3 turned = ris__rigid_apply(&f.rig.jaw, v4_xyz(f.model->rest_position[i]));
            assert_point(v4_xyz(f.rig.point[i].a), turned.x, turned.y, turned.z, 1e-4f);
        }
    }
    close_rig(&f);
}

/* KA-37 in the kaehler tissue: anchor and mirror move by the same displacement. KA-35: the group's passive
 * members lengthen, and their free sections are drawn towards the straight line. */
static void kaehler_pairs_and_stretching(void **state)
{
    (void)state;
    fixture f = open_rig(RIS_TISSUE_KAEHLER);
    ris_anchor_point *rest = malloc(f.model->node_count * sizeof *rest);
    memcpy(rest, f.rig.point, f.model->node_count * sizeof *rest);
    f.pose[ris_model_channel(f.model, "zygomaticus_major.L")] = 1.0f;
    run(&f);
    uint32_t moved = 0;
    for (uint32_t i = 0; i < f.model->node_count; ++i) {
        const ris_vec3 a = v3_sub(v4_xyz(f.rig.point[i].a), v4_xyz(rest[i].a)),
                       m = v3_sub(v4_xyz(f.rig.point[i].b), v4_xyz(rest[i].b));
        assert_point(m, a.x, a.y, a.z, 2e-5f);
        moved += v3_length(a) > 1.0f;
    }
    assert_true(moved > 50);
    const ris_muscle *idle = &f.model->muscle[ris_model_channel(f.model, "depressor_anguli_oris.L")];
    const uint32_t first = f.model->fiber[idle->first_fiber].first_point;
    assert_true(polyline(f.rig.q + first, idle->point_count) >
                1.05f * polyline(f.rig.p + first, idle->point_count));
    for (uint32_t i = 1; i + 1 < idle->point_count; ++i) {
        assert_true(v3_distance(f.rig.q[first + i], f.rig.p[first + i]) > 0.5f);
    }
    free(rest);
    close_rig(&f);
}

/* KA-35 with w = 1: a lengthened fibre without constrained points becomes straight; its ends stay, and so
 * does a shortened one. */
static void long_fibres_straighten(void **state)
{
    (void)state;
    fixture f = open_rig(RIS_TISSUE_KAEHLER);
    const ris_muscle *muscle = &f.model->muscle[ris_model_channel(f.model, "frontalis_inner.L")];
    const uint32_t first = f.model->fiber[muscle->first_fiber].first_point, n = muscle->point_count;
    ris_vec3 *q = f.rig.q + first;
    for (uint32_t i = 0; i < n; ++i) {
        q[i] = v3_mad(f.rig.p[first], 1.4f, v3_sub(f.rig.p[first + i], f.rig.p[first]));
        q[i].x += i % 2 ? 2.0f : 0.0f;
    }
    const ris_vec3 from = q[0], to = q[n - 1];
    ris__muscle_relax(&f.rig);
    assert_memory_equal(&q[0], &from, sizeof from);
    assert_memory_equal(&q[n - 1], &to, sizeof to);
    const ris_vec3 line = v3_unit_or(v3_sub(to, from), v3(0, 0, 0));
    for (uint32_t i = 1; i + 1 < n; ++i) {
        const ris_vec3 d = v3_sub(q[i], from);
        assert_true(v3_length(v3_cross(d, line)) < 1e-4f);
        assert_true(v3_dot(d, line) > v3_dot(v3_sub(q[i - 1], from), line));
    }
    ris__contract_linear(f.rig.p + first, n, 0.3f, q);
    ris_vec3 short_q[16];
    assert_true(n <= 16);
    memcpy(short_q, q, n * sizeof *q);
    ris__muscle_relax(&f.rig);
    assert_memory_equal(short_q, q, n * sizeof *q);
    close_rig(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jaw_rotation),
        cmocka_unit_test(linear_contraction),
        cmocka_unit_test(a_bowstring_straightens),
        cmocka_unit_test(sphincter_contraction),
        cmocka_unit_test(slit_contraction),
        cmocka_unit_test(group_resolution),
        cmocka_unit_test(relax_weight),
        cmocka_unit_test(bulge_factors),
        cmocka_unit_test(segment_frames),
        cmocka_unit_test(powers_without_libm),
        cmocka_unit_test(neutral_is_identity),
        cmocka_unit_test(muscle_points_are_means),
        cmocka_unit_test(smile_drags_the_lip),
        cmocka_unit_test(jaw_carries_the_lower_face),
        cmocka_unit_test(kaehler_pairs_and_stretching),
        cmocka_unit_test(long_fibres_straighten),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
