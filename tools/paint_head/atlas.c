/* Rasterises the mesh in UV space and paints every texel from its place in 3D; spreads the colour beyond
 * the seams, so that filtering does not pull the background in. */
#include "paint.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SPREAD_TEXELS 16

static float blend(const float *field, const uint32_t *t, const float w[3])
{
    return field[t[0]] * w[0] + field[t[1]] * w[1] + field[t[2]] * w[2];
}

static ris_vec3 blend3(const ris_vec3 *field, const uint32_t *t, const float w[3])
{
    return vec3_add(vec3_scale(field[t[0]], w[0]),
                    vec3_add(vec3_scale(field[t[1]], w[1]), vec3_scale(field[t[2]], w[2])));
}

/* How densely the hairs of a brow stand over a place, 0..1: their shade, and the short hairs between them. */
static float brow_at(const ris_paint_surface *surface, ris_vec3 p)
{
    const float reach = 5.0f, kernel = 1.5f, half_dense = 24.0f;
    const ris_vec3 low = surface->brow_low, high = surface->brow_high;
    if (p.x < low.x - reach || p.x > high.x + reach || p.y < low.y - reach || p.y > high.y + reach ||
        p.z < low.z - reach || p.z > high.z + reach)
        return 0;
    float sum = 0;
    for (uint32_t i = 0; i < surface->brow_count; i++) {
        const ris_vec3 d = vec3_sub(p, surface->brow[i]);
        const float square = vec3_dot(d, d);
        if (square < reach * reach)
            sum += expf(-square / (kernel * kernel));
    }
    return 1 - expf(-sum / half_dense);
}

static uint8_t linear_byte(float value)
{
    return (uint8_t)(255 * ris_paint_clamp(value, 0, 1) + 0.5f);
}

static void paint_texel(const ris_paint_surface *surface, uint32_t triangle, const float w[3],
                        ris_paint_skin_images *images, size_t at)
{
    const uint32_t *t = &surface->triangle[3 * triangle];
    ris_paint_site site = {.shell = surface->shell[triangle]};
    site.p = blend3(surface->mesh->position, t, w);
    site.n = ris_paint_unit(blend3(surface->normal, t, w));
    site.lip = blend(surface->lip_ring, t, w);
    site.lid = blend(surface->lid_ring, t, w);
    site.curvature = blend(surface->curvature, t, w);
    site.occlusion = blend(surface->occlusion, t, w);
    site.thinness = blend(surface->thinness, t, w);
    site.brow = brow_at(surface, site.p);
    const ris_paint_texel texel = ris_paint_skin(surface, &site);
    for (int k = 0; k < 3; k++) {
        images->color.rgb[3 * at + (size_t)k] = ris_paint_encode(texel.color[k]);
        images->detail.rgb[3 * at + (size_t)k] = linear_byte(texel.detail[k]);
        images->wrinkles.rgb[3 * at + (size_t)k] = linear_byte(texel.wrinkle);
    }
}

static void paint_triangle(const ris_paint_surface *surface, uint32_t triangle, ris_paint_skin_images *images)
{
    const float size = (float)images->color.width;
    float x[3], y[3];
    for (int k = 0; k < 3; k++) {
        const float *uv = &surface->mesh->uv[2 * surface->triangle_uv[3 * triangle + (uint32_t)k]];
        x[k] = uv[0] * size;
        y[k] = (1 - uv[1]) * size;
    }
    const float area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if (area == 0)
        return;
    const float left = fminf(x[0], fminf(x[1], x[2])), right = fmaxf(x[0], fmaxf(x[1], x[2]));
    const float top = fminf(y[0], fminf(y[1], y[2])), bottom = fmaxf(y[0], fmaxf(y[1], y[2]));
    const int32_t x0 = (int32_t)fmaxf(0, floorf(left)), x1 = (int32_t)fminf(size - 1, ceilf(right));
    const int32_t y0 = (int32_t)fmaxf(0, floorf(top)), y1 = (int32_t)fminf(size - 1, ceilf(bottom));
    const float slack = -1e-4f;
    for (int32_t j = y0; j <= y1; j++) {
        for (int32_t i = x0; i <= x1; i++) {
            const float px = (float)i + 0.5f, py = (float)j + 0.5f;
            float w[3];
            w[0] = ((x[1] - px) * (y[2] - py) - (x[2] - px) * (y[1] - py)) / area;
            w[1] = ((x[2] - px) * (y[0] - py) - (x[0] - px) * (y[2] - py)) / area;
            w[2] = 1 - w[0] - w[1];
            const size_t at = (size_t)j * images->color.width + (size_t)i;
            if (w[0] < slack || w[1] < slack || w[2] < slack || images->color.covered[at])
                continue;
            images->color.covered[at] = images->detail.covered[at] = images->wrinkles.covered[at] = 1;
            paint_texel(surface, triangle, w, images, at);
        }
    }
}

