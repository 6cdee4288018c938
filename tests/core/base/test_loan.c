/* What is lent under a name is read and drawn as a file of the same numbers is. */
#include "core/base/loan_find.h"

#include <string.h>

#include "conic/conic.h"
#include "tests/support/check.h"

static void check_lent_names(conic_context *context) {
  conic_camera camera = {.width = 4, .height = 3, .fx = 2.0, .fy = 2.0};
  CHECK(conic_lend(context, "camera", &camera) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_lend(context, "memory:sphere:1", &camera) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_lend(context, "memory:camera:1", NULL) == CONIC_ERROR_ARGUMENT);
  CHECK(conic_lend(context, "memory:camera:1", &camera) == CONIC_OK);
  CHECK(conic_loan_find(context, "memory:camera:1", "camera") == &camera);
  CHECK(!conic_loan_find(context, "memory:camera:2", "camera"));
  CHECK(!conic_loan_find(context, "memory:camera:1", "image"));
  CHECK(conic_loan_is_named("memory:image:", "image") && !conic_loan_is_named("memory:images:", "image"));
  conic_take_back_loans(context);
  CHECK(!conic_loan_find(context, "memory:camera:1", "camera"));
}

static void check_lent_cameras(conic_context *context) {
  conic_camera camera = {.width = 4, .height = 3, .fx = 2.0, .fy = 3.0, .cx = 2.0, .cy = 1.5}, found;
  for (int i = 0; i < 3; i++)
    camera.cam_from_world[i][i] = 1.0;
  CHECK(conic_lend(context, "memory:camera:a", &camera) == CONIC_OK);
  CHECK(conic_camera_read(context, "memory:camera:a", &found) == CONIC_OK &&
        memcmp(&camera, &found, sizeof found) == 0);
  conic_cameras_options options;
  conic_cameras_options_init(&options);
  options.width = options.height = 12;
  conic_cameras cameras;
  CHECK(conic_cameras_read(context, "memory:camera:a", &options, &cameras) == CONIC_OK);
  CHECK(cameras.cameras[0].fx == 6.0 && cameras.cameras[0].fy == 12.0);
  conic_cameras_release(context, &cameras);
  camera.fx = 0.0;
  CHECK(conic_camera_read(context, "memory:camera:a", &found) == CONIC_ERROR_INPUT);
  conic_take_back_loans(context);
}

static void check_lent_images(conic_context *context) {
  conic_image image, found;
  CHECK(conic_image_allocate(context, 3, 2, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_ID, &image) == CONIC_OK);
  for (uint32_t i = 0; i < 6; i++)
    ((uint32_t *)image.planes[CONIC_PLANE_ID])[i] = i;
  image.is_display = 1;
  CHECK(conic_lend(context, "memory:image:a", &image) == CONIC_OK);
  CHECK(conic_image_read(context, "memory:image:a", &found) == CONIC_OK);
  CHECK(conic_image_planes(&found) == conic_image_planes(&image) && found.is_display == 1);
  CHECK(conic_image_hash(&found, CONIC_PLANE_ID) == conic_image_hash(&image, CONIC_PLANE_ID));
  CHECK(found.planes[CONIC_PLANE_ID] != image.planes[CONIC_PLANE_ID]);
  conic_image_release(context, &found);
  conic_take_back_loans(context);
  conic_image_release(context, &image);
  CHECK(conic_image_read(context, "memory:image:a", &found) == CONIC_ERROR_INPUT);
}

/* Eight splats of a square, in rows of 13 floats, and one more value. */
static float rows[8][13];

