/* Eyelids of the reference head, settled: closed lids meet along their whole width whatever the lower lid and
 * the gaze do, stay off the ball and the cornea's mesh,
 * keep their corners, open wide, follow the gaze, mirror.
 * Rings of the lids are found here from regions and faces, not from the bake. */
#include "loaded_head.h"
#include "measure/measure.h"
#include "risorius/timeline.h"

#define MARGIN_RING 2 /* from the lining of the socket outwards */
#define GAP_MM 0.3f
#define LASH_VERTICES 12 /* of a strand, from its root to its tip */

enum { UPPER = 1, LOWER = 2, CORNER = 3 };

static ris_vec4 *rest, *other;
static uint8_t *lid;   /* UPPER | LOWER, left eye */
static uint32_t *ring; /* left eye */
static uint32_t (*edge)[2];
static uint32_t edge_count;

static void find_edges(void)
{
    const ris_mesh *skin = &model->head->skin;
    edge = malloc(2 * (size_t)skin->face_start[skin->face_count] * sizeof *edge);
    for (uint32_t f = 0; f < skin->face_count; ++f) {
        const uint32_t first = skin->face_start[f], end = skin->face_start[f + 1];
        for (uint32_t c = first; c < end; ++c) {
            const uint32_t a = skin->face_vertex[c], b = skin->face_vertex[c + 1 < end ? c + 1 : first];
            edge[edge_count][0] = a;
            edge[edge_count++][1] = b;
            edge[edge_count][0] = b;
            edge[edge_count++][1] = a;
        }
    }
}

static void find_rings(void)
{
    const ris_region *socket = ris_head_region(model->head, "eye_socket");
    const ris_region *region[2] = {ris_head_region(model->head, "lid_upper.L"),
                                   ris_head_region(model->head, "lid_lower.L")};
    bool *lining = calloc(model->node_count, sizeof *lining);
    for (uint32_t k = 0; k < socket->count; ++k) {
        lining[socket->vertex[k]] = true;
    }
    for (int l = 0; l < 2; ++l) {
        for (uint32_t k = 0; k < region[l]->count; ++k) {
            lid[region[l]->vertex[k]] |= (uint8_t)(1 << l);
        }
    }
    memset(ring, 0xff, model->node_count * sizeof *ring);
    for (uint32_t e = 0; e < edge_count; ++e) {
        if (lid[edge[e][0]] && lining[edge[e][1]]) {
            ring[edge[e][0]] = 0;
        }
    }
    for (uint32_t r = 0; r < MARGIN_RING; ++r) {
        for (uint32_t e = 0; e < edge_count; ++e) {
            if (ring[edge[e][0]] == r && lid[edge[e][1]] && ring[edge[e][1]] == UINT32_MAX) {
                ring[edge[e][1]] = r + 1;
            }
        }
    }
    free(lining);
}

static int open_head(void **state)
{
    (void)state;
    if (load_head() != 0) {
        return -1;
    }
    other = malloc(model->node_count * sizeof *other);
    rest = model->rest_position;
    lid = calloc(model->node_count, sizeof *lid);
    ring = malloc(model->node_count * sizeof *ring);
    find_edges();
    find_rings();
    return 0;
}

static int close_head(void **state)
{
    (void)state;
    free_head();
    free(other);
    free(lid);
    free(ring);
    free(edge);
    return 0;
}

static void set(const char *name, float value)
{
    const uint32_t c = ris_model_channel(model, name);
    assert_true(c < model->channel_count);
    pose[c] = value;
}

/* Both eyes; pitch and yaw in degrees. */
static void hold(float upper, float lower, float pitch, float yaw)
{
    memset(pose, 0, model->channel_count * sizeof *pose);
    set("lid.upper.L", upper);
    set("lid.upper.R", upper);
    set("lid.lower.L", lower);
    set("lid.lower.R", lower);
    set("eye.pitch.L", pitch);
    set("eye.pitch.R", pitch);
    set("eye.yaw.L", yaw);
    set("eye.yaw.R", yaw);
    settle();
}

