#include "source/shared_source.h"

#include "core/estimate/estimate.h"
#include "core/formats/model_part.h"
#include "core/image/image_common.h"
#include "core/splats/near.h"
#include "core/splats/repairs_log.h"
#include "raster/frame/samples.h"
#include "raster/frame/splat_boxes.h"
#include "source/source_kind.h"
#include "source/splat_exchange.h"
#include "source/window_deal.h"

typedef struct shared_source {
  conic_source base;
  conic_splats part; /* the splats that this process has read … */
  conic_splats held; /* … and those that its windows of one picture need */
  uint32_t *ids;     /* the places of the held ones among all splats */
  conic_repairs repairs;
  conic_render_statistics census; /* counts over all splats in the picture */
} shared_source;

static const conic_triangles no_triangles;

/* --- which files --- */

/* What the first process finds in the files' heads. */
typedef struct files_look {
  int can_share;
  unsigned fields;
  uint64_t n_splats;
} files_look;

enum { NEEDED = CONIC_SPLATS_TANGENTS, HANDED = CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES };

/* Whether the splats depend on nothing but their own axes. */
static int wants_splats(const char *const *paths, size_t n_paths, const conic_source_options *options) {
  int is_plain = (options->as == CONIC_AS_POINTS || options->as == CONIC_AS_AUTO) && !options->where &&
                 !options->texture_path && !options->columns && !options->colors_are &&
                 !conic_coloring_is_asked(options);
  return is_plain && conic_source_kind_find(paths, n_paths, options) == &conic_source_kind_drawing;
}

static void read_as_drawing_does(const conic_source_options *options, conic_read_options *reading) {
  conic_read_options_init(reading);
  reading->cutoff = options->cutoff;
  reading->keeps_alpha = options->keeps_alpha;
}

static int colors_may_be_made(const conic_source_options *options) {
  return options->coloring && options->coloring->by && strcmp(options->coloring->by, "auto") == 0;
}

/* Finds the number of points of each file, into n_points. */
static conic_status look_at_files(conic_context *context, const char *const *paths, size_t n_paths,
                                  const conic_source_options *options, files_look *look, uint64_t *n_points) {
  conic_read_options reading;
  conic_status status = CONIC_OK;
  read_as_drawing_does(options, &reading);
  *look = (files_look){.can_share = wants_splats(paths, n_paths, options)};
  for (size_t i = 0; i < n_paths && look->can_share && status == CONIC_OK; i++) {
    conic_model_shape shape = {.can_part = 0};
    if (!conic_source_kind_of_file(paths[i]) && !conic_gaussians_is_file(context, paths[i]))
      status = conic_model_look(context, paths[i], &reading, &shape);
    look->can_share = shape.can_part && !shape.needs_survey && shape.n_points > 0 &&
                      (shape.fields & NEEDED) == NEEDED && !(shape.fields & ~(unsigned)HANDED);
    look->fields |= shape.fields;
    look->n_splats += n_points[i] = shape.n_points;
  }
  look->can_share &=
      look->n_splats <= CONIC_MAX_POINTS && (look->fields & CONIC_SPLATS_COLORS || !colors_may_be_made(options));
  return status;
}

/* --- reading a part --- */

/* Reading the splats of one file into the part. */
typedef struct part_reading {
  shared_source *source;
  const char *path;
  double origin[3]; /* the file's */
  size_t first, end, next;
} part_reading;

