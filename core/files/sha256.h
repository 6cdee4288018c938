/* SHA-256 (FIPS 180-4), with which others can check a file. */
#pragma once

#include "core/base/base.h"

enum { CONIC_SHA256_ROOM = 65 };

typedef struct conic_sha256 {
  uint32_t state[8];
  uint64_t n_bytes;
  unsigned char block[64];
} conic_sha256;

void conic_sha256_begin(conic_sha256 *sum);
void conic_sha256_add(conic_sha256 *sum, const void *bytes, size_t n);
/* As 64 hex digits. */
void conic_sha256_end(conic_sha256 *sum, char text[CONIC_SHA256_ROOM]);

/* Whether the processor has instructions for it (core/files/sha256_machine.c); and blocks of 64 bytes mixed into the
 * state by these. */
int conic_sha256_has_instructions(void);
void conic_sha256_mix_blocks(uint32_t state[8], const uint32_t constants[64], const unsigned char *blocks, size_t n);
