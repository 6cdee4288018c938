/* A scene as the commands that draw one take it: read, given axes, measured, framed. */
#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands/hybrid_mesh.h"
#include "cli/commands/reach.h"
#include "cli/render/render_job.h"
#include "cli/tell.h"
#include "core/base/message.h"

static conic_status check_extent(const cli_render_job *job, const char *path, const conic_model *model) {
  double low[3], high[3];
  const char *why = cli_why_out_of_reach(&model->points);
  if (!why || (job->camera_path && conic_splats_bounds(&model->points, low, high)))
    return CONIC_OK;
  cli_error(CLI_INPUT, "%s: cannot be drawn: %s", path, why);
  return CONIC_ERROR_INPUT;
}

/* An octree without a choice of level is the splats that it was built from. */
static conic_status read_octree(cli_session *session, const char *path, conic_splats *splats, conic_model_kind *kind) {
  conic_octree *octree;
  conic_splats leaves;
  *kind = CONIC_MODEL_PLY;
  conic_status status = conic_octree_read(session->context, path, &octree);
  if (status != CONIC_OK)
    return status;
  status = conic_octree_leaves(octree, &leaves);
  conic_octree_destroy(octree);
  if (status != CONIC_OK || splats->count == 0) {
    if (status == CONIC_OK)
      *splats = leaves;
    return status;
  }
  status = conic_splats_append(session->context, splats, &leaves);
  conic_splats_release(session->context, &leaves);
  return status;
}

/* So is a layered point cloud, beside other inputs or where every splat is to be known. */
static conic_status read_layers(cli_session *session, const cli_render_job *job, const char *path,
                                conic_splats *splats) {
  conic_layers *layers;
  conic_splats samples;
  conic_status status = conic_layers_open(session->context, path, NULL, &layers);
  if (status != CONIC_OK)
    return status;
  status = conic_layers_splats(layers, job->options.kernel.cutoff, &samples);
  conic_layers_close(layers);
  if (status != CONIC_OK)
    return status;
  status = conic_splats_append(session->context, splats, &samples);
  conic_splats_release(session->context, &samples);
  return status;
}

/* A model's faces become triangles. */
static conic_status take_triangles(cli_session *session, cli_render_job *job, const char *path, conic_model *model) {
  conic_triangles triangles;
  conic_status status = conic_triangles_take(session->context, model, &triangles);
  if (status == CONIC_OK)
    status = cli_mesh_check(path, &triangles);
  if (status == CONIC_OK)
    status = conic_triangles_append(session->context, &job->triangles, &triangles);
  conic_triangles_release(session->context, &triangles);
  return status;
}

/* Reads an input, and gives its points axes where it has none. */
static conic_status read_input(cli_session *session, cli_render_job *job, const char *path, conic_splats *splats,
                               conic_model_kind *kind, double *estimate_seconds) {
  conic_model model;
  conic_read_options read_options;
  conic_estimate_options estimate_options;
  conic_repairs repairs;
  if (conic_octree_is_file(path))
    return read_octree(session, path, splats, kind);
  *kind = CONIC_MODEL_PLY;
  if (cli_layers_is_input(path))
    return read_layers(session, job, path, splats);
  conic_read_options_init(&read_options);
  conic_estimate_options_init(&estimate_options);
  read_options.cutoff = estimate_options.cutoff = job->options.kernel.cutoff;
  estimate_options.n_neighbours = job->n_neighbours;
  read_options.keeps_faces = job->as == CLI_AS_MESH;
  conic_status status = conic_model_read(session->context, path, &read_options, &model);
  if (status != CONIC_OK)
    return status;
  *kind = model.kind;
  double start = cli_seconds();
  status = check_extent(job, path, &model);
  if (status == CONIC_OK && read_options.keeps_faces && model.n_triangles) {
    status = take_triangles(session, job, path, &model);
    conic_model_release(session->context, &model);
    return status;
  }
  if (status == CONIC_OK)
    status = conic_model_to_splats(session->context, &estimate_options, &model, &repairs);
  if (status == CONIC_OK)
    cli_tell_repairs(session, path, &repairs);
  if (status == CONIC_OK && splats->count == 0) {
    *splats = model.points; /* the first input's arrays are taken over, not copied */
    memset(&model.points, 0, sizeof model.points);
  } else if (status == CONIC_OK)
    status = conic_splats_append(session->context, splats, &model.points);
  *estimate_seconds += cli_seconds() - start;
  conic_model_release(session->context, &model);
  return status;
}

