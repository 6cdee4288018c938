#include "oracle/oracle_splat.h"

enum { LEVELS = 18, RADII = 16, NODES = 5, PARTS = 40, KNOWN = 256, NORMALS = 225 };
enum { STEPS = 16, PLACES = 9, TERMS = 16 };

static const double node_directions[NODES] = {0.0, 0.15, 0.5, 0.85, 1.0};

/* At the lesser share's level, the greater's, the radius, the direction's node; only where the first is not above the
 * second. */
struct oracle_profile {
  double nodes[LEVELS][LEVELS][RADII][NODES];
  double smooth[STEPS][STEPS][TERMS]; /* for either order of two shares, the polynomial's coefficients */
  double narrowing;
};

/* What the making of it needs: the normal distribution's integral, itself and its density at every 1/32. */
typedef struct workshop {
  const oracle_view *view;
  double integral[NORMALS], distribution[NORMALS], density[NORMALS];
  double end, blur, reach, known[KNOWN + 1]; /* of the kernel, blurred in all directions */
} workshop;

static int is_flat(const oracle_view *view) {
  return conic_oracle_kernel_facts(&view->kernel).is_flat;
}

static double level_share(int level) {
  double s = ((double)(1 << level) - 1.0) / 131072.0;
  return 4.0 * s / (1.0 + 3.0 * s);
}

static double bend_of(const oracle_view *view, const double share[2]) {
  return is_flat(view) ? sqrt((share[0] + 0.002) / (share[1] + 0.002)) : 1.0;
}

/* By the series of the distribution's odd part. */
static void tabulate_normal(workshop *w) {
  for (int i = 0; i < NORMALS; i++) {
    double z = i / 32.0, term = z, sum = z;
    w->density[i] = conic_oracle_exp(-0.5 * z * z) / sqrt(2.0 * 3.14159265358979323846);
    for (int n = 3; n < 300; n += 2) {
      term *= z * z / n;
      sum += term;
    }
    w->distribution[i] = 0.5 + w->density[i] * sum;
    w->integral[i] = z * w->distribution[i] + w->density[i];
  }
}

static double integrate_normal(const workshop *w, double z) {
  if (z < 0.0)
    return integrate_normal(w, -z) + z;
  if (z >= 7.0)
    return z;
  int i = (int)(z * 32.0 + 0.5);
  double at = i / 32.0, d = z - at, phi = w->density[i];
  return w->integral[i] +
         d * (w->distribution[i] + d * (phi / 2.0 + d * (-at * phi / 6.0 + d * (at * at - 1.0) * phi / 24.0)));
}

/* The mean, over half widths from a to b, of boxes about 0 as a Gaussian at y sees them. */
static double mean_box(const workshop *w, double a, double b, double y, double blur) {
  double sum = integrate_normal(w, (b + y) / blur) - integrate_normal(w, (a + y) / blur) +
               integrate_normal(w, (b - y) / blur) - integrate_normal(w, (a - y) / blur);
  return sum * blur / (b - a) - 1.0;
}

static double blur_even(const workshop *w, const double *places, const double *values, double y, double blur) {
  double hair = 1e-6 * blur;
  double sum = values[PARTS] * mean_box(w, places[PARTS], places[PARTS] + hair, y, blur);
  for (int i = 0; i < PARTS; i++)
    if (places[i] < places[i + 1])
      sum += (values[i] - values[i + 1]) * mean_box(w, places[i], places[i + 1], y, blur);
  return sum;
}

static double round_kernel(const workshop *w, double r) {
  if (w->blur == 0.0 && is_flat(w->view))
    return 1.0;
  if (w->blur == 0.0)
    return conic_oracle_kernel(&w->view->kernel, r * r);
  double place = oracle_min(r / w->reach, 1.0) * KNOWN;
  int i = (int)oracle_min(place, KNOWN - 1.0);
  return w->known[i] * (i + 1 - place) + w->known[i + 1] * (place - i);
}

