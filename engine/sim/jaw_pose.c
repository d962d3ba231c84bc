/* jaw_pose, first stage of a tick: KA-05 jaw rotation, in the default tissue along the path of the joint
 * (jaw_path.c), and the rigid poses of eyes and head (KA-06, KA-48). Cosine and sine come from fixed series in double:
 * the same bits on every machine. */
#include "sim/rig.h"

#include "model/vec3.h"

#include <string.h>

#define PI 3.14159265358979323846

/* Taylor series after halving the angle until it is small; only + and x, so no libm in what feeds a hash. */
void ris__cos_sin(double angle, double *out_cos, double *out_sin)
{
    const double x = angle / 16.0, s = x * x;
    double sine =
        x * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0)))));
    double versine = s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0))));
    for (int k = 0; k < 4; ++k) { /* 1 - cos 2a = 2 sin^2 a, sin 2a = 2 sin a cos a */
        double cosine = 1.0 - versine;
        versine = 2.0 * sine * sine;
        sine = 2.0 * sine * cosine;
    }
    *out_cos = 1.0 - versine;
    *out_sin = sine;
}

ris_rigid ris__rigid_turn(ris_vec3 point, ris_vec3 axis, double angle_rad)
{
    double c, s;
    ris__cos_sin(angle_rad, &c, &s);
    const double x = (double)axis.x, y = (double)axis.y, z = (double)axis.z, v = 1.0 - c;
    const double r[9] = {
        c + x * x * v,     x * y * v - z * s, x * z * v + y * s, y * x * v + z * s, c + y * y * v,
        y * z * v - x * s, z * x * v - y * s, z * y * v + x * s, c + z * z * v,
    };
    ris_rigid rigid = {.point = point, .identity = angle_rad == 0.0};
    for (int k = 0; k < 9; ++k) {
        rigid.rotation[k] = (float)r[k];
    }
    return rigid;
}

ris_vec3 ris__rigid_rotate(const ris_rigid *rigid, ris_vec3 v)
{
    const float *r = rigid->rotation;
    return v3((r[0] * v.x + r[1] * v.y) + r[2] * v.z, (r[3] * v.x + r[4] * v.y) + r[5] * v.z,
              (r[6] * v.x + r[7] * v.y) + r[8] * v.z);
}

ris_vec3 ris__rigid_apply(const ris_rigid *rigid, ris_vec3 x)
{
    if (rigid->identity) {
        return x;
    }
    return v3_add(v3_add(ris__rigid_rotate(rigid, v3_sub(x, rigid->point)), rigid->point), rigid->shift);
}

void ris__rigid_matrix(const ris_rigid *rigid, float out[12])
{
    const ris_vec3 turned = ris__rigid_rotate(rigid, rigid->point);
    const ris_vec3 t = v3_add(v3_sub(rigid->point, turned), rigid->shift);
    const float translation[3] = {t.x, t.y, t.z};
    for (int r = 0; r < 3; ++r) {
        memcpy(out + 4 * r, rigid->rotation + 3 * r, 3 * sizeof *out);
        out[4 * r + 3] = translation[r];
    }
}

static ris_vec3 part_pivot(const ris_head *head, ris_bone bone)
{
    for (uint32_t k = 0; k < head->part_count; ++k) {
        if (head->part[k].bone == bone) {
            return head->part[k].pivot;
        }
    }
    return v3(0.0f, 0.0f, 0.0f);
}

/* rotation of a, then of b on its left */
static ris_rigid turn_after(ris_rigid b, ris_rigid a)
{
    ris_rigid result = a;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            result.rotation[3 * r + c] =
                (b.rotation[3 * r] * a.rotation[c] + b.rotation[3 * r + 1] * a.rotation[3 + c]) +
                b.rotation[3 * r + 2] * a.rotation[6 + c];
        }
    }
    result.identity = a.identity && b.identity;
    return result;
}

/* yaw to the subject's left, pitch up, roll to the left shoulder; degrees */
static ris_rigid yaw_pitch_roll(ris_vec3 point, float yaw, float pitch, float roll)
{
    const double rad = PI / 180.0;
    ris_rigid r = ris__rigid_turn(point, v3(0, 0, 1), -(double)roll * rad);
    r = turn_after(ris__rigid_turn(point, v3(1, 0, 0), -(double)pitch * rad), r);
    return turn_after(ris__rigid_turn(point, v3(0, 1, 0), (double)yaw * rad), r);
}

