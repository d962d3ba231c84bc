/* Clip reader, sampling and labels. */
#include "fuzz.h"

#include "anim/clip.h"
#include "unit/fake_model.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ris_clip *clip;
    ris_error err = {0};
    ris_result result = ris__clip_parse(&fake_model, "input", (const char *)data, size, &clip, &err);
    fuzz_check_error(result, &err);
    FUZZ_CHECK((result == RIS_OK) == (clip != NULL));
    if (clip) {
        float pose[FAKE_COUNT];
        FUZZ_CHECK(clip->duration_s > 0 && clip->layer_count > 0);
        for (int i = -1; i <= 21; i++) {
            ris_clip_sample(clip, clip->duration_s * i / 20, pose);
            for (int c = 0; c < FAKE_COUNT; c++) { /* false for NaN too */
                FUZZ_CHECK(pose[c] >= fake_channel[c].minimum && pose[c] <= fake_channel[c].maximum);
            }
        }
        FUZZ_CHECK(ris_clip_label_count(clip) > 0);
    }
    ris_clip_destroy(clip);
    return 0;
}
