/* Meshes and buffers of the layers, and what is written into them every frame. */
#include "draw/draw_impl.h"

#include "draw/occlusion.h"
#include "draw/refine.h"
#include "model/vec3.h"

#include <stdlib.h>
#include <string.h>

/* Constant half of the layers on its way to the device. */
typedef struct layer_build {
    ris_refined bone[2];
    const ris_mesh *mesh[2];
    ris_draw_corner *corner; /* (vertex_count) */
    uint32_t *index;
} layer_build;

static void finish_build(layer_build *build)
{
    ris__refined_finish(&build->bone[0]);
    ris__refined_finish(&build->bone[1]);
    free(build->corner);
    free(build->index);
}

static ris_result count_all(ris_draw *draw, layer_build *build, ris_error *err)
{
    ris_draw_layers *layers = &draw->layers;
    const ris_head *head = draw->model->head;
    const ris_mesh *mesh[2] = {&head->skull, &head->mandible};
    ris_result result = RIS_OK;
    for (uint32_t i = 0; i < 2; ++i) {
        if (mesh[i]->vertex_count == 0) {
            continue;
        }
        ris_refined *bone = &build->bone[layers->bone_count];
        RIS_TRY(ris__refine(mesh[i], 0, bone, err));
        build->mesh[layers->bone_count] = mesh[i];
        layers->bone[layers->bone_count++] =
            (ris_layer_bone){i ? RIS_BONE_JAW : RIS_BONE_SKULL, layers->bone_index_count, bone->index_count};
        layers->bone_vertex_count += bone->vertex_count;
        layers->bone_index_count += bone->index_count;
    }
    RIS_TRY(ris__muscle_mesh_build(draw->model, &layers->muscles, err));
    RIS_TRY(ris__marks_build(draw->model, &layers->marks, err));
    layers->vertex_count =
        layers->bone_vertex_count + layers->muscles.vertex_count + layers->marks.vertex_count;
    layers->index_count = layers->bone_index_count + layers->muscles.index_count + layers->marks.index_count;
    layers->shown = calloc(draw->model->muscle_count + 1u, sizeof *layers->shown);
    layers->bone_index = calloc(layers->bone_index_count + 1u, sizeof *layers->bone_index);
    layers->node = calloc(draw->model->node_count + 1u, sizeof *layers->node);
    build->corner = calloc(layers->vertex_count + 1u, sizeof *build->corner);
    build->index = calloc(layers->index_count + 1u, sizeof *build->index);
    if (!layers->shown || !layers->bone_index || !layers->node || !build->corner || !build->index) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for the layers of the head");
    }
    memset(layers->shown, true, draw->model->muscle_count * sizeof *layers->shown);
fail:
    return result;
}

static ris_result create_buffers(ris_draw *draw, ris_error *err)
{
    ris_draw_layers *layers = &draw->layers;
    ris_device *device = draw->device;
    const VkBufferUsageFlags data = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    const VkDeviceSize vertices = (VkDeviceSize)layers->vertex_count + 1;
    ris_result result;
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_UPLOAD, vertices * 16, data, "layer positions",
                                 &layers->position, err));
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_UPLOAD, vertices * 16, data, "layer normals", &layers->normal,
                                 err));
    RIS_TRY(
        ris_vk_buffer_create(device, RIS_VK_UPLOAD, vertices * 16, data, "layer rest", &layers->rest, err));
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_UPLOAD, (VkDeviceSize)draw->scene.skin_count * 16, data,
                                 "layer strain", &layers->strain, err));
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_DEVICE, vertices * sizeof(ris_draw_corner), data,
                                 "layer corners", &layers->corner, err));
    RIS_TRY(ris_vk_buffer_create(device, RIS_VK_DEVICE, (VkDeviceSize)layers->index_count * 4 + 4,
                                 VK_BUFFER_USAGE_INDEX_BUFFER_BIT, "layer triangles", &layers->index, err));
    memset(layers->position.data, 0, (size_t)layers->position.size);
    memset(layers->normal.data, 0, (size_t)layers->normal.size);
    memset(layers->rest.data, 0, (size_t)layers->rest.size);
    ris_vec4 *strain = layers->strain.data;
    for (uint32_t i = 0; i < draw->scene.skin_count; i++) {
        strain[i] = draw->scene.rest[i];
        strain[i].w = fabsf(strain[i].w); /* negative in the mouth */
    }
