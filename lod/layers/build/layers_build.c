/* Building a layered point cloud in bounded memory: samples are put aside as they come, sorted roughly by where they
 * are, grown into a tree piece by piece, and written (docs/reference/layers.md). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "conic/layers.h"
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/options.h"
#include "core/base/vectors.h"
#include "core/files/file.h"
#include "core/splats/columns.h"
#include "lod/layers/build/layers_exchange.h"
#include "lod/layers/build/layers_file.h"
#include "lod/layers/build/layers_intake.h"
#include "lod/layers/build/layers_normals.h"
#include "lod/layers/build/layers_team.h"

struct conic_layers_builder {
  conic_context *context;
  char *path;
  conic_layers_options options;
  const conic_team *team; /* null: one process builds all */
  int has_united;
  conic_layers_kept kept;
  conic_layers_intake intake;
  conic_layers_shares shares;
  conic_layers_arrivals arrivals;
  conic_layers_buckets buckets;
  conic_layers_forest forest;
  conic_layers_plan plan;
  conic_layers_header header;
  conic_layers_statistics statistics;
  double started;
};

enum { LEAST_CLOUD = 64, MOST_CLOUD = 32768 };

void conic_layers_options_init_sized(conic_layers_options *options, size_t size) {
  static const conic_layers_options own = {.size = sizeof own,
                                           .cloud_size = 2048,
                                           .memory_bytes = UINT64_C(1) << 30,
                                           .quantum = 0.5,
                                           .quantum_in_spacings = 1,
                                           .cutoff = 1.5f};
  conic_options_give(options, size, &own);
}

static int are_options_sound(const conic_layers_options *options) {
  return options->cloud_size >= LEAST_CLOUD && options->cloud_size <= MOST_CLOUD && options->quantum > 0.0 &&
         options->quantum < 1e15 && options->cutoff > 0.0f && options->cutoff < 1e3f &&
         conic_dot(options->up, options->up) < 1e30;
}

/* What the program itself takes, its libraries and what reads the samples; and what building takes at least. */
static const uint64_t own_bytes = UINT64_C(12) << 20, least_bytes = UINT64_C(4) << 20;

static size_t usable_bytes(const conic_layers_builder *builder) {
  uint64_t bytes = builder->options.memory_bytes;
  bytes = bytes > own_bytes + least_bytes ? bytes - own_bytes : least_bytes;
  return bytes < SIZE_MAX / 2 ? (size_t)bytes : SIZE_MAX / 2;
}

/* Of the memory that building may take, in eighths. First there is what comes in; then its rough order, two thirds of
 * which stay while it grows; then the workers, each with a chunk and room to sort it, branches that wait, and nodes. */
static size_t eighths_of_memory(const conic_layers_builder *builder, size_t n_eighths) {
  return usable_bytes(builder) / 8 * n_eighths;
}

/* How many samples are one chunk at least: a leaf is not parted, nor is what normals are found in. */
static uint64_t least_in_chunk(const conic_layers_plan *plan) {
  return conic_layers_most_in_leaf(plan) * (plan->has_bare ? (uint64_t)CONIC_LAYERS_PATCH_LEAVES : 1);
}

/* A sample of a chunk, its copy for sorting, and keys of the nodes below; and where normals are found, their grid. */
static size_t bytes_in_chunk(const conic_layers_plan *plan) {
  return 2 * plan->sample_bytes + 2 * sizeof(uint64_t) + (plan->has_bare ? 28 : 0);
}

/* Of branches that are kept: no more than what takes seconds, nor than the fraction that one may lose; and enough for
 * all threads. Of smaller ones, more would be kept for each sample. */
static uint64_t most_in_kept(const conic_layers_builder *builder, uint64_t n_workers) {
  enum { MOST = 1 << 19, LEAST_BRANCHES = 32, BRANCHES_A_THREAD = 8 };
  uint64_t n_branches = BRANCHES_A_THREAD * n_workers > LEAST_BRANCHES ? BRANCHES_A_THREAD * n_workers : LEAST_BRANCHES;
  uint64_t n = builder->plan.n_samples / (n_branches * (builder->team ? (uint64_t)builder->team->count : 1));
  return n < MOST ? n : MOST;
}

