/* Another program's intermediates held against what floats may make of them. */
#include "core/base/byte_order.h"
#include "core/files/mapping.h"
#include "core/files/numpy_array.h"
#include "core/files/zip.h"
#include "oracle/gaussians/oracle_intermediates.h"

/* Arrays by their names. Those of rows come first, by their kinds. */
typedef enum given_name {
  GIVEN_ISECT_IDS = CONIC_INTERMEDIATE_TRANSMITTANCES, /* which nobody has */
  GIVEN_FLATTEN_IDS,
  GIVEN_ISECT_OFFSETS,
  GIVEN_GAUSSIAN_IDS,
  GIVEN_COLORS, /* of pixels */
  GIVEN_ALPHAS,
  N_GIVEN
} given_name;

static const struct {
  const char *names[3];
  conic_gaussian_stage stage;
} about[N_GIVEN] = {
    [CONIC_INTERMEDIATE_RADII] = {{"radii"}, CONIC_GAUSSIAN_STAGE_PROJECTION},
    [CONIC_INTERMEDIATE_MEANS2D] = {{"means2d"}, CONIC_GAUSSIAN_STAGE_PROJECTION},
    [CONIC_INTERMEDIATE_DEPTHS] = {{"depths"}, CONIC_GAUSSIAN_STAGE_PROJECTION},
    [CONIC_INTERMEDIATE_COVARS2D] = {{"covars2d"}, CONIC_GAUSSIAN_STAGE_PROJECTION},
    [CONIC_INTERMEDIATE_CONICS] = {{"conics"}, CONIC_GAUSSIAN_STAGE_PROJECTION},
    [CONIC_INTERMEDIATE_TILE_BOXES] = {{"tile_boxes"}, CONIC_GAUSSIAN_STAGE_SORT},
    [CONIC_INTERMEDIATE_TILES_PER_GAUSS] = {{"tiles_per_gauss"}, CONIC_GAUSSIAN_STAGE_SORT},
    [CONIC_INTERMEDIATE_OPACITIES] = {{"opacities"}, CONIC_GAUSSIAN_STAGE_ALPHA},
    [CONIC_INTERMEDIATE_COLORS] = {{"colors"}, CONIC_GAUSSIAN_STAGE_COLOR},
    [GIVEN_ISECT_IDS] = {{"isect_ids"}, CONIC_GAUSSIAN_STAGE_SORT},
    [GIVEN_FLATTEN_IDS] = {{"flatten_ids"}, CONIC_GAUSSIAN_STAGE_SORT},
    [GIVEN_ISECT_OFFSETS] = {{"isect_offsets"}, CONIC_GAUSSIAN_STAGE_SORT},
    [GIVEN_GAUSSIAN_IDS] = {{"gaussian_ids"}, CONIC_GAUSSIAN_STAGE_PROJECTION},
    [GIVEN_COLORS] = {{"render_colors", "colors"}, CONIC_GAUSSIAN_STAGE_BLENDING},
    [GIVEN_ALPHAS] = {{"render_alphas", "alphas"}, CONIC_GAUSSIAN_STAGE_BLENDING},
};

/* The order in which they are judged and told. */
static const int in_order[N_GIVEN] = {GIVEN_GAUSSIAN_IDS,
                                      CONIC_INTERMEDIATE_RADII,
                                      CONIC_INTERMEDIATE_MEANS2D,
                                      CONIC_INTERMEDIATE_DEPTHS,
                                      CONIC_INTERMEDIATE_COVARS2D,
                                      CONIC_INTERMEDIATE_CONICS,
                                      CONIC_INTERMEDIATE_TILE_BOXES,
                                      GIVEN_ISECT_IDS,
                                      GIVEN_FLATTEN_IDS,
                                      CONIC_INTERMEDIATE_TILES_PER_GAUSS,
                                      GIVEN_ISECT_OFFSETS,
                                      CONIC_INTERMEDIATE_OPACITIES,
                                      CONIC_INTERMEDIATE_COLORS,
                                      GIVEN_COLORS,
                                      GIVEN_ALPHAS};

