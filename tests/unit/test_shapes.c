/* Shapes and merging of muscles: KA-25 ellipsoids, KA-26 boxes, KA-28 groups by intersecting shapes, KA-29 network, KA-34 its
 * run, KA-27 moving a muscle-level point. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh_head.h"
#include "model/model_impl.h"
#include "model/shapes.h"
#include "model/vec3.h"
#include "scenes/scenes.h"
#include "sim/rig.h"

#define assert_near(a, b, tolerance) assert_float_equal((float)(a), (float)(b), (float)(tolerance))
#define SIDE 25

static ris_error err;

static void need(ris_result result)
{
    if (result != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

/* One straight fibre of `count` segments of 4 x 2 x 3 mm along x from the origin, bent by `turn` mm in y per segment. */
typedef struct strand {
    ris_segment segment[16];
    ris_vec3 point[17];
    ris_fiber_pose pose;
} strand;

static void make_strand(strand *s, uint32_t count, float turn)
{
    for (uint32_t k = 0; k <= count; ++k) {
        s->point[k] = v3(4.0f * (float)k, turn * (float)(k * k), 0.0f);
    }
    for (uint32_t k = 0; k < count; ++k) {
        const ris_vec3 along = v3_unit_or(v3_sub(s->point[k + 1], s->point[k]), v3(1, 0, 0)),
                       wide = v3(0, 0, 1);
        s->segment[k] = (ris_segment){.origin = v3_scale(v3_add(s->point[k], s->point[k + 1]), 0.5f),
                                      .along = along,
                                      .up = v3_cross(wide, along),
                                      .wide = wide,
                                      .size = {v3_distance(s->point[k + 1], s->point[k]), 2.0f, 3.0f}};
    }
    s->pose = (ris_fiber_pose){s->segment, s->point, s->point, NULL, count};
}

static void ellipsoids(void **state) /* KA-25 */
{
    (void)state;
    strand s;
    make_strand(&s, 1, 0.0f);
    const ris_ellipsoid e = ris__segment_ellipsoid(&s.pose, 0);
    const float half[3] = {2.2f, 1.0f, 1.65f};
    float t[2];
    assert_true(ris__ellipsoid_ray(&e, e.centre, e.axis[1], t));
    assert_near(t[1], 1.0, 1e-6); /* height / 2 */
    assert_near(t[0], -1.0, 1e-6);
    assert_true(ris__ellipsoid_inside(&e, e.centre));
    for (int k = 0; k < 3; ++k) {
        assert_near(e.half[k], half[k], 1e-6);
        assert_false(ris__ellipsoid_inside(&e, v3_mad(e.centre, 1.01f * half[k], e.axis[k])));
        assert_true(ris__ellipsoid_inside(&e, v3_mad(e.centre, 0.99f * half[k], e.axis[k])));
    }
    assert_false(ris__ellipsoid_ray(&e, v3(0, 5, 0), v3(1, 0, 0), t));
}

static void boxes(void **state) /* KA-26 */
{
    (void)state;
    strand s;
    ris_box box[2];
    float t[4];
    make_strand(&s, 1, 0.0f);
    ris__fiber_boxes(&s.pose, box);
    const ris_vec3 centre = v3(2, 0, 0);
    assert_int_equal(ris__chain_hits(box, 1, centre, v3(0.01f, 1, 0.013f), t, 4), 1);
    assert_near(t[0], 1.0, 1e-5);
    assert_true(ris__box_inside(box, centre));
    const ris_vec3 half[3] = {{2, 0, 0}, {0, 1, 0}, {0, 0, 1.5f}};
    for (int k = 0; k < 3; ++k) {
        assert_false(ris__box_inside(box, v3_mad(centre, 1.01f, half[k])));
        assert_true(ris__box_inside(box, v3_mad(centre, 0.99f, half[k])));
    }
    const float bulge = 2.0f;
    s.pose.bulge = &bulge; /* the height alone */
    ris__fiber_boxes(&s.pose, box);
    assert_near(box[0].corner[2].y, 2.0, 1e-6);
    assert_near(box[0].corner[4].z, 1.5, 1e-6);
    make_strand(&s, 2, 1.0f); /* neighbours share their corners */
    ris__fiber_boxes(&s.pose, box);
    for (int k = 0; k < 8; k += 2) {
        assert_memory_equal(&box[0].corner[k + 1], &box[1].corner[k], sizeof(ris_vec3));
    }
}

