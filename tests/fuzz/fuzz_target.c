/* What `solve` and `score` aim at: landmarks as JSON or CSV, and sculpted displacements. */
#include "fuzz.h"

#include "asset/target.h"
#include "solve/target.h"

#include <math.h>

#define VERTICES 40

static void check_landmarks(const char *text, size_t size)
{
    static ris_landmark landmark[] = {{.name = "ch.L", .mesh = RIS_LANDMARK_SKIN},
                                      {.name = "g", .mesh = RIS_LANDMARK_SKULL},
                                      {.name = "gn", .mesh = RIS_LANDMARK_MANDIBLE},
                                      {.name = "sto", .mesh = RIS_LANDMARK_SKIN}};
    static ris_head head = {.landmark_count = 4, .landmark = landmark};
    static const ris_model model = {.head = &head};
    ris_target target;
    ris_error err = {0};
    const ris_result result = ris__target_parse(&model, "input", text, size, &target, &err);
    fuzz_check_error(result, &err);
    FUZZ_CHECK((result == RIS_OK) == (target.count > 0 && target.index && target.at && target.landmarks));
    for (uint32_t i = 0; i < target.count; i++) {
        const ris_vec3 at = target.at[i];
        FUZZ_CHECK(target.index[i] < 4 && target.index[i] != 1);
        FUZZ_CHECK(i == 0 || target.index[i] > target.index[i - 1]);
        FUZZ_CHECK(fabsf(at.x) <= 1e4f && fabsf(at.y) <= 1e4f && fabsf(at.z) <= 1e4f); /* false for NaN too */
    }
    ris_target_finish(&target);
}

static void check_sculpt(const char *text, size_t size)
{
    double sum[3 * VERTICES] = {0};
    ris_error err = {0};
    const ris_result result = ris__target_add("input", text, size, VERTICES, sum, &err);
    fuzz_check_error(result, &err);
    for (int i = 0; i < 3 * VERTICES; i++) { /* a thousand decimetres a line at most */
        FUZZ_CHECK(fabs(sum[i]) <= 1e3 * (double)(size + 1));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    check_landmarks((const char *)data, size);
    check_sculpt((const char *)data, size);
    return 0;
}
