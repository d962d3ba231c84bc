/* risorius view HEAD: the window. The simulation ticks at 1/60 s; a window that cannot keep up lets the clip run slower
 * instead of taking longer steps (KA-19 as a policy of pace), a faster one shows interpolated states. */
#define GLFW_INCLUDE_VULKAN
#include <GLFW/glfw3.h>

#include "backend.h"
#include "base/clock.h"
#include "layers.h"
#include "motion.h"
#include "orbit.h"
#include "player.h"
#include "risorius/draw.h"
#include "risorius/output.h"

#include <stdlib.h>
#include <time.h>

#define TICKS_PER_FRAME 4 /* more are dropped */
#define SIDE_MAX 8192     /* pixels */

typedef struct view_args {
    const char *head, *pose, *size, *frames_text, *screenshot, *layers_text;
    motion_words motion;
    uint32_t width, height, frames, layers; /* frames: 0 = until closed */
} view_args;

typedef struct view_state {
    GLFWwindow *window;
    ris_backend backend;
    ris_clip *clip;
    float *pose;
    ris_player player;
    ris_draw *draw;
    ris_window *surface;
    ris_orbit orbit;
    uint32_t width, height; /* of the drawing */
    uint32_t layers;        /* ris_layer mask */
    double time_s, speed;
    double cursor_x, cursor_y;
    bool playing, wireframe, restart, step, step_back, stale; /* stale: the picture must be drawn again */
} view_state;

static ris_result window_fail(const char *what, ris_error *err)
{
    const char *reason = NULL;
    glfwGetError(&reason);
    return ris_fail(err, RIS_ERROR_DEVICE, "%s: %s", what, reason ? reason : "no reason given");
}

static void look_from(view_state *view, const char *name)
{
    ris_camera camera;
    if (ris_camera_named(view->backend.model, name, &camera)) {
        view->orbit = orbit_from_camera(&camera);
    }
}

/* Key of each layer, in the order of their bits. */
static const int layer_keys[RIS_LAYER_COUNT] = {GLFW_KEY_S, GLFW_KEY_M, GLFW_KEY_B,
                                                GLFW_KEY_P, GLFW_KEY_L, GLFW_KEY_T};

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods)
{
    (void)scancode, (void)mods;
    view_state *v = glfwGetWindowUserPointer(window);
    if (action == GLFW_RELEASE) {
        return;
    }
    v->stale = true;
    for (uint32_t bit = 0; bit < RIS_LAYER_COUNT; bit++) {
        v->layers ^= key == layer_keys[bit] ? 1u << bit : 0u;
    }
    switch (key) {
    case GLFW_KEY_SPACE: v->playing = !v->playing; break;
    case GLFW_KEY_R: v->restart = true; break;
    case GLFW_KEY_W:
        v->wireframe = !v->wireframe;
        ris_draw_set_wireframe(v->draw, v->wireframe);
        break;
    case GLFW_KEY_RIGHT: v->step = true; break;
    case GLFW_KEY_LEFT: v->step_back = true; break;
    case GLFW_KEY_UP: v->speed = v->speed < 4 ? v->speed * 2 : v->speed; break;
    case GLFW_KEY_DOWN: v->speed = v->speed > 0.0625 ? v->speed / 2 : v->speed; break;
    case GLFW_KEY_F:
    case GLFW_KEY_1: look_from(v, "front"); break;
    case GLFW_KEY_3: look_from(v, "profile"); break;
    case GLFW_KEY_7: look_from(v, "34"); break;
    case GLFW_KEY_Q:
    case GLFW_KEY_ESCAPE: glfwSetWindowShouldClose(window, GLFW_TRUE); break;
    default: break;
    }
}

