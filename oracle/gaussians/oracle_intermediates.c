/* All Gaussians' intermediates, the lists of tiles, and the transmittances before each. */
#include "oracle/gaussians/oracle_intermediates.h"

#include "core/base/real.h"

CONIC_DEFINE_NAMES(conic_intermediate_name, conic_intermediate, CONIC_N_INTERMEDIATES, "radii", "means2d", "depths",
                   "covars2d", "conics", "tile_boxes", "tiles_per_gauss", "opacities", "colors", "transmittances")
CONIC_DEFINE_NAMES(conic_gaussian_stage_name, conic_gaussian_stage, CONIC_N_GAUSSIAN_STAGES, "projection", "sort",
                   "alpha", "color", "blending")

enum { A_RUN = 256 };

typedef struct list_entry {
  uint64_t id;
  uint32_t gaussian;
} list_entry;

typedef struct intermediates_finding {
  oracle_entry *e;
  conic_gaussian_intermediates *to;
  int is_by_ellipse; /* its tiles are those that its ellipse meets, not its box */
  size_t *begin;     /* of each Gaussian's entries, count + 1 of them */
  list_entry *entries;
} intermediates_finding;

static void put_range(const conic_intermediate_array *a, size_t i, int column, oracle_range r) {
  const size_t at = i * (size_t)a->n_columns + (size_t)column;
  a->value[at] = r.v;
  a->low[at] = r.low;
  a->high[at] = r.high;
}

/* How many tiles list it: in double, and at least and at most. */
static oracle_range count_tiles(const intermediates_finding *j, const oracle_projected *p) {
  const oracle_doubting *d = &j->e->bounding.doubting;
  oracle_range n = {0.0, 0.0, 0.0};
  for (int y = (int)p->first[1].low; y < (int)p->behind[1].high; y++)
    for (int x = (int)p->first[0].low; x < (int)p->behind[0].high; x++) {
      n.v += conic_oracle_lists(d, p, j->is_by_ellipse, x, y) != 0;
      n.low += conic_oracle_has_to_list(d, p, x, y) != 0;
      n.high += conic_oracle_may_list(p, x, y) != 0;
    }
  return n;
}

static void project_run(void *data, size_t i_run) {
  const intermediates_finding *j = data;
  for (size_t i = i_run * A_RUN; i < (i_run + 1) * A_RUN && i < j->to->count; i++) {
    oracle_projected p;
    conic_oracle_project(&j->e->bounding.doubting, i, &p);
    for (int kind = 0; kind < CONIC_N_INTERMEDIATES; kind++) {
      const conic_intermediate_array *a = &j->to->arrays[kind];
      for (int k = 0; k < a->n_columns; k++)
        put_range(a, i, k,
                  kind == CONIC_INTERMEDIATE_TRANSMITTANCES    ? (oracle_range){NAN, -INFINITY, INFINITY}
                  : kind == CONIC_INTERMEDIATE_TILES_PER_GAUSS ? count_tiles(j, &p)
                                                               : conic_oracle_intermediate(&p, kind, k));
    }
  }
}

/* --- lists --- */

static void list_run(void *data, size_t i_run) {
  const intermediates_finding *j = data;
  for (size_t i = i_run * A_RUN; i < (i_run + 1) * A_RUN && i < j->to->count; i++) {
    list_entry *entry = &j->entries[j->begin[i]];
    oracle_projected p;
    if (j->begin[i] == j->begin[i + 1])
      continue;
    conic_oracle_project(&j->e->bounding.doubting, i, &p);
    const uint32_t depth = conic_bits_of_float((float)p.g.z.v);
    for (int y = (int)p.first[1].v; y < (int)p.behind[1].v; y++)
      for (int x = (int)p.first[0].v; x < (int)p.behind[0].v; x++)
        if (conic_oracle_lists(&j->e->bounding.doubting, &p, j->is_by_ellipse, x, y))
          *entry++ = (list_entry){(uint64_t)(y * j->to->tile_width + x) << 32 | depth, (uint32_t)i};
  }
}

