/* Where a picture is wrong: places and values, found from the map of wrong pixels alone. */
#include <string.h>

#include "conic/diagnosis.h"

/* A set of pixels: of columns and rows from `first` to `last`, those whose column, row or sum of both is `rest` modulo
 * n. */
typedef struct region {
  int first[2], last[2];
  int axis, n, rest; /* axis 2: the sum */
} region;

typedef struct locate_job {
  const conic_image *image;
  const uint8_t *classes;
  int first[2], last[2]; /* of the wrong pixels */
  size_t n_wrong;
} locate_job;

static int is_in_region(const region *r, int x, int y) {
  const int place = r->axis == 0 ? x : r->axis == 1 ? y : x + y;
  return x >= r->first[0] && x <= r->last[0] && y >= r->first[1] && y <= r->last[1] &&
         (r->n < 2 || place % r->n == r->rest);
}

static int is_same_color(const conic_image *image, size_t a, size_t b) {
  const float *rgba = image->planes[CONIC_PLANE_RGBA];
  return rgba && memcmp(rgba + 4 * a, rgba + 4 * b, 3 * sizeof *rgba) == 0;
}

/* Whether all that is wrong lies in the region, and the region is one: of one colour, while the rest has several, or
 * wrong nearly everywhere. */
static int is_fault_of_region(const locate_job *j, const region *r, conic_fault_place *place) {
  const size_t width = (size_t)j->image->width, none = width * (size_t)j->image->height;
  size_t n_wrong = 0, n_in = 0, n_out = 0, one_in = none, one_out = none;
  int is_constant = 1, is_rest_constant = 1;
  for (int y = 0; y < j->image->height; y++)
    for (int x = 0; x < j->image->width; x++) {
      const size_t pixel = (size_t)y * width + (size_t)x;
      if (j->classes[pixel] > CONIC_PIXEL_WRONG)
        continue;
      if (is_in_region(r, x, y)) {
        n_in++;
        n_wrong += j->classes[pixel] == CONIC_PIXEL_WRONG;
        one_in = one_in == none ? pixel : one_in;
        is_constant &= is_same_color(j->image, one_in, pixel);
      } else {
        n_out++;
        one_out = one_out == none ? pixel : one_out;
        is_rest_constant &= is_same_color(j->image, one_out, pixel);
      }
    }
  place->is_constant = is_constant && j->image->planes[CONIC_PLANE_RGBA];
  place->pixels = n_wrong;
  return n_wrong == j->n_wrong && n_out > 0 && !is_rest_constant && (is_constant || 10 * n_wrong >= 9 * n_in);
}

static int find_tile(const locate_job *j, conic_fault_place *place) {
  for (int size = 8; size <= 32; size *= 2) {
    region r = {.n = 1};
    int is_one = 1;
    *place = (conic_fault_place){.kind = "tile", .size = size};
    for (int axis = 0; axis < 2; axis++) {
      place->at[axis] = j->first[axis] / size;
      is_one &= j->last[axis] / size == place->at[axis];
      r.first[axis] = place->at[axis] * size;
      r.last[axis] = r.first[axis] + size - 1;
    }
    if (is_one && is_fault_of_region(j, &r, place))
      return 1;
  }
  return 0;
}

/* One or two columns or rows at an edge; or a band of them, of the width of tiles. */
static int find_band(const locate_job *j, conic_fault_place *place) {
  static const char *const kinds[] = {"column", "row"}, *const sides[][2] = {{"left", "right"}, {"top", "bottom"}};
  static const int sizes[] = {1, 2, 8, 16, 32};
  const int whole[2] = {j->image->width, j->image->height};
  for (int axis = 0; axis < 2; axis++)
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
      region r = {.last = {whole[0] - 1, whole[1] - 1}, .n = 1};
      const int size = sizes[k], at = j->first[axis] / size, is_last = j->last[axis] == whole[axis] - 1;
      const int is_border = size <= 2 && (j->last[axis] < size || j->first[axis] >= whole[axis] - size);
      if (!is_border && (size == 2 || j->last[axis] / size != at))
        continue;
      r.first[axis] = is_border ? (is_last ? whole[axis] - size : 0) : at * size;
      r.last[axis] = r.first[axis] + size - 1;
      *place = (conic_fault_place){
          .kind = is_border ? "border" : kinds[axis], .what = is_border ? sides[axis][is_last] : NULL, .size = size};
      place->at[axis] = is_border ? r.first[axis] : at;
      if (is_fault_of_region(j, &r, place))
        return 1;
    }
  return 0;
}

static int find_half(const locate_job *j, conic_fault_place *place) {
  static const char *const sides[][2] = {{"left", "right"}, {"top", "bottom"}};
  const int whole[2] = {j->image->width, j->image->height};
  for (int axis = 0; axis < 2; axis++)
    for (int side = 0; side < 2; side++) {
      region r = {.last = {whole[0] - 1, whole[1] - 1}, .n = 1};
      if (side)
        r.first[axis] = j->first[axis];
      else
        r.last[axis] = j->last[axis];
      *place = (conic_fault_place){.kind = "half", .what = sides[axis][side]};
      place->at[axis] = r.first[axis];
      place->size = r.last[axis] - r.first[axis] + 1;
      if (place->size < whole[axis] && is_fault_of_region(j, &r, place))
        return 1;
    }
  return 0;
}

