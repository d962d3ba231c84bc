/* The bake, against hand-computed numbers: KA-02, 09, 10, 11, 13, 23, 24, 38, 40, 41, 42, 28, 48 and the
 * bending umbrella. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/channel.h"
#include "mesh_head.h"
#include "model/vec3.h"
#include "scenes/scenes.h"

#define assert_near(a, b, tolerance) assert_float_equal((float)(a), (float)(b), (float)(tolerance))

static ris_model *bake(const ris_head *head)
{
    ris_error err = {0};
    ris_model *model = NULL;
    if (ris_model_create(head, &model, &err) != RIS_OK) {
        fail_msg("%s", err.text);
    }
    return model;
}

static void expect_refusal(const ris_head *head, const char *part)
{
    ris_error err = {0};
    ris_model *model = NULL;
    assert_int_equal(ris_model_create(head, &model, &err), RIS_ERROR_DATA);
    assert_null(model);
    if (!strstr(err.text, part)) {
        fail_msg("\"%s\" does not say \"%s\"", err.text, part);
    }
}

/* KA-11: two equilateral triangles of side 1: interior edge g = 0.8660, boundary edges half of it; any
 * scale. */
static void area_ratio_of_equilateral_edges(void **state)
{
    (void)state;
    const float h = 0.8660254f, scales[] = {1.0f, 7.5f};
    for (int s = 0; s < 2; ++s) {
        const float q = scales[s];
        const ris_vec3 p[] = {{0, 0, 0}, {q, 0, 0}, {0.5f * q, h * q, 0}, {0.5f * q, -h * q, 0}};
        const uint32_t corners[] = {3, 3}, v[] = {0, 1, 2, 1, 0, 3};
        ris_head head = mesh_head(4, p, 2, corners, v, NULL);
        ris_model *model = bake(&head);
        assert_int_equal(model->spring_count, 5);
        assert_int_equal(model->half_spring_count, 10);
        assert_near(find_spring(model, 0, 1)->area_ratio * 100.0f, 86.6025, 1e-3);
        assert_near(find_spring(model, 1, 0)->area_ratio * 100.0f, 86.6025, 1e-3);
        assert_near(find_spring(model, 0, 2)->area_ratio * 100.0f, 43.3013, 1e-3);
        assert_near(find_spring(model, 0, 1)->rest_mm, q, 1e-6);
        assert_null(find_spring(model, 2, 3));
        ris_model_destroy(model);
        ris_head_finish(&head);
    }
}

/* KA-11: right-isosceles grid of unit legs: interior legs 100, diagonals 50 on the low modulus. */
static void area_ratio_of_right_isosceles_grid(void **state)
{
    (void)state;
    ris_vec3 p[9];
    for (uint32_t i = 0; i < 9; ++i) {
        p[i] = v3((float)(i % 3), (float)(i / 3), 0);
    }
    const uint32_t corners[] = {3, 3, 3, 3, 3, 3, 3, 3};
    const uint32_t v[] = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 3, 4, 7, 3, 7, 6, 4, 5, 8, 4, 8, 7};
    ris_head head = mesh_head(9, p, 8, corners, v, NULL);
    ris_model *model = bake(&head);
    assert_near(find_spring(model, 4, 1)->area_ratio * 100.0f, 100.0, 1e-4);
    assert_near(find_spring(model, 4, 5)->area_ratio * 100.0f, 100.0, 1e-4);
    assert_near(find_spring(model, 4, 0)->area_ratio * 100.0f, 50.0, 1e-4);
    assert_near(model->node_area_mm2[4], 1.0, 1e-6);
    ris_model_destroy(model);
    ris_head_finish(&head);
}

