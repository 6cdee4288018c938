/* A renderer of Gaussian scenes that has nothing of conic: what another author's program is to the judge.
 *
 * plain_renderer SCENE.ply CAMERA.json [--profile NAME] [--fault NAME]… [--otherwise 1] [--background R,G,B]
 *                [--floats SEED] -o OUT
 * plain_renderer --make SCENE.ply CAMERA.json SEED
 *
 * OUT.pfm or OUT.npy. --otherwise 1 plants the faults as other programs have them. With --floats, the arithmetic fuses,
 * orders and approximates by chance. */
#include <string.h>

#include "tests/judge/plain_gaussians.h"

static void plain_take_option(const char *name, const char *value, plain_settings *s, const char **out) {
  if (strcmp(name, "-o") == 0)
    *out = value;
  else if (strcmp(name, "--profile") == 0)
    s->profile = plain_profile_find(value);
  else if (strcmp(name, "--fault") == 0)
    s->faults |= 1u << plain_fault_find(value);
  else if (strcmp(name, "--otherwise") == 0)
    s->faults |= strcmp(value, "1") == 0 ? PLAIN_OTHERWISE : 0;
  else if (strcmp(name, "--floats") == 0)
    s->floats = plain_floats_by_chance(strtoull(value, NULL, 10), 1);
  else if (strcmp(name, "--background") != 0 ||
           sscanf(value, "%f,%f,%f", &s->background[0], &s->background[1], &s->background[2]) != 3)
    plain_give_up(name, "is no option");
}

int main(int argc, char **argv) {
  plain_settings settings = {.profile = plain_profile_find("gsplat-1.6")};
  const char *out = NULL;
  if (argc == 5 && strcmp(argv[1], "--make") == 0) {
    plain_random_write(strtoull(argv[4], NULL, 10), 150, argv[2], argv[3]);
    return 0;
  }
  for (int k = 3; k + 1 < argc; k += 2)
    plain_take_option(argv[k], argv[k + 1], &settings, &out);
  if (argc < 5 || !out || !settings.profile)
    plain_give_up("plain_renderer", "SCENE.ply CAMERA.json [--profile NAME] [--fault NAME]… -o OUT");
  plain_scene scene = plain_scene_read(argv[1], settings.faults);
  plain_camera camera = plain_camera_read(argv[2]);
  plain_picture picture = plain_picture_allocate(camera.width, camera.height);
  plain_gaussians_draw(&scene, &camera, &settings, &picture);
  plain_picture_write(&picture, out);
  plain_picture_release(&picture);
  plain_scene_release(&scene);
  return 0;
}
