/* risorius-make-guidance HEAD_DIR [-o FILE]: measures how far the jaw must be open for the teeth to pass, at every place
 * forward and to the side, and writes it as guidance.csv (beyond KA-05: the border of the movements with closed teeth). The
 * jaw goes by the engine's own path; the teeth are the head's parts of that material on skull and jaw. */
#include "base/file.h"
#include "query/query.h"
#include "sim/rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEP_MM 0.5     /* between knots, forward */
#define SIDE_KNOTS 9    /* jaw.side 0 .. 1 */
#define FINE 3          /* measured places between two knots */
#define MAX_FORWARD 128 /* knots */
#define FREE_DEG 10.0   /* teeth are apart when open this far */
#define LEAST_DEG (-8.0)
#define MARGIN_DEG 0.04 /* kept between the teeth beside contact */

typedef struct teeth {
    tri_mesh mesh[2]; /* upper, lower */
    bvh tree[2];
} teeth;

typedef struct field {
    uint32_t forward_count;      /* knots */
    double forward[MAX_FORWARD]; /* mm */
    uint32_t rows, columns;      /* measured places */
    double *contact;             /* degrees (rows x columns) */
    double *knot;                /* degrees (forward_count x SIDE_KNOTS) */
} field;

static ris_result find_teeth(const ris_head *head, teeth *out, ris_error *err)
{
    for (int k = 0; k < 2; k++) {
        const ris_bone bone = k ? RIS_BONE_JAW : RIS_BONE_SKULL;
        const ris_part_def *found = NULL;
        for (uint32_t i = 0; i < head->part_count; i++)
            if (head->part[i].material == RIS_MATERIAL_TEETH && head->part[i].bone == bone)
                found = &head->part[i];
        if (!found)
            return ris_fail(err, RIS_ERROR_DATA, "%s has no teeth on the %s", head->directory,
                            k ? "jaw" : "skull");
        ris_result result = ris__tri_from_mesh(&found->mesh, found->name, &out->mesh[k], err);
        if (result != RIS_OK || (result = ris__bvh_build(&out->tree[k], &out->mesh[k], err)))
            return result;
    }
    return RIS_OK;
}

static bool crossing(const teeth *t, const ris_jaw_def *jaw, double forward_mm, double side, double open_deg)
{
    float forward[2] = {-1000, 1000}, sides[2] = {0, 1}, open[4];
    for (int k = 0; k < 4; k++)
        open[k] = (float)open_deg;
    const ris_guidance held = {2, 2, forward, sides, open};
    const double whole = (double)(forward_mm < 0 ? jaw->back_mm : jaw->forward_mm);
    const ris_rigid rigid =
        ris__jaw_path(jaw, &held, 0, whole > 0 ? (float)(forward_mm / whole) : 0, (float)side);
    float place[12];
    ris__rigid_matrix(&rigid, place);
    return ris__bvh_crossings(&t->tree[1], place, &t->tree[0], 1) > 0;
}

/* Opening above which nothing crosses, coming from wide open. */
static double find_contact(const teeth *t, const ris_jaw_def *jaw, double forward_mm, double side)
{
    double high = FREE_DEG, low = LEAST_DEG;
    for (double d = FREE_DEG; d > LEAST_DEG; d -= 0.2) {
        if (crossing(t, jaw, forward_mm, side, d)) {
            low = d;
            break;
        }
        high = d;
    }
    for (int i = 0; i < 6; i++) {
        const double middle = 0.5 * (low + high);
        if (crossing(t, jaw, forward_mm, side, middle))
            low = middle;
        else
            high = middle;
    }
    return high;
}

/* Shares of the four knots about measured place (r, c); index of the first in *at. */
static void shares(uint32_t r, uint32_t c, const field *f, uint32_t *at, double share[4])
{
    uint32_t i = r / FINE, j = c / FINE;
    i = i + 2 > f->forward_count ? f->forward_count - 2 : i;
    j = j + 2 > SIDE_KNOTS ? SIDE_KNOTS - 2 : j;
    const double u = (double)r / FINE - i, v = (double)c / FINE - j;
    *at = i * SIDE_KNOTS + j;
    share[0] = (1 - u) * (1 - v);
    share[1] = (1 - u) * v;
    share[2] = u * (1 - v);
    share[3] = u * v;
}

/* Lifts the knots until the surface through them is above contact everywhere but at rest, which stays 0. */
static void lift(field *f, uint32_t rest)
{
    static const uint32_t step[4] = {0, 1, SIDE_KNOTS, SIDE_KNOTS + 1};
    for (int pass = 0; pass < 200; pass++)
        for (uint32_t r = 0; r < f->rows; r++)
            for (uint32_t c = 0; c < f->columns; c++) {
                uint32_t at;
                double share[4], value = 0, sum = 0;
                shares(r, c, f, &at, share);
                for (int k = 0; k < 4; k++) {
                    value += share[k] * f->knot[at + step[k]];
                    sum += at + step[k] == rest ? 0 : share[k] * share[k];
                }
                const double lack = f->contact[r * f->columns + c] + MARGIN_DEG - value;
                for (int k = 0; k < 4 && lack > 1e-6 && sum > 1e-6; k++)
                    if (at + step[k] != rest)
                        f->knot[at + step[k]] += lack * share[k] / sum;
            }
}

