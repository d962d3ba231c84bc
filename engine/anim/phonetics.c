/* KA-51, KA-54: the tables of speech that are built into the library: which visemes a phone is, how strongly each
 * holds lips, jaw and tongue. */
#include "anim/speech.h"
#include "asset/names.h"
#include "asset/vocabulary.h"
#include "vocabulary/ipa.h"

#include <stdlib.h>
#include <string.h>

#define MAX_VISEMES 64
#define MAX_PHONES 1024

const ris_phonetics_text ris__phonetics_ipa = {"vocabulary/ipa.json", (const char *)ris_text_ipa,
                                               sizeof ris_text_ipa - 1};

ris_phonetics_text ris__phonetics_visemes(void)
{
    const ris_vocabulary_text *file = &ris__vocabulary_file[RIS_WORD_VISEME];
    return (ris_phonetics_text){file->name, file->text, file->size};
}

static ris_result no_memory(const ris_json_at *at, ris_error *err)
{
    return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the tables of speech", at->json->name);
}

static ris_result read_dominance(const ris_json_at *at, ris_dominance *out, ris_error *err)
{
    float value[3] = {0, 0, 0};
    ris_result result = ris__json_floats(at, RIS_JSON_REQUIRED, 3, 0.001, 1000, value, err);
    *out = (ris_dominance){(double)value[0], (double)value[1], (double)value[2]};
    return result;
}

static ris_result read_viseme(const ris_json_at *at, ris_speech_viseme *out, ris_error *err)
{
    static const char *const keys[] = {"hold", "lips", "jaw", "tongue", NULL};
    ris_json_at speech = ris__json_key(at, "speech"), hold = ris__json_key(&speech, "hold");
    ris_result result;
    if (!speech.value) {
        return ris__json_fail(at, err, "expected the key \"speech\"");
    }
    if ((result = ris__json_check_object(&speech, keys, err)) ||
        (result = ris__json_double(&hold, RIS_JSON_REQUIRED, 0, 1, &out->hold, err))) {
        return result;
    }
    for (int k = 0; k < RIS_ARTICULATORS && !result; k++) {
        ris_json_at part = ris__json_key(&speech, keys[1 + k]);
        result = read_dominance(&part, &out->dominance[k], err);
    }
    return result;
}

static ris_result read_visemes(const ris_json *json, ris_phonetics *out, ris_error *err)
{
    const ris_json_at root = ris__json_root(json), list = ris__json_key(&root, "visemes");
    const char *key;
    json_t *value;
    size_t count = json_object_size(list.value);
    if (!json_is_object(list.value) || count == 0 || count > MAX_VISEMES) {
        return ris__json_expected(&list, err, "an object of 1 to 64 visemes");
    }
    out->viseme = calloc(count, sizeof *out->viseme);
    if (!out->viseme) {
        return no_memory(&list, err);
    }
    json_object_foreach(list.value, key, value)
    {
        const ris_json_at item = ris__json_key(&list, key);
        ris_speech_viseme *viseme = &out->viseme[out->viseme_count];
        if (strlen(key) >= sizeof viseme->name) {
            return ris__json_fail(&item, err, "expected a shorter name");
        }
        strcpy(viseme->name, key);
        ris_result result = read_viseme(&item, viseme, err);
        if (result) {
            return result;
        }
        out->viseme_count++;
    }
    return RIS_OK;
}

uint32_t ris__phonetics_viseme(const ris_phonetics *phonetics, const char *name)
{
    const char *prefix = strncmp(name, "viseme.", 7) == 0 ? "" : "viseme.";
    char whole[RIS_NAME_SIZE + 8];
    snprintf(whole, sizeof whole, "%s%.60s", prefix, name);
    for (uint32_t i = 0; i < phonetics->viseme_count; i++) {
        if (strcmp(phonetics->viseme[i].name, whole) == 0) {
            return i;
        }
    }
    return UINT32_MAX;
}

/* "aa", or {"viseme": "aa", "share": 0.6, "amount": 0.8} */
static ris_result read_part(const ris_json_at *at, const ris_phonetics *phonetics, ris_phone_part *out,
                            ris_error *err)
{
    static const char *const keys[] = {"viseme", "share", "amount", NULL};
    const bool whole = json_is_object(at->value);
    ris_json_at name_at = whole ? ris__json_key(at, "viseme") : *at;
    ris_json_at share = ris__json_key(at, "share"), amount = ris__json_key(at, "amount");
    char name[RIS_NAME_SIZE];
    ris_result result;
    *out = (ris_phone_part){.share = 1, .amount = 1};
    if ((whole && (result = ris__json_check_object(at, keys, err))) ||
        (result = ris__json_text(&name_at, RIS_JSON_REQUIRED, name, sizeof name, err)) ||
        (whole && (result = ris__json_double(&share, RIS_JSON_OPTIONAL, 0.01, 100, &out->share, err))) ||
        (whole && (result = ris__json_double(&amount, RIS_JSON_OPTIONAL, 0, 2, &out->amount, err)))) {
        return result;
    }
    out->viseme = ris__phonetics_viseme(phonetics, name);
    return out->viseme == UINT32_MAX ? ris__json_fail(&name_at, err, "unknown viseme \"%.40s\"", name)
                                     : RIS_OK;
}

