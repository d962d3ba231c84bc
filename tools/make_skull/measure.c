/* What the bones must keep to, measured on the meshes with exact closest points and rays (docs/skull.md). */
#include "make_skull.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEETH 16

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static ris_result measure_depths(const skull_input *in, skull_report *out, ris_error *err)
{
    for (int k = 0; k < 2; k++) {
        const tri_mesh *m = &in->bone[k];
        double *depth = malloc((m->vertex_count + 1) * sizeof *depth);
        if (!depth || m->vertex_count == 0) {
            free(depth);
            return ris_fail(err, RIS_ERROR_MEMORY, "no depths for %u vertices", m->vertex_count);
        }
        for (uint32_t i = 0; i < m->vertex_count; i++)
            depth[i] = ris__bvh_depth(&in->skin->tree, m->position[i]);
        qsort(depth, m->vertex_count, sizeof *depth, compare_doubles);
        out->least_depth[k] = depth[0];
        for (uint32_t i = 0; i < m->triangle_count * 3; i++) {
            dvec p = m->position[m->triangle[i]], q = m->position[m->triangle[i % 3 == 2 ? i - 2 : i + 1]];
            if (m->triangle[i] < m->triangle[i % 3 == 2 ? i - 2 : i + 1])
                out->least_depth[k] =
                    fmin(out->least_depth[k], ris__bvh_depth(&in->skin->tree, dv_mad(p, 0.5, dv_sub(q, p))));
        }
        uint32_t near = 0;
        for (uint32_t i = 0; i < m->vertex_count; i++)
            near += fabs(depth[i] - depth[m->vertex_count / 2]) < 2;
        if (k == 0) {
            out->depth_spread = depth[m->vertex_count - 1] - depth[0];
            out->shrink_share = (double)near / m->vertex_count;
        }
        free(depth);
    }
    return RIS_OK;
}

static void measure_sites(const skull_input *in, skull_report *out)
{
    out->worst_depth_error = 0;
    snprintf(out->worst_site, sizeof out->worst_site, "none");
    for (uint32_t i = 0; i < in->landmark->bone_count; i++) {
        const landmark *l = &in->landmark->bone[i];
        double error = l->table_mm > 0 ? fabs(l->depth_mm - l->table_mm) / l->table_mm : 0;
        if (error > out->worst_depth_error) {
            out->worst_depth_error = error;
            memcpy(out->worst_site, l->name, sizeof out->worst_site);
        }
        for (uint32_t k = 0; l->table_mm > 0 && k < in->landmark->skin_count; k++)
            if (strcmp(in->landmark->skin[k].name, l->name) == 0) {
                double near = ris__bvh_closest(&in->tree[l->bone], in->landmark->skin[k].at).distance;
                out->worst_near_error = fmax(out->worst_near_error, fabs(near - l->table_mm) / l->table_mm);
            }
    }
}

/* z where a frontal ray meets the skull, or -200. */
static double front(const skull_input *in, double x, double y)
{
    bvh_hit hit = ris__bvh_ray(&in->tree[0], dv(x, y, 200), dv(0, 0, -1), 0, 400);
    return hit.found ? hit.at.z : -200;
}

/* Walks from inside an opening to its rim, where the bone stops rising to the front. */
static dvec find_rim(const skull_input *in, double x, double y, double dx, double dy)
{
    double last = front(in, x, y), floor = last + 8;
    for (int k = 1; k < 80; k++) {
        double px = x + 0.5 * k * dx, py = y + 0.5 * k * dy, z = front(in, px, py);
        if (k > 8 && last > floor && z - last < 0.15)
            return dv(px - 0.5 * dx, py - 0.5 * dy, last);
        last = z;
    }
    return dv(x + 20 * dx, y + 20 * dy, -1000); /* no rim: nothing is free */
}

