/* KA-51, KA-52: coarticulation by dominance: M. M. Cohen, D. W. Massaro, Modeling coarticulation in synthetic visual
 * speech, in: Models and Techniques in Computer Animation, Springer 1993. After A. Löfqvist, Speech as audible
 * gestures (1990). What is ours: the hold, the rounded tip, pauses between phones (docs/speech.md). */
#include "anim/speech.h"
#include "base/real.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_PHONES 65536
#define TIP_S 0.012   /* the tip of a dominance is rounded over this time, so that nothing has a kink */
#define REACH_S 1.0   /* no dominance matters this far away */
#define PAUSE_S 0.25  /* a longer gap between phones, and what lies before and behind them, is silence */
#define RELEASE_S 0.1 /* between a phone and the silence's hold */
#define FALL_S                                                                                               \
    0.15 /* a long phone is held but for so much at its ends: dominance must not run out within it */
#define LONG_S 1e6

static ris_result no_memory(const ris_json_at *at, ris_error *err)
{
    return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for speech", at->json->name);
}

double ris__speech_dominance(const ris_speech *speech, uint32_t segment, ris_articulator part, double time_s)
{
    const ris_utterance *s = &speech->segment[segment];
    const ris_dominance *d = &speech->phonetics.viseme[s->viseme].dominance[part];
    double away = time_s < s->from_s ? s->from_s - time_s : time_s > s->to_s ? time_s - s->to_s : 0;
    double rate = time_s < s->from_s ? d->before_per_s : d->after_per_s;
    return d->strength * ris__exp(-rate * (sqrt(away * away + TIP_S * TIP_S) - TIP_S));
}

