/* What the fuzz targets share: the input as a file that exists in memory only, and a context that says nothing. */
#pragma once

/* For memfd_create. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* NOLINT(bugprone-reserved-identifier,cert-dcl*) */
#endif

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "conic/conic.h"
#include "core/assimp/assimp_kinds.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n_bytes);

#define FUZZ_CHECK(condition)                                                                                          \
  do {                                                                                                                 \
    if (!(condition)) {                                                                                                \
      fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                                          \
      abort();                                                                                                         \
    }                                                                                                                  \
  } while (0)

typedef struct fuzz_input {
  conic_context *context;
  int descriptor;
  char path[32];
} fuzz_input;

static int fuzz_n_messages;

static inline void fuzz_log(void *cookie, conic_log_level level, const char *message) {
  (void)cookie;
  fuzz_n_messages += level == CONIC_LOG_ERROR;
  for (const char *c = message; *c; c++)
    FUZZ_CHECK((unsigned char)*c >= 0x20);
}

/* One context serves all runs: it keeps nothing of them. */
static inline fuzz_input fuzz_open(const uint8_t *bytes, size_t n_bytes) {
  static conic_context *context;
  fuzz_input input;
  if (!context) {
    conic_context_options options;
    conic_context_options_init(&options);
    options.log = fuzz_log;
    options.threads = 1;
    options.max_allocation_bytes = (size_t)1 << 30;
    FUZZ_CHECK(conic_context_create(&options, &context) == CONIC_OK);
  }
  input.context = context;
  input.descriptor = memfd_create("fuzz", MFD_CLOEXEC);
  FUZZ_CHECK(input.descriptor >= 0);
  FUZZ_CHECK(n_bytes == 0 || write(input.descriptor, bytes, n_bytes) == (ssize_t)n_bytes);
  snprintf(input.path, sizeof input.path, "/proc/self/fd/%d", input.descriptor);
  fuzz_n_messages = 0;
  return input;
}

/* What fails says once why, and what does not says nothing. */
static inline void fuzz_end(fuzz_input *input, conic_status status) {
  FUZZ_CHECK(fuzz_n_messages == (status != CONIC_OK));
  close(input->descriptor);
}

/* Of a reader: bad input is never anything else. */
static inline void fuzz_close(fuzz_input *input, conic_status status, int may_be_unsupported) {
  FUZZ_CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT ||
             (status == CONIC_ERROR_UNSUPPORTED && may_be_unsupported));
  fuzz_end(input, status);
}

/* A mesh as triangles. What can be read as a model can be read as those, unless a material file or a picture that it
 * names is spoiled. */
static inline void fuzz_triangles(const uint8_t *bytes, size_t n_bytes) {
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_triangles triangles;
  conic_status status = conic_triangles_read(input.context, input.path, &triangles);
  FUZZ_CHECK(conic_triangles_check(input.context, &triangles, "fuzz") == CONIC_OK);
  conic_triangles_release(input.context, &triangles);
  fuzz_close(&input, status, 1);
}

/* A file has as many points whichever of its fields is read, and one scalar a point then. Only a field that is packed
 * by itself may be spoiled where the others are sound. */
static inline void fuzz_field(const uint8_t *bytes, size_t n_bytes, const char *field, size_t n_points,
                              int may_be_spoiled) {
  conic_model model;
  conic_read_options options;
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_read_options_init(&options);
  options.field = field;
  conic_status status = conic_model_read(input.context, input.path, &options, &model);
  FUZZ_CHECK(status == CONIC_OK ? model.points.count == n_points && (model.points.scalar || n_points == 0)
                                : may_be_spoiled && status == CONIC_ERROR_INPUT);
  conic_model_release(input.context, &model);
  fuzz_close(&input, status, 0);
}

/* The models' targets differ in their seeds, and in what the bytes begin with: a target keeps to its own reader. */
static inline int fuzz_model(const uint8_t *bytes, size_t n_bytes, conic_model_kind kind) {
  conic_model model;
  double low[3], high[3];
  conic_model_kind found;
  if (kind < CONIC_MODEL_STL && conic_assimp_find_content("", (const char *)bytes, n_bytes, n_bytes, &found))
    return -1; /* which would start a process */
  fuzz_input input = fuzz_open(bytes, n_bytes);
  conic_status status = conic_model_read(input.context, input.path, NULL, &model);
  int is_mine = status == CONIC_OK && model.kind == kind;
  char field[sizeof model.fields->name] = "";
  size_t n_points = model.points.count;
  if (is_mine && model.n_fields)
    memcpy(field, model.fields[n_bytes % model.n_fields].name, sizeof field);
  for (size_t i = 0; i < model.n_triangles; i++)
    for (int corner = 0; corner < 3; corner++)
      FUZZ_CHECK(model.triangles[i][corner] < model.points.count);
  conic_splats_bounds(&model.points, low, high);
  conic_model_release(input.context, &model);
  fuzz_close(&input, status, 1); /* a kind of Assimp's, where that is not there */
  if (field[0])
    fuzz_field(bytes, n_bytes, field, n_points, kind == CONIC_MODEL_LAS || kind == CONIC_MODEL_E57);
  return is_mine || status != CONIC_OK ? 0 : -1; /* -1: not kept in the corpus */
}