/* Least free length behind the rim plane of frontal rays in a disc about the middle of an opening. */
static double free_behind(const skull_input *in, double x, double y, double reach)
{
    dvec left = find_rim(in, x, y, 1, 0), right = find_rim(in, x, y, -1, 0), up = find_rim(in, x, y, 0, 1),
         down = find_rim(in, x, y, 0, -1);
    double least = HUGE_VAL;
    for (int i = -2; i <= 2; i++)
        for (int j = -2; j <= 2; j++) {
            double px = x + reach * i / 2, py = y + reach * j / 2;
            double across = right.z + (left.z - right.z) * (px - right.x) / (left.x - right.x);
            double along = down.z + (up.z - down.z) * (py - down.y) / (up.y - down.y);
            least = fmin(least, fmin(across, along) - front(in, px, py));
        }
    return least;
}

static void measure_openings(const skull_input *in, skull_report *out)
{
    out->orbit_free = fmin(free_behind(in, 31.5, 17, 8), free_behind(in, -31.5, 17, 8));
    out->nose_free = free_behind(in, 0.0, -14, 5);
    out->arch_free = HUGE_VAL;
    for (int side = -1; side <= 1; side += 2) {
        dvec in_dir = dv(-side, 0, 0);
        bvh_hit outer = ris__bvh_ray(&in->tree[0], dv(100 * side, -3, 33), in_dir, 0, 100);
        bvh_hit inner = ris__bvh_ray(&in->tree[0], dv_mad(outer.at, 1e-3, in_dir), in_dir, 0, 100);
        bvh_hit wall = ris__bvh_ray(&in->tree[0], dv_mad(inner.at, 1e-3, in_dir), in_dir, 0, 100);
        if (!outer.found || !inner.found || !wall.found || inner.distance > 9) {
            out->arch_free = 0; /* no arch that stands free */
            return;
        }
        for (int k = 0; k < 2; k++)
            for (int turn = -1; turn <= 1; turn += 2) {
                dvec from = dv_mad(inner.at, 0.4 * wall.distance, in_dir);
                bvh_hit hit = ris__bvh_ray(&in->tree[k], from, dv(0, turn, 0), 0, 25);
                out->arch_free = fmin(out->arch_free, hit.distance);
            }
    }
}

/* Middle of the box about the uppermost 6 mm of the mandible behind z 20, each side. */
static void measure_condyles(const skull_input *in, skull_report *out)
{
    const tri_mesh *m = &in->bone[1];
    out->condyle_off = 0;
    out->joint_gap = HUGE_VAL;
    for (int side = -1; side <= 1; side += 2) {
        double top = -HUGE_VAL;
        for (uint32_t i = 0; i < m->vertex_count; i++)
            if (side * m->position[i].x > 0 && m->position[i].z < 20)
                top = fmax(top, m->position[i].y);
        dvec low = dv(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = dv(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
        for (uint32_t i = 0; i < m->vertex_count; i++) {
            dvec p = m->position[i];
            if (side * p.x < 0 || p.z > 20 || p.y < top - 6)
                continue;
            low = dv(fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z));
            high = dv(fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z));
            out->joint_gap = fmin(out->joint_gap, ris__bvh_closest(&in->tree[0], p).distance);
        }
        dvec middle = dv_mad(low, 0.5, dv_sub(high, low)), off = dv_sub(middle, in->jaw_point);
        off = dv_mad(off, -dv_dot(off, in->jaw_axis), in->jaw_axis);
        out->condyle_off = fmax(out->condyle_off, dv_length(off));
    }
}

/* The neck of a crown is the end towards its bone; the root goes on from there, leaning a little inwards. */
static void measure_roots(const skull_input *in, skull_report *out)
{
    out->roots_bare = 0;
    for (int k = 0; k < 2; k++) {
        const tri_mesh *m = &in->teeth[k];
        uint32_t each = m->vertex_count / TEETH;
        double up = k == 0 ? 1 : -1;
        for (uint32_t t = 0; t < TEETH; t++) {
            double top = -HUGE_VAL;
            dvec sum = {0};
            uint32_t n = 0;
            for (uint32_t i = t * each; i < (t + 1) * each; i++)
                top = fmax(top, up * m->position[i].y);
            for (uint32_t i = t * each; i < (t + 1) * each; i++)
                if (up * m->position[i].y > top - 1.5) {
                    sum = dv_add(sum, m->position[i]);
                    n++;
                }
            dvec root = dv(sum.x / n, sum.y / n + up * 5, sum.z / n);
            out->roots_bare += !ris__bvh_inside(&in->tree[k], root);
        }
    }
}

