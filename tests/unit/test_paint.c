/* The texture painter on the reference head: same bytes every time, colours in the order of real faces, no
 * texel of a UV island left out, refusals. */
#include "paint.h"

#include "scratch.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIZE 256u

typedef struct fixture {
    ris_mesh mesh;
    ris_paint_surface surface;
    ris_paint_skin_images images;
} fixture;

static void paint(fixture *f)
{
    ris_error err = {0};
    *f = (fixture){0};
    assert_int_equal(ris_mesh_load_obj(RIS_SOURCE_DIR "/assets/human/skin.obj", &f->mesh, &err), RIS_OK);
    assert_int_equal(ris_paint_surface_init(&f->surface, &f->mesh, NULL, 0, NULL, 0, &err), RIS_OK);
    assert_int_equal(ris_paint_atlas(&f->surface, SIZE, &f->images, &err), RIS_OK);
}

static void finish(fixture *f)
{
    ris_paint_skin_images_finish(&f->images);
    ris_paint_surface_finish(&f->surface);
    ris_mesh_finish(&f->mesh);
}

static int set_up(void **state)
{
    fixture *f = malloc(sizeof *f);
    assert_non_null(f);
    paint(f);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    finish(*state);
    free(*state);
    return 0;
}

static void test_same_bytes_twice(void **state)
{
    const fixture *f = *state;
    fixture again;
    paint(&again);
    const size_t bytes = (size_t)SIZE * SIZE * 3;
    assert_memory_equal(f->images.color.rgb, again.images.color.rgb, bytes);
    assert_memory_equal(f->images.detail.rgb, again.images.detail.rgb, bytes);
    assert_memory_equal(f->images.wrinkles.rgb, again.images.wrinkles.rgb, bytes);
    /* control: the two maps are not the same picture, so equality means something */
    assert_memory_not_equal(f->images.color.rgb, f->images.detail.rgb, bytes);
    finish(&again);
}

/* Texels whose centre lies inside a triangle but which no triangle painted. */
static uint32_t count_holes(const fixture *f)
{
    uint32_t holes = 0;
    for (uint32_t i = 0; i < f->surface.triangle_count; i++) {
        float x[3], y[3];
        for (uint32_t k = 0; k < 3; k++) {
            const float *uv = &f->mesh.uv[2 * f->surface.triangle_uv[3 * i + k]];
            x[k] = uv[0] * SIZE;
            y[k] = (1 - uv[1]) * SIZE;
        }
        const float left = fminf(x[0], fminf(x[1], x[2])), right = fmaxf(x[0], fmaxf(x[1], x[2]));
        const float top = fminf(y[0], fminf(y[1], y[2])), bottom = fmaxf(y[0], fmaxf(y[1], y[2]));
        for (uint32_t row = (uint32_t)top; (float)row <= bottom && row < SIZE; row++) {
            for (uint32_t column = (uint32_t)left; (float)column <= right && column < SIZE; column++) {
                int inside = 0;
                for (int k = 0; k < 3; k++) {
                    const int n = (k + 1) % 3;
                    const float side = (x[n] - x[k]) * ((float)row + 0.5f - y[k]) -
                                       (y[n] - y[k]) * ((float)column + 0.5f - x[k]);
                    inside += side > 0 ? 1 : side < 0 ? -1 : 0;
                }
                holes += abs(inside) == 3 && f->images.color.covered[row * SIZE + column] != 1 ? 1 : 0;
            }
        }
    }
    return holes;
}

