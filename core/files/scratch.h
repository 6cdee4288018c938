/* A file without a name, which the system removes however the program ends. */
#pragma once

#include "core/base/base.h"

/* Where files must have a name for a moment, it begins so. */
#define CONIC_SCRATCH_START ".conic-spool-"

typedef struct conic_scratch {
  conic_context *context;
  const char *path; /* the file lies beside it, on the disk that will hold the result; for messages too */
  int descriptor;   /* -1: not open */
  int is_named;     /* the file has that path; whoever opened it owns it */
} conic_scratch;

/* `path` must outlive the file. Errors: MEMORY, IO. */
conic_status conic_scratch_open(conic_context *context, const char *path, conic_scratch *scratch);
void conic_scratch_close(conic_scratch *scratch);

/* Several threads may read while none writes. Errors: IO. */
conic_status conic_scratch_write(const conic_scratch *scratch, uint64_t at, const void *bytes, size_t n_bytes);
conic_status conic_scratch_read(const conic_scratch *scratch, uint64_t at, void *bytes, size_t n_bytes);
