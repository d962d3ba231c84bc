/* Horn's closed form: the turn is the eigenvector of a symmetric 4 x 4 matrix, found by Jacobi rotations. */
#include "solve/align.h"

#include <math.h>
#include <string.h>

#define SWEEPS 30

static void find_means(uint32_t count, const ris_vec3 *p, double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (uint32_t i = 0; i < count; ++i) {
        out[0] += (double)p[i].x / count;
        out[1] += (double)p[i].y / count;
        out[2] += (double)p[i].z / count;
    }
}

static void centred(ris_vec3 p, const double mean[3], double out[3])
{
    out[0] = (double)p.x - mean[0];
    out[1] = (double)p.y - mean[1];
    out[2] = (double)p.z - mean[2];
}

/* Turns rows and columns p, q of a until a[p][q] is 0, and the columns of v with them. */
static void rotate(double a[4][4], double v[4][4], int p, int q)
{
    if (a[p][q] == 0) {
        return;
    }
    const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    const double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
    const double c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 4; ++k) {
        const double kp = a[k][p], kq = a[k][q];
        a[k][p] = c * kp - s * kq;
        a[k][q] = s * kp + c * kq;
    }
    for (int k = 0; k < 4; ++k) {
        const double pk = a[p][k], qk = a[q][k], vp = v[k][p], vq = v[k][q];
        a[p][k] = c * pk - s * qk;
        a[q][k] = s * pk + c * qk;
        v[k][p] = c * vp - s * vq;
        v[k][q] = s * vp + c * vq;
    }
}

/* Unit eigenvector of the largest eigenvalue; false if the two largest are as good as equal. */
static bool largest_eigenvector(double a[4][4], double out[4])
{
    double v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        for (int p = 0; p < 3; ++p) {
            for (int q = p + 1; q < 4; ++q) {
                rotate(a, v, p, q);
            }
        }
    }
    int best = 0;
    for (int k = 1; k < 4; ++k) {
        best = a[k][k] > a[best][best] ? k : best;
    }
    double second = -INFINITY;
    for (int k = 0; k < 4; ++k) {
        out[k] = v[k][best];
        second = k != best && a[k][k] > second ? a[k][k] : second;
    }
    return a[best][best] - second > 1e-9 * fabs(a[best][best]);
}

static void turn_of_quaternion(const double q[4], double out[9])
{
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(out, r, sizeof r);
}

bool ris__align(uint32_t count, const ris_vec3 *from, const ris_vec3 *onto, ris_motion *out)
{
    double m[3][3] = {{0}}, mean_from[3], mean_onto[3], a[3], b[3], quaternion[4];
    find_means(count, from, mean_from);
    find_means(count, onto, mean_onto);
    for (uint32_t i = 0; i < count; ++i) {
        centred(from[i], mean_from, a);
        centred(onto[i], mean_onto, b);
        for (int r = 0; r < 3; ++r) {
            for (int c = 0; c < 3; ++c) {
                m[r][c] += a[r] * b[c];
            }
        }
    }
    double n[4][4] = {{m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]},
                      {0, m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2]},
                      {0, 0, m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1]},
                      {0, 0, 0, m[2][2] - m[0][0] - m[1][1]}};
    for (int r = 1; r < 4; ++r) {
        for (int c = 0; c < r; ++c) {
            n[r][c] = n[c][r];
        }
    }
    if (!largest_eigenvector(n, quaternion)) {
        return false;
    }
    turn_of_quaternion(quaternion, out->turn);
    for (int r = 0; r < 3; ++r) {
        const double *row = out->turn + 3 * r;
        out->shift[r] =
            mean_onto[r] - ((row[0] * mean_from[0] + row[1] * mean_from[1]) + row[2] * mean_from[2]);
    }
    return true;
}

ris_vec3 ris__motion_apply(const ris_motion *motion, ris_vec3 p)
{
    double out[3];
    for (int r = 0; r < 3; ++r) {
        const double *row = motion->turn + 3 * r;
        out[r] = ((row[0] * (double)p.x + row[1] * (double)p.y) + row[2] * (double)p.z) + motion->shift[r];
    }
    return (ris_vec3){(float)out[0], (float)out[1], (float)out[2]};
}

double ris__motion_degrees(const ris_motion *motion)
{
    const double *t = motion->turn;
    const double sine = 0.5 * sqrt((t[7] - t[5]) * (t[7] - t[5]) + (t[2] - t[6]) * (t[2] - t[6]) +
                                   (t[3] - t[1]) * (t[3] - t[1]));
    return atan2(sine, 0.5 * (t[0] + t[4] + t[8] - 1)) * 180 / 3.14159265358979323846;
}