/* KA-13: 0.1450 m^2 of skin, 2 mm thick, 1027 vertices give 0.31061 g; here the same ratio on 4 vertices. */
static void mass_from_density(void **state)
{
    (void)state;
    const float side = sqrtf(0.1450f * 1e6f * 4.0f / 1027.0f);
    const ris_vec3 p[] = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
    const uint32_t corners[] = {4}, v[] = {0, 1, 2, 3};
    ris_head head = mesh_head(4, p, 1, corners, v, NULL);
    head.tissue.model = RIS_TISSUE_KAEHLER;
    ris_model *model = bake(&head);
    assert_near(model->mass_g, 0.31061, 1e-5);
    assert_near(model->rest_position[0].w, 1.0 / 0.31061, 1e-3);
    assert_near(model->push.damping_per_s, 30.0 / 0.31061, 1e-2);
    ris_model_destroy(model);
    ris_head_finish(&head);
}

/* KA-02: of a kite the shorter diagonal; of equal diagonals the one at the topmost vertex, on both sides
 * of the mirror. */
static void quads_split_mirror_symmetrically(void **state)
{
    (void)state;
    const ris_vec3 p[] = {{1, 0, 0},  {2, 0, 0},  {2, 1, 0}, {1, 1, 0},  {-1, 0, 0},      {-2, 0, 0},
                          {-2, 1, 0}, {-1, 1, 0}, {3, 0, 0}, {4, -1, 0}, {4.5f, 1.5f, 0}, {3, 1, 0}};
    const uint32_t corners[] = {4, 4, 4}, v[] = {0, 1, 2, 3, 5, 4, 7, 6, 8, 9, 10, 11};
    ris_head head = mesh_head(12, p, 3, corners, v, NULL);
    ris_model *model = bake(&head);
    assert_int_equal(model->triangle_count, 6);
    assert_non_null(find_spring(model, 0, 2)); /* (2, 1) is above (1, 1) in y, z, |x| */
    assert_null(find_spring(model, 1, 3));
    assert_non_null(find_spring(model, 4, 6)); /* and so is its mirror image */
    assert_null(find_spring(model, 5, 7));
    assert_non_null(find_spring(model, 8, 10)); /* 2.12 against 2.24 */
    assert_null(find_spring(model, 9, 11));
    for (uint32_t t = 0; t < 18; ++t) {
        assert_int_equal(model->triangle[t], head.skin.face_vertex[model->triangle_corner[t]]);
    }
    ris_model_destroy(model);
    ris_head_finish(&head);
}

static void bad_meshes_are_refused(void **state)
{
    (void)state;
    const ris_vec3 p[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, {0, 0, 1}};
    const uint32_t three[] = {3, 3, 3};
    const uint32_t turned[] = {0, 1, 2, 0, 1, 3, 0, 2, 4};
    ris_head head = mesh_head(5, p, 3, three, turned, NULL);
    expect_refusal(&head, "edge 0-1");
    ris_head_finish(&head);

    const uint32_t lonely[] = {0, 1, 2};
    head = mesh_head(5, p, 1, three, lonely, NULL);
    expect_refusal(&head, "vertex 3");
    ris_head_finish(&head);

    const ris_vec3 flat[] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    head = mesh_head(3, flat, 1, three, lonely, NULL);
    expect_refusal(&head, "no area");
    ris_head_finish(&head);

    head = mesh_head(3, p, 1, three, lonely, NULL);
    snprintf(head.simulated, sizeof head.simulated, "nowhere");
    expect_refusal(&head, "nowhere");
    ris_head_finish(&head);
}

/* Spec 2.9: too long a step is refused with the number of substeps that suffices, and that number is then
 * accepted. */
static void unstable_substeps_are_refused(void **state)
{
    (void)state;
    ris_scene_def def = ris_default_scene_def();
    def.columns = def.rows = 9;
    def.rig = false;
    ris_model *model = NULL;
    ris_error err = {0};
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_OK);
    assert_true(model->stable_dt_s > model->push.dt_s);
    ris_model_destroy(model);
    def.tissue.stiffness_scale = 400.0f;
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_ERROR_DATA);
    const char *needed = strstr(err.text, "at least ");
    assert_non_null(needed);
    def.tissue.substeps = (uint32_t)strtoul(needed + 9, NULL, 10);
    assert_true(def.tissue.substeps > 8);
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_OK);
    ris_model_destroy(model);
    def.tissue.substeps -= 1;
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_ERROR_DATA);
}

