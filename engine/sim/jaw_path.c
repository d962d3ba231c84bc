/* The way of the mandible (KA-05 and beyond; docs/physics.md, jaw_pose): condyles that slide down the articular eminences,
 * teeth that guide. Double, no libm but sqrt: the same bits on every machine, and mirrored bits for a mirrored pose. */
#include "sim/rig.h"

#include "model/vec3.h"

#include <math.h>

#define PI 3.14159265358979323846

typedef struct vec {
    double x, y, z;
} vec;

static vec mad(vec a, double s, vec b)
{
    return (vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static vec cross(vec a, vec b)
{
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static double dot(vec a, vec b)
{
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}

static vec unit(vec a)
{
    const double l = sqrt(dot(a, a));
    return (vec){a.x / l, a.y / l, a.z / l};
}

/* A direction square to the axis, forward, or up for an axis that runs forward. */
static vec forward_of(vec axis)
{
    const vec z = {0, 0, 1}, y = {0, 1, 0};
    const vec base = fabs(axis.z) < 0.9 ? z : y;
    return unit(mad(base, -dot(base, axis), axis));
}

/* The joint seen from the side: a parabola from the fossa to the crest of the eminence, level behind and beyond. */
typedef struct joint {
    double crest, fall; /* crest: mm forward of the fossa; fall: slope where it begins */
} joint;

static joint joint_of(const ris_jaw_def *def)
{
    double c, s;
    ris__cos_sin((double)def->eminence_deg * PI / 180.0, &c, &s);
    return (joint){(double)def->eminence_mm, s / c};
}

/* How far a condyle is down when it is f mm forward. */
static double drop_at(joint j, double f)
{
    if (!(f > 0.0) || !(j.crest > 0.0)) {
        return 0.0;
    }
    const double u = f < j.crest ? f / j.crest : 1.0;
    return j.fall * j.crest * (u - 0.5 * u * u);
}

/* Cell of x among ascending knots, and the share of its right end; held beyond the ends. */
static uint32_t find_cell(const float *knot, uint32_t count, double x, double *share)
{
    uint32_t k = 0;
    while (k + 2 < count && x >= (double)knot[k + 1]) {
        ++k;
    }
    const double t = (x - (double)knot[k]) / ((double)knot[k + 1] - (double)knot[k]);
    *share = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    return k;
}

double ris__jaw_guidance(const ris_guidance *guidance, double forward_mm, double side)
{
    if (guidance->forward_count < 2 || guidance->side_count < 2) {
        return 0.0;
    }
    double u, v;
    const uint32_t i = find_cell(guidance->forward_mm, guidance->forward_count, forward_mm, &u);
    const uint32_t j = find_cell(guidance->side, guidance->side_count, side, &v);
    const float *a = guidance->open_deg + (size_t)i * guidance->side_count + j, *b = a + guidance->side_count;
    return (1.0 - u) * ((1.0 - v) * (double)a[0] + v * (double)a[1]) +
           u * ((1.0 - v) * (double)b[0] + v * (double)b[1]);
}

/* The chin goes to a side when the condyle of the other side goes forward and down, or its own back and up. Finds how far
 * apart that takes them, so that the incisors go side_mm at 1; share: what the common way has used of the joint. */
static double find_turn(const ris_jaw_def *def, joint j, double both, double share, double side, vec incisor)
{
    const double want =
        ((double)def->side_mm - (double)def->bennett_mm) * side * 2.0 * (double)def->condyle_mm;
    if (!(want > 0.0) || !(incisor.z > 0.0)) {
        return 0.0;
    }
    double low = 0.0, high = want / incisor.z;
    for (int i = 0; i < 40; ++i) {
        const double turn = 0.5 * (low + high), balancing = both + turn * (1.0 - share);
        const double tilt = drop_at(j, balancing) - drop_at(j, balancing - turn);
        if (turn * incisor.z - tilt * incisor.y < want) {
            low = turn;
        } else {
            high = turn;
        }
    }
    return 0.5 * (low + high);
}

/* Ways of the condyles at the two ends of the axis, mm forward of the fossae. What one movement has used of the joint the
 * others do not have, so none goes past the crest. incisor: from the hinge's point, z ahead, y up. */
static void condyles_forward(const ris_jaw_def *def, joint j, double open, double forward_mm, double side,
                             vec incisor, double way[2])
{
    const double start = (double)def->slide_start;
    double u = (open - start) / (1.0 - start);
    u = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
    const double slide = (double)def->slide_mm * u * u * (2.0 - u);
    double both = forward_mm + slide, share = 0.0;
    if (j.crest > 0.0) {
        both = forward_mm + slide * (1.0 - (forward_mm > 0.0 ? forward_mm / j.crest : 0.0));
        share = both > 0.0 ? both / j.crest : 0.0;
    }
    const double turn = find_turn(def, j, both, share, fabs(side), incisor);
    const double balancing = both + turn * (1.0 - share), working = balancing - turn;
    way[0] = side > 0.0 ? working : balancing;
    way[1] = side > 0.0 ? balancing : working;
}

/* Turn about the axis by angle, then the smallest rotation of axis to `to`, row-major. */
static void turn_and_tilt(vec axis, vec to, double angle, float out[9])
{
    const vec v = cross(axis, to);
    const double c = dot(axis, to), k = 1.0 / (1.0 + c);
    const double tilt[9] = {
        c + v.x * v.x * k,   v.x * v.y * k - v.z, v.x * v.z * k + v.y, v.x * v.y * k + v.z, c + v.y * v.y * k,
        v.y * v.z * k - v.x, v.x * v.z * k - v.y, v.y * v.z * k + v.x, c + v.z * v.z * k,
    };
    double cosine, s;
    ris__cos_sin(angle, &cosine, &s);
    const double x = axis.x, y = axis.y, z = axis.z, w = 1.0 - cosine;
    const double turn[9] = {
        cosine + x * x * w, x * y * w - z * s, x * z * w + y * s, y * x * w + z * s,  cosine + y * y * w,
        y * z * w - x * s,  z * x * w - y * s, z * y * w + x * s, cosine + z * z * w,
    };
    for (int r = 0; r < 3; ++r) {
        for (int q = 0; q < 3; ++q) {
            out[3 * r + q] = (float)((tilt[3 * r] * turn[q] + tilt[3 * r + 1] * turn[3 + q]) +
                                     tilt[3 * r + 2] * turn[6 + q]);
        }
    }
}

ris_rigid ris__jaw_path(const ris_jaw_def *def, const ris_guidance *guidance, float open, float forward,
                        float side)
{
    const double o = (double)open, s = (double)side;
    const double forward_mm = (double)forward * (double)(forward < 0.0f ? def->back_mm : def->forward_mm);
    const vec axis = {(double)def->axis.x, (double)def->axis.y, (double)def->axis.z};
    const vec ahead = forward_of(axis), up = cross(ahead, axis);
    const double half = def->condyle_mm > 0.0f ? (double)def->condyle_mm : 1.0;
    const joint j = joint_of(def);
    const vec to = {(double)def->incisor.x - (double)def->point.x,
                    (double)def->incisor.y - (double)def->point.y,
                    (double)def->incisor.z - (double)def->point.z};
    double way[2];
    condyles_forward(def, j, o, forward_mm, s, (vec){0, dot(to, up), dot(to, ahead)}, way);
    vec end[2], middle = {0, 0, 0};
    for (int k = 0; k < 2; ++k) {
        end[k] = mad(middle, k == 0 ? half : -half, axis);
        end[k] = mad(mad(end[k], way[k], ahead), -drop_at(j, way[k]), up);
    }
    middle = mad((vec){0, 0, 0}, 0.5, (vec){end[0].x + end[1].x, end[0].y + end[1].y, end[0].z + end[1].z});
    middle = mad(middle, (double)def->bennett_mm * s, axis);
    const double held = ris__jaw_guidance(guidance, forward_mm, fabs(s)) * PI / 180.0;
    const double most = (double)def->open_deg * PI / 180.0;
    ris_rigid jaw = {.point = def->point, .identity = open == 0.0f && forward == 0.0f && side == 0.0f};
    jaw.shift = v3((float)middle.x, (float)middle.y, (float)middle.z);
    turn_and_tilt(axis, unit(mad(end[0], -1.0, end[1])), held + o * (most - held), jaw.rotation);
    return jaw;
}