/* --texture: in place of what the files name. */
static conic_status lay_texture(cli_session *session, cli_render_job *job) {
  conic_texture *texture;
  if (!job->triangles.texture_coordinate[0]) {
    cli_error(CLI_INPUT, "%s: the mesh has no texture coordinates for it", job->texture_path);
    return CONIC_ERROR_INPUT;
  }
  conic_status status = conic_texture_read(session->context, job->texture_path, CONIC_WRAP_REPEAT, &texture);
  if (status != CONIC_OK)
    return status;
  status = conic_triangles_texture(session->context, &job->triangles, texture);
  if (status != CONIC_OK)
    conic_texture_destroy(texture);
  return status;
}

/* What the options say of triangles. */
static conic_status dress_triangles(cli_session *session, cli_render_job *job) {
  conic_status status = CONIC_OK;
  if (job->as == CLI_AS_MESH && job->triangles.count == 0)
    conic_log(session->context, CONIC_LOG_WARNING, "%s: there are no faces to draw as a mesh; the points are drawn",
              job->inputs[0]);
  if (job->is_smooth && job->triangles.count)
    status = conic_triangles_smooth(session->context, &job->triangles);
  return status == CONIC_OK && job->texture_path && job->triangles.count ? lay_texture(session, job) : status;
}

conic_status cli_scene_begin(cli_session *session, cli_render_job *job) {
  if (cli_isa_check(session, job->options.isa) != CLI_DONE)
    return CONIC_ERROR_UNSUPPORTED;
  if (job->texture_path && access(job->texture_path, R_OK) != 0) {
    cli_error(CLI_INPUT, "%s: cannot read: %s", job->texture_path, strerror(errno));
    return CONIC_ERROR_INPUT;
  }
  conic_status status = cli_device_open(session, &job->device, &job->renderer);
  if (status == CONIC_OK && job->camera_path)
    status = conic_camera_read(session->context, job->camera_path, &job->camera);
  return status;
}

conic_status cli_scene_read(cli_session *session, cli_render_job *job, conic_splats *splats) {
  double start = cli_seconds(), estimate_seconds = 0.0;
  int n_las = 0;
  memset(splats, 0, sizeof *splats);
  if (cli_layers_is_wanted(job) && job->draws_layers)
    return cli_layers_open(session, job);
  if (cli_hybrid_is_wanted(job))
    return cli_hybrid_open(session, job);
  if (cli_lod_is_wanted(job))
    return cli_lod_open(session, job);
  for (int i = 0; i < job->n_inputs; i++) {
    conic_model_kind kind;
    conic_status status = read_input(session, job, job->inputs[i], splats, &kind, &estimate_seconds);
    if (status != CONIC_OK)
      return status;
    n_las += kind == CONIC_MODEL_LAS;
  }
  conic_status dressed = dress_triangles(session, job);
  if (dressed != CONIC_OK)
    return dressed;
  if (n_las == job->n_inputs && !job->is_up_given) { /* surveys have heights in z */
    job->framing.up[0] = job->framing.up[1] = 0.0;
    job->framing.up[2] = 1.0;
  }
  job->read_ms = 1e3 * (cli_seconds() - start - estimate_seconds);
  job->estimate_ms = 1e3 * estimate_seconds;
  return CONIC_OK;
}

void cli_scene_release(cli_session *session, cli_render_job *job, conic_splats *splats) {
  conic_renderer_destroy(job->renderer);
  job->renderer = NULL;
  cli_patch_close(job); /* it refers to the splats */
  cli_lod_close(session, job);
  cli_layers_close(job);
  cli_hybrid_close(session, job);
  conic_splats_release(session->context, splats);
  conic_triangles_release(session->context, &job->triangles);
}

