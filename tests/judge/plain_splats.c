/* A renderer of surface splats that has nothing of conic.
 *
 * plain_splats SURFELS.ply CAMERA.json [--method conic|affine] [--cutoff F] [--prefilter V] [--fault NAME]…
 *              [--background R,G,B] [--floats SEED] -o OUT
 *
 * OUT.pfm or OUT.npy: colours without light, as conic render --shade none --samples 1 has them. */
#include <string.h>

#include "tests/judge/plain_surfels.h"

static void plain_take_surfel_option(const char *name, const char *value, plain_surfel_settings *s, const char **out) {
  if (strcmp(name, "-o") == 0)
    *out = value;
  else if (strcmp(name, "--method") == 0 && (strcmp(value, "conic") == 0 || strcmp(value, "affine") == 0))
    s->is_affine = value[0] == 'a';
  else if (strcmp(name, "--cutoff") == 0)
    s->cutoff = strtof(value, NULL);
  else if (strcmp(name, "--prefilter") == 0)
    s->prefilter = strtof(value, NULL);
  else if (strcmp(name, "--fault") == 0)
    s->faults |= 1u << plain_fault_find(value);
  else if (strcmp(name, "--floats") == 0)
    s->floats = plain_floats_by_chance(strtoull(value, NULL, 10), 1);
  else if (strcmp(name, "--background") == 0 &&
           sscanf(value, "%f,%f,%f", &s->background[0], &s->background[1], &s->background[2]) == 3)
    s->is_opaque = 1;
  else
    plain_give_up(name, "is no option");
}

int main(int argc, char **argv) {
  plain_surfel_settings settings = {.cutoff = 1.5f, .prefilter = 1.0f};
  const char *out = NULL;
  for (int k = 3; k + 1 < argc; k += 2)
    plain_take_surfel_option(argv[k], argv[k + 1], &settings, &out);
  if (argc < 5 || !out)
    plain_give_up("plain_splats", "SURFELS.ply CAMERA.json [--method conic|affine] [--fault NAME]… -o OUT");
  plain_surfels surfels = plain_surfels_read(argv[1], settings.cutoff, settings.faults);
  plain_camera camera = plain_camera_read(argv[2]);
  plain_picture picture = plain_picture_allocate(camera.width, camera.height);
  size_t n_lacking = plain_surfels_draw(&surfels, &camera, &settings, &picture);
  if (n_lacking)
    fprintf(stderr, "%zu surfels are too near or too slanted for this renderer\n", n_lacking);
  plain_picture_write(&picture, out);
  plain_picture_release(&picture);
  plain_surfels_release(&surfels);
  return 0;
}
