/* The loops in vectors as wide as a register; each instruction set's file includes this. A total has eight partial sums
 * at any width: a narrow vector goes through all neighbours once for each part of the eight. Each lane does what
 * surface/loops/surface_loops_scalar.c and surface/loops/weight.h do, in their order. */
#include "core/lanes/lanes_double.h"
#include "surface/loops/surface_loops.h"
#include "surface/loops/weight.h"

/* The order in which every total is added. */
CONIC_INLINE double total(const double partial[CONIC_NEAR_LANES]) {
  return ((partial[0] + partial[4]) + (partial[2] + partial[6])) +
         ((partial[1] + partial[5]) + (partial[3] + partial[7]));
}

typedef struct wide_theta {
  wide value, first, second;
} wide_theta;

CONIC_INLINE wide wide_exp(wide s) {
  wide x = -s, k = x * CONIC_WEIGHT_LOG2E + CONIC_WEIGHT_ROUND;
  wide_mask k_bits = (wide_mask)k << 52;
  k = k - CONIC_WEIGHT_ROUND;
  wide r = (x - k * CONIC_WEIGHT_LN2_HIGH) - k * CONIC_WEIGHT_LN2_LOW, r2 = r * r, r4 = r2 * r2;
  wide a = (1.0 + r) + r2 * (CONIC_EXP_2 + CONIC_EXP_3 * r);
  wide b = (CONIC_EXP_4 + CONIC_EXP_5 * r) + r2 * (CONIC_EXP_6 + CONIC_EXP_7 * r);
  wide c = (CONIC_EXP_8 + CONIC_EXP_9 * r) + r2 * (CONIC_EXP_10 + CONIC_EXP_11 * r);
  return (wide)((wide_mask)(a + r4 * (b + r4 * c)) + k_bits);
}

CONIC_INLINE wide_theta wide_gauss(const conic_weighing *weighing, wide s) {
  wide_theta theta;
  wide g = wide_exp(s);
  theta.value = g - weighing->edge * ((1.0 + weighing->end) - s);
  theta.first = weighing->edge - g;
  theta.second = g;
  return theta;
}

CONIC_INLINE wide_theta wide_compact(const conic_weighing *weighing, wide s) {
  wide_theta theta;
  wide z = s / weighing->end, y = wide_sqrt(z);
  wide least = wide_select(y > CONIC_WEIGHT_LEAST, y, wide_of(CONIC_WEIGHT_LEAST));
  theta.value = 1.0 - z * (3.0 - 2.0 * y);
  theta.first = (3.0 * y - 3.0) / weighing->end;
  theta.second = (1.5 / least) / (weighing->end * weighing->end);
  return theta;
}

CONIC_INLINE wide_theta wide_flat(const conic_weighing *weighing, wide s) {
  wide_theta theta;
  double inverse = 1.0 / weighing->end;
  wide z = s * inverse, z2 = z * z, u = 1.0 - z2;
  theta.value = u * u;
  theta.first = (z * u) * (-4.0 * inverse);
  theta.second = (3.0 * z2 - 1.0) * ((4.0 * inverse) * inverse);
  return theta;
}

CONIC_INLINE wide_theta wide_weight(const conic_weighing *weighing, wide s, conic_surface_weight weight) {
  wide_mask inside = s < weighing->end;
  wide inner = wide_select(inside, s, wide_of(weighing->end));
  wide_theta theta = weight == CONIC_WEIGHT_COMPACT ? wide_compact(weighing, inner)
                     : weight == CONIC_WEIGHT_FLAT  ? wide_flat(weighing, inner)
                                                    : wide_gauss(weighing, inner);
  theta.value = wide_keep((theta.value > 0.0) & inside, theta.value);
  theta.first = wide_keep(inside, theta.first);
  theta.second = wide_keep(inside, theta.second);
  return theta;
}

/* Partial sums of several terms: numbers `lane` to lane + CONIC_WIDE_LANES - 1 of each. */
typedef double partial_sums[CONIC_NEAR_LANES];

