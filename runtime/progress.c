/* The progress bar. */
#include "cli.h"
#include "base/clock.h"

#include <unistd.h>

#define BAR_WIDTH 32

void progress_start(ris_progress *bar, const ris_cli *cli, const char *title)
{
    *bar = (ris_progress){
        .title = title, .silent = cli->quiet, .terminal = isatty(STDERR_FILENO) != 0, .last = UINT32_MAX};
    bar->start_ns = ris__clock_ns();
}

void progress_show(ris_progress *bar, uint32_t done, uint32_t total)
{
    if (bar->silent || total == 0) {
        return;
    }
    uint32_t percent = (uint32_t)((uint64_t)done * 100u / total);
    uint32_t step = bar->terminal ? percent : percent / 10u;
    if (step == bar->last) {
        return;
    }
    bar->last = step;
    double seconds = ris__clock_ms(bar->start_ns, ris__clock_ns()) / 1000.0;
    char cells[BAR_WIDTH + 1];
    for (uint32_t i = 0; i < BAR_WIDTH; i++) {
        cells[i] = i < percent * BAR_WIDTH / 100u ? '#' : '.';
    }
    cells[BAR_WIDTH] = '\0';
    fprintf(stderr, "%s%s [%s] %3u %%  %u/%u  %.1f s%s", bar->terminal ? "\r" : "", bar->title, cells,
            percent, done, total, seconds, bar->terminal ? "" : "\n");
    fflush(stderr);
}

void progress_end(ris_progress *bar)
{
    if (!bar->silent && bar->terminal && bar->last != UINT32_MAX) {
        fputc('\n', stderr);
    }
    bar->silent = true;
}
