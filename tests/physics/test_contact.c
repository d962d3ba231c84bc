/* contact (KF-04), and the grids it reads: hand-computed pushes of one node, distance grids against exact distances, and
 * the reference head held in poses that drive lips and skin into each other, into bone and teeth, measured on the
 * meshes, with and without the stage. */
#include "query/query.h" /* before the globals of loaded_head.h, which its names would hide */

#include "loaded_head.h"

#include "measure/measure.h"
#include "model/distance_grid.h"
#include "risorius/timeline.h"
#include "sim/sim_impl.h"

#include <math.h>

/* A cube of side 2 h about the origin, counter-clockwise outward. */
static ris_mesh cube(float h, ris_vec3 position[8], uint32_t start[7], uint32_t vertex[24])
{
    static const uint32_t corner[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                        2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    for (uint32_t k = 0; k < 8; ++k) {
        position[k] = v3(k & 1 ? h : -h, k & 2 ? h : -h, k & 4 ? h : -h);
    }
    for (uint32_t f = 0; f <= 6; ++f) {
        start[f] = 4 * f;
    }
    memcpy(vertex, corner, sizeof corner);
    return (ris_mesh){
        .vertex_count = 8, .face_count = 6, .position = position, .face_start = start, .face_vertex = vertex};
}

/* Distance to the cube of half side h, negative inside. */
static float cube_distance(ris_vec3 p, float h)
{
    const ris_vec3 d = v3(fabsf(p.x) - h, fabsf(p.y) - h, fabsf(p.z) - h);
    const ris_vec3 out = v3(f_max(d.x, 0.0f), f_max(d.y, 0.0f), f_max(d.z, 0.0f));
    return v3_length(out) + f_min(f_max(d.x, f_max(d.y, d.z)), 0.0f);
}

/* Is every sample of the grid of the cube right? 25 samples a side, 1 mm apart from -12. */
static bool grid_is_right(const float *value)
{
    for (uint32_t k = 0; k < 25 * 25 * 25; ++k) {
        const ris_vec3 p =
            v3((float)(k % 25) - 12.0f, (float)(k / 25 % 25) - 12.0f, (float)(k / 625) - 12.0f);
        const float exact = cube_distance(p, 5.0f), size = fabsf(exact);
        if (exact == 0.0f) {
            continue; /* on the surface either sign will do */
        }
        /* 2.5 cells exactly; beyond, a sum over neighbours that is never short */
        const bool near = size <= 2.5f ? fabsf(value[k] - exact) < 1e-4f
                                       : fabsf(value[k]) > size - 1e-3f && fabsf(value[k]) < 1.1f * size;
        if ((value[k] < 0.0f) != (exact < 0.0f) || !near) {
            return false;
        }
    }
    return true;
}

static void a_grid_knows_the_distance(void **state)
{
    (void)state;
    ris_vec3 position[8];
    uint32_t start[7], vertex[24];
    ris_mesh mesh = cube(5.0f, position, start, vertex);
    const ris_mesh *list[] = {&mesh};
    const ris_grid_place place = ris__grid_place(v3(-12.0f, -12.0f, -12.0f), v3(12.0f, 12.0f, 12.0f), 1.0f);
    float *value = calloc(ris__grid_count(&place), sizeof *value);
    ris_vec4 *grid = calloc(ris__grid_count(&place), sizeof *grid);
    assert_non_null(value);
    assert_non_null(grid);
    assert_int_equal(ris__grid_count(&place), 25 * 25 * 25);
    need(ris__distance_grid(list, 1, &place, value, &err));
    assert_true(grid_is_right(value));
    ris__grid_directions(&place, value, grid);
    ris_vec4 at;
    assert_true(ris__grid_sample(grid, &place, v3(6.5f, 0.3f, -0.2f), &at));
    assert_float_equal(at.w, 1.5f, 1e-4f); /* a face: the blend of a linear function is exact */
    assert_float_equal(at.x, 1.0f, 1e-4f);
    assert_float_equal(at.y, 0.0f, 1e-4f);
    assert_true(ris__grid_sample(grid, &place, v3(0.1f, 0.2f, -4.0f), &at));
    assert_float_equal(at.w, -1.0f, 1e-4f);
    assert_float_equal(at.z, -1.0f, 1e-4f);
    assert_false(ris__grid_sample(grid, &place, v3(12.5f, 0.0f, 0.0f), &at));
    /* controls: a corner moved by a millimetre, and a cube without one face, whose inside leaks */
    position[7].x += 1.0f;
    need(ris__distance_grid(list, 1, &place, value, &err));
    assert_false(grid_is_right(value));
    position[7].x -= 1.0f;
    mesh.face_count = 1;
    need(ris__distance_grid(list, 1, &place, value, &err));
    assert_false(grid_is_right(value));
    free(value);
    free(grid);
}

/* The grids of the head against exact distances to its meshes, near the surface. */
static void the_heads_grids_are_its_bones(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < model->contact_solid_count; ++k) {
        const ris_contact_solid *solid = &model->contact_solid[k];
        const ris_mesh *mesh = strcmp(solid->name, "skull") == 0      ? &model->head->skull
                               : strcmp(solid->name, "mandible") == 0 ? &model->head->mandible
                                                                      : NULL;
        if (!mesh) {
            continue;
        }
        tri_mesh soup = {0};
        bvh tree = {0};
        need(ris__tri_from_mesh(mesh, solid->name, &soup, &err));
        need(ris__bvh_build(&tree, &soup, &err));
        uint32_t tested = 0;
        double worst = 0.0, sum = 0.0;
        for (uint32_t s = 0; s < solid->count[0] * solid->count[1] * solid->count[2]; s += 131) {
            const ris_vec4 sample = model->contact_grid[solid->first + s];
            const uint32_t at[3] = {s % solid->count[0], s / solid->count[0] % solid->count[1],
                                    s / (solid->count[0] * solid->count[1])};
            if (fabsf(sample.w) > 3.0f) {
                continue;
            }
            const dvec p = dv((double)(solid->low.x + (float)at[0] * solid->cell_mm),
                              (double)(solid->low.y + (float)at[1] * solid->cell_mm),
                              (double)(solid->low.z + (float)at[2] * solid->cell_mm));
            const double off = fabs((double)sample.w + ris__bvh_depth(&tree, p));
            worst = fmax(worst, off);
            sum += off;
            ++tested;
        }
        print_message(
            "%s: %u samples near the surface, off by %.3f mm in the mean, %.2f at most (smoothed)\n",
            solid->name, tested, sum / tested, worst);
        assert_true(tested > 100);
        assert_true(sum / tested < 0.35 && worst < 2.0);
        ris__bvh_finish(&tree);
        ris__tri_finish(&soup);
    }
}

