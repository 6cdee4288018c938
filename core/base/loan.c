#include "core/base/loan_find.h"

#include "core/base/base.h"
#include "core/base/context_struct.h"

static const char *const loan_kinds[] = {"splats", "triangles", "gaussians", "image", "camera"};

int conic_loan_is_named(const char *name, const char *kind) {
  static const char prefix[] = "memory:";
  size_t n_prefix = sizeof prefix - 1, n_kind = strlen(kind);
  return name && strncmp(name, prefix, n_prefix) == 0 && strncmp(name + n_prefix, kind, n_kind) == 0 &&
         name[n_prefix + n_kind] == ':';
}

const void *conic_loan_find(const conic_context *context, const char *name, const char *kind) {
  if (!conic_loan_is_named(name, kind))
    return NULL;
  for (size_t i = context->n_loans; i-- > 0;)
    if (strcmp(context->loans[i].name, name) == 0)
      return context->loans[i].what;
  return NULL;
}

conic_status conic_lend(conic_context *context, const char *name, const void *what) {
  int is_known = 0;
  for (size_t i = 0; i < sizeof loan_kinds / sizeof *loan_kinds; i++)
    is_known |= conic_loan_is_named(name, loan_kinds[i]);
  if (!is_known || !what)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: nothing can be lent under that name", name ? name : "null");
  const conic_loan loan = {conic_memory_copy_text(context, name), what};
  if (!loan.name)
    return CONIC_ERROR_MEMORY;
  conic_status status =
      conic_memory_append(context, &context->loans, &context->n_loans, &context->loans_room, &loan, sizeof loan);
  if (status != CONIC_OK)
    conic_memory_release(context, loan.name);
  return status;
}

void conic_take_back_loans(conic_context *context) {
  for (size_t i = 0; i < context->n_loans; i++)
    conic_memory_release(context, context->loans[i].name);
  conic_memory_release(context, context->loans);
  context->loans = NULL;
  context->n_loans = context->loans_room = 0;
}
