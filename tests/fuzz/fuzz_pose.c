/* "name=value,..." of the command line. */
#include "fuzz.h"

#include "risorius/timeline.h"
#include "unit/fake_model.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    float pose[FAKE_COUNT];
    ris_error err = {0};
    FUZZ_CHECK(text);
    memcpy(text, data, size);
    text[size] = 0;
    ris_result result = ris_pose_parse(&fake_model, text, pose, &err);
    fuzz_check_error(result, &err);
    for (int c = 0; result == RIS_OK && c < FAKE_COUNT; c++) {
        FUZZ_CHECK(pose[c] >= fake_channel[c].minimum && pose[c] <= fake_channel[c].maximum);
    }
    free(text);
    return 0;
}
