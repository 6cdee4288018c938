/* The largest weight error of the methods' bare formulas (no hand-overs) within the footprint, against the exactly
 * projected kernel, numerically convolved with the pixel's Gaussian of 1 px². All in double, apart from the renderer:
 * this is about the methods, not about their implementation. The figures are those of docs/reference/accuracy.md. */
#include "raster/tiles/coverage.h"
#include "tests/support/fixture.h"

static const double pi = 3.14159265358979324, prefilter = 1.0;

/* A splat at distance 1 from the eye, 25° off the axis, its normal leaning away from the view ray by `tilt`. */
typedef struct setting {
  double focal_px, cutoff;
  double p[3], tu[3], tv[3];
} setting;

typedef struct variance {
  double x, y; /* centre, px from the principal point */
  double xx, xy, yy;
  double root; /* √|R'| */
} variance;

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; i++)
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void scale_to(double v[3], double length) {
  double norm = sqrt(dot(v, v));
  for (int i = 0; i < 3; i++)
    v[i] *= length / norm;
}

static setting make_setting(double focal_px, double size, double tilt, double cutoff) {
  setting s = {.focal_px = focal_px, .cutoff = cutoff, .p = {sin(pi * 25.0 / 180.0), 0.0, cos(pi * 25.0 / 180.0)}};
  const double up[3] = {0, 1, 0}, helper[3] = {0.3, 1.0, 0.2};
  double a[3], b[3], n[3];
  cross(up, s.p, a);
  scale_to(a, 1.0);
  cross(s.p, a, b);
  for (int i = 0; i < 3; i++)
    n[i] = cos(tilt) * s.p[i] + sin(tilt) * (a[i] * cos(0.6) + b[i] * sin(0.6));
  cross(n, helper, s.tu);
  scale_to(s.tu, size);
  cross(n, s.tu, s.tv);
  return s;
}

static double normal_times(const setting *s, const double d[3]) {
  double n[3];
  cross(s->tu, s->tv, n);
  return dot(n, d);
}

/* Heckbert's affine mapping: exact at the centre. */
static variance affine_variance(const setting *s) {
  const double *p = s->p, *t[2] = {s->tu, s->tv};
  variance v = {s->focal_px * p[0] / p[2], s->focal_px * p[1] / p[2], 0, 0, 0, 0};
  for (int k = 0; k < 2; k++) {
    double jx = s->focal_px * (t[k][0] - p[0] / p[2] * t[k][2]) / p[2];
    double jy = s->focal_px * (t[k][1] - p[1] / p[2] * t[k][2]) / p[2];
    v.xx += jx * jx;
    v.xy += jx * jy;
    v.yy += jy * jy;
  }
  v.root = s->focal_px * s->focal_px * fabs(normal_times(s, p)) / (p[2] * p[2] * p[2]);
  return v;
}

/* PAS: exact on the outline. From the dual conic D = Σ t tᵀ - p pᵀ/F². */
static variance conic_variance(const setting *s) {
  double dual[3][3], f = s->focal_px, squared = s->cutoff * s->cutoff;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      dual[i][j] = s->tu[i] * s->tu[j] + s->tv[i] * s->tv[j] - s->p[i] * s->p[j] / squared;
  double x = dual[0][2] / dual[2][2], y = dual[1][2] / dual[2][2];
  variance v = {f * x, f * y, 0, 0, 0, 0};
  v.xx = f * f * (x * x - dual[0][0] / dual[2][2]) / squared;
  v.xy = f * f * (x * y - dual[0][1] / dual[2][2]) / squared;
  v.yy = f * f * (y * y - dual[1][1] / dual[2][2]) / squared;
  double hz_squared = s->tu[2] * s->tu[2] + s->tv[2] * s->tv[2];
  v.root = f * f * fabs(normal_times(s, s->p)) / pow(s->p[2] * s->p[2] - squared * hz_squared, 1.5);
  return v;
}

static double ewa_weight(const variance *r, double x, double y) {
  double xx = r->xx + prefilter, yy = r->yy + prefilter, det = xx * yy - r->xy * r->xy, dx = x - r->x, dy = y - r->y;
  double q = (yy * dx * dx - 2.0 * r->xy * dx * dy + xx * dy * dy) / det;
  return r->root / sqrt(det) * exp(-0.5 * q);
}

