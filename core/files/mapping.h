/* A whole file in memory, read-only. */
#pragma once

#include "core/files/input.h"

typedef struct conic_mapping {
  unsigned char *bytes;
  size_t n_bytes;
  int is_mapped; /* else allocated: the file is a pipe */
} conic_mapping;

/* "-" is standard input. The caller closes it. Errors: INPUT, MEMORY. */
conic_status conic_mapping_open(conic_context *context, const char *path, conic_mapping *mapping);

/* The file that an input has begun: a regular one is mapped; what is none, or is empty, is read on to its end, `most`
 * bytes of it. The caller closes *mapping, which begins empty, on failure too. Errors: INPUT, MEMORY, CANCELLED. */
conic_status conic_mapping_take(conic_input *input, uint64_t most, conic_mapping *mapping);

void conic_mapping_close(conic_context *context, conic_mapping *mapping);

/* 64 bits that change with any word of the bytes, computed at the speed of memory. */
unsigned long long conic_checksum(const unsigned char *bytes, size_t n_bytes);

/* The same for bytes that come in pieces. */
typedef struct conic_checksumming {
  uint64_t n_bytes, lanes[4];
  unsigned char rest[32];
} conic_checksumming;

void conic_checksum_begin(conic_checksumming *sum);
void conic_checksum_add(conic_checksumming *sum, const unsigned char *bytes, size_t n_bytes);
unsigned long long conic_checksum_end(const conic_checksumming *sum);
