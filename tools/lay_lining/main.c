/* risorius-lay-lining HEAD_DIR: moves the vertices of the lining of the mouth in skin.obj off bone and teeth. Every other
 * byte of the file stays. */
#include "lay_lining.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LAID_MM 0.5 /* a lining this far off bone and teeth everywhere is laid already */

static const char usage[] = "Usage: risorius-lay-lining HEAD_DIR [-o DIR]\n"
                            "Lays the lining of the mouth (region mouth_cavity behind the rim of the lips) "
                            "of HEAD_DIR/skin.obj over skull,\n"
                            "mandible, teeth and tongue, and writes skin.obj into DIR (HEAD_DIR). A lining "
                            "that is clear of bone and teeth is\n"
                            "left as it is.\n";

typedef struct job {
    const char *head_path, *out;
    ris_head head;
    tri_mesh mesh[BODY_COUNT];
    bvh tree[BODY_COUNT];
    lining lining;
    bool laid; /* by this run */
} job;

static ris_result parse_arguments(job *j, int argc, char **argv, ris_error *err)
{
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "-o") == 0 && i + 1 < argc)
            j->out = argv[++i];
        else if (argv[i][0] != '-' && !j->head_path)
            j->head_path = argv[i];
        else
            return ris_fail(err, RIS_ERROR_USAGE, "unknown or incomplete argument \"%s\"; see --help",
                            argv[i]);
    }
    if (!j->head_path)
        return ris_fail(err, RIS_ERROR_USAGE, "no HEAD_DIR; see --help");
    j->out = j->out ? j->out : j->head_path;
    return RIS_OK;
}

static ris_result load(job *j, ris_error *err)
{
    static const char *const name[BODY_COUNT] = {"skull.obj", "mandible.obj", "teeth_upper.obj",
                                                 "teeth_lower.obj", "tongue.obj"};
    ris_result result = ris_head_load(j->head_path, &j->head, err);
    for (int k = 0; k < BODY_COUNT && result == RIS_OK; k++) {
        char path[RIS_PATH_SIZE];
        result = ris__path_join(path, j->head_path, name[k], err);
        if (result == RIS_OK)
            result = ris__tri_load_obj(path, &j->mesh[k], err);
        if (result == RIS_OK)
            result = ris__bvh_build(&j->tree[k], &j->mesh[k], err);
    }
    return result == RIS_OK ? lining_build(&j->lining, &j->head, j->tree, err) : result;
}

static double shown(double x)
{
    return fabs(x) < 5e-7 ? 0.0 : x;
}

/* Copies skin.obj line by line; the n-th "v" line is the n-th vertex. */
static void copy_lines(FILE *out, const char *text, const lining *l, bool laid)
{
    uint32_t vertex = 0;
    for (const char *line = text; *line;) {
        const char *end = strchr(line, '\n');
        const size_t length = end ? (size_t)(end - line) + 1 : strlen(line);
        const bool is_vertex = strncmp(line, "v ", 2) == 0;
        if (laid && is_vertex && vertex < l->count && l->moves[vertex]) {
            const dvec p = l->at[vertex];
            fprintf(out, "v %.6f %.6f %.6f\n", shown(p.x), shown(p.y), shown(p.z));
        } else
            fwrite(line, 1, length, out);
        vertex += is_vertex;
        line += length;
    }
}

static ris_result write_skin(const job *j, ris_error *err)
{
    char from[RIS_PATH_SIZE], to[RIS_PATH_SIZE], part[RIS_PATH_SIZE];
    ris_result result = ris__path_join(from, j->head_path, "skin.obj", err);
    if (result == RIS_OK)
        result = ris__path_join(to, j->out, "skin.obj", err);
    if (result == RIS_OK)
        result = ris__path_join(part, j->out, "skin.obj.part", err);
    FILE *in = result == RIS_OK ? fopen(from, "rb") : NULL;
    if (!in)
        return result ? result : ris_fail(err, RIS_ERROR_FAILED, "cannot read %s", from);
    fseek(in, 0, SEEK_END);
    const long size = ftell(in);
    rewind(in);
    char *text = calloc(size > 0 ? (size_t)size + 1 : 1, 1);
    const bool read = text && size > 0 && fread(text, 1, (size_t)size, in) == (size_t)size;
    fclose(in);
    FILE *out = read ? fopen(part, "wb") : NULL;
    bool good = out != NULL;
    if (out) {
        copy_lines(out, text, &j->lining, j->laid);
        good = !ferror(out);
        good = fclose(out) == 0 && good && rename(part, to) == 0;
    }
    free(text);
    return good ? RIS_OK : ris_fail(err, RIS_ERROR_FAILED, "cannot write %s", to);
}

static void print(const char *when, const lining_report *r)
{
    printf("%-8s vertices %6.2f mm (%u buried), midpoints of edges %6.2f mm (%u buried), moved %.2f mm\n",
           when, r->vertex_mm, r->buried, r->midpoint_mm, r->buried_midpoints, r->moved_mm);
    printf("         worst vertex %u, edge %u-%u\n", r->vertex, r->edge[0], r->edge[1]);
}

static ris_result run(job *j, ris_error *err)
{
    ris_result result = load(j, err);
    if (result != RIS_OK)
        return result;
    lining_report r = lining_measure(&j->lining);
    print("before", &r);
    if (r.vertex_mm < LAID_MM || r.midpoint_mm < 0) {
        result = lining_lay(&j->lining, err);
        j->laid = true;
        r = lining_measure(&j->lining);
        print("laid", &r);
    }
    return result == RIS_OK ? write_skin(j, err) : result;
}

int main(int argc, char **argv)
{
    static job j;
    ris_error err = {0};
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        fputs(usage, stdout);
        return 0;
    }
    ris_result result = parse_arguments(&j, argc, argv, &err);
    if (result == RIS_OK)
        result = run(&j, &err);
    if (result != RIS_OK)
        fprintf(stderr, "risorius-lay-lining: %s\n", err.text);
    lining_finish(&j.lining);
    for (int k = 0; k < BODY_COUNT; k++) {
        ris__bvh_finish(&j.tree[k]);
        ris__tri_finish(&j.mesh[k]);
    }
    ris_head_finish(&j.head);
    return ris_exit_code(result);
}
