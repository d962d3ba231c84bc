/* Video by piping raw RGBA frames to the ffmpeg program: no shell, so any path is safe; ffmpeg
 * writes a temporary file beside the target that is renamed when the program has ended well. */
#include "risorius/output.h"

#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

struct ris_video {
    char path[RIS_PATH_SIZE], temporary[RIS_PATH_SIZE]; /* temporary is empty until it is ours */
    FILE *log; /* what ffmpeg says, unlinked; NULL if there was no room for it */
    pid_t pid;
    int pipe; /* -1 once closed */
    uint32_t width, height, frames;
    bool failed;
};

/* A broken pipe must come back as EPIPE from write, whatever the program does with SIGPIPE. */
static int write_all(int fd, const uint8_t *data, size_t size)
{
    sigset_t pipe_signal, old, pending;
    sigemptyset(&pipe_signal);
    sigaddset(&pipe_signal, SIGPIPE);
    sigpending(&pending);
    bool was_pending = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &pipe_signal, &old);
    int failure = 0;
    while (size > 0 && failure == 0) {
        ssize_t done = write(fd, data, size);
        if (done >= 0) {
            data += done;
            size -= (size_t)done;
        } else if (errno != EINTR) {
            failure = errno;
        }
    }
    if (failure == EPIPE && !was_pending) {
        const struct timespec now = {0, 0};
        while (sigtimedwait(&pipe_signal, NULL, &now) == -1 && errno == EINTR) {
        }
    }
    pthread_sigmask(SIG_SETMASK, &old, NULL);
    return failure;
}

/* Ends the program: closes its input, waits, and returns its wait status (-1 if it cannot be had). */
static int end_program(ris_video *video)
{
    if (video->pipe >= 0) {
        close(video->pipe);
        video->pipe = -1;
    }
    int status = -1;
    if (video->pid > 0) {
        pid_t got;
        do {
            got = waitpid(video->pid, &status, 0);
        } while (got == -1 && errno == EINTR);
        if (got == -1) {
            status = -1;
        }
        video->pid = 0;
    }
    return status;
}

/* First line of what ffmpeg said, without its newline. */
static void first_line(FILE *log, char *out, size_t size)
{
    out[0] = '\0';
    if (log != NULL && fseek(log, 0, SEEK_SET) == 0 && fgets(out, (int)size, log) != NULL) {
        out[strcspn(out, "\r\n")] = '\0';
    }
}

static ris_result fail_program(ris_video *video, int status, ris_error *err)
{
    char line[400], how[64];
    first_line(video->log, line, sizeof line);
    if (status != -1 && WIFSIGNALED(status)) {
        snprintf(how, sizeof how, "was stopped by signal %d", WTERMSIG(status));
    } else {
        snprintf(how, sizeof how, "ended with code %d", status == -1 ? -1 : WEXITSTATUS(status));
    }
    return ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": the ffmpeg program %s%s%s", video->path, how,
                    line[0] != '\0' ? ": " : "", line);
}

void ris_video_abandon(ris_video *video)
{
    if (video == NULL) {
        return;
    }
    if (video->pid > 0) {
        kill(video->pid, SIGKILL);
    }
    (void)end_program(video);
    if (video->temporary[0] != '\0' && strcmp(video->temporary, video->path) != 0) {
        unlink(video->temporary);
    }
    if (video->log != NULL) {
        fclose(video->log);
    }
    free(video);
}

/* Runs argv with in_fd as input, what it says in the log, and default signals; returns 0 or an errno. */
static int spawn(ris_video *video, int in_fd, char *const *argv)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, defaults;
    sigemptyset(&none);
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, in_fd, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (video->log != NULL) {
        posix_spawn_file_actions_adddup2(&actions, fileno(video->log), STDERR_FILENO);
    }
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    int failure = posix_spawnp(&video->pid, "ffmpeg", &actions, &attributes, argv, environ);
    if (failure != 0) {
        video->pid = 0;
    }
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return failure;
}

