/* How much a picture changes where a merged Gaussian is drawn in place of its parts: measured from some directions. */

#include "core/base/vectors.h"
#include "core/splats/kernel.h"
#include "gaussians/scene/harmonics.h"
#include "lod/blends/blend.h"

/* Directions of sight, from all octants and along the axes; places a side of the square that is looked at, which is so
 * many deviations wide; and what is added to what is found, as between directions and places there may be more. */
enum { DIRECTIONS = 7, SIDE = 9 };
static const double half_width = 3.3, step = 6.6 / SIDE, safety = 1.25;

/* What is behind is not known: how much the square of a change counts over black, over the whole's own colour, and
 * where the opacity alone is looked at. */
static const float over_black = 0.2f, over_own = 1.0f, of_opacity = 0.05f;

/* A Gaussian on the screen: e^-(xx·x² + 2·xy·x·y + yy·y²)/2 about its mean. */
typedef struct trace {
  double x, y, depth;
  float xx, xy, yy, opacity, color[3];
} trace;

typedef struct screen {
  double right[3], down[3], sight[3], harmonics[(CONIC_MAX_SH_DEGREE + 1) * (CONIC_MAX_SH_DEGREE + 1)];
  int degree;
} screen;

static screen screen_of(int i, int degree) {
  static const double sights[DIRECTIONS][3] = {{1, 0, 0},  {0, -1, 0},  {0, 0, 1},  {1, 1, 1},
                                               {-1, 1, 1}, {1, -1, -1}, {-1, -1, 1}};
  screen s = {.degree = degree, .down = {0.0, 0.0, 0.0}};
  memcpy(s.sight, sights[i], sizeof s.sight);
  conic_normalize(s.sight);
  s.down[i == 1 ? 2 : 1] = 1.0;
  conic_cross(s.down, s.sight, s.right);
  conic_normalize(s.right);
  conic_cross(s.sight, s.right, s.down);
  conic_harmonics_evaluate(s.sight, degree, s.harmonics);
  return s;
}

static trace trace_of(const screen *s, const conic_blend *b, const double from[3], double *root) {
  trace t = {.opacity = b->is_drawn ? b->row[CONIC_BLEND_OPACITY] : 0.0f};
  double d[3], xx = conic_quadratic_form(b->covariance, s->right, s->right),
               xy = conic_quadratic_form(b->covariance, s->right, s->down),
               yy = conic_quadratic_form(b->covariance, s->down, s->down), det;
  conic_subtract(b->mean, from, d);
  t.x = conic_dot(d, s->right);
  t.y = conic_dot(d, s->down);
  t.depth = conic_dot(d, s->sight);
  /* what is flat seen from its edge has no area, and keeps a thousandth of its width */
  const double thin = 1e-6 * (xx + yy) + 1e-30;
  xx += thin;
  yy += thin;
  det = fmax(xx * yy - xy * xy, thin * thin);
  *root = sqrt(det);
  t.xx = (float)(yy / det);
  t.xy = (float)(-xy / det);
  t.yy = (float)(xx / det);
  for (int c = 0; c < 3; c++) {
    double sum = 0.5;
    for (int k = 0; k < (s->degree + 1) * (s->degree + 1); k++)
      sum += s->harmonics[k] * (double)b->row[CONIC_BLEND_HARMONICS + 3 * k + c];
    t.color[c] = b->is_drawn ? (float)fmax(sum, 0.0) : 0.0f;
  }
  return t;
}

/* Places on the screen, and what is seen there: light, and what is left of it. A multiple of the lanes of vectors. */
enum { MOST_PLACES = (SIDE * SIDE + 7) / 8 * 8 };

typedef struct seen_places {
  float x[MOST_PLACES], y[MOST_PLACES], left[MOST_PLACES], sum[3][MOST_PLACES];
} seen_places;

/* Lays one before what is behind those that came before it. */
static void lay_down(const trace *t, seen_places *at) {
  const float x0 = (float)t->x, y0 = (float)t->y;
  for (size_t i = 0; i < MOST_PLACES; i++) {
    const float x = at->x[i] - x0, y = at->y[i] - y0;
    const float q = t->xx * x * x + 2.0f * t->xy * x * y + t->yy * y * y;
    float alpha = t->opacity * conic_exp_negative(-0.5f * q);
    alpha = alpha < 0.99f ? alpha : 0.99f;
    const float weight = at->left[i] * alpha;
    for (int c = 0; c < 3; c++)
      at->sum[c][i] += weight * t->color[c];
    at->left[i] -= weight;
  }
}

