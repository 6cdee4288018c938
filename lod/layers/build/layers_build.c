/* Building a layered point cloud in bounded memory: samples are put aside as they come, sorted roughly by where they
 * are, grown into a tree piece by piece, and written (docs/reference/layers.md). */

#include "core/base/vectors.h"
#include "core/files/file.h"
#include "core/splats/columns.h"
#include "core/splats/near.h"
#include "lod/layers/build/layers_grow.h"

struct conic_layers_builder {
  conic_context *context;
  char *path;
  conic_layers_options options;
  const conic_team *team; /* null: one process builds all */
  int has_combined;
  conic_layers_kept kept;
  conic_layers_raws raws;
  conic_layers_parts parts;
  conic_layers_received received;
  conic_layers_buckets buckets;
  conic_layers_tree tree;
  conic_layers_plan plan;
  conic_layers_header header;
  conic_layers_statistics statistics;
  double started;
};

enum { LEAST_CLOUD = 64, MOST_CLOUD = 32768 };

CONIC_DEFINE_OPTIONS(conic_layers_options, .cloud_size = 2048, .memory_bytes = UINT64_C(1) << 30, .quantum = 0.5,
                     .quantum_in_spacings = 1, .cutoff = 1.5f)

static int are_options_sound(const conic_layers_options *options) {
  return options->cloud_size >= LEAST_CLOUD && options->cloud_size <= MOST_CLOUD && options->quantum > 0.0 &&
         options->quantum < 1e15 && options->cutoff > 0.0f && options->cutoff < 1e3f &&
         conic_dot(options->up, options->up) < 1e30 && options->epsg <= UINT16_MAX;
}

/* What the program itself takes, its libraries and what reads the samples; and what building takes at least. */
static const uint64_t own_bytes = UINT64_C(12) << 20, least_bytes = UINT64_C(4) << 20;

static size_t usable_bytes(const conic_layers_builder *builder) {
  uint64_t bytes = builder->options.memory_bytes;
  bytes = bytes > own_bytes + least_bytes ? bytes - own_bytes : least_bytes;
  return bytes < SIZE_MAX / 2 ? (size_t)bytes : SIZE_MAX / 2;
}

/* A share of the memory that building may take. At first what comes in needs it. Then its rough order does, two thirds
 * of which stay while the tree grows. Beside these there are the workers, each with a chunk and room to sort it, nodes
 * that wait for their parents, and entries. */
static size_t eighths_of_memory(const conic_layers_builder *builder, size_t n_eighths) {
  return usable_bytes(builder) / 8 * n_eighths;
}

/* How many samples are one chunk at least: neither a leaf is split, nor a patch in which normals are found. */
static uint64_t least_in_chunk(const conic_layers_plan *plan) {
  return conic_layers_most_in_leaf(plan) * (plan->has_bare ? (uint64_t)CONIC_LAYERS_PATCH_LEAVES : 1);
}

/* What a sample of a chunk takes: itself, its copy for sorting, keys of the nodes below, and the grid where normals are
 * found. */
static size_t bytes_in_chunk(const conic_layers_plan *plan) {
  return 2 * plan->sample_bytes + 2 * sizeof(uint64_t) + (plan->has_bare ? 28 : 0);
}

/* How many samples a chunk has at most, however much memory there is: few enough that all threads have chunks. Where
 * branches are kept, each is a chunk. It takes no more than seconds to grow, and is no more than the fraction that may
 * be lost. Smaller chunks would take and keep more for each sample. */
static uint64_t most_to_share(const conic_layers_builder *builder, uint64_t n_workers) {
  enum { MOST = 1 << 19, LEAST_BRANCHES = 32, CHUNKS_A_THREAD = 8 };
  uint64_t n_chunks = n_workers > 1 ? CHUNKS_A_THREAD * n_workers : 1;
  if (builder->kept.key && n_chunks < LEAST_BRANCHES)
    n_chunks = LEAST_BRANCHES;
  uint64_t n = builder->plan.n_samples / (n_chunks * (builder->team ? (uint64_t)builder->team->count : 1));
  return n < MOST || !builder->kept.key ? n : MOST;
}

