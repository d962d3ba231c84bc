/* risorius export HEAD: the skin of a held pose, or of a moment of a clip, as OBJ in the order of skin.obj. */
#include "backend.h"
#include "base/file.h"
#include "motion.h"
#include "player.h"
#include "risorius/output.h"

#include <stdlib.h>
#include <string.h>

typedef struct export_args {
    const char *head, *pose, *at, *out, *set;
    motion_words motion;
    ris_word_kind kind; /* of set */
    bool parts;
} export_args;

/* Brings the simulation to the state that is asked for. */
static ris_result reach(const ris_backend *backend, const ris_cli *cli, const export_args *args,
                        ris_error *err)
{
    const ris_model *model = backend->model;
    ris_clip *clip = NULL;
    ris_player player = {0};
    double time_s = 0;
    float *pose = calloc(model->channel_count + 1u, sizeof *pose);
    ris_result r = pose ? RIS_OK : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    if (!r && motion_file(&args->motion)) {
        r = motion_load(&args->motion, cli, model, &clip, err);
        if (!r) {
            r = cli_number("at", args->at, 0, ris_clip_duration_s(clip), &time_s, err);
        }
        if (!r) {
            motion_start(&args->motion, backend->sim);
            r = player_init(&player, backend->sim, clip, NULL, err);
        }
        while (!r && player.tick < player_tick_at(time_s)) {
            r = player_tick(&player, err);
            if (!r) {
                r = interrupt_check(err);
            }
        }
    } else if (!r) {
        if (args->pose) {
            r = ris_pose_parse(model, args->pose, pose, err);
        }
        if (!r) {
            r = ris_sim_settle(backend->sim, pose, &time_s, err);
        }
    }
    player_finish(&player);
    ris_clip_destroy(clip);
    free(pose);
    return r;
}

/* Writes the skin and, with --parts, everything else, as objects of one file. */
static ris_result write_obj(const ris_backend *backend, const export_args *args, const char *path,
                            ris_error *err)
{
    const ris_head *head = backend->model->head;
    uint32_t node_count = backend->model->node_count, part_count = args->parts ? head->part_count : 0;
    ris_obj_object *object = calloc(part_count + 1u, sizeof *object);
    ris_vec4 **place = calloc(part_count + 1u, sizeof *place);
    ris_result r = RIS_OK;
    if (!object || !place || !(place[0] = calloc(node_count, sizeof **place))) {
        r = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for %u vertices", node_count);
        goto fail;
    }
    r = ris_sim_read(backend->sim, RIS_STATE_POSITION, place[0], err);
    object[0] = (ris_obj_object){"skin", &head->skin, place[0]};
    for (uint32_t i = 0; !r && i < part_count; i++) {
        const ris_mesh *mesh = &head->part[i].mesh;
        place[i + 1] = calloc(mesh->vertex_count, sizeof **place);
        if (!place[i + 1]) {
            r = ris_fail(err, RIS_ERROR_MEMORY, "out of memory for part '%s'", head->part[i].name);
            goto fail;
        }
        r = ris_sim_part(backend->sim, i, place[0], place[i + 1], err);
        object[i + 1] = (ris_obj_object){head->part[i].name, mesh, place[i + 1]};
    }
    if (!r) {
        r = interrupt_check(err);
    }
    if (!r) {
        r = ris_obj_write(path, object, part_count + 1u, err);
    }
fail:
    for (uint32_t i = 0; place && i <= part_count; i++) {
        free(place[i]);
    }
    free(place);
    free(object);
    return r;
}

/* One file of the set: a word held at 1, or the neutral head (name NULL). */
static ris_result write_word(const ris_backend *backend, const export_args *args, const char *name,
                             float *pose, ris_error *err)
{
    const ris_model *model = backend->model;
    char file[RIS_NAME_SIZE + 8], path[RIS_PATH_SIZE];
    snprintf(file, sizeof file, "%s.obj", name ? name : "neutral");
    for (uint32_t c = 0; c < model->channel_count; c++) {
        pose[c] = 0;
    }
    ris_result r = ris__path_join(path, args->out, file, err);
    if (!r && name) {
        r = ris_pose_add(model, name, 1, pose, err);
        ris_pose_clamp(model, pose);
    }
    if (!r) {
        r = ris_sim_reset(backend->sim, err);
    }
    if (!r) {
        r = ris_sim_settle(backend->sim, pose, NULL, err);
    }
    return r ? r : write_obj(backend, args, path, err);
}