static float random_unit(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (float)(*seed >> 8) / 16777216.0f;
}

/* 1000 rays through a bent muscle: the chain of boxes is hit an even number of times by each; between the ellipsoids of a
 * strongly bent one some points of the fibre lie in no shape. */
static void chains_are_watertight(void **state)
{
    (void)state;
    strand s;
    ris_box box[16];
    uint32_t seed = 7u, through = 0, gaps = 0;
    make_strand(&s, 12, 0.15f);
    ris__fiber_boxes(&s.pose, box);
    for (int k = 0; k < 1000; ++k) {
        const ris_vec3 target = v3_lerp(s.point[0], s.point[12], random_unit(&seed));
        const ris_vec3 origin = v3(200.0f * (random_unit(&seed) - 0.5f), 200.0f * (random_unit(&seed) - 0.5f),
                                   100.0f + 50.0f * random_unit(&seed));
        float t[8];
        const ris_vec3 aim = v3_mad(target, random_unit(&seed) - 0.5f, v3(0, 12, 6));
        const uint32_t hits = ris__chain_hits(box, 12, origin, v3_sub(aim, origin), t, 8);
        assert_int_equal(hits % 2, 0);
        through += hits > 0;
        for (uint32_t i = 1; i < hits && i < 8; ++i) {
            assert_true(t[i] >= t[i - 1]);
        }
    }
    assert_true(through > 200);
    uint32_t odd = 0; /* control: one corner torn from its neighbour */
    ris_box torn[16];
    memcpy(torn, box, sizeof torn);
    torn[5].corner[1].y -= 1.0f;
    for (int k = 0; k < 1000; ++k) {
        const ris_vec3 origin = v3(100.0f * random_unit(&seed), 50.0f * random_unit(&seed), 100.0f);
        odd += ris__chain_hits(torn, 12, origin, v3_sub(s.point[6], origin), NULL, 0) % 2;
    }
    assert_true(odd > 5);
    uint32_t samples = 0;
    for (float u = 0.0f; u < 12.0f; u += 0.01f) { /* along the middle of the upper side, just below it */
        const uint32_t k = (uint32_t)u;
        const ris_segment *g = &s.segment[k];
        const ris_vec3 p =
            v3_mad(v3_lerp(s.point[k], s.point[k + 1], u - (float)k), 0.45f * g->size.y, g->up);
        bool boxed = false, round = false;
        for (uint32_t i = 0; i < 12; ++i) {
            const ris_ellipsoid e = ris__segment_ellipsoid(&s.pose, i);
            round = round || ris__ellipsoid_inside(&e, p);
            boxed = boxed || ris__box_inside(&box[i], p);
        }
        gaps += !round;
        samples += boxed;
    }
    assert_true(samples > 1150);           /* bent corners are cut a little */
    assert_true(gaps > 200 && gaps < 800); /* ellipsoids sink between segments; 60 % of the length here */
}