/* As many workers as there are threads, if there is memory for them. The more memory, the larger are the chunks. */
static conic_layers_growth plan_growth(conic_layers_builder *builder) {
  const conic_layers_plan *plan = &builder->plan;
  uint64_t n_threads = (uint64_t)conic_context_threads(builder->context), least = least_in_chunk(plan);
  uint64_t bytes = eighths_of_memory(builder, 5), worker = conic_layers_worker_bytes(plan),
           sample = bytes_in_chunk(plan);
  uint64_t n_workers = bytes / (worker + least * sample);
  n_workers = n_workers < n_threads ? n_workers : n_threads;
  n_workers = n_workers ? n_workers : 1;
  uint64_t left = bytes / n_workers > worker ? bytes / n_workers - worker : 0, most = left / sample;
  if (most > most_to_share(builder, n_workers))
    most = most_to_share(builder, n_workers);
  return (conic_layers_growth){.n_workers = (int)n_workers,
                               .most = most > least ? most : least,
                               .kept = &builder->kept,
                               .pool_bytes = eighths_of_memory(builder, 1),
                               .entry_bytes = eighths_of_memory(builder, 1) / 2};
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
      status = conic_output_sweep(context, path);
    conic_layers_raws_begin(context, made->path, eighths_of_memory(made, 3), made->options.cutoff,
                            made->options.keeps_all, team, &made->raws);
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
  if (builder->team && !builder->has_combined)
    conic_layers_raws_combine(&builder->raws, CONIC_ERROR_CANCELLED);
  conic_layers_parts_end(&builder->parts);
  conic_layers_received_end(&builder->received);
  conic_layers_raws_end(&builder->raws);
  conic_layers_buckets_end(&builder->buckets);
  conic_layers_tree_end(&builder->tree);
  conic_layers_kept_end(&builder->kept);
  conic_memory_release_these(builder->context, builder->path, builder);
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
    status = conic_layers_raws_append(&builder->raws, &close);
  conic_memory_release(builder->context, block);
  return status;
}

conic_status conic_layers_builder_agree(conic_layers_builder *builder, const conic_splats *batch, int *has_colors) {
  conic_status status = builder->team ? conic_layers_raws_agree(&builder->raws, batch, 0) : CONIC_OK;
  *has_colors = builder->team ? builder->raws.has_colors : batch->color[0] != NULL;
  return status;
}

/* Steps of more sampling distances than this are warned of: pictures show them. */
static const double LONG_STEP = 4.0;

/* Lays the grid evenly about the box, in as many steps of the quantum as that takes. Where there would be too many, the
 * steps are larger. Errors: ARGUMENT (the cloud is smaller than a step). */
static conic_status lay_grid(conic_layers_builder *builder, double quantum) {
  const conic_layers_facts *facts = &builder->raws.payload.facts;
  conic_layers_header *header = &builder->header;
  double extent = 0.0, magnitude = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double length = facts->high[axis] - facts->low[axis];
    extent = length > extent ? length : extent;
    magnitude = fabs(facts->high[axis]) > magnitude ? fabs(facts->high[axis]) : magnitude;
    magnitude = fabs(facts->low[axis]) > magnitude ? fabs(facts->low[axis]) : magnitude;
  }
  if (quantum > extent && extent > 0.0)
    return conic_fail(builder->context, CONIC_ERROR_ARGUMENT,
                      "%s: not written: positions would be rounded to steps of %g, and all lie within %g",
                      builder->path, quantum, extent);
  if (quantum > LONG_STEP * header->spacing && header->spacing > 0.0)
    conic_log(builder->context, CONIC_LOG_WARNING, "%s: positions are rounded to steps of %g, samples lie %g apart",
              builder->path, quantum, header->spacing);
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
    header->low[axis] = facts->low[axis];
    header->high[axis] = facts->high[axis];
    header->origin[axis] = facts->low[axis] - 0.5 * (edge - (facts->high[axis] - facts->low[axis]));
  }
  return CONIC_OK;
}

