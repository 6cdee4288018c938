#include "source/top/top_lift.h"

#include "core/base/base.h"
#include "core/splats/columns.h"

enum { AXES_ARRAYS = 9, COLOR_ARRAYS = 3 };
enum { COPIED = CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES | CONIC_SPLATS_DOTS };

static size_t count_arrays(unsigned fields) {
  return AXES_ARRAYS + (fields & CONIC_SPLATS_COLORS ? COLOR_ARRAYS : 0u) +
         (fields & CONIC_SPLATS_OPACITIES ? 1u : 0u) + (fields & CONIC_SPLATS_DOTS ? 1u : 0u);
}

static void place_lifted_arrays(conic_top_set *set) {
  conic_splats *s = &set->splats;
  float *next = set->arrays, **all[] = {s->position, s->tangent_u, s->tangent_v, s->color};
  for (size_t i = 0; i < (set->fields & CONIC_SPLATS_COLORS ? 12 : 9); i++, next += set->room)
    all[i / 3][i % 3] = next;
  s->opacity = set->fields & CONIC_SPLATS_OPACITIES ? next : NULL;
  next += set->fields & CONIC_SPLATS_OPACITIES ? set->room : 0;
  s->dot = set->fields & CONIC_SPLATS_DOTS ? next : NULL;
}

/* Makes room for one more chunk of splats, keeping those that there are. */
static conic_status make_lifted_room(conic_context *context, conic_top_set *set, size_t wanted) {
  if (wanted <= set->room)
    return CONIC_OK;
  size_t room = (wanted + wanted / 4 + 1023) / 1024 * 1024, n = count_arrays(set->fields);
  float *arrays = conic_memory_allocate(context, room * n, sizeof *arrays);
  if (!arrays)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n && set->splats.count; i++)
    memcpy(arrays + i * room, set->arrays + i * set->room, set->splats.count * sizeof *arrays);
  conic_memory_release(context, set->arrays);
  set->arrays = arrays;
  set->room = room;
  place_lifted_arrays(set);
  return CONIC_OK;
}

void conic_top_set_release(conic_context *context, conic_top_set *set) {
  conic_memory_release_these(context, set->arrays, set->splats.clips);
  memset(set, 0, sizeof *set);
}

double conic_top_reach(const conic_splats *splats, size_t i, float cutoff) {
  const double widening = 1.5; /* for splats that are bounded by the box of their outline */
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double u = (double)conic_column_at(splats->tangent_u[axis], splats->strides.tangent_u, i);
    double v = (double)conic_column_at(splats->tangent_v[axis], splats->strides.tangent_v, i);
    sum += u * u + v * v;
  }
  return widening * (double)cutoff * sqrt(sum);
}

/* Whether a splat is wanted, and its place; splats that are not finite are not wanted. */
static int is_wanted(const conic_top_place *place, const conic_splats *splats, size_t i, double p[3]) {
  double reach = conic_top_reach(splats, i, place->cutoff);
  conic_columns_at(splats->position, splats->strides.position, i, p);
  double height = p[2] + splats->origin[2];
  for (int axis = 0; axis < 3; axis++)
    p[axis] += splats->origin[axis] - place->origin[axis];
  return height >= place->heights[0] && height <= place->heights[1] && p[0] + reach >= place->low[0] &&
         p[0] - reach <= place->high[0] && p[1] + reach >= place->low[1] && p[1] - reach <= place->high[1] &&
         height - height == 0.0;
}

static void lift_axis(const conic_top_place *place, const double p[3], float *const from[3], size_t stride, size_t i,
                      float *const to[3], size_t k) {
  double axis[3], depth = place->distance - p[2];
  conic_columns_at(from, stride, i, axis);
  for (int a = 0; a < 2; a++)
    to[a][k] = (float)((axis[a] * depth - p[a] * axis[2]) / place->distance);
  to[2][k] = (float)axis[2];
}

static void lift_one(const conic_top_place *place, const conic_splats *from, size_t i, const double p[3],
                     conic_top_set *set) {
  conic_splats *to = &set->splats;
  size_t k = to->count++;
  double depth = place->distance - p[2];
  to->position[0][k] = (float)(p[0] * depth / place->distance);
  to->position[1][k] = (float)(p[1] * depth / place->distance);
  to->position[2][k] = (float)p[2];
  lift_axis(place, p, from->tangent_u, from->strides.tangent_u, i, to->tangent_u, k);
  lift_axis(place, p, from->tangent_v, from->strides.tangent_v, i, to->tangent_v, k);
  for (int c = 0; c < 3 && to->color[0]; c++)
    to->color[c][k] = conic_column_at(from->color[c], from->strides.color, i);
  if (to->opacity)
    to->opacity[k] = conic_column_at(from->opacity, from->strides.opacity, i);
  if (to->dot)
    to->dot[k] = conic_column_at(from->dot, from->strides.dot, i);
}

/* Takes the clip lines of splat i, which is now the last one. `next` is the first record that may be its own. */
static conic_status take_clip(conic_context *context, const conic_splats *from, size_t i, size_t *next,
                              conic_top_set *set) {
  conic_splats *to = &set->splats;
  while (*next < from->n_clips && from->clips[*next].splat < i)
    ++*next;
  if (*next == from->n_clips || from->clips[*next].splat != i)
    return CONIC_OK;
  conic_clip clip = from->clips[*next];
  clip.splat = (uint32_t)(to->count - 1);
  return conic_memory_append(context, &to->clips, &to->n_clips, &set->clips_room, &clip, sizeof clip);
}

static void begin_set(conic_context *context, const conic_splats *splats, conic_top_set *set) {
  unsigned fields = conic_splats_fields(splats) & COPIED;
  if (fields != set->fields)
    conic_top_set_release(context, set);
  set->fields = fields;
  set->splats.count = set->splats.n_clips = 0;
}

conic_status conic_top_lift(conic_context *context, const conic_top_place *place, const conic_splats *splats,
                            const uint32_t *chosen, size_t n, conic_top_set *set) {
  enum { CHUNK = 4096 };
  conic_status status = CONIC_OK;
  size_t next_clip = 0;
  begin_set(context, splats, set);
  for (size_t k = 0; k < n && status == CONIC_OK; k++) {
    size_t i = chosen ? chosen[k] : k;
    double p[3];
    if (k % CHUNK == 0)
      status = make_lifted_room(context, set, set->splats.count + CHUNK);
    if (status != CONIC_OK || !is_wanted(place, splats, i, p))
      continue;
    lift_one(place, splats, i, p, set);
    if (splats->n_clips)
      status = take_clip(context, splats, i, &next_clip, set);
  }
  return status;
}
