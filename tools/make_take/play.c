/* The course of a performance: acts and speech in turn, blinks, looks, and a head that is never quite still. */
#include "make_take.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KNOT_S 0.7
#define EYE_FULL_DEG 30.0 /* of an eyeLook shape of 1 */

static double unit(ris_pcg *pcg)
{
    return (double)(ris__pcg_next(pcg) >> 8) / 16777216.0;
}

static double between(ris_pcg *pcg, double low, double high)
{
    return low + (high - low) * unit(pcg);
}

/* Between -1 and 1, nearer to 0 as a rule. */
static double about_zero(ris_pcg *pcg)
{
    const double a = unit(pcg) + unit(pcg);
    return a - 1;
}

uint32_t shape_index(const char *name)
{
    uint32_t k = 0;
    while (k < RIS__ARKIT_COUNT && strcmp(ris__arkit_name[k], name) != 0) {
        k++;
    }
    return k;
}

static bool is_side_of(const char *sided, const char *name)
{
    const size_t length = strlen(name);
    return strncmp(sided, name, length) == 0 &&
           (strcmp(sided + length, "Left") == 0 || strcmp(sided + length, "Right") == 0);
}

static void fill(take_act *out)
{
    for (const take_term *t = out->recipe->term; t < out->recipe->term + MAX_TERMS && t->shape; t++) {
        const bool sided = shape_index(t->shape) == RIS__ARKIT_COUNT;
        for (uint32_t k = 0; k < RIS__ARKIT_COUNT; k++) {
            if (sided ? is_side_of(ris__arkit_name[k], t->shape)
                      : strcmp(ris__arkit_name[k], t->shape) == 0) {
                out->shape[k] = t->amount;
            }
        }
    }
}

static bool add(take_play *play, const take_recipe *recipe, double start_s, double hold_s, double amount)
{
    if (play->act_count % 256 == 0) {
        take_act *grown = realloc(play->act, (play->act_count + 256u) * sizeof *grown);
        if (!grown) {
            return false;
        }
        play->act = grown;
    }
    take_act *out = &play->act[play->act_count++];
    *out = (take_act){.recipe = recipe,
                      .start_s = start_s,
                      .rise_s = recipe->rise_s,
                      .hold_s = hold_s,
                      .fall_s = recipe->fall_s,
                      .amount = amount};
    fill(out);
    return true;
}

static double hold_of(const take_recipe *recipe, ris_pcg *pcg)
{
    return between(pcg, recipe->hold_s[0], recipe->hold_s[1]);
}

static double end_of(const take_act *act)
{
    return act->start_s + act->rise_s + act->hold_s + act->fall_s;
}

/* A phrase of some syllables, each a consonant that runs into a vowel. Returns its end, below 0 without memory. */
static double speak(take_play *play, double time_s, ris_pcg *pcg)
{
    const uint32_t syllables = 4 + ris__pcg_below(pcg, 10);
    for (uint32_t i = 0; i < syllables; i++) {
        const take_recipe *consonant = &consonants[ris__pcg_below(pcg, consonant_count)];
        const take_recipe *vowel = &vowels[ris__pcg_below(pcg, vowel_count)];
        const double strength = between(pcg, 0.7, 1.1);
        if (!add(play, consonant, time_s, hold_of(consonant, pcg), strength) ||
            !add(play, vowel, time_s + consonant->rise_s, hold_of(vowel, pcg), strength)) {
            return -1;
        }
        const take_act *last = &play->act[play->act_count - 1];
        time_s = end_of(last) - 0.6 * last->fall_s + (ris__pcg_below(pcg, 5) == 0 ? 0.12 : 0);
    }
    return time_s + 0.15;
}

/* Every act comes once before any comes again. */
static void shuffle(uint32_t *deck, uint32_t count, ris_pcg *pcg)
{
    for (uint32_t k = 0; k < count; k++) {
        deck[k] = k;
    }
    for (uint32_t k = 0; k + 1 < count; k++) {
        const uint32_t other = k + ris__pcg_below(pcg, count - k), held = deck[k];
        deck[k] = deck[other];
        deck[other] = held;
    }
}

static bool make_acts(const take_options *options, take_play *out)
{
    ris_pcg pcg = ris__pcg_start(options->seed, 1);
    uint32_t deck[64], next = act_count, turn = 0;
    for (double time_s = 0.4; time_s < options->seconds; turn++) {
        if (turn % 4 == 3) {
            time_s = speak(out, time_s, &pcg);
            if (time_s < 0) {
                return false;
            }
            continue;
        }
        if (next == act_count) {
            shuffle(deck, act_count, &pcg);
            next = 0;
        }
        const take_recipe *recipe = &acts[deck[next++]];
        if (!add(out, recipe, time_s, hold_of(recipe, &pcg), between(&pcg, 0.85, 1.1))) {
            return false;
        }
        /* one melts into the next as often as not */
        time_s = end_of(&out->act[out->act_count - 1]) - (ris__pcg_below(&pcg, 2) ? recipe->fall_s : 0) +
                 between(&pcg, 0.05, 0.5);
    }
    return true;
}

