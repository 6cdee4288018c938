#include "gaussians/formats/codebook.h"

/* The vectors order[first] … Their squared distances from their mean add up to `squares`. */
typedef struct palette_group {
  size_t first, count;
  int widest;
  double squares, middle; /* the mean along the widest */
} palette_group;

typedef struct palette {
  const conic_gaussians *gaussians;
  size_t n_numbers;
  uint32_t *order;
  palette_group *groups; /* a heap: none has more squares than the one at half its place */
  size_t n_groups;
} palette;

/* Numbers that are not finite count as 0. */
static double number_of(const float *harmonics, size_t k) {
  float value = harmonics[3 + k];
  return value - value == 0.0f ? (double)value : 0.0;
}

static void measure_group(const palette *self, palette_group *group) {
  double sums[CONIC_MOST_HARMONICS] = {0}, squares[CONIC_MOST_HARMONICS] = {0}, n = (double)group->count, widest = -1.0;
  float room[CONIC_MOST_HARMONICS];
  for (size_t i = 0; i < group->count; i++) {
    const float *sh = conic_gaussians_harmonics(self->gaussians, self->order[group->first + i], room);
    for (size_t k = 0; k < self->n_numbers; k++) {
      double value = number_of(sh, k);
      sums[k] += value;
      squares[k] += value * value;
    }
  }
  group->squares = 0.0;
  for (size_t k = 0; k < self->n_numbers; k++) {
    double off = squares[k] - sums[k] * sums[k] / n;
    off = off > 1e-14 * squares[k] ? off : 0.0; /* the rest is rounding */
    group->squares += off;
    if (off > widest) {
      widest = off;
      group->widest = (int)k;
      group->middle = sums[k] / n;
    }
  }
}

static void sift_entry(palette *self, size_t at) {
  for (;;) {
    size_t child = 2 * at + 1;
    if (child + 1 < self->n_groups && self->groups[child + 1].squares > self->groups[child].squares)
      child++;
    if (child >= self->n_groups || self->groups[child].squares <= self->groups[at].squares)
      return;
    palette_group moved = self->groups[at];
    self->groups[at] = self->groups[child];
    self->groups[child] = moved;
    at = child;
  }
}

static void add_group(palette *self, palette_group group) {
  size_t at = self->n_groups++;
  for (; at > 0 && self->groups[(at - 1) / 2].squares < group.squares; at = (at - 1) / 2)
    self->groups[at] = self->groups[(at - 1) / 2];
  self->groups[at] = group;
}

/* Splits the group of the most squares; 0 where there is nothing to split. */
static int split_group(palette *self) {
  palette_group low = self->groups[0], high = low;
  float room[CONIC_MOST_HARMONICS];
  size_t left = low.first, right = low.first + low.count;
  if (!(low.squares > 0.0))
    return 0;
  while (left < right) {
    const float *sh = conic_gaussians_harmonics(self->gaussians, self->order[left], room);
    if (number_of(sh, (size_t)low.widest) <= low.middle) {
      left++;
      continue;
    }
    uint32_t moved = self->order[--right];
    self->order[right] = self->order[left];
    self->order[left] = moved;
  }
  high.first = left;
  high.count = low.first + low.count - left;
  low.count = left - low.first;
  if (low.count == 0 || high.count == 0) {
    self->groups[0].squares = 0.0;
    sift_entry(self, 0);
    return 1;
  }
  measure_group(self, &low);
  measure_group(self, &high);
  self->groups[0] = low;
  sift_entry(self, 0);
  add_group(self, high);
  return 1;
}

static void find_centroids(const palette *self, uint32_t *labels, float *centroids) {
  float room[CONIC_MOST_HARMONICS];
  for (size_t g = 0; g < self->n_groups; g++) {
    const palette_group *group = &self->groups[g];
    double sums[CONIC_MOST_HARMONICS] = {0};
    for (size_t i = 0; i < group->count; i++) {
      size_t vector = self->order[group->first + i];
      const float *sh = conic_gaussians_harmonics(self->gaussians, vector, room);
      labels[vector] = (uint32_t)g;
      for (size_t k = 0; k < self->n_numbers; k++)
        sums[k] += number_of(sh, k);
    }
    for (size_t k = 0; k < self->n_numbers; k++)
      centroids[g * self->n_numbers + k] = (float)(sums[k] / (double)group->count);
  }
}

static conic_status make_palette(conic_context *context, palette *self, uint32_t *labels, float **centroids) {
  palette_group all = {.count = self->gaussians->count};
  for (size_t i = 0; i < all.count; i++)
    self->order[i] = (uint32_t)i;
  measure_group(self, &all);
  add_group(self, all);
  while (self->n_groups < CONIC_MOST_CENTROIDS && split_group(self))
    if (self->n_groups % 256 == 0) {
      conic_status status = conic_progress(context, "palette", (double)self->n_groups / CONIC_MOST_CENTROIDS);
      if (status != CONIC_OK)
        return status;
    }
  *centroids = conic_memory_allocate(context, self->n_groups * self->n_numbers, sizeof **centroids);
  if (!*centroids)
    return CONIC_ERROR_MEMORY;
  find_centroids(self, labels, *centroids);
  return CONIC_OK;
}

conic_status conic_palette_make(conic_context *context, const conic_gaussians *gaussians, size_t n_numbers,
                                uint32_t *labels, float **centroids, size_t *n_centroids) {
  palette self = {.gaussians = gaussians, .n_numbers = n_numbers};
  *centroids = NULL;
  self.order = conic_memory_allocate(context, gaussians->count, sizeof *self.order);
  self.groups = conic_memory_allocate(context, CONIC_MOST_CENTROIDS, sizeof *self.groups);
  conic_status status =
      self.order && self.groups ? make_palette(context, &self, labels, centroids) : CONIC_ERROR_MEMORY;
  *n_centroids = self.n_groups;
  conic_memory_release_these(context, self.order, self.groups);
  return status;
}
