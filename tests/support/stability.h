/* What the stability tests share: sheets of discs, cameras anywhere, the comparison with the oracle over every method,
 * and the comparison of two pictures of one thing. Every case prints its figures, which docs/reference/accuracy.md
 * quotes. */
#pragma once

#include "tests/support/examine.h"

/* One of so many pixels is looked at, unless a test says otherwise. */
#ifndef STABILITY_ONE_OF
#define STABILITY_ONE_OF 3
#endif

static const double stability_pi = 3.14159265358979323846;

/* n × n discs over a rectangle, in two colours by squares. */
typedef struct stability_sheet {
  double center[3], along[3], across[3]; /* from the centre to the middles of two edges, at right angles */
  int n;
  double outline; /* radius in spacings; √½ just covers */
  int squares;    /* an edge; 0: all in the first colour */
  float colors[2][3];
} stability_sheet;

/* Writes the sheet's splats from number `first` on; returns the number after its last. */
static inline size_t stability_fill(fixture *f, size_t first, const stability_sheet *s) {
  for (int j = 0; j < s->n; j++)
    for (int i = 0; i < s->n; i++) {
      double a = (2.0 * i + 1.0) / s->n - 1.0, b = (2.0 * j + 1.0) / s->n - 1.0, p[3], tu[3], tv[3];
      double sigma = s->outline / 1.5 * 2.0 / s->n;
      for (int c = 0; c < 3; c++) {
        p[c] = s->center[c] + a * s->along[c] + b * s->across[c];
        tu[c] = sigma * s->along[c];
        tv[c] = sigma * s->across[c];
      }
      const float *color = s->colors[s->squares && (i * s->squares / s->n + j * s->squares / s->n) % 2];
      fixture_set(f, first++, p, tu, tv, color[0], color[1], color[2]);
    }
  return first;
}

/* A wall across the line of sight at depth z, two units wide. */
static inline stability_sheet stability_wall(double z, int n, float red, float green, float blue) {
  stability_sheet wall = {{0, 0, z}, {1, 0, 0}, {0, 1, 0}, n, 1.5, 0, {{red, green, blue}, {red, green, blue}}};
  return wall;
}

/* A floor `below` the eye from behind it to far ahead, rolled about the line of sight. */
static inline stability_sheet stability_floor(double below, double roll, double half_size, int n) {
  double c = cos(roll), s = sin(roll);
  stability_sheet floor = {
      {-s * below, c * below, 0.4 * half_size}, {c * half_size, s * half_size, 0}, {0, 0, -half_size}, n, 1.5, 8,
      {{0.9f, 0.8f, 0.6f}, {0.1f, 0.2f, 0.4f}}};
  return floor;
}

/* The eye at `eye`, looking along `forward` (any length, not along y), turned by `roll` about it. */
static inline void stability_look(fixture *f, const double eye[3], const double forward[3], double roll) {
  double z[3], x[3], y[3], length = sqrt(forward[0] * forward[0] + forward[1] * forward[1] + forward[2] * forward[2]);
  for (int c = 0; c < 3; c++)
    z[c] = forward[c] / length;
  double flat = hypot(z[0], z[2]);
  const double x0[3] = {z[2] / flat, 0, -z[0] / flat};
  const double y0[3] = {z[1] * x0[2] - z[2] * x0[1], z[2] * x0[0] - z[0] * x0[2], z[0] * x0[1] - z[1] * x0[0]};
  for (int c = 0; c < 3; c++) {
    x[c] = cos(roll) * x0[c] + sin(roll) * y0[c];
    y[c] = cos(roll) * y0[c] - sin(roll) * x0[c];
  }
  const double *rows[3] = {x, y, z};
  for (int r = 0; r < 3; r++) {
    f->camera.cam_from_world[r][3] = 0.0;
    for (int c = 0; c < 3; c++) {
      f->camera.cam_from_world[r][c] = rows[r][c];
      f->camera.cam_from_world[r][3] -= rows[r][c] * eye[c];
    }
  }
}

/* The judged pixels that one of the two covers alone and that no doubt about an outline excuses: there are none. */
static inline size_t stability_uncovered(const conic_reference *reference, const conic_image *image) {
  const unsigned excuses = 1u << CONIC_UNSTABLE_CUTOFF | 1u << CONIC_UNSTABLE_CLIP | 1u << CONIC_UNSTABLE_FORMULA;
  const uint32_t *ids = image->planes[CONIC_PLANE_ID];
  size_t n = 0;
  for (size_t i = 0; i < reference->n_pixels; i++) {
    size_t at = reference->pixels ? reference->pixels[i] : i;
    n += (ids[at] != CONIC_NO_ID) != (reference->planes[CONIC_PLANE_COUNT][i] > 0.0) &&
         !(reference->unstable[i] & excuses);
  }
  return n;
}

/* Whether the method draws splats as they lie in space: `point` and `disc` do not, and close no surface seen aslant. */
static inline int stability_fills(int method) {
  const char *name = conic_method_name((conic_method)method);
  return strcmp(name, "point") != 0 && strcmp(name, "disc") != 0;
}

