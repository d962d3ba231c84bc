/* The findings of `risorius soak` as a table, as JSON and as a verdict. */
#include "soak.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_FLIPPED 8

const char *soak_row_name(const soak *run, uint32_t row)
{
    return row == SOAK_SPEED ? (run->clip ? "speed" : "not at rest") : ris__measure_name((ris_measure)row);
}

const char *soak_row_unit(uint32_t row)
{
    return row == SOAK_SPEED ? "mm/s" : ris__measure_unit((ris_measure)row);
}

double soak_row_value(const soak *run, uint32_t row)
{
    const soak_row *r = &run->row[row];
    if (row == RIS_MEASURE_FLIPPED) {
        const double all =
            (double)ris__measurer_tested(run->measurer, RIS_MEASURE_FLIPPED) * (double)r->pose_count;
        return all > 0 ? r->sum / all : 0;
    }
    return r->worst_count ? r->worst[0].finding.value : 0;
}

bool soak_row_broken(const soak *run, uint32_t row)
{
    const soak_row *r = &run->row[row];
    if (!r->measured || !r->bounded) {
        return false;
    }
    return soak_row_value(run, row) > r->bound || (row == RIS_MEASURE_FLIPPED && r->single.finding.value > 0);
}

/* "vertex 12 (nose)", "edge 12-13 (nose) in teeth_upper 3" */
static const char *place(const soak *run, const ris_finding *f, char *out, size_t size)
{
    static const char *const kind[] = {"", "vertex", "edge", "triangle"};
    const ris_model *model = run->backend.model;
    char piece[16] = "";
    if (f->piece) {
        snprintf(piece, sizeof piece, " %u", f->piece);
    }
    snprintf(out, size, "%s", "");
    if (f->vertex_count) {
        size_t used = (size_t)snprintf(out, size, "%s ", kind[f->vertex_count]);
        for (uint32_t k = 0; k < f->vertex_count && used < size; k++) {
            used += (size_t)snprintf(out + used, size - used, "%s%u", k ? "-" : "", f->vertex[k]);
        }
        if (used < size) {
            const char *region = ris__measure_region(model, f->vertex[0]);
            snprintf(out + used, size - used, "%s%s%s%s%s%s", *region ? " (" : "", region, *region ? ")" : "",
                     *f->part ? " in " : "", f->part, piece);
        }
    }
    return out;
}

/* What the motion asks for at the frame, as words that hold it. */
static char *motion_pose_text(const soak *run, uint32_t frame)
{
    const ris_model *model = run->backend.model;
    const size_t size = ((size_t)model->channel_count + 1) * (RIS_NAME_SIZE + 16);
    char *text = calloc(size, 1);
    float *pose = calloc(model->channel_count + 1u, sizeof *pose);
    size_t used = 0;
    if (text && pose) {
        ris_clip_sample(run->clip, soak_motion_time_s(run, frame), pose);
        for (uint32_t c = 0; c < model->channel_count; c++) {
            if (fabsf(pose[c]) >= 0.0005f) {
                used += (size_t)snprintf(text + used, size - used, "%s%s=%.4g", used ? "," : "",
                                         model->channel[c].name, (double)pose[c]);
            }
        }
    }
    free(pose);
    return text;
}

char *soak_pose_text(const soak *run, ris_soak_id id)
{
    if (run->clip) {
        return motion_pose_text(run, id.number);
    }
    if (!run->args.pose) {
        return ris__soak_pose_text(run->backend.model, run->args.seed, id);
    }
    const size_t size = strlen(run->args.pose) + 1;
    char *text = malloc(size);
    return text ? memcpy(text, run->args.pose, size) : NULL;
}

/* "pose 'few 12' of seed 1" */
static const char *pose_name(const soak *run, ris_soak_id id, char *out, size_t size)
{
    if (run->clip) {
        snprintf(out, size, "the frame at %.3f s", soak_motion_time_s(run, id.number));
    } else if (run->args.pose) {
        snprintf(out, size, "this pose");
    } else {
        snprintf(out, size, "pose '%s %u' of seed %u", ris__soak_kind_name(id.kind), id.number,
                 run->args.seed);
    }
    return out;
}

static void print_value(const soak *run, uint32_t row, double value)
{
    if (run->row[row].measured) {
        printf(" %9.4g", value);
    } else {
        printf(" %9s", "-");
    }
}

static void print_bound(const soak_row *row)
{
    if (row->bounded) {
        printf(" %9g", row->bound);
    } else {
        printf(" %9s", "-");
    }
}

static void print_row(const soak *run, uint32_t k)
{
    const soak_row *row = &run->row[k];
    char where[256] = "";
    printf("  %-22s", soak_row_name(run, k));
    print_value(run, k, row->worst_count ? row->worst[0].finding.value : 0);
    printf(" %-9s", soak_row_unit(k));
    print_bound(row);
    print_value(run, k, k < RIS_MEASURE_COUNT ? ris__measurer_rest(run->measurer, (ris_measure)k)->value : 0);
    printf(" %7u", row->broken_count);
    printf("  %-6s", !row->measured ? "none" : soak_row_broken(run, k) ? "BROKEN" : "holds");
    if (row->worst_count) {
        printf(" %s", place(run, &row->worst[0].finding, where, sizeof where));
    }
    printf("\n");
}

