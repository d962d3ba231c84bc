/* Readers of recorded performances. The bytes are read as both formats, with every adjustment and without. */
#include "fuzz.h"

#include "asset/take.h"

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
        }
        ris__take_finish(&table);
    }
    return 0;
}
