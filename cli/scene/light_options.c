#include "cli/scene/light_options.h"

#include "core/files/file.h"

/* Chosen by eye on scans, meshes and a terrain: a warm key light from the viewer's upper left gives the shape, a cool
 * one from behind on the right draws the edge of the shaded side, a little from the front keeps what neither reaches
 * readable, and from all around comes a sky over a darker ground. White does not burn out where they meet. */
static const conic_light studio_lights[] = {
    {.frame = CONIC_LIGHT_CAMERA, .color = {0.92f, 0.89f, 0.84f}, .direction = {-0.7, 0.8, 0.6}},
    {.frame = CONIC_LIGHT_CAMERA, .color = {0.25f, 0.29f, 0.36f}, .direction = {0.9, 0.25, -0.2}},
    {.frame = CONIC_LIGHT_HEAD, .color = {0.08f, 0.08f, 0.08f}},
};
static const float studio_sky[3] = {0.17f, 0.19f, 0.22f}, studio_ground[3] = {0.055f, 0.05f, 0.045f};
static const float plain_sky = 0.05f;

/* Room for one more; null: there are as many as there may be. */
static conic_light *next_light(cli_render_job *job) {
  conic_lighting *lighting = &job->shot.render.lighting;
  return lighting->n_lights < CONIC_MAX_LIGHTS ? &lighting->lights[lighting->n_lights++] : NULL;
}

static int add_studio(cli_render_job *job) {
  enum { N = sizeof studio_lights / sizeof *studio_lights };
  job->is_studio = 1;
  for (int i = 0; i < N; i++) {
    conic_light *light = next_light(job);
    if (!light)
      return 0;
    *light = studio_lights[i];
  }
  return 1;
}

/* head, camera:X,Y,Z or X,Y,Z in so many letters. */
static int parse_place(const char *text, size_t length, conic_light *light) {
  static const char camera[] = "camera:", head[] = "head";
  char copy[128];
  if (length >= sizeof copy)
    return 0;
  snprintf(copy, sizeof copy, "%.*s", (int)length, text);
  light->frame = strcmp(copy, head) == 0 ? CONIC_LIGHT_HEAD : CONIC_LIGHT_WORLD;
  if (light->frame == CONIC_LIGHT_HEAD)
    return 1;
  const char *direction = copy;
  if (strncmp(copy, camera, sizeof camera - 1) == 0) {
    light->frame = CONIC_LIGHT_CAMERA;
    direction += sizeof camera - 1;
  }
  return cli_parse_direction(direction, light->direction);
}

/* The colour, and of what has a direction the radius of its disc. */
static int parse_looks(const char *text, cli_render_job *job, conic_light *light) {
  size_t length = strcspn(text, ":");
  if (!cli_parse_color(text, length, light->color))
    return 0;
  return !text[length] || (light->frame != CONIC_LIGHT_HEAD &&
                           cli_parse_sun_radius(text + length + 1,
                                                &job->lamps.sun_radius_deg[light - job->shot.render.lighting.lights]));
}

int cli_parse_light(const char *text, void *value) {
  static const char lamp[] = "lamp:";
  cli_render_job *job = value;
  job->n_light_words++;
  job->is_light_given = 1;
  if (strcmp(text, "none") == 0)
    return job->is_unlit = 1;
  if (strcmp(text, "studio") == 0)
    return add_studio(job);
  if (strncmp(text, lamp, sizeof lamp - 1) == 0)
    return cli_parse_lamp(text + sizeof lamp - 1, job);
  conic_light *light = next_light(job);
  const char *colon = strchr(strncmp(text, "camera:", 7) == 0 ? text + 7 : text, ':');
  if (!light)
    return cli_because("there are 8 lights with a direction already");
  if (!parse_place(text, colon ? (size_t)(colon - text) : strlen(text), light))
    return 0;
  return parse_looks(colon ? colon + 1 : "1", job, light);
}

