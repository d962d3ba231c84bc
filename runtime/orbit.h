/* The viewer's camera: turns about a point, pans in the picture plane, moves nearer. */
#pragma once

#include "risorius/draw.h"

typedef struct ris_orbit {
    ris_vec3 target;               /* mm */
    float yaw, pitch, distance_mm; /* radians; yaw 0 looks at the face, positive from the subject's left */
    float fov_y_deg;
} ris_orbit;

/* Takes over a camera whose up is +y. */
ris_orbit orbit_from_camera(const ris_camera *camera);
ris_camera orbit_camera(const ris_orbit *orbit);
/* Moves by pixels of a window of the given height. */
void orbit_turn(ris_orbit *orbit, float right_px, float down_px, float height_px);
void orbit_pan(ris_orbit *orbit, float right_px, float down_px, float height_px);
/* Positive steps go nearer. */
void orbit_dolly(ris_orbit *orbit, float steps);