/* One node 0.4 mm inside a limit of 1 mm over a plane that a bone turned by 90 degrees about z carries: world x is the
 * rest frame's y. It moves by half of the 0.6 mm that are missing, and of its speed (-3, 8, 2) it keeps half of what
 * does not go into the plane. */
static void a_push_is_what_it_should_be(void **state)
{
    (void)state;
    ris_vec4 grid[27], place[1], v[1];
    for (uint32_t k = 0; k < 27; ++k) { /* plane y = 0 of the rest frame, samples 2 mm apart from -2 */
        grid[k] = v4_from(v3(0.0f, 1.0f, 0.0f), 2.0f * (float)(k / 3 % 3) - 2.0f);
    }
    ris_contact_node node = {.node = 0, .touch_end = 1};
    ris_contact_touch touch = {0, 0, 1.0f};
    ris_ring no_ring = {0};
    uint32_t none[2] = {0, 0};
    ris_vec4 rest = {0.4f, 0.0f, 0.0f, 1.0f}, rest_normal = {1.0f, 0.0f, 0.0f, 0.0f};
    ris_half_spring no_spring = {0};
    ris_anchor_param param = {0};
    ris_head head = {.tissue = ris_default_tissue()};
    ris_vec3 anchor = {0};
    ris_channel channel[32] = {{{0}, 0, 0}};
    float weight = 0.0f;
    ris_model one = {.head = &head,
                     .node_count = 1,
                     .moving_count = 1,
                     .rest_position = &rest,
                     .rest_normal = &rest_normal,
                     .spring_start = none,
                     .half_spring = &no_spring,
                     .ring_start = none,
                     .ring = &no_ring,
                     .anchor_param = &param,
                     .binding_start = none,
                     .bone_anchor = &anchor,
                     .jaw_weight = &weight,
                     .channel = channel,
                     .fiber_point = &anchor,
                     .contact_node = &node,
                     .contact_touch = &touch,
                     .contact_grid = grid,
                     .contact_node_count = 1,
                     .contact_touch_count = 1,
                     .contact_sample_count = 27,
                     .push = {.node_count = 1, .dt_s = 0.001f, .contact_node_count = 1}};
    const ris_contact_body body = {.row_x = {0, 1, 0, 0},
                                   .row_y = {1, 0, 0, 0},
                                   .row_z = {0, 0, 1, 0},
                                   .low = {-2, -2, -2, 0.5f},
                                   .count_x = 3,
                                   .count_y = 3,
                                   .count_z = 3};
    ris_anchor_point point = {0};
    ris_vec4 delta = {0};
    const ris_anchor_frame anchors = {&point, &delta, &body, NULL};
    ris_contact_body bodies[RIS_CONTACT_BODIES] = {body};
    const ris_anchor_frame frame = {anchors.point, anchors.delta, bodies, NULL};
    ris_sim *alone = NULL;
    need(ris_sim_create_cpu(&one, &alone, &err));
    v[0] = v4_from(v3(-3.0f, 8.0f, 2.0f), 0.0f);
    need(ris_sim_write(alone, RIS_STATE_VELOCITY_HALF, v, &err));
    need(ris_sim_write(alone, RIS_STATE_VELOCITY_PREV, v, &err));
    need(ris__sim_stage(alone, RIS_STAGE_CONTACT, &frame, &err));
    need(ris_sim_read(alone, RIS_STATE_POSITION, place, &err));
    assert_float_equal(place[0].x, 0.7f, 1e-6f);
    assert_float_equal(place[0].y, 0.0f, 1e-6f);
    need(ris_sim_read(alone, RIS_STATE_VELOCITY_HALF, v, &err));
    assert_float_equal(v[0].x, 0.0f, 1e-6f);
    assert_float_equal(v[0].y, 4.0f, 1e-6f);
    assert_float_equal(v[0].z, 1.0f, 1e-6f);
    touch.limit_mm = 0.3f; /* control: far enough, nothing happens */
    need(ris_sim_reset(alone, &err));
    need(ris__sim_stage(alone, RIS_STAGE_CONTACT, &frame, &err));
    need(ris_sim_read(alone, RIS_STATE_POSITION, place, &err));
    assert_float_equal(place[0].x, 0.4f, 0.0f);
    ris_sim_destroy(alone);
}

