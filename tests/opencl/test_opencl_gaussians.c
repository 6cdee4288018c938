/* On an OpenCL device, pictures of Gaussians are those of the CPU, in every bit of every plane: all profiles, scenes
 * friendly and hostile, by tiles and by pixels, with the host's memory and copies of it, all tiles at a time and few.
 */
#include "conic/opencl.h"
#include "core/splats/gaussian_profile.h"
#include "opencl/opencl_renderer.h"
#include "tests/support/check.h"
#include "tests/support/gaussian_picture.h"

/* Ways to draw the same. */
typedef struct way {
  const char *name;
  conic_opencl_work work;
  int copies; /* as to a device that is no CPU */
  size_t part;
} way;

static const way ways[] = {{"tiles", CONIC_OPENCL_WORK_TILES, 0, 0},
                           {"tiles, copied, in parts", CONIC_OPENCL_WORK_TILES, 1, 90},
                           {"pixels", CONIC_OPENCL_WORK_PIXELS, 0, 0},
                           {"pixels, copied, in parts", CONIC_OPENCL_WORK_PIXELS, 1, 40}};

enum { N_WAYS = 4, N_DEVICES = 2 };

typedef struct desk {
  conic_context *context;
  conic_opencl *devices[N_DEVICES]; /* by tiles, by pixels */
} desk;

static conic_opencl *device_in_way(const desk *d, const way *w) {
  conic_opencl *opencl = d->devices[w->work == CONIC_OPENCL_WORK_PIXELS];
  opencl->device.is_cpu = !w->copies;
  opencl->part_splats = w->part;
  return opencl;
}

/* So that what is not drawn differs. */
static conic_gaussian_planes spoiled_planes(const conic_camera *camera) {
  conic_gaussian_planes p = picture_planes(camera);
  void *const all[] = {p.rgb, p.normal, p.transparency, p.z, p.median_z, p.inverse_z, p.count, p.id, p.last};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    memset(all[i], 0x5a, (size_t)camera->width * (size_t)camera->height * (i < 2 ? 12 : 4));
  return p;
}

static void compare_ways(const desk *d, const conic_gaussians *scene, const conic_camera *given, int profile,
                         int n_ways, const char *what) {
  conic_camera centered = *given, *camera = &centered;
  if (conic_profile_row_of((conic_gaussian_profile)profile)->takes_middle) /* which draw no other */
    centered.cx = 0.5 * given->width;
  conic_gaussian_planes p = picture_planes(camera);
  conic_gaussian_options options;
  conic_gaussian_statistics s, of_device;
  conic_gaussian_options_init(&options);
  options.profile = (conic_gaussian_profile)profile;
  options.background[1] = 0.3f;
  CHECK_OK(conic_gaussians_render(d->context, scene, camera, &options, &p, &s));
  CHECK(s.device_units == 0);
  for (int i = 0; i < n_ways; i++) {
    conic_gaussian_planes other = spoiled_planes(camera);
    options.device = &device_in_way(d, &ways[i])->gaussian_device;
    CHECK_OK(conic_gaussians_render(d->context, scene, camera, &options, &other, &of_device));
    CHECK(of_device.device_units > 0 && of_device.entries == s.entries && of_device.pairs == s.pairs);
    if (!picture_is_same(&p, &other))
      fprintf(stderr, "%s, %s: %s differs\n", what, conic_gaussian_profile_name(options.profile), ways[i].name);
    CHECK(picture_is_same(&p, &other));
    picture_release(&other);
  }
  picture_release(&p);
}

static void compare_profiles(const desk *d, const conic_gaussians *scene, const conic_camera *camera,
                             const char *what) {
  for (int profile = 0; profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    compare_ways(d, scene, camera, profile, N_WAYS, what);
}

static conic_camera camera_of(int width, int height) {
  conic_camera camera = {
      .width = width, .height = height, .fx = 60.0, .fy = 62.0, .cx = 0.4 * width, .cy = 0.5 * height};
  for (int axis = 0; axis < 3; axis++)
    camera.cam_from_world[axis][axis] = 1.0;
  camera.cam_from_world[2][3] = 4.0;
  return camera;
}

/* A picture of each shape, small enough for a simulator (scripts/oclgrind). */
static void check_small_pictures(const desk *d) {
  const conic_camera camera = camera_of(19, 17);
  conic_gaussians scene = gaussians_random(d->context, 40, 0, 0);
  compare_ways(d, &scene, &camera, CONIC_PROFILE_EXACT, N_WAYS, "small");
  compare_ways(d, &scene, &camera, CONIC_PROFILE_KHR_2026, N_WAYS, "small");
  compare_ways(d, &scene, &camera, CONIC_PROFILE_2DGS_2024, N_WAYS, "small");
  conic_gaussians_release(d->context, &scene);
}

static void check_gaussian_sizes(const desk *d) {
  static const int sizes[][2] = {{70, 53}, {1, 1}, {1, 37}, {33, 16}};
  conic_gaussians scene = gaussians_random(d->context, 400, 1, 0);
  conic_gaussians flat = gaussians_random(d->context, 300, 0, CONIC_GAUSSIANS_2D);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    const conic_camera camera = camera_of(sizes[i][0], sizes[i][1]);
    compare_profiles(d, &scene, &camera, "random");
    compare_profiles(d, &flat, &camera, "flat");
  }
  conic_gaussians_release(d->context, &scene);
  conic_gaussians_release(d->context, &flat);
}

