#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

ris_result ris__file_read(const char *path, size_t max_size, char **out, size_t *out_size, ris_error *err)
{
    ris_result result = RIS_OK;
    char *data = NULL;
    size_t size = 0, capacity = 0;
    struct stat info;
    FILE *stream = fopen(path, "rb");
    *out = NULL;
    *out_size = 0;
    if (!stream) {
        return ris_fail(err, RIS_ERROR_DATA, "%s: cannot open: %s", path, strerror(errno));
    }
    if (fstat(fileno(stream), &info) == 0 && S_ISDIR(info.st_mode)) {
        result = ris_fail(err, RIS_ERROR_DATA, "%s: cannot read: %s", path, strerror(EISDIR));
        goto fail;
    }
    for (;;) {
        if (size + 1 >= capacity) {
            capacity = capacity ? capacity * 2 : (size_t)64 << 10;
            char *grown = realloc(data, capacity);
            if (!grown) {
                result = ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for %zu bytes", path, capacity);
                goto fail;
            }
            data = grown;
        }
        size_t got = fread(data + size, 1, capacity - 1 - size, stream);
        size += got;
        if (size > max_size) {
            result = ris_fail(err, RIS_ERROR_DATA, "%s: larger than the limit of %zu bytes", path, max_size);
            goto fail;
        }
        if (got == 0) {
            break;
        }
    }
    if (ferror(stream)) {
        result = ris_fail(err, RIS_ERROR_DATA, "%s: cannot read: %s", path, strerror(errno));
        goto fail;
    }
    fclose(stream);
    data[size] = 0;
    *out = data;
    *out_size = size;
    return RIS_OK;
fail:
    fclose(stream);
    free(data);
    return result;
}

ris_result ris__path_join(char out[RIS_PATH_SIZE], const char *directory, const char *name, ris_error *err)
{
    size_t length = strlen(directory);
    bool alone = name[0] == '/' || length == 0;
    bool slash = !alone && directory[length - 1] != '/';
    int wrote = snprintf(out, RIS_PATH_SIZE, "%s%s%s", alone ? "" : directory, slash ? "/" : "", name);
    if (wrote < 0 || wrote >= RIS_PATH_SIZE) {
        return ris_fail(err, RIS_ERROR_DATA, "%.100s...: path longer than %d bytes", name, RIS_PATH_SIZE - 1);
    }
    return RIS_OK;
}

static ris_result write_failed(const char *path, int reason, ris_error *err)
{
    return ris_fail(err, RIS_ERROR_FAILED, "%s: cannot write: %s", path, strerror(reason));
}