static conic_status take_part_batch(void *cookie, const conic_splats *batch) {
  part_reading *r = cookie;
  conic_splats own = *batch;
  conic_column to[CONIC_SPLATS_COLUMNS], from[CONIC_SPLATS_COLUMNS];
  if (batch->count > r->end - r->next)
    return conic_fail(r->source->base.context, CONIC_ERROR_INPUT, "%s: it changes while it is read", r->path);
  conic_splats_list_columns(&r->source->part, to);
  conic_splats_list_columns(&own, from);
  for (int i = 0; i < CONIC_SPLATS_COLUMNS; i++) {
    float *place = *to[i].floats ? *to[i].floats + r->next : NULL;
    if (place && *from[i].floats)
      memcpy(place, *from[i].floats, batch->count * sizeof *place);
    for (size_t k = 0; place && !*from[i].floats && k < batch->count; k++)
      place[k] = 1.0f; /* white, or opaque */
  }
  memcpy(r->origin, batch->origin, sizeof r->origin);
  r->next += batch->count;
  return CONIC_OK;
}

static conic_status read_piece_of_file(const conic_source_options *options, const conic_points_range *range,
                                       part_reading *r) {
  conic_context *context = r->source->base.context;
  conic_read_options reading;
  const conic_model_survey unneeded = {.n_wanted = 0};
  read_as_drawing_does(options, &reading);
  conic_status status = conic_model_stream_part(context, r->path, &reading, range, &unneeded, take_part_batch, r);
  return status == CONIC_OK && r->next < r->end
             ? conic_fail(context, CONIC_ERROR_INPUT, "%s: it changes while it is read", r->path)
             : status;
}

/* Each process reads the splats after those of the process before it. */
static conic_status read_part_of_files(shared_source *s, const char *const *paths, size_t n_paths,
                                       const uint64_t *n_points, const conic_source_options *options,
                                       part_reading *pieces) {
  uint64_t before = 0, first = s->base.shares.first, end = first + s->part.count;
  conic_status status = CONIC_OK;
  size_t next = 0;
  for (size_t i = 0; i < n_paths && status == CONIC_OK; before += n_points[i], i++) {
    uint64_t low = first > before ? first : before, high = end < before + n_points[i] ? end : before + n_points[i];
    pieces[i] = (part_reading){.source = s, .path = paths[i], .first = next, .end = next, .next = next};
    if (low >= high)
      continue;
    const conic_points_range range = {low - before, high == before + n_points[i] ? UINT64_MAX : high - before};
    next = pieces[i].end += (size_t)(high - low);
    status = read_piece_of_file(options, &range, &pieces[i]);
  }
  return status;
}

/* Measures all splats from the first file's origin. */
static void rebase_part(shared_source *s, const part_reading *pieces, size_t n_paths) {
  const conic_team *team = s->base.shares.team;
  double origins[CONIC_MOST_IN_TEAM][3];
  conic_team_collect(team, pieces[0].origin, sizeof pieces[0].origin, origins);
  memcpy(s->part.origin, origins[0], sizeof s->part.origin);
  for (size_t k = 0; k < n_paths; k++)
    for (int axis = 0; axis < 3; axis++) {
      double shift = pieces[k].origin[axis] - s->part.origin[axis];
      float *position = s->part.position[axis];
      for (size_t i = pieces[k].first; shift != 0.0 && i < pieces[k].end; i++)
        position[i] = (float)((double)position[i] + shift);
    }
}

/* Whether the splats of all processes need no neighbours for repairs. Counts the splats of each file that have no
 * finite place. */
static int repair_parts(shared_source *s, const part_reading *pieces, size_t n_paths, uint64_t *n_nowhere) {
  uint64_t n_needy = 0;
  for (size_t k = 0; k < n_paths; k++) {
    size_t n = 0;
    conic_splats piece = s->part;
    piece.count = pieces[k].end - pieces[k].first;
    conic_column columns[CONIC_SPLATS_COLUMNS];
    conic_splats_list_columns(&piece, columns);
    for (int i = 0; i < CONIC_SPLATS_COLUMNS; i++)
      if (*columns[i].floats)
        *columns[i].floats += pieces[k].first;
    n_needy += !conic_splats_repair_alone(&piece, &n);
    n_nowhere[k] = n;
  }
  conic_shares_take_sums(&s->base.shares, n_nowhere, n_paths);
  conic_shares_take_sums(&s->base.shares, &n_needy, 1);
  return n_needy == 0;
}

