/* lid_pose (KA-48), last host stage: the lids turn about the lateral axis through the centre of the eye.
 * lid.upper 1 carries the margin of the upper lid onto the lower margin, wherever that is; -1 widens;
 * lid.lower 1 raises the lower lid, -1 lowers it; the pitch of the eye carries both. Anchors stay off the
 * ball and the cornea. */
#include "sim/rig.h"

#include "model/model_impl.h"
#include "model/vec3.h"

#define DEG (3.14159265358979323846f / 180.0f)
#define WIDE_RAD (10.0f * DEG)      /* lid.upper -1, before the limit of the fold */
#define FOLD_KNEE_RAD (6.0f * DEG)  /* a raised lid runs freely so far ... */
#define FOLD_ROOM_RAD (4.5f * DEG)  /* ... and at most so much farther under its fold */
#define LOWER_UP_RAD (10.0f * DEG)  /* lid.lower 1 */
#define LOWER_DOWN_RAD (3.6f * DEG) /* lid.lower -1 */
#define SQUEEZE_UPPER 0.45f         /* the ring in the lids at its strongest: share of closing, */
#define SQUEEZE_LOWER 1.0f          /* and of lid.lower */
#define UPPER_FOLLOWS 0.75f         /* share of the eye's pitch */
#define LOWER_FOLLOWS 0.3f
#define MEET_HALF 0.6f  /* at the corners the lids meet half way ... */
#define MEET_SHARE 0.6f /* ... where the opening is this share of the widest, on the lower margin as it was */
#define FULL_MM 0.8f    /* how much a closed lid rounds out between margin and fold */
#define CLEAR_MM 0.25f  /* nearest a moved anchor comes to the eye */
#define LINING_LESS 0.4f /* of what the surface of the eye comes out by, the lining lies less deep in it */
#define THICK_SHARE 0.5f /* what lies farther out at rest keeps this share of it ... */
#define THICK_MM 0.15f   /* ... up to so much, so that a lid pressed on the cornea is not pressed flat */

/* What moves the lids of one eye this tick. */
typedef struct lid_state {
    float closed;       /* 0..1 */
    float open_rad;     /* widest opening at rest */
    float raise, sink;  /* upper lid, radians up or down */
    float lower, pitch; /* lower lid: channel -1..1, radians */
    ris_vec3 gaze;      /* unit */
    bool still;
} lid_state;

/* Activation of this eye's lid muscles: linear ones lift the upper lid, rings narrow both. */
static float lid_muscle(const ris_rig *rig, uint32_t eye, ris_muscle_kind kind)
{
    float most = 0.0f;
    for (uint32_t m = 0; m < rig->model->muscle_count; ++m) {
        const ris_muscle *muscle = &rig->model->muscle[m];
        if (muscle->lid_eye == eye + 1 && muscle->kind == kind) {
            most = f_max(most, rig->activation[m]);
        }
    }
    return most;
}

static lid_state read_state(const ris_rig *rig, const float *beside, uint32_t eye)
{
    const float lift = lid_muscle(rig, eye, RIS_MUSCLE_LINEAR),
                squeeze = lid_muscle(rig, eye, RIS_MUSCLE_SPHINCTER);
    const float upper = beside[RIS__LID_UPPER_L + eye], pitch = beside[RIS__EYE_PITCH_L + eye] * DEG;
    lid_state s = {.closed = f_clamp(upper, 0.0f, 1.0f),
                   .open_rad = rig->model->lid_eye[eye].open_rad,
                   .lower = beside[RIS__LID_LOWER_L + eye]};
    const float wish = (f_max(-upper, 0.0f) + lift) * WIDE_RAD + f_max(pitch, 0.0f) * UPPER_FOLLOWS;
    const float more = f_max(wish - FOLD_KNEE_RAD, 0.0f) / FOLD_ROOM_RAD;
    s.raise = f_min(wish, FOLD_KNEE_RAD) + FOLD_ROOM_RAD * more / (1.0f + more);
    s.sink = f_max(-pitch, 0.0f) * UPPER_FOLLOWS;
    s.pitch = pitch * LOWER_FOLLOWS;
    s.gaze = ris__rigid_rotate(&rig->eye[eye], v3(0, 0, 1));
    s.closed += (1.0f - s.closed) * SQUEEZE_UPPER * squeeze;
    s.lower = f_min(s.lower + SQUEEZE_LOWER * squeeze, 1.0f);
    s.still = upper == 0.0f && lift == 0.0f && squeeze == 0.0f && s.lower == 0.0f && rig->eye[eye].identity;
    return s;
}

/* Turn of the lower margin where the opening is `share` of the widest, radians upwards. */
static float lower_turn(const lid_state *s, float share)
{
    const float up = f_max(s->lower, 0.0f) * LOWER_UP_RAD * (share * share);
    const float gaze = s->pitch * share;
    const float down = f_min(s->lower, 0.0f) * LOWER_DOWN_RAD * (share * (2.0f - share)) + f_min(gaze, 0.0f);
    const float near = s->closed * f_max(1.0f - share / MEET_SHARE, 0.0f);
    const float meet = MEET_HALF * (share * s->open_rad);
    return ((up + f_max(gaze, 0.0f)) + (1.0f - near) * down) + near * meet;
}

static float node_turn(const lid_state *s, const ris_lid_node *lid)
{
    if (!lid->upper) {
        const float up = lower_turn(s, lid->share);
        return up * (up < 0.0f ? lid->weight_open : lid->weight_close);
    }
    const float open = s->raise * (lid->share * (2.0f - lid->share)) * lid->weight_open -
                       s->sink * (lid->share * (0.5f + 0.5f * lid->share)) * lid->weight_close;
    const float shut = (lower_turn(s, lid->lower_share) - lid->close_rad) * lid->weight_close;
    return open + s->closed * (shut - open);
}

