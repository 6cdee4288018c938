#include "cli/scene/light_options.h"
#include "core/base/vectors.h"
#include "shots/shot_plan.h"

/* The square of the sine of an angle that is as good as none. */
static const double LEAST_ACROSS = 1e-12;

/* R, or WxH. */
static int parse_lamp_size(const char *text, double size[2], int *is_flat) {
  double radius;
  *is_flat = strchr(text, 'x') != NULL;
  if (*is_flat)
    return cli_parse_pair(text, 'x', size) &&
           ((size[0] > 0.0 && size[1] > 0.0 && size[0] < 1e18 && size[1] < 1e18) || cli_because("W and H are above 0"));
  if (!cli_parse_number(text, &radius) || !(radius >= 0.0 && radius < 1e18))
    return cli_because("a radius is 0 or above");
  size[0] = size[1] = 2.0 * radius;
  return 1;
}

/* The parts of a text between colons; 0: there are more than `most`. */
static int split_words(char *text, int most, char *parts[]) {
  int n = 0;
  for (char *rest = text; rest; n++) {
    if (n == most)
      return 0;
    parts[n] = rest;
    rest = strchr(rest, ':');
    if (rest)
      *rest++ = 0;
  }
  return n;
}

int cli_parse_lamp(const char *text, cli_render_job *job) {
  enum { PLACE, COLOR, SIZE, AHEAD, UPWARD, N_PARTS };
  cli_lamp_job *own = &job->lamps;
  char copy[256], *parts[N_PARTS];
  int i = own->n_lamps, is_rectangle = 0;
  if (i == CONIC_MAX_LAMPS || strlen(text) >= sizeof copy)
    return cli_because(i == CONIC_MAX_LAMPS ? "there are 8 lamps already" : "it is too long");
  memcpy(copy, text, strlen(text) + 1);
  int n = split_words(copy, N_PARTS, parts);
  conic_lamp *lamp = &own->lamps[own->n_lamps++];
  double size[2] = {0.0, 0.0};
  *lamp = (conic_lamp){.color = {1.0f, 1.0f, 1.0f}};
  if (n == 0)
    return cli_because("it has too many parts");
  if (!cli_parse_vector(parts[PLACE], lamp->position))
    return 0;
  if (n > COLOR && !cli_parse_color_to(parts[COLOR], strlen(parts[COLOR]), 1e12, lamp->color))
    return 0;
  if (n > SIZE && !parse_lamp_size(parts[SIZE], size, &is_rectangle))
    return 0;
  if (n <= AHEAD) {
    lamp->radius = 0.5 * size[0];
    return !is_rectangle || cli_because("a rectangle needs a direction behind WxH");
  }
  lamp->kind = is_rectangle ? CONIC_LAMP_RECTANGLE : CONIC_LAMP_DISC;
  own->half[i][0] = 0.5 * size[0];
  own->half[i][1] = 0.5 * size[1];
  double across[3];
  if (!(size[0] > 0.0))
    return cli_because("a disc's radius is above 0");
  if (!cli_parse_direction(parts[AHEAD], own->ahead[i]) || !conic_normalize(own->ahead[i]))
    return 0;
  if (n <= UPWARD)
    return 1;
  if (!is_rectangle)
    return cli_because("of a lamp with W x H alone, H goes somewhere");
  if (!cli_parse_direction(parts[UPWARD], own->upward[i]) || !conic_normalize(own->upward[i]))
    return 0;
  conic_cross(own->ahead[i], own->upward[i], across);
  return conic_dot(across, across) >= LEAST_ACROSS || cli_because("H goes along where to the lamp shines");
}

int cli_parse_sun_radius(const char *text, float *radius_deg) {
  static const char unit[] = "deg";
  size_t length = strlen(text), own = sizeof unit - 1;
  char copy[32];
  double value;
  if (length <= own || length - own >= sizeof copy || strcmp(text + length - own, unit) != 0)
    return cli_because("a sun's radius ends with deg");
  snprintf(copy, sizeof copy, "%.*s", (int)(length - own), text);
  if (!cli_parse_number(copy, &value) || !(value >= 0.0 && value <= 90.0))
    return cli_because("a sun's radius is 0 to 90 degrees");
  *radius_deg = (float)value;
  return 1;
}

static int has_soft_sun(const cli_render_job *job) {
  int n = 0;
  for (int i = 0; i < job->shot.render.lighting.n_lights; i++)
    n += job->lamps.sun_radius_deg[i] > 0.0f;
  return n > 0;
}

