/* Another program's intermediates held against what floats may make of them. */
#include "conic/picture.h"
#include "core/files/mapping.h"
#include "core/files/numpy_array.h"
#include "core/files/zip.h"
#include "oracle/gaussians/oracle_intermediates.h"

/* The arrays in the order in which they are told. */
typedef enum given_name {
  GIVEN_GAUSSIAN_IDS,
  GIVEN_RADII,
  GIVEN_MEANS2D,
  GIVEN_DEPTHS,
  GIVEN_COVARS2D,
  GIVEN_CONICS,
  GIVEN_TILE_BOXES,
  GIVEN_ISECT_IDS,
  GIVEN_FLATTEN_IDS,
  GIVEN_TILES_PER_GAUSS,
  GIVEN_ISECT_OFFSETS,
  GIVEN_OPACITIES,
  GIVEN_COLORS,
  GIVEN_RENDER_COLORS,
  GIVEN_RENDER_ALPHAS,
  N_GIVEN
} given_name;

enum { OF_NO_ROWS = -1 };

static const struct {
  const char *name;
  conic_gaussian_stage stage;
  int kind; /* a conic_intermediate, of what has a row for each Gaussian */
} about[N_GIVEN] = {
    {"gaussian_ids", CONIC_GAUSSIAN_STAGE_PROJECTION, OF_NO_ROWS},
    {"radii", CONIC_GAUSSIAN_STAGE_PROJECTION, CONIC_INTERMEDIATE_RADII},
    {"means2d", CONIC_GAUSSIAN_STAGE_PROJECTION, CONIC_INTERMEDIATE_MEANS2D},
    {"depths", CONIC_GAUSSIAN_STAGE_PROJECTION, CONIC_INTERMEDIATE_DEPTHS},
    {"covars2d", CONIC_GAUSSIAN_STAGE_PROJECTION, CONIC_INTERMEDIATE_COVARS2D},
    {"conics", CONIC_GAUSSIAN_STAGE_PROJECTION, CONIC_INTERMEDIATE_CONICS},
    {"tile_boxes", CONIC_GAUSSIAN_STAGE_SORT, CONIC_INTERMEDIATE_TILE_BOXES},
    {"isect_ids", CONIC_GAUSSIAN_STAGE_SORT, OF_NO_ROWS},
    {"flatten_ids", CONIC_GAUSSIAN_STAGE_SORT, OF_NO_ROWS},
    {"tiles_per_gauss", CONIC_GAUSSIAN_STAGE_SORT, CONIC_INTERMEDIATE_TILES_PER_GAUSS},
    {"isect_offsets", CONIC_GAUSSIAN_STAGE_SORT, OF_NO_ROWS},
    {"opacities", CONIC_GAUSSIAN_STAGE_ALPHA, CONIC_INTERMEDIATE_OPACITIES},
    {"colors", CONIC_GAUSSIAN_STAGE_COLOR, CONIC_INTERMEDIATE_COLORS},
    {"render_colors", CONIC_GAUSSIAN_STAGE_BLENDING, OF_NO_ROWS},
    {"render_alphas", CONIC_GAUSSIAN_STAGE_BLENDING, OF_NO_ROWS},
};

typedef struct given_array {
  unsigned char *block; /* null: it is not there */
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
  int has_picture;
  int tile_width, tile_height;
  size_t *begin;    /* of each row's entries, in `places` */
  uint32_t *places; /* of entries */
  char *is_listed;  /* tiles of one Gaussian */
} intermediates_judging;

static double given_number(const intermediates_judging *j, int name, size_t i) {
  return conic_numpy_array_at(&j->given[name].a, i);
}

/* --- what is there --- */

static int is_there(const intermediates_judging *j, int name) {
  return j->given[name].block != NULL;
}

