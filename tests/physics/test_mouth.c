/* The mouth of the reference head, settled: a pout thickens the lips and a smile thins them (KA-54 pose facts
 * of 7.1, 7.7), lips meet, the lining behind them follows, and no channel of mouth or jaw turns a triangle
 * of lips or lining over. Rings of the mouth are found here from regions and faces, not from the bake. */
#include "loaded_head.h"
#include "risorius/timeline.h"

#include <math.h>

#define RINGS 20
#define LIP_RINGS 12 /* of the profile: from the border of the red to the back of the lip */

static uint32_t *ring; /* from the border of the lips inwards (node_count) */
static bool *lips, *lower, *cavity, *soft;
static uint32_t *fan_start, *fan;

static void flag(const char *name, bool *flags)
{
    const ris_region *region = ris_head_region(model->head, name);
    assert_non_null(region);
    for (uint32_t k = 0; k < region->count; ++k) {
        flags[region->vertex[k]] = true;
    }
}

static void each_edge(void (*visit)(uint32_t, uint32_t, uint32_t), uint32_t argument)
{
    const ris_mesh *skin = &model->head->skin;
    for (uint32_t f = 0; f < skin->face_count; ++f) {
        const uint32_t first = skin->face_start[f], end = skin->face_start[f + 1];
        for (uint32_t c = first; c < end; ++c) {
            const uint32_t a = skin->face_vertex[c], b = skin->face_vertex[c + 1 < end ? c + 1 : first];
            visit(a, b, argument);
            visit(b, a, argument);
        }
    }
}

static void start_ring(uint32_t from, uint32_t to, uint32_t argument)
{
    if (lips[from] && !lips[to] && !cavity[to]) {
        ring[from] = argument;
    }
}

static void next_ring(uint32_t from, uint32_t to, uint32_t at)
{
    if (ring[from] == at && (lips[to] || cavity[to]) && ring[to] == UINT32_MAX) {
        ring[to] = at + 1;
    }
}

static void find_fans(void)
{
    fan_start = calloc((size_t)model->node_count + 2, sizeof *fan_start);
    fan = malloc(3 * (size_t)model->triangle_count * sizeof *fan);
    for (uint32_t k = 0; k < 3 * model->triangle_count; ++k) {
        ++fan_start[model->triangle[k] + 2];
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        fan_start[i + 2] += fan_start[i + 1];
    }
    for (uint32_t k = 0; k < 3 * model->triangle_count; ++k) {
        fan[fan_start[model->triangle[k] + 1]++] = k / 3;
    }
}

static int open_head(void **state)
{
    (void)state;
    if (load_head() != 0) {
        return -1;
    }
    const uint32_t n = model->node_count;
    ring = malloc(n * sizeof *ring);
    lips = calloc(n, sizeof *lips);
    lower = calloc(n, sizeof *lower);
    cavity = calloc(n, sizeof *cavity);
    soft = calloc(n, sizeof *soft);
    memset(ring, 0xff, n * sizeof *ring);
    flag("lips", lips);
    flag("lip_lower", lower);
    flag("mouth_cavity", cavity);
    flag("lips", soft);
    flag("mouth_cavity", soft);
    each_edge(start_ring, 0);
    for (uint32_t r = 0; r + 1 < RINGS; ++r) {
        each_edge(next_ring, r);
    }
    find_fans();
    return 0;
}

static int close_head(void **state)
{
    (void)state;
    free_head();
    free(ring);
    free(lips);
    free(lower);
    free(cavity);
    free(soft);
    free(fan_start);
    free(fan);
    return 0;
}

static void hold(const char *text)
{
    need(ris_pose_parse(model, text, pose, &err));
    settle();
}

/* Area of the lip's profile in the plane of symmetry, mm^2: nodes of the midline from ring to ring. */
static float profile(const ris_vec4 *p, bool of_lower)
{
    uint32_t node[LIP_RINGS];
    float area = 0.0f;
    for (uint32_t r = 0; r < LIP_RINGS; ++r) {
        node[r] = UINT32_MAX;
        for (uint32_t i = 0; i < model->node_count; ++i) {
            const ris_vec4 at = model->rest_position[i];
            if (ring[i] == r && fabsf(at.x) < 1e-3f && (at.y < -50.45f) == of_lower) {
                node[r] = i;
            }
        }
    }
    for (uint32_t r = 0, last = UINT32_MAX, first = UINT32_MAX; r <= LIP_RINGS; ++r) {
        const uint32_t i = r < LIP_RINGS ? node[r] : first;
        if (i != UINT32_MAX && last != UINT32_MAX) {
            area += 0.5f * (p[last].z * p[i].y - p[last].y * p[i].z);
        }
        first = first == UINT32_MAX ? i : first;
        last = i == UINT32_MAX ? last : i;
    }
    return fabsf(area);
}

