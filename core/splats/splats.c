#include <math.h>

#include "core/splats/columns.h"
#include "core/splats/point_values.h"
#include "core/splats/splats_gather.h"

/* What an absent array means: white and opaque; zero axes and normals, which are repaired later; no dot, no scalar
 * and no sight. */
static float absent_value(const conic_column *column) {
  if (column->field == CONIC_SPLATS_SCALARS)
    return NAN;
  return column->field & (CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES) ? 1.0f : 0.0f;
}

conic_status conic_splats_allocate(conic_context *context, size_t count, unsigned fields, conic_splats *splats) {
  conic_column columns[CONIC_SPLATS_COLUMNS];
  memset(splats, 0, sizeof *splats);
  conic_splats_list_columns(splats, columns);
  for (int i = 0; i < CONIC_SPLATS_COLUMNS; i++) {
    if (columns[i].field && !(fields & columns[i].field))
      continue;
    float *floats = *columns[i].floats = conic_memory_allocate(context, count, sizeof(float));
    if (!floats) {
      conic_splats_release(context, splats);
      return CONIC_ERROR_MEMORY;
    }
    conic_memory_prefer_large_pages(context, floats, count * sizeof(float));
  }
  if (fields & CONIC_SPLATS_CLIPS) {
    splats->clips = conic_memory_allocate(context, count, sizeof *splats->clips);
    if (!splats->clips) {
      conic_splats_release(context, splats);
      return CONIC_ERROR_MEMORY;
    }
  }
  splats->count = count;
  return CONIC_OK;
}

unsigned conic_splats_fields(const conic_splats *splats) {
  return (splats->tangent_u[0] ? (unsigned)CONIC_SPLATS_TANGENTS : 0u) |
         (splats->normal[0] ? (unsigned)CONIC_SPLATS_NORMALS : 0u) |
         (splats->color[0] ? (unsigned)CONIC_SPLATS_COLORS : 0u) |
         (splats->opacity ? (unsigned)CONIC_SPLATS_OPACITIES : 0u) |
         (splats->clips ? (unsigned)CONIC_SPLATS_CLIPS : 0u) | (splats->dot ? (unsigned)CONIC_SPLATS_DOTS : 0u) |
         (splats->scalar ? (unsigned)CONIC_SPLATS_SCALARS : 0u) |
         (splats->sight[0] ? (unsigned)CONIC_SPLATS_SIGHTS : 0u);
}

void conic_splats_release(conic_context *context, conic_splats *splats) {
  conic_column columns[CONIC_SPLATS_COLUMNS];
  conic_splats_list_columns(splats, columns);
  for (int i = 0; i < CONIC_SPLATS_COLUMNS; i++)
    conic_memory_release(context, *columns[i].floats);
  conic_memory_release(context, splats->clips);
  conic_point_values_destroy(context, splats->values);
  memset(splats, 0, sizeof *splats);
}

static void copy_or_fill(float *to, const conic_column *from) {
  for (size_t i = 0; i < from->count; i++)
    to[i] = *from->floats ? conic_column_at(*from->floats, *from->stride, i) : absent_value(from);
}

/* Puts the clip lines of both sets into `joined`, and nothing where there are none. On failure `joined` is empty. */
static conic_status join_clips(conic_context *context, const conic_splats *first, const conic_splats *next,
                               conic_splats *joined) {
  size_t n = first->n_clips + next->n_clips;
  if (n == 0)
    return CONIC_OK;
  joined->clips = conic_memory_allocate(context, n, sizeof *joined->clips);
  if (!joined->clips) {
    conic_splats_release(context, joined);
    return CONIC_ERROR_MEMORY;
  }
  joined->n_clips = n;
  if (first->n_clips)
    memcpy(joined->clips, first->clips, first->n_clips * sizeof *joined->clips);
  for (size_t i = 0; i < next->n_clips; i++) {
    conic_clip *clip = &joined->clips[first->n_clips + i];
    *clip = next->clips[i];
    clip->splat += (uint32_t)first->count;
  }
  return CONIC_OK;
}