/* As many workers as there are threads, if there is memory for them; and the larger chunks the more there is. */
static conic_layers_growth plan_growth(conic_layers_builder *builder) {
  const conic_layers_plan *plan = &builder->plan;
  uint64_t n_threads = (uint64_t)conic_context_threads(builder->context), least = least_in_chunk(plan);
  uint64_t bytes = eighths_of_memory(builder, 5), worker = conic_layers_worker_bytes(plan),
           sample = bytes_in_chunk(plan);
  uint64_t n_workers = bytes / (worker + least * sample);
  n_workers = n_workers < n_threads ? n_workers : n_threads;
  n_workers = n_workers ? n_workers : 1;
  uint64_t left = bytes / n_workers > worker ? bytes / n_workers - worker : 0, most = left / sample;
  if (builder->kept.key && most > most_in_kept(builder, n_workers))
    most = most_in_kept(builder, n_workers);
  return (conic_layers_growth){.n_workers = (int)n_workers,
                               .most = most > least ? most : least,
                               .kept = &builder->kept,
                               .waiting_bytes = eighths_of_memory(builder, 1),
                               .node_bytes = eighths_of_memory(builder, 1) / 2};
}

conic_status conic_layers_builder_open(conic_context *context, const char *path, const conic_layers_options *options,
                                       conic_layers_builder **builder) {
  return conic_layers_builder_open_team(context, path, options, NULL, NULL, builder);
}

static conic_status open_builder(conic_context *context, const char *path, const conic_layers_options *options,
                                 const conic_team *team, conic_layers_builder **builder) {
  conic_zstd *zstd;
  conic_layers_options own;
  conic_layers_options_init(&own);
  if ((options && !conic_options_take(&own, options)) || !are_options_sound(&own))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the options of a layered point cloud have no meaning", path);
  conic_status status = conic_zstd_create(context, &zstd); /* told before hours of work, not after */
  if (status != CONIC_OK)
    return status;
  conic_zstd_destroy(context, zstd);
  conic_layers_builder *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->started = conic_seconds_now();
  made->options = own;
  size_t n_path = strlen(path) + 1;
  made->path = conic_memory_allocate(context, n_path, 1);
  status = made->path ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    memcpy(made->path, path, n_path);
    if (!team || team->index == 0)
      conic_output_sweep(context, path);
    status = conic_layers_intake_begin(context, made->path, eighths_of_memory(made, 3), made->options.cutoff,
                                       made->options.keeps_all, team, &made->intake);
  }
  *builder = made;
  return status;
}

conic_status conic_layers_builder_open_team(conic_context *context, const char *path,
                                            const conic_layers_options *options, const conic_team *team,
                                            const conic_layers_keeping *keeping, conic_layers_builder **builder) {
  *builder = NULL;
  conic_status status = conic_team_agree(team, open_builder(context, path, options, team, builder));
  if (status == CONIC_OK)
    status = conic_layers_kept_begin(context, (*builder)->path, team, keeping, &(*builder)->kept);
  if (status == CONIC_OK) {
    (*builder)->team = team;
    return CONIC_OK;
  }
  conic_layers_builder_abandon(*builder);
  *builder = NULL;
  return status;
}

void conic_layers_builder_abandon(conic_layers_builder *builder) {
  if (!builder)
    return;
  if (builder->team && !builder->has_united)
    conic_layers_intake_unite(&builder->intake, CONIC_ERROR_CANCELLED);
  conic_layers_shares_end(&builder->shares);
  conic_layers_arrivals_end(&builder->arrivals);
  conic_layers_intake_end(&builder->intake);
  conic_layers_buckets_end(&builder->buckets);
  conic_layers_forest_end(&builder->forest);
  conic_layers_kept_end(&builder->kept);
  conic_memory_release(builder->context, builder->path);
  conic_memory_release(builder->context, builder);
}

uint64_t conic_layers_builder_finished(const conic_layers_builder *builder) {
  return builder->kept.n_samples;
}

conic_status conic_layers_builder_keep(conic_layers_builder *builder, uint64_t input,
                                       const conic_layers_kept_bytes *pieces, size_t n_pieces) {
  return builder->kept.key ? conic_layers_kept_add_input(&builder->kept, input, pieces, n_pieces) : CONIC_OK;
}

FILE *conic_layers_builder_open_kept(const conic_layers_builder *builder, uint64_t input, uint64_t n_bytes) {
  return conic_layers_kept_open_input(&builder->kept, input, n_bytes);
}

