/* Readers of recorded performances. The bytes are read as both formats, with every adjustment and without. */
#include "fuzz.h"

#include "anim/take_clip.h"
#include "asset/take.h"
#include "unit/fake_model.h"

static void check_table(const ris_take_table *table, const ris_take_info *info)
{
    FUZZ_CHECK(table->sample_count > 0 && table->sample_count == info->samples);
    FUZZ_CHECK(info->rows == info->samples + info->lost + info->repeated + info->other_faces);
    FUZZ_CHECK(table->duration_s >= table->time_s[table->sample_count - 1] - 1e-9);
    for (uint32_t i = 0; i < table->sample_count; i++) {
        FUZZ_CHECK(i == 0 ? table->time_s[0] >= 0 : table->time_s[i] > table->time_s[i - 1]);
        for (uint32_t c = 0; c < table->column_count; c++) { /* false for NaN too */
            const float value = table->value[(size_t)i * table->column_count + c];
            FUZZ_CHECK(value >= table->column[c].minimum && value <= table->column[c].maximum);
        }
    }
}

static void check_clip(const char *text, size_t size, const ris_take_def *def)
{
    ris_clip *clip;
    ris_take_info info;
    ris_error err = {0};
    const ris_result result = ris__take_clip(&fake_model, "input", text, size, def, &clip, &info, &err);
    fuzz_check_error(result, &err);
    FUZZ_CHECK((result == RIS_OK) == (clip != NULL));
    for (int i = -1; clip && i <= 11; i++) {
        float pose[FAKE_COUNT];
        ris_clip_sample(clip, ris_clip_duration_s(clip) * i / 10, pose);
        for (int c = 0; c < FAKE_COUNT; c++) { /* false for NaN too */
            FUZZ_CHECK(pose[c] >= fake_channel[c].minimum && pose[c] <= fake_channel[c].maximum);
        }
    }
    FUZZ_CHECK(!clip || ris_clip_label_count(clip) > 0);
    ris_clip_destroy(clip);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    for (int k = 0; k < 4; k++) {
        ris_take_def def = ris_default_take_def(k & 1 ? RIS_TAKE_OPENFACE : RIS_TAKE_LIVE_LINK);
        ris_take_table table;
        ris_take_info info;
        ris_error err = {0};
        if (k & 2) {
            FUZZ_CHECK(ris_take_adjust(&def, "mirror,landscape,flip-roll,center,rate=59", &err) == RIS_OK);
        }
        ris_result result = ris__take_parse("input", (const char *)data, size, &def, &table, &info, &err);
        fuzz_check_error(result, &err);
        FUZZ_CHECK((result == RIS_OK) == (table.sample_count > 0));
        if (result == RIS_OK) {
            check_table(&table, &info);
            check_clip((const char *)data, size, &def);
        }
        ris__take_finish(&table);
    }
    return 0;
}