/* u = x·M⁻¹, dehomogenised; 0 where the plane is behind the eye. */
static int parameter_at(const setting *s, double x, double y, double u[2]) {
  double d[3] = {x / s->focal_px, y / s->focal_px, 1.0}, m_u[3], m_v[3];
  cross(s->tv, s->p, m_u);
  cross(s->p, s->tu, m_v);
  double w = normal_times(s, d);
  u[0] = dot(d, m_u) / w;
  u[1] = dot(d, m_v) / w;
  return w / normal_times(s, s->p) > 0.0;
}

static double ray_weight(const setting *s, double x, double y) {
  double u[2], right[2], left[2], down[2], up[2], j[2][2], step = 1e-4;
  if (!parameter_at(s, x, y, u))
    return 0.0;
  parameter_at(s, x + step, y, right);
  parameter_at(s, x - step, y, left);
  parameter_at(s, x, y + step, down);
  parameter_at(s, x, y - step, up);
  for (int i = 0; i < 2; i++) {
    j[i][0] = (right[i] - left[i]) / (2.0 * step);
    j[i][1] = (down[i] - up[i]) / (2.0 * step);
  }
  double uu = 1.0 + prefilter * (j[0][0] * j[0][0] + j[0][1] * j[0][1]);
  double vv = 1.0 + prefilter * (j[1][0] * j[1][0] + j[1][1] * j[1][1]);
  double uv = prefilter * (j[0][0] * j[1][0] + j[0][1] * j[1][1]), det = uu * vv - uv * uv;
  double q = (vv * u[0] * u[0] - 2.0 * uv * u[0] * u[1] + uu * u[1] * u[1]) / det;
  return exp(-0.5 * q) / sqrt(det);
}

/* Minus the logarithm of what exact_weight integrates, but for a constant. */
static double integrand_depth(const setting *s, const double pixel[2], double x, double y) {
  double u[2], dx = x - pixel[0], dy = y - pixel[1];
  parameter_at(s, x, y, u);
  return 0.5 * (u[0] * u[0] + u[1] * u[1]) + 0.5 * (dx * dx + dy * dy) / prefilter;
}

/* The formula of auto: u linearised about the place that the affine mapping gives for the integrand's peak, and the
 * integrand's curvature there, by differences. Nowhere near the limits that the formula has for the worst of cases. */