typedef struct given_array {
  const char *name; /* null: it is not there */
  unsigned char *block;
  conic_numpy_array a;
  size_t n; /* numbers */
} given_array;

typedef struct intermediates_judging {
  oracle_entry e;
  conic_context *context;
  const char *path;
  given_array given[N_GIVEN];
  conic_judged_array verdicts[N_GIVEN];
  double severity[N_GIVEN];
  size_t count, n_rows, n_isects;
  int tile_width, tile_height;
  size_t *begin;    /* of each row's entries, in `places` */
  uint32_t *places; /* of entries */
  char *is_listed;  /* tiles of one Gaussian; Gaussians that a row is of */
} intermediates_judging;

static double given_number(const intermediates_judging *j, int name, size_t i) {
  return conic_numpy_array_at(&j->given[name].a, i);
}

/* --- what is there --- */

static int is_of_pixels(const intermediates_judging *j, const conic_numpy_array *a, size_t least_channels) {
  const size_t *shape = a->shape + a->n_axes, width = (size_t)j->e.bounding.width;
  if (a->n_axes >= 2 && least_channels == 1 && shape[-1] == width)
    return shape[-2] == (size_t)j->e.bounding.height;
  return a->n_axes >= 3 && shape[-1] >= least_channels && shape[-2] == width &&
         shape[-3] == (size_t)j->e.bounding.height;
}

static conic_status open_given(intermediates_judging *j, const conic_zip *zip, int name) {
  given_array *given = &j->given[name];
  char file[40];
  for (int k = 0; k < 3 && about[name].names[k] && !given->name; k++) {
    size_t n_bytes;
    snprintf(file, sizeof file, "%s.npy", about[name].names[k]);
    if (!conic_zip_has(zip, file))
      continue;
    conic_status status = conic_zip_read(zip, file, (size_t)1 << 40, &given->block, &n_bytes);
    if (status == CONIC_OK)
      status = conic_numpy_array_open(j->context, j->path, file, given->block, n_bytes, &given->a);
    if (status != CONIC_OK)
      return status;
    const int is_picture = is_of_pixels(j, &given->a, name == GIVEN_ALPHAS ? 1 : 3);
    const int wants_picture = name == GIVEN_COLORS || name == GIVEN_ALPHAS;
    if ((name == GIVEN_COLORS || name == CONIC_INTERMEDIATE_COLORS) && is_picture != wants_picture &&
        k == wants_picture) {
      conic_memory_release(j->context, given->block); /* "colors" may be either's */
      given->block = NULL;
      continue;
    }
    if (wants_picture && !is_picture)
      return conic_fail(j->context, CONIC_ERROR_INPUT, "%s: %s is not of the picture's size (at byte 0)", j->path,
                        file);
    given->name = about[name].names[k];
    given->n = 1;
    for (int axis = 0; axis < given->a.n_axes; axis++)
      given->n *= given->a.shape[axis];
  }
  return CONIC_OK;
}

/* Numbers of a row that it has to have; 0: it is not judged by rows. */
static size_t columns_given(const intermediates_judging *j, int name) {
  if (name >= CONIC_INTERMEDIATE_TRANSMITTANCES || !j->given[name].name)
    return 0;
  if (name == CONIC_INTERMEDIATE_RADII && j->given[name].n == j->n_rows && conic_oracle_has_radii(j->e.view.rules))
    return 1;
  return (size_t)conic_oracle_intermediate_columns(j->e.view.rules, (conic_intermediate)name);
}

