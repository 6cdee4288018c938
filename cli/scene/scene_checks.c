/* Which options of a scene go together. */
#include <string.h>

#include "cli/color_options.h"
#include "cli/outputs.h"
#include "cli/scene/scene_options.h"
#include "cli/scene/views.h"
#include "conic/layers_draw.h"
#include "core/files/disk.h"

/* A layered cloud knows what its values mean without all of them. */
static int is_colored_by_value(const cli_render_job *job) {
  const char *by = job->coloring.by;
  return strcmp(by, "height") != 0 && strcmp(by, "normal") != 0 && job->n_inputs == 1 &&
         (conic_layers_is_url(job->inputs[0]) || conic_layers_is_file(job->inputs[0]));
}

/* Colours that are made of something need all of it at once. */
static int check_colors(const cli_session *session, cli_render_job *job, int as) {
  int answer = cli_color_check(session, &job->coloring, !job->is_plain);
  if (!job->coloring.by)
    return answer;
  job->opening.coloring = &job->coloring;
  job->opening.is_whole = cli_color_is_asked(&job->coloring) && !is_colored_by_value(job);
  if (job->is_up_given)
    memcpy(job->coloring.up, job->framing.up, sizeof job->coloring.up);
  if (answer == CLI_DONE && job->opening.is_whole && cli_lod_is_wanted(job) && as != CONIC_AS_HYBRID)
    return cli_usage("%s: --color-by looks at all that there is: not with --error or --budget; conic octree and conic "
                     "layer take it, too, and keep the colours",
                     session->command);
  return answer;
}

/* What goes with choosing less than everything, and with hybrid models. */
static int check_choice(const cli_session *session, const cli_render_job *job, int as) {
  const char *command = session->command;
  int is_hybrid = (job->abilities & CONIC_SOURCE_CLUSTERS) != 0;
  if (job->shot.view.error_px > 0.0 && job->budget > 0)
    return cli_usage("%s: --error and --budget are two ways to choose; give one of both", command);
  if (job->is_patch && ((as != CONIC_AS_POINTS && as != CONIC_AS_AUTO) || is_hybrid))
    return cli_usage("%s: --method patch draws points; not with --as mesh, nor hybrids", command);
  if (job->is_patch && cli_lod_is_wanted(job))
    return cli_usage("%s: --method patch draws samples of its own: not with --error or --budget", command);
  if (job->boxes_path && job->abilities != CONIC_SOURCE_CHOOSES)
    return cli_usage("%s: --boxes shows the nodes of a single .cot (conic octree makes one), not with --color-by",
                     command);
  int is_exact = job->abilities & CONIC_SOURCE_COMPOSITES && job->shot.gaussians.profile == CONIC_PROFILE_EXACT;
  int is_profiled = job->abilities & CONIC_SOURCE_COMPOSITES && !is_exact && job->projection != CONIC_CAMERA_CUBE;
  if (job->projection != CONIC_CAMERA_PERSPECTIVE && (is_profiled || (!job->is_for_looking && !is_exact)))
    return cli_usage("%s: --projection %s is of pictures by conic render, and of Gaussian scenes by --profile exact",
                     command, cli_projection_words[job->projection]);
  if (job->projection == CONIC_CAMERA_CUBE && job->framing.height != 6 * job->framing.width)
    return cli_usage("%s: --projection cube is six times as high as wide", command);
  if ((job->projection == CONIC_CAMERA_FISHEYE || job->projection == CONIC_CAMERA_EQUIRECTANGULAR) &&
      job->shot.gaussians.prefilter > 0.0)
    return cli_usage("%s: --prefilter is of perspective and orthographic pictures of Gaussian scenes", command);
  if (is_hybrid)
    return job->n_inputs == 1 ? CLI_DONE : cli_usage("%s: a hybrid is drawn by itself, and made of one file", command);
  if (job->abilities & CONIC_SOURCE_COMPOSITES && (job->deep_path || job->has_mattes || job->is_exposure_automatic))
    return cli_usage("%s: --deep, --cryptomatte and --exposure auto are of splats; give --profile surface, too",
                     command);
  if (job->abilities & CONIC_SOURCE_COMPOSITES && job->shot.gaussians.prefilter > 0.0 &&
      job->shot.gaussians.profile != CONIC_PROFILE_EXACT)
    return cli_usage("%s: --prefilter is of splats and of --profile exact; the others have what they have", command);
  if (job->abilities & CONIC_SOURCE_COMPOSITES && !job->is_for_looking && !job->may_composite)
    return cli_usage("%s: it takes splats apart; give --profile surface, or none", command);
  if (job->shot.planes & CONIC_GAUSSIAN_PLANES && !(job->abilities & CONIC_SOURCE_COMPOSITES))
    return cli_usage("%s: the planes T, medianZ, inverseZ, last and doubt are of Gaussian scenes", command);
  if (job->shot.view.only_kind >= 0 || job->clusters_path || job->shot.planes & 1u << CONIC_PLANE_CLUSTER)
    return cli_usage("%s: --only, --clusters and the plane cluster are of hybrids: a .chy, or --as hybrid", command);
  if (job->abilities & CONIC_SOURCE_STREAMS && cli_lod_is_wanted(job) && !job->may_stream)
    return cli_usage("%s: of an .lpc it takes all; --error and --budget choose of one in conic render", command);
  int may_choose =
      job->abilities & CONIC_SOURCE_CHOOSES || (job->n_inputs == 1 && !conic_disk_can_read(job->inputs[0]));
  if (cli_lod_is_wanted(job) && !may_choose)
    return cli_usage(
        "%s: --error and --budget need a single .cot, .lpc or .chy as input (conic octree, conic layer and "
        "conic hybrid make them), or --as hybrid",
        command);
  return CLI_DONE;
}