static double laplace_weight(const setting *s, const variance *affine, double x, double y) {
  double xx = affine->xx + prefilter, yy = affine->yy + prefilter, det = xx * yy - affine->xy * affine->xy;
  double dx = x - affine->x, dy = y - affine->y, u[2], right[2], down[2], left[2], up[2], step = 1e-3;
  const double pixel[2] = {x, y};
  double px = prefilter * (yy * dx - affine->xy * dy) / det, py = prefilter * (xx * dy - affine->xy * dx) / det;
  double ax = x - px, ay = y - py;
  if (!parameter_at(s, ax, ay, u))
    return 0.0;
  parameter_at(s, ax + step, ay, right);
  parameter_at(s, ax - step, ay, left);
  parameter_at(s, ax, ay + step, down);
  parameter_at(s, ax, ay - step, up);
  double uu = 1.0, vv = 1.0, uv = 0.0;
  for (int i = 0; i < 2; i++) {
    double by_x = (right[i] - left[i]) / (2.0 * step), by_y = (down[i] - up[i]) / (2.0 * step);
    double other_x = (right[1 - i] - left[1 - i]) / (2.0 * step), other_y = (down[1 - i] - up[1 - i]) / (2.0 * step);
    *(i ? &vv : &uu) += prefilter * (by_x * by_x + by_y * by_y);
    uv = prefilter * (by_x * other_x + by_y * other_y);
    u[i] += by_x * px + by_y * py;
  }
  double q = (vv * u[0] * u[0] - 2.0 * uv * u[0] * u[1] + uu * u[1] * u[1]) / (uu * vv - uv * uv), c[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      c[i][j] = integrand_depth(s, pixel, ax + step * (i - 1), ay + step * (j - 1));
  double h_xx = (c[2][1] - 2.0 * c[1][1] + c[0][1]) / (step * step);
  double h_yy = (c[1][2] - 2.0 * c[1][1] + c[1][0]) / (step * step);
  double h_xy = (c[2][2] - c[2][0] - c[0][2] + c[0][0]) / (4.0 * step * step);
  return exp(-0.5 * q) / (prefilter * sqrt(h_xx * h_yy - h_xy * h_xy));
}

/* The untruncated kernel under the pixel's Gaussian. The grid lies along the projected axes; the trapezoid rule on a
 * product of Gaussians is exact to e^(-2π²(σ/step)²), here with steps of `fineness` standard deviations of the product:
 * to 1e-7 with 1.1. What lies farther from the pixel than 6 of its deviations is less. */
static double exact_weight(const setting *s, const variance *r, double x, double y, double fineness) {
  double half = 0.5 * atan2(2.0 * r->xy, r->xx - r->yy), c = cos(half), sn = sin(half);
  double major = c * c * r->xx + 2.0 * c * sn * r->xy + sn * sn * r->yy;
  double minor = r->xx + r->yy - major, sum = 0.0;
  double step_a = fineness * sqrt(major * prefilter / (major + prefilter));
  double step_b = fineness * sqrt(minor * prefilter / (minor + prefilter));
  double reach = 6.0 * sqrt(prefilter);
  int n_a = (int)(reach / step_a);
  for (int i = -n_a; i <= n_a; i++) {
    double a = i * step_a, u[2];
    int n_b = (int)(sqrt(fmax(0.0, reach * reach - a * a)) / step_b);
    for (int k = -n_b; k <= n_b; k++) {
      double b = k * step_b;
      if (parameter_at(s, x + c * a - sn * b, y + sn * a + c * b, u))
        sum += exp(-0.5 * (u[0] * u[0] + u[1] * u[1]) - 0.5 * (a * a + b * b) / prefilter);
    }
  }
  return sum * step_a * step_b / (2.0 * pi * prefilter);
}

/* The bound of conic's error: how far its centre is from the projected p, in standard deviations, times the amplitude.
 */
static double conic_bound(const setting *s) {
  variance affine = affine_variance(s), conic = conic_variance(s);
  double xx = conic.xx + prefilter, yy = conic.yy + prefilter, det = xx * yy - conic.xy * conic.xy;
  double dx = conic.x - affine.x, dy = conic.y - affine.y;
  double q = (yy * dx * dx - 2.0 * conic.xy * dx * dy + xx * dy * dy) / det;
  return 0.68 * conic.root / sqrt(det) * sqrt(q);
}

static double smaller_variance(const setting *s) {
  variance r = conic_variance(s);
  double sum = r.xx + r.yy, difference = r.xx - r.yy;
  return 2.0 * r.root * r.root / (sum + sqrt(difference * difference + 4.0 * r.xy * r.xy));
}

static const double thin_variance = 1.0 / 64.0;

static int takes_ray(const setting *s) {
  return smaller_variance(s) >= thin_variance && conic_bound(s) > 4e-3;
}

/* The relative change of inverse depth over a pixel, at p. */
static double change(const setting *s) {
  double n[3];
  cross(s->tu, s->tv, n);
  return hypot(n[0], n[1]) / s->focal_px * s->p[2] / fabs(dot(n, s->p)) * sqrt(prefilter);
}

/* What auto draws by where it is not conic. */
static double other_weight(const setting *s, const variance *affine, double x, double y) {
  return change(s) > 1e-2 ? laplace_weight(s, affine, x, y) : ray_weight(s, x, y);
}

static double chosen_weight(const setting *s, const variance *affine, const variance *conic, double x, double y) {
  return takes_ray(s) ? other_weight(s, affine, x, y) : ewa_weight(conic, x, y);
}

typedef struct errors {
  double affine, conic, ray, chosen;
  int n_compared;
} errors;

static errors worst_errors(double focal_px, double size, double tilt_deg, double cutoff) {
  setting s = make_setting(focal_px, size, pi * tilt_deg / 180.0, cutoff);
  variance affine = affine_variance(&s), conic = conic_variance(&s);
  errors worst = {0, 0, 0, 0, 0};
  double half_x = cutoff * sqrt(conic.xx + prefilter), half_y = cutoff * sqrt(conic.yy + prefilter);
  for (int j = 0; j <= 40; j++)
    for (int i = 0; i <= 40; i++) {
      double x = conic.x + half_x * (i - 20) / 20.0, y = conic.y + half_y * (j - 20) / 20.0;
      double exact = exact_weight(&s, &affine, x, y, 1.1);
      if (exact <= 0.3 * exp(-0.5 * cutoff * cutoff))
        continue;
      worst.n_compared++;
      worst.affine = fmax(worst.affine, fabs(ewa_weight(&affine, x, y) - exact));
      worst.conic = fmax(worst.conic, fabs(ewa_weight(&conic, x, y) - exact));
      worst.ray = fmax(worst.ray, fabs(ray_weight(&s, x, y) - exact));
      worst.chosen = fmax(worst.chosen, fabs(chosen_weight(&s, &affine, &conic, x, y) - exact));
      if (i % 10 == 5 && j % 10 == 5)
        CHECK_NEAR(exact, exact_weight(&s, &affine, x, y, 0.45), 1e-6);
    }
  return worst;
}

typedef struct known {
  double size, tilt_deg, cutoff, affine, conic, ray;
} known;

static const known table[] = {
    {0.003, 60, 1.5, 1.9e-3, 5.1e-4, 5.7e-4}, {0.003, 85, 1.5, 1.6e-4, 4e-5, 2.4e-3},
    {0.01, 60, 1.5, 1.1e-2, 7.9e-3, 5.2e-4},  {0.01, 60, 3.0, 1.1e-2, 4.6e-2, 5.2e-4},
    {0.03, 60, 1.5, 3.7e-2, 3.1e-2, 2.6e-4},  {0.03, 60, 3.0, 3.7e-2, 1.6e-1, 2.6e-4},
    {0.1, 60, 1.5, 1.3e-1, 1.1e-1, 1.0e-4},   {0.1, 60, 3.0, 1.3e-1, 5.1e-1, 1.0e-4},
    {0.1, 85, 1.5, 1.2e-1, 9.3e-2, 2.8e-3},
};

/* Two figures, as the table has them. */
static void check_figure(double measured, double expected) {
  CHECK_NEAR(measured, expected, 0.05 * expected + 0.5e-6);
}

static void test_table(void) {
  printf("%6s %5s %4s %10s %10s %10s\n", "size", "tilt", "F_g", "affine", "conic", "ray");
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    const known *k = &table[i];
    errors found = worst_errors(500.0, k->size, k->tilt_deg, k->cutoff);
    printf("%6g %5g %4g %10.2e %10.2e %10.2e\n", k->size, k->tilt_deg, k->cutoff, found.affine, found.conic, found.ray);
    check_figure(found.affine, k->affine);
    check_figure(found.conic, k->conic);
    check_figure(found.ray, k->ray);
  }
}