/* Mean of the painted neighbours of an unpainted texel; false if it has none. */
static bool gather(const ris_paint_image *image, uint32_t x, uint32_t y, uint8_t out[3])
{
    uint32_t sum[3] = {0}, count = 0;
    for (uint32_t k = 0; k < 9; k++) {
        const uint32_t nx = x + k % 3 - 1, ny = y + k / 3 - 1;
        if (nx >= image->width || ny >= image->height ||
            image->covered[(size_t)ny * image->width + nx] % 3 == 0)
            continue;
        const uint8_t *rgb = &image->rgb[3 * ((size_t)ny * image->width + nx)];
        for (int c = 0; c < 3; c++)
            sum[c] += rgb[c];
        count++;
    }
    for (int c = 0; c < 3 && count; c++)
        out[c] = (uint8_t)((sum[c] + count / 2) / count);
    return count > 0;
}

/* Grows the painted area by whole texels and fills the rest with the mean colour. */
static void spread(ris_paint_image *image)
{
    uint64_t sum[3] = {0}, count = 0;
    const size_t texels = (size_t)image->width * image->height;
    for (size_t i = 0; i < texels; i++) {
        for (int c = 0; c < 3 && image->covered[i]; c++)
            sum[c] += image->rgb[3 * i + (size_t)c];
        count += image->covered[i] ? 1 : 0;
    }
    for (int pass = 0; pass < SPREAD_TEXELS; pass++) {
        for (uint32_t y = 0; y < image->height; y++)
            for (uint32_t x = 0; x < image->width; x++) {
                const size_t at = (size_t)y * image->width + x;
                /* 3 marks texels of this pass, so that they do not feed each other */
                if (!image->covered[at] && gather(image, x, y, &image->rgb[3 * at]))
                    image->covered[at] = 3;
            }
        for (size_t i = 0; i < texels; i++)
            image->covered[i] = image->covered[i] == 3 ? 2 : image->covered[i];
    }
    for (size_t i = 0; i < texels && count; i++)
        for (int c = 0; c < 3 && !image->covered[i]; c++)
            image->rgb[3 * i + (size_t)c] = (uint8_t)(sum[c] / count);
}

void ris_paint_skin_images_finish(ris_paint_skin_images *images)
{
    ris_paint_image_finish(&images->color);
    ris_paint_image_finish(&images->detail);
    ris_paint_image_finish(&images->wrinkles);
}

ris_result ris_paint_atlas(const ris_paint_surface *surface, uint32_t size, ris_paint_skin_images *out,
                           ris_error *err)
{
    *out = (ris_paint_skin_images){0};
    ris_paint_image *const all[] = {&out->color, &out->detail, &out->wrinkles};
    ris_result result = RIS_OK;
    for (int k = 0; k < 3 && !result; k++)
        result = ris_paint_image_init(all[k], size, size, err);
    if (result) {
        ris_paint_skin_images_finish(out);
        return result;
    }
    for (uint32_t i = 0; i < surface->triangle_count; i++)
        paint_triangle(surface, i, out);
    for (int k = 0; k < 3; k++)
        spread(all[k]);
    return RIS_OK;
}
