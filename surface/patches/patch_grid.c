/* A patch on a grid, by forward differences (PSS §6.2). */

#include "surface/loops/weight.h"
#include "surface/patches/patch.h"

#define TWO_PI 6.283185307179586

enum { N_DIFFERENCES = CONIC_SURFACE_MAX_DEGREE + 1, LONGEST_ROW = 64 };

/* A sample's weight at the rim, relative to the middle: small, but enough where the sample is alone. */
static const double LEAST_WEIGHT = 0x1p-10;

/* The columns of a row whose places, at odd multiples of 1/n, are in the unit disc: from *first to before *end. */
static void clip_row(int64_t n, int64_t row, int64_t *first, int64_t *end) {
  int64_t t = 2 * row + 1 - n, room = n * n - t * t;
  int64_t half = (int64_t)sqrt((double)room); /* the greatest |2 i + 1 - n|; its parity is not n's */
  while (half * half > room)
    half--;
  while ((half + 1) * (half + 1) <= room)
    half++;
  half -= (half ^ n ^ 1) & 1;
  *first = half < 0 ? 0 : (n - 1 - half) / 2;
  *end = half < 0 ? 0 : (n - 1 + half) / 2 + 1;
}

/* clip_row within the part. */
static void clip_part(const conic_grid_part *part, int64_t row, int64_t *first, int64_t *end) {
  int64_t begin = part->column, stop = begin + part->n_columns;
  clip_row(part->n, row, first, end);
  *first = *first > begin ? *first : begin;
  *end = *end < stop ? *end : stop;
  *end = *end > *first ? *end : *first;
}

/* What a fence keeps of a sample, whose axes are `sigma` in units of the disc: returns 0 for nothing, and lays the
 * lines that meet it, the nearest two, into the record. */
static int fence_sample(const conic_patch_fence *fence, double s, double t, double outline, double sigma,
                        conic_clip *clip) {
  double nearest[2] = {2.0, 2.0}; /* in outlines, which the prefilter widens */
  int n_missed = 0;
  clip->n_lines = 0;
  clip->operation = fence->is_either ? CONIC_CLIP_OR : CONIC_CLIP_AND;
  for (int i = 0; i < fence->n_lines; i++) {
    const float *line = fence->lines[i];
    double on = (double)line[3] * s + (double)line[4] * t, bend = (double)line[5] * on;
    double along = (double)line[0] - 2.0 * bend * (double)line[3];
    double across = (double)line[1] - 2.0 * bend * (double)line[4];
    double value = (double)line[0] * s + (double)line[1] * t + (double)line[2] - bend * on;
    double away = value / (outline * sqrt(along * along + across * across));
    n_missed += away < 0.0;
    if (!(away < nearest[1]))
      continue;
    int at = away < nearest[0] ? 0 : 1;
    memmove(clip->lines[1], clip->lines[0], at == 0 ? sizeof clip->lines[0] : 0);
    nearest[1] = at == 0 ? nearest[0] : away;
    nearest[at] = away;
    clip->lines[at][0] = (float)(sigma * along);
    clip->lines[at][1] = (float)(sigma * across);
    clip->lines[at][2] = (float)value;
    clip->n_lines = clip->n_lines < 2 ? (uint16_t)(clip->n_lines + 1) : 2;
  }
  clip->n_lines = fence->is_either && clip->n_lines < 2 ? 0 : clip->n_lines;
  return n_missed < (fence->is_either ? fence->n_lines : 1);
}

size_t conic_grid_count(const conic_grid_part *part, const conic_patch_fence *fence) {
  double step = 2.0 / (double)part->n;
  size_t count = 0;
  conic_clip clip;
  for (int64_t row = part->row; row < part->row + part->n_rows; row++) {
    int64_t first, end;
    clip_part(part, row, &first, &end);
    double t = (double)(2 * row + 1 - part->n) / (double)part->n;
    for (int64_t i = first; i < end && fence; i++)
      count += (size_t)fence_sample(fence, (double)(2 * i + 1 - part->n) / (double)part->n, t,
                                    CONIC_SAMPLE_OUTLINE * step, step, &clip);
    count += fence ? 0 : (size_t)(end - first);
  }
  return count;
}

/* A polynomial in one variable, as differences that carry it from place to place. */
typedef struct polynomial_walk {
  double differences[N_DIFFERENCES];
} polynomial_walk;

/* The differences of Σ a_i x^i at `from`, for steps of `step`. */
static polynomial_walk walk_from(const double a[N_DIFFERENCES], double from, double step) {
  double b[N_DIFFERENCES], scale = 1.0;
  polynomial_walk w;
  for (int i = 0; i < N_DIFFERENCES; i++)
    b[i] = a[i];
  for (int i = 0; i < N_DIFFERENCES - 1; i++) /* Horner's scheme, repeated: the polynomial about `from` */
    for (int k = N_DIFFERENCES - 2; k >= i; k--)
      b[k] += from * b[k + 1];
  for (int i = 1; i < N_DIFFERENCES; i++)
    b[i] *= scale *= step;
  w.differences[0] = b[0];
  w.differences[1] = (b[1] + b[2]) + (b[3] + b[4]);
  w.differences[2] = 2.0 * b[2] + (6.0 * b[3] + 14.0 * b[4]);
  w.differences[3] = 6.0 * b[3] + 36.0 * b[4];
  w.differences[4] = 24.0 * b[4];
  return w;
}