/* What check_fragments found. */
static double worst_fragment;
static int n_fragments;

/* --- auto, along the ellipse's axes --- */

/* The renderer's own weights are those of the formula here. */
static void check_fragments(const conic_view *view, const conic_projected *projected, const setting *s) {
  const conic_box *box = &projected->boxes[0];
  const conic_footprint *footprint = &projected->footprints[0];
  variance affine = affine_variance(s);
  int step_x = 1 + (box->x_end - box->x_begin) / 24, step_y = 1 + (box->y_end - box->y_begin) / 24;
  for (int y = box->y_begin; y < box->y_end; y += step_y)
    for (int x = box->x_begin; x < box->x_end; x += step_x) {
      conic_fragment fragment;
      if (!conic_fragment_at(view, projected, footprint, x, y, &fragment))
        continue;
      double weight = (double)conic_final_weight(view, footprint, fragment.q, fragment.scale);
      double expected = other_weight(s, &affine, x + 0.5 - view->cx, y + 0.5 - view->cy);
      worst_fragment = fmax(worst_fragment, fabs(weight - expected));
      n_fragments++;
    }
}

/* What the renderer's set-up takes, which is the same but on the border itself. */
static void check_choice(fixture *f, const setting *s) {
  conic_view view;
  conic_chunk chunk;
  conic_footprint footprint;
  conic_box box;
  conic_projected_surface surface;
  conic_ray ray;
  conic_projected projected = {1, 1, &chunk, &footprint, &box, &surface, &ray, NULL};
  double thinness = smaller_variance(s) / thin_variance - 1.0, error = conic_bound(s) / 4e-3 - 1.0;
  if (fabs(thinness) < 1e-3 || fabs(error) < 1e-3 || fabs(100.0 * change(s) - 1.0) < 1e-3)
    return;
  fixture_camera(f, 4000, 4000, s->focal_px);
  fixture_set(f, 0, s->p, s->tu, s->tv, 1, 1, 1);
  f->options.method = CONIC_METHOD_AUTO;
  f->options.kernel.cutoff = (float)s->cutoff;
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 1.0, &view));
  conic_project_chunk(&view, &f->splats, 0, &projected);
  CHECK(chunk.n_drawn == 1 && chunk.n_fallback == 0);
  CHECK(chunk.n_rays == (size_t)takes_ray(s));
  if (!takes_ray(s))
    return;
  CHECK(conic_is_laplace(&footprint) == (change(s) > 1e-2));
  check_fragments(&view, &projected, s);
}

