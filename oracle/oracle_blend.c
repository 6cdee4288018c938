/* The planes of a covered pixel, from the fragments that are visible there. */
#include "oracle/oracle_pixel.h"

static double difference(const double a[3], const double b[3]) {
  double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return oracle_length(d);
}

/* The splat that names the id, the nearest, or the one that gives Z, the heaviest; the first of equals. */
static size_t find_first(const oracle_fragment *f, size_t n, int of_weight) {
  size_t best = n;
  for (size_t i = 0; i < n; i++)
    if (f[i].is_visible && (best == n || (of_weight ? f[i].weight > f[best].weight : f[i].iz > f[best].iz)))
      best = i;
  return best;
}

/* The errors of two splats are independent. */
static double together(double a, double b) {
  return sqrt(a * a + b * b);
}

/* Copies of a splat are equal however they are computed; so are the depths of discs across the line of sight. */
static int are_copies(const oracle_fragment *a, const oracle_fragment *b) {
  const oracle_splat *first = a->candidate->splat, *second = b->candidate->splat;
  const oracle_placed *one = &first->placed, *other = &second->placed;
  for (int axis = 0; axis < 3; axis++)
    if (one->p[axis] != other->p[axis] || one->tu[axis] != other->tu[axis] || one->tv[axis] != other->tv[axis])
      return 0;
  return first->opacity == second->opacity;
}
static int are_level(const oracle_fragment *a, const oracle_fragment *b) {
  const double *first = a->candidate->shape.range, *second = b->candidate->shape.range;
  return first[0] == first[1] && second[0] == second[1] && first[0] == second[0];
}

int conic_oracle_are_as_near(const oracle_fragment *a, const oracle_fragment *b) {
  return are_copies(a, b) || are_level(a, b);
}

int conic_oracle_is_rival(const oracle_fragment *f, const oracle_fragment *nearest) {
  return f != nearest && !conic_oracle_are_as_near(f, nearest) &&
         f->iz + together(f->iz_error, nearest->iz_error) >= nearest->iz;
}

/* What is exactly equal is settled by the order in the file, in any precision; what is nearly so is in doubt. A rival
 * for the id changes nothing else, unless there is one pass only. */
static unsigned doubt_ties(const oracle_fragment *f, size_t n, size_t nearest, size_t heaviest, int passes,
                           int is_exact, oracle_pixel *pixel) {
  unsigned doubt = 0;
  for (size_t i = 0; i < n; i++) {
    if (!f[i].is_visible)
      continue;
    if (conic_oracle_is_rival(&f[i], &f[nearest])) {
      doubt |= passes == 1 ? 1u << CONIC_UNSTABLE_DEPTH_TIE : 0u;
      pixel->has_rivals = 1;
    }
    double weight_error = is_exact ? 0.0 : together(f[i].weight_error, f[heaviest].weight_error);
    if (passes != 1 && i != heaviest && !are_copies(&f[i], &f[heaviest]) &&
        !(weight_error == 0.0 && f[i].weight == f[heaviest].weight) &&
        f[i].weight + weight_error >= f[heaviest].weight &&
        fabs(f[i].z - f[heaviest].z) > 0.5 * ORACLE_Z_BOUND * f[heaviest].z)
      doubt |= 1u << CONIC_UNSTABLE_WEIGHT_TIE;
  }
  return doubt;
}

/* The rounding of one splat knows nothing of another's: their shares add as independent errors do. */
static unsigned doubt_precision(const oracle_fragment *f, size_t n, const oracle_pixel *pixel,
                                const oracle_fragment *heaviest) {
  double color = 0.0, normal = 0.0, weight = 0.0, shortness = oracle_length(pixel->mean_normal);
  unsigned doubt = 0;
  for (size_t i = 0; i < n; i++) {
    const oracle_splat *splat = f[i].candidate->splat;
    if (!f[i].is_visible)
      continue;
    double share = f[i].weight_spread / pixel->weight;
    double color_step = share * difference(splat->color, pixel->albedo);
    double normal_step = share * difference(splat->normal, pixel->mean_normal);
    color += color_step * color_step;
    normal += normal_step * normal_step;
    weight += f[i].weight_spread * f[i].weight_spread;
    if (splat->is_facing_unsure && 2.0 * f[i].weight > ORACLE_NORMAL_BOUND * shortness * pixel->weight)
      doubt |= 1u << CONIC_UNSTABLE_FACING;
  }
  double brightness = oracle_max(1.0, oracle_length(pixel->albedo));
  if (!(sqrt(color) < ORACLE_COLOR_BOUND * brightness) || !(sqrt(normal) < ORACLE_NORMAL_BOUND * shortness) ||
      !(sqrt(weight) < ORACLE_WEIGHT_BOUND * oracle_max(1.0, pixel->weight)) ||
      !(heaviest->z_error < ORACLE_Z_BOUND * heaviest->z))
    doubt |= 1u << CONIC_UNSTABLE_PRECISION;
  return doubt;
}

static void add_fragment(const oracle_fragment *f, oracle_pixel *pixel) {
  for (int c = 0; c < 3; c++) {
    pixel->albedo[c] += f->weight * f->candidate->splat->color[c];
    pixel->mean_normal[c] += f->weight * f->candidate->splat->normal[c];
  }
  pixel->weight += f->weight;
  pixel->count++;
}

void conic_oracle_blend(const oracle_fragment *f, size_t n, int passes, int is_exact, oracle_pixel *pixel) {
  /* Of one pass, the nearest is all there is. */
  size_t nearest = find_first(f, n, 0), heaviest = passes == 1 ? nearest : find_first(f, n, 1);
  memset(pixel, 0, sizeof *pixel);
  if (passes == 1)
    add_fragment(&f[nearest], pixel);
  else
    for (size_t i = 0; i < n; i++)
      if (f[i].is_visible)
        add_fragment(&f[i], pixel);
  for (int c = 0; c < 3; c++) {
    pixel->albedo[c] /= pixel->weight;
    pixel->mean_normal[c] /= pixel->weight;
  }
  double length = oracle_length(pixel->mean_normal);
  const double *spare = f[heaviest].candidate->splat->normal;
  for (int c = 0; c < 3; c++)
    pixel->normal[c] = length > 0.0 ? pixel->mean_normal[c] / length : spare[c];
  pixel->z = f[heaviest].z;
  pixel->id = f[nearest].candidate->splat->index;
  pixel->doubt = doubt_ties(f, n, nearest, heaviest, passes, is_exact, pixel);
  if (!is_exact) {
    if (passes == 1)
      pixel->doubt |= doubt_precision(&f[nearest], 1, pixel, &f[heaviest]);
    else
      pixel->doubt |= doubt_precision(f, n, pixel, &f[heaviest]);
  }
}
