/* The few macros that the tests share: a test is a program that checks, reports every failure, and returns
 * check_result(). */
#pragma once

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "conic/conic.h"

static int check_failures;

static inline int check_result(void) {
  if (check_failures)
    fprintf(stderr, "%d checks failed\n", check_failures);
  return check_failures ? 1 : 0;
}

#define CHECK(condition)                                                                                               \
  do {                                                                                                                 \
    if (!(condition)) {                                                                                                \
      fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                                          \
      check_failures++;                                                                                                \
    }                                                                                                                  \
  } while (0)

/* |a - b| ≤ bound; a NaN on either side fails. */
#define CHECK_NEAR(a, b, bound)                                                                                        \
  do {                                                                                                                 \
    double check_a = (a), check_b = (b), check_bound = (bound);                                                        \
    if (!(fabs(check_a - check_b) <= check_bound)) {                                                                   \
      fprintf(stderr, "%s:%d: %s = %.17g, %s = %.17g, more than %g apart\n", __FILE__, __LINE__, #a, check_a, #b,      \
              check_b, check_bound);                                                                                   \
      check_failures++;                                                                                                \
    }                                                                                                                  \
  } while (0)

#define CHECK_OK(call) CHECK((call) == CONIC_OK)

static inline void check_log(void *cookie, conic_log_level level, const char *message) {
  (void)cookie;
  (void)level;
  fprintf(stderr, "  log: %s\n", message);
}

/* A context that prints its messages; ends the program where it can't be had. */
static inline conic_context *check_context(int threads) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.log = check_log;
  options.threads = threads;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

/* The path of a file in the shared data folder beside the checkout; null, with a message, where it is absent. */
static inline const char *check_data(const char *source_folder, const char *name) {
  static char path[4096];
  snprintf(path, sizeof path, "%s/../shared/data/%s", source_folder, name);
  FILE *file = fopen(path, "rb");
  if (!file) {
    fprintf(stderr, "skipped: %s is not there\n", path);
    return NULL;
  }
  fclose(file);
  return path;
}