CONIC_DEFINE_ORDER_BY_TWO(compare_entries, list_entry, id, gaussian)

static size_t n_runs_of(const intermediates_finding *j) {
  return (j->to->count + A_RUN - 1) / A_RUN;
}

static conic_status make_lists(intermediates_finding *j) {
  conic_context *context = j->e->bounding.context;
  conic_gaussian_intermediates *to = j->to;
  const size_t n_tiles = (size_t)to->tile_width * (size_t)to->tile_height;
  if (!n_tiles)
    return CONIC_OK;
  j->begin = conic_memory_allocate_zeroed(context, to->count + 1, sizeof *j->begin);
  for (size_t i = 0; j->begin && i < to->count; i++)
    j->begin[i + 1] = j->begin[i] + (size_t)to->arrays[CONIC_INTERMEDIATE_TILES_PER_GAUSS].value[i];
  const size_t n = j->begin ? j->begin[to->count] : 0;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ROOM(j->entries, n), CONIC_ROOM(to->isect_ids, n),
                                  CONIC_ROOM(to->flatten_ids, n), CONIC_ROOM(to->isect_offsets, n_tiles));
  if (status != CONIC_OK || !j->begin)
    return CONIC_ERROR_MEMORY;
  status = conic_parallel_told(context, "project", 0.3, 0.4, n_runs_of(j), list_run, j);
  if (status != CONIC_OK)
    return status;
  qsort(j->entries, n, sizeof *j->entries, compare_entries);
  to->n_isects = n;
  for (size_t k = 0, tile = 0; tile < n_tiles; to->isect_offsets[tile++] = (int64_t)k)
    while (k < n && j->entries[k].id >> 32 < tile)
      k++;
  for (size_t k = 0; k < n; k++) {
    to->isect_ids[k] = (int64_t)j->entries[k].id;
    to->flatten_ids[k] = j->entries[k].gaussian;
  }
  return CONIC_OK;
}

/* --- transmittances --- */

/* T before the k-th meeting: in double, and with all that may come before it, or only what has to. */
static oracle_range find_transmittance(const oracle_meeting *meetings, size_t n, size_t k) {
  oracle_range T = {1.0, 1.0, 1.0};
  const unsigned harmless = 1u << CONIC_DOUBT_MOST | 1u << CONIC_DOUBT_ORDER;
  for (size_t i = 0; i < n; i++) {
    const oracle_meeting *m = &meetings[i];
    if (i == k)
      continue;
    if (i < k && m->covers)
      T.v *= 1.0 - m->alpha_v;
    if (!conic_oracle_is_before(&meetings[k], m))
      T.low *= (1.0 - m->alpha[1]) * (1.0 - 4.0 * ORACLE_FLOAT_UNIT);
    if (m->covers && !(m->doubts & ~harmless) && conic_oracle_is_before(m, &meetings[k]))
      T.high *= (1.0 - m->alpha[0]) * (1.0 + 4.0 * ORACLE_FLOAT_UNIT);
  }
  return T;
}

static void note_transmittances(void *data, size_t pixel, const oracle_meeting *meetings, size_t n, int i_thread) {
  const intermediates_finding *j = data;
  const size_t width = (size_t)j->e->bounding.width, row = pixel / width;
  const double x = (double)(pixel % width) + 0.5, y = (double)row + 0.5;
  (void)i_thread;
  for (size_t k = 0; k < n; k++)
    if (meetings[k].g->pixel[0] == x && meetings[k].g->pixel[1] == y && meetings[k].covers)
      put_range(&j->to->arrays[CONIC_INTERMEDIATE_TRANSMITTANCES], meetings[k].g->index, 0,
                find_transmittance(meetings, n, k));
}

