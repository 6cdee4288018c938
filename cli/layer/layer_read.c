#include "cli/layer/layer_job.h"
#include "cli/points/points_input.h"
#include "core/files/disk.h"
#include "core/splats/repairs_log.h"
#include "lod/layers/build/layers_team.h"

/* Bytes a point for estimating from the whole file, about. */
enum { ESTIMATE_BYTES_A_POINT = 250 };

uint64_t cli_layer_most_whole(const cli_layer_job *job) {
  return job->options.memory_bytes / ESTIMATE_BYTES_A_POINT;
}

/* Only some inputs may have colours. If the first has, inputs without are white, as in pictures. */
static conic_status append_colored(cli_layer_job *job, const conic_splats *batch) {
  conic_context *context = job->base.session->context;
  conic_status status = CONIC_OK;
  if (!job->has_points)
    status = conic_layers_builder_agree(job->builder, batch, &job->has_colors);
  job->has_points = 1;
  if (status != CONIC_OK)
    return status;
  if (!batch->color[0] == !job->has_colors)
    return conic_layers_builder_append(job->builder, batch);
  if (!job->has_colors)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: has colours, and what comes before it has none: name it first",
                      job->base.input);
  float *white = conic_memory_allocate(context, batch->count, sizeof *white);
  if (!white)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < batch->count; i++)
    white[i] = 1.0f;
  conic_splats colored = *batch;
  for (int channel = 0; channel < 3; channel++)
    colored.color[channel] = white;
  status = conic_layers_builder_append(job->builder, &colored);
  conic_memory_release(context, white);
  return status;
}

/* The batch's arrays are the reader's: colours go into a copy. */
static conic_status append_layer_batch(cli_layer_job *job, const conic_splats *batch) {
  conic_context *context = job->base.session->context;
  conic_splats own;
  struct conic_point_values *values = batch->values;
  if (!job->coloring.options.by)
    return append_colored(job, batch);
  conic_status status = conic_splats_allocate(context, 0, conic_splats_fields(batch), &own);
  if (status != CONIC_OK)
    return status;
  memcpy(own.origin, batch->origin, sizeof own.origin);
  status = conic_splats_append(context, &own, batch);
  if (status == CONIC_OK)
    status = conic_drawing_color(context, &job->coloring.options, &own, NULL, &job->coloring.done);
  own.values = values;
  if (status == CONIC_OK)
    status = append_colored(job, &own);
  own.values = NULL;
  conic_splats_release(context, &own);
  return status;
}

/* Points without normals and axes: if the whole file fits into memory, they are estimated from it, as in other
 * commands; else they get their normals while the cloud is built. */
static conic_status take_layer_batch(void *cookie, const conic_splats *batch) {
  cli_layer_job *job = cookie;
  int is_raw = !batch->tangent_u[0] && !batch->normal[0];
  job->n_points += batch->count;
  job->was_raw |= is_raw;
  job->has_values |= batch->values && batch->values->n > 0;
  if (job->is_counting)
    return CONIC_OK;
  if (is_raw && !job->has_begun && job->may_read_again) {
    job->is_raw = 1;
    return CONIC_ERROR_CANCELLED;
  }
  job->has_begun = 1;
  return append_layer_batch(job, batch);
}

static conic_status read_whole_file(cli_layer_job *job, const conic_read_options *options) {
  conic_context *context = job->base.session->context;
  conic_repairs repairs;
  conic_model model;
  conic_status status = cli_points_read(job->base.session, job->base.input, options, &model);
  if (status != CONIC_OK)
    return status;
  cli_build_hint_faces(&job->base, &model);
  status = cli_layer_estimate(job, &model, &repairs);
  if (status == CONIC_OK)
    conic_repairs_log(job->base.session->context, job->base.input, &repairs);
  if (status == CONIC_OK)
    status = append_layer_batch(job, &model.points);
  conic_model_release(context, &model);
  return status;
}

static conic_status read_raw(cli_layer_job *job, const conic_read_options *options) {
  job->n_points = 0;
  job->is_counting = 1;
  conic_status status = cli_points_stream(job->base.session, job->base.input, options, take_layer_batch, job);
  job->is_counting = job->may_read_again = 0;
  if (status != CONIC_OK)
    return status;
  if (job->n_points <= cli_layer_most_whole(job))
    return read_whole_file(job, options);
  return cli_points_stream(job->base.session, job->base.input, options, take_layer_batch, job);
}

void cli_layer_reading(const cli_layer_job *job, conic_read_options *options) {
  cli_build_reading(&job->base, options);
  options->where = NULL;
  options->cutoff = job->options.cutoff;
  cli_coloring_read(&job->coloring, options);
}

static conic_status read_layer_piece(cli_layer_job *job, const cli_points_piece *piece,
                                     const conic_read_options *options) {
  conic_disk_entry found;
  job->has_begun = job->is_raw = 0;
  job->may_read_again =
      piece->is_whole && strcmp(job->base.input, "-") != 0 && conic_disk_look(job->base.input, &found) && found.is_file;
  conic_status status = cli_points_share_stream(&job->share, piece, options, take_layer_batch, job);
  return job->is_raw ? read_raw(job, options) : status;
}

/* A batch of a continued .lpc: samples and colours stay as they are. */
static conic_status take_old_samples(void *cookie, const conic_splats *batch) {
  return append_colored(cookie, batch);
}

static conic_status read_continued(cli_layer_job *job, const char *path) {
  conic_layers_region all;
  conic_layers *layers;
  conic_layers_region_init(&all);
  all.keep = job->continued;
  conic_status status = cli_layer_open_input(job, path, &layers);
  if (status == CONIC_OK)
    status = conic_layers_read_samples(layers, job->options.cutoff, &all, take_old_samples, job);
  conic_layers_close(layers);
  return status;
}

conic_status cli_layer_read_share(cli_layer_job *job, conic_read_options *options) {
  conic_status status = CONIC_OK;
  options->where = job->base.where;
  options->keep = job->keep;
  for (size_t i = 0; i < job->share.n && status == CONIC_OK; i++) {
    const cli_points_piece *piece = &job->share.pieces[i];
    conic_moment start = conic_moment_now();
    job->i_input = piece->input;
    job->base.input = job->share.inputs[piece->input];
    status =
        piece->input < job->n_continued ? read_continued(job, job->base.input) : read_layer_piece(job, piece, options);
    job->n_pieces++;
    job->busy_seconds += cli_seconds() - start.clock_s;
    conic_team_note(job->share.team, "read", start, i);
  }
  return status;
}
