#include "cli/render/strip_list.h"

#include <math.h>
#include <stdlib.h>

/* What lies across the border of two strips is read for both, so there are few: of a process's share, the first is one
 * part of so many, and the last of so many. */
enum { FIRST_PARTS = 2, LAST_PARTS = 10 };

/* The picture is weighed by so many slices, about. */
enum { SLICES = 1024 };

static int lesser_row(int a, int b) {
  return a < b ? a : b;
}

/* Rows in pieces of `rows`, none of them in two bands. Returns how many; `list` may be null. */
static size_t slice_picture(const conic_source_windows *w, int rows, conic_window *list) {
  int height = w->camera.height;
  size_t n = 0;
  for (int band = 0; band < height; band += w->band_rows) {
    int band_end = height - band < w->band_rows ? height : band + w->band_rows;
    for (int y = band; y < band_end; y += rows, n++)
      if (list)
        list[n] = (conic_window){0, w->camera.width, y, lesser_row(y + rows, band_end)};
  }
  return n;
}

/* Where the strip ends that begins with slice `first`: where its weight is next to what is wanted. The rest of a band
 * is parted evenly, lest something small is left of it. */
static size_t find_strip_end(const conic_source_windows *w, const conic_window *slices, const double *weights, size_t n,
                             size_t first, double wanted, int most_rows) {
  int begin = slices[first].y_begin, band = begin / w->band_rows;
  double weight = weights[first], in_band = 0.0;
  size_t end = first + 1;
  for (size_t i = first; i < n && slices[i].y_begin / w->band_rows == band; i++)
    in_band += weights[i];
  double n_parts = ceil(in_band / wanted - 0.15);
  wanted = in_band / (n_parts > 1.0 ? n_parts : 1.0);
  while (end < n && slices[end].y_begin / w->band_rows == band && slices[end].y_end - begin <= most_rows &&
         weight + 0.5 * weights[end] <= wanted)
    weight += weights[end++];
  return end;
}

/* Slices become strips, in place. */
static size_t unite_slices(const conic_source_windows *w, conic_window *slices, const double *weights, size_t n,
                           int most_rows, int n_processes) {
  double left = 0.0;
  for (size_t i = 0; i < n; i++)
    left += weights[i];
  double least = left / ((double)n_processes * LAST_PARTS);
  size_t n_strips = 0;
  for (size_t first = 0, end; first < n; first = end) {
    double wanted = left / ((double)n_processes * FIRST_PARTS);
    end = find_strip_end(w, slices, weights, n, first, wanted > least ? wanted : least, most_rows);
    slices[n_strips] = slices[first];
    slices[n_strips++].y_end = slices[end - 1].y_end;
    for (size_t i = first; i < end; i++)
      left -= weights[i];
  }
  return n_strips;
}

conic_status cli_list_strips(const conic_source_windows *windows, int step, int most_rows, int n_processes,
                             conic_window **strips, size_t *n) {
  int rows = most_rows;
  if (n_processes > 1)
    rows = lesser_row(((windows->camera.height - 1) / SLICES + step) / step * step, most_rows);
  *n = slice_picture(windows, rows, NULL);
  *strips = calloc(*n, sizeof **strips);
  if (!*strips)
    return CONIC_ERROR_MEMORY;
  slice_picture(windows, rows, *strips);
  if (n_processes == 1)
    return CONIC_OK;
  double *weights = calloc(*n, sizeof *weights);
  if (!weights)
    return CONIC_ERROR_MEMORY;
  conic_source_windows_weigh(windows, *strips, *n, weights);
  *n = unite_slices(windows, *strips, weights, *n, most_rows, n_processes);
  free(weights);
  return CONIC_OK;
}
