#include "core/base/base.h"
#include "core/splats/columns.h"
#include "source/top/top_lift.h"

/* Marks a splat that is not finite, which is in no list. */
#define NOWHERE SIZE_MAX

enum { MOST_LISTS = 10 }; /* three by three squares, and the far-reaching splats */

static double ground_of(const conic_splats *splats, int axis, size_t i) {
  return splats->origin[axis] + (double)conic_column_at(splats->position[axis], splats->strides.position, i);
}

/* The square of a place along an axis; places beyond the squares belong to the last ones. */
static size_t bin_square_of(double place, double low, double edge, size_t n) {
  double at = (place - low) / edge;
  return at > 0.0 ? at < (double)n ? (size_t)at : n - 1 : 0;
}

static size_t list_of(const conic_top_bins *bins, const conic_splats *splats, float cutoff, size_t i) {
  double x = ground_of(splats, 0, i), y = ground_of(splats, 1, i), reach = conic_top_reach(splats, i, cutoff);
  if (!((x - x) + (y - y) + (reach - reach) == 0.0))
    return NOWHERE;
  if (reach > 0.5 * bins->edge)
    return bins->n_columns * bins->n_rows;
  return bin_square_of(y, bins->low[1], bins->edge, bins->n_rows) * bins->n_columns +
         bin_square_of(x, bins->low[0], bins->edge, bins->n_columns);
}

/* Takes at most as many squares as there are splats, or thousands. */
static void choose_squares(const conic_splats *splats, double edge, conic_top_bins *bins) {
  double low[3], high[3], most = splats->count > 4096 ? (double)splats->count : 4096.0;
  conic_splats_bounds(splats, low, high);
  while ((floor((high[0] - low[0]) / edge) + 1.0) * (floor((high[1] - low[1]) / edge) + 1.0) > most)
    edge *= 2.0;
  memcpy(bins->low, low, sizeof bins->low);
  bins->edge = edge;
  bins->n_columns = (size_t)((high[0] - low[0]) / edge) + 1;
  bins->n_rows = (size_t)((high[1] - low[1]) / edge) + 1;
}

void conic_top_bins_release(conic_context *context, conic_top_bins *bins) {
  conic_memory_release_these(context, bins->starts, bins->members, bins->found);
  memset(bins, 0, sizeof *bins);
}

conic_status conic_top_bins_make(conic_context *context, const conic_splats *splats, float cutoff, double edge,
                                 conic_top_bins *bins) {
  memset(bins, 0, sizeof *bins);
  choose_squares(splats, edge, bins);
  size_t n_lists = bins->n_columns * bins->n_rows + 1;
  if (conic_memory_allocate_these(context, CONIC_ZEROED(bins->starts, n_lists + 1),
                                  CONIC_ROOM(bins->members, splats->count)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < splats->count; i++) {
    size_t list = list_of(bins, splats, cutoff, i);
    if (list != NOWHERE)
      bins->starts[list + 1]++;
  }
  for (size_t k = 0; k < n_lists; k++)
    bins->starts[k + 1] += bins->starts[k];
  for (size_t i = 0; i < splats->count; i++) { /* a list's start moves to its end, where the next one starts … */
    size_t list = list_of(bins, splats, cutoff, i);
    if (list != NOWHERE)
      bins->members[bins->starts[list]++] = (uint32_t)i;
  }
  memmove(bins->starts + 1, bins->starts, n_lists * sizeof *bins->starts); /* … and is moved back */
  bins->starts[0] = 0;
  return CONIC_OK;
}

typedef struct span {
  const uint32_t *next, *end;
} span;

/* The lists of the squares that a box, widened by half a square, meets. */
static size_t list_spans(const conic_top_bins *bins, const double low[2], const double high[2],
                         span spans[MOST_LISTS]) {
  double half = 0.5 * bins->edge;
  size_t n_of[2] = {bins->n_columns, bins->n_rows}, first[2], last[2], n = 0;
  for (int axis = 0; axis < 2; axis++) {
    first[axis] = bin_square_of(low[axis] - half, bins->low[axis], bins->edge, n_of[axis]);
    last[axis] = bin_square_of(high[axis] + half, bins->low[axis], bins->edge, n_of[axis]);
  }
  for (size_t row = first[1]; row <= last[1]; row++)
    for (size_t column = first[0]; column <= last[0] && n < MOST_LISTS - 1; column++) {
      size_t list = row * bins->n_columns + column;
      spans[n++] = (span){bins->members + bins->starts[list], bins->members + bins->starts[list + 1]};
    }
  size_t far = bins->n_columns * bins->n_rows;
  spans[n++] = (span){bins->members + bins->starts[far], bins->members + bins->starts[far + 1]};
  return n;
}

conic_status conic_top_bins_find(conic_context *context, conic_top_bins *bins, const double low[2],
                                 const double high[2], size_t *n) {
  span spans[MOST_LISTS];
  size_t n_spans = list_spans(bins, low, high, spans), n_all = 0;
  for (size_t k = 0; k < n_spans; k++)
    n_all += (size_t)(spans[k].end - spans[k].next);
  conic_status status = CONIC_OK;
  *n = 0;
  if (n_all > bins->found_room)
    status = conic_memory_reserve(context, &bins->found, 0, n_all, &bins->found_room, sizeof *bins->found);
  if (status != CONIC_OK)
    return status;
  while (*n < n_all) {
    span *least = NULL;
    for (size_t k = 0; k < n_spans; k++)
      if (spans[k].next < spans[k].end && (!least || *spans[k].next < *least->next))
        least = &spans[k];
    if (!least)
      break;
    bins->found[(*n)++] = *least->next++;
  }
  return CONIC_OK;
}
