/* Every profile: what one and two Gaussians must be, the oracle, one set of bits, what others draw. */
#include "core/base/memory.h"
#include "core/files/zip.h"
#include "core/splats/gaussian_profile.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"

static conic_camera camera_at(double distance, int side) {
  conic_camera camera = {
      .width = side, .height = side, .fx = 1.1 * side, .fy = 1.1 * side, .cx = 0.5 * side, .cy = 0.5 * side};
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][axis] = 1.0;
  camera.cam_from_world[2][3] = distance;
  return camera;
}

/* Round Gaussians on the axis, of degree 0, with the colours given. */
static conic_gaussians make_row(conic_context *context, size_t n, const double *z, const double *opacity,
                                const double (*color)[3], double scale) {
  conic_gaussians scene;
  if (conic_gaussians_allocate(context, n, 0, 0, &scene) != CONIC_OK)
    exit(1);
  for (size_t i = 0; i < n; i++) {
    for (int k = 0; k < 3; k++) {
      scene.position[k][i] = k == 2 ? (float)z[i] : 0.0f;
      scene.scale[k][i] = (float)scale;
      scene.sh[3 * i + (size_t)k] = (float)((color[i][k] - 0.5) / 0.28209479177387814);
    }
    for (int k = 0; k < 4; k++)
      scene.rotation[k][i] = k == 0 ? 1.0f : 0.0f;
    scene.opacity[i] = (float)opacity[i];
  }
  return scene;
}

/* Seen on the axis: alpha is the opacity, but for half a pixel. */
static int is_fainter(int profile) {
  const conic_profile_row *row = conic_profile_row_of((conic_gaussian_profile)profile);
  return row->shape == CONIC_SHAPE_ELLIPSE && row->dilation > 0.0 && row->compensation_least >= 0.0;
}

static void test_one_gaussian(conic_context *context) {
  const double z = 0.0, opacity = 0.6, color[1][3] = {{0.7, 0.2, 0.4}};
  const conic_camera camera = camera_at(4.0, 33);
  conic_gaussians scene = make_row(context, 1, &z, &opacity, color, 0.3);
  const size_t middle = 16 * 33 + 16;
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_planes p = picture_draw(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    const double h = conic_profile_row_of((conic_gaussian_profile)profile)->dilation;
    const double share = is_fainter(profile) ? 1.0 / (1.0 + h / (0.3 * 36.3 / 4.0 * 0.3 * 36.3 / 4.0)) : 1.0;
    CHECK_NEAR((double)p.transparency[middle], 1.0 - 0.6 * share, 2e-6);
    for (int c = 0; c < 3; c++)
      CHECK_NEAR((double)p.rgb[3 * middle + (size_t)c], (1.0 - (double)p.transparency[middle]) * color[0][c], 1e-6);
    CHECK_NEAR((double)p.z[middle], 4.0, 2e-6);
    CHECK(p.count[middle] == 1 && p.id[middle] == 0 && p.last[middle] == 0);
    CHECK(p.id[0] == CONIC_NO_ID && p.transparency[0] == 1.0f && p.rgb[0] == 0.0f);
    picture_release(&p);
  }
  /* Along the ray of a pixel to the side, at the angle φ: the distance of the mean from the ray is 4·sin φ. */
  conic_gaussian_planes p = picture_draw(context, &scene, &camera, CONIC_PROFILE_EXACT, CONIC_ISA_AUTO);
  for (int x = 0; x < 33; x++) {
    double slope = (x + 0.5 - 16.5) / 36.3, q = 16.0 * slope * slope / (1.0 + slope * slope) / 0.09;
    double alpha = 0.6 * exp(-0.5 * q);
    CHECK_NEAR(1.0 - (double)p.transparency[16 * 33 + x], alpha >= 1.0 / 255.0 ? alpha : 0.0, 1e-6);
    if (alpha >= 1.0 / 255.0)
      CHECK_NEAR((double)p.z[16 * 33 + x], 4.0 / (1.0 + slope * slope), 4e-6);
  }
  picture_release(&p);
  conic_gaussians_release(context, &scene);
}

/* The nearer one first, whichever comes first in the file; of equal depth, the first in the file. */
static void test_two_gaussians(conic_context *context) {
  static const double places[3][2] = {{-0.5, 0.5}, {0.5, -0.5}, {0.0, 0.0}}, opacity[2] = {0.6, 0.5};
  static const double color[2][3] = {{0.9, 0.1, 0.3}, {0.2, 0.8, 0.4}};
  const conic_camera camera = camera_at(4.0, 33);
  const size_t middle = 16 * 33 + 16;
  for (int k = 0; k < 3; k++)
    for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
      if (is_fainter(profile))
        continue;
      conic_gaussians scene = make_row(context, 2, places[k], opacity, color, 0.3);
      conic_gaussian_planes p = picture_draw(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
      const int first = k == 1, second = !first;
      for (int c = 0; c < 3; c++)
        CHECK_NEAR((double)p.rgb[3 * middle + (size_t)c],
                   opacity[first] * color[first][c] + (1.0 - opacity[first]) * opacity[second] * color[second][c],
                   1e-6);
      CHECK_NEAR((double)p.transparency[middle], 0.2, 1e-6);
      CHECK(p.last[middle] == (uint32_t)second && p.count[middle] == 2 && p.id[middle] == (uint32_t)first);
      picture_release(&p);
      conic_gaussians_release(context, &scene);
    }
}