CONIC_INLINE void store_parts(const wide *parts, int n, partial_sums *partials, size_t lane) {
  for (int k = 0; k < n; k++)
    wide_store(partials[k] + lane, parts[k]);
}

CONIC_INLINE void add_up(partial_sums *partials, int n, double *sums) {
  for (int k = 0; k < n; k++)
    sums[k] = total(partials[k]);
}

#if CONIC_WIDE_LANES > 2 /* two by two, it takes three times as long as plain C */

static void select(const conic_near *all, const double r[3], double neglect, double margin, uint32_t except,
                   conic_near *near) {
  size_t n = 0;
  for (size_t i = 0; i < all->n_padded; i += CONIC_WIDE_LANES) {
    wide x = wide_load(all->offset[0] + i) - r[0], y = wide_load(all->offset[1] + i) - r[1];
    wide z = wide_load(all->offset[2] + i) - r[2], h = wide_load(all->inverse_h2 + i), reach = neglect * h + margin;
    wide_ints sources;
    memcpy(&sources, all->sources + i, sizeof sources);
    wide_mask is_other = __builtin_convertvector(sources != (int32_t)except, wide_mask);
    unsigned bits = wide_bits(((x * x + y * y) + z * z < reach * reach) & is_other);
    wide_append(near->offset[0] + n, bits, x);
    wide_append(near->offset[1] + n, bits, y);
    wide_append(near->offset[2] + n, bits, z);
    wide_append(near->mass + n, bits, wide_load(all->mass + i));
    wide_append(near->inverse_h2 + n, bits, wide_keep(h > 0.0, 1.0 / (h * h)));
    wide_append_ints(near->sources + n, bits, sources);
    n += (size_t)__builtin_popcount(bits);
  }
  near->n = n;
}

#endif

CONIC_INLINE void moments_part(conic_near *near, const conic_weighing *weighing, const double q[3],
                               partial_sums *partials, size_t lane, conic_surface_weight weight) {
  wide w_sum = {0}, x_sum = {0}, y_sum = {0}, z_sum = {0}, count = {0};
  wide xx = {0}, xy = {0}, xz = {0}, yy = {0}, yz = {0}, zz = {0};
  for (size_t i = lane; i < near->n_padded; i += CONIC_NEAR_LANES) {
    wide x = wide_load(near->offset[0] + i) - q[0], y = wide_load(near->offset[1] + i) - q[1];
    wide z = wide_load(near->offset[2] + i) - q[2];
    wide s = ((x * x + y * y) + z * z) * wide_load(near->inverse_h2 + i);
    wide w = wide_weight(weighing, s, weight).value * wide_load(near->mass + i);
    wide wx = w * x, wy = w * y, wz = w * z;
    wide_store(near->weights + i, w);
    w_sum += w;
    x_sum += wx;
    y_sum += wy;
    z_sum += wz;
    xx += wx * x;
    xy += wx * y;
    xz += wx * z;
    yy += wy * y;
    yz += wy * z;
    zz += wz * z;
    count += wide_keep(w > 0.0, wide_of(1.0));
  }
  const wide parts[CONIC_N_MOMENTS] = {w_sum, x_sum, y_sum, z_sum, xx, xy, xz, yy, yz, zz, count};
  store_parts(parts, CONIC_N_MOMENTS, partials, lane);
}

static void moments(conic_near *near, const conic_weighing *weighing, const double q[3], double sums[CONIC_N_MOMENTS]) {
  partial_sums partials[CONIC_N_MOMENTS];
  for (size_t lane = 0; lane < CONIC_NEAR_LANES; lane += CONIC_WIDE_LANES)
    if (weighing->weight == CONIC_WEIGHT_COMPACT)
      moments_part(near, weighing, q, partials, lane, CONIC_WEIGHT_COMPACT);
    else if (weighing->weight == CONIC_WEIGHT_FLAT)
      moments_part(near, weighing, q, partials, lane, CONIC_WEIGHT_FLAT);
    else
      moments_part(near, weighing, q, partials, lane, CONIC_WEIGHT_GAUSS);
  add_up(partials, CONIC_N_MOMENTS, sums);
}

