#include "cli/render/mattes.h"

#include "cli/scene/surfaces_drawn.h"
#include "core/base/machine.h"
#include "core/base/real.h"
#include "core/files/file.h"
#include "gaussians/formats/gaussian_formats.h"
#include "raster/frame/samples.h"

enum { MOST_SAMPLES = CONIC_MAX_SAMPLES * CONIC_MAX_SAMPLES };

/* A value of an input's Gaussians, by --matte-by. */
typedef struct matte_label {
  size_t i_input;
  float value;
} matte_label;

/* What can be picked: an input, a cluster of a hybrid, or a label; these come behind the inputs. */
typedef struct pickable {
  uint32_t bits; /* of its name */
  int is_seen;
} pickable;

typedef struct matte_pass {
  conic_context *context;
  const cli_render_job *job;
  conic_plane naming; /* the plane that tells things apart */
  pickable *list;
  size_t n, room;
  matte_label *labels;
  size_t n_labels, labels_room;
  uint32_t *named;         /* the name of each Gaussian; null: its input's */
  const conic_image *fine; /* a band, */
  size_t first_row;        /* which begins here */
  conic_image *image;
} matte_pass;

/* The file's name without its folder and ending. */
static const char *base_of(const char *path, size_t *length) {
  const char *name = conic_file_name(path), *base = *name ? name : path, *dot = strrchr(base, '.');
  *length = dot && dot != base ? (size_t)(dot - base) : strlen(base);
  return base;
}

/* Files in several folders may have one name: those after the first have the path for theirs. */
static int is_taken(const cli_render_job *job, size_t i_input) {
  size_t length, own_length;
  const char *own = base_of(job->inputs[i_input], &own_length);
  for (size_t i = 0; i < i_input; i++) {
    const char *other = base_of(job->inputs[i], &length);
    if (length == own_length && memcmp(own, other, length) == 0)
      return 1;
  }
  return 0;
}

/* The caller frees it. */
static char *name_matte(const matte_pass *pass, size_t i) {
  const int is_cluster = pass->naming == CONIC_PLANE_CLUSTER;
  const size_t n_inputs = (size_t)pass->job->n_inputs;
  const matte_label *label = !is_cluster && i >= n_inputs ? &pass->labels[i - n_inputs] : NULL;
  const char *path = pass->job->inputs[label ? label->i_input : is_cluster ? 0 : i];
  size_t length, room = strlen(path) + 32;
  const char *base = base_of(path, &length);
  char *name = malloc(room);
  if (name && is_cluster)
    snprintf(name, room, "%.*s/%zu", (int)length, base, i);
  else if (name && label)
    snprintf(name, room, "%.*s/%.9g", (int)length, base, (double)label->value);
  else if (name)
    snprintf(name, room, "%.*s", is_taken(pass->job, i) ? (int)strlen(path) : (int)length,
             is_taken(pass->job, i) ? path : base);
  return name;
}

/* Makes the list as long as that. */
static conic_status list_up_to(matte_pass *pass, size_t n) {
  conic_status status = CONIC_OK;
  if (n > pass->room)
    status = conic_memory_reserve(pass->context, &pass->list, pass->n, n, &pass->room, sizeof *pass->list);
  for (; pass->n < n && status == CONIC_OK; pass->n++) {
    char *name = name_matte(pass, pass->n);
    const int is_input = pass->naming == CONIC_PLANE_ID;
    const int is_held_out =
        is_input && pass->n < 64 && pass->n < (size_t)pass->job->n_inputs && pass->job->shot.holdouts >> pass->n & 1;
    pass->list[pass->n] = (pickable){name && !is_held_out ? conic_cryptomatte_bits(name) : 0, is_input && !is_held_out};
    if (!name)
      status = CONIC_ERROR_MEMORY;
    free(name);
  }
  return status;
}

static conic_status list_clusters(matte_pass *pass, const conic_image *fine) {
  const uint32_t *clusters = fine->planes[CONIC_PLANE_CLUSTER];
  for (size_t i = 0; i < (size_t)fine->width * (size_t)fine->height; i++) {
    if (clusters[i] == CONIC_NO_ID || (clusters[i] < pass->n && pass->list[clusters[i]].is_seen))
      continue;
    conic_status status = list_up_to(pass, (size_t)clusters[i] + 1);
    if (status != CONIC_OK)
      return status;
    pass->list[clusters[i]].is_seen = 1;
  }
  return CONIC_OK;
}

