#include "cli/commands/mls_cells.h"

typedef struct cells_cleaning {
  cli_session *session;
  const conic_splats *points;
  const char *input, *columns, *output;
  conic_splats_writer *writer;
  double work_end; /* when the last point was projected */
} cells_cleaning;

static conic_status feed(void *cookie, conic_batch_receiver *receive, void *to) {
  cells_cleaning *job = cookie;
  conic_read_options options;
  conic_read_options_init(&options);
  options.columns = job->columns;
  return job->points ? receive(to, job->points)
                     : conic_model_stream(job->session->context, job->input, &options, receive, to);
}

static conic_status begin_cells(void *cookie, const conic_surface_report *report, unsigned fields) {
  cells_cleaning *job = cookie;
  job->work_end = cli_seconds();
  if (report->n_out == 0)
    return CONIC_OK;
  return conic_splats_writer_open(job->session->context, job->output, report->n_out, fields, NULL, &job->writer);
}

static conic_status append_cleaned(void *cookie, const conic_splats *batch) {
  cells_cleaning *job = cookie;
  return conic_splats_writer_append(job->writer, batch);
}

conic_status cli_mls_clean(cli_session *session, const conic_clean_options *options, const conic_splats *points,
                           const char *input, const char *columns, const char *output, conic_surface_report *report,
                           double *work_seconds) {
  cells_cleaning job = {session, points, input, columns, output, NULL, 0.0};
  const conic_points_sink sink = {begin_cells, append_cleaned, &job};
  double start = cli_seconds();
  conic_status status = conic_surface_clean_cells(session->context, options, feed, &job, &sink, report);
  if (status == CONIC_OK && job.writer)
    status = conic_splats_writer_finish(job.writer);
  else
    conic_splats_writer_abandon(job.writer);
  *work_seconds = job.work_end - start;
  return status;
}
