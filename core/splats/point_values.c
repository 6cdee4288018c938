#include "core/splats/point_values.h"

#include "core/splats/columns.h"
#include "core/splats/coordinate.h"

conic_status conic_point_values_reserve(conic_context *context, conic_point_values *values, size_t room) {
  for (size_t k = 0; k < values->n_columns && room > values->room; k++)
    if (conic_memory_grow(context, &values->value[k], values->room, room, sizeof **values->value) != CONIC_OK)
      return CONIC_ERROR_MEMORY;
  values->room = room > values->room ? room : values->room;
  return CONIC_OK;
}

void conic_point_values_destroy(conic_context *context, conic_point_values *values) {
  if (!values)
    return;
  for (size_t k = 0; k < values->n_columns; k++)
    conic_memory_release(context, values->value[k]);
  conic_filter_destroy(context, values->filter);
  conic_memory_release(context, values);
}

static void fill_place_columns(conic_splats *points, conic_point_values *values) {
  for (size_t k = 0; k < values->n_columns; k++) {
    int axis = -1 - values->source[k];
    for (size_t i = 0; i < points->count && axis >= 0; i++)
      values->value[k][i] = conic_coordinate_of(points->origin[axis], points->position[axis][i]);
  }
}

/* The record of point i, which is still there and now number `kept`. */
static void keep_point_clips(conic_splats *points, size_t i, size_t kept, size_t *next, size_t *n_clips) {
  while (*next < points->n_clips && points->clips[*next].splat < i)
    ++*next;
  if (*next < points->n_clips && points->clips[*next].splat == i) {
    points->clips[*n_clips] = points->clips[*next];
    points->clips[(*n_clips)++].splat = (uint32_t)kept;
  }
}

static void leave_points_out(conic_splats *points, conic_point_values *values) {
  conic_column columns[CONIC_SPLATS_COLUMNS];
  size_t kept = 0, next_clip = 0, n_clips = 0;
  conic_splats_list_columns(points, columns);
  for (size_t i = 0; i < points->count; i++) {
    double asked[CONIC_FILTER_MOST_NAMES];
    for (size_t k = 0; k < conic_filter_names(values->filter); k++)
      asked[k] = values->value[values->filtered_by[k]][i];
    if (!conic_filter_passes(values->filter, asked))
      continue;
    keep_point_clips(points, i, kept, &next_clip, &n_clips);
    for (int k = 0; k < CONIC_SPLATS_COLUMNS; k++)
      if (*columns[k].floats)
        (*columns[k].floats)[kept] = (*columns[k].floats)[i];
    for (size_t k = 0; k < values->n_columns; k++)
      values->value[k][kept] = values->value[k][i];
    kept++;
  }
  points->count = kept;
  points->n_clips = n_clips;
}

/* Where the first number lies as far out as map coordinates, it becomes the origin, such as of times. */
static void find_scalar_origin(conic_splats *points, conic_point_values *values) {
  const double *value = values->value[values->scalar];
  for (size_t i = 0; i < points->count && !values->is_scalar_origin_set; i++) {
    if (!(value[i] - value[i] == 0.0))
      continue;
    if (fabs(value[i]) > 65536.0)
      points->scalar_origin = value[i];
    values->is_scalar_origin_set = 1;
  }
}

void conic_point_values_settle(conic_splats *points) {
  conic_point_values *values = points->values;
  fill_place_columns(points, values);
  if (values->scalar >= 0 && points->scalar)
    find_scalar_origin(points, values);
  for (size_t i = 0; i < points->count && values->scalar >= 0 && points->scalar; i++)
    points->scalar[i] = (float)(values->value[values->scalar][i] - points->scalar_origin);
  if (values->filter)
    leave_points_out(points, values);
  values->count = points->count;
}

conic_status conic_splats_keep_value(conic_context *context, conic_splats *splats, const char *name,
                                     const float *values) {
  conic_point_values *kept = conic_memory_allocate_zeroed(context, 1, sizeof *kept);
  if (!kept)
    return CONIC_ERROR_MEMORY;
  conic_point_values_destroy(context, splats->values);
  splats->values = kept;
  kept->n = kept->n_columns = 1;
  kept->scalar = -1;
  snprintf(kept->field[0].name, sizeof kept->field[0].name, "%s", name);
  kept->field[0].type = "float";
  conic_status status = conic_point_values_reserve(context, kept, splats->count);
  for (size_t i = 0; i < splats->count && status == CONIC_OK; i++)
    kept->value[0][i] = (double)values[i];
  kept->count = status == CONIC_OK ? splats->count : 0;
  return status;
}
