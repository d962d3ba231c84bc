/* Which channels `risorius solve` may move. */
#include "solve.h"

#include "asset/names.h"
#include "risorius/timeline.h"

#include <stdlib.h>
#include <string.h>

static ris_result add(solve_run *run, const char *name, float minimum, float maximum, ris_error *err)
{
    for (uint32_t k = 0; k < run->control_count; k++) {
        if (strcmp(run->control[k].name, name) == 0) {
            return RIS_OK;
        }
    }
    if (run->control_count == RIS_SOLVE_CONTROLS) {
        return ris_fail(err, RIS_ERROR_USAGE, "--channels names more than %d channels", RIS_SOLVE_CONTROLS);
    }
    ris_control *control = &run->control[run->control_count++];
    *control = (ris_control){.minimum = minimum, .maximum = maximum};
    snprintf(control->name, sizeof control->name, "%.*s", RIS_NAME_SIZE - 1, name);
    return RIS_OK;
}

static ris_result add_channel(solve_run *run, uint32_t channel, ris_error *err)
{
    const ris_channel *c = &run->backend.model->channel[channel];
    return add(run, c->name, c->minimum, c->maximum, err);
}

static bool starts(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

/* "all": what moves the skin, or may; "muscles": muscles, protrusion of the lips and jaw. */
static bool in_group(const ris_model *model, uint32_t channel, const char *group)
{
    const char *name = model->channel[channel].name;
    if (strcmp(group, "all") == 0) {
        return !starts(name, "head.");
    }
    return channel < model->muscle_count || starts(name, "jaw.") || strstr(name, ".protrude");
}

/* What a word does at full strength; false if it turns the head, which moves no skin, or does nothing here. */
static ris_result read_word(const ris_model *model, const char *name, float *pose, bool *out_moves,
                            ris_error *err)
{
    memset(pose, 0, model->channel_count * sizeof *pose);
    *out_moves = false;
    ris_result r = ris_pose_add(model, name, 1, pose, err);
    for (uint32_t c = 0; !r && c < model->channel_count; c++) {
        if (pose[c] != 0 && starts(model->channel[c].name, "head.")) {
            *out_moves = false;
            return RIS_OK;
        }
        *out_moves = *out_moves || pose[c] != 0;
    }
    return r;
}

/* A word of a vocabulary; of one whose sides differ each side, for both halves of what has no side are one and the same.
 * pose: three times channel_count floats of room. */
static ris_result add_word(solve_run *run, const ris_word *word, float *pose, ris_error *err)
{
    const ris_model *model = run->backend.model;
    float *side[2] = {pose + model->channel_count, pose + 2 * (size_t)model->channel_count};
    char name[2][RIS_NAME_SIZE + 4];
    bool moves, moves_side;
    ris_result r = read_word(model, word->name, pose, &moves, err);
    if (r || !moves) {
        return r;
    }
    for (int k = 0; k < 2; k++) {
        snprintf(name[k], sizeof name[k], "%s.%c", word->name, "LR"[k]);
    }
    /* without an error to report: a word may have no sides */
    if (word->symmetric && strlen(name[0]) < RIS_NAME_SIZE &&
        read_word(model, name[0], side[0], &moves_side, NULL) == RIS_OK &&
        read_word(model, name[1], side[1], &moves_side, NULL) == RIS_OK &&
        memcmp(side[0], side[1], model->channel_count * sizeof *pose) != 0) {
        r = add(run, name[0], 0, 1, err);
        return r ? r : add(run, name[1], 0, 1, err);
    }
    return add(run, word->name, 0, 1, err);
}

static ris_result add_words(solve_run *run, ris_word_kind kind, ris_error *err)
{
    const ris_vocabulary *vocabulary = &run->backend.model->vocabulary;
    float *pose = calloc(3 * (size_t)run->backend.model->channel_count + 1u, sizeof *pose);
    ris_result r = pose ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    for (uint32_t i = 0; !r && i < vocabulary->word_count; i++) {
        if (vocabulary->word[i].kind == kind) {
            r = add_word(run, &vocabulary->word[i], pose, err);
        }
    }
    free(pose);
    return r;
}

/* A channel, both sides of one, "eye.*", or any other name of a pose with its strength. */
static ris_result add_name(solve_run *run, const char *name, ris_error *err)
{
    const ris_model *model = run->backend.model;
    const size_t length = strlen(name);
    const bool wild = length > 0 && name[length - 1] == '*';
    const uint32_t before = run->control_count;
    bool known = false;
    ris_result r = RIS_OK;
    for (uint32_t c = 0; !r && c < model->channel_count; c++) {
        const char *channel = model->channel[c].name;
        if (wild ? strncmp(channel, name, length - 1) == 0
                 : strcmp(channel, name) == 0 || ris__name_is_side_of(channel, name)) {
            known = true;
            r = add_channel(run, c, err);
        }
    }
    if (r || known) {
        return r;
    }
    float *pose = calloc(model->channel_count + 1u, sizeof *pose);
    r = pose ? ris_pose_add(model, name, 1, pose, err)
             : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    free(pose);
    return r || run->control_count > before ? r : add(run, name, 0, 1, err);
}

ris_result solve_controls(solve_run *run, ris_error *err)
{
    const ris_model *model = run->backend.model;
    const char *list = run->args.channels ? run->args.channels : run->args.self_test ? "all" : "muscles";
    ris_result r = RIS_OK;
    for (const char *at = list; !r;) {
        char name[RIS_NAME_SIZE];
        const size_t length = strcspn(at, ",");
        if (length == 0 || length >= sizeof name) {
            return ris_fail(err, RIS_ERROR_USAGE, "--channels \"%.200s\": expected a name, found \"%.*s\"",
                            list, (int)(length < 80 ? length : 80), at);
        }
        memcpy(name, at, length);
        name[length] = '\0';
        if (strcmp(name, "au") == 0) {
            r = add_words(run, RIS_WORD_UNIT, err);
        } else if (strcmp(name, "arkit") == 0) {
            r = add_words(run, RIS_WORD_SHAPE, err);
        } else if (strcmp(name, "all") == 0 || strcmp(name, "muscles") == 0) {
            for (uint32_t c = 0; !r && c < model->channel_count; c++) {
                r = in_group(model, c, name) ? add_channel(run, c, err) : RIS_OK;
            }
        } else {
            r = add_name(run, name, err);
        }
        if (at[length] == '\0') {
            break;
        }
        at += length + 1;
    }
    return r;
}