CONIC_INLINE void plane_part(const conic_near *near, const conic_weighing *weighing, double frame[3][3], double t,
                             partial_sums *partials, size_t lane, conic_surface_weight weight) {
  wide g_a = {0}, g_b = {0}, k = {0}, aa = {0}, ab = {0}, bb = {0}, at = {0}, bt = {0}, ka = {0}, kb = {0}, kt = {0};
  wide energy = {0};
  for (size_t i = lane; i < near->n_padded; i += CONIC_NEAR_LANES) {
    wide dx = wide_load(near->offset[0] + i), dy = wide_load(near->offset[1] + i);
    wide dz = wide_load(near->offset[2] + i), h2 = wide_load(near->inverse_h2 + i);
    wide x = (dx * frame[0][0] + dy * frame[0][1]) + dz * frame[0][2];
    wide y = (dx * frame[1][0] + dy * frame[1][1]) + dz * frame[1][2];
    wide S = (dx * frame[2][0] + dy * frame[2][1]) + dz * frame[2][2];
    wide s = S - t, s2 = s * s, mass = wide_load(near->mass + i);
    wide_theta theta = wide_weight(weighing, ((x * x + y * y) + s2) * h2, weight);
    wide value = theta.value * mass, first = theta.first * (mass * h2), second = theta.second * (mass * h2 * h2);
    wide sv = s * value, s2f = s2 * first, turn = value - 2.0 * (t * s) * first, lift = sv * S;
    wide slip = value + 2.0 * s2f;
    wide lean = (value + 3.0 * s2f) - 2.0 * (t * s) * (first + s2 * second);
    wide sink = (value + 5.0 * s2f) + 2.0 * (s2 * s2) * second;
    wide xt = x * turn, yt = y * turn;
    g_a += sv * x;
    g_b += sv * y;
    k += sv + s * s2f;
    aa += xt * x - lift;
    ab += xt * y;
    bb += yt * y - lift;
    at += -x * slip;
    bt += -y * slip;
    ka += x * lean;
    kb += y * lean;
    kt += -sink;
    energy += s * sv;
  }
  const wide parts[CONIC_N_PLANE_SUMS] = {g_a, g_b, k, aa, ab, bb, at, bt, ka, kb, kt, energy};
  store_parts(parts, CONIC_N_PLANE_SUMS, partials, lane);
}

static void plane(const conic_near *near, const conic_weighing *weighing, double frame[3][3], double t,
                  double sums[CONIC_N_PLANE_SUMS]) {
  partial_sums partials[CONIC_N_PLANE_SUMS];
  for (size_t lane = 0; lane < CONIC_NEAR_LANES; lane += CONIC_WIDE_LANES)
    if (weighing->weight == CONIC_WEIGHT_COMPACT)
      plane_part(near, weighing, frame, t, partials, lane, CONIC_WEIGHT_COMPACT);
    else if (weighing->weight == CONIC_WEIGHT_FLAT)
      plane_part(near, weighing, frame, t, partials, lane, CONIC_WEIGHT_FLAT);
    else
      plane_part(near, weighing, frame, t, partials, lane, CONIC_WEIGHT_GAUSS);
  add_up(partials, CONIC_N_PLANE_SUMS, sums);
}

static void fill_columns(conic_near *near, double frame[3][3], double t, double scale, int degree) {
  size_t n = near->n_padded;
  int n_coefficients = conic_n_coefficients(degree);
  for (size_t i = 0; i < n; i += CONIC_WIDE_LANES) {
    wide dx = wide_load(near->offset[0] + i), dy = wide_load(near->offset[1] + i), dz = wide_load(near->offset[2] + i);
    wide x = ((dx * frame[0][0] + dy * frame[0][1]) + dz * frame[0][2]) * scale;
    wide y = ((dx * frame[1][0] + dy * frame[1][1]) + dz * frame[1][2]) * scale;
    wide S = (dx * frame[2][0] + dy * frame[2][1]) + dz * frame[2][2];
    double *column = near->columns + i;
    wide_store(column, wide_of(1.0));
    for (int power = 1, first = 1; power <= degree; first += ++power) {
      for (int k = 0; k < power; k++)
        wide_store(column + (size_t)(first + k) * n, wide_load(column + (size_t)(first - power + k) * n) * x);
      wide_store(column + (size_t)(first + power) * n, wide_load(column + (size_t)(first - 1) * n) * y);
    }
    wide_store(column + (size_t)n_coefficients * n, (S - t) * scale);
  }
}