int cli_parse_sky(const char *text, void *value) {
  cli_render_job *job = value;
  conic_lighting *lighting = &job->shot.render.lighting;
  size_t length = strcspn(text, ":");
  const char *ground = text[length] ? text + length + 1 : text;
  job->is_sky_given = 1;
  job->sky_path = *conic_file_ending(text) && text[strspn(text, "0123456789.,:")] ? text : NULL;
  if (job->sky_path) {
    memset(lighting->sky, 0, sizeof lighting->sky);
    memset(lighting->ground, 0, sizeof lighting->ground);
    return 1;
  }
  return cli_parse_color(text, length, lighting->sky) && cli_parse_color(ground, strlen(ground), lighting->ground);
}

/* The grey that is as bright: by coloured light, values' colours would not be those of the legend. */
static void make_grey(float color[3]) {
  color[0] = color[1] = color[2] = 0.2126f * color[0] + 0.7152f * color[1] + 0.0722f * color[2];
}

static int shows_values(const cli_render_job *job) {
  const conic_coloring *coloring = conic_source_coloring(job->source);
  return !job->is_plain && coloring && coloring->ramp && job->coloring.by && strcmp(job->coloring.by, "auto") != 0;
}

void cli_lights_settle(cli_render_job *job) {
  conic_lighting *lighting = &job->shot.render.lighting;
  if (!job->is_light_given)
    (void)(job->is_plain ? cli_parse_light("head", job) : add_studio(job));
  /* What has no colours of its own is white, which no material is: the lights stand back as far as plaster is darker.
   */
  float part = job->is_plain || job->is_light_given || conic_source_measure(job->source)->has_colors ? 1.0f : 0.75f;
  for (int i = 0; i < lighting->n_lights; i++)
    for (int c = 0; c < 3; c++)
      lighting->lights[i].color[c] *= part;
  for (int i = 0; i < 3 && !job->is_sky_given; i++) {
    lighting->sky[i] = job->is_studio ? studio_sky[i] : plain_sky;
    lighting->ground[i] = job->is_studio ? studio_ground[i] : plain_sky;
  }
  for (int i = 0; i < lighting->n_lights && !job->is_light_given && shows_values(job); i++)
    make_grey(lighting->lights[i].color);
  if (!job->is_sky_given && shows_values(job)) {
    make_grey(lighting->sky);
    make_grey(lighting->ground);
  }
  lighting->is_given = 1;
  /* Whatever looks at it, as the light stands in the scene. */
  memcpy(lighting->up, job->is_up_given ? job->framing.up : conic_source_measure(job->source)->up, sizeof lighting->up);
  cli_lamps_turn(job);
}

void cli_lights_report(cli_json *json, const cli_render_job *job) {
  static const char *const frames[] = {
      [CONIC_LIGHT_WORLD] = "world", [CONIC_LIGHT_CAMERA] = "camera", [CONIC_LIGHT_HEAD] = "head"};
  const conic_lighting *lighting = &job->shot.render.lighting;
  if (job->shot.render.shading == CONIC_SHADE_NONE)
    return;
  cli_json_array(json, "lights");
  for (int i = 0; i < lighting->n_lights; i++) {
    const conic_light *light = &lighting->lights[i];
    cli_json_object(json, NULL);
    cli_json_text(json, "frame", frames[light->frame]);
    cli_json_array(json, "direction");
    for (int axis = 0; axis < 3 && light->frame != CONIC_LIGHT_HEAD; axis++)
      cli_json_number(json, NULL, light->direction[axis]);
    cli_json_close(json);
    cli_report_color(json, "color", light->color);
    if (job->lamps.sun_radius_deg[i] > 0.0f)
      cli_json_number(json, "radius_deg", (double)job->lamps.sun_radius_deg[i]);
    cli_json_close(json);
  }
  cli_json_close(json);
  cli_lamps_report(json, job);
  if (job->n_directions)
    cli_json_count(json, "ao", (uint64_t)job->n_directions);
  if (job->has_shadows)
    cli_json_bool(json, "shadow", 1);
  if (job->sky_path)
    cli_json_text(json, "sky_picture", job->sky_path);
  cli_report_color(json, "sky", lighting->sky);
  cli_report_color(json, "ground", lighting->ground);
}
