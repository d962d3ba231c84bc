/* KA-48, KA-49: poses from names. Contributions to one channel add, then clamp. */
#include "anim/pose_names.h"
#include "asset/names.h"
#include "asset/vocabulary.h"
#include "base/text.h"
#include "model/vocabulary.h"
#include "risorius/timeline.h"

#include <stdlib.h>
#include <string.h>

#define MAX_VALUE 1000.0 /* beyond every channel; keeps sums finite */
#define MAX_NESTING 2    /* an expression may name expressions that are made of channels */

static const char *expand(const ris_pose_names *names, const char *name, float value, int depth, float *pose)
{
    const ris_head *head = names->model->head;
    ris_pose_names inner = *names;
    if (ris__model_add_channel(names->model, name, value, pose)) {
        return NULL;
    }
    const ris_expression *found =
        ris__expression_find(names->clip_expression, names->clip_expression_count, name);
    if (!found && head) {
        found = ris__expression_find(head->expression, head->expression_count, name);
        inner.clip_expression_count = 0; /* the head's own terms mean the head's expressions */
    }
    if (!found) {
        return ris__model_add_word(names->model, name, value, pose) ? NULL : name;
    }
    if (depth == MAX_NESTING) {
        return name;
    }
    for (uint32_t i = 0; i < found->term_count; i++) {
        const char *unknown =
            expand(&inner, found->term[i].channel, value * found->term[i].value, depth + 1, pose);
        if (unknown) {
            return unknown;
        }
    }
    return NULL;
}

const char *ris__pose_expand(const ris_pose_names *names, const char *name, float value, float *pose)
{
    return expand(names, name, value, 0, pose);
}

const char *ris__pose_nearest(const ris_pose_names *names, const char *name, char *out, size_t size)
{
    const ris_head *head = names->model->head;
    ris_nearest nearest;
    ris__nearest_init(&nearest, name);
    for (uint32_t i = 0; i < names->clip_expression_count; i++) {
        ris__nearest_add(&nearest, names->clip_expression[i].name);
    }
    for (uint32_t i = 0; head && i < head->expression_count; i++) {
        ris__nearest_add(&nearest, head->expression[i].name);
    }
    for (uint32_t i = 0; i < names->model->channel_count; i++) {
        ris__nearest_add(&nearest, names->model->channel[i].name);
    }
    ris__vocabulary_nearest(&names->model->vocabulary, &nearest);
    return ris__nearest_text(&nearest, out, size);
}

ris_result ris_pose_add(const ris_model *model, const char *name, float value, float *pose, ris_error *err)
{
    ris_pose_names names = {.model = model};
    char nearest[256];
    const char *unknown = ris__pose_expand(&names, name, value, pose);
    if (unknown) {
        return ris_fail(
            err, RIS_ERROR_USAGE,
            "\"%.63s\" is no muscle, channel, unit, shape, viseme or expression of this head; nearest: "
            "%s",
            unknown, ris__pose_nearest(&names, unknown, nearest, sizeof nearest));
    }
    return RIS_OK;
}

void ris_pose_clamp(const ris_model *model, float *pose)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        const ris_channel *channel = &model->channel[i];
        pose[i] = pose[i] < channel->minimum ? channel->minimum : pose[i];
        pose[i] = pose[i] > channel->maximum ? channel->maximum : pose[i];
    }
}

/* A number, or a letter A-E for 0.2 .. 1 (intensities of FACS). */
static bool read_value(const char *text, const char *end, float *out)
{
    double value;
    if (end - text == 1 && *text >= 'A' && *text <= 'E') {
        *out = (float)(*text - 'A' + 1) / 5.0f;
        return true;
    }
    if (ris__parse_number(text, end, &value) != end || !(value >= -MAX_VALUE && value <= MAX_VALUE)) {
        return false;
    }
    *out = (float)value;
    return true;
}

ris_result ris_pose_parse(const ris_model *model, const char *text, float *pose, ris_error *err)
{
    for (uint32_t i = 0; i < model->channel_count; i++) {
        pose[i] = 0;
    }
    for (const char *at = text;;) {
        size_t length = strcspn(at, ",");
        const char *end = at + length, *equals = memchr(at, '=', length);
        char name[RIS_NAME_SIZE];
        float value;
        if (!equals || equals == at || equals - at >= RIS_NAME_SIZE) {
            return ris_fail(err, RIS_ERROR_USAGE, "pose \"%.200s\": expected name=value, found \"%.*s\"",
                            text, (int)(length < 80 ? length : 80), at);
        }
        if (!read_value(equals + 1, end, &value)) {
            int shown = (int)(end - equals - 1 < 40 ? end - equals - 1 : 40);
            return ris_fail(err, RIS_ERROR_USAGE,
                            "pose \"%.200s\": expected a number or a letter A to E, found \"%.*s\"", text,
                            shown, equals + 1);
        }
        memcpy(name, at, (size_t)(equals - at));
        name[equals - at] = 0;
        ris_result result = ris_pose_add(model, name, value, pose, err);
        if (result != RIS_OK) {
            return result;
        }
        if (*end == 0) {
            break;
        }
        at = end + 1;
    }
    ris_pose_clamp(model, pose);
    return RIS_OK;
}
