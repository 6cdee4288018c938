/* The functions of the OpenCL programs alone, on random and edge inputs, against their C twins: an entry is added to
 * the program's text that calls them, plain and in lanes. And that a change of one unit in the last place does not
 * pass. */
#include "opencl/frame.h"
#include "opencl/program.h"
#include "raster/tiles/coverage.h"
#include "tests/support/opencl_fixture.h"

enum { N_VALUES = 4096, N_ANSWERS = 8, N_FRAGMENT_NUMBERS = 5 };

static const char added_text[] =
    "__kernel void try_functions(__constant conic_view *frame_view, __global const float *x, __global float *plain,\n"
    "                            __global float *in_lanes) {\n"
    "  conic_view view = *frame_view;\n"
    "  size_t item = get_global_id(0), n = 16 * get_global_size(0);\n"
    "  lanes all;\n"
    "  for (size_t i = 0; i < 16; i++) {\n"
    "    float v = x[16 * item + i], w = x[16 * item + 15 - i], a = fabs(v);\n"
    "    float b = a < view.support ? a : 0.0f;\n"
    "    float y[8] = {conic_exp_negative(-a), conic_gauss_narrow(v), conic_kernel_value(&view.reconstruction, b),\n"
    "                  sqrt(a), 1.0f / v, v / w, v * w + w, (v - w) * v};\n"
    "    for (size_t k = 0; k < 8; k++)\n"
    "      plain[k * n + 16 * item + i] = y[k];\n"
    "    ((float *)&all)[i] = v;\n"
    "  }\n"
    "  lanes a = fabs(all), w = all.sfedcba9876543210;\n"
    "  lanes y[8] = {lanes_exp_negative(-a), lanes_gauss_narrow(all), \n"
    "                kernel_value(&view, a < view.support ? a : 0.0f, kind_of(&view.reconstruction)),\n"
    "                sqrt(a), 1.0f / all, all / w, all * w + w, (all - w) * all};\n"
    "  for (size_t k = 0; k < 8; k++)\n"
    "    vstore16(y[k], 0, in_lanes + k * n + 16 * item);\n"
    "}\n"
    "__kernel void try_fragments(__constant conic_view *frame_view, __global const conic_footprint *footprints,\n"
    "                            __global const conic_ray *rays, __global const conic_clip_record *clips,\n"
    "                            __global float *plain, __global float *in_lanes,\n"
    "                            __global const float *profile_table) {\n"
    "  conic_view view = view_of(frame_view, profile_table);\n"
    "  size_t item = get_global_id(0);\n"
    "  conic_footprint footprint = footprints[item];\n"
    "  conic_ray ray = rays[item];\n"
    "  conic_clip_record clip = clips[item];\n"
    "  const conic_device_reference reference = {(uint)item, 0};\n"
    "  splat_rows row = begin_rows(&footprint, rows_from(8));\n"
    "  if (view.profile.table)\n"
    "    begin_profile(&view, &footprint, &ray, 0, &row);\n"
    "  splat_kind kind = view.profile.table ? SPLAT_PROFILED : footprint.s3 > 0.0f ? SPLAT_USUAL : SPLAT_SPECIAL;\n"
    "  fragments f;\n"
    "  fragments_at(&view, view.support, &footprint, &ray, 0, &clip, 0, &row, columns_from(12), kind, "
    "&f);\n"
    "  for (int lane = 0; lane < 16; lane++) {\n"
    "    gather_pixel p = {.column = 0, .row = 0};\n"
    "    conic_fragment g = {0, 0, 0, 0};\n"
    "    p.x = 12 + lane / 4;\n"
    "    p.y = 8 + lane % 4;\n"
    "    __global float *to = plain + (item * 16 + (size_t)lane) * 5, *to_lanes = in_lanes + (to - plain);\n"
    "    to[0] = gather_fragment(&view, reference, footprints, rays, clips, &p, &footprint, &g) ? 1.0f : 0.0f;\n"
    "    to[1] = g.q;\n"
    "    to[2] = g.iz;\n"
    "    to[3] = g.plane_iz;\n"
    "    to[4] = g.scale;\n"
    "    to_lanes[0] = ((int *)&f.covered)[lane] ? 1.0f : 0.0f;\n"
    "    to_lanes[1] = ((float *)&f.q)[lane];\n"
    "    to_lanes[2] = ((float *)&f.iz)[lane];\n"
    "    to_lanes[3] = ((float *)&f.plane_iz)[lane];\n"
    "    to_lanes[4] = ((float *)&f.scale)[lane];\n"
    "  }\n"
    "}\n";

/* A device with the raster's program and the added entries. */
typedef struct workbench {
  int is_planted; /* differs on purpose */
  conic_queue queue;
  cl_program program;
  cl_kernel functions, fragments;
  conic_buffer view, x, records[3], plain, in_lanes, profile;
} workbench;