/* Width of the mouth between the outermost nodes of the innermost ring of the lips, mm. */
static float mouth_width(const ris_vec4 *p)
{
    float most = 0.0f, least = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (ring[i] == 6) {
            most = f_max(most, p[i].x);
            least = f_min(least, p[i].x);
        }
    }
    return most - least;
}

static void assert_symmetric_mouth(void)
{
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (soft[i] && mirror[i] != UINT32_MAX) {
            const ris_vec4 other = x[mirror[i]];
            assert_true(v3_distance(v4_xyz(x[i]), v3(-other.x, other.y, other.z)) < 0.01f);
        }
    }
}

static void a_pout_thickens_and_a_smile_thins(void **state)
{
    (void)state;
    const ris_vec4 *rest = model->rest_position;
    hold("orbicularis_oris_superior=1,orbicularis_oris_inferior=1");
    for (int l = 0; l < 2; ++l) {
        const float gain = profile(x, l) / profile(rest, l);
        print_message("pout: profile of the %s lip x %.3f\n", l ? "lower" : "upper", (double)gain);
        assert_true(gain > 1.10f);
    }
    assert_true(mouth_width(x) < mouth_width(rest) - 6.0f);
    assert_symmetric_mouth();
    static const char *const wide[] = {"zygomaticus_major=1", "risorius=1"};
    for (size_t k = 0; k < 2; ++k) {
        hold(wide[k]);
        for (int l = 0; l < 2; ++l) {
            const float gain = profile(x, l) / profile(rest, l);
            print_message("%s: profile of the %s lip x %.3f\n", wide[k], l ? "lower" : "upper", (double)gain);
            assert_true(gain < 0.98f);
        }
        assert_true(mouth_width(x) > mouth_width(rest) + 5.0f);
    }
    hold("frontalis_inner=1"); /* control: what does not touch the lips leaves their profile */
    assert_true(fabsf(profile(x, false) / profile(rest, false) - 1.0f) < 0.002f);
}

/* Smallest height of the upper lip's inner edge over the lower lip's, near the midline, mm. */
static float opening(void)
{
    float upper = 1e9f, under = -1e9f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (lips[i] && fabsf(model->rest_position[i].x) < 12.0f) {
            upper = lower[i] ? upper : f_min(upper, x[i].y);
            under = lower[i] ? f_max(under, x[i].y) : under;
        }
    }
    return upper - under;
}

static void lips_meet_and_part(void **state)
{
    (void)state;
    hold("jaw.open=0");
    const float closed = opening();
    static const char *const shut[] = {"orbicularis_oris_superior=1,orbicularis_oris_inferior=1",
                                       "risorius=1", "zygomaticus_major=1"};
    for (size_t k = 0; k < sizeof shut / sizeof *shut; ++k) {
        hold(shut[k]);
        print_message("%s: opening %.2f mm, at rest %.2f\n", shut[k], (double)opening(), (double)closed);
        assert_true(opening() < closed + 0.6f);
    }
    hold("levator_labii_superioris=1,depressor_labii_inferioris=1");
    assert_true(opening() > closed + 2.0f);
    hold("jaw.open=0.3");
    assert_true(opening() > closed + 6.0f);
}

/* Triangles of lips and mouth whose normal points against the mean of those around it, and at rest does
 * not. */
static float agreement(const ris_vec4 *p, uint32_t t)
{
    const uint32_t *v = model->triangle + 3 * (size_t)t;
    ris_vec3 around = {0};
    for (uint32_t c = 0; c < 3; ++c) {
        for (uint32_t k = fan_start[v[c]]; k < fan_start[v[c] + 1]; ++k) {
            if (fan[k] != t) {
                around = v3_add(around, triangle_cross(p, model->triangle + 3 * (size_t)fan[k]));
            }
        }
    }
    return v3_dot(triangle_cross(p, v), around);
}

