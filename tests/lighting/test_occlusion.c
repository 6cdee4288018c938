/* Ambient occlusion against rays. */
#include "tests/support/light_fixture.h"

/* What a picture is compared with rays by. */
typedef struct comparison {
  double mean, worst; /* error of pixels; of means over 5 × 5 pixels that are all covered */
  long n_pixels, n_blocks;
} comparison;

static double error_at(const light_picture *picture, const ray_mesh *mesh, int x, int y, int n_rays, double lift) {
  double place[3], normal[3];
  size_t pixel = (size_t)y * (size_t)picture->camera.width + (size_t)x;
  if (!light_place(picture, x, y, place, normal))
    return NAN;
  return (double)((const float *)picture->image.planes[CONIC_PLANE_AO])[pixel] -
         light_occlusion_by_rays(mesh, place, normal, n_rays, lift);
}

static comparison compare_with_rays(const light_picture *picture, const ray_mesh *mesh, int step, double lift) {
  comparison c = {.n_pixels = 0};
  for (int y = 2; y < picture->camera.height - 2; y += step)
    for (int x = 2; x < picture->camera.width - 2; x += step) {
      double sum = 0.0;
      int n = 0;
      for (int k = 0; k < 25; k++) {
        double error = error_at(picture, mesh, x + k % 5 - 2, y + k / 5 - 2, 24, lift);
        if (isnan(error))
          continue;
        c.mean += fabs(error);
        sum += error;
        n++;
      }
      c.n_pixels += n;
      c.n_blocks += n == 25;
      if (n == 25 && fabs(sum / 25.0) > c.worst)
        c.worst = fabs(sum / 25.0);
    }
  c.mean /= (double)c.n_pixels;
  return c;
}

static void judge_mesh(conic_context *context, const char *name, conic_triangles *mesh, int size, int step) {
  const conic_drawing drawing = {NULL, mesh};
  light_drawer drawer = {.context = context, .drawing = &drawing};
  conic_lighting_options options;
  CHECK_OK(conic_renderer_create(context, &drawer.renderer));
  conic_render_options_init(&drawer.options);
  conic_lighting_options_init(&options);
  options.n_directions = 1024;
  conic_casters casters = light_casters(&drawer, 0.0);
  light_picture picture = light_take_picture(&drawer, size, 30.0, 25.0, LIGHT_PLANES);
  CHECK_OK(conic_image_light(context, &casters, &picture.camera, &drawer.options, &options, &picture.image));
  CHECK(drawer.n_maps == 1024);
  double diagonal = 0.0;
  for (int axis = 0; axis < 3; axis++)
    diagonal += pow(casters.maximum[axis] - casters.minimum[axis], 2.0);
  ray_mesh rays = ray_mesh_of(mesh);
  comparison c = compare_with_rays(&picture, &rays, step, 2e-5 * sqrt(diagonal));
  printf("%s: %ld pixels, mean error %.4f; %ld blocks, the worst %.4f\n", name, c.n_pixels, c.mean, c.n_blocks,
         c.worst);
  CHECK(c.n_blocks > 20);
  CHECK(c.mean <= 0.01);
  CHECK(c.worst <= 0.05);
  ray_mesh_free(&rays);
  conic_image_release(context, &picture.image);
  conic_renderer_destroy(drawer.renderer);
  conic_triangles_release(context, mesh);
}

static double hills(double x, double z) {
  return 0.25 * sin(3.1 * x) * cos(2.3 * z) + 0.12 * sin(7.3 * x + 1.0) * sin(6.1 * z) +
         0.05 * cos(17.0 * x) * sin(15.0 * z + 0.5);
}

static void occlusion_is_that_of_rays(conic_context *context, const char *source_folder) {
  static const char *const files[] = {"fandisk.obj", "bunny.obj"};
  conic_triangles mesh = light_cube_on_plane(context);
  judge_mesh(context, "cube", &mesh, 256, 13);
  mesh = light_mesh(context, 2 * 120 * 120);
  light_field(&mesh, 120, 1.0, hills);
  judge_mesh(context, "terrain", &mesh, 192, 17);
  for (int i = 0; i < 2; i++) {
    const char *path = check_data(source_folder, files[i]);
    if (!path)
      continue;
    CHECK_OK(conic_triangles_read(context, path, &mesh));
    judge_mesh(context, files[i], &mesh, 192, 17);
  }
}

int main(int argc, char **argv) {
  conic_context *context = check_context(0);
  occlusion_is_that_of_rays(context, argc > 1 ? argv[1] : ".");
  conic_context_destroy(context);
  return check_result();
}
