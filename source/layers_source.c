/* Layered point clouds: a .lpc or its URL, which draws itself in bounded memory. */
#include <inttypes.h>

#include "core/image/image_common.h"
#include "lod/layers/draw/layers_gather.h"
#include "lod/layers/draw/layers_picture.h"
#include "raster/frame/samples.h"
#include "source/source_kind.h"

typedef struct layers_source {
  conic_source base;
  conic_layers *layers;
  float cutoff;
  uint64_t n_clouds;
  int may_pass_none; /* so far no sample is known to pass the filter */
  conic_layers_drawn drawn;
} layers_source;

static int is_layers_file(const char *path) {
  return (conic_layers_is_url(path) && !conic_hybrid_is_url(path)) || conic_layers_is_file(path) ||
         conic_layers_is_hierarchy(path);
}

static const char *name_layers_file(const char *path) {
  const char *name = conic_hierarchy_name_of(path);
  return name ? name : "lpc";
}

static int takes_layers(const char *path, const conic_source_options *options) {
  return !options->is_whole && options->as != CONIC_AS_PATCHES && is_layers_file(path);
}

static conic_status open_layers(conic_source *source, const char *const *paths, size_t n_paths,
                                const conic_source_options *options) {
  layers_source *l = (layers_source *)source;
  conic_source_scale *scale = &source->scale;
  conic_layers_scale found;
  (void)n_paths;
  conic_status status = conic_layers_open(source->context, paths[0], options->access, &l->layers);
  if (status != CONIC_OK)
    return status;
  if (options->coloring || options->where)
    status = conic_layers_choose(l->layers, options->coloring, options->where, &source->coloring);
  if (status != CONIC_OK)
    return status;
  conic_layers_measure(l->layers, options->cutoff, &found);
  memcpy(scale->minimum, found.minimum, sizeof scale->minimum);
  memcpy(scale->maximum, found.maximum, sizeof scale->maximum);
  scale->near_z = found.near_z;
  scale->splat_length = found.splat_length;
  scale->spacing = found.spacing;
  scale->n_splats = found.n_samples;
  scale->n_levels = found.n_levels;
  scale->has_colors = found.has_colors;
  if (conic_layers_schema_find(&l->layers->header.schema, CONIC_LAYERS_OPACITY) < 0)
    source->no_traits = CONIC_TRAIT_ALPHA;
  if (found.up[0] != 0.0 || found.up[1] != 0.0 || found.up[2] != 0.0) {
    memcpy(scale->up, found.up, sizeof scale->up);
    scale->up_basis = CONIC_UP_KIND;
  }
  l->cutoff = options->cutoff;
  scale->follows_cutoff = 1;
  l->n_clouds = found.n_clouds;
  l->may_pass_none = options->where != NULL;
  return CONIC_OK;
}

static void close_layers(conic_source *source) {
  conic_layers_close(((layers_source *)source)->layers);
}

static conic_status see_sample(void *cookie, const conic_splats *batch) {
  (void)batch;
  ((layers_source *)cookie)->may_pass_none = 0;
  return CONIC_ERROR_CANCELLED; /* one sample is enough */
}

/* After an empty picture: finds out whether any sample passes the filter, for which it may have to read the whole
 * file. */
static conic_status refuse_none(layers_source *l) {
  conic_status status = conic_layers_read_samples(l->layers, l->cutoff, NULL, see_sample, l);
  if (!l->may_pass_none)
    return CONIC_OK;
  return status == CONIC_OK ? conic_fail(l->base.context, CONIC_ERROR_INPUT,
                                         "%s: cannot be drawn: no point passes --where", l->base.name)
                            : status;
}

static conic_layers_draw_options wish_of(const conic_source_view *view) {
  conic_layers_draw_options options;
  conic_layers_draw_options_init(&options);
  options.error_px = view->error_px;
  options.budget = view->budget;
  options.most_levels = view->most_levels;
  options.occlusion = view->occlusion;
  options.samples = view->samples;
  options.may_be_coarser = view->may_be_coarser;
  options.seconds = view->seconds;
  options.tolerates_damage = view->tolerates_damage;
  options.transparency = view->transparency;
  options.chance = view->chance;
  return options;
}

static conic_status finish_picture(layers_source *l, const conic_render_statistics *statistics) {
  l->base.choice = (conic_source_choice){
      .error_px = l->drawn.error_px, .n_culled = l->drawn.n_clouds_culled, .n_levels = l->drawn.n_levels};
  if (statistics->splats_in > 0)
    l->may_pass_none = 0;
  return l->may_pass_none && !l->base.view.may_be_coarser ? refuse_none(l) : CONIC_OK;
}