static float edge_value(uint64_t *state) {
  static const float edges[] = {NAN,    INFINITY, -INFINITY, 0.0f,  -0.0f,  1e-42f, -1e-42f, 1e30f,
                                1e-20f, 3e38f,    -3e38f,    2.25f, 1.125f, 80.0f,  87.0f,   0x1p-126f};
  double choice = fixture_random(state);
  if (choice < 0.1)
    return edges[(int)(fixture_random(state) * 16.0)];
  return (float)((choice < 0.6 ? 2.25 : 200.0) * (fixture_random(state) - (choice < 0.4 ? 0.0 : 0.5)));
}

/* The same bits, or both not a number. */
static int are_same(float a, float b) {
  return memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b);
}

/* Ends the program where the device cannot even be prepared. */
static void open_workbench(conic_context *context, workbench *d, const char *from, const char *to) {
  conic_opencl_options options;
  conic_opencl_device device;
  cl_platform_id platform;
  cl_device_id id;
  cl_int answer;
  size_t n = conic_opencl_raster_text.n_bytes + sizeof added_text;
  char *text = malloc(n);
  memset(d, 0, sizeof *d);
  d->is_planted = from != NULL;
  if (!text)
    exit(1);
  snprintf(text, n, "%s%s", conic_opencl_raster_text.text, added_text);
  for (char *at = text; from && (at = strstr(at, from)); at += strlen(from))
    memcpy(at, to, strlen(to)); /* of the same length */
  conic_opencl_options_init(&options);
  CHECK_OK(conic_opencl_find(context, &options, &platform, &id, &device));
  CHECK_OK(conic_queue_open(context, platform, id, &d->queue));
  const conic_opencl_text whole = {"functions", text, strlen(text)};
  CHECK_OK(conic_opencl_build(context, d->queue.cl, id, &device, 5, &whole, NULL, &d->program));
  if (check_failures)
    exit(1);
  d->functions = clCreateKernel(d->program, "try_functions", &answer);
  CHECK_OK(conic_opencl_check(context, answer, "try_functions"));
  d->fragments = clCreateKernel(d->program, "try_fragments", &answer);
  CHECK_OK(conic_opencl_check(context, answer, "try_fragments"));
  free(text);
}

static void close_workbench(workbench *d) {
  conic_buffer *all[] = {&d->view,       &d->x,     &d->records[0], &d->records[1],
                         &d->records[2], &d->plain, &d->in_lanes,   &d->profile};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    conic_queue_release(&d->queue, all[i]);
  clReleaseKernel(d->functions);
  clReleaseKernel(d->fragments);
  clReleaseProgram(d->program);
  conic_queue_close(&d->queue);
}

static conic_argument put(workbench *d, conic_buffer *buffer, const void *from, size_t bytes) {
  CHECK_OK(conic_queue_room(&d->queue, buffer, bytes));
  if (from)
    CHECK_OK(conic_queue_write(&d->queue, buffer, from, bytes));
  return (conic_argument){sizeof(cl_mem), &buffer->memory};
}

static void run(workbench *d, cl_kernel entry, const conic_argument *arguments, int n, size_t n_items) {
  CHECK_OK(conic_queue_run(&d->queue, CONIC_STAGE_SETUP, entry, arguments, n, (const size_t[2]){n_items, 1},
                           (const size_t[2]){1, 1}));
  CHECK_OK(conic_queue_finish(&d->queue));
}

/* How many answers differ from the host's. */
static size_t try_functions(workbench *d, const conic_view *view, uint64_t *state) {
  static float x[N_VALUES], plain[N_ANSWERS * N_VALUES], in_lanes[N_ANSWERS * N_VALUES];
  size_t n_wrong = 0;
  for (int i = 0; i < N_VALUES; i++)
    x[i] = edge_value(state);
  const conic_argument arguments[] = {put(d, &d->view, view, sizeof *view), put(d, &d->x, x, sizeof x),
                                      put(d, &d->plain, NULL, sizeof plain),
                                      put(d, &d->in_lanes, NULL, sizeof in_lanes)};
  run(d, d->functions, arguments, 4, N_VALUES / 16);
  CHECK_OK(conic_queue_read(&d->queue, &d->plain, 0, plain, sizeof plain));
  CHECK_OK(conic_queue_read(&d->queue, &d->in_lanes, 0, in_lanes, sizeof in_lanes));
  for (int i = 0; i < N_VALUES; i++) {
    volatile float v = x[i], w = x[i / 16 * 16 + 15 - i % 16], a = fabsf(v), product = v * w, difference = v - w;
    const float expected[N_ANSWERS] = {conic_exp_negative(-a),
                                       conic_gauss_narrow(v),
                                       conic_kernel_value(&view->kernel, a < view->support ? a : 0.0f),
                                       sqrtf(a),
                                       1.0f / v,
                                       v / w,
                                       product + w,
                                       difference * v};
    for (int k = 0; k < N_ANSWERS; k++) {
      int is_wrong =
          !are_same(expected[k], plain[k * N_VALUES + i]) + !are_same(expected[k], in_lanes[k * N_VALUES + i]);
      if (is_wrong && n_wrong == 0 && !d->is_planted)
        printf("first difference: answer %d of %a: %a plain %a lanes %a\n", k, (double)v, (double)expected[k],
               (double)plain[k * N_VALUES + i], (double)in_lanes[k * N_VALUES + i]);
      n_wrong += (size_t)is_wrong;
    }
  }
  return n_wrong;
}

