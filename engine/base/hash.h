/* FNV-1a, 64 bit: the state hash of a simulation and anything else that wants a
 * fingerprint. Bytes are hashed as they lie in memory, so hashes compare between little-endian machines only.
 * */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define RIS_HASH_START UINT64_C(0xcbf29ce484222325)

/* Continues hash (RIS_HASH_START for a new one) over size bytes. */
uint64_t ris__hash(uint64_t hash, const void *data, size_t size);