static ris_result read_phone(const ris_json_at *at, const ris_phonetics *phonetics, ris_phone *out,
                             ris_error *err)
{
    double shares = 0;
    if (strlen(at->key) >= RIS_PHONE_SIZE || !*at->key) {
        return ris__json_fail(at, err, "expected a symbol of 1 to %d bytes", RIS_PHONE_SIZE - 1);
    }
    strcpy(out->symbol, at->key);
    ris_result result = ris__json_check_array(at, 1, RIS_PHONE_PARTS, err);
    for (; !result && out->part_count < json_array_size(at->value); out->part_count++) {
        ris_json_at item = ris__json_item(at, out->part_count);
        result = read_part(&item, phonetics, &out->part[out->part_count], err);
        shares += out->part[out->part_count].share;
    }
    for (uint32_t i = 0; !result && i < out->part_count; i++) {
        out->part[i].share /= shares;
    }
    return result;
}

static ris_result read_phones(const ris_json *json, ris_phonetics *out, ris_error *err)
{
    static const char *const keys[] = {"format", "version", "source", "phones", NULL};
    const ris_json_at root = ris__json_root(json), list = ris__json_key(&root, "phones");
    const char *key;
    json_t *value;
    size_t count = json_object_size(list.value);
    ris_result result;
    if ((result = ris__json_check_format(&root, "risorius-ipa", 1, err)) ||
        (result = ris__json_check_object(&root, keys, err))) {
        return result;
    }
    if (!json_is_object(list.value) || count == 0 || count > MAX_PHONES) {
        return ris__json_expected(&list, err, "an object of phones");
    }
    out->phone = calloc(count, sizeof *out->phone);
    if (!out->phone) {
        return no_memory(&list, err);
    }
    json_object_foreach(list.value, key, value)
    {
        const ris_json_at item = ris__json_key(&list, key);
        if ((result = read_phone(&item, out, &out->phone[out->phone_count++], err))) {
            return result;
        }
    }
    return RIS_OK;
}

ris_result ris__phonetics_read(ris_phonetics_text visemes, ris_phonetics_text ipa, ris_phonetics *out,
                               ris_error *err)
{
    ris_json json;
    *out = (ris_phonetics){0};
    ris_result result = ris__json_parse(visemes.name, visemes.text, visemes.size, &json, err);
    if (!result) {
        result = read_visemes(&json, out, err);
    }
    ris__json_finish(&json);
    if (result) {
        return result;
    }
    result = ris__json_parse(ipa.name, ipa.text, ipa.size, &json, err);
    if (!result) {
        result = read_phones(&json, out, err);
    }
    ris__json_finish(&json);
    return result;
}

void ris__phonetics_finish(ris_phonetics *phonetics)
{
    free(phonetics->viseme);
    free(phonetics->phone);
    *phonetics = (ris_phonetics){0};
}

static const ris_phone *find(const ris_phonetics *phonetics, const char *symbol)
{
    for (uint32_t i = 0; i < phonetics->phone_count; i++) {
        if (strcmp(phonetics->phone[i].symbol, symbol) == 0) {
            return &phonetics->phone[i];
        }
    }
    return NULL;
}

/* Stress, length, tones, ties, voicing, release, nasality: marks that leave the lips as they are. */
static bool is_mark(uint32_t c)
{
    return (c >= 0x0300 && c <= 0x036F && c != 0x0327) || /* combining, but for the cedilla of c */
           (c >= 0x02B0 && c <= 0x02FF) || (c >= 0x1D2C && c <= 0x1D6A) || (c >= 0x1DC0 && c <= 0x1DFF) ||
           c == 0x207F || c == '\'' || c == '.' || c == ':' || c == '`';
}

/* The symbol without marks; false if it is no UTF-8. */
static bool strip(const char *symbol, char out[RIS_PHONE_SIZE])
{
    size_t used = 0;
    for (const unsigned char *p = (const unsigned char *)symbol; *p;) {
        size_t length = *p < 0x80 ? 1 : *p < 0xC0 ? 0 : *p < 0xE0 ? 2 : *p < 0xF0 ? 3 : *p < 0xF8 ? 4 : 0;
        uint32_t c = length == 1 ? *p : *p & (0xFFu >> (length + 1));
        for (size_t i = 1; i < length; i++) {
            if ((p[i] & 0xC0) != 0x80) {
                return false;
            }
            c = c << 6 | (p[i] & 0x3Fu);
        }
        if (length == 0 || used + length >= RIS_PHONE_SIZE) {
            return false;
        }
        if (!is_mark(c)) {
            memcpy(out + used, p, length);
            used += length;
        }
        p += length;
    }
    out[used] = 0;
    return true;
}

const ris_phone *ris__phonetics_find(const ris_phonetics *phonetics, const char *symbol)
{
    char plain[RIS_PHONE_SIZE];
    const ris_phone *phone = find(phonetics, symbol);
    return phone || !strip(symbol, plain) ? phone : find(phonetics, plain);
}