static float segment_distance(ris_vec3 p, ris_vec3 a, ris_vec3 b)
{
    const ris_vec3 ab = v3_sub(b, a);
    const float length2 = v3_dot(ab, ab);
    const float s = length2 > 0.0f ? f_clamp(v3_dot(v3_sub(p, a), ab) / length2, 0.0f, 1.0f) : 0.0f;
    return v3_distance(p, v3_mad(a, s, ab));
}

/* Largest distance of the upper margin's nodes from the line of the lower margin, mm. */
static float widest_gap(void)
{
    float widest = 0.0f;
    uint32_t nodes = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (ring[i] != MARGIN_RING || lid[i] != UPPER) {
            continue;
        }
        float nearest = 1e9f;
        for (uint32_t e = 0; e < edge_count; ++e) {
            const uint32_t a = edge[e][0], b = edge[e][1];
            if (ring[a] == MARGIN_RING && ring[b] == MARGIN_RING && (lid[a] & LOWER) && (lid[b] & LOWER)) {
                nearest = f_min(nearest, segment_distance(v4_xyz(x[i]), v4_xyz(x[a]), v4_xyz(x[b])));
            }
        }
        widest = f_max(widest, nearest);
        ++nodes;
    }
    assert_true(nodes >= 10);
    return widest;
}

static const ris_part_def *part(const char *name)
{
    for (uint32_t k = 0; k < model->head->part_count; ++k) {
        if (strcmp(model->head->part[k].name, name) == 0) {
            return &model->head->part[k];
        }
    }
    fail_msg("no part %s", name);
    return NULL;
}

static ris_vec3 transformed(const float *m, ris_vec3 p)
{
    return v3(((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3],
              ((m[4] * p.x + m[5] * p.y) + m[6] * p.z) + m[7],
              ((m[8] * p.x + m[9] * p.y) + m[10] * p.z) + m[11]);
}

/* Distance along the ray from o to triangle a, b, c, or 0. */
static float ray_hit(ris_vec3 o, ris_vec3 d, ris_vec3 a, ris_vec3 b, ris_vec3 c)
{
    const ris_vec3 u = v3_sub(b, a), v = v3_sub(c, a), p = v3_cross(d, v), s = v3_sub(o, a),
                   q = v3_cross(s, u);
    const float det = v3_dot(u, p);
    if (det > -1e-9f && det < 1e-9f) {
        return 0.0f;
    }
    const float i = v3_dot(s, p) / det, j = v3_dot(d, q) / det, t = v3_dot(v, q) / det;
    return i >= -1e-4f && j >= -1e-4f && i + j <= 1.0002f && t > 0.0f ? t : 0.0f;
}

/* How far p is outside the eyeball's sphere and the cornea's mesh, along the ray from the centre. */
static float clearance(ris_vec3 p, ris_vec3 centre, float ball_mm, const ris_mesh *cornea, const float *bone)
{
    const float r = v3_distance(p, centre);
    const ris_vec3 d = v3_scale(v3_sub(p, centre), 1.0f / r);
    float surface = ball_mm;
    for (uint32_t f = 0; f < cornea->face_count; ++f) {
        const uint32_t first = cornea->face_start[f], end = cornea->face_start[f + 1];
        for (uint32_t c = first + 1; c + 1 < end; ++c) {
            const uint32_t *v = cornea->face_vertex;
            surface = f_max(surface, ray_hit(centre, d, transformed(bone, cornea->position[v[first]]),
                                             transformed(bone, cornea->position[v[c]]),
                                             transformed(bone, cornea->position[v[c + 1]])));
        }
    }
    return r - surface;
}

/* No node of a lid deeper in the eye than 0.1 mm below the surface, or than it is at rest. */
static void assert_outside(void)
{
    const ris_part_def *cornea = part("cornea.L"), *ball = part("eye.L");
    float ball_mm = 0.0f, bone[12];
    const float still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    ris_sim_bone_transform(sim, RIS_BONE_EYE_L, bone);
    for (uint32_t k = 0; k < ball->mesh.vertex_count; ++k) {
        ball_mm = f_max(ball_mm, v3_distance(ball->mesh.position[k], ball->pivot));
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (lid[i] && ring[i] <= MARGIN_RING) {
            const float now = clearance(v4_xyz(x[i]), ball->pivot, ball_mm, &cornea->mesh, bone);
            const float before = clearance(v4_xyz(rest[i]), ball->pivot, ball_mm, &cornea->mesh, still);
            if (now < f_min(before, 0.1f) - 0.1f) {
                fail_msg("vertex %u is %.2f mm outside the eye, at rest %.2f", i, (double)now,
                         (double)before);
            }
        }
    }
}

static void assert_corners(void)
{
    uint32_t corners = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (lid[i] == CORNER) {
            const float moved = v3_distance(v4_xyz(x[i]), v4_xyz(rest[i]));
            if (moved >= 0.5f) {
                fail_msg("vertex %u of a corner moved by %.2f mm", i, (double)moved);
            }
            ++corners;
        }
    }
    assert_true(corners >= 2);
}

