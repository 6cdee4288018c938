/* The table of profile.h, in double: the kernel is blurred alike in all directions by the lesser of two filters, and
 * then along the other axis by what the greater has more. */
#include "core/splats/profile.h"

#include "core/base/base.h"
#include "core/base/context_struct.h"
#include "core/base/gaussian.h"

/* --- the smooth part as a polynomial of q and of q's part across, by least squares --- */

/* It is fitted at so many q and directions. */
enum { SMOOTH_PLACES = 9, SMOOTH_DIRECTIONS = 5, SMOOTH_NODES = SMOOTH_PLACES * SMOOTH_DIRECTIONS };

enum { SMOOTH_TERMS = CONIC_PROFILE_SMOOTH_TERMS };

/* The polynomials' values at the nodes, as orthogonal columns times a triangle. */
typedef struct smooth_fit {
  double column[SMOOTH_TERMS][SMOOTH_NODES];
  double triangle[SMOOTH_TERMS][SMOOTH_TERMS];
} smooth_fit;

/* Of each coefficient, the powers of q and of its part across. */
static const int powers[SMOOTH_TERMS][2] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}, {0, 1},
                                            {1, 1}, {2, 1}, {3, 1}, {0, 2}, {1, 2}, {2, 2}, {0, 3}, {1, 3}};

static double whole_power(double x, int power) {
  double product = 1.0;
  for (int i = 0; i < power; i++)
    product *= x;
  return product;
}

/* Over the support: 0 to 1. */
static double smooth_place(int i_place) {
  double v = (double)i_place / (double)(SMOOTH_PLACES - 1);
  return v * v * (3.0 - 2.0 * v);
}

static double inner_product(const double *a, const double *b) {
  double sum = 0.0;
  for (int i = 0; i < SMOOTH_NODES; i++)
    sum += a[i] * b[i];
  return sum;
}

/* Gram and Schmidt's columns. */
static void smooth_fit_begin(const double directions[SMOOTH_DIRECTIONS], smooth_fit *fit) {
  for (int term = 0; term < SMOOTH_TERMS; term++) {
    double *column = fit->column[term];
    for (int i = 0; i < SMOOTH_NODES; i++) {
      double q = smooth_place(i / SMOOTH_DIRECTIONS);
      double across = q * directions[i % SMOOTH_DIRECTIONS];
      column[i] = whole_power(q, powers[term][0]) * whole_power(across, powers[term][1]);
    }
    for (int before = 0; before < term; before++) {
      double part = inner_product(fit->column[before], column);
      fit->triangle[before][term] = part;
      for (int i = 0; i < SMOOTH_NODES; i++)
        column[i] -= part * fit->column[before][i];
    }
    double length = sqrt(inner_product(column, column));
    fit->triangle[term][term] = length;
    for (int i = 0; i < SMOOTH_NODES; i++)
      column[i] /= length;
  }
}

/* Finds the coefficients of the polynomial from its values, place by place. q ends at the support. */
static void smooth_fit_solve(const smooth_fit *fit, const double values[SMOOTH_NODES], double support,
                             float coefficients[SMOOTH_TERMS]) {
  double solved[SMOOTH_TERMS];
  for (int term = SMOOTH_TERMS - 1; term >= 0; term--) {
    double rest = inner_product(fit->column[term], values);
    for (int after = term + 1; after < SMOOTH_TERMS; after++)
      rest -= fit->triangle[term][after] * solved[after];
    solved[term] = rest / fit->triangle[term][term];
    coefficients[term] = (float)(solved[term] / whole_power(support, powers[term][0] + powers[term][1]));
  }
}

/* --- profiles --- */