CONIC_INLINE double weighted_product(const conic_near *near, const double *a, const double *b) {
  partial_sums partial;
  for (size_t lane = 0; lane < CONIC_NEAR_LANES; lane += CONIC_WIDE_LANES) {
    wide sum = {0};
    for (size_t i = lane; i < near->n_padded; i += CONIC_NEAR_LANES)
      sum += (wide_load(near->weights + i) * wide_load(a + i)) * wide_load(b + i);
    wide_store(partial + lane, sum);
  }
  return total(partial);
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
      for (size_t i = 0; i < n; i += CONIC_WIDE_LANES)
        wide_store(column + i, wide_load(column + i) - share * wide_load(pivot + i));
    }
  }
}

CONIC_INLINE void sphere_part(conic_near *near, const conic_weighing *weighing, const double q[3],
                              partial_sums *partials, size_t lane, conic_surface_weight weight) {
  wide w_sum = {0}, x_sum = {0}, y_sum = {0}, z_sum = {0}, nx_sum = {0}, ny_sum = {0}, nz_sum = {0};
  wide d2_sum = {0}, dn_sum = {0}, count = {0};
  for (size_t i = lane; i < near->n_padded; i += CONIC_NEAR_LANES) {
    wide x = wide_load(near->offset[0] + i) - q[0], y = wide_load(near->offset[1] + i) - q[1];
    wide z = wide_load(near->offset[2] + i) - q[2];
    wide nx = wide_load(near->normal[0] + i), ny = wide_load(near->normal[1] + i);
    wide nz = wide_load(near->normal[2] + i), d2 = (x * x + y * y) + z * z;
    wide w = wide_weight(weighing, d2 * wide_load(near->inverse_h2 + i), weight).value * wide_load(near->mass + i);
    wide_store(near->weights + i, w);
    w_sum += w;
    x_sum += w * x;
    y_sum += w * y;
    z_sum += w * z;
    nx_sum += w * nx;
    ny_sum += w * ny;
    nz_sum += w * nz;
    d2_sum += w * d2;
    dn_sum += w * ((x * nx + y * ny) + z * nz);
    count += wide_keep(w > 0.0, wide_of(1.0));
  }
  const wide parts[CONIC_N_SPHERE_SUMS] = {w_sum, x_sum, y_sum, z_sum, nx_sum, ny_sum, nz_sum, d2_sum, dn_sum, count};
  store_parts(parts, CONIC_N_SPHERE_SUMS, partials, lane);
}

static void sphere(conic_near *near, const conic_weighing *weighing, const double q[3],
                   double sums[CONIC_N_SPHERE_SUMS]) {
  partial_sums partials[CONIC_N_SPHERE_SUMS];
  for (size_t lane = 0; lane < CONIC_NEAR_LANES; lane += CONIC_WIDE_LANES)
    if (weighing->weight == CONIC_WEIGHT_COMPACT)
      sphere_part(near, weighing, q, partials, lane, CONIC_WEIGHT_COMPACT);
    else if (weighing->weight == CONIC_WEIGHT_FLAT)
      sphere_part(near, weighing, q, partials, lane, CONIC_WEIGHT_FLAT);
    else
      sphere_part(near, weighing, q, partials, lane, CONIC_WEIGHT_GAUSS);
  add_up(partials, CONIC_N_SPHERE_SUMS, sums);
}

CONIC_FILL_LOOPS(conic_surface_loops) {
#if CONIC_WIDE_LANES > 2
  loops->select = select;
#endif
  loops->moments = moments;
  loops->plane = plane;
  loops->factor = factor;
  loops->sphere = sphere;
}
