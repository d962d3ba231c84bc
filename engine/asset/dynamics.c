/* Dynamics of head.json: how fast muscles follow what the pose asks for. Sources: docs/physics.md, activation. */
#include "asset/head_parts.h"

ris_dynamics_def ris_default_dynamics(void)
{
    return (ris_dynamics_def){
        .onset_ms = 60,
        .release_ms = 120,
        .lid_onset_ms = 40,
        .lid_release_ms = 80,
        .jaw_onset_ms = 70,
        .jaw_release_ms = 100,
        .follow_through = 0.2f,
        .gravity = 0.1f,
    };
}

ris_result ris__dynamics_read(const ris_json_at *at, ris_head *head, ris_error *err)
{
    static const char *const keys[] = {"onset_ms",       "release_ms",   "lid_onset_ms",
                                       "lid_release_ms", "jaw_onset_ms", "jaw_release_ms",
                                       "follow_through", "gravity",      NULL};
    ris_dynamics_def *dynamics = &head->dynamics;
    *dynamics = ris_default_dynamics();
    if (!at->value) {
        return RIS_OK;
    }
    const struct {
        const char *key;
        double minimum, maximum;
        float *out;
    } number[] = {
        {"onset_ms", 0, RIS_MAX_PACE_MS, &dynamics->onset_ms},
        {"release_ms", 0, RIS_MAX_PACE_MS, &dynamics->release_ms},
        {"lid_onset_ms", 0, RIS_MAX_PACE_MS, &dynamics->lid_onset_ms},
        {"lid_release_ms", 0, RIS_MAX_PACE_MS, &dynamics->lid_release_ms},
        {"jaw_onset_ms", 0, RIS_MAX_PACE_MS, &dynamics->jaw_onset_ms},
        {"jaw_release_ms", 0, RIS_MAX_PACE_MS, &dynamics->jaw_release_ms},
        {"follow_through", 0, 2, &dynamics->follow_through},
        {"gravity", 0, 2, &dynamics->gravity},
    };
    ris_result result = ris__json_check_object(at, keys, err);
    for (size_t i = 0; result == RIS_OK && i < sizeof number / sizeof number[0]; i++) {
        ris_json_at value = ris__json_key(at, number[i].key);
        result = ris__json_float(&value, RIS_JSON_OPTIONAL, number[i].minimum, number[i].maximum,
                                 number[i].out, err);
    }
    return result;
}
