/* What of a scene a picture takes: all of it, or what is chosen for its camera. */
#include "cli/render/render_job.h"

conic_status cli_scene_select(cli_render_job *job, const conic_camera *camera, const conic_splats *splats,
                              conic_drawing *drawing, double *ms) {
  *ms = 0.0;
  conic_status status = job->octree    ? cli_lod_select(job, camera, ms)
                        : job->patches ? cli_patch_select(job, camera, ms)
                        : job->hybrid  ? cli_hybrid_select(job, camera, ms)
                                       : CONIC_OK;
  *drawing = cli_scene_drawing(job, splats);
  return status;
}

conic_drawing cli_scene_drawing(const cli_render_job *job, const conic_splats *splats) {
  conic_drawing drawing = {splats, &job->triangles};
  if (job->octree)
    drawing.splats = &job->selection.splats;
  if (job->patches)
    drawing.splats = &job->patch_selection.splats;
  if (job->hybrid) {
    drawing.splats = &job->hybrid_selection.splats;
    drawing.triangles = &job->hybrid_selection.triangles;
  }
  return drawing;
}

void cli_scene_name(const cli_render_job *job, conic_image *image) {
  if (job->octree)
    conic_selection_name(&job->selection, image);
  if (job->patches)
    conic_patch_selection_name(&job->patch_selection, image);
  if (job->hybrid && image->planes[CONIC_PLANE_CLUSTER])
    conic_hybrid_name(&job->hybrid_selection, image);
}
