/* Recorded performances: both spellings and three ways to write a shape, timecodes at several rates, lost faces, leaps, mirror
 * and signs; OpenFace intensities, bits, gaze within the head; every wrong file is told with its place. */
#include "scratch.h"

#include "asset/take.h"

#include <math.h>

#define LL "Timecode,BlendShapeCount,"

typedef struct read_take {
    ris_take_table table;
    ris_take_info info;
    ris_error err;
} read_take;

static ris_result read_with(read_take *t, ris_take_format format, const char *adjust, const char *text)
{
    ris_take_def def = ris_default_take_def(format);
    *t = (read_take){0};
    if (adjust) {
        assert_int_equal(ris_take_adjust(&def, adjust, &t->err), RIS_OK);
    }
    return ris__take_parse("t.csv", text, strlen(text), &def, &t->table, &t->info, &t->err);
}

static void read_fine(read_take *t, ris_take_format format, const char *adjust, const char *text)
{
    if (read_with(t, format, adjust, text) != RIS_OK) {
        print_error("%s\n", t->err.text);
        fail();
    }
}

static void refused(ris_take_format format, const char *text, const char *sentence)
{
    read_take t;
    ris_result result = read_with(&t, format, NULL, text);
    expect_error(&t.err, result, RIS_ERROR_DATA, sentence);
    assert_null(t.table.value);
}

static double value_of(const read_take *t, const char *column, uint32_t sample)
{
    for (uint32_t c = 0; c < t->table.column_count; c++) {
        if (strcmp(t->table.column[c].name, column) == 0) {
            assert_true(sample < t->table.sample_count);
            return (double)t->table.value[(size_t)sample * t->table.column_count + c];
        }
    }
    fail_msg("no column %s", column);
    return 0;
}

static void near(double found, double wanted, double tolerance)
{
    if (!(fabs(found - wanted) <= tolerance)) {
        fail_msg("expected %.9g within %g, found %.9g", wanted, tolerance, found);
    }
}

static void spellings(void **state)
{
    static const char *const header[] = {"Timecode,BlendShapeCount,EyeBlinkLeft,MouthSmileRight",
                                         "Timecode,BlendshapeCount,eyeBlinkLeft,mouthSmileRight",
                                         "Timecode,BlendShapeCount,EyeBlink_L,MouthSmile_R",
                                         "\xef\xbb\xbfTimecode,BlendShapeCount,eyeBlink_L,mouthSmile_R"};
    char text[512];
    (void)state;
    for (int k = 0; k < 4; k++) {
        read_take t;
        snprintf(text, sizeof text, "%s\r\n00:00:01:00.000,2,0.25,0.5\r\n00:00:01:01.000,2,0.75,1\r\n",
                 header[k]);
        read_fine(&t, RIS_TAKE_LIVE_LINK, NULL, text);
        near(value_of(&t, "eyeBlinkLeft", 1), 0.75, 0);
        near(value_of(&t, "mouthSmileRight", 0), 0.5, 0);
        near(t.table.time_s[0], 0, 0);
        near(t.table.time_s[1], 1 / 60.0, 1e-12);
        assert_int_equal(t.info.columns, 2);
        ris__take_finish(&t.table);
    }
}

static void halves_of_the_middle(void **state)
{
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL, LL "browInnerUp_L,browInnerUp_R\n0:0:0:0,2,0.25,1\n");
    near(value_of(&t, "browInnerUp", 0), 0.625, 1e-7);
    ris__take_finish(&t.table);
    refused(RIS_TAKE_LIVE_LINK, LL "browInnerUp,browInnerUp_R\n0:0:0:0,2,0.25,1\n",
            "t.csv:1:38: expected each shape once, found \"browInnerUp_R\"");
}

static void write_takes(char *out, size_t size, int rate, int step, int rows)
{
    size_t used = (size_t)snprintf(out, size, LL "jawOpen\n");
    for (int i = 0; i < rows; i++) {
        const int frame = i * step + rate - 5;
        used += (size_t)snprintf(out + used, size - used, "00:59:%02d:%02d.250,1,0.5\n", 50 + frame / rate,
                                 frame % rate);
    }
}

