#include "core/formats/point_fields.h"

#include <stdio.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/nearest_word.h"

enum { NAME_ROOM = sizeof(((conic_model_field *)0)->name) };

/* What does not matter in a name is left out. */
static void reduce_field_name(const char *name, char reduced[NAME_ROOM]) {
  size_t n = 0;
  for (const char *c = name; *c && n + 1 < NAME_ROOM; c++)
    if (*c != '_' && *c != '-' && *c != ' ')
      reduced[n++] = (char)(*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c);
  reduced[n] = 0;
  if (n > 6 && memcmp(reduced, "scalar", 6) == 0)
    memmove(reduced, reduced + 6, n - 5);
}

/* Of names that mean the same the first. */
static const char *meaning(const char *reduced) {
  static const char *const same[][2] = {
      {"reflectance", "intensity"}, {"class", "classification"}, {"label", "classification"}};
  for (size_t i = 0; i < sizeof same / sizeof *same; i++)
    if (strcmp(reduced, same[i][0]) == 0)
      return same[i][1];
  return reduced;
}

int conic_field_is(const char *name, const char *other) {
  char first[NAME_ROOM], second[NAME_ROOM];
  reduce_field_name(name, first);
  reduce_field_name(other, second);
  return strcmp(meaning(first), meaning(second)) == 0;
}

conic_status conic_fields_add(conic_builder *builder, const char *name, size_t length, const char *type) {
  conic_model *model = builder->model;
  conic_status status = conic_memory_reserve(builder->context, &model->fields, model->n_fields, model->n_fields + 1,
                                             &builder->field_capacity, sizeof *model->fields);
  if (status != CONIC_OK)
    return status;
  conic_model_field *field = &model->fields[model->n_fields++];
  memset(field, 0, sizeof *field);
  for (size_t i = 0; i < length && i + 1 < NAME_ROOM; i++) /* what would spoil a line of a terminal is no letter */
    field->name[i] = (char)((unsigned char)name[i] < 0x20 || name[i] == 0x7f ? '?' : name[i]);
  field->type = type;
  return CONIC_OK;
}

/* "a, b, c", as many as there is room for. */
static void list_field_names(const conic_model *model, char *text, size_t room) {
  size_t length = 0;
  for (size_t i = 0; i < model->n_fields && length < room; i++)
    length += (size_t)snprintf(text + length, room - length, "%s%s", i ? ", " : "", model->fields[i].name);
}

static conic_status refuse_field(conic_context *context, const char *file, const char *wanted,
                                 const conic_model *model) {
  char names[400] = "";
  const char *nearest = NULL;
  list_field_names(model, names, sizeof names);
  for (size_t i = 0; i < model->n_fields; i++)
    nearest = conic_nearer_word(wanted, nearest, model->fields[i].name);
  if (!model->n_fields)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: no field '%s': its points have none by name", file, wanted);
  return conic_fail(context, CONIC_ERROR_INPUT, "%s: no field '%s'%s%s%s; there are: %s", file, wanted,
                    nearest ? " (did you mean '" : "", nearest ? nearest : "", nearest ? "'?)" : "", names);
}

/* The very name, else one that means the same. */
static int find_field(const conic_model *model, const char *wanted) {
  for (size_t i = 0; i < model->n_fields; i++)
    if (strcmp(model->fields[i].name, wanted) == 0)
      return (int)i;
  for (size_t i = 0; i < model->n_fields; i++)
    if (conic_field_is(model->fields[i].name, wanted))
      return (int)i;
  return -1;
}

conic_status conic_fields_choose(conic_builder *builder, const char *file, const conic_read_options *options,
                                 int *chosen) {
  *chosen = options->field ? find_field(builder->model, options->field) : -1;
  if (*chosen >= 0)
    return conic_builder_add_field(builder, CONIC_SPLATS_SCALARS);
  return options->field && !options->field_is_optional
             ? refuse_field(builder->context, file, options->field, builder->model)
             : CONIC_OK;
}

conic_status conic_fields_check(conic_context *context, const char *file, const conic_read_options *options,
                                const conic_model *model) {
  return options->field && !options->field_is_optional && !model->points.scalar
             ? refuse_field(context, file, options->field, model)
             : CONIC_OK;
}
