/* The scenes of `conic bench`: analytic ones, mixes of splats by their size on the screen, files. */

#include "bench/bench.h"
#include "cli/arguments.h"
#include "cli/scene/views.h"
#include "core/base/nearest_word.h"
#include "core/base/random.h"
#include "core/base/vectors.h"
#include "core/files/file.h"
#include "shots/way.h"

/* The camera of the rates that are quoted: the unit sphere from a little above, some 900 pixels across. */
static const double focal_px = 1406.708438760767; /* for 1024 pixels */
static const double distance = 3.2;
static const double cam_from_world[3][4] = {{0.9438583563660174, 0.0, -0.33035042472810605, 0.0},
                                            {0.09000264042231507, -0.9621710845147493, 0.25715040120661453, 0.0},
                                            {-0.3178536264305498, -0.2724459655118999, -0.9081532183729997, distance}};

/* Splats of every direction all over the unit ball, their outlines between two lengths (logarithmically even). */
typedef struct mix {
  const char *name, *summary;
  unsigned long long count; /* where none is asked for */
  double low_px, high_px;   /* the longer diameter, at the ball's centre, 1024 pixels wide */
  double ratio;             /* shorter over longer axis, at least */
} mix;

static const mix mixes[] = {
    {"mixed", "splats all over a ball: outlines of 1 to 100 pixels", 50000, 1.0, 100.0, 0.2},
    {"subpixel", "splats all over a ball: outlines of 0.01 to 1 pixel", 1000000, 0.01, 1.0, 0.2},
    {"needles", "splats all over a ball: 20 to 200 pixels long, a thousandth as wide", 100000, 20.0, 200.0, 0.001},
    {"huge", "splats all over a ball: outlines of 200 to 2000 pixels", 300, 200.0, 2000.0, 0.2},
};

enum { N_MIXES = sizeof mixes / sizeof mixes[0] };

/* --- mixes --- */

/* 2^t, but straight between the powers: even enough, and the same everywhere. */
static double doubled(double t) {
  double whole = floor(t), power = 1.0;
  for (int i = 0; i < (int)fabs(whole); i++)
    power *= whole > 0.0 ? 2.0 : 0.5;
  return power * (1.0 + (t - whole));
}

/* The t of which that is `value`. */
static double halvings(double value) {
  double t = 0.0;
  for (; value >= 2.0; value *= 0.5)
    t += 1.0;
  for (; value < 1.0; value *= 2.0)
    t -= 1.0;
  return t + (value - 1.0);
}

/* Evenly in the unit ball, but not at its very centre. */
static void place_in_ball(uint64_t i, uint64_t dimension, double p[3]) {
  do {
    for (int axis = 0; axis < 3; axis++)
      p[axis] = 2.0 * conic_random_uniform(1, i, dimension++) - 1.0;
  } while (conic_length(p) > 1.0 || conic_length(p) < 1e-3);
}

/* Two perpendicular unit directions. */
static void point_axes(uint64_t i, double u[3], double v[3]) {
  double other[3], length;
  place_in_ball(i, 1000, u);
  length = conic_length(u);
  for (int axis = 0; axis < 3; axis++)
    u[axis] /= length;
  for (uint64_t dimension = 2000;; dimension += 1000) {
    place_in_ball(i, dimension, other);
    conic_cross(u, other, v);
    length = conic_length(v);
    if (length > 1e-3)
      break;
  }
  for (int axis = 0; axis < 3; axis++)
    v[axis] /= length;
}

static void set_splat(const mix *m, size_t i, conic_splats *splats) {
  const double cutoff = 1.5, low = halvings(m->low_px), high = halvings(m->high_px);
  double p[3], u[3], v[3];
  double diameter_px = doubled(low + (high - low) * conic_random_uniform(1, i, 0));
  double ratio = m->ratio * (1.0 + conic_random_uniform(1, i, 1));
  double sigma = diameter_px * (distance / focal_px) / (2.0 * cutoff);
  place_in_ball(i, 10, p);
  point_axes(i, u, v);
  for (int axis = 0; axis < 3; axis++) {
    splats->position[axis][i] = (float)p[axis];
    splats->tangent_u[axis][i] = (float)(sigma * u[axis]);
    splats->tangent_v[axis][i] = (float)(sigma * ratio * v[axis]);
    splats->color[axis][i] = (float)(0.5 + 0.5 * p[axis]);
  }
}

static conic_status make_mix(cli_session *session, const mix *m, size_t count, conic_splats *splats) {
  conic_status status =
      conic_splats_allocate(session->context, count, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, splats);
  for (size_t i = 0; i < count && status == CONIC_OK; i++)
    set_splat(m, i, splats);
  return status;
}

