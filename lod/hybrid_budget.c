#include "lod/hybrid_budget.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "core/message.h"

/* Patches in sight, and how far on the screen each of their levels is off. */
typedef struct fitting {
  const conic_hybrid *hybrid;
  int only_kind;
  const uint32_t *patches;
  size_t n;
  double *errors_px; /* of all levels of the first patch, then of the second … */
  uint32_t *levels;
} fitting;

static int is_allowed(const fitting *f, const conic_hybrid_level *level) {
  return f->only_kind < 0 || level->kind == (uint32_t)f->only_kind;
}

/* The finest of what is allowed, which is drawn where nothing is good enough. */
static uint32_t finest(const fitting *f, const conic_hybrid_level *levels, uint32_t n) {
  for (uint32_t k = 0; k < n; k++)
    if (is_allowed(f, &levels[k]))
      return k;
  return 0;
}

/* The level of fewest primitives among those that are good enough; of as many, the better one. */
static uint32_t fewest(const fitting *f, const conic_hybrid_patch *patch, const double *errors_px, double error_px) {
  const conic_hybrid_level *levels = f->hybrid->levels + patch->first_level;
  uint32_t best = finest(f, levels, patch->n_levels);
  for (uint32_t k = 0; k < patch->n_levels; k++) {
    int is_fewer = levels[k].count < levels[best].count ||
                   (levels[k].count == levels[best].count && errors_px[k] < errors_px[best]);
    if (is_allowed(f, &levels[k]) && errors_px[k] <= error_px && is_fewer)
      best = k;
  }
  return best;
}

/* Chooses for all patches; returns how many primitives that are, and the greatest error of what was chosen. */
static uint64_t choose_all(const fitting *f, double error_px, double *greatest_px) {
  const double *errors_px = f->errors_px;
  uint64_t count = 0;
  *greatest_px = 0.0;
  for (size_t i = 0; i < f->n; i++) {
    const conic_hybrid_patch *patch = &f->hybrid->patches[f->patches[i]];
    uint32_t level = fewest(f, patch, errors_px, error_px);
    count += f->hybrid->levels[patch->first_level + level].count;
    *greatest_px = errors_px[level] > *greatest_px ? errors_px[level] : *greatest_px;
    f->levels[i] = level;
    errors_px += patch->n_levels;
  }
  return count;
}

static conic_status measure_levels(fitting *f, const conic_hybrid_camera *view) {
  const conic_hybrid *h = f->hybrid;
  size_t n_levels = 0;
  for (size_t i = 0; i < f->n; i++)
    n_levels += h->patches[f->patches[i]].n_levels;
  double *next = f->errors_px = conic_memory_allocate(h->context, n_levels, sizeof *f->errors_px);
  if (!next)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < f->n; i++) {
    const conic_hybrid_patch *patch = &h->patches[f->patches[i]];
    for (uint32_t k = 0; k < patch->n_levels; k++)
      *next++ = conic_hybrid_error_px(view, patch, &h->levels[patch->first_level + k]);
  }
  return CONIC_OK;
}

static double error_of(uint64_t bits) {
  double error;
  memcpy(&error, &bits, sizeof error);
  return error;
}

static uint64_t bits_of(double error) {
  uint64_t bits;
  memcpy(&bits, &error, sizeof bits);
  return bits;
}

/* Halves the errors, which order like their bits as none is negative, down to the least that the budget gives. */
static conic_status fit(const fitting *f, uint64_t budget) {
  double error_px;
  if (choose_all(f, 0.0, &error_px) <= budget)
    return CONIC_OK;
  uint64_t count = choose_all(f, HUGE_VAL, &error_px), low = 0, high = bits_of(error_px);
  if (count > budget)
    return conic_fail(
        f->hybrid->context, CONIC_ERROR_ARGUMENT,
        "hybrid: the coarsest of what is in sight are %llu triangles and surfels, more than the budget of %llu",
        (unsigned long long)count, (unsigned long long)budget);
  while (high - low > 1) {
    uint64_t middle = low + (high - low) / 2;
    if (choose_all(f, error_of(middle), &error_px) > budget)
      low = middle;
    else /* what was chosen may be better than what was asked for */
      high = error_px < error_of(middle) ? bits_of(error_px) : middle;
  }
  choose_all(f, error_of(high), &error_px);
  return CONIC_OK;
}

conic_status conic_hybrid_fit_budget(const conic_hybrid *hybrid, const conic_hybrid_camera *view, int only_kind,
                                     uint64_t budget, const uint32_t *patches, size_t n, uint32_t *levels) {
  fitting f = {.hybrid = hybrid, .only_kind = only_kind, .patches = patches, .n = n};
  f.levels = levels;
  conic_status status = measure_levels(&f, view);
  if (status == CONIC_OK)
    status = fit(&f, budget);
  conic_memory_release(hybrid->context, f.errors_px);
  return status;
}
