/* Bodies of muscles without a device: closed and outward, as wide and high as their segments, higher by the bulge, turned
 * with the jaw; and what is projected into a picture. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "draw/muscle_mesh.h"
#include "mesh_head.h"
#include "model/vec3.h"
#include "risorius/draw.h"
#include "scenes/scenes.h"

#define GOOD(call)                                                                                           \
    do {                                                                                                     \
        if ((call) != RIS_OK) {                                                                              \
            fail_msg("%s: %s", #call, err.text);                                                             \
        }                                                                                                    \
    } while (0)

/* The muscles of the built scene, placed as they are in sim (NULL = at rest). */
static ris_vec4 *place(ris_muscle_mesh *mesh, const ris_sim *sim)
{
    ris_vec4 *position = calloc(mesh->vertex_count, sizeof *position),
             *normal = calloc(mesh->vertex_count, sizeof *normal);
    assert_true(position && normal);
    ris__muscle_mesh_place(mesh, sim, position, normal);
    free(normal);
    return position;
}

/* Edges that do not run once each way. */
static uint32_t open_edges(const ris_muscle_mesh *mesh, const ris_muscle_body *body)
{
    const uint32_t *index = mesh->index + body->first_index, count = body->index_count;
    uint32_t open = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t a = index[i], b = index[i % 3 == 2 ? i - 2 : i + 1];
        uint32_t same = 0, back = 0;
        for (uint32_t k = 0; k < count; k++) {
            const uint32_t c = index[k], d = index[k % 3 == 2 ? k - 2 : k + 1];
            same += a == c && b == d;
            back += a == d && b == c;
        }
        open += same != 1 || back != 1;
    }
    return open;
}

/* Six times the enclosed volume. */
static double volume6(const ris_muscle_mesh *mesh, const ris_muscle_body *body, const ris_vec4 *position)
{
    double sum = 0.0;
    for (uint32_t i = body->first_index; i < body->first_index + body->index_count; i += 3) {
        const ris_vec3 a = v4_xyz(position[mesh->index[i]]), b = v4_xyz(position[mesh->index[i + 1]]),
                       c = v4_xyz(position[mesh->index[i + 2]]);
        sum += (double)v3_dot(a, v3_cross(b, c));
    }
    return sum;
}

static void bodies_are_closed_and_outward(void **state)
{
    (void)state;
    ris_error err = {0};
    const ris_scene_def def = ris_default_scene_def();
    ris_model *model;
    ris_muscle_mesh mesh;
    GOOD(ris_scene_model(&def, &model, &err));
    GOOD(ris__muscle_mesh_build(model, &mesh, &err));
    ris_vec4 *position = place(&mesh, NULL);
    bool linear = false, ring = false, wide = false;
    for (uint32_t m = 0; m < model->muscle_count; m++) {
        assert_int_equal(open_edges(&mesh, &mesh.body[m]), 0);
        assert_true(volume6(&mesh, &mesh.body[m], position) > 0.0);
        linear = linear || model->muscle[m].kind == RIS_MUSCLE_LINEAR;
        ring = ring || model->muscle[m].kind == RIS_MUSCLE_SPHINCTER;
        wide = wide || model->muscle[m].fiber_count > 1;
    }
    assert_true(linear && ring && wide);
    mesh.index[mesh.body[0].first_index] =
        mesh.index[mesh.body[0].first_index + 1]; /* a spoilt face is seen */
    assert_true(open_edges(&mesh, &mesh.body[0]) > 0);
    free(position);
    ris__muscle_mesh_finish(&mesh);
    ris_model_destroy(model);
}

