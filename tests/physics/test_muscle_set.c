/* The whole muscle set of the reference head: no dead muscle (KA-48), no folded skin, mirrored activation
 * mirrors the result, linear muscles shorten by activation x max_shortening (KA-31), and every record says
 * where it comes from. */
#include "loaded_head.h"
#include "sim/rig.h"

static bool *inside; /* node of the lips, the mouth, the lids or the socket, where skin may roll in */

static void mark_inside(void)
{
    static const char *const names[] = {"lips", "inner_lip_rim", "mouth_cavity", "lids", "eye_socket"};
    for (size_t k = 0; k < sizeof names / sizeof *names; ++k) {
        const ris_region *region = ris_head_region(model->head, names[k]);
        for (uint32_t i = 0; region && i < region->count; ++i) {
            inside[region->vertex[i]] = true;
        }
    }
}

static int open_head(void **state)
{
    (void)state;
    if (load_head() != 0) {
        return -1;
    }
    inside = calloc(model->node_count, sizeof *inside);
    if (!inside) {
        return -1;
    }
    mark_inside();
    return 0;
}

static int close_head(void **state)
{
    (void)state;
    free_head();
    free(inside);
    return 0;
}

/* Holds `pose` as it stands. */
static void settle_pose(void)
{
    need(ris_sim_reset(sim, &err));
    for (int i = 0; i < 20; ++i) {
        need(ris_sim_tick(sim, pose, &err));
    }
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
}

/* Muscles are the first channels. The slowest mode decays in 0.1 s, six ticks. */
static void hold(uint32_t muscle, float activation, int ticks)
{
    memset(pose, 0, model->channel_count * sizeof *pose);
    pose[muscle] = activation;
    need(ris_sim_reset(sim, &err));
    for (int i = 0; i < ticks; ++i) {
        need(ris_sim_tick(sim, pose, &err));
    }
    need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
}

static float largest_motion(void)
{
    float most = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        most = f_max(most, v3_distance(v4_xyz(x[i]), v4_xyz(model->rest_position[i])));
    }
    return most;
}

/* Triangles of the outer skin whose normal has turned by more than 90 degrees. */
static uint32_t folded(void)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        if (!inside[v[0]] && !inside[v[1]] && !inside[v[2]]) {
            count += v3_dot(triangle_cross(x, v), triangle_cross(model->rest_position, v)) < 0.0f;
        }
    }
    return count;
}

static uint32_t channel_index(const char *name)
{
    for (uint32_t c = 0; c < model->channel_count; ++c) {
        if (strcmp(model->channel[c].name, name) == 0) {
            return c;
        }
    }
    fail_msg("no channel %s", name);
    return 0;
}

static void every_muscle_moves_and_folds_nothing(void **state)
{
    (void)state;
    assert_true(model->muscle_count >= 40);
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        hold(m, 1.0f, 20);
        const float most = largest_motion();
        if (most < 0.5f || most > 15.0f) {
            fail_msg("%s moves the skin by %.2f mm at most", model->muscle[m].name, (double)most);
        }
        if (folded() > 0) {
            fail_msg("%s folds %u triangles of the outer skin", model->muscle[m].name, folded());
        }
    }
    for (uint32_t i = 0; i < model->node_count; ++i) { /* control: skin turned inside out is found */
        x[i] = model->rest_position[i];
        x[i].z = -x[i].z;
    }
    assert_true(folded() > 1000);
}

/* The state of the left muscle, mirrored, is the state of the right one. */
static void sides_mirror(void **state)
{
    (void)state;
    ris_vec4 *left = malloc(model->node_count * sizeof *left);
    assert_non_null(left);
    uint32_t pairs = 0;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        char other[RIS_NAME_SIZE];
        const size_t length = strlen(model->muscle[m].name);
        if (strcmp(model->muscle[m].name + length - 2, ".L") != 0) {
            continue;
        }
        memcpy(other, model->muscle[m].name, length + 1);
        other[length - 1] = 'R';
        hold(m, 0.7f, 8);
        memcpy(left, x, model->node_count * sizeof *left);
        hold(channel_index(other), 0.7f, 8);
        float gap = 0.0f, lopsided = 0.0f;
        for (uint32_t i = 0; i < model->node_count; ++i) {
            if (mirror[i] != UINT32_MAX) {
                const ris_vec4 p = x[mirror[i]], q = left[mirror[i]];
                gap = f_max(gap, v3_distance(v4_xyz(left[i]), v3(-p.x, p.y, p.z)));
                lopsided = f_max(lopsided, v3_distance(v4_xyz(left[i]), v3(-q.x, q.y, q.z)));
            }
        }
        if (gap >= 0.01f) {
            fail_msg("%s and %s differ by %.4f mm", model->muscle[m].name, other, (double)gap);
        }
        const ris_muscle_def *def = model->muscle[m].def;
        if (def->end_bone == RIS_BONE_AUTO || def->gain > 0.0f || def->drives[2] != 0.0f) {
            assert_true(lopsided > 0.1f); /* control: one side alone is not symmetric */
        } else {
            assert_true(lopsided < 0.01f); /* deep, and opens the jaw straight */
        }
        ++pairs;
    }
    free(left);
    assert_true(pairs >= 20);
}

