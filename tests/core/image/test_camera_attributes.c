/* What an EXR says of its camera: points to the left of its matrices land where the camera sees them; and where the
 * world lies behind its pixels. */
#include "tests/support/image_fixture.h"

static const conic_attribute *find(const conic_image *image, const char *name) {
  int i = 0, n = image->n_attributes;
  while (i < n && strcmp(image->attributes[i].name, name) != 0)
    i++;
  CHECK(i < n);
  if (i == n)
    exit(1);
  return &image->attributes[i];
}

/* (point, 1) to the left of the matrix. */
static void transform(const double point[3], const double matrix[16], double to[4]) {
  for (int column = 0; column < 4; column++)
    to[column] =
        point[0] * matrix[column] + point[1] * matrix[4 + column] + point[2] * matrix[8 + column] + matrix[12 + column];
}

static conic_camera a_camera(void) {
  const double world[3][4] = {{0.36, 0.48, -0.8, 0.5}, {-0.8, 0.6, 0.0, -0.25}, {0.48, 0.64, 0.6, 7.0}};
  conic_camera camera = {.width = 640, .height = 480, .fx = 700.0, .fy = 650.0, .cx = 300.0, .cy = 250.0};
  memcpy(camera.cam_from_world, world, sizeof world);
  return camera;
}

static void check_point(const conic_image *image, const conic_camera *camera, const double point[3]) {
  double seen[3], there[4], ndc[4];
  for (int row = 0; row < 3; row++) {
    const double *m = camera->cam_from_world[row];
    seen[row] = m[0] * point[0] + m[1] * point[1] + m[2] * point[2] + m[3];
  }
  transform(point, find(image, "worldToCamera")->values, there);
  CHECK_NEAR(there[0], seen[0], 1e-9);
  CHECK_NEAR(there[1], -seen[1], 1e-9); /* y is up */
  CHECK_NEAR(there[2], seen[2], 1e-9);
  CHECK_NEAR(there[3], 1.0, 1e-12);
  transform(point, find(image, "worldToNDC")->values, ndc);
  double x = camera->fx * seen[0] / seen[2] + camera->cx, y = camera->fy * seen[1] / seen[2] + camera->cy;
  CHECK_NEAR(ndc[0] / ndc[3], x / camera->width, 1e-9);
  CHECK_NEAR(ndc[1] / ndc[3], y / camera->height, 1e-9);

  /* The screen window lies at distance 1, and its centre in the middle of the picture. */
  const double *center = find(image, "screenWindowCenter")->values;
  double width = find(image, "screenWindowWidth")->values[0], aspect = find(image, "pixelAspectRatio")->values[0];
  double height = width * camera->height / camera->width / aspect;
  CHECK_NEAR((there[0] / there[2] - center[0]) / width + 0.5, x / camera->width, 1e-9);
  CHECK_NEAR(0.5 - (there[1] / there[2] - center[1]) / height, y / camera->height, 1e-9);
}

/* They come back from a file, as floats; and what is more than there is room for is left out. */
static void test_file(conic_context *context, const conic_camera *camera) {
  conic_image image = random_image(context, 4, 3, 1u), back;
  conic_image_describe_camera(&image, camera);
  CHECK_OK(conic_image_write(context, in_folder("a.exr"), &image));
  CHECK_OK(conic_image_read(context, in_folder("a.exr"), &back));
  for (int i = 0; i < image.n_attributes; i++) {
    const conic_attribute *from = &image.attributes[i], *to = find(&back, from->name);
    CHECK(to->type == from->type);
    for (int k = 0; k < 16; k++)
      CHECK(to->values[k] == (double)(float)from->values[k]);
  }
  conic_image_release(context, &back);
  image.n_attributes = CONIC_MAX_ATTRIBUTES - 1;
  conic_image_describe_camera(&image, camera);
  CHECK(image.n_attributes == CONIC_MAX_ATTRIBUTES);
  conic_image_release(context, &image);
}

/* Pixels may be flatter than a file can say: then it says nothing. What a file cannot have is an error, and no wait. */
static void test_flat_pixels(conic_context *context) {
  conic_camera flat = a_camera();
  conic_image image = random_image(context, 4, 3, 1u), back;
  flat.fx = 4e9;
  conic_image_describe_camera(&image, &flat);
  CHECK_OK(conic_image_write(context, in_folder("flat.exr"), &image));
  CHECK_OK(conic_image_read(context, in_folder("flat.exr"), &back));
  conic_image_release(context, &back);
  image.n_attributes = 1;
  image.attributes[0] = (conic_attribute){.name = "pixelAspectRatio", .type = CONIC_ATTRIBUTE_FLOAT, .values = {1e9}};
  CHECK(conic_image_write(context, in_folder("none.exr"), &image) != CONIC_OK);
  conic_image_release(context, &image);
}

/* Places are where the camera sees the pixel's middle, or the sample next to it, at that depth. */
static void test_positions(conic_context *context, const conic_camera *camera, int samples) {
  conic_image image;
  const double offset = samples % 2 ? 0.5 : 0.5 - 0.5 / samples;
  CHECK_OK(conic_image_allocate(context, 640, 480, 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_POSITION, &image));
  float *z = image.planes[CONIC_PLANE_Z], *place = image.planes[CONIC_PLANE_POSITION];
  for (int i = 0; i < 640 * 480; i++)
    z[i] = i % 3 ? 1.0f + (float)(i % 97) : 0.0f;
  CHECK_OK(conic_image_locate(context, camera, samples, &image));
  for (int i = 0; i < 640 * 480; i += 101) {
    const float *p = place + 3 * i;
    double seen[3];
    if (z[i] == 0.0f) {
      CHECK(p[0] == 0.0f && p[1] == 0.0f && p[2] == 0.0f);
      continue;
    }
    for (int row = 0; row < 3; row++) {
      const double *m = camera->cam_from_world[row];
      seen[row] = m[0] * (double)p[0] + m[1] * (double)p[1] + m[2] * (double)p[2] + m[3];
    }
    CHECK_NEAR(seen[2], (double)z[i], 2e-5);
    CHECK_NEAR(camera->fx * seen[0] / seen[2] + camera->cx, i % 640 + offset, 5e-3);
    CHECK_NEAR(camera->fy * seen[1] / seen[2] + camera->cy, i / 640 + offset, 5e-3);
  }
  conic_camera other = *camera;
  other.width--;
  CHECK(conic_image_locate(context, &other, 1, &image) == CONIC_ERROR_ARGUMENT);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context = check_context(1);
  conic_camera camera = a_camera();
  conic_image image = {.width = 640, .height = 480};
  conic_image_describe_camera(&image, &camera);
  CHECK(image.n_attributes == 6);
  for (int i = 0; i < 8; i++)
    check_point(&image, &camera, (const double[3]){i % 2 - 0.4, i / 2 % 2 - 0.6, i / 4 + 0.1});
  for (int samples = 1; samples <= 4; samples++)
    test_positions(context, &camera, samples);
  if (has_feature("OpenEXR")) {
    open_test_folder();
    test_file(context, &camera);
    test_flat_pixels(context);
    close_test_folder();
  }
  conic_context_destroy(context);
  return check_result();
}
