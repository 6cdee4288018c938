/* The sums over a point's neighbours: of a few and of many, by every weight and degree. */
#include "bench/loops/cross.h"
#include "tests/support/bent_sheet.h"

typedef struct surface_desk {
  cross_desk memory;
  conic_near near;
  conic_weighing weighing;
  int degree;
  double *moments, *plane, *sphere;
  uint32_t *selected;
  double *scales, *chosen; /* chosen: offsets, masses, inverse squares */
  size_t *n_chosen;
  double (*upper)[CONIC_MAX_COLUMNS], *norms2, *before2;
} surface_desk;

static const double q[3] = {0.05, -0.1, 0.2};

static surface_desk *open_sums(size_t n, int weight, double neglect, int degree, uint64_t seed) {
  surface_desk *d = cross_calloc(sizeof *d);
  size_t bytes = (n + 7) / 8 * 8 * sizeof(double);
  for (int axis = 0; axis < 3; axis++) {
    d->near.offset[axis] = cross_room(&d->memory, "offsets", bytes);
    d->near.normal[axis] = cross_room(&d->memory, "normals", bytes);
  }
  d->near.mass = cross_room(&d->memory, "masses", bytes);
  d->near.inverse_h2 = cross_room(&d->memory, "widths", bytes);
  d->near.weights = cross_room(&d->memory, "weights", bytes);
  d->near.columns = cross_room(&d->memory, "columns", bytes * CONIC_MAX_COLUMNS);
  d->moments = cross_room(&d->memory, "moments", CONIC_N_MOMENTS * sizeof *d->moments);
  d->plane = cross_room(&d->memory, "plane", CONIC_N_PLANE_SUMS * sizeof *d->plane);
  d->sphere = cross_room(&d->memory, "sphere", CONIC_N_SPHERE_SUMS * sizeof *d->sphere);
  d->upper = cross_room(&d->memory, "upper", CONIC_MAX_COLUMNS * sizeof *d->upper);
  d->norms2 = cross_room(&d->memory, "norms", CONIC_MAX_COLUMNS * sizeof *d->norms2);
  d->before2 = cross_room(&d->memory, "norms before", CONIC_MAX_COLUMNS * sizeof *d->before2);
  d->chosen = cross_room(&d->memory, "chosen", 5 * (bytes + 64));
  d->selected = cross_room(&d->memory, "chosen sources", bytes / 2 + 32);
  d->n_chosen = cross_room(&d->memory, "counts", sizeof *d->n_chosen);
  d->weighing = bent_sheet_weighing((conic_surface_weight)weight, neglect);
  d->degree = degree;
  bent_sheet_fill(&d->near, n, seed);
  d->near.sources = cross_room(&d->memory, "sources", bytes / 2);
  d->scales = cross_room(&d->memory, "scales", bytes);
  for (size_t i = 0; i < d->near.n_padded; i++) {
    d->near.sources[i] = (uint32_t)(7 * i + 3);
    d->scales[i] = i < n ? d->near.inverse_h2[i] : NAN;
  }
  return d;
}

CROSS_RUN(run_moments, surface_desk, tables->surface.moments(&d->near, &d->weighing, q, d->moments))
CROSS_RUN(run_plane, surface_desk, tables->surface.plane(&d->near, &d->weighing, bent_sheet_frame, 0.15, d->plane))
CROSS_RUN(run_factor, surface_desk,
          tables->surface.factor(&d->near, bent_sheet_frame, 0.15, 0.9, d->degree, d->upper, d->norms2, d->before2))
CROSS_RUN(run_sphere, surface_desk, tables->surface.sphere(&d->near, &d->weighing, q, d->sphere))

/* Of those that are chosen; what lies behind them is anything. */
static void select_near(const surface_desk *d, const cross_tables *tables) {
  conic_near near = {0}, all = d->near;
  size_t room = d->near.n_padded + 8;
  double *columns[5];
  for (size_t i = 0; i < 5; i++)
    columns[i] = d->chosen + i * room;
  for (int axis = 0; axis < 3; axis++)
    near.offset[axis] = columns[axis];
  near.mass = columns[3];
  near.inverse_h2 = columns[4];
  near.sources = d->selected;
  all.inverse_h2 = d->scales;
  tables->surface.select(&all, q, 1.0, 0.3, 7 * 5 + 3, &near);
  *d->n_chosen = near.n;
  for (size_t i = near.n; i < room; i++) {
    for (int k = 0; k < 5; k++)
      columns[k][i] = 0.0;
    d->selected[i] = 0;
  }
}
CROSS_RUN(run_select, surface_desk, select_near(d, tables))

static void try_slots(cross *c, size_t n, int weight, double neglect, int degree, uint64_t seed) {
  surface_desk *desks[CONIC_N_ISAS];
  char variant[32];
  const cross_slot slots[] = {{"surface select", variant, run_select, "candidate", (double)n},
                              {"surface plane", variant, run_plane, "neighbour", (double)n},
                              {"surface sphere", variant, run_sphere, "neighbour", (double)n},
                              {"surface moments", variant, run_moments, "neighbour", (double)n},
                              {"surface factor", variant, run_factor, "neighbour", (double)n}};
  snprintf(variant, sizeof variant, "w %d, d %d, %zu", weight, degree, n);
  for (int i = 0; i < c->n_tables; i++)
    desks[i] = open_sums(n, weight, neglect, degree, seed);
  for (size_t i = 0; i < sizeof slots / sizeof slots[0]; i++)
    cross_try(c, &slots[i], (cross_desk **)(void *)desks);
  for (int i = 0; i < c->n_tables; i++)
    cross_close(&desks[i]->memory);
}

int cli_cross_surface(cross *c) {
  static const size_t counts[] = {1, 7, 8, 9, 26, 93};
  if (c->is_bench)
    try_slots(c, 64, CONIC_WEIGHT_GAUSS, 2.0, 3, c->seed);
  for (int weight = CONIC_WEIGHT_GAUSS; weight <= CONIC_WEIGHT_FLAT && !c->is_bench; weight++)
    for (int degree = 1; degree <= CONIC_SURFACE_MAX_DEGREE; degree++)
      for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        try_slots(c, counts[i], weight, 1.5 + 0.5 * (double)i, degree, c->seed + 11 * i);
  return check_failures;
}
