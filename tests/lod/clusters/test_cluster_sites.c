/* What surfels are put on: sites by nearness, at several spacings at once, and ellipses that are nearly the smallest.
 */
#include "core/splats/ellipse.h"
#include "lod/clusters/cluster_sites.h"
#include "tests/support/hybrid_fixture.h"
#include "tests/support/random_numbers.h"

static double random_between(uint64_t *state, double low, double high) {
  return low + (high - low) * random_unit(state);
}

/* --- sites --- */

typedef struct spread_site {
  double at[3], facing[3];
  size_t first; /* of the places for which it is put */
} spread_site;

/* By asking every site that is put for a place of that number. */
static uint32_t nearest_of_all(const spread_site *sites, size_t n, const spread_site *place, size_t number,
                               double spacing) {
  double least = spacing * spacing;
  uint32_t found = CONIC_NO_SITE;
  for (size_t i = 0; i < n; i++) {
    if (number < sites[i].first)
      continue;
    double square = 0.0, cosine = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      double d = place->at[axis] - sites[i].at[axis];
      square += d * d;
      cosine += place->facing[axis] * sites[i].facing[axis];
    }
    if (square < least && cosine > 0.7) {
      least = square;
      found = (uint32_t)i;
    }
  }
  return found;
}

static spread_site random_site(uint64_t *state) {
  spread_site site = {.first = 0};
  double length2 = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    site.at[axis] = random_between(state, -1.0, 1.0) * (axis == 2 ? 0.1 : 1.0);
    site.facing[axis] = random_between(state, -1.0, 1.0) + (axis == 2 ? 2.0 : 0.0);
    length2 += site.facing[axis] * site.facing[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    site.facing[axis] /= sqrt(length2);
  return site;
}

enum { SITES = 3000, GROUPS = 500, A_GROUP = 4, PLACES = GROUPS * A_GROUP };

/* Places in groups that face alike, each but the first of a group anywhere. */
typedef struct spread_places {
  double at[PLACES][3], facing[GROUPS][3];
  uint32_t group[PLACES], owner[PLACES];
  uint8_t depth[GROUPS];
  conic_places places;
} spread_places;

static void spread_randomly(spread_places *p, uint64_t *state, int coarsest, int finest) {
  for (uint32_t i = 0; i < PLACES; i++) {
    spread_site place = random_site(state);
    p->group[i] = i / A_GROUP;
    memcpy(p->at[i], place.at, sizeof place.at);
    memcpy(p->facing[p->group[i]], place.facing, sizeof place.facing);
    p->depth[p->group[i]] = (uint8_t)(coarsest + (int)p->group[i] % (finest - coarsest + 1));
  }
  p->places = (conic_places){.n = PLACES,
                             .at = (const double(*)[3])p->at,
                             .group = p->group,
                             .facing = (const double(*)[3])p->facing,
                             .depth = p->depth,
                             .spacing = 0.17,
                             .coarsest = coarsest,
                             .finest = finest};
}

static void check_nearest(conic_context *context, int coarsest, int finest) {
  static spread_site sites[SITES];
  static spread_places p;
  conic_place_table table = {0};
  uint64_t state = 7;
  long n_found = 0;
  for (int time = 0; time < 2; time++) { /* the second in memory that was used */
    spread_randomly(&p, &state, coarsest, finest);
    CHECK_OK(conic_place_table_fill(context, &table, &p.places, p.owner));
    for (uint32_t i = 0; i < SITES; i++) {
      sites[i] = random_site(&state);
      sites[i].first = i % 3 == 2 ? i % PLACES : 0;
      if (i % 5 == 0) /* where a place is; and twice, of which the first counts */
        memcpy(sites[i].at, i % 10 ? sites[i - 5].at : p.at[i % PLACES], sizeof sites[i].at);
      conic_place_table_put(&table, i, sites[i].at, sites[i].facing, sites[i].first);
    }
    for (uint32_t i = 0; i < PLACES; i++) {
      spread_site place = {.first = 0};
      memcpy(place.at, p.at[i], sizeof place.at);
      memcpy(place.facing, p.facing[p.group[i]], sizeof place.facing);
      double spacing = p.places.spacing / (double)(1 << p.depth[p.group[i]]);
      CHECK(p.owner[i] == nearest_of_all(sites, SITES, &place, i, spacing));
      n_found += p.owner[i] != CONIC_NO_SITE;
    }
  }
  CHECK(n_found > PLACES / 8 && (finest == 0 || n_found < 2 * PLACES));
  conic_place_table_release(context, &table);
}

/* --- ellipses --- */

/* The area, over π, of the ellipse of that shape about the points. */
static double area_about(const double (*points)[2], int n, const double center[2], const double covariance[3]) {
  conic_ellipse ellipse = conic_ellipse_shape(covariance, 1e-3);
  for (int i = 0; i < n; i++)
    conic_ellipse_cover(&ellipse, points[i][0] - center[0], points[i][1] - center[1]);
  return ellipse.reach * ellipse.reach * ellipse.ratio;
}

/* The eight corners of a stretched, turned and moved octagon lie on their smallest ellipse. */
static void check_octagon(double ratio, double turn) {
  double points[8][2], center[2], covariance[3];
  for (int i = 0; i < 8; i++) {
    double x = cos(0.785398163397448 * i), y = ratio * sin(0.785398163397448 * i);
    points[i][0] = 3.0 + cos(turn) * x - sin(turn) * y;
    points[i][1] = -2.0 + sin(turn) * x + cos(turn) * y;
  }
  conic_least_ellipse((const double(*)[2])points, 8, center, covariance);
  CHECK_NEAR(center[0], 3.0, 1e-9);
  CHECK_NEAR(center[1], -2.0, 1e-9);
  CHECK_NEAR(area_about((const double(*)[2])points, 8, center, covariance), ratio, 1e-6);
}

/* No other ellipse about random points is much smaller: their triangle alone needs 4π/(3√3) times its area. */
static void check_random(void) {
  uint64_t state = 11;
  double sum = 0.0;
  for (int time = 0; time < 500; time++) {
    double points[3][2], center[2], covariance[3];
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 2; k++)
        points[i][k] = random_between(&state, -1.0, 1.0);
    double area = 0.5 * fabs((points[1][0] - points[0][0]) * (points[2][1] - points[0][1]) -
                             (points[2][0] - points[0][0]) * (points[1][1] - points[0][1]));
    double least = area * 4.0 / (3.0 * sqrt(3.0));
    if (area < 0.05)
      continue;
    conic_least_ellipse((const double(*)[2])points, 3, center, covariance);
    CHECK_NEAR(area_about((const double(*)[2])points, 3, center, covariance) / least, 1.0, 1e-6);
    sum += area;
  }
  CHECK(sum > 10.0);
}