fail:
    return result;
}

/* Bones: corners of the refined mesh become vertices of their own only where textures part them, and bones have none. */
static void add_bones(ris_draw_layers *layers, layer_build *build)
{
    ris_vec4 *position = layers->position.data, *normal = layers->normal.data;
    uint32_t vertex = 0, index = 0;
    for (uint32_t b = 0; b < layers->bone_count; ++b) {
        const ris_refined *bone = &build->bone[b];
        for (uint32_t i = 0; i < bone->index_count; ++i) {
            build->index[index++] = vertex + bone->corner[bone->index[i]].vertex;
        }
        for (uint32_t i = 0; i < bone->vertex_count; ++i) {
            ris_vec3 sum = {0};
            const ris_vec3 *at = build->mesh[b]->position;
            for (uint32_t k = bone->ring_start[i]; k < bone->ring_start[i + 1]; ++k) {
                sum = v3_add(sum, v3_cross(v3_sub(at[bone->ring[2 * (size_t)k]], at[i]),
                                           v3_sub(at[bone->ring[2 * (size_t)k + 1]], at[i])));
            }
            position[vertex + i] = v4_from(at[i], 1.0f);
            normal[vertex + i] = v4_from(v3_unit_or(sum, v3(0.0f, 0.0f, 1.0f)), 0.0f);
        }
        vertex += bone->vertex_count;
    }
    memcpy(layers->bone_index, build->index, layers->bone_index_count * sizeof *layers->bone_index);
}

static void add_muscles(const ris_draw *draw, layer_build *build)
{
    const ris_draw_layers *layers = &draw->layers;
    const ris_muscle_mesh *mesh = &layers->muscles;
    const uint32_t first = layers->bone_vertex_count;
    for (uint32_t i = 0; i < mesh->index_count; ++i) {
        build->index[layers->bone_index_count + i] = first + mesh->index[i];
    }
    for (uint32_t m = 0; m < draw->model->muscle_count; ++m) {
        const ris_muscle *muscle = &draw->model->muscle[m];
        const ris_muscle_body *body = &mesh->body[m];
        float length_mm = 0.0f;
        for (uint32_t i = 0; i + 1 < muscle->point_count; ++i) {
            length_mm +=
                draw->model->segment[draw->model->fiber[muscle->first_fiber].first_segment + i].size.x;
        }
        for (uint32_t v = body->first_vertex; v < body->first_vertex + body->row_count * body->ring_count;
             ++v) {
            /* no two muscles with the same strands */
            build->corner[first + v].u = mesh->across[v] + 7.3f * (float)m;
            build->corner[first + v].v = mesh->along[v] * length_mm;
        }
    }
}

static void add_marks(const ris_draw_layers *layers, layer_build *build)
{
    const uint32_t first = layers->bone_vertex_count + layers->muscles.vertex_count;
    uint32_t *to = build->index + layers->bone_index_count + layers->muscles.index_count;
    for (uint32_t i = 0; i < layers->marks.index_count; ++i) {
        to[i] = first + layers->marks.index[i];
    }
}

