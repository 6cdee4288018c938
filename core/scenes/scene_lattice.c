#include "core/base/real.h"
#include "core/scenes/scene_kind.h"

/* found · n_wanted / n_found, rounded, computed as found minus its share of the surplus. The surplus is small where the
 * numbers are large, so the product stays below 2⁶⁴. */
uint64_t conic_lattice_kept(const conic_lattice *lattice, uint64_t found) {
  uint64_t surplus = lattice->n_found - lattice->n_wanted;
  return found - (2 * found * surplus + lattice->n_found - 1) / (2 * lattice->n_found);
}

/* The slab whose points raise the number of kept points above `i`. */
static size_t slab_of(const conic_lattice *lattice, uint64_t i) {
  size_t low = 0;
  CONIC_BISECT(low, lattice->n_cells - 1, conic_lattice_kept(lattice, lattice->found_before[middle + 1]) <= i);
  return low;
}

size_t conic_lattice_slabs(const conic_lattice *lattice, uint64_t first, uint64_t n, size_t *first_slab) {
  *first_slab = slab_of(lattice, first);
  return n ? slab_of(lattice, first + n - 1) - *first_slab + 1 : 0;
}

typedef struct counting {
  const conic_lattice *lattice;
  conic_lattice_walk *walk;
  const void *surface;
} counting;

static void count_point(void *cookie, const double point[3]) {
  (void)point;
  ++*(uint64_t *)cookie;
}

static void count_slab(void *data, size_t i_slab) {
  const counting *work = data;
  uint64_t n = 0;
  work->walk(work->surface, work->lattice, i_slab, count_point, &n);
  work->lattice->found_before[i_slab + 1] = n;
}

/* Fills found_before and n_found for the lattice's n_cells. */
static conic_status count_cells(conic_context *context, conic_lattice_walk *walk, const void *surface,
                                conic_lattice *lattice) {
  counting work = {lattice, walk, surface};
  size_t slabs_a_run = 8 * (size_t)conic_context_threads(context);
  lattice->found_before[0] = 0;
  conic_status status =
      conic_parallel_runs(context, "survey", 0.0, 1.0, lattice->n_cells, slabs_a_run, count_slab, &work);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < lattice->n_cells; i++)
    lattice->found_before[i + 1] += lattice->found_before[i];
  lattice->n_found = lattice->found_before[lattice->n_cells];
  return CONIC_OK;
}

conic_status conic_lattice_fit(conic_context *context, conic_lattice_walk *walk, const void *surface, double area,
                               uint64_t n_wanted, size_t min_cells, conic_lattice *lattice) {
  memset(lattice, 0, sizeof *lattice);
  lattice->n_wanted = n_wanted;
  size_t n_cells = (size_t)ceil(2.0 * sqrt((double)n_wanted / area));
  if (n_cells < min_cells)
    n_cells = min_cells;
  for (;;) {
    conic_status status = CONIC_ERROR_MEMORY;
    lattice->n_cells = n_cells;
    lattice->spacing = 2.0 / (double)n_cells;
    lattice->found_before = conic_memory_allocate(context, n_cells + 1, sizeof *lattice->found_before);
    if (lattice->found_before)
      status = count_cells(context, walk, surface, lattice);
    if (status == CONIC_OK && lattice->n_found >= n_wanted)
      return CONIC_OK;
    conic_lattice_release(context, lattice);
    if (status != CONIC_OK)
      return status;
    /* Adds cells in proportion to the shortfall, and at least one. */
    double shortfall = (double)n_wanted / (double)(lattice->n_found ? lattice->n_found : 1);
    size_t next = (size_t)ceil((double)n_cells * (shortfall < 4.0 ? sqrt(shortfall) : 2.0));
    n_cells = next > n_cells ? next : n_cells + 1;
  }
}

void conic_lattice_release(conic_context *context, conic_lattice *lattice) {
  conic_memory_release(context, lattice->found_before);
  lattice->found_before = NULL;
}
