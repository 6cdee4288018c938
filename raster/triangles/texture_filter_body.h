/* Textures a pixel a lane: the operations of core/image/texture_sample.c in the same order, so that each pixel's sums
 * run over its texels as they do there. C and OpenCL C share this text. Who includes it has before it
 * fetch_texels(texels, which, color), which gives the texels that the lanes name. */
#include "core/image/texture_filter.h"
#include "core/image/texture_levels.h"
#include "core/lanes/lanes.h"

/* A texture's coordinates and the footprints' variances, in texels² of the first level, in as many pixels as there are
 * lanes. */
typedef struct texture_part {
  const conic_texture *texture;
  lanes place[2];
  lanes xx, xy, yy;
} texture_part;

CONIC_INLINE lanes near_or_zero(lanes value) {
  lanes farthest = lanes_of(CONIC_TEXTURE_FARTHEST);
  return lanes_keep(lanes_at_least(value, -farthest) & lanes_at_least(farthest, value), value);
}

/* Of values within int32_t. */
CONIC_INLINE int_lanes floor_to_int(lanes value) {
  int_lanes truncated = lanes_to_ints(value);
  lanes_mask is_above = lanes_less(value, lanes_of_ints(truncated));
  return lanes_select_ints(is_above, truncated - 1, truncated);
}

CONIC_INLINE lanes sides_of(lanes value, int size) {
  lanes side = near_or_zero(value) * (float)size;
  return lanes_min(lanes_max(side, lanes_of(-CONIC_TEXTURE_WIDEST)), lanes_of(CONIC_TEXTURE_WIDEST));
}

CONIC_INLINE lanes places_in(lanes value, conic_texture_wrap wrap) {
  value = near_or_zero(value);
  if (wrap == CONIC_WRAP_REPEAT)
    return value - lanes_of_ints(floor_to_int(value));
  return lanes_min(lanes_max(value, lanes_of(0.0f)), lanes_of(1.0f));
}

/* The eigenvalues of the variances. */
CONIC_INLINE void extents_of_lanes(const texture_part *p, lanes *greater, lanes *smaller) {
  lanes mean = 0.5f * (p->xx + p->yy), half = 0.5f * (p->xx - p->yy);
  lanes spread = lanes_sqrt(half * half + p->xy * p->xy);
  *greater = mean + spread;
  *smaller = lanes_keep(lanes_less(spread, mean), mean - spread);
}

CONIC_INLINE void begin_part(const conic_texture *texture, const lanes uv[2], const lanes along[2],
                             const lanes across[2], texture_part *p) {
  const conic_texture_level *level = &texture->levels[0];
  lanes ax = sides_of(along[0], level->width), ay = sides_of(along[1], level->height);
  lanes bx = sides_of(across[0], level->width), by = sides_of(across[1], level->height);
  lanes greater, smaller;
  p->texture = texture;
  for (int axis = 0; axis < 2; axis++)
    p->place[axis] = places_in(uv[axis], texture->wrap);
  p->xx = CONIC_FILTER_VARIANCE * (ax * ax + bx * bx);
  p->xy = -(CONIC_FILTER_VARIANCE * (ax * ay + bx * by));
  p->yy = CONIC_FILTER_VARIANCE * (ay * ay + by * by);
  extents_of_lanes(p, &greater, &smaller);
  lanes least = greater * (1.0f / (CONIC_FILTER_RATIO * CONIC_FILTER_RATIO)); /* a power of two */
  lanes_mask is_narrow = lanes_less(smaller, least);
  p->xx = lanes_select(is_narrow, p->xx + (least - smaller), p->xx);
  p->yy = lanes_select(is_narrow, p->yy + (least - smaller), p->yy);
}

/* The levels on which the footprints are as wide as they should be, and how far it is to those after. */
CONIC_INLINE index_lanes levels_of(const texture_part *p, lanes *beyond) {
  lanes greater, smaller, least = lanes_of(CONIC_FILTER_WIDTH), twice = lanes_of(2.0f * CONIC_FILTER_WIDTH);
  extents_of_lanes(p, &greater, &smaller);
  lanes width = 2.0f * lanes_sqrt(smaller);
  index_lanes level = lanes_of_index(0);
  int_lanes last = lanes_of_int(p->texture->n_levels - 1);
  for (;;) {
    lanes_mask is_wide = lanes_at_least(width, twice) & lanes_less_int(ints_of_indices(level), last);
    if (!lanes_any(is_wide))
      break;
    width = lanes_select(is_wide, width * 0.5f, width);
    level = lanes_increment(is_wide, level);
  }
  lanes_mask is_beyond = lanes_less_int(ints_of_indices(level), last) & lanes_at_least(width, least);
  *beyond = lanes_keep(is_beyond, (width - least) / least);
  return level;
}