static conic_status check_rows(intermediates_judging *j) {
  const int has_lists = j->given[GIVEN_ISECT_IDS].name || j->given[GIVEN_FLATTEN_IDS].name;
  int n_there = j->given[GIVEN_COLORS].name || j->given[GIVEN_ALPHAS].name;
  j->n_rows = j->given[GIVEN_GAUSSIAN_IDS].name ? j->given[GIVEN_GAUSSIAN_IDS].n : j->count;
  for (int name = 0; name < CONIC_INTERMEDIATE_TRANSMITTANCES; name++) {
    const size_t n_columns = columns_given(j, name);
    n_there += n_columns > 0;
    if (n_columns && j->given[name].n != j->n_rows * n_columns)
      return conic_fail(j->context, CONIC_ERROR_INPUT,
                        "%s: %s has %zu numbers, and %zu rows of %zu are due: one camera at a time (at byte 0)",
                        j->path, j->given[name].name, j->given[name].n, j->n_rows, n_columns);
  }
  for (size_t row = 0; j->given[GIVEN_GAUSSIAN_IDS].name && row < j->n_rows; row++)
    if (!(given_number(j, GIVEN_GAUSSIAN_IDS, row) >= 0.0 &&
          given_number(j, GIVEN_GAUSSIAN_IDS, row) < (double)j->count))
      return conic_fail(j->context, CONIC_ERROR_INPUT, "%s: gaussian_ids has one that is no Gaussian (at byte 0)",
                        j->path);
  if (has_lists && j->given[GIVEN_ISECT_IDS].n != j->given[GIVEN_FLATTEN_IDS].n)
    return conic_fail(j->context, CONIC_ERROR_INPUT, "%s: isect_ids and flatten_ids go together (at byte 0)", j->path);
  j->n_isects = conic_oracle_has_radii(j->e.view.rules) ? j->given[GIVEN_ISECT_IDS].n : 0;
  if (!n_there && !has_lists)
    return conic_fail(j->context, CONIC_ERROR_INPUT,
                      "%s: it has none of radii, means2d, depths, conics, opacities, colors … (at byte 0)", j->path);
  return CONIC_OK;
}

/* --- findings --- */

static void note_wrong(intermediates_judging *j, int name, double severity, conic_judged_array found) {
  conic_judged_array *to = &j->verdicts[name];
  to->wrong++;
  if (to->wrong > 1 && !(severity > j->severity[name]))
    return;
  j->severity[name] = severity;
  found.name = j->given[name].name;
  found.stage = about[name].stage;
  found.judged = to->judged;
  found.wrong = to->wrong;
  *to = found;
}

/* How far a number is outside of its range, in widths of it; 0: it is within. */
static double outside_of(oracle_range r, double found) {
  double out = found < r.low ? r.low - found : found > r.high ? found - r.high : found == found ? 0.0 : INFINITY;
  return out > 0.0 ? out / (r.high - r.low + 1e-7 * fabs(r.v) + 1e-30) : 0.0;
}

static void judge_row_of(intermediates_judging *j, int name, size_t row, const oracle_projected *p) {
  const size_t n_columns = columns_given(j, name);
  conic_judged_array worst = {.row = row, .gaussian = p->g.index};
  double severity = 0.0;
  for (size_t k = 0; k < n_columns; k++) {
    oracle_range r = name == CONIC_INTERMEDIATE_RADII ? p->radius[k]
                                                      : conic_oracle_intermediate(p, (conic_intermediate)name, (int)k);
    const double found = given_number(j, name, row * n_columns + k), out = outside_of(r, found);
    if (!(out > severity))
      continue;
    severity = out;
    worst.column = (int)k;
    worst.found = found;
    worst.value = r.v;
    worst.low = r.low;
    worst.high = r.high;
  }
  j->verdicts[name].judged += n_columns > 0;
  if (severity > 0.0)
    note_wrong(j, name, severity, worst);
}

/* --- lists --- */

static void note_entry(intermediates_judging *j, int name, size_t k, uint32_t gaussian, const char *what, double found,
                       double low, double high) {
  note_wrong(j, name, 1.0,
             (conic_judged_array){
                 .row = k, .gaussian = gaussian, .found = found, .value = low, .low = low, .high = high, .what = what});
}

/* What is no whole number that doubles have is the id of no tile. */
static uint64_t id_of(const intermediates_judging *j, size_t k) {
  const double id = given_number(j, GIVEN_ISECT_IDS, k);
  return id >= 0.0 && id < 0x1p53 ? (uint64_t)id : UINT64_MAX;
}

