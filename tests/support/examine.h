/* A picture held against the oracle's. */
#pragma once

#include "tests/support/fixture.h"

typedef struct outcome {
  conic_reference reference;
  conic_oracle_verdict verdict;
} outcome;

/* At one of so many pixels. */
static inline outcome examine_some(fixture *f, size_t of) {
  outcome o;
  conic_drawing drawing = {.splats = &f->splats};
  size_t n_judged = of > 1 ? (size_t)f->camera.width * (size_t)f->camera.height / of : 0;
  fixture_render(f);
  CHECK_OK(conic_oracle_render_pixels(f->context, &drawing, &f->camera, &f->options, CONIC_ORACLE_METHOD, 1, n_judged,
                                      &o.reference));
  CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
  return o;
}

static inline outcome examine(fixture *f) {
  return examine_some(f, 1);
}
