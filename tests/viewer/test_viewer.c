/* The viewer on a virtual display: sixty frames with a picture that is not blank; sizes, hiding, keys and closing.
 * ctest sets RIS_VALIDATION=1: not one message of the validation layer is allowed. */
#include "cli/command.h"
#include "cli/picture.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <X11/Xlib.h>
#include <X11/keysym.h>
#include <cmocka.h>

#define HEAD "'" RIS_SOURCE_DIR "/assets/human'" /* quoted for a line */
#define CLIP "'" RIS_SOURCE_DIR "/assets/clips/first_light.json'"

static run_result run;

static void sixty_frames_show_a_face(void **state)
{
    (void)state;
    char folder[COMMAND_PATH_SIZE], line[2 * COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 16];
    command_folder(folder, "viewer");
    snprintf(path, sizeof path, "%s/shot.png", folder);
    snprintf(line, sizeof line, "view " HEAD " --clip " CLIP " --size 160x200 --frames 60 --screenshot '%s'",
             path);
    command_run(&run, NULL, line);
    if (run.code != 0) {
        fail_msg("view: code %d, %s", run.code, run.err);
    }
    assert_null(strstr(run.err, "validation: "));
    picture shot;
    picture_load(path, &shot);
    assert_int_equal(shot.width, 160);
    assert_int_equal(shot.height, 200);
    assert_false(picture_is_blank(&shot));
    picture_finish(&shot);
}

static void without_a_display_there_is_no_window(void **state)
{
    (void)state;
    const command_def none = {.environment = {"DISPLAY=", "WAYLAND_DISPLAY="}};
    command_run(&run, &none, "view " HEAD " --frames 1");
    assert_int_equal(run.code, 4);
    assert_non_null(strstr(run.err, "window"));
}

static void sleep_ms(long ms)
{
    struct timespec pause = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&pause, NULL);
}

/* The viewer's window, or 0 when it does not appear within a minute. */
static Window find_window(Display *display)
{
    for (int attempt = 0; attempt < 600; attempt++) {
        Window root, parent, *children = NULL, found = 0;
        unsigned count = 0;
        XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count);
        for (unsigned i = 0; i < count; i++) {
            char *name = NULL;
            if (XFetchName(display, children[i], &name) && name && strncmp(name, "Risorius", 8) == 0) {
                found = children[i];
            }
            XFree(name);
        }
        if (children) {
            XFree(children);
        }
        if (found) {
            return found;
        }
        sleep_ms(100);
    }
    return 0;
}

static void press(Display *display, Window window, KeySym symbol)
{
    XKeyEvent event = {.type = KeyPress,
                       .display = display,
                       .window = window,
                       .root = DefaultRootWindow(display),
                       .same_screen = True,
                       .keycode = XKeysymToKeycode(display, symbol)};
    XSendEvent(display, window, True, KeyPressMask, (XEvent *)&event);
    event.type = KeyRelease;
    XSendEvent(display, window, True, KeyReleaseMask, (XEvent *)&event);
    XSync(display, False);
    sleep_ms(150);
}

static void close_window(Display *display, Window window)
{
    XEvent event = {.xclient = {.type = ClientMessage,
                                .window = window,
                                .format = 32,
                                .message_type = XInternAtom(display, "WM_PROTOCOLS", False)}};
    event.xclient.data.l[0] = (long)XInternAtom(display, "WM_DELETE_WINDOW", False);
    XSendEvent(display, window, False, NoEventMask, &event);
    XSync(display, False);
}

/* Everything a hand does to a window; true if the viewer is still there afterwards. */
static bool use_window(Display *display, Window window, pid_t pid)
{
    static const int sizes[][2] = {{300, 200}, {1, 1}, {90, 400}, {257, 129}, {160, 160}};
    static const KeySym keys[] = {XK_w,     XK_space, XK_Right, XK_Left, XK_3, XK_7, XK_1, XK_r, XK_w,
                                  XK_space, XK_m,     XK_b,     XK_l,    XK_s, XK_p, XK_t, XK_s, XK_m};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        XResizeWindow(display, window, (unsigned)sizes[i][0], (unsigned)sizes[i][1]);
        XSync(display, False);
        sleep_ms(300);
    }
    for (int i = 0; i < 2; i++) {
        XUnmapWindow(display, window); /* minimised */
        XSync(display, False);
        sleep_ms(300);
        XMapWindow(display, window);
        XSync(display, False);
        sleep_ms(300);
    }
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        press(display, window, keys[i]);
    }
    return waitpid(pid, NULL, WNOHANG) == 0;
}

static void a_hand_may_do_what_it_likes(void **state)
{
    (void)state;
    Display *display = XOpenDisplay(NULL);
    assert_non_null(display);
    char folder[COMMAND_PATH_SIZE], path[COMMAND_PATH_SIZE + 16];
    command_folder(folder, "viewer_hand");
    snprintf(path, sizeof path, "%s/log", folder);
    pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        if (!freopen(path, "w", stderr)) {
            _exit(126);
        }
        execl(RIS_BUILD_DIR "/bin/risorius", "risorius", "view", RIS_SOURCE_DIR "/assets/human", "--clip",
              RIS_SOURCE_DIR "/assets/clips/first_light.json", "--size", "160x160", (char *)NULL);
        _exit(127);
    }
    Window window = find_window(display);
    bool alive = window && use_window(display, window, pid);
    if (alive) {
        close_window(display, window);
    } else {
        kill(pid, SIGKILL);
    }
    int status = 0;
    waitpid(pid, &status, 0);
    XCloseDisplay(display);
    char *log = command_read_file(path);
    assert_non_null(log);
    bool silent = strstr(log, "validation: ") == NULL;
    if (!alive || !silent || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        print_error("%s\n", log);
        free(log);
        fail_msg("the viewer did not end well: window %d, alive %d, status %d", window != 0, alive, status);
    }
    free(log);
}

int main(void)
{
    if (!getenv("DISPLAY")) {
        fprintf(stderr, "needs a display: run it by xvfb-run, as ctest does\n");
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sixty_frames_show_a_face),
        cmocka_unit_test(without_a_display_there_is_no_window),
        cmocka_unit_test(a_hand_may_do_what_it_likes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
