#include "cli/layer/layer_job.h"
#include "core/estimate/estimate.h"
#include "lod/layers/build/layers_team.h"
#include "shots/shot_key.h"

int cli_layer_check_keeping(const cli_layer_job *job) {
  const char *command = job->base.session->command;
  if (!job->is_resumable && !job->resume_path)
    return CLI_DONE;
  if (job->resume_path && strcmp(job->resume_path, job->base.output) != 0)
    return cli_usage("%s: --resume goes on with a file where it is; give -o %s, too", command, job->resume_path);
  for (int i = 0; i < job->n_inputs; i++)
    if (strcmp(job->inputs[i], "-") == 0)
      return cli_usage("%s: standard input cannot be gone on with; give files", command);
  return CLI_DONE;
}

static conic_status hash_input(conic_context *context, const char *path, char hash[CONIC_SHA256_ROOM]) {
  conic_shot_input input = {.name = path};
  conic_status status = conic_shot_input_look(context, path, &input);
  memcpy(hash, input.sha256, CONIC_SHA256_ROOM);
  return status;
}

/* The team shares the inputs, since there may be many. */
static conic_status hash_inputs(const cli_layer_job *job, char (*hashes)[CONIC_SHA256_ROOM],
                                char (*all)[CONIC_SHA256_ROOM]) {
  const cli_points_share *share = &job->share;
  size_t n = (size_t)share->n_inputs, index = share->team ? (size_t)share->team->index : 0,
         count = share->team ? (size_t)share->team->count : 1;
  conic_status status = CONIC_OK;
  for (size_t i = index; i < n && status == CONIC_OK; i += count) {
    status = hash_input(job->base.session->context, share->inputs[i], hashes[i]);
    if (status == CONIC_OK)
      status = conic_progress(job->base.session->context, "look", (double)i / (double)n);
  }
  status = conic_team_agree(share->team, status);
  if (status != CONIC_OK || !share->team)
    return status;
  conic_team_collect(share->team, hashes, n * sizeof *hashes, all);
  for (size_t i = 0; i < n; i++)
    memcpy(hashes[i], all[i % count * n + i], sizeof *hashes);
  return CONIC_OK;
}

/* How inputs are read, as that of pictures is. */
static void add_reading(const cli_layer_job *job, conic_sha256 *sum) {
  conic_shot_file file;
  conic_shot_file_init(&file);
  file.reading.n_neighbours = job->estimate.n_neighbours;
  file.reading.finds_dots = job->estimate.finds_dots;
  file.reading.cutoff = (float)job->cutoff;
  file.reading.columns = job->base.columns;
  file.reading.colors_are = job->base.colors_are;
  file.reading.where = job->base.where;
  file.reading.coloring = job->coloring.options.by ? &job->coloring.options : NULL;
  conic_key_add_fields(sum, &file, "reading.");
}

/* What the options say of the file: neither threads nor memory change a byte of it. */
static void add_layer_options(const cli_layer_job *job, conic_sha256 *sum) {
  const int numbers[] = {job->is_merging, job->is_appending,           job->cloud_size,
                         job->payload,    job->options.keeps_all != 0, job->quantum.is_in_spacings};
  const double reals[] = {job->quantum.value, job->coloring.options.up[0], job->coloring.options.up[1],
                          job->coloring.options.up[2]};
  const char *output = job->base.output;
  while (output[0] == '.' && output[1] == '/')
    output += 2;
  conic_key_add_text(sum, conic_version());
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    conic_key_add_number(sum, (uint64_t)numbers[i]);
  conic_sha256_add(sum, reals, sizeof reals);
  conic_key_add_text(sum, output);
  conic_key_add_text(sum, job->keep ? job->keep : "");
  add_reading(job, sum);
}