/* Whether the entries are in order; and sorts them by rows. */
static conic_status take_entries(intermediates_judging *j) {
  const size_t n_tiles = (size_t)j->tile_width * (size_t)j->tile_height;
  conic_status status =
      conic_memory_allocate_these(j->context, CONIC_ZEROED(j->begin, j->n_rows + 2), CONIC_ROOM(j->places, j->n_isects),
                                  CONIC_ZEROED(j->is_listed, n_tiles > j->count ? n_tiles : j->count));
  if (status != CONIC_OK)
    return status;
  j->verdicts[GIVEN_ISECT_IDS].judged = j->verdicts[GIVEN_FLATTEN_IDS].judged = j->n_isects;
  for (size_t k = 0; k < j->n_isects; k++) {
    const double row = given_number(j, GIVEN_FLATTEN_IDS, k);
    const uint64_t id = id_of(j, k);
    if (!(row >= 0.0 && row < (double)j->n_rows))
      note_entry(j, GIVEN_FLATTEN_IDS, k, CONIC_NO_ID, "there is no such row", row, 0.0, (double)j->n_rows - 1.0);
    else
      j->begin[(size_t)row + 2]++;
    if (id >> 32 >= n_tiles)
      note_entry(j, GIVEN_ISECT_IDS, k, CONIC_NO_ID, "there is no such tile", (double)(id >> 32), 0.0,
                 (double)n_tiles - 1.0);
    if (k > 0 && id < id_of(j, k - 1))
      note_entry(j, GIVEN_ISECT_IDS, k, CONIC_NO_ID, "it stands behind a greater one", (double)id,
                 (double)id_of(j, k - 1), INFINITY);
    if (k > 0 && id == id_of(j, k - 1) && row <= given_number(j, GIVEN_FLATTEN_IDS, k - 1))
      note_entry(j, GIVEN_FLATTEN_IDS, k, CONIC_NO_ID, "of equal ids the lower Gaussian comes first, and once", row,
                 given_number(j, GIVEN_FLATTEN_IDS, k - 1), INFINITY);
  }
  for (size_t row = 0; row < j->n_rows; row++)
    j->begin[row + 2] += j->begin[row + 1];
  for (size_t k = 0; k < j->n_isects; k++) {
    const double row = given_number(j, GIVEN_FLATTEN_IDS, k);
    if (row >= 0.0 && row < (double)j->n_rows)
      j->places[j->begin[(size_t)row + 1]++] = (uint32_t)k;
  }
  return CONIC_OK;
}

/* The tiles that list the row, and those that have to and do not. */
static void judge_tiles_of(intermediates_judging *j, size_t row, const oracle_projected *p) {
  const int across = j->tile_width;
  for (size_t i = j->begin[row]; i < j->begin[row + 1]; i++) {
    const size_t k = j->places[i];
    const uint64_t id = id_of(j, k), tile = id >> 32;
    const double depth = (double)conic_float_of_bits((uint32_t)id);
    const oracle_range z = conic_oracle_intermediate(p, CONIC_INTERMEDIATE_DEPTHS, 0);
    if (tile >= (uint64_t)across * (uint64_t)j->tile_height)
      continue;
    j->is_listed[tile] = 1;
    if (!conic_oracle_may_list(p, (int)tile % across, (int)tile / across))
      note_entry(j, GIVEN_ISECT_IDS, k, p->g.index, "the Gaussian does not come to that tile", (double)tile,
                 p->first[1].low * across + p->first[0].low,
                 (p->behind[1].high - 1.0) * across + p->behind[0].high - 1.0);
    else if (outside_of(z, depth) > 0.0)
      note_entry(j, GIVEN_ISECT_IDS, k, p->g.index, "its lower half is not the Gaussian's depth", depth, z.low, z.high);
  }
  for (int y = (int)p->first[1].high; y < (int)p->behind[1].low && j->n_isects; y++)
    for (int x = (int)p->first[0].high; x < (int)p->behind[0].low; x++)
      if (!j->is_listed[y * across + x] && conic_oracle_has_to_list(&j->e.bounding.doubting, p, x, y))
        note_entry(j, GIVEN_ISECT_IDS, row, p->g.index, "the Gaussian's tile does not list it", y * across + x,
                   y * across + x, y * across + x);
  for (size_t i = j->begin[row]; i < j->begin[row + 1]; i++) {
    const uint64_t tile = id_of(j, j->places[i]) >> 32;
    if (tile < (uint64_t)across * (uint64_t)j->tile_height)
      j->is_listed[tile] = 0;
  }
}

