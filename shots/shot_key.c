#include "shots/shot_key.h"

#include "conic/version.h"
#include "shots/shot_text.h"

void conic_key_add_text(conic_sha256 *sum, const char *text) {
  conic_sha256_add(sum, text, strlen(text) + 1);
}

/* As text, so that machines agree. */
void conic_key_add_number(conic_sha256 *sum, uint64_t number) {
  char digits[32];
  snprintf(digits, sizeof digits, "%llu", (unsigned long long)number);
  conic_key_add_text(sum, digits);
}

void conic_key_add_real(conic_sha256 *sum, double number) {
  conic_sha256_add(sum, &number, sizeof number);
}

typedef struct key_adding {
  conic_text text; /* which goes to the sum */
  const char *part;
} key_adding;

static void add_field(void *cookie, const conic_field_visit *visit) {
  key_adding *a = cookie;
  int is_wanted = a->part ? strncmp(visit->path, a->part, strlen(a->part)) == 0
                          : strncmp(visit->path, "writing.", strlen("writing.")) != 0;
  if (!is_wanted || visit->row->is_no_key || conic_row_is_same(visit->row, visit->value, visit->standard))
    return;
  conic_key_add_text(a->text.sum, visit->path);
  conic_text_value(&a->text, visit->row, visit->value);
  conic_text_add(&a->text, "", 1);
}

void conic_key_add_fields(conic_sha256 *sum, const conic_shot_file *file, const char *part) {
  key_adding a = {.text = {.sum = sum}, .part = part};
  conic_fields_visit(file, add_field, &a);
}

/* What they are called decides no bit; how many there are of each role does. */
void conic_key_add_inputs(conic_sha256 *sum, const conic_shot_file *file) {
  for (size_t i = 0; i < file->n_inputs; i++) {
    const conic_shot_input *input = &file->inputs[i];
    conic_key_add_number(sum, (uint64_t)input->role);
    conic_key_add_number(sum, input->n_bytes);
    conic_key_add_text(sum, *input->sha256 ? input->sha256 : input->name);
  }
}

conic_status conic_shot_file_key(conic_context *context, const conic_shot_file *file, char key[CONIC_SHOT_KEY_ROOM]) {
  conic_sha256 sum;
  if (!file || file->size != sizeof *file)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the shot's file was not initialised");
  conic_sha256_begin(&sum);
  conic_key_add_text(&sum, conic_version());
  conic_key_add_fields(&sum, file, NULL);
  conic_key_add_inputs(&sum, file);
  conic_sha256_end(&sum, key);
  return CONIC_OK;
}

/* --- pictures that are the same have one key --- */

/* What lens and shutter do not have is not there. */
static void plain_samples(conic_shot *shot) {
  if (shot->n_samples == 0) {
    shot->noise = 0.0;
    shot->is_shutter_open = 0;
    memset(&shot->aperture, 0, sizeof shot->aperture);
  }
  if (!(shot->aperture.diameter > 0.0)) {
    memset(&shot->aperture, 0, sizeof shot->aperture);
    shot->focus_kind = CONIC_FOCUS_MIDDLE;
  }
  if (!shot->is_shutter_open) {
    memset(&shot->way, 0, sizeof shot->way);
    memset(shot->shutter, 0, sizeof shot->shutter);
  }
  if (shot->way.kind != CONIC_WAY_CAMERAS)
    shot->way.cameras = NULL, shot->way.n_cameras = 0;
  if (shot->eye.shift == 0.0)
    memset(&shot->eye, 0, sizeof shot->eye);
}

/* A light at the eye has no direction, nor, where nothing is a mean, a light a size, but a lamp only what its kind has.
 */
