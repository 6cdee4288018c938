/* Each stage of a frame on an OpenCL device, downloaded and compared with plain C's: records, tile lists, thresholds,
 * sums. */
#include "opencl/frame.h"
#include "raster/tiles/coverage.h"
#include "tests/support/opencl_fixture.h"

/* What plain C makes of the splats: one chunk of records in file order, and what every pixel then has. */
typedef struct expectation {
  const fixture *f;
  conic_view view;
  conic_chunk chunk;
  conic_projected projected;
  float *thresholds, (*sums)[CONIC_N_SUMS]; /* by pixel, row by row */
  uint64_t n_fragments;
} expectation;

static void *zeroed(size_t count, size_t size) {
  void *memory = calloc(count + 1, size);
  if (!memory)
    exit(1);
  return memory;
}

static void expect_records(expectation *e) {
  size_t n = e->f->splats.count;
  conic_projected *p = &e->projected;
  p->n_chunks = 1;
  p->chunk_size = n;
  p->chunks = &e->chunk;
  p->footprints = zeroed(n, sizeof *p->footprints);
  p->boxes = zeroed(n, sizeof *p->boxes);
  p->surfaces = zeroed(n, sizeof *p->surfaces);
  p->rays = zeroed(n, sizeof *p->rays);
  p->clips = zeroed(n, sizeof *p->clips);
  memset(&e->chunk, 0, sizeof e->chunk);
  for (size_t i = 0; i < n; i++)
    conic_project_one(&e->view, &e->f->splats, i, p, &e->chunk);
  conic_clip_chunk(&e->view, &e->f->splats, 0, p, &e->chunk);
}

static float larger(float a, float b) {
  return a > b ? a : b;
}

static int covers(const expectation *e, size_t i, int x, int y, conic_fragment *fragment) {
  const conic_box *box = &e->projected.boxes[i]; /* rounded outwards to blocks */
  return x >= box->x_begin / 4 * 4 && x < (box->x_end + 3) / 4 * 4 && y >= box->y_begin / 4 * 4 &&
         y < (box->y_end + 3) / 4 * 4 &&
         conic_fragment_at(&e->view, &e->projected, &e->projected.footprints[i], x, y, fragment);
}

/* By the definition (docs/reference/picture.md, Visible and Planes), in file order. */
static void expect_pixel(expectation *e, int x, int y) {
  size_t at = (size_t)y * (size_t)e->view.width + (size_t)x;
  conic_fragment g;
  float *sums = e->sums[at], threshold = 0.0f;
  float ray_x = (float)(((double)x + 0.5 - e->view.cx) / e->view.fx);
  float ray_y = (float)(((double)y + 0.5 - e->view.cy) / e->view.fy);
  uint32_t count = 0;
  for (size_t i = 0; i < e->chunk.n_drawn; i++)
    if (covers(e, i, x, y, &g)) {
      threshold = larger(conic_hiding_iz(&e->projected.footprints[i], &g, ray_x, ray_y), threshold);
      e->n_fragments++;
    }
  e->thresholds[at] = threshold;
  for (size_t i = 0; i < e->chunk.n_drawn; i++) {
    const conic_footprint *footprint = &e->projected.footprints[i];
    const conic_projected_surface *surface = &e->projected.surfaces[i];
    if (!covers(e, i, x, y, &g) || !(larger(g.plane_iz, g.iz) >= threshold))
      continue;
    float weight = conic_final_weight(&e->view, footprint, g.q, g.scale);
    sums[CONIC_SUM_WEIGHT] += weight;
    for (int axis = 0; axis < 3; axis++) {
      sums[CONIC_SUM_COLOR + axis] += weight * surface->color[axis];
      sums[CONIC_SUM_NORMAL + axis] += weight * surface->normal[axis];
    }
    if (sums[CONIC_SUM_HEAVIEST_WEIGHT] < weight) {
      sums[CONIC_SUM_HEAVIEST_WEIGHT] = weight;
      sums[CONIC_SUM_Z] = conic_plane_z(footprint, x, y);
      memcpy(&sums[CONIC_SUM_HEAVIEST_NORMAL], surface->normal, sizeof surface->normal);
    }
    if (sums[CONIC_SUM_NEAREST_IZ] < g.iz) {
      sums[CONIC_SUM_NEAREST_IZ] = g.iz;
      memcpy(&sums[CONIC_SUM_ID], &surface->index, sizeof surface->index);
    }
    count++;
  }
  memcpy(&sums[CONIC_SUM_COUNT], &count, sizeof count);
}