static void order_by_depth(trace *parts, size_t n) {
  for (size_t i = 1; i < n; i++)
    for (size_t k = i; k > 0 && parts[k].depth < parts[k - 1].depth; k--) {
      const trace kept = parts[k];
      parts[k] = parts[k - 1];
      parts[k - 1] = kept;
    }
}

/* A square of the whole's own axes: L of Σ = L·Lᵀ turns the unit square into them. */
static void lay_out(const trace *whole, double root, seen_places *at) {
  const double xx = (double)whole->yy * root * root, xy = -(double)whole->xy * root * root;
  const double l_xx = sqrt(xx), l_yx = xy / l_xx, l_yy = root / l_xx;
  memset(at, 0, sizeof *at);
  for (int row = 0; row < SIDE; row++)
    for (int column = 0; column < SIDE; column++) {
      const double u = (column + 0.5) * step - half_width, v = (row + 0.5) * step - half_width;
      at->x[row * SIDE + column] = (float)(l_xx * u);
      at->y[row * SIDE + column] = (float)(l_yx * u + l_yy * v);
    }
  for (size_t i = 0; i < MOST_PLACES; i++)
    at->left[i] = 1.0f;
}

/* Looks from one direction, and raises what was found from others. */
static void look_from(const screen *s, const conic_blend *parts, size_t n, conic_blend *whole) {
  trace traces[CONIC_BLEND_MOST_PARTS];
  seen_places at, alone;
  double root, unused, sum = 0.0;
  const trace own = trace_of(s, whole, whole->mean, &root);
  for (size_t i = 0; i < n; i++)
    traces[i] = trace_of(s, &parts[i], whole->mean, &unused);
  order_by_depth(traces, n);
  lay_out(&own, root, &at);
  alone = at;
  lay_down(&own, &alone);
  for (size_t i = 0; i < n; i++)
    lay_down(&traces[i], &at);
  for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
    const float left = at.left[i] - alone.left[i];
    float change = of_opacity * left * left;
    for (int c = 0; c < 3; c++) {
      const float light = at.sum[c][i] - alone.sum[c][i], over = light + left * own.color[c];
      change += over_black * light * light + over_own * over * over;
    }
    sum += (double)change;
  }
  whole->parts.light = fmaxf(whole->parts.light, (float)(sum * step * step * root));
}

/* A float that is no less and has few bits. */
static float rounded_up(double value) {
  const uint32_t bits = conic_bits_of_float((float)value);
  return value > 0.0 ? conic_float_of_bits((bits + 0x1fff) & ~(uint32_t)0xfff) : 0.0f;
}

void conic_blend_find_parts(const conic_blend *parts, size_t n, int sh_degree, conic_blend *whole) {
  double light = 0.0, depth = 0.0, edge = 0.0, tint[3] = {0.0, 0.0, 0.0}, reach = (double)whole->parts.reach;
  for (size_t i = 0; i < n; i++) {
    const conic_blend_parts *p = &parts[i].parts;
    double d[3];
    conic_subtract(parts[i].mean, whole->mean, d);
    light += (double)p->light;
    depth += (double)p->depth;
    edge += (double)p->edge;
    for (int c = 0; c < 3; c++)
      tint[c] += (double)(p->depth * p->tint[c]);
    reach = fmax(reach, conic_length(d) + (double)p->reach);
  }
  whole->parts = (conic_blend_parts){.depth = rounded_up(depth), .edge = rounded_up(edge), .reach = rounded_up(reach)};
  for (int c = 0; c < 3; c++)
    whole->parts.tint[c] = depth > 0.0 ? conic_blend_rounded(tint[c] / depth) : 0.0f;
  if (n > 1 && whole->is_drawn)
    for (int i = 0; i < DIRECTIONS; i++) {
      const screen s = screen_of(i, sh_degree);
      look_from(&s, parts, n, whole);
    }
  whole->parts.light = rounded_up(safety * (double)whole->parts.light + light);
}