static void plain_lights(conic_shot *shot) {
  conic_lighting *lighting = &shot->render.lighting;
  for (int i = 0; i < lighting->n_lights; i++)
    if (lighting->lights[i].frame == CONIC_LIGHT_HEAD)
      memset(lighting->lights[i].direction, 0, sizeof lighting->lights[i].direction);
  for (int i = 0; i < CONIC_MAX_LIGHTS; i++)
    if (shot->n_samples == 0 || i >= lighting->n_lights || lighting->lights[i].frame == CONIC_LIGHT_HEAD)
      shot->light.sun_radius_deg[i] = 0.0f;
  for (int i = 0; i < shot->light.n_lamps; i++) {
    conic_lamp *lamp = &shot->light.lamps[i];
    if (lamp->kind == CONIC_LAMP_SPHERE)
      memset(lamp->axes, 0, sizeof lamp->axes);
    else
      lamp->radius = 0.0;
  }
  if (memcmp(lighting->sky, lighting->ground, sizeof lighting->sky) == 0 && !(shot->light.n_directions > 0))
    memset(lighting->up, 0, sizeof lighting->up);
  if (lighting->is_given || !shot->render.has_light) {
    shot->render.has_light = 0;
    memset(shot->render.light, 0, sizeof shot->render.light);
  }
}

/* Numbers of what there is not: of confetti, of a lens that does not distort, of how colours may differ and chance. */
static void plain_drawing(conic_shot *shot, const conic_shot *standard, unsigned abilities) {
  conic_kernel *kernel = &shot->render.kernel;
  if (kernel->type != CONIC_KERNEL_CONFETTI) {
    kernel->a = standard->render.kernel.a;
    kernel->b = standard->render.kernel.b;
    kernel->n = standard->render.kernel.n;
  }
  if (shot->camera.lens == CONIC_LENS_NONE)
    memset(shot->camera.distortion, 0, sizeof shot->camera.distortion);
  if ((abilities && !(abilities & CONIC_SOURCE_CLUSTERS)) || !(shot->view.error_px > 0.0))
    shot->view.color_error = standard->view.color_error;
  if (!(abilities & CONIC_SOURCE_CLUSTERS))
    shot->view.only_kind = standard->view.only_kind;
  if (abilities || !(shot->view.error_px > 0.0))
    shot->view.is_alone = 0;
  if (shot->view.transparency != CONIC_TRANSPARENCY_CHANCE)
    shot->view.chance = standard->view.chance;
  if (shot->gaussians.profile != CONIC_PROFILE_EXACT)
    shot->gaussians.prefilter = standard->gaussians.prefilter;
}

static void plain_shot(conic_shot *shot, unsigned abilities) {
  conic_shot standard;
  conic_shot_init(&standard);
  plain_samples(shot);
  plain_lights(shot);
  plain_drawing(shot, &standard, abilities);
  if (shot->focus_kind != CONIC_FOCUS_DEPTH)
    shot->aperture.focus = 0.0;
  if (shot->focus_kind != CONIC_FOCUS_PIXEL)
    memset(shot->focus_pixel, 0, sizeof shot->focus_pixel);
  if (!shot->has_backdrop) {
    memset(shot->backdrop_top, 0, sizeof shot->backdrop_top);
    memset(shot->backdrop_bottom, 0, sizeof shot->backdrop_bottom);
  }
  if (!shot->render.has_background)
    memset(shot->render.background, 0, sizeof shot->render.background);
  if (!(abilities & CONIC_SOURCE_COMPOSITES))
    shot->gaussians = standard.gaussians;
}

static void plain_reading(conic_source_options *reading, unsigned abilities) {
  reading->texture_path = NULL;
  reading->access = NULL;
  if (reading->as != CONIC_AS_PATCHES) {
    reading->patches = NULL;
    reading->h_in_spacings = 0;
  }
  if (!(abilities & CONIC_SOURCE_COMPOSITES))
    reading->gaussians = NULL;
}

void conic_shot_file_plain(conic_shot_file *file, unsigned abilities) {
  plain_shot(&file->shot, abilities);
  plain_reading(&file->reading, abilities);
  if (file->map.is_wanted)
    memset(&file->shot.camera, 0, sizeof file->shot.camera); /* it follows */
}