conic_status conic_splats_append(conic_context *context, conic_splats *splats, const conic_splats *more) {
  conic_splats joined, second = *more;
  conic_column to[CONIC_SPLATS_COLUMNS], first[CONIC_SPLATS_COLUMNS], next[CONIC_SPLATS_COLUMNS];
  conic_status status = conic_splats_check_own(context, "append", splats);
  if (status == CONIC_OK)
    status = conic_splats_check(context, "append", more);
  if (status != CONIC_OK)
    return status;
  if (more->count > SIZE_MAX - splats->count)
    return conic_fail(context, CONIC_ERROR_MEMORY, "too many splats");
  unsigned fields = conic_splats_fields(splats) | conic_splats_fields(more);
  status = conic_splats_allocate(context, splats->count + more->count, fields & ~(unsigned)CONIC_SPLATS_CLIPS, &joined);
  if (status == CONIC_OK)
    status = join_clips(context, splats, more, &joined);
  if (status != CONIC_OK)
    return status;
  conic_splats_list_columns(&joined, to);
  conic_splats_list_columns(splats, first);
  conic_splats_list_columns(&second, next);
  for (int i = 0; i < CONIC_SPLATS_COLUMNS; i++) {
    if (!*to[i].floats)
      continue;
    copy_or_fill(*to[i].floats, &first[i]);
    copy_or_fill(*to[i].floats + splats->count, &next[i]);
  }
  for (int axis = 0; axis < 3; axis++) {
    double shift = more->origin[axis] - splats->origin[axis];
    joined.origin[axis] = splats->origin[axis];
    for (size_t i = 0; shift != 0.0 && i < more->count; i++)
      joined.position[axis][splats->count + i] = (float)((double)joined.position[axis][splats->count + i] + shift);
  }
  joined.scalar_origin = splats->scalar ? splats->scalar_origin : more->scalar_origin;
  double shift = more->scalar_origin - joined.scalar_origin;
  for (size_t i = 0; more->scalar && shift != 0.0 && i < more->count; i++)
    joined.scalar[splats->count + i] = (float)((double)joined.scalar[splats->count + i] + shift);
  conic_splats_release(context, splats);
  *splats = joined;
  return CONIC_OK;
}

conic_status conic_splats_resize(conic_context *context, conic_splats *splats, size_t capacity, unsigned fields) {
  conic_splats larger;
  conic_column to[CONIC_SPLATS_COLUMNS], from[CONIC_SPLATS_COLUMNS];
  conic_status status = conic_splats_allocate(context, capacity, fields & ~(unsigned)CONIC_SPLATS_CLIPS, &larger);
  if (status != CONIC_OK)
    return status;
  conic_splats_list_columns(&larger, to);
  conic_splats_list_columns(splats, from);
  for (int i = 0; i < CONIC_SPLATS_COLUMNS; i++)
    if (*to[i].floats)
      copy_or_fill(*to[i].floats, &from[i]);
  memcpy(larger.origin, splats->origin, sizeof larger.origin);
  larger.scalar_origin = splats->scalar_origin;
  larger.count = splats->count;
  larger.n_clips = splats->n_clips;
  larger.clips = splats->clips;
  larger.values = splats->values;
  splats->clips = NULL;
  splats->values = NULL;
  conic_splats_release(context, splats);
  *splats = larger;
  return CONIC_OK;
}

conic_status conic_splats_gather(conic_context *context, const conic_splats *from, const uint32_t *sources,
                                 size_t count, conic_splats *gathered) {
  conic_splats listed = *from;
  conic_column to[CONIC_SPLATS_COLUMNS], old[CONIC_SPLATS_COLUMNS];
  unsigned fields = conic_splats_fields(from) & ~(unsigned)CONIC_SPLATS_CLIPS;
  conic_status status = conic_splats_allocate(context, count, fields, gathered);
  if (status != CONIC_OK)
    return status;
  conic_splats_list_columns(gathered, to);
  conic_splats_list_columns(&listed, old);
  for (int i_column = 0; i_column < CONIC_SPLATS_COLUMNS; i_column++)
    for (size_t i = 0; *to[i_column].floats && i < count; i++)
      (*to[i_column].floats)[i] = (*old[i_column].floats)[sources[i]];
  memcpy(gathered->origin, from->origin, sizeof gathered->origin);
  gathered->scalar_origin = from->scalar_origin;
  return CONIC_OK;
}
