/* A plane of discs whose outlines just cover it (PAS Figs. 3 and 7) has no hole, however flat and far off the axis it
 * is seen; and outlines that touch in space touch on the screen. */
#include "raster/tiles/coverage.h"
#include "tests/support/fixture.h"

enum { WIDTH = 160, HEIGHT = 120 };

static const double pi = 3.14159265358979324;

/* A square of discs about the point at distance 1 that lies `off_axis` from the axis, its normal leaning by `tilt` from
 * the ray to that point, towards `roll`. */
typedef struct sheet {
  double focal_px, tilt, off_axis, roll, spacing;
  int n;          /* discs a side */
  double outline; /* the discs' radius, in spacings */
  double center[3], u[3], v[3], normal[3];
} sheet;

static void cross(const double a[3], const double b[3], double c[3]) {
  for (int i = 0; i < 3; i++)
    c[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
  return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static void set_axes(sheet *s) {
  const double side[3] = {cos(s->off_axis), 0.0, -sin(s->off_axis)};
  double up[3], leaning[3];
  s->center[0] = sin(s->off_axis);
  s->center[1] = 0.0;
  s->center[2] = cos(s->off_axis);
  cross(s->center, side, up);
  for (int i = 0; i < 3; i++) {
    leaning[i] = cos(s->roll) * side[i] + sin(s->roll) * up[i];
    s->normal[i] = cos(s->tilt) * s->center[i] + sin(s->tilt) * leaning[i];
    s->u[i] = cos(s->tilt) * leaning[i] - sin(s->tilt) * s->center[i]; /* towards the eye, the flatter the more */
  }
  cross(s->normal, s->u, s->v);
}

/* The discs, and a camera whose picture shows the nearer half of the sheet: at these tilts the rest is a line. */
static void set_sheet(fixture *f, sheet *s) {
  double sigma = s->outline * s->spacing / (double)f->options.kernel.cutoff, tu[3], tv[3];
  set_axes(s);
  fixture_splats(f, (size_t)s->n * (size_t)s->n);
  for (int i = 0; i < 3; i++) {
    tu[i] = sigma * s->u[i];
    tv[i] = sigma * s->v[i];
  }
  for (int k = 0; k < s->n * s->n; k++) {
    double along = (k % s->n + 0.5 - 0.5 * s->n) * s->spacing, across = (k / s->n + 0.5 - 0.5 * s->n) * s->spacing;
    double p[3];
    for (int i = 0; i < 3; i++)
      p[i] = s->center[i] + along * s->u[i] + across * s->v[i];
    fixture_set(f, (size_t)k, p, tu, tv, 0.9f, (float)(k % 2), 0.4f);
  }
  fixture_camera(f, WIDTH, HEIGHT, s->focal_px);
  double near_part = 0.4 * s->n * s->spacing, at[3];
  for (int i = 0; i < 3; i++)
    at[i] = s->center[i] + near_part * s->u[i];
  f->camera.cx -= s->focal_px * at[0] / at[2];
  f->camera.cy -= s->focal_px * at[1] / at[2];
  f->options.near_z = 1e-3;
}

/* Whether the pixel's centre sees the sheet's inside: the squares of the discs' own, but a hair of the rim. */
static int sees_sheet(const fixture *f, const sheet *s, int x, int y) {
  const double ray[3] = {(x + 0.5 - f->camera.cx) / s->focal_px, (y + 0.5 - f->camera.cy) / s->focal_px, 1.0};
  double depth = dot(s->normal, s->center) / dot(s->normal, ray), offset[3];
  for (int i = 0; i < 3; i++)
    offset[i] = depth * ray[i] - s->center[i];
  double limit = 0.5 * s->n * s->spacing * (1.0 - 1e-6);
  return depth > 2e-3 && fabs(dot(offset, s->u)) < limit && fabs(dot(offset, s->v)) < limit;
}

typedef struct tally {
  long n_inside, n_holes;
  int n_pictures, n_with_holes;
} tally;

static void look(fixture *f, const sheet *s, tally *t) {
  int n_holes = 0, n_inside = 0;
  fixture_render(f);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      if (!sees_sheet(f, s, x, y))
        continue;
      n_inside++;
      n_holes += !(fixture_pixel(f, CONIC_PLANE_WEIGHT, x, y)[0] > 0.0f);
    }
  t->n_inside += n_inside;
  t->n_holes += n_holes;
  t->n_pictures += n_inside > 0;
  t->n_with_holes += n_holes > 0;
}

static tally sweep(fixture *f) {
  static const double tilts_deg[] = {0, 45, 75, 85, 88, 89, 89.5, 89.8, 89.9}, off_axes_deg[] = {0, 20, 40, 60},
                      focals[] = {150, 600, 2400};
  static const int sides[] = {10, 30, 90};
  tally t = {0, 0, 0, 0};
  for (int i = 0; i < 9; i++)
    for (int k = 0; k < 36; k++) {
      sheet s = {.tilt = tilts_deg[i] * pi / 180.0, .off_axis = off_axes_deg[k % 4] * pi / 180.0};
      s.roll = 0.3 + 1.7 * k + i;
      s.focal_px = focals[k / 4 % 3];
      s.n = sides[k / 12];
      s.spacing = 1.8 / s.n;
      s.outline = sqrt(0.5); /* the circles about the squares */
      set_sheet(f, &s);
      look(f, &s, &t);
    }
  return t;
}

/* With and without a prefilter. Only affine, whose outlines are off, leaves holes: the search does find them. */
static void test_holes(fixture *f) {
  static const conic_method methods[] = {CONIC_METHOD_CONIC, CONIC_METHOD_RAY, CONIC_METHOD_AUTO, CONIC_METHOD_AFFINE};
  for (int k = 0; k < 16; k++) {
    f->options.method = methods[k % 4];
    f->options.prefilter = k / 4 % 2 ? 0.0f : 1.0f;
    f->options.kernel.cutoff = k / 8 ? 3.0f : 1.5f;
    tally t = sweep(f);
    printf("%s, prefilter %g, cutoff %g: %ld holes in %ld pixels inside, in %d of %d pictures\n",
           conic_method_name(methods[k % 4]), (double)f->options.prefilter, (double)f->options.kernel.cutoff, t.n_holes,
           t.n_inside, t.n_with_holes, t.n_pictures);
    CHECK(t.n_pictures > 300 && t.n_inside > 4000000);
    CHECK(f->options.method == CONIC_METHOD_AFFINE ? t.n_holes > 10000 : t.n_holes == 0);
  }
}

/* Puts splat i where `at`, `angle` along its outline, is a point of that. */
static void set_through(fixture *f, size_t i, const double at[3], uint64_t *state) {
  double cutoff = (double)f->options.kernel.cutoff, angle = 2.0 * pi * fixture_random(state), u[3], v[3], p[3];
  double size = 0.06 * pow(10.0, -1.5 * fixture_random(state)), n[3], side[3];
  for (int axis = 0; axis < 3; axis++) {
    n[axis] = fixture_random(state) - 0.5;
    side[axis] = fixture_random(state) - 0.5;
  }
  if (fixture_random(state) < 0.5) { /* nearly edge-on */
    double along = dot(n, at) / dot(at, at), leaning = 0.02 * (fixture_random(state) - 0.5);
    for (int axis = 0; axis < 3; axis++)
      n[axis] += (leaning - along) * at[axis];
  }
  cross(n, side, u);
  cross(n, u, v);
  double u_scale = size / sqrt(dot(u, u)), v_scale = size * (0.3 + 0.7 * fixture_random(state)) / sqrt(dot(v, v));
  for (int axis = 0; axis < 3; axis++) {
    u[axis] *= u_scale;
    v[axis] *= v_scale;
    p[axis] = at[axis] - cutoff * (cos(angle) * u[axis] + sin(angle) * v[axis]);
  }
  fixture_set(f, i, p, u, v, 1, 1, 1);
}

/* Whether splat i covers the pixel of the middle, with the camera moved by so many pixels. */
static int covers(fixture *f, size_t i, double x_px, double y_px) {
  conic_view view;
  conic_footprint footprint;
  conic_box box;
  conic_projected_surface surface;
  conic_ray ray;
  conic_fragment fragment;
  conic_chunk chunk = {.n_drawn = 0};
  conic_projected projected = {.footprints = &footprint, .boxes = &box, .surfaces = &surface, .rays = &ray};
  f->camera.cx += x_px;
  f->camera.cy += y_px;
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 1.0, &view));
  f->camera.cx -= x_px;
  f->camera.cy -= y_px;
  conic_project_one(&view, &f->splats, i, &projected, &chunk);
  return chunk.n_drawn == 1 && conic_fragment_at(&view, &projected, &footprint, WIDTH / 2, HEIGHT / 2, &fragment);
}

