/* KA-55, KA-57, KU-31: the vocabularies as channels of a model. A term whose channel the head lacks is left out. */
#include "model/vocabulary.h"

#include "asset/names.h"
#include "asset/vocabulary.h"
#include "model_impl.h"

#include <stdlib.h>
#include <string.h>

static bool add_named(const ris_model *model, const char *name, float value, float *pose)
{
    bool found = false;
    uint32_t own = ris_model_channel(model, name);
    if (own != UINT32_MAX) {
        pose[own] += value;
        return true;
    }
    for (uint32_t i = 0; i < model->channel_count; i++) {
        if (ris__name_is_side_of(model->channel[i].name, name)) {
            pose[i] += value;
            found = true;
        }
    }
    return found;
}

bool ris__model_add_channel(const ris_model *model, const char *name, float value, float *pose)
{
    char own[RIS_NAME_SIZE];
    return add_named(model, name, value, pose) ||
           (ris__name_of_synonym(name, own) && add_named(model, own, value, pose));
}

uint32_t ris__model_mirror_channel(const ris_model *model, uint32_t c)
{
    for (uint32_t k = 0; ris__name_is_sided(model->channel[c].name) && k < model->channel_count; k++) {
        if (ris__name_is_opposite(model->channel[k].name, model->channel[c].name)) {
            return k;
        }
    }
    return c;
}

/* A unit of one side (a wink): nothing but left channels. */
static bool is_left(const ris_model *model, const ris_word *word)
{
    bool all = word->value_count > 0;
    for (uint32_t i = 0; i < word->value_count; i++) {
        const char *name = model->channel[word->value[i].channel].name;
        all = all && ris__name_is_sided(name) && name[strlen(name) - 1] == 'L';
    }
    return all;
}

/* One side of a word. Of what does the same on both sides: the channels of that side, and half of those without one,
 * so that both halves make the whole. What is written for one side is written for the left: .L is it, .R its mirror
 * image. */
static void add_side(const ris_model *model, const ris_word *word, char side, float value, float *pose)
{
    const bool for_left = word->kind == RIS_WORD_EXPRESSION ? !word->symmetric : is_left(model, word);
    for (uint32_t i = 0; i < word->value_count; i++) {
        const uint32_t c = word->value[i].channel;
        const char *name = model->channel[c].name;
        const float v = value * word->value[i].value;
        if (for_left) {
            if (side == 'L') {
                pose[c] += v;
            } else {
                pose[ris__model_mirror_channel(model, c)] += ris__name_turns_sign(name) ? -v : v;
            }
        } else if (!ris__name_is_sided(name)) {
            pose[c] += 0.5f * v;
        } else if (name[strlen(name) - 1] == side) {
            pose[c] += v;
        }
    }
}

static bool add_word(const ris_model *model, const char *name, float value, float *pose)
{
    char side;
    const ris_word *word = ris__vocabulary_find(&model->vocabulary, name, &side);
    if (!word) {
        return false;
    }
    if (side) {
        add_side(model, word, side, value, pose);
        return true;
    }
    for (uint32_t i = 0; i < word->value_count; i++) {
        pose[word->value[i].channel] += value * word->value[i].value;
    }
    return true;
}

bool ris__model_add_word(const ris_model *model, const char *name, float value, float *pose)
{
    ris_unit unit[RIS_UNITS_MAX];
    if (!ris__vocabulary_has(&model->vocabulary, name)) {
        return false;
    }
    const uint32_t count = ris__units_split(name, unit);
    for (uint32_t i = 0; i < count; i++) {
        add_word(model, unit[i].name, value * unit[i].factor, pose);
    }
    return count > 0 || add_word(model, name, value, pose);
}

/* What resolving needs beside the model. */
typedef struct resolver {
    ris_model *model;
    float *pose;      /* scratch (channel_count) */
    uint32_t *mirror; /* of each channel (channel_count) */
} resolver;

static bool is_symmetric(const resolver *r)
{
    for (uint32_t c = 0; c < r->model->channel_count; c++) {
        const float other = r->pose[r->mirror[c]];
        if (r->pose[c] != (ris__name_turns_sign(r->model->channel[c].name) ? -other : other)) {
            return false;
        }
    }
    return true;
}

static ris_result resolve(const resolver *r, ris_word *word, ris_error *err)
{
    const uint32_t channels = r->model->channel_count;
    uint32_t count = 0;
    memset(r->pose, 0, channels * sizeof *r->pose);
    for (uint32_t i = 0; i < word->term_count; i++) {
        const char *name = word->term[i].channel;
        const float value = word->term[i].value;
        word->missing_count += !ris__model_add_channel(r->model, name, value, r->pose) &&
                               !ris__model_add_word(r->model, name, value, r->pose);
    }
    for (uint32_t c = 0; c < channels; c++) {
        count += r->pose[c] != 0;
    }
    ris_result result = ris__model_alloc(&word->value, count, sizeof *word->value, "a vocabulary", err);
    for (uint32_t c = 0; c < channels && result == RIS_OK; c++) {
        if (r->pose[c] != 0) {
            word->value[word->value_count++] = (ris_channel_value){c, r->pose[c]};
        }
    }
    word->symmetric = is_symmetric(r);
    return result;
}

ris_result ris__vocabulary_resolve(ris_model *model, ris_error *err)
{
    resolver r = {.model = model};
    ris_result result = ris__model_alloc(&r.pose, model->channel_count, sizeof *r.pose, "a pose", err);
    if (result == RIS_OK) {
        result = ris__model_alloc(&r.mirror, model->channel_count, sizeof *r.mirror, "a pose", err);
    }
    for (uint32_t c = 0; c < model->channel_count && result == RIS_OK; c++) {
        r.mirror[c] = ris__model_mirror_channel(model, c);
    }
    for (uint32_t i = 0; i < model->vocabulary.word_count && result == RIS_OK; i++) {
        result = resolve(&r, &model->vocabulary.word[i], err);
    }
    free(r.pose);
    free(r.mirror);
    return result;
}

ris_result ris__bake_vocabulary(ris_bake *bake, ris_error *err)
{
    ris_result result = ris__vocabulary_read(ris__vocabulary_file, &bake->model->vocabulary, err);
    return result ? result : ris__vocabulary_resolve(bake->model, err);
}