static void cut_exactly(const workshop *w, double x, double *places, double *values) {
  double steep = w->blur > 0.0 ? oracle_max(w->end - 3.0 * w->blur, 0.0) : 0.75 * w->end;
  double first = sqrt(oracle_max(steep * steep - x * x, 0.0)),
         last = sqrt(oracle_max(w->reach * w->reach - x * x, 0.0));
  for (int i = 0; i <= PARTS; i++) {
    const int half = PARTS / 2;
    places[i] = i < half ? first * i / half : first + (last - first) * (i - half) / half;
    values[i] = round_kernel(w, sqrt(x * x + places[i] * places[i]));
  }
}

/* From the plain kernel, which the workshop has. */
static void blur_all_round(workshop *w, double blur) {
  double places[PARTS + 1], values[PARTS + 1], row_places[PARTS + 1], rows[PARTS + 1];
  w->blur = 0.0;
  w->reach = w->end;
  for (int i = 0; i <= PARTS; i++) {
    double rest = 1.0 - (double)i / PARTS;
    row_places[i] = w->end * (1.0 - rest * rest);
    cut_exactly(w, row_places[i], places, values);
    rows[i] = i < PARTS ? blur_even(w, places, values, 0.0, blur) : 0.0;
  }
  w->blur = blur;
  w->reach = w->end + 5.0 * blur;
  for (int i = 0; i <= KNOWN; i++)
    w->known[i] = blur_even(w, row_places, rows, w->reach * i / KNOWN, blur);
}

/* The convolution at q over a Gaussian's peak. `across` is the share of q that lies across the splat. */
static double convolve(const workshop *w, const double share[2], double q, double across) {
  double x = sqrt(q * (1.0 - across) / (1.0 - share[0])), y = sqrt(q * across / (1.0 - share[1]));
  double more = share[1] / (1.0 - share[1]) - share[0] / (1.0 - share[0]), places[PARTS + 1], values[PARTS + 1];
  double peak = sqrt(1.0 - share[0]) * sqrt(1.0 - share[1]);
  if (share[0] == share[1])
    return round_kernel(w, sqrt(x * x + y * y)) / peak;
  cut_exactly(w, x, places, values);
  return blur_even(w, places, values, y, sqrt(more)) / peak;
}

static double node(const workshop *w, const double share[2], double narrowing, double radius, double direction) {
  double support = w->view->support, bend = bend_of(w->view, share);
  double q = is_flat(w->view) ? support * (1.0 - radius * radius) : support * radius * radius;
  double across = direction * bend / (direction * bend + (1.0 - direction));
  return convolve(w, share, q, across) * sqrt((1.0 + narrowing * share[0]) * (1.0 + narrowing * share[1]));
}

/* The q over the support that it is fitted at. */
static double smooth_place(int i) {
  double part = i / (PLACES - 1.0);
  return part * part * (3.0 - 2.0 * part);
}

/* The terms of the smooth polynomial: to the powers 0 to 3 of `across` 7, 4, 3 and 2 powers of q. Both are over the
 * support. */
static void smooth_terms(double q, double across, double terms[TERMS]) {
  static const int n_powers[] = {7, 4, 3, 2};
  double factor = 1.0;
  for (int j = 0, at = 0; j < 4; j++, factor *= across) {
    double power = factor;
    for (int i = 0; i < n_powers[j]; i++, power *= 2.0 * q - 1.0)
      terms[at++] = power;
  }
}

/* Solves the normal equations by elimination. */
static void solve_normal(double matrix[TERMS][TERMS], double right[TERMS]) {
  for (int pivot = 0; pivot < TERMS; pivot++)
    for (int row = pivot + 1; row < TERMS; row++) {
      double factor = matrix[row][pivot] / matrix[pivot][pivot];
      for (int column = pivot; column < TERMS; column++)
        matrix[row][column] -= factor * matrix[pivot][column];
      right[row] -= factor * right[pivot];
    }
  for (int row = TERMS - 1; row >= 0; row--) {
    for (int column = row + 1; column < TERMS; column++)
      right[row] -= matrix[row][column] * right[column];
    right[row] /= matrix[row][row];
  }
}

