/* The jaw in the solver. Its three channels take the sum of what they are asked and of what every muscle drives, cut off at
 * their ends: beyond an end nothing answers, and a step that loads closing muscles would take back unseen what another channel
 * opens. What a step promised of the jaw is therefore kept by the jaw's own channels. */
#include "model/model_impl.h"
#include "solve/solver.h"

#include <math.h>
#include <string.h>

#define SMALL_STEP 0.05

static const struct end {
    const char *name;
    double low, high;
} ends[RIS_SOLVER_JAW] = {{"jaw.open", 0, 1}, {"jaw.forward", -1, 1}, {"jaw.side", -1, 1}};

/* What the control drives of the jaw at u = 1; *out_own: it does nothing else, and of the jaw this alone. */
static void find_drive(const ris_solver *s, uint32_t k, uint32_t axis, double *out, bool *out_own)
{
    const ris_model *model = s->model;
    const float *unit = s->unit + (size_t)k * model->channel_count;
    const uint32_t own = ris_model_channel(model, ends[axis].name);
    *out = own < model->channel_count ? (double)unit[own] : 0;
    *out_own = *out != 0;
    for (uint32_t c = 0; c < model->channel_count; ++c) {
        *out_own = *out_own && (c == own || unit[c] == 0.0f);
        *out += c < model->muscle_count ? (double)unit[c] * (double)model->muscle[c].def->drives[axis] : 0;
    }
}

void ris__solver_find_drives(ris_solver *s)
{
    for (uint32_t axis = 0; axis < RIS_SOLVER_JAW; ++axis) {
        s->jaw_own[axis] = s->n;
        for (uint32_t k = 0; k < s->n; ++k) {
            bool own;
            find_drive(s, k, axis, &s->drive[(size_t)axis * s->n + k], &own);
            s->jaw_own[axis] = own ? k : s->jaw_own[axis];
        }
    }
}

static double cut(uint32_t axis, double value)
{
    return fmin(fmax(value, ends[axis].low), ends[axis].high);
}

/* What the jaw is asked, not cut off. */
static double asked(const ris_solver *s, uint32_t axis, const double *u)
{
    double sum = 0;
    for (uint32_t k = 0; k < s->n; ++k) {
        sum += s->drive[(size_t)axis * s->n + k] * u[k];
    }
    return sum;
}

void ris__solver_step_inwards(ris_solver *s)
{
    for (uint32_t axis = 0; axis < RIS_SOLVER_JAW; ++axis) {
        const double now = asked(s, axis, s->u);
        for (uint32_t k = 0; k < s->n; ++k) {
            const double drive = s->drive[(size_t)axis * s->n + k];
            const double other =
                s->step[k] < 0 ? fmax(-s->step[k], SMALL_STEP) : fmin(-s->step[k], -SMALL_STEP);
            const double there = now + drive * s->step[k], back = now + drive * other;
            if (drive != 0 && there != cut(axis, there) && back == cut(axis, back) &&
                s->u[k] + other >= s->knob[k].low && s->u[k] + other <= s->knob[k].high) {
                s->step[k] = other;
            }
        }
    }
}

void ris__solver_keep_jaw(const ris_solver *s, const double *d, double *u)
{
    for (uint32_t axis = 0; axis < RIS_SOLVER_JAW; ++axis) {
        const double *drive = s->drive + (size_t)axis * s->n;
        const uint32_t own = s->jaw_own[axis];
        const double now = asked(s, axis, s->u);
        double promised = cut(axis, now);
        for (uint32_t k = 0; k < s->n; ++k) {
            if (drive[k] != 0 && d[k] != 0 && s->step[k] != 0) {
                promised += d[k] * (cut(axis, now + drive[k] * s->step[k]) - cut(axis, now)) / s->step[k];
            }
        }
        if (own < s->n && !s->frozen[own]) {
            const double change = (cut(axis, promised) - asked(s, axis, u)) / drive[own];
            u[own] = fmin(fmax(u[own] + change, s->knob[own].low), s->knob[own].high);
        }
    }
}

bool ris__solver_let_jaw_go(const ris_solver *s, double *u)
{
    bool any = false;
    for (uint32_t axis = 0; axis < RIS_SOLVER_JAW; ++axis) {
        const uint32_t own = s->jaw_own[axis];
        if (own < s->n && u[own] != 0) {
            const double now = asked(s, axis, u),
                         without = now - s->drive[(size_t)axis * s->n + own] * u[own];
            if (fabs(cut(axis, without) - cut(axis, now)) <= RIS_SOLVER_NOTHING) {
                u[own] = 0;
                any = true;
            }
        }
    }
    return any;
}