static void test_islands_are_full(void **state)
{
    fixture *f = *state;
    uint32_t painted = 0, spread = 0, middle = 0;
    for (uint32_t i = 0; i < SIZE * SIZE; i++) {
        painted += f->images.color.covered[i] == 1 ? 1 : 0;
        spread += f->images.color.covered[i] == 2 ? 1 : 0;
    }
    assert_in_range(painted, SIZE * SIZE / 10, SIZE * SIZE);
    assert_true(spread > 500); /* colour goes on beyond the seams */
    assert_int_equal(count_holes(f), 0);
    /* control: a texel taken away well inside an island is noticed */
    for (uint32_t i = SIZE + 1; i + SIZE + 1 < SIZE * SIZE && !middle; i++)
        if (f->images.color.covered[i] == 1 && f->images.color.covered[i - 1] == 1 &&
            f->images.color.covered[i + 1] == 1 && f->images.color.covered[i - SIZE] == 1 &&
            f->images.color.covered[i + SIZE] == 1)
            middle = i;
    assert_true(middle > 0);
    f->images.color.covered[middle] = 0;
    assert_true(count_holes(f) > 0);
    f->images.color.covered[middle] = 1;
}

/* Height of squeezed skin at a place on the front of the face. */
static float wrinkle_at(const fixture *f, float x, float y)
{
    ris_paint_site site = {
        .shell = RIS_SHELL_FACE, .lip = RIS_PAINT_RING_MAX, .lid = RIS_PAINT_RING_MAX, .occlusion = 1};
    site.p = (ris_vec3){x, y, -1000};
    for (uint32_t i = 0; i < f->mesh.vertex_count; i++) {
        const ris_vec3 v = f->mesh.position[i];
        if (fabsf(v.x - x) < 8 && fabsf(v.y - y) < 8 && v.z > site.p.z)
            site.p.z = v.z;
    }
    const ris_paint_zones zones = ris_paint_find_zones(&f->surface, &site);
    return ris_paint_wrinkles(&f->surface, &site, &zones);
}

/* Furrows down a column of the forehead, none above the hairline or in the mouth. */
static void test_wrinkles(void **state)
{
    const fixture *f = *state;
    uint32_t furrows = 0;
    float before = RIS_PAINT_SMOOTH;
    for (float y = 45; y < 80; y += 0.5f) {
        const float h = wrinkle_at(f, 20, y);
        assert_true(h >= 0 && h <= 1);
        furrows += h < 0.45f && before >= 0.45f;
        before = h;
    }
    assert_in_range(furrows, 3, 5);
    for (float x = -30; x < 30; x += 0.5f)
        assert_true(fabsf(wrinkle_at(f, x, 112) - RIS_PAINT_SMOOTH) < 0.02f);
    const ris_paint_site mouth = {.shell = RIS_SHELL_MOUTH, .p = {20, 57, 80}};
    const ris_paint_zones zones = {0};
    assert_true(ris_paint_wrinkles(&f->surface, &mouth, &zones) == RIS_PAINT_SMOOTH);
}

typedef enum place { LIPS, CHEEK, FOREHEAD, SCALP, PLACES } place;

/* Mean linear colour of the painted texels at the middles of triangles that clearly belong to each place. */
static void measure(const fixture *f, float mean[PLACES][3])
{
    uint32_t count[PLACES] = {0};
    memset(mean, 0, sizeof(float[PLACES][3]));
    for (uint32_t i = 0; i < f->surface.triangle_count; i++) {
        const uint32_t *t = &f->surface.triangle[3 * i], *uv = &f->surface.triangle_uv[3 * i];
        ris_paint_site site = {.shell = f->surface.shell[i], .occlusion = 1};
        float u = 0, v = 0;
        for (int k = 0; k < 3; k++) {
            site.p = vec3_add(site.p, vec3_scale(f->mesh.position[t[k]], 1 / 3.0f));
            site.lip += f->surface.lip_ring[t[k]] / 3;
            site.lid += f->surface.lid_ring[t[k]] / 3;
            u += f->mesh.uv[2 * uv[k]] / 3;
            v += f->mesh.uv[2 * uv[k] + 1] / 3;
        }
        const ris_paint_zones z = ris_paint_find_zones(&f->surface, &site);
        const bool in[PLACES] = {z.lip > 0.95f && z.inner_lip < 0.1f && z.inner_mouth<0.5f, z.cheek> 0.6f,
                                 z.forehead > 0.95f && z.scalp<0.02f, z.scalp> 0.95f};
        const uint32_t x = (uint32_t)(u * SIZE), y = (uint32_t)((1 - v) * SIZE);
        for (int p = 0; p < PLACES; p++) {
            for (int k = 0; k < 3 && in[p]; k++)
                mean[p][k] += ris_paint_decode((float)f->images.color.rgb[3 * (y * SIZE + x) + (uint32_t)k]);
            count[p] += in[p] ? 1 : 0;
        }
    }
    for (int p = 0; p < PLACES; p++) {
        assert_true(count[p] >= 10);
        for (int k = 0; k < 3; k++)
            mean[p][k] /= (float)count[p];
    }
}

