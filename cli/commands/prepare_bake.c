#include "cli/commands/prepare_bake.h"

#include "core/splats/point_values.h"

int cli_bake_parse(const char *text, void *value) {
  cli_bake *bake = value;
  *bake = strcmp(text, "ao") == 0 ? CLI_BAKE_AO : strcmp(text, "color") == 0 ? CLI_BAKE_COLOR : CLI_BAKE_NONE;
  return *bake != CLI_BAKE_NONE;
}

/* Draws the maps. */
typedef struct bake_drawer {
  conic_context *context;
  conic_renderer *renderer;
  const conic_drawing *drawing;
  conic_render_options options;
} bake_drawer;

static conic_status draw_bake_map(void *cookie, const conic_camera *camera, double near_z, conic_image *depth) {
  const bake_drawer *drawer = cookie;
  conic_render_options options = drawer->options;
  options.near_z = near_z;
  return conic_render_drawing(drawer->context, drawer->renderer, drawer->drawing, camera, &options, 1, depth, NULL);
}

static conic_status occlude(conic_context *context, int n_directions, float cutoff, const conic_splats *splats,
                            float *ao) {
  const conic_drawing drawing = {.splats = splats};
  bake_drawer drawer = {.context = context, .drawing = &drawing};
  conic_casters casters = {.draw = draw_bake_map, .cookie = &drawer, .epsilon_is_drawn = 1};
  conic_lighting_options options;
  double length;
  conic_lighting_options_init(&options);
  options.n_directions = (uint64_t)n_directions;
  conic_render_options_init(&drawer.options);
  drawer.options.kernel.cutoff = cutoff;
  drawer.options.passes = CONIC_PASS_OF_HIDING;
  conic_status status = conic_splats_length(context, splats, &length);
  drawer.options.splat_length = CONIC_MAP_LENGTHS * length;
  casters.epsilon = (double)cutoff * length;
  conic_splats_bounds(splats, casters.minimum, casters.maximum);
  for (int axis = 0; axis < 3; axis++) { /* splats reach beyond their centres */
    casters.minimum[axis] -= 4.0 * casters.epsilon;
    casters.maximum[axis] += 4.0 * casters.epsilon;
  }
  if (status == CONIC_OK)
    status = conic_renderer_create(context, &drawer.renderer);
  if (status == CONIC_OK)
    status = conic_splats_occlude(context, &casters, splats, length, &options, ao);
  conic_renderer_destroy(drawer.renderer);
  return status;
}

/* A set without colours is white. */
static conic_status darken_colors(conic_context *context, const float *ao, conic_splats *splats) {
  for (int c = 0; c < 3; c++) {
    float *white = splats->color[c];
    if (!white && !(white = conic_memory_allocate(context, splats->count, sizeof *white)))
      return CONIC_ERROR_MEMORY;
    for (size_t i = 0; i < splats->count; i++)
      white[i] = splats->color[c] ? white[i] * ao[i] : ao[i];
    splats->color[c] = white;
  }
  return CONIC_OK;
}

conic_status cli_bake_splats(conic_context *context, cli_bake bake, int n_directions, float cutoff,
                             conic_splats *splats) {
  if (bake == CLI_BAKE_NONE)
    return CONIC_OK;
  float *ao = conic_memory_allocate(context, splats->count, sizeof *ao);
  if (!ao)
    return CONIC_ERROR_MEMORY;
  conic_status status = occlude(context, n_directions, cutoff, splats, ao);
  if (status == CONIC_OK)
    status = conic_splats_keep_value(context, splats, "ao", ao);
  if (status == CONIC_OK && bake == CLI_BAKE_COLOR)
    status = darken_colors(context, ao, splats);
  conic_memory_release(context, ao);
  return status;
}