static void on_cursor(GLFWwindow *window, double x, double y)
{
    view_state *v = glfwGetWindowUserPointer(window);
    float right = (float)(x - v->cursor_x), down = (float)(y - v->cursor_y);
    int width, height;
    v->cursor_x = x;
    v->cursor_y = y;
    glfwGetWindowSize(window, &width, &height);
    bool left = glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
    bool shift = glfwGetKey(window, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS ||
                 glfwGetKey(window, GLFW_KEY_RIGHT_SHIFT) == GLFW_PRESS;
    bool other = glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_MIDDLE) == GLFW_PRESS ||
                 glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
    if (height <= 0) {
        return;
    }
    if (other || (left && shift)) {
        orbit_pan(&v->orbit, right, down, (float)height);
        v->stale = true;
    } else if (left) {
        orbit_turn(&v->orbit, right, down, (float)height);
        v->stale = true;
    }
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    (void)x;
    view_state *v = glfwGetWindowUserPointer(window);
    orbit_dolly(&v->orbit, (float)y);
    v->stale = true;
}

static void on_refresh(GLFWwindow *window)
{
    view_state *v = glfwGetWindowUserPointer(window);
    v->stale = true;
}

static ris_result open_window(view_state *view, const view_args *args, ris_error *err)
{
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    view->window = glfwCreateWindow((int)args->width, (int)args->height, "Risorius", NULL, NULL);
    if (!view->window) {
        return window_fail("cannot open a window", err);
    }
    glfwSetWindowUserPointer(view->window, view);
    glfwSetKeyCallback(view->window, on_key);
    glfwSetCursorPosCallback(view->window, on_cursor);
    glfwSetScrollCallback(view->window, on_scroll);
    glfwSetWindowRefreshCallback(view->window, on_refresh);
    return RIS_OK;
}

static ris_result open_surface(view_state *view, ris_error *err)
{
    int width = 0, height = 0;
    glfwGetFramebufferSize(view->window, &width, &height);
    view->width = width > 0 ? (uint32_t)width : 1;
    view->height = height > 0 ? (uint32_t)height : 1;
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    VkInstance instance = ris_device_instance(view->backend.device);
    if (glfwCreateWindowSurface(instance, view->window, NULL, &surface) != VK_SUCCESS) {
        return window_fail("cannot make a Vulkan surface for the window", err);
    }
    return ris_window_create(view->backend.device, (uint64_t)surface, view->width, view->height,
                             &view->surface, err);
}

static ris_result open_motion(view_state *view, const ris_cli *cli, const view_args *args, ris_error *err)
{
    const ris_model *model = view->backend.model;
    view->pose = calloc(model->channel_count + 1u, sizeof *view->pose);
    if (!view->pose) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a pose");
    }
    ris_result r = RIS_OK;
    if (motion_file(&args->motion)) {
        r = motion_load(&args->motion, cli, model, &view->clip, err);
    } else if (args->pose) {
        r = ris_pose_parse(model, args->pose, view->pose, err);
    }
    motion_start(&args->motion, view->backend.sim);
    return r ? r : player_init(&view->player, view->backend.sim, view->clip, view->pose, err);
}

static ris_result open_view(view_state *view, const ris_cli *cli, const view_args *args, ris_error *err)
{
    if (!glfwInit()) {
        return window_fail("cannot open a window", err);
    }
    uint32_t extension_count = 0;
    const char **extensions = glfwGetRequiredInstanceExtensions(&extension_count);
    if (!extensions) {
        return window_fail("Vulkan cannot draw into windows here", err);
    }
    const backend_need need = {.sim = true,
                               .draw = true,
                               .instance_extensions = extensions,
                               .instance_extension_count = extension_count};
    ris_result r = backend_open(&view->backend, cli, args->head, &need, err);
    if (!r) {
        r = open_motion(view, cli, args, err);
    }
    if (!r) {
        r = open_window(view, args, err);
    }
    if (!r) {
        r = open_surface(view, err);
    }
    if (!r) {
        const ris_draw_def def = {.width = view->width, .height = view->height};
        r = ris_draw_create(view->backend.device, view->backend.model, &def, &view->draw, err);
    }
    if (!r && !cli->quiet) {
        fprintf(stderr, "device: %s\n", ris_sim_backend(view->backend.sim));
    }
    if (!r) {
        look_from(view, "front");
    }
    return r;
}