/* From rows or columns of the endless picture to those of the level, which has `n`. */
CONIC_INLINE int_lanes wrapped_lanes(int_lanes i, int n, conic_texture_wrap wrap) {
  const int_lanes none = lanes_of_int(0), last = lanes_of_int(n - 1);
  lanes_mask is_before = lanes_less_int(i, none), is_after = lanes_less_int(last, i);
  if (!lanes_any(is_before | is_after))
    return i;
  if (wrap == CONIC_WRAP_REPEAT) { /* no quotient but a whole number is rounded up to one */
    lanes turns = lanes_of_ints(i) / lanes_of((float)n);
    return i - floor_to_int(turns) * n;
  }
  int_lanes high = lanes_select_ints(is_after, last, i);
  return lanes_select_ints(is_before, none, high);
}

/* The column after, which may be one of the endless picture. */
CONIC_INLINE int_lanes next_column(int_lanes column, int_lanes i, int n, conic_texture_wrap wrap) {
  const int_lanes none = lanes_of_int(0), last = lanes_of_int(n - 1);
  if (wrap == CONIC_WRAP_REPEAT)
    return lanes_select_ints(lanes_less_int(column, last), column + 1, none);
  return wrapped_lanes(i, n, wrap);
}

/* The filter on one level: its footprints. */
typedef struct texture_filter {
  const conic_texture_level *level;
  conic_texture_wrap wrap;
  lanes x, y, xx, xy, yy, inverse;
  lanes slope, of_yy, reach; /* of the rows' middles; the square of a row's half length is reach·(span − dy²/yy) */
  int_lanes x_begin, x_end, y_begin, y_end;
} texture_filter;

/* Pixels where the mask does not hold have no texels. */
CONIC_INLINE void begin_filter(const texture_part *p, int i_level, lanes_mask mask, texture_filter *f) {
  float shrunk = 1.0f / (float)(1 << i_level), scale = shrunk * shrunk;
  f->level = &p->texture->levels[i_level];
  f->wrap = p->texture->wrap;
  f->xx = lanes_keep(mask, p->xx * scale) + CONIC_FILTER_VARIANCE;
  f->xy = lanes_keep(mask, p->xy * scale);
  f->yy = lanes_keep(mask, p->yy * scale) + CONIC_FILTER_VARIANCE;
  f->x = p->place[0] * (float)f->level->width - 0.5f;
  f->y = (1.0f - p->place[1]) * (float)f->level->height - 0.5f;
  lanes determinant = f->xx * f->yy - f->xy * f->xy;
  f->inverse = 1.0f / determinant;
  f->of_yy = 1.0f / f->yy;
  f->slope = f->xy * f->of_yy;
  f->reach = determinant * f->of_yy;
  lanes reach_x = lanes_sqrt(CONIC_FILTER_SUPPORT * f->xx), reach_y = lanes_sqrt(CONIC_FILTER_SUPPORT * f->yy);
  const int_lanes none = lanes_of_int(0);
  f->x_begin = floor_to_int(f->x - reach_x) + 1;
  f->x_end = floor_to_int(f->x + reach_x) + 1;
  f->y_begin = floor_to_int(f->y - reach_y) + 1;
  f->y_end = floor_to_int(f->y + reach_y) + 1;
  f->y_end = lanes_select_ints(mask, f->y_end, none);
  f->y_begin = lanes_select_ints(mask, f->y_begin, none);
}

CONIC_INLINE int_lanes max_int(int_lanes a, int_lanes b) {
  return lanes_select_ints(lanes_less_int(a, b), b, a);
}

CONIC_INLINE int_lanes min_int(int_lanes a, int_lanes b) {
  return lanes_select_ints(lanes_less_int(a, b), a, b);
}