static void rank_row(void *data, size_t i_row) {
  const matte_pass *pass = data;
  uint32_t bits[MOST_SAMPLES];
  size_t samples = (size_t)pass->job->shot.view.samples, fine_width = (size_t)pass->fine->width;
  size_t width = (size_t)pass->image->width;
  const uint32_t *names = pass->fine->planes[pass->naming];
  for (size_t x = 0; x < width; x++) {
    for (size_t k = 0; k < samples * samples; k++) {
      uint32_t name = names[(i_row * samples + k / samples) * fine_width + x * samples + k % samples];
      size_t i = pass->naming == CONIC_PLANE_ID ? conic_source_input_of(pass->job->source, name) : name;
      bits[k] = name == CONIC_NO_ID ? 0 : pass->list[i].bits;
    }
    conic_cryptomatte_rank(bits, NULL, samples * samples, pass->image, (pass->first_row + i_row) * width + x);
  }
}

static conic_status take_band(void *cookie, conic_image *fine, int first_row) {
  matte_pass *pass = cookie;
  conic_source_name_image(pass->job->source, fine);
  pass->fine = fine;
  pass->first_row = (size_t)first_row;
  conic_status status = pass->naming == CONIC_PLANE_CLUSTER ? list_clusters(pass, fine) : CONIC_OK;
  if (status == CONIC_OK)
    conic_parallel_for(pass->context, (size_t)(fine->height / pass->job->shot.view.samples), rank_row, pass);
  return status;
}

static conic_status rank_drawn(cli_session *session, const conic_camera *camera, matte_pass *pass) {
  const cli_render_job *job = pass->job;
  return conic_render_bands(session->context, job->renderer, &conic_source_chosen(job->source)->drawing, camera,
                            &job->shot.render, job->shot.view.samples, 1u << CONIC_PLANE_ID | 1u << pass->naming,
                            take_band, pass);
}

/* --- of Gaussians --- */

static size_t find_name(const void *cookie, uint32_t id) {
  const matte_pass *pass = cookie;
  return pass->named && id < conic_source_gaussians(pass->job->source)->count
             ? pass->named[id]
             : conic_source_input_of(pass->job->source, id);
}

CONIC_DEFINE_ORDER(compare_labels, matte_label, value)

/* NaN has no place in an order. */
static float label_of(float value) {
  return value == value ? value : 0.0f;
}

/* Labels of an input: adds each value once, and names its Gaussians, from the first on, by these. */
static conic_status add_labels(matte_pass *pass, size_t i_input, const float *values, size_t n, size_t first) {
  matte_label *all = conic_memory_allocate(pass->context, n, sizeof *all);
  const size_t n_before = pass->n_labels;
  conic_status status = all ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t i = 0; all && i < n; i++)
    all[i] = (matte_label){i_input, label_of(values[i])};
  if (all)
    qsort(all, n, sizeof *all, compare_labels);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    if (i > 0 && all[i].value == all[i - 1].value)
      continue;
    status =
        conic_memory_append(pass->context, &pass->labels, &pass->n_labels, &pass->labels_room, &all[i], sizeof *all);
  }
  conic_memory_release(pass->context, all);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const matte_label wanted = {i_input, label_of(values[i])}, *own = pass->labels + n_before,
                      *found = bsearch(&wanted, own, pass->n_labels - n_before, sizeof wanted, compare_labels);
    pass->named[first + i] = (uint32_t)((size_t)pass->job->n_inputs + n_before + (size_t)(found - own));
  }
  return status;
}

/* An input without the property keeps its one name. */
static conic_status read_labels_of(matte_pass *pass, size_t i_input, size_t first, size_t n) {
  const char *path = pass->job->inputs[i_input];
  conic_read_options options;
  conic_model model;
  for (size_t i = 0; i < n; i++)
    pass->named[first + i] = (uint32_t)i_input;
  if (!conic_file_has_ending(path, "ply") || conic_gaussians_is_packed(pass->context, path))
    return CONIC_OK;
  conic_read_options_init(&options);
  options.field = pass->job->matte_by;
  options.field_is_optional = 1;
  conic_status status = conic_model_read(pass->context, path, &options, &model);
  if (status != CONIC_OK)
    return status;
  if (model.points.scalar && model.points.count == n) {
    status = add_labels(pass, i_input, model.points.scalar, n, first);
    pass->list[i_input].is_seen = 0; /* NOLINT(clang-analyzer-core.NullDereference): it lists all inputs */
  }
  conic_model_release(pass->context, &model);
  return status;
}