/* Measures the parts together as a whole drawing is measured. */
static conic_status measure_shared(shared_source *s) {
  conic_source_scale *scale = &s->base.scale;
  const conic_splats_shares *shares = &s->base.shares;
  conic_shares_bounds(shares, &s->part, scale->minimum, scale->maximum);
  scale->near_z = conic_near_of_box(scale->minimum, scale->maximum);
  scale->n_splats = shares->count;
  scale->has_colors = s->part.color[0] != NULL;
  s->base.no_traits =
      CONIC_TRAIT_FACES | CONIC_TRAIT_EDGES | CONIC_TRAIT_RAW | CONIC_TRAIT_TEXT | CONIC_TRAIT_FRACTIONS;
  return conic_shares_length(s->base.context, shares, &s->part, &scale->splat_length);
}

/* Opens this process's part; *is_shared: the files can be used in parts. */
static conic_status open_part(shared_source *s, const char *const *paths, size_t n_paths,
                              const conic_source_options *options, const files_look *look, const uint64_t *n_points,
                              int *is_shared) {
  conic_context *context = s->base.context;
  const conic_team *team = s->base.shares.team;
  uint64_t *n_nowhere = conic_memory_allocate_zeroed(context, n_paths, sizeof *n_nowhere);
  part_reading *pieces = conic_memory_allocate_zeroed(context, n_paths, sizeof *pieces);
  uint64_t count = (uint64_t)team->count, index = (uint64_t)team->index;
  uint64_t end = (look->n_splats * (index + 1) + count - 1) / count;
  s->base.shares.count = look->n_splats;
  s->base.shares.first = (look->n_splats * index + count - 1) / count;
  conic_status status = n_nowhere && pieces ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = conic_splats_allocate(context, (size_t)(end - s->base.shares.first), look->fields & HANDED, &s->part);
  if (status == CONIC_OK)
    status = read_part_of_files(s, paths, n_paths, n_points, options, pieces);
  status = conic_team_agree(team, status);
  double start = conic_seconds_now();
  if (status == CONIC_OK) {
    rebase_part(s, pieces, n_paths);
    *is_shared = repair_parts(s, pieces, n_paths, n_nowhere);
  }
  if (status == CONIC_OK && *is_shared)
    status = measure_shared(s);
  for (size_t k = 0; k < n_paths && status == CONIC_OK && *is_shared; k++) {
    const conic_repairs repairs = {.nan = (size_t)n_nowhere[k]};
    conic_repairs_log(context, paths[k], &repairs);
    s->repairs.nan += repairs.nan;
  }
  if (status == CONIC_OK) /* a part without a place gives none; reading the whole reports what is wrong */
    *is_shared &= s->repairs.nan < look->n_splats;
  s->base.scale.estimate_seconds = conic_seconds_now() - start;
  conic_memory_release_these(context, n_nowhere, pieces);
  return status;
}

static conic_status try_to_share(conic_context *context, const conic_team *team, const char *const *paths,
                                 size_t n_paths, const conic_source_options *options, uint64_t *n_points,
                                 conic_source **source) {
  files_look look = {.can_share = 0};
  double start = conic_seconds_now();
  int is_shared = 0;
  conic_status status = n_points ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK && team->index == 0)
    status = look_at_files(context, paths, n_paths, options, &look, n_points);
  status = conic_team_agree(team, status);
  if (status != CONIC_OK)
    return status;
  /* The first process's findings go to all. */
  conic_team_collect(team, &look, team->index == 0 ? sizeof look : 0, &look);
  conic_team_collect(team, n_points, team->index == 0 ? n_paths * sizeof *n_points : 0, n_points);
  if (!look.can_share)
    return CONIC_OK;
  status = conic_team_agree(team, conic_source_create(context, &conic_source_kind_shared, paths[0], source));
  if (status == CONIC_OK) {
    (*source)->shares.team = team;
    status = open_part((shared_source *)*source, paths, n_paths, options, &look, n_points, &is_shared);
    (*source)->scale.read_seconds = conic_seconds_now() - start - (*source)->scale.estimate_seconds;
  }
  if (status != CONIC_OK || !is_shared) {
    conic_source_close(*source);
    *source = NULL;
  }
  return status;
}

