/* The picture with layers: bones, eyes and muscles opaque, then what is on the skin's inside, then the skin as glass or
 * by its strain, brows and lashes, springs and landmarks of the skin. */
#include "draw/draw_impl.h"

#define GLASS 0.28f /* how much of what lies behind it the skin hides where it is seen face on */

static const ris_vec3 bone_tint = {0.60f, 0.52f, 0.39f};

bool ris__draw_is_plain(const ris_draw *draw)
{
    return draw->shown == RIS_LAYER_SKIN;
}

static bool is_tooth(const ris_draw_item *item)
{
    return item->material == RIS_MATERIAL_TEETH;
}

static bool is_soft_mouth(const ris_draw_item *item)
{
    return item->material == RIS_MATERIAL_GUM || item->material == RIS_MATERIAL_TONGUE;
}

static void bind(const ris_draw *draw, VkCommandBuffer cmd, VkPipeline pipe, VkBuffer index)
{
    (void)draw;
    vkCmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipe);
    vkCmdBindIndexBuffer(cmd, index, 0, VK_INDEX_TYPE_UINT32);
}

static void draw_bones(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    const ris_draw_layers *layers = &draw->layers;
    for (uint32_t i = 0; i < layers->bone_count; i++) {
        if (draw->jawless && layers->bone[i].bone == RIS_BONE_JAW) {
            continue;
        }
        const ris_draw_item item = {.bone = layers->bone[i].bone,
                                    .first_index = layers->bone[i].first_index,
                                    .index_count = layers->bone[i].index_count,
                                    .tint = bone_tint,
                                    .texture = UINT32_MAX};
        ris__draw_object(draw, cmd, sim, &item, layers->set.set[0]);
    }
}

/* Runs of muscles that are shown, each one draw. */
static void draw_muscles(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    const ris_draw_layers *layers = &draw->layers;
    const uint32_t count = draw->model->muscle_count;
    for (uint32_t m = 0; m < count; m++) {
        if (!layers->shown[m]) {
            continue;
        }
        ris_draw_item item = {.bone = RIS_BONE_SKULL,
                              .first_index = layers->bone_index_count + layers->muscles.body[m].first_index,
                              .texture = UINT32_MAX};
        for (; m < count && layers->shown[m]; m++) {
            item.index_count += layers->muscles.body[m].index_count;
        }
        ris__draw_object(draw, cmd, sim, &item, layers->set.set[0]);
    }
}

static void draw_marks(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim, uint32_t first,
                       uint32_t count)
{
    const ris_draw_layers *layers = &draw->layers;
    const ris_draw_item item = {.bone = RIS_BONE_SKULL,
                                .first_index = layers->bone_index_count + layers->muscles.index_count + first,
                                .index_count = count,
                                .texture = UINT32_MAX};
    bind(draw, cmd, layers->pipe[RIS_LAYER_PIPE_FLAT], layers->index.handle);
    ris__draw_object(draw, cmd, sim, &item, layers->set.set[0]);
}

/* Parts of the scene that wanted() picks, with one pipeline. */
static void draw_parts(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim, VkPipeline pipe,
                       bool (*wanted)(const ris_draw_item *))
{
    bind(draw, cmd, pipe, draw->store.index.handle);
    for (uint32_t i = 0; i < draw->scene.item_count; i++) {
        const ris_draw_item *item = &draw->scene.item[i];
        if (wanted(item) && !(draw->jawless && is_tooth(item) && item->bone == RIS_BONE_JAW)) {
            ris__draw_object(draw, cmd, sim, item, ris__draw_set_of(draw, item));
        }
    }
}

static bool is_eye(const ris_draw_item *item)
{
    return item->material == RIS_MATERIAL_EYE;
}

static bool is_cornea(const ris_draw_item *item)
{
    return item->material == RIS_MATERIAL_CORNEA;
}

static bool is_hair(const ris_draw_item *item)
{
    return item->material == RIS_MATERIAL_HAIR;
}