static void compare_profile(conic_context *context, const conic_gaussians *scene, const conic_camera *camera,
                            int profile, double bound) {
  const size_t n = (size_t)camera->width * (size_t)camera->height;
  conic_gaussian_profile name = (conic_gaussian_profile)profile;
  conic_gaussian_reference r = picture_reference(context, scene, camera, name, CONIC_GAUSSIAN_PROFILE);
  conic_gaussian_planes p = picture_draw(context, scene, camera, name, CONIC_ISA_SCALAR);
  size_t n_other = 0;
  for (size_t i = 0; i < n; i++)
    n_other += p.count[i] != r.count[i];
  double rgb = picture_difference(p.rgb, r.rgb, 3 * n), rest = picture_difference(p.transparency, r.transparency, n);
  printf("%-14s rgb %.2g, T %.2g, N %.2g; %zu pixels with another count\n", conic_gaussian_profile_name(name), rgb,
         rest, picture_difference(p.normal, r.normal, 3 * n), n_other);
  CHECK(rgb <= bound && rest <= bound && picture_difference(p.normal, r.normal, 3 * n) <= bound);
  CHECK(n_other * 1000 <= n);
  for (int isa = CONIC_ISA_SSE2; isa < CONIC_N_ISAS; isa++) {
    conic_gaussian_planes planes = picture_planes(camera);
    conic_gaussian_options options;
    conic_gaussian_options_init(&options);
    options.profile = name;
    options.isa = (conic_isa)isa;
    if (conic_gaussians_render(context, scene, camera, &options, &planes, NULL) == CONIC_OK)
      CHECK(picture_is_same(&p, &planes));
    picture_release(&planes);
  }
  picture_release(&p);
  conic_gaussian_reference_release(context, &r);
}

/* Without a word where an instruction set is not here. */
static conic_context *quiet_context(int threads) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.threads = threads;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

/* A disc or an undilated ellipse that is seen nearly from its edge is the difference of large numbers. */
static double bound_of(int profile) {
  int is_bare = profile == CONIC_PROFILE_2DGS_2024 || profile == CONIC_PROFILE_2DGS_GSPLAT;
  return conic_profile_row_of((conic_gaussian_profile)profile)->stop == 0.0 ? 2e-5 : is_bare ? 4e-6 : 1e-6;
}

static void test_profiles_by_oracle(conic_context *context) {
  for (int degree = 0; degree <= CONIC_MAX_SH_DEGREE; degree++) {
    conic_gaussians scene = gaussians_random(context, 300, degree, 0);
    const conic_camera camera = camera_at(5.0, 70);
    for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
      compare_profile(context, &scene, &camera, profile, bound_of(profile));
    conic_gaussians_release(context, &scene);
  }
  conic_gaussians flat = gaussians_random(context, 200, 1, CONIC_GAUSSIANS_2D | CONIC_GAUSSIANS_HALF);
  const conic_camera camera = camera_at(5.0, 50);
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    compare_profile(context, &flat, &camera, profile, bound_of(profile));
  conic_gaussians_release(context, &flat);
}