/* By least squares over nine q and the directions of the nodes; of turned ones, the shares change places. */
static void fit_smooth(const double values[PLACES][NODES], int is_turned, double coefficients[TERMS]) {
  double matrix[TERMS][TERMS] = {{0.0}}, terms[TERMS];
  for (int i = 0; i < TERMS; i++)
    coefficients[i] = 0.0;
  for (int i = 0; i < PLACES * NODES; i++) {
    int place = i / NODES, direction = i % NODES;
    smooth_terms(smooth_place(place), smooth_place(place) * node_directions[direction], terms);
    for (int row = 0; row < TERMS; row++) {
      coefficients[row] += terms[row] * values[place][is_turned ? NODES - 1 - direction : direction];
      for (int column = 0; column < TERMS; column++)
        matrix[row][column] += terms[row] * terms[column];
    }
  }
  solve_normal(matrix, coefficients);
}

static void make_smooth(workshop *w, struct oracle_profile *profile) {
  const double nearly_all = 1.0 - 1.0 / 65536.0;
  double values[PLACES][NODES];
  for (int low = 0; low < STEPS; low++)
    for (int high = low; high < STEPS; high++) {
      const double share[2] = {oracle_min((low + 1.0) / STEPS, nearly_all),
                               oracle_min((high + 1.0) / STEPS, nearly_all)};
      if (high == low)
        blur_all_round(w, sqrt(share[0] / (1.0 - share[0])));
      for (int i = 0; i < PLACES; i++)
        for (int j = 0; j < NODES; j++)
          values[i][j] = convolve(w, share, smooth_place(i) * w->view->support, node_directions[j]);
      fit_smooth((const double(*)[NODES])values, 0, profile->smooth[low][high]);
      fit_smooth((const double(*)[NODES])values, 1, profile->smooth[high][low]);
    }
}

static double narrowing_of(const workshop *w) {
  double integral = 0.0;
  for (int i = 0; i < 1024; i++) {
    double r = w->end * (i + 0.5) / 1024.0;
    integral += (is_flat(w->view) ? 1.0 : conic_oracle_kernel(&w->view->kernel, r * r)) * r;
  }
  return 1.0 / (integral * w->end / 1024.0) - 1.0;
}

conic_status conic_oracle_profile_create(conic_context *context, oracle_view *view) {
  const conic_kernel *kernel = &view->kernel;
  view->profile = NULL;
  if (conic_oracle_kernel_facts(kernel).is_gaussian || !(view->prefilter > 0.0) || view->method == CONIC_METHOD_DISC ||
      view->method == CONIC_METHOD_POINT)
    return CONIC_OK;
  struct oracle_profile *profile = conic_memory_allocate(context, 1, sizeof *profile);
  if (!profile)
    return CONIC_ERROR_MEMORY;
  workshop w = {.view = view, .end = oracle_min(conic_oracle_kernel_facts(kernel).end, 4.0 * view->cutoff)};
  tabulate_normal(&w);
  w.reach = w.end;
  profile->narrowing = narrowing_of(&w);
  for (int low = 0; low < LEVELS; low++) {
    if (low > 0)
      blur_all_round(&w, sqrt(level_share(low) / (1.0 - level_share(low))));
    for (int high = low; high < LEVELS; high++)
      for (int i = 0; i < RADII * NODES; i++) {
        const double share[2] = {level_share(low), level_share(high)};
        const int radius = i / NODES;
        profile->nodes[low][high][radius][i % NODES] =
            node(&w, share, profile->narrowing, radius / (RADII - 1.0), node_directions[i % NODES]);
      }
  }
  make_smooth(&w, profile);
  view->profile = profile;
  return CONIC_OK;
}

