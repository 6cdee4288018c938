/* Inputs that move and change their shape: an edge against its integral, a turning half plane, what stands still to the
 * bit, axes and normals, and what is refused. */
#include "conic/motion.h"
#include "tests/support/files.h"

enum { WIDTH = 48, HEIGHT = 24, N_SAMPLES = 1024 };

typedef struct stage {
  conic_context *context;
  conic_renderer *renderer;
  conic_source *source;
  conic_motion *motion;
  conic_render_options options;
  conic_camera camera;
} stage;

static void write_text(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

static conic_status read_key_text(conic_context *context, const char *text, conic_motion **motion) {
  const char *path = files_path("motion.json");
  write_text(path, text);
  return conic_motion_read(context, path, 1, NULL, motion);
}

/* The half plane to the right of x = 0 at depth 2, before nothing. */
static conic_source *make_edge(conic_context *context) {
  static const uint32_t corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
  const float x[4] = {0, 9, 9, 0}, y[4] = {-9, -9, 9, 9};
  conic_triangles triangles;
  conic_splats splats = {.count = 0};
  conic_source *source;
  CHECK_OK(conic_splats_allocate(context, 0, CONIC_SPLATS_TANGENTS, &splats));
  CHECK_OK(conic_triangles_allocate(context, 2, 4, 0, &triangles));
  memcpy(triangles.corners, corners, sizeof corners);
  for (int i = 0; i < 4; i++) {
    triangles.position[0][i] = x[i];
    triangles.position[1][i] = y[i];
    triangles.position[2][i] = 2.0f;
  }
  CHECK_OK(conic_source_of_drawing(context, &splats, &triangles, &source));
  return source;
}

static stage set_motion_stage(conic_context *context) {
  stage s = {.context = context, .source = make_edge(context)};
  CHECK_OK(conic_renderer_create(context, &s.renderer));
  conic_render_options_init(&s.options);
  s.options.shading = CONIC_SHADE_NONE;
  s.options.near_z = 0.01;
  s.camera = (conic_camera){.width = WIDTH, .height = HEIGHT, .fx = 100, .fy = 100, .cx = 24, .cy = 12};
  for (int i = 0; i < 3; i++)
    s.camera.cam_from_world[i][i] = 1.0;
  return s;
}

static void end_stage(stage *s) {
  conic_motion_destroy(s->motion);
  conic_source_close(s->source);
  conic_renderer_destroy(s->renderer);
}

static conic_status draw_moment(void *cookie, const conic_sample *sample, conic_image *image) {
  stage *s = cookie;
  conic_status status = s->motion ? conic_motion_apply(s->motion, s->source, sample->time) : CONIC_OK;
  return status == CONIC_OK ? conic_source_draw(s->source, s->renderer, &sample->camera, &s->options, NULL, image, NULL)
                            : status;
}

static conic_image accumulate_moments(stage *s, uint64_t n_samples) {
  conic_accumulate_options options;
  conic_accumulation *sums;
  conic_image image;
  conic_accumulate_options_init(&options);
  options.camera = s->camera;
  options.end_sample = n_samples;
  options.cookie = s;
  options.draw = draw_moment;
  CHECK_OK(conic_accumulation_create(s->context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, 0, &sums));
  CHECK_OK(conic_accumulate(s->context, &options, sums));
  CHECK_OK(conic_image_allocate(s->context, WIDTH, HEIGHT, 1u << CONIC_PLANE_RGBA, &image));
  CHECK_OK(conic_accumulation_resolve(sums, &image));
  conic_accumulation_destroy(sums);
  return image;
}

static double alpha_at(const conic_image *image, int x, int y) {
  return (double)((const float *)image->planes[CONIC_PLANE_RGBA])[4 * (y * WIDTH + x) + 3];
}

/* The part of the time that the edge, which goes from pixel 24 to 24 + length, has not come to x yet. */
static double ramp_at(double x, double length) {
  double part = (x - 24.0) / length;
  return part < 0.0 ? 0.0 : part > 1.0 ? 1.0 : part;
}

static void check_moved_edge(conic_context *context) {
  const double length = 12.5; /* 0.25 units at depth 2 */
  double worst = 0.0;
  stage s = set_motion_stage(context);
  CHECK_OK(read_key_text(context,
                         "[{\"frame\": 1, \"matrix\": [[1,0,0,0.25],[0,1,0,0],[0,0,1,0]]},"
                         " {\"frame\": 0, \"input\": 0, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]},"
                         " {\"frame\": 0, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]",
                         &s.motion));
  conic_image image = accumulate_moments(&s, N_SAMPLES);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      double truth = 0.0;
      for (int k = 0; k < 64; k++)
        truth += ramp_at(x + (k + 0.5) / 64.0, length) / 64.0;
      worst = fmax(worst, fabs(alpha_at(&image, x, y) - truth));
    }
  fprintf(stderr, "ramp: largest %.2e\n", worst);
  CHECK(worst < 4e-3);
  conic_image_release(context, &image);
  end_stage(&s);
}

