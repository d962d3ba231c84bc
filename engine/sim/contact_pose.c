/* contact_pose, last host stage: where the bodies of the contact stage are this tick. Their grids stay in the rest
 * frame; a node is carried there by the inverse of the bone's movement. */
#include "sim/rig.h"

#include "model/vec3.h"

static const ris_rigid *rigid_of(const ris_rig *rig, ris_bone bone)
{
    switch (bone) {
    case RIS_BONE_JAW: return &rig->jaw;
    case RIS_BONE_EYE_L: return &rig->eye[0];
    case RIS_BONE_EYE_R: return &rig->eye[1];
    case RIS_BONE_AUTO:
    case RIS_BONE_SKULL:
    case RIS_BONE_SKIN: break;
    }
    return NULL;
}

void ris__contact_pose(ris_rig *rig)
{
    static const float still[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const ris_model *model = rig->model;
    for (uint32_t k = 0; k < model->contact_solid_count; ++k) {
        const ris_contact_solid *solid = &model->contact_solid[k];
        const ris_rigid *rigid = rigid_of(rig, solid->bone);
        const bool moves = rigid && !rigid->identity;
        const float *r = moves ? rigid->rotation : still;
        ris_contact_body *body = &rig->body[k];
        /* x = R(y - o) + o + s, so y = R^T x + (o - R^T(o + s)) */
        ris_vec3 t = {0};
        if (moves) {
            const ris_vec3 c = v3_add(rigid->point, rigid->shift);
            t = v3_sub(rigid->point,
                       v3((r[0] * c.x + r[3] * c.y) + r[6] * c.z, (r[1] * c.x + r[4] * c.y) + r[7] * c.z,
                          (r[2] * c.x + r[5] * c.y) + r[8] * c.z));
        }
        *body = (ris_contact_body){.row_x = {r[0], r[3], r[6], t.x},
                                   .row_y = {r[1], r[4], r[7], t.y},
                                   .row_z = {r[2], r[5], r[8], t.z},
                                   .low = v4_from(solid->low, 1.0f / solid->cell_mm),
                                   .count_x = solid->count[0],
                                   .count_y = solid->count[1],
                                   .count_z = solid->count[2],
                                   .first = solid->first};
    }
}