static conic_status draw_layers(conic_source *source, conic_renderer *renderer, const conic_camera *camera,
                                const conic_render_options *render, const conic_source_view *view, conic_image *image,
                                conic_render_statistics *statistics) {
  layers_source *l = (layers_source *)source;
  conic_render_statistics own;
  conic_layers_draw_options options = wish_of(view);
  options.only_samples = source->only_samples;
  statistics = statistics ? statistics : &own;
  conic_status status = conic_layers_draw(l->layers, renderer, camera, render, &options, image, statistics, &l->drawn);
  return status == CONIC_OK ? finish_picture(l, statistics) : status;
}

/* --- in windows --- */

static conic_status begin_layers_windows(conic_source_windows *windows) {
  layers_source *l = (layers_source *)windows->source;
  const conic_layers_draw_options options = wish_of(&l->base.view);
  conic_layers_picture *picture;
  windows->step = CONIC_WINDOW_STEP;
  windows->band_rows = conic_samples_band_rows(&windows->camera, windows->samples);
  windows->is_summed = 1;
  uint64_t n_bytes =
      conic_planes_pixel_bytes(windows->planes) * (uint64_t)windows->camera.width * (uint64_t)windows->camera.height;
  conic_status status = conic_layers_picture_begin(l->layers, windows->renderer, &windows->camera, &windows->render,
                                                   &options, n_bytes, &picture);
  windows->own = picture;
  return status;
}

static void end_layers_windows(conic_source_windows *windows) {
  conic_layers_picture_end(windows->own);
}

static conic_status draw_layers_window(conic_source_windows *windows, const conic_window *window, conic_image *image,
                                       conic_render_statistics *statistics) {
  conic_layers_tally tally = {.n_turned = 0};
  conic_status status =
      conic_layers_picture_draw(windows->own, window, windows->other_bytes, image, statistics, &tally);
  const uint64_t counts[] = {tally.n_turned, tally.n_clouds_read, tally.n_bytes_received, tally.n_bands};
  for (int i = 0; i < CONIC_SOURCE_TALLIES; i++)
    windows->tallies[i] += counts[i];
  return status;
}

static conic_status count_layers_windows(const conic_source_windows *windows, conic_render_statistics *statistics) {
  layers_source *l = (layers_source *)windows->source;
  const uint64_t *counts = windows->tallies;
  const conic_layers_tally tally = {counts[0], counts[1], counts[2], counts[3]};
  conic_layers_picture_tell(windows->own, statistics, &tally, &l->drawn);
  return finish_picture(l, statistics);
}

static void weigh_layers_windows(const conic_source_windows *windows, const conic_window *list, size_t n,
                                 double *weights) {
  conic_layers_picture_weigh(windows->own, list, n, weights);
}

static const conic_source_windowing windowing_of_layers = {.begin = begin_layers_windows,
                                                           .end = end_layers_windows,
                                                           .draw = draw_layers_window,
                                                           .count = count_layers_windows,
                                                           .weigh = weigh_layers_windows};

static void tell_layers_rest(const conic_source *source, conic_facts *facts) {
  const conic_layers_drawn *d = &((const layers_source *)source)->drawn;
  CONIC_ADD_FACTS(facts, CONIC_OBJECT("layers"), CONIC_COUNT("clouds", ((const layers_source *)source)->n_clouds),
                  CONIC_COUNT("clouds_drawn", d->n_clouds), CONIC_COUNT("clouds_grazing", d->n_clouds_grazing),
                  CONIC_COUNT("clouds_read", d->n_clouds_read), CONIC_COUNT("clouds_missing", d->n_clouds_missing),
                  CONIC_COUNT("clouds_damaged", d->n_clouds_damaged), CONIC_COUNT("places", d->n_places),
                  CONIC_COUNT("places_hidden", d->n_places_hidden), CONIC_COUNT("places_grazing", d->n_places_grazing),
                  CONIC_COUNT("places_coarser", d->n_places_coarser), CONIC_NUMBER("coarser_px", d->missing_error_px),
                  CONIC_COUNT("splats_hidden", d->n_splats_left), CONIC_COUNT("splats_turned", d->n_splats_turned),
                  CONIC_COUNT("levels", d->n_levels), CONIC_COUNT("bands", d->n_bands),
                  CONIC_COUNT("bytes_received", d->n_bytes_received));
  if (source->view.most_levels > 0) /* one after each level */
    CONIC_ADD_FACTS(facts, CONIC_COUNT("pictures", source->view.most_levels));
  CONIC_ADD_FACTS(facts, CONIC_END);
}

static void tell_system(const conic_layers *layers, conic_facts *facts) {
  conic_georeference reference;
  if (conic_layers_find_georeference(layers, &reference) != CONIC_OK)
    return;
  conic_facts_add_system(facts, &reference);
  conic_georeference_release(facts->context, &reference);
}