void conic_oracle_profile_release(conic_context *context, oracle_view *view) {
  conic_memory_release(context, (void *)view->profile);
  view->profile = NULL;
}

/* Lagrange's polynomial through the nodes of one radius, for any order of the levels. */
static double along_direction(const struct oracle_profile *p, int first, int second, int i_radius, double direction) {
  double sum = 0.0;
  for (int i = 0; i < NODES; i++) {
    double factor =
        first <= second ? p->nodes[first][second][i_radius][i] : p->nodes[second][first][i_radius][NODES - 1 - i];
    for (int j = 0; j < NODES; j++)
      if (j != i)
        factor *= (direction - node_directions[j]) / (node_directions[i] - node_directions[j]);
    sum += factor;
  }
  return sum;
}

double conic_oracle_direction(const oracle_view *view, const double share[2], double n, double m, double round) {
  double d = n + bend_of(view, share) * m + share[1] / 4096.0 * round;
  return d > 0.0 ? oracle_min(oracle_max(n / d, 0.0), 1.0) : 0.0;
}

static double smooth_response(const oracle_view *view, const double share[2], double across, double q) {
  double terms[TERMS], sum = 0.0, part[2];
  int level[2];
  smooth_terms(q / view->support, oracle_min(across, q) / view->support, terms);
  for (int i = 0; i < 2; i++) {
    double place = oracle_max(oracle_min(share[i], 1.0) * STEPS - 1.0, 0.0);
    level[i] = (int)oracle_min(place, STEPS - 2.0);
    part[i] = place - level[i];
  }
  for (int corner = 0; corner < 4; corner++) {
    int a = corner & 1, b = corner >> 1;
    double factor = (a ? part[0] : 1.0 - part[0]) * (b ? part[1] : 1.0 - part[1]);
    for (int i = 0; i < TERMS; i++)
      sum += factor * view->profile->smooth[level[0] + a][level[1] + b][i] * terms[i];
  }
  return sum;
}

static double steep_response(const oracle_view *view, const double share[2], double direction, double q) {
  const struct oracle_profile *p = view->profile;
  double part = oracle_min(oracle_max(q / view->support, 0.0), 1.0), level_part[2], sum = 0.0, peak = 1.0;
  double place = (RADII - 1) * sqrt(is_flat(view) ? 1.0 - part : part);
  int i_radius = (int)oracle_min(place, RADII - 2.0), level[2];
  for (int i = 0; i < 2; i++) {
    double s = 1.0 + 131072.0 * share[i] / (4.0 - 3.0 * share[i]);
    for (level[i] = 0; level[i] < LEVELS - 2 && s >= (double)(2 << level[i]); level[i]++)
      ;
    level_part[i] = s / (double)(1 << level[i]) - 1.0;
    peak *= 1.0 + p->narrowing * share[i];
  }
  for (int corner = 0; corner < 8; corner++) {
    int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
    double factor = (a ? level_part[0] : 1.0 - level_part[0]) * (b ? level_part[1] : 1.0 - level_part[1]) *
                    (c ? place - i_radius : 1.0 - (place - i_radius));
    sum += factor * along_direction(p, level[0] + a, level[1] + b, i_radius + c, direction);
  }
  return sum / sqrt(peak);
}

double conic_oracle_response(const oracle_view *view, const double share[2], double direction, double across, double q,
                             double *doubt) {
  const double place = share[0] * STEPS;
  if (doubt)
    *doubt = 0.0;
  if (!view->profile)
    return conic_oracle_kernel(&view->kernel, q);
  if (doubt && fabs(place - 1.0) < 1e-5)
    *doubt = fabs(smooth_response(view, share, across, q) - steep_response(view, share, direction, q));
  return place >= 1.0 ? smooth_response(view, share, across, q) : steep_response(view, share, direction, q);
}