static void test_profile_threads(conic_context *context) {
  conic_context *one = quiet_context(1);
  conic_gaussians scene = gaussians_random(context, 5000, 2, 0);
  const conic_camera camera = camera_at(5.0, 90);
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_planes a = picture_draw(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    conic_gaussian_planes b = picture_draw(one, &scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    CHECK(picture_is_same(&a, &b));
    picture_release(&a);
    picture_release(&b);
  }
  conic_gaussians_release(context, &scene);
  conic_context_destroy(one);
}

static void move(conic_gaussians *scene, size_t to, const conic_gaussians *from, size_t i) {
  const size_t n = conic_harmonics_of_degree(scene->sh_degree);
  for (int k = 0; k < 3; k++) {
    scene->position[k][to] = from->position[k][i];
    scene->scale[k][to] = from->scale[k][i];
  }
  for (int k = 0; k < 4; k++)
    scene->rotation[k][to] = from->rotation[k][i];
  scene->opacity[to] = from->opacity[i];
  memcpy(scene->sh + to * n, from->sh + i * n, n * sizeof *scene->sh);
}

/* Where no two depths are equal, the order in the file changes no bit of the colours. */
static void test_permuted(conic_context *context) {
  conic_gaussians scene = gaussians_random(context, 400, 3, 0), turned = gaussians_random(context, 400, 3, 0);
  const conic_camera camera = camera_at(5.0, 64);
  for (size_t i = 0; i < scene.count; i++)
    move(&turned, scene.count - 1 - i, &scene, i);
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_planes a = picture_draw(context, &scene, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    conic_gaussian_planes b = picture_draw(context, &turned, &camera, (conic_gaussian_profile)profile, CONIC_ISA_AUTO);
    CHECK(memcmp(a.rgb, b.rgb, 64 * 64 * 3 * sizeof(float)) == 0);
    CHECK(memcmp(a.transparency, b.transparency, 64 * 64 * sizeof(float)) == 0);
    picture_release(&a);
    picture_release(&b);
  }
  conic_gaussians_release(context, &scene);
  conic_gaussians_release(context, &turned);
}

/* As many as the planes count, whether they are wanted or not. */
static void check_pairs(conic_context *context, const conic_gaussians *scene, const conic_camera *camera,
                        const conic_gaussian_options *options, const conic_gaussian_planes *planes, uint64_t n_pairs) {
  conic_gaussian_planes colors = {.width = planes->width, .height = planes->height, .rgb = planes->rgb};
  conic_gaussian_options own = *options;
  conic_gaussian_statistics s;
  uint64_t sum = 0;
  for (size_t i = 0; i < (size_t)planes->width * (size_t)planes->height; i++)
    sum += planes->count[i];
  CHECK(sum > 0 && sum == n_pairs);
  for (int isa = CONIC_ISA_AUTO; isa <= CONIC_ISA_SCALAR; isa++) {
    own.isa = (conic_isa)isa;
    CHECK_OK(conic_gaussians_render(context, scene, camera, &own, &colors, &s));
    CHECK(s.pairs == n_pairs);
  }
}

/* What breaks others: counted or drawn, and never a number that is none. */
static void test_hard(conic_context *context) {
  enum { N = 14 };
  conic_gaussians scene = gaussians_random(context, N, 1, 0);
  const conic_camera camera = camera_at(5.0, 40);
  scene.position[0][0] = (float)NAN;
  scene.rotation[0][1] = scene.rotation[1][1] = scene.rotation[2][1] = scene.rotation[3][1] = 0.0f;
  scene.scale[1][2] = -1.0f;
  scene.scale[2][3] = (float)INFINITY;
  for (int k = 0; k < 3; k++) {
    scene.position[k][4] = k == 2 ? -5.0f : 0.0f; /* at the eye */
    scene.position[k][5] = k == 2 ? -9.0f : 0.0f; /* behind it, reaching before it */
    scene.scale[k][5] = 3.0f;
    scene.scale[k][6] = 1e-9f;
    scene.scale[k][7] = 1e9f;
    scene.scale[k][8] = k == 0 ? 10.0f : 1e-6f; /* a needle */
    scene.scale[k][9] = k == 0 ? 0.0f : 0.3f;   /* flat */
    scene.scale[k][10] = 0.0f;
  }
  scene.opacity[11] = 0.0f;
  scene.opacity[12] = 1.0f;
  scene.sh[13 * 12] = (float)NAN;
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++) {
    conic_gaussian_options options;
    conic_gaussian_statistics s;
    conic_gaussian_planes p = picture_planes(&camera);
    conic_gaussian_options_init(&options);
    options.profile = (conic_gaussian_profile)profile;
    CHECK_OK(conic_gaussians_render(context, &scene, &camera, &options, &p, &s));
    CHECK(s.gaussians_in == N && s.gaussians_skipped + s.gaussians_culled + s.gaussians_drawn == N);
    CHECK(s.gaussians_skipped >= 4 && s.gaussians_skipped <= 5);
    for (size_t i = 0; i < 3 * 1600; i++)
      CHECK(p.rgb[i] >= 0.0f && p.rgb[i] < 100.0f);
    for (size_t i = 0; i < 1600; i++)
      CHECK(p.transparency[i] >= 0.0f && p.transparency[i] <= 1.0f && p.z[i] - p.z[i] == 0.0f);
    check_pairs(context, &scene, &camera, &options, &p, s.pairs);
    picture_release(&p);
  }
  conic_gaussians_release(context, &scene);
}

/* --- what others draw, of the shared data --- */

typedef struct archive {
  conic_zip zip;
  unsigned char *bytes;
} archive;

