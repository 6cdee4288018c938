/* A picture held against the oracle's. */
#pragma once

#include "tests/support/fixture.h"

typedef struct outcome {
  conic_reference reference;
  conic_oracle_verdict verdict;
} outcome;

static inline outcome examine(fixture *f) {
  outcome o;
  fixture_render(f);
  CHECK_OK(conic_oracle_render(f->context, &f->splats, &f->camera, &f->options, CONIC_ORACLE_METHOD, &o.reference));
  CHECK_OK(conic_oracle_compare(f->context, &o.reference, &f->image, &o.verdict));
  return o;
}