/* Lengths in spacings become world units. */
static conic_status resolve_lengths(cli_session *session, cli_render_job *job, const conic_splats *splats) {
  double spacing = 1.0;
  conic_status status = CONIC_OK;
  if (job->layers.file)
    spacing = job->layers.scale.spacing;
  if ((job->octree || job->hybrid) && (job->epsilon.is_in_spacings || job->near_z.is_in_spacings)) {
    cli_error(CLI_USAGE,
              "%s: lengths in spacings need every splat; give world units with --error, --budget or a hybrid",
              session->command);
    return CONIC_ERROR_ARGUMENT;
  }
  if (!job->layers.file && (job->epsilon.is_in_spacings || job->near_z.is_in_spacings))
    status = conic_splats_spacing(session->context, splats, &spacing);
  if (job->epsilon.value >= 0.0)
    job->options.epsilon = job->epsilon.value * (job->epsilon.is_in_spacings ? spacing : 1.0);
  if (job->near_z.value >= 0.0)
    job->options.near_z = job->near_z.value * (job->near_z.is_in_spacings ? spacing : 1.0);
  return status;
}

/* What an octree or a hybrid knows of what it was built from. */
static void measure_built(cli_render_job *job) {
  job->options.splat_length = job->hybrid ? job->hybrid_info.splat_length : job->info.splat_length;
  if (job->options.near_z == 0.0)
    job->options.near_z = job->hybrid ? job->hybrid_info.near_z : job->info.near_z;
}

conic_status cli_scene_measure(cli_session *session, cli_render_job *job, const conic_splats *splats) {
  double start = cli_seconds();
  conic_status status = resolve_lengths(session, job, splats);
  if (job->layers.file) {
    job->options.splat_length = job->layers.scale.splat_length;
    job->options.near_z = job->options.near_z > 0.0 ? job->options.near_z : job->layers.scale.near_z;
  } else if (job->octree || job->hybrid)
    measure_built(job);
  else if (status == CONIC_OK && splats->count)
    status = conic_splats_length(session->context, splats, &job->options.splat_length);
  if (status == CONIC_OK && !job->octree && !job->hybrid && !job->layers.file && job->options.near_z == 0.0) {
    const conic_drawing drawing = {splats, &job->triangles};
    job->options.near_z = conic_drawing_near(&drawing);
  }
  if (status == CONIC_OK && job->is_patch)
    status = cli_patch_open(session, job, splats);
  job->estimate_ms += 1e3 * (cli_seconds() - start);
  return status;
}

conic_status cli_scene_camera(cli_session *session, const cli_render_job *job, const conic_splats *splats, int i_frame,
                              conic_camera *camera) {
  double low[3], high[3];
  conic_framing framing = job->framing;
  if (job->camera_path) {
    *camera = job->camera;
    return CONIC_OK;
  }
  if (job->layers.file) {
    memcpy(low, job->layers.scale.minimum, sizeof low);
    memcpy(high, job->layers.scale.maximum, sizeof high);
  } else if (job->hybrid) {
    memcpy(low, job->hybrid_info.minimum, sizeof low);
    memcpy(high, job->hybrid_info.maximum, sizeof high);
  } else if (job->octree) {
    memcpy(low, job->info.minimum, sizeof low);
    memcpy(high, job->info.maximum, sizeof high);
  } else {
    const conic_drawing drawing = {splats, &job->triangles};
    conic_drawing_bounds(&drawing, low, high);
  }
  framing.azimuth_deg += 360.0 * (double)i_frame / (double)job->n_frames;
  if (!cli_is_in_reach(low, high)) { /* what was read point by point was asked before */
    cli_error(CLI_INPUT, "%s: cannot be drawn: a point is farther out than 1e20", job->inputs[0]);
    return CONIC_ERROR_INPUT;
  }
  return conic_camera_frame(session->context, &framing, low, high, camera);
}
