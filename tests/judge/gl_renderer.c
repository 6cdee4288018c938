/* A renderer of Gaussian scenes with OpenGL, for the tests; 77 where there is no OpenGL.
 *
 * gl_renderer SHADERS SCENE.ply CAMERA.json -o OUT [--profile NAME] [--fault NAME]…
 *
 * OUT.pfm or OUT.npy. With each --fault, one more picture is drawn, OUT.NAME.pfm or OUT.NAME.npy. */
#include <string.h>

#include "tests/judge/gl_device.h"
#include "tests/judge/gl_frame.h"

static void draw_file(const gl_order *order, const char *scene_path, const char *camera_path, const char *out) {
  plain_scene scene = plain_scene_read(scene_path, order->faults);
  plain_camera camera = plain_camera_read(camera_path);
  plain_picture picture = plain_picture_allocate(camera.width, camera.height);
  gl_draw(order, &scene, &camera, &picture);
  plain_picture_write(&picture, out);
  plain_picture_release(&picture);
  plain_scene_release(&scene);
}

/* OUT.pfm: OUT.NAME.pfm */
static void name_out(const char *out, const char *name, char *path, size_t room) {
  const char *ending = strrchr(out, '.');
  int stem = (int)(ending ? (size_t)(ending - out) : strlen(out));
  snprintf(path, room, "%.*s.%s%s", stem, out, name, ending ? ending : "");
}

int main(int n, char **words) {
  gl_order order = {.profile = "gsplat-1.6"};
  const char *reason, *out = "";
  char path[4096];
  for (int i = 4; i + 1 < n; i += 2) {
    if (strcmp(words[i], "-o") == 0)
      out = words[i + 1];
    else if (strcmp(words[i], "--profile") == 0)
      order.profile = words[i + 1];
    else if (strcmp(words[i], "--fault") != 0)
      plain_give_up(words[i], "is no option");
  }
  if (n < 4 || !out[0])
    plain_give_up("gl_renderer", "SHADERS SCENE.ply CAMERA.json -o OUT [--profile NAME] [--fault NAME]…");
  if (!gl_open(&reason)) {
    printf("skipped: %s\n", reason);
    return 77;
  }
  order.folder = words[1];
  draw_file(&order, words[2], words[3], out);
  for (int i = 4; i + 1 < n; i += 2) {
    order.faults = 0;
    for (int k = 0; k < PLAIN_N_FAULTS && strcmp(words[i], "--fault") == 0; k++)
      order.faults |= (unsigned)(strcmp(words[i + 1], plain_fault_names[k]) == 0) << k;
    name_out(out, words[i + 1], path, sizeof path);
    if (order.faults)
      draw_file(&order, words[2], words[3], path);
  }
  return 0;
}