static inline double walk_on(polynomial_walk *w) {
  double here = w->differences[0];
  for (int i = 0; i < N_DIFFERENCES - 1; i++)
    w->differences[i] += w->differences[i + 1];
  return here;
}

/* A row of a patch: its height, and its slopes along and across, as polynomials in s. */
static void collapse(const conic_patch *patch, int degree, double t, double height[N_DIFFERENCES],
                     double along[N_DIFFERENCES], double across[N_DIFFERENCES]) {
  for (int i = 0; i < N_DIFFERENCES; i++)
    height[i] = along[i] = across[i] = 0.0;
  for (int i = 0; i <= degree; i++)
    for (int j = degree - i; j >= 0; j--) { /* Horner's scheme in t */
      double c = (double)patch->coefficients[(i + j) * (i + j + 1) / 2 + j];
      across[i] = j > 0 ? across[i] * t + (double)j * c : across[i];
      height[i] = height[i] * t + c;
    }
  for (int i = 1; i <= degree; i++)
    along[i - 1] = (double)i * height[i];
}

/* Maps one row from the unit disc to the world: places and tangent axes. */
static void place_row(const conic_patch *patch, double sigma, double peak, double t, const double *restrict s,
                      const double (*restrict g)[LONGEST_ROW], size_t n, size_t at, const conic_grid_samples *to) {
  for (int axis = 0; axis < 3; axis++) {
    double along = (double)patch->along[axis], across = (double)patch->across[axis];
    double normal = (double)patch->normal[axis], start = (double)patch->center[axis] + t * across;
    float *restrict position = to->position[axis] + at, *restrict u = to->tangent_u[axis] + at,
                    *restrict v = to->tangent_v[axis] + at;
    for (size_t i = 0; i < n; i++) {
      position[i] = (float)((start + s[i] * along) + g[0][i] * normal);
      u[i] = (float)(sigma * (along + g[1][i] * normal));
      v[i] = (float)(sigma * (across + g[2][i] * normal));
    }
  }
  float *restrict weight = to->weight + at;
  for (size_t i = 0; i < n; i++) {
    double inside = 1.0 - (s[i] * s[i] + t * t), w = inside * inside;
    weight[i] = (float)(peak * (w > LEAST_WEIGHT ? w : LEAST_WEIGHT));
  }
}

/* The peak with which the samples in the middle together weigh 1, as a splat does there: one over the sum of their
 * Gaussians. */
static double peak_of(double cutoff) {
  double outline2 = CONIC_SAMPLE_OUTLINE * CONIC_SAMPLE_OUTLINE, cutoff2 = cutoff * cutoff;
  return cutoff2 / (TWO_PI * outline2 * (1.0 - conic_weight_exp(0.5 * cutoff2)));
}

size_t conic_grid_sample(const conic_patch *patch, int degree, double cutoff, const conic_grid_part *part,
                         const conic_grid_samples *to) {
  double step = 2.0 / (double)part->n, sigma = CONIC_SAMPLE_OUTLINE * step / cutoff, peak = peak_of(cutoff);
  size_t at = 0;
  for (int64_t row = part->row; row < part->row + part->n_rows; row++) {
    double height[N_DIFFERENCES], along[N_DIFFERENCES], across[N_DIFFERENCES], s[LONGEST_ROW], g[3][LONGEST_ROW];
    int64_t first, end;
    clip_part(part, row, &first, &end);
    size_t n = (size_t)(end - first);
    double from = (double)(2 * first + 1 - part->n) / (double)part->n;
    double t = (double)(2 * row + 1 - part->n) / (double)part->n;
    collapse(patch, degree, t, height, along, across);
    polynomial_walk walks[3] = {walk_from(height, from, step), walk_from(along, from, step),
                                walk_from(across, from, step)};
    size_t n_kept = 0, n_clipped = 0;
    conic_clip clip;
    for (size_t i = 0; i < n; i++) {
      s[n_kept] = (double)(2 * (first + (int64_t)i) + 1 - part->n) / (double)part->n;
      for (int k = 0; k < 3; k++)
        g[k][n_kept] = walk_on(&walks[k]);
      n_kept += !patch->fence || fence_sample(patch->fence, s[n_kept], t, CONIC_SAMPLE_OUTLINE * step, sigma, &clip);
      if (patch->fence && n_kept > n_clipped)
        to->clips[at + n_clipped++] = clip;
    }
    place_row(patch, sigma, peak, t, s, (const double(*)[LONGEST_ROW])g, n_kept, at, to);
    at += n_kept;
  }
  return at;
}