static conic_splats make_rows(void) {
  conic_splats splats = {.count = 8, .origin = {10.0, 0.0, 0.0}, .scalar = &rows[0][12]};
  memset(rows, 0, sizeof rows);
  for (int i = 0; i < 8; i++) {
    rows[i][0] = (float)(i % 4);
    rows[i][1] = (float)(i / 4);
    rows[i][3] = rows[i][7] = 0.5f;
    rows[i][9] = 0.1f * (float)i;
  }
  for (int axis = 0; axis < 3; axis++) {
    splats.position[axis] = &rows[0][axis];
    splats.tangent_u[axis] = &rows[0][3 + axis];
    splats.tangent_v[axis] = &rows[0][6 + axis];
    splats.color[axis] = &rows[0][9 + axis];
  }
  splats.strides.position = splats.strides.tangent_u = splats.strides.tangent_v = sizeof *rows;
  splats.strides.color = splats.strides.scalar = sizeof *rows;
  return splats;
}

static conic_status add_batch(void *cookie, const conic_splats *batch) {
  *(size_t *)cookie += batch->count;
  return CONIC_OK;
}

static void check_lent_splats(conic_context *context) {
  conic_splats splats = make_rows();
  conic_model model;
  size_t n = 0;
  CHECK(conic_lend(context, "memory:splats:a", &splats) == CONIC_OK);
  CHECK(conic_model_read(context, "memory:splats:a", NULL, &model) == CONIC_OK);
  CHECK(model.points.count == 8 && model.points.origin[0] == 10.0 && !model.points.scalar);
  CHECK(model.points.position[0][3] == 3.0f && model.points.position[1][5] == 1.0f);
  CHECK(model.points.tangent_v[1][2] == 0.5f && model.points.color[0][7] == rows[7][9]);
  conic_model_release(context, &model);
  CHECK(conic_model_stream(context, "memory:splats:a", NULL, add_batch, &n) == CONIC_OK && n == 8);

  conic_read_options options;
  conic_read_options_init(&options);
  options.field = "intensity";
  CHECK(conic_model_read(context, "memory:splats:a", &options, &model) == CONIC_OK && model.points.scalar);
  conic_model_release(context, &model);
  splats.scalar = NULL;
  CHECK(conic_model_read(context, "memory:splats:a", &options, &model) == CONIC_ERROR_INPUT);
  splats.tangent_v[2] = NULL;
  CHECK(conic_model_read(context, "memory:splats:a", NULL, &model) == CONIC_ERROR_ARGUMENT);
  conic_take_back_loans(context);
}

/* Of what is drawn where it lies, and of what has to be put right before. */
static uint64_t draw_lent(conic_context *context, const conic_splats *splats, int is_borrowed) {
  const char *const name = "memory:splats:drawn";
  conic_source *source;
  conic_renderer *renderer;
  conic_camera camera;
  conic_render_options options;
  conic_image image;
  uint64_t hash = 0;
  conic_render_options_init(&options);
  CHECK(conic_lend(context, name, splats) == CONIC_OK);
  CHECK(conic_renderer_create(context, &renderer) == CONIC_OK);
  CHECK(conic_source_open(context, &name, 1, NULL, &source) == CONIC_OK);
  CHECK((conic_source_chosen(source)->drawing.splats->color[0] == splats->color[0]) == is_borrowed);
  CHECK(conic_source_frame(source, NULL, &camera) == CONIC_OK);
  conic_camera_resize(&camera, 32, 32);
  CHECK(conic_image_allocate(context, 32, 32, 1, &image) == CONIC_OK);
  if (conic_source_draw(source, renderer, &camera, &options, NULL, &image, NULL) == CONIC_OK)
    hash = conic_image_hash(&image, CONIC_PLANE_RGBA);
  conic_image_release(context, &image);
  conic_source_close(source);
  conic_renderer_destroy(renderer);
  conic_take_back_loans(context);
  return hash;
}

static void check_drawing(conic_context *context) {
  conic_splats strided = make_rows(), close = {.origin = {10.0, 0.0, 0.0}};
  strided.scalar = NULL;
  CHECK(conic_splats_append(context, &close, &strided) == CONIC_OK);
  uint64_t hash = draw_lent(context, &close, 1);
  CHECK(hash != 0 && draw_lent(context, &strided, 0) == hash);
  float before = close.tangent_u[0][2];
  close.tangent_u[0][2] = 0.0f; /* no axis */
  CHECK(draw_lent(context, &close, 0) != hash);
  close.tangent_u[0][2] = before;
  CHECK(draw_lent(context, &close, 1) == hash);
  conic_splats_release(context, &close);
}