/* The numbers of an array of 4 or 8 bytes each, which the caller frees. */
static double *array_named(const archive *a, const char *name, size_t n) {
  unsigned char *contents;
  size_t n_bytes;
  double *values = malloc(n * sizeof *values);
  if (conic_zip_read(&a->zip, name, (size_t)1 << 24, &contents, &n_bytes) != CONIC_OK || !values)
    exit(1);
  size_t begin = 10 + (size_t)(contents[8] | contents[9] << 8);
  int is_double = n_bytes - begin == 8 * n;
  CHECK(is_double || n_bytes - begin == 4 * n);
  for (size_t i = 0; i < n; i++) {
    float single;
    memcpy(&single, contents + begin + 4 * i, sizeof single);
    if (is_double)
      memcpy(&values[i], contents + begin + 8 * i, sizeof *values);
    else
      values[i] = (double)single;
  }
  conic_memory_release(a->zip.context, contents);
  return values;
}

static void take_columns(const archive *a, const char *name, size_t n, size_t n_columns, float **columns) {
  double *values = array_named(a, name, n * n_columns);
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n_columns; k++)
      columns[k][i] = (float)values[i * n_columns + k];
  free(values);
}

static void open_archive(conic_context *context, const char *path, archive *a) {
  FILE *file = fopen(path, "rb");
  size_t room = (size_t)1 << 22;
  a->bytes = malloc(room);
  size_t n = a->bytes && file ? fread(a->bytes, 1, room, file) : 0;
  if (file)
    fclose(file);
  if (conic_zip_open(context, path, a->bytes, n, &a->zip) != CONIC_OK)
    exit(1);
}

static void test_what_others_draw(conic_context *context, const char *path) {
  static const struct {
    const char *name;
    conic_gaussian_profile profile;
  } drawn[] = {{"rgb_inria.npy", CONIC_PROFILE_INRIA_2023},           {"rgb_gsplat_153.npy", CONIC_PROFILE_GSPLAT_1_5},
               {"rgb_gsplat_153aa.npy", CONIC_PROFILE_GSPLAT_1_5_AA}, {"rgb_gsplat_160.npy", CONIC_PROFILE_GSPLAT_1_6},
               {"rgb_gsplat_160aa.npy", CONIC_PROFILE_GSPLAT_1_6_AA}, {"rgb_exact.npy", CONIC_PROFILE_EXACT}};
  enum { N = 200, SIDE = 64 };
  archive a;
  conic_gaussians scene;
  conic_camera camera = {.width = SIDE, .height = SIDE};
  open_archive(context, path, &a);
  CHECK_OK(conic_gaussians_allocate(context, N, 3, 0, &scene));
  take_columns(&a, "means.npy", N, 3, scene.position);
  take_columns(&a, "scales.npy", N, 3, scene.scale);
  take_columns(&a, "quats.npy", N, 4, scene.rotation);
  take_columns(&a, "opac.npy", N, 1, &scene.opacity);
  take_columns(&a, "sh.npy", (size_t)N * 48, 1, &scene.sh);
  double *view = array_named(&a, "viewmat.npy", 16), *K = array_named(&a, "K.npy", 4);
  memcpy(camera.cam_from_world, view, sizeof camera.cam_from_world);
  camera.fx = K[0], camera.fy = K[1], camera.cx = K[2], camera.cy = K[3];
  for (size_t i = 0; i < sizeof drawn / sizeof *drawn; i++) {
    double *wanted = array_named(&a, drawn[i].name, SIDE * SIDE * 3);
    conic_gaussian_planes p = picture_draw(context, &scene, &camera, drawn[i].profile, CONIC_ISA_AUTO);
    conic_gaussian_reference r = picture_reference(context, &scene, &camera, drawn[i].profile, CONIC_GAUSSIAN_PROFILE);
    double of_float = picture_difference(p.rgb, wanted, SIDE * SIDE * 3), of_double = 0.0;
    for (size_t k = 0; k < SIDE * SIDE * 3; k++)
      of_double = fmax(of_double, fabs(r.rgb[k] - wanted[k]));
    printf("%-22s drawn %.2g, by the oracle %.2g\n", drawn[i].name, of_float, of_double);
    CHECK(of_float <= 2e-6 && of_double <= 1e-12);
    conic_gaussian_reference_release(context, &r);
    picture_release(&p);
    free(wanted);
  }
  free(view);
  free(K);
  free(a.bytes);
  conic_gaussians_release(context, &scene);
}

int main(int argc, char **argv) {
  conic_context *context = check_context(2), *quiet = quiet_context(2);
  const char *path = check_data(argc > 1 ? argv[1] : ".", "gaussians/random200.npz");
  test_one_gaussian(context);
  test_two_gaussians(context);
  test_profiles_by_oracle(quiet);
  test_profile_threads(context);
  test_permuted(context);
  test_hard(context);
#if CONIC_HAVE_ZLIB /* by which it is packed */
  if (path)
    test_what_others_draw(context, path);
#else
  (void)path, (void)test_what_others_draw;
#endif
  conic_context_destroy(quiet);
  conic_context_destroy(context);
  return check_result();
}
