/* Which samples of a layered cloud are drawn, and in which colours. */

#include "core/base/nearest_word.h"
#include "core/coloring/coloring_stream.h"
#include "lod/layers/draw/layers_scene.h"

static conic_status refuse_layer_value(const conic_layers *layers, const char *name) {
  const conic_layers_schema *schema = &layers->header.schema;
  const char *nearest = NULL;
  for (uint32_t i = 0; i < schema->n; i++)
    if (schema->list[i].kind == CONIC_LAYERS_VALUE)
      nearest = conic_nearer_word(name, nearest, schema->list[i].name);
  return conic_fail(layers->context, CONIC_ERROR_INPUT, "%s: its samples have no '%s'%s%s%s%s", layers->name, name,
                    nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "",
                    layers->octree ? ": only places and colours are read of it"
                                   : " (conic layer --keep keeps what there is)");
}

static conic_status choose_layer_colors(conic_layers *layers, const conic_coloring_options *options) {
  conic_layers_choice *choice = &layers->choice;
  conic_coloring_options own;
  conic_coloring_options_init(&own);
  if (!conic_options_take(&own, options) || !own.by)
    return conic_fail(layers->context, CONIC_ERROR_ARGUMENT, "layers: the colouring's options were not initialised");
  int is_auto = strcmp(own.by, "auto") == 0;
  if (strcmp(own.by, "rgb") == 0 || (is_auto && layers->header.flags & CONIC_LAYERS_COLORS))
    return CONIC_OK;
  if (strcmp(own.by, "height") == 0 || strcmp(own.by, "normal") == 0) /* for who has all samples, to do */
    return CONIC_OK;
  int i = conic_layers_schema_value(&layers->header.schema, is_auto ? "intensity" : own.by);
  if (i < 0)
    return is_auto ? CONIC_OK : refuse_layer_value(layers, own.by);
  const conic_layers_attribute *value = &layers->header.schema.list[i];
  if (is_auto && !(value->typical[1] > value->typical[0]))
    return CONIC_OK;
  choice->colored_by = i;
  return conic_coloring_of_range(layers->context, &own, is_auto ? "intensity" : own.by, value->typical, value->low,
                                 value->high, &choice->coloring);
}

static conic_status choose_layer_samples(conic_layers *layers, const char *where) {
  conic_layers_choice *choice = &layers->choice;
  conic_status status = conic_filter_parse(layers->context, where, &choice->filter);
  for (size_t k = 0; status == CONIC_OK && k < conic_filter_names(choice->filter); k++) {
    const char *name = conic_filter_name(choice->filter, k);
    choice->filtered_by[k] = conic_layers_schema_value(&layers->header.schema, name);
    for (int axis = 0; axis < 3 && choice->filtered_by[k] < 0; axis++)
      if ((name[0] == "xyz"[axis] || name[0] == "XYZ"[axis]) && !name[1])
        choice->filtered_by[k] = CONIC_LAYERS_BY_X - axis;
    if (choice->filtered_by[k] == -1)
      status = refuse_layer_value(layers, name);
  }
  return status;
}

/* The next of names that commas part, without blanks about it; where it ends. */
static const char *next_name(const char *names, char *name, size_t room) {
  size_t n = 0;
  names += strspn(names, " ,");
  size_t length = strcspn(names, ",");
  for (; n + 1 < room && n < length; n++)
    name[n] = names[n];
  while (n > 0 && name[n - 1] == ' ')
    n--;
  name[n] = 0;
  return names + length;
}

conic_status conic_layers_keep(conic_layers *layers, const char *names) {
  const conic_layers_schema *schema = &layers->header.schema;
  conic_layers_choice *choice = &layers->choice;
  int is_all = names && strcmp(names, "all") == 0;
  uint32_t n_before = choice->n_kept;
  conic_status status = CONIC_OK;
  choice->n_kept = 0;
  for (uint32_t i = 0; i < schema->n && is_all; i++)
    if (schema->list[i].kind == CONIC_LAYERS_VALUE)
      choice->kept[choice->n_kept++] = (uint8_t)i;
  while (names && !is_all && *names && status == CONIC_OK && choice->n_kept < CONIC_LAYERS_MOST_ATTRIBUTES) {
    char name[sizeof schema->list->name];
    names = next_name(names, name, sizeof name);
    int i = name[0] ? conic_layers_schema_value(schema, name) : -1;
    if (i >= 0)
      choice->kept[choice->n_kept++] = (uint8_t)i;
    else if (name[0])
      status = refuse_layer_value(layers, name);
  }
  choice->n_kept = status == CONIC_OK ? choice->n_kept : 0;
  if (choice->n_kept == 0 && n_before == 0)
    return status;
  conic_layers_store_close(layers); /* what is in memory has others */
  conic_status opened = conic_layers_store_open(layers);
  return status == CONIC_OK ? opened : status;
}

int conic_layers_value(const conic_layers *layers, size_t i, conic_model_field *field) {
  const conic_layers_schema *schema = &layers->header.schema;
  for (uint32_t k = 0; k < schema->n; k++) {
    if (schema->list[k].kind != CONIC_LAYERS_VALUE || i-- > 0)
      continue;
    memset(field, 0, sizeof *field);
    memcpy(field->name, schema->list[k].name, sizeof field->name);
    field->type = conic_layers_number_name(schema->list[k].type);
    return 1;
  }
  return 0;
}

conic_status conic_layers_choose(conic_layers *layers, const conic_coloring_options *coloring, const char *where,
                                 conic_coloring *done) {
  conic_layers_choice *choice = &layers->choice;
  conic_layers_store_close(layers);
  conic_filter_destroy(layers->context, choice->filter);
  memset(choice, 0, sizeof *choice);
  choice->colored_by = -1;
  conic_status status = coloring ? choose_layer_colors(layers, coloring) : CONIC_OK;
  if (status == CONIC_OK && where && layers->octree)
    status =
        conic_fail(layers->context, CONIC_ERROR_INPUT,
                   "%s: its samples cannot be chosen by --where: only places and colours are read of it", layers->name);
  else if (status == CONIC_OK && where)
    status = choose_layer_samples(layers, where);
  if (status != CONIC_OK) { /* what is half chosen is nothing */
    conic_filter_destroy(layers->context, choice->filter);
    choice->filter = NULL;
    choice->colored_by = -1;
  }
  conic_status opened = conic_layers_store_open(layers);
  if (done)
    *done = choice->coloring;
  return status == CONIC_OK ? opened : status;
}