static void box_intersection(void **state)
{
    (void)state;
    strand s;
    ris_box a[2], b;
    make_strand(&s, 2, 0.0f);
    ris__fiber_boxes(&s.pose, a);
    const ris_vec3 steps[] = {{3.99f, 0, 0}, {0, 1.99f, 0}, {0, 0, 2.99f},
                              {4.01f, 0, 0}, {0, 2.01f, 0}, {0, 0, 3.01f}};
    for (int k = 0; k < 6; ++k) {
        b = a[0];
        for (int c = 0; c < 8; ++c) {
            b.corner[c] = v3_add(b.corner[c], steps[k]);
        }
        assert_true(ris__boxes_meet(&a[0], &b) == (k < 3));
    }
    /* two crossed boxes edge to edge: only a cross product of edges separates them */
    for (int c = 0; c < 8; ++c) {
        const ris_vec3 p = v3_sub(a[0].corner[c], v3(2, 0, 0));
        const float h = 0.70710678f, x = p.x * 4.0f;
        a[1].corner[c] = v3(x, h * (p.y - p.z), h * (p.y + p.z));
        b.corner[c] = v3(h * (p.y - p.z), h * (p.y + p.z) + 3.6f, x);
    }
    assert_false(ris__boxes_meet(&a[1], &b));
    for (int c = 0; c < 8; ++c) {
        b.corner[c].y -= 0.2f;
    }
    assert_true(ris__boxes_meet(&a[1], &b));
}

static ris_head flat_head(void)
{
    static ris_vec3 p[SIDE * SIDE];
    static uint32_t corners[(SIDE - 1) * (SIDE - 1)], v[4 * (SIDE - 1) * (SIDE - 1)];
    for (uint32_t i = 0; i < SIDE * SIDE; ++i) {
        const uint32_t row = i / SIDE, column = i % SIDE;
        p[i] = v3(2.5f * ((float)column - 12.0f), 2.5f * ((float)row - 12.0f), 0.0f);
    }
    for (uint32_t f = 0; f < (SIDE - 1) * (SIDE - 1); ++f) {
        const uint32_t a = f / (SIDE - 1) * SIDE + f % (SIDE - 1),
                       quad[4] = {a, a + 1, a + SIDE + 1, a + SIDE};
        corners[f] = 4;
        memcpy(v + 4 * (size_t)f, quad, sizeof quad);
    }
    ris_head head = mesh_head(SIDE * SIDE, p, (SIDE - 1) * (SIDE - 1), corners, v, NULL);
    head.tissue.model = RIS_TISSUE_KAEHLER;
    head.tissue.substeps = 64;
    return head;
}

static ris_model *bake(const ris_head *head)
{
    ris_model *model = NULL;
    need(ris_model_create(head, &model, &err));
    return model;
}

/* Figure 7.4 of the thesis: muscles 1, 2 and 3 merge into muscle 0. */
static ris_head worked_example(void)
{
    ris_head head = flat_head();
    ris_muscle_def *def = add_muscles(&head, 4);
    const ris_vec3 trunk[8] = {{-3, -18, 0}, {3, -18, 0}, {-3, -6, 0}, {3, -6, 0},
                               {-3, 6, 0},   {3, 6, 0},   {-3, 18, 0}, {3, 18, 0}};
    const ris_vec3 first[4] = {{-20, -5, 0}, {-20, -3, 0}, {-2, -5, 0}, {-2, -3, 0}};
    const ris_vec3 second[4] = {{20, 5, 0}, {20, 3, 0}, {2, 5, 0}, {2, 3, 0}};
    const ris_vec3 third[4] = {{20, 17, 0}, {20, 15, 0}, {2, 17, 0}, {2, 15, 0}};
    set_muscle(&def[0], "trunk", 4, 2, trunk);
    set_muscle(&def[1], "first_branch", 2, 2, first);
    set_muscle(&def[2], "second_branch", 2, 2, second);
    set_muscle(&def[3], "third_branch", 2, 2, third);
    return head;
}

static bool in_group(const ris_model *model, uint32_t g, uint32_t muscle, uint32_t point)
{
    const ris_group_point *p = model->group_point + model->group[g].first_point;
    for (uint32_t k = 0; k < model->group[g].point_count; ++k) {
        if (p[k].muscle == muscle && p[k].point == point) {
            return true;
        }
    }
    return false;
}