/* A flat skin with one straight muscle of three fibres 5 mm wide and six rows 8 mm apart, along +y. */
static ris_model *straight(ris_head *head, bool reversed)
{
    ris_error err = {0};
    ris_scene_def def = ris_default_scene_def();
    ris_vec3 grid[6 * 4];
    ris_model *model;
    def.radius_mm = 0.0f;
    def.rig = false;
    GOOD(ris_scene_head(&def, head, &err));
    for (uint32_t r = 0; r < 6; r++) {
        for (uint32_t c = 0; c < 4; c++) {
            grid[4 * r + c] = (ris_vec3){(reversed ? -1.0f : 1.0f) * (5.0f * (float)c - 7.5f),
                                         8.0f * (float)r - 20.0f, 0.0f};
        }
    }
    set_muscle(add_muscles(head, 1), "flat", 6, 4, grid);
    GOOD(ris_model_create(head, &model, &err));
    return model;
}

/* Width (x) and height (z) of the row of a body that lies in the middle of a segment. */
static void section(const ris_muscle_mesh *mesh, const ris_vec4 *position, uint32_t segment, float *width,
                    float *height)
{
    const ris_muscle_body *body = &mesh->body[0];
    const float middle = ((float)segment + 0.5f) / 5.0f;
    ris_vec3 low = {1e9f, 1e9f, 1e9f}, high = {-1e9f, -1e9f, -1e9f};
    uint32_t found = 0;
    for (uint32_t v = body->first_vertex; v < body->first_vertex + body->row_count * body->ring_count; v++) {
        if (fabsf(mesh->along[v] - middle) < 1e-4f) {
            low = v3(f_min(low.x, position[v].x), 0.0f, f_min(low.z, position[v].z));
            high = v3(f_max(high.x, position[v].x), 0.0f, f_max(high.z, position[v].z));
            found++;
        }
    }
    assert_int_equal(found, body->ring_count);
    *width = high.x - low.x;
    *height = high.z - low.z;
}

static void sections_are_the_segments(void **state)
{
    (void)state;
    for (int reversed = 0; reversed < 2; reversed++) {
        ris_error err = {0};
        ris_head head;
        ris_model *model = straight(&head, reversed);
        ris_muscle_mesh mesh;
        ris_sim *sim;
        float *pose = calloc(model->channel_count, sizeof *pose), width, height;
        GOOD(ris__muscle_mesh_build(model, &mesh, &err));
        GOOD(ris_sim_create_cpu(model, &sim, &err));
        ris_vec4 *position = place(&mesh, NULL);
        assert_true(volume6(&mesh, &mesh.body[0], position) > 0.0);
        for (uint32_t s = 0; s < 5; s++) {
            section(&mesh, position, s, &width, &height);
            assert_true(fabsf(width - 15.0f) < 1e-3f);
            assert_true(fabsf(height - 4.0f) < 0.01f); /* (2 + 6) / 2 mm */
        }
        /* at full activation the fibre is 20 % shorter and its middle 1 + 1 x 0.2 times as high */
        pose[0] = 1.0f;
        GOOD(ris_sim_tick(sim, pose, &err));
        assert_true(ris_sim_activation(sim, 0) == 1.0f);
        ris_vec4 *bulged = place(&mesh, sim);
        section(&mesh, bulged, 2, &width, &height);
        assert_true(fabsf(width - 15.0f) < 1e-3f);
        assert_true(fabsf(height - 4.8f) < 0.05f);
        section(&mesh, bulged, 0, &width, &height);
        assert_true(fabsf(height - 4.0f) < 0.05f);
        free(position);
        free(bulged);
        free(pose);
        ris_sim_destroy(sim);
        ris__muscle_mesh_finish(&mesh);
        ris_model_destroy(model);
        ris_head_finish(&head);
    }
}

