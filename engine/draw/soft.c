/* Parts that change their shape on the host (KA-06: the tongue): their vertices go into the surface with the frame's
 * commands. */
#include "draw/draw_impl.h"

#include "model/vec3.h"

#include <stdlib.h>
#include <string.h>

#define UPDATE_MOST 65536u /* bytes of one vkCmdUpdateBuffer */

void ris__soft_normals(const ris_mesh *mesh, const ris_vec4 *position, ris_vec4 *normal)
{
    memset(normal, 0, mesh->vertex_count * sizeof *normal);
    for (uint32_t f = 0; f < mesh->face_count; ++f) {
        const uint32_t first = mesh->face_start[f], end = mesh->face_start[f + 1];
        const ris_vec3 a = v4_xyz(position[mesh->face_vertex[first]]);
        ris_vec3 sum = {0};
        for (uint32_t c = first + 1; c + 1 < end; ++c) {
            const ris_vec3 b = v4_xyz(position[mesh->face_vertex[c]]),
                           d = v4_xyz(position[mesh->face_vertex[c + 1]]);
            sum = v3_add(sum, v3_cross(v3_sub(b, a), v3_sub(d, a)));
        }
        for (uint32_t c = first; c < end; ++c) {
            ris_vec4 *n = &normal[mesh->face_vertex[c]];
            *n = v4_from(v3_add(v4_xyz(*n), sum), 0.0f);
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; ++v) {
        normal[v] = v4_from(v3_unit_or(v4_xyz(normal[v]), v3(0.0f, 0.0f, 1.0f)), 0.0f);
    }
}

static void update(VkCommandBuffer cmd, const ris_vk_buffer *buffer, uint32_t first, const ris_vec4 *data,
                   uint32_t count)
{
    const uint32_t most = UPDATE_MOST / (uint32_t)sizeof *data;
    for (uint32_t done = 0; done < count; done += most) {
        const uint32_t now = count - done < most ? count - done : most;
        vkCmdUpdateBuffer(cmd, buffer->handle, ((VkDeviceSize)first + done) * sizeof *data,
                          now * sizeof *data, data + done);
    }
}

ris_result ris__draw_soft_record(ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim, ris_error *err)
{
    const ris_head *head = draw->model->head;
    for (uint32_t i = 0; i < draw->scene.item_count; ++i) {
        const ris_draw_item *item = &draw->scene.item[i];
        if (item->part == UINT32_MAX || head->part[item->part].material != RIS_MATERIAL_TONGUE) {
            continue;
        }
        const ris_mesh *mesh = &head->part[item->part].mesh;
        ris_vec4 *at = calloc(2 * (size_t)mesh->vertex_count, sizeof *at);
        if (at == NULL) {
            return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for part \"%s\"",
                            head->part[item->part].name);
        }
        if (ris_sim_part_shape(sim, item->part, at)) {
            ris__soft_normals(mesh, at, at + mesh->vertex_count);
            update(cmd, &draw->store.position, item->first_vertex, at, mesh->vertex_count);
            update(cmd, &draw->store.normal, item->first_vertex, at + mesh->vertex_count, mesh->vertex_count);
        }
        free(at);
    }
    return RIS_OK;
}
