#include "orbit.h"

#include <math.h>

#define PI 3.14159265f
#define PITCH_LIMIT 1.5f /* radians, short of straight up */
#define NEAREST_MM 60.0f
#define FARTHEST_MM 3000.0f

static float clamp(float value, float low, float high)
{
    return value < low ? low : value > high ? high : value;
}

ris_orbit orbit_from_camera(const ris_camera *camera)
{
    ris_vec3 d = {camera->eye.x - camera->target.x, camera->eye.y - camera->target.y,
                  camera->eye.z - camera->target.z};
    float distance = sqrtf(d.x * d.x + d.y * d.y + d.z * d.z);
    return (ris_orbit){.target = camera->target,
                       .yaw = atan2f(d.x, d.z),
                       .pitch = asinf(clamp(d.y / distance, -1, 1)),
                       .distance_mm = distance,
                       .fov_y_deg = camera->fov_y_deg};
}

ris_camera orbit_camera(const ris_orbit *orbit)
{
    float flat = orbit->distance_mm * cosf(orbit->pitch);
    ris_vec3 eye = {orbit->target.x + flat * sinf(orbit->yaw),
                    orbit->target.y + orbit->distance_mm * sinf(orbit->pitch),
                    orbit->target.z + flat * cosf(orbit->yaw)};
    return (ris_camera){.eye = eye, .target = orbit->target, .up = {0, 1, 0}, .fov_y_deg = orbit->fov_y_deg};
}

void orbit_turn(ris_orbit *orbit, float right_px, float down_px, float height_px)
{
    orbit->yaw -= right_px / height_px * PI;
    orbit->pitch = clamp(orbit->pitch + down_px / height_px * PI, -PITCH_LIMIT, PITCH_LIMIT);
}

void orbit_pan(ris_orbit *orbit, float right_px, float down_px, float height_px)
{
    float mm = 2.0f * orbit->distance_mm * tanf(orbit->fov_y_deg * PI / 360.0f) / height_px;
    float sy = sinf(orbit->yaw), cy = cosf(orbit->yaw), sp = sinf(orbit->pitch), cp = cosf(orbit->pitch);
    /* right = (cy, 0, -sy), up = (-sp sy, cp, -sp cy) of the picture */
    orbit->target.x += (-right_px * cy - down_px * sp * sy) * mm;
    orbit->target.y += down_px * cp * mm;
    orbit->target.z += (right_px * sy - down_px * sp * cy) * mm;
}

void orbit_dolly(ris_orbit *orbit, float steps)
{
    orbit->distance_mm = clamp(orbit->distance_mm * powf(0.9f, steps), NEAREST_MM, FARTHEST_MM);
}
