/* Unpacking Brotli, through libbrotlidec where it is there. */
#pragma once

#include "core/base/base.h"

int conic_unbrotli_is_there(void);

/* Whether the bytes unpack to n_bytes exactly. Thread-safe. */
int conic_unbrotli(conic_context *context, const unsigned char *from, size_t n_from, unsigned char *to, size_t n_bytes);