static void rates(void **state)
{
    static const int rate[] = {24, 25, 30, 50, 60, 60, 120}, step[] = {1, 1, 1, 2, 1, 2, 1};
    static char text[1 << 14];
    (void)state;
    for (size_t k = 0; k < sizeof rate / sizeof *rate; k++) {
        read_take t;
        write_takes(text, sizeof text, rate[k], step[k], 100);
        read_fine(&t, RIS_TAKE_LIVE_LINK, NULL, text);
        near(t.info.duration_s, 99.0 * step[k] / rate[k], 1e-9);
        near(t.info.rate_hz, (double)rate[k] / step[k], 1e-3);
        assert_int_equal(t.info.gaps, 0);
        ris__take_finish(&t.table);
    }
    read_take t; /* too short to tell: 60; and told */
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL, LL "jawOpen\n0:0:0:3,1,0\n0:0:0:4,1,0\n");
    near(t.info.duration_s, 1 / 60.0, 1e-12);
    ris__take_finish(&t.table);
    read_fine(&t, RIS_TAKE_LIVE_LINK, "rate=30", LL "jawOpen\n0:0:0:3,1,0\n0:0:0:4,1,0\n");
    near(t.info.duration_s, 1 / 30.0, 1e-12);
    ris__take_finish(&t.table);
}

static void midnight(void **state)
{
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL,
              LL "jawOpen\n23:59:59:58,1,0.1\n23:59:59:59,1,0.2\n00:00:00:00,1,0.3\n00:00:00:01,1,0.4\n");
    near(t.info.duration_s, 3 / 60.0, 1e-9);
    near(value_of(&t, "jawOpen", 3), 0.4, 1e-7);
    ris__take_finish(&t.table);
}

static void lost_and_dropped(void **state)
{
    read_take t;
    char text[512];
    (void)state;
    read_fine(
        &t, RIS_TAKE_LIVE_LINK, NULL,
        LL "jawOpen,tongueOut\n0:0:0:0,0\n0:0:0:1,2,0.5,0\n0:0:0:2,2,0.5,0\n0:0:0:3,2,0.5,0\n0:0:0:4,0,0,0\n"
           "0:0:0:5,2,0.5,0\n0:0:0:5,2,0.9,0\n0:0:0:6,2,0.6,0\n0:0:0:12,2,0.7,0\n0:0:0:13,0\n");
    assert_int_equal(t.info.rows, 10);
    assert_int_equal(t.info.samples, 6);
    assert_int_equal(t.info.lost, 3);
    assert_int_equal(t.info.repeated, 1);
    assert_int_equal(t.info.gaps, 2); /* 3 -> 5 and 6 -> 12 */
    near(t.info.longest_gap_s, 6 / 60.0, 1e-9);
    near(t.table.time_s[0], 1 / 60.0, 1e-12); /* time 0 is the first row, face or not */
    near(t.info.duration_s, 13 / 60.0, 1e-9);
    near(value_of(&t, "jawOpen", 3), 0.5, 0); /* the repeated row is not played */
    assert_string_equal(
        ris_take_describe(&t.info, text, sizeof text),
        "6 of 10 rows, 1 columns that move, 0.22 s at 60 Hz; 2 gaps bridged, the longest 0.10 s; 3 rows "
        "without a sure face; 1 rows of a time that was there");
    ris__take_finish(&t.table);
}

static void leaps(void **state)
{
    static const char text[] = LL "jawOpen,eyeBlinkLeft\n0:0:0:0,2,0.1,0\n0:0:0:1,2,0.1,0.3\n0:0:0:2,2,0.9,0."
                                  "9\n0:0:0:3,2,0.2,1\n0:0:0:4,2,0.2,0.4\n";
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL, text);
    assert_int_equal(t.info.spikes, 1);
    near(value_of(&t, "jawOpen", 2), 0.15, 1e-6);     /* one frame up and back: the tracker slipped */
    near(value_of(&t, "eyeBlinkLeft", 2), 0.9, 1e-6); /* the fastest blink is slower */
    ris__take_finish(&t.table);
    read_fine(&t, RIS_TAKE_LIVE_LINK, "keep-spikes", text);
    assert_int_equal(t.info.spikes, 0);
    near(value_of(&t, "jawOpen", 2), 0.9, 1e-6);
    ris__take_finish(&t.table);
}

/* 0.35 for one frame of a sixtieth is no face; of a thirtieth it is half a blink. */
static void small_leaps(void **state)
{
    static const char *const rate[] = {"rate=60", "rate=30"};
    (void)state;
    for (uint32_t k = 0; k < 2; k++) {
        read_take t;
        read_fine(&t, RIS_TAKE_LIVE_LINK, rate[k],
                  LL "jawOpen\n0:0:0:0,1,0.1\n0:0:0:1,1,0.45\n0:0:0:2,1,0.1\n0:0:0:3,1,0.2\n");
        assert_int_equal(t.info.spikes, 1 - k);
        ris__take_finish(&t.table);
    }
}

