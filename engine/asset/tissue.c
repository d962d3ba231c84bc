/* Tissue of head.json: KA-10..18, KA-33 and the default tissue of docs/physics.md. */
#include "asset/head_parts.h"
#include "asset/names.h"
#include "base/text.h"

#include <math.h>
#include <string.h>

#define MAX_STIFFNESS 1e7 /* g/s^2 */
#define MAX_ANCHORS ((uint32_t)(sizeof((ris_tissue_def *)0)->anchor_region / sizeof(ris_anchor_region)))

ris_tissue_def ris_default_tissue(void)
{
    /* normal: the thesis's pair 2 x 30, less on the cheek; tangential: a decay length of 5..8 mm. The
     * forehead glides on its bone. Lips are full of muscle to the rim, and their small triangles would rather stay as they are. */
    static const ris_anchor_region anchors[] = {
        {"bone", 60, 45},
        {"cheek", 24, 20},
        {"lips", 30, 10},
        {"lids", 60, 20},
        {"nose", 60, 45},
        {"mouth_cavity", 30, 30},
        {"inner_lip_rim", 30, 10},
        {"forehead", 90, 25},
        {"muscle", 60, 90},
        {"lips", 300, 300},
        {"inner_lip_rim", 150, 150},
    };
    ris_tissue_def tissue = {
        .model = RIS_TISSUE_RISORIUS,
        .density_kg_m3 = 1100,
        .skin_mm = 2,
        .modulus = {100, 1000},
        .switch_stretch = 1.5f,
        .continuous = true,
        .compression = 0.2f,
        .bending = 100,
        .stiffness_scale = 2,
        .damping_per_s = 70,
        .damping_g_s = 30,
        .mass_g = 0.084f,
        .bone_anchor = 30,
        .muscle_anchor = 10,
        .muscle_radius_mm = 10,
        .constraint_lambda = 30,
        .bulge = 1,
        .bulge_kaehler = 5,
        .substeps = 8,
        .anchor_region_count = sizeof anchors / sizeof anchors[0],
    };
    memcpy(tissue.anchor_region, anchors, sizeof anchors);
    return tissue;
}

/* "bone" and "muscle" mean node sets of the model; any other name must be a region of the head. */
static bool anchor_known(const ris_head *head, const char *region)
{
    return strcmp(region, "bone") == 0 || strcmp(region, "muscle") == 0 || ris_head_region(head, region);
}

static void drop_absent_anchors(ris_head *head)
{
    ris_tissue_def *tissue = &head->tissue;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < tissue->anchor_region_count; i++) {
        if (anchor_known(head, tissue->anchor_region[i].region)) {
            tissue->anchor_region[kept++] = tissue->anchor_region[i];
        }
    }
    tissue->anchor_region_count = kept;
}

static ris_result read_anchor(const ris_json_at *at, const ris_head *head, ris_anchor_region *out,
                              ris_error *err)
{
    static const char *const keys[] = {"region", "normal", "tangential", NULL};
    ris_result result;
    if ((result = ris__json_check_object(at, keys, err))) {
        return result;
    }
    ris_json_at region = ris__json_key(at, "region"), normal = ris__json_key(at, "normal");
    ris_json_at tangential = ris__json_key(at, "tangential");
    if ((result = ris__read_name(&region, "a region name", out->region, err)) ||
        (result = ris__json_float(&normal, RIS_JSON_REQUIRED, 0, MAX_STIFFNESS, &out->normal, err)) ||
        (result = ris__json_float(&tangential, RIS_JSON_REQUIRED, 0, MAX_STIFFNESS, &out->tangential, err))) {
        return result;
    }
    if (!anchor_known(head, out->region)) {
        ris_nearest nearest;
        char names[256];
        ris__nearest_init(&nearest, out->region);
        ris__nearest_add(&nearest, "bone");
        ris__nearest_add(&nearest, "muscle");
        for (uint32_t i = 0; i < head->region_count; i++) {
            ris__nearest_add(&nearest, head->region[i].name);
        }
        return ris__json_fail(&region, err, "unknown region; nearest: %s",
                              ris__nearest_text(&nearest, names, sizeof names));
    }
    return RIS_OK;
}

