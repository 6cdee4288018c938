/* No splat or patch made from a mesh reaches more than a pixel beyond the mesh's own silhouette, as the prefilter
 * widens it, nor leaves a hole in it: pictures from some of 26 sides against the triangles'. Files named after the
 * source folder are measured, and nothing is asked of them. */
#include "tests/support/files.h"
#include "tests/support/fixture.h"

enum {
  SIZE = 1024,
  FINE = 2 /* samples of the mesh a pixel, across */,
  REACH = 80 /* fine samples that are searched */
};

/* How far the centre of a pixel that may be covered is from a covered sample: the prefilter, and half of a diagonal
 * between samples. */
static const double allowed_px = 1.5 + 0.36;

typedef struct silhouette {
  double most_px; /* the farthest beyond */
  size_t n_beyond, n_holes, n_covered, n_splats;
} silhouette;

typedef enum way { POINTS, CREASES, PATCHES, ROUND, SURFELS, HYBRID, N_WAYS } way;

/* Of surfels alone, which a picture has to ask for, nothing is promised but their error. */
enum { ASKED = 1 << POINTS | 1 << CREASES | 1 << PATCHES | 1 << ROUND | 1 << HYBRID };

/* Patches that round a mesh reach beyond its triangles as far as it is curved. */
static const double round_px = 2.0;

static const char *const way_names[N_WAYS] = {"points", "creases", "patches", "round", "surfels", "hybrid"};

static conic_source *open_way(fixture *f, const char *path, way which) {
  static const conic_representation as[N_WAYS] = {CONIC_AS_POINTS,  CONIC_AS_POINTS, CONIC_AS_PATCHES,
                                                  CONIC_AS_PATCHES, CONIC_AS_HYBRID, CONIC_AS_HYBRID};
  conic_source_options opening;
  conic_source *source = NULL;
  conic_source_options_init(&opening);
  opening.as = as[which];
  opening.crease_deg = which == ROUND ? 30.0 : 0.0;
  if (which != CREASES) {
    CHECK_OK(conic_source_open(f->context, &path, 1, &opening, &source));
    return source;
  }
  conic_model model;
  conic_estimate_options estimate;
  conic_estimate_options_init(&estimate);
  estimate.feature_angle_deg = 30.0; /* which says that splats stay at the mesh, too */
  CHECK_OK(conic_model_read(f->context, path, NULL, &model));
  CHECK_OK(conic_model_to_splats(f->context, &estimate, &model, NULL));
  CHECK_OK(conic_source_of_drawing(f->context, &model.points, NULL, &source));
  conic_model_release(f->context, &model);
  return source;
}

static int is_there(const uint32_t *ids, int width, int x, int y) {
  return x >= 0 && y >= 0 && x < width && y < width && ids[(size_t)y * (size_t)width + (size_t)x] != CONIC_NO_ID;
}

/* Of every sample of the mesh's picture, how many samples the next covered one above or below it is away. */
static uint16_t *measure_columns(const uint32_t *mesh) {
  int width = FINE * SIZE;
  uint16_t *away = malloc((size_t)width * (size_t)width * sizeof *away);
  if (!away)
    exit(1);
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < width; k++)
      for (int x = 0; x < width; x++) {
        int y = pass ? width - 1 - k : k, before = pass ? y + 1 : y - 1;
        uint16_t *at = &away[(size_t)y * (size_t)width + (size_t)x];
        int from_there = k > 0 ? away[(size_t)before * (size_t)width + (size_t)x] + 1 : width;
        int here = is_there(mesh, width, x, y) ? 0 : from_there;
        *at = (uint16_t)(pass && *at < here ? *at : here);
      }
  return away;
}

/* How far the centre of pixel (x, y), which is sample (FINE·x, FINE·y), is from the nearest covered sample: pixels. */
static double distance_from(const uint16_t *away, int x, int y) {
  int width = FINE * SIZE, best2 = 2 * width * width;
  for (int dx = 0; dx * dx < best2 && dx < width; dx++)
    for (int sign = -1; sign <= 1; sign += 2) {
      int at = FINE * x + sign * dx;
      if (at < 0 || at >= width)
        continue;
      int dy = away[(size_t)(FINE * y) * (size_t)width + (size_t)at], distance2 = dx * dx + dy * dy;
      best2 = distance2 < best2 ? distance2 : best2;
    }
  return sqrt(best2) / FINE;
}

/* Whether the mesh is all around pixel (x, y). */
static int is_within(const uint32_t *mesh, int x, int y) {
  for (int j = FINE * y - FINE; j < FINE * y + 2 * FINE; j++)
    for (int i = FINE * x - FINE; i < FINE * x + 2 * FINE; i++)
      if (!is_there(mesh, FINE * SIZE, i, j))
        return 0;
  return 1;
}

