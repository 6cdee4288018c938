/* Memory that runs out at the n-th allocation, for every n, on the way through a surface, and a wish to stop at the
 * n-th report of progress: a clean error each time, and nothing lost. */
#include <stdatomic.h>

#include "tests/support/surface_shapes.h"

static atomic_long n_calls, n_alive;
static long failing_call; /* from 1; 0: none */

static void *allocate(void *cookie, size_t bytes) {
  (void)cookie;
  if (atomic_fetch_add(&n_calls, 1) + 1 == failing_call)
    return NULL;
  void *pointer = malloc(bytes);
  atomic_fetch_add(&n_alive, pointer != NULL);
  return pointer;
}

static void release(void *cookie, void *pointer) {
  (void)cookie;
  atomic_fetch_sub(&n_alive, pointer != NULL);
  free(pointer);
}

static long n_reports, stopping_report; /* from 1; 0: none */
static unsigned tasks_seen;             /* bits of the names below */
static const char *const task_names[] = {"scales", "measure", "project", "patches"};

static int report(void *cookie, const char *task, double fraction) {
  (void)cookie;
  CHECK(fraction >= 0.0 && fraction <= 1.0);
  for (unsigned i = 0; i < sizeof task_names / sizeof task_names[0]; i++)
    tasks_seen |= strcmp(task, task_names[i]) == 0 ? 1u << i : 0u;
  return ++n_reports == stopping_report;
}

static conic_context *open_context(void) {
  conic_context_options options;
  conic_context *context;
  conic_context_options_init(&options);
  options.allocate = allocate;
  options.release = release;
  options.progress = report;
  options.threads = 2;
  if (conic_context_create(&options, &context) != CONIC_OK)
    exit(1);
  return context;
}

static conic_status work_on(conic_context *context, const conic_splats *samples, double cluster) {
  conic_surface_options options;
  conic_thin_options thin;
  conic_densify_options densify;
  conic_surface *surface;
  conic_splats clean, thinned, dense;
  conic_surface_options_init(&options);
  conic_thin_options_init(&thin);
  conic_densify_options_init(&densify);
  options.cluster = cluster;
  thin.count = 48;
  thin.is_measured = 1;
  densify.spacing = 0.4;
  conic_status status = conic_surface_create(context, samples, &options, &surface);
  if (status != CONIC_OK)
    return status;
  status = conic_surface_clean(surface, &clean, NULL);
  conic_splats_release(context, &clean);
  if (status == CONIC_OK) {
    status = conic_surface_thin(surface, &thin, &thinned, NULL);
    conic_splats_release(context, &thinned);
  }
  if (status == CONIC_OK) {
    status = conic_surface_densify(surface, &densify, &dense, NULL);
    conic_splats_release(context, &dense);
  }
  conic_surface_destroy(surface);
  return status;
}

static conic_status draw(conic_context *context, const conic_splats *splats) {
  conic_patches *patches;
  conic_patch_selection selection;
  conic_render_options render;
  conic_camera camera = {.width = 40, .height = 30, .fx = 300.0, .fy = 300.0, .cx = 20.0, .cy = 15.0};
  conic_render_options_init(&render);
  for (int i = 0; i < 3; i++)
    camera.cam_from_world[i][i] = 1.0;
  conic_status status = conic_patches_create(context, splats, NULL, &patches);
  for (int i = 0; i < 3 && status == CONIC_OK; i++) {
    camera.cam_from_world[2][3] = 5.0 - i; /* each picture takes more */
    status = conic_patches_select(patches, &camera, &render, &selection);
    CHECK(status != CONIC_OK || selection.n_patches > 0);
  }
  conic_patches_destroy(patches);
  return status;
}

static conic_status run(conic_context *context, const conic_splats *samples, double cluster) {
  return conic_splats_fields(samples) & CONIC_SPLATS_TANGENTS ? draw(context, samples)
                                                              : work_on(context, samples, cluster);
}

/* Stopped at any of its reports, it gives back all that it had. */
static void check_stopped(const conic_splats *samples, const conic_splats *splats) {
  long n_stopped = 0;
  failing_call = 0;
  for (int what = 0; what < 2; what++) {
    conic_status status = CONIC_ERROR_CANCELLED;
    for (stopping_report = 1; status == CONIC_ERROR_CANCELLED; stopping_report++) {
      conic_context *context = open_context();
      long n_before = atomic_load(&n_alive);
      n_reports = 0;
      status = run(context, what ? splats : samples, 0.0);
      CHECK(status == (n_reports < stopping_report ? CONIC_OK : CONIC_ERROR_CANCELLED));
      CHECK(atomic_load(&n_alive) == n_before);
      n_stopped += status == CONIC_ERROR_CANCELLED;
      conic_context_destroy(context);
    }
  }
  stopping_report = 0;
  CHECK(n_stopped > 6 && tasks_seen == 0xF);
}

int main(void) {
  conic_context *plain = check_context(1);
  conic_splats samples = shape_sample(plain, SHAPE_TORUS, 64, 0.1, 3);
  conic_splats splats = shape_places(plain, SHAPE_TORUS, 64, 3);
  long n_failures = 0;
  for (int what = 0; what < 3; what++) {
    for (long i = 1;; i++) {
      failing_call = 0;
      conic_context *context = open_context();
      long n_before = atomic_load(&n_alive);
      atomic_store(&n_calls, 0);
      failing_call = i;
      conic_status status = run(context, what < 2 ? &samples : &splats, what == 1 ? 0.3 : 0.0);
      CHECK(atomic_load(&n_alive) == n_before);
      long n_asked = atomic_load(&n_calls);
      conic_context_destroy(context);
      CHECK(atomic_load(&n_alive) == 0);
      CHECK(status == CONIC_OK || status == CONIC_ERROR_MEMORY);
      n_failures += status == CONIC_ERROR_MEMORY;
      if (n_asked < i) {
        CHECK(status == CONIC_OK);
        break;
      }
    }
  }
  check_stopped(&samples, &splats);
  printf("%ld clean failures\n", n_failures);
  CHECK(n_failures > 100);
  conic_splats_release(plain, &samples);
  conic_splats_release(plain, &splats);
  conic_context_destroy(plain);
  return check_result();
}
