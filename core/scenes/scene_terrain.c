#include "core/scenes/scene_terrain.h"

#include "core/base/random.h"
#include "core/base/real.h"
#include "core/scenes/noise.h"
#include "core/scenes/scene_kind.h"

/* Octaves of noise, each twice as fine as the one before; the finest cells are 1/700 wide. */
enum { OCTAVES = 10 };

#define FIRST_FREQUENCY 1.37 /* noise cells per unit */
#define RELIEF 0.95          /* height of the first octave */
#define PERSISTENCE 0.48     /* height of an octave relative to the one before */
#define EROSION 1.2          /* how strongly steep ground suppresses finer octaves */
#define UPLIFT 0.24          /* lifts the island's middle */
#define SEA_FLOOR 0.10       /* depth of the ground along the border */

/* The sum of the octaves, and its gradient. Where the octaves so far are steep, finer ones count less: as if rain had
 * smoothed the slopes and left valleys and ridges rough. */
static void mountains(uint64_t seed, double x, double z, double *height, double slope[2], double *ruggedness) {
  /* Noise coordinates are (a·x + b·z, −b·x + a·z): turned by the 3-4-5 angle and doubled with each octave. */
  double a = FIRST_FREQUENCY, b = 0.0, amplitude = RELIEF;
  conic_jet steep = {0}; /* gradient: the octaves' slopes so far, each in its own scale; xx, xy, yy: its derivatives */
  *height = slope[0] = slope[1] = 0.0;
  for (int octave = 0; octave < OCTAVES; octave++) {
    conic_jet n;
    double own_scale = 1.0 / sqrt(a * a + b * b);
    conic_noise(conic_random_mix(seed + (uint64_t)octave), a * x + b * z + 0.37, a * z - b * x + 0.61, &n);
    double gx = a * n.gradient[0] - b * n.gradient[1], gz = b * n.gradient[0] + a * n.gradient[1];
    steep.gradient[0] += own_scale * gx;
    steep.gradient[1] += own_scale * gz;
    steep.xx += own_scale * (a * a * n.xx - 2.0 * a * b * n.xy + b * b * n.yy);
    steep.xy += own_scale * (a * b * (n.xx - n.yy) + (a * a - b * b) * n.xy);
    steep.yy += own_scale * (b * b * n.xx + 2.0 * a * b * n.xy + a * a * n.yy);
    double sx = steep.gradient[0], sz = steep.gradient[1];
    double share = 1.0 / (1.0 + EROSION * (sx * sx + sz * sz));
    double share_squared = 2.0 * EROSION * share * share;
    *height += amplitude * share * n.value;
    slope[0] += amplitude * (share * gx - share_squared * n.value * (sx * steep.xx + sz * steep.xy));
    slope[1] += amplitude * (share * gz - share_squared * n.value * (sx * steep.xy + sz * steep.yy));
    if (octave == 3)
      *ruggedness = sx * sx + sz * sz;
    double turned = 1.6 * a - 1.2 * b;
    b = 1.6 * b + 1.2 * a;
    a = turned;
    amplitude *= PERSISTENCE;
  }
}

void conic_terrain_at(uint64_t seed, double x, double z, conic_terrain_place *place) {
  double height, slope[2];
  mountains(seed, x, z, &height, slope, &place->ruggedness);
  /* 1 in the middle; 0 with zero slope at the square's border. */
  double x_part = 1.0 - x * x, z_part = 1.0 - z * z;
  double island = x_part * x_part * z_part * z_part;
  double island_x = -4.0 * x * x_part * z_part * z_part, island_z = -4.0 * z * z_part * x_part * x_part;
  place->ground = island * (height + UPLIFT + SEA_FLOOR) - SEA_FLOOR;
  int is_sea = !(place->ground > 0.0);
  place->height = is_sea ? 0.0 : place->ground;
  place->slope[0] = is_sea ? 0.0 : island_x * (height + UPLIFT + SEA_FLOOR) + island * slope[0];
  place->slope[1] = is_sea ? 0.0 : island_z * (height + UPLIFT + SEA_FLOOR) + island * slope[1];
}

/* From the deep to the shore; from the beach to the tree line; bare rock; snow. */
static const uint8_t sea[][3] = {{0x12, 0x2f, 0x56}, {0x1b, 0x54, 0x7e}, {0x2f, 0x8f, 0xa3}, {0x86, 0xd0, 0xc6}};
static const uint8_t land[][3] = {{0xe3, 0xd3, 0x9f}, {0x9d, 0xae, 0x5a}, {0x5b, 0x86, 0x41},
                                  {0x3d, 0x66, 0x3a}, {0x6a, 0x70, 0x4c}, {0x8b, 0x80, 0x6d}};
static const uint8_t rock[][3] = {{0x5d, 0x52, 0x4a}, {0x93, 0x86, 0x79}};
static const uint8_t snow[3] = {0xf6, 0xf8, 0xfb};