static void hold_and_measure(const ris_measurer *measurer, const char *text, ris_finding *out)
{
    ris_bone_frames frames;
    memset(pose, 0, model->channel_count * sizeof *pose);
    need(ris_pose_parse(model, text, pose, &err));
    need(ris_sim_reset(sim, &err));
    need(ris_sim_settle(sim, pose, NULL, &err));
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
    for (int b = 0; b < RIS_BONE_SKIN; ++b) {
        ris_sim_bone_transform(sim, (ris_bone)b, frames.bone[b]);
    }
    need(ris__measure_pose(measurer, x, &frames, out, NULL, &err));
}

/* The middle of an edge is held by both of its ends, alike, and never nearer than at rest. */
static void middles_have_two_ends(void **state)
{
    (void)state;
    uint32_t middles = 0;
    for (uint32_t c = 0; c < model->contact_node_count; ++c) {
        const ris_contact_node *node = &model->contact_node[c];
        for (uint32_t k = node->touch_first; k < node->touch_end; ++k) {
            const ris_contact_touch *touch = &model->contact_touch[k];
            uint32_t twins = 0;
            for (uint32_t d = 0; touch->other != node->node && d < model->contact_node_count; ++d) {
                const ris_contact_node *end = &model->contact_node[d];
                for (uint32_t t = end->touch_first; end->node == touch->other && t < end->touch_end; ++t) {
                    const ris_contact_touch *twin = &model->contact_touch[t];
                    twins += twin->body == touch->body && twin->other == node->node &&
                             twin->limit_mm == touch->limit_mm;
                }
            }
            assert_int_equal(twins, touch->other != node->node);
            assert_true(touch->other == node->node || touch->limit_mm <= 0.3f);
            middles += twins;
        }
    }
    print_message("%u ends of %u edges by the teeth\n", middles, middles / 2);
    assert_true(middles >= 100);
}