static void judge_count_of(intermediates_judging *j, size_t row, const oracle_projected *p, int is_left_out) {
  oracle_range r = {0.0, 0.0, 0.0};
  if (!j->given[CONIC_INTERMEDIATE_TILES_PER_GAUSS].name || !j->tile_width)
    return;
  for (int y = (int)p->first[1].low; y < (int)p->behind[1].high && !is_left_out; y++)
    for (int x = (int)p->first[0].low; x < (int)p->behind[0].high; x++) {
      r.high += conic_oracle_may_list(p, x, y) != 0;
      r.low += conic_oracle_has_to_list(&j->e.bounding.doubting, p, x, y) != 0;
    }
  if (j->n_isects)
    r.low = r.high = (double)(j->begin[row + 1] - j->begin[row]);
  r.v = r.high;
  const double found = given_number(j, CONIC_INTERMEDIATE_TILES_PER_GAUSS, row);
  j->verdicts[CONIC_INTERMEDIATE_TILES_PER_GAUSS].judged++;
  if (outside_of(r, found) > 0.0)
    note_entry(j, CONIC_INTERMEDIATE_TILES_PER_GAUSS, row, p->g.index,
               j->n_isects ? "it is not the number of the Gaussian's entries" : NULL, found, r.low, r.high);
}

static void judge_offsets(intermediates_judging *j) {
  const given_array *given = &j->given[GIVEN_ISECT_OFFSETS];
  const size_t n_tiles = (size_t)j->tile_width * (size_t)j->tile_height;
  if (!given->name || !j->n_isects)
    return;
  for (size_t tile = 0, k = 0; tile < n_tiles && tile < given->n; tile++) {
    while (k < j->n_isects && id_of(j, k) >> 32 < tile)
      k++;
    j->verdicts[GIVEN_ISECT_OFFSETS].judged++;
    if (given_number(j, GIVEN_ISECT_OFFSETS, tile) != (double)k)
      note_entry(j, GIVEN_ISECT_OFFSETS, tile, CONIC_NO_ID, "it is not where the tile's entries begin",
                 given_number(j, GIVEN_ISECT_OFFSETS, tile), (double)k, (double)k);
  }
  if (given->n != n_tiles)
    note_entry(j, GIVEN_ISECT_OFFSETS, given->n, CONIC_NO_ID, "there are more tiles, or fewer", (double)given->n,
               (double)n_tiles, (double)n_tiles);
}

/* --- rows --- */

/* Whether theirs is left out: 1, 0, or -1 where that is not told. */
static int is_left_out_there(const intermediates_judging *j, size_t row) {
  const size_t n_columns = columns_given(j, CONIC_INTERMEDIATE_RADII);
  int is_left_out = 0;
  for (size_t k = 0; k < n_columns; k++)
    is_left_out |= !(given_number(j, CONIC_INTERMEDIATE_RADII, row * n_columns + k) > 0.0);
  return n_columns || j->given[GIVEN_GAUSSIAN_IDS].name ? is_left_out : -1;
}

static void note_presence(intermediates_judging *j, int name, size_t row, uint32_t gaussian, const char *what,
                          double found) {
  note_wrong(j, name, 1e30, (conic_judged_array){.row = row, .gaussian = gaussian, .what = what, .found = found});
}