static void close_view(view_state *view)
{
    ris_window_destroy(view->surface);
    ris_draw_destroy(view->draw);
    player_finish(&view->player);
    ris_clip_destroy(view->clip);
    free(view->pose);
    backend_close(&view->backend);
    if (view->window) {
        glfwDestroyWindow(view->window);
    }
    glfwTerminate();
}

/* Moves the clip's time by seconds and the simulation with it, at most TICKS_PER_FRAME ticks. */
static ris_result move(view_state *view, double seconds, ris_error *err)
{
    ris_result r = RIS_OK;
    if (view->clip && !ris_clip_repeats(view->clip) && view->time_s >= ris_clip_duration_s(view->clip)) {
        view->restart = true;
    }
    if (view->step_back) {
        double target = view->time_s - 10 * RIS_TICK_S;
        r = player_restart(&view->player, err);
        view->time_s = target > 0 ? target : 0;
        view->playing = view->step_back = false;
        return r ? r : player_advance(&view->player, view->time_s, err);
    }
    if (view->restart) {
        view->restart = false;
        view->time_s = 0;
        return player_restart(&view->player, err);
    }
    if (view->step) {
        view->playing = view->step = false;
        view->time_s = (double)(view->player.tick + 1) * RIS_TICK_S;
    } else if (view->playing) {
        double most = (double)(view->player.tick + TICKS_PER_FRAME) * RIS_TICK_S;
        view->time_s += seconds * view->speed;
        view->time_s = view->time_s < most ? view->time_s : most;
    }
    return player_advance(&view->player, view->time_s, err);
}

/* Draws and shows one picture in the window's present size; a minimised window is left alone. */
static ris_result show(view_state *view, ris_error *err)
{
    int width, height;
    glfwGetFramebufferSize(view->window, &width, &height);
    if (width <= 0 || height <= 0) {
        glfwWaitEventsTimeout(0.1);
        return RIS_OK;
    }
    uint32_t w = width < SIDE_MAX ? (uint32_t)width : SIDE_MAX,
             h = height < SIDE_MAX ? (uint32_t)height : SIDE_MAX;
    ris_result r = RIS_OK;
    if (w != view->width || h != view->height) {
        r = ris_draw_resize(view->draw, w, h, err);
        view->width = w;
        view->height = h;
    }
    const ris_vec4 *position, *normal;
    if (!r) {
        r = ris_draw_set_layers(view->draw, view->layers, err); /* what a key has chosen; no layer = skin */
    }
    if (!r) {
        r = player_look(&view->player, view->time_s, &position, &normal, err);
    }
    if (!r) {
        ris_camera camera = orbit_camera(&view->orbit);
        r = ris_draw_frame_at(view->draw, view->backend.sim, position, normal, &camera, err);
    }
    view->stale = false;
    return r ? r : ris_window_present(view->surface, view->draw, w, h, err);
}

static void set_title(view_state *view, const view_args *args, double frame_ms)
{
    char title[256];
    snprintf(title, sizeof title, "Risorius - %.100s - %.2f s%s - %.1f ms a frame", args->head, view->time_s,
             view->playing ? "" : " (paused)", frame_ms);
    glfwSetWindowTitle(view->window, title);
}

/* Sleeps until a sixtieth of a second after start: FIFO presentation does not throttle everywhere. */
static void wait_for_frame(uint64_t start_ns)
{
    double left_ms = 1000.0 * RIS_TICK_S - ris__clock_ms(start_ns, ris__clock_ns());
    if (left_ms > 0.1) {
        struct timespec pause = {.tv_nsec = (long)(left_ms * 1e6)};
        nanosleep(&pause, NULL);
    }
}