/* Of the umbrella of a node whose edges are 1 to 4 mm long, g/s^2. */
static float stiffness_of(const ris_tissue_def *tissue, const ris_model *model, uint32_t i)
{
    float sum = 0.0f;
    for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
        sum += model->half_spring[h].rest_mm;
    }
    const float mean = sum / (float)(model->spring_start[i + 1] - model->spring_start[i]);
    return tissue->bending * tissue->stiffness_scale * 20.25f / (mean * mean);
}

static uint32_t springs_of(const ris_model *model, uint32_t i)
{
    return model->spring_start[i + 1] - model->spring_start[i];
}

/* The list of the stages: every moving node once, those with more springs first (fewer nodes than a window holds). */
static void check_moving_list(const ris_model *model)
{
    uint8_t seen[512] = {0};
    assert_true(model->node_count <= sizeof seen);
    assert_int_equal(model->push.moving_count, model->moving_count);
    for (uint32_t k = 0; k < model->moving_count; ++k) {
        const uint32_t i = model->moving[k];
        assert_true(i < model->node_count && model->rest_position[i].w > 0.0f && seen[i]++ == 0);
        assert_true(k == 0 || springs_of(model, model->moving[k - 1]) >= springs_of(model, i));
    }
}

/* KA-09, and the umbrella: weights of a moving node sum to 1, the transpose carries the stiffness, which grows
 * as edges get shorter than 4.5 mm; static umbrellas are left out. */
static void moving_nodes_and_umbrellas(void **state)
{
    (void)state;
    ris_scene_def def = ris_default_scene_def();
    def.columns = 11;
    def.rig = false;
    def.rows = 13;
    ris_model *model = NULL;
    ris_error err = {0};
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_OK);
    assert_int_equal(model->moving_count, 9 * 11);
    check_moving_list(model);
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const bool moves = model->rest_position[i].w > 0.0f;
        float sum = 0.0f;
        for (uint32_t h = model->spring_start[i]; h < model->spring_start[i + 1]; ++h) {
            const ris_half_spring *half = &model->half_spring[h], *back = find_spring(model, half->other, i);
            assert_non_null(back);
            assert_true(back->rest_mm == half->rest_mm && back->area_ratio == half->area_ratio);
            assert_near(half->bend_in, stiffness_of(&def.tissue, model, half->other) * back->bend_out, 1e-2);
            sum += half->bend_out;
        }
        assert_near(sum, moves ? 1.0 : 0.0, 1e-5);
        assert_near(model->anchor_param[i].bend, moves ? stiffness_of(&def.tissue, model, i) : 0.0f, 1e-2);
        assert_true(!moves ||
                    (model->anchor_param[i].normal > 0.0f && model->anchor_param[i].tangential > 0.0f));
    }
    ris_model_destroy(model);
}

static ris_head flat_skin(void)
{
    static ris_vec3 p[21 * 21];
    static uint32_t corners[400], v[1600];
    for (uint32_t i = 0; i < 441; ++i) {
        p[i] = v3((float)(i % 21) * 4.0f - 40.0f, (float)(i / 21) * 4.0f - 40.0f, 0.0f);
    }
    for (uint32_t f = 0; f < 400; ++f) {
        const uint32_t a = f / 20 * 21 + f % 20, quad[4] = {a, a + 1, a + 22, a + 21};
        corners[f] = 4;
        memcpy(v + 4 * (size_t)f, quad, sizeof quad);
    }
    return mesh_head(441, p, 400, corners, v, NULL);
}

/* KA-38: on flat skin the grid lies 4.0 mm deep, 4 mm thick; KA-40: 7 x 3 points give 2 fibres of 7
 * points. */