conic_status conic_source_open_shared(conic_context *context, const conic_team *team, const char *const *paths,
                                      size_t n_paths, const conic_source_options *options, conic_source **source) {
  conic_source_options own;
  conic_source_options_init(&own);
  *source = NULL;
  if (!conic_options_take(&own, options) || n_paths == 0)
    return conic_source_open(context, paths, n_paths, options, source);
  uint64_t *n_points = conic_memory_allocate_zeroed(context, n_paths, sizeof *n_points);
  conic_status status = try_to_share(context, team, paths, n_paths, &own, n_points, source);
  conic_memory_release(context, n_points);
  if (status == CONIC_OK && !*source)
    status = conic_team_agree(team, conic_source_open(context, paths, n_paths, options, source));
  return status;
}

/* --- pictures --- */

static void release_held(shared_source *s) {
  conic_splats_release(s->base.context, &s->held);
  conic_memory_release(s->base.context, s->ids);
  s->ids = NULL;
}

/* From outside, only the part can be looked at. */
static conic_status choose_part(conic_source *source, const conic_camera *camera, const conic_render_options *render,
                                const conic_source_view *view) {
  shared_source *s = (shared_source *)source;
  (void)camera, (void)render, (void)view;
  source->choice.drawing = (conic_drawing){&s->part, &no_triangles};
  return CONIC_OK;
}

/* Sums the counts over all processes. */
static void add_censuses(shared_source *s) {
  conic_render_statistics *census = &s->census;
  uint64_t counts[5 + CONIC_MAX_METHODS] = {census->splats_culled, census->splats_skipped, census->splats_drawn,
                                            census->splats_fallback, census->splats_by_laplace};
  memcpy(counts + 5, census->splats_by_method, sizeof census->splats_by_method);
  conic_shares_take_sums(&s->base.shares, counts, 5 + CONIC_MAX_METHODS);
  census->splats_in = s->base.shares.count;
  census->splats_culled = counts[0];
  census->splats_skipped = counts[1];
  census->splats_drawn = counts[2];
  census->splats_fallback = counts[3];
  census->splats_by_laplace = counts[4];
  memcpy(census->splats_by_method, counts + 5, sizeof census->splats_by_method);
}

/* Finds the splats' boxes on the screen. Bands have cameras of their own, whose rounding differs from that of the whole
 * picture's camera here. */
static conic_status find_own_boxes(conic_source_windows *w, conic_box *boxes) {
  shared_source *s = (shared_source *)w->source;
  conic_camera fine = w->samples == 1 ? w->camera : conic_samples_camera(&w->camera, w->samples, 0, w->camera.height);
  memset(&s->census, 0, sizeof s->census);
  return conic_splats_find_boxes(s->base.context, &s->part, &fine, &w->render, w->planes & CONIC_DRAWN_PLANES, boxes,
                                 &s->census);
}

static conic_status exchange_for(shared_source *s, const conic_dealing *dealing, const int *owners) {
  conic_context *context = s->base.context;
  uint32_t *list = NULL;
  size_t *begin = conic_memory_allocate(context, (size_t)dealing->team->count + 1, sizeof *begin);
  conic_status status = begin ? conic_windows_list_splats(context, dealing, owners, begin, &list) : CONIC_ERROR_MEMORY;
  status = conic_team_agree(dealing->team, status);
  if (status == CONIC_OK)
    status = conic_splats_exchange(context, &s->base.shares, &s->part, begin, list, &s->held, &s->ids);
  conic_memory_release_these(context, list, begin);
  return status;
}