int cli_lamps_are_soft(const cli_render_job *job) {
  int n = has_soft_sun(job);
  for (int i = 0; i < job->lamps.n_lamps; i++)
    n += job->lamps.lamps[i].kind != CONIC_LAMP_SPHERE || job->lamps.lamps[i].radius > 0.0;
  return n > 0;
}

void cli_lamps_turn(cli_render_job *job) {
  cli_lamp_job *own = &job->lamps;
  for (int i = 0; i < own->n_lamps; i++) {
    const double *ahead = own->ahead[i];
    double up[3], right[3], down[3];
    if (!(own->half[i][0] > 0.0)) /* of a ball, or of a picture that is drawn again */
      continue;
    memcpy(up, own->upward[i], sizeof up);
    if (!conic_normalize(up)) {
      memcpy(up, job->shot.render.lighting.up, sizeof up);
      (void)conic_normalize(up);
    }
    conic_cross(ahead, up, right);
    if (conic_dot(right, right) < LEAST_ACROSS || !conic_normalize(right)) { /* straight up or down */
      const double x[3] = {1.0, 0.0, 0.0}, y[3] = {0.0, 1.0, 0.0};
      const double *along = fabs(ahead[0]) < 0.9 ? x : y;
      for (int axis = 0; axis < 3; axis++)
        right[axis] = along[axis] - conic_dot(along, ahead) * ahead[axis];
      (void)conic_normalize(right);
    }
    conic_cross(ahead, right, down);
    for (int axis = 0; axis < 3; axis++) {
      own->lamps[i].axes[0][axis] = own->half[i][0] * right[axis];
      own->lamps[i].axes[1][axis] = own->half[i][1] * down[axis];
    }
  }
}

/* Those at your eye cast none that you see. */
static int casts_shadows(const cli_render_job *job) {
  const conic_lighting *lighting = &job->shot.render.lighting;
  int n = job->lamps.n_lamps;
  for (int i = 0; i < lighting->n_lights; i++)
    n += lighting->lights[i].frame != CONIC_LIGHT_HEAD;
  return n > 0;
}

static const char *what_changes_nothing(const cli_render_job *job) {
  int is_shown = (job->n_directions && job->shot.planes & 1u << CONIC_PLANE_AO) ||
                 (job->has_shadows && job->shot.planes & 1u << CONIC_PLANE_SHADOW);
  int is_lit = conic_shot_is_lit(&job->shot);
  if (job->shot.render.shading == CONIC_SHADE_NONE)
    return is_lit && !is_shown ? "--ao, --shadow and lamps change nothing where there is no light (--shade none)"
                               : NULL;
  if (job->has_shadows && !is_shown && !casts_shadows(job))
    return "--shadow changes nothing: no light has a direction or a place";
  if (cli_lamps_are_soft(job) && !job->accumulating.n_samples)
    return "lights that have a size shine from their middle; --accumulate 64 makes their shadows soft";
  return NULL;
}

void cli_lamps_warn(cli_session *session, cli_render_job *job) {
  const char *what = what_changes_nothing(job);
  if (what && !job->lamps.is_warned && !job->top.is_wanted)
    conic_log(session->context, CONIC_LOG_WARNING, "%s: %s", job->inputs[0], what);
  job->lamps.is_warned = 1;
}

static void report_vector(cli_json *json, const char *key, const double vector[3]) {
  cli_json_array(json, key);
  for (int axis = 0; axis < 3; axis++)
    cli_json_number(json, NULL, vector[axis]);
  cli_json_close(json);
}

void cli_lamps_report(cli_json *json, const cli_render_job *job) {
  static const char *const kinds[] = {
      [CONIC_LAMP_SPHERE] = "sphere", [CONIC_LAMP_DISC] = "disc", [CONIC_LAMP_RECTANGLE] = "rectangle"};
  const cli_lamp_job *own = &job->lamps;
  if (own->n_lamps == 0)
    return;
  cli_json_array(json, "lamps");
  for (int i = 0; i < own->n_lamps; i++) {
    const conic_lamp *lamp = &own->lamps[i];
    cli_json_object(json, NULL);
    cli_json_text(json, "kind", kinds[lamp->kind]);
    report_vector(json, "position", lamp->position);
    cli_report_color(json, "color", lamp->color);
    if (lamp->kind == CONIC_LAMP_SPHERE)
      cli_json_number(json, "radius", lamp->radius);
    else {
      report_vector(json, "right", lamp->axes[0]);
      report_vector(json, "down", lamp->axes[1]);
    }
    cli_json_close(json);
  }
  cli_json_close(json);
}
