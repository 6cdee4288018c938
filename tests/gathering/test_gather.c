/* Gathered pictures of a scene that is known at every ray: what a pixel shows lies as near to its own ray, and as deep,
 * as conic/gather.h says; the sides of a cube are six pictures; nothing depends on threads. */
#include "conic/gather.h"
#include "core/base/vectors.h"
#include "core/image/camera_rays.h"
#include "tests/support/check.h"

enum { PLANES = 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z | 1u << CONIC_PLANE_ALBEDO | 1u << CONIC_PLANE_ID };

static const double pi = 3.14159265358979323846;

/* The room: a ball's inside. Pixels have as albedo where its wall is met, in the world, and as id, of which side. */
typedef struct room {
  double center[3], radius;
  int n_views;
  conic_gather_view last;
  double greatest_pixels_per_unit;
} room;

static void eye_of(const conic_camera *c, double eye[3]) {
  for (int axis = 0; axis < 3; axis++)
    eye[axis] =
        -(c->cam_from_world[0][axis] * c->cam_from_world[0][3] + c->cam_from_world[1][axis] * c->cam_from_world[1][3] +
          c->cam_from_world[2][axis] * c->cam_from_world[2][3]);
}

/* Along the ray from `from`, where the wall is. */
static double wall_at(const room *r, const double from[3], const double direction[3]) {
  double to[3];
  conic_subtract(from, r->center, to);
  double a = conic_dot(direction, direction), b = conic_dot(to, direction),
         c = conic_dot(to, to) - r->radius * r->radius;
  return (sqrt(b * b - a * c) - b) / a;
}

static void turn_to_world(const conic_camera *c, const double v[3], double world[3]) {
  for (int axis = 0; axis < 3; axis++)
    world[axis] =
        c->cam_from_world[0][axis] * v[0] + c->cam_from_world[1][axis] * v[1] + c->cam_from_world[2][axis] * v[2];
}

static conic_status draw_room(void *cookie, const conic_gather_view *view, conic_image *image) {
  room *r = cookie;
  const conic_camera *c = &view->camera;
  double eye[3], direction[3];
  eye_of(c, eye);
  CHECK(c->width == image->width && c->height == image->height && !c->kind && !c->lens);
  r->n_views++;
  r->last = *view;
  r->greatest_pixels_per_unit = fmax(r->greatest_pixels_per_unit, c->fx);
  for (int y = 0; y < c->height; y++)
    for (int x = 0; x < c->width; x++) {
      size_t i = (size_t)y * (size_t)c->width + (size_t)x;
      const double ray[3] = {(x + 0.5 - c->cx) / c->fx, (y + 0.5 - c->cy) / c->fy, 1.0};
      turn_to_world(c, ray, direction);
      double z = wall_at(r, eye, direction);
      for (int axis = 0; axis < 3; axis++)
        ((float *)image->planes[CONIC_PLANE_ALBEDO])[3 * i + (size_t)axis] = (float)(eye[axis] + z * direction[axis]);
      ((float *)image->planes[CONIC_PLANE_Z])[i] = (float)z;
      ((float *)image->planes[CONIC_PLANE_RGBA])[4 * i + 3] = 1.0f;
      ((uint32_t *)image->planes[CONIC_PLANE_ID])[i] = (uint32_t)r->n_views;
    }
  return CONIC_OK;
}

typedef struct camera_case {
  const char *name;
  conic_camera_kind kind;
  conic_lens lens;
  int width, height;
  double focal;
  double distortion[8];
  int most_views;
} camera_case;