static float fiber_length(const ris_vec3 *p, uint32_t count)
{
    float length = 0.0f;
    for (uint32_t i = 1; i < count; ++i) {
        length += v3_distance(p[i], p[i - 1]);
    }
    return length;
}

static void linear_muscles_shorten_as_told(void **state) /* within 2 % of the length of each fibre */
{
    (void)state;
    ris_vec3 *q = malloc(model->fiber_point_count * sizeof *q);
    assert_non_null(q);
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        if (muscle->kind != RIS_MUSCLE_LINEAR) {
            continue;
        }
        assert_true(muscle->max_shortening > 0.0f && muscle->max_shortening <= 0.30f);
        for (int step = 1; step <= 2; ++step) {
            const float c = 0.5f * (float)step * muscle->max_shortening;
            for (uint32_t f = 0; f < muscle->fiber_count; ++f) {
                const ris_vec3 *p = model->fiber_point + model->fiber[muscle->first_fiber + f].first_point;
                ris__contract_linear(p, muscle->point_count, c, q);
                const float shortened =
                    1.0f - fiber_length(q, muscle->point_count) / fiber_length(p, muscle->point_count);
                if (fabsf(shortened - c) > 0.02f) {
                    fail_msg("fibre %u of %s shortens by %.3f, not %.3f", f, muscle->name, (double)shortened,
                             (double)c);
                }
            }
        }
    }
    free(q);
}

/* Displacement of the node nearest to a place at rest. */
static ris_vec3 motion_at(ris_vec3 place)
{
    uint32_t nearest = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (v3_distance(v4_xyz(model->rest_position[i]), place) <
            v3_distance(v4_xyz(model->rest_position[nearest]), place)) {
            nearest = i;
        }
    }
    return v3_sub(v4_xyz(x[nearest]), v4_xyz(model->rest_position[nearest]));
}

