/* How far a node of one lip is from the other lip: the formula of the contact stage (docs/physics.md), which the bake
 * needs at rest. Every pair is judged along the mean of the two facing normals, so that both see the same distance and
 * round lips are not taken for flat ones. */
#include "model_impl.h"
#include "vec3.h"

float ris__lip_distance(const ris_model *model, const ris_vec4 *position, const ris_vec4 *normal,
                        const ris_contact_node *contact, ris_vec3 *out_away, float *out_weight)
{
    const ris_vec3 x = v4_xyz(position[contact->node]), n = v4_xyz(normal[contact->node]);
    const float radius = model->push.lip_radius_mm, radius2 = radius * radius;
    float weight = 0.0f, distance = 0.0f;
    ris_vec3 away = {0};
    for (uint32_t k = contact->lip_first; k < contact->lip_end; ++k) {
        const uint32_t j = model->contact_other[k];
        const ris_vec3 r = v3_sub(x, v4_xyz(position[j]));
        const float near = 1.0f - v3_dot(r, r) / radius2;
        const float along = v3_dot(n, v4_xyz(normal[j]));
        if (!(near > 0.0f) || !(along < 0.0f)) {
            continue;
        }
        /* w and m both point the other way, which saves two negations */
        const ris_vec3 m = v3_sub(n, v4_xyz(normal[j]));
        const float w = (near * near) * along, q = w / v3_length(m);
        weight = weight - w;
        distance = distance + q * v3_dot(m, r);
        away = v3_mad(away, q, m);
    }
    *out_weight = weight;
    *out_away = away;
    return weight > 0.0f ? distance / weight : 0.0f;
}
