/* The contributions that weigh most in the worst pixels. */

#include "cli/commands/gaussian_commands.h"
#include "cli/judge/judge_job.h"

/* Keeps the heaviest. */
static void keep_part(cli_judge_worst *w, const cli_judge_part *part) {
  int at = w->n_parts;
  while (at > 0 && part->weight > w->parts[at - 1].weight)
    at--;
  if (at == CLI_JUDGE_MOST_PARTS)
    return;
  w->n_parts += w->n_parts < CLI_JUDGE_MOST_PARTS;
  for (int k = w->n_parts - 1; k > at; k--)
    w->parts[k] = w->parts[k - 1];
  w->parts[at] = *part;
}

static const char *first_doubt(unsigned doubts) {
  for (int k = 0; k < CONIC_N_GAUSSIAN_DOUBTS; k++)
    if (doubts >> k & 1)
      return conic_gaussian_doubt_name((conic_gaussian_doubt)k);
  return NULL;
}

static conic_status explain_gaussian_pixel(cli_session *session, cli_judge_job *job, const conic_float_model *model,
                                           cli_judge_worst *w) {
  const conic_gaussian_options options = cli_gaussian_options(&job->scene);
  conic_gaussian_listing listing;
  conic_status status =
      conic_gaussian_explain(session->context, conic_source_gaussians(job->scene.source), &job->camera, &options, model,
                             job->drawn.given, w->fault.x, w->fault.y, &listing);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < listing.n; i++) {
    const conic_gaussian_entry *e = &listing.entries[i];
    if (e->part != CONIC_PART_COMPOSITED && !e->doubts)
      continue;
    w->n_blended += e->part == CONIC_PART_COMPOSITED;
    keep_part(w, &(cli_judge_part){"gaussian",
                                   e->index,
                                   e->weight,
                                   e->alpha,
                                   e->z,
                                   {e->color[0], e->color[1], e->color[2]},
                                   first_doubt(e->doubts)});
  }
  conic_gaussian_listing_release(session->context, &listing);
  return CONIC_OK;
}

static conic_status explain_gaussian_pixels(cli_session *session, cli_judge_job *job) {
  conic_float_model model;
  conic_status status = CONIC_OK;
  if (job->drawn.given && job->scene.shot.view.samples > 1) /* the surfaces of a pixel's middle are not drawn */
    return CONIC_OK;
  conic_float_model_init(&model, (conic_float_kind)job->floats);
  for (int k = 0; k < job->found.n_worst && status == CONIC_OK; k++)
    status = explain_gaussian_pixel(session, job, &model, &job->found.worst[k]);
  return status;
}

conic_status cli_judge_explain_vague(cli_session *session, cli_judge_job *job) {
  const conic_gaussian_options options = cli_gaussian_options(&job->scene);
  const int width = job->camera.width;
  conic_gaussian_listing listing;
  conic_float_model model;
  size_t at = 0;
  for (size_t i = 0; i < job->found.n_whole; i++)
    at = job->ranges[i] > job->ranges[at] ? i : at;
  conic_float_model_init(&model, (conic_float_kind)job->floats);
  conic_status status =
      conic_gaussian_explain(session->context, conic_source_gaussians(job->scene.source), &job->camera, &options,
                             &model, job->drawn.given, (int)at % width, (int)at / width, &listing);
  if (status != CONIC_OK)
    return status;
  for (size_t i = 0; i < listing.n; i++) {
    const conic_gaussian_entry *e = &listing.entries[i];
    if (e->alpha_high > e->alpha_low)
      keep_part(&job->found.vaguest, &(cli_judge_part){.index = e->index, .weight = e->alpha_high - e->alpha_low});
  }
  conic_gaussian_listing_release(session->context, &listing);
  return CONIC_OK;
}

static conic_status explain_splat_pixel(conic_contributions *contributions, cli_judge_worst *w) {
  const conic_contribution *list;
  const conic_triangle_contribution *triangles;
  size_t n, n_triangles;
  double weight = 0.0;
  conic_status status = conic_contributions_at(contributions, w->fault.x, w->fault.y, &list, &n);
  if (status == CONIC_OK)
    status = conic_contributions_triangles_at(contributions, w->fault.x, w->fault.y, &triangles, &n_triangles);
  for (size_t i = 0; status == CONIC_OK && i < n; i++) {
    if (list[i].verdict != CONIC_CONTRIBUTION_VISIBLE)
      continue;
    conic_projection p;
    status = conic_contributions_project(contributions, list[i].splat, &p);
    if (status != CONIC_OK)
      return status;
    weight += (double)list[i].weight;
    w->n_blended++;
    keep_part(w, &(cli_judge_part){.kind = "splat",
                                   .index = list[i].splat,
                                   .weight = (double)list[i].weight,
                                   .depth = (double)list[i].depth,
                                   .color = {(double)p.color[0], (double)p.color[1], (double)p.color[2]}});
  }
  for (size_t i = 0; status == CONIC_OK && i < n_triangles; i++) {
    if (triangles[i].verdict != CONIC_CONTRIBUTION_VISIBLE)
      continue;
    const float *color = triangles[i].color;
    weight += 1.0;
    w->n_blended++;
    keep_part(w, &(cli_judge_part){.kind = "triangle",
                                   .index = triangles[i].triangle,
                                   .weight = 1.0,
                                   .depth = (double)triangles[i].depth,
                                   .color = {(double)color[0], (double)color[1], (double)color[2]}});
  }
  for (int k = 0; k < w->n_parts; k++)
    w->parts[k].weight /= weight;
  return status;
}

static conic_status explain_splat_pixels(cli_session *session, cli_judge_job *job) {
  conic_contributions *contributions = NULL;
  conic_status status =
      conic_contributions_create_drawing(session->context, &conic_source_chosen(job->scene.source)->drawing,
                                         &job->camera, &job->scene.shot.render, &contributions);
  for (int k = 0; k < job->found.n_worst && status == CONIC_OK; k++)
    status = explain_splat_pixel(contributions, &job->found.worst[k]);
  conic_contributions_destroy(contributions);
  return status;
}

conic_status cli_judge_explain(cli_session *session, cli_judge_job *job) {
  return cli_is_composited(&job->scene) ? explain_gaussian_pixels(session, job) : explain_splat_pixels(session, job);
}