static void test_colors_of_a_face(void **state)
{
    float mean[PLACES][3], red[PLACES];
    measure(*state, mean);
    for (int p = 0; p < PLACES; p++)
        red[p] = mean[p][0] / mean[p][1];
    assert_true(red[LIPS] > 1.1f * red[CHEEK]);
    assert_true(red[CHEEK] > 1.03f * red[FOREHEAD]);
    /* skin: red over green over blue, none near white; cropped hair is darker */
    for (int p = 0; p < PLACES; p++)
        assert_true(mean[p][0] > mean[p][1] && mean[p][1] > mean[p][2] && mean[p][0] < 0.75f &&
                    mean[p][2] > 0.03f);
    assert_true(mean[SCALP][0] < 0.6f * mean[FOREHEAD][0]);
}

static float byte_at(const ris_paint_image *image, float u, float v, int channel)
{
    const uint32_t x = (uint32_t)(u * (float)image->width), y = (uint32_t)((1 - v) * (float)image->height);
    return (float)image->rgb[3 * ((size_t)y * image->width + x) + (size_t)channel];
}

static void test_eye(void **state)
{
    (void)state;
    const ris_paint_eye eye = {14.95f, 5.9f, 2.1f};
    ris_paint_image image;
    ris_error err = {0};
    assert_int_equal(ris_paint_eye_image(&eye, 256, &image, &err), RIS_OK);
    const float pi = 3.14159265f, edge = 0.5f * asinf(5.9f / 14.95f) / pi;
    assert_true(byte_at(&image, 0.5f, 0.5f, 0) < 20);                /* pupil */
    assert_true(byte_at(&image, 0.5f + 0.7f * edge, 0.5f, 1) < 140); /* iris */
    assert_true(byte_at(&image, 0.5f + 1.6f * edge, 0.5f, 0) > 160); /* white */
    assert_true(byte_at(&image, 0.5f, 0.5f - 1.6f * edge, 0) > 150);
    ris_paint_image_finish(&image);
    const ris_paint_eye wrong = {5.0f, 5.9f, 2.1f};
    expect_error(&err, ris_paint_eye_image(&wrong, 256, &image, &err), RIS_ERROR_DATA, "radii");
}

static void test_refusals(void **state)
{
    const fixture *f = *state;
    ris_error err = {0};
    ris_paint_surface surface;
    ris_mesh bare = f->mesh;
    bare.uv_count = 0;
    expect_error(&err, ris_paint_surface_init(&surface, &bare, NULL, 0, NULL, 0, &err), RIS_ERROR_DATA,
                 "texture");
    ris_mesh faceless = f->mesh; /* the first quad only: one island, no mouth */
    faceless.face_count = 1;
    err = (ris_error){0};
    expect_error(&err, ris_paint_surface_init(&surface, &faceless, NULL, 0, NULL, 0, &err), RIS_ERROR_DATA,
                 "mouth");
    err = (ris_error){0};
    const char *nowhere = RIS_BUILD_DIR "/no-such-folder/skin.png";
    expect_error(&err, ris_paint_image_save(&f->images.color, nowhere, &err), RIS_ERROR_FAILED,
                 "no-such-folder");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bytes_twice), cmocka_unit_test(test_islands_are_full),
        cmocka_unit_test(test_colors_of_a_face), cmocka_unit_test(test_eye),
        cmocka_unit_test(test_wrinkles),         cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
