/* The mixing of SHA-256 by the instructions that x86 processors have for it. */
#ifndef CONIC_SHA256_X86_H
#define CONIC_SHA256_X86_H

#include <stddef.h>
#include <stdint.h>

/* Whether this processor has them. */
int conic_sha256_has_x86(void);
/* Mixes blocks of 64 bytes into the state. */
void conic_sha256_mix_x86(uint32_t state[8], const uint32_t constants[64], const unsigned char *blocks, size_t n);

#endif