/* --- names --- */

/* What a name asks for: a mix or an analytic scene, and how many splats. */
typedef struct wish {
  const mix *mix;  /* null: analytic */
  int is_gaussian; /* neither */
  conic_scene_type type;
  unsigned long long count;
} wish;

static const char gaussians_name[] = "gaussians";

static int find_base(const char *base, size_t length, wish *w) {
  memset(w, 0, sizeof *w);
  w->count = 1000000;
  w->is_gaussian = strlen(gaussians_name) == length && strncmp(gaussians_name, base, length) == 0;
  if (w->is_gaussian)
    return 1;
  for (int i = 0; i < N_MIXES; i++)
    if (strlen(mixes[i].name) == length && strncmp(mixes[i].name, base, length) == 0) {
      w->mix = &mixes[i];
      w->count = mixes[i].count;
      return 1;
    }
  for (int i = 0; i < CONIC_N_SCENES; i++)
    if (strlen(conic_scene_name((conic_scene_type)i)) == length &&
        strncmp(conic_scene_name((conic_scene_type)i), base, length) == 0) {
      w->type = (conic_scene_type)i;
      return 1;
    }
  return 0;
}

static int refuse_scene(const char *name, size_t length) {
  char base[32];
  snprintf(base, sizeof base, "%.*s", (int)length, name);
  const char *nearest = conic_nearer_word(base, NULL, gaussians_name);
  for (int i = 0; i < N_MIXES; i++)
    nearest = conic_nearer_word(base, nearest, mixes[i].name);
  for (int i = 0; i < CONIC_N_SCENES; i++)
    nearest = conic_nearer_word(base, nearest, conic_scene_name((conic_scene_type)i));
  if (nearest)
    return cli_usage("bench: unknown scene %s; did you mean %s?", name, nearest);
  return cli_usage("bench: unknown scene %s; see conic help bench", name);
}

/* "sphere", "sphere-4M", "needles-10k" */
static int understand(const char *name, wish *w) {
  size_t length = strcspn(name, "-");
  if (!find_base(name, length, w))
    return refuse_scene(name, length);
  if (name[length] && (!cli_parse_count(name + length + 1, &w->count) || w->count < 1 || w->count > 4294967294u))
    return cli_usage("bench: scene %s: how many splats is %s?", name, name + length + 1);
  if (strlen(name) >= sizeof((cli_bench_scene *)NULL)->name)
    return cli_usage("bench: scene %s: the name is too long", name);
  return CLI_DONE;
}

int cli_bench_scene_check(const char *name, int *is_gaussian) {
  wish w;
  int exit_code = understand(name, &w);
  *is_gaussian = exit_code == CLI_DONE && w.is_gaussian;
  return exit_code;
}

const char *cli_bench_scene_at(int i, const char **about) {
  if (i < CONIC_N_SCENES) {
    *about = conic_scene_summary((conic_scene_type)i);
    return conic_scene_name((conic_scene_type)i);
  }
  i -= CONIC_N_SCENES;
  *about = i < N_MIXES ? mixes[i].summary : "3D Gaussians of degree 3, like a scene trained from photographs";
  return i < N_MIXES ? mixes[i].name : i == N_MIXES ? gaussians_name : NULL;
}

/* --- opening --- */

static conic_status make_analytic(cli_session *session, const wish *w, conic_splats *splats) {
  conic_scene_options options;
  conic_scene *scene = NULL;
  conic_scene_options_init(&options);
  options.type = w->type;
  options.count = (size_t)w->count;
  conic_status status = conic_scene_create(session->context, &options, &scene);
  if (status == CONIC_OK)
    status =
        conic_splats_allocate(session->context, options.count, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_COLORS, splats);
  if (status == CONIC_OK)
    status = conic_scene_sample(scene, 0, options.count, splats);
  conic_scene_destroy(scene);
  return status;
}

conic_status cli_bench_camera_read(cli_session *session, const char *path, const char *view, conic_camera *camera) {
  const cli_views_wish wanted = {.path = path, .view = view};
  conic_cameras cameras;
  size_t i_view;
  conic_status status = cli_views_read(session, &wanted, &cameras, &i_view);
  if (status == CONIC_OK)
    *camera = cameras.cameras[i_view];
  conic_cameras_release(session->context, &cameras);
  return status;
}

int cli_bench_file_chooses(const char *path, int has_errors) {
  conic_source_options options;
  conic_source_options_init(&options);
  unsigned abilities = conic_source_abilities(&path, 1, &options);
  return (abilities & CONIC_SOURCE_CLUSTERS) || (has_errors && (abilities & CONIC_SOURCE_CHOOSES));
}