static const camera_case cases[] = {
    {"panorama", CONIC_CAMERA_EQUIRECTANGULAR, CONIC_LENS_NONE, 120, 60, 120 / (2.0 * 3.14159265358979323846), {0}, 6},
    {"fisheye", CONIC_CAMERA_FISHEYE, CONIC_LENS_NONE, 96, 96, 30.0, {0}, 6},
    {"whole fisheye", CONIC_CAMERA_FISHEYE, CONIC_LENS_NONE, 90, 90, 14.0, {0}, 6},
    {"narrow fisheye", CONIC_CAMERA_FISHEYE, CONIC_LENS_RADIAL, 96, 64, 70.0, {0.03, -0.01, 2e-3, -3e-4}, 1},
    {"opencv", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_OPENCV, 96, 64, 60.0, {-0.2, 0.04, 2e-3, -1e-3}, 1},
    {"pincushion", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_RADIAL, 96, 64, 60.0, {0.2}, 1},
    {"fov", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_FOV, 96, 64, 40.0, {0.9}, 5},
    {"eucm", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_EUCM, 96, 64, 40.0, {0.5, 1.2}, 5},
    {"pinhole", CONIC_CAMERA_PERSPECTIVE, CONIC_LENS_NONE, 64, 48, 50.0, {0}, 1},
};
enum { N_CASES = sizeof cases / sizeof cases[0] };

/* Looks aslant, from amid the room. */
static conic_camera camera_of(const camera_case *c) {
  static const double rows[3][4] = {{0.36, 0.48, -0.8, 0.1}, {-0.8, 0.6, 0.0, -0.2}, {0.48, 0.64, 0.6, 0.3}};
  conic_camera camera = {.width = c->width,
                         .height = c->height,
                         .fx = c->focal,
                         .fy = c->focal,
                         .cx = 0.5 * c->width,
                         .cy = 0.5 * c->height,
                         .kind = (uint32_t)c->kind,
                         .lens = (uint32_t)c->lens};
  memcpy(camera.cam_from_world, rows, sizeof rows);
  memcpy(camera.distortion, c->distortion, sizeof c->distortion);
  return camera;
}

static conic_gather_options options_of(const conic_camera *camera, room *r) {
  conic_gather_options options;
  conic_gather_options_init(&options);
  options.camera = *camera;
  options.near_z = 0.01;
  options.cookie = r;
  options.draw = draw_room;
  return options;
}

/* Where the pixel's own ray, from the moved eye through what is in focus, meets the wall. */
static int truth_at(const conic_gather_options *o, const room *r, int x, int y, double there[3], double *depth) {
  conic_camera_rays rays;
  double origin[3], ray[3], eye[3], lens[3], world[3], moved[3];
  conic_camera_rays_init(&o->camera, &rays);
  if (!conic_camera_ray(&rays, x + 0.5, y + 0.5, origin, ray))
    return 0;
  double length = o->camera.kind == CONIC_CAMERA_PERSPECTIVE ? 1.0 : conic_length(ray);
  CHECK(o->camera.kind == CONIC_CAMERA_PERSPECTIVE ? ray[2] == 1.0 : fabs(length - 1.0) < 1e-12);
  eye_of(&o->camera, eye);
  for (int axis = 0; axis < 3 && o->focus > 0.0; axis++)
    ray[axis] = ray[axis] * o->focus - o->lens[axis];
  turn_to_world(&o->camera, ray, world);
  turn_to_world(&o->camera, o->lens, lens);
  for (int axis = 0; axis < 3; axis++)
    moved[axis] = eye[axis] + lens[axis];
  double t = wall_at(r, moved, world);
  for (int axis = 0; axis < 3; axis++)
    there[axis] = moved[axis] + t * world[axis];
  *depth = t * (o->camera.kind == CONIC_CAMERA_PERSPECTIVE ? ray[2] : conic_length(ray));
  return 1;
}