static void check_lent_triangles(conic_context *context) {
  float x[] = {0.0f, 1.0f, 0.0f}, y[] = {0.0f, 0.0f, 1.0f}, z[] = {0.0f, 0.0f, 0.0f}, u[] = {0.0f, 0.5f, 1.0f};
  uint32_t corners[][3] = {{0, 1, 2}};
  conic_triangles mesh = {.count = 1, .corners = corners, .n_vertices = 3, .position = {x, y, z}}, found;
  mesh.n_texture_coordinates = 3;
  mesh.texture_coordinate[0] = mesh.texture_coordinate[1] = u;
  CHECK(conic_lend(context, "memory:triangles:a", &mesh) == CONIC_OK);
  CHECK(conic_triangles_read(context, "memory:triangles:a", &found) == CONIC_OK);
  CHECK(found.count == 1 && found.n_vertices == 3 && found.corners[0][2] == 2 && found.position[1][2] == 1.0f);
  CHECK(found.n_texture_coordinates == 3 && found.texture_coordinate[1][1] == 0.5f);
  conic_triangles_release(context, &found);
  corners[0][1] = 3;
  CHECK(conic_triangles_read(context, "memory:triangles:a", &found) == CONIC_ERROR_INPUT);
  conic_take_back_loans(context);
}

static void check_lent_gaussians(conic_context *context) {
  float numbers[11] = {1.0f, 2.0f, 3.0f, 0.1f, 0.2f, 0.3f, 1.0f, 0.0f, 0.0f, 0.0f, 0.5f}, sh[12];
  conic_gaussians set = {.count = 1, .opacity = &numbers[10], .sh_degree = 1, .sh = sh, .frame = "rub"}, found;
  for (int i = 0; i < 12; i++)
    sh[i] = (float)i;
  for (int i = 0; i < 4; i++)
    set.rotation[i] = &numbers[6 + i];
  for (int i = 0; i < 3; i++) {
    set.position[i] = &numbers[i];
    set.scale[i] = &numbers[3 + i];
  }
  conic_gaussians_read_options options;
  conic_gaussians_read_options_init(&options);
  CHECK(conic_lend(context, "memory:gaussians:a", &set) == CONIC_OK);
  CHECK(conic_gaussians_is_file(context, "memory:gaussians:a"));
  CHECK(conic_gaussians_read(context, "memory:gaussians:a", &options, &found) == CONIC_OK);
  CHECK(found.position[2][0] == 3.0f && found.sh[11] == 11.0f && strcmp(found.frame, "rub") == 0);
  conic_gaussians_release(context, &found);
  options.most_sh_degree = 0;
  options.half_harmonics = 1;
  CHECK(conic_gaussians_read(context, "memory:gaussians:a", &options, &found) == CONIC_OK);
  CHECK(found.sh_degree == 0 && !found.sh && found.sh_half);
  conic_gaussians_release(context, &found);
  set.opacity = NULL;
  CHECK(conic_gaussians_read(context, "memory:gaussians:a", NULL, &found) == CONIC_ERROR_ARGUMENT);
  conic_take_back_loans(context);
}

int main(void) {
  conic_context *context;
  CHECK(conic_context_create(NULL, &context) == CONIC_OK);
  check_lent_names(context);
  check_lent_cameras(context);
  check_lent_images(context);
  check_lent_splats(context);
  check_drawing(context);
  check_lent_triangles(context);
  check_lent_gaussians(context);
  conic_camera camera = {.width = 1};
  CHECK(conic_lend(context, "memory:camera:left", &camera) == CONIC_OK); /* goes with the context */
  conic_context_destroy(context);
  return check_result();
}