static void ranges(void **state)
{
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL, LL "jawOpen,HeadYaw\n0:0:0:0,2,1.25,3\n0:0:0:1,2,-0.01,0\n");
    near(value_of(&t, "jawOpen", 0), 1, 0);
    near(value_of(&t, "jawOpen", 1), 0, 0);
    near(value_of(&t, "head.yaw", 0), 80, 0); /* 172 degrees */
    assert_int_equal(t.info.clamped, 3);
    ris__take_finish(&t.table);
}

static void head_angles(void **state)
{
    static const char text[] =
        LL "HeadYaw,HeadPitch,HeadRoll\n0:0:0:0,3,0.5,0.25,-0.1\n0:0:0:1,3,0.6,0.25,-0.1\n"
           "0:0:0:2,3,0.7,0.25,-0.1\n";
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL, text);
    near(value_of(&t, "head.yaw", 0), 28.6478898, 1e-5);
    near(value_of(&t, "head.pitch", 0), 14.3239449, 1e-5);
    near(value_of(&t, "head.roll", 0), 5.7295780, 1e-5);
    assert_false(t.info.degrees);
    ris__take_finish(&t.table);
    read_fine(&t, RIS_TAKE_LIVE_LINK, "landscape,flip-roll,center", text);
    near(value_of(&t, "head.yaw", 0), 5.7295780, 1e-5); /* 0.6 is the middle */
    near(value_of(&t, "head.pitch", 0), 0, 1e-5);
    ris__take_finish(&t.table);
    read_fine(&t, RIS_TAKE_LIVE_LINK, "no-head", text);
    near(value_of(&t, "head.yaw", 2), 0, 0);
    ris__take_finish(&t.table);
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL,
              LL "HeadYaw\n0:0:0:0,1,-12.5\n0:0:0:1,1,2\n"); /* above pi: degrees */
    near(value_of(&t, "head.yaw", 0), -12.5, 0);
    near(value_of(&t, "head.yaw", 1), 2, 0);
    assert_true(t.info.degrees);
    ris__take_finish(&t.table);
}

static void eyes_by_shapes_or_by_angles(void **state)
{
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL,
              LL "eyeLookOutLeft,LeftEyeYaw,RightEyePitch,LeftEyeRoll\n0:0:0:0,4,0.5,0.2,0.1,0.3\n");
    near(value_of(&t, "eyeLookOutLeft", 0), 0.5, 0);
    near(value_of(&t, "eye.yaw.L", 0), 0, 0);
    ris__take_finish(&t.table);
    read_fine(&t, RIS_TAKE_LIVE_LINK, NULL,
              LL "eyeLookOutLeft,LeftEyeYaw,RightEyePitch,LeftEyeRoll\n0:0:0:0,4,0,0.2,0.1,0.3\n");
    near(value_of(&t, "eye.yaw.L", 0), 11.4591559, 1e-5);
    near(value_of(&t, "eye.pitch.R", 0), -5.7295780, 1e-5);
    ris__take_finish(&t.table);
}

static void mirrored(void **state)
{
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_LIVE_LINK, "mirror",
              LL "mouthSmileLeft,mouthSmileRight,jawLeft,jawOpen,HeadYaw,HeadPitch,LeftEyeYaw\n0:0:0:0,7,0."
                 "75,0.25,1,0.5,"
                 "0.1,0.2,0.3\n");
    near(value_of(&t, "mouthSmileLeft", 0), 0.25, 0);
    near(value_of(&t, "mouthSmileRight", 0), 0.75, 0);
    near(value_of(&t, "jawRight", 0), 1, 0);
    near(value_of(&t, "jawLeft", 0), 0, 0);
    near(value_of(&t, "jawOpen", 0), 0.5, 0);
    near(value_of(&t, "head.yaw", 0), -5.7295780, 1e-5);
    near(value_of(&t, "head.pitch", 0), 11.4591559, 1e-5);
    near(value_of(&t, "eye.yaw.R", 0), -17.1887339, 1e-5);
    near(value_of(&t, "eye.yaw.L", 0), 0, 0);
    ris__take_finish(&t.table);
}