/* All pixels: of one sample, half a view's pixel off at most; the depth is exactly that of the place that is shown. */
static void check_pixels(const camera_case *c, const conic_gather_options *o, const room *r, const conic_image *image) {
  double greatest = 0.0, allowed = sqrt(0.5) / r->greatest_pixels_per_unit;
  int n_seen = 0;
  for (int y = 0; y < c->height; y++)
    for (int x = 0; x < c->width; x++) {
      size_t i = (size_t)y * (size_t)c->width + (size_t)x;
      double there[3], depth, shown[3], eye[3], lens[3], to_there[3], to_shown[3], across[3];
      const float *albedo = (const float *)image->planes[CONIC_PLANE_ALBEDO] + 3 * i;
      const float *rgba = (const float *)image->planes[CONIC_PLANE_RGBA] + 4 * i;
      double z = (double)((const float *)image->planes[CONIC_PLANE_Z])[i];
      uint32_t id = ((const uint32_t *)image->planes[CONIC_PLANE_ID])[i];
      if (!truth_at(o, r, x, y, there, &depth)) {
        CHECK(z == 0.0 && id == CONIC_NO_ID && rgba[3] == 0.25f && rgba[0] == 0.5f);
        continue;
      }
      n_seen++;
      CHECK(rgba[3] == 1.0f && id >= 1 && id <= (uint32_t)r->n_views);
      eye_of(&o->camera, eye);
      turn_to_world(&o->camera, o->lens, lens);
      for (int axis = 0; axis < 3; axis++) {
        shown[axis] = (double)albedo[axis];
        to_there[axis] = there[axis] - eye[axis] - lens[axis];
        to_shown[axis] = shown[axis] - eye[axis] - lens[axis];
      }
      conic_cross(to_there, to_shown, across);
      double angle = conic_length(across) / (conic_length(to_there) * conic_length(to_shown));
      greatest = fmax(greatest, angle / allowed);
      const double *axis_z = o->camera.cam_from_world[2];
      double shown_depth = o->camera.kind == CONIC_CAMERA_PERSPECTIVE
                               ? conic_dot((const double[3]){axis_z[0], axis_z[1], axis_z[2]}, to_shown)
                               : conic_length(to_shown);
      CHECK(fabs(z - shown_depth) < 1e-6 * shown_depth + 2e-7 * conic_length(to_shown));
    }
  if (greatest > 1.0001 || !n_seen)
    printf("%s: %d pixels are up to %.4f of what is allowed off\n", c->name, n_seen, greatest);
  CHECK(greatest <= 1.0001 && greatest > 0.5 && n_seen > 0);
}

static void test_places(conic_context *context) {
  for (int i = 0; i < N_CASES; i++)
    for (int is_moved = 0; is_moved < 2; is_moved++) {
      const conic_camera camera = camera_of(&cases[i]);
      room r = {.center = {0.1, -0.2, 0.05}, .radius = 3.0};
      conic_gather_options options = options_of(&camera, &r);
      conic_image image;
      options.empty[0] = 0.5f;
      options.empty[3] = 0.25f;
      options.shift[0] = 0.37;
      options.shift[1] = 0.91;
      if (is_moved) {
        const double lens[3] = {0.07, -0.04, cases[i].kind == CONIC_CAMERA_EQUIRECTANGULAR ? 0.03 : 0.0};
        memcpy(options.lens, lens, sizeof lens);
        options.focus = 2.0;
      }
      CHECK_OK(conic_image_allocate(context, camera.width, camera.height, PLANES, &image));
      CHECK_OK(conic_gather(context, &options, &image));
      CHECK(r.n_views >= 1 && r.n_views <= cases[i].most_views);
      check_pixels(&cases[i], &options, &r, &image);
      conic_image_release(context, &image);
    }
}

/* A view's pixel is no larger than the picture's, divided by the fineness: in the middle of a fisheye and of a
 * panorama, a pixel is 1/f; at a whole fisheye's rim, where it is as thin as a line, its diagonal is; and the
 * pincushion's corners are finer. */
static void test_fineness(conic_context *context) {
  for (int i = 0; i < 6; i++) {
    const conic_camera camera = camera_of(&cases[i]);
    room r = {.radius = 3.0};
    conic_gather_options options = options_of(&camera, &r);
    conic_image image;
    options.fineness = 2.0;
    options.samples = 3;
    CHECK_OK(conic_image_allocate(context, camera.width, camera.height, PLANES, &image));
    CHECK_OK(conic_gather(context, &options, &image));
    double part = r.greatest_pixels_per_unit / (2.0 * 3.0 * camera.fx);
    CHECK(r.last.samples == 1);
    CHECK(cases[i].lens ? part > 0.9 && part < 1.7 : part > 0.999 && part < (i == 2 ? 1.45 : 1.02));
    conic_image_release(context, &image);
  }
}

