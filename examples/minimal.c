/* The smallest program that draws: a sphere of coloured discs, from arrays in memory to a float image in a file. */
#include <conic/conic.h>
#include <math.h>

enum { N = 4000 };
static float p[3][N], u[3][N], v[3][N], rgb[3][N]; /* centres, two tangents of one standard deviation, colours */
static const conic_splats splats = {.count = N,
                                    .position = {p[0], p[1], p[2]},
                                    .tangent_u = {u[0], u[1], u[2]},
                                    .tangent_v = {v[0], v[1], v[2]},
                                    .color = {rgb[0], rgb[1], rgb[2]}};

static void fill_sphere(void) { /* evenly, on a spiral from pole to pole */
  const double sigma = sqrt(4.0 * 3.14159265 / N), golden_angle_rad = 2.39996323;
  for (int i = 0; i < N; i++) {
    double y = 1.0 - (2.0 * i + 1.0) / N, r = sqrt(1.0 - y * y);
    double c = cos(golden_angle_rad * i), s = sin(golden_angle_rad * i);
    const double centre[3] = {r * c, y, r * s}, along[3] = {-s, 0.0, c}, down[3] = {y * c, -r, y * s};
    for (int k = 0; k < 3; k++) {
      p[k][i] = (float)centre[k];
      u[k][i] = (float)(sigma * along[k]);
      v[k][i] = (float)(sigma * down[k]);
      rgb[k][i] = (float)(0.5 + 0.5 * centre[k]);
    }
  }
}

int main(int argc, char **argv) {
  const char *path = argc > 1 ? argv[1] : "minimal.pfm";
  const double low[3] = {-1.0, -1.0, -1.0}, high[3] = {1.0, 1.0, 1.0};
  conic_context *context = NULL;
  conic_renderer *renderer = NULL;
  conic_image image = {0};
  conic_framing framing;
  conic_camera camera;
  conic_render_options options;

  fill_sphere();
  conic_framing_init(&framing);
  conic_render_options_init(&options);
  int failed = conic_context_create(NULL, &context) || conic_camera_frame(context, &framing, low, high, &camera) ||
               conic_image_allocate(context, camera.width, camera.height, 1u << CONIC_PLANE_RGBA, &image) ||
               conic_renderer_create(context, &renderer) ||
               conic_render(renderer, &splats, &camera, &options, &image, NULL) || /* floats in image.planes[0] */
               conic_image_write(context, path, &image);
  conic_renderer_destroy(renderer);
  conic_image_release(context, &image);
  conic_context_destroy(context);
  return failed;
}
