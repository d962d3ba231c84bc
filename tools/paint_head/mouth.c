/* Teeth, gums and tongue. The teeth run along u; v goes from the gum line (0) to the cutting edge (1). */
#include "paint.h"

#include <math.h>

static ris_vec3 texel_at(uint32_t i, uint32_t size)
{
    return vec3(((float)(i % size) + 0.5f) / (float)size, 1 - ((float)(i / size) + 0.5f) / (float)size, 0);
}

static void put(ris_paint_image *image, uint32_t i, const float color[3])
{
    for (int k = 0; k < 3; k++)
        image->rgb[3 * (size_t)i + (size_t)k] = ris_paint_encode(color[k]);
    image->covered[i] = 1;
}

ris_result ris_paint_teeth_image(uint32_t size, ris_paint_image *out, ris_error *err)
{
    const ris_result result = ris_paint_image_init(out, size, size, err);
    if (result)
        return result;
    const float ivory[3] = {0.60f, 0.535f, 0.415f}, root[3] = {0.52f, 0.40f, 0.25f},
                edge[3] = {0.47f, 0.475f, 0.45f};
    for (uint32_t i = 0; i < size * size; i++) {
        const ris_vec3 at = texel_at(i, size);
        const float cloud = ris_paint_fbm(vec3(at.x * 20, at.y * 4, 0), 3, 307);
        const float stripe = ris_paint_fbm(vec3(at.x * 120, at.y * 3, 0), 2, 311);
        const float low = ris_paint_step(0.45f, 0.0f, at.y + 0.1f * cloud),
                    high = ris_paint_step(0.78f, 1.0f, at.y + 0.08f * cloud);
        float color[3];
        for (int k = 0; k < 3; k++) {
            color[k] = ris_paint_mix(ris_paint_mix(ivory[k], root[k], 0.75f * low), edge[k], 0.6f * high);
            color[k] *= 1 + 0.04f * cloud + 0.03f * stripe;
        }
        put(out, i, color);
    }
    return RIS_OK;
}

ris_result ris_paint_gum_image(uint32_t size, ris_paint_image *out, ris_error *err)
{
    const ris_result result = ris_paint_image_init(out, size, size, err);
    if (result)
        return result;
    const float pink[3] = {0.43f, 0.165f, 0.145f}, pale[3] = {0.53f, 0.265f, 0.225f},
                red[3] = {0.33f, 0.085f, 0.075f};
    for (uint32_t i = 0; i < size * size; i++) {
        const ris_vec3 at = texel_at(i, size);
        const float cloud = ris_paint_fbm(vec3(at.x * 14, at.y * 6, 1), 3, 313);
        const float stipple = ris_paint_cells(vec3(at.x * 160, at.y * 60, 1), 317).near;
        const float vessel = 1 - 6 * fabsf(ris_paint_fbm(vec3(at.x * 18, at.y * 8, 2), 2, 331));
        float color[3];
        for (int k = 0; k < 3; k++) {
            color[k] = ris_paint_mix(pink[k], pale[k], ris_paint_clamp(0.4f + 0.7f * cloud, 0, 1));
            color[k] = ris_paint_mix(color[k], red[k], 0.4f * ris_paint_clamp(vessel, 0, 1));
            color[k] *= 0.95f + 0.08f * stipple;
        }
        put(out, i, color);
    }
    return RIS_OK;
}

ris_result ris_paint_tongue_image(uint32_t size, ris_paint_image *out, ris_error *err)
{
    const ris_result result = ris_paint_image_init(out, size, size, err);
    if (result)
        return result;
    const float pink[3] = {0.42f, 0.155f, 0.140f}, coat[3] = {0.55f, 0.32f, 0.275f},
                deep[3] = {0.26f, 0.060f, 0.060f};
    for (uint32_t i = 0; i < size * size; i++) {
        const ris_vec3 at = texel_at(i, size);
        const float cloud = ris_paint_fbm(vec3(at.x * 6, at.y * 6, 3), 4, 337);
        const ris_paint_cell papilla = ris_paint_cells(vec3(at.x * 62, at.y * 62, 3), 347);
        const float top = ris_paint_step(0.55f, 0.12f, papilla.near);
        const float bent = at.x - 0.5f + 0.012f * ris_paint_noise(vec3(at.y * 7, 0, 3), 349);
        const float groove = expf(-powf(bent / 0.022f, 2)) * ris_paint_step(0.02f, 0.2f, at.y) *
                             ris_paint_step(0.98f, 0.75f, at.y);
        const float middle = expf(-powf(bent / 0.26f, 2));
        const ris_paint_cell mushroom = ris_paint_cells(vec3(at.x * 17, at.y * 17, 4), 353);
        float color[3];
        for (int k = 0; k < 3; k++) {
            color[k] =
                ris_paint_mix(pink[k], coat[k],
                              ris_paint_clamp(0.55f * middle * (0.35f + 0.4f * top) + 0.18f * cloud, 0, 1));
            color[k] = ris_paint_mix(color[k], deep[k], 0.55f * groove + 0.22f * (1 - top) * 0.5f);
            color[k] = ris_paint_mix(
                color[k], deep[k],
                (mushroom.id & 3u) == 0 ? 0.35f * ris_paint_step(0.16f, 0.05f, mushroom.near) : 0);
            color[k] *= 1 + 0.08f * cloud;
        }
        put(out, i, color);
    }
    return RIS_OK;
}