/* A muscle of the jaw turns with it: its fixed end wholly, in both tissues. */
static void muscles_turn_with_the_jaw(void **state)
{
    (void)state;
    for (int tissue = 0; tissue < 2; tissue++) {
        ris_error err = {0};
        ris_scene_def def = ris_default_scene_def();
        ris_model *model;
        ris_sim *sim;
        def.tissue.model = tissue ? RIS_TISSUE_KAEHLER : RIS_TISSUE_RISORIUS;
        def.tissue.substeps = tissue ? 64 : def.tissue.substeps;
        GOOD(ris_scene_model(&def, &model, &err));
        GOOD(ris_sim_create_cpu(model, &sim, &err));
        float *pose = calloc(model->channel_count, sizeof *pose), jaw[12];
        ris_vec3 *point = calloc(model->fiber_point_count, sizeof *point);
        ris_segment *segment = calloc(model->segment_count, sizeof *segment);
        uint32_t on_jaw = 0;
        ris_sim_muscles(sim, point, segment);
        assert_memory_equal(point, model->fiber_point, model->fiber_point_count * sizeof *point);
        pose[ris_model_channel(model, "jaw.open")] = 1.0f;
        GOOD(ris_sim_tick(sim, pose, &err));
        ris_sim_muscles(sim, point, segment);
        ris_sim_bone_transform(sim, RIS_BONE_JAW, jaw);
        for (uint32_t m = 0; m < model->muscle_count; m++) {
            const uint32_t first = model->fiber[model->muscle[m].first_fiber].first_point;
            const ris_vec3 p = model->fiber_point[first], q = point[first];
            const ris_vec3 t = {jaw[0] * p.x + jaw[1] * p.y + jaw[2] * p.z + jaw[3],
                                jaw[4] * p.x + jaw[5] * p.y + jaw[6] * p.z + jaw[7],
                                jaw[8] * p.x + jaw[9] * p.y + jaw[10] * p.z + jaw[11]};
            if (model->muscle[m].kind == RIS_MUSCLE_LINEAR) {
                assert_true(v3_distance(q, model->muscle[m].on_jaw ? t : p) < 1e-3f);
                assert_true(v3_distance(q, model->muscle[m].on_jaw ? p : t) > 0.5f);
                on_jaw += model->muscle[m].on_jaw;
            }
        }
        assert_true(on_jaw > 0);
        for (uint32_t s = 0; s < model->segment_count; s++) { /* frames stay orthogonal */
            assert_true(fabsf(v3_dot(segment[s].along, segment[s].up)) < 1e-4f &&
                        fabsf(v3_length(segment[s].wide) - 1.0f) < 1e-4f);
        }
        free(point);
        free(segment);
        free(pose);
        ris_sim_destroy(sim);
        ris_model_destroy(model);
    }
}

static uint32_t muscle_named(const ris_model *model, const char *name)
{
    for (uint32_t m = 0; m < model->muscle_count; m++) {
        if (strcmp(model->muscle[m].name, name) == 0) {
            return m;
        }
    }
    fail_msg("there is no muscle %s", name);
    return 0;
}

/* How far point `row` of a muscle, counted through its fibres, has come from rest, mm, after a tick with a pose of one
 * channel. */
static ris_vec3 shown_move(const ris_model *model, const char *channel, const char *muscle, uint32_t row)
{
    ris_error err = {0};
    ris_sim *sim;
    float *pose = calloc(model->channel_count, sizeof *pose);
    ris_vec3 *point = calloc(model->fiber_point_count, sizeof *point);
    ris_segment *segment = calloc(model->segment_count, sizeof *segment);
    assert_true(pose && point && segment && ris_model_channel(model, channel) != UINT32_MAX);
    pose[ris_model_channel(model, channel)] = 1.0f;
    ris_hold hold;
    GOOD(ris_sim_create_cpu(model, &sim, &err));
    GOOD(ris_sim_hold(sim, pose, RIS_TICK_S, &hold, &err)); /* one tick without onset */
    ris_sim_muscles(sim, point, segment);
    const uint32_t at =
        model->fiber[model->muscle[muscle_named(model, muscle)].first_fiber].first_point + row;
    const ris_vec3 move = v3_sub(point[at], model->fiber_point[at]);
    GOOD(ris_sim_reset(sim, &err)); /* a reset takes everything back */
    ris_sim_muscles(sim, point, segment);
    assert_true(v3_distance(point[at], model->fiber_point[at]) < 1e-6f);
    ris_sim_destroy(sim);
    free(pose);
    free(point);
    free(segment);
    return move;
}

/* On the reference head: the ring of the lower lip goes down with the jaw and the upper one stays; both follow a pulled
 * corner, that of their side only; the ring of the lids and the lifter's end go down with a lid that closes, on its own side. */
