/* The dowels of the tissue depth table (KA-74, table 8.3) on this head, and the table itself. */
#include "make_skull.h"

#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* seed lies near the bone, out points to the skin. aim keeps a chin where the mean table would smooth it
 * away. */
static const site table[] = {
    {"tr", false, 0, {0, 82, 80}, {0, 0.45, 0.89}, 1, 20, 0},
    {"g", false, 0, {0, 44, 88}, {0, 0, 1}, 1, 14, 0},
    {"n", false, 0, {0, 26, 84}, {0, -0.1, 1}, 0.9, 9, 0},
    {"na", false, 0, {0, 3.5, 94}, {0, 0.45, 0.89}, 1, 7, 0},
    {"a", false, 0, {0, -36, 86}, {0, -0.1, 1}, 1, 9, 0},
    {"sd", false, 0, {0, -38.5, 86}, {0, -0.05, 1}, 1, 9, 0},
    {"id", false, 1, {0, -63.5, 83}, {0, 0.1, 1}, 1, 9, 0},
    {"b", false, 1, {0, -70, 80}, {0, -0.05, 1}, 1.12, 9, 0},
    {"pog", false, 1, {0, -79, 78}, {0, 0, 1}, 0.82, 11, 0},
    {"me", false, 1, {0, -84, 74}, {0, -1, 0.12}, 1, 11, 0},
    {"fe", true, 0, {30, 76, 74}, {0.36, 0.36, 0.86}, 1, 20, 0},
    {"sci", true, 0, {31, 39, 76}, {0.25, 0.1, 0.96}, 0.82, 18, 0},
    {"or", true, 0, {31, -3.5, 74}, {0.2, 0, 0.98}, 1, 11, 0},
    {"im", true, 0, {39, -19, 64}, {0.5, -0.3, 0.81}, 1, 11, 0},
    {"lo", true, 0, {47, -7, 62}, {0.62, 0, 0.78}, 1, 11, 0},
    {"zy", true, 0, {60, -3, 32}, {1, 0, 0.05}, 1, 12, 0},
    {"sg", true, 0, {61, 6, 9}, {1, 0.05, 0}, 1, 10, 0},
    {"go", true, 1, {40, -60, 21}, {0.92, -0.25, 0.05}, 1, 12, 0},
    {"spm2", true, 0, {31, -30, 57}, {0.7, -0.05, 0.71}, 1, 10, 0},
    {"ol", true, 1, {42, -44, 30}, {0.98, 0, 0.2}, 1, 12, 0},
    {"sbm2", true, 1, {31, -63, 53}, {0.8, -0.05, 0.6}, 0.8, 16, 0},
    {"mp", true, 0, {52, -17, -13}, {0.95, -0.1, -0.2}, 1, 10, 0},
    {"en", true, 0, {13.5, 16, 78}, {0.45, 0, 0.89}, 1, 8, 0},
    {"ex", true, 0, {50, 16, 62}, {0.45, 0, 0.89}, 1, 8, 0},
};

uint32_t sites_default(site out[SITE_LIMIT])
{
    uint32_t count = sizeof table / sizeof *table;
    memcpy(out, table, sizeof table);
    for (uint32_t i = 0; i < count; i++)
        out[i].out = dv_unit(out[i].out);
    return count;
}

ris_result sites_read_table(const char *path, site *sites, uint32_t count, ris_error *err)
{
    char *text = NULL;
    size_t size = 0;
    ris_result result = ris__file_read(path, (size_t)1 << 20, &text, &size, err);
    if (result != RIS_OK)
        return result;
    int row = 0;
    for (char *line = strtok(text, "\r\n"); line && result == RIS_OK; line = strtok(NULL, "\r\n")) {
        char id[16], name[128];
        int sided = 0;
        double mean = 0;
        if (line[0] == '#' || row++ == 0)
            continue;
        if (sscanf(line, "%15[^,],%127[^,],%d,%lf", id, name, &sided, &mean) != 4 || !(mean > 0)) {
            result = ris_fail(err, RIS_ERROR_DATA, "%s: expected id,site,bilateral,mean_mm, found \"%.40s\"",
                              path, line);
            break;
        }
        uint32_t i = 0;
        while (i < count && (strcmp(sites[i].name, id) != 0 || sites[i].bilateral != (sided != 0)))
            i++;
        if (i == count)
            result = ris_fail(err, RIS_ERROR_DATA, "%s: no site is named \"%s\"", path, id);
        else
            sites[i].table_mm = mean;
    }
    free(text);
    return result;
}
