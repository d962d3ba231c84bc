/* activation, first stage of a tick: what the pose asks for is what the nerve asks; a muscle follows in its own time.
 * Excitation goes through two equal first-order stages (calcium, then tension): da/dt = (u - a) / tau with one tau when the
 * muscle tightens and one when it slackens is the activation dynamics of Zajac 1989 and Thelen 2003; two of them answer a
 * single impulse with (t / tau^2) exp(-t / tau), the twitch of Milner-Brown, Stein and Yemm 1973 and of Fuglevand,
 * Winter and Patla 1993. */
#include "sim/rig.h"

#include "model/vec3.h"

/* (1 + x) exp(-x) = 0.1: a step is done to 90 % after x time constants */
#define NINETY_PERCENT 3.8897201698674290
#define ARRIVED 1e-6 /* closer than this is there: no endless tail of ever smaller numbers */

/* Taylor series after halving the argument until it is small; only + and x, so no libm in what feeds a hash. */
double ris__decay(double x)
{
    int halvings = 0;
    for (; x > 0.03125 && halvings < 64; ++halvings) {
        x *= 0.5;
    }
    double e =
        1.0 - x * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 6.0)))));
    for (; halvings > 0; --halvings) {
        e *= e;
    }
    return e;
}

ris_pace ris__pace(float ms)
{
    ris_pace pace = {0};
    if (ms > 0.0f) {
        const double x = RIS_TICK_S * 1000.0 * NINETY_PERCENT / (double)ms;
        const double keep = ris__decay(x);
        pace.keep = keep;
        pace.pass = x * keep;
    }
    return pace;
}

void ris__follow(ris_pace pace, double u, double *first, double *second)
{
    const double r = *first - u, s = *second - u;
    *first = u + pace.keep * r;
    *second = u + (pace.keep * s + pace.pass * r);
    if (fabs(*first - u) < ARRIVED && fabs(*second - u) < ARRIVED) {
        *first = *second = u;
    }
}

/* The two paces of every channel. Eyes and head move as they are told: a saccade is an input. */
static void set_pace(ris_rig *rig, uint32_t channel, float onset_ms, float release_ms)
{
    rig->onset[channel] = ris__pace(onset_ms);
    rig->release[channel] = ris__pace(release_ms);
}

void ris__activation_init(ris_rig *rig)
{
    const ris_model *model = rig->model;
    const ris_dynamics_def *dynamics = &model->head->dynamics;
    if (model->push.flags & RIS_TISSUE_FLAG_KAEHLER) {
        return;
    }
    for (uint32_t m = 0; m < model->muscle_count; ++m) {
        const ris_muscle_def *def = model->muscle[m].def;
        set_pace(rig, m, def->onset_ms, def->release_ms);
        if (model->muscle[m].protrude_channel < model->channel_count) {
            set_pace(rig, model->muscle[m].protrude_channel, def->onset_ms, def->release_ms);
        }
    }
    const struct {
        uint32_t first, last;
        float onset_ms, release_ms;
    } beside[] = {
        {RIS__JAW_OPEN, RIS__JAW_SIDE, dynamics->jaw_onset_ms, dynamics->jaw_release_ms},
        {RIS__LID_UPPER_L, RIS__LID_LOWER_R, dynamics->lid_onset_ms, dynamics->lid_release_ms},
        {RIS__TONGUE_OUT, RIS__LIP_LOWER_ROLL, dynamics->onset_ms, dynamics->release_ms},
    };
    for (size_t k = 0; k < sizeof beside / sizeof *beside; ++k) {
        for (uint32_t c = rig->first_beside + beside[k].first; /* a model made by hand may have none */
             c <= rig->first_beside + beside[k].last && c < model->channel_count; ++c) {
            set_pace(rig, c, beside[k].onset_ms, beside[k].release_ms);
        }
    }
}

void ris__activation(ris_rig *rig, const float *pose, bool at_once)
{
    for (uint32_t c = 0; c < rig->model->channel_count; ++c) {
        const double u = (double)pose[c];
        if (at_once) {
            rig->excitation[c] = rig->reached[c] = u;
        } else {
            const bool tightens = fabs(u) > fabs(rig->reached[c]);
            ris__follow(tightens ? rig->onset[c] : rig->release[c], u, &rig->excitation[c], &rig->reached[c]);
        }
        rig->pose[c] = (float)rig->reached[c];
    }
}