static const take_recipe blink = {
    "blink", {0.02, 0.05}, 0.07, 0.16, {{"eyeBlink", 0.97}, {"eyeSquint", 0.1}}};

static bool make_blinks(const take_options *options, take_play *out)
{
    ris_pcg pcg = ris__pcg_start(options->seed, 2);
    for (double time_s = between(&pcg, 0.5, 3); time_s < options->seconds;) {
        if (!add(out, &blink, time_s, hold_of(&blink, &pcg), between(&pcg, 0.92, 1.03))) {
            return false;
        }
        time_s += ris__pcg_below(&pcg, 8) == 0 ? between(&pcg, 0.3, 0.5) : between(&pcg, 2, 6);
    }
    return true;
}

static bool make_looks(const take_options *options, take_play *out)
{
    ris_pcg pcg = ris__pcg_start(options->seed, 3);
    const uint32_t most = (uint32_t)(options->seconds / 0.3) + 4;
    out->look = calloc(most, sizeof *out->look);
    double yaw = 0, pitch = 0;
    for (double time_s = 0.3; out->look && time_s < options->seconds && out->look_count < most;) {
        take_look *l = &out->look[out->look_count++];
        *l = (take_look){.start_s = time_s, .yaw = 26 * about_zero(&pcg), .pitch = 18 * about_zero(&pcg)};
        const double way = (l->yaw > yaw ? l->yaw - yaw : yaw - l->yaw) +
                           (l->pitch > pitch ? l->pitch - pitch : pitch - l->pitch);
        l->move_s = 0.025 + 0.0022 * way; /* main sequence of saccades: about 2.2 ms a degree and 21 ms */
        yaw = l->yaw;
        pitch = l->pitch;
        time_s += l->move_s + between(&pcg, 0.3, 2.4);
    }
    return out->look != NULL;
}

static bool make_knots(const take_options *options, take_play *out)
{
    ris_pcg pcg = ris__pcg_start(options->seed, 4);
    out->knot_count = (uint32_t)(options->seconds / KNOT_S) + 5;
    out->knot = calloc(out->knot_count, sizeof *out->knot);
    for (uint32_t k = 0; out->knot && k < out->knot_count; k++) {
        out->knot[k] = (take_knot){{24 * about_zero(&pcg), 13 * about_zero(&pcg), 9 * about_zero(&pcg)}};
    }
    return out->knot != NULL;
}

ris_result play_make(const take_options *options, take_play *out, ris_error *err)
{
    *out = (take_play){0};
    if (!options->still && (!make_acts(options, out) || !make_blinks(options, out) ||
                            !make_looks(options, out) || !make_knots(options, out))) {
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for a performance of %g s", options->seconds);
    }
    return RIS_OK;
}

void play_finish(take_play *play)
{
    free(play->act);
    free(play->look);
    free(play->knot);
}

static double smooth(double u)
{
    u = u < 0 ? 0 : u > 1 ? 1 : u;
    return u * u * u * (u * (6 * u - 15) + 10); /* minimum jerk */
}

static double share_of(const take_act *act, double time_s)
{
    const double t = time_s - act->start_s, falling = t - act->rise_s - act->hold_s;
    return t <= 0                   ? 0
           : falling >= act->fall_s ? 0
                                    : smooth(t / act->rise_s) * (1 - smooth(falling / act->fall_s));
}

/* Opposites: each gives way to the other, as no face does both. Without a corner, or the face would leap. */
static void give_way(double *shape, const char *one, const char *other)
{
    double *a = &shape[shape_index(one)], *b = &shape[shape_index(other)];
    const double had = *a;
    *a *= 1 - 0.7 * *b;
    *b *= 1 - 0.7 * had;
}