/* The worst of each region: the name in the smallest region of the vertex. */
static void print_regions(const soak *run, uint32_t k)
{
    const ris_model *model = run->backend.model;
    const float *worst = run->trace.worst + (size_t)model->node_count * k;
    const ris_head *head = model->head;
    for (uint32_t r = 0; r <= head->region_count; r++) {
        const char *name = r < head->region_count ? head->region[r].name : "";
        double value = 0;
        uint32_t any = 0, over = 0;
        for (uint32_t i = 0; i < model->node_count; i++) {
            if (worst[i] > 0 && strcmp(ris__measure_region(model, i), name) == 0) {
                any++;
                over += (double)worst[i] > run->row[k].bound;
                value = (double)worst[i] > value ? (double)worst[i] : value;
            }
        }
        if (any) {
            printf("    %-16s %9.4g mm, %u vertices, %u over the bound\n", *name ? name : "elsewhere", value,
                   any, over);
        }
    }
}

static void print_worst(const soak *run)
{
    char where[256], name[64];
    for (uint32_t k = 0; k < SOAK_COUNT; k++) {
        const soak_row *row = &run->row[k];
        const uint32_t count = run->args.worst ? row->worst_count : row->worst_count ? 1 : 0;
        if (count == 0) {
            continue;
        }
        printf("\n%s: worst of %u %s, %u of which have any\n", soak_row_name(run, k), row->pose_count,
               run->clip ? "frames" : "poses", row->found_count);
        if (k >= RIS_MEASURE_SKULL && k <= RIS_MEASURE_LIDS) {
            print_regions(run, k);
        }
        for (uint32_t i = 0; i < count; i++) {
            const soak_record *r = &row->worst[i];
            char *text = soak_pose_text(run, r->id);
            printf("  %.4g %s at %s, %u in all; %s: %s\n", r->finding.value, soak_row_unit(k),
                   place(run, &r->finding, where, sizeof where), r->finding.count,
                   pose_name(run, r->id, name, sizeof name), text ? text : "");
            free(text);
        }
    }
}

/* The triangles that are turned over in the most poses. */
static void print_flipped(const soak *run)
{
    const ris_model *model = run->backend.model;
    uint32_t last = UINT32_MAX, last_at = 0;
    for (int n = 0; n < MOST_FLIPPED; n++) {
        uint32_t best = UINT32_MAX;
        for (uint32_t t = 0; t < model->triangle_count; t++) {
            const bool after = run->trace.flipped[t] < last || (run->trace.flipped[t] == last && t > last_at);
            if (after && run->trace.flipped[t] &&
                (best == UINT32_MAX || run->trace.flipped[t] > run->trace.flipped[best])) {
                best = t;
            }
        }
        if (best == UINT32_MAX) {
            return;
        }
        const uint32_t *v = model->triangle + 3 * (size_t)best;
        printf("%s  %u-%u-%u (%s) in %u poses or frames\n", n ? "" : "\nturned over most often\n", v[0], v[1],
               v[2], ris__measure_region(model, v[0]), run->trace.flipped[best]);
        last = run->trace.flipped[best];
        last_at = best;
    }
}

static void print_rest(const soak *run)
{
    char where[256];
    printf("\nat rest, which is the zero of the table\n");
    for (uint32_t k = 0; k < RIS_MEASURE_MIRROR; k++) {
        const ris_finding *f = ris__measurer_rest(run->measurer, (ris_measure)k);
        if (f->value > 0) {
            printf("  %-22s %9.4g %-9s %u of %u, worst %s\n", soak_row_name(run, k), f->value,
                   soak_row_unit(k), f->count, ris__measurer_tested(run->measurer, (ris_measure)k),
                   place(run, f, where, sizeof where));
        }
    }
}

void soak_print_text(const soak *run)
{
    if (run->clip) {
        printf("%s, %s: %u of %u frames%s, one in %u, %.2f s, %s\n\n", run->args.head,
               motion_file(&run->args.motion), run->done, run->total, run->interrupted ? ", interrupted" : "",
               run->args.every, run->done ? soak_motion_time_s(run, run->done - 1) : 0.0,
               ris_sim_backend(run->backend.sim));
    } else {
        printf("%s, seed %u: %u of %u poses%s (%u of 1 to 6 channels, %u of all, %u single), %.1f s each, "
               "%s\n\n",
               run->args.head, run->args.seed, run->done, run->total, run->interrupted ? ", interrupted" : "",
               run->kind_count[0], run->kind_count[1], run->kind_count[2],
               run->done ? run->held_s / run->done : 0.0, ris_sim_backend(run->backend.sim));
    }
    printf("  %-22s %9s %-9s %9s %9s %7s\n", "measure", "worst", "", "bound", "at rest",
           run->clip ? "frames" : "poses");
    for (uint32_t k = 0; k < SOAK_COUNT; k++) {
        print_row(run, k);
    }
    const soak_row *flipped = &run->row[RIS_MEASURE_FLIPPED];
    printf("\nflipped lip and lid triangles: %.0f of %u x %u, a share of %.3g; by single channels at most "
           "%.0f\n",
           flipped->sum, ris__measurer_tested(run->measurer, RIS_MEASURE_FLIPPED), flipped->pose_count,
           soak_row_value(run, RIS_MEASURE_FLIPPED), flipped->single.finding.value);
    if (ris__measurer_unpaired(run->measurer)) {
        printf("%u vertices without a mirror image are not compared\n",
               ris__measurer_unpaired(run->measurer));
    }
    print_rest(run);
    print_flipped(run);
    print_worst(run);
}