/* What the meshes say, with the stage and, as a control, without it. */
static void contact_keeps_apart(void **state)
{
    (void)state;
    static const struct {
        const char *pose;
        ris_measure measure;
        double without_mm; /* at least so deep when nothing holds */
    } cases[] = {
        {"orbicularis_oris_superior=1,orbicularis_oris_inferior=1,mentalis=1,incisivus_labii_superioris=1,"
         "incisivus_labii_inferioris=1",
         RIS_MEASURE_LIPS, 0.8},
        {"jaw.forward=1", RIS_MEASURE_LOWER_TEETH, 1.0},
        {"orbicularis_oris_superior=1,incisivus_labii_superioris=1,jaw.open=0.3", RIS_MEASURE_UPPER_TEETH,
         0.8},
    };
    ris_measurer *measurer = NULL;
    ris_finding found[RIS_MEASURE_COUNT];
    need(ris__measurer_create(model, &measurer, &err));
    for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
        hold_and_measure(measurer, cases[k].pose, found);
        const double with = found[cases[k].measure].value;
        const uint32_t count = model->push.contact_node_count, lips = model->push.lip_node_count;
        model->push.contact_node_count = model->push.lip_node_count = 0;
        hold_and_measure(measurer, cases[k].pose, found);
        model->push.contact_node_count = count;
        model->push.lip_node_count = lips;
        print_message("%s: %s %.2f mm, without contact %.2f mm\n", cases[k].pose,
                      ris__measure_name(cases[k].measure), with, found[cases[k].measure].value);
        assert_true(with < 0.5);
        assert_true(found[cases[k].measure].value > cases[k].without_mm &&
                    found[cases[k].measure].value > 2.0 * with);
    }
    ris__measurer_destroy(measurer);
}

/* Contact, springs and anchors leave the rest pose where it is. */
static void rest_is_untouched(void **state)
{
    (void)state;
    memset(pose, 0, model->channel_count * sizeof *pose);
    need(ris_sim_reset(sim, &err));
    for (int t = 0; t < 60; ++t) {
        need(ris_sim_tick(sim, pose, &err));
    }
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
    for (uint32_t i = 0; i < model->node_count; ++i) {
        assert_true(v3_distance(v4_xyz(x[i]), v4_xyz(model->rest_position[i])) < 1e-4f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_grid_knows_the_distance),   cmocka_unit_test(the_heads_grids_are_its_bones),
        cmocka_unit_test(a_push_is_what_it_should_be), cmocka_unit_test(middles_have_two_ends),
        cmocka_unit_test(contact_keeps_apart),         cmocka_unit_test(rest_is_untouched),
    };
    return cmocka_run_group_tests(tests, open_loaded_head, close_loaded_head);
}
