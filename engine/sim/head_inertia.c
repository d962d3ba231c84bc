/* head_inertia, last host stage of a tick: the simulation runs in the frame of the head, so the flesh feels the head's
 * acceleration as a field, and its weight where the head is tilted. At the place r of the head's frame, with the
 * acceleration A of the origin, angular velocity w and acceleration e, all in that frame, and the weight g at rest:
 *
 *     f(r) = -(A + e x r + w x (w x r)) + (R^T g - g)
 *
 * What comes from the motion is linear in r, so three rows are all that verlet needs. Derivatives are differences of the
 * poses of three ticks, bounded so that a cut in a take is no blow, and smoothed like an activation. */
#include "sim/rig.h"

#include "model/vec3.h"

#include <string.h>

#define GRAVITY_MM_S2 9810.0
/* A shaken head reaches 1 g at the face and 100 rad/s^2; a jump of the pose is held to these. */
#define MOST_SPEED_MM_S 3000.0
#define MOST_ACCELERATION_MM_S2 12000.0
#define MOST_SPIN 8.0          /* rad/s */
#define MOST_SPIN_CHANGE 120.0 /* rad/s^2 */
#define SMOOTHED_MS 80.0f      /* until 90 % of a step of the acceleration is felt */

/* Shortens v to at most `most`, keeping its direction. */
static void bound(double v[3], double most)
{
    const double length2 = (v[0] * v[0] + v[1] * v[1]) + v[2] * v[2];
    if (length2 > most * most) {
        const double s = most / sqrt(length2);
        for (int k = 0; k < 3; ++k) {
            v[k] = s * v[k];
        }
    }
}

/* rotation^T v */
static void turn_back(const double rotation[9], const double v[3], double out[3])
{
    for (int k = 0; k < 3; ++k) {
        out[k] = (rotation[k] * v[0] + rotation[3 + k] * v[1]) + rotation[6 + k] * v[2];
    }
}

/* Angular velocity in the frame of the head between two rotations: the axis times the sine of the angle between them. */
static void spin_between(const double before[9], const double now[9], double out[3])
{
    double d[9]; /* before^T now */
    for (int c = 0; c < 3; ++c) {
        const double column[3] = {now[c], now[3 + c], now[6 + c]};
        double turned[3];
        turn_back(before, column, turned);
        for (int r = 0; r < 3; ++r) {
            d[3 * r + c] = turned[r];
        }
    }
    out[0] = 0.5 * (d[7] - d[5]) / RIS_TICK_S;
    out[1] = 0.5 * (d[2] - d[6]) / RIS_TICK_S;
    out[2] = 0.5 * (d[3] - d[1]) / RIS_TICK_S;
    bound(out, MOST_SPIN);
}

/* Rows (3x4) of -(A + e x r + w x (w x r)). */
static void field_of(const double a[3], const double e[3], const double w[3], double out[12])
{
    const double w2 = (w[0] * w[0] + w[1] * w[1]) + w[2] * w[2];
    const double cross[9] = {0.0, -e[2], e[1], e[2], 0.0, -e[0], -e[1], e[0], 0.0};
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            out[4 * r + c] = (r == c ? w2 : 0.0) - w[r] * w[c] - cross[3 * r + c];
        }
        out[4 * r + 3] = -a[r];
    }
}

/* The field of the motion over the last three ticks; none of what is not known yet. */
static void measure(ris_head_motion *m, const double rotation[9], const double place[3], double out[12])
{
    double spin[3] = {0}, speed[3] = {0}, a[3] = {0}, e[3] = {0};
    if (m->known > 0) {
        spin_between(m->rotation, rotation, spin);
        for (int k = 0; k < 3; ++k) {
            speed[k] = (place[k] - m->place[k]) / RIS_TICK_S;
        }
        bound(speed, MOST_SPEED_MM_S);
    }
    if (m->known > 1) {
        double change[3];
        for (int k = 0; k < 3; ++k) {
            e[k] = (spin[k] - m->spin[k]) / RIS_TICK_S;
            change[k] = (speed[k] - m->speed[k]) / RIS_TICK_S;
        }
        turn_back(rotation, change, a);
        bound(a, MOST_ACCELERATION_MM_S2);
        bound(e, MOST_SPIN_CHANGE);
    }
    field_of(a, e, spin, out);
    memcpy(m->rotation, rotation, sizeof m->rotation);
    memcpy(m->place, place, sizeof m->place);
    memcpy(m->spin, spin, sizeof m->spin);
    memcpy(m->speed, speed, sizeof m->speed);
    m->known += m->known < 2;
}

void ris__head_inertia(ris_rig *rig, bool at_once)
{
    const ris_dynamics_def *dynamics = &rig->model->head->dynamics;
    const bool off = (rig->model->push.flags & RIS_TISSUE_FLAG_KAEHLER) != 0;
    const double share = off ? 0.0 : (double)dynamics->follow_through,
                 weight = off ? 0.0 : (double)dynamics->gravity * GRAVITY_MM_S2;
    ris_head_motion *m = &rig->head_motion;
    double rotation[9], field[12];
    const double place[3] = {(double)rig->head.shift.x, (double)rig->head.shift.y, (double)rig->head.shift.z};
    for (int k = 0; k < 9; ++k) {
        rotation[k] = (double)rig->head.rotation[k];
    }
    if (at_once) {
        m->known = 0; /* held, however it came here */
    }
    measure(m, rotation, place, field);
    const ris_pace pace = ris__pace(at_once ? 0.0f : SMOOTHED_MS);
    for (int k = 0; k < 12; ++k) {
        /* g = (0, -weight, 0), and R^T of it is minus the second row of R */
        const double tilt = k % 4 == 3 ? -weight * (rotation[3 + k / 4] - (k == 7 ? 1.0 : 0.0)) : 0.0;
        /* + 0: no negative zero, so that what is not felt changes no bit */
        ris__follow(pace, (share * field[k] + tilt) + 0.0, &m->first[k], &m->second[k]);
    }
    ris_vec4 *const row[3] = {&rig->inertia.row_x, &rig->inertia.row_y, &rig->inertia.row_z};
    for (int r = 0; r < 3; ++r) {
        const double *f = m->second + 4 * (size_t)r;
        *row[r] = (ris_vec4){(float)f[0], (float)f[1], (float)f[2], (float)f[3]};
    }
}