uint32_t skull_crossings(const bvh tree[2])
{
    static const float rest[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    return ris__bvh_crossings(&tree[1], rest, &tree[0], UINT32_MAX);
}

ris_result skull_measure(const skull_input *in, skull_report *out, ris_error *err)
{
    *out = (skull_report){0};
    ris_result result = RIS_OK;
    for (int k = 0; k < 2 && result == RIS_OK; k++) {
        result = tri_open_edges(&in->bone[k], &out->open_edges[k], err);
        out->asymmetry[k] = tri_asymmetry(&in->bone[k]);
    }
    if (result == RIS_OK)
        result = measure_depths(in, out, err);
    if (result != RIS_OK)
        return result;
    measure_sites(in, out);
    measure_openings(in, out);
    measure_condyles(in, out);
    measure_roots(in, out);
    out->crossing = skull_crossings(in->tree);
    return RIS_OK;
}

void skull_print(const skull_report *r)
{
    printf("open edges            %u skull, %u mandible\n", r->open_edges[0], r->open_edges[1]);
    printf("asymmetry             %g, %g mm\n", r->asymmetry[0], r->asymmetry[1]);
    printf("least depth           %.2f skull, %.2f mandible mm under the skin\n", r->least_depth[0],
           r->least_depth[1]);
    printf("worst site            %s, %.1f %% off the table\n", r->worst_site, 100 * r->worst_depth_error);
    printf("nearest bone          at most %.1f %% off the table\n", 100 * r->worst_near_error);
    printf("frontal rays          orbit %.1f mm, nose %.1f mm free past the rim\n", r->orbit_free,
           r->nose_free);
    printf("under the arch        %.1f mm free up and down\n", r->arch_free);
    printf("condyles              %.2f mm from the axis, joint gap %.2f mm\n", r->condyle_off, r->joint_gap);
    printf("bones crossing        %u edges\n", r->crossing);
    printf("roots not in bone     %u of 32\n", r->roots_bare);
    printf("depth of the skull    spread %.1f mm, %.0f %% of the vertices within 2 mm of the median\n",
           r->depth_spread, 100 * r->shrink_share);
}

bool skull_accept(const skull_report *r, ris_error *err)
{
    const char *broken = NULL;
    if (r->open_edges[0] || r->open_edges[1])
        broken = "a bone is not a closed manifold";
    else if (r->asymmetry[0] > 0 || r->asymmetry[1] > 0)
        broken = "a bone is not mirror-symmetric";
    else if (!(r->least_depth[0] > 0 && r->least_depth[1] > 0))
        broken = "bone stands out of the skin";
    else if (!(r->worst_depth_error <= 0.30))
        broken = "a tissue depth is more than 30 % off the table";
    else if (!(r->worst_near_error <= 0.30))
        broken = "the bone nearest to a site is more than 30 % off the table";
    else if (!(r->orbit_free >= 15))
        broken = "a frontal ray into an orbit meets bone within 15 mm";
    else if (!(r->nose_free >= 15))
        broken = "a frontal ray into the nasal aperture meets bone within 15 mm";
    else if (!(r->arch_free >= 12))
        broken = "the way under the zygomatic arch is not free";
    else if (!(r->condyle_off <= 3))
        broken = "a condyle is more than 3 mm off the jaw axis";
    else if (r->crossing)
        broken = "mandible and skull cross";
    else if (r->roots_bare)
        broken = "a tooth has no bone about its root";
    else if (!(r->depth_spread >= 20 && r->shrink_share <= 0.6))
        broken = "the skull is a shrunken skin";
    if (broken)
        ris_fail(err, RIS_ERROR_FAILED, "%s", broken);
    return broken == NULL;
}