/* Where the texels of row j begin and end that may have weights; they end where they begin where there are none. */
CONIC_INLINE void find_span(const texture_filter *f, int_lanes j, lanes dy, int_lanes *begin, int_lanes *end) {
  lanes left = CONIC_FILTER_SPAN - dy * dy * f->of_yy, half = lanes_sqrt(f->reach * lanes_max(left, lanes_of(0.0f)));
  lanes middle = f->x + f->slope * dy;
  lanes_mask has_texels = lanes_less_int(j, f->y_end) & lanes_less(lanes_of(0.0f), left);
  *begin = max_int(floor_to_int(middle - half) + 1, f->x_begin);
  *end = min_int(floor_to_int(middle + half) + 1, f->x_end);
  *end = lanes_select_ints(has_texels, *end, *begin);
}

/* A row of a footprint: where its texels that may have weights begin and end, the column of the first, the row's first
 * texel, and what is the same in all of it. All rows are found before the first is summed up: that waits for nothing.
 */
typedef struct texture_row {
  int_lanes begin, end, column;
  index_lanes first;
  lanes skew, rise;
} texture_row;

/* Footprints are no larger: 8 times twice the greatest half width, and two texels. */
enum { MOST_ROWS = 52 };

CONIC_INLINE int find_rows(const texture_filter *f, conic_texture_wrap wrap, texture_row rows[MOST_ROWS]) {
  int n = 0;
  for (int_lanes j = f->y_begin; lanes_any(lanes_less_int(j, f->y_end)) && n < MOST_ROWS; j += 1) {
    texture_row *row = &rows[n++];
    lanes dy = lanes_of_ints(j) - f->y;
    row->skew = 2.0f * f->xy * dy;
    row->rise = f->xx * dy * dy;
    find_span(f, j, dy, &row->begin, &row->end);
    row->column = wrapped_lanes(row->begin, f->level->width, wrap);
    row->first = indices_of_ints(wrapped_lanes(j, f->level->height, wrap)) * (uint32_t)f->level->width;
  }
  return n;
}

CONIC_INLINE void add_row(const texture_filter *f, const texture_row *row, conic_texture_wrap wrap, lanes sum[4]) {
  const conic_texture_level *level = f->level;
  int_lanes i = row->begin, column = row->column;
  lanes i_float = lanes_of_ints(i);
  for (lanes_mask is_left = lanes_less_int(i, row->end); lanes_any(is_left); is_left = lanes_less_int(i, row->end)) {
    lanes dx = i_float - f->x, color[3];
    lanes q = ((f->yy * dx - row->skew) * dx + row->rise) * f->inverse;
    fetch_texels(conic_texels_of(level), row->first + indices_of_ints(column), color);
    lanes_mask has_weight = is_left & lanes_less(q, lanes_of(CONIC_FILTER_SUPPORT));
    lanes weight = lanes_keep(has_weight, lanes_exp_negative(-0.5f * q) - CONIC_FILTER_END);
    for (int channel = 0; channel < 3; channel++)
      sum[channel] += weight * color[channel];
    sum[3] += weight;
    i += 1;
    i_float += 1.0f;
    column = next_column(column, i, level->width, wrap);
  }
}

CONIC_INLINE void add_rows(const texture_filter *f, conic_texture_wrap wrap, lanes sum[4]) {
  texture_row rows[MOST_ROWS];
  int n = find_rows(f, wrap, rows);
  for (int i = 0; i < n; i++)
    add_row(f, &rows[i], wrap, sum);
}

/* Replaces the colours where the mask holds. */
CONIC_OUTLINE void filter_level(const texture_part *p, int i_level, lanes_mask mask, lanes color[3]) {
  lanes sum[4] = {lanes_of(0.0f), lanes_of(0.0f), lanes_of(0.0f), lanes_of(0.0f)};
  texture_filter f;
  if (i_level == p->texture->n_levels - 1) {
    for (int channel = 0; channel < 3; channel++)
      color[channel] =
          lanes_select(mask, lanes_of(conic_texels_of(&p->texture->levels[i_level])[channel]), color[channel]);
    return;
  }
  begin_filter(p, i_level, mask, &f);
  if (f.wrap == CONIC_WRAP_REPEAT)
    add_rows(&f, CONIC_WRAP_REPEAT, sum);
  else
    add_rows(&f, CONIC_WRAP_CLAMP, sum);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = lanes_select(mask, sum[channel] / sum[3], color[channel]);
}