static ris_result loop(view_state *view, const view_args *args, ris_error *err)
{
    ris_result r = RIS_OK;
    uint64_t last = ris__clock_ns(), titled = 0;
    view->playing = true;
    for (uint32_t frame = 0; !r && !glfwWindowShouldClose(view->window) && !interrupt_seen(); frame++) {
        if (args->frames > 0 && frame == args->frames) {
            break;
        }
        glfwPollEvents();
        uint64_t now = ris__clock_ns();
        /* a run of counted frames is for tests: each is one tick, however long it takes */
        double seconds = args->frames > 0 ? RIS_TICK_S : ris__clock_ms(last, now) / 1000.0;
        last = now;
        r = move(view, seconds, err);
        if (!r) {
            r = show(view, err);
        }
        if (now - titled > 500000000u) {
            set_title(view, args, ris__clock_ms(now, ris__clock_ns()));
            titled = now;
        }
        if (args->frames == 0) {
            wait_for_frame(now);
            while (!r && !view->playing && !view->stale && !view->step && !view->step_back &&
                   !view->restart && !glfwWindowShouldClose(view->window) && !interrupt_seen()) {
                glfwWaitEventsTimeout(0.25);
                last = ris__clock_ns();
            }
        }
    }
    return r;
}

static ris_result take_screenshot(view_state *view, const char *path, ris_error *err)
{
    uint8_t *rgba = malloc((size_t)view->width * view->height * 4);
    if (!rgba) {
        return ris_fail(err, RIS_ERROR_MEMORY, "out of memory for a screenshot");
    }
    ris_result r = ris_draw_read(view->draw, rgba, err);
    if (!r) {
        r = ris_png_write(path, rgba, view->width, view->height, err);
    }
    free(rgba);
    return r;
}

static ris_result parse(ris_cli *cli, view_args *args, int argc, char **argv, ris_error *err)
{
    const cli_option options[] = {
        MOTION_OPTIONS(&args->motion),
        {"pose", 'p', "POSE", "a pose to hold instead: name=value[,name=value...]", NULL, &args->pose, NULL},
        {"size", 's', "WxH", "size of the window (900x900)", NULL, &args->size, NULL},
        {"layers", 0, "LIST", LAYER_NAMES " (skin)", NULL, &args->layers_text, NULL},
        {"frames", 0, "N", "quit after N frames of one tick each", NULL, &args->frames_text, NULL},
        {"screenshot", 0, "FILE.png", "write the last picture", NULL, &args->screenshot, NULL},
        {0},
    };
    uint32_t count;
    ris_result r = cli_parse(cli, &cmd_view, options, argc, argv, &args->head, 1, &count, err);
    if (r || cli->done) {
        return r;
    }
    r = cli_need_head(&cmd_view, count, err);
    if (!r) {
        r = motion_check(&args->motion, err);
    }
    if (!r && motion_file(&args->motion) && args->pose) {
        r = ris_fail(err, RIS_ERROR_USAGE, "view takes --clip or --pose, not both");
    }
    if (!r) {
        r = cli_size("size", args->size ? args->size : "900x900", &args->width, &args->height, err);
    }
    args->layers = RIS_LAYER_SKIN;
    if (!r && args->layers_text) {
        r = layers_parse(args->layers_text, &args->layers, err);
    }
    if (!r && args->frames_text) {
        r = cli_count("frames", args->frames_text, 1, 1000000, &args->frames, err);
    }
    return r;
}

static ris_result run(ris_cli *cli, int argc, char **argv, ris_error *err)
{
    view_args args = {0};
    ris_result r = parse(cli, &args, argc, argv, err);
    if (r || cli->done) {
        return r;
    }
    view_state view = {.speed = 1.0, .layers = args.layers};
    r = open_view(&view, cli, &args, err);
    if (!r) {
        r = loop(&view, &args, err);
    }
    if (!r && args.screenshot) {
        r = take_screenshot(&view, args.screenshot, err);
    }
    close_view(&view);
    return r;
}

const cli_command cmd_view = {
    .name = "view",
    .usage = "HEAD [--clip C | --live-link T | --openface T | --pose P]",
    .summary = "show a head in a window",
    .detail = "left button      turn                    space  play, pause\n"
              "middle button    pan (or shift + left)   R      restart\n"
              "wheel            nearer, farther         W      wireframe\n"
              "1, 7, 3          front, 3/4, profile     right  one tick on, left: ten back\n"
              "up, down         faster, slower          Q      quit\n"
              "layers: S skin, M muscles, B bones, P springs, L landmarks, T strain\n",
    .run = run,
};
