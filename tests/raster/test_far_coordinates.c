/* A scene in map coordinates looks as it does at the origin, whichever format it comes in. */
#include "tests/support/files.h"
#include "tests/support/las_file.h"
#include "tests/support/random_numbers.h"

enum { N_POINTS = 6000, SIZE = 256 };

static conic_context *context;

/* A bumpy ball of some 5 m in whole millimetres, with colours, sampled without order. */
static int32_t points_mm[N_POINTS][3];
static unsigned colors[N_POINTS][3];

static void make_points(void) {
  uint64_t state = 1;
  for (int i = 0; i < N_POINTS; i++) {
    double p[3], length2;
    do {
      length2 = 0.0;
      for (int axis = 0; axis < 3; axis++) {
        p[axis] = 2.0 * random_unit(&state) - 1.0;
        length2 += p[axis] * p[axis];
      }
    } while (length2 > 1.0 || length2 < 0.01);
    double radius_mm = 5000.0 * (1.0 + 0.1 * p[0] * p[1] / length2) / sqrt(length2);
    for (int axis = 0; axis < 3; axis++) {
      points_mm[i][axis] = (int32_t)(radius_mm * p[axis]);
      colors[i][axis] = (unsigned)(255.0 * (0.5 + 0.5 * p[axis]));
    }
  }
}

typedef const char *write_scene(const double offset_m[3]);

/* As programs write it: sums of doubles, not of whole millimetres. */
static double coordinate_m(const double offset_m[3], int i, int axis) {
  return offset_m[axis] + points_mm[i][axis] * 0.001;
}

static FILE *open_file(const char *path) {
  FILE *file = fopen(path, "wb");
  if (!file)
    exit(1);
  return file;
}

static const char *write_ply(const double offset_m[3]) {
  const char *path = files_path("a.ply");
  FILE *file = open_file(path);
  fprintf(file,
          "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\nproperty double y\n"
          "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
          N_POINTS);
  for (int i = 0; i < N_POINTS; i++) {
    for (int axis = 0; axis < 3; axis++) {
      double value = coordinate_m(offset_m, i, axis);
      uint64_t bits;
      memcpy(&bits, &value, sizeof bits);
      for (int byte = 0; byte < 8; byte++)
        putc((int)(bits >> 8 * byte & 255), file);
    }
    for (int channel = 0; channel < 3; channel++)
      putc((int)colors[i][channel], file);
  }
  fclose(file);
  return path;
}

static const char *write_xyz(const double offset_m[3]) {
  const char *path = files_path("a.xyz");
  FILE *file = open_file(path);
  for (int i = 0; i < N_POINTS; i++)
    fprintf(file, "%.3f %.3f %.3f %u %u %u\n", coordinate_m(offset_m, i, 0), coordinate_m(offset_m, i, 1),
            coordinate_m(offset_m, i, 2), colors[i][0], colors[i][1], colors[i][2]);
  fclose(file);
  return path;
}

static const char *write_las(const double offset_m[3]) {
  las_file file = las_begin(2, 2, N_POINTS, 0);
  las_set_scale(&file, 0.001, offset_m[0], offset_m[1], offset_m[2]);
  for (int i = 0; i < N_POINTS; i++) {
    las_set_point(&file, (size_t)i, points_mm[i][0], points_mm[i][1], points_mm[i][2]);
    las_set_color(&file, (size_t)i, colors[i][0], colors[i][1], colors[i][2]);
  }
  const char *path = files_write_bytes("a.las", file.bytes, file.n_bytes);
  free(file.bytes);
  return path;
}

/* From the file to the picture, framed as the program does. */
static void draw(write_scene *write, const double offset_m[3], conic_image *image) {
  const unsigned planes = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_NORMAL;
  const char *path = write(offset_m);
  conic_model model;
  conic_framing framing;
  conic_camera camera;
  conic_estimate_options estimate;
  conic_render_options options;
  conic_renderer *renderer;
  double low[3], high[3];
  conic_framing_init(&framing);
  framing.width = framing.height = SIZE;
  conic_estimate_options_init(&estimate);
  conic_render_options_init(&options);
  CHECK_OK(conic_model_read(context, path, NULL, &model));
  CHECK(unlink(path) == 0);
  CHECK_OK(conic_model_to_splats(context, &estimate, &model, NULL));
  CHECK(conic_splats_bounds(&model.points, low, high) == N_POINTS);
  CHECK_OK(conic_camera_frame(context, &framing, low, high, &camera));
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK_OK(conic_image_allocate(context, SIZE, SIZE, planes, image));
  CHECK_OK(conic_render(renderer, &model.points, &camera, &options, image, NULL));
  conic_renderer_destroy(renderer);
  conic_model_release(context, &model);
}

static double difference_at(const conic_image *a, const conic_image *b, conic_plane plane, size_t i_pixel) {
  size_t n = (size_t)conic_plane_describe(plane)->n_channels;
  const float *p = (const float *)a->planes[plane] + i_pixel * n, *q = (const float *)b->planes[plane] + i_pixel * n;
  double largest = 0.0;
  for (size_t c = 0; c < n; c++) {
    double difference = fabs((double)p[c] - (double)q[c]);
    if (!(difference <= largest))
      largest = difference;
  }
  return largest;
}

/* How far apart the pictures may be. Positions are floats relative to the first point, here up to 11 m from it, so they
 * are rounded by up to 2⁻²¹ m; the doubles before them, at 1e7 m, by some 2⁻³⁰ m, which may turn that rounding over: a
 * splat moves by 5e-7 m, or at 351 px focal length and 17 m by 1e-5 px. A weight so changes by under 1e-5 of the
 * largest, colours and normals by less than ten times that after shading; depth by the movement times the slope. Only
 * where an outline passes within 1e-5 px of a pixel's centre may a splat come or go: under one pixel in a thousand. */
static void compare(const char *name, const conic_image *a, const conic_image *b) {
  static const struct {
    conic_plane plane;
    double bound;
  } bounds[] = {{CONIC_PLANE_RGBA, 1e-4}, {CONIC_PLANE_Z, 1e-4}, {CONIC_PLANE_NORMAL, 1e-4}};
  size_t n_covered = 0, n_beyond = 0;
  for (size_t i = 0; i < (size_t)SIZE * SIZE; i++) {
    int is_beyond = 0;
    for (int k = 0; k < 3; k++)
      is_beyond |= !(difference_at(a, b, bounds[k].plane, i) <= bounds[k].bound);
    n_beyond += (size_t)is_beyond;
    n_covered += ((const float *)a->planes[CONIC_PLANE_Z])[i] > 0.0f;
  }
  if (n_covered < 10000 || n_beyond * 1000 > n_covered) {
    fprintf(stderr, "%s: %zu of %zu pixels differ\n", name, n_beyond, n_covered);
    check_failures++;
  }
}

int main(void) {
  static const struct {
    const char *name;
    write_scene *write;
  } formats[] = {{"PLY", write_ply}, {"XYZ", write_xyz}, {"LAS", write_las}};
  const double here[3] = {0, 0, 0}, there[3] = {589500.0, 231300.0, 1e7};
  context = files_context();
  make_points();
  for (int i = 0; i < 3; i++) {
    conic_image a, b;
    draw(formats[i].write, here, &a);
    draw(formats[i].write, there, &b);
    compare(formats[i].name, &a, &b);
    conic_image_release(context, &a);
    conic_image_release(context, &b);
  }
  files_end(context);
  return check_result();
}
