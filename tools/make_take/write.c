/* Frames with their faults as CSV. */
#include "make_take.h"

#include "base/file.h"

#include <ctype.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180)
#define FIRST_SECOND 36000 /* 10:00:00 */

/* The faults of one frame, each from a stream of its own. */
typedef struct faults {
    ris_pcg noise, drop, lose, spike;
    uint32_t dropped, lost; /* frames still to go */
} faults;

static double unit(ris_pcg *pcg)
{
    return (double)(ris__pcg_next(pcg) >> 8) / 16777216.0;
}

/* Mean 0, standard deviation 1, four times that at most: the sum of twelve would be closer to normal, four will do. */
static double noise(ris_pcg *pcg)
{
    const double sum = unit(pcg) + unit(pcg) + unit(pcg) + unit(pcg);
    return (sum - 2) * 1.7320508075688772;
}

static void shake(const take_options *options, faults *f, take_frame *frame)
{
    const double turn = 0.3 * options->jitter / DEGREE;
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT; k++) {
        const double value = frame->shape[k] + options->jitter * noise(&f->noise);
        frame->shape[k] = value < 0 ? 0 : value > 1 ? 1 : value;
    }
    double *angle[] = {&frame->head_yaw,   &frame->head_pitch,   &frame->head_roll,   &frame->eye_yaw[0],
                       &frame->eye_yaw[1], &frame->eye_pitch[0], &frame->eye_pitch[1]};
    for (size_t k = 0; k < sizeof angle / sizeof *angle; k++) {
        *angle[k] += turn * noise(&f->noise);
    }
    if (unit(&f->spike) < options->spike) {
        double *shape = &frame->shape[ris__pcg_below(&f->spike, RIS__ARKIT_COUNT)];
        *shape = *shape < 0.5 ? 1 : 0;
    }
}

/* Steps the faults on by a frame. */
static void step(const take_options *options, faults *f)
{
    f->dropped -= f->dropped > 0;
    f->lost -= f->lost > 0;
    if (unit(&f->drop) < options->drop) {
        f->dropped = 1 + ris__pcg_below(&f->drop, 6);
    }
    if (unit(&f->lose) < options->lose) {
        const uint32_t half_second = (uint32_t)(0.5 * options->fps);
        f->lost = 2 + ris__pcg_below(&f->lose, half_second ? half_second : 1);
    }
}

static ris_result write_live_link_header(const take_options *options, ris_output_file *out, ris_error *err)
{
    static const char angles[] =
        ",HeadYaw,HeadPitch,HeadRoll,LeftEyeYaw,LeftEyePitch,LeftEyeRoll,RightEyeYaw,"
        "RightEyePitch,RightEyeRoll\n";
    ris_result result =
        ris__output_printf(out, err, "Timecode,%s", options->camel ? "BlendshapeCount" : "BlendShapeCount");
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT && result == RIS_OK; k++) {
        char name[RIS_NAME_SIZE];
        snprintf(name, sizeof name, "%s", ris__arkit_name[k]);
        char *left = strstr(name, "Left"), *right = strstr(name, "Right");
        if (options->sides && left && left > name + 5) {
            strcpy(left, "_L");
        } else if (options->sides && right && right > name + 5) {
            strcpy(right, "_R");
        }
        if (!options->camel && !options->sides) {
            name[0] = (char)toupper((unsigned char)name[0]);
        }
        result = ris__output_printf(out, err, ",%s", name);
    }
    return result == RIS_OK ? ris__output_write(out, angles, strlen(angles), err) : result;
}

static ris_result write_live_link(const take_options *options, const take_frame *frame, uint32_t index,
                                  bool lost, ris_output_file *out, ris_error *err)
{
    const uint32_t fps = (uint32_t)options->fps, second = FIRST_SECOND + index / fps;
    ris_result result =
        ris__output_printf(out, err, "%02u:%02u:%02u:%02u.207,%d", second / 3600 % 24, second / 60 % 60,
                           second % 60, index % fps, lost ? 0 : RIS__ARKIT_COUNT + 9);
    for (uint32_t k = 0; k < RIS__ARKIT_COUNT && result == RIS_OK && !lost; k++) {
        result = ris__output_printf(out, err, ",%.8f", frame->shape[k]);
    }
    if (result == RIS_OK && !lost) { /* signs as docs/performances.md tells them */
        result = ris__output_printf(out, err, ",%.8f,%.8f,%.8f,%.8f,%.8f,%.8f,%.8f,%.8f,%.8f",
                                    frame->head_yaw * DEGREE, frame->head_pitch * DEGREE,
                                    -frame->head_roll * DEGREE, frame->eye_yaw[0] * DEGREE,
                                    -frame->eye_pitch[0] * DEGREE, 0.0, frame->eye_yaw[1] * DEGREE,
                                    -frame->eye_pitch[1] * DEGREE, 0.0);
    }
    return result == RIS_OK ? ris__output_write(out, "\n", 1, err) : result;
}

