#include "cli/outputs.h"
#include "cli/scene/render_job.h"

int cli_parse_focus(const char *text, void *value) {
  cli_focus *focus = value;
  if (strcmp(text, "auto") == 0) {
    focus->kind = CONIC_FOCUS_MIDDLE;
    return 1;
  }
  if (cli_parse_number(text, &focus->depth)) {
    focus->kind = CONIC_FOCUS_DEPTH;
    return (focus->depth > 0.0 && focus->depth < 1e30) || cli_because("a depth is above 0");
  }
  focus->kind = CONIC_FOCUS_PIXEL;
  return cli_parse_pair(text, ',', focus->pixel) && focus->pixel[0] >= 0.0 && focus->pixel[1] >= 0.0;
}

int cli_parse_blades(const char *text, void *value) {
  unsigned long long n;
  int is_number = cli_parse_count(text, &n) && n <= CONIC_MAX_BLADES;
  ((cli_accumulate_job *)value)->n_blades = is_number ? (int)n : 0;
  return is_number;
}

int cli_parse_shutter(const char *text, void *value) {
  double *shutter = value;
  if (!cli_parse_pair(text, ':', shutter))
    return 0;
  return (shutter[0] <= shutter[1] && fabs(shutter[0]) <= 1e5 && fabs(shutter[1]) <= 1e5) ||
         cli_because("A is not after B");
}

/* What a sample is drawn with, unless it is said otherwise: the samples are the filter. */
static const float sample_prefilter = 0.0625f;

int cli_accumulate_settle(const cli_session *session, cli_render_job *job) {
  const cli_accumulate_job *own = &job->accumulating;
  if (own->n_blades == 1 || own->n_blades == 2)
    return cli_usage("%s: a lens has 3 blades at least, or is round", session->command);
  if (!job->is_prefilter_given)
    job->shot.render.prefilter = sample_prefilter;
  return CLI_DONE;
}

int cli_accumulate_check(const cli_session *session, cli_render_job *job) {
  cli_accumulate_job *own = &job->accumulating;
  int answer = own->n_samples ? cli_accumulate_settle(session, job) : CLI_DONE;
  if (answer != CLI_DONE || !own->n_samples)
    return answer;
  if (own->noise > 0.0 && own->n_samples <= 16)
    cli_warn(session, "%s: --noise has no effect: it looks at 16 samples, and then at more", session->command);
  if (own->width.value > 0.0 && own->focus.kind != CONIC_FOCUS_DEPTH) /* which is known before the lens is */
    job->unwritten_planes |= ~job->shot.planes & 1u << CONIC_PLANE_Z;
  job->shot.planes |= job->unwritten_planes;
  return CLI_DONE;
}

void cli_accumulate_describe(const cli_render_job *job, conic_image *image) {
  const cli_accumulate_job *own = &job->accumulating;
  if (!own->n_samples)
    return;
  cli_name_attribute(image, "conicAccumulated", NULL, (double)own->facts.end_sample);
  if (job->shot.aperture.diameter > 0.0) {
    cli_name_attribute(image, "conicAperture", NULL, job->shot.aperture.diameter);
    cli_name_attribute(image, "conicFocus", NULL, own->focus_depth);
  }
}

void cli_accumulate_report(cli_json *json, const cli_render_job *job) {
  const cli_accumulate_job *own = &job->accumulating;
  if (!own->n_samples)
    return;
  cli_json_object(json, "accumulated");
  cli_json_counts(json, NULL, {"samples", own->facts.end_sample}, {"resumed", own->n_resumed});
  if (own->reached_noise >= 0.0)
    cli_json_number(json, "noise", own->reached_noise);
  if (job->shot.aperture.diameter > 0.0)
    cli_json_number(json, "focus", own->focus_depth);
  cli_json_close(json);
}
