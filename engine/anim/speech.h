/* KA-51, KA-52: visemes in sequence, blended by dominance (docs/speech.md). */
#pragma once

#include "asset/json.h"
#include "risorius/model.h"

#define RIS_PHONE_SIZE 24 /* bytes of a phone's symbol with its terminator */
#define RIS_PHONE_PARTS 3
#define RIS_SPEECH_LEAD_S 0.04 /* the flesh reaches a pose about so much later (test_visemes) */

/* Parts of the face that are shaped apart from each other. */
typedef enum ris_articulator { RIS_LIPS, RIS_JAW, RIS_TONGUE, RIS_ARTICULATORS } ris_articulator;

/* How strongly a viseme holds a part, how fast that rises before it and falls behind it. */
typedef struct ris_dominance {
    double strength;
    double before_per_s, after_per_s;
} ris_dominance;

typedef struct ris_speech_viseme {
    char name[RIS_NAME_SIZE]; /* "viseme.PP" */
    double hold;              /* share of a segment, about its middle, over which dominance does not fall */
    ris_dominance dominance[RIS_ARTICULATORS];
} ris_speech_viseme;

/* One viseme of a phone. */
typedef struct ris_phone_part {
    uint32_t viseme;
    double share;  /* of the phone's time, 1 in all */
    double amount; /* of the viseme */
} ris_phone_part;

typedef struct ris_phone {
    char symbol[RIS_PHONE_SIZE];
    uint32_t part_count;
    ris_phone_part part[RIS_PHONE_PARTS];
} ris_phone;

/* Visemes with their dominance, and phones. */
typedef struct ris_phonetics {
    uint32_t viseme_count, phone_count;
    ris_speech_viseme *viseme;
    ris_phone *phone;
} ris_phonetics;

typedef struct ris_phonetics_text {
    const char *name, *text; /* name: for messages */
    size_t size;
} ris_phonetics_text;

/* The tables built into the library. */
extern const ris_phonetics_text ris__phonetics_ipa;
ris_phonetics_text ris__phonetics_visemes(void);

/* *out is to be finished also after a failure: RIS_ERROR_DATA with the place, RIS_ERROR_MEMORY. */
ris_result ris__phonetics_read(ris_phonetics_text visemes, ris_phonetics_text ipa, ris_phonetics *out,
                               ris_error *err);
void ris__phonetics_finish(ris_phonetics *phonetics);
/* The phone of that symbol, or of it less stress, length and other marks that leave the lips alone; NULL: none. */
const ris_phone *ris__phonetics_find(const ris_phonetics *phonetics, const char *symbol);
/* Index, or UINT32_MAX; "PP" or "viseme.PP". */
uint32_t ris__phonetics_viseme(const ris_phonetics *phonetics, const char *name);

typedef struct ris_utterance {
    double from_s, to_s; /* where dominance is greatest */
    double middle_s;
    double amount; /* of the viseme */
    uint32_t viseme;
    char phone[RIS_PHONE_SIZE]; /* for labels; "" = not the first viseme of a phone, or a pause */
} ris_utterance;

/* What a viseme does on a model. */
typedef struct ris_mouth_target {
    uint32_t count;
    ris_channel_value *value;
} ris_mouth_target;

typedef struct ris_speech {
    ris_phonetics phonetics;
    uint32_t segment_count, channel_count;
    double lead_s;            /* ris__speech_add shows what sounds so much later */
    ris_utterance *segment;   /* ascending in time */
    ris_mouth_target *target; /* (phonetics.viseme_count) */
    uint8_t *articulator;     /* (channel_count) ris_articulator */
} ris_speech;

/* Reads the phones of a layer of duration_s, shaped lead_s before they sound. RIS_ERROR_DATA with the place; *out is NULL after a failure. */
ris_result ris__speech_read(const ris_json_at *at, const ris_model *model, double duration_s, double lead_s,
                            ris_speech **out, ris_error *err);
void ris__speech_destroy(ris_speech *speech);
/* Dominance of a segment over a part at time_s. */
double ris__speech_dominance(const ris_speech *speech, uint32_t segment, ris_articulator part, double time_s);
/* Adds the mouth at time_s to pose, channels first .. first + count - 1. */
void ris__speech_add(const ris_speech *speech, double time_s, uint32_t first, uint32_t count, float *pose);
/* Sets touches (channel_count) of the channels it moves. */
void ris__speech_touch(const ris_speech *speech, bool *touches);