/* The units OpenFace tells, by the shapes that are their kin; both sides' mean. */
static const struct kin {
    uint32_t unit;
    const char *shape;
} kin[] = {{1, "browInnerUp"},   {2, "browOuterUp"},  {4, "browDown"},        {5, "eyeWide"},
           {6, "cheekSquint"},   {7, "eyeSquint"},    {9, "noseSneer"},       {10, "mouthUpperUp"},
           {12, "mouthSmile"},   {14, "mouthDimple"}, {15, "mouthFrown"},     {17, "mouthShrugLower"},
           {20, "mouthStretch"}, {23, "mouthPress"},  {25, "mouthLowerDown"}, {26, "jawOpen"},
           {45, "eyeBlink"}};
#define KIN_COUNT (sizeof kin / sizeof *kin)

static double mean_shape(const take_frame *frame, const char *stem)
{
    char name[2][RIS_NAME_SIZE];
    if (shape_index(stem) < RIS__ARKIT_COUNT) {
        return frame->shape[shape_index(stem)];
    }
    snprintf(name[0], sizeof name[0], "%sLeft", stem);
    snprintf(name[1], sizeof name[1], "%sRight", stem);
    return 0.5 * (frame->shape[shape_index(name[0])] + frame->shape[shape_index(name[1])]);
}

static ris_result write_openface_header(ris_output_file *out, ris_error *err)
{
    ris_result result = ris__output_printf(out, err,
                                           "frame, face_id, timestamp, confidence, success, gaze_angle_x, "
                                           "gaze_angle_y, pose_Tx, pose_Ty, pose_Tz, "
                                           "pose_Rx, pose_Ry, pose_Rz");
    for (size_t k = 0; k < KIN_COUNT && result == RIS_OK; k++) {
        result = ris__output_printf(out, err, ", AU%02u_r", kin[k].unit);
    }
    for (size_t k = 0; k < KIN_COUNT && result == RIS_OK; k++) {
        result =
            ris__output_printf(out, err, "%s, AU%02u_c", kin[k].unit == 45 ? ", AU28_c" : "", kin[k].unit);
    }
    return result == RIS_OK ? ris__output_write(out, "\n", 1, err) : result;
}

static ris_result write_openface(const take_options *options, const take_frame *frame, uint32_t index,
                                 bool lost, ris_output_file *out, ris_error *err)
{
    /* gaze of the camera: small angles add up well enough for a made-up face */
    const double gaze_x = frame->head_yaw + 0.5 * (frame->eye_yaw[0] + frame->eye_yaw[1]),
                 gaze_y = frame->head_pitch + 0.5 * (frame->eye_pitch[0] + frame->eye_pitch[1]);
    const bool sucked = mean_shape(frame, "mouthRollLower") + mean_shape(frame, "mouthRollUpper") > 0.7;
    ris_result result = ris__output_printf(
        out, err, "%u, 0, %.3f, %.2f, %d, %.3f, %.3f, 0.0, 0.0, 600.0, %.3f, %.3f, %.3f", index + 1,
        (double)index / options->fps, lost ? 0.31 : 0.98, !lost, gaze_x * DEGREE, -gaze_y * DEGREE,
        -frame->head_pitch * DEGREE, -frame->head_yaw * DEGREE, frame->head_roll * DEGREE);
    for (size_t k = 0; k < KIN_COUNT && result == RIS_OK; k++) {
        result = ris__output_printf(out, err, ", %.2f", lost ? 0.0 : 5 * mean_shape(frame, kin[k].shape));
    }
    for (size_t k = 0; k < KIN_COUNT && result == RIS_OK; k++) {
        if (kin[k].unit == 45) {
            result = ris__output_printf(out, err, ", %d", sucked && !lost);
        }
        if (result == RIS_OK) {
            result = ris__output_printf(out, err, ", %d", !lost && mean_shape(frame, kin[k].shape) > 0.2);
        }
    }
    return result == RIS_OK ? ris__output_write(out, "\n", 1, err) : result;
}

ris_result write_take(const take_options *options, const take_play *play, const char *path,
                      uint32_t *out_rows, ris_error *err)
{
    const uint32_t count = (uint32_t)(options->seconds * options->fps + 0.5);
    faults f = {.noise = ris__pcg_start(options->seed, 11),
                .drop = ris__pcg_start(options->seed, 12),
                .lose = ris__pcg_start(options->seed, 13),
                .spike = ris__pcg_start(options->seed, 14)};
    ris_output_file out = {0};
    *out_rows = 0;
    ris_result result = ris__output_open(&out, path, err);
    if (result == RIS_OK) {
        result =
            options->openface ? write_openface_header(&out, err) : write_live_link_header(options, &out, err);
    }
    for (uint32_t i = 0; i < count && result == RIS_OK; i++) {
        take_frame frame;
        play_at(play, (double)i / options->fps, &frame);
        shake(options, &f, &frame);
        step(options, &f);
        if (f.dropped && i > 0 && i + 1 < count) {
            continue;
        }
        const bool lost = f.lost && i > 0 && i + 1 < count;
        result = (options->openface ? write_openface : write_live_link)(options, &frame, i, lost, &out, err);
        ++*out_rows;
    }
    if (result == RIS_OK) {
        result = ris__output_commit(&out, err);
    }
    ris__output_discard(&out);
    return result;
}