static uint64_t hash_of_threads(const camera_case *c, int threads, int samples) {
  conic_context *context = check_context(threads);
  const conic_camera camera = camera_of(c);
  room r = {.radius = 3.0};
  conic_gather_options options = options_of(&camera, &r);
  conic_image image;
  options.samples = samples;
  CHECK_OK(conic_image_allocate(context, camera.width, camera.height, PLANES, &image));
  CHECK_OK(conic_gather(context, &options, &image));
  uint64_t hash = 0;
  for (int plane = 0; plane < CONIC_N_PLANES; plane++)
    hash = hash * 31 + conic_image_hash(&image, (conic_plane)plane);
  conic_image_release(context, &image);
  conic_context_destroy(context);
  return hash;
}

static void test_threads(void) {
  for (int i = 0; i < N_CASES; i++)
    CHECK(hash_of_threads(&cases[i], 1, 2) == hash_of_threads(&cases[i], 5, 2));
}

/* In bands, too, every pixel is there, and is the mean of its samples. */
static void test_bands(conic_context *context) {
  camera_case c = cases[0];
  c.width = 1024;
  c.height = 512;
  c.focal = c.width / (2.0 * pi);
  const conic_camera camera = camera_of(&c);
  room r = {.radius = 3.0};
  conic_gather_options options = options_of(&camera, &r);
  conic_image image;
  options.samples = 3;
  options.fineness = 1.0;
  CHECK_OK(conic_image_allocate(context, c.width, c.height, PLANES, &image));
  CHECK_OK(conic_gather(context, &options, &image));
  CHECK(r.n_views > 6);
  for (int y = 0; y < c.height; y += 7)
    for (int x = 0; x < c.width; x += 3) {
      double there[3], depth, apart = 0.0;
      size_t i = (size_t)y * (size_t)c.width + (size_t)x;
      CHECK(truth_at(&options, &r, x, y, there, &depth));
      for (int axis = 0; axis < 3; axis++)
        apart =
            fmax(apart, fabs((double)((float *)image.planes[CONIC_PLANE_ALBEDO])[3 * i + (size_t)axis] - there[axis]));
      CHECK(apart < 3.5 / camera.fx);
    }
  conic_image_release(context, &image);
}

/* --- whole views --- */