static void random_records(conic_footprint *footprint, conic_ray *ray, conic_clip_record *clip, uint64_t *state,
                           uint32_t i) {
  float *numbers = (float *)(void *)footprint, *of_ray = (float *)(void *)ray, *of_clip = (float *)(void *)clip;
  for (int k = 0; k < 16; k++)
    numbers[k] = 0.5f * any_value(state, 2.0, 0.02);
  for (int k = 0; k < 12; k++)
    of_ray[k] = any_value(state, 2.0, 0.02);
  for (int k = 0; k < 6; k++)
    of_clip[k] = any_value(state, 4.0, 0.02);
  clip->dx_low = clip->dy_low = -5.0f;
  clip->dx_high = clip->dy_high = 5.0f;
  footprint->x = (float)(11 + i % 7);
  footprint->y = (float)(6 + i % 5);
  footprint->iz_far = fabsf(footprint->iz_far);
  footprint->iz_near = footprint->iz_far + fabsf(footprint->iz_near);
  footprint->s3 = i % 3 == 0 ? 0.0f : footprint->s3;
  footprint->s2 = i % 6 == 0 ? 0.0f : footprint->s2; /* of rays: not by Laplace's method */
  if (footprint->s3 == 0.0f)
    footprint->i_ray = i;
  if (i % 4 == 1)
    footprint->s3 = -footprint->s3;
  ray->iz_low = -1.0f;
  ray->iz_high = 3.0f;
  ray->dx_low = ray->dy_low = -6.0f;
  ray->dx_high = ray->dy_high = 6.0f;
  clip->is_or = i / 4 % 2;
}

static size_t try_fragments(workbench *d, const conic_view *view, uint64_t *state, size_t *n_covered) {
  enum { N = 512, N_NUMBERS = N * 16 * N_FRAGMENT_NUMBERS };
  static conic_footprint footprints[N];
  static conic_ray rays[N];
  static conic_clip_record clips[N];
  static float plain[N_NUMBERS], in_lanes[N_NUMBERS];
  const conic_projected projected = {.footprints = footprints, .rays = rays, .clips = clips};
  size_t n_wrong = 0;
  for (uint32_t i = 0; i < N; i++)
    random_records(&footprints[i], &rays[i], &clips[i], state, i);
  const conic_argument arguments[] = {put(d, &d->view, view, sizeof *view),
                                      put(d, &d->records[0], footprints, sizeof footprints),
                                      put(d, &d->records[1], rays, sizeof rays),
                                      put(d, &d->records[2], clips, sizeof clips),
                                      put(d, &d->plain, NULL, sizeof plain),
                                      put(d, &d->in_lanes, NULL, sizeof in_lanes),
                                      put(d, &d->profile, view->profile.table, CONIC_PROFILE_FLOATS * sizeof(float))};
  run(d, d->fragments, arguments, 7, N);
  CHECK_OK(conic_queue_read(&d->queue, &d->plain, 0, plain, sizeof plain));
  CHECK_OK(conic_queue_read(&d->queue, &d->in_lanes, 0, in_lanes, sizeof in_lanes));
  for (int i = 0; i < N * 16; i++) {
    conic_fragment f = {0, 0, 0, 0};
    int lane = i % 16, x = 12 + lane / 4, y = 8 + lane % 4;
    float is_covered = (float)conic_fragment_at(view, &projected, &footprints[i / 16], x, y, &f);
    const float expected[N_FRAGMENT_NUMBERS] = {is_covered, f.q, f.iz, f.plane_iz, f.scale};
    const float *of_plain = plain + N_FRAGMENT_NUMBERS * i, *of_lanes = in_lanes + N_FRAGMENT_NUMBERS * i;
    n_wrong += is_covered != of_plain[0] || is_covered != of_lanes[0];
    *n_covered += is_covered != 0.0f;
    for (int k = 1; k < N_FRAGMENT_NUMBERS && is_covered != 0.0f; k++)
      n_wrong += !are_same(expected[k], of_plain[k]) || !are_same(expected[k], of_lanes[k]);
  }
  return n_wrong;
}

