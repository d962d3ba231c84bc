/* Random poses (KA-48): channels, values and their text. */
#include "measure/soak_pose.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_FEW 6
#define STEPS 1000

const char *ris__soak_kind_name(ris_soak_kind kind)
{
    return kind == RIS_SOAK_FEW ? "few" : kind == RIS_SOAK_ALL ? "all" : "single";
}

static bool is_head(const ris_channel *channel)
{
    return strncmp(channel->name, "head.", 5) == 0;
}

uint32_t ris__soak_single_count(const ris_model *model)
{
    uint32_t count = 0;
    for (uint32_t c = 0; c < model->channel_count; ++c) {
        count += (model->channel[c].minimum != 0.0f) + (model->channel[c].maximum != 0.0f);
    }
    return count;
}

typedef struct writer {
    char *text;
    size_t used, size;
} writer;

static void write_value(writer *w, const char *name, double value)
{
    const int length =
        snprintf(w->text + w->used, w->size - w->used, "%s%s=%.6g", w->used ? "," : "", name, value);
    w->used += (size_t)length;
}

static void write_random(writer *w, const ris_channel *channel, ris_pcg *pcg)
{
    const double low = (double)channel->minimum, high = (double)channel->maximum;
    const double share = (double)ris__pcg_below(pcg, STEPS + 1) / STEPS;
    write_value(w, channel->name, low + (high - low) * share);
}

/* Distinct channels in order of drawing (the first steps of a Fisher-Yates shuffle). */
static void write_few(writer *w, const ris_model *model, uint32_t *list, uint32_t count, ris_pcg *pcg)
{
    uint32_t wanted = 1 + ris__pcg_below(pcg, MOST_FEW);
    wanted = wanted < count ? wanted : count;
    for (uint32_t k = 0; k < wanted; ++k) {
        const uint32_t at = k + ris__pcg_below(pcg, count - k), chosen = list[at];
        list[at] = list[k];
        list[k] = chosen;
        write_random(w, &model->channel[chosen], pcg);
    }
}

static void write_single(writer *w, const ris_model *model, uint32_t number)
{
    for (uint32_t c = 0; c < model->channel_count; ++c) {
        const float ends[2] = {model->channel[c].minimum, model->channel[c].maximum};
        for (int e = 0; e < 2; ++e) {
            if (ends[e] != 0.0f && number-- == 0) {
                write_value(w, model->channel[c].name, (double)ends[e]);
                return;
            }
        }
    }
}

char *ris__soak_pose_text(const ris_model *model, uint64_t seed, ris_soak_id id)
{
    uint32_t *list = malloc(((size_t)model->channel_count + 1) * sizeof *list), count = 0;
    writer w = {.size = ((size_t)model->channel_count + 1) * (RIS_NAME_SIZE + 16)};
    w.text = calloc(w.size, 1);
    if (!list || !w.text) {
        free(list);
        free(w.text);
        return NULL;
    }
    for (uint32_t c = 0; c < model->channel_count; ++c) {
        if (!is_head(&model->channel[c])) {
            list[count++] = c;
        }
    }
    ris_pcg pcg = ris__pcg_start(seed, (uint64_t)id.kind << 32 | id.number);
    if (id.kind == RIS_SOAK_SINGLE) {
        write_single(&w, model, id.number);
    } else if (id.kind == RIS_SOAK_FEW && count) {
        write_few(&w, model, list, count, &pcg);
    }
    for (uint32_t k = 0; id.kind == RIS_SOAK_ALL && k < count; ++k) {
        write_random(&w, &model->channel[list[k]], &pcg);
    }
    free(list);
    if (w.used == 0) {
        free(w.text);
        return NULL;
    }
    return w.text;
}