static void rings_follow_jaw_corner_and_lid(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_model *model;
    GOOD(ris_model_load(RIS_SOURCE_DIR "/assets/human", &model, &err));
    const uint32_t lower = muscle_named(model, "orbicularis_oris_inferior"),
                   middle = model->muscle[lower].point_count / 2;
    const float down = -shown_move(model, "jaw.open", "orbicularis_oris_inferior", middle).y;
    assert_true(down > 20.0f);
    assert_true(fabsf(shown_move(model, "jaw.open", "orbicularis_oris_superior", middle).y) < 0.15f * down);
    const uint32_t last = model->muscle[muscle_named(model, "orbicularis_oris_superior")].point_count - 1;
    const ris_vec3 pulled = shown_move(model, "zygomaticus_major.L", "orbicularis_oris_superior", last);
    assert_true(pulled.x > 2.0f && pulled.y > 2.0f); /* out and up: the last row is on the subject's left */
    assert_true(v3_length(shown_move(model, "zygomaticus_major.L", "orbicularis_oris_superior", 0)) < 0.01f);
    /* what holds neither skin nor jaw stays with the skull */
    const uint32_t lifter = muscle_named(model, "levator_palpebrae_superioris.L"),
                   end = model->muscle[lifter].point_count - 1;
    assert_true(v3_length(shown_move(model, "jaw.open", "levator_palpebrae_superioris.L", end)) < 0.01f);
    float lid = 0.0f;
    for (uint32_t f = 0; f < model->muscle[lifter].fiber_count; f++) {
        lid = f_max(lid, -shown_move(model, "lid.upper.L", "levator_palpebrae_superioris.L",
                                     f * model->muscle[lifter].point_count + end)
                              .y);
    }
    print_message("the lifter's end comes down by %.2f mm\n", (double)lid);
    assert_true(lid > 1.0f);
    assert_true(v3_length(shown_move(model, "lid.upper.L", "levator_palpebrae_superioris.L", 0)) < 0.01f);
    const ris_muscle *ring = &model->muscle[muscle_named(model, "orbicularis_oculi_palpebral.L")];
    const uint32_t n = ring->point_count * ring->fiber_count;
    float most = 0.0f, other = 0.0f;
    for (uint32_t row = 0; row < n; row++) {
        most = f_max(most, -shown_move(model, "lid.upper.L", "orbicularis_oculi_palpebral.L", row).y);
        other =
            f_max(other, v3_length(shown_move(model, "lid.upper.L", "orbicularis_oculi_palpebral.R", row)));
    }
    print_message("the ring of the lid comes down by %.2f mm, that of the other by %.4f\n", (double)most,
                  (double)other);
    assert_true(most > 2.0f && other < 0.01f);
    ris_model_destroy(model);
}

static void points_are_projected(void **state)
{
    (void)state;
    const ris_camera camera = {.eye = {0, 0, 100}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov_y_deg = 90.0f};
    float x, y, far;
    assert_true(ris_camera_project(&camera, 200, 100, (ris_vec3){0, 0, 0}, &x, &y, &far));
    assert_true(fabsf(x - 100.0f) < 1e-3f && fabsf(y - 50.0f) < 1e-3f && fabsf(far - 100.0f) < 1e-3f);
    assert_true(ris_camera_project(&camera, 200, 100, (ris_vec3){50, 50, 0}, &x, &y, NULL));
    assert_true(fabsf(x - 125.0f) < 1e-3f && fabsf(y - 25.0f) < 1e-3f); /* up is a smaller row */
    assert_false(ris_camera_project(&camera, 200, 100, (ris_vec3){0, 0, 101}, &x, &y, NULL));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bodies_are_closed_and_outward), cmocka_unit_test(sections_are_the_segments),
        cmocka_unit_test(muscles_turn_with_the_jaw),     cmocka_unit_test(rings_follow_jaw_corner_and_lid),
        cmocka_unit_test(points_are_projected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