static void live_link_refused(void **state)
{
    (void)state;
    refused(RIS_TAKE_LIVE_LINK, "",
            "t.csv:1:1: expected a header that begins with Timecode, found the end of the file");
    refused(RIS_TAKE_LIVE_LINK, "frame, timestamp\n",
            "t.csv:1:1: expected a header that begins with Timecode, found \"frame");
    refused(RIS_TAKE_LIVE_LINK, "Timecode,Count,jawOpen\n", "t.csv:1:10: expected BlendShapeCount");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpne\n",
            "t.csv:1:26: expected an ARKit shape or an angle of head or eyes, found \"jawOpne\"; nearest: "
            "jawOpen");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen,jawOpen\n", "t.csv:1:34: expected each shape once");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n", "t.csv:2:1: expected rows below the header");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n0:0:0:0,0\n",
            "expected a row with a face, found none among 1 rows");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n0:0:0.0,1,0\n",
            "t.csv:2:1: expected a timecode HH:MM:SS:FF.fff, found \"0:0:0.0");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n0:60:0:0,1,0\n", "t.csv:2:1: expected a timecode");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n0:0:0:0,1,nan\n",
            "t.csv:2:11: expected a value of 0 to 1, found \"nan\"");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen,tongueOut\n0:0:0:0,2,0.5\n",
            "t.csv:2:14: expected a value for every column of the header, found \"\"");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n0:0:0:0,1,0.5,3\n", "t.csv:2:15: expected the end of the line");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n0:0:9:0,1,0\n0:0:8:0,1,0\n",
            "t.csv:3:1: expected a timecode after that of the row");
    refused(RIS_TAKE_LIVE_LINK, LL "jawOpen\n0:0:0:0\n",
            "t.csv:2:8: expected the number of shapes behind the timecode");
}

#define OF                                                                                                   \
    "frame, face_id, timestamp, confidence, success, gaze_angle_x, gaze_angle_y, pose_Rx, pose_Ry, "         \
    "pose_Rz, "

static void openface_rows(void **state)
{
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_OPENFACE, NULL,
              OF "AU12_r, AU28_c, AU12_c, x_0, eye_lmk_X_3\n"
                 "1, 0, 0.0, 0.98, 1, 0, 0, 0, 0, 0, 2.5, 0, 1, 12.5, 3\n"
                 "2, 0, 0.1, 0.98, 1, 0.2, 0.1, 0, 0, 0, 5, 0, 1, 12.5, 3\n"
                 "2, 1, 0.1, 0.98, 1, 0.2, 0.1, 0, 0, 0, 5, 0, 1, 12.5, 3\n"
                 "3, 0, 0.2, 0.40, 1, 0, 0, 0, 0, 0, 5, 0, 1, nothing, 3\n"
                 "4, 0, 0.3, 0.98, 0, 0, 0, 0, 0, 0, 5, 0, 1, 12.5, 3\n"
                 "5, 0, 0.4, 0.98, 1, 0, 0, 0.1, 0.2, 0.3, 5.5, 1, 1, 12.5, 3\n");
    assert_int_equal(t.info.rows, 6);
    assert_int_equal(t.info.samples, 3);
    assert_int_equal(t.info.lost, 2);
    assert_int_equal(t.info.other_faces, 1);
    assert_int_equal(t.info.clamped, 1); /* 5.5 of 5 */
    near(value_of(&t, "AU12", 0), 0.5, 0);
    near(value_of(&t, "AU12", 2), 1, 0);
    near(value_of(&t, "eye.yaw", 1), 11.4591559, 1e-5); /* to the right of the picture: the subject's left */
    /* down: the vector (tan 0.2, tan 0.1, -1) is atan(tan 0.1 cos 0.2) below the horizon */
    near(value_of(&t, "eye.pitch", 1), -5.6161, 1e-3);
    near(value_of(&t, "head.pitch", 2), -5.7295780, 1e-5);
    near(value_of(&t, "head.yaw", 2), -11.4591559, 1e-5);
    near(value_of(&t, "head.roll", 2), 17.1887339, 1e-5);
    near(value_of(&t, "AU28", 2), 0.6, 1e-6);
    ris__take_finish(&t.table);
}

