/* KA-45: other names of the muscles, of table 7.1 and of anatomy books. The one table of them; the channel's
 * own name goes first everywhere (docs/file-formats.md, Names). */
#include "asset/names.h"

#include <stdio.h>
#include <string.h>

static const char *const synonym[][2] = {
    {"triangularis", "depressor_anguli_oris"},
    {"quadratus_labii", "depressor_labii_inferioris"},
    {"quadratus_labii_inferioris", "depressor_labii_inferioris"},
    {"levator_labii", "levator_labii_superioris"},
    {"caninus", "levator_anguli_oris"},
    {"compressor_naris", "nasalis"},
    {"dilatator_naris", "nasalis_alaris"},
    {"depressor_septi_nasi", "depressor_septi"},
    {"occipitofrontalis_inner", "frontalis_inner"},
    {"occipitofrontalis_outer", "frontalis_outer"},
    {"levator_palpebrae", "levator_palpebrae_superioris"},
    {"medial_pterygoid", "pterygoideus_medialis"},
    {"lateral_pterygoid", "pterygoideus_lateralis"},
    {"internal_pterygoid", "pterygoideus_medialis"},
    {"external_pterygoid", "pterygoideus_lateralis"},
    {"mylohyoid", "mylohyoideus"},
};

const char *ris__name_of_synonym(const char *name, char out[RIS_NAME_SIZE])
{
    const size_t side = ris__name_is_sided(name) ? 2 : 0, length = strlen(name) - side;
    for (size_t k = 0; k < sizeof synonym / sizeof *synonym; k++) {
        if (strlen(synonym[k][0]) == length && memcmp(synonym[k][0], name, length) == 0) {
            snprintf(out, RIS_NAME_SIZE, "%s%s", synonym[k][1], name + length);
            return out;
        }
    }
    return NULL;
}
