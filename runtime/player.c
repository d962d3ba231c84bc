#include "player.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Times that differ from a tick by less than this are that tick: 29.97 Hz and the like never come so near. */
#define TICK_SLACK 1e-6

ris_result player_init(ris_player *out, ris_sim *sim, const ris_clip *clip, const float *pose, ris_error *err)
{
    const ris_model *model = ris_sim_get_model(sim);
    *out = (ris_player){.sim = sim, .clip = clip};
    out->pose = calloc(model->channel_count ? model->channel_count : 1, sizeof *out->pose);
    ris_vec4 **arrays[] = {&out->position[0], &out->position[1],    &out->normal[0],
                           &out->normal[1],   &out->mixed_position, &out->mixed_normal};
    bool failed = !out->pose;
    for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) {
        *arrays[i] = calloc(model->node_count, sizeof(ris_vec4));
        failed = failed || !*arrays[i];
    }
    if (failed) {
        player_finish(out);
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u nodes", model->node_count);
    }
    if (pose) {
        memcpy(out->pose, pose, model->channel_count * sizeof *pose);
    }
    return RIS_OK;
}

void player_finish(ris_player *player)
{
    free(player->pose);
    for (int i = 0; i < 2; i++) {
        free(player->position[i]);
        free(player->normal[i]);
    }
    free(player->mixed_position);
    free(player->mixed_normal);
    *player = (struct ris_player){0};
}

ris_result player_restart(ris_player *player, ris_error *err)
{
    player->tick = 0;
    player->loaded = false;
    return ris_sim_reset(player->sim, err);
}

uint64_t player_tick_at(double time_s)
{
    double tick = ceil(time_s / RIS_TICK_S - TICK_SLACK);
    return tick > 0 ? (uint64_t)tick : 0;
}

/* Reads the present state into slot 1. */
static ris_result load(ris_player *player, ris_error *err)
{
    if (player->loaded) {
        return RIS_OK;
    }
    ris_result r = ris_sim_read(player->sim, RIS_STATE_POSITION, player->position[1], err);
    if (!r) {
        r = ris_sim_read(player->sim, RIS_STATE_NORMAL, player->normal[1], err);
    }
    player->loaded = !r;
    return r;
}

ris_result player_tick(ris_player *player, ris_error *err)
{
    if (player->clip) {
        ris_clip_sample(player->clip, (double)(player->tick + 1) * RIS_TICK_S, player->pose);
    }
    ris_result r = ris_sim_tick(player->sim, player->pose, err);
    if (!r) {
        player->tick++;
        player->loaded = false;
    }
    return r;
}

/* One tick that keeps the state before it in slot 0. */
static ris_result tick_and_keep(ris_player *player, ris_error *err)
{
    ris_result r = load(player, err);
    if (r) {
        return r;
    }
    ris_vec4 *position = player->position[0], *normal = player->normal[0];
    player->position[0] = player->position[1];
    player->normal[0] = player->normal[1];
    player->position[1] = position;
    player->normal[1] = normal;
    return player_tick(player, err);
}

ris_result player_advance(ris_player *player, double time_s, ris_error *err)
{
    uint64_t target = player_tick_at(time_s);
    ris_result r = RIS_OK;
    while (!r && player->tick + 1 < target) {
        r = player_tick(player, err);
    }
    if (!r && player->tick < target) {
        r = tick_and_keep(player, err);
    }
    return r;
}

static float mix(float a, float b, float t)
{
    return a + (b - a) * t;
}

ris_result player_look(ris_player *player, double time_s, const ris_vec4 **out_position,
                       const ris_vec4 **out_normal, ris_error *err)
{
    ris_result r = load(player, err);
    if (r) {
        return r;
    }
    double share = time_s / RIS_TICK_S - ((double)player->tick - 1.0);
    if (player->tick == 0 || share > 1.0 - TICK_SLACK) {
        *out_position = player->position[1];
        *out_normal = player->normal[1];
        return RIS_OK;
    }
    float t = share > 0 ? (float)share : 0.0f;
    uint32_t count = ris_sim_get_model(player->sim)->node_count;
    for (uint32_t i = 0; i < count; i++) {
        const ris_vec4 *a = &player->position[0][i], *b = &player->position[1][i];
        player->mixed_position[i] =
            (ris_vec4){mix(a->x, b->x, t), mix(a->y, b->y, t), mix(a->z, b->z, t), b->w};
        a = &player->normal[0][i];
        b = &player->normal[1][i];
        ris_vec4 n = {mix(a->x, b->x, t), mix(a->y, b->y, t), mix(a->z, b->z, t), 0};
        float length = sqrtf(n.x * n.x + n.y * n.y + n.z * n.z);
        float scale = length > 0 ? 1.0f / length : 0.0f;
        player->mixed_normal[i] = (ris_vec4){n.x * scale, n.y * scale, n.z * scale, 0};
    }
    *out_position = player->mixed_position;
    *out_normal = player->mixed_normal;
    return RIS_OK;
}
