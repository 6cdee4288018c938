#include "core/splats/point_fields.h"

#include <limits.h>

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
  conic_model_field *field =
      conic_memory_add(builder->context, &model->fields, &model->n_fields, &builder->field_capacity, sizeof *field);
  if (!field)
    return CONIC_ERROR_MEMORY;
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

/* The column of a field, a new one where it has none yet. −1: there are too many. */
static int column_for(conic_point_values *values, int source) {
  for (size_t k = 0; k < values->n_columns; k++)
    if (values->source[k] == source)
      return (int)k;
  if (values->n_columns == CONIC_MOST_POINT_VALUES)
    return -1;
  values->source[values->n_columns] = source;
  return (int)values->n_columns++;
}

/* As find_field, or a place's coordinate; INT_MIN: it is not there. */
static int find_source(const conic_model *model, const char *wanted) {
  int found = find_field(model, wanted);
  if (found >= 0)
    return found;
  for (int axis = 0; axis < 3; axis++)
    if ((wanted[0] == "xyz"[axis] || wanted[0] == "XYZ"[axis]) && !wanted[1])
      return -1 - axis;
  return INT_MIN;
}

static void keep_field(const conic_model *model, int source, conic_point_values *values) {
  size_t n_before = values->n_columns;
  int column = column_for(values, source);
  if (column >= 0 && values->n_columns > n_before)
    values->field[values->n++] = model->fields[source];
}

static conic_status keep_named(conic_builder *builder, const char *file, const char *keep, conic_point_values *values) {
  const char *c = keep;
  while (*c) {
    char name[NAME_ROOM];
    size_t n = 0;
    for (; *c == ' ' || *c == ','; c++)
      continue;
    for (; *c && *c != ','; c++)
      if (n + 1 < sizeof name)
        name[n++] = *c;
    while (n > 0 && name[n - 1] == ' ')
      n--;
    name[n] = 0;
    int field = n ? find_field(builder->model, name) : -1;
    if (n && field < 0)
      return refuse_field(builder->context, file, name, builder->model);
    if (n)
      keep_field(builder->model, field, values);
  }
  return CONIC_OK;
}

int conic_field_is_of_splats(const char *name) {
  static const char *const own[] = {"x",     "y",    "z",    "nx",   "ny",  "nz",      "red",
                                    "green", "blue", "r",    "g",    "b",   "tu_x",    "tu_y",
                                    "tu_z",  "tv_x", "tv_y", "tv_z", "dot", "opacity", "radius"};
  for (size_t i = 0; i < sizeof own / sizeof *own; i++)
    if (strcmp(name, own[i]) == 0)
      return 1;
  return 0;
}

static conic_status keep_fields(conic_builder *builder, const char *file, const char *keep,
                                conic_point_values *values) {
  if (strcmp(keep, "all") != 0)
    return keep_named(builder, file, keep, values);
  for (size_t i = 0; i < builder->model->n_fields; i++)
    if (!conic_field_is_of_splats(builder->model->fields[i].name))
      keep_field(builder->model, (int)i, values);
  return CONIC_OK;
}

static conic_status choose_filtered(conic_builder *builder, const char *file, const char *where,
                                    conic_point_values *values) {
  conic_status status = conic_filter_parse(builder->context, where, &values->filter);
  for (size_t k = 0; status == CONIC_OK && k < conic_filter_names(values->filter); k++) {
    int source = find_source(builder->model, conic_filter_name(values->filter, k));
    if (source == INT_MIN)
      return refuse_field(builder->context, file, conic_filter_name(values->filter, k), builder->model);
    values->filtered_by[k] = column_for(values, source);
    if (values->filtered_by[k] < 0)
      return conic_fail(builder->context, CONIC_ERROR_INPUT, "%s: more values are asked for than %d", file,
                        CONIC_MOST_POINT_VALUES);
  }
  return status;
}

static conic_status choose_scalar_field(conic_builder *builder, const char *file, const conic_read_options *options,
                                        conic_point_values *values) {
  int field = options->field ? find_field(builder->model, options->field) : -1;
  if (field < 0)
    return options->field && !options->field_is_optional
               ? refuse_field(builder->context, file, options->field, builder->model)
               : CONIC_OK;
  values->scalar = column_for(values, field);
  values->is_scalar_origin_set = strcmp(builder->model->fields[field].type, "float") == 0;
  return values->scalar >= 0 ? conic_builder_add_field(builder, CONIC_SPLATS_SCALARS) : CONIC_OK;
}

conic_status conic_fields_choose(conic_builder *builder, const char *file, const conic_read_options *options) {
  if (!options->field && !options->keep && !options->where)
    return CONIC_OK;
  conic_point_values *values = conic_memory_allocate_zeroed(builder->context, 1, sizeof *values);
  if (!values)
    return CONIC_ERROR_MEMORY;
  conic_status status = options->keep ? keep_fields(builder, file, options->keep, values) : CONIC_OK;
  values->scalar = -1;
  if (status == CONIC_OK)
    status = choose_scalar_field(builder, file, options, values);
  if (status == CONIC_OK && options->where)
    status = choose_filtered(builder, file, options->where, values);
  builder->model->points.values = values;
  return status == CONIC_OK ? conic_point_values_reserve(builder->context, values, builder->point_capacity) : status;
}

conic_status conic_fields_check(conic_context *context, const char *file, const conic_read_options *options,
                                const conic_model *model) {
  if (options->where && model->n_triangles)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: it has faces, and points are chosen of files without", file);
  if (model->n_fields)
    return CONIC_OK; /* its reader has looked */
  const char *wanted = options->where                                       ? options->where
                       : options->keep && strcmp(options->keep, "all") != 0 ? options->keep
                                                                            : NULL;
  if (!wanted && options->field && !options->field_is_optional && !model->points.scalar)
    wanted = options->field;
  return wanted ? refuse_field(context, file, wanted, model) : CONIC_OK;
}
