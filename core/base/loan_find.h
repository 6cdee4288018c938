/* Finds what a caller has lent (conic/loan.h), for readers. */
#pragma once

#include "conic/loan.h"

/* Whether a set of the kind ("splats", "image" …) can be lent under a name. */
int conic_loan_is_named(const char *name, const char *kind);

/* The set lent under that name, if it is of the kind; else null. */
const void *conic_loan_find(const conic_context *context, const char *name, const char *kind);
