/* engine/output/video.c: a playable file, and one sentence with nothing left behind when ffmpeg is missing, fails or the
 * disk is full. Without ffmpeg the writing tests are skipped, the rest is not. */
#include "scratch.h"

#include "risorius/output.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

enum { WIDTH = 64, HEIGHT = 48 };
static uint8_t frame[WIDTH * HEIGHT * 4];
static bool have_ffmpeg;

static int setup(void **state)
{
    have_ffmpeg = system("ffmpeg -version >/dev/null 2>&1 && ffprobe -version >/dev/null 2>&1") == 0;
    if (!have_ffmpeg) {
        print_message("skipped: the ffmpeg program is not installed\n");
    }
    return scratch_setup(state);
}

static void paint(uint32_t turn)
{
    uint32_t seed = turn * 77u + 1u;
    for (uint32_t i = 0; i < sizeof frame; i++) {
        seed = seed * 1664525u + 1013904223u;
        frame[i] = i % 4 == 3 ? 255 : (uint8_t)(seed >> 24);
    }
}

static void test_writes(void **state)
{
    (void)state;
    if (!have_ffmpeg) {
        skip();
    }
    ris_error err = {0};
    ris_video *video = NULL;
    const char *path = scratch_path("a film; with 'odd' name.mp4");
    assert_int_equal(ris_video_open(path, WIDTH, HEIGHT, 25, &video, &err), RIS_OK);
    for (uint32_t i = 0; i < 30; i++) {
        paint(i);
        assert_int_equal(ris_video_add(video, frame, &err), RIS_OK);
    }
    assert_int_equal(ris_video_close(video, &err), RIS_OK);
    assert_int_equal(scratch_count(), 1);
    char command[4096], told[256] = "";
    snprintf(command, sizeof command,
             "ffprobe -v error -count_frames -select_streams v -show_entries "
             "stream=codec_name,width,height,pix_fmt,nb_read_frames -of csv=p=0 \"%s\"",
             path);
    FILE *probe = popen(command, "r");
    assert_non_null(probe);
    assert_non_null(fgets(told, sizeof told, probe));
    assert_int_equal(pclose(probe), 0);
    assert_string_equal(told, "h264,64,48,yuv420p,30\n");
    scratch_clear();
}

static void test_refused(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_video *video = NULL;
    expect_error(&err, ris_video_open(scratch_path("a.mp4"), 63, 48, 25, &video, &err), RIS_ERROR_USAGE,
                 "63x48");
    expect_error(&err, ris_video_open(scratch_path("a.mp4"), 0, 48, 25, &video, &err), RIS_ERROR_USAGE,
                 "0x48");
    expect_error(&err, ris_video_open(scratch_path("a.mp4"), 64, 48, 0, &video, &err), RIS_ERROR_USAGE,
                 "found 0");
    expect_error(&err, ris_video_open(scratch_path("no/a.mp4"), 64, 48, 25, &video, &err), RIS_ERROR_FAILED,
                 "no/a.mp4");
    assert_null(video);
    assert_int_equal(scratch_count(), 0);
}

static void test_no_frames_and_abandon(void **state)
{
    (void)state;
    if (!have_ffmpeg) {
        skip();
    }
    ris_error err = {0};
    ris_video *video = NULL;
    assert_int_equal(ris_video_open(scratch_path("a.mp4"), WIDTH, HEIGHT, 25, &video, &err), RIS_OK);
    expect_error(&err, ris_video_close(video, &err), RIS_ERROR_FAILED, "no frames");
    assert_int_equal(ris_video_open(scratch_path("a.mp4"), WIDTH, HEIGHT, 25, &video, &err), RIS_OK);
    assert_int_equal(ris_video_add(video, frame, &err), RIS_OK);
    ris_video_abandon(video);
    ris_video_abandon(NULL);
    assert_int_equal(scratch_count(), 0);
}

static void test_missing_program(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_video *video = NULL;
    char *path = strdup(getenv("PATH"));
    assert_non_null(path);
    setenv("PATH", scratch_folder, 1);
    ris_result result = ris_video_open(scratch_path("a.mp4"), WIDTH, HEIGHT, 25, &video, &err);
    setenv("PATH", path, 1);
    free(path);
    expect_error(&err, result, RIS_ERROR_FAILED, "ffmpeg program was not found");
    assert_null(video);
    assert_int_equal(scratch_count(), 0);
}

/* A program that dies: the frame that finds out tells it, SIGPIPE does not end us. */
static void test_dying_program(void **state)
{
    (void)state;
    ris_error err = {0};
    ris_video *video = NULL;
    char *path = strdup(getenv("PATH"));
    assert_non_null(path);
    const char *fake = scratch_write("ffmpeg", "#!/bin/sh\necho no such codec >&2\nexit 7\n");
    assert_int_equal(chmod(fake, 0755), 0);
    setenv("PATH", scratch_folder, 1);
    ris_result result = ris_video_open(scratch_path("a.mp4"), WIDTH, HEIGHT, 25, &video, &err);
    setenv("PATH", path, 1);
    free(path);
    assert_int_equal(result, RIS_OK);
    for (uint32_t i = 0; i < 1000 && result == RIS_OK; i++) {
        result = ris_video_add(video, frame, &err);
    }
    expect_error(&err, result, RIS_ERROR_FAILED, "ended with code 7: no such codec");
    ris_error later = {0};
    expect_error(&later, ris_video_add(video, frame, &later), RIS_ERROR_FAILED, "earlier frame");
    expect_error(&later, ris_video_close(video, &later), RIS_ERROR_FAILED, "a frame failed");
    assert_int_equal(scratch_count(), 1);
    scratch_clear();
}

static int write_limited(const char *path)
{
    const struct rlimit limit = {20000, 20000};
    ris_error err = {0};
    ris_video *video = NULL;
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    ris_result result = ris_video_open(path, WIDTH, HEIGHT, 25, &video, &err);
    for (uint32_t i = 0; i < 100 && result == RIS_OK; i++) {
        paint(i);
        result = ris_video_add(video, frame, &err);
    }
    if (result == RIS_OK) {
        result = ris_video_close(video, &err);
    } else {
        ris_video_abandon(video);
    }
    return result == RIS_ERROR_FAILED && strstr(err.text, "ffmpeg") != NULL ? 0 : 1;
}

static void test_full_disk(void **state)
{
    (void)state;
    if (!have_ffmpeg) {
        skip();
    }
    const char *path = scratch_path("a.mp4");
    int status;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(write_limited(path));
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(scratch_count(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_writes),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_no_frames_and_abandon),
        cmocka_unit_test(test_missing_program),
        cmocka_unit_test(test_dying_program),
        cmocka_unit_test(test_full_disk),
    };
    return cmocka_run_group_tests(tests, setup, scratch_teardown);
}