enum { LEVELS = CONIC_PROFILE_LEVELS, TERMS = CONIC_PROFILE_TERMS, RADII = CONIC_PROFILE_RADII };
enum { SMOOTH = CONIC_PROFILE_SMOOTH_LEVELS };
/* Lesser shares of levels from here on are smooth. */
enum { STEEP = 13 };
/* Parts of a line that is blurred, an even number; and of the radius at which a blurred kernel is known. */
enum { PARTS = 40, N_KNOWN = 256 };
/* The normal distribution is known at so many places, up to 7. */
enum { N_NORMAL = 448 };
#define NORMAL_STEPS 64.0

/* Where the polynomial in the direction passes through what it stands for. */
static const double directions[TERMS] = {0.0, 0.15, 0.5, 0.85, 1.0};

/* A kernel's table. All lasting blocks of a context are such. */
typedef struct profile_table {
  conic_lasting lasting;
  conic_kernel kernel;
  float values[CONIC_PROFILE_FLOATS];
} profile_table;

#define KERNEL_VALUE value_in_doubles
#define KERNEL_INLINE static
#define KERNEL_NUMBER double
#define KERNEL_REAL double
#define KERNEL_OF(x) ((double)(x))
#define KERNEL_SQRT(x) sqrt(x)
#define KERNEL_EXP(x) conic_gaussian_exp(x)
#define KERNEL_ABOVE_0(x, y) ((x) > 0.0 ? (y) : 0.0)
#define KERNEL_GAUSS_OF(kernel, q) conic_gaussian_exp(-0.5 * (q))
#include "core/splats/kernel_body.h"

/* Beyond its end, too. */
static double plain_kernel(const conic_kernel *kernel, double r) {
  double value = value_in_doubles(kernel, r * r);
  return value > 0.0 ? value : 0.0;
}

/* The normal distribution and its integral, at multiples of 1/64. */
typedef struct normal_table {
  double distribution[N_NORMAL + 1], integral[N_NORMAL + 1];
} normal_table;

static double normal_density(double z) {
  return 0.3989422804014326779 * conic_gaussian_exp(-0.5 * z * z);
}

static void fill_normal(normal_table *table) {
  double distribution = 0.5, before = normal_density(0.0);
  for (int i = 0; i <= N_NORMAL; i++) {
    double z = (double)i / NORMAL_STEPS, density = normal_density(z);
    if (i > 0) /* Simpson's rule */
      distribution += (before + 4.0 * normal_density(z - 0.5 / NORMAL_STEPS) + density) / (6.0 * NORMAL_STEPS);
    table->distribution[i] = distribution;
    table->integral[i] = z * distribution + density;
    before = density;
  }
}

/* Its integral up to z: a cubic between the places. */
static double normal_integral(const normal_table *table, double z) {
  double size = fabs(z), place = size * NORMAL_STEPS;
  int i = place < (double)N_NORMAL ? (int)place : N_NORMAL - 1;
  double v = place - (double)i, rest = 1.0 - v, sum = size;
  if (place < (double)N_NORMAL)
    sum = rest * rest * (1.0 + 2.0 * v) * table->integral[i] + v * v * (3.0 - 2.0 * v) * table->integral[i + 1] +
          v * rest * (rest * table->distribution[i] - v * table->distribution[i + 1]) / NORMAL_STEPS;
  return z < 0.0 ? sum - size : sum;
}

/* A Gaussian of deviation `blur` at y sees a part of a box; the integral of that part over half widths 0 to `half`. */
static double integral_of_boxes(const normal_table *normal, double half, double y, double blur) {
  return blur * (normal_integral(normal, (half + y) / blur) + normal_integral(normal, (half - y) / blur)) - half;
}

/* The kernel, blurred alike in all directions. */
typedef struct round_kernel {
  const conic_kernel *kernel;
  const normal_table *normal;
  double end;         /* the kernel's own */
  double blur, reach; /* nothing is beyond that */
  double known[N_KNOWN + 1];
} round_kernel;