static uint32_t turned_over(void)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < model->triangle_count; ++t) {
        const uint32_t *v = model->triangle + 3 * (size_t)t;
        if (soft[v[0]] || soft[v[1]] || soft[v[2]]) {
            count += agreement(x, t) < 0.0f && agreement(model->rest_position, t) >= 0.0f;
        }
    }
    return count;
}

/* Farthest forward of the lips' red, near the midline, mm. */
static float farthest_out(const ris_vec4 *p)
{
    float out = -1e9f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        out = lips[i] && ring[i] >= 2 && ring[i] <= 7 && fabsf(p[i].x) < 12.0f ? f_max(out, p[i].z) : out;
    }
    return out;
}

/* Incisivi draw the corners in and turn the pout into a press: flat lips against the teeth. */
static void incisivi_press_the_lips(void **state)
{
    (void)state;
#define ORIS "orbicularis_oris_superior=1,orbicularis_oris_inferior=1"
#define INCISIVI "incisivus_labii_superioris=1,incisivus_labii_inferioris=1"
    const ris_vec4 *rest = model->rest_position;
    hold(INCISIVI);
    assert_true(mouth_width(x) < mouth_width(rest) - 4.0f);
    assert_true(fabsf(farthest_out(x) - farthest_out(rest)) < 1.0f);
    hold(ORIS "," INCISIVI);
    const float pressed[2] = {profile(x, false), profile(x, true)};
    print_message("press: red %.2f mm out, opening %.2f mm, profiles x %.3f %.3f\n",
                  (double)(farthest_out(x) - farthest_out(rest)), (double)opening(),
                  (double)(pressed[0] / profile(rest, false)), (double)(pressed[1] / profile(rest, true)));
    assert_true(farthest_out(x) < farthest_out(rest) - 0.5f && opening() < 0.2f);
    assert_true(turned_over() == 0);
    hold(ORIS);
    assert_true(farthest_out(x) > farthest_out(rest) + 6.0f);
    assert_true(pressed[0] < profile(x, false) && pressed[1] < profile(x, true));
    hold(ORIS ",incisivus_labii_superioris.L=1"); /* one side ties one half of one lip */
    float left = 0.0f, right = 0.0f, below = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const float side = rest[i].x, out = x[i].z - rest[i].z;
        if (ring[i] >= 3 && ring[i] <= 6 && fabsf(side) > 8.0f && fabsf(side) < 18.0f) {
            left = !lower[i] && side > 0.0f ? f_max(left, out) : left;
            right = !lower[i] && side < 0.0f ? f_max(right, out) : right;
            below = lower[i] ? f_max(below, out) : below;
        }
    }
    assert_true(left < 0.7f * right && below > 0.8f * right);
}

/* lips.close brings the lips together whatever the jaw does (AU8), by half when half; at rest it does nothing. */
static void lips_close_over_an_open_jaw(void **state)
{
    (void)state;
    hold("jaw.open=0.4");
    const float open = opening();
    hold("jaw.open=0.4,lips.close=0.5");
    const float half = opening();
    hold("jaw.open=0.4,lips.close=1");
    print_message("opening %.2f mm, half closed %.2f, closed %.2f\n", (double)open, (double)half,
                  (double)opening());
    assert_true(open > 8.0f && half > 0.3f * open && half < 0.7f * open);
    assert_true(opening() < 0.5f && turned_over() == 0);
    hold("lips.close=1");
    assert_true(opening() < 0.2f);
}

/* How far the red of one lip is out of the face on average, mm from rest. */
static float red_out(bool of_lower)
{
    float sum = 0.0f, count = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (ring[i] >= 5 && ring[i] <= 7 && lower[i] == of_lower && fabsf(model->rest_position[i].x) < 8.0f) {
            sum += x[i].z - model->rest_position[i].z;
            count += 1.0f;
        }
    }
    assert_true(count > 4.0f);
    return sum / count;
}