static void closed_lids_meet(void **state)
{
    (void)state;
    static const float poses[][4] = {{1, 0, 0, 0},  {1, 0.2f, 0, 0}, {1, 1, 0, 0},
                                     {1, -1, 0, 0}, {1, 0, 25, 20},  {1, 0.5f, -25, -20}};
    for (size_t k = 0; k < sizeof poses / sizeof poses[0]; ++k) {
        hold(poses[k][0], poses[k][1], poses[k][2], poses[k][3]);
        const float gap = widest_gap();
        print_message("upper %g lower %g pitch %g yaw %g: gap %.3f mm\n", (double)poses[k][0],
                      (double)poses[k][1], (double)poses[k][2], (double)poses[k][3], (double)gap);
        assert_true(gap < GAP_MM);
        assert_outside();
        assert_corners();
    }
    hold(0.9f, 0, 0, 0); /* the measure sees a slit of a tenth of the opening */
    assert_true(widest_gap() > 2.0f * GAP_MM);
}

static void lids_stay_off_the_eye(void **state)
{
    (void)state;
    static const float poses[][4] = {{0.25f, 0, 0, 0}, {0.5f, 0, 0, 0}, {0.75f, 1, 0, 0}, {0.5f, 0, 15, 0},
                                     {0, 0, 25, 0},    {0, 0, -25, 0},  {0, 0, 0, 30},    {-1, -1, 10, -30}};
    for (size_t k = 0; k < sizeof poses / sizeof poses[0]; ++k) {
        hold(poses[k][0], poses[k][1], poses[k][2], poses[k][3]);
        assert_outside();
        assert_corners();
    }
}

/* Mean displacement upwards of the middle of a margin (share of the opening above 0.9). */
static float margin_lift(uint8_t which)
{
    float sum = 0.0f, count = 0.0f;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const float side = rest[i].x - part("eye.L")->pivot.x;
        if (ring[i] == MARGIN_RING && lid[i] == which && side > -5.0f && side < 5.0f) {
            sum += x[i].y - rest[i].y;
            count += 1.0f;
        }
    }
    assert_true(count >= 3.0f);
    return sum / count;
}