static void settle(double *shape)
{
    static const char *const pair[][2] = {
        {"mouthSmile", "mouthPucker"},     {"mouthSmile", "mouthFunnel"},
        {"mouthSmile", "mouthFrown"},      {"mouthStretch", "mouthPucker"},
        {"eyeWide", "eyeBlink"},           {"eyeWide", "eyeSquint"},
        {"browOuterUp", "browDown"},       {"mouthRollLower", "mouthLowerDown"},
        {"mouthPress", "mouthLowerDown"},  {"mouthPress", "mouthUpperUp"},
        {"mouthFunnel", "mouthRollUpper"}, {"mouthFunnel", "mouthRollLower"},
        {"cheekPuff", "jawOpen"},          {"mouthPress", "jawOpen"},
        {"mouthRollUpper", "jawOpen"},     {"mouthShrugLower", "jawOpen"},
        {"jawLeft", "jawRight"},           {"mouthLeft", "mouthRight"},
        {"mouthStretch", "mouthFunnel"},   {"mouthRollUpper", "mouthUpperUp"},
        {"mouthPress", "mouthFunnel"},     {"mouthDimple", "mouthPucker"},
        {"jawForward", "jawOpen"},         {"cheekPuff", "mouthSmile"}};
    for (size_t k = 0; k < sizeof pair / sizeof *pair; k++) {
        const bool first = shape_index(pair[k][0]) == RIS__ARKIT_COUNT,
                   second = shape_index(pair[k][1]) == RIS__ARKIT_COUNT;
        for (int side = 0; side < (first || second ? 2 : 1); side++) {
            char one[RIS_NAME_SIZE], other[RIS_NAME_SIZE];
            snprintf(one, sizeof one, "%s%s", pair[k][0], !first ? "" : side ? "Right" : "Left");
            snprintf(other, sizeof other, "%s%s", pair[k][1], !second ? "" : side ? "Right" : "Left");
            give_way(shape, one, other);
        }
    }
    double *closed = &shape[shape_index("mouthClose")], open = shape[shape_index("jawOpen")];
    *closed = *closed < open ? *closed : open; /* mouthClose is how far the lips undo the jaw */
    double *tongue = &shape[shape_index("tongueOut")];
    *tongue = *tongue < 2 * open ? *tongue : 2 * open;
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT; k++) {
        shape[k] = shape[k] > 1 ? 1 : shape[k];
    }
}

static void look_at(const take_play *play, double time_s, take_frame *out)
{
    double yaw = 0, pitch = 0;
    for (uint32_t i = 0; i < play->look_count && play->look[i].start_s < time_s; i++) {
        const take_look *l = &play->look[i];
        const double share = smooth((time_s - l->start_s) / l->move_s);
        yaw += (l->yaw - yaw) * share;
        pitch += (l->pitch - pitch) * share;
    }
    const double yaws[2] = {yaw - 1, yaw + 1}; /* the eyes meet at some 1.8 m */
    for (int eye = 0; eye < 2; eye++) {
        const char *side = eye ? "Right" : "Left";
        const double out_deg = eye ? -yaws[eye] : yaws[eye];
        const struct {
            const char *stem;
            double degrees;
        } shape[] = {
            {"eyeLookOut", out_deg}, {"eyeLookIn", -out_deg}, {"eyeLookUp", pitch}, {"eyeLookDown", -pitch}};
        for (int k = 0; k < 4; k++) {
            char name[RIS_NAME_SIZE];
            snprintf(name, sizeof name, "%s%s", shape[k].stem, side);
            out->shape[shape_index(name)] = shape[k].degrees > 0 ? shape[k].degrees / EYE_FULL_DEG : 0;
        }
        out->eye_yaw[eye] = yaws[eye];
        out->eye_pitch[eye] = pitch;
    }
}

static void turn_head(const take_play *play, double time_s, take_frame *out)
{
    const double place = time_s / KNOT_S;
    const uint32_t at = (uint32_t)place;
    const double u = place - at, v = 1 - u;
    const double weight[4] = {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
                              (3 * v * v * v - 6 * v * v + 4) / 6, u * u * u / 6};
    double value[3] = {0};
    for (uint32_t k = 0; k < 4 && at + k < play->knot_count; k++) {
        for (int i = 0; i < 3; i++) {
            value[i] += weight[k] * play->knot[at + k].value[i];
        }
    }
    out->head_yaw = value[0];
    out->head_pitch = value[1];
    out->head_roll = value[2];
}

void play_at(const take_play *play, double time_s, take_frame *out)
{
    *out = (take_frame){0};
    for (uint32_t i = 0; i < play->act_count; i++) {
        const double share = share_of(&play->act[i], time_s) * play->act[i].amount;
        for (uint32_t k = 0; share > 0 && k < RIS__ARKIT_COUNT; k++) {
            /* what two acts want is not twice as much: the rest of the way to 1 */
            out->shape[k] += share * play->act[i].shape[k] * (out->shape[k] < 1 ? 1 - out->shape[k] : 0);
        }
    }
    settle(out->shape);
    look_at(play, time_s, out);
    turn_head(play, time_s, out);
}