static void test_cube(conic_context *context) {
  enum { EDGE = 20 };
  /* right, down and forward of OpenEXR's sides, by its latitude and longitude map's axes: x is left, y up, z forward */
  static const double sides[6][3][3] = {{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},   {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
                                        {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                        {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},    {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}}};
  const camera_case c = {"cube", CONIC_CAMERA_CUBE, CONIC_LENS_NONE, EDGE, 6 * EDGE, EDGE / 2, {0}, 6};
  conic_camera camera = camera_of(&c);
  camera.cy = EDGE / 2;
  room r = {.center = {0.1, -0.2, 0.05}, .radius = 3.0}, alone = r;
  conic_gather_options options = options_of(&camera, &r);
  conic_image image, side;
  CHECK_OK(conic_image_allocate(context, EDGE, 6 * EDGE, PLANES, &image));
  CHECK_OK(conic_image_allocate(context, EDGE, EDGE, PLANES, &side));
  options.samples = 4;
  CHECK_OK(conic_gather(context, &options, &image));
  CHECK(r.n_views == 6 && r.last.samples == 4 && r.last.near_z == 0.01);
  for (int i = 0; i < 6; i++) {
    conic_gather_view view = {
        .camera = {.width = EDGE, .height = EDGE, .fx = EDGE / 2, .fy = EDGE / 2, .cx = EDGE / 2, .cy = EDGE / 2}};
    for (int row = 0; row < 3; row++)
      for (int column = 0; column < 4; column++)
        for (int k = 0; k < 3; k++)
          view.camera.cam_from_world[row][column] += sides[i][row][k] * camera.cam_from_world[k][column];
    CHECK_OK(draw_room(&alone, &view, &side));
    CHECK(memcmp(side.planes[CONIC_PLANE_Z], (float *)image.planes[CONIC_PLANE_Z] + i * EDGE * EDGE,
                 EDGE * EDGE * sizeof(float)) == 0);
    CHECK(memcmp(side.planes[CONIC_PLANE_ALBEDO], (float *)image.planes[CONIC_PLANE_ALBEDO] + 3 * i * EDGE * EDGE,
                 3 * EDGE * EDGE * sizeof(float)) == 0);
  }
  for (int y = 0; y < 6 * EDGE; y++) /* the camera's own rays go there */
    for (int x = 0; x < EDGE; x++) {
      conic_camera_rays rays;
      double origin[3], ray[3], world[3], eye[3];
      conic_camera_rays_init(&camera, &rays);
      CHECK(conic_camera_ray(&rays, x + 0.5, y + 0.5, origin, ray));
      turn_to_world(&camera, ray, world);
      eye_of(&camera, eye);
      double z = wall_at(&r, eye, world);
      CHECK(fabs(z - (double)((float *)image.planes[CONIC_PLANE_Z])[y * EDGE + x]) < 1e-6);
    }
  conic_image_release(context, &image);
  conic_image_release(context, &side);
}

/* What is farther off than so many pixels at some depth of the box, where the picture's own parallel ray, tilted about
 * the focus, and a view's are compared. */
typedef struct parallel_check {
  conic_gather_options options;
  double depths[2], greatest_px;
  double sum_px; /* by what pixel (300, 200) is off to the right at the farther depth, over all pictures */
  int n_views, left, top;
} parallel_check;

static conic_status check_far_view(void *cookie, const conic_gather_view *view, conic_image *image) {
  parallel_check *p = cookie;
  const conic_gather_options *o = &p->options;
  const conic_camera *c = &view->camera;
  double eye[3], at_camera[3];
  eye_of(c, eye);
  for (int row = 0; row < 3; row++)
    at_camera[row] = conic_dot((const double[3]){o->camera.cam_from_world[row][0], o->camera.cam_from_world[row][1],
                                                 o->camera.cam_from_world[row][2]},
                               eye) +
                     o->camera.cam_from_world[row][3];
  for (int corner = 0; corner < 8; corner++) {
    double x = corner & 1 ? c->width - 0.5 : 0.5, y = corner & 2 ? c->height - 0.5 : 0.5, z = p->depths[corner >> 2];
    double along = z - at_camera[2], tilt = o->focus > 0.0 ? 1.0 - z / o->focus : 0.0;
    const double seen[2] = {at_camera[0] + along * (x - c->cx) / c->fx, at_camera[1] + along * (y - c->cy) / c->fy};
    const double own[2] = {(p->left + x - o->camera.cx) / o->camera.fx + o->lens[0] * tilt,
                           (p->top + y - o->camera.cy) / o->camera.fy + o->lens[1] * tilt};
    CHECK(along > view->near_z && view->near_z > 0.0);
    p->greatest_px = fmax(p->greatest_px, hypot(seen[0] - own[0], seen[1] - own[1]) * o->camera.fx);
  }
  if (p->left <= 300 && 300 < p->left + c->width && p->top <= 200 && 200 < p->top + c->height)
    p->sum_px += (at_camera[0] + (p->depths[1] - at_camera[2]) * (300.5 - p->left - c->cx) / c->fx) * o->camera.fx -
                 (300.5 - o->camera.cx);
  for (int i = 0; i < c->width * c->height; i++)
    ((float *)image->planes[CONIC_PLANE_Z])[i] = (float)(p->depths[1] - at_camera[2]);
  p->n_views++;
  p->left += c->width;
  if (p->left == o->camera.width) {
    p->left = 0;
    p->top += c->height;
  }
  return CONIC_OK;
}

static void test_parallel(conic_context *context) {
  const camera_case c = {"parallel", CONIC_CAMERA_ORTHOGRAPHIC, CONIC_LENS_NONE, 700, 520, 250.0, {0}, 4};
  for (int is_moved = 0; is_moved < 2; is_moved++) {
    parallel_check p = {.depths = {3.0, 5.0}};
    conic_image image;
    conic_gather_options_init(&p.options);
    p.options.camera = camera_of(&c);
    memset(p.options.camera.cam_from_world, 0, sizeof p.options.camera.cam_from_world);
    for (int i = 0; i < 3; i++)
      p.options.camera.cam_from_world[i][i] = 1.0;
    p.options.camera.cam_from_world[2][3] = 4.0;
    p.options.near_z = 0.01;
    for (int axis = 0; axis < 3; axis++) {
      p.options.minimum[axis] = -1.0;
      p.options.maximum[axis] = 1.0;
    }
    p.options.cookie = &p;
    p.options.draw = check_far_view;
    if (is_moved) {
      p.options.lens[0] = 0.2;
      p.options.lens[1] = -0.1;
      p.options.focus = 4.5;
    }
    CHECK_OK(conic_image_allocate(context, c.width, c.height, 1u << CONIC_PLANE_Z, &image));
    CHECK_OK(conic_gather(context, &p.options, &image));
    CHECK(p.n_views == 9);
    if (!(p.greatest_px < 0.09))
      printf("parallel: %g pixels off\n", p.greatest_px);
    CHECK(p.greatest_px < 0.09 && p.greatest_px > 0.05); /* half a view's diagonal, by 2048 */
    for (size_t i = 0; i < (size_t)c.width * (size_t)c.height; i++)
      CHECK(fabs((double)((float *)image.planes[CONIC_PLANE_Z])[i] - 5.0) < 2e-4);
    p.sum_px = p.greatest_px = 0.0;
    p.options.edge = 512;
    for (int i = 0; i < 16 && !is_moved; i++) { /* on the mean over all places of the views, nothing is off */
      p.left = p.top = 0;
      p.options.shift[0] = (i + 0.5) / 16;
      p.options.shift[1] = (i * 5 % 16 + 0.5) / 16;
      CHECK_OK(conic_gather(context, &p.options, &image));
    }
    CHECK(is_moved || (p.greatest_px > 0.15 && p.greatest_px < 0.18 && fabs(p.sum_px) / 16 < 1e-2));
    conic_image_release(context, &image);
  }
}

/* --- through the renderer --- */

/* Splats all over a ball about the eye. */
static conic_splats ball_of_splats(conic_context *context, double radius) {
  enum { N = 4000 };
  conic_splats splats;
  CHECK_OK(conic_splats_allocate(context, N, CONIC_SPLATS_TANGENTS, &splats));
  for (int i = 0; i < N; i++) {
    double z = 1.0 - (2.0 * i + 1.0) / N, angle = i * 2.399963229728653, flat = sqrt(1.0 - z * z);
    const double n[3] = {flat * cos(angle), flat * sin(angle), z};
    double u[3] = {-n[1], n[0], 0.0}, v[3];
    CHECK(conic_normalize(u));
    conic_cross(n, u, v);
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = (float)(radius * n[axis]);
      splats.tangent_u[axis][i] = (float)(0.06 * radius * u[axis]);
      splats.tangent_v[axis][i] = (float)(0.06 * radius * v[axis]);
    }
  }
  return splats;
}

