/* risorius info HEAD: counts, springs, stable time step, muscles and channels of a head. */
#include "backend.h"

static const char *tissue_name(const ris_model *model)
{
    return model->head->tissue.model == RIS_TISSUE_KAEHLER ? "kaehler" : "risorius";
}

static uint32_t muscle_nodes(const ris_model *model, uint32_t muscle)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < model->binding_start[model->node_count]; i++) {
        count += model->binding[i].muscle == muscle;
    }
    return count;
}

static const char *const kind_name[RIS_WORD_KINDS] = {"units", "shapes", "visemes", "expressions"};

/* How many words of a kind there are, and the names of those for which the head lacks a muscle or channel. */
static void print_vocabulary(const ris_model *model)
{
    const ris_vocabulary *vocabulary = &model->vocabulary;
    printf("vocabulary  ");
    for (int kind = 0; kind < RIS_WORD_KINDS; kind++) {
        uint32_t count = 0;
        for (uint32_t i = 0; i < vocabulary->word_count; i++) {
            count += (int)vocabulary->word[i].kind == kind;
        }
        printf("%s%u %s", kind ? ", " : "", count, kind_name[kind]);
    }
    const char *before = "; incomplete on this head: ";
    for (uint32_t i = 0; i < vocabulary->word_count; i++) {
        const ris_word *word = &vocabulary->word[i];
        if (word->missing_count > 0) {
            printf("%s%s%s", before, word->name, word->value_count == 0 ? " (empty)" : "");
            before = ", ";
        }
    }
    printf("\n");
}

static void print_terms(const ris_term *term, uint32_t count)
{
    for (uint32_t k = 0; k < count; k++) {
        printf("%s%s=%g", k ? "," : " ", term[k].channel, (double)term[k].value);
    }
}

/* Tables for docs/facs.md. */
static void print_names(const ris_model *model)
{
    static const char *const title[RIS_WORD_KINDS] = {"Action units", "ARKit shapes", "Visemes",
                                                      "Expressions"};
    const ris_vocabulary *vocabulary = &model->vocabulary;
    int kind = -1;
    for (uint32_t i = 0; i < vocabulary->word_count; i++) {
        const ris_word *word = &vocabulary->word[i];
        if ((int)word->kind != kind) {
            kind = (int)word->kind;
            printf("\n## %s\n\n| name | title | made of | source |\n| --- | --- | --- | --- |\n",
                   title[kind]);
        }
        printf("| `%s` | %s |", word->name, word->title);
        for (uint32_t k = 0; k < word->term_count; k++) {
            printf("%s%s %g", k ? ", " : " ", word->term[k].channel, (double)word->term[k].value);
        }
        printf("%s | %s |\n",
               word->missing_count == 0 ? ""
               : word->value_count == 0 ? " (empty here)"
                                        : " (incomplete here)",
               word->source);
    }
}

static void print_json_names(const ris_model *model)
{
    const ris_vocabulary *vocabulary = &model->vocabulary;
    printf("  \"vocabulary\": [");
    for (uint32_t i = 0; i < vocabulary->word_count; i++) {
        const ris_word *word = &vocabulary->word[i];
        printf("%s\n    {\"name\": \"%s\", \"kind\": \"%s\", \"title\": ", i ? "," : "", word->name,
               kind_name[word->kind]);
        cli_json_string(stdout, word->title);
        printf(", \"missing\": %u, \"channels\": {", word->missing_count);
        for (uint32_t k = 0; k < word->value_count; k++) {
            printf("%s\"%s\": %.9g", k ? ", " : "", model->channel[word->value[k].channel].name,
                   (double)word->value[k].value);
        }
        printf("}}");
    }
    printf("\n  ],\n");
}