/* Once round in six keys, every place is covered for half of the time, however it turns between them. */
static void check_turn(conic_context *context) {
  char text[2000];
  size_t n = 0;
  double worst = 0.0;
  stage s = set_motion_stage(context);
  for (int i = 0; i <= 6; i++) {
    double c = cos(i * 1.0471975511965976), e = sin(i * 1.0471975511965976);
    n += (size_t)snprintf(text + n, sizeof text - n,
                          "%c{\"frame\": %.17g, \"matrix\": [[%.17g,%.17g,0,0],[%.17g,%.17g,0,0],[0,0,1,0]]}",
                          i ? ',' : '[', i / 6.0, c, -e, e, c);
  }
  snprintf(text + n, sizeof text - n, "]");
  CHECK_OK(read_key_text(context, text, &s.motion));
  conic_image image = accumulate_moments(&s, N_SAMPLES);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++)
      worst = fmax(worst, fabs(alpha_at(&image, x, y) - 0.5));
  fprintf(stderr, "turn: largest %.2e\n", worst);
  CHECK(worst < 8e-3);
  conic_image_release(context, &image);
  end_stage(&s);
}

static void check_still(conic_context *context) {
  stage s = set_motion_stage(context);
  conic_source_pose pose;
  uint64_t hashes[4];
  double low[3], high[3];
  conic_source_pose_init(&pose);
  for (int i = 0; i < 4; i++) {
    if (i == 1)
      CHECK_OK(read_key_text(context,
                             "[{\"frame\": 0, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]},"
                             " {\"frame\": 1, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]",
                             &s.motion));
    if (i == 2) {
      conic_motion_destroy(s.motion);
      s.motion = NULL;
      pose.world_from_rest[0][3] = 0.1;
      CHECK_OK(conic_source_move(s.source, &pose, 1));
      conic_source_box(s.source, low, high);
      CHECK_NEAR(low[0], 0.1, 1e-7);
      CHECK_NEAR(high[0], 9.1, 1e-6);
    }
    if (i == 3)
      CHECK_OK(conic_source_move(s.source, NULL, 0));
    conic_image image = accumulate_moments(&s, 5);
    hashes[i] = conic_image_hash(&image, CONIC_PLANE_RGBA);
    conic_image_release(context, &image);
  }
  CHECK(hashes[0] == hashes[1] && hashes[0] == hashes[3] && hashes[0] != hashes[2]);
  conic_source_box(s.source, low, high);
  CHECK(low[0] == 0.0);
  end_stage(&s);
}