static conic_status read_bench_file(cli_session *session, const char *path, const cli_bench_look *look,
                                    cli_bench_scene *scene) {
  conic_source_options options;
  conic_source_options_init(&options);
  snprintf(scene->name, sizeof scene->name, "%.31s", conic_file_name(path));
  if (cli_bench_is_gaussian_file(path))
    return cli_bench_gaussians_read(session, path, look, scene);
  options.is_whole = !look->chooses;
  scene->cull_back = look->culls_back;
  scene->is_framed = !look->camera_path;
  scene->has_camera = look->camera_path != NULL;
  conic_status status = CONIC_OK;
  if (look->camera_path)
    status = cli_bench_camera_read(session, look->camera_path, look->view, &scene->camera);
  return status == CONIC_OK ? conic_source_open(session->context, &path, 1, &options, &scene->source) : status;
}

static conic_status make(cli_session *session, const wish *w, const char *name, cli_bench_scene *scene) {
  conic_splats splats = {0};
  snprintf(scene->name, sizeof scene->name, "%s", name);
  if (w->is_gaussian)
    return cli_bench_gaussians_make(session, (size_t)w->count, scene);
  scene->cull_back = !w->mix && w->type == CONIC_SCENE_SPHERE;
  conic_status status =
      w->mix ? make_mix(session, w->mix, (size_t)w->count, &splats) : make_analytic(session, w, &splats);
  if (status == CONIC_OK)
    status = conic_source_of_drawing(session->context, &splats, NULL, &scene->source);
  conic_splats_release(session->context, &splats);
  return status;
}

int cli_bench_scene_open(cli_session *session, const char *name, const cli_bench_look *look, cli_bench_scene *scene) {
  wish w;
  memset(scene, 0, sizeof *scene);
  int exit_code = look ? CLI_DONE : understand(name, &w);
  if (exit_code != CLI_DONE)
    return exit_code;
  conic_status status = look ? read_bench_file(session, name, look, scene) : make(session, &w, name, scene);
  if (status == CONIC_OK && !scene->is_gaussian && !(look && look->chooses))
    scene->splats = conic_source_chosen(scene->source)->drawing.splats;
  return cli_exit_of(status);
}

void cli_bench_scene_release(cli_session *session, cli_bench_scene *scene) {
  cli_bench_gaussians_release(session, scene);
  conic_source_close(scene->source);
  scene->source = NULL;
}

static void build_in(conic_camera *camera) {
  memset(camera, 0, sizeof *camera);
  camera->width = camera->height = 1024;
  camera->fx = camera->fy = focal_px;
  camera->cx = camera->cy = 512.0;
  memcpy(camera->cam_from_world, cam_from_world, sizeof cam_from_world);
}

/* The same view in another size: what the shorter side showed it shows again. */
static void bench_camera_resize(conic_camera *camera, int width, int height) {
  int shorter = width < height ? width : height;
  double factor = (double)shorter / (double)(camera->width < camera->height ? camera->width : camera->height);
  camera->cx = 0.5 * (double)width + factor * (camera->cx - 0.5 * (double)camera->width);
  camera->cy = 0.5 * (double)height + factor * (camera->cy - 0.5 * (double)camera->height);
  camera->fx *= factor;
  camera->fy *= factor;
  camera->width = width;
  camera->height = height;
}

void cli_bench_scene_turn(const cli_bench_scene *scene, double turns, conic_camera *camera) {
  const conic_source_scale *scale = conic_source_measure(scene->source);
  double center[3];
  for (int axis = 0; axis < 3; axis++)
    center[axis] = 0.5 * scale->minimum[axis] + 0.5 * scale->maximum[axis];
  conic_camera_orbit(center, scale->up, turns, camera);
}

conic_status cli_bench_scene_camera(const cli_bench_scene *scene, int width, int height, conic_camera *camera) {
  if (scene->is_framed) {
    conic_framing framing;
    conic_framing_init(&framing);
    framing.width = width;
    framing.height = height;
    return conic_source_frame(scene->source, &framing, camera);
  }
  if (scene->has_camera)
    *camera = scene->camera;
  else
    build_in(camera);
  for (int row = 0; row < 3 && scene->is_gaussian && !scene->has_camera; row++)
    for (int axis = 1; axis < 3; axis++) /* what is made has y down */
      camera->cam_from_world[row][axis] = -camera->cam_from_world[row][axis];
  bench_camera_resize(camera, width, height);
  return CONIC_OK;
}