static conic_status read_labels(matte_pass *pass) {
  const size_t count = conic_source_gaussians(pass->job->source)->count;
  conic_status status = CONIC_OK;
  pass->named = conic_memory_allocate(pass->context, count, sizeof *pass->named);
  if (!pass->named)
    return CONIC_ERROR_MEMORY;
  for (size_t first = 0, end = 0; first < count && status == CONIC_OK; first = end) {
    const size_t i_input = conic_source_input_of(pass->job->source, (uint32_t)first);
    while (end < count && conic_source_input_of(pass->job->source, (uint32_t)end) == i_input)
      end++;
    status = read_labels_of(pass, i_input, first, end - first);
  }
  if (status == CONIC_OK && !pass->n_labels) {
    cli_error(CLI_INPUT, "%s: --matte-by %s: no scene has the property for each of its Gaussians; a .ply may",
              pass->job->inputs[0], pass->job->matte_by);
    return CONIC_ERROR_INPUT;
  }
  return status == CONIC_OK ? list_up_to(pass, pass->n + pass->n_labels) : status;
}

static conic_status rank_shares(conic_context *context, const matte_pass *pass, const float *shares) {
  const size_t n_pixels = (size_t)pass->image->width * (size_t)pass->image->height;
  uint32_t *bits = conic_memory_allocate(context, pass->n, sizeof *bits);
  if (!bits)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < pass->n; i++)
    bits[i] = pass->list[i].bits;
  for (size_t pixel = 0; pixel < n_pixels; pixel++)
    conic_cryptomatte_rank(bits, shares + pass->n * pixel, pass->n, pass->image, pixel);
  conic_memory_release(context, bits);
  return CONIC_OK;
}

/* Names have of each pixel what they have of its light. */
static conic_status rank_composited(cli_session *session, const conic_camera *camera, matte_pass *pass) {
  const cli_render_job *job = pass->job;
  const int samples = job->shot.view.samples;
  const size_t n_pixels = (size_t)camera->width * (size_t)camera->height;
  const conic_camera fine = conic_samples_camera(camera, samples, 0, camera->height);
  conic_gaussian_options options = job->shot.gaussians;
  cli_surfaces_drawn drawn;
  if (pass->n * n_pixels > conic_machine_memory() / (2 * sizeof(float)))
    return conic_fail(session->context, CONIC_ERROR_MEMORY,
                      "out of memory: %zu names of mattes have shares of %zu pixels; draw a smaller picture", pass->n,
                      n_pixels);
  float *shares = conic_memory_allocate(session->context, pass->n * n_pixels, sizeof *shares);
  conic_status status = shares ? CONIC_OK : CONIC_ERROR_MEMORY;
  options.isa = job->shot.render.isa;
  conic_status drawing = cli_draw_surfaces(job, camera, 1u << CONIC_PLANE_ID, &drawn);
  status = status == CONIC_OK ? drawing : status;
  if (status == CONIC_OK)
    status = conic_gaussians_find_shares(session->context, conic_source_gaussians(job->source), &fine, &options,
                                         drawn.given ? &drawn.image : NULL, samples, pass->n, find_name, pass, shares);
  if (status == CONIC_OK)
    status = rank_shares(session->context, pass, shares);
  conic_image_release(session->context, &drawn.image);
  conic_memory_release(session->context, shares);
  return status;
}

/* All inputs, but only the clusters that are seen: of these there may be many. */
static conic_status write_manifest(const matte_pass *pass, conic_cryptomatte_manifest *manifest) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < pass->n && status == CONIC_OK; i++) {
    char *name = pass->list[i].is_seen ? name_matte(pass, i) : NULL;
    if (name)
      status = conic_cryptomatte_name(pass->context, manifest, name);
    else if (pass->list[i].is_seen)
      status = CONIC_ERROR_MEMORY;
    free(name);
  }
  return status;
}

conic_status cli_fill_mattes(cli_session *session, cli_render_job *job, const conic_camera *camera,
                             conic_image *image) {
  const int is_composited = (job->abilities & CONIC_SOURCE_COMPOSITES) != 0;
  const int is_hybrid = !is_composited && (job->abilities & CONIC_SOURCE_CLUSTERS) != 0;
  matte_pass pass = {.context = session->context,
                     .job = job,
                     .naming = is_hybrid ? CONIC_PLANE_CLUSTER : CONIC_PLANE_ID,
                     .image = image};
  double start = cli_seconds();
  conic_cryptomatte_manifest_release(session->context, &job->manifest);
  conic_status status = is_hybrid ? CONIC_OK : list_up_to(&pass, (size_t)job->n_inputs);
  if (status == CONIC_OK && job->matte_by)
    status = read_labels(&pass);
  if (status == CONIC_OK)
    status = is_composited ? rank_composited(session, camera, &pass) : rank_drawn(session, camera, &pass);
  if (status == CONIC_OK)
    status = write_manifest(&pass, &job->manifest);
  image->manifest = job->manifest.text;
  conic_memory_release_these(session->context, pass.list, pass.labels, pass.named);
  job->frames_ms += 1e3 * (cli_seconds() - start);
  return status;
}