/* The neutral head and every word of a vocabulary, a file each. */
static ris_result write_set(const ris_backend *backend, const ris_cli *cli, const export_args *args,
                            ris_error *err)
{
    const ris_vocabulary *words = &backend->model->vocabulary;
    float *pose = calloc(backend->model->channel_count + 1u, sizeof *pose);
    uint32_t written = 0;
    ris_progress bar;
    ris_result r = pose ? ris__directory_make(args->out, err)
                        : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    progress_start(&bar, cli, "export");
    for (uint32_t i = 0; !r && i <= words->word_count; i++) {
        const ris_word *word = i ? &words->word[i - 1] : NULL;
        progress_show(&bar, i, words->word_count + 1);
        if (!word || word->kind == args->kind) {
            r = write_word(backend, args, word ? word->name : NULL, pose, err);
            written += !r;
        }
        r = r ? r : interrupt_check(err);
    }
    progress_end(&bar);
    free(pose);
    if (!r && !cli->quiet) {
        fprintf(stderr, "wrote %u files in %s (%s)\n", written, args->out, ris_sim_backend(backend->sim));
    }
    return r;
}

static ris_result check_set(export_args *args, ris_error *err)
{
    if (args->pose || motion_file(&args->motion) || args->at) {
        return ris_fail(err, RIS_ERROR_USAGE, "export --set makes its own poses");
    }
    return cli_set(args->set, &args->kind, err);
}

static ris_result check_args(export_args *args, ris_error *err)
{
    if (!args->out) {
        return ris_fail(err, RIS_ERROR_USAGE, "export needs -o FILE.obj, or --set WORDS -o DIR");
    }
    if (args->pose && motion_file(&args->motion)) {
        return ris_fail(err, RIS_ERROR_USAGE, "export takes --pose or a motion, not both");
    }
    if (!motion_file(&args->motion) != !args->at) {
        return ris_fail(err, RIS_ERROR_USAGE, "export --clip C and --at T belong together");
    }
    if (args->set) {
        return check_set(args, err);
    }
    return motion_check(&args->motion, err);
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    export_args args = {0};
    const cli_option options[] = {
        {"pose", 'p', "POSE", "name=value[,name=value...]; without it the neutral head at rest", NULL,
         &args.pose, NULL},
        MOTION_OPTIONS(&args.motion),
        {"at", 't', "SECONDS", "the moment of the motion", NULL, &args.at, NULL},
        {"output", 'o', "FILE.obj", "the file to write", NULL, &args.out, NULL},
        {"set", 0, "WORDS",
         "facs, arkit, visemes or expressions: each name held at 1, as DIR/NAME.obj with -o DIR", NULL,
         &args.set, NULL},
        {"parts", 0, NULL, "eyes, teeth, tongue and the rest too", &args.parts, NULL, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_export, options, argc, argv, &args.head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    r = cli_need_head(&cmd_export, count, err);
    if (!r) {
        r = check_args(&args, err);
    }
    if (r) {
        return r;
    }
    ris_backend backend;
    r = backend_open(&backend, cli, args.head, &(backend_need){.sim = true}, err);
    if (!r && args.set) {
        r = write_set(&backend, cli, &args, err);
    } else if (!r) {
        r = reach(&backend, cli, &args, err);
        r = r ? r : write_obj(&backend, &args, args.out, err);
    }
    if (!r && !args.set && !cli->quiet) {
        fprintf(stderr, "wrote %s (%s)\n", args.out, ris_sim_backend(backend.sim));
    }
    backend_close(&backend);
    return r;
}

const cli_command cmd_export = {
    .name = "export",
    .usage = "HEAD [--pose P | --clip C --at T] -o FILE.obj [--parts], or HEAD --set WORDS -o DIR",
    .summary = "write the skin of a held pose or of a moment of a clip as OBJ",
    .detail = "A pose is held until no vertex is faster than 0.1 mm/s for 0.25 s of simulated time; if that "
              "is not\n"
              "reached in 20 s the command fails and names the vertex. Vertices keep the order of skin.obj, "
              "in mm.\n",
    .run = run,
};