static expectation *expect(const fixture *f) {
  expectation *e = zeroed(1, sizeof *e);
  size_t n_pixels = (size_t)f->camera.width * (size_t)f->camera.height;
  e->f = f;
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 0.01, &e->view));
  expect_records(e);
  e->thresholds = zeroed(n_pixels, sizeof *e->thresholds);
  e->sums = zeroed(n_pixels, sizeof *e->sums);
  for (int y = 0; y < e->view.height; y++)
    for (int x = 0; x < e->view.width; x++)
      expect_pixel(e, x, y);
  return e;
}

static void drop(expectation *e) {
  free(e->projected.footprints);
  free(e->projected.boxes);
  free(e->projected.surfaces);
  free(e->projected.rays);
  free(e->projected.clips);
  free(e->thresholds);
  free(e->sums);
  free(e);
}

/* The download hook: so many elements of a buffer, in memory of the caller's. */
static void *download(const conic_frame *frame, int buffer, size_t count, size_t size) {
  void *to = zeroed(count, size);
  CHECK_OK(conic_queue_read(&frame->opencl->queue, &frame->opencl->buffers[buffer], 0, to, count * size));
  return to;
}

/* The records in file order, as plain C's; a ray's place among the rays may be another. */
static void check_setup(const expectation *e, const conic_frame *frame) {
  size_t n = e->f->splats.count, n_wrong = 0;
  CHECK(frame->n_drawn == e->chunk.n_drawn);
  uint32_t *order = download(frame, CONIC_BUFFER_ORDER, frame->n_drawn, sizeof *order);
  conic_footprint *footprints = download(frame, CONIC_BUFFER_FOOTPRINTS, n, sizeof *footprints);
  conic_box *boxes = download(frame, CONIC_BUFFER_BOXES, n, sizeof *boxes);
  conic_projected_surface *surfaces = download(frame, CONIC_BUFFER_SURFACES, n, sizeof *surfaces);
  conic_ray *rays = download(frame, CONIC_BUFFER_RAYS, n, sizeof *rays);
  conic_clip_record *clips =
      e->f->splats.n_clips ? download(frame, CONIC_BUFFER_CLIP_RECORDS, n, sizeof *clips) : zeroed(n, sizeof *clips);
  for (size_t i = 0; i < frame->n_drawn && i < e->chunk.n_drawn; i++) {
    uint32_t at = order[i];
    conic_footprint expected = e->projected.footprints[i];
    CHECK(at < n && (i == 0 || order[i - 1] < at));
    if (expected.s3 == 0.0f) {
      n_wrong += memcmp(&rays[footprints[at].i_ray], &e->projected.rays[expected.i_ray], sizeof *rays) != 0;
      expected.i_ray = footprints[at].i_ray;
    }
    n_wrong += memcmp(&footprints[at], &expected, sizeof expected) != 0;
    n_wrong += memcmp(&boxes[at], &e->projected.boxes[i], sizeof *boxes) != 0;
    n_wrong += memcmp(&surfaces[at], &e->projected.surfaces[i], sizeof *surfaces) != 0;
    n_wrong += conic_is_clipped(&expected) && memcmp(&clips[at], &e->projected.clips[i], sizeof *clips) != 0;
  }
  CHECK(n_wrong == 0);
  free(order);
  free(footprints);
  free(boxes);
  free(surfaces);
  free(rays);
  free(clips);
}

