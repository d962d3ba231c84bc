/* PCG32 (O'Neill 2014, XSH-RR 64/32): seeded numbers that are the same on every machine. */
#pragma once

#include <stdint.h>

/* 64 bits of state, a stream per sequence number. */
typedef struct ris_pcg {
    uint64_t state, increment;
} ris_pcg;

ris_pcg ris__pcg_start(uint64_t seed, uint64_t sequence);
uint32_t ris__pcg_next(ris_pcg *pcg);
/* Evenly in [0, limit), limit > 0, by rejection. */
uint32_t ris__pcg_below(ris_pcg *pcg, uint32_t limit);
/* Evenly in [0, 1), a multiple of 2^-32. */
double ris__pcg_unit(ris_pcg *pcg);
/* Nearly normal, mean 0, deviation 1: the sum of twelve even numbers less 6 (Irwin and Hall), never beyond 6. */
double ris__pcg_normal(ris_pcg *pcg);
