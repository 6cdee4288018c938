/* Polygons that are not convex: their triangles cover them once and nothing else, keep their corners' other data, and
 * what is convex, or no polygon at all, stays the fan. */
#include "tests/support/check.h"
#include "tests/support/files.h"

static conic_model read_text(conic_context *context, const char *path, const char *text) {
  conic_read_options options;
  conic_model model;
  conic_read_options_init(&options);
  options.keeps_faces = 1;
  const char *file = files_write(path, text);
  CHECK_OK(conic_model_read(context, file, &options, &model));
  remove(file);
  return model;
}

/* The sum of the triangles' areas in x and y, and of their magnitudes. */
static void measure(const conic_model *model, double *area, double *magnitude) {
  *area = *magnitude = 0.0;
  for (size_t i = 0; i < model->n_triangles; i++) {
    double at[3][2];
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 2; axis++)
        at[k][axis] = (double)model->points.position[axis][model->triangles[i][k]];
    double twice = (at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) - (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]);
    *area += 0.5 * twice;
    *magnitude += 0.5 * fabs(twice);
  }
}

static void check_area(conic_context *context, const char *path, const char *text, size_t n_triangles, double wanted) {
  conic_model model = read_text(context, path, text);
  double area, magnitude;
  measure(&model, &area, &magnitude);
  CHECK(model.n_triangles == n_triangles);
  CHECK_NEAR(area, wanted, 1e-6);
  CHECK_NEAR(magnitude, fabs(wanted), 1e-6);
  conic_model_release(context, &model);
}

/* An L of area 3, from the corner that a fan sees least of; a chevron; the L the other way round. */
static const char l_shape[] = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nf 1 2 3 4 5 6\n";
static const char l_turned[] = "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nf 6 5 4 3 2 1\n";
static const char chevron[] = "v 0 0 0\nv 2 -1 0\nv 1 0 0\nv 2 1 0\nf 2 3 4 1\n";
static const char in_ply[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                             "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                             "0 0 0\n2 -1 0\n1 0 0\n2 1 0\n4 3 0 1 2\n";

static void check_fan(conic_context *context, const char *text, size_t n_triangles) {
  conic_model model = read_text(context, "fan.obj", text);
  CHECK(model.n_triangles == n_triangles);
  for (size_t i = 0; i < model.n_triangles; i++)
    CHECK(model.triangles[i][0] == 0 && model.triangles[i][1] == i + 1 && model.triangles[i][2] == i + 2);
  conic_model_release(context, &model);
}

/* Texture coordinates go with their corners: here they are the places. */
static void check_coordinates(conic_context *context) {
  conic_triangles triangles;
  conic_model model = read_text(context, "textured.obj",
                                "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nvt 0 0\nvt 0 2\nvt 1 2\nvt 1 1\n"
                                "vt 2 1\nvt 2 0\nf 1/6 2/5 3/4 4/3 5/2 6/1\n");
  CHECK_OK(conic_triangles_take(context, &model, &triangles));
  CHECK(triangles.count == 4 && triangles.texture_coordinate[0] != NULL);
  for (size_t i = 0; i < triangles.count; i++)
    for (int k = 0; k < 3; k++)
      for (int axis = 0; axis < 2; axis++) {
        uint32_t at = triangles.texture_corners ? triangles.texture_corners[i][k] : triangles.corners[i][k];
        CHECK(triangles.texture_coordinate[axis][at] == triangles.position[axis][triangles.corners[i][k]]);
      }
  conic_triangles_release(context, &triangles);
  conic_model_release(context, &model);
}

int main(void) {
  conic_context *context = files_context();
  check_area(context, "l.obj", l_shape, 4, 3.0);
  check_area(context, "l_turned.obj", l_turned, 4, -3.0);
  check_area(context, "chevron.obj", chevron, 2, 1.0);
  check_area(context, "chevron.ply", in_ply, 2, 1.0);
  check_fan(context, "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n", 3);
  check_fan(context, "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", 2); /* crosses itself */
  check_fan(context, "v 0 0 0\nv 1 1 0\nv 2 2 0\nv nan 1 0\nv 4 4 0\nf 1 2 3 4 5\n", 3);
  check_fan(context, "v 0 0 0\nv 2 -1 0\nf 1 2 3 4\nv 1 0 0\nv 2 1 0\n", 2); /* vertices that come later */
  check_coordinates(context);
  files_end(context);
  return check_result();
}
