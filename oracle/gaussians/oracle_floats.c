/* What is known of others' floats, and the names of doubts. */
#include "conic/gaussian_judge.h"
#include "core/base/base.h"

/* Four times what a step rounds: orders of operations differ, and a few steps are one here. */
#define IN_DOUBLE (4.0 * 0x1p-53)
#define IN_FLOAT (4.0 * 0x1p-24)

/* A ulp is at most 2⁻²³ of a number. Conic's eˣ is within 1.1 of them (tests/core/splats/test_kernel.c). */
static const conic_float_model models[CONIC_N_FLOAT_KINDS] = {
    [CONIC_FLOATS_OWN] = {.setup_roundoff = IN_DOUBLE, .exp_relative = 1.1 * 0x1p-23, .n_form_roundings = 4},
    [CONIC_FLOATS_STRICT] = {.is_setup_in_float = 1,
                             .setup_roundoff = IN_FLOAT,
                             .exp_relative = 2.0 * 0x1p-23,
                             .n_form_roundings = 6},
    [CONIC_FLOATS_FAST] = {.is_setup_in_float = 1,
                           .setup_roundoff = IN_FLOAT,
                           .exp_relative = 0x1p-21,
                           .exp_by_argument = 0x1p-23,
                           .n_form_roundings = 6},
};

void conic_float_model_init_sized(conic_float_model *model, conic_float_kind kind, size_t size) {
  conic_float_model own = models[(unsigned)kind < CONIC_N_FLOAT_KINDS ? kind : CONIC_FLOATS_OWN];
  own.size = sizeof own;
  conic_options_give(model, size, &own);
}

CONIC_DEFINE_OPTIONS(conic_gaussian_judging, .samples = 1)

CONIC_DEFINE_NAMES(conic_gaussian_doubt_name, conic_gaussian_doubt, CONIC_N_GAUSSIAN_DOUBTS, "least", "sign", "edge",
                   "near", "order", "end", "most", "surface")

const char *conic_gaussian_class_name(conic_gaussian_class number) {
  return conic_pixel_class_name(number);
}

CONIC_DEFINE_NAMES(conic_gaussian_part_name, conic_gaussian_part, CONIC_N_GAUSSIAN_PARTS, "composited", "hidden",
                   "faint", "outside", "near", "behind")
