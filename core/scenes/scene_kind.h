/* The interface of a scene's surface.
 *
 * A surface is sampled in one of two ways. `place` puts sample i of n where a formula says: an even lattice, carried
 * onto the surface by a map that keeps areas. Without such a map the scene has a lattice;
 * `walk` and `project` find its points near the surface and carry them there. */
#pragma once

#include "conic/scene.h"
#include "core/base/base.h"

/* Even samples of a surface that has no parametrisation: the points of a cubic lattice in [-1, 1]³ that lie within half
 * a lattice spacing of it, carried onto it.
 *
 * This layer, one spacing thick, holds one lattice point per spacing² of surface, however the surface is turned. Its
 * points are numbered slab by slab; the surplus over the wanted number is dropped evenly. Only the slabs' counts are
 * kept: memory does not grow with the number of points, and any batch is found without those before it. */

typedef struct conic_scene_point conic_scene_point;

typedef struct conic_lattice {
  size_t n_cells;         /* along an edge of the cube; the points are the cells' centres */
  double spacing;         /* 2 / n_cells */
  uint64_t n_found;       /* points near the surface */
  uint64_t n_wanted;      /* not above n_found */
  uint64_t *found_before; /* n_cells + 1: points in the slabs before this one */
} conic_lattice;

/* Called for each point near the surface, with a start for its projection: the point itself, or a nearer place. */
typedef void conic_lattice_visit(void *cookie, const double start[3]);

/* Visits the points of slab `i_slab` (below n_cells), always in the same order. To first order they are less than half
 * a spacing from the surface, so that the layer is one spacing thick. Thread-safe. */
typedef void conic_lattice_walk(const void *surface, const conic_lattice *lattice, size_t i_slab,
                                conic_lattice_visit *visit, void *cookie);

/* Carries a start from the walk onto the surface. Thread-safe. */
typedef void conic_lattice_project(const void *surface, const double start[3], conic_scene_point *point);

/* The coordinate of the i-th cells' centres, along any axis. */
static inline double conic_lattice_coordinate(const conic_lattice *lattice, size_t i) {
  return (double)i * lattice->spacing + (0.5 * lattice->spacing - 1.0);
}

/* Finds the coarsest lattice, of at least `min_cells` cells along an edge, with at least `n_wanted` (1 to 2³² − 2)
 * points near the surface, whose area is about `area`. Reports progress. On failure nothing is left to release. Errors:
 * MEMORY, CANCELLED. */
conic_status conic_lattice_fit(conic_context *context, conic_lattice_walk *walk, const void *surface, double area,
                               uint64_t n_wanted, size_t min_cells, conic_lattice *lattice);

void conic_lattice_release(conic_context *context, conic_lattice *lattice);

/* The slabs with the kept points first … first + n − 1: *first_slab is the first; returns how many. */
size_t conic_lattice_slabs(const conic_lattice *lattice, uint64_t first, uint64_t n, size_t *first_slab);

/* How many of the first `found` points near the surface are kept. */
uint64_t conic_lattice_kept(const conic_lattice *lattice, uint64_t found);

/* A place on a surface. */
struct conic_scene_point {
  double position[3];
  double normal[3]; /* unit, outward */
  uint8_t color[3]; /* sRGB codes, so that files keep colours exactly */
};

enum { CONIC_SCENE_MAX_EDGES = 2 };

/* The sharp edges of a flat face at which a splat has to be clipped. */
typedef struct conic_scene_edges {
  int n;
  conic_clip_operator operation;
  double inward[CONIC_SCENE_MAX_EDGES][3]; /* unit, in the face's plane, away from the edge */
  double distance[CONIC_SCENE_MAX_EDGES];  /* from the edge; negative outside of the face */
} conic_scene_edges;

typedef struct conic_scene_kind {
  const char *name, *summary;

  /* Sets scene->area; scene->surface, where the kind needs one; and scene->lattice, where `place` is null.
   * conic_scene_destroy releases them, on failure, too. */
  conic_status (*prepare)(conic_scene *scene);

  /* Places sample i of scene->options.count; null: the lattice does. */
  void (*place)(const conic_scene *scene, uint64_t i, conic_scene_point *point);

  /* Finds the edges near a place on the face of sample i, whose outline has that radius; null: a surface without
   * edges. */
  void (*edges)(const conic_scene *scene, uint64_t i, const double position[3], double radius,
                conic_scene_edges *edges);

  conic_lattice_walk *walk;
  conic_lattice_project *project;
} conic_scene_kind;

struct conic_scene {
  conic_context *context;
  conic_scene_options options;
  const conic_scene_kind *kind;
  double area;
  double spacing;    /* sqrt(area / count) */
  float decode[256]; /* linear values of colour codes */
  void *surface;     /* the kind's own data, in one allocation; may be null */
  conic_lattice lattice;
};

extern const conic_scene_kind conic_scene_plane, conic_scene_sphere, conic_scene_torus, conic_scene_knot,
    conic_scene_terrain, conic_scene_gyroid, conic_scene_cube, conic_scene_corner;

/* Makes scene->surface, `bytes` large; null on failure. */
void *conic_scene_surface(conic_scene *scene, size_t bytes);

/* Point i of n of the golden lattice in the unit square: u = (i + ½)/n, v = i/φ + ½ modulo 1, exact to 2⁻⁵³ for any i.
 * It stays even when the square is stretched to a rectangle of any shape and the same area. */
void conic_scene_golden(uint64_t i, uint64_t n, double *u, double *v);

/* The angle ψ with ψ − e·sin ψ = 2π·turns (Kepler's equation), |e| ≤ 0.7, to 1e-7. It divides the circumference of a
 * bent tube into pieces of equal area. */
double conic_scene_equal_area_angle(double turns, double e);

/* A colour `t` (clamped to 0 … 1) of the way through n ≥ 2 equally spaced colours. */
void conic_scene_blend(const uint8_t (*stops)[3], int n, double t, uint8_t color[3]);
