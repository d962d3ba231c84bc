/* The table of docs/ids.md names tests that exist: `test_program` case, case; `test_program` case. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdbool.h>
#include <stdint.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    char *text = calloc(1 << 20, 1);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    return text;
}

static bool has_case(const char *program, const char *name)
{
    static const char *const folders[] = {"unit", "physics", "cli"};
    char path[1024], wanted[256];
    bool found = false;
    snprintf(wanted, sizeof wanted, "cmocka_unit_test(%s)", name);
    for (int k = 0; k < 3; ++k) {
        snprintf(path, sizeof path, RIS_SOURCE_DIR "/tests/%s/%s.c", folders[k], program);
        char *text = read_text(path);
        found = found || (text && strstr(text, wanted));
        free(text);
    }
    return found;
}

/* Checks the cell of cases; the number of them. */
static int check_cases(const char *cell)
{
    char program[128] = "", word[128];
    int count = 0, used = 0;
    while (sscanf(cell, " %127[^ ,;|\n]%n", word, &used) == 1) {
        cell += used;
        cell += strspn(cell, " ,;|\n");
        if (word[0] == '`') {
            snprintf(program, sizeof program, "%.*s", (int)strlen(word) - 2, word + 1);
            continue;
        }
        if (!has_case(program, word)) {
            fail_msg("docs/ids.md: %s has no case %s", program, word);
        }
        ++count;
    }
    return count;
}

static void the_table_names_real_tests(void **state)
{
    (void)state;
    char *text = read_text(RIS_SOURCE_DIR "/docs/ids.md");
    assert_non_null(text);
    int rows = 0, cases = 0;
    char *line = strstr(text, "## Which test proves which row");
    assert_non_null(line);
    for (line = strtok(line, "\n"); line; line = strtok(NULL, "\n")) {
        const bool row = strncmp(line, "| KA-", 5) == 0 || strncmp(line, "| f", 3) == 0;
        char *cell = row ? strstr(line, " | `test_") : NULL;
        if (cell) {
            const int here = check_cases(cell + 3);
            assert_true(here > 0);
            cases += here;
            ++rows;
        }
    }
    assert_true(rows >= 36 && cases >= 70);
    assert_false(has_case("test_model", "no_such_case")); /* control */
    assert_false(has_case("test_nothing", "jaw_rotation"));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_table_names_real_tests)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