static void groups_of_the_worked_example(void **state) /* KA-28, KA-29 */
{
    (void)state;
    ris_head head = worked_example();
    ris_model *model = bake(&head);
    assert_int_equal(model->group_count, 2);
    const uint32_t c0 = in_group(model, 0, 0, 1) ? 0 : 1, c1 = 1 - c0;
    assert_int_equal(model->group[c0].point_count, 4);
    assert_true(in_group(model, c0, 0, 1) && in_group(model, c0, 0, 2) && in_group(model, c0, 1, 1) &&
                in_group(model, c0, 2, 1));
    assert_int_equal(model->group[c1].point_count, 2);
    assert_true(in_group(model, c1, 0, 3) && in_group(model, c1, 3, 1));
    /* nodes: 6 points, and a bone end each, for the trunk's end is in C_1 too; springs: 2 along the trunk, 4 from bone, in C_0 all
     * pairs of different muscles (5 of 6), in C_1 one */
    assert_int_equal(model->network_node_count, 10);
    assert_int_equal(model->network_spring_count, 2 + 4 + 5 + 1);
    ris_vec3 sum = {0};
    for (uint32_t k = 0; k < 4;
         ++k) { /* rest distances are those from the centroid, which is in the middle here */
        const ris_group_point *p = &model->group_point[model->group[c0].first_point + k];
        const ris_vec3 q = ris__muscle_point(model, &model->muscle[p->muscle], model->fiber_point, p->point);
        sum = v3_add(sum, q);
        assert_near(p->rest_distance_mm, v3_distance(q, v3(0, 0, -4)), 1e-4);
    }
    assert_near(sum.x, 0, 1e-4);
    ris_model_destroy(model);
    ris_head_finish(&head);
}

/* A muscle that merely crosses another, its ends beyond it, stays independent. */
static void crossing_muscles_do_not_merge(void **state)
{
    (void)state;
    ris_head head = flat_head();
    ris_muscle_def *def = add_muscles(&head, 2);
    const ris_vec3 trunk[8] = {{-3, -18, 0}, {3, -18, 0}, {-3, -6, 0}, {3, -6, 0},
                               {-3, 6, 0},   {3, 6, 0},   {-3, 18, 0}, {3, 18, 0}};
    const ris_vec3 across[8] = {{-24, 2, 0}, {-24, -2, 0}, {-9, 2, 0}, {-9, -2, 0},
                                {9, 2, 0},   {9, -2, 0},   {24, 2, 0}, {24, -2, 0}};
    set_muscle(&def[0], "trunk", 4, 2, trunk);
    set_muscle(&def[1], "across", 4, 2, across);
    ris_model *model = bake(&head);
    assert_int_equal(model->group_count, 0);
    assert_int_equal(model->network_node_count, 0);
    ris_model_destroy(model);
    for (uint32_t k = 0; k < 8; ++k) { /* control: moved so that its end lies on the trunk, it merges */
        def[1].grid[k].x -= 22.0f;
        def[1].grid[k].x = def[1].grid[k].x < -28.0f ? -28.0f - (float)(7 - k) * 0.2f : def[1].grid[k].x;
    }
    model = bake(&head);
    assert_int_equal(model->group_count, 1);
    ris_model_destroy(model);
    ris_head_finish(&head);
}

/* KA-34: what a node closes of its gap in 20 ms on K = 40, 120 and 160 g/s^2: 20.5, 52.5, 64.7 % exactly; the leapfrog with its
 * Euler start comes near. */
