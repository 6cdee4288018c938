/* Which points are wanted, by what they have by name: "classification = 2 and (intensity > 100 or z in 0..5)". The same
 * for every file (docs/reference/formats.md, Choosing points). */
#pragma once

#include "core/base/base.h"

typedef struct conic_filter conic_filter;

enum { CONIC_FILTER_MOST_NAMES = 16 };

/* Parses an expression. Errors: ARGUMENT (and where it is wrong), MEMORY. */
conic_status conic_filter_parse(conic_context *context, const char *expression, conic_filter **filter);
void conic_filter_destroy(conic_context *context, conic_filter *filter);

/* The names that it asks for, each once. */
size_t conic_filter_names(const conic_filter *filter);
const char *conic_filter_name(const conic_filter *filter, size_t i);

/* Whether a point with these values, in the order of the names, is wanted. A value that is not a number satisfies no
 * comparison but !=. */
int conic_filter_passes(const conic_filter *filter, const double *values);