static void grids_sink_below_flat_skin(void **state)
{
    (void)state;
    ris_head head = flat_skin();
    ris_vec3 grid[21];
    for (uint32_t k = 0; k < 21; ++k) {
        grid[k] = v3((float)(k % 3) * 5.0f - 5.0f, (float)(k / 3) * 5.0f - 15.0f,
                     1.5f); /* above the skin: it is projected */
    }
    set_muscle(add_muscles(&head, 1), "test_muscle.L", 7, 3, grid);
    ris_model *model = bake(&head);
    assert_int_equal(model->fiber_count, 2);
    assert_int_equal(model->muscle[0].point_count, 7);
    assert_int_equal(model->segment_count, 12);
    for (uint32_t k = 0; k < model->fiber_point_count; ++k) {
        assert_near(model->fiber_point[k].z, -4.0, 1e-5);
        assert_near(model->fiber_point[k].x, k < 7 ? -2.5 : 2.5, 1e-5);
    }
    for (uint32_t s = 0; s < model->segment_count; ++s) { /* KA-24 */
        const ris_segment *segment = &model->segment[s];
        assert_near(segment->size.x, 5.0, 1e-4);
        assert_near(segment->size.y, 4.0, 1e-6);
        assert_near(segment->size.z, 5.0, 1e-4);
        assert_near(segment->up.z, 1.0, 1e-6);
        assert_near(segment->along.y, 1.0, 1e-6);
        assert_near(v3_dot(v3_cross(segment->along, segment->up), segment->wide), 1.0, 1e-6);
    }
    assert_false(model->muscle[0].on_jaw);
    ris_model_destroy(model);

    for (uint32_t i = 0; i < head.skin.vertex_count;
         ++i) { /* KA-41: a jaw below y = 12 wins the vote of most rows */
        head.jaw_weight[i] = head.skin.position[i].y < 10.0f ? 1.0f : 0.0f;
    }
    head.muscle[0].bone = RIS_BONE_AUTO;
    model = bake(&head);
    assert_true(model->muscle[0].on_jaw);
    ris_model_destroy(model);

    ris_muscle_def *def = &head.muscle[0];
    ris_vec3 *small = def->grid, wide[55]; /* KA-40: 11 x 5 points give 4 fibres of 11 points */
    for (uint32_t k = 0; k < 55; ++k) {
        wide[k] = v3((float)(k % 5) * 5.0f - 10.0f, (float)(k / 5) * 5.0f - 25.0f, 0.0f);
    }
    def->grid = wide;
    def->rows = 11;
    def->columns = 5;
    model = bake(&head);
    assert_int_equal(model->fiber_count, 4);
    assert_int_equal(model->muscle[0].point_count, 11);
    ris_model_destroy(model);
    def->grid = small;
    def->rows = 7;
    def->columns = 3;

    head.muscle[0].grid[20].z = 90.0f;
    expect_refusal(&head, "row 6, column 2");
    head.muscle[0].rows = 1;
    expect_refusal(&head, "1 x 3");
    ris_head_finish(&head);
}

/* Weights of the default tissue on flat skin: none before the insertion profile starts, all at its end,
 * none beyond the radius; an explicit attach list restricts them. */
