/* The readers behind ris_head_load, one per file or object; each fills its fields of the head and leaves what
 * it took to ris_head_finish, also on failure. head->skin must be there before the others. */
#pragma once

#include "asset/json.h"
#include "risorius/head.h"

ris_result ris__regions_read(const ris_json *json, ris_head *head, ris_error *err);
/* Skin and bones must be there. */
ris_result ris__landmarks_read(const ris_json *json, ris_head *head, ris_error *err);
/* dynamics object of head.json; before the muscles, which take its times where they have none. */
ris_result ris__dynamics_read(const ris_json_at *at, ris_head *head, ris_error *err);
#define RIS_MAX_PACE_MS 2000
ris_result ris__muscles_read(const ris_json *json, ris_head *head, ris_error *err);
ris_result ris__tissue_read(const ris_json_at *at, ris_head *head, ris_error *err);
ris_result ris__jaw_read(const ris_json_at *at, ris_head *head, ris_error *err);
/* parts array of head.json; meshes and textures are read from head->directory. */
ris_result ris__parts_read(const ris_json_at *at, ris_head *head, ris_error *err);
/* The expressions of expressions.json; muscles must be there. */
ris_result ris__head_expressions_read(const ris_json *json, ris_head *head, ris_error *err);

/* depth.csv: "vertex,depth_mm,jaw_weight", one row per vertex in order. name stands for the file in errors.
 * */
ris_result ris__depth_read(const char *name, const char *text, size_t size, ris_head *head, ris_error *err);
/* guidance.csv: "forward_mm,side,open_deg", a full grid. */
ris_result ris__guidance_read(const char *name, const char *text, size_t size, ris_head *head,
                              ris_error *err);
/* skin.map: one base vertex or -1 per line, one line per vertex. */
ris_result ris__map_read(const char *name, const char *text, size_t size, ris_head *head, ris_error *err);

/* Reads a file name, checks that the file can be opened and gives its path (malloc) in *out; absent: *out
 * NULL. */
ris_result ris__read_file_key(const ris_json_at *at, const char *directory, char **out, ris_error *err);

/* A copy (malloc) of text. */
char *ris__copy_text(const char *text);