static void print_text(const char *path, const ris_model *model)
{
    const ris_head *head = model->head;
    const ris_tissue_def *tissue = &head->tissue;
    double dt_ms = 1000.0 / 60.0 / tissue->substeps;
    printf("head        %s\n", path);
    printf("skin        %u vertices, %u faces, %u triangles, %u texture coordinates\n", model->node_count,
           head->skin.face_count, model->triangle_count, head->skin.uv_count);
    printf("simulated   %u moving nodes (region '%s'), %u springs\n", model->moving_count, head->simulated,
           model->spring_count);
    printf("tissue      %s, node mass %.4g g, %u substeps of %.4f ms, stable up to %.4f ms\n",
           tissue_name(model), (double)model->mass_g, tissue->substeps, dt_ms,
           (double)model->stable_dt_s * 1000.0);
    printf("rig         %u muscles, %u fibres, %u control points, %u constraint groups\n",
           model->muscle_count, model->fiber_count, model->fiber_point_count, model->group_count);
    if (model->network_node_count > 0) {
        printf("network     %u nodes, %u springs between merged muscles\n", model->network_node_count,
               model->network_spring_count);
    }
    print_vocabulary(model);
    printf("muscles\n");
    for (uint32_t i = 0; i < model->muscle_count; i++) {
        const ris_muscle *m = &model->muscle[i];
        printf("  %-32s %-9s on %-6s %2u fibres x %2u points, shortens by up to %2.0f %%, acts on %u nodes\n",
               m->name, m->kind == RIS_MUSCLE_LINEAR ? "linear" : "sphincter", m->on_jaw ? "jaw" : "skull",
               m->fiber_count, m->point_count, (double)m->max_shortening * 100.0, muscle_nodes(model, i));
    }
    printf("channels\n");
    for (uint32_t i = model->muscle_count; i < model->channel_count; i++) {
        printf("  %-32s %g .. %g\n", model->channel[i].name, (double)model->channel[i].minimum,
               (double)model->channel[i].maximum);
    }
    printf("expressions\n");
    for (uint32_t i = 0; i < head->expression_count; i++) {
        printf("  %-32s", head->expression[i].name);
        print_terms(head->expression[i].term, head->expression[i].term_count);
        printf("\n");
    }
    printf("parts\n");
    for (uint32_t i = 0; i < head->part_count; i++) {
        printf("  %-32s %u vertices, %u faces\n", head->part[i].name, head->part[i].mesh.vertex_count,
               head->part[i].mesh.face_count);
    }
}

static void print_json_muscles(const ris_model *model)
{
    printf("  \"muscles\": [");
    for (uint32_t i = 0; i < model->muscle_count; i++) {
        const ris_muscle *m = &model->muscle[i];
        printf("%s\n    {\"name\": ", i ? "," : "");
        cli_json_string(stdout, m->name);
        printf(
            ", \"kind\": \"%s\", \"bone\": \"%s\", \"fibers\": %u, \"points\": %u, \"max_shortening\": %.6g, "
            "\"nodes\": %u}",
            m->kind == RIS_MUSCLE_LINEAR ? "linear" : "sphincter", m->on_jaw ? "jaw" : "skull",
            m->fiber_count, m->point_count, (double)m->max_shortening, muscle_nodes(model, i));
    }
    printf("\n  ],\n  \"channels\": [");
    for (uint32_t i = 0; i < model->channel_count; i++) {
        printf("%s\n    {\"name\": ", i ? "," : "");
        cli_json_string(stdout, model->channel[i].name);
        printf(", \"minimum\": %.9g, \"maximum\": %.9g}", (double)model->channel[i].minimum,
               (double)model->channel[i].maximum);
    }
    printf("\n  ],\n");
}

static void print_json(const char *path, const ris_model *model)
{
    const ris_head *head = model->head;
    printf("{\n  \"head\": ");
    cli_json_string(stdout, path);
    printf(",\n  \"vertices\": %u,\n  \"faces\": %u,\n  \"triangles\": %u,\n  \"uvs\": %u,\n",
           model->node_count, head->skin.face_count, model->triangle_count, head->skin.uv_count);
    printf("  \"moving_nodes\": %u,\n  \"springs\": %u,\n  \"tissue\": \"%s\",\n  \"node_mass_g\": %.9g,\n",
           model->moving_count, model->spring_count, tissue_name(model), (double)model->mass_g);
    printf("  \"substeps\": %u,\n  \"dt_s\": %.9g,\n  \"stable_dt_s\": %.9g,\n", head->tissue.substeps,
           1.0 / 60.0 / head->tissue.substeps, (double)model->stable_dt_s);
    print_json_muscles(model);
    print_json_names(model);
    printf("  \"expressions\": [");
    for (uint32_t i = 0; i < head->expression_count; i++) {
        printf("%s", i ? ", " : "");
        cli_json_string(stdout, head->expression[i].name);
    }
    printf("],\n  \"parts\": [");
    for (uint32_t i = 0; i < head->part_count; i++) {
        printf("%s", i ? ", " : "");
        cli_json_string(stdout, head->part[i].name);
    }
    printf("]\n}\n");
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    bool names = false;
    const cli_option options[] = {
        {.name = "names",
         .help = "print tables of action units, shapes, visemes and expressions instead",
         .flag = &names},
        {0}};
    const char *head = NULL;
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_info, options, argc, argv, &head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    r = cli_need_head(&cmd_info, count, err);
    if (r) {
        return r;
    }
    ris_backend backend;
    r = backend_open(&backend, cli, head, &(backend_need){0}, err);
    if (!r) {
        if (names && !cli->json) {
            print_names(backend.model);
        } else {
            (cli->json ? print_json : print_text)(head, backend.model);
        }
    }
    backend_close(&backend);
    return r;
}

const cli_command cmd_info = {
    .name = "info",
    .usage = "HEAD [--names] [--json]",
    .summary = "counts, springs, stable time step, muscles and channels of a head",
    .run = run,
};
