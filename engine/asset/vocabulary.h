/* KA-54, KA-55, KU-31: the vocabularies of assets/vocabulary, which are part of the library (docs/facs.md). */
#pragma once

#include "base/text.h"
#include "risorius/head.h"

#define RIS_UNITS_MAX 16 /* units in one name, "AU1+2+5" */

typedef struct ris_vocabulary_text {
    const char *name; /* for messages */
    const char *text;
    size_t size;
} ris_vocabulary_text;

/* The files built into the library, one of each kind. */
extern const ris_vocabulary_text ris__vocabulary_file[RIS_WORD_KINDS];

/* Reads one file of each kind into *out (zeroed first; ris__vocabulary_finish also on failure). Refuses names of another
 * kind, units made of anything but channels, other words made of anything but units and channels. RIS_ERROR_DATA with the
 * place. Channel names are not checked here: they are the model's. */
ris_result ris__vocabulary_read(const ris_vocabulary_text file[RIS_WORD_KINDS], ris_vocabulary *out,
                                ris_error *err);
void ris__vocabulary_finish(ris_vocabulary *vocabulary);

/* One unit of a name that may join several. */
typedef struct ris_unit {
    char name[16]; /* "AU12.L" */
    float factor;  /* of the letter behind it: "AU12C" 0.6; 1 without */
} ris_unit;

/* "AU6+12C.L" into AU6.L and AU12.L. How many units, 0 if the name is not written so. */
uint32_t ris__units_split(const char *name, ris_unit unit[RIS_UNITS_MAX]);

/* The word of that name; or, if the name ends in .L or .R and there is none, the unit or expression without it, with its
 * side in *out_side (0 otherwise). NULL: none. */
const ris_word *ris__vocabulary_find(const ris_vocabulary *vocabulary, const char *name, char *out_side);
/* A word, one side of it, or units joined. vocabulary may be NULL. */
bool ris__vocabulary_has(const ris_vocabulary *vocabulary, const char *name);
/* Adds all names. */
void ris__vocabulary_nearest(const ris_vocabulary *vocabulary, ris_nearest *nearest);
