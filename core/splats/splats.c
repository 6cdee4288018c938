#include "conic/splats.h"

#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/splats/clip.h"
#include "core/splats/splats_gather.h"

/* The set's arrays in one list, so that what is done to one is done to all. */
enum { N_ARRAYS = 16 };

static void list_arrays(conic_splats *splats, float **arrays[N_ARRAYS]) {
  for (int axis = 0; axis < 3; axis++) {
    arrays[axis] = &splats->position[axis];
    arrays[3 + axis] = &splats->tangent_u[axis];
    arrays[6 + axis] = &splats->tangent_v[axis];
    arrays[9 + axis] = &splats->normal[axis];
    arrays[12 + axis] = &splats->color[axis];
  }
  arrays[15] = &splats->opacity;
}

static unsigned field_of_array(int i_array) {
  return i_array < 3    ? 0u
         : i_array < 9  ? (unsigned)CONIC_SPLATS_TANGENTS
         : i_array < 12 ? (unsigned)CONIC_SPLATS_NORMALS
         : i_array < 15 ? (unsigned)CONIC_SPLATS_COLORS
                        : (unsigned)CONIC_SPLATS_OPACITIES;
}

/* What an absent array means: white and opaque; zero axes and normals, which are repaired later. */
static float absent_value(int i_array) {
  return i_array >= 12 ? 1.0f : 0.0f;
}

conic_status conic_splats_allocate(conic_context *context, size_t count, unsigned fields, conic_splats *splats) {
  float **arrays[N_ARRAYS];
  memset(splats, 0, sizeof *splats);
  list_arrays(splats, arrays);
  for (int i = 0; i < N_ARRAYS; i++) {
    unsigned field = field_of_array(i);
    if (field && !(fields & field))
      continue;
    *arrays[i] = conic_memory_allocate(context, count, sizeof(float));
    if (!*arrays[i]) {
      conic_splats_release(context, splats);
      return CONIC_ERROR_MEMORY;
    }
    conic_memory_prefer_large_pages(context, *arrays[i], count * sizeof(float));
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
         (splats->clips ? (unsigned)CONIC_SPLATS_CLIPS : 0u);
}

void conic_splats_release(conic_context *context, conic_splats *splats) {
  float **arrays[N_ARRAYS];
  list_arrays(splats, arrays);
  for (int i = 0; i < N_ARRAYS; i++)
    conic_memory_release(context, *arrays[i]);
  conic_memory_release(context, splats->clips);
  memset(splats, 0, sizeof *splats);
}

static void copy_or_fill(float *to, const float *from, size_t count, float absent) {
  if (from)
    memcpy(to, from, count * sizeof *to);
  else
    for (size_t i = 0; i < count; i++)
      to[i] = absent;
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
  float **to[N_ARRAYS], **first[N_ARRAYS], **next[N_ARRAYS];
  if (more->count > SIZE_MAX - splats->count)
    return conic_fail(context, CONIC_ERROR_MEMORY, "too many splats");
  unsigned fields = conic_splats_fields(splats) | conic_splats_fields(more);
  conic_status status =
      conic_splats_allocate(context, splats->count + more->count, fields & ~(unsigned)CONIC_SPLATS_CLIPS, &joined);
  if (status == CONIC_OK)
    status = join_clips(context, splats, more, &joined);
  if (status != CONIC_OK)
    return status;
  list_arrays(&joined, to);
  list_arrays(splats, first);
  list_arrays(&second, next);
  for (int i = 0; i < N_ARRAYS; i++) {
    if (!*to[i])
      continue;
    copy_or_fill(*to[i], *first[i], splats->count, absent_value(i));
    copy_or_fill(*to[i] + splats->count, *next[i], more->count, absent_value(i));
  }
  for (int axis = 0; axis < 3; axis++) {
    double shift = more->origin[axis] - splats->origin[axis];
    joined.origin[axis] = splats->origin[axis];
    for (size_t i = 0; shift != 0.0 && i < more->count; i++)
      joined.position[axis][splats->count + i] = (float)((double)more->position[axis][i] + shift);
  }
  conic_splats_release(context, splats);
  *splats = joined;
  return CONIC_OK;
}

conic_status conic_splats_resize(conic_context *context, conic_splats *splats, size_t capacity, unsigned fields) {
  conic_splats larger;
  float **to[N_ARRAYS], **from[N_ARRAYS];
  conic_status status = conic_splats_allocate(context, capacity, fields & ~(unsigned)CONIC_SPLATS_CLIPS, &larger);
  if (status != CONIC_OK)
    return status;
  list_arrays(&larger, to);
  list_arrays(splats, from);
  for (int i = 0; i < N_ARRAYS; i++)
    if (*to[i])
      copy_or_fill(*to[i], *from[i], splats->count, absent_value(i));
  memcpy(larger.origin, splats->origin, sizeof larger.origin);
  larger.count = splats->count;
  larger.n_clips = splats->n_clips;
  larger.clips = splats->clips;
  splats->clips = NULL;
  conic_splats_release(context, splats);
  *splats = larger;
  return CONIC_OK;
}

conic_status conic_splats_gather(conic_context *context, const conic_splats *from, const uint32_t *sources,
                                 size_t count, conic_splats *gathered) {
  conic_splats listed = *from;
  float **to[N_ARRAYS], **old[N_ARRAYS];
  unsigned fields = conic_splats_fields(from) & ~(unsigned)CONIC_SPLATS_CLIPS;
  conic_status status = conic_splats_allocate(context, count, fields, gathered);
  if (status != CONIC_OK)
    return status;
  list_arrays(gathered, to);
  list_arrays(&listed, old);
  for (int i_array = 0; i_array < N_ARRAYS; i_array++)
    for (size_t i = 0; *to[i_array] && i < count; i++)
      (*to[i_array])[i] = (*old[i_array])[sources[i]];
  memcpy(gathered->origin, from->origin, sizeof gathered->origin);
  return CONIC_OK;
}

size_t conic_points_bounds(float *const position[3], const double origin[3], const uint32_t *indices, size_t n,
                           double minimum[3], double maximum[3]) {
  float low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
  size_t n_finite = 0;
  for (size_t k = 0; k < n; k++) {
    size_t i = indices ? indices[k] : k;
    const float p[3] = {position[0][i], position[1][i], position[2][i]};
    if (!(p[0] * 0.0f == 0.0f && p[1] * 0.0f == 0.0f && p[2] * 0.0f == 0.0f))
      continue;
    for (int axis = 0; axis < 3; axis++) {
      low[axis] = n_finite == 0 || p[axis] < low[axis] ? p[axis] : low[axis];
      high[axis] = n_finite == 0 || p[axis] > high[axis] ? p[axis] : high[axis];
    }
    n_finite++;
  }
  for (int axis = 0; axis < 3; axis++) {
    minimum[axis] = n_finite ? origin[axis] + (double)low[axis] : 0.0;
    maximum[axis] = n_finite ? origin[axis] + (double)high[axis] : 0.0;
  }
  return n_finite;
}

size_t conic_splats_bounds(const conic_splats *splats, double minimum[3], double maximum[3]) {
  return conic_points_bounds(splats->position, splats->origin, NULL, splats->count, minimum, maximum);
}
