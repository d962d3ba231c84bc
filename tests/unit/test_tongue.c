/* The tongue's channels (KA-06, KA-48; docs/physics.md, tongue_pose) on the reference head: it goes where they say, keeps its
 * volume roughly, leaves between the teeth and touches neither them, gums nor palate, over the whole range of jaw and
 * channels. Controls: the same tongue where it must not be. */
#include "query/query.h"
#include "risorius/sim.h"
#include "risorius/timeline.h"
#include "sim/rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HUMAN RIS_SOURCE_DIR "/assets/human"

enum { SKULL, TEETH_UPPER, TEETH_LOWER, GUM_UPPER, GUM_LOWER, MESHES };
static const char *const part_names[MESHES] = {NULL, "teeth_upper", "teeth_lower", "gum_upper", "gum_lower"};

static ris_model *model;
static ris_rig rig;
static float *pose;
static tri_mesh mesh[MESHES], rest, tongue;
static bvh tree[MESHES];
static uint32_t tongue_part;

static const ris_mesh *source_of(int k)
{
    if (k == SKULL)
        return &model->head->skull;
    for (uint32_t i = 0; i < model->head->part_count; i++)
        if (strcmp(model->head->part[i].name, part_names[k]) == 0)
            return &model->head->part[i].mesh;
    return NULL;
}

static int load(void **state)
{
    (void)state;
    ris_error err = {0};
    bool ok = ris_model_load(HUMAN, &model, &err) == RIS_OK && ris__rig_init(&rig, model, &err) == RIS_OK;
    for (int k = 0; k < MESHES && ok; k++)
        ok = source_of(k) && ris__tri_from_mesh(source_of(k), "a mesh", &mesh[k], &err) == RIS_OK &&
             ris__bvh_build(&tree[k], &mesh[k], &err) == RIS_OK;
    ok = ok && rig.tongue.mesh && ris__tri_from_mesh(rig.tongue.mesh, "the tongue", &rest, &err) == RIS_OK &&
         ris__tri_from_mesh(rig.tongue.mesh, "the tongue", &tongue, &err) == RIS_OK;
    for (uint32_t i = 0; ok && i < model->head->part_count; i++)
        tongue_part = model->head->part[i].material == RIS_MATERIAL_TONGUE ? i : tongue_part;
    pose = ok ? calloc(model->channel_count, sizeof *pose) : NULL;
    if (!pose)
        print_error("%s\n", err.text);
    return pose ? 0 : -1;
}

static int unload(void **state)
{
    (void)state;
    for (int k = 0; k < MESHES; k++) {
        ris__bvh_finish(&tree[k]);
        ris__tri_finish(&mesh[k]);
    }
    ris__tri_finish(&rest);
    ris__tri_finish(&tongue);
    ris__rig_finish(&rig);
    ris_model_destroy(model);
    free(pose);
    return 0;
}

/* Moves the tongue, in the frame of the jaw. */
static void take(float open, float out, float tip, float wide)
{
    memset(pose, 0, model->channel_count * sizeof *pose);
    float *beside = pose + rig.first_beside;
    beside[RIS__JAW_OPEN] = open;
    beside[RIS__TONGUE_OUT] = out;
    beside[RIS__TONGUE_TIP] = tip;
    beside[RIS__TONGUE_WIDE] = wide;
    ris__jaw_pose(&rig, pose);
    ris__tongue_pose(&rig, pose);
    for (uint32_t i = 0; i < tongue.vertex_count; i++) {
        const dvec p = rest.position[i];
        const ris_vec3 q = ris__tongue_place(&rig.tongue, (ris_vec3){(float)p.x, (float)p.y, (float)p.z});
        tongue.position[i] = dv(q.x, q.y, q.z);
    }
}