/* The largest error within the footprint, on a grid along the ellipse's own axes, so that thin ones are seen as well:
 * conic's, auto's, and those of the best of affine, conic and ray. And the largest difference between conic and what
 * auto has else, and between the two that it has. */
typedef struct auto_errors {
  double conic, chosen, best, step, other_step;
} auto_errors;

static auto_errors measure_auto(const setting *s, int has_exact) {
  variance affine = affine_variance(s), conic = conic_variance(s);
  auto_errors worst = {0, 0, 0, 0, 0};
  double ray_error = 0.0, affine_error = 0.0, half = 0.5 * atan2(2.0 * conic.xy, conic.xx - conic.yy), c = cos(half),
         sn = sin(half);
  double minor = smaller_variance(s), major = conic.xx + conic.yy - minor;
  double length = s->cutoff * sqrt(major + prefilter) / 12.0, width = s->cutoff * sqrt(minor + prefilter) / 12.0;
  for (int j = -12; j <= 12; j++)
    for (int i = -12; i <= 12; i++) {
      double a = length * i, b = width * j, x = conic.x + c * a - sn * b, y = conic.y + sn * a + c * b;
      double by_conic = ewa_weight(&conic, x, y), by_other = other_weight(s, &affine, x, y);
      if (i * i + j * j <= 144) { /* the footprint */
        worst.step = fmax(worst.step, fabs(by_conic - by_other));
        worst.other_step = fmax(worst.other_step, fabs(laplace_weight(s, &affine, x, y) - ray_weight(s, x, y)));
      }
      double exact = has_exact ? exact_weight(s, &affine, x, y, 1.1) : 0.0;
      if (exact <= 0.3 * exp(-0.5 * s->cutoff * s->cutoff))
        continue;
      worst.conic = fmax(worst.conic, fabs(by_conic - exact));
      worst.chosen = fmax(worst.chosen, fabs((takes_ray(s) ? by_other : by_conic) - exact));
      affine_error = fmax(affine_error, fabs(ewa_weight(&affine, x, y) - exact));
      ray_error = fmax(ray_error, fabs(ray_weight(s, x, y) - exact));
    }
  worst.best = fmin(worst.conic, fmin(affine_error, ray_error));
  return worst;
}

static void test_auto(fixture *f) {
  static const double sizes[] = {0.003, 0.01, 0.03, 0.055, 0.1}, focals[] = {500, 2000},
                      tilts[] = {0, 45, 75, 85, 88, 89, 89.3, 89.5, 89.7, 89.8, 89.85, 89.9};
  for (int k = 0; k < 2; k++) {
    double cutoff = k ? 3.0 : 1.5, worst = 0.0, worst_best = 0.0, worst_ratio = 0.0;
    for (int i = 0; i < 120; i++) {
      setting s = make_setting(focals[i / 60], sizes[i / 12 % 5], pi * tilts[i % 12] / 180.0, cutoff);
      auto_errors found = measure_auto(&s, 1);
      check_choice(f, &s);
      worst_best = fmax(worst_best, found.best);
      if (found.chosen > worst) {
        worst = found.chosen;
        printf("F_g %g: %g px, size %g, tilt %g: %.2e by %s\n", cutoff, focals[i / 60], sizes[i / 12 % 5],
               tilts[i % 12], worst,
               !takes_ray(&s)      ? "conic"
               : change(&s) > 1e-2 ? "laplace"
                                   : "ray");
      }
      if (found.conic > 1e-4)
        worst_ratio = fmax(worst_ratio, found.conic / conic_bound(&s));
    }
    printf("auto, F_g %g, to 89.9 degrees: at most %.2e, best of the others %.2e; conic at most %.2f of its bound\n",
           cutoff, worst, worst_best, worst_ratio);
    CHECK(worst < (k ? 2.2e-2 : 1e-2));
    CHECK(worst_ratio < 1.0);
  }
  printf("the renderer's weights: off by %.2e in %d fragments\n", worst_fragment, n_fragments);
  CHECK(n_fragments > 1000 && worst_fragment < 1e-4);
}

