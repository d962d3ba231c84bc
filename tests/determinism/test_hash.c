/* The CPU reference gives the same bits on every compiler and optimisation level: golden hashes of a code-
 * built scene (no file, no libm but sqrtf), repeated runs, save and restore, one tick of 8 substeps = 8
 * ticks of one. Built twice: as is, and with -O0. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scenes/scenes.h"
#include "sim/sim_impl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    ris_tissue_model tissue;
    bool flesh; /* with onset, follow-through and weight */
    uint64_t hash;
} golden[] = {
    {RIS_TISSUE_RISORIUS, false, UINT64_C(0x12ca34e8b539bb63)},
    {RIS_TISSUE_KAEHLER, false, UINT64_C(0x2328a598a256461e)},
    {RIS_TISSUE_RISORIUS, true, UINT64_C(0x58362f78ee205e1c)},
};

static ris_error err;

static void need(ris_result result)
{
    if (result != RIS_OK) {
        fail_msg("%s", err.text);
    }
}

typedef struct player {
    ris_model *model;
    ris_sim *sim;
    float *pose;
} player;

static player open_player(ris_tissue_model tissue, bool flesh, uint32_t substeps)
{
    player p = {0};
    ris_scene_def def = ris_default_scene_def();
    def.tissue.model = tissue;
    def.tissue.substeps = substeps;
    if (flesh) {
        def.dynamics = ris_default_dynamics();
    }
    def.spacing_mm = 4;
    def.columns = 25;
    def.rows = 31;
    if (tissue == RIS_TISSUE_KAEHLER) {
        def.spacing_mm = 6;
        def.columns = 17;
        def.rows = 21;
    }
    need(ris_scene_model(&def, &p.model, &err));
    need(ris_sim_create_cpu(p.model, &p.sim, &err));
    p.pose = calloc(p.model->channel_count, sizeof *p.pose);
    return p;
}

static void close_player(player *p)
{
    ris_sim_destroy(p->sim);
    ris_model_destroy(p->model);
    free(p->pose);
}

static uint64_t hash_of(player *p)
{
    uint64_t hash = 0;
    need(ris_sim_hash(p->sim, &hash, &err));
    return hash;
}

/* A smile with the jaw opening and closing and a head that turns and nods over 40 ticks. */
static void play(player *p)
{
    for (int i = 0; i < 40; ++i) {
        const float t = (float)(i < 20 ? i + 1 : 40 - i) / 20.0f;
        p->pose[ris_model_channel(p->model, "zygomaticus_major.L")] = t;
        p->pose[ris_model_channel(p->model, "zygomaticus_major.R")] = 0.75f * t;
        p->pose[ris_model_channel(p->model, "orbicularis_oris_superior")] = 0.5f * t;
        p->pose[ris_model_channel(p->model, "jaw.open")] = 0.625f * t;
        p->pose[ris_model_channel(p->model, "jaw.side")] = -0.25f * t;
        p->pose[ris_model_channel(p->model, "head.yaw")] = 30.0f * t * t;
        p->pose[ris_model_channel(p->model, "head.pitch")] = -20.0f * t;
        p->pose[ris_model_channel(p->model, "head.x")] = 8.0f * t * t;
        need(ris_sim_tick(p->sim, p->pose, &err));
    }
}

static void golden_hashes(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof golden / sizeof golden[0]; ++k) {
        player p = open_player(golden[k].tissue, golden[k].flesh, 8);
        play(&p);
        const uint64_t first = hash_of(&p);
        need(ris_sim_reset(p.sim, &err));
        play(&p);
        assert_true(hash_of(&p) == first);
        if (first != golden[k].hash) {
            fail_msg("scene %zu hashes to %016llx, the golden hash is %016llx", k, (unsigned long long)first,
                     (unsigned long long)golden[k].hash);
        }
        close_player(&p);
    }
}

/* Control: one bit of one velocity changes the hash. */
static void one_bit_changes_the_hash(void **state)
{
    (void)state;
    player p = open_player(RIS_TISSUE_RISORIUS, false, 8);
    play(&p);
    const uint64_t hash = hash_of(&p);
    ris_vec4 *v = malloc(p.model->node_count * sizeof *v);
    need(ris_sim_read(p.sim, RIS_STATE_VELOCITY_PREV, v, &err));
    uint32_t word;
    memcpy(&word, &v[333].y, sizeof word);
    word ^= 1u;
    memcpy(&v[333].y, &word, sizeof word);
    need(ris_sim_write(p.sim, RIS_STATE_VELOCITY_PREV, v, &err));
    assert_true(hash_of(&p) != hash);
    free(v);
    close_player(&p);
}

static void saved_states_go_on(void **state)
{
    (void)state;
    static const ris_state states[] = {RIS_STATE_POSITION, RIS_STATE_VELOCITY_HALF, RIS_STATE_VELOCITY_PREV};
    player a = open_player(RIS_TISSUE_RISORIUS, false, 8), b = open_player(RIS_TISSUE_RISORIUS, false, 8);
    a.pose[0] = b.pose[0] = 1.0f;
    for (int i = 0; i < 5; ++i) {
        need(ris_sim_tick(a.sim, a.pose, &err));
    }
    need(ris_sim_tick(b.sim, b.pose, &err)); /* the same pose held, so that the anchors are those of a */
    ris_vec4 *value = malloc(a.model->node_count * sizeof *value);
    for (size_t k = 0; k < 3; ++k) {
        need(ris_sim_read(a.sim, states[k], value, &err));
        need(ris_sim_write(b.sim, states[k], value, &err));
    }
    assert_true(hash_of(&a) == hash_of(&b));
    for (int i = 0; i < 10; ++i) {
        need(ris_sim_tick(a.sim, a.pose, &err));
        need(ris_sim_tick(b.sim, b.pose, &err));
        assert_true(hash_of(&a) == hash_of(&b));
    }
    free(value);
    close_player(&a);
    close_player(&b);
}

static void eight_substeps_are_eight_ticks(void **state)
{
    (void)state;
    player a = open_player(RIS_TISSUE_RISORIUS, false, 8), b = open_player(RIS_TISSUE_RISORIUS, false, 8);
    b.model->owned_head->tissue.substeps = 1; /* one of the same dt */
    a.pose[0] = b.pose[0] = 1.0f;
    for (int i = 0; i < 10; ++i) {
        need(ris_sim_tick(a.sim, a.pose, &err));
        for (int k = 0; k < 8; ++k) {
            need(ris_sim_tick(b.sim, b.pose, &err));
        }
        assert_true(hash_of(&a) == hash_of(&b));
    }
    close_player(&a);
    close_player(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(golden_hashes),
        cmocka_unit_test(one_bit_changes_the_hash),
        cmocka_unit_test(saved_states_go_on),
        cmocka_unit_test(eight_substeps_are_eight_ticks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
