#include "command.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

#define WORDS 64

static void in_child(const command_def *def, char **words, int out, int err)
{
    if (def->file_limit > 0) {
        struct rlimit limit = {(rlim_t)def->file_limit, (rlim_t)def->file_limit};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    for (int i = 0; i < 4 && def->environment[i]; i++) {
        putenv((char *)(uintptr_t)def->environment[i]);
    }
    if (def->directory && chdir(def->directory) != 0) {
        _exit(126);
    }
    if (def->out_path) {
        out = open(def->out_path, O_WRONLY);
    }
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    execv(words[0], words);
    _exit(127);
}

/* The text of an unlinked temporary file from its start. */
static void take_text(FILE *file, char *text, size_t size)
{
    rewind(file);
    size_t length = fread(text, 1, size - 1, file);
    text[length] = '\0';
    fclose(file);
}

static void sleep_ms(int ms)
{
    struct timespec pause = {ms / 1000, (long)(ms % 1000) * 1000000L};
    nanosleep(&pause, NULL);
}

/* Parts line into at most WORDS words, stored in copy (as long as line). */
static void split_words(const char *line, char *copy, char **words)
{
    int count = 0;
    bool quoted = false, inside = false;
    for (; *line; line++) {
        if (*line == ' ' && !quoted) {
            *copy++ = '\0';
            inside = false;
            continue;
        }
        if (!inside && count < WORDS) {
            words[count++] = copy;
        }
        inside = true;
        if (*line == '\'') {
            quoted = !quoted;
        } else {
            *copy++ = *line;
        }
    }
    *copy = '\0';
}

void command_run(run_result *result, const command_def *def, const char *line)
{
    static const command_def plain;
    char *copy = malloc(strlen(line) + 1);
    assert_non_null(copy);
    char program[] = RIS_BUILD_DIR "/bin/risorius";
    char *words[WORDS + 2] = {program};
    split_words(line, copy, words + 1);
    FILE *out = tmpfile(), *err = tmpfile();
    assert_non_null(out);
    assert_non_null(err);
    pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        in_child(def ? def : &plain, words, fileno(out), fileno(err));
    }
    if (def && def->interrupt_after_ms > 0) {
        sleep_ms(def->interrupt_after_ms);
        kill(pid, SIGINT);
    }
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    result->code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    take_text(out, result->out, sizeof result->out);
    take_text(err, result->err, sizeof result->err);
    free(copy);
}

/* Removes what is in a folder, two levels deep: tests make no deeper ones. */
static void empty_folder(const char *folder, int depth)
{
    DIR *directory = opendir(folder);
    struct dirent *entry;
    while (directory && (entry = readdir(directory))) {
        char path[COMMAND_PATH_SIZE];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0 ||
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) >= (int)sizeof path) {
            continue;
        }
        if (unlink(path) != 0 && depth > 0) {
            empty_folder(path, depth - 1);
            rmdir(path);
        }
    }
    if (directory) {
        closedir(directory);
    }
}

void command_folder(char out[COMMAND_PATH_SIZE], const char *name)
{
    const char *base = RIS_BUILD_DIR "/cli";
    mkdir(base, 0777);
    assert_true(snprintf(out, COMMAND_PATH_SIZE, "%s/%s", base, name) < COMMAND_PATH_SIZE);
    mkdir(out, 0777);
    empty_folder(out, 2);
    assert_int_equal(command_entries(out), 0);
}

uint32_t command_entries(const char *folder)
{
    uint32_t count = 0;
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    struct dirent *entry;
    while ((entry = readdir(directory))) {
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    }
    closedir(directory);
    return count;
}

bool command_exists(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0;
}

void command_write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

char *command_read_file(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    rewind(file);
    char *text = size >= 0 ? malloc((size_t)size + 1) : NULL;
    if (text) {
        text[fread(text, 1, (size_t)size, file)] = '\0';
    }
    fclose(file);
    return text;
}

void command_spoil_head(const char *folder, const char *file, const char *text)
{
    const char *source = RIS_SOURCE_DIR "/assets/human";
    DIR *directory = opendir(source);
    assert_non_null(directory);
    struct dirent *entry;
    char from[COMMAND_PATH_SIZE], to[COMMAND_PATH_SIZE];
    while ((entry = readdir(directory))) {
        if (entry->d_name[0] == '.' || strcmp(entry->d_name, file) == 0) {
            continue;
        }
        assert_true(snprintf(from, sizeof from, "%s/%s", source, entry->d_name) < (int)sizeof from);
        assert_true(snprintf(to, sizeof to, "%s/%s", folder, entry->d_name) < (int)sizeof to);
        assert_int_equal(symlink(from, to), 0);
    }
    closedir(directory);
    assert_true(snprintf(to, sizeof to, "%s/%s", folder, file) < (int)sizeof to);
    command_write_file(to, text);
}