conic_status cli_layer_make_key(const cli_layer_job *job, char key[CONIC_SHA256_ROOM]) {
  conic_context *context = job->base.session->context;
  size_t n = (size_t)job->share.n_inputs, count = job->share.team ? (size_t)job->share.team->count : 1;
  conic_sha256 sum;
  char(*hashes)[CONIC_SHA256_ROOM] = conic_memory_allocate_zeroed(context, n, sizeof *hashes);
  char(*all)[CONIC_SHA256_ROOM] = conic_memory_allocate(context, n * count, sizeof *all);
  conic_status status = conic_team_agree(job->share.team, hashes && all ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK)
    status = hash_inputs(job, hashes, all);
  if (status == CONIC_OK) {
    conic_sha256_begin(&sum);
    add_layer_options(job, &sum);
    for (size_t i = 0; i < n; i++)
      conic_key_add_text(&sum, hashes[i]);
    conic_sha256_end(&sum, key);
  }
  conic_memory_release_these(context, hashes, all);
  return status;
}

/* --- axes --- */

enum { AXES = 6 }; /* columns, and one more for the dots, if there are any */

/* Reads n columns; with n = AXES + 1, the last one tells which points are dots. */
static conic_status read_axes(conic_context *context, FILE *stream, size_t count, int n, float *columns[AXES + 1]) {
  for (int i = 0; i < n; i++) {
    columns[i] = conic_memory_allocate(context, count, sizeof(float));
    if (!columns[i])
      return CONIC_ERROR_MEMORY;
    if (fread(columns[i], sizeof(float), count, stream) != count)
      return CONIC_ERROR_IO;
  }
  return CONIC_OK;
}

/* Takes the axes if they were kept; *are_there says so. */
static conic_status take_axes_kept(cli_layer_job *job, conic_model *model, int *are_there) {
  conic_context *context = job->base.session->context;
  size_t count = model->points.count;
  float *columns[AXES + 1] = {NULL};
  conic_status status = CONIC_OK;
  *are_there = 0;
  for (int n = AXES; n <= AXES + 1 && !*are_there && status == CONIC_OK; n++) {
    FILE *stream = conic_layers_builder_open_kept(job->builder, (uint64_t)job->i_input,
                                                  (uint64_t)count * (uint64_t)n * sizeof(float));
    if (!stream)
      continue;
    status = read_axes(context, stream, count, n, columns);
    fclose(stream);
    *are_there = status == CONIC_OK;
  }
  if (*are_there)
    status = conic_model_take_axes(context, model, columns, columns + 3, columns[AXES]);
  for (int i = 0; i <= AXES && (status != CONIC_OK || !*are_there); i++)
    conic_memory_release(context, columns[i]);
  if (status == CONIC_ERROR_IO) /* the file was removed meanwhile: the axes are made again */
    status = CONIC_OK;
  return status;
}

static conic_status keep_axes(cli_layer_job *job, const conic_splats *points) {
  conic_layers_kept_bytes pieces[AXES + 1];
  int n = points->dot ? AXES + 1 : AXES;
  for (int axis = 0; axis < 3; axis++) {
    pieces[axis].bytes = points->tangent_u[axis];
    pieces[axis + 3].bytes = points->tangent_v[axis];
  }
  pieces[AXES].bytes = points->dot;
  for (int i = 0; i < n; i++)
    pieces[i].n_bytes = points->count * sizeof(float);
  return conic_layers_builder_keep(job->builder, (uint64_t)job->i_input, pieces, (size_t)n);
}

conic_status cli_layer_estimate(cli_layer_job *job, conic_model *model, conic_repairs *repairs) {
  int are_there = 0, is_raw = !model->points.tangent_u[0] && !model->points.dot;
  conic_status status = is_raw ? take_axes_kept(job, model, &are_there) : CONIC_OK;
  *repairs = (conic_repairs){0};
  if (status != CONIC_OK || are_there)
    return status;
  status = conic_model_to_splats(job->base.session->context, &job->estimate, model, repairs);
  return status == CONIC_OK && is_raw ? keep_axes(job, &model->points) : status;
}