/* A splat with these axes, and a triangle with this normal. */
static conic_source *make_one(conic_context *context, float x, const float u[3], const float v[3],
                              const float normal[3]) {
  conic_splats splats;
  conic_triangles triangles;
  conic_source *source;
  CHECK_OK(conic_splats_allocate(context, 1, CONIC_SPLATS_TANGENTS, &splats));
  CHECK_OK(conic_triangles_allocate(context, 1, 3, CONIC_TRIANGLES_NORMALS, &triangles));
  for (int axis = 0; axis < 3; axis++) {
    splats.position[axis][0] = x;
    splats.tangent_u[axis][0] = u[axis];
    splats.tangent_v[axis][0] = v[axis];
    for (int k = 0; k < 3; k++) {
      triangles.position[axis][k] = x + (float)(k == axis);
      triangles.normal[axis][k] = normal[axis];
      triangles.corners[0][k] = (uint32_t)k;
    }
  }
  CHECK_OK(conic_source_of_drawing(context, &splats, &triangles, &source));
  return source;
}

static conic_drawing chosen_of(conic_source *source) {
  conic_camera camera;
  conic_render_options options;
  conic_render_options_init(&options);
  CHECK_OK(conic_source_frame(source, NULL, &camera));
  CHECK_OK(conic_source_choose(source, &camera, &options, NULL));
  return conic_source_chosen(source)->drawing;
}

static void check_axes_and_normals(conic_context *context) {
  const float u[3] = {2, 0, 0}, v[3] = {0, 1, 0}, diagonal[3] = {1, 1, 0};
  /* The same ellipse with its axes turned by 37° and mirrored. */
  const float other_u[3] = {1.6f, -0.6f, 0}, other_v[3] = {-1.2f, -0.8f, 0}, up[3] = {0, 1, 0};
  conic_source *source = make_one(context, 0, u, v, diagonal), *next = make_one(context, 1, other_u, other_v, up);
  conic_source_pose pose;
  conic_source_pose_init(&pose);
  pose.shapes[1] = next;
  pose.part = 0.25;
  CHECK_OK(conic_source_move(source, &pose, 1));
  conic_drawing drawing = chosen_of(source);
  const conic_splats *s = drawing.splats;
  CHECK_NEAR((double)s->position[0][0], 0.25, 1e-7);
  for (int axis = 0; axis < 3; axis++) { /* an ellipse on its way to itself */
    CHECK_NEAR((double)s->tangent_u[axis][0], (double)u[axis], 1e-6);
    CHECK_NEAR((double)s->tangent_v[axis][0], (double)v[axis], 1e-6);
  }
  CHECK_NEAR((double)drawing.triangles->position[0][0], 1.25, 1e-7);
  CHECK_NEAR((double)drawing.triangles->normal[0][0], 0.75, 1e-7);

  /* Twice as wide: axes go along, normals the other way. */
  conic_source_pose_init(&pose);
  pose.world_from_rest[0][0] = 2.0;
  pose.world_from_rest[0][3] = 7.0;
  CHECK_OK(conic_source_move(source, &pose, 1));
  drawing = chosen_of(source);
  CHECK_NEAR((double)drawing.splats->tangent_u[0][0], 4.0, 1e-6);
  CHECK_NEAR((double)drawing.splats->position[0][0], 7.0, 1e-6);
  CHECK_NEAR((double)drawing.triangles->position[0][0], 9.0, 1e-6);
  CHECK_NEAR((double)drawing.triangles->normal[1][0] / (double)drawing.triangles->normal[0][0], 2.0, 1e-6);

  /* What is no pose, and what does not fit. */
  conic_source *edge = make_edge(context);
  pose.world_from_rest[0][0] = -1.0;
  CHECK(conic_source_move(source, &pose, 1) == CONIC_ERROR_ARGUMENT);
  pose.world_from_rest[0][0] = NAN;
  CHECK(conic_source_move(source, &pose, 1) == CONIC_ERROR_ARGUMENT);
  conic_source_pose_init(&pose);
  pose.shapes[0] = edge;
  CHECK(conic_source_move(source, &pose, 1) == CONIC_ERROR_ARGUMENT);
  conic_source_pose too_many[2];
  conic_source_pose_init(&too_many[0]);
  conic_source_pose_init(&too_many[1]);
  CHECK(conic_source_move(source, too_many, 2) == CONIC_ERROR_ARGUMENT);
  conic_source_close(edge);
  conic_source_close(source);
  conic_source_close(next);
}