static void weights_follow_profile_radius_and_list(void **state)
{
    (void)state;
    ris_head head = flat_skin();
    const ris_vec3 grid[4] = {{-4, -20, 0}, {4, -20, 0}, {-4, 20, 0}, {4, 20, 0}};
    ris_muscle_def *def = add_muscles(&head, 1);
    set_muscle(def, "test_muscle.L", 2, 2, grid);
    def->insertion_start = 0.5f;
    def->radius_mm = 8.0f;
    ris_model *model = bake(&head);
    uint32_t bound = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const ris_vec4 x = model->rest_position[i];
        const uint32_t count = model->binding_start[i + 1] - model->binding_start[i];
        bound += count;
        assert_true(count == 0 || (x.y > 0.0f && fabsf(x.x) < 17.0f));
        if (x.x == 0.0f && x.y == 20.0f) {
            assert_int_equal(count, 1);
            assert_near(model->binding[model->binding_start[i]].weight, 1.0, 1e-3);
            assert_near(model->binding[model->binding_start[i]].along, 1.0, 1e-5);
        }
        if (x.x == 0.0f && x.y == 8.0f) { /* t = 0.7: smoothstep(1.2 x 0.4) */
            assert_near(model->binding[model->binding_start[i]].weight, 0.48 * 0.48 * (3.0 - 0.96), 1e-3);
        }
    }
    assert_true(bound > 20);
    ris_model_destroy(model);

    def->attach_auto = false;
    def->attach_count = 1;
    def->attach = malloc(sizeof *def->attach);
    def->attach[0] = 15 * 21 + 10; /* (0, 20) */
    model = bake(&head);
    assert_int_equal(model->binding_start[model->node_count], 1);
    ris_model_destroy(model);
    def->attach[0] = 441;
    expect_refusal(&head, "vertex 441");
    ris_head_finish(&head);
}

/* KA-42: closed lips. Two skins face each other 0.4 mm apart with a muscle behind each: every vertex binds
 * to its own. */
static void closed_lips_do_not_mix(void **state)
{
    (void)state;
    ris_vec3 p[50];
    uint32_t corners[32], v[128];
    for (uint32_t k = 0; k < 50; ++k) {
        const uint32_t i = k % 25;
        p[k] = v3((float)(i % 5) * 4.0f - 8.0f, k < 25 ? 0.2f : -0.2f, (float)(i / 5) * 4.0f - 8.0f);
    }
    for (uint32_t k = 0; k < 32; ++k) {
        const uint32_t f = k % 16, base = k < 16 ? 0 : 25, a = base + f / 4 * 5 + f % 4;
        const uint32_t up[4] = {a, a + 1, a + 6, a + 5}, down[4] = {a, a + 5, a + 6, a + 1};
        corners[k] = 4; /* x then z: that order looks down */
        memcpy(v + 4 * (size_t)k, k < 16 ? up : down, sizeof up);
    }
    for (int literal = 0; literal < 2; ++literal) {
        ris_head head = mesh_head(50, p, 32, corners, v, NULL);
        head.tissue.model = literal ? RIS_TISSUE_KAEHLER : RIS_TISSUE_RISORIUS;
        head.tissue.substeps = 64;
        const ris_vec3 upper[4] = {{-6, 0.3f, -6}, {6, 0.3f, -6}, {-6, 0.3f, 6}, {6, 0.3f, 6}};
        const ris_vec3 lower[4] = {{-6, -0.3f, -6}, {6, -0.3f, -6}, {-6, -0.3f, 6}, {6, -0.3f, 6}};
        ris_muscle_def *def = add_muscles(&head, 2);
        set_muscle(&def[0], "upper_muscle", 2, 2, upper);
        set_muscle(&def[1], "lower_muscle", 2, 2, lower);
        ris_model *model = bake(&head);
        assert_near(model->rest_normal[0].y, -1.0, 1e-6);
        uint32_t seen[2] = {0};
        for (uint32_t i = 0; i < 50; ++i) {
            for (uint32_t b = model->binding_start[i]; b < model->binding_start[i + 1]; ++b) {
                assert_int_equal(model->binding[b].muscle, i < 25 ? 0 : 1);
                ++seen[model->binding[b].muscle];
            }
        }
        assert_true(seen[0] > 10 && seen[1] > 10);
        ris_model_destroy(model);
        ris_head_finish(&head);
    }
}

/* KA-28 on the scene: each corner of the mouth joins its two pullers and both halves of the orbicularis;
 * the brow joins nothing. */