/* Points within weigh nothing in the end, wherever they are: the smallest about a rectangle's corners has the area
 * π·width·height/2. */
static void check_inside(void) {
  uint64_t state = 5;
  for (int time = 0; time < 100; time++) {
    double points[8][2] = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.0, 1.0}}, center[2], covariance[3];
    for (int i = 4; i < 8; i++)
      for (int k = 0; k < 2; k++)
        points[i][k] = random_between(&state, 0.6, 1.0) * (k ? 1.0 : 2.0);
    conic_least_ellipse((const double(*)[2])points, 8, center, covariance);
    double share = area_about((const double(*)[2])points, 8, center, covariance);
    CHECK(share >= 1.0 - 1e-9 && share < 1.1);
  }
}

/* One place, and places in a line, have a middle and no area. */
static void check_flat(void) {
  const double line[4][2] = {{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}, {4.0, 4.0}}, place[2][2] = {{5.0, 6.0}, {5.0, 6.0}};
  double center[2], covariance[3];
  conic_least_ellipse(line, 4, center, covariance);
  CHECK(center[0] > 0.0 && center[0] < 4.0 && center[0] == center[1]);
  CHECK_NEAR(covariance[0], covariance[1], 1e-12);
  conic_least_ellipse(place, 2, center, covariance);
  CHECK(center[0] == 5.0 && center[1] == 6.0 && covariance[0] == 0.0 && covariance[2] == 0.0);
}

/* --- colours --- */

/* A flat sheet of 24 × 24 squares, all of it surfels; one half may be black, the other white. */
static conic_hybrid_level finest_of_sheet(conic_context *context, int has_colors) {
  const size_t side = 24;
  conic_triangles mesh;
  conic_hybrid_options options;
  conic_hybrid *hybrid;
  conic_hybrid_level found = {0};
  CHECK_OK(conic_triangles_allocate(context, 2 * side * side, (side + 1) * (side + 1),
                                    has_colors ? CONIC_TRIANGLES_COLORS : 0, &mesh));
  for (size_t y = 0; y <= side; y++)
    for (size_t x = 0; x <= side; x++) {
      size_t i = y * (side + 1) + x;
      for (int axis = 0; axis < 3; axis++) {
        mesh.position[axis][i] = axis == 0 ? (float)x : axis == 1 ? (float)y : 0.0f;
        if (has_colors)
          mesh.color[axis][i] = 2 * x < side ? 0.0f : 1.0f;
      }
    }
  for (size_t y = 0; y < side; y++)
    for (size_t x = 0; x < side; x++) {
      uint32_t i = (uint32_t)(y * (side + 1) + x), above = i + (uint32_t)side + 1;
      const uint32_t both[2][3] = {{i, i + 1, above}, {i + 1, above + 1, above}};
      memcpy(mesh.corners + 2 * (y * side + x), both, sizeof both);
    }
  conic_hybrid_options_init(&options);
  options.phase2 = 1e6;
  options.most_error = 0.0; /* they may stand out at the border */
  CHECK_OK(conic_hybrid_build(context, &mesh, &options, &hybrid, NULL));
  CHECK(hybrid->n_clusters == 1 && hybrid->clusters[0].built > 0);
  if (hybrid->n_clusters == 1)
    found = hybrid->levels[hybrid->clusters[0].first_level + hybrid->clusters[0].built];
  CHECK(found.kind == CONIC_HYBRID_SURFELS);
  conic_hybrid_destroy(hybrid);
  return found;
}

/* Nothing on a flat sheet is off its place but colours that are smeared; there surfels lie closer. The mean edge is
 * 1.14, half of it lies between surfels, and half of that is the most error. */
static void check_colors(conic_context *context) {
  conic_hybrid_level plain = finest_of_sheet(context, 0), colored = finest_of_sheet(context, 1);
  CHECK(plain.error > 0.0f && plain.error <= 0.2846f); /* at its border */
  CHECK(colored.error >= plain.error && colored.error <= 0.2846f);
  CHECK(colored.count > plain.count && colored.count < 2 * plain.count);
}

int main(void) {
  conic_context *context = check_context(1);
  check_nearest(context, 0, 0);
  check_nearest(context, 0, CONIC_MOST_DEPTH);
  check_nearest(context, 1, 2);
  for (int i = 0; i < 12; i++)
    check_octagon(0.25 + 0.06 * i, 0.5 * i);
  check_random();
  check_inside();
  check_colors(context);
  check_flat();
  conic_context_destroy(context);
  return check_result();
}