static void judge(const uint32_t *mesh, const uint16_t *away, const uint32_t *splats, silhouette *s) {
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++) {
      if (!is_there(splats, SIZE, x, y)) {
        s->n_holes += (size_t)is_within(mesh, x, y);
        continue;
      }
      s->n_covered++;
      if (is_there(mesh, FINE * SIZE, FINE * x, FINE * y))
        continue;
      double beyond = distance_from(away, x, y) - allowed_px;
      s->most_px = beyond > s->most_px ? beyond : s->most_px;
      s->n_beyond += beyond > 1.0;
    }
}

static void draw(fixture *f, conic_source *source, const conic_camera *camera, int only_kind) {
  conic_source_view view;
  conic_source_view_init(&view);
  view.only_kind = only_kind;
  conic_image_release(f->context, &f->image);
  CHECK_OK(conic_image_allocate(f->context, camera->width, camera->height, 1u << CONIC_PLANE_ID, &f->image));
  CHECK_OK(conic_source_draw(source, f->renderer, camera, &f->options, &view, &f->image, &f->statistics));
}

static void compare_side(fixture *f, conic_source *mesh, conic_source *const *drawn, int i_side, silhouette *found) {
  static const double elevations[5] = {-90, -45, 0, 45, 90};
  conic_framing framing;
  conic_camera camera, fine;
  conic_framing_init(&framing);
  framing.width = framing.height = SIZE;
  framing.azimuth_deg = i_side == 0 || i_side == 25 ? 0.0 : (i_side - 1) % 8 * 45.0 + 5.0;
  framing.elevation_deg = elevations[i_side == 0 ? 0 : i_side == 25 ? 4 : 1 + (i_side - 1) / 8];
  CHECK_OK(conic_source_frame(mesh, &framing, &camera));
  fine = camera;
  fine.width = fine.height = FINE * SIZE;
  fine.fx *= FINE;
  fine.fy *= FINE;
  fine.cx = FINE * camera.cx - 0.5 * (FINE - 1); /* a pixel's centre is that of a sample */
  fine.cy = FINE * camera.cy - 0.5 * (FINE - 1);
  draw(f, mesh, &fine, -1);
  conic_image triangles = f->image;
  memset(&f->image, 0, sizeof f->image);
  uint16_t *away = measure_columns(triangles.planes[CONIC_PLANE_ID]);
  for (int which = 0; which < N_WAYS; which++)
    if (drawn[which]) {
      draw(f, drawn[which], &camera, which == SURFELS ? CONIC_HYBRID_SURFELS : -1);
      found[which].n_splats = f->statistics.splats_in;
      judge(triangles.planes[CONIC_PLANE_ID], away, f->image.planes[CONIC_PLANE_ID], &found[which]);
    }
  free(away);
  conic_image_release(f->context, &triangles);
}

/* The ways of `ways` (bits), from each side of `step`. */
static void examine(fixture *f, const char *path, const char *name, unsigned ways, int step, int is_asked) {
  conic_source_options opening;
  conic_source *mesh, *drawn[N_WAYS] = {NULL};
  silhouette found[N_WAYS];
  memset(found, 0, sizeof found);
  conic_source_options_init(&opening);
  opening.as = CONIC_AS_MESH;
  CHECK_OK(conic_source_open(f->context, &path, 1, &opening, &mesh));
  for (int which = 0; which < N_WAYS; which++)
    if (ways & 1u << which)
      drawn[which] = open_way(f, path, (way)which);
  for (int i_side = 0; i_side < 26; i_side += step)
    compare_side(f, mesh, drawn, i_side, found);
  for (int which = 0; which < N_WAYS; which++)
    if (drawn[which]) {
      const silhouette *s = &found[which];
      fprintf(stderr, "%-24s %-8s %8zu splats: %7.2f px beyond at most, %7zu pixels more than one; %zu holes of %zu\n",
              name, way_names[which], s->n_splats, s->most_px, s->n_beyond, s->n_holes, s->n_covered);
      int stays = which == ROUND ? s->most_px < round_px : s->n_beyond == 0;
      CHECK(!is_asked || (s->n_covered > 100000 && stays && s->n_holes <= s->n_covered / 100000));
      conic_source_close(drawn[which]);
    }
  conic_source_close(mesh);
}

/* --- meshes --- */