static conic_status deal_shared_windows(conic_source_windows *w, const conic_window *list, size_t n, int is_in_order,
                                        int *owners) {
  shared_source *s = (shared_source *)w->source;
  const conic_team *team = s->base.shares.team;
  conic_box *boxes = conic_memory_allocate(s->base.context, s->part.count, sizeof *boxes);
  conic_status status = conic_team_agree(team, boxes ? find_own_boxes(w, boxes) : CONIC_ERROR_MEMORY);
  const conic_dealing dealing = {.team = team,
                                 .boxes = boxes,
                                 .n_splats = s->part.count,
                                 .list = list,
                                 .n = n,
                                 .samples = w->samples,
                                 .margin = w->band_rows < w->camera.height ? 2 : 0,
                                 .is_in_order = is_in_order};
  if (status == CONIC_OK) {
    add_censuses(s);
    status = conic_windows_deal(s->base.context, &dealing, owners);
  }
  if (status == CONIC_OK)
    status = exchange_for(s, &dealing, owners);
  conic_memory_release(s->base.context, boxes);
  if (status != CONIC_OK)
    return status;
  s->base.choice.drawing.splats = &s->held;
  s->base.choice.ids = s->ids;
  return CONIC_OK;
}

static conic_status begin_shared_windows(conic_source_windows *windows) {
  return conic_source_windowing_choice.begin(windows);
}

static void end_shared_windows(conic_source_windows *windows) {
  shared_source *s = (shared_source *)windows->source;
  conic_source_windowing_choice.end(windows);
  release_held(s);
  s->base.choice.drawing.splats = &s->part;
  s->base.choice.ids = NULL;
}

static conic_status draw_shared_window(conic_source_windows *windows, const conic_window *window, conic_image *image,
                                       conic_render_statistics *statistics) {
  return conic_source_windowing_choice.draw(windows, window, image, statistics);
}

static conic_status count_shared_windows(const conic_source_windows *windows, conic_render_statistics *statistics) {
  const conic_render_statistics *census = &((const shared_source *)windows->source)->census;
  statistics->splats_in = census->splats_in;
  statistics->splats_culled = census->splats_culled;
  statistics->splats_skipped = census->splats_skipped;
  statistics->splats_drawn = census->splats_drawn;
  statistics->splats_fallback = census->splats_fallback;
  statistics->splats_by_laplace = census->splats_by_laplace;
  memcpy(statistics->splats_by_method, census->splats_by_method, sizeof census->splats_by_method);
  return CONIC_OK;
}

static const conic_source_windowing windowing_of_shares = {.begin = begin_shared_windows,
                                                           .end = end_shared_windows,
                                                           .draw = draw_shared_window,
                                                           .count = count_shared_windows,
                                                           .deal = deal_shared_windows};

static void name_shared_image(const conic_source *source, conic_image *image) {
  const uint32_t *ids = source->choice.ids;
  uint32_t *named = image->planes[CONIC_PLANE_ID];
  size_t n = conic_image_pixels(image);
  for (size_t i = 0; named && ids && i < n; i++)
    if (named[i] != CONIC_NO_ID)
      named[i] = ids[named[i]];
}

static void close_shared(conic_source *source) {
  shared_source *s = (shared_source *)source;
  release_held(s);
  conic_splats_release(source->context, &s->part);
}

static void tell_shared_rest(const conic_source *source, conic_facts *facts) {
  conic_facts_add_repairs(facts, &((const shared_source *)source)->repairs);
}

/* No file becomes this kind by itself. */
const conic_source_kind conic_source_kind_shared = {
    .size = sizeof(shared_source),
    .company = CONIC_SOURCE_MANY,
    .close = close_shared,
    .choose = choose_part,
    .windowing = &windowing_of_shares,
    .name_image = name_shared_image,
    .tell_rest = tell_shared_rest,
};