/* What each muscle is for: its main direction at one place of the left half of the face. */
static void muscles_do_what_they_are_named_for(void **state)
{
    (void)state;
    static const struct {
        const char *muscle;
        ris_vec3 place, direction;
    } cases[] = {
        {"frontalis_outer.L", {48, 40, 77}, {0, 1, 0}},
        {"frontalis_middle.L", {34, 43, 87}, {0, 1, 0}},
        {"procerus", {0, 26, 95}, {0, -1, 0}},
        {"procerus", {0, 8, 98}, {0, 1, 0}},
        {"levator_labii_superioris_alaeque_nasi.L", {17, -27, 93}, {0, 1, 0}},
        {"levator_labii_superioris.L", {17, -38, 96}, {0, 1, 0}},
        {"zygomaticus_minor.L", {21, -37, 92}, {0.5f, 0.8f, -0.2f}},
        {"levator_anguli_oris.L", {27, -48, 86}, {0, 1, 0}},
        {"risorius.L", {30, -48, 84}, {0.8f, 0, -0.6f}},
        {"buccinator.L", {30, -48, 84}, {0.6f, 0, -0.8f}},
        {"depressor_labii_inferioris.L", {12, -57, 96}, {0, -1, 0}},
        {"mentalis.L", {7, -82, 91}, {0, 1, 0}},
        {"depressor_septi.L", {5, -26, 102}, {0, -1, 0}},
        {"platysma.L", {33, -75, 70}, {0, -1, -0.5f}},
        {"orbicularis_oculi_orbital.L", {34, -6, 87}, {0, 1, 0}},
        {"orbicularis_oculi_palpebral.L", {32, 11, 85}, {0, 1, 0}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; ++k) {
        hold(channel_index(cases[k].muscle), 1.0f, 20);
        const ris_vec3 d = motion_at(cases[k].place);
        const float along = v3_dot(d, v3_unit_or(cases[k].direction, v3(0, 0, 0)));
        if (!(along > 0.8f && along > 0.5f * v3_length(d))) {
            fail_msg("%s moves its place by %.2f %.2f %.2f mm", cases[k].muscle, (double)d.x, (double)d.y,
                     (double)d.z);
        }
    }
}

/* AU1+4: frontalis prevails over the depressors, the corrugators still draw the brows together. Control: the depressors
 * alone lower. */
static void raised_brows_come_together(void **state)
{
    (void)state;
    static const char *const frown[] = {"corrugator_supercilii", "depressor_supercilii", "procerus"};
    const ris_vec3 head = {15, 40, 95}, middle = {25, 40, 91};
    memset(pose, 0, model->channel_count * sizeof *pose);
    for (int on = 0; on < 2; ++on) {
        for (int side = 0; side < 2; ++side) {
            char name[RIS_NAME_SIZE];
            for (size_t k = 0; k < 3; ++k) {
                snprintf(name, sizeof name, k == 2 ? "%s" : "%s.%c", frown[k], side ? 'R' : 'L');
                pose[channel_index(name)] = 1;
            }
            snprintf(name, sizeof name, "frontalis_inner.%c", side ? 'R' : 'L');
            pose[channel_index(name)] = (float)on;
        }
        settle_pose();
        const ris_vec3 d = motion_at(head), m = motion_at(middle);
        print_message("%s: head %.2f %.2f, middle %.2f %.2f\n", on ? "AU1+4" : "AU4", (double)d.x,
                      (double)d.y, (double)m.x, (double)m.y);
        assert_true(on ? d.y > 1.0f : d.y < -1.0f);
        assert_true(m.x < -0.8f);
    }
}

/* Table 7.1 of the thesis and what FACS needs beyond it; a synonym (docs/file-formats.md) is no second
 * muscle. */
static void the_set_is_whole(void **state)
{
    (void)state;
    static const char *const both[] = {"corrugator_supercilii",
                                       "zygomaticus_major",
                                       "risorius",
                                       "mentalis",
                                       "depressor_anguli_oris",
                                       "levator_labii_superioris",
                                       "depressor_labii_inferioris",
                                       "frontalis_inner",
                                       "frontalis_middle",
                                       "frontalis_outer",
                                       "orbicularis_oculi_orbital",
                                       "orbicularis_oculi_palpebral",
                                       "levator_labii_superioris_alaeque_nasi",
                                       "levator_anguli_oris",
                                       "zygomaticus_minor",
                                       "buccinator",
                                       "nasalis",
                                       "nasalis_alaris",
                                       "depressor_septi",
                                       "depressor_supercilii",
                                       "levator_palpebrae_superioris",
                                       "incisivus_labii_superioris",
                                       "incisivus_labii_inferioris",
                                       "platysma",
                                       "masseter",
                                       "temporalis",
                                       "pterygoideus_medialis",
                                       "pterygoideus_lateralis",
                                       "mylohyoideus"};
    static const char *const single[] = {"orbicularis_oris_superior", "orbicularis_oris_inferior",
                                         "procerus"};
    char name[RIS_NAME_SIZE];
    for (size_t k = 0; k < sizeof both / sizeof *both; ++k) {
        for (int side = 0; side < 2; ++side) {
            snprintf(name, sizeof name, "%s.%c", both[k], side ? 'R' : 'L');
            assert_true(channel_index(name) < model->muscle_count);
        }
    }
    for (size_t k = 0; k < sizeof single / sizeof *single; ++k) {
        assert_true(channel_index(single[k]) < model->muscle_count);
    }
}

static void every_muscle_has_its_anatomy(void **state)
{
    (void)state;
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle_def *def = model->muscle[m].def;
        assert_true(def->origin[0] && def->insertion[0] && def->source[0]);
        assert_true(model->muscle[m].fiber_count >= 1 && model->muscle[m].point_count >= 3);
    }
}

/* The row of docs/anatomy.md that starts with the muscle's name, sides left off, tells its counts. */
static void the_documentation_agrees(void **state)
{
    (void)state;
    char line[1024], start[RIS_NAME_SIZE + 8], counts[64];
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        const char *dot = strchr(muscle->name, '.');
        const int length = dot ? (int)(dot - muscle->name) : (int)strlen(muscle->name);
        snprintf(start, sizeof start, "| `%.*s` |", length, muscle->name);
        snprintf(counts, sizeof counts, "| %u x %u | %.0f %% |", muscle->fiber_count, muscle->point_count,
                 100.0 * (double)muscle->max_shortening);
        FILE *file = fopen(RIS_SOURCE_DIR "/docs/anatomy.md", "r");
        assert_non_null(file);
        bool agrees = false;
        while (fgets(line, sizeof line, file)) {
            agrees = agrees || (strncmp(line, start, strlen(start)) == 0 && strstr(line, counts));
        }
        fclose(file);
        if (!agrees) {
            fail_msg("docs/anatomy.md has no row of %s with %s", start, counts);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_muscle_moves_and_folds_nothing),
        cmocka_unit_test(sides_mirror),
        cmocka_unit_test(linear_muscles_shorten_as_told),
        cmocka_unit_test(muscles_do_what_they_are_named_for),
        cmocka_unit_test(raised_brows_come_together),
        cmocka_unit_test(the_set_is_whole),
        cmocka_unit_test(every_muscle_has_its_anatomy),
        cmocka_unit_test(the_documentation_agrees),
    };
    return cmocka_run_group_tests(tests, open_head, close_head);
}