static void the_network_runs_for_twenty_milliseconds(void **state)
{
    (void)state;
    const uint32_t springs[] = {1, 3, 4};
    const float closed[] = {0.205f, 0.525f, 0.647f};
    for (int k = 0; k < 3; ++k) {
        const ris_network_node node[2] = {{0, 0, true}, {0, 1, false}};
        const ris_network_spring spring[4] = {{0, 1, 1}, {0, 1, 1}, {0, 1, 1}, {0, 1, 1}};
        const float rest[4] = {1, 1, 1, 1};
        ris_vec3 x[2] = {{0, 0, 0}, {2, 0, 0}}, half[2], previous[2], force[2];
        const ris_network net = {node, spring, 2, springs[k], rest, force};
        ris__network_run(&net, x, half, previous);
        assert_near(2.0f - x[1].x, closed[k], 0.025);
        assert_true(x[0].x == 0.0f && x[1].y == 0.0f);
        x[1] = v3(1, 0, 0);
        ris__network_run(&net, x, half, previous);
        assert_true(x[1].x == 1.0f); /* at rest nothing moves */
    }
}

/* The rig of the worked example with muscle `active` contracted; displacement of a muscle-level point. */
static ris_vec3 moved(ris_rig *rig, uint32_t muscle, uint32_t point)
{
    const ris_model *model = rig->model;
    return v3_sub(ris__muscle_point(model, &model->muscle[muscle], rig->q, point),
                  ris__muscle_point(model, &model->muscle[muscle], rig->p, point));
}

static void pulls_travel_along_the_muscle(void **state) /* KA-34 */
{
    (void)state;
    ris_head head = worked_example();
    ris_model *model = bake(&head);
    ris_rig rig;
    need(ris__rig_init(&rig, model, &err));
    float *pose = calloc(model->channel_count, sizeof *pose);
    pose[2] = 1.0f; /* the second branch pulls at C_0 */
    ris__jaw_pose(&rig, pose);
    ris__muscle_contract(&rig, pose);
    const float pull = v3_length(moved(&rig, 2, 1));
    ris__muscle_constrain(&rig);
    const float near = v3_length(moved(&rig, 0, 2)), far = v3_length(moved(&rig, 0, 3)),
                beyond = v3_length(moved(&rig, 3, 1));
    assert_true(pull > 3.0f);
    assert_true(near > 0.5f && near < pull);
    assert_true(far > 0.01f && far < near); /* another group of the same muscle moves, but less */
    assert_true(beyond > 0.0f && beyond < near);
    memset(pose, 0, model->channel_count * sizeof *pose);
    ris__muscle_contract(&rig, pose);
    ris__muscle_constrain(&rig);
    assert_memory_equal(rig.q, rig.p, model->fiber_point_count * sizeof *rig.q); /* nothing contracts */
    free(pose);
    ris__rig_finish(&rig);
    ris_model_destroy(model);
    ris_head_finish(&head);
}

static void points_move_in_all_fibres(void **state) /* KA-27 */
{
    (void)state;
    ris_scene_def def = ris_default_scene_def();
    ris_model *model = NULL;
    ris_rig rig;
    need(ris_scene_model(&def, &model, &err));
    need(ris__rig_init(&rig, model, &err));
    ris__displace_point(&rig, 0, 2, v3(1, 2, 3));
    for (uint32_t k = 0; k < model->fiber_point_count; ++k) {
        const ris_vec3 d = v3_sub(rig.q[k], rig.p[k]);
        const bool member = k == model->fiber[0].first_point + 2 || k == model->fiber[1].first_point + 2;
        assert_near(d.x, member ? 1 : 0, 1e-5);
        assert_near(d.y, member ? 2 : 0, 1e-5);
        assert_near(d.z, member ? 3 : 0, 1e-5);
    }
    ris__rig_finish(&rig);
    ris_model_destroy(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ellipsoids),
        cmocka_unit_test(boxes),
        cmocka_unit_test(chains_are_watertight),
        cmocka_unit_test(box_intersection),
        cmocka_unit_test(groups_of_the_worked_example),
        cmocka_unit_test(crossing_muscles_do_not_merge),
        cmocka_unit_test(the_network_runs_for_twenty_milliseconds),
        cmocka_unit_test(pulls_travel_along_the_muscle),
        cmocka_unit_test(points_move_in_all_fibres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