/* At a radius up to the reach. */
static double round_value(const round_kernel *k, double r) {
  if (!(k->blur > 0.0))
    return plain_kernel(k->kernel, r);
  double place = r / k->reach * (double)N_KNOWN;
  int i = (int)place < N_KNOWN ? (int)place : N_KNOWN - 1;
  return k->known[i] + (place - (double)i) * (k->known[i + 1] - k->known[i]);
}

/* At y, an even function blurred by a Gaussian: linear between its places, which ascend from 0, and 0 beyond them. */
static double blur_line(const normal_table *normal, const double places[PARTS + 1], const double values[PARTS + 1],
                        double y, double blur) {
  double sum = 0.0, before = integral_of_boxes(normal, places[0], y, blur);
  for (int i = 0; i < PARTS; i++) {
    double next = integral_of_boxes(normal, places[i + 1], y, blur), step = places[i + 1] - places[i];
    if (step > 0.0)
      sum += (values[i] - values[i + 1]) * ((next - before) / step);
    before = next;
  }
  double hair = 1e-6 * blur, last = places[PARTS];
  return sum + values[PARTS] * ((integral_of_boxes(normal, last + hair, y, blur) - before) / hair);
}

static double half_chord(double r, double x) {
  return r > x ? sqrt((r - x) * (r + x)) : 0.0;
}

/* The kernel on the line at x. Half of the places lie where it may be steep. */
static void cut_line(const round_kernel *k, double x, double places[PARTS + 1], double values[PARTS + 1]) {
  double steep = k->end - 3.0 * k->blur, first = half_chord(steep > 0.0 ? steep : 0.0, x), last;
  if (!(k->blur > 0.0))
    first = half_chord(0.75 * k->end, x);
  last = half_chord(k->reach, x);
  for (int i = 0; i <= PARTS; i++) {
    double part = 2.0 * (double)i / (double)PARTS;
    places[i] = part < 1.0 ? part * first : first + (part - 1.0) * (last - first);
    values[i] = round_value(k, x < k->reach ? sqrt(x * x + places[i] * places[i]) : k->reach);
  }
}

/* Fills the known values of `blurred`: the plain kernel, blurred along x and then along y. */
static void blur_round(const round_kernel *plain, round_kernel *blurred) {
  double places[PARTS + 1], values[PARTS + 1], rows[PARTS + 1], row_places[PARTS + 1];
  for (int i = 0; i <= PARTS; i++) {
    double left = 1.0 - (double)i / (double)PARTS;
    row_places[i] = plain->end * (1.0 - left * left);
    cut_line(plain, row_places[i], places, values);
    rows[i] = i < PARTS ? blur_line(plain->normal, places, values, 0.0, blurred->blur) : 0.0;
  }
  for (int i = 0; i <= N_KNOWN; i++)
    blurred->known[i] =
        blur_line(plain->normal, row_places, rows, blurred->reach * (double)i / (double)N_KNOWN, blurred->blur);
}

/* What conic_profile_level makes a whole number of. */
static double share_of_level(int level) {
  double place = (double)((1 << level) - 1) / (double)CONIC_PROFILE_PLACES;
  return 4.0 * place / (1.0 + 3.0 * place);
}

/* The square of the filter's deviation where its share in the variance is t. */
static double filter_of(double t) {
  return t / (1.0 - t);
}

/* What the filter makes of the kernel at q. `across` is the part of q along axis 1, which has the greater share. */
static double filter_kernel(const round_kernel *k, const double share[2], double q, double across) {
  double more = filter_of(share[1]) - filter_of(share[0]), places[PARTS + 1], values[PARTS + 1];
  double x = sqrt(q * (1.0 - across) / (1.0 - share[0])), y = sqrt(q * across / (1.0 - share[1]));
  double r = sqrt(x * x + y * y);
  if (!(more > 0.0))
    return r < k->reach || k->blur == 0.0 ? round_value(k, r) : 0.0;
  cut_line(k, x, places, values);
  return x < k->reach ? blur_line(k->normal, places, values, y, sqrt(more)) : 0.0;
}