typedef struct ball {
  conic_context *context;
  conic_renderer *renderer;
  conic_splats splats;
  conic_render_options render;
} ball;

static conic_status draw_ball(void *cookie, const conic_gather_view *view, conic_image *image) {
  const ball *b = cookie;
  return conic_render_samples(b->context, b->renderer, &b->splats, &view->camera, &b->render, view->samples, image,
                              NULL);
}

/* No pixel is missed at seams, and the distance is the ball's but for the splats' flatness. */
static void test_seams(conic_context *context) {
  ball b = {.context = context};
  conic_image image;
  CHECK_OK(conic_renderer_create(context, &b.renderer));
  conic_render_options_init(&b.render);
  b.render.near_z = 0.01;
  b.splats = ball_of_splats(context, 2.0);
  for (int i = 0; i < 2; i++) {
    conic_camera camera = camera_of(&cases[i]);
    for (int row = 0; row < 3; row++)
      camera.cam_from_world[row][3] = 0.0;
    conic_gather_options options = options_of(&camera, NULL);
    options.samples = 2;
    options.cookie = &b;
    options.draw = draw_ball;
    CHECK_OK(conic_image_allocate(context, camera.width, camera.height, PLANES, &image));
    CHECK_OK(conic_gather(context, &options, &image));
    for (size_t k = 0; k < (size_t)camera.width * (size_t)camera.height; k++) {
      CHECK(((float *)image.planes[CONIC_PLANE_RGBA])[4 * k + 3] == 1.0f);
      CHECK(fabs((double)((float *)image.planes[CONIC_PLANE_Z])[k] - 2.0) < 0.02);
      CHECK(((uint32_t *)image.planes[CONIC_PLANE_ID])[k] < 4000);
    }
    conic_image_release(context, &image);
  }
  conic_splats_release(context, &b.splats);
  conic_renderer_destroy(b.renderer);
}