/* Numbers that are none, too large, too small, or at and behind the eye, each in some Gaussian's place. */
static void check_specials(const desk *d) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 0.0f, -1.0f, -4.0f, 1e-9f, 1e-30f, 1e9f, 3e38f, 1.0f};
  const conic_camera camera = camera_of(40, 40);
  conic_gaussians scene = gaussians_random(d->context, 300, 1, 0);
  uint64_t state = 11;
  for (size_t i = 0; i < scene.count; i += 2) {
    float *const columns[] = {scene.position[0], scene.position[1], scene.position[2], scene.scale[0],
                              scene.scale[1],    scene.scale[2],    scene.rotation[0], scene.rotation[3],
                              scene.opacity,     scene.position[2]};
    size_t column = (size_t)(random_unit(&state) * 10.0), special = (size_t)(random_unit(&state) * 11.0);
    columns[column][i] = specials[special];
    if (i % 6 == 0)
      scene.scale[0][i] = specials[7 + special % 4];
  }
  compare_profiles(d, &scene, &camera, "hostile");
  conic_gaussians_release(d->context, &scene);
}

/* Many at one place, so that depths are equal, and pixels have long lists and come to their end; and none at all. */
static void check_stack(const desk *d) {
  conic_camera camera = camera_of(30, 20);
  conic_gaussians scene = gaussians_random(d->context, 500, 0, 0);
  for (size_t i = 0; i < scene.count; i++)
    for (int axis = 0; axis < 3; axis++) {
      scene.position[axis][i] = axis == 2 && i % 5 ? 0.0f : 0.2f * scene.position[axis][i];
      scene.scale[axis][i] = 0.3f;
    }
  for (size_t i = 0; i < scene.count; i++)
    scene.opacity[i] = i % 3 ? 0.02f : scene.opacity[i];
  compare_profiles(d, &scene, &camera, "a stack");
  camera.cam_from_world[0][3] = 1e6;
  compare_profiles(d, &scene, &camera, "nothing");
  conic_gaussians_release(d->context, &scene);
}