static conic_status open_given(intermediates_judging *j, const conic_zip *zip, int name) {
  given_array *given = &j->given[name];
  const size_t width = (size_t)j->e.bounding.width, *shape = given->a.shape;
  char file[40];
  size_t n_bytes;
  snprintf(file, sizeof file, "%s.npy", about[name].name);
  if (name >= GIVEN_RENDER_COLORS || !conic_zip_has(zip, file))
    return CONIC_OK;
  conic_status status = conic_zip_read(zip, file, CONIC_MOST_BYTES, &given->block, &n_bytes);
  if (status == CONIC_OK)
    status = conic_numpy_array_open(j->context, j->path, file, given->block, n_bytes, &given->a);
  if (status != CONIC_OK)
    return status;
  const int n_axes = given->a.n_axes;
  given->n = 1;
  for (int axis = 0; axis < n_axes; axis++)
    given->n *= shape[axis];
  if (name == GIVEN_COLORS && n_axes >= 3 && shape[n_axes - 2] == width &&
      shape[n_axes - 3] == (size_t)j->e.bounding.height) {
    j->has_picture = 1; /* whose colours they are */
    conic_memory_release(j->context, given->block);
    given->block = NULL;
  }
  return CONIC_OK;
}

/* Numbers of a row that it has to have; 0: it is not judged by rows. */
static size_t columns_given(const intermediates_judging *j, int name) {
  const int n = about[name].kind == OF_NO_ROWS || !is_there(j, name)
                    ? 0
                    : conic_oracle_intermediate_columns(j->e.view.rules, (conic_intermediate)about[name].kind);
  return name == GIVEN_RADII && n && j->given[name].n == j->n_rows ? 1 : (size_t)n;
}

static conic_status check_rows(intermediates_judging *j) {
  const int is_packed = is_there(j, GIVEN_GAUSSIAN_IDS);
  int n_there = j->has_picture + is_there(j, GIVEN_ISECT_IDS);
  const char *wrong = NULL;
  j->n_rows = is_packed ? j->given[GIVEN_GAUSSIAN_IDS].n : j->count;
  for (int name = 0; name < N_GIVEN && !wrong; name++) {
    const size_t n_columns = columns_given(j, name);
    n_there += n_columns > 0;
    wrong = n_columns && j->given[name].n != j->n_rows * n_columns ? about[name].name : NULL;
  }
  if (wrong)
    return conic_fail(j->context, CONIC_ERROR_INPUT, "%s: %s is not of %zu rows: one camera at a time (at byte 0)",
                      j->path, wrong, j->n_rows);
  for (size_t row = 0; is_packed && row < j->n_rows; row++)
    if (!(given_number(j, GIVEN_GAUSSIAN_IDS, row) >= 0.0 &&
          given_number(j, GIVEN_GAUSSIAN_IDS, row) < (double)j->count))
      return conic_fail(j->context, CONIC_ERROR_INPUT, "%s: gaussian_ids has one that is no Gaussian (at byte 0)",
                        j->path);
  if (j->given[GIVEN_ISECT_IDS].n != j->given[GIVEN_FLATTEN_IDS].n)
    return conic_fail(j->context, CONIC_ERROR_INPUT, "%s: isect_ids and flatten_ids go together (at byte 0)", j->path);
  j->n_isects = conic_oracle_has_radii(j->e.view.rules) ? j->given[GIVEN_ISECT_IDS].n : 0;
  return n_there ? CONIC_OK
                 : conic_fail(j->context, CONIC_ERROR_INPUT,
                              "%s: it has none of radii, means2d, depths, conics, opacities, colors … (at byte 0)",
                              j->path);
}

/* --- findings --- */

static void note_wrong(intermediates_judging *j, int name, double severity, conic_judged_array found) {
  conic_judged_array *to = &j->verdicts[name];
  to->wrong++;
  if (to->wrong > 1 && !(severity > j->severity[name]))
    return;
  j->severity[name] = severity;
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
    oracle_range r =
        name == GIVEN_RADII ? p->radius[k] : conic_oracle_intermediate(p, (conic_intermediate)about[name].kind, (int)k);
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
                                  CONIC_ZEROED(j->is_listed, n_tiles));
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
  if (!columns_given(j, GIVEN_TILES_PER_GAUSS))
    return;
  for (int y = (int)p->first[1].low; y < (int)p->behind[1].high && !is_left_out; y++)
    for (int x = (int)p->first[0].low; x < (int)p->behind[0].high; x++) {
      r.high += conic_oracle_may_list(p, x, y) != 0;
      r.low += conic_oracle_has_to_list(&j->e.bounding.doubting, p, x, y) != 0;
    }
  if (j->n_isects)
    r.low = r.high = (double)(j->begin[row + 1] - j->begin[row]);
  r.v = r.high;
  const double found = given_number(j, GIVEN_TILES_PER_GAUSS, row);
  j->verdicts[GIVEN_TILES_PER_GAUSS].judged++;
  if (outside_of(r, found) > 0.0)
    note_entry(j, GIVEN_TILES_PER_GAUSS, row, p->g.index,
               j->n_isects ? "it is not the number of the Gaussian's entries" : NULL, found, r.low, r.high);
}

