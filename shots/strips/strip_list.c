#include "shots/strips/strip_list.h"

#include "source/source_kind.h"

/* What lies across the border of two strips is read for both, so there are few: of a process's share, the first is one
 * part of so many, and the last of so many. */
enum { FIRST_PARTS = 2, LAST_PARTS = 10 };

/* The picture is weighed by so many slices, about. */
enum { SLICES = 1024 };

/* Rows in pieces of `rows`, none of them in two bands; behind *n strips of a list, which may be null. */
static void slice_rows(const conic_source_windows *w, int y, int y_end, int rows, conic_strip *list, size_t *n) {
  while (y < y_end) {
    int band = y / w->band_rows * w->band_rows, end = y_end - band < w->band_rows ? y_end : band + w->band_rows;
    end = end - y < rows ? end : y + rows;
    if (list)
      list[*n] = (conic_strip){y, end, 0};
    ++*n;
    y = end;
  }
}

/* What is kept, and pieces of what lies between. Returns how many; `list` may be null. */
static size_t slice_picture(const conic_source_windows *w, const conic_strip *kept, size_t n_kept, int rows,
                            conic_strip *list) {
  size_t n = 0;
  int y = 0;
  for (size_t i = 0; i < n_kept; i++) {
    slice_rows(w, y, kept[i].y_begin, rows, list, &n);
    if (list)
      list[n] = kept[i];
    n++;
    y = kept[i].y_end;
  }
  slice_rows(w, y, w->camera.height, rows, list, &n);
  return n;
}

/* Kept ones are no work. */
static conic_status weigh_slices(const conic_source_windows *w, const conic_strip *slices, size_t n, double *weights) {
  conic_window *list = conic_memory_allocate(w->source->context, n, sizeof *list);
  if (!list)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < n; i++)
    list[i] = (conic_window){0, w->camera.width, slices[i].y_begin, slices[i].y_end};
  conic_source_windows_weigh(w, list, n, weights);
  for (size_t i = 0; i < n; i++)
    weights[i] = slices[i].is_kept ? 0.0 : weights[i];
  conic_memory_release(w->source->context, list);
  return CONIC_OK;
}

/* Where the slices end that may be one strip with slice `first`: of its band, and none of them kept. */
static size_t find_run_end(const conic_source_windows *w, const conic_strip *slices, size_t n, size_t first) {
  size_t end = first + 1;
  while (end < n && !slices[end].is_kept && slices[end].y_begin / w->band_rows == slices[first].y_begin / w->band_rows)
    end++;
  return end;
}

/* Where the strip ends that begins with slice `first`: where its weight is next to what is wanted. The rest of a run
 * is parted evenly, lest something small is left of it. */
static size_t find_strip_end(const conic_strip *slices, const double *weights, size_t first, size_t run_end,
                             double wanted, int most_rows) {
  int begin = slices[first].y_begin;
  double weight = weights[first], in_run = 0.0;
  size_t end = first + 1;
  for (size_t i = first; i < run_end; i++)
    in_run += weights[i];
  double n_parts = ceil(in_run / wanted - 0.15);
  wanted = in_run / (n_parts > 1.0 ? n_parts : 1.0);
  while (end < run_end && slices[end].y_end - begin <= most_rows && weight + 0.5 * weights[end] <= wanted)
    weight += weights[end++];
  return end;
}

/* Slices become strips, in place. */
static size_t unite_slices(const conic_source_windows *w, conic_strip *slices, const double *weights, size_t n,
                           int most_rows, int n_processes) {
  double left = 0.0;
  for (size_t i = 0; i < n; i++)
    left += weights[i];
  double least = left / ((double)n_processes * LAST_PARTS);
  size_t n_strips = 0;
  for (size_t first = 0, end; first < n; first = end) {
    double wanted = left / ((double)n_processes * FIRST_PARTS);
    end = first + 1;
    if (!slices[first].is_kept)
      end = find_strip_end(slices, weights, first, find_run_end(w, slices, n, first), wanted > least ? wanted : least,
                           most_rows);
    slices[n_strips] = slices[first];
    slices[n_strips++].y_end = slices[end - 1].y_end;
    for (size_t i = first; i < end; i++)
      left -= weights[i];
  }
  return n_strips;
}

conic_status conic_list_strips(const conic_source_windows *windows, const conic_strip *kept, size_t n_kept, int step,
                               int most_rows, int n_processes, conic_strip **strips, size_t *n) {
  conic_context *context = windows->source->context;
  int rows = most_rows;
  if (n_processes > 1)
    rows = conic_least(((windows->camera.height - 1) / SLICES + step) / step * step, most_rows);
  *n = slice_picture(windows, kept, n_kept, rows, NULL);
  *strips = conic_memory_allocate(context, *n, sizeof **strips);
  if (!*strips)
    return CONIC_ERROR_MEMORY;
  slice_picture(windows, kept, n_kept, rows, *strips);
  if (n_processes == 1)
    return CONIC_OK;
  double *weights = conic_memory_allocate_zeroed(context, *n, sizeof *weights);
  conic_status status = weights ? weigh_slices(windows, *strips, *n, weights) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    *n = unite_slices(windows, *strips, weights, *n, most_rows, n_processes);
  conic_memory_release(context, weights);
  return status;
}
