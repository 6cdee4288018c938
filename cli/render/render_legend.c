/* conic render --legend: what the colours mean. */
#include "cli/scene/render_job.h"
#include "core/base/message.h"
#include "core/coloring/legend.h"

static conic_status write_legend(cli_session *session, const cli_render_job *job, const conic_coloring *coloring) {
  conic_image legend;
  conic_status status = conic_legend_make(session->context, coloring, &legend);
  if (status != CONIC_OK)
    return status;
  const conic_image_options writing = cli_picture_writing(job);
  status = conic_image_write_as(session->context, job->legend_path, &legend, &writing);
  conic_image_release(session->context, &legend);
  return status;
}

conic_status cli_legend_show(cli_session *session, cli_render_job *job, conic_image *image) {
  const conic_coloring *coloring = conic_source_coloring(job->source);
  conic_status status = CONIC_OK;
  if (!job->has_legend && !job->legend_path)
    return CONIC_OK;
  if (!coloring) {
    conic_log(session->context, CONIC_LOG_WARNING, "%s: no legend: the colours are the file's own", job->inputs[0]);
    job->has_legend = 0; /* said once */
    job->legend_path = NULL;
    return CONIC_OK;
  }
  if (job->has_legend)
    conic_legend_draw(coloring, image);
  if (job->legend_path)
    status = write_legend(session, job, coloring);
  job->legend_path = NULL; /* once, however many frames */
  return status;
}
