#include "cli/scene/stereo.h"

#include "core/files/file.h"

int cli_parse_convergence(const char *text, void *value) {
  cli_stereo *stereo = value;
  stereo->is_convergence_given = 1;
  return cli_parse_number(text, &stereo->convergence) && stereo->convergence >= 0.0 && stereo->convergence <= 1e29;
}

int cli_stereo_eyes(const cli_render_job *job) {
  return job->stereo.distance > 0.0 ? 2 : 1;
}

void cli_stereo_begin(cli_render_job *job, int i_eye) {
  job->stereo.side = job->stereo.distance > 0.0 ? 2 * i_eye - 1 : 0;
}

conic_stereo_eye cli_stereo_eye(const cli_render_job *job) {
  const conic_source_scale *scale = conic_source_measure(job->source);
  conic_stereo_eye eye = {.shift = 0.5 * job->stereo.distance * job->stereo.side,
                          .convergence = job->stereo.convergence,
                          .finds_convergence = !job->stereo.is_convergence_given};
  for (int axis = 0; axis < 3; axis++)
    eye.center[axis] = 0.5 * scale->minimum[axis] + 0.5 * scale->maximum[axis];
  return eye;
}

char *cli_stereo_name(const cli_render_job *job, char *name) {
  if (!name || job->stereo.side == 0)
    return name;
  const char *eye = job->stereo.side < 0 ? "left" : "right", *place = strstr(name, "%V");
  const char *base = conic_file_name(name), *dot = strrchr(base, '.');
  const char *ending = dot ? dot : name + strlen(name);
  size_t room = strlen(name) + 8;
  char *named = malloc(room);
  if (named && place)
    snprintf(named, room, "%.*s%s%s", (int)(place - name), name, eye, place + 2);
  else if (named)
    snprintf(named, room, "%.*s.%s%s", (int)(ending - name), name, eye, ending);
  free(name);
  return named;
}
