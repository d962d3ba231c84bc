/* Monotonic time for measurements; never an input of the simulation. */
#pragma once

#include <stdint.h>

/* Nanoseconds since an arbitrary start, never going back. */
uint64_t ris__clock_ns(void);
/* Milliseconds between two readings of ris__clock_ns(). */
double ris__clock_ms(uint64_t start_ns, uint64_t end_ns);