/* Openness at rest: bones among themselves, muscles among muscles and bones. */
static ris_result occlude(ris_draw *draw, const layer_build *build, ris_error *err)
{
    ris_draw_layers *layers = &draw->layers;
    const uint32_t bones = layers->bone_vertex_count, all = bones + layers->muscles.vertex_count;
    ris_vec3 *point = calloc(all + 1u, sizeof *point), *normal = calloc(all + 1u, sizeof *normal);
    float *share = calloc(all + 1u, sizeof *share);
    ris_vec4 *rest = layers->rest.data;
    const ris_vec4 *position = layers->position.data, *facing = layers->normal.data;
    ris_result result = RIS_OK;
    if (!point || !normal || !share) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for occlusion");
        goto fail;
    }
    for (uint32_t i = 0; i < all; ++i) {
        point[i] = v4_xyz(position[i]);
        normal[i] = v4_xyz(facing[i]);
    }
    ris_occluder occluder = {all, point, build->index, layers->bone_index_count};
    RIS_TRY(ris__occlusion(&occluder, 1, point, normal, bones, share, err));
    occluder.index_count += layers->muscles.index_count;
    RIS_TRY(ris__occlusion(&occluder, 1, point + bones, normal + bones, all - bones, share + bones, err));
    for (uint32_t i = 0; i < all; ++i) {
        rest[i] = v4_from(point[i], share[i]);
        if (i >= bones) {
            rest[i].x = 0.0f;
            rest[i].z = layers->muscles.tendon[i - bones];
        }
    }
fail:
    free(point);
    free(normal);
    free(share);
    return result;
}

ris_result ris__draw_layers_create(ris_draw *draw, ris_error *err)
{
    ris_draw_layers *layers = &draw->layers;
    layer_build build = {0};
    ris_result result = RIS_OK;
    if (layers->ready) {
        return RIS_OK;
    }
    RIS_TRY(count_all(draw, &build, err));
    RIS_TRY(create_buffers(draw, err));
    add_bones(layers, &build);
    add_muscles(draw, &build);
    add_marks(layers, &build);
    for (uint32_t i = 0; i < layers->vertex_count; ++i) {
        build.corner[i].vertex = i;
    }
    ris__muscle_mesh_place(&layers->muscles, NULL,
                           (ris_vec4 *)layers->position.data + layers->bone_vertex_count,
                           (ris_vec4 *)layers->normal.data + layers->bone_vertex_count);
    RIS_TRY(occlude(draw, &build, err));
    RIS_TRY(ris_vk_buffer_write(
        draw->device, &layers->corner, 0, build.corner,
        (VkDeviceSize)layers->vertex_count * sizeof *build.corner + sizeof *build.corner, err));
    RIS_TRY(ris_vk_buffer_write(draw->device, &layers->index, 0, build.index,
                                (VkDeviceSize)layers->index_count * 4 + 4, err));
    RIS_TRY(ris__draw_layer_pipes_create(draw, err));
    layers->ready = true;
fail:
    finish_build(&build);
    if (result != RIS_OK) {
        ris__draw_layers_finish(draw);
    }
    return result;
}

void ris__draw_layers_finish(ris_draw *draw)
{
    ris_draw_layers *layers = &draw->layers;
    ris_vk_buffer *all[] = {&layers->position, &layers->normal, &layers->rest,
                            &layers->strain,   &layers->corner, &layers->index};
    ris__draw_layer_pipes_finish(draw);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i) {
        ris_vk_buffer_finish(draw->device, all[i]);
    }
    ris__muscle_mesh_finish(&layers->muscles);
    ris__marks_finish(&layers->marks);
    free(layers->shown);
    free(layers->bone_index);
    free(layers->node);
    *layers = (ris_draw_layers){0};
}

/* Growth of the area around a node: triangles of the ring now over those at rest, less one. */
static float node_strain(const ris_model *model, const ris_vec4 *node, uint32_t i)
{
    float now = 0.0f, rest = 0.0f;
    for (uint32_t k = model->ring_start[i]; k < model->ring_start[i + 1]; ++k) {
        const uint32_t b = model->ring[k].b, c = model->ring[k].c;
        const ris_vec3 p = v4_xyz(node[i]), r = v4_xyz(model->rest_position[i]);
        now += v3_length(v3_cross(v3_sub(v4_xyz(node[b]), p), v3_sub(v4_xyz(node[c]), p)));
        rest += v3_length(
            v3_cross(v3_sub(v4_xyz(model->rest_position[b]), r), v3_sub(v4_xyz(model->rest_position[c]), r)));
    }
    return rest > 0.0f ? now / rest - 1.0f : 0.0f;
}