/* The head turned to the subject's right by 0.3 while the gaze stays on the camera: the eyes are 0.3 to the left in it. */
static void openface_gaze_within_the_head(void **state)
{
    read_take t;
    (void)state;
    read_fine(&t, RIS_TAKE_OPENFACE, NULL,
              "timestamp,gaze_angle_x,gaze_angle_y,pose_Rx,pose_Ry,pose_Rz\n0,0,0,0,0.3,0\n1,0,0,0.2,0,0\n2,"
              "0.3,0,0,-0.3,0\n");
    near(value_of(&t, "eye.yaw", 0), 17.1887339, 1e-4);
    near(value_of(&t, "eye.pitch", 0), 0, 1e-5);
    near(value_of(&t, "eye.pitch", 1), 11.4591559, 1e-4); /* nose down, eyes up */
    near(value_of(&t, "eye.yaw", 2), 0, 1e-4);            /* eyes and head went together */
    ris__take_finish(&t.table);
}

/* A bit of one second becomes a rise and a fall of 0.2 s, none faster. */
static void openface_bits_are_smooth(void **state)
{
    static char text[4096];
    size_t used = (size_t)snprintf(text, sizeof text, "timestamp,AU28_c\n");
    read_take t;
    (void)state;
    for (int i = 0; i < 90; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "%.4f,%d\n", i / 30.0, i >= 30 && i < 60);
    }
    read_fine(&t, RIS_TAKE_OPENFACE, NULL, text);
    double most = 0;
    for (uint32_t i = 1; i < 90; i++) {
        most = fmax(most, fabs(value_of(&t, "AU28", i) - value_of(&t, "AU28", i - 1)));
    }
    near(value_of(&t, "AU28", 45), 0.6, 1e-6);
    assert_true(most <= 0.13);
    ris__take_finish(&t.table);
}

static void openface_refused(void **state)
{
    (void)state;
    refused(RIS_TAKE_OPENFACE, "", "t.csv:1:1: expected a header with timestamp");
    refused(RIS_TAKE_OPENFACE, "frame, AU12_r\n1, 1\n",
            "t.csv:1:1: expected a column timestamp, found none among 2");
    refused(RIS_TAKE_OPENFACE, "timestamp, AU1_r\n", "t.csv:1:12: expected a column of OpenFace");
    refused(RIS_TAKE_OPENFACE, "timestamp, AU12_r, AU12_r\n", "t.csv:1:20: expected each column once");
    refused(RIS_TAKE_OPENFACE, "timestamp, AU12_r\n0, x\n",
            "t.csv:2:4: expected an intensity of 0 to 5, found \"x\"");
    refused(RIS_TAKE_OPENFACE, "timestamp, AU12_r\n1, 0\n0.5, 0\n",
            "t.csv:3:1: expected a timestamp after that");
    refused(RIS_TAKE_OPENFACE, "timestamp, success\n0, 0\n",
            "expected a row with a face, found none among 1 rows");
}

static void adjustments(void **state)
{
    ris_take_def def = ris_default_take_def(RIS_TAKE_OPENFACE);
    ris_error err = {0};
    (void)state;
    assert_int_equal(ris_take_adjust(&def, "confidence=0.25,mirror,no-head", &err), RIS_OK);
    assert_true(def.confidence == 0.25 && def.mirror && def.no_head && !def.center);
    expect_error(&err, ris_take_adjust(&def, "mirror,upside-down", &err), RIS_ERROR_USAGE,
                 "or confidence=C, found \"upside-down\"");
    err = (ris_error){0};
    expect_error(&err, ris_take_adjust(&def, "rate=fast", &err), RIS_ERROR_USAGE,
                 "expected a number from 1 to 1000");
    err = (ris_error){0};
    expect_error(&err, ris_take_adjust(&def, "", &err), RIS_ERROR_USAGE, "found \"\"");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spellings),
        cmocka_unit_test(halves_of_the_middle),
        cmocka_unit_test(rates),
        cmocka_unit_test(midnight),
        cmocka_unit_test(lost_and_dropped),
        cmocka_unit_test(leaps),
        cmocka_unit_test(small_leaps),
        cmocka_unit_test(ranges),
        cmocka_unit_test(head_angles),
        cmocka_unit_test(eyes_by_shapes_or_by_angles),
        cmocka_unit_test(mirrored),
        cmocka_unit_test(live_link_refused),
        cmocka_unit_test(openface_rows),
        cmocka_unit_test(openface_gaze_within_the_head),
        cmocka_unit_test(openface_bits_are_smooth),
        cmocka_unit_test(openface_refused),
        cmocka_unit_test(adjustments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