static void judge_offsets(intermediates_judging *j) {
  const given_array *given = &j->given[GIVEN_ISECT_OFFSETS];
  const size_t n_tiles = (size_t)j->tile_width * (size_t)j->tile_height;
  if (!given->block || !j->n_isects)
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
  const size_t n_columns = columns_given(j, GIVEN_RADII);
  int is_left_out = 0;
  for (size_t k = 0; k < n_columns; k++)
    is_left_out |= !(given_number(j, GIVEN_RADII, row * n_columns + k) > 0.0);
  return n_columns || is_there(j, GIVEN_GAUSSIAN_IDS) ? is_left_out : -1;
}

static void judge_row(intermediates_judging *j, size_t row, const oracle_projected *p) {
  const int is_left_out = is_left_out_there(j, row);
  if (is_left_out == 1 && !p->may_be_left_out)
    note_entry(j, GIVEN_RADII, row, p->g.index, "it is not left out", 0.0, p->radius[0].low, p->radius[0].high);
  if (is_left_out == 0 && !p->may_be_shown)
    note_entry(j, columns_given(j, GIVEN_RADII) ? GIVEN_RADII : GIVEN_GAUSSIAN_IDS, row, p->g.index, "it is left out",
               (double)row, 0.0, 0.0);
  for (int name = 0; name < N_GIVEN; name++)
    if (name != GIVEN_TILES_PER_GAUSS && p->may_be_shown && is_left_out <= 0 &&
        (is_left_out == 0 || !p->may_be_left_out))
      judge_row_of(j, name, row, p);
  if (j->n_isects)
    judge_tiles_of(j, row, p);
  judge_count_of(j, row, p, is_left_out == 1);
}

static conic_status judge_rows(intermediates_judging *j) {
  const int is_packed = is_there(j, GIVEN_GAUSSIAN_IDS);
  char *has_row = conic_memory_allocate_zeroed(j->context, j->count, 1);
  conic_status status = has_row ? CONIC_OK : CONIC_ERROR_MEMORY;
  oracle_projected p;
  for (size_t row = 0; row < j->n_rows && status == CONIC_OK; row++) {
    const size_t i = is_packed ? (size_t)given_number(j, GIVEN_GAUSSIAN_IDS, row) : row;
    has_row[i] = 1;
    conic_oracle_project(&j->e.bounding.doubting, i, &p);
    judge_row(j, row, &p);
    if (row % 4096 == 0)
      status = conic_progress(j->context, "judge", (double)row / (double)j->n_rows);
  }
  j->verdicts[GIVEN_GAUSSIAN_IDS].judged = is_packed ? j->count : 0;
  for (size_t i = 0; i < j->count && status == CONIC_OK; i++) {
    if (has_row[i])
      continue;
    conic_oracle_project(&j->e.bounding.doubting, i, &p);
    if (!p.may_be_left_out)
      note_entry(j, GIVEN_GAUSSIAN_IDS, i, (uint32_t)i, "it is missing, and is not left out", 0.0, 0.0, 0.0);
  }
  conic_memory_release(j->context, has_row);
  return status;
}

/* --- the picture --- */

/* Shows the first wrong pixel of these channels: the few worst pixels may be wrong in other channels alone. */
static void take_first_fault(const uint32_t *faults, const float *rgba, unsigned channels, conic_judged_array *to) {
  size_t pixel = 0;
  int channel = 0;
  while (!(faults[pixel] & channels << CONIC_MAX_PLANES))
    pixel++;
  while (!(faults[pixel] & (channels & 1u << channel) << CONIC_MAX_PLANES) && channel < 3)
    channel++;
  to->row = pixel;
  to->column = channel == 3 ? 0 : channel;
  to->found = to->value = to->low = to->high = (double)rgba[4 * pixel + (size_t)channel];
  to->what = "it is out of its range";
}