/* A lip rolls in over its teeth and out from them, each lip alone; rolled out, the mouth opens. */
static void lips_roll_in_and_out(void **state)
{
    (void)state;
    hold("lip.upper.roll=1");
    print_message("roll in: red %.2f mm, lower %.2f\n", (double)red_out(false), (double)red_out(true));
    assert_true(red_out(false) < -0.8f && fabsf(red_out(true)) < 0.6f && turned_over() == 0);
    hold("lip.lower.roll=1");
    print_message("lower in: red %.2f mm, upper %.2f\n", (double)red_out(true), (double)red_out(false));
    assert_true(red_out(true) < -0.8f && fabsf(red_out(false)) < 0.6f && turned_over() == 0);
    hold("lip.upper.roll=-1,lip.lower.roll=-1");
    print_message("roll out: red %.2f mm, lower %.2f, opening %.2f mm\n", (double)red_out(false),
                  (double)red_out(true), (double)opening());
    assert_true(red_out(false) > 1.0f && red_out(true) > 1.0f && opening() > 2.0f && turned_over() == 0);
}

static ris_vec3 moved(uint32_t i)
{
    return v3_sub(v4_xyz(x[i]), v4_xyz(model->rest_position[i]));
}

/* Largest displacement in a ring. */
static float ring_motion(uint32_t r)
{
    float most = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        most = ring[i] == r ? f_max(most, v3_length(moved(i))) : most;
    }
    return most;
}

static float steepest; /* largest difference of displacement over an edge, as a share of its length */

static void note_slope(uint32_t a, uint32_t b, uint32_t argument)
{
    (void)argument;
    if (cavity[a] && cavity[b]) {
        const float length = v3_distance(v4_xyz(model->rest_position[a]), v4_xyz(model->rest_position[b]));
        steepest = f_max(steepest, v3_distance(moved(a), moved(b)) / length);
    }
}

static void the_lining_follows_the_lips(void **state)
{
    (void)state;
    static const char *const poses[] = {"orbicularis_oris_superior=1,orbicularis_oris_inferior=1",
                                        "zygomaticus_major=1", "depressor_labii_inferioris=1", "risorius=1"};
    for (size_t k = 0; k < sizeof poses / sizeof *poses; ++k) {
        hold(poses[k]);
        steepest = 0.0f;
        each_edge(note_slope, 0);
        print_message("%s: rings 8, 9, 11, 17 move by %.2f %.2f %.2f %.2f mm, steepest %.2f\n", poses[k],
                      (double)ring_motion(8), (double)ring_motion(9), (double)ring_motion(11),
                      (double)ring_motion(17), (double)steepest);
        assert_true(ring_motion(9) > 0.5f * ring_motion(8));
        assert_true(ring_motion(11) > 0.2f * ring_motion(8));
        assert_true(ring_motion(17) < 0.5f);
        assert_true(steepest < 1.5f);
    }
}

/* Every muscle alone and both sides, and the jaw. */
static void no_channel_turns_the_mouth_over(void **state)
{
    (void)state;
    char text[RIS_NAME_SIZE + 8], name[RIS_NAME_SIZE];
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        for (int both = 0; both < 2; ++both) {
            strcpy(name, model->muscle[m].name);
            char *dot = strchr(name, '.');
            if (both && (!dot || dot[1] == 'R')) {
                continue;
            }
            if (both) {
                *dot = '\0';
            }
            snprintf(text, sizeof text, "%s=1", name);
            hold(text);
            if (turned_over() > 0) {
                fail_msg("%s turns %u triangles of the mouth over", text, turned_over());
            }
        }
    }
    static const char *const jaw[] = {"jaw.open=1", "jaw.open=0.5", "jaw.forward=-1", "jaw.side=0.5",
                                      "jaw.forward=0.4"};
    for (size_t k = 0; k < sizeof jaw / sizeof *jaw; ++k) {
        hold(jaw[k]);
        if (turned_over() > 0) {
            fail_msg("%s turns %u triangles of the mouth over", jaw[k], turned_over());
        }
    }
    for (uint32_t i = 0; i < model->node_count; ++i) { /* control: one node pushed through its neighbours */
        if (ring[i] == 5) {
            x[i] = model->rest_position[i];
            x[i].x += 5.0f;
            break;
        }
    }
    assert_true(turned_over() > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pout_thickens_and_a_smile_thins),
        cmocka_unit_test(lips_meet_and_part),
        cmocka_unit_test(incisivi_press_the_lips),
        cmocka_unit_test(lips_close_over_an_open_jaw),
        cmocka_unit_test(lips_roll_in_and_out),
        cmocka_unit_test(the_lining_follows_the_lips),
        cmocka_unit_test(no_channel_turns_the_mouth_over),
    };
    return cmocka_run_group_tests(tests, open_head, close_head);
}
