#include "core/files/guard.h"

#include <string.h>

#include "core/base/context_struct.h"
#include "core/base/memory.h"
#include "core/base/message.h"

static int is_file(const conic_file_identity *known, const conic_disk_entry *found) {
  return known->is_there && known->device == found->device && known->number == found->number;
}

static conic_file_identity identify(const conic_disk_entry *found) {
  return (conic_file_identity){1, found->device, found->number, found->n_bytes};
}

void conic_guard_inputs(conic_context *context, const char *replaceable) {
  conic_disk_entry found;
  context->guards_inputs = 1;
  context->n_inputs = 0;
  memset(&context->replaceable, 0, sizeof context->replaceable);
  if (replaceable && conic_disk_look(replaceable, &found))
    context->replaceable = identify(&found);
}

static int is_noted(const conic_context *context, const conic_disk_entry *found) {
  for (size_t i = 0; i < context->n_inputs; i++)
    if (is_file(&context->inputs[i], found))
      return 1;
  return 0;
}

conic_status conic_guard_note(conic_context *context, const conic_disk_entry *read) {
  if (!context->guards_inputs || !read->is_file || is_noted(context, read) || is_file(&context->replaceable, read))
    return CONIC_OK;
  conic_status status = conic_memory_reserve(context, &context->inputs, context->n_inputs, context->n_inputs + 1,
                                             &context->inputs_room, sizeof *context->inputs);
  if (status == CONIC_OK)
    context->inputs[context->n_inputs++] = identify(read);
  return status;
}

conic_status conic_guard_note_path(conic_context *context, const char *path) {
  conic_disk_entry found;
  return conic_disk_look(path, &found) ? conic_guard_note(context, &found) : CONIC_OK;
}

uint64_t conic_guard_bytes(const conic_context *context) {
  uint64_t n_bytes = 0;
  for (size_t i = 0; i < context->n_inputs; i++)
    n_bytes += context->inputs[i].n_bytes;
  return n_bytes;
}

conic_status conic_guard_check(conic_context *context, const char *path, const conic_disk_entry *existing) {
  if (!is_noted(context, existing))
    return CONIC_OK;
  return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s is an input, and would be written over", path);
}