/* Edges of the tongue in teeth, gums and palate and the other way round. */
static uint32_t crossings(void)
{
    static const float still[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    float jaw[12];
    ris_error err = {0};
    bvh moved;
    uint32_t count = 0;
    ris__rigid_matrix(&rig.jaw, jaw);
    assert_int_equal(ris__bvh_build(&moved, &tongue, &err), RIS_OK);
    for (int k = 0; k < MESHES; k++)
        count += ris__bvh_crossings(&moved, k == TEETH_LOWER || k == GUM_LOWER ? still : jaw, &tree[k],
                                    UINT32_MAX);
    ris__bvh_finish(&moved);
    return count;
}

static double volume(const tri_mesh *m)
{
    double sum = 0;
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *v = m->triangle + 3 * (size_t)i;
        sum += dv_dot(m->position[v[0]], dv_cross(m->position[v[1]], m->position[v[2]])) / 6;
    }
    return sum;
}

/* The vertex that is foremost at rest, now. */
static dvec tip_place(void)
{
    uint32_t first = 0;
    for (uint32_t i = 0; i < rest.vertex_count; i++)
        first = rest.position[i].z > rest.position[first].z ? i : first;
    return tongue.position[first];
}

static double half_width(double from_z)
{
    double most = 0;
    for (uint32_t i = 0; i < tongue.vertex_count; i++)
        most = tongue.position[i].z > from_z ? fmax(most, fabs(tongue.position[i].x)) : most;
    return most;
}

static void it_touches_nothing(void **state)
{
    (void)state;
    static const float opens[] = {0, 0.15f, 0.25f, 0.32f, 0.4f, 0.5f, 0.65f, 1};
    uint32_t count = 0, poses = 0;
    double least = 1, most = 1;
    const double whole = volume(&rest);
    for (size_t o = 0; o < sizeof opens / sizeof *opens; o++)
        for (int out = 0; out <= 8; out++)
            for (int tip = -2; tip <= 2; tip++)
                for (int wide = -1; wide <= 1; wide++) {
                    take(opens[o], (float)out / 8, (float)tip / 2, (float)wide);
                    const uint32_t now = crossings();
                    if (now)
                        print_error("open %.2f out %d/8 tip %d/2 wide %d: %u edges\n", (double)opens[o], out,
                                    tip, wide, now);
                    count += now;
                    poses++;
                    least = fmin(least, volume(&tongue) / whole);
                    most = fmax(most, volume(&tongue) / whole);
                }
    print_message("%u poses, %u edges in teeth, gums and palate; volume x %.2f .. %.2f\n", poses, count,
                  least, most);
    assert_int_equal(count, 0);
    assert_true(least > 0.8 && most < 1.2);
    take(0.6f, 1, 0, 0); /* control: the jaw closed on it, and lifted through the roof of the mouth */
    rig.jaw = ris__rigid_turn(model->head->jaw.point, model->head->jaw.axis, 0);
    assert_true(crossings() > 0);
    take(0, 0, 0, 0);
    for (uint32_t i = 0; i < tongue.vertex_count; i++)
        tongue.position[i].y += 15;
    assert_true(crossings() > 0);
}

