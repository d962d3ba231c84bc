/* Triangle meshes: OBJ out, closedness, symmetry (KA-04). */
#include "make_skull.h"

#include "base/file.h"

#include <stdlib.h>
#include <string.h>

ris_result tri_write_obj(const char *path, const char *comment, const tri_mesh *mesh, ris_error *err)
{
    ris_output_file file = {0};
    ris_result result = ris__output_open(&file, path, err);
    if (result == RIS_OK)
        result = ris__output_printf(&file, err, "# %s\n", comment);
    for (uint32_t i = 0; result == RIS_OK && i < mesh->vertex_count; i++) {
        dvec p = mesh->position[i];
        result = ris__output_printf(&file, err, "v %.4f %.4f %.4f\n", p.x, p.y, p.z);
    }
    for (uint32_t i = 0; result == RIS_OK && i < mesh->triangle_count; i++) {
        const uint32_t *t = mesh->triangle + 3 * (size_t)i;
        result = ris__output_printf(&file, err, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    if (result == RIS_OK)
        result = ris__output_commit(&file, err);
    ris__output_discard(&file);
    return result;
}

static int compare_edges(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    if (x[0] != y[0])
        return x[0] < y[0] ? -1 : 1;
    if (x[1] != y[1])
        return x[1] < y[1] ? -1 : 1;
    return x[2] < y[2] ? -1 : x[2] > y[2];
}

ris_result tri_open_edges(const tri_mesh *mesh, uint32_t *out_count, ris_error *err)
{
    size_t n = (size_t)mesh->triangle_count * 3;
    uint32_t(*edge)[3] = malloc((n + 1) * sizeof *edge);
    if (!edge)
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %zu edges", n);
    for (size_t i = 0; i < n; i++) {
        uint32_t a = mesh->triangle[i], b = mesh->triangle[i % 3 == 2 ? i - 2 : i + 1];
        edge[i][0] = a < b ? a : b;
        edge[i][1] = a < b ? b : a;
        edge[i][2] = a < b ? 0 : 1;
    }
    qsort(edge, n, sizeof *edge, compare_edges);
    *out_count = 0;
    for (size_t i = 0, j; i < n; i = j) {
        for (j = i; j < n && edge[j][0] == edge[i][0] && edge[j][1] == edge[i][1]; j++) {
        }
        *out_count += j - i != 2 || edge[i][2] == edge[i + 1][2];
    }
    free(edge);
    return RIS_OK;
}

static int compare_positions(const void *a, const void *b)
{
    const dvec *p = a, *q = b;
    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    if (p->z != q->z)
        return p->z < q->z ? -1 : 1;
    return p->x < q->x ? -1 : p->x > q->x;
}

double tri_asymmetry(const tri_mesh *mesh)
{
    uint32_t n = mesh->vertex_count;
    dvec *sorted = malloc((n + 1) * sizeof *sorted);
    if (!sorted)
        return HUGE_VAL;
    memcpy(sorted, mesh->position, n * sizeof *sorted);
    qsort(sorted, n, sizeof *sorted, compare_positions);
    double worst = 0;
    for (uint32_t i = 0; i < n; i++) {
        dvec key = dv(-mesh->position[i].x, mesh->position[i].y, mesh->position[i].z);
        if (key.x == 0)
            key.x = 0; /* -0 */
        if (bsearch(&key, sorted, n, sizeof *sorted, compare_positions))
            continue;
        double best = HUGE_VAL;
        for (uint32_t k = 0; k < n; k++)
            best = fmin(best, dv_length(dv_sub(sorted[k], key)));
        worst = fmax(worst, best);
    }
    free(sorted);
    return worst;
}

double tri_volume(const tri_mesh *mesh)
{
    double six = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *t = mesh->triangle + 3 * (size_t)i;
        six += dv_dot(mesh->position[t[0]], dv_cross(mesh->position[t[1]], mesh->position[t[2]]));
    }
    return six / 6;
}