/* The first segment that may matter at time_s. */
static uint32_t first_near(const ris_speech *speech, double time_s)
{
    uint32_t low = 0, high = speech->segment_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (speech->segment[middle].to_s < time_s - REACH_S) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

void ris__speech_add(const ris_speech *speech, double time_s, uint32_t first, uint32_t count, float *pose)
{
    time_s += speech->lead_s;
    const uint32_t begin = first_near(speech, time_s);
    double all[RIS_ARTICULATORS] = {0};
    uint32_t end = begin;
    for (; end < speech->segment_count && speech->segment[end].from_s <= time_s + REACH_S; end++) {
        for (int part = 0; part < RIS_ARTICULATORS; part++) {
            all[part] += ris__speech_dominance(speech, end, (ris_articulator)part, time_s);
        }
    }
    for (uint32_t i = begin; i < end; i++) {
        const ris_utterance *segment = &speech->segment[i];
        const ris_mouth_target *target = &speech->target[segment->viseme];
        double share[RIS_ARTICULATORS];
        for (int part = 0; part < RIS_ARTICULATORS; part++) {
            share[part] =
                segment->amount / all[part] * ris__speech_dominance(speech, i, (ris_articulator)part, time_s);
        }
        for (uint32_t n = 0; n < target->count; n++) {
            uint32_t channel = target->value[n].channel, at = channel - first;
            if (at < count) {
                pose[at] += (float)(share[speech->articulator[channel]] * (double)target->value[n].value);
            }
        }
    }
}

void ris__speech_touch(const ris_speech *speech, bool *touches)
{
    for (uint32_t i = 0; i < speech->segment_count; i++) {
        const ris_mouth_target *target = &speech->target[speech->segment[i].viseme];
        for (uint32_t n = 0; n < target->count; n++) {
            touches[target->value[n].channel] = true;
        }
    }
}

static void add_segment(ris_speech *speech, double start_s, double end_s, const ris_phone_part *part,
                        const char *phone)
{
    double hold = speech->phonetics.viseme[part->viseme].hold;
    double fall_s = fmin((1 - hold) * (end_s - start_s) / 2, FALL_S);
    ris_utterance *segment = &speech->segment[speech->segment_count++];
    *segment = (ris_utterance){.from_s = start_s + fall_s,
                               .to_s = end_s - fall_s,
                               .middle_s = (start_s + end_s) / 2,
                               .amount = part->amount,
                               .viseme = part->viseme};
    strcpy(segment->phone, phone);
}

/* Silence whose hold leaves RELEASE_S to the phones beside it. */
static void add_pause(ris_speech *speech, double start_s, double end_s)
{
    uint32_t silence = ris__phonetics_viseme(&speech->phonetics, "sil");
    ris_utterance *segment = &speech->segment[speech->segment_count++];
    *segment = (ris_utterance){.from_s = start_s + RELEASE_S,
                               .to_s = end_s - RELEASE_S,
                               .middle_s = (start_s + end_s) / 2,
                               .amount = 1,
                               .viseme = silence};
}

typedef struct reader {
    ris_speech *speech;
    double duration_s, end_s; /* of the layer; of the phone before */
    ris_error *err;
} reader;

static ris_result read_symbol(const ris_json_at *at, reader *r, ris_phone *out)
{
    const ris_phonetics *phonetics = &r->speech->phonetics;
    ris_json_at phone_at = ris__json_key(at, "phone"), viseme_at = ris__json_key(at, "viseme");
    char name[RIS_PHONE_SIZE];
    if (!phone_at.value == !viseme_at.value) {
        return ris__json_fail(at, r->err, "expected one of \"phone\" and \"viseme\"");
    }
    ris_json_at *symbol = phone_at.value ? &phone_at : &viseme_at;
    ris_result result = ris__json_text(symbol, RIS_JSON_REQUIRED, name, sizeof name, r->err);
    if (result) {
        return result;
    }
    if (viseme_at.value) {
        *out = (ris_phone){.part_count = 1, .part = {{ris__phonetics_viseme(phonetics, name), 1, 1}}};
        strcpy(out->symbol, name);
        return out->part[0].viseme != UINT32_MAX
                   ? RIS_OK
                   : ris__json_fail(symbol, r->err, "unknown viseme \"%s\"", name);
    }
    const ris_phone *phone = ris__phonetics_find(phonetics, name);
    if (!phone) {
        return ris__json_fail(symbol, r->err, "unknown phone \"%s\": no symbol of ipa.json", name);
    }
    *out = *phone;
    return RIS_OK;
}

static ris_result read_segment(const ris_json_at *at, reader *r)
{
    static const char *const keys[] = {"phone", "viseme", "t", "end", "amount", NULL};
    ris_json_at t = ris__json_key(at, "t"), end = ris__json_key(at, "end"),
                amount_at = ris__json_key(at, "amount");
    double start_s = 0, end_s = 0, amount = 1;
    ris_phone phone;
    ris_result result;
    if ((result = ris__json_check_object(at, keys, r->err)) || (result = read_symbol(at, r, &phone)) ||
        (result = ris__json_double(&t, RIS_JSON_REQUIRED, 0, r->duration_s, &start_s, r->err)) ||
        (result = ris__json_double(&end, RIS_JSON_REQUIRED, 0, r->duration_s, &end_s, r->err)) ||
        (result = ris__json_double(&amount_at, RIS_JSON_OPTIONAL, 0, 2, &amount, r->err))) {
        return result;
    }
    if (start_s < r->end_s - 1e-6) {
        return ris__json_expected(&t, r->err, "a time at or after the end of the phone before");
    }
    if (end_s - start_s < 1e-3) {
        return ris__json_expected(&end, r->err, "a time at least 1 ms after \"t\"");
    }
    if (r->speech->segment_count == 0 || start_s - r->end_s > PAUSE_S) {
        add_pause(r->speech, r->speech->segment_count == 0 ? -LONG_S : r->end_s, start_s);
    }
    double from_s = start_s;
    for (uint32_t i = 0; i < phone.part_count; i++) {
        ris_phone_part part = phone.part[i];
        double to_s = from_s + part.share * (end_s - start_s);
        part.amount *= amount;
        add_segment(r->speech, from_s, to_s, &part, i == 0 ? phone.symbol : "");
        from_s = to_s;
    }
    r->end_s = end_s;
    return RIS_OK;
}

static ris_result make_targets(const ris_json_at *at, const ris_model *model, ris_speech *speech,
                               ris_error *err)
{
    const ris_vocabulary *vocabulary = &model->vocabulary;
    speech->channel_count = model->channel_count;
    speech->articulator = calloc(model->channel_count + 1u, sizeof *speech->articulator);
    speech->target = calloc(speech->phonetics.viseme_count, sizeof *speech->target);
    if (!speech->articulator || !speech->target) {
        return no_memory(at, err);
    }
    for (uint32_t c = 0; c < model->channel_count; c++) {
        const char *name = model->channel[c].name;
        speech->articulator[c] = strncmp(name, "jaw.", 4) == 0      ? RIS_JAW
                                 : strncmp(name, "tongue.", 7) == 0 ? RIS_TONGUE
                                                                    : RIS_LIPS;
    }
    for (uint32_t i = 0; i < vocabulary->word_count; i++) {
        const ris_word *word = &vocabulary->word[i];
        uint32_t viseme = word->kind == RIS_WORD_VISEME
                              ? ris__phonetics_viseme(&speech->phonetics, word->name)
                              : UINT32_MAX;
        if (viseme == UINT32_MAX) {
            continue;
        }
        ris_mouth_target *target = &speech->target[viseme];
        target->value = calloc(word->value_count + 1u, sizeof *target->value);
        if (!target->value) {
            return no_memory(at, err);
        }
        memcpy(target->value, word->value, word->value_count * sizeof *target->value);
        target->count = word->value_count;
    }
    return RIS_OK;
}

static ris_result read_all(const ris_json_at *at, const ris_model *model, reader *r)
{
    ris_speech *speech = r->speech;
    size_t count = json_array_size(at->value);
    ris_result result;
    if ((result = ris__json_check_array(at, 1, MAX_PHONES, r->err)) ||
        (result =
             ris__phonetics_read(ris__phonetics_visemes(), ris__phonetics_ipa, &speech->phonetics, r->err)) ||
        (result = make_targets(at, model, speech, r->err))) {
        return result;
    }
    speech->segment = calloc((RIS_PHONE_PARTS + 1) * count + 1, sizeof *speech->segment);
    if (!speech->segment) {
        return no_memory(at, r->err);
    }
    for (size_t i = 0; i < count; i++) {
        ris_json_at item = ris__json_item(at, i);
        if ((result = read_segment(&item, r))) {
            return result;
        }
    }
    add_pause(speech, r->end_s, LONG_S);
    return RIS_OK;
}

ris_result ris__speech_read(const ris_json_at *at, const ris_model *model, double duration_s, double lead_s,
                            ris_speech **out, ris_error *err)
{
    reader r = {.speech = calloc(1, sizeof *r.speech), .duration_s = duration_s, .err = err};
    *out = NULL;
    if (!r.speech) {
        return no_memory(at, err);
    }
    r.speech->lead_s = lead_s;
    ris_result result = read_all(at, model, &r);
    if (result) {
        ris__speech_destroy(r.speech);
        return result;
    }
    *out = r.speech;
    return RIS_OK;
}

void ris__speech_destroy(ris_speech *speech)
{
    if (!speech) {
        return;
    }
    for (uint32_t i = 0; speech->target && i < speech->phonetics.viseme_count; i++) {
        free(speech->target[i].value);
    }
    free(speech->target);
    free(speech->articulator);
    free(speech->segment);
    ris__phonetics_finish(&speech->phonetics);
    free(speech);
}