static void wide_and_gaze(void **state)
{
    (void)state;
    hold(-1, -1, 0, 0);
    assert_in_range((int)(margin_lift(UPPER) * 100.0f), 180, 300);
    assert_in_range((int)(margin_lift(LOWER) * -100.0f), 60, 150);
    hold(0, 1, 0, 0);
    assert_in_range((int)(margin_lift(LOWER) * 100.0f), 180, 350);
    hold(0, 0, -20, 0); /* 15 degrees of the lid's 16.5 mm */
    assert_in_range((int)(margin_lift(UPPER) * -100.0f), 300, 500);
    assert_in_range((int)(margin_lift(LOWER) * -100.0f), 80, 220);
    hold(0, 0, 20, 0);
    assert_in_range((int)(margin_lift(UPPER) * 100.0f), 180, 320);
    assert_in_range((int)(margin_lift(LOWER) * 100.0f), 80, 220);
}

/* Closed lids stay closed, and off the eye, whatever the muscles around them do, alone and all at once. */
static void muscles_do_not_open_closed_lids(void **state)
{
    (void)state;
    static const char *const poses[] = {
        "lid.upper=1,orbicularis_oculi_palpebral=1",
        "lid.upper=1,orbicularis_oculi_orbital=1",
        "lid.upper=1,frontalis_inner=1,frontalis_outer=1",
        "lid.upper=1,corrugator_supercilii=1,depressor_supercilii=1,procerus=1",
        "lid.upper=1,zygomaticus_major=1,levator_labii_superioris=1",
        "lid.upper=1,frontalis_inner=1,frontalis_outer=1,corrugator_supercilii=1,zygomaticus_major=1,"
        "orbicularis_oculi_orbital=1,orbicularis_oculi_palpebral=1",
        "lid.upper=1,eye.pitch=-25,eye.yaw=20,orbicularis_oculi_palpebral=1,frontalis_outer=1",
        "lid.upper=1,eye.pitch=25,lid.lower=0.5,orbicularis_oculi_palpebral=1,orbicularis_oculi_orbital=1",
        "lid.upper=1,levator_palpebrae_superioris=1,frontalis_inner=1"};
    for (size_t k = 0; k < sizeof poses / sizeof poses[0]; ++k) {
        need(ris_pose_parse(model, poses[k], pose, &err));
        settle();
        print_message("%s: gap %.3f mm\n", poses[k], (double)widest_gap());
        assert_true(widest_gap() < GAP_MM);
        assert_outside();
    }
    need(ris_pose_parse(model, "orbicularis_oculi_palpebral=1,orbicularis_oculi_orbital=1", pose, &err));
    settle();
    assert_true(widest_gap() > 1.0f); /* control: muscles alone do not close this eye */
    assert_outside();
}

/* AU5: the levator moves the lid as the channel does, one eye at a time; a closed lid stays closed. */
static void the_levator_lifts_the_lid(void **state)
{
    (void)state;
    hold(-1, 0, 0, 0);
    memcpy(other, x, model->node_count * sizeof *other);
    memset(pose, 0, model->channel_count * sizeof *pose);
    set("levator_palpebrae_superioris.L", 1);
    settle();
    const float lift = margin_lift(UPPER);
    print_message("levator palpebrae: lid %.2f mm up\n", (double)lift);
    assert_true(lift > 1.8f);
    assert_outside();
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const float side = rest[i].x;
        const ris_vec3 wanted = v4_xyz(side > 0.0f ? other[i] : rest[i]);
        assert_true(v3_distance(v4_xyz(x[i]), wanted) < 0.05f);
    }
    set("levator_palpebrae_superioris.L", 0.5f);
    settle();
    assert_true(margin_lift(UPPER) > 0.4f * lift && margin_lift(UPPER) < 0.8f * lift);
    set("levator_palpebrae_superioris.L", 1);
    set("lid.upper.L", 1);
    settle();
    assert_true(widest_gap() < GAP_MM);
}

/* Triangles of lips and lids that are turned over, by the measure of `risorius soak`. */
static double turned_over(const ris_measurer *measurer)
{
    ris_finding found[RIS_MEASURE_COUNT];
    ris_bone_frames frames;
    for (int bone = 0; bone < RIS_BONE_SKIN; ++bone) {
        ris_sim_bone_transform(sim, (ris_bone)bone, frames.bone[bone]);
    }
    need(ris__measure_pose(measurer, x, &frames, found, NULL, &err));
    return found[RIS_MEASURE_FLIPPED].value;
}