/* At the pixels that hold a mean. */
static conic_status find_transmittances(intermediates_finding *j) {
  oracle_bound_request *b = &j->e->bounding;
  const double *place = j->to->arrays[CONIC_INTERMEDIATE_MEANS2D].value;
  const size_t whole = b->n_pixels;
  char *is_asked = conic_memory_allocate_zeroed(b->context, whole, 1);
  uint32_t *pixels = conic_memory_allocate(b->context, whole, sizeof *pixels);
  for (size_t i = 0; is_asked && i < j->to->count; i++)
    if (place[2 * i] >= 0.0 && place[2 * i] < b->width && place[2 * i + 1] >= 0.0 && place[2 * i + 1] < b->height)
      is_asked[(size_t)place[2 * i + 1] * (size_t)b->width + (size_t)place[2 * i]] = 1;
  b->n_pixels = 0;
  for (size_t i = 0; is_asked && pixels && i < whole; i++)
    if (is_asked[i])
      pixels[b->n_pixels++] = (uint32_t)i;
  b->pixels = pixels;
  b->note = note_transmittances;
  b->data = j;
  b->task = "transmittances";
  conic_status status = is_asked && pixels ? conic_oracle_bound_all(b) : CONIC_ERROR_MEMORY;
  conic_memory_release_these(b->context, is_asked, pixels);
  return status;
}

static conic_status make_room(conic_context *context, const oracle_entry *e, size_t count,
                              conic_gaussian_intermediates *to) {
  conic_status status = CONIC_OK;
  to->count = count;
  for (int kind = 0; kind < CONIC_N_INTERMEDIATES && status == CONIC_OK; kind++) {
    conic_intermediate_array *a = &to->arrays[kind];
    a->n_columns = conic_oracle_intermediate_columns(e->view.rules, kind);
    const size_t n = count * (size_t)a->n_columns;
    if (n)
      status =
          conic_memory_allocate_these(context, CONIC_ROOM(a->value, n), CONIC_ROOM(a->low, n), CONIC_ROOM(a->high, n));
  }
  if (conic_oracle_has_radii(e->view.rules)) {
    const int tile = conic_profile_tile(e->view.rules, e->view.camera);
    to->tile_width = (e->bounding.width + tile - 1) / tile;
    to->tile_height = (e->bounding.height + tile - 1) / tile;
  }
  return status;
}

conic_status conic_gaussian_intermediates_find(conic_context *context, const conic_gaussians *gaussians,
                                               const conic_camera *camera, const conic_gaussian_options *options,
                                               const conic_float_model *model, conic_gaussian_intermediates *found) {
  oracle_entry e;
  conic_float_model fast;
  conic_float_model_init(&fast, CONIC_FLOATS_FAST);
  memset(found, 0, sizeof *found);
  conic_status status = conic_oracle_enter(context, gaussians, camera, options, model ? model : &fast, 1, &e);
  if (status != CONIC_OK)
    return status;
  intermediates_finding j = {.e = &e, .to = found};
  j.is_by_ellipse = e.options.profile == CONIC_PROFILE_GSPLAT_1_6 || e.options.profile == CONIC_PROFILE_GSPLAT_1_6_AA;
  status = make_room(context, &e, gaussians->count, found);
  if (status == CONIC_OK)
    status = conic_parallel_told(context, "project", 0.0, 0.3, n_runs_of(&j), project_run, &j);
  if (status == CONIC_OK)
    status = make_lists(&j);
  if (status == CONIC_OK)
    status = find_transmittances(&j);
  conic_memory_release_these(context, j.begin, j.entries);
  if (status != CONIC_OK)
    conic_gaussian_intermediates_release(context, found);
  return status;
}

void conic_gaussian_intermediates_release(conic_context *context, conic_gaussian_intermediates *found) {
  for (int kind = 0; kind < CONIC_N_INTERMEDIATES; kind++)
    conic_memory_release_these(context, found->arrays[kind].value, found->arrays[kind].low, found->arrays[kind].high);
  conic_memory_release_these(context, found->isect_ids, found->flatten_ids, found->isect_offsets);
  memset(found, 0, sizeof *found);
}
