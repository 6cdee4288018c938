#include "core/files/guard.h"

#include "core/base/context_struct.h"

static int is_file(const conic_file_identity *known, const conic_disk_entry *found) {
  return known->is_there && known->device == found->device && known->number == found->number;
}

static conic_file_identity identify(const conic_disk_entry *found) {
  return (conic_file_identity){1, found->device, found->number, found->n_bytes};
}

void conic_guard_inputs(conic_context *context, const char *replaceable) {
  conic_disk_entry found;
  for (size_t i = 0; i < context->n_inputs; i++)
    conic_memory_release(context, context->inputs[i].path);
  context->guards_inputs = 1;
  context->n_inputs = 0;
  context->inputs_phase = 0;
  memset(&context->replaceable, 0, sizeof context->replaceable);
  if (replaceable && conic_disk_look(replaceable, &found))
    context->replaceable = identify(&found);
}

static conic_noted_file *find_noted(const conic_context *context, const conic_disk_entry *found) {
  for (size_t i = 0; i < context->n_inputs; i++)
    if (is_file(&context->inputs[i].file, found))
      return &context->inputs[i];
  return NULL;
}

static conic_status add_noted(conic_context *context, const char *path, const conic_file_identity *file) {
  conic_status status = conic_memory_reserve(context, &context->inputs, context->n_inputs, context->n_inputs + 1,
                                             &context->inputs_room, sizeof *context->inputs);
  char *copy = status == CONIC_OK ? conic_memory_copy_text(context, path) : NULL;
  if (!copy)
    return CONIC_ERROR_MEMORY;
  context->inputs[context->n_inputs++] = (conic_noted_file){*file, copy, context->inputs_phase};
  return CONIC_OK;
}

conic_status conic_guard_note(conic_context *context, const char *path, const conic_disk_entry *read) {
  if (!context->guards_inputs || !read->is_file || is_file(&context->replaceable, read))
    return CONIC_OK;
  conic_noted_file *noted = find_noted(context, read);
  if (noted) {
    noted->phase = context->inputs_phase;
    return CONIC_OK;
  }
  const conic_file_identity file = identify(read);
  return add_noted(context, path, &file);
}

conic_status conic_guard_note_path(conic_context *context, const char *path) {
  conic_disk_entry found;
  return conic_disk_look(path, &found) ? conic_guard_note(context, path, &found) : CONIC_OK;
}

conic_status conic_guard_note_url(conic_context *context, const char *url, uint64_t n_bytes) {
  const conic_file_identity nowhere = {.n_bytes = n_bytes};
  return context->guards_inputs ? add_noted(context, url, &nowhere) : CONIC_OK;
}

void conic_guard_go_on(conic_context *context) {
  context->inputs_phase++;
}

int conic_guard_next(const conic_context *context, size_t *at, conic_guarded *read) {
  for (; *at < context->n_inputs; ++*at) {
    const conic_noted_file *noted = &context->inputs[*at];
    if (noted->phase != context->inputs_phase)
      continue;
    *read = (conic_guarded){noted->path, noted->file.n_bytes};
    ++*at;
    return 1;
  }
  return 0;
}

conic_status conic_guard_check(conic_context *context, const char *path, const conic_disk_entry *existing) {
  if (!find_noted(context, existing))
    return CONIC_OK;
  return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s is an input, and would be written over", path);
}
