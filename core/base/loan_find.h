/* What a caller has lent (conic/loan.h), found by those that read. */
#ifndef CONIC_LOAN_FIND_H
#define CONIC_LOAN_FIND_H

#include "conic/loan.h"

/* Whether a name is one that something of the kind ("splats", "image" …) can be lent under. */
int conic_loan_is_named(const char *name, const char *kind);

/* What is lent under that name, if it is of the kind; else null. */
const void *conic_loan_find(const conic_context *context, const char *name, const char *kind);

#endif