static conic_status judge_rows(intermediates_judging *j) {
  conic_status status = CONIC_OK;
  for (size_t row = 0; row < j->n_rows && status == CONIC_OK; row++) {
    const int is_packed = j->given[GIVEN_GAUSSIAN_IDS].name != NULL, is_left_out = is_left_out_there(j, row);
    oracle_projected p;
    conic_oracle_project(&j->e.bounding.doubting, is_packed ? (size_t)given_number(j, GIVEN_GAUSSIAN_IDS, row) : row,
                         &p);
    if (is_left_out == 1 && !p.may_be_left_out)
      note_presence(j, CONIC_INTERMEDIATE_RADII, row, p.g.index, "it is not left out", 0.0);
    if (is_left_out == 0 && !p.may_be_shown)
      note_presence(j, is_packed ? GIVEN_GAUSSIAN_IDS : CONIC_INTERMEDIATE_RADII, row, p.g.index, "it is left out",
                    is_packed ? (double)p.g.index : given_number(j, CONIC_INTERMEDIATE_RADII, row));
    for (int name = 0; name < CONIC_INTERMEDIATE_TRANSMITTANCES; name++)
      if (name != CONIC_INTERMEDIATE_TILES_PER_GAUSS && p.may_be_shown && is_left_out <= 0 &&
          (is_left_out == 0 || !p.may_be_left_out))
        judge_row_of(j, name, row, &p);
    if (j->n_isects)
      judge_tiles_of(j, row, &p);
    judge_count_of(j, row, &p, is_left_out == 1);
    if (row % 4096 == 0)
      status = conic_progress(j->context, "judge", (double)row / (double)j->n_rows);
  }
  return status;
}

/* Those that no row is of. */
static conic_status judge_missing(intermediates_judging *j) {
  if (!j->given[GIVEN_GAUSSIAN_IDS].name)
    return CONIC_OK;
  char *is_there = conic_memory_allocate_zeroed(j->context, j->count, 1);
  if (!is_there)
    return CONIC_ERROR_MEMORY;
  for (size_t row = 0; row < j->n_rows; row++)
    is_there[(size_t)given_number(j, GIVEN_GAUSSIAN_IDS, row)] = 1;
  j->verdicts[GIVEN_GAUSSIAN_IDS].judged = j->count;
  for (size_t i = 0; i < j->count; i++) {
    oracle_projected p;
    if (is_there[i])
      continue;
    conic_oracle_project(&j->e.bounding.doubting, i, &p);
    if (!p.may_be_left_out)
      note_presence(j, GIVEN_GAUSSIAN_IDS, i, (uint32_t)i, "it is missing, and is not left out", 0.0);
  }
  conic_memory_release(j->context, is_there);
  return CONIC_OK;
}

/* --- the picture --- */

static void take_picture(const intermediates_judging *j, conic_image *image) {
  const given_array *colors = &j->given[GIVEN_COLORS], *alphas = &j->given[GIVEN_ALPHAS];
  const size_t n_pixels = (size_t)image->width * (size_t)image->height;
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  for (size_t i = 0; i < n_pixels; i++) {
    for (size_t c = 0; c < 3 && colors->name; c++)
      rgba[4 * i + c] = (float)given_number(j, GIVEN_COLORS, i * (colors->n / n_pixels) + c);
    if (alphas->name)
      rgba[4 * i + 3] = (float)given_number(j, GIVEN_ALPHAS, i);
  }
  image->lacks_alpha = alphas->name == NULL;
}

static void take_faults(intermediates_judging *j, const uint32_t *faults, size_t n_pixels,
                        const conic_gaussian_verdict *v) {
  for (int name = GIVEN_COLORS; name <= GIVEN_ALPHAS; name++) {
    const uint32_t bits = (name == GIVEN_COLORS ? 7u : 8u) << CONIC_MAX_PLANES;
    j->verdicts[name].judged = j->given[name].name ? n_pixels : 0;
    for (int k = v->n_worst - 1; k >= 0 && j->given[name].name; k--) {
      const conic_oracle_fault *f = &v->worst[k];
      if ((f->channel == 3) == (name == GIVEN_ALPHAS))
        j->verdicts[name] = (conic_judged_array){.judged = n_pixels,
                                                 .row = (size_t)f->y * (size_t)j->e.bounding.width + (size_t)f->x,
                                                 .column = f->channel == 3 ? 0 : f->channel,
                                                 .found = f->found,
                                                 .value = 0.5 * (f->low + f->high),
                                                 .low = f->low,
                                                 .high = f->high};
    }
    for (size_t i = 0; i < n_pixels && j->given[name].name; i++)
      j->verdicts[name].wrong += (faults[i] & bits) != 0;
    j->verdicts[name].gaussian = CONIC_NO_ID;
  }
}