/* Devices and pipes must not be replaced by a file. */
static bool written_directly(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

ris_result ris__temporary_path(char out[RIS_PATH_SIZE], const char *path, ris_error *err)
{
    struct stat info;
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    int folder = slash ? (int)(slash - path) + 1 : 0;
    int wrote;
    if (name[0] == 0 || (stat(path, &info) == 0 && S_ISDIR(info.st_mode))) {
        return write_failed(path, EISDIR, err);
    }
    if (written_directly(path)) {
        wrote = snprintf(out, RIS_PATH_SIZE, "%s", path);
    } else {
        wrote = snprintf(out, RIS_PATH_SIZE, "%.*s.part-%ld-%s", folder, path, (long)getpid(), name);
    }
    if (wrote < 0 || wrote >= RIS_PATH_SIZE) {
        return write_failed(path, ENAMETOOLONG, err);
    }
    return RIS_OK;
}

ris_result ris__temporary_commit(const char *temporary, const char *path, ris_error *err)
{
    if (strcmp(temporary, path) != 0 && rename(temporary, path) != 0) {
        int reason = errno;
        remove(temporary);
        return write_failed(path, reason, err);
    }
    return RIS_OK;
}

ris_result ris__output_open(ris_output_file *file, const char *path, ris_error *err)
{
    *file = (ris_output_file){0};
    int wrote = snprintf(file->path, sizeof file->path, "%s", path);
    if (wrote < 0 || (size_t)wrote >= sizeof file->path) {
        return write_failed(path, ENAMETOOLONG, err);
    }
    if (written_directly(path)) {
        file->stream = fopen(path, "wb");
        return file->stream ? RIS_OK : write_failed(path, errno, err);
    }
    ris_result result = ris__temporary_path(file->temporary, path, err);
    if (result != RIS_OK) {
        file->temporary[0] = 0;
        return result;
    }
    int handle = open(file->temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    file->stream = handle >= 0 ? fdopen(handle, "wb") : NULL;
    if (!file->stream) {
        int reason = errno;
        if (handle >= 0) {
            close(handle);
            remove(file->temporary);
        }
        file->temporary[0] = 0;
        return write_failed(path, reason, err);
    }
    return RIS_OK;
}

ris_result ris__output_try(const char *path, ris_error *err)
{
    ris_output_file file = {0};
    ris_result result = written_directly(path) ? RIS_OK : ris__output_open(&file, path, err);
    ris__output_discard(&file);
    return result;
}

ris_result ris__output_write(ris_output_file *file, const void *data, size_t size, ris_error *err)
{
    errno = 0;
    if (size > 0 && fwrite(data, 1, size, file->stream) != size) {
        return write_failed(file->path, errno ? errno : EIO, err);
    }
    return RIS_OK;
}

ris_result ris__output_printf(ris_output_file *file, ris_error *err, const char *format, ...)
{
    va_list args;
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (c_locale == (locale_t)0) {
        return ris_fail(err, RIS_ERROR_MEMORY, "%s: no memory for the C locale", file->path);
    }
    locale_t before = uselocale(c_locale);
    va_start(args, format);
    errno = 0;
    int wrote = vfprintf(file->stream, format, args);
    int reason = errno;
    va_end(args);
    uselocale(before);
    freelocale(c_locale);
    return wrote < 0 ? write_failed(file->path, reason ? reason : EIO, err) : RIS_OK;
}

ris_result ris__output_commit(ris_output_file *file, ris_error *err)
{
    bool failed_before = ferror(file->stream) != 0;
    errno = 0;
    bool flushed = fflush(file->stream) == 0;
    int reason = errno;
    errno = 0;
    bool closed = fclose(file->stream) == 0;
    reason = reason ? reason : errno;
    file->stream = NULL;
    if (failed_before || !flushed || !closed) {
        ris__output_discard(file);
        return write_failed(file->path, reason ? reason : EIO, err);
    }
    if (file->temporary[0] == 0) {
        return RIS_OK;
    }
    ris_result result = ris__temporary_commit(file->temporary, file->path, err);
    file->temporary[0] = 0;
    return result;
}

void ris__output_discard(ris_output_file *file)
{
    if (file->stream) {
        fclose(file->stream);
        file->stream = NULL;
    }
    if (file->temporary[0]) {
        remove(file->temporary);
        file->temporary[0] = 0;
    }
}

ris_result ris__file_write(const char *path, const void *data, size_t size, ris_error *err)
{
    ris_output_file file = {0};
    ris_result result = ris__output_open(&file, path, err);
    if (result == RIS_OK) {
        result = ris__output_write(&file, data, size, err);
    }
    if (result == RIS_OK) {
        result = ris__output_commit(&file, err);
    }
    ris__output_discard(&file);
    return result;
}

ris_result ris__directory_make(const char *path, ris_error *err)
{
    struct stat info;
    if (mkdir(path, 0777) == 0 || (errno == EEXIST && stat(path, &info) == 0 && S_ISDIR(info.st_mode))) {
        return RIS_OK;
    }
    return ris_fail(err, RIS_ERROR_FAILED, "%s: cannot make the directory: %s", path, strerror(errno));
}
