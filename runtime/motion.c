#include "motion.h"

const char *motion_file(const motion_words *words)
{
    return words->clip ? words->clip : words->live_link ? words->live_link : words->openface;
}

static ris_result make_def(const motion_words *words, ris_take_def *out, ris_error *err)
{
    *out = ris_default_take_def(words->live_link ? RIS_TAKE_LIVE_LINK : RIS_TAKE_OPENFACE);
    return words->adjust ? ris_take_adjust(out, words->adjust, err) : RIS_OK;
}

ris_result motion_check(const motion_words *words, ris_error *err)
{
    ris_take_def def;
    if (!!words->clip + !!words->live_link + !!words->openface > 1) {
        return ris_fail(err, RIS_ERROR_USAGE,
                        "--clip, --live-link and --openface name one motion between them");
    }
    if (words->adjust && !words->live_link && !words->openface) {
        return ris_fail(err, RIS_ERROR_USAGE, "--adjust is for --live-link or --openface");
    }
    return make_def(words, &def, err);
}

ris_result motion_load(const motion_words *words, const ris_cli *cli, const ris_model *model, ris_clip **out,
                       ris_error *err)
{
    ris_take_def def;
    ris_take_info info;
    char text[1024];
    if (words->clip) {
        return ris_clip_load(model, words->clip, out, err);
    }
    ris_result r = make_def(words, &def, err);
    if (!r) {
        r = ris_take_load(model, motion_file(words), &def, out, &info, err);
    }
    if (!r && !cli->quiet && !cli->json) {
        fprintf(stderr, "%s: %s\n", motion_file(words), ris_take_describe(&info, text, sizeof text));
    }
    return r;
}

void motion_start(const motion_words *words, ris_sim *sim)
{
    ris_take_def def;
    if ((words->live_link || words->openface) && make_def(words, &def, NULL) == RIS_OK) {
        ris_sim_set_onset(sim, def.onset);
    }
}
