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
    snprintf(control->name, sizeof control->name, "%s", name);
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
        if (strcmp(name, "all") == 0 || strcmp(name, "muscles") == 0) {
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