/* Not in the corners of the eye, not in the lining that folds under a raised lid, not where muscles draw as well. */
static void no_triangle_turns_over(void **state)
{
    (void)state;
    static const char *const poses[] = {
        "lid.upper=1",
        "lid.upper=0.8,lid.lower=-0.5,eye.pitch=-15",
        "lid.upper=-1,eye.pitch=30",
        "eye.pitch=-30,eye.yaw=30",
        "levator_palpebrae_superioris=1,lid.lower=-1",
        "lid.upper=0.65,lid.lower=0.7,eye.pitch=23,orbicularis_oculi_palpebral=0.9,orbicularis_oculi_orbital="
        "1",
        "lid.upper=-0.4,lid.lower=1,eye.pitch=20,corrugator_supercilii=1,depressor_supercilii=1,"
        "orbicularis_oculi_palpebral=1,orbicularis_oculi_orbital=1,zygomaticus_major=1"};
    ris_measurer *measurer = NULL;
    need(ris__measurer_create(model, &measurer, &err));
    for (size_t k = 0; k < sizeof poses / sizeof poses[0]; ++k) {
        need(ris_pose_parse(model, poses[k], pose, &err));
        settle();
        const double count = turned_over(measurer);
        if (count > 0) {
            fail_msg("%s turns over %g triangles", poses[k], count);
        }
    }
    uint32_t corner = 0; /* control: a corner of the eye drawn across the lid */
    while (lid[corner] != CORNER) {
        ++corner;
    }
    x[corner].x += x[corner].x > part("eye.L")->pivot.x ? -4.0f : 4.0f;
    assert_true(turned_over(measurer) > 0);
    ris__measurer_destroy(measurer);
}

/* AU7: the ring within the lids narrows the eye from both sides, leaves it open, and moves no other skin. */
static void the_ring_narrows_both_lids(void **state)
{
    (void)state;
    memset(pose, 0, model->channel_count * sizeof *pose);
    set("orbicularis_oculi_palpebral.L", 1);
    settle();
    print_message("palpebral ring: upper %.2f, lower %.2f mm\n", (double)margin_lift(UPPER),
                  (double)margin_lift(LOWER));
    assert_true(margin_lift(UPPER) < -2.5f && margin_lift(UPPER) > -4.5f);
    assert_true(margin_lift(LOWER) > 2.0f && margin_lift(LOWER) < 3.5f);
    assert_outside();
    for (uint32_t i = 0; i < model->node_count; ++i) {
        const bool here = lid[i] && rest[i].x > 0.0f;
        assert_true(here || v3_distance(v4_xyz(x[i]), v4_xyz(rest[i])) < 0.6f);
    }
}

/* How steeply the strands of one lid stand, mean of the sines of their angles over the horizontal plane. */
static double lash_slope(uint32_t p, bool upper, const ris_vec4 *at)
{
    const ris_mesh *mesh = &model->head->part[p].mesh;
    double sum = 0;
    uint32_t count = 0;
    for (uint32_t first = 0; first + LASH_VERTICES <= mesh->vertex_count; first += LASH_VERTICES) {
        if ((mesh->position[first].y > part("eye.L")->pivot.y) == upper) {
            const ris_vec3 way = v3_sub(v4_xyz(at[first + LASH_VERTICES - 1]), v4_xyz(at[first]));
            sum += (double)(way.y / v3_length(way));
            ++count;
        }
    }
    assert_true(count > 20);
    return sum / count;
}