/* Two discs of any attitude with a point of their outlines in common. Without a prefilter the outlines on the screen
 * run through where that is seen, within a two-hundredth of a pixel; with one, both cover the place. */
static void test_touching(fixture *f) {
  static const conic_method methods[] = {CONIC_METHOD_CONIC, CONIC_METHOD_RAY, CONIC_METHOD_AUTO};
  const double step = 5e-3;
  uint64_t state = 31;
  fixture_splats(f, 2);
  f->options.kernel.cutoff = 1.5f;
  for (int k = 0; k < 6000; k++) {
    double z = 0.5 + fixture_random(&state);
    const double at[3] = {3.4 * z * (fixture_random(&state) - 0.5), 2.0 * z * (fixture_random(&state) - 0.5), z};
    fixture_camera(f, WIDTH, HEIGHT, 400.0);
    f->camera.cx = WIDTH / 2 + 0.5 - 400.0 * at[0] / z;
    f->camera.cy = HEIGHT / 2 + 0.5 - 400.0 * at[1] / z;
    f->options.method = methods[k % 3];
    for (size_t i = 0; i < 2; i++)
      set_through(f, i, at, &state);
    for (size_t i = 0; i < 2; i++) {
      f->options.prefilter = 0.0f;
      int n = 0;
      for (int k_place = 0; k_place < 48; k_place++) {
        double angle = pi * k_place / 8.0, away = step * (k_place < 16 ? 1.0 : k_place < 32 ? 0.5 : 0.1);
        n += covers(f, i, away * cos(angle), away * sin(angle));
      }
      CHECK(n < 48);
      f->options.prefilter = (float)(step * step / 2.25); /* what is thinner than a step may lie between */
      CHECK(n > 0 || covers(f, i, 0.0, 0.0));
      f->options.prefilter = 1.0f;
      CHECK(covers(f, i, 0.0, 0.0));
    }
  }
}

int main(void) {
  fixture f = fixture_open(1);
  f.options.isa = CONIC_ISA_AUTO;
  test_holes(&f);
  test_touching(&f);
  fixture_close(&f);
  return check_result();
}