/* Where a splat that grows or turns is handed over: by how much the weights differ. */
static void test_hand_over(void) {
  double by_bound = 0.0, by_change = 0.0, by_thinness[2] = {0.0, 0.0};
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 90; i++) {
      double low = 1e-4, high = 0.1, cutoff = k ? 3.0 : 1.5;
      setting s;
      for (int step = 0; step < 50; step++) { /* the tilt is i degrees */
        s = make_setting(500.0, sqrt(low * high), pi * i / 180.0, cutoff);
        *(conic_bound(&s) > 4e-3 ? &high : &low) = sqrt(low * high);
      }
      if (high < 0.1 && smaller_variance(&s) >= thin_variance)
        by_bound = fmax(by_bound, measure_auto(&s, 0).step);
      low = 0.0, high = 0.5 * pi;
      for (int step = 0; step < 50; step++) { /* the size goes from 0.001 to 0.1 */
        s = make_setting(500.0, 1e-3 * pow(100.0, i / 89.0), 0.5 * (low + high), cutoff);
        *(smaller_variance(&s) < thin_variance ? &high : &low) = 0.5 * (low + high);
      }
      if (low > 0.0 && conic_bound(&s) > 4e-3)
        by_thinness[k] = fmax(by_thinness[k], measure_auto(&s, 0).step);
      low = 0.0, high = 0.5 * pi;
      for (int step = 0; step < 50; step++) {
        s = make_setting(500.0, 1e-3 * pow(100.0, i / 89.0), 0.5 * (low + high), cutoff);
        *(change(&s) > 1e-2 ? &high : &low) = 0.5 * (low + high);
      }
      if (low > 0.0 && takes_ray(&s))
        by_change = fmax(by_change, measure_auto(&s, 0).other_step);
    }
  printf("hand-over steps: %.2e at the bound, %.2e between ray and laplace, %.2e and %.2e at the thin end\n", by_bound,
         by_change, by_thinness[0], by_thinness[1]);
  CHECK(by_change > 1e-4 && by_change < 4e-3);
  CHECK(by_bound > 1e-3 && by_bound < 1e-2);
  CHECK(by_thinness[0] < 7e-3 && by_thinness[1] < 3e-2);
}

/* Everything else of the grid, at both focal lengths: the best of the three stays under a bound. */
static void test_grid(void) {
  static const double focals[] = {500, 2000}, sizes[] = {0.003, 0.01, 0.03, 0.1}, tilts[] = {0, 60, 85},
                      cutoffs[] = {1.5, 3};
  double worst_best = 0.0, worst_auto = 0.0;
  for (int f = 0; f < 2; f++)
    for (int i = 0; i < 24; i++) {
      double size = sizes[i / 6], tilt = tilts[i / 2 % 3], cutoff = cutoffs[i % 2];
      errors found = worst_errors(focals[f], size, tilt, cutoff);
      printf("focal %g: %6g %5g %4g %10.2e %10.2e %10.2e (%d)\n", focals[f], size, tilt, cutoff, found.affine,
             found.conic, found.ray, found.n_compared);
      CHECK(found.n_compared > 250);
      worst_auto = fmax(worst_auto, found.chosen);
      worst_best = fmax(worst_best, fmin(found.ray, fmin(found.affine, found.conic)));
    }
  printf("best of the three: at most %.2e; auto: %.2e\n", worst_best, worst_auto);
  CHECK(worst_best <= 4e-3);
  CHECK(worst_auto <= 2e-3);
}

int main(void) {
  test_table();
  test_grid();
  fixture f = fixture_open(1);
  fixture_splats(&f, 1);
  test_auto(&f);
  test_hand_over();
  fixture_close(&f);
  return check_result();
}
