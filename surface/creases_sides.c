/* Which side of a crease each sample is on. A plane through all neighbours of a sample near a crease is blunt. So such
 * a sample takes over the flattest nearby plane in which it lies: that of a neighbour farther inside. */

#include "core/base/team_runs.h"
#include "core/base/vectors.h"
#include "surface/least_spread.h"
#include "surface/mls_surface.h"

enum { CHUNK = 256, CHUNKS_A_REPORT = 16, N_WINDOW = 32 };

/* A plane is taken over if the own one is rougher than so many spacings (as a bend of 30° is), and the other is flatter
 * by this factor and passes the sample within so many spacings. */
static const double ROUGH = 0.4, FLATTER = 0.6, IN_PLANE = 0.75;

typedef struct window_plane {
  double normal[3], mean[3];
  double roughness; /* deviation of the neighbours from the plane */
} window_plane;

typedef struct sides_search {
  conic_surface *surface;
  window_plane *planes;
} sides_search;

static size_t window_of(const conic_surface *surface, size_t slot, uint32_t slots[N_WINDOW], double place[3]) {
  double distances2[N_WINDOW];
  conic_vector_at(surface->tree.position, slot, place);
  size_t n = conic_neighbours_nearest(&surface->tree, place, (uint32_t)slot, N_WINDOW, HUGE_VAL, slots, distances2);
  double area = n ? 3.14159265358979323846 * distances2[n - 1] / (double)n : 0.0;
  surface->creases.spacing[slot] = (float)sqrt(area);
  return n;
}

static void fit_window(const sides_search *search, size_t slot, window_plane *plane) {
  const conic_neighbours *tree = &search->surface->tree;
  uint32_t slots[N_WINDOW];
  double place[3], sum[3] = {0.0}, products[6] = {0.0}, frame[3][3];
  size_t n = window_of(search->surface, slot, slots, place);
  double share = 1.0 / (double)(n + 1);
  for (size_t i = 0; i < n; i++) {
    double d[3];
    for (int axis = 0; axis < 3; axis++) {
      d[axis] = (double)tree->position[axis][slots[i]] - place[axis];
      sum[axis] += d[axis];
    }
    conic_add_outer(products, d, d);
  }
  for (int a = 0, k = 0; a < 3; a++)
    for (int b = a; b < 3; b++, k++)
      products[k] = products[k] * share - sum[a] * share * (sum[b] * share);
  conic_least_spread(products, frame);
  const double *z = frame[2];
  double spread = z[0] * (products[0] * z[0] + 2.0 * (products[1] * z[1] + products[2] * z[2])) +
                  z[1] * (products[3] * z[1] + 2.0 * products[4] * z[2]) + z[2] * z[2] * products[5];
  plane->roughness = spread > 0.0 ? sqrt(spread) : 0.0;
  for (int axis = 0; axis < 3; axis++) {
    plane->normal[axis] = z[axis];
    plane->mean[axis] = place[axis] + sum[axis] * share;
  }
}

static void choose_side(const sides_search *search, size_t slot) {
  conic_surface *surface = search->surface;
  const window_plane *own = &search->planes[slot], *best = own;
  uint32_t slots[N_WINDOW];
  double place[3];
  size_t n = window_of(surface, slot, slots, place);
  double spacing = (double)surface->creases.spacing[slot], least = FLATTER * own->roughness;
  n = own->roughness > ROUGH * spacing ? n : 0;
  for (size_t i = 0; i < n; i++) {
    const window_plane *other = &search->planes[slots[i]];
    double d[3];
    conic_subtract(place, other->mean, d);
    double height = fabs(conic_dot(d, other->normal));
    if (!(height <= IN_PLANE * spacing) || !(other->roughness < least))
      continue;
    least = other->roughness;
    best = other;
  }
  for (int axis = 0; axis < 3; axis++)
    surface->creases.side[slot][axis] = (float)best->normal[axis];
}

static void fit_windows(void *data, size_t i_item) {
  sides_search *search = data;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < search->surface->tree.n_slots; i++)
    fit_window(search, i, &search->planes[i]);
}

static void choose_sides(void *data, size_t i_item) {
  sides_search *search = data;
  for (size_t i = i_item * CHUNK; i < (i_item + 1) * CHUNK && i < search->surface->tree.n_slots; i++)
    choose_side(search, i);
}

conic_status conic_creases_find(conic_surface *surface) {
  conic_context *context = surface->context;
  size_t n = surface->tree.n_slots;
  sides_search search = {surface, conic_memory_allocate(context, n, sizeof *search.planes)};
  surface->creases.side = conic_memory_allocate(context, n, sizeof *surface->creases.side);
  surface->creases.spacing = conic_memory_allocate(context, n, sizeof *surface->creases.spacing);
  conic_status status =
      search.planes && surface->creases.side && surface->creases.spacing ? CONIC_OK : CONIC_ERROR_MEMORY;
  conic_team_loop windows = conic_team_loop_of("creases", 0.0, 0.5, n, CHUNK, CHUNKS_A_REPORT, fit_windows, &search);
  conic_team_loop sides = conic_team_loop_of("creases", 0.5, 1.0, n, CHUNK, CHUNKS_A_REPORT, choose_sides, &search);
  windows.columns[0] = (conic_team_column){search.planes, sizeof *search.planes};
  windows.columns[1] = (conic_team_column){surface->creases.spacing, sizeof *surface->creases.spacing};
  sides.columns[0] = (conic_team_column){surface->creases.side, sizeof *surface->creases.side};
  if (status == CONIC_OK)
    status = conic_team_runs(context, &windows);
  if (status == CONIC_OK)
    status = conic_team_runs(context, &sides);
  conic_memory_release(context, search.planes);
  return status;
}

void conic_creases_release(conic_surface *surface) {
  conic_memory_release_these(surface->context, surface->creases.side, surface->creases.spacing);
}
