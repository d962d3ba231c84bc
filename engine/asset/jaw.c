/* The jaw of head.json: KA-05 and the path of its joint. */
#include "asset/head_parts.h"

#include <math.h>

ris_jaw_def ris_default_jaw(void)
{
    return (ris_jaw_def){
        .axis = {1, 0, 0},
        .open_deg = 20,
        .forward_mm = 8,
        .back_mm = 1,
        .side_mm = 6,
        .condyle_mm = 49,
        .incisor = {0, -43, 76},
        .eminence_deg = 55,
        .eminence_mm = 10,
        .slide_mm = 8,
        .slide_start = 0.4f,
        .bennett_mm = 0.8f,
    };
}

static ris_result read_hinge(const ris_json_at *at, ris_jaw_def *jaw, ris_error *err)
{
    float point[3] = {0}, axis[3] = {0}, incisor[3];
    ris_json_at incisor_at = ris__json_key(at, "incisor");
    ris_json_at point_at = ris__json_key(at, "point"), axis_at = ris__json_key(at, "axis");
    ris_result result;
    if ((result = ris__json_floats(&point_at, RIS_JSON_REQUIRED, 3, -1000, 1000, point, err)) ||
        (result = ris__json_floats(&axis_at, RIS_JSON_REQUIRED, 3, -1000, 1000, axis, err))) {
        return result;
    }
    incisor[0] = point[0] + jaw->incisor.x;
    incisor[1] = point[1] + jaw->incisor.y;
    incisor[2] = point[2] + jaw->incisor.z;
    if ((result = ris__json_floats(&incisor_at, RIS_JSON_OPTIONAL, 3, -1000, 1000, incisor, err))) {
        return result;
    }
    jaw->incisor = (ris_vec3){incisor[0], incisor[1], incisor[2]};
    double length = sqrt((double)axis[0] * axis[0] + (double)axis[1] * axis[1] + (double)axis[2] * axis[2]);
    if (length < 1e-3) {
        return ris__json_expected(&axis_at, err, "a direction");
    }
    jaw->point = (ris_vec3){point[0], point[1], point[2]};
    jaw->axis = (ris_vec3){(float)(axis[0] / length), (float)(axis[1] / length), (float)(axis[2] / length)};
    return RIS_OK;
}

ris_result ris__jaw_read(const ris_json_at *at, ris_head *head, ris_error *err)
{
    static const char *const keys[] = {
        "point",   "axis",         "open_deg",    "forward_mm", "back_mm",     "side_mm",    "condyle_mm",
        "incisor", "eminence_deg", "eminence_mm", "slide_mm",   "slide_start", "bennett_mm", NULL};
    ris_jaw_def *jaw = &head->jaw;
    *jaw = ris_default_jaw();
    ris_result result = ris__json_check_object(at, keys, err);
    if (result == RIS_OK) {
        result = read_hinge(at, jaw, err);
    }
    const struct {
        const char *key;
        double minimum, maximum;
        float *value;
    } numbers[] = {
        {"open_deg", 0, 60, &jaw->open_deg},         {"back_mm", 0, 50, &jaw->back_mm},
        {"side_mm", 0, 50, &jaw->side_mm},           {"condyle_mm", 1, 500, &jaw->condyle_mm},
        {"eminence_deg", 0, 75, &jaw->eminence_deg}, {"eminence_mm", 0.1, 50, &jaw->eminence_mm},
        {"slide_start", 0, 0.95, &jaw->slide_start}, {"bennett_mm", 0, 5, &jaw->bennett_mm},
    };
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0] && result == RIS_OK; k++) {
        ris_json_at number = ris__json_key(at, numbers[k].key);
        result = ris__json_float(&number, RIS_JSON_OPTIONAL, numbers[k].minimum, numbers[k].maximum,
                                 numbers[k].value, err);
    }
    /* the condyles cannot go past the crest */
    ris_json_at forward = ris__json_key(at, "forward_mm"), slide = ris__json_key(at, "slide_mm");
    const double crest = (double)jaw->eminence_mm;
    jaw->forward_mm = fminf(jaw->forward_mm, jaw->eminence_mm);
    jaw->slide_mm = fminf(jaw->slide_mm, jaw->eminence_mm);
    if (result != RIS_OK ||
        (result = ris__json_float(&forward, RIS_JSON_OPTIONAL, 0, crest, &jaw->forward_mm, err))) {
        return result;
    }
    return ris__json_float(&slide, RIS_JSON_OPTIONAL, 0, crest, &jaw->slide_mm, err);
}
