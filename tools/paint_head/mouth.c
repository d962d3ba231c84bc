/* Teeth, gums and tongue. Teeth and gums run along u from the subject's right to the left; the teeth's v
 * goes from the gum line (0) to the cutting edge (1). */
#include "paint.h"

#include <math.h>

static ris_vec3 texel_at(uint32_t i, uint32_t size)
{
    const uint32_t column = i % size, row = i / size;
    return vec3(((float)column + 0.5f) / (float)size, 1 - ((float)row + 0.5f) / (float)size, 0);
}

static void put(ris_paint_image *image, uint32_t i, const float color[3])
{
    for (int k = 0; k < 3; k++)
        image->rgb[3 * (size_t)i + (size_t)k] = ris_paint_encode(color[k]);
    image->covered[i] = 1;
}

/* Sixteen crowns side by side, eight a side of u = 0.5. */
ris_result ris_paint_teeth_image(uint32_t size, ris_paint_image *out, ris_error *err)
{
    const ris_result result = ris_paint_image_init(out, size, size, err);
    if (result)
        return result;
    const float ivory[3] = {0.50f, 0.445f, 0.345f}, root[3] = {0.42f, 0.325f, 0.205f},
                edge[3] = {0.37f, 0.38f, 0.365f};
    for (uint32_t i = 0; i < size * size; i++) {
        const ris_vec3 at = texel_at(i, size);
        const float slot = at.x * 16, middle = fabsf(at.x - 0.5f) * 16; /* crowns from the midline */
        const int32_t tooth = (int32_t)floorf(slot);
        const float own = (float)(ris_paint_hash(tooth, 0, 0, 305) & 255u) / 255.0f - 0.5f;
        const float canine = middle > 2 && middle < 3 ? 1 : 0;
        const float cloud = ris_paint_fbm(vec3(at.x * 28, at.y * 4, 0), 3, 307);
        const float stripe = ris_paint_fbm(vec3(at.x * 130, at.y * 3, 0), 2, 311);
        const float side = fabsf(slot - (float)tooth - 0.5f) * 2; /* 1 where two crowns meet */
        const float low = ris_paint_step(0.5f, 0.0f, at.y + 0.1f * cloud) + 0.30f * canine + 0.35f * own;
        const float high = ris_paint_step(0.76f, 1.0f, at.y + 0.06f * cloud) * (middle < 3 ? 1 : 0.3f);
        const float deep =
            1 - 0.45f * ris_paint_step(2.0f, 7.0f, middle); /* back teeth lie in the shade of the cheeks */
        const float gap =
            1 - 0.45f * ris_paint_step(0.78f, 1.0f, side) - 0.35f * ris_paint_step(0.10f, 0.0f, at.y);
        float color[3];
        for (int k = 0; k < 3; k++) {
            color[k] = ris_paint_mix(ivory[k], root[k], ris_paint_clamp(0.8f * low, 0, 1));
            color[k] = ris_paint_mix(color[k], edge[k], 0.6f * high);
            color[k] *= (1 + 0.04f * cloud + 0.03f * stripe) * deep * gap;
        }
        put(out, i, color);
    }
    return RIS_OK;
}

/* v: outer fold (0), margin at the teeth (0.5), inside (1). */
ris_result ris_paint_gum_image(uint32_t size, ris_paint_image *out, ris_error *err)
{
    const ris_result result = ris_paint_image_init(out, size, size, err);
    if (result)
        return result;
    const float pink[3] = {0.39f, 0.150f, 0.130f}, pale[3] = {0.47f, 0.235f, 0.200f},
                red[3] = {0.28f, 0.072f, 0.064f};
    for (uint32_t i = 0; i < size * size; i++) {
        const ris_vec3 at = texel_at(i, size);
        const float cloud = ris_paint_fbm(vec3(at.x * 16, at.y * 6, 1), 3, 313);
        const float stipple = ris_paint_cells(vec3(at.x * 110, at.y * 34, 1), 317).near;
        const float vessel = 1 - 6 * fabsf(ris_paint_fbm(vec3(at.x * 20, at.y * 7, 2), 2, 331));
        const float margin = fabsf(at.y - 0.5f); /* firm pale gum by the teeth, red moving lining beyond */
        const float loose = ris_paint_step(0.16f, 0.40f, margin);
        const float deep = 1 - 0.45f * ris_paint_step(0.2f, 0.47f, fabsf(at.x - 0.5f));
        float color[3];
        for (int k = 0; k < 3; k++) {
            color[k] =
                ris_paint_mix(pink[k], pale[k], ris_paint_clamp(0.45f + 0.6f * cloud, 0, 1) * (1 - loose));
            color[k] = ris_paint_mix(color[k], red[k],
                                     0.45f * loose + 0.35f * loose * ris_paint_clamp(vessel, 0, 1));
            color[k] = ris_paint_mix(color[k], red[k], 0.45f * ris_paint_step(0.05f, 0.0f, margin));
            color[k] *= (0.95f + 0.08f * stipple * (1 - loose)) * deep;
        }
        put(out, i, color);
    }
    return RIS_OK;
}

/* Seen from above: u across, v from the root (0) to the tip (1). */
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
            color[k] *= (1 + 0.08f * cloud) * ris_paint_mix(0.45f, 1, ris_paint_step(0.1f, 0.75f, at.y));
        }
        put(out, i, color);
    }
    return RIS_OK;
}
