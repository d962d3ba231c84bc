/* guidance.csv: how far the teeth hold the jaw open on its way forward and to a side (beyond KA-05). A full grid, forward
 * slowest; what makes it is tools/make_guidance. */
#include "asset/head_parts.h"
#include "asset/lines.h"

#include <stdlib.h>
#include <string.h>

#define MAX_ROWS 4096
#define HEADER "forward_mm,side,open_deg"

typedef struct guidance_row {
    float forward_mm, side, open_deg;
} guidance_row;

static ris_result read_row(ris_lines *l, guidance_row *row)
{
    ris_result result;
    if ((result = ris__lines_number(l, "-50 to 50 mm", -50, 50, ',', &row->forward_mm)) ||
        (result = ris__lines_number(l, "a side of 0 to 1", 0, 1, ',', &row->side))) {
        return result;
    }
    return ris__lines_number(l, "an opening of -30 to 60 degrees", -30, 60, 0, &row->open_deg);
}

/* Row i of a full grid with `sides` rows for each step forward; sides 0 = still in the first step. */
static bool in_order(const guidance_row *row, uint32_t i, uint32_t sides)
{
    if (i == 0) {
        return true;
    }
    if (sides == 0 || i % sides) {
        return row[i].forward_mm == row[i - 1].forward_mm && row[i].side > row[i - 1].side &&
               (sides == 0 || row[i].side == row[i % sides].side);
    }
    return row[i].forward_mm > row[i - 1].forward_mm && row[i].side == row[0].side;
}

static ris_result keep(const guidance_row *row, uint32_t count, uint32_t sides, const char *name,
                       ris_head *head, ris_error *err)
{
    ris_guidance *g = &head->guidance;
    const uint32_t steps = sides ? count / sides : 0;
    if (sides < 2 || steps < 2 || count % sides) {
        return ris_fail(
            err, RIS_ERROR_DATA,
            "%s: expected a full grid of at least 2 steps forward by 2 to the side, found %u rows", name,
            count);
    }
    g->forward_mm = calloc(steps, sizeof *g->forward_mm);
    g->side = calloc(sides, sizeof *g->side);
    g->open_deg = calloc(count, sizeof *g->open_deg);
    if (!g->forward_mm || !g->side || !g->open_deg) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %u rows", name, count);
    }
    g->forward_count = steps;
    g->side_count = sides;
    bool rest = false;
    for (uint32_t i = 0; i < count; i++) {
        g->forward_mm[i / sides] = row[i].forward_mm;
        g->side[i % sides] = row[i].side;
        g->open_deg[i] = row[i].open_deg;
        rest = rest || (row[i].forward_mm == 0 && row[i].side == 0 && row[i].open_deg == 0);
    }
    return rest ? RIS_OK
                : ris_fail(err, RIS_ERROR_DATA, "%s: expected the row \"0,0,0\" of the closed jaw", name);
}

ris_result ris__guidance_read(const char *name, const char *text, size_t size, ris_head *head, ris_error *err)
{
    ris_lines l = {.name = name, .next = text, .end = text + size, .err = err};
    uint32_t count = 0, sides = 0;
    ris_result result = ris__lines_header(&l, HEADER);
    guidance_row *row = result == RIS_OK ? malloc(MAX_ROWS * sizeof *row) : NULL;
    if (result == RIS_OK && !row) {
        result = ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for its rows", name);
    }
    while (result == RIS_OK && ris__lines_next(&l)) {
        if (count == MAX_ROWS) {
            result = ris__lines_expected(&l, "at most 4096 rows");
        } else if ((result = read_row(&l, &row[count])) == RIS_OK) {
            sides = sides == 0 && count && row[count].forward_mm != row[0].forward_mm ? count : sides;
            l.at = l.start;
            result =
                in_order(row, count, sides)
                    ? RIS_OK
                    : ris__lines_expected(&l, "the next place of a full ascending grid, forward slowest");
            count++;
        }
    }
    result = result == RIS_OK ? keep(row, count, sides, name, head, err) : result;
    free(row);
    return result;
}