static void knot_at(double along, double around, double tube, double p[3]) {
  double c = cos(3.0 * along), r = 2.0 + c, middle[3] = {r * cos(2.0 * along), r * sin(2.0 * along), -sin(3.0 * along)};
  double out[3] = {cos(2.0 * along) * c, sin(2.0 * along) * c, -sin(3.0 * along)};
  double side[3] = {-sin(2.0 * along) * 0.5, cos(2.0 * along) * 0.5, 0.866};
  for (int axis = 0; axis < 3; axis++)
    p[axis] = middle[axis] + tube * (cos(around) * out[axis] + sin(around) * side[axis]);
}

/* A grid that is closed both ways. */
static void write_grid(FILE *file, int n, int m) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) {
      int a = i * m + j, b = (i + 1) % n * m + j, c = (i + 1) % n * m + (j + 1) % m, d = i * m + (j + 1) % m;
      fprintf(file, "f %d %d %d\nf %d %d %d\n", a + 1, b + 1, c + 1, a + 1, c + 1, d + 1);
    }
}

static void write_knot(FILE *file, int n, int m) {
  for (int i = 0; i < n * m; i++) {
    double p[3];
    knot_at(6.283185307179586 * (i / m) / n, 6.283185307179586 * (i % m) / m, 0.5, p);
    fprintf(file, "v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
  }
  write_grid(file, n, m);
}

/* Rings of m vertices at heights and radii, closed by a tip at both ends. */
static void write_lathe(FILE *file, const double (*profile)[2], int n, int m) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++)
      fprintf(file, "v %.9g %.9g %.9g\n", profile[i][0] * cos(6.283185307179586 * j / m), profile[i][1],
              -profile[i][0] * sin(6.283185307179586 * j / m));
  fprintf(file, "v 0 %.9g 0\nv 0 %.9g 0\n", profile[0][1], profile[n - 1][1]);
  for (int j = 0; j < m; j++) {
    for (int i = 0; i + 1 < n; i++) {
      int a = i * m + j, b = i * m + (j + 1) % m, c = b + m, d = a + m;
      fprintf(file, "f %d %d %d\nf %d %d %d\n", a + 1, b + 1, c + 1, a + 1, c + 1, d + 1);
    }
    fprintf(file, "f %d %d %d\n", n * m + 1, (j + 1) % m + 1, j + 1);
    fprintf(file, "f %d %d %d\n", n * m + 2, (n - 1) * m + j + 1, (n - 1) * m + (j + 1) % m + 1);
  }
}

static void write_ball(FILE *file, int n, int m) {
  double profile[64][2];
  for (int i = 0; i < n; i++) {
    profile[i][0] = sin(3.14159265358979 * (i + 1) / (n + 1));
    profile[i][1] = -cos(3.14159265358979 * (i + 1) / (n + 1));
  }
  write_lathe(file, (const double(*)[2])profile, n, m);
}

/* A pawn: a plate with a sharp rim, a thin neck, and slivers as faces. */
static void write_pawn(FILE *file, int m) {
  static const double profile[7][2] = {{1, -1},     {1, -0.8},   {0.25, -0.75}, {0.05, 0.4},
                                       {0.5, 0.45}, {0.45, 0.7}, {0.1, 1}};
  write_lathe(file, profile, 7, m);
}

static const char *const made_names[] = {"knot.obj", "fine_knot.obj", "ball.obj", "pawn.obj"};

static const char *make_mesh(int i) {
  const char *path = files_path(made_names[i]);
  FILE *file = fopen(path, "w");
  if (!file)
    exit(1);
  if (i < 2)
    write_knot(file, i ? 240 : 30, i ? 24 : 5);
  else if (i == 2)
    write_ball(file, 6, 8);
  else
    write_pawn(file, 48);
  fclose(file);
  return path;
}

int main(int argc, char **argv) {
  enum { MADE = sizeof made_names / sizeof *made_names };
  static const char *const data[] = {"fandisk.obj", "bunny.obj"};
  conic_context *context = files_context();
  fixture f = fixture_open(0);
  for (int i = 2; i < argc; i++)
    examine(&f, argv[i], strrchr(argv[i], '/') ? strrchr(argv[i], '/') + 1 : argv[i], (1u << N_WAYS) - 1, 1, 0);
  for (int i = 0; i < MADE && argc <= 2; i++) {
    const char *path = make_mesh(i);
    examine(&f, path, made_names[i], i ? ASKED : ASKED & ~(1 << ROUND), i == 1 ? 13 : 8, 1);
    CHECK(remove(path) == 0);
  }
  for (int i = 0; i < 2 && argc <= 2; i++) {
    const char *path = check_data(argc > 1 ? argv[1] : ".", data[i]);
    if (path)
      examine(&f, path, data[i], ASKED, 13, 1);
  }
  fixture_close(&f);
  files_end(context);
  return check_result();
}