/* Facts of another kind's hierarchy, or of one on a web server: opening it finds them. */
static conic_status tell_hierarchy(conic_source *source, conic_facts *facts) {
  conic_layers *layers;
  conic_layers_scale found;
  conic_status status = conic_layers_open(source->context, source->name, NULL, &layers);
  if (status != CONIC_OK)
    return status;
  conic_layers_measure(layers, 1.5f, &found);
  tell_system(layers, facts);
  CONIC_ADD_FACTS(facts, CONIC_COUNT("points", found.n_samples), CONIC_TRUTH("colors", found.has_colors),
                  CONIC_NUMBER("spacing", found.spacing), CONIC_NUMBER("near", found.near_z),
                  CONIC_LINE("points", "%" PRIu64 "%s", found.n_samples, found.has_colors ? ", with colours" : ""),
                  CONIC_LINE("spacing", "about %.4g", found.spacing));
  conic_facts_add_bounds(facts, found.minimum, found.maximum);
  conic_layers_close(layers);
  return CONIC_OK;
}

static conic_status tell_hierarchy_defects(conic_source *source, conic_facts *facts) {
  conic_layers *layers;
  uint64_t n_damaged = 0;
  conic_status status = conic_layers_open(source->context, source->name, NULL, &layers);
  if (status != CONIC_OK)
    return status;
  status = conic_layers_count_damaged(layers, &n_damaged);
  conic_layers_close(layers);
  if (status == CONIC_OK)
    CONIC_ADD_FACTS(facts, CONIC_DEFECT("clouds", n_damaged, "nodes or pages that are damaged"));
  return status;
}

/* The values that --color-by and --where take. */
static conic_status tell_layers_values(conic_source *source, conic_facts *facts) {
  conic_layers_file file;
  int n_told = 0;
  conic_status status = conic_layers_file_open(source->context, source->name, &file);
  if (status != CONIC_OK)
    return status;
  if (file.header.epsg)
    CONIC_ADD_FACTS(facts, CONIC_COUNT("epsg", file.header.epsg),
                    CONIC_LINE("system", "EPSG:%u", (unsigned)file.header.epsg));
  for (uint32_t i = 0; i < file.header.schema.n; i++) {
    const conic_layers_attribute *value = &file.header.schema.list[i];
    if (value->kind != CONIC_LAYERS_VALUE)
      continue;
    if (n_told++ == 0)
      CONIC_ADD_FACTS(facts, CONIC_ARRAY("values"));
    CONIC_ADD_FACTS(facts, CONIC_OBJECT(NULL), conic_fact_text(CONIC_FACT_TEXT, "name", "%s", value->name),
                    conic_fact_text(CONIC_FACT_TEXT, "type", "%s", conic_layers_number_name(value->type)),
                    CONIC_NUMBER("minimum", value->low), CONIC_NUMBER("maximum", value->high), CONIC_END,
                    conic_facts_range(n_told == 1, value->name, value->low, value->high));
  }
  if (n_told)
    CONIC_ADD_FACTS(facts, CONIC_END);
  conic_layers_file_close(&file);
  return CONIC_OK;
}

static conic_status tell_layers_file(conic_source *source, conic_facts *facts) {
  conic_layers_info info;
  if (!conic_layers_is_file(source->name))
    return tell_hierarchy(source, facts);
  conic_status status = conic_layers_describe(source->context, source->name, &info);
  if (status != CONIC_OK)
    return status;
  const double bits = 8.0 * (double)info.n_bytes / (double)info.n_samples;
  CONIC_ADD_FACTS(facts, CONIC_COUNT("points", info.n_samples), CONIC_COUNT("clouds", info.n_clouds),
                  CONIC_COUNT("levels", info.n_levels), CONIC_COUNT("cloud_size", info.cloud_size),
                  CONIC_COUNT("largest_cloud", info.most_samples), CONIC_TRUTH("colors", info.has_colors),
                  CONIC_TRUTH("oriented", !info.is_unoriented), CONIC_NUMBER("bits_per_sample", bits),
                  CONIC_OBJECT("bits"), CONIC_NUMBER("position", info.bits_position),
                  CONIC_NUMBER("normal", info.bits_normal), CONIC_NUMBER("colour", info.bits_color),
                  CONIC_NUMBER("index", info.bits_index), CONIC_NUMBER("more", info.bits_more), CONIC_END,
                  CONIC_NUMBER("spacing", info.spacing), CONIC_NUMBER("quantum", info.quantum),
                  CONIC_NUMBER("position_error", info.position_error), CONIC_NUMBER("splat_radius", info.splat_radius),
                  CONIC_NUMBER("near", info.near_z),
                  CONIC_LINE("samples", "%" PRIu64 "%s%s", info.n_samples, info.has_colors ? ", with colours" : "",
                             info.is_unoriented ? ", normals without a side" : ""),
                  CONIC_LINE("clouds", "%" PRIu64 " in %d levels, %u samples asked for, %u in the largest",
                             info.n_clouds, info.n_levels, (unsigned)info.cloud_size, (unsigned)info.most_samples),
                  CONIC_LINE("spacing", "%.4g; positions in steps of %.4g, moved by %.3g at most", info.spacing,
                             info.quantum, info.position_error),
                  CONIC_LINE("outline", "%.4g, the median at full resolution", info.splat_radius));
  if (info.up[0] != 0.0 || info.up[1] != 0.0 || info.up[2] != 0.0)
    CONIC_ADD_FACTS(facts, CONIC_ARRAY("up"), CONIC_NUMBER(NULL, info.up[0]), CONIC_NUMBER(NULL, info.up[1]),
                    CONIC_NUMBER(NULL, info.up[2]), CONIC_END,
                    CONIC_LINE("up", "%.3g %.3g %.3g", info.up[0], info.up[1], info.up[2]));
  conic_facts_add_bounds(facts, info.minimum, info.maximum);
  CONIC_ADD_FACTS(
      facts, CONIC_LINE("bits", "%.2f a sample: position %.2f, normal %.2f, colour %.2f, index %.2f, more %.2f", bits,
                        info.bits_position, info.bits_normal, info.bits_color, info.bits_index, info.bits_more));
  return tell_layers_values(source, facts);
}