/* Prefix sums of random numbers, of sizes about the items' borders. */
static void check_scan(conic_context *context, uint64_t *state) {
  static const uint32_t sizes[] = {1, 2, 1023, 1024, 1025, 5000};
  conic_opencl_options options;
  conic_opencl *opencl;
  conic_opencl_options_init(&options);
  CHECK_OK(conic_opencl_open(context, &options, &opencl));
  CHECK_OK(conic_opencl_need_splats(opencl));
  for (size_t s = 0; opencl && s < sizeof sizes / sizeof sizes[0]; s++) {
    static uint32_t numbers[5000];
    static uint64_t places[5001];
    uint32_t n = sizes[s], n_sums = (n + CONIC_SCAN_NUMBERS - 1) / CONIC_SCAN_NUMBERS;
    for (uint32_t i = 0; i < n; i++)
      numbers[i] = (uint32_t)(fixture_random(state) * 4294967296.0);
    conic_buffer of_numbers = {NULL, 0}, sums = {NULL, 0}, of_places = {NULL, 0};
    conic_queue *queue = &opencl->queue;
    CHECK_OK(conic_queue_room(queue, &of_numbers, n * sizeof *numbers));
    CHECK_OK(conic_queue_room(queue, &sums, n_sums * sizeof *places));
    CHECK_OK(conic_queue_room(queue, &of_places, (n + 1) * sizeof *places));
    CHECK_OK(conic_queue_write(queue, &of_numbers, numbers, n * sizeof *numbers));
    const conic_argument steps[3][4] = {
        {CONIC_ARGUMENT(n), CONIC_ARGUMENT(of_numbers.memory), CONIC_ARGUMENT(sums.memory)},
        {CONIC_ARGUMENT(n_sums), CONIC_ARGUMENT(sums.memory)},
        {CONIC_ARGUMENT(n), CONIC_ARGUMENT(of_numbers.memory), CONIC_ARGUMENT(sums.memory),
         CONIC_ARGUMENT(of_places.memory)}};
    static const int n_arguments[] = {3, 2, 4};
    for (int step = 0; step < 3; step++)
      CHECK_OK(conic_queue_run(queue, CONIC_STAGE_BIN, opencl->entries[CONIC_ENTRY_SCAN_SUMS + step], steps[step],
                               n_arguments[step], (const size_t[2]){step == 1 ? 1 : n_sums, 1},
                               (const size_t[2]){1, 1}));
    CHECK_OK(conic_queue_read(queue, &of_places, 0, places, (n + 1) * sizeof *places));
    uint64_t sum = 0;
    for (uint32_t i = 0; i <= n; i++) {
      CHECK(places[i] == sum);
      sum += i < n ? numbers[i] : 0;
    }
    conic_queue_release(queue, &of_numbers);
    conic_queue_release(queue, &sums);
    conic_queue_release(queue, &of_places);
  }
  conic_opencl_close(opencl);
}

/* All kernels of reconstruction; returns how much differs. */
static size_t check_functions(fixture *f, workbench *d) {
  uint64_t state = 11;
  size_t n_wrong = 0, n_covered = 0;
  for (int number = 0; number < 2 * CONIC_N_METHODS * CONIC_N_KERNELS; number += CONIC_N_METHODS) {
    conic_view view;
    choose(f, number);
    f->options.kernel.cutoff = number < CONIC_N_METHODS * CONIC_N_KERNELS ? 1.5f : 3.0f;
    CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 0.01, &view));
    n_wrong += try_functions(d, &view, &state);
    n_wrong += try_fragments(d, &view, &state, &n_covered);
  }
  CHECK(n_covered > 1000);
  return n_wrong;
}

int main(void) {
  fixture f = fixture_open(1);
  workbench d;
  uint64_t state = 5;
  opencl_need_device(f.context);
  fixture_camera(&f, 64, 64, 60.0);
  fill(&f, &state, 1.0, 0.0);
  open_workbench(f.context, &d, NULL, NULL);
  CHECK(check_functions(&f, &d) == 0);
  close_workbench(&d);
  check_scan(f.context, &state);
  /* One unit in the last place of a coefficient of each kind must be seen. */
  static const char *const planted[][2] = {{"0x1.23ba98p-4f", "0x1.23ba9ap-4f"}, {"0x1.fffffcp-2f", "0x1.fffffep-2f"}};
  for (size_t i = 0; i < sizeof planted / sizeof planted[0]; i++) {
    CHECK(strstr(conic_opencl_raster_text.text, planted[i][0]) != NULL);
    open_workbench(f.context, &d, planted[i][0], planted[i][1]);
    CHECK(check_functions(&f, &d) > 0);
    close_workbench(&d);
  }
  fixture_close(&f);
  return check_result();
}