/* Takes the grid of a file that there is, and adds as many whole steps below it as the box takes. */
static conic_status continue_grid(conic_layers_builder *builder) {
  const conic_layers_options *options = &builder->options;
  conic_layers_header *header = &builder->header;
  double n_most = 2.0;
  header->quantum = options->quantum;
  for (int axis = 0; axis < 3; axis++) {
    header->low[axis] = builder->raws.payload.facts.low[axis];
    header->high[axis] = builder->raws.payload.facts.high[axis];
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

static conic_status make_plan(conic_layers_builder *builder) {
  conic_layers_header *header = &builder->header;
  const conic_layers_raws *raws = &builder->raws;
  conic_status status = conic_layers_raws_spacing(&builder->raws, &header->spacing);
  if (status != CONIC_OK)
    return status;
  int is_unoriented = builder->options.is_unoriented || raws->payload.facts.n_unseen > 0;
  double unit = builder->options.quantum_in_spacings ? header->spacing : 1.0;
  status = builder->options.has_corner ? continue_grid(builder) : lay_grid(builder, builder->options.quantum * unit);
  if (status != CONIC_OK)
    return status;
  if (!(header->spacing > 0.0)) /* all coincide: something that can be seen */
    header->spacing = header->quantum;
  conic_layers_payload_settle(&builder->raws.payload, header->spacing);
  header->schema = raws->payload.schema;
  header->version = CONIC_LAYERS_VERSION;
  header->flags = (raws->has_colors ? CONIC_LAYERS_COLORS : 0u) | (is_unoriented ? CONIC_LAYERS_UNORIENTED : 0u);
  header->cloud_size = builder->options.cloud_size;
  double up[3] = {builder->options.up[0], builder->options.up[1], builder->options.up[2]};
  for (int axis = 0; axis < 3 && conic_normalize(up); axis++)
    header->up[axis] = (float)up[axis];
  header->epsg = builder->options.epsg;
  header->near_z = conic_near_of_box(header->low, header->high);
  builder->plan = (conic_layers_plan){.context = builder->context,
                                      .bits = header->bits,
                                      .cloud_size = header->cloud_size,
                                      .n_samples = raws->payload.facts.n_samples,
                                      .sample_bytes = header->schema.sample_bytes,
                                      .quantum = header->quantum,
                                      .spacing = header->spacing,
                                      .schema = &header->schema,
                                      .cutoff = builder->options.cutoff,
                                      .is_unoriented = is_unoriented,
                                      .has_bare = raws->payload.facts.n_bare > 0};
  return CONIC_OK;
}

static conic_status refuse_nothing(const conic_layers_builder *builder) {
  const conic_layers_facts *facts = &builder->raws.payload.facts;
  if (facts->n_samples == 0)
    return conic_fail(builder->context, CONIC_ERROR_INPUT, "%s: not written: there is no sample that can be drawn",
                      builder->path);
  if (facts->n_bright > 0)
    conic_log(builder->context, CONIC_LOG_WARNING, "%s: %llu colours are brighter than white, and are kept as white",
              builder->path, (unsigned long long)facts->n_bright);
  return CONIC_OK;
}

/* Says where the samples come from that are sorted here: from what was taken in, or, with a team, from what all have
 * sent. */
static conic_status feed_samples(conic_layers_builder *builder, conic_layers_grid *grid, conic_layers_feed *feed) {
  const conic_layers_plan *plan = &builder->plan;
  conic_moment start = conic_moment_now();
  conic_layers_grid_init(&builder->raws, plan, builder->header.origin, &builder->kept, "sort", grid);
  conic_status status = conic_layers_parts_find(builder->team, grid, plan, least_in_chunk(plan), &builder->parts);
  *feed =
      (conic_layers_feed){conic_layers_grid_run, grid, builder->raws.payload.facts.n_samples - builder->kept.n_samples};
  if (status != CONIC_OK || !builder->team)
    return status;
  start = conic_team_note(builder->team, "share", start, builder->raws.n_own);
  status = conic_layers_send_samples(&builder->parts, grid, builder->path, eighths_of_memory(builder, 4),
                                     &builder->received);
  conic_team_note(builder->team, "exchange", start, builder->received.n_samples);
  conic_layers_raws_end(&builder->raws);
  *feed = (conic_layers_feed){conic_layers_received_run, &builder->received, builder->received.n_samples};
  return status;
}

/* Finds the keys at which buckets have to end, and the kept branches in the own parts. The caller releases `own` and
 * `keys`, on failure too. */
static conic_status find_own(const conic_layers_builder *builder, const conic_layers_kept_branch ***own, size_t *n_own,
                             uint64_t **keys, size_t *n_keys) {
  const conic_layers_kept *kept = &builder->kept;
  const conic_layers_parts *parts = &builder->parts;
  *own = conic_memory_allocate(builder->context, kept->n, sizeof **own);
  *keys = conic_memory_allocate(builder->context, 2 * kept->n + parts->n_own, sizeof **keys);
  *n_own = *n_keys = 0;
  if (!*own || !*keys)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < parts->n_own; i++)
    (*keys)[(*n_keys)++] = parts->own_keys[i];
  for (size_t i = 0; i < kept->n; i++) {
    const conic_layers_kept_branch *branch = &kept->branches[i];
    if (builder->team && conic_layers_parts_owner(parts, branch->key) != builder->team->index)
      continue;
    (*own)[(*n_own)++] = branch;
    (*keys)[(*n_keys)++] = branch->key;
    (*keys)[(*n_keys)++] = branch->key + (UINT64_C(1) << branch->n_bits);
  }
  qsort(*keys, *n_keys, sizeof **keys, conic_layers_compare_keys);
  return CONIC_OK;
}

static conic_status fill_buckets(conic_layers_builder *builder, const conic_layers_growth *growth,
                                 const conic_layers_feed *feed) {
  const conic_layers_kept_branch **own;
  uint64_t *keys;
  size_t n_own, n_keys;
  conic_status status = find_own(builder, &own, &n_own, &keys, &n_keys);
  const conic_layers_borders borders = {keys, n_keys};
  if (status == CONIC_OK)
    status = conic_layers_buckets_fill(builder->context, builder->path, feed, &builder->plan, &borders,
                                       eighths_of_memory(builder, 3) / 2, growth->most, &builder->buckets);
  if (status == CONIC_OK)
    status = conic_layers_buckets_add(&builder->buckets, own, n_own);
  conic_memory_release_these(builder->context, own, keys);
  return status;
}

static conic_status sort_samples(conic_layers_builder *builder, const conic_layers_growth *growth) {
  conic_layers_grid grid;
  conic_layers_feed feed;
  conic_status status = feed_samples(builder, &grid, &feed);
  conic_moment start = conic_moment_now();
  if (status == CONIC_OK)
    status = fill_buckets(builder, growth, &feed);
  conic_team_note(builder->team, "sort", start, feed.n_samples);
  conic_layers_raws_end(&builder->raws);
  conic_layers_received_end(&builder->received);
  return conic_team_agree(builder->team, status);
}

static conic_status build_layers(conic_layers_builder *builder) {
  conic_layers_growth growth;
  conic_status status = CONIC_OK;
  conic_moment start = conic_moment_now();
  builder->has_combined = 1;
  if (builder->team)
    status = conic_layers_raws_combine(&builder->raws, CONIC_OK);
  if (status == CONIC_OK)
    status = conic_team_agree(builder->team, refuse_nothing(builder));
  if (status == CONIC_OK)
    status = make_plan(builder);
  conic_team_note(builder->team, "measure", start, builder->raws.n_own);
  if (status == CONIC_OK) {
    growth = plan_growth(builder);
    status = sort_samples(builder, &growth);
  }
  if (status == CONIC_OK)
    status = conic_layers_tree_grow(&builder->plan, &builder->buckets, &builder->parts, &growth, &builder->tree);
  conic_layers_buckets_end(&builder->buckets);
  return status;
}

static void fill_statistics(conic_layers_builder *builder, double begun, double built) {
  conic_layers_statistics *s = &builder->statistics;
  const conic_layers_header *header = &builder->header;
  s->n_in = builder->raws.payload.facts.n_in;
  s->n_nan = builder->raws.payload.facts.n_nan;
  s->n_zero = builder->raws.payload.facts.n_bare;
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
    status = conic_layers_write(builder->context, builder->path, builder->team, &builder->tree, &builder->header);
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