/* Rays side by side, too; what devices do not draw, they refuse. */
static void check_cameras(const desk *d) {
  conic_camera camera = camera_of(40, 30);
  conic_gaussians scene = gaussians_random(d->context, 300, 1, 0);
  conic_gaussian_planes p = picture_planes(&camera);
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  options.device = &device_in_way(d, &ways[0])->gaussian_device;
  options.prefilter = 0.3;
  CHECK(conic_gaussians_render(d->context, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
  camera.kind = CONIC_CAMERA_ORTHOGRAPHIC;
  camera.fx = camera.fy = 10.0;
  compare_ways(d, &scene, &camera, CONIC_PROFILE_EXACT, N_WAYS, "orthographic");
  p.surface_z = p.z;
  options.prefilter = 0.0;
  CHECK(conic_gaussians_render(d->context, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_ARGUMENT);
  picture_release(&p);
  conic_gaussians_release(d->context, &scene);
}

/* Planes that are not wanted are not touched, and change nothing of others. */
static void check_single_planes(const desk *d) {
  const conic_camera camera = camera_of(35, 20);
  const size_t n = 35 * 20;
  conic_gaussians scene = gaussians_random(d->context, 300, 0, 0);
  for (int i = 0; i < N_WAYS; i++) {
    conic_gaussian_planes whole = picture_draw(d->context, &scene, &camera, CONIC_PROFILE_EXACT, CONIC_ISA_AUTO);
    conic_gaussian_planes drawn = spoiled_planes(&camera), p = {.width = 35, .height = 20, .rgb = drawn.rgb};
    conic_gaussian_options options;
    conic_gaussian_options_init(&options);
    options.device = &device_in_way(d, &ways[i])->gaussian_device;
    CHECK_OK(conic_gaussians_render(d->context, &scene, &camera, &options, &p, NULL));
    CHECK(memcmp(whole.rgb, drawn.rgb, n * 12) == 0 && drawn.count[0] == 0x5a5a5a5a);
    p.rgb = NULL;
    p.normal = drawn.normal;
    CHECK_OK(conic_gaussians_render(d->context, &scene, &camera, &options, &p, NULL));
    CHECK(memcmp(whole.normal, drawn.normal, n * 12) == 0 && drawn.z[n - 1] == drawn.transparency[0]);
    picture_release(&whole);
    picture_release(&drawn);
  }
  conic_gaussians_release(d->context, &scene);
}

/* A device that is too small says so, and draws what it can hold after that. */
static void check_small_memory(const desk *d) {
  const conic_camera camera = camera_of(64, 64);
  conic_gaussians scene = gaussians_random(d->context, 300, 0, 0);
  conic_gaussian_planes p = picture_planes(&camera);
  conic_gaussian_options options;
  conic_gaussian_options_init(&options);
  for (int i = 0; i < N_WAYS; i++) {
    conic_opencl *opencl = device_in_way(d, &ways[i]);
    const conic_opencl_device whole = opencl->device;
    options.device = &opencl->gaussian_device;
    opencl->device.greatest_buffer_bytes = 1000;
    CHECK(conic_gaussians_render(d->context, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_MEMORY);
    opencl->device.greatest_buffer_bytes = whole.greatest_buffer_bytes;
    opencl->device.memory_bytes = 5000;
    CHECK(conic_gaussians_render(d->context, &scene, &camera, &options, &p, NULL) == CONIC_ERROR_MEMORY);
    opencl->device = whole;
    CHECK_OK(conic_gaussians_render(d->context, &scene, &camera, &options, &p, NULL));
  }
  picture_release(&p);
  conic_gaussians_release(d->context, &scene);
}

static void check_biker(const desk *d, const char *path) {
  const conic_camera camera = camera_of(48, 48);
  conic_gaussians scene;
  CHECK_OK(conic_gaussians_read(d->context, path, NULL, &scene));
  compare_ways(d, &scene, &camera, CONIC_PROFILE_EXACT, 1, "biker");
  compare_ways(d, &scene, &camera, CONIC_PROFILE_GSPLAT_1_6, 1, "biker");
  conic_gaussians_release(d->context, &scene);
}

/* A renderer offers its device; one that has none, none. */
static void check_renderers(conic_context *context) {
  conic_renderer *renderer;
  conic_opencl_options options;
  conic_opencl_options_init(&options);
  CHECK_OK(conic_renderer_create(context, &renderer));
  CHECK(conic_opencl_gaussian_device(renderer) == NULL);
  conic_renderer_destroy(renderer);
  CHECK_OK(conic_opencl_renderer_create(context, &options, NULL, &renderer));
  CHECK(conic_opencl_gaussian_device(renderer) != NULL);
  conic_renderer_destroy(renderer);
}

static void check_all(const desk *d, const char *path) {
  check_gaussian_sizes(d);
  check_specials(d);
  check_stack(d);
  check_cameras(d);
  check_single_planes(d);
  check_small_memory(d);
  check_renderers(d->context);
  if (path)
    check_biker(d, path);
}

/* FOLDER, or FOLDER small: also on a device that does not say that it rounds correctly, as a simulator may */
int main(int argc, char **argv) {
  const int is_small = argc > 2 && strcmp(argv[2], "small") == 0;
  const char *path = check_data(argc > 1 ? argv[1] : ".", "gaussians/biker.spz");
  desk d = {.context = check_context(2)};
  conic_opencl_device *found;
  size_t n;
  if (conic_opencl_devices(d.context, &found, &n) != CONIC_OK || n == 0) {
    fprintf(stderr, "skipped: no OpenCL device is there\n");
    return 77;
  }
  conic_opencl_devices_release(d.context, found);
  for (int i = 0; i < N_DEVICES; i++) {
    conic_opencl_options options;
    conic_opencl_options_init(&options);
    options.allow_inexact = is_small;
    options.work = i ? CONIC_OPENCL_WORK_PIXELS : CONIC_OPENCL_WORK_TILES;
    CHECK_OK(conic_opencl_open(d.context, &options, &d.devices[i]));
    if (!d.devices[i])
      return 1;
  }
  if (is_small)
    check_small_pictures(&d);
  else
    check_all(&d, path);
  for (int i = 0; i < N_DEVICES; i++) {
    d.devices[i]->device.is_cpu = 1;
    conic_opencl_close(d.devices[i]);
  }
  conic_context_destroy(d.context);
  return check_result();
}