static void print_json_record(const soak *run, const soak_record *r)
{
    const ris_finding *f = &r->finding;
    printf("{\"value\": %.9g, \"vertices\": [", f->value);
    for (uint32_t k = 0; k < f->vertex_count; k++) {
        printf("%s%u", k ? ", " : "", f->vertex[k]);
    }
    printf("], \"region\": ");
    cli_json_string(stdout, f->vertex_count ? ris__measure_region(run->backend.model, f->vertex[0]) : "");
    printf(", \"part\": ");
    cli_json_string(stdout, f->part);
    char *text = soak_pose_text(run, r->id);
    printf(", \"piece\": %u, \"count\": %u, \"kind\": \"%s\", \"number\": %u", f->piece, f->count,
           run->clip        ? "frame"
           : run->args.pose ? "given"
                            : ris__soak_kind_name(r->id.kind),
           r->id.number);
    if (run->clip) {
        printf(", \"time_s\": %.6g", soak_motion_time_s(run, r->id.number));
    }
    printf(", \"pose\": ");
    cli_json_string(stdout, text ? text : "");
    printf("}");
    free(text);
}

void soak_print_json(const soak *run)
{
    printf("{\n  \"head\": ");
    cli_json_string(stdout, run->args.head);
    printf(",\n  \"device\": ");
    cli_json_string(stdout, ris_sim_backend(run->backend.sim));
    printf(",\n  \"seed\": %u,\n  \"poses\": {\"done\": %u, \"few\": %u, \"all\": %u, \"single\": %u},\n",
           run->args.seed, run->done, run->kind_count[0], run->kind_count[1], run->kind_count[2]);
    printf("  \"interrupted\": %s,\n  \"mean_hold_s\": %.6g,\n", run->interrupted ? "true" : "false",
           run->done ? run->held_s / run->done : 0.0);
    printf("  \"flipped_share\": %.9g,\n  \"measures\": [", soak_row_value(run, RIS_MEASURE_FLIPPED));
    bool first = true;
    for (uint32_t k = 0; k < SOAK_COUNT; k++) {
        const soak_row *row = &run->row[k];
        if (!row->measured) {
            continue;
        }
        printf("%s\n    {\"name\": \"%s\", \"unit\": \"%s\", \"holds\": %s, \"poses\": %u, \"broken\": %u, ",
               first ? "" : ",", soak_row_name(run, k), soak_row_unit(k),
               soak_row_broken(run, k) ? "false" : "true", row->pose_count, row->broken_count);
        first = false;
        if (row->bounded) {
            printf("\"bound\": %.9g, ", row->bound);
        }
        printf("\"worst_single\": %.9g, \"at_rest\": %.9g, \"worst\": [", row->single.finding.value,
               k < RIS_MEASURE_COUNT ? ris__measurer_rest(run->measurer, (ris_measure)k)->value : 0.0);
        for (uint32_t i = 0; i < row->worst_count; i++) {
            printf("%s\n      ", i ? "," : "");
            print_json_record(run, &row->worst[i]);
        }
        printf("]}");
    }
    printf("\n  ]\n}\n");
}

ris_result soak_verdict(const soak *run, ris_error *err)
{
    char where[256], name[64];
    for (uint32_t k = 0; k < SOAK_COUNT; k++) {
        const soak_row *row = &run->row[k];
        if (!soak_row_broken(run, k)) {
            continue;
        }
        if (k == RIS_MEASURE_FLIPPED) {
            return ris_fail(
                err, RIS_ERROR_FAILED,
                "%s: a share of %.3g of the triangles of lips and lids, where %g is allowed, and up to "
                "%.0f of one channel alone, where none is",
                soak_row_name(run, k), soak_row_value(run, k), row->bound, row->single.finding.value);
        }
        const soak_record *worst = &row->worst[0];
        return ris_fail(err, RIS_ERROR_FAILED, "%s: %.4g %s at %s in %s, where %g is allowed",
                        soak_row_name(run, k), worst->finding.value, soak_row_unit(k),
                        place(run, &worst->finding, where, sizeof where),
                        pose_name(run, worst->id, name, sizeof name), row->bound);
    }
    return RIS_OK;
}