conic_status conic_layers_builder_append(conic_layers_builder *builder, const conic_splats *batch) {
  conic_splats close;
  float *block;
  conic_status status = conic_splats_enter(builder->context, "layers", batch, &close, &block);
  if (status == CONIC_OK)
    status = conic_layers_intake_append(&builder->intake, &close);
  conic_memory_release(builder->context, block);
  return status;
}

conic_status conic_layers_builder_meet(conic_layers_builder *builder, const conic_splats *batch, int *has_colors) {
  conic_status status = builder->team ? conic_layers_intake_meet(&builder->intake, batch, 0) : CONIC_OK;
  *has_colors = builder->team ? builder->intake.has_colors : batch->color[0] != NULL;
  return status;
}

/* The grid: steps of the quantum, as many as the box takes; it lies evenly about the box. Where there would be too
 * many, they are larger. */
static void lay_grid(conic_layers_builder *builder, double quantum) {
  const conic_layers_intake *intake = &builder->intake;
  conic_layers_header *header = &builder->header;
  double extent = 0.0, magnitude = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double length = intake->high[axis] - intake->low[axis];
    extent = length > extent ? length : extent;
    magnitude = fabs(intake->high[axis]) > magnitude ? fabs(intake->high[axis]) : magnitude;
    magnitude = fabs(intake->low[axis]) > magnitude ? fabs(intake->low[axis]) : magnitude;
  }
  double least = extent * (1.0 + 0x1p-20) * 0x1p-21, finest = magnitude * 0x1p-45;
  header->quantum = quantum > least ? quantum : least;
  header->quantum = header->quantum > finest ? header->quantum : finest;
  if (!(header->quantum > 0.0)) /* all in one place, the origin */
    header->quantum = 1.0;
  if (header->quantum > quantum && extent > 0.0)
    conic_log(builder->context, CONIC_LOG_WARNING, "%s: positions are rounded to steps of %g: finer ones are too many",
              builder->path, header->quantum);
  header->bits = 1;
  while (header->bits < CONIC_LAYERS_MOST_BITS &&
         header->quantum * (double)(UINT64_C(1) << header->bits) < extent * (1.0 + 0x1p-20))
    header->bits++;
  double edge = header->quantum * (double)(UINT64_C(1) << header->bits);
  for (int axis = 0; axis < 3; axis++) {
    header->low[axis] = intake->low[axis];
    header->high[axis] = intake->high[axis];
    header->origin[axis] = intake->low[axis] - 0.5 * (edge - (intake->high[axis] - intake->low[axis]));
  }
}

/* The grid of a file that there is, and as many whole steps more below it as the box takes. */
static conic_status continue_grid(conic_layers_builder *builder) {
  const conic_layers_options *options = &builder->options;
  conic_layers_header *header = &builder->header;
  double n_most = 2.0;
  header->quantum = options->quantum;
  for (int axis = 0; axis < 3; axis++) {
    header->low[axis] = builder->intake.low[axis];
    header->high[axis] = builder->intake.high[axis];
    double n_below = ceil((options->corner[axis] - header->low[axis]) / header->quantum);
    header->origin[axis] = options->corner[axis] - (n_below > 0.0 ? n_below * header->quantum : 0.0);
    double n_steps = floor((header->high[axis] - header->origin[axis]) / header->quantum) + 1.0;
    n_most = n_steps > n_most ? n_steps : n_most;
  }
  if (!(n_most <= (double)(UINT64_C(1) << CONIC_LAYERS_MOST_BITS)))
    return conic_fail(
        builder->context, CONIC_ERROR_INPUT,
        "%s: not written: with what is added, there are too many steps of %g: build it anew with larger ones",
        builder->path, header->quantum);
  for (header->bits = 1; (double)(UINT64_C(1) << header->bits) < n_most;)
    header->bits++;
  return CONIC_OK;
}

/* As conic_default_near, of the box. */
static double near_of(const conic_layers_header *header) {
  double diagonal2 = 0.0;
  for (int axis = 0; axis < 3; axis++)
    diagonal2 += (header->high[axis] - header->low[axis]) * (header->high[axis] - header->low[axis]);
  return diagonal2 > 0.0 ? 1e-4 * sqrt(diagonal2) : 1e-4;
}

