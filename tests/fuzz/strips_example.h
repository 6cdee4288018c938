/* A small picture in strips: what its fuzz target reads and its seed is of. */
#pragma once

#include "shots/strips/strips_file.h"

#define STRIPS_EXAMPLE_KEY "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"
enum { STRIPS_EXAMPLE_HEAD = 128, STRIPS_EXAMPLE_PART = 600 };

static const conic_strips_size strips_example = {
    .height = 200, .step = 16, .band_rows = 80, .row_bytes = 4, .most_bytes = 4096, .is_hashed = 1};