#define STEEP_SLOPE 1.05
#define SNOW_HEIGHT 0.42

static void mix_colors(const uint8_t to[3], double part, uint8_t color[3]) {
  for (int c = 0; c < 3; c++)
    color[c] = (uint8_t)((double)color[c] * (1.0 - part) + (double)to[c] * part + 0.5);
}

static void paint(uint64_t seed, double x, double z, const conic_terrain_place *place, uint8_t color[3]) {
  if (!(place->ground > 0.0)) {
    conic_scene_blend(sea, 4, 1.0 + place->ground / SEA_FLOOR, color);
    return;
  }
  conic_jet speckle;
  conic_noise(seed, 61.0 * x, 61.0 * z, &speckle);
  double slope = sqrt(place->slope[0] * place->slope[0] + place->slope[1] * place->slope[1]);
  double height = place->ground + 0.03 * speckle.value;
  uint8_t stone[3];
  conic_scene_blend(land, 6, height / SNOW_HEIGHT, color);
  conic_scene_blend(rock, 2, 0.5 + speckle.value, stone);
  mix_colors(stone, conic_unit((slope - STEEP_SLOPE + 0.2 * speckle.value) / 0.35), color);
  double cover = (height - SNOW_HEIGHT) / 0.04 + 1.0 - conic_unit((slope - 1.1) / 0.5);
  mix_colors(snow, conic_unit(cover), color);
}

typedef struct terrain {
  uint64_t seed;
} terrain;

/* Cells along each edge of the grid that the area is measured on. */
enum { AREA_CELLS = 512 };

typedef struct area_measuring {
  uint64_t seed;
  double rows[AREA_CELLS];
} area_measuring;

static double stretch(const conic_terrain_place *place) {
  return sqrt(1.0 + place->slope[0] * place->slope[0] + place->slope[1] * place->slope[1]);
}

static void measure_row(void *data, size_t i_row) {
  area_measuring *work = data;
  const double step = 2.0 / AREA_CELLS;
  double sum = 0.0;
  for (int i = 0; i < AREA_CELLS; i++) {
    conic_terrain_place place;
    conic_terrain_at(work->seed, ((double)i + 0.5) * step - 1.0, ((double)i_row + 0.5) * step - 1.0, &place);
    sum += stretch(&place);
  }
  work->rows[i_row] = sum * step * step;
}

static conic_status prepare_terrain(conic_scene *scene) {
  terrain *made = conic_scene_surface(scene, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->seed = scene->options.seed;
  area_measuring work = {.seed = made->seed};
  conic_parallel_for(scene->context, AREA_CELLS, measure_row, &work);
  for (int i = 0; i < AREA_CELLS; i++)
    scene->area += work.rows[i];
  return conic_lattice_fit(scene->context, scene->kind->walk, made, scene->area, scene->options.count, 1,
                           &scene->lattice);
}

static double clamp_to_square(double t) {
  return t > -1.0 ? t < 1.0 ? t : 1.0 : -1.0;
}

/* The column over a cell cuts the layer in an interval of heights. It is half open, so that on flat ground it always
 * holds one point. Projections start at the point's foot on the tangent plane at the column. */
static void walk(const void *surface, const conic_lattice *lattice, size_t i_slab, conic_lattice_visit *visit,
                 void *cookie) {
  const terrain *self = surface;
  double x, z = conic_lattice_coordinate(lattice, i_slab);
  for (size_t i = 0; i < lattice->n_cells; i++) {
    conic_terrain_place place;
    x = conic_lattice_coordinate(lattice, i);
    conic_terrain_at(self->seed, x, z, &place);
    double length = stretch(&place), middle = place.height / lattice->spacing;
    double top = floor(middle + 0.5 * length);
    for (double level = floor(middle - 0.5 * length) + 1.0; level <= top; level += 1.0) {
      double along = (level * lattice->spacing - place.height) / (length * length);
      double start[3] = {clamp_to_square(x + along * place.slope[0]), 0.0, clamp_to_square(z + along * place.slope[1])};
      visit(cookie, start);
    }
  }
}

/* Moves the place up or down onto the surface. */
static void project_on_terrain(const void *surface, const double start[3], conic_scene_point *point) {
  const terrain *self = surface;
  conic_terrain_place place;
  conic_terrain_at(self->seed, start[0], start[2], &place);
  double length = stretch(&place);
  *point = (conic_scene_point){.position = {start[0], place.height, start[2]},
                               .normal = {-place.slope[0] / length, 1.0 / length, -place.slope[1] / length}};
  paint(self->seed, start[0], start[2], &place, point->color);
}

const conic_scene_kind conic_scene_terrain = {.name = "terrain",
                                              .summary = "fractal mountains in a sea, y up; another island a seed",
                                              .prepare = prepare_terrain,
                                              .walk = walk,
                                              .project = project_on_terrain};