static int find_every(const locate_job *j, conic_fault_place *place) {
  static const char *const words[] = {"column", "row", NULL};
  const int whole[2] = {j->image->width, j->image->height};
  for (int axis = 0; axis < 3; axis++)
    for (int n = axis == 2 ? 2 : 16; n >= 2; n--)
      for (int rest = 0; rest < n; rest++) {
        const region r = {.last = {whole[0] - 1, whole[1] - 1}, .axis = axis, .n = n, .rest = rest};
        if (axis < 2 && j->first[axis] % n != rest)
          continue;
        *place = (conic_fault_place){.kind = axis < 2 ? "every" : "checkerboard", .what = words[axis], .size = n};
        place->at[axis % 2] = rest;
        if (j->last[axis % 2] - j->first[axis % 2] >= 2 * n && is_fault_of_region(j, &r, place))
          return 1;
      }
  return 0;
}

/* Codes stand for values up to infinity, so that only NaN counts among them. */
static int has_no_number(const conic_image *image, int is_coded, size_t pixel) {
  for (int plane = 0; plane < CONIC_N_PLANES; plane++) {
    const conic_plane_description *about = conic_plane_describe((conic_plane)plane);
    const float *values = about->is_uint ? NULL : image->planes[plane];
    const size_t n = (size_t)about->n_channels;
    for (size_t c = 0; values && c < n; c++) {
      const float v = values[pixel * n + c];
      if (v != v || (!is_coded && v - v != 0.0f))
        return 1;
    }
  }
  return 0;
}

static int find_nan(const locate_job *j, int is_coded, conic_fault_place *place) {
  const size_t width = (size_t)j->image->width, n = width * (size_t)j->image->height;
  *place = (conic_fault_place){.kind = "nan"};
  for (size_t pixel = 0; pixel < n; pixel++) {
    if (j->classes[pixel] != CONIC_PIXEL_WRONG || !has_no_number(j->image, is_coded, pixel))
      continue;
    if (!place->pixels++) {
      place->at[0] = (int)(pixel % width);
      place->at[1] = (int)(pixel / width);
    }
  }
  return place->pixels > 0;
}

/* One plane alone, or one channel of rgba. */
static int find_plane(const locate_job *j, const uint32_t *faults, conic_fault_place *place) {
  static const char *const channels[] = {"R", "G", "B", "A"};
  const size_t n = (size_t)j->image->width * (size_t)j->image->height;
  uint32_t all = 0, planes;
  for (size_t pixel = 0; pixel < n; pixel++)
    all |= j->classes[pixel] == CONIC_PIXEL_WRONG ? faults[pixel] : 0u;
  planes = all & ((1u << CONIC_MAX_PLANES) - 1u);
  all >>= CONIC_MAX_PLANES;
  *place = (conic_fault_place){.kind = "plane", .pixels = j->n_wrong};
  if (planes != 1u << CONIC_PLANE_RGBA) {
    for (int plane = 0; plane < CONIC_N_PLANES; plane++)
      place->what = planes == 1u << plane ? conic_plane_describe((conic_plane)plane)->name : place->what;
    return place->what && conic_image_planes(j->image) != planes;
  }
  for (int c = 0; c < 4; c++)
    if (all == 1u << c) {
      place->kind = c == 3 ? "plane" : "channel";
      place->what = channels[c];
    }
  return place->what != NULL;
}

void conic_faults_locate(const conic_image *image, const conic_image *greatest, const uint8_t *classes,
                         const uint32_t *faults, conic_fault_place places[CONIC_MOST_FAULT_PLACES], int *n) {
  locate_job j = {.image = image, .classes = classes, .first = {image->width, image->height}, .last = {-1, -1}};
  *n = 0;
  for (int y = 0; y < image->height; y++)
    for (int x = 0; x < image->width; x++) {
      if (classes[(size_t)y * (size_t)image->width + (size_t)x] != CONIC_PIXEL_WRONG)
        continue;
      j.n_wrong++;
      j.first[0] = x < j.first[0] ? x : j.first[0];
      j.first[1] = y < j.first[1] ? y : j.first[1];
      j.last[0] = x > j.last[0] ? x : j.last[0];
      j.last[1] = y > j.last[1] ? y : j.last[1];
    }
  if (!j.n_wrong)
    return;
  *n += find_nan(&j, greatest != NULL, &places[*n]);
  if (faults)
    *n += find_plane(&j, faults, &places[*n]);
  *n += j.n_wrong >= 4 && (find_tile(&j, &places[*n]) || find_band(&j, &places[*n]) || find_half(&j, &places[*n]) ||
                           find_every(&j, &places[*n]));
}