static void corners_of_the_mouth_are_groups(void **state)
{
    (void)state;
    ris_scene_def def = ris_default_scene_def();
    ris_model *model = NULL;
    ris_error err = {0};
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_OK);
    assert_int_equal(model->group_count, 2);
    for (uint32_t g = 0; g < 2; ++g) {
        assert_int_equal(model->group[g].point_count, 4);
        for (uint32_t k = 0; k < 4; ++k) {
            const ris_group_point *point = &model->group_point[model->group[g].first_point + k];
            const char *name = model->muscle[point->muscle].name;
            assert_null(strstr(name, "frontalis"));
            assert_null(strstr(name, g == 0 ? ".R" : ".L"));
            assert_true(point->rest_distance_mm > 0.0f && point->rest_distance_mm < 8.0f);
        }
    }
    ris_model_destroy(model);
}

/* KA-48: muscles first, then the channels beside them, in the order the pose stage counts on, then the movable centres. */
static void channels_are_muscles_then_beside(void **state)
{
    (void)state;
    static const char *const order[] = {
        "jaw.open",     "jaw.forward",  "jaw.side",   "eye.yaw.L",      "eye.yaw.R",
        "eye.pitch.L",  "eye.pitch.R",  "head.yaw",   "head.pitch",     "head.roll",
        "head.x",       "head.y",       "head.z",     "lid.upper.L",    "lid.upper.R",
        "lid.lower.L",  "lid.lower.R",  "tongue.out", "tongue.tip",     "tongue.wide",
        "cheek.puff.L", "cheek.puff.R", "lips.close", "lip.upper.roll", "lip.lower.roll"};
    ris_scene_def def = ris_default_scene_def();
    ris_model *model = NULL;
    ris_error err = {0};
    assert_int_equal(ris_scene_model(&def, &model, &err), RIS_OK);
    assert_int_equal(model->channel_count, model->muscle_count + ris__beside_channel_count + 2);
    const uint32_t protrude = ris_model_channel(model, "orbicularis_oris_inferior.protrude");
    assert_int_equal(protrude, model->channel_count - 1);
    assert_int_equal(model->muscle[ris_model_channel(model, "orbicularis_oris_inferior")].protrude_channel,
                     protrude);
    assert_int_equal(model->muscle[0].protrude_channel, UINT32_MAX);
    assert_true(model->channel[protrude].minimum == 0.0f && model->channel[protrude].maximum == 1.0f);
    assert_int_equal(ris__beside_channel_count, sizeof order / sizeof order[0]);
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        assert_string_equal(model->channel[m].name, model->muscle[m].name);
        assert_true(model->channel[m].minimum == 0.0f && model->channel[m].maximum == 1.0f);
    }
    for (uint32_t k = 0; k < ris__beside_channel_count; ++k) {
        assert_string_equal(model->channel[model->muscle_count + k].name, order[k]);
        assert_int_equal(ris_model_channel(model, order[k]), model->muscle_count + k);
    }
    char name[RIS_NAME_SIZE];
    ris_muscle_def sphincter = {.kind = RIS_MUSCLE_SPHINCTER, .name = "ring.L"};
    assert_true(ris__protrude_channel(&sphincter, name));
    assert_string_equal(name, "ring.protrude.L");
    sphincter.closes_on_line = true;
    assert_false(ris__protrude_channel(&sphincter, name));
    assert_int_equal(ris_model_channel(model, "jaw.opn"), UINT32_MAX);
    ris_model_destroy(model);
    ris_model_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(area_ratio_of_equilateral_edges),
        cmocka_unit_test(area_ratio_of_right_isosceles_grid),
        cmocka_unit_test(mass_from_density),
        cmocka_unit_test(quads_split_mirror_symmetrically),
        cmocka_unit_test(bad_meshes_are_refused),
        cmocka_unit_test(unstable_substeps_are_refused),
        cmocka_unit_test(moving_nodes_and_umbrellas),
        cmocka_unit_test(grids_sink_below_flat_skin),
        cmocka_unit_test(weights_follow_profile_radius_and_list),
        cmocka_unit_test(closed_lips_do_not_mix),
        cmocka_unit_test(corners_of_the_mouth_are_groups),
        cmocka_unit_test(channels_are_muscles_then_beside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