/* The blocks, along one axis, of a tile's n that the pixels begin … end - 1 meet; -1 where none. */
static int blocks_met(int begin, int end, int tile, int n) {
  int first = begin / 4 - n * tile, last = (end - 1) / 4 - n * tile;
  if (last < 0 || first >= n)
    return -1;
  return (first < 0 ? 0 : first) | (last >= n ? n - 1 : last) << 4;
}

/* Every tile's list has the splats whose boxes meet it, in file order, and which of its blocks they meet. */
static void check_lists(const expectation *e, const conic_frame *frame) {
  uint32_t *order = download(frame, CONIC_BUFFER_ORDER, frame->n_drawn, sizeof *order);
  uint64_t *begin = download(frame, CONIC_BUFFER_TILE_BEGIN, frame->n_tiles + (size_t)1, sizeof *begin);
  CHECK(begin[frame->n_tiles] == frame->n_references);
  conic_device_reference *lists = frame->n_references
                                      ? download(frame, CONIC_BUFFER_REFERENCES, frame->n_references, sizeof *lists)
                                      : zeroed(0, sizeof *lists);
  uint64_t at = 0;
  int n = frame->opencl->tile / 4;
  for (int tile = 0; tile < (int)frame->n_tiles; tile++) {
    CHECK(begin[tile] == at);
    for (size_t i = 0; i < frame->n_drawn; i++) {
      const conic_box *box = &e->projected.boxes[i];
      int columns = blocks_met(box->x_begin, box->x_end, tile % frame->constants.n_tiles_x, n);
      int rows = blocks_met(box->y_begin, box->y_end, tile / frame->constants.n_tiles_x, n);
      if (columns < 0 || rows < 0)
        continue;
      CHECK(at < frame->n_references);
      if (at < frame->n_references)
        CHECK(lists[at].footprint == order[i] && lists[at].blocks == (uint32_t)(columns | rows << 8));
      at++;
    }
  }
  CHECK(at == frame->n_references);
  free(order);
  free(begin);
  free(lists);
}

/* Those of whole tiles. */
static size_t n_padded_pixels(const conic_frame *frame) {
  return (size_t)frame->n_tiles * (size_t)frame->opencl->tile * (size_t)frame->opencl->tile;
}

/* Where a pixel's number lies in memory that is [block][stride][pixel]. */
static size_t place(const conic_frame *frame, int x, int y, size_t stride) {
  size_t block = (size_t)(y / 4) * (size_t)frame->constants.n_blocks_x + (size_t)(x / 4);
  return block * 16 * stride + (size_t)(x % 4 * 4 + y % 4);
}

static void check_thresholds(const expectation *e, const conic_frame *frame) {
  size_t n_wrong = 0;
  float *thresholds = download(frame, CONIC_BUFFER_THRESHOLDS, n_padded_pixels(frame), sizeof *thresholds);
  for (int y = 0; y < e->view.height; y++)
    for (int x = 0; x < e->view.width; x++)
      n_wrong += memcmp(&thresholds[place(frame, x, y, 1)], &e->thresholds[y * e->view.width + x], 4) != 0;
  CHECK(n_wrong == 0);
  CHECK(frame->n_fragments == e->n_fragments);
  free(thresholds);
}

static void check_sums_of(const expectation *e, const conic_frame *frame) {
  size_t n_wrong = 0, n_covered = 0;
  float *sums = download(frame, CONIC_BUFFER_SUMS, n_padded_pixels(frame) * CONIC_N_SUMS, sizeof *sums);
  for (int y = 0; y < e->view.height; y++)
    for (int x = 0; x < e->view.width; x++) {
      const float *expected = e->sums[y * e->view.width + x];
      n_covered += expected[CONIC_SUM_WEIGHT] > 0.0f;
      for (size_t i = 0; i < CONIC_N_SUMS; i++)
        n_wrong += memcmp(&sums[place(frame, x, y, CONIC_N_SUMS) + 16 * i], &expected[i], 4) != 0;
    }
  CHECK(n_wrong == 0);
  CHECK(n_covered > 100);
  free(sums);
}