/* The skin, opaque when nothing lies behind it that is to be seen. */
static void draw_skin(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    const ris_draw_layers *layers = &draw->layers;
    const bool strain = (draw->shown & RIS_LAYER_STRAIN) != 0, glass = (draw->shown & RIS_LAYER_INNER) != 0;
    ris_draw_item skin = draw->scene.item[0];
    skin.pivot.x = glass ? GLASS : 1.0f;
    const VkDescriptorSet set = strain ? layers->strain_set.set[0] : ris__draw_set_of(draw, &skin);
    if (glass || strain) {
        bind(draw, cmd, layers->pipe[RIS_LAYER_PIPE_DEPTH], draw->store.index.handle);
        ris__draw_object(draw, cmd, sim, &skin, set);
    }
    bind(draw, cmd,
         strain ? layers->pipe[RIS_LAYER_PIPE_STRAIN]
                : (glass ? layers->pipe[RIS_LAYER_PIPE_CLEAR] : draw->pipe[RIS_DRAW_PIPE_SKIN]),
         draw->store.index.handle);
    ris__draw_object(draw, cmd, sim, &skin, set);
}

void ris__draw_layer_shadow(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    vkCmdBindIndexBuffer(cmd, draw->layers.index.handle, 0, VK_INDEX_TYPE_UINT32);
    if (draw->shown & RIS_LAYER_SKULL) {
        draw_bones(draw, cmd, sim);
    }
    if (draw->shown & RIS_LAYER_MUSCLES) {
        draw_muscles(draw, cmd, sim);
    }
}

void ris__draw_layer_picture(const ris_draw *draw, VkCommandBuffer cmd, const ris_sim *sim)
{
    const ris_draw_layers *layers = &draw->layers;
    const ris_marks *marks = &layers->marks;
    const uint32_t shown = draw->shown;
    const bool skin = (shown & (RIS_LAYER_SKIN | RIS_LAYER_STRAIN)) != 0;
    if (shown & RIS_LAYER_SKULL) {
        bind(draw, cmd, layers->pipe[RIS_LAYER_PIPE_BONE], layers->index.handle);
        draw_bones(draw, cmd, sim);
        draw_parts(draw, cmd, sim, layers->pipe[RIS_LAYER_PIPE_BONE], is_tooth);
    } else if (skin) {
        draw_parts(draw, cmd, sim, draw->pipe[RIS_DRAW_PIPE_MOUTH], is_tooth);
    }
    draw_parts(draw, cmd, sim, draw->pipe[RIS_DRAW_PIPE_EYE], is_eye);
    if (skin) {
        draw_parts(draw, cmd, sim, draw->pipe[RIS_DRAW_PIPE_MOUTH], is_soft_mouth);
    }
    if (shown & RIS_LAYER_MUSCLES) {
        bind(draw, cmd, layers->pipe[RIS_LAYER_PIPE_MUSCLE], layers->index.handle);
        draw_muscles(draw, cmd, sim);
    }
    if (shown & RIS_LAYER_LANDMARKS) {
        draw_marks(draw, cmd, sim, 0, marks->bone_index_count);
    }
    draw_parts(draw, cmd, sim, draw->pipe[RIS_DRAW_PIPE_CORNEA], is_cornea);
    if (skin) {
        draw_skin(draw, cmd, sim);
    }
    if (shown & RIS_LAYER_SKIN) {
        draw_parts(draw, cmd, sim, draw->pipe[RIS_DRAW_PIPE_HAIR], is_hair);
    }
    if (shown & RIS_LAYER_SPRINGS) {
        draw_marks(draw, cmd, sim, marks->bone_index_count, marks->spring_index_count);
    }
    if (shown & RIS_LAYER_LANDMARKS) {
        draw_marks(draw, cmd, sim, marks->bone_index_count + marks->spring_index_count,
                   marks->skin_index_count);
    }
}