static conic_status make_plan(conic_layers_builder *builder) {
  conic_layers_header *header = &builder->header;
  const conic_layers_intake *intake = &builder->intake;
  conic_status status = conic_layers_intake_spacing(&builder->intake, &header->spacing);
  if (status != CONIC_OK)
    return status;
  int is_unoriented = builder->options.is_unoriented || intake->n_unseen > 0;
  double unit = builder->options.quantum_in_spacings ? header->spacing : 1.0;
  if (builder->options.has_corner)
    status = continue_grid(builder);
  else
    lay_grid(builder, builder->options.quantum * unit);
  if (status != CONIC_OK)
    return status;
  if (!(header->spacing > 0.0)) /* all coincide: something that can be seen */
    header->spacing = header->quantum;
  conic_layers_payload_settle(&builder->intake.payload, header->spacing);
  header->schema = intake->payload.schema;
  header->version = CONIC_LAYERS_VERSION;
  header->flags = (intake->has_colors ? CONIC_LAYERS_COLORS : 0u) | (is_unoriented ? CONIC_LAYERS_UNORIENTED : 0u);
  header->cloud_size = builder->options.cloud_size;
  double up[3] = {builder->options.up[0], builder->options.up[1], builder->options.up[2]};
  for (int axis = 0; axis < 3 && conic_normalize(up); axis++)
    header->up[axis] = (float)up[axis];
  header->near_z = near_of(header);
  builder->plan = (conic_layers_plan){.context = builder->context,
                                      .bits = header->bits,
                                      .cloud_size = header->cloud_size,
                                      .n_samples = intake->n_samples,
                                      .sample_bytes = header->schema.sample_bytes,
                                      .quantum = header->quantum,
                                      .spacing = header->spacing,
                                      .schema = &header->schema,
                                      .cutoff = builder->options.cutoff,
                                      .is_unoriented = is_unoriented,
                                      .has_bare = intake->n_bare > 0};
  return CONIC_OK;
}

static conic_status refuse_nothing(const conic_layers_builder *builder) {
  const conic_layers_intake *intake = &builder->intake;
  if (intake->n_samples == 0)
    return conic_fail(builder->context, CONIC_ERROR_INPUT, "%s: not written: there is no sample that can be drawn",
                      builder->path);
  if (intake->n_bright > 0)
    conic_log(builder->context, CONIC_LOG_WARNING, "%s: %llu colours are brighter than white, and are kept as white",
              builder->path, (unsigned long long)intake->n_bright);
  return CONIC_OK;
}

/* Where the samples come from that are sorted here: what was taken in, or, with a team, what has come then from all.
 */
static conic_status feed_samples(conic_layers_builder *builder, conic_layers_placing *placing,
                                 conic_layers_feed *feed) {
  const conic_layers_plan *plan = &builder->plan;
  conic_moment start = conic_moment_now();
  conic_layers_placing_init(&builder->intake, plan, builder->header.origin, &builder->kept, "sort", placing);
  conic_status status = conic_layers_shares_find(builder->team, placing, plan, least_in_chunk(plan), &builder->shares);
  *feed = (conic_layers_feed){conic_layers_place_all, placing, builder->intake.n_samples - builder->kept.n_samples};
  if (status != CONIC_OK || !builder->team)
    return status;
  start = conic_team_note(builder->team, "share", start, builder->intake.n_own);
  status = conic_layers_exchange(&builder->shares, placing, builder->path, eighths_of_memory(builder, 4),
                                 &builder->arrivals);
  conic_team_note(builder->team, "exchange", start, builder->arrivals.n_samples);
  conic_layers_intake_end(&builder->intake);
  *feed = (conic_layers_feed){conic_layers_arrivals_run, &builder->arrivals, builder->arrivals.n_samples};
  return status;
}

static int compare_own_cuts(const void *a, const void *b) {
  uint64_t first = *(const uint64_t *)a, second = *(const uint64_t *)b;
  return (first > second) - (first < second);
}

/* Where buckets have to end, and what of that is kept: `own` and `keys` are to be released, on failure too. */
static conic_status find_own(const conic_layers_builder *builder, const conic_layers_kept_branch ***own, size_t *n_own,
                             uint64_t **keys, size_t *n_keys) {
  const conic_layers_kept *kept = &builder->kept;
  const conic_layers_shares *shares = &builder->shares;
  *own = conic_memory_allocate(builder->context, kept->n, sizeof **own);
  *keys = conic_memory_allocate(builder->context, 2 * kept->n + shares->n_own, sizeof **keys);
  *n_own = *n_keys = 0;
  if (!*own || !*keys)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < shares->n_own; i++)
    (*keys)[(*n_keys)++] = shares->own_keys[i];
  for (size_t i = 0; i < kept->n; i++) {
    const conic_layers_kept_branch *branch = &kept->branches[i];
    if (builder->team && conic_layers_shares_owner(shares, branch->key) != builder->team->index)
      continue;
    (*own)[(*n_own)++] = branch;
    (*keys)[(*n_keys)++] = branch->key;
    (*keys)[(*n_keys)++] = branch->key + (UINT64_C(1) << branch->n_bits);
  }
  qsort(*keys, *n_keys, sizeof **keys, compare_own_cuts);
  return CONIC_OK;
}