/* --- the lens of all directions, and what is refused --- */

static void test_ball_lens(conic_context *context) {
  const camera_case c = cases[0];
  const conic_camera camera = camera_of(&c);
  const conic_aperture aperture = {.diameter = 2.0, .focus = 4.0}, flat = {2.0, 4.0, 6, 0, {0}};
  static const double looks[4][3] = {{1, 0, 0}, {0, 0, 1}, {0, 0.6, 0.8}, {0.6, 0, -0.8}};
  double squares[4] = {0.0}, fourths[4] = {0.0};
  conic_sample sample;
  enum { N = 4096 };
  for (uint64_t i = 0; i < N; i++) {
    CHECK_OK(conic_sample_place(context, &camera, &aperture, i, &sample));
    const double point[3] = {sample.lens[0], sample.lens[1], sample.lens_forward};
    CHECK(conic_length(point) <= 1.0 + 1e-12);
    CHECK(memcmp(sample.camera.cam_from_world, camera.cam_from_world, sizeof camera.cam_from_world) == 0);
    for (int k = 0; k < 4; k++) {
      double along = conic_dot(looks[k], point);
      squares[k] += along * along / N;
      fourths[k] += along * along * along * along / N;
    }
  }
  for (int k = 0; k < 4; k++) /* of a disc: 1/4 and 1/8 */
    CHECK(fabs(squares[k] - 0.25) < 2e-3 && fabs(fourths[k] - 0.125) < 2e-3);
  CHECK(conic_sample_place(context, &camera, &flat, 0, &sample) == CONIC_ERROR_ARGUMENT);
  const conic_camera distorting = camera_of(&cases[4]);
  CHECK_OK(conic_sample_place(context, &distorting, &flat, 1, &sample));
  CHECK(sample.lens_forward == 0.0 && sample.lens[0] != 0.0 && sample.camera.lens == CONIC_LENS_OPENCV);
}

static void test_refusals(conic_context *context) {
  conic_camera camera = camera_of(&cases[0]);
  room r = {.radius = 3.0};
  conic_image image;
  CHECK_OK(conic_image_allocate(context, camera.width, camera.height, PLANES, &image));
  conic_gather_options options = options_of(&camera, &r), good = options;
  options.fineness = 0.5;
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  options = good;
  options.samples = 17;
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  options = good;
  options.lens[0] = 0.1; /* without a focus */
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  options = good;
  options.draw = NULL;
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  options = good;
  options.camera.kind = CONIC_CAMERA_CUBE; /* of no such size */
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  options = good;
  options.camera.width--;
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  options = good;
  options.edge = 16;
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  options = good;
  options.shift[1] = 1.5;
  CHECK(conic_gather(context, &options, &image) == CONIC_ERROR_ARGUMENT);
  CHECK(r.n_views == 0);
  conic_image_release(context, &image);
}

int main(void) {
  conic_context *context = check_context(2);
  test_places(context);
  test_fineness(context);
  test_threads();
  test_bands(context);
  test_cube(context);
  test_parallel(context);
  test_seams(context);
  test_ball_lens(context);
  conic_context_destroy(context);
  context = check_context(1);
  test_refusals(context);
  conic_context_destroy(context);
  return check_result();
}
