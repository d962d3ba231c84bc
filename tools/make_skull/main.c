/* risorius-make-skull HEAD_DIR: writes skull.obj, mandible.obj and landmarks.json into HEAD_DIR and prints
 * what they
 * keep to (KA-04, KA-07). */
#include "make_skull.h"

#include "base/file.h"
#include "risorius/head.h"

#include <stdio.h>
#include <string.h>

static const char usage[] =
    "Usage: risorius-make-skull HEAD_DIR [--tables FILE] [-o DIR] [--step MM]\n"
    "Builds skull and mandible from signed-distance shapes under HEAD_DIR/skin.obj, fits them to the tissue\n"
    "depths of FILE (HEAD_DIR/../tables/tissue_depth.csv) and writes skull.obj, mandible.obj and "
    "landmarks.json\n"
    "into DIR (HEAD_DIR). --step is the width of the meshing lattice, 1.25 mm unless told.\n";

typedef struct job {
    const char *head, *out;
    char tables[RIS_PATH_SIZE];
    double step;
    ris_jaw_def jaw;
    hull skin;
    depth_grid depth;
    solid solid[2];
    tri_mesh bone[2], teeth[2];
    bvh tree[2];
    site site[SITE_LIMIT];
    uint32_t site_count;
    landmark_set landmark;
} job;

static const char *const names[2] = {"skull", "mandible"};
static const uint32_t half_triangles[2] = {12400, 5200};

static ris_result parse_arguments(job *j, int argc, char **argv, ris_error *err)
{
    const char *tables = NULL;
    j->step = 1.25;
    for (int i = 1; i < argc; i++) {
        bool more = i + 1 < argc;
        if (strcmp(argv[i], "--tables") == 0 && more)
            tables = argv[++i];
        else if (strcmp(argv[i], "-o") == 0 && more)
            j->out = argv[++i];
        else if (strcmp(argv[i], "--step") == 0 && more && sscanf(argv[i + 1], "%lf", &j->step) == 1 &&
                 j->step >= 0.8 && j->step <= 4)
            i++;
        else if (argv[i][0] != '-' && !j->head)
            j->head = argv[i];
        else
            return ris_fail(err, RIS_ERROR_USAGE, "unknown or incomplete argument \"%s\"; see --help",
                            argv[i]);
    }
    if (!j->head)
        return ris_fail(err, RIS_ERROR_USAGE, "no HEAD_DIR; see --help");
    j->out = j->out ? j->out : j->head;
    return tables ? ris__path_join(j->tables, "", tables, err)
                  : ris__path_join(j->tables, j->head, "../tables/tissue_depth.csv", err);
}

static ris_result load(job *j, ris_error *err)
{
    ris_head head;
    ris_result result = ris_head_load(j->head, &head, err);
    if (result != RIS_OK)
        return result;
    j->jaw = head.jaw;
    ris_head_finish(&head);
    static const char *const teeth[2] = {"teeth_upper.obj", "teeth_lower.obj"};
    char path[RIS_PATH_SIZE];
    for (int k = 0; k < 2 && result == RIS_OK; k++) {
        result = ris__path_join(path, j->head, teeth[k], err);
        if (result == RIS_OK)
            result = ris__tri_load_obj(path, &j->teeth[k], err);
    }
    j->site_count = sites_default(j->site);
    if (result == RIS_OK)
        result = sites_read_table(j->tables, j->site, j->site_count, err);
    if (result == RIS_OK)
        result = hull_load(j->head, &j->skin, err);
    if (result == RIS_OK)
        result = depth_grid_build(&j->depth, &j->skin, 3, err);
    return result;
}