static conic_status judge_picture(intermediates_judging *j, const conic_gaussians *gaussians,
                                  const conic_camera *camera) {
  const size_t n_pixels = (size_t)camera->width * (size_t)camera->height;
  conic_gaussian_judging judging;
  conic_gaussian_verdict verdict;
  conic_image image = {.width = 0};
  conic_gaussian_judging_init(&judging);
  judging.model = &j->e.model;
  if (!j->given[GIVEN_COLORS].name && !j->given[GIVEN_ALPHAS].name)
    return CONIC_OK;
  judging.faults = conic_memory_allocate_zeroed(j->context, n_pixels, sizeof *judging.faults);
  conic_status status =
      judging.faults ? conic_image_allocate(j->context, camera->width, camera->height, 1u << CONIC_PLANE_RGBA, &image)
                     : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    take_picture(j, &image);
    status = conic_gaussian_judge(j->context, gaussians, camera, &j->e.options, &judging, &image, NULL, &verdict);
  }
  if (status == CONIC_OK)
    take_faults(j, judging.faults, n_pixels, &verdict);
  conic_image_release(j->context, &image);
  conic_memory_release(j->context, judging.faults);
  return status;
}

/* --- all --- */

static conic_status read_given(intermediates_judging *j) {
  conic_mapping file;
  conic_zip zip;
  conic_status status = conic_mapping_open(j->context, j->path, &file);
  if (status != CONIC_OK)
    return status;
  status = conic_zip_open(j->context, j->path, file.bytes, file.n_bytes, &zip);
  for (int name = 0; name < N_GIVEN && status == CONIC_OK; name++)
    status = open_given(j, &zip, name);
  conic_mapping_close(j->context, &file);
  return status == CONIC_OK ? check_rows(j) : status;
}

static void tell_verdict(const intermediates_judging *j, conic_intermediates_verdict *verdict) {
  verdict->first_wrong = -1;
  for (int k = 0; k < N_GIVEN; k++) {
    const conic_judged_array *found = &j->verdicts[in_order[k]];
    if (!found->judged && !found->wrong)
      continue;
    conic_judged_array *to = &verdict->arrays[verdict->n_arrays];
    *to = *found;
    to->name = j->given[in_order[k]].name;
    to->stage = about[in_order[k]].stage;
    if (to->wrong && verdict->first_wrong < 0)
      verdict->first_wrong = verdict->n_arrays;
    verdict->n_arrays++;
  }
}

conic_status conic_gaussian_intermediates_judge(conic_context *context, const conic_gaussians *gaussians,
                                                const conic_camera *camera, const conic_gaussian_options *options,
                                                const conic_float_model *model, const char *path,
                                                conic_intermediates_verdict *verdict) {
  conic_float_model fast;
  conic_float_model_init(&fast, CONIC_FLOATS_FAST);
  memset(verdict, 0, sizeof *verdict);
  intermediates_judging *j = conic_memory_allocate_zeroed(context, 1, sizeof *j);
  if (!j)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_oracle_enter(context, gaussians, camera, options, model ? model : &fast, 1, &j->e);
  j->context = context;
  j->path = path;
  if (status == CONIC_OK) {
    j->count = gaussians->count;
    j->tile_width = conic_oracle_has_radii(j->e.view.rules) ? (camera->width + ORACLE_TILE - 1) / ORACLE_TILE : 0;
    j->tile_height = (camera->height + ORACLE_TILE - 1) / ORACLE_TILE;
    status = read_given(j);
  }
  if (status == CONIC_OK)
    status = take_entries(j);
  if (status == CONIC_OK)
    status = judge_rows(j);
  if (status == CONIC_OK)
    status = judge_missing(j);
  if (status == CONIC_OK) {
    judge_offsets(j);
    status = judge_picture(j, gaussians, camera);
  }
  if (status == CONIC_OK)
    tell_verdict(j, verdict);
  for (int name = 0; name < N_GIVEN; name++)
    conic_memory_release(context, j->given[name].block);
  conic_memory_release_these(context, j->begin, j->places, j->is_listed, j);
  return status;
}
