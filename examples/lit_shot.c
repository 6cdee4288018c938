/* Two shots of any file that conic reads. The first is a fisheye's, the mean of 16 samples, each of them darker where
 * less light from all around arrives, and with a lamp that casts a soft shadow; the second an EXR of any size, of which
 * no more than 64 MiB are in memory: lit_shot IN OUT STRIPS.exr */
#include <conic/conic.h>

int main(int argc, char **argv) {
  conic_context *context = NULL;
  conic_source *source = NULL;
  conic_renderer *renderer = NULL;
  conic_image image = {0};
  conic_shot shot;
  conic_shot_framing framing;
  if (argc != 4)
    return 2;
  conic_shot_init(&shot);
  conic_shot_framing_init(&framing);
  framing.kind = CONIC_CAMERA_FISHEYE;
  framing.framing.width = framing.framing.height = 256;
  shot.n_samples = 16;
  shot.render.prefilter = 0.0625f; /* the mean filters, too */
  shot.light.n_directions = 16;
  shot.light.n_lamps = 1;
  shot.light.lamps[0] = (conic_lamp){.position = {0.5, 0.5, 2.0}, .color = {2.0f, 1.5f, 1.0f}, .radius = 0.25};
  int failed = conic_context_create(NULL, &context) || conic_renderer_create(context, &renderer) ||
               conic_source_open(context, (const char *const *)&argv[1], 1, NULL, &source) ||
               conic_shot_frame(source, &framing, &shot) ||
               conic_image_allocate(context, 256, 256, 1u << CONIC_PLANE_RGBA, &image) ||
               conic_shot_draw(source, renderer, &shot, &image, NULL) || conic_image_write(context, argv[2], &image);
  conic_shot_init(&shot); /* colour and depth, without more light than that of the options */
  conic_shot_framing_init(&framing);
  framing.framing.width = framing.framing.height = 2048;
  failed = failed || conic_shot_frame(source, &framing, &shot) ||
           conic_shot_write_strips(source, renderer, &shot, argv[3], UINT64_C(64) << 20, NULL);
  conic_image_release(context, &image);
  conic_renderer_destroy(renderer);
  conic_source_close(source);
  conic_context_destroy(context);
  return failed;
}