/* Starts ffmpeg for raw frames from in_fd; returns 0 or an errno. */
static int start_program(ris_video *video, int in_fd, uint32_t fps)
{
    char size[32], rate[16];
    snprintf(size, sizeof size, "%ux%u", (unsigned)video->width, (unsigned)video->height);
    snprintf(rate, sizeof rate, "%u", (unsigned)fps);
    char target[RIS_PATH_SIZE + 8];
    snprintf(target, sizeof target, "file:%s", video->temporary);
    char *const argv[] = {"ffmpeg",
                          "-xerror",
                          "-nostdin",
                          "-loglevel",
                          "error",
                          "-y",
                          "-f",
                          "rawvideo",
                          "-pixel_format",
                          "rgba",
                          "-video_size",
                          size,
                          "-framerate",
                          rate,
                          "-i",
                          "pipe:0",
                          "-vf",
                          "scale=out_color_matrix=bt709:out_range=tv",
                          "-c:v",
                          "libx264",
                          "-preset",
                          "veryfast",
                          "-crf",
                          "18",
                          "-pix_fmt",
                          "yuv420p",
                          "-colorspace",
                          "bt709",
                          "-color_primaries",
                          "bt709",
                          "-color_trc",
                          "bt709",
                          "-f",
                          "mp4",
                          target,
                          NULL};
    return spawn(video, in_fd, argv);
}

/* Reserves the temporary file beside path, so that an unwritable place is told before ffmpeg starts. */
static ris_result reserve(ris_video *video, ris_error *err)
{
    char name[RIS_PATH_SIZE];
    ris_result result = ris__temporary_path(name, video->path, err);
    if (result != RIS_OK) {
        return result;
    }
    int fd = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (fd < 0) {
        return ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": %s", video->path, strerror(errno));
    }
    memcpy(video->temporary, name, sizeof name);
    close(fd);
    return RIS_OK;
}

ris_result ris_video_open(const char *path, uint32_t width, uint32_t height, uint32_t fps, ris_video **out,
                          ris_error *err)
{
    *out = NULL;
    if (width == 0 || height == 0 || width % 2 != 0 || height % 2 != 0 || width > 16384 || height > 16384) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "video \"%s\": the size must be even and at most 16384, found %ux%u", path,
                        (unsigned)width, (unsigned)height);
    }
    if (fps == 0 || fps > 1000) {
        return ris_fail(err, RIS_ERROR_USAGE, "video \"%s\": frames per second must be 1 to 1000, found %u",
                        path, (unsigned)fps);
    }
    int ends[2] = {-1, -1};
    ris_video *video = calloc(1, sizeof *video);
    if (video == NULL) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for video \"%s\"", path);
    }
    if ((size_t)snprintf(video->path, sizeof video->path, "%s", path) >= sizeof video->path) {
        free(video);
        return ris_fail(err, RIS_ERROR_USAGE, "the path of the video is longer than %d bytes",
                        RIS_PATH_SIZE - 1);
    }
    video->pipe = -1;
    video->width = width;
    video->height = height;
    ris_result result = reserve(video, err);
    if (result != RIS_OK) {
        goto fail;
    }
    video->log = tmpfile();
    if (pipe(ends) != 0) {
        result = ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": no pipe: %s", path, strerror(errno));
        goto fail;
    }
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    fcntl(ends[1], F_SETFD, FD_CLOEXEC);
    int failure = start_program(video, ends[0], fps);
    close(ends[0]);
    video->pipe = ends[1];
    if (failure == ENOENT) {
        result = ris_fail(err, RIS_ERROR_FAILED,
                          "cannot write \"%s\": the ffmpeg program was not found; install ffmpeg "
                          "or write PNG frames instead",
                          path);
        goto fail;
    }
    if (failure != 0) {
        result = ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": ffmpeg does not start: %s", path,
                          strerror(failure));
        goto fail;
    }
    *out = video;
    return RIS_OK;
fail:
    ris_video_abandon(video);
    return result;
}

ris_result ris_video_add(ris_video *video, const uint8_t *rgba, ris_error *err)
{
    if (video->failed) {
        return ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": an earlier frame failed", video->path);
    }
    int failure = write_all(video->pipe, rgba, (size_t)video->width * video->height * 4);
    if (failure == 0) {
        video->frames++;
        return RIS_OK;
    }
    video->failed = true;
    if (failure == EPIPE) {
        return fail_program(video, end_program(video), err);
    }
    return ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": %s", video->path, strerror(failure));
}

ris_result ris_video_close(ris_video *video, ris_error *err)
{
    ris_result result = RIS_OK;
    if (video->failed) {
        result = ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": a frame failed", video->path);
    } else if (video->frames == 0) {
        result = ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": it has no frames", video->path);
    } else {
        int status = end_program(video);
        char line[400];
        first_line(video->log, line, sizeof line);
        if (status != 0) {
            result = fail_program(video, status, err);
        } else if (line[0] != '\0') { /* it may end with 0 although its last write failed */
            result = ris_fail(err, RIS_ERROR_FAILED, "cannot write \"%s\": the ffmpeg program says: %s",
                              video->path, line);
        } else {
            result = ris__temporary_commit(video->temporary, video->path, err);
            video->temporary[0] = '\0';
        }
    }
    ris_video_abandon(video);
    return result;
}
