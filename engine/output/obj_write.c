/* OBJ writer (`risorius export`): vertex order, quads and UVs of the source mesh are kept, "%.6f" mm. */
#include "risorius/output.h"

#include "base/file.h"

static ris_result write_vertices(ris_output_file *file, const ris_obj_object *object, ris_error *err)
{
    const ris_mesh *mesh = object->mesh;
    ris_result result = RIS_OK;
    for (uint32_t i = 0; i < mesh->vertex_count && result == RIS_OK; i++) {
        ris_vec4 p = object->position[i];
        result = ris__output_printf(file, err, "v %.6f %.6f %.6f\n", (double)p.x, (double)p.y, (double)p.z);
    }
    for (uint32_t i = 0; i < mesh->uv_count && result == RIS_OK; i++) {
        result = ris__output_printf(file, err, "vt %.6f %.6f\n", (double)mesh->uv[2 * i],
                                    (double)mesh->uv[2 * i + 1]);
    }
    return result;
}

/* bases: how many vertices and UVs the objects before this one have; OBJ counts from 1 over the whole file. */
static ris_result write_faces(ris_output_file *file, const ris_mesh *mesh, uint32_t vertex_base,
                              uint32_t uv_base, ris_error *err)
{
    ris_result result = RIS_OK;
    for (uint32_t f = 0; f < mesh->face_count && result == RIS_OK; f++) {
        result = ris__output_printf(file, err, "f");
        for (uint32_t c = mesh->face_start[f]; c < mesh->face_start[f + 1] && result == RIS_OK; c++) {
            unsigned vertex = (unsigned)(mesh->face_vertex[c] + vertex_base + 1);
            if (mesh->face_uv != NULL && mesh->face_uv[c] != UINT32_MAX) {
                result = ris__output_printf(file, err, " %u/%u", vertex,
                                            (unsigned)(mesh->face_uv[c] + uv_base + 1));
            } else {
                result = ris__output_printf(file, err, " %u", vertex);
            }
        }
        if (result == RIS_OK) {
            result = ris__output_printf(file, err, "\n");
        }
    }
    return result;
}

ris_result ris_obj_write(const char *path, const ris_obj_object *object, uint32_t object_count,
                         ris_error *err)
{
    ris_output_file file = {0};
    uint32_t vertex_base = 0, uv_base = 0;
    ris_result result = ris__output_open(&file, path, err);
    if (result == RIS_OK) {
        result = ris__output_printf(&file, err, "# risorius %s, mm, y up, z out of the face\n",
                                    RIS_VERSION_STRING);
    }
    for (uint32_t i = 0; i < object_count && result == RIS_OK; i++) {
        result = ris__output_printf(&file, err, "o %s\n", object[i].name);
        if (result == RIS_OK) {
            result = write_vertices(&file, &object[i], err);
        }
        if (result == RIS_OK) {
            result = write_faces(&file, object[i].mesh, vertex_base, uv_base, err);
        }
        vertex_base += object[i].mesh->vertex_count;
        uv_base += object[i].mesh->uv_count;
    }
    if (result == RIS_OK) {
        result = ris__output_commit(&file, err);
    }
    ris__output_discard(&file);
    return result;
}
