#include "render_out.h"
#include "base/file.h"

#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n > m && strcmp(text + n - m, end) == 0;
}

/* The one %d or %0Nd of a pattern: its place and width. False if there is another use of %. */
static bool find_number(const char *pattern, size_t *out_start, size_t *out_end, int *out_width)
{
    const char *percent = strchr(pattern, '%');
    if (!percent || strchr(percent + 1, '%')) {
        return false;
    }
    const char *c = percent + 1;
    *out_width = 1;
    if (*c == '0' && c[1] >= '1' && c[1] <= '9') {
        *out_width = c[1] - '0';
        c += 2;
    }
    *out_start = (size_t)(percent - pattern);
    *out_end = (size_t)(c + 1 - pattern);
    return *c == 'd';
}

ris_result render_out_name(render_out *out, const char *path, ris_error *err)
{
    *out = (render_out){.path = path};
    if (strlen(path) >= RIS_PATH_SIZE - 16) {
        return ris_fail(err, RIS_ERROR_USAGE, "-o: the name is longer than %d bytes", RIS_PATH_SIZE - 16);
    }
    if (ends_with(path, ".mp4")) {
        out->kind = RENDER_MP4;
    } else if (ends_with(path, ".pc2")) {
        out->kind = RENDER_PC2;
    } else if (ends_with(path, ".png")) {
        size_t start, end;
        int width;
        out->kind = strchr(path, '%') ? RENDER_PNG_SEQUENCE : RENDER_PNG;
        if (out->kind == RENDER_PNG_SEQUENCE && !find_number(path, &start, &end, &width)) {
            return ris_fail(err, RIS_ERROR_USAGE,
                            "-o: a picture sequence needs one %%d or %%0Nd in its name, found '%s'", path);
        }
        if (out->kind == RENDER_PNG_SEQUENCE && strchr(path + start, '/')) {
            return ris_fail(err, RIS_ERROR_USAGE,
                            "-o: the number of a picture sequence belongs in the file name, found '%s'",
                            path);
        }
    } else {
        return ris_fail(err, RIS_ERROR_USAGE, "-o: expected a name ending in .mp4, .png or .pc2, found '%s'",
                        path);
    }
    return RIS_OK;
}

bool render_out_draws(const render_out *out)
{
    return out->kind != RENDER_PC2;
}

static void frame_path(const render_out *out, uint32_t frame, char path[RIS_PATH_SIZE])
{
    size_t start = 0, end = 0;
    int width = 1;
    find_number(out->path, &start, &end, &width);
    snprintf(path, RIS_PATH_SIZE, "%.*s%0*u%s", (int)start, out->path, width, frame, out->path + end);
}

/* Folder of the sequence, "" for the current one. */
static void folder_path(const render_out *out, char path[RIS_PATH_SIZE])
{
    const char *slash = strrchr(out->path, '/');
    snprintf(path, RIS_PATH_SIZE, "%.*s", slash ? (int)(slash - out->path) : 0, out->path);
}

ris_result render_out_open(render_out *out, uint32_t width, uint32_t height, uint32_t fps,
                           uint32_t node_count, ris_error *err)
{
    ris_result r = RIS_OK;
    out->width = width;
    out->height = height;
    if (out->kind == RENDER_MP4) {
        r = ris_video_open(out->path, width, height, fps, &out->video, err);
    } else if (out->kind == RENDER_PC2) {
        r = ris_pc2_open(out->path, node_count, 0.0f, 1.0f, &out->cache, err);
    } else if (out->kind == RENDER_PNG_SEQUENCE) {
        char folder[RIS_PATH_SIZE];
        folder_path(out, folder);
        struct stat status;
        if (folder[0] && stat(folder, &status) != 0) {
            r = ris__directory_make(folder, err);
            out->made_directory = !r;
        }
    }
    out->open = !r;
    return r;
}

ris_result render_out_frame(render_out *out, const uint8_t *rgba, const ris_vec4 *position, ris_error *err)
{
    ris_result r = RIS_OK;
    if (out->kind == RENDER_MP4) {
        r = ris_video_add(out->video, rgba, err);
    } else if (out->kind == RENDER_PC2) {
        r = ris_pc2_add(out->cache, position, err);
    } else if (out->kind == RENDER_PNG_SEQUENCE) {
        char path[RIS_PATH_SIZE];
        frame_path(out, out->frames, path);
        r = ris_png_write(path, rgba, out->width, out->height, err);
    } else {
        r = ris_png_write(out->path, rgba, out->width, out->height, err);
    }
    out->frames += !r;
    return r;
}

ris_result render_out_close(render_out *out, ris_error *err)
{
    ris_result r = RIS_OK;
    if (out->kind == RENDER_MP4) {
        r = ris_video_close(out->video, err);
        out->video = NULL;
    } else if (out->kind == RENDER_PC2) {
        r = ris_pc2_close(out->cache, err);
        out->cache = NULL;
    }
    out->open = false;
    return r;
}

void render_out_abandon(render_out *out)
{
    if (!out->open) {
        return;
    }
    if (out->kind == RENDER_MP4) {
        ris_video_abandon(out->video);
    } else if (out->kind == RENDER_PC2) {
        ris_pc2_abandon(out->cache);
    } else if (out->kind == RENDER_PNG_SEQUENCE) {
        char path[RIS_PATH_SIZE];
        for (uint32_t i = 0; i < out->frames; i++) {
            frame_path(out, i, path);
            unlink(path);
        }
        if (out->made_directory) {
            folder_path(out, path);
            rmdir(path);
        }
    }
    out->open = false;
}