/* The thesis turns the jaw about a fixed axis (KA-05); its shifts are ours. */
static ris_rigid turn_and_shift(const ris_jaw_def *def, float open, float forward, float side)
{
    ris_rigid jaw = ris__rigid_turn(def->point, def->axis, (double)open * (double)def->open_deg * PI / 180.0);
    jaw.shift = v3(def->side_mm * side, 0.0f, forward * (forward < 0.0f ? def->back_mm : def->forward_mm));
    jaw.identity = open == 0.0f && side == 0.0f && forward == 0.0f;
    return jaw;
}

/* Channel of the jaw with what the muscles that move it add, clamped. */
static float driven(const ris_rig *rig, const float *pose, uint32_t channel, float least)
{
    const ris_model *model = rig->model;
    double sum = (double)pose[rig->first_beside + channel];
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const float *drives = model->muscle[m].def->drives;
        sum += (double)f_clamp(pose[m], 0.0f, 1.0f) * (double)drives[channel - RIS__JAW_OPEN];
    }
    return f_clamp((float)sum, least, 1.0f);
}

static void pose_jaw(ris_rig *rig, const float *pose)
{
    const ris_head *head = rig->model->head;
    const float open = driven(rig, pose, RIS__JAW_OPEN, 0.0f),
                forward = driven(rig, pose, RIS__JAW_FORWARD, -1.0f),
                side = driven(rig, pose, RIS__JAW_SIDE, -1.0f);
    rig->jaw = rig->model->push.flags & RIS_TISSUE_FLAG_KAEHLER
                   ? turn_and_shift(&head->jaw, open, forward, side)
                   : ris__jaw_path(&head->jaw, &head->guidance, open, forward, side);
    rig->slides = forward != 0.0f || side != 0.0f;
    rig->meets =
        (1.0f - f_clamp(forward, 0.0f, 1.0f)) * (1.0f - f_clamp(side < 0.0f ? -side : side, 0.0f, 1.0f));
    rig->jaw_open = rig->slides ? ris__jaw_path(&head->jaw, &head->guidance, open, 0.0f, 0.0f) : rig->jaw;
}

void ris__jaw_pose(ris_rig *rig, const float *pose)
{
    const ris_model *model = rig->model;
    const float *beside = pose + rig->first_beside;
    pose_jaw(rig, pose);
    rig->eye[0] = yaw_pitch_roll(part_pivot(model->head, RIS_BONE_EYE_L), beside[RIS__EYE_YAW_L],
                                 beside[RIS__EYE_PITCH_L], 0.0f);
    rig->eye[1] = yaw_pitch_roll(part_pivot(model->head, RIS_BONE_EYE_R), beside[RIS__EYE_YAW_R],
                                 beside[RIS__EYE_PITCH_R], 0.0f);
    rig->head =
        yaw_pitch_roll(v3(0, 0, 0), beside[RIS__HEAD_YAW], beside[RIS__HEAD_PITCH], beside[RIS__HEAD_ROLL]);
    rig->head.shift = v3(beside[RIS__HEAD_X], beside[RIS__HEAD_Y], beside[RIS__HEAD_Z]);
    rig->head.identity = rig->head.identity && beside[RIS__HEAD_X] == 0.0f && beside[RIS__HEAD_Y] == 0.0f &&
                         beside[RIS__HEAD_Z] == 0.0f;

    /* the default tissue moves muscles in the closed-jaw space and turns their targets with the node's own
     * jaw weight */
    memcpy(rig->p, model->fiber_point, model->fiber_point_count * sizeof *rig->p);
    if (!(model->push.flags & RIS_TISSUE_FLAG_KAEHLER)) {
        return;
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle *muscle = &model->muscle[m];
        const bool turns = muscle->on_jaw && muscle->def->end_bone == RIS_BONE_AUTO;
        for (uint32_t f = 0; turns && f < muscle->fiber_count; ++f) {
            ris_vec3 *p = rig->p + model->fiber[muscle->first_fiber + f].first_point;
            for (uint32_t i = 0; i < muscle->point_count; ++i) {
                p[i] = ris__rigid_apply(&rig->jaw, p[i]);
            }
        }
    }
}
