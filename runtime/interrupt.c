/* Ctrl-C and the signals that would otherwise kill the program in the middle of a file. */
#include "cli.h"

#include <signal.h>

static volatile sig_atomic_t interrupted;

static void on_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

void interrupt_install(void)
{
    struct sigaction action = {.sa_handler = on_interrupt};
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESETHAND; /* a second Ctrl-C ends the program at once */
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);

    struct sigaction ignore = {.sa_handler = SIG_IGN};
    sigemptyset(&ignore.sa_mask);
    sigaction(SIGPIPE, &ignore, NULL); /* a closed pipe and a full disk are errors to report */
#ifdef SIGXFSZ
    sigaction(SIGXFSZ, &ignore, NULL);
#endif
}

bool interrupt_seen(void)
{
    return interrupted != 0;
}

ris_result interrupt_check(ris_error *err)
{
    return interrupted ? ris_fail(err, RIS_ERROR_FAILED, "interrupted; unfinished output was removed")
                       : RIS_OK;
}
