/* Parts of the reader of clips. */
#pragma once

#include "anim/clip.h"
#include "anim/pose_names.h"
#include "asset/json.h"

#define RIS_CLIP_MAX_S 86400.0
#define RIS_CLIP_MAX_VALUE 1000.0

/* A file being read, and the one that includes it. */
typedef struct ris_clip_reader {
    ris_pose_names names;
    ris_clip *clip;
    float *pose; /* scratch (channel_count) */
    ris_error *err;
    const char *path; /* of the file, NULL = from memory */
    const struct ris_clip_reader *outer;
    uint32_t *file_count; /* files read in all */
} ris_clip_reader;

/* What keys of a track may be and how they are taken. */
typedef struct ris_key_range {
    double duration_s, minimum, maximum;
    ris_ease ease; /* of keys that name none */
    double scale, offset, shift_s;
} ris_key_range;

/* Each reads what its name says; RIS_ERROR_DATA with the place in the file. Memory hangs on the clip at once, so that
 * ris_clip_destroy frees it after a failure too. */
ris_result ris__read_keys(const ris_json_at *at, const ris_key_range *range, ris_track *track,
                          ris_error *err);
ris_result ris__read_tracks(const ris_json_at *at, ris_clip_reader *r, ris_clip_layer *layer);
/* plain: the key "tracks" of the clip, which is the lowest layer; both may be absent, not both be. */
ris_result ris__read_layers(const ris_json_at *plain, const ris_json_at *list, ris_clip_reader *r);
ris_result ris__read_bool(const ris_json_at *at, bool *out, ris_error *err);
ris_result ris__clip_no_memory(const ris_json_at *at, ris_error *err);
/* Refuses a file that is one too many. */
ris_result ris__clip_count_file(const char *path, const ris_clip_reader *r);
/* A clip of another file that outer includes. */
ris_result ris__clip_include(const char *path, const ris_clip_reader *outer, ris_clip **out);
