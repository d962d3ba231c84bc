/* risorius-make-take -o FILE.csv: writes a synthetic performance as Live Link Face or OpenFace CSV, with the faults of real
 * ones: noise, dropped frames, a face lost, leaps of the tracker. The same seed gives the same bytes on every machine. */
#include "base/text.h"
#include "make_take.h"

#include <stdio.h>
#include <string.h>

static const char usage[] =
    "Usage: risorius-make-take -o FILE.csv [options]\n"
    "Writes a synthetic performance: emotions, gestures of lips, jaw and brows, speech, blinks, looks and a "
    "moving head.\n"
    "  --seconds S      length (10)\n"
    "  --seed N         which performance (1)\n"
    "  --fps N          frames a second (60; OpenFace 30)\n"
    "  --openface       OpenFace CSV instead of Live Link Face CSV\n"
    "  --jitter J       standard deviation of the noise of every shape (0.006)\n"
    "  --drop P         chance a frame that 1 to 6 frames are dropped (0.004)\n"
    "  --lose P         chance a frame that the face is lost for up to half a second (0.0005)\n"
    "  --spikes P       chance a frame that a shape leaps for that frame (0.0005)\n"
    "  --still          a neutral face: noise alone\n"
    "  --clean          no noise, no faults\n"
    "  --spelling WORD  of the shapes: pascal (MouthSmileLeft), camel (mouthSmileLeft), sides "
    "(mouthSmile_L)\n";

static ris_result read_number(const char *option, const char *text, double low, double high, double *out,
                              ris_error *err)
{
    const char *end = text ? text + strlen(text) : NULL;
    if (!text || ris__parse_number(text, end, out) != end || !(*out >= low && *out <= high)) {
        return ris_fail(err, RIS_ERROR_USAGE, "%s: expected a number from %g to %g, found \"%s\"", option,
                        low, high, text ? text : "");
    }
    return RIS_OK;
}

static ris_result read_spelling(const char *text, take_options *options, ris_error *err)
{
    options->camel = text && strcmp(text, "camel") == 0;
    options->sides = text && strcmp(text, "sides") == 0;
    if (!options->camel && !options->sides && (!text || strcmp(text, "pascal") != 0)) {
        return ris_fail(err, RIS_ERROR_USAGE, "--spelling: expected pascal, camel or sides, found \"%s\"",
                        text ? text : "");
    }
    return RIS_OK;
}

static ris_result read_options(int argc, char **argv, take_options *o, const char **out_path, ris_error *err)
{
    double seed = 1, fps = 0;
    bool clean = false;
    ris_result result = RIS_OK;
    for (int i = 1; i < argc && result == RIS_OK; i++) {
        const char *word = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        const struct {
            const char *name;
            double low, high, *out;
        } number[] = {{"--seconds", 0.1, 3600, &o->seconds},
                      {"--seed", 0, 4294967295.0, &seed},
                      {"--fps", 1, 240, &fps},
                      {"--jitter", 0, 0.5, &o->jitter},
                      {"--drop", 0, 1, &o->drop},
                      {"--lose", 0, 1, &o->lose},
                      {"--spikes", 0, 1, &o->spike}};
        const struct {
            const char *name;
            bool *out;
        } flag[] = {{"--openface", &o->openface}, {"--still", &o->still}, {"--clean", &clean}};
        bool known = false;
        for (size_t k = 0; k < sizeof flag / sizeof *flag; k++) {
            if (strcmp(word, flag[k].name) == 0) {
                *flag[k].out = known = true;
            }
        }
        for (size_t k = 0; k < sizeof number / sizeof *number; k++) {
            if (strcmp(word, number[k].name) == 0) {
                known = true;
                result = read_number(word, value, number[k].low, number[k].high, number[k].out, err);
                i++;
            }
        }
        if (strcmp(word, "--spelling") == 0) {
            known = true;
            result = read_spelling(value, o, err);
            i++;
        } else if (strcmp(word, "-o") == 0 && value) {
            known = true;
            *out_path = value;
            i++;
        }
        if (!known) {
            result = ris_fail(err, RIS_ERROR_USAGE, "unexpected '%s'; see --help", word);
        }
    }
    o->seed = (uint32_t)seed;
    o->fps = fps > 0 ? fps : o->openface ? 30 : 60;
    if (result == RIS_OK && (o->fps != (uint32_t)o->fps || seed != (double)o->seed)) {
        result = ris_fail(err, RIS_ERROR_USAGE, "--fps and --seed are whole numbers");
    }
    if (result == RIS_OK && !*out_path) {
        result = ris_fail(err, RIS_ERROR_USAGE, "expected -o FILE.csv; see --help");
    }
    if (clean) {
        o->jitter = o->drop = o->lose = o->spike = 0;
    }
    return result;
}

int main(int argc, char **argv)
{
    take_options options = {.seconds = 10, .jitter = 0.006, .drop = 0.004, .lose = 0.0005, .spike = 0.0005};
    const char *path = NULL;
    take_play play = {0};
    ris_error err = {0};
    uint32_t rows = 0;
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        fputs(usage, stdout);
        return 0;
    }
    ris_result result = read_options(argc, argv, &options, &path, &err);
    if (result == RIS_OK) {
        result = play_make(&options, &play, &err);
    }
    if (result == RIS_OK) {
        result = write_take(&options, &play, path, &rows, &err);
    }
    if (result == RIS_OK) {
        fprintf(stderr, "wrote %s (%u rows, %g s)\n", path, rows, options.seconds);
    } else {
        fprintf(stderr, "risorius-make-take: %s\n", err.text);
    }
    play_finish(&play);
    return ris_exit_code(result);
}