static conic_status fill_buckets(conic_layers_builder *builder, const conic_layers_growth *growth,
                                 const conic_layers_feed *feed) {
  const conic_layers_kept_branch **own;
  uint64_t *keys;
  size_t n_own, n_keys;
  conic_status status = find_own(builder, &own, &n_own, &keys, &n_keys);
  const conic_layers_cuts cuts = {keys, n_keys};
  if (status == CONIC_OK)
    status = conic_layers_buckets_fill(builder->context, builder->path, feed, &builder->plan, &cuts,
                                       eighths_of_memory(builder, 3) / 2, growth->most, &builder->buckets);
  if (status == CONIC_OK)
    status = conic_layers_buckets_add(&builder->buckets, own, n_own);
  conic_memory_release(builder->context, own);
  conic_memory_release(builder->context, keys);
  return status;
}

static conic_status sort_samples(conic_layers_builder *builder, const conic_layers_growth *growth) {
  conic_layers_placing placing;
  conic_layers_feed feed;
  conic_status status = feed_samples(builder, &placing, &feed);
  conic_moment start = conic_moment_now();
  if (status == CONIC_OK)
    status = fill_buckets(builder, growth, &feed);
  conic_team_note(builder->team, "sort", start, feed.n_samples);
  conic_layers_intake_end(&builder->intake);
  conic_layers_arrivals_end(&builder->arrivals);
  return conic_team_agree(builder->team, status);
}

static conic_status build_layers(conic_layers_builder *builder) {
  conic_layers_growth growth;
  conic_status status = CONIC_OK;
  conic_moment start = conic_moment_now();
  builder->has_united = 1;
  if (builder->team)
    status = conic_layers_intake_unite(&builder->intake, CONIC_OK);
  if (status == CONIC_OK)
    status = conic_team_agree(builder->team, refuse_nothing(builder));
  if (status == CONIC_OK)
    status = make_plan(builder);
  conic_team_note(builder->team, "measure", start, builder->intake.n_own);
  if (status == CONIC_OK) {
    growth = plan_growth(builder);
    status = sort_samples(builder, &growth);
  }
  if (status == CONIC_OK)
    status = conic_layers_forest_grow(&builder->plan, &builder->buckets, &builder->shares, &growth, &builder->forest);
  conic_layers_buckets_end(&builder->buckets);
  return status;
}

static void fill_statistics(conic_layers_builder *builder, double begun, double built) {
  conic_layers_statistics *s = &builder->statistics;
  const conic_layers_header *header = &builder->header;
  s->n_in = builder->intake.n_in;
  s->n_nan = builder->intake.n_nan;
  s->n_zero = builder->intake.n_bare;
  s->n_samples = header->n_samples;
  s->n_clouds = header->n_clouds;
  s->n_bytes = header->file_bytes;
  s->n_levels = (int)header->n_levels;
  s->spacing = header->spacing;
  s->quantum = header->quantum;
  s->read_seconds = begun - builder->started;
  s->work_seconds = built - begun;
  s->write_seconds = conic_seconds_now() - built;
}

conic_status conic_layers_builder_finish(conic_layers_builder *builder, conic_layers_statistics *statistics) {
  double begun = conic_seconds_now();
  conic_status status = build_layers(builder);
  double built = conic_seconds_now();
  int is_built = status == CONIC_OK;
  if (is_built)
    status = conic_layers_write(builder->context, builder->path, builder->team, &builder->forest, &builder->header);
  if (builder->kept.key && is_built) {
    status = conic_team_agree(builder->team, status);
    if (status == CONIC_OK)
      conic_layers_kept_remove(&builder->kept);
  }
  if (status == CONIC_OK && statistics) {
    fill_statistics(builder, begun, built);
    *statistics = builder->statistics;
  }
  conic_layers_builder_abandon(builder);
  return status;
}