static void it_goes_where_it_is_told(void **state)
{
    (void)state;
    take(0.6f, 0, 0, 0);
    const dvec start = tip_place();
    const double wide_at_rest = half_width(60);
    for (uint32_t i = 0; i < tongue.vertex_count; i++) /* channels at 0: the bits of the file */
        assert_true(tongue.position[i].x == rest.position[i].x &&
                    tongue.position[i].y == rest.position[i].y && tongue.position[i].z == rest.position[i].z);
    take(0.6f, 1, 0, 0);
    const dvec out = tip_place();
    print_message("out: %.1f mm forward, %.1f past the lower incisors\n", out.z - start.z,
                  out.z - (double)model->head->jaw.incisor.z);
    assert_true(out.z - start.z > 30 && out.z > (double)model->head->jaw.incisor.z + 20);
    take(0.6f, 1, 1, 0);
    const dvec up = tip_place();
    take(0.6f, 1, -1, 0);
    const dvec down = tip_place();
    assert_true(up.y > out.y + 5 && down.y < out.y - 5);
    take(0.6f, 0, 1, 0);
    assert_true(tip_place().y > start.y + 5);
    take(0.6f, 0, -1, 0);
    assert_true(tip_place().y < start.y - 1);
    take(0.6f, 1, 0, 1);
    const double wide = half_width(96);
    take(0.6f, 1, 0, -1);
    const double narrow = half_width(96);
    take(0.6f, 1, 0, 0);
    print_message("outside: half width %.1f narrow, %.1f, %.1f wide\n", narrow, half_width(96), wide);
    assert_true(wide > 1.1 * half_width(96) && narrow < 0.85 * half_width(96));
    take(0.6f, 0, 0, -1);
    assert_true(half_width(60) < 0.9 * wide_at_rest);
    take(0, 1, 0, 0); /* closed teeth let it not out; it presses towards them */
    assert_true(tip_place().z < start.z + 2.5 && tip_place().z > start.z + 1);
    double last = -HUGE_VAL; /* and the wider they open, the farther */
    for (int k = 2; k <= 6; k++) {
        take((float)k / 10, 1, 0, 0);
        assert_true(tip_place().z > last - 0.5);
        last = tip_place().z;
    }
}

/* The surface stays smooth: small steps of a channel are small steps of every vertex; left and right stay mirror images. */
static void it_moves_smoothly(void **state)
{
    (void)state;
    dvec *before = malloc(tongue.vertex_count * sizeof *before);
    for (int k = 0; k <= 100; k++) {
        take(0.5f, (float)k / 100, 0.5f, 0.3f);
        double step = 0;
        for (uint32_t i = 0; i < tongue.vertex_count && k > 0; i++)
            step = fmax(step, dv_length(dv_sub(tongue.position[i], before[i])));
        assert_true(step < 2.5);
        memcpy(before, tongue.position, tongue.vertex_count * sizeof *before);
    }
    free(before);
    for (uint32_t i = 0; i < rest.vertex_count; i++)
        assert_true(rest.position[i].x == 0 || tongue.position[i].x * rest.position[i].x > 0);
}

/* What a simulation exports is the bent tongue in the turned jaw. */
static void parts_show_it(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_sim *sim = NULL;
    ris_hold hold;
    const ris_mesh *m = rig.tongue.mesh;
    ris_vec4 *out = malloc(m->vertex_count * sizeof *out), *own = malloc(m->vertex_count * sizeof *own);
    assert_int_equal(ris_sim_create_cpu(model, &sim, &err), RIS_OK);
    take(0.6f, 1, -0.5f, 0);
    assert_int_equal(ris_sim_hold(sim, pose, RIS_TICK_S, &hold, &err), RIS_OK);
    assert_int_equal(ris_sim_part(sim, tongue_part, model->rest_position, out, &err), RIS_OK);
    assert_true(ris_sim_part_shape(sim, tongue_part, own));
    assert_false(ris_sim_part_shape(sim, tongue_part ? 0 : 1, own));
    float jaw[12];
    ris__rigid_matrix(&rig.jaw, jaw);
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        const dvec p = ris__place(jaw, tongue.position[i]);
        assert_true(fabs(p.x - (double)out[i].x) + fabs(p.y - (double)out[i].y) +
                        fabs(p.z - (double)out[i].z) <
                    1e-3);
        assert_true((double)own[i].z == tongue.position[i].z);
    }
    ris_sim_destroy(sim);
    free(out);
    free(own);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_touches_nothing),
        cmocka_unit_test(it_goes_where_it_is_told),
        cmocka_unit_test(it_moves_smoothly),
        cmocka_unit_test(parts_show_it),
    };
    return cmocka_run_group_tests_name("tongue", tests, load, unload);
}
