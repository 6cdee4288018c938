/* The loops in plain C: the reference. */
#include "surface/loops/weight.h"

typedef double partial[CONIC_NEAR_LANES];

static double total(const partial sum) {
  return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

static void totals(partial *partials, int n, double *sums) {
  for (int i = 0; i < n; i++)
    sums[i] = total(partials[i]);
}

static void select(const conic_near *all, const double r[3], double neglect, double margin, uint32_t except,
                   conic_near *near) {
  size_t n = 0;
  for (size_t i = 0; i < all->n; i++) {
    double x = all->offset[0][i] - r[0], y = all->offset[1][i] - r[1], z = all->offset[2][i] - r[2];
    double h = all->inverse_h2[i], reach = neglect * h + margin;
    near->offset[0][n] = x;
    near->offset[1][n] = y;
    near->offset[2][n] = z;
    near->mass[n] = all->mass[i];
    near->inverse_h2[n] = h > 0.0 ? 1.0 / (h * h) : 0.0;
    near->sources[n] = all->sources[i];
    n += (x * x + y * y) + z * z < reach * reach && all->sources[i] != except;
  }
  near->n = n;
}

static void moments(conic_near *near, const conic_weighing *weighing, const double q[3], double sums[CONIC_N_MOMENTS]) {
  partial partials[CONIC_N_MOMENTS] = {{0}};
  for (size_t i = 0; i < near->n_padded; i++) {
    size_t lane = i % CONIC_NEAR_LANES;
    double x = near->offset[0][i] - q[0], y = near->offset[1][i] - q[1], z = near->offset[2][i] - q[2];
    double s = ((x * x + y * y) + z * z) * near->inverse_h2[i];
    double w = conic_weight_at(weighing, s).value * near->mass[i], wx = w * x, wy = w * y, wz = w * z;
    const double terms[CONIC_N_MOMENTS] = {
        w, wx, wy, wz, wx * x, wx * y, wx * z, wy * y, wy * z, wz * z, w > 0.0 ? 1.0 : 0.0};
    near->weights[i] = w;
    for (int k = 0; k < CONIC_N_MOMENTS; k++)
      partials[k][lane] += terms[k];
  }
  totals(partials, CONIC_N_MOMENTS, sums);
}

/* With D the offset from r, S = n·D and s = S - t: a sample's energy is s² θ(ρ), ρ = D·D - 2tS + t². */
static void plane(const conic_near *near, const conic_weighing *weighing, double frame[3][3], double t,
                  double sums[CONIC_N_PLANE_SUMS]) {
  partial partials[CONIC_N_PLANE_SUMS] = {{0}};
  for (size_t i = 0; i < near->n_padded; i++) {
    size_t lane = i % CONIC_NEAR_LANES;
    double dx = near->offset[0][i], dy = near->offset[1][i], dz = near->offset[2][i], h2 = near->inverse_h2[i];
    double x = (dx * frame[0][0] + dy * frame[0][1]) + dz * frame[0][2];
    double y = (dx * frame[1][0] + dy * frame[1][1]) + dz * frame[1][2];
    double S = (dx * frame[2][0] + dy * frame[2][1]) + dz * frame[2][2];
    double s = S - t, s2 = s * s, mass = near->mass[i];
    conic_theta theta = conic_weight_at(weighing, ((x * x + y * y) + s2) * h2);
    double value = theta.value * mass, first = theta.first * (mass * h2), second = theta.second * (mass * h2 * h2);
    double sv = s * value, s2f = s2 * first, turn = value - 2.0 * (t * s) * first, lift = sv * S;
    double slip = value + 2.0 * s2f;
    double lean = (value + 3.0 * s2f) - 2.0 * (t * s) * (first + s2 * second);
    double sink = (value + 5.0 * s2f) + 2.0 * (s2 * s2) * second;
    double xt = x * turn, yt = y * turn;
    const double terms[CONIC_N_PLANE_SUMS] = {sv * x,    sv * y,    sv + s * s2f, xt * x - lift, xt * y, yt * y - lift,
                                              -x * slip, -y * slip, x * lean,     y * lean,      -sink,  s * sv};
    for (int k = 0; k < CONIC_N_PLANE_SUMS; k++)
      partials[k][lane] += terms[k];
  }
  totals(partials, CONIC_N_PLANE_SUMS, sums);
}

/* The monomials 1, x, y, x², xy, y² … and the heights, column by column. */
static void fill_columns(conic_near *near, double frame[3][3], double t, double scale, int degree) {
  size_t n = near->n_padded;
  int n_coefficients = conic_n_coefficients(degree);
  for (size_t i = 0; i < n; i++) {
    double dx = near->offset[0][i], dy = near->offset[1][i], dz = near->offset[2][i];
    double x = ((dx * frame[0][0] + dy * frame[0][1]) + dz * frame[0][2]) * scale;
    double y = ((dx * frame[1][0] + dy * frame[1][1]) + dz * frame[1][2]) * scale;
    double S = (dx * frame[2][0] + dy * frame[2][1]) + dz * frame[2][2];
    double *column = near->columns + i;
    column[0] = 1.0;
    for (int power = 1, first = 1; power <= degree; first += ++power) {
      for (int k = 0; k < power; k++)
        column[(size_t)(first + k) * n] = column[(size_t)(first - power + k) * n] * x;
      column[(size_t)(first + power) * n] = column[(size_t)(first - 1) * n] * y;
    }
    column[(size_t)n_coefficients * n] = (S - t) * scale;
  }
}

static double weighted_product(const conic_near *near, const double *a, const double *b) {
  partial sum = {0};
  for (size_t i = 0; i < near->n_padded; i++)
    sum[i % CONIC_NEAR_LANES] += (near->weights[i] * a[i]) * b[i];
  return total(sum);
}

static void factor(conic_near *near, double frame[3][3], double t, double scale, int degree,
                   double upper[CONIC_MAX_COLUMNS][CONIC_MAX_COLUMNS], double norms2[CONIC_MAX_COLUMNS],
                   double before2[CONIC_MAX_COLUMNS]) {
  size_t n = near->n_padded;
  int n_coefficients = conic_n_coefficients(degree);
  fill_columns(near, frame, t, scale, degree);
  for (int k = 0; k < n_coefficients; k++)
    before2[k] = weighted_product(near, near->columns + (size_t)k * n, near->columns + (size_t)k * n);
  for (int j = 0; j < n_coefficients; j++) {
    const double *pivot = near->columns + (size_t)j * n;
    norms2[j] = weighted_product(near, pivot, pivot);
    double inverse = norms2[j] > 0.0 ? 1.0 / norms2[j] : 0.0;
    for (int k = j + 1; k <= n_coefficients; k++) {
      double *column = near->columns + (size_t)k * n;
      double share = weighted_product(near, pivot, column) * inverse;
      upper[j][k] = share;
      for (size_t i = 0; i < n; i++)
        column[i] = column[i] - share * pivot[i];
    }
  }
}

static void sphere(conic_near *near, const conic_weighing *weighing, const double q[3],
                   double sums[CONIC_N_SPHERE_SUMS]) {
  partial partials[CONIC_N_SPHERE_SUMS] = {{0}};
  for (size_t i = 0; i < near->n_padded; i++) {
    size_t lane = i % CONIC_NEAR_LANES;
    double x = near->offset[0][i] - q[0], y = near->offset[1][i] - q[1], z = near->offset[2][i] - q[2];
    double nx = near->normal[0][i], ny = near->normal[1][i], nz = near->normal[2][i];
    double d2 = (x * x + y * y) + z * z;
    double w = conic_weight_at(weighing, d2 * near->inverse_h2[i]).value * near->mass[i];
    const double terms[CONIC_N_SPHERE_SUMS] = {
        w, w * x, w * y, w * z, w * nx, w * ny, w * nz, w * d2, w * ((x * nx + y * ny) + z * nz), w > 0.0 ? 1.0 : 0.0};
    near->weights[i] = w;
    for (int k = 0; k < CONIC_N_SPHERE_SUMS; k++)
      partials[k][lane] += terms[k];
  }
  totals(partials, CONIC_N_SPHERE_SUMS, sums);
}

CONIC_DEFINE_LOOPS(conic_surface_loops)

void conic_surface_loops_scalar(conic_surface_loops *loops) {
  *loops = (conic_surface_loops){select, moments, plane, factor, sphere};
}