int cli_scene_is_top(const cli_render_job *job) {
  return job->camera_path && strcmp(job->camera_path, "top") == 0;
}

/* Of a map, north is up, and up is z. */
static int check_top(const cli_session *session, const cli_scene_words *words, cli_render_job *job) {
  const double *up = job->framing.up;
  if (!cli_scene_is_top(job))
    return job->top.is_given
               ? cli_usage("%s: --gsd, --box and --epsg are of maps; give --camera top, too", session->command)
               : CLI_DONE;
  if (!job->is_for_looking)
    return cli_usage("%s: --camera top is of conic render", session->command);
  if (words->is_framing_given || words->is_size_given)
    return cli_usage("%s: --camera top sees all from straight above; --gsd says how large, and --box which part",
                     session->command);
  if (job->is_up_given && (up[0] != 0.0 || up[1] != 0.0 || !(up[2] > 0.0)))
    return cli_usage("%s: of --camera top, z points up", session->command);
  job->top.is_wanted = job->is_up_given = 1;
  memcpy(job->framing.up, (const double[3]){0.0, 0.0, 1.0}, sizeof job->framing.up);
  job->camera_path = NULL;
  return CLI_DONE;
}

int cli_scene_check(const cli_session *session, const cli_scene_words *words, cli_render_job *job) {
  const char *command = session->command;
  if (job->n_inputs == 0)
    return cli_usage("%s: no input; see conic help %s", command, command);
  int top = check_top(session, words, job);
  if (top != CLI_DONE)
    return top;
  if (job->view_name && !job->camera_path)
    return cli_usage("%s: --view is of a file of cameras; give --camera, too", command);
  if (cli_views_are_all(job->view_name) && !job->is_for_looking)
    return cli_usage("%s: it takes one view; conic render draws all", command);
  if (cli_views_are_all(job->view_name) && (job->is_turntable || job->progressive_path))
    return cli_usage("%s: --view all draws every view once: not with --turntable or --progressive", command);
  job->is_every_view = cli_views_are_all(job->view_name);
  if (job->camera_path && words->is_framing_given)
    return cli_usage(
        "%s: --azimuth, --elevation, --fov, --zoom, --projection and --eye frame the scene; --camera does it itself",
        command);
  if (job->opening.texture_path && words->as == CONIC_AS_POINTS)
    return cli_usage("%s: --texture lies on triangles; give --as mesh or hybrid, too", command);
  if ((job->opening.is_smooth || words->is_crease_given) && words->as == CONIC_AS_POINTS)
    return cli_usage("%s: --smooth and --crease are about triangles; give --as mesh or hybrid, too", command);
  if (job->opening.is_smooth && words->is_crease_given)
    return cli_usage("%s: --smooth rounds all edges, --crease those up to an angle; give one of both", command);
  if (!job->is_patch && words->is_patch_given)
    return cli_usage("%s: --degree and --h are of patches; give --method patch, too", command);
  if (job->shot.has_backdrop && !job->is_for_looking)
    return cli_usage("%s: --background takes two colours in conic render; here it takes one", command);
  if ((job->lamps.n_lamps || cli_lamps_are_soft(job)) && !job->is_for_looking)
    return cli_usage("%s: lamps, and lights with a radius, are of conic render", command);
  if (job->is_exposure_automatic && !job->is_for_looking)
    return cli_usage("%s: --exposure auto is of conic render, which says in --json what it chose", command);
  if (words->passes != 1 && words->passes != 3)
    return cli_usage("%s: --passes takes 3 or 1", command);
  if (job->shot.render.tile & (job->shot.render.tile - 1))
    return cli_usage("%s: --tile takes 8, 16, 32 or 64", command);
  int colors = check_colors(session, job, words->as);
  if (colors != CLI_DONE)
    return colors;
  job->opening.as = job->is_patch ? CONIC_AS_PATCHES : (conic_representation)words->as;
  job->abilities = conic_source_abilities(job->inputs, (size_t)job->n_inputs, &job->opening);
  if (job->abilities & CONIC_SOURCE_CLUSTERS) /* of which any part may be drawn, unless --memory says less */
    job->access.memory_bytes = 0;
  job->opening.is_whole =
      !cli_lod_is_wanted(job) && !job->boxes_path && !(job->may_stream && job->abilities & CONIC_SOURCE_STREAMS);
  int answer = check_choice(session, job, words->as);
  return answer == CLI_DONE ? cli_device_check(session, &job->device) : answer;
}

int cli_scene_inputs_stay(const cli_session *session, const cli_render_job *job, const char *const *outputs,
                          int n_outputs) {
  const char *const beside[] = {job->camera_path, job->opening.texture_path, job->accumulating.motion_path};
  int answer = cli_check_inputs_stay(session, job->inputs, job->n_inputs, outputs, n_outputs);
  return answer == CLI_DONE ? cli_check_inputs_stay(session, beside, 3, outputs, n_outputs) : answer;
}