static conic_status tell_layers_defects(conic_source *source, conic_facts *facts) {
  conic_layers_defects broken;
  if (!conic_layers_is_file(source->name))
    return tell_hierarchy_defects(source, facts);
  conic_status status = conic_layers_check(source->context, source->name, &broken);
  if (status == CONIC_OK)
    CONIC_ADD_FACTS(facts, CONIC_DEFECT("clouds", broken.clouds, "clouds that are damaged"),
                    CONIC_DEFECT("coverage", broken.coverage, "clouds that do not cover their place as they say"),
                    CONIC_DEFECT("spheres", broken.spheres, "clouds whose sphere does not hold their place"),
                    CONIC_DEFECT("cones", broken.cones, "clouds whose cone does not hold their normals"));
  return status;
}

/* Gathered splats are copied once more for drawing. */
static conic_status gather_layers(conic_source *source, const conic_layers_region *part, int may_cut,
                                  const conic_splats **splats, int *is_cut_short) {
  enum { COPY_BYTES = 14 * sizeof(float) };
  layers_source *l = (layers_source *)source;
  size_t most = conic_layers_drawing_bytes(l->layers) / (CONIC_LAYERS_SPLAT_BYTES + COPY_BYTES) + 1;
  conic_layers_set *set;
  conic_status status = conic_layers_gather_part(l->layers, l->cutoff, part, may_cut ? most : 0, &set);
  *splats = &set->splats;
  *is_cut_short = status == CONIC_OK && set->is_cut_short;
  return status;
}

static conic_status find_layers_georeference(const conic_source *source, conic_georeference *reference) {
  return conic_layers_find_georeference(((const layers_source *)source)->layers, reference);
}

/* Measures positions from the world's origin, not the file's. */
static conic_status take_layers_splats(conic_source *source, conic_splats *splats) {
  const layers_source *l = (layers_source *)source;
  conic_splats samples;
  memset(splats, 0, sizeof *splats);
  conic_status status = conic_layers_splats(l->layers, l->cutoff, &samples);
  if (status == CONIC_OK)
    status = conic_splats_append(source->context, splats, &samples);
  conic_splats_release(source->context, &samples);
  return status;
}

static conic_status draw_layers_boxes(conic_source *source, const conic_camera *camera, int level,
                                      const conic_image *image, conic_image *map) {
  return conic_layers_draw_boxes(((layers_source *)source)->layers, camera, level, image, map);
}

const conic_source_kind conic_source_kind_layers = {
    .size = sizeof(layers_source),
    .abilities = CONIC_SOURCE_CHOOSES | CONIC_SOURCE_STREAMS | CONIC_SOURCE_READS_PARTS,
    .company = CONIC_SOURCE_SINGLE,
    .takes = takes_layers,
    .open = open_layers,
    .close = close_layers,
    .draw = draw_layers,
    .windowing = &windowing_of_layers,
    .draw_boxes = draw_layers_boxes,
    .tell_rest = tell_layers_rest,
    .is_file = is_layers_file,
    .name = "lpc",
    .name_file = name_layers_file,
    .tell_file = tell_layers_file,
    .tell_defects = tell_layers_defects,
    .gather = gather_layers,
    .find_georeference = find_layers_georeference,
    .take_splats = take_layers_splats,
};
