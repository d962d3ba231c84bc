/* How names look (docs/file-formats.md, Names) and how a name finds its channels; used by head and clip
 * readers. */
#pragma once

#include "asset/json.h"
#include "base/text.h"
#include "risorius/head.h"

/* snake_case of letters and digits, with ".L" or ".R" behind it or not: muscles, regions, parts. */
bool ris__name_is_anatomical(const char *name);
/* True if name ends in ".L" or ".R". */
bool ris__name_is_sided(const char *name);
/* True if b is a with the other side, ".L" for ".R" or ".R" for ".L". */
bool ris__name_is_opposite(const char *a, const char *b);
/* The name in out that name is a synonym of, side kept ("caninus.L" for levator_anguli_oris.L), or NULL. */
const char *ris__name_of_synonym(const char *name, char out[RIS_NAME_SIZE]);
/* True if sided is name followed by ".L" or ".R". */
bool ris__name_is_side_of(const char *sided, const char *name);

/* Reads a name of at most RIS_NAME_SIZE - 1 bytes that is anatomical; what is for the message ("a muscle
 * name"). */
ris_result ris__read_name(const ris_json_at *at, const char *what, char out[RIS_NAME_SIZE], ris_error *err);

/* True if a mirror image changes the sign of the channel: jaw.side, eye.yaw, head.yaw, head.roll, head.x. */
bool ris__name_turns_sign(const char *name);
/* What kind other than an expression the name would be ("an action unit"), channels aside, or NULL. */
const char *ris__name_reserved(const char *name);

/* Channel names as a list, and expressions that are in reach beside those being read. */
typedef struct ris_scope {
    const char *const *channel;
    uint32_t channel_count;
    const ris_expression *outer; /* of the head while a clip is read, else NULL */
    uint32_t outer_count;
    const ris_vocabulary *vocabulary; /* or NULL */
} ris_scope;

/* True if name is a channel, the unsided name of one or two, or a synonym of such a name. */
bool ris__scope_has_channel(const ris_scope *scope, const char *name);

/* Reads the terms {name: value} of one expression into a new list (malloc, also on failure). */
ris_result ris__terms_read(const ris_json_at *at, ris_term **out, uint32_t *out_count, ris_error *err);
/* Reads {name: {channel: value}} into *out (malloc, also on failure: ris__expressions_finish). Refuses names
 * of another kind, unknown terms (three nearest) and terms that are expressions made of expressions. */
ris_result ris__expressions_read(const ris_json_at *at, const ris_scope *scope, ris_expression **out,
                                 uint32_t *out_count, ris_error *err);
void ris__expressions_finish(ris_expression *expression, uint32_t count);
/* By name, or NULL. */
const ris_expression *ris__expression_find(const ris_expression *expression, uint32_t count,
                                           const char *name);
