/* Opens any file that conic reads (points, splats, a mesh, an octree, a layered cloud or its URL, a hybrid model) and
 * draws it, no finer than the screen shows: any_file IN OUT */
#include <conic/conic.h>

int main(int argc, char **argv) {
  conic_context *context = NULL;
  conic_source *source = NULL;
  conic_renderer *renderer = NULL;
  conic_image image = {0};
  conic_camera camera;
  conic_render_options options;
  conic_source_view view;
  if (argc != 3)
    return 2;
  conic_render_options_init(&options);
  conic_source_view_init(&view);
  view.error_px = 0.5; /* of what has levels of detail */
  int failed = conic_context_create(NULL, &context) ||
               conic_source_open(context, (const char *const *)&argv[1], 1, NULL, &source) ||
               conic_source_frame(source, NULL, &camera) ||
               conic_image_allocate(context, camera.width, camera.height, 1u << CONIC_PLANE_RGBA, &image) ||
               conic_renderer_create(context, &renderer) ||
               conic_source_draw(source, renderer, &camera, &options, &view, &image, NULL) ||
               conic_image_write(context, argv[2], &image);
  conic_renderer_destroy(renderer);
  conic_image_release(context, &image);
  conic_source_close(source);
  conic_context_destroy(context);
  return failed;
}