/* The methods draw what the oracle says at some of the pixels, to its bounds, in every plane; at most so large a
 * share of the covered pixels may hang on roundings: of `point` and of the method `doubtful` any, since on a regular
 * grid many points lie on the borders of pixels. The image of the last method is left in the fixture. */
static inline void stability_agree_but(fixture *f, const char *name, double unstable_share, const char *doubtful) {
  for (int method = 0; method < CONIC_N_METHODS; method++) {
    f->options.method = (conic_method)method;
    outcome o = examine_some(f, STABILITY_ONE_OF);
    const conic_oracle_verdict verdict = o.verdict;
    double share = (double)verdict.unstable_pixels / fmax(1.0, (double)verdict.covered_pixels);
    printf("%-44s %-7s rgba %.1e  Z %.1e  unstable %.3f %% of %zu\n", name, conic_method_name((conic_method)method),
           verdict.planes[CONIC_PLANE_RGBA].max_abs, verdict.planes[CONIC_PLANE_Z].max_abs, 100.0 * share,
           verdict.covered_pixels);
    for (int i = 0; i < CONIC_N_DRAWN_PLANES; i++)
      if (!(verdict.planes[i].is_compared && verdict.planes[i].max_abs <= verdict.planes[i].bound)) {
        fprintf(stderr, "%s, %s: plane %s is off by %g\n", name, conic_method_name((conic_method)method),
                conic_plane_describe((conic_plane)i)->name, verdict.planes[i].max_abs);
        check_failures++;
      }
    CHECK(!stability_fills(method) || stability_uncovered(&o.reference, &f->image) == 0);
    const char *method_name = conic_method_name((conic_method)method);
    if (!(share <= unstable_share) && strcmp(method_name, "point") != 0 && strcmp(method_name, doubtful) != 0) {
      fprintf(stderr, "%s, %s: %.3g of the pixels are unstable\n", name, conic_method_name((conic_method)method),
              share);
      check_failures++;
    }
    conic_reference_release(f->context, &o.reference);
  }
}

static inline void stability_agree(fixture *f, const char *name, double unstable_share) {
  stability_agree_but(f, name, unstable_share, "");
}

static inline int stability_covers(const conic_image *image, int x, int y) {
  return ((const uint32_t *)image->planes[CONIC_PLANE_ID])[(size_t)y * (size_t)image->width + (size_t)x] != CONIC_NO_ID;
}

static inline size_t stability_covered(const fixture *f) {
  return (size_t)f->statistics.pixels_covered;
}

/* Draws, and hands the image over: the caller releases it. */
static inline conic_image stability_draw(fixture *f) {
  fixture_render(f);
  conic_image image = f->image;
  memset(&f->image, 0, sizeof f->image);
  return image;
}

/* How two pictures of one size differ. */
typedef struct stability_difference {
  double color, depth;           /* the largest, where both are covered; of Z relative */
  double color_p999, depth_p999; /* what all but a thousandth of those pixels keep to */
  size_t both, coverage;         /* pixels covered in both, and in one alone */
} stability_difference;

static inline int stability_ascending(const void *a, const void *b) {
  const double *first = a, *second = b;
  return (*first > *second) - (*first < *second);
}

static inline stability_difference stability_compare(const conic_image *a, const conic_image *b) {
  stability_difference d = {0};
  size_t n = (size_t)a->width * (size_t)a->height;
  const float *ca = a->planes[CONIC_PLANE_RGBA], *cb = b->planes[CONIC_PLANE_RGBA];
  const float *za = a->planes[CONIC_PLANE_Z], *zb = b->planes[CONIC_PLANE_Z];
  double *colors = malloc(n * sizeof *colors), *depths = malloc(n * sizeof *depths);
  if (!colors || !depths)
    exit(1);
  for (size_t i = 0; i < n; i++) {
    int in_a = za[i] > 0.0f, in_b = zb[i] > 0.0f;
    d.coverage += in_a != in_b;
    if (!in_a || !in_b)
      continue;
    double color = 0.0;
    for (size_t c = 0; c < 3; c++)
      color = fmax(color, fabs((double)ca[4 * i + c] - (double)cb[4 * i + c]));
    colors[d.both] = color;
    depths[d.both++] = fabs((double)za[i] / (double)zb[i] - 1.0);
  }
  qsort(colors, d.both, sizeof *colors, stability_ascending);
  qsort(depths, d.both, sizeof *depths, stability_ascending);
  if (d.both) {
    size_t i_p999 = (d.both - 1) - d.both / 1000;
    d.color = colors[d.both - 1];
    d.depth = depths[d.both - 1];
    d.color_p999 = colors[i_p999];
    d.depth_p999 = depths[i_p999];
  }
  free(colors);
  free(depths);
  return d;
}

static inline void stability_print(const char *name, const fixture *f, const stability_difference *d) {
  printf("%-44s %-7s colour %.1e (p99.9 %.1e)  Z %.1e (%.1e)  coverage %zu of %zu\n", name,
         conic_method_name(f->options.method), d->color, d->color_p999, d->depth, d->depth_p999, d->coverage, d->both);
}