static ris_result measure(const teeth *t, const ris_jaw_def *jaw, field *f, ris_error *err)
{
    const double back = (double)jaw->back_mm, ahead = (double)jaw->forward_mm;
    const uint32_t behind = (uint32_t)ceil(back / STEP_MM), before = (uint32_t)ceil(ahead / STEP_MM);
    f->forward_count = behind + before + 1;
    if (f->forward_count < 2 || f->forward_count > MAX_FORWARD)
        return ris_fail(err, RIS_ERROR_DATA, "the jaw goes %g mm, expected up to %g", back + ahead,
                        STEP_MM * (MAX_FORWARD - 2));
    for (uint32_t i = 0; i < f->forward_count; i++)
        f->forward[i] = fmin(fmax(((double)i - behind) * STEP_MM, -back), ahead);
    f->rows = (f->forward_count - 1) * FINE + 1;
    f->columns = (SIDE_KNOTS - 1) * FINE + 1;
    f->contact = calloc((size_t)f->rows * f->columns, sizeof *f->contact);
    f->knot = calloc((size_t)f->forward_count * SIDE_KNOTS, sizeof *f->knot);
    if (!f->contact || !f->knot)
        return ris_fail(err, RIS_ERROR_MEMORY, "no memory for %u places", f->rows * f->columns);
    for (uint32_t r = 0; r < f->rows; r++)
        for (uint32_t c = 0; c < f->columns; c++) {
            const uint32_t i = r / FINE + 1 < f->forward_count ? r / FINE : f->forward_count - 2;
            const double u = (double)r / FINE - i,
                         mm = f->forward[i] + u * (f->forward[i + 1] - f->forward[i]);
            const double side = (double)c / (f->columns - 1);
            f->contact[r * f->columns + c] = find_contact(t, jaw, mm, side);
            if (r % FINE == 0 && c % FINE == 0)
                f->knot[r / FINE * SIDE_KNOTS + c / FINE] = f->contact[r * f->columns + c] + MARGIN_DEG;
        }
    f->knot[behind * SIDE_KNOTS] = 0;
    lift(f, behind * SIDE_KNOTS);
    return RIS_OK;
}

static ris_result write_table(const char *path, const field *f, ris_error *err)
{
    ris_output_file out = {0};
    ris_result result = ris__output_open(&out, path, err);
    if (result == RIS_OK)
        result = ris__output_printf(&out, err, "forward_mm,side,open_deg\n");
    for (uint32_t i = 0; i < f->forward_count * SIDE_KNOTS && result == RIS_OK; i++) {
        const double deg = f->knot[i] == 0 ? 0 : ceil(f->knot[i] * 1000) / 1000 + 0.0;
        result = ris__output_printf(&out, err, "%g,%g,%g\n", f->forward[i / SIDE_KNOTS],
                                    (double)(i % SIDE_KNOTS) / (SIDE_KNOTS - 1), deg);
    }
    if (result == RIS_OK)
        result = ris__output_commit(&out, err);
    ris__output_discard(&out);
    return result;
}

static ris_result run(const char *directory, const char *file, ris_error *err)
{
    ris_head head;
    teeth t = {0};
    field f = {0};
    char path[RIS_PATH_SIZE];
    ris_result result = ris_head_load(directory, &head, err);
    if (result != RIS_OK)
        return result;
    if ((result = file ? ris__path_join(path, "", file, err)
                       : ris__path_join(path, directory, "guidance.csv", err)) ||
        (result = find_teeth(&head, &t, err)) || (result = measure(&t, &head.jaw, &f, err)) ||
        (result = write_table(path, &f, err)))
        goto done;
    printf("%s: %u places forward, %d to the side\n", path, f.forward_count, SIDE_KNOTS);
done:
    free(f.contact);
    free(f.knot);
    for (int k = 0; k < 2; k++) {
        ris__bvh_finish(&t.tree[k]);
        ris__tri_finish(&t.mesh[k]);
    }
    ris_head_finish(&head);
    return result;
}

int main(int argc, char **argv)
{
    static const char usage[] = "Usage: risorius-make-guidance HEAD_DIR [-o FILE]\n"
                                "Measures how far the jaw must be open for the teeth to pass, at every place "
                                "forward and to the side, and\n"
                                "writes it to FILE (HEAD_DIR/guidance.csv).\n";
    ris_error err = {0};
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        fputs(usage, stdout);
        return 0;
    }
    ris_result result;
    if (argc == 2)
        result = run(argv[1], NULL, &err);
    else if (argc == 4 && strcmp(argv[2], "-o") == 0)
        result = run(argv[1], argv[3], &err);
    else
        result = ris_fail(&err, RIS_ERROR_USAGE, "expected HEAD_DIR [-o FILE]; see --help");
    if (result != RIS_OK)
        fprintf(stderr, "risorius-make-guidance: %s\n", err.text);
    return ris_exit_code(result);
}
