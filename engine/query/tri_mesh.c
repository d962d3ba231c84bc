/* Triangle meshes of polygon meshes. */
#include "query/query.h"

#include <stdlib.h>

void ris__tri_finish(tri_mesh *mesh)
{
    free(mesh->position);
    free(mesh->triangle);
    *mesh = (tri_mesh){0};
}

dvec ris__tri_normal(const tri_mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangle + 3 * (size_t)triangle;
    dvec a = mesh->position[t[0]];
    return dv_unit(dv_cross(dv_sub(mesh->position[t[1]], a), dv_sub(mesh->position[t[2]], a)));
}

ris_result ris__tri_from_mesh(const ris_mesh *mesh, const char *name, tri_mesh *out, ris_error *err)
{
    const uint32_t corners = mesh->face_count ? mesh->face_start[mesh->face_count] : 0;
    *out = (tri_mesh){.vertex_count = mesh->vertex_count};
    out->position = malloc(((size_t)mesh->vertex_count + 1) * sizeof *out->position);
    out->triangle = malloc(((size_t)corners * 3 + 1) * sizeof *out->triangle);
    if (!out->position || !out->triangle) {
        ris__tri_finish(out);
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: out of memory", name);
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        const ris_vec3 p = mesh->position[i];
        out->position[i] = dv((double)p.x, (double)p.y, (double)p.z);
    }
    for (uint32_t f = 0; f < mesh->face_count; f++) {
        const uint32_t *v = mesh->face_vertex + mesh->face_start[f];
        for (uint32_t k = 2; k < mesh->face_start[f + 1] - mesh->face_start[f]; k++) {
            uint32_t *t = out->triangle + 3 * (size_t)out->triangle_count++;
            t[0] = v[0];
            t[1] = v[k - 1];
            t[2] = v[k];
        }
    }
    return RIS_OK;
}

ris_result ris__tri_load_obj(const char *path, tri_mesh *out, ris_error *err)
{
    ris_mesh mesh;
    *out = (tri_mesh){0};
    ris_result result = ris_mesh_load_obj(path, &mesh, err);
    if (result == RIS_OK) {
        result = ris__tri_from_mesh(&mesh, path, out, err);
        ris_mesh_finish(&mesh);
    }
    return result;
}