/* layers->node gives its w to the strain on the way. */
static void place_strain(ris_draw *draw)
{
    const ris_draw_scene *scene = &draw->scene;
    ris_vec4 *node = draw->layers.node, *strain = draw->layers.strain.data;
    for (uint32_t i = 0; i < draw->model->node_count; ++i) {
        node[i].w = node_strain(draw->model, node, i);
    }
    for (uint32_t v = 0; v < scene->skin_count; ++v) {
        float sum = 0.0f;
        for (uint32_t k = scene->term_start[v]; k < scene->term_start[v + 1]; ++k) {
            sum += scene->term[k].weight * node[scene->term[k].source].w;
        }
        strain[v].x = sum;
    }
}

/* The camera in the frame of the head, whose pose turns everything drawn. */
static ris_vec3 eye_of_head(const ris_sim *sim, const ris_camera *camera)
{
    float h[12];
    ris_sim_head_transform(sim, h);
    const ris_vec3 d = v3(camera->eye.x - h[3], camera->eye.y - h[7], camera->eye.z - h[11]);
    return v3(h[0] * d.x + h[4] * d.y + h[8] * d.z, h[1] * d.x + h[5] * d.y + h[9] * d.z,
              h[2] * d.x + h[6] * d.y + h[10] * d.z);
}

ris_result ris__draw_layers_update(ris_draw *draw, ris_sim *sim, const ris_vec4 *node,
                                   const ris_camera *camera, ris_error *err)
{
    ris_draw_layers *layers = &draw->layers;
    const ris_model *model = draw->model;
    const uint32_t bones = layers->bone_vertex_count, marks = bones + layers->muscles.vertex_count;
    ris_vec4 *position = layers->position.data, *rest = layers->rest.data;
    ris_result result = RIS_OK;
    if (node != NULL) {
        memcpy(layers->node, node, model->node_count * sizeof *node);
    } else if (draw->shown & (RIS_LAYER_SPRINGS | RIS_LAYER_LANDMARKS | RIS_LAYER_STRAIN)) {
        RIS_TRY(ris_sim_read(sim, RIS_STATE_POSITION, layers->node, err));
    }
    if (draw->shown & RIS_LAYER_MUSCLES) {
        ris__muscle_mesh_place(&layers->muscles, sim, position + bones,
                               (ris_vec4 *)layers->normal.data + bones);
        for (uint32_t m = 0; m < model->muscle_count; ++m) {
            const ris_muscle_body *body = &layers->muscles.body[m];
            const float activation = ris_sim_activation(sim, m);
            for (uint32_t v = 0; v < body->row_count * body->ring_count; ++v) {
                rest[bones + body->first_vertex + v].x = activation;
            }
        }
    }
    if (draw->shown & (RIS_LAYER_SPRINGS | RIS_LAYER_LANDMARKS)) {
        ris__marks_place(&layers->marks, sim, layers->node, draw->shown, eye_of_head(sim, camera),
                         position + marks, rest + marks);
    }
    if (draw->shown & RIS_LAYER_STRAIN) {
        place_strain(draw);
    }
    RIS_TRY(ris_vk_buffer_flush(draw->device, &layers->position, err));
    RIS_TRY(ris_vk_buffer_flush(draw->device, &layers->normal, err));
    RIS_TRY(ris_vk_buffer_flush(draw->device, &layers->rest, err));
    RIS_TRY(ris_vk_buffer_flush(draw->device, &layers->strain, err));
fail:
    return result;
}
