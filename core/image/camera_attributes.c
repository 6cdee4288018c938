/* A camera as the attributes of an EXR. */

#include "conic/image.h"
#include "core/base/base.h"

static void append(conic_image *image, const char *name, conic_attribute_type type, const double *values, size_t n) {
  if (image->n_attributes == CONIC_MAX_ATTRIBUTES)
    return;
  conic_attribute *attribute = &image->attributes[image->n_attributes++];
  memset(attribute, 0, sizeof *attribute);
  snprintf(attribute->name, sizeof attribute->name, "%s", name);
  attribute->type = type;
  memcpy(attribute->values, values, n * sizeof *values);
}

/* The file's matrices multiply row vectors: our rows are columns there. */
static void add_matrix(conic_image *image, const char *name, const double rows[4][4]) {
  double values[16];
  for (int row = 0; row < 4; row++)
    for (int column = 0; column < 4; column++)
      values[4 * column + row] = rows[row][column];
  append(image, name, CONIC_ATTRIBUTE_FLOAT_MATRIX, values, 16);
}

void conic_image_describe_camera(conic_image *image, const conic_camera *camera) {
  static const double rec_709[] = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290};
  const double width = camera->width, height = camera->height;
  const double center[] = {(0.5 * width - camera->cx) / camera->fx, (camera->cy - 0.5 * height) / camera->fy};
  const double window_width = width / camera->fx, aspect = camera->fy / camera->fx;
  double to_camera[4][4] = {{0}}, to_ndc[4][4] = {{0}};
  to_camera[3][3] = 1.0;
  for (int i = 0; i < 4; i++) {
    const double x = camera->cam_from_world[0][i], y = camera->cam_from_world[1][i], z = camera->cam_from_world[2][i];
    to_camera[0][i] = x;
    to_camera[1][i] = -y; /* y points up there */
    to_camera[2][i] = z;
    to_ndc[0][i] = (camera->fx * x + camera->cx * z) / width;
    to_ndc[1][i] = (camera->fy * y + camera->cy * z) / height;
    to_ndc[2][i] = z - to_camera[3][i]; /* 1 - 1/z, so that the matrix has an inverse */
    to_ndc[3][i] = z;
  }
  add_matrix(image, "worldToCamera", (const double(*)[4])to_camera);
  if (!camera->kind && !camera->lens) { /* attributes cannot describe other kinds and lenses */
    add_matrix(image, "worldToNDC", (const double(*)[4])to_ndc);
    append(image, "screenWindowCenter", CONIC_ATTRIBUTE_FLOAT_PAIR, center, 2);
    if (window_width < 1e38)
      append(image, "screenWindowWidth", CONIC_ATTRIBUTE_FLOAT, &window_width, 1);
  }
  if (aspect >= 1e-6 && aspect <= 1e6) /* others no file may have */
    append(image, "pixelAspectRatio", CONIC_ATTRIBUTE_FLOAT, &aspect, 1);
  append(image, "chromaticities", CONIC_ATTRIBUTE_CHROMATICITIES, rec_709, 8);
}