/* AU7 turns the edges of both lids in. The upper lashes go along and hang before the eye; the lower ones do not stand up. */
static void lower_lashes_stay_down(void **state)
{
    (void)state;
    uint32_t p = 0;
    while (p < model->head->part_count && strcmp(model->head->part[p].name, "lashes.L") != 0) {
        ++p;
    }
    assert_true(p < model->head->part_count);
    ris_vec4 *at = calloc(model->head->part[p].mesh.vertex_count, sizeof *at);
    assert_non_null(at);
    need(ris_sim_part(sim, p, rest, at, &err));
    const double low = lash_slope(p, false, at), high = lash_slope(p, true, at);
    memset(pose, 0, model->channel_count * sizeof *pose);
    set("orbicularis_oculi_palpebral.L", 1);
    settle();
    need(ris_sim_part(sim, p, x, at, &err));
    const double low_now = lash_slope(p, false, at), high_now = lash_slope(p, true, at);
    print_message("lashes: lower %.2f, in a squint %.2f; upper %.2f, in a squint %.2f\n", low, low_now, high,
                  high_now);
    assert_true(low < -0.1 && low_now < -0.05);
    assert_true(high > 0.2 && high_now < -0.05);
    free(at);
}

/* One eye at a time is the mirror image of the other, and moves nothing on its side. */
static void one_eye_mirrors(void **state)
{
    (void)state;
    memset(pose, 0, model->channel_count * sizeof *pose);
    set("lid.upper.L", 0.8f);
    set("lid.lower.L", 0.3f);
    set("eye.yaw.L", 15);
    settle();
    memcpy(other, x, model->node_count * sizeof *other);
    memset(pose, 0, model->channel_count * sizeof *pose);
    set("lid.upper.R", 0.8f);
    set("lid.lower.R", 0.3f);
    set("eye.yaw.R", -15);
    settle();
    uint32_t pairs = 0;
    for (uint32_t i = 0; i < model->node_count; ++i) {
        if (!lid[i]) {
            continue;
        }
        assert_true(v3_distance(v4_xyz(x[i]), v4_xyz(rest[i])) < 0.05f);
        for (uint32_t j = 0; j < model->node_count; ++j) {
            if (v3_distance(v3(-rest[j].x, rest[j].y, rest[j].z), v4_xyz(rest[i])) < 1e-3f) {
                assert_true(v3_distance(v3(-x[j].x, x[j].y, x[j].z), v4_xyz(other[i])) < 0.01f);
                ++pairs;
            }
        }
    }
    assert_true(pairs > 200);
}

/* A blink of natural speed: 0.1 s down, 0.05 s shut, 0.2 s up; then at rest again soon. */
static void blink(void **state)
{
    (void)state;
    memset(pose, 0, model->channel_count * sizeof *pose);
    need(ris_sim_reset(sim, &err));
    for (int tick = 1; tick <= 45; ++tick) {
        const float c = tick <= 6   ? (float)tick / 6.0f
                        : tick <= 9 ? 1.0f
                                    : f_max(1.0f - (float)(tick - 9) / 12.0f, 0.0f);
        set("lid.upper.L", c);
        set("lid.upper.R", c);
        need(ris_sim_tick(sim, pose, &err));
        need(ris_sim_read(sim, RIS_STATE_POSITION, x, &err));
        if (tick == 8) {
            assert_true(widest_gap() < 0.4f);
        }
    }
    for (uint32_t i = 0; i < model->node_count; ++i) {
        assert_true(v3_distance(v4_xyz(x[i]), v4_xyz(rest[i])) < 0.1f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_lids_meet),
        cmocka_unit_test(lids_stay_off_the_eye),
        cmocka_unit_test(wide_and_gaze),
        cmocka_unit_test(muscles_do_not_open_closed_lids),
        cmocka_unit_test(the_levator_lifts_the_lid),
        cmocka_unit_test(no_triangle_turns_over),
        cmocka_unit_test(the_ring_narrows_both_lids),
        cmocka_unit_test(lower_lashes_stay_down),
        cmocka_unit_test(one_eye_mirrors),
        cmocka_unit_test(blink),
    };
    return cmocka_run_group_tests(tests, open_head, close_head);
}