/* The profile at a radius and the nodes of the direction. */
static void find_nodes(const round_kernel *k, const conic_profile *profile, const double share[2], int i_radius,
                       double nodes[TERMS]) {
  double radius = (double)i_radius / (double)(RADII - 1), bend = 1.0, peak = 1.0;
  double support = (double)conic_kernel_support(k->kernel);
  double q = profile->is_bent ? support * (1.0 - radius * radius) : support * (radius * radius);
  for (int i = 0; i < 2; i++)
    peak *= (1.0 - share[i]) / (1.0 + (double)profile->narrowing * share[i]);
  peak = sqrt(peak);
  if (profile->is_bent)
    bend = sqrt((share[0] + (double)CONIC_PROFILE_BEND) / (share[1] + (double)CONIC_PROFILE_BEND));
  for (int i = 0; i < TERMS; i++) {
    double across = directions[i] * bend / (directions[i] * bend + (1.0 - directions[i]));
    nodes[i] = filter_kernel(k, share, q, across) / peak;
  }
}

/* What conic_profile_smooth_level makes a whole number of; all but all, where it is all. */
static double smooth_share(int level) {
  return level < SMOOTH - 1 ? (double)(level + 1) / (double)SMOOTH : 1.0 - 0x1p-16;
}

/* Newton's divided differences, multiplied out. */
static void write_polynomial(const double nodes[TERMS], int is_turned, int i_radius, float *slice) {
  double differences[TERMS], terms[TERMS] = {0.0};
  for (int i = 0; i < TERMS; i++)
    differences[i] = nodes[is_turned ? TERMS - 1 - i : i];
  for (int order = 1; order < TERMS; order++)
    for (int i = TERMS - 1; i >= order; i--)
      differences[i] = (differences[i] - differences[i - 1]) / (directions[i] - directions[i - order]);
  for (int i = TERMS - 1; i >= 0; i--) {
    for (int term = TERMS - 1; term > 0; term--)
      terms[term] = terms[term - 1] - directions[i] * terms[term];
    terms[0] = differences[i] - directions[i] * terms[0];
  }
  for (int term = 0; term < TERMS; term++)
    slice[term * RADII + i_radius] = (float)terms[term];
}

static double end_of_kernel(const conic_kernel *kernel) {
  double cutoff = (double)kernel->cutoff;
  double end = conic_kernel_traits(kernel) & CONIC_HAS_PARAMETERS ? (double)kernel->b : cutoff;
  return end < 4.0 * cutoff ? end : 4.0 * cutoff;
}

enum { N_RINGS = 1024 };

double conic_profile_slope(const conic_kernel *kernel) {
  double step = end_of_kernel(kernel) / (double)N_RINGS, most = 0.0;
  for (int i = 0; i < N_RINGS; i++) {
    double fall = plain_kernel(kernel, step * (double)i) - plain_kernel(kernel, step * (double)(i + 1));
    most = fall > most ? fall : most;
  }
  return most / step;
}

static conic_profile reading(const conic_kernel *kernel, const float *table) {
  float by_q = 1.0f / conic_kernel_support(kernel);
  double end = end_of_kernel(kernel), integral = 0.0;
  for (int i = 0; i < N_RINGS; i++) {
    double r = end * ((double)i + 0.5) / (double)N_RINGS;
    integral += plain_kernel(kernel, r) * r * (end / (double)N_RINGS);
  }
  float narrowing = (float)(1.0 / integral - 1.0);
  if (conic_kernel_traits(kernel) & CONIC_IS_FLAT)
    return (conic_profile){1.0f, -by_q, narrowing, 1, table};
  return (conic_profile){0.0f, by_q, narrowing, 0, table};
}

static void begin_kernel(const conic_kernel *kernel, const normal_table *normal, double share, round_kernel *blurred) {
  round_kernel plain = {.kernel = kernel, .normal = normal, .end = end_of_kernel(kernel)};
  plain.reach = plain.end;
  *blurred = plain;
  if (share > 0.0) {
    blurred->blur = sqrt(filter_of(share));
    blurred->reach = plain.end + 5.0 * blurred->blur;
    blur_round(&plain, blurred);
  }
}