/* About +x through the origin; a positive angle lifts what lies in front. */
static ris_vec3 turn(ris_vec3 p, double c, double s)
{
    return v3(p.x, (float)(c * (double)p.y + s * (double)p.z), (float)(c * (double)p.z - s * (double)p.y));
}

/* Keeps the node's gap over the eye's surface as it was at rest, and at least CLEAR_MM once it has moved. */
static ris_vec3 clear_eye(const lid_state *s, const ris_lid_eye *eye, const ris_lid_node *lid, ris_vec3 rest,
                          ris_vec3 p)
{
    const float r = v3_length(p), r0 = v3_length(rest);
    const float now = ris__eye_surface(eye, v3_scale(p, 1.0f / r), s->gaze);
    const float firm = 0.4f + 0.6f * f_min(4.0f * lid->share, 1.0f); /* corners are tied to the bone */
    const float bulge = (now - (r0 - lid->gap_mm)) * lid->weight_open * firm;
    const float moved = f_clamp(v3_distance(p, rest) + (bulge < 0.0f ? -bulge : bulge), 0.0f, 1.0f);
    const float gap = lid->gap_mm < CLEAR_MM
                          ? lid->gap_mm + moved * (CLEAR_MM - lid->gap_mm)
                          : CLEAR_MM + f_min(THICK_SHARE * (lid->gap_mm - CLEAR_MM), THICK_MM);
    return v3_scale(p, f_max(r + bulge, now + gap) / r);
}

/* The lining lies inside the eye, and goes no deeper when the cornea comes by: a little less deep, since its edges are
 * straight. */
static ris_vec3 clear_lining(const lid_state *s, const ris_lid_eye *eye, const ris_lid_node *lid,
                             ris_vec3 rest, ris_vec3 p)
{
    const float r = v3_length(p), now = ris__eye_surface(eye, v3_scale(p, 1.0f / r), s->gaze);
    const float come = f_max(now - (v3_length(rest) - lid->gap_mm), 0.0f);
    return v3_scale(p, f_max(r, now + lid->gap_mm + LINING_LESS * come) / r);
}

static bool is_zero(ris_vec3 v)
{
    return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}

/* What moves the margin that a node meets or, of the lining, hangs on. */
static ris_vec3 facing_move(const ris_rig *rig, const ris_lid_node *lid)
{
    return v3_lerp(rig->lid_move[lid->facing[0]], rig->lid_move[lid->facing[1]], lid->facing_share);
}

/* Place of the node relative to the eye's centre. own: what muscles and jaw move it by. */
static ris_vec3 place(const lid_state *s, const ris_rig *rig, const ris_lid_node *lid, uint32_t k,
                      ris_vec3 rest, double cosine, double sine)
{
    const ris_lid_eye *eye = &rig->model->lid_eye[lid->eye];
    const float shut = lid->upper ? s->closed * lid->weight_close : 0.0f;
    ris_vec3 p = turn(rest, cosine, sine);
    if (shut > 0.0f) {
        const float r = sqrtf(p.y * p.y + p.z * p.z),
                    full = lid->share * 4.0f * shut * (1.0f - lid->weight_close),
                    scale = (r + lid->close_mm * s->closed + FULL_MM * full) / r;
        p = v3(p.x, p.y * scale, p.z * scale);
    }
    p = v3_add(p, v3_lerp(rig->lid_move[k], facing_move(rig, lid), lid->lining ? 1.0f : shut));
    return lid->lining ? clear_lining(s, eye, lid, rest, p) : clear_eye(s, eye, lid, rest, p);
}

void ris__lid_pose(ris_rig *rig, const float *pose)
{
    const ris_model *model = rig->model;
    const float *beside = pose + rig->first_beside;
    const lid_state state[2] = {read_state(rig, beside, 0), read_state(rig, beside, 1)};
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        const uint32_t i = model->lid[k].node;
        rig->lid_move[k] = v3_sub(rig->target[i], v4_xyz(model->rest_position[i]));
    }
    for (uint32_t k = 0; k < model->lid_count; ++k) {
        const ris_lid_node *lid = &model->lid[k];
        const lid_state *s = &state[lid->eye];
        const uint32_t i = lid->node;
        const ris_vec3 centre = model->lid_eye[lid->eye].centre;
        const ris_vec3 before = v3_sub(rig->target[i], v4_xyz(rig->delta[i]));
        rig->lid_turn[k] = (ris_turn){1.0f, 0.0f};
        if (s->still && is_zero(rig->lid_move[k]) && (!lid->lining || is_zero(facing_move(rig, lid)))) {
            continue; /* at rest to the bit */
        }
        double cosine, sine;
        ris__cos_sin((double)node_turn(s, lid), &cosine, &sine);
        rig->lid_turn[k] = (ris_turn){(float)cosine, (float)sine};
        const ris_vec3 rest = v3_sub(v4_xyz(model->rest_position[i]), centre);
        rig->target[i] = v3_add(centre, place(s, rig, lid, k, rest, cosine, sine));
        rig->delta[i] = v4_from(v3_sub(rig->target[i], before), 0.0f);
        rig->point[i].a = v4_from(rig->target[i], 0.0f);
        rig->point[i].b = v4_from(turn(v4_xyz(rig->point[i].b), cosine, sine), 0.0f);
    }
    ris__lid_unfold(rig);
}
