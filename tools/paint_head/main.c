/* risorius-paint-head: paints the textures of a head folder. */
#include "paint.h"

#include "base/file.h"

#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: risorius-paint-head HEAD [--size N] [--eye-size N] [--iris MM] [--ball MM] [--pupil MM]\n"
    "Paints skin.png, skin_detail.png, skin_wrinkles.png, eye.png, teeth.png, gum.png and tongue.png into\n"
    "the folder HEAD from its skin.obj and, where head.json names them, eyes and brows. N: 64..8192 (2048; "
    "eye 1024).\n";

typedef struct options {
    const char *head;
    uint32_t size, eye_size;
    ris_paint_eye eye;
    bool help;
} options;

static bool read_size(const char *text, uint32_t *out)
{
    char *end = NULL;
    const long value = strtol(text, &end, 10);
    *out = (uint32_t)value;
    return *text && !*end && value >= 64 && value <= 8192;
}

static bool read_mm(const char *text, float *out)
{
    char *end = NULL;
    *out = strtof(text, &end);
    return *text && !*end && *out > 0 && *out < 100;
}

static bool read_options(int argc, char **argv, options *out)
{
    *out = (options){.size = 2048, .eye_size = 1024, .eye = {14.95f, 5.9f, 2.1f}};
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i];
        if (strcmp(name, "--help") == 0)
            return out->help = true;
        if (name[0] != '-' && !out->head) {
            out->head = name;
            continue;
        }
        if (++i >= argc)
            return false;
        const bool good = strcmp(name, "--size") == 0       ? read_size(argv[i], &out->size)
                          : strcmp(name, "--eye-size") == 0 ? read_size(argv[i], &out->eye_size)
                          : strcmp(name, "--iris") == 0     ? read_mm(argv[i], &out->eye.iris_radius_mm)
                          : strcmp(name, "--ball") == 0     ? read_mm(argv[i], &out->eye.ball_radius_mm)
                          : strcmp(name, "--pupil") == 0    ? read_mm(argv[i], &out->eye.pupil_radius_mm)
                                                            : false;
        if (!good)
            return false;
    }
    return out->head != NULL;
}

enum { MAX_EXTRA = 16 };

/* Meshes of the parts that shade the skin (eyes) or sit on it (brows). */
typedef struct parts {
    ris_mesh eye[MAX_EXTRA], brow[MAX_EXTRA];
    uint32_t eye_count, brow_count;
} parts;

static ris_result load_parts(const char *head, parts *out, ris_error *err)
{
    char path[RIS_PATH_SIZE];
    ris_result result = ris__path_join(path, head, "head.json", err);
    json_error_t where;
    json_t *root = result ? NULL : json_load_file(path, 0, &where);
    if (!root)
        return result; /* a folder without head.json has no parts yet */
    json_t *list = json_object_get(root, "parts"), *part;
    size_t index;
    json_array_foreach(list, index, part)
    {
        const char *name = json_string_value(json_object_get(part, "name"));
        const char *mesh = json_string_value(json_object_get(part, "mesh"));
        if (!name || !mesh)
            continue;
        const bool eye = strncmp(name, "eye", 3) == 0 && !strstr(name, "lash") && !strstr(name, "brow");
        const bool brow = strstr(name, "brow") != NULL;
        ris_mesh *slot = eye && out->eye_count < MAX_EXTRA     ? &out->eye[out->eye_count]
                         : brow && out->brow_count < MAX_EXTRA ? &out->brow[out->brow_count]
                                                               : NULL;
        if (!slot)
            continue;
        if ((result = ris__path_join(path, head, mesh, err)) || (result = ris_mesh_load_obj(path, slot, err)))
            break;
        out->eye_count += eye ? 1 : 0;
        out->brow_count += eye ? 0 : 1;
    }
    json_decref(root);
    return result;
}

static void free_parts(parts *all)
{
    for (uint32_t i = 0; i < all->eye_count; i++)
        ris_mesh_finish(&all->eye[i]);
    for (uint32_t i = 0; i < all->brow_count; i++)
        ris_mesh_finish(&all->brow[i]);
}

static ris_result save(const char *head, const char *name, ris_paint_image *image, ris_error *err)
{
    char path[RIS_PATH_SIZE];
    ris_result result = ris__path_join(path, head, name, err);
    if (!result)
        result = ris_paint_image_save(image, path, err);
    if (!result)
        printf("%s: %u x %u\n", path, image->width, image->height);
    ris_paint_image_finish(image);
    return result;
}

static ris_result paint_skin(const options *opt, ris_error *err)
{
    char path[RIS_PATH_SIZE];
    parts all = {0};
    ris_mesh mesh = {0};
    ris_paint_surface surface = {0};
    ris_paint_skin_images images = {0};
    ris_result result = ris__path_join(path, opt->head, "skin.obj", err);
    if (result || (result = ris_mesh_load_obj(path, &mesh, err)) ||
        (result = load_parts(opt->head, &all, err)) ||
        (result = ris_paint_surface_init(&surface, &mesh, all.eye, all.eye_count, all.brow, all.brow_count,
                                         err)) ||
        (result = ris_paint_atlas(&surface, opt->size, &images, err)) ||
        (result = save(opt->head, "skin.png", &images.color, err)) ||
        (result = save(opt->head, "skin_detail.png", &images.detail, err)))
        goto done;
    result = save(opt->head, "skin_wrinkles.png", &images.wrinkles, err);
done:
    ris_paint_skin_images_finish(&images);
    ris_paint_surface_finish(&surface);
    ris_mesh_finish(&mesh);
    free_parts(&all);
    return result;
}

static ris_result paint_all(const options *opt, ris_error *err)
{
    ris_paint_image image = {0};
    ris_result result = paint_skin(opt, err);
    if (result || (result = ris_paint_eye_image(&opt->eye, opt->eye_size, &image, err)) ||
        (result = save(opt->head, "eye.png", &image, err)) ||
        (result = ris_paint_teeth_image(512, &image, err)) ||
        (result = save(opt->head, "teeth.png", &image, err)) ||
        (result = ris_paint_gum_image(256, &image, err)) ||
        (result = save(opt->head, "gum.png", &image, err)) ||
        (result = ris_paint_tongue_image(512, &image, err)))
        return result;
    return save(opt->head, "tongue.png", &image, err);
}

int main(int argc, char **argv)
{
    options opt;
    if (!read_options(argc, argv, &opt)) {
        fputs(usage, stderr);
        return ris_exit_code(RIS_ERROR_USAGE);
    }
    if (opt.help) {
        fputs(usage, stdout);
        return 0;
    }
    signal(SIGXFSZ, SIG_IGN); /* a full disk is an error, not an end */
    ris_error err = {0};
    if (paint_all(&opt, &err))
        fprintf(stderr, "risorius-paint-head: %s\n", err.text);
    return ris_exit_code(err.code);
}
