/* What `risorius solve` found, as text, as JSON and as a file. */
#include "solve.h"

#include "base/file.h"
#include "measure/measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool acts(const solve_run *run, uint32_t k)
{
    return run->found[k].value != 0.0f;
}

char *solve_pose_text(const solve_run *run)
{
    const size_t size = ((size_t)run->control_count + 1) * (RIS_NAME_SIZE + 32);
    char *text = calloc(size, 1);
    size_t used = 0;
    for (uint32_t k = 0; text && k < run->control_count; k++) {
        if (acts(run, k)) {
            used += (size_t)snprintf(text + used, size - used, "%s%s=%.6g", used ? "," : "",
                                     run->control[k].name, (double)run->found[k].value);
        }
    }
    if (text && !used) { /* --pose wants a word */
        snprintf(text, size, "%s=0", run->control[0].name);
    }
    return text;
}

/* "landmark ch.L", "vertex 12 (lips)" */
static const char *place(const solve_run *run, char *out, size_t size)
{
    const ris_model *model = run->backend.model;
    const uint32_t index = run->target.index[run->result.worst];
    if (run->target.landmarks) {
        snprintf(out, size, "landmark %s", model->head->landmark[index].name);
    } else {
        const char *region = ris__measure_region(model, index);
        snprintf(out, size, "vertex %u%s%s%s", index, *region ? " (" : "", region, *region ? ")" : "");
    }
    return out;
}

static void print_channels(const solve_run *run)
{
    uint32_t acting = 0;
    for (uint32_t k = 0; k < run->control_count; k++) {
        acting += acts(run, k);
    }
    printf("%u of %u channels act:\n", acting, run->control_count);
    if (acting) {
        printf("  %-40s %8s %10s %6s\n", "channel", "value", "reach mm", "share");
    }
    for (uint32_t k = 0; k < run->control_count; k++) {
        const ris_control_found *f = &run->found[k];
        if (acts(run, k)) {
            printf("  %-40s %8.4g %10.3f %6.2f%s\n", run->control[k].name, (double)f->value, f->reach_mm,
                   f->share, ris_control_independent(f) ? "" : "  dependent");
        }
    }
}

/* Those whose value the target does not tell. */
static void print_dependent(const solve_run *run)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < run->control_count; k++) {
        count += !ris_control_independent(&run->found[k]);
    }
    if (!count) {
        return;
    }
    printf(
        "%u dependent (a share below %g or a reach below %g mm: others can stand in, or the target does not "
        "show it):\n",
        count, RIS_INDEPENDENT_SHARE, RIS_INDEPENDENT_MM);
    uint32_t width = 0;
    for (uint32_t k = 0; k < run->control_count; k++) {
        if (!ris_control_independent(&run->found[k])) {
            const uint32_t length = (uint32_t)strlen(run->control[k].name) + 1;
            const bool wrap = width && width + length > 110;
            printf("%s%s", wrap ? "\n  " : width ? " " : "  ", run->control[k].name);
            width = wrap ? length : width + length;
        }
    }
    printf("\n");
}

void solve_print_text(const solve_run *run)
{
    const ris_solve_result *found = &run->result;
    char where[160];
    char *text = solve_pose_text(run);
    if (run->args.align) {
        printf("aligned: turned by %.3f degrees, moved by %.3f mm\n", run->target.turned_deg,
               run->target.moved_mm);
    }
    printf("target: %u %s, %.4f mm rms and %.4f mm at most from rest\n", run->target.count,
           run->target.landmarks ? "landmarks" : "vertices", found->rest_rms_mm, found->rest_max_mm);
    printf("found: %.4f mm rms, %.4f mm at most at %s; %u iterations, %u holds\n", found->rms_mm,
           found->max_mm, place(run, where, sizeof where), found->iterations, found->holds);
    if (found->rms_mm > run->args.near_mm) {
        printf("not reached: no pose of these channels was found nearer than %.4f mm rms\n", found->rms_mm);
    }
    if (!found->at_rest) {
        printf("the pose is not quite at rest\n");
    }
    print_channels(run);
    print_dependent(run);
    printf("pose: %s\n", text ? text : "?");
    free(text);
}

void solve_print_json(const solve_run *run)
{
    const ris_solve_result *found = &run->result;
    char where[160];
    char *text = solve_pose_text(run);
    printf(
        "{\"points\": %u, \"landmarks\": %s, \"rest_rms_mm\": %.6g, \"rest_max_mm\": %.6g, \"rms_mm\": %.6g, "
        "\"max_mm\": %.6g,\n \"worst\": ",
        run->target.count, run->target.landmarks ? "true" : "false", found->rest_rms_mm, found->rest_max_mm,
        found->rms_mm, found->max_mm);
    cli_json_string(stdout, place(run, where, sizeof where));
    printf(", \"reached\": %s, \"iterations\": %u, \"holds\": %u, \"at_rest\": %s, \"turned_deg\": %.6g, "
           "\"moved_mm\": %.6g,\n \"pose\": ",
           found->rms_mm <= run->args.near_mm ? "true" : "false", found->iterations, found->holds,
           found->at_rest ? "true" : "false", run->target.turned_deg, run->target.moved_mm);
    cli_json_string(stdout, text ? text : "");
    printf(",\n \"channels\": [");
    for (uint32_t k = 0; k < run->control_count; k++) {
        const ris_control_found *f = &run->found[k];
        printf("%s\n  {\"name\": ", k ? "," : "");
        cli_json_string(stdout, run->control[k].name);
        printf(", \"value\": %.6g, \"reach_mm\": %.6g, \"share\": %.6g, \"independent\": %s}",
               (double)f->value, f->reach_mm, f->share, ris_control_independent(f) ? "true" : "false");
    }
    printf("\n ]}\n");
    free(text);
}

static ris_result write_clip(const solve_run *run, ris_output_file *file, ris_error *err)
{
    ris_result r = ris__output_printf(file, err,
                                      "{\"format\": \"risorius-clip\", \"version\": 1, \"duration_s\": 1,\n"
                                      " \"expressions\": {\"solved\": {");
    bool first = true;
    for (uint32_t k = 0; !r && k < run->control_count; k++) {
        if (acts(run, k)) {
            r = ris__output_printf(file, err, "%s\n  \"%s\": %.6g", first ? "" : ",", run->control[k].name,
                                   (double)run->found[k].value);
            first = false;
        }
    }
    return r ? r
             : ris__output_printf(
                   file, err,
                   "}},\n \"tracks\": [{\"target\": \"solved\", \"keys\": [{\"t\": 0, \"v\": 1}]}]}\n");
}

ris_result solve_write(const solve_run *run, const char *path, ris_error *err)
{
    const size_t length = strlen(path);
    ris_output_file file = {0};
    ris_result r = ris__output_open(&file, path, err);
    if (!r && length > 5 && strcmp(path + length - 5, ".json") == 0) {
        r = write_clip(run, &file, err);
    } else if (!r) {
        char *text = solve_pose_text(run);
        r = text ? ris__output_printf(&file, err, "%s\n", text)
                 : ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
        free(text);
    }
    if (!r) {
        r = ris__output_commit(&file, err);
    }
    ris__output_discard(&file);
    return r;
}