/* The rows of the table in which the lesser share has one level, and the columns. */
static void fill_steep(profile_table *table, const normal_table *normal, int low) {
  const conic_profile profile = reading(&table->kernel, NULL);
  round_kernel blurred;
  begin_kernel(&table->kernel, normal, share_of_level(low), &blurred);
  for (int high = low; high < LEVELS; high++)
    for (int i = 0; i < RADII; i++) {
      double share[2] = {share_of_level(low), share_of_level(high)}, nodes[TERMS];
      find_nodes(&blurred, &profile, share, i, nodes);
      write_polynomial(nodes, 0, i, table->values + (size_t)(low * LEVELS + high) * CONIC_PROFILE_SLICE);
      write_polynomial(nodes, 1, i, table->values + (size_t)(high * LEVELS + low) * CONIC_PROFILE_SLICE);
    }
}

/* Likewise of what is smooth. */
static void fill_smooth(profile_table *table, const normal_table *normal, int low) {
  const double support = (double)conic_kernel_support(&table->kernel);
  smooth_fit fit;
  round_kernel blurred;
  smooth_fit_begin(directions, &fit);
  begin_kernel(&table->kernel, normal, smooth_share(low), &blurred);
  for (int high = low; high < SMOOTH; high++) {
    const double share[2] = {smooth_share(low), smooth_share(high)};
    double peak = sqrt((1.0 - share[0]) * (1.0 - share[1])), values[SMOOTH_NODES], turned[SMOOTH_NODES];
    for (int i = 0; i < SMOOTH_NODES; i++) {
      int place = i / TERMS, direction = i % TERMS;
      values[i] = filter_kernel(&blurred, share, support * smooth_place(place), directions[direction]) / peak;
      turned[place * TERMS + TERMS - 1 - direction] = values[i];
    }
    float *smooth = table->values + CONIC_PROFILE_STEEP;
    smooth_fit_solve(&fit, values, support, smooth + (size_t)(low * SMOOTH + high) * SMOOTH_TERMS);
    smooth_fit_solve(&fit, turned, support, smooth + (size_t)(high * SMOOTH + low) * SMOOTH_TERMS);
  }
}

static void fill_level(void *data, size_t i_level) {
  profile_table *table = data;
  normal_table normal;
  fill_normal(&normal);
  if (i_level < SMOOTH)
    fill_smooth(table, &normal, (int)i_level);
  else
    fill_steep(table, &normal, (int)i_level - SMOOTH);
}

static int is_same_kernel(const conic_kernel *a, const conic_kernel *b) {
  return a->type == b->type && a->cutoff == b->cutoff &&
         (!(conic_kernel_traits(a) & CONIC_HAS_PARAMETERS) || (a->a == b->a && a->b == b->b && a->n == b->n));
}

conic_status conic_profile_make(conic_context *context, const conic_kernel *kernel, conic_profile *profile) {
  conic_lasting *first = context->lasting;
  for (const conic_lasting *block = first; block; block = block->next) {
    const profile_table *table = (const profile_table *)block;
    if (is_same_kernel(&table->kernel, kernel)) {
      *profile = reading(kernel, table->values);
      return CONIC_OK;
    }
  }
  profile_table *table = conic_memory_allocate(context, 1, sizeof *table);
  if (!table)
    return CONIC_ERROR_MEMORY;
  table->kernel = *kernel;
  memset(table->values, 0, sizeof table->values); /* some are never read */
  conic_parallel_for(context, SMOOTH + STEEP, fill_level, table);
  do
    table->lasting.next = first;
  while (!atomic_compare_exchange_weak(&context->lasting, &first, &table->lasting));
  *profile = reading(kernel, table->values);
  return CONIC_OK;
}