/* Shapes from files: the input's own is that of frame 0. */
static void check_shape_files(conic_context *context) {
  static const struct {
    double frame, x;
  } moments[] = {{-5, 3}, {-1, 3}, {-0.5, 1.5}, {0, 0}, {0.5, 2}, {1, 4}, {2, 6}, {3, 8}, {9, 8}};
  const float u[3] = {2, 0, 0}, v[3] = {0, 1, 0};
  const char *const names[] = {"a.ply", "b.ply", "c.ply"};
  const double places[] = {3, 4, 8};
  conic_motion *motion;
  conic_splats splats;
  conic_source *source;
  for (int i = 0; i < 3; i++) {
    char text[1000];
    snprintf(text, sizeof text,
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
             "property float tu_x\nproperty float tu_y\nproperty float tu_z\nproperty float tv_x\nproperty float tv_y\n"
             "property float tv_z\nend_header\n%g 0 0 2 0 0 0 1 0\n",
             places[i]);
    write_text(files_path(names[i]), text);
  }
  CHECK_OK(conic_splats_allocate(context, 1, CONIC_SPLATS_TANGENTS, &splats));
  for (int axis = 0; axis < 3; axis++) {
    splats.position[axis][0] = 0.0f;
    splats.tangent_u[axis][0] = u[axis];
    splats.tangent_v[axis][0] = v[axis];
  }
  CHECK_OK(conic_source_of_drawing(context, &splats, NULL, &source));
  CHECK_OK(read_key_text(context,
                         "[{\"input\": 0, \"frame\": 1, \"file\": \"b.ply\"}, {\"input\": 0, \"frame\": 3, \"file\": "
                         "\"c.ply\"}, {\"input\": 0, \"frame\": -1, \"file\": \"a.ply\"}]",
                         &motion));
  for (size_t i = 0; i < sizeof moments / sizeof *moments; i++) {
    CHECK_OK(conic_motion_apply(motion, source, moments[i].frame));
    CHECK_NEAR((double)chosen_of(source).splats->position[0][0], moments[i].x, 1e-6);
  }
  conic_source_move(source, NULL, 0);
  conic_motion_destroy(motion);
  conic_source_close(source);
}

static void check_wrong_keys(conic_context *context) {
  static const char *const wrong[] = {
      "[]",
      "{}",
      "[{\"frame\": 0}]",
      "[{\"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]",
      "[{\"frame\": 0, \"matrix\": [[1,0,0,0],[0,1,0,0]]}]",
      "[{\"frame\": 0, \"matrix\": [[1,0,0],[0,1,0],[0,0,1]]}]",
      "[{\"frame\": 0, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,2]]}]",
      "[{\"frame\": 0, \"matrix\": [[1,0,0,1e30],[0,1,0,0],[0,0,1,0]]}]",
      "[{\"frame\": 0, \"input\": 1, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]",
      "[{\"frame\": 0, \"input\": 0.5, \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]",
      "[{\"frame\": 0, \"file\": \"a.ply\"}]",
      "[{\"frame\": 0, \"input\": 0, \"file\": \"\"}]",
      "[{\"frame\": 0, \"input\": 0, \"file\": \"nothing.ply\"}]",
      "[{\"frame\": 0, \"turn\": 1}]",
      "[{\"frame\": 0, \"input\": 0, \"file\": \"a.ply\", \"matrix\": [[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]",
  };
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    conic_motion *motion;
    *files_message = 0;
    CHECK(read_key_text(context, wrong[i], &motion) == CONIC_ERROR_INPUT);
    CHECK(motion == NULL && *files_message);
  }
}

int main(void) {
  conic_context *context = files_context();
  check_moved_edge(context);
  check_turn(context);
  check_still(context);
  check_axes_and_normals(context);
  check_shape_files(context);
  check_wrong_keys(context);
  conic_context_destroy(context);
  return check_result();
}