static ris_result read_anchors(const ris_json_at *at, ris_head *head, ris_error *err)
{
    ris_tissue_def *tissue = &head->tissue;
    size_t count = json_array_size(at->value);
    if (!at->value) {
        drop_absent_anchors(head);
        return RIS_OK;
    }
    ris_result result = ris__json_check_array(at, 1, MAX_ANCHORS, err);
    tissue->anchor_region_count = 0;
    for (size_t i = 0; i < count && result == RIS_OK; i++) {
        ris_json_at item = ris__json_item(at, i);
        result = read_anchor(&item, head, &tissue->anchor_region[tissue->anchor_region_count++], err);
    }
    return result;
}

/* The plain numbers of the tissue: key, range, place. */
static ris_result read_numbers(const ris_json_at *at, ris_tissue_def *t, ris_error *err)
{
    const struct {
        const char *key;
        double minimum, maximum;
        float *out;
    } number[] = {
        {"density_kg_m3", 1, 1e5, &t->density_kg_m3},
        {"skin_mm", 0.01, 50, &t->skin_mm},
        {"switch", 1, 10, &t->switch_stretch},
        {"compression", 0, 10, &t->compression},
        {"bending", 0, MAX_STIFFNESS, &t->bending},
        {"stiffness_scale", 1e-3, 1e3, &t->stiffness_scale},
        {"damping_per_s", 0, 1e5, &t->damping_per_s},
        {"damping_g_s", 0, 1e5, &t->damping_g_s},
        {"mass_g", 1e-6, 1e3, &t->mass_g},
        {"bone_anchor", 0, MAX_STIFFNESS, &t->bone_anchor},
        {"muscle_anchor", 0, MAX_STIFFNESS, &t->muscle_anchor},
        {"muscle_radius_mm", 0, 100, &t->muscle_radius_mm},
        {"constraint_lambda", 0, 1e4, &t->constraint_lambda},
        {"bulge", 0, 10, &t->bulge},
        {"bulge_kaehler", 0, 10, &t->bulge_kaehler},
    };
    for (size_t i = 0; i < sizeof number / sizeof number[0]; i++) {
        ris_json_at value = ris__json_key(at, number[i].key);
        ris_result result = ris__json_float(&value, RIS_JSON_OPTIONAL, number[i].minimum, number[i].maximum,
                                            number[i].out, err);
        if (result != RIS_OK) {
            return result;
        }
    }
    return RIS_OK;
}

ris_result ris__tissue_read(const ris_json_at *at, ris_head *head, ris_error *err)
{
    static const char *const keys[] = {"model",
                                       "density_kg_m3",
                                       "skin_mm",
                                       "modulus",
                                       "switch",
                                       "law",
                                       "compression",
                                       "bending",
                                       "stiffness_scale",
                                       "damping_per_s",
                                       "damping_g_s",
                                       "mass_g",
                                       "bone_anchor",
                                       "muscle_anchor",
                                       "muscle_radius_mm",
                                       "constraint_lambda",
                                       "substeps",
                                       "anchors",
                                       "bulge",
                                       "bulge_kaehler",
                                       NULL};
    static const char *const models[] = {"risorius", "kaehler", NULL}, *const laws[] = {"continuous", "jump",
                                                                                        NULL};
    ris_tissue_def *t = &head->tissue;
    uint32_t model = RIS_TISSUE_RISORIUS, law = 0;
    ris_result result;
    *t = ris_default_tissue();
    if (!at->value) {
        drop_absent_anchors(head);
        return RIS_OK;
    }
    if ((result = ris__json_check_object(at, keys, err))) {
        return result;
    }
    ris_json_at model_at = ris__json_key(at, "model"), law_at = ris__json_key(at, "law");
    ris_json_at modulus = ris__json_key(at, "modulus"), substeps = ris__json_key(at, "substeps");
    ris_json_at anchors = ris__json_key(at, "anchors");
    if ((result = ris__json_choice(&model_at, RIS_JSON_OPTIONAL, models, &model, err)) ||
        (result = ris__json_choice(&law_at, RIS_JSON_OPTIONAL, laws, &law, err)) ||
        (result = ris__json_floats(&modulus, RIS_JSON_OPTIONAL, 2, 0, MAX_STIFFNESS, t->modulus, err)) ||
        (result = ris__json_uint(&substeps, RIS_JSON_OPTIONAL, 1, 1024, &t->substeps, err)) ||
        (result = read_numbers(at, t, err)) || (result = read_anchors(&anchors, head, err))) {
        return result;
    }
    if (t->modulus[1] < t->modulus[0]) {
        return ris__json_expected(&modulus, err, "the low modulus first, then the high one");
    }
    t->model = (ris_tissue_model)model;
    t->continuous = law == 0;
    return RIS_OK;
}
