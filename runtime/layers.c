#include "layers.h"

#include "base/text.h"
#include "risorius/draw.h"

#include <stdio.h>
#include <string.h>

static const char *const names[] = {"skin", "muscles", "skull", "springs", "landmarks", "strain"};

const char *layers_name(uint32_t bit)
{
    return bit < sizeof names / sizeof names[0] ? names[bit] : NULL;
}

static ris_result unknown_layer(const char *word, size_t length, ris_error *err)
{
    char name[64], nearest_text[128];
    snprintf(name, sizeof name, "%.*s", (int)(length < 60 ? length : 60), word);
    ris_nearest nearest;
    ris__nearest_init(&nearest, name);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        ris__nearest_add(&nearest, names[i]);
    }
    return ris_fail(err, RIS_ERROR_USAGE, "--layers: there is no layer '%s'; the nearest are %s", name,
                    ris__nearest_text(&nearest, nearest_text, sizeof nearest_text));
}

ris_result layers_parse(const char *text, uint32_t *out, ris_error *err)
{
    *out = 0;
    for (const char *c = text;; c++) {
        size_t length = strcspn(c, ",");
        uint32_t bit = 0;
        while (layers_name(bit) && (strlen(names[bit]) != length || strncmp(c, names[bit], length) != 0)) {
            bit++;
        }
        if (!layers_name(bit)) {
            return unknown_layer(c, length, err);
        }
        *out |= 1u << bit;
        c += length;
        if (*c == '\0') {
            return RIS_OK;
        }
    }
}