static void check_stages(fixture *f, conic_opencl *opencl) {
  uint64_t n_covered = 0;
  int fits = 0;
  expectation *e = expect(f);
  conic_image image;
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
  conic_frame frame = {.opencl = opencl, .view = &e->view, .splats = &f->splats, .image = &image};
  opencl->keeps_sums = 1;
  CHECK_OK(conic_frame_begin(&frame));
  CHECK_OK(conic_frame_project(&frame, 0, f->splats.count));
  check_setup(e, &frame);
  CHECK_OK(conic_frame_bin(&frame, &fits));
  CHECK(fits);
  check_lists(e, &frame);
  CHECK_OK(conic_frame_visibility(&frame));
  check_thresholds(e, &frame);
  CHECK_OK(conic_frame_accumulate(&frame));
  check_sums_of(e, &frame);
  CHECK_OK(conic_frame_end(&frame, &n_covered));
  CHECK_OK(conic_frame_close(&frame));
  conic_image_release(f->context, &image);
  drop(e);
}

/* A device that holds few splats, and not always those: parts are made, and halved where their lists are too long. */
static void check_small_device(fixture *f, conic_opencl *opencl, uint64_t *state) {
  conic_image image;
  conic_view view;
  conic_render_statistics statistics;
  uint64_t real_bytes = opencl->device.greatest_buffer_bytes;
  fill(f, state, 1.0, 0.0);
  conic_render_options_init(&f->options);
  f->options.shading = CONIC_SHADE_NONE;
  f->options.near_z = 1e-3;
  f->options.splat_length = 0.01;
  fixture_render(f);
  const conic_finish_lights lights = {0};
  conic_finish finish = {.options = &f->options, .lights = &lights, .exposure = 1.0f};
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 0.01, &view));
  CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, ALL_PLANES, &image));
  memset(&statistics, 0, sizeof statistics);
  opencl->keeps_sums = 0;
  opencl->device.greatest_buffer_bytes = 400 * sizeof(conic_footprint);
  CHECK_OK(opencl->backend.draw(&opencl->backend, &view, &f->splats, NULL, &finish, &image, &statistics));
  CHECK(opencl_same(&f->image, &image, "a small device"));
  CHECK(statistics.splats_drawn == f->statistics.splats_drawn && statistics.fragments == f->statistics.fragments);
  opencl->device.greatest_buffer_bytes = sizeof(conic_footprint); /* not even the lists of one */
  CHECK(opencl->backend.draw(&opencl->backend, &view, &f->splats, NULL, &finish, &image, &statistics) ==
        CONIC_ERROR_MEMORY);
  opencl->device.greatest_buffer_bytes = real_bytes;
  conic_image_release(f->context, &image);
}

int main(void) {
  fixture f = fixture_open(1);
  uint64_t state = 3;
  opencl_need_device(f.context);
  fixture_camera(&f, 118, 90, 90.0);
  for (int work = CONIC_OPENCL_WORK_TILES; work <= CONIC_OPENCL_WORK_PIXELS; work++) {
    conic_opencl_options options;
    conic_opencl *opencl;
    conic_opencl_options_init(&options);
    options.work = (conic_opencl_work)work;
    CHECK_OK(conic_opencl_open(f.context, &options, &opencl));
    CHECK_OK(conic_opencl_need_splats(opencl));
    for (int number = 0; opencl && number < CONIC_N_METHODS * CONIC_N_KERNELS; number++) {
      fill(&f, &state, 2.0, number % 3 ? 0.01 : 0.0);
      if (number % 4 != 1)
        opencl_add_clips(&f, &state);
      choose(&f, number);
      check_stages(&f, opencl);
      opencl_drop_clips(&f);
    }
    if (opencl)
      check_small_device(&f, opencl, &state);
    conic_opencl_close(opencl);
  }
  fixture_close(&f);
  return check_result();
}
