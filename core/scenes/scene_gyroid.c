#include "core/base/trigonometry.h"
#include "core/scenes/scene_kind.h"

/* sin x cos y + sin y cos z + sin z cos x = 0, with so many periods along an edge of the cube that its picture has more
 * than 20 sheets behind each other, on average over the pixels. */
enum { PERIODS = 22 };
#define WAVE_NUMBER (PERIODS * CONIC_PI) /* a period is 2 / PERIODS wide */

/* The area in a cube of one period, over the period squared. */
#define AREA_OF_PERIOD 3.0915

/* With fewer cells, the lattice's layer would reach from one sheet to the next. */
enum { MIN_CELLS = 4 * PERIODS };

/* Cells along the edge of the tiles that a slab is walked in, so that sines are computed once an edge, not once a
 * cell. */
enum { TILE = 512 };

/* From the middle of the cube outwards: ember, apricot, sand, sage, deep blue. */
static const uint8_t palette[][3] = {
    {0xb8, 0x32, 0x2a}, {0xee, 0x96, 0x4b}, {0xf4, 0xe0, 0xb0}, {0x5f, 0x9e, 0x8f}, {0x1d, 0x3f, 0x72}};

static conic_status prepare_gyroid(conic_scene *scene) {
  uint64_t count = scene->options.count;
  scene->area = AREA_OF_PERIOD * 8.0 / (2.0 / PERIODS); /* the cube's volume over the period, times the constant */
  return conic_lattice_fit(scene->context, scene->kind->walk, NULL, scene->area, count, MIN_CELLS, &scene->lattice);
}

/* Sines and cosines at cells' centres along an axis. */
typedef struct waves {
  int n;
  double sines[TILE], cosines[TILE];
} waves;

static void fill_waves(const conic_lattice *lattice, size_t first, waves *w) {
  w->n = lattice->n_cells - first < TILE ? (int)(lattice->n_cells - first) : TILE;
  for (int i = 0; i < w->n; i++) {
    double phase = WAVE_NUMBER * conic_lattice_coordinate(lattice, first + (size_t)i);
    w->sines[i] = conic_sin(phase);
    w->cosines[i] = conic_cos(phase);
  }
}

/* Tests a row along x: a cell is nearer than half a spacing if |f| < |∇f|·spacing/2; both sides are squared. */
static void test_row(const waves *x, double sy, double cy, double sz, double cz, double bound, unsigned char *is_near) {
  double sy_cz = sy * cz, cy_cz = cy * cz, sy_sz = sy * sz;
  for (int i = 0; i < x->n; i++) {
    double sx = x->sines[i], cx = x->cosines[i];
    double f = sx * cy + sy_cz + sz * cx;
    double dx = cx * cy - sz * sx, dy = cy_cz - sx * sy, dz = cz * cx - sy_sz;
    is_near[i] = f * f < (dx * dx + dy * dy + dz * dz) * bound;
  }
}

static void walk_tile(const conic_lattice *lattice, const size_t first[3], const waves *x, double sz, double cz,
                      conic_lattice_visit *visit, void *cookie) {
  double half = 0.5 * lattice->spacing * WAVE_NUMBER, point[3];
  unsigned char is_near[TILE];
  waves y;
  fill_waves(lattice, first[1], &y);
  point[2] = conic_lattice_coordinate(lattice, first[2]);
  for (int row = 0; row < y.n; row++) {
    test_row(x, y.sines[row], y.cosines[row], sz, cz, half * half, is_near);
    point[1] = conic_lattice_coordinate(lattice, first[1] + (size_t)row);
    for (int i = 0; i < x->n; i++) {
      if (!is_near[i])
        continue;
      point[0] = conic_lattice_coordinate(lattice, first[0] + (size_t)i);
      visit(cookie, point);
    }
  }
}

static void walk(const void *surface, const conic_lattice *lattice, size_t i_slab, conic_lattice_visit *visit,
                 void *cookie) {
  double phase = WAVE_NUMBER * conic_lattice_coordinate(lattice, i_slab);
  double sz = conic_sin(phase), cz = conic_cos(phase);
  size_t first[3] = {0, 0, i_slab};
  waves x;
  (void)surface;
  for (first[0] = 0; first[0] < lattice->n_cells; first[0] += TILE) {
    fill_waves(lattice, first[0], &x);
    for (first[1] = 0; first[1] < lattice->n_cells; first[1] += TILE)
      walk_tile(lattice, first, &x, sz, cz, visit, cookie);
  }
}

/* f and its gradient at a place in phases. */
static double evaluate_gyroid(const double phase[3], double gradient[3]) {
  double sx = conic_sin(phase[0]), cx = conic_cos(phase[0]);
  double sy = conic_sin(phase[1]), cy = conic_cos(phase[1]);
  double sz = conic_sin(phase[2]), cz = conic_cos(phase[2]);
  gradient[0] = cx * cy - sz * sx;
  gradient[1] = cy * cz - sx * sy;
  gradient[2] = cz * cx - sy * sz;
  return sx * cy + sy * cz + sz * cx;
}

/* Newton's iteration along the gradient, from less than a radian away. */
static void project_on_gyroid(const void *surface, const double start[3], conic_scene_point *point) {
  double phase[3], gradient[3], squared = 1.0;
  (void)surface;
  for (int axis = 0; axis < 3; axis++)
    phase[axis] = WAVE_NUMBER * start[axis];
  for (int i = 0; i < 8; i++) {
    double f = evaluate_gyroid(phase, gradient);
    squared = gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2];
    if (fabs(f) < 1e-9)
      break;
    for (int axis = 0; axis < 3; axis++)
      phase[axis] -= f / squared * gradient[axis];
  }
  double length = sqrt(squared), from_middle = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    point->position[axis] = phase[axis] / WAVE_NUMBER;
    point->normal[axis] = gradient[axis] / length;
    from_middle += point->position[axis] * point->position[axis];
  }
  conic_scene_blend(palette, (int)(sizeof palette / sizeof *palette), sqrt(from_middle) / 1.5, point->color);
}

const conic_scene_kind conic_scene_gyroid = {.name = "gyroid",
                                             .summary = "an iso-surface in a cube, over 20 sheets deep; from 4M on",
                                             .prepare = prepare_gyroid,
                                             .walk = walk,
                                             .project = project_on_gyroid};