static void take_faults(intermediates_judging *j, const uint32_t *faults, const conic_gaussian_verdict *v,
                        const float *rgba, int has_alpha) {
  const size_t width = (size_t)j->e.bounding.width;
  for (int name = GIVEN_RENDER_COLORS; name <= (has_alpha ? GIVEN_RENDER_ALPHAS : GIVEN_RENDER_COLORS); name++) {
    const int is_alpha = name == GIVEN_RENDER_ALPHAS;
    conic_judged_array *to = &j->verdicts[name];
    *to = (conic_judged_array){.judged = v->judged_pixels, .gaussian = CONIC_NO_ID};
    for (size_t i = 0; i < v->judged_pixels; i++)
      to->wrong += (faults[i] & (is_alpha ? 8u : 7u) << CONIC_MAX_PLANES) != 0;
    int is_listed = 0;
    for (int k = v->n_worst - 1; k >= 0; k--) {
      const conic_oracle_fault *f = &v->worst[k];
      if ((f->channel == 3) != is_alpha)
        continue;
      is_listed = 1;
      to->row = (size_t)f->y * width + (size_t)f->x;
      to->column = is_alpha ? 0 : f->channel;
      to->found = f->found;
      to->low = f->low;
      to->high = f->high;
    }
    if (to->wrong > 0 && !is_listed)
      take_first_fault(faults, rgba, is_alpha ? 8u : 7u, to);
  }
}

static conic_status judge_picture(intermediates_judging *j, const conic_gaussians *gaussians,
                                  const conic_camera *camera) {
  conic_gaussian_judging judging;
  conic_gaussian_verdict verdict;
  conic_picture picture;
  conic_gaussian_judging_init(&judging);
  judging.model = &j->e.model;
  conic_status status = conic_picture_read(j->context, j->path, 1u << CONIC_PLANE_RGBA, NULL, &picture);
  if (status != CONIC_OK)
    return status;
  judging.faults = conic_memory_allocate_zeroed(j->context, j->e.bounding.n_pixels, sizeof *judging.faults);
  if (picture.image.width != camera->width || picture.image.height != camera->height)
    status = conic_fail(j->context, CONIC_ERROR_INPUT, "%s: render_colors is not of the picture's size (at byte 0)",
                        j->path);
  else if (!judging.faults)
    status = CONIC_ERROR_MEMORY;
  else
    status =
        conic_gaussian_judge(j->context, gaussians, camera, &j->e.options, &judging, &picture.image, NULL, &verdict);
  if (status == CONIC_OK)
    take_faults(j, judging.faults, &verdict, picture.image.planes[CONIC_PLANE_RGBA], !picture.image.lacks_alpha);
  conic_picture_release(j->context, &picture);
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
  j->has_picture |= status == CONIC_OK && conic_zip_has(&zip, "render_colors.npy");
  conic_mapping_close(j->context, &file);
  return status == CONIC_OK ? check_rows(j) : status;
}

static void tell_verdict(const intermediates_judging *j, conic_intermediates_verdict *verdict) {
  for (int name = 0; name < N_GIVEN; name++) {
    conic_judged_array *to = &verdict->arrays[verdict->n_arrays];
    if (!j->verdicts[name].judged && !j->verdicts[name].wrong)
      continue;
    *to = j->verdicts[name];
    to->name = about[name].name;
    to->stage = about[name].stage;
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
    const int tile = conic_profile_tile(j->e.view.rules, camera);
    j->count = gaussians->count;
    j->tile_width = conic_oracle_has_radii(j->e.view.rules) ? (camera->width + tile - 1) / tile : 0;
    j->tile_height = (camera->height + tile - 1) / tile;
    status = read_given(j);
  }
  if (status == CONIC_OK)
    status = take_entries(j);
  if (status == CONIC_OK)
    status = judge_rows(j);
  if (status == CONIC_OK)
    judge_offsets(j);
  if (status == CONIC_OK && j->has_picture)
    status = judge_picture(j, gaussians, camera);
  if (status == CONIC_OK)
    tell_verdict(j, verdict);
  for (int name = 0; name < N_GIVEN; name++)
    conic_memory_release(context, j->given[name].block);
  conic_memory_release_these(context, j->begin, j->places, j->is_listed, j);
  return status;
}