static ris_result build(job *j, ris_error *err)
{
    ris_result result = RIS_OK;
    for (int k = 0; k < 2 && result == RIS_OK; k++) {
        result = solid_init(&j->solid[k], names[k], err);
        j->solid[k].skin = &j->depth;
        j->solid[k].clearance = k ? mandible_clearance : skull_clearance;
    }
    if (result != RIS_OK)
        return result;
    skull_shapes(&j->solid[0]);
    mandible_shapes(&j->solid[1]);
    fit_sites(j->solid, &j->skin, j->site, j->site_count);
    static const dvec low[2] = {{0, -50, -94}, {0, -96, -2}}, high[2] = {{78, 140, 102}, {64, 4, 94}};
    for (int k = 0; k < 2 && result == RIS_OK; k++) {
        tri_mesh half = {0};
        result = mesh_half(&j->solid[k], low[k], high[k], j->step, &half, err);
        if (result == RIS_OK) {
            mesh_project(&half, &j->solid[k], 0.6 * j->step);
            result = mesh_keep_largest(&half, err);
        }
        if (result == RIS_OK)
            result = mesh_simplify(&half, half_triangles[k], err);
        if (result == RIS_OK) {
            mesh_project(&half, &j->solid[k], 0.3);
            mesh_round(&half);
            result = mesh_mirror(&half, &j->bone[k], err);
        }
        ris__tri_finish(&half);
        if (result == RIS_OK)
            result = ris__bvh_build(&j->tree[k], &j->bone[k], err);
    }
    return result;
}

static ris_result write_all(job *j, ris_error *err)
{
    static const char *const comment[2] = {
        "Skull without mandible, from signed-distance shapes (risorius-make-skull); mm, CC0",
        "Mandible at rest, from signed-distance shapes (risorius-make-skull); mm, CC0"};
    char path[RIS_PATH_SIZE], name[32];
    ris_result result = RIS_OK;
    for (int k = 0; k < 2 && result == RIS_OK; k++) {
        snprintf(name, sizeof name, "%s.obj", names[k]);
        result = ris__path_join(path, j->out, name, err);
        if (result == RIS_OK)
            result = tri_write_obj(path, comment[k], &j->bone[k], err);
        printf("%-22s%u vertices, %u triangles\n", names[k], j->bone[k].vertex_count,
               j->bone[k].triangle_count);
    }
    if (result == RIS_OK)
        result = ris__path_join(path, j->out, "landmarks.json", err);
    if (result == RIS_OK)
        result = landmarks_write(path, &j->landmark, err);
    return result;
}

static ris_result run(job *j, ris_error *err)
{
    ris_result result = load(j, err);
    if (result == RIS_OK)
        result = build(j, err);
    if (result == RIS_OK)
        result = landmarks_place(&j->landmark, &j->skin, j->bone, j->tree, j->site, j->site_count, err);
    if (result != RIS_OK)
        return result;
    dvec point = dv(j->jaw.point.x, j->jaw.point.y, j->jaw.point.z),
         axis = dv(j->jaw.axis.x, j->jaw.axis.y, j->jaw.axis.z);
    j->landmark.jaw_point = point;
    j->landmark.jaw_axis = dv_unit(axis);
    skull_input in = {&j->skin, j->bone, j->tree, j->teeth, &j->landmark, point, dv_unit(axis)};
    skull_report report;
    result = skull_measure(&in, &report, err);
    if (result == RIS_OK)
        result = write_all(j, err);
    if (result != RIS_OK)
        return result;
    printf("landmarks             %u on the skin, %u on bone\n", j->landmark.skin_count,
           j->landmark.bone_count);
    for (uint32_t i = 0; i < j->landmark.bone_count; i++) {
        const landmark *l = &j->landmark.bone[i];
        if (l->table_mm > 0 && !strstr(l->name, ".R"))
            printf("  %-8s depth %5.1f mm, table %5.2f, %+5.1f %%\n", l->name, l->depth_mm, l->table_mm,
                   100 * (l->depth_mm - l->table_mm) / l->table_mm);
    }
    skull_print(&report);
    return skull_accept(&report, err) ? RIS_OK : err->code;
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
        fprintf(stderr, "risorius-make-skull: %s\n", err.text);
    hull_finish(&j.skin);
    depth_grid_finish(&j.depth);
    for (int k = 0; k < 2; k++) {
        ris__bvh_finish(&j.tree[k]);
        ris__tri_finish(&j.bone[k]);
        ris__tri_finish(&j.teeth[k]);
        solid_finish(&j.solid[k]);
    }
    return ris_exit_code(result);
}
