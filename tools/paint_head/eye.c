/* The eye: iris of radial fibres round a collarette, dark limbal ring, warm sclera with faint veins.
 * Azimuthal layout: the distance from the image centre is proportional to the angle from the corneal pole. */
#include "paint.h"

#include <math.h>

static const float pi = 3.14159265f;

static void mix3(float *a, const float *b, float t)
{
    for (int k = 0; k < 3; k++)
        a[k] = ris_paint_mix(a[k], b[k], t);
}

/* r: 0 at the pupil's rim .. 1 at the limbus; turn: direction, radians. */
static void paint_iris(float r, float turn, float color[3])
{
    const float outer[3] = {0.080f, 0.100f, 0.097f}, inner[3] = {0.160f, 0.088f, 0.034f},
                light[3] = {0.27f, 0.265f, 0.20f};
    const float dark[3] = {0.030f, 0.030f, 0.028f};
    const float cx = cosf(turn), cy = sinf(turn);
    const float wave = ris_paint_fbm(vec3(cx * 5, cy * 5, r * 1.5f), 3, 211);
    const float fibre = ris_paint_fbm(vec3(cx * 17, cy * 17, r * 1.2f + 0.3f * wave), 3, 223);
    const float fine = ris_paint_fbm(vec3(cx * 42, cy * 42, r * 2.0f), 2, 227);
    const float collar = 0.30f + 0.05f * ris_paint_noise(vec3(cx * 4, cy * 4, 3), 229);
    const float centre = ris_paint_step(collar + 0.16f, collar - 0.12f, r + 0.10f * fibre);
    mix3(color, outer, 1);
    mix3(color, inner, 0.85f * centre);
    const float bright = ris_paint_step(-0.15f, 0.6f, fibre + 0.4f * fine) * (0.75f - 0.35f * centre);
    mix3(color, light, 0.55f * bright);
    const float ridge = expf(-powf((r - collar) / 0.055f, 2));
    mix3(color, light, 0.30f * ridge * (0.7f + 0.5f * fibre));
    mix3(color, dark, 0.45f * ris_paint_step(0.05f, 0.6f, -fibre - 0.3f * fine));
    const ris_paint_cell crypt = ris_paint_cells(vec3(cx * 4.5f, cy * 4.5f, r * 2.4f), 233);
    mix3(color, dark, 0.30f * ris_paint_step(0.32f, 0.12f, crypt.near) * ris_paint_step(0.2f, 0.45f, r));
    mix3(color, dark, 0.80f * ris_paint_step(0.74f, 1.0f, r + 0.04f * wave));
    mix3(color, dark, 0.75f * ris_paint_step(0.10f, 0.0f, r));
}

/* angle: from the corneal pole, radians. */
static void paint_sclera(float angle, float edge, float turn, ris_vec3 direction, float color[3])
{
    const float white[3] = {0.60f, 0.555f, 0.505f}, warm[3] = {0.52f, 0.41f, 0.335f},
                red[3] = {0.46f, 0.105f, 0.075f};
    const float grey[3] = {0.42f, 0.425f, 0.43f};
    mix3(color, white, 1);
    const float cloud = ris_paint_fbm(vec3_scale(direction, 4), 3, 239);
    mix3(color, warm, ris_paint_clamp(0.18f + 0.22f * cloud, 0, 1));
    const float side = fabsf(cosf(turn));
    const float away = ris_paint_step(edge + 0.12f, edge + 0.75f, angle);
    mix3(color, warm, 0.65f * away * side);
    /* vessels wander towards the limbus and thin out before it */
    const float wander = 0.35f * ris_paint_fbm(vec3_scale(direction, 5), 3, 241);
    const float course =
        ris_paint_noise(vec3(cosf(turn + wander) * 7, sinf(turn + wander) * 7, angle * 0.9f), 251);
    const float branch =
        ris_paint_noise(vec3(cosf(turn - wander) * 15, sinf(turn - wander) * 15, angle * 3), 257);
    const float vein =
        ris_paint_step(0.045f, 0.0f, fabsf(course)) + 0.6f * ris_paint_step(0.05f, 0.0f, fabsf(branch));
    const float patchy = ris_paint_clamp(0.4f + 0.9f * ris_paint_fbm(vec3_scale(direction, 3), 2, 263), 0, 1);
    mix3(color, red,
         ris_paint_clamp(0.42f * vein * patchy * (0.15f + away) * (0.35f + 0.65f * side), 0, 0.6f));
    mix3(color, grey, 0.75f * ris_paint_step(edge + 0.075f, edge, angle));
    const float deep = 1 - 0.45f * ris_paint_step(0.9f, 1.5f, angle);
    for (int k = 0; k < 3; k++)
        color[k] *= deep;
}

ris_result ris_paint_eye_image(const ris_paint_eye *eye, uint32_t size, ris_paint_image *out, ris_error *err)
{
    if (!(eye->pupil_radius_mm > 0 && eye->pupil_radius_mm < eye->iris_radius_mm &&
          eye->iris_radius_mm < eye->ball_radius_mm))
        return ris_fail(
            err, RIS_ERROR_DATA, "eye radii must grow from pupil to iris to ball, found %g, %g, %g mm",
            (double)eye->pupil_radius_mm, (double)eye->iris_radius_mm, (double)eye->ball_radius_mm);
    const ris_result result = ris_paint_image_init(out, size, size, err);
    if (result)
        return result;
    const float edge = asinf(eye->iris_radius_mm / eye->ball_radius_mm);
    const float pupil = asinf(eye->pupil_radius_mm / eye->ball_radius_mm);
    const float soft = pi * 1.5f / (float)size; /* 1.5 texels */
    for (uint32_t i = 0; i < size * size; i++) {
        const uint32_t column = i % size, row = i / size;
        const float u = ((float)column + 0.5f) / (float)size - 0.5f;
        const float v = 0.5f - ((float)row + 0.5f) / (float)size;
        const float angle = 2 * pi * sqrtf(u * u + v * v), turn = atan2f(v, u);
        const float flat = fminf(angle, pi);
        const ris_vec3 direction = vec3(sinf(flat) * cosf(turn), sinf(flat) * sinf(turn), cosf(flat));
        float color[3], iris[3];
        const float black[3] = {0.004f, 0.004f, 0.004f};
        paint_sclera(flat, edge, turn, direction, color);
        paint_iris(ris_paint_clamp((angle - pupil) / (edge - pupil), 0, 1), turn, iris);
        const float ragged = 0.012f * ris_paint_noise(vec3(cosf(turn) * 6, sinf(turn) * 6, 0), 269);
        mix3(color, iris, ris_paint_step(edge + 0.022f, edge - 0.022f, angle + ragged));
        mix3(color, black, ris_paint_step(pupil + soft, pupil - soft, angle + 0.2f * ragged));
        const float lidded = 1 - 0.5f * ris_paint_step(0.10f, 0.62f, angle * sinf(turn)) -
                             0.18f * ris_paint_step(0.2f, 0.7f, -angle * sinf(turn));
        for (int k = 0; k < 3; k++)
            color[k] *= lidded;
        for (int k = 0; k < 3; k++)
            out->rgb[3 * (size_t)i + (size_t)k] = ris_paint_encode(color[k]);
        out->covered[i] = 1;
    }
    return RIS_OK;
}
