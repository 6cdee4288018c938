/* Pictures of cameras that see everything from one eye: each sample takes the pixel that its ray goes through, from the
 * sides of a cube or from one wide view. */

#include "core/base/vectors.h"
#include "core/image/image_common.h"
#include "gathering/gather_views.h"
#include "raster/frame/samples.h"

/* So many samples, or one row of pixels, are looked up at a time; a view with more pixels than the second is
 * refused. */
enum { BAND_SAMPLES = 1 << 22, MOST_VIEW_PIXELS = 1 << 28 };
enum { NO_SIDE = 255 };

/* One view may replace up to three sides of a cube, each of which has 4 square units at the distance 1. */
static const double widest_area = 12.0;

/* Where a sample's ray meets a view: in the plane at the depth 1. */
typedef struct gather_place {
  float at[2];
} gather_place;

/* The wanted places of a side. */
typedef struct gather_box {
  float low[2], high[2];
} gather_box;

typedef struct gather_band {
  const conic_gathering *g;
  conic_camera_rays rays;
  int is_one_view;        /* else sides of a cube */
  double pixels_per_unit; /* of the views, at the depth 1 */
  size_t first_row, n_rows, width, samples;
  unsigned char *side; /* of each sample, or NO_SIDE */
  gather_place *place;
  gather_box *boxes; /* of each side, for each row of samples */
  conic_image *fine; /* the band's samples; with one a pixel, the picture itself */
  /* the current view */
  int i_side;
  long left, top; /* its first pixel in the side's grid */
  const conic_image *view;
} gather_band;

/* --- rays --- */

/* The direction, from the eye's place on the lens, to what is in focus at a place; returns 0 where there is none. */
static int ray_of_place(const gather_band *b, double x_px, double y_px, double direction[3]) {
  const conic_gather_options *o = b->g->options;
  double origin[3];
  if (!conic_camera_ray(&b->rays, x_px, y_px, origin, direction))
    return 0;
  for (int axis = 0; axis < 3 && o->focus > 0.0; axis++)
    direction[axis] = o->focus * direction[axis] - o->lens[axis];
  return 1;
}

static int side_of_ray(const double d[3]) {
  static const unsigned char sides[3][2] = {{1, 0}, {3, 2}, {4, 5}}; /* by axis; the second for negative directions */
  int axis = fabs(d[1]) > fabs(d[0]) ? 1 : 0;
  axis = fabs(d[2]) >= fabs(d[axis]) ? 2 : axis;
  return sides[axis][d[axis] < 0.0];
}

/* The side that the ray of a place goes through, and where it does. */
static int find_view_place(const gather_band *b, double x_px, double y_px, double at[2]) {
  double d[3];
  if (!ray_of_place(b, x_px, y_px, d))
    return NO_SIDE;
  int side = b->is_one_view ? CONIC_CUBE_FORWARD : side_of_ray(d);
  double depth = conic_dot(conic_cube_sides[side][2], d);
  if (!(depth > 0.0))
    return NO_SIDE;
  for (int axis = 0; axis < 2; axis++)
    at[axis] = conic_dot(conic_cube_sides[side][axis], d) / depth;
  return side;
}

/* --- how fine, and how many --- */

enum { PROBES = 32 };

static double step_between(const double a[2], const double b[2]) {
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]));
}

/* The larger edge of a pixel at a place, in the side's plane; infinite where there is no ray. */
static double view_pixel_at(const gather_band *b, double x, double y) {
  double here[2], right[2], below[2];
  int side = find_view_place(b, x, y, here);
  if (side == NO_SIDE || find_view_place(b, x + 1.0, y, right) != side || find_view_place(b, x, y + 1.0, below) != side)
    return HUGE_VAL;
  double across = step_between(here, right), down = step_between(here, below);
  return across > down ? across : down;
}

/* Checks places all over the picture: whether one view is enough, and how small the smallest pixel is. */
static conic_status plan_views(gather_band *b) {
  const conic_gather_options *o = b->g->options;
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL}, finest = HUGE_VAL;
  int is_wide = 0;
  for (int i = 0; i <= PROBES; i++)
    for (int j = 0; j <= PROBES; j++) {
      double d[3];
      if (!ray_of_place(b, (double)o->camera.width * j / PROBES, (double)o->camera.height * i / PROBES, d))
        continue;
      is_wide |= !(d[2] > 0.0);
      for (int axis = 0; axis < 2 && d[2] > 0.0; axis++) {
        low[axis] = fmin(low[axis], d[axis] / d[2]);
        high[axis] = fmax(high[axis], d[axis] / d[2]);
      }
    }
  b->is_one_view = !is_wide && (high[0] - low[0]) * (high[1] - low[1]) <= widest_area;
  for (int i = 0; i <= PROBES; i++)
    for (int j = 0; j <= PROBES; j++)
      finest = fmin(finest, view_pixel_at(b, (double)(o->camera.width - 1) * j / PROBES,
                                          (double)(o->camera.height - 1) * i / PROBES));
  b->pixels_per_unit = o->fineness * o->samples / finest;
  return finest > 0.0 ? CONIC_OK
                      : conic_fail(b->g->context, CONIC_ERROR_ARGUMENT,
                                   "gather: the camera's pixels are too small to be drawn one by one");
}

/* --- looking up --- */

static void widen_box(gather_box *box, const float at[2]) {
  for (int axis = 0; axis < 2; axis++)
    CONIC_WIDEN(box->low[axis], box->high[axis], at[axis], at[axis]);
}

static void look_up_row(void *data, size_t i_row) {
  const gather_band *b = data;
  gather_box *boxes = b->boxes + i_row * CONIC_CUBE_SIDES;
  double step = 1.0 / (double)b->samples;
  double y = ((double)(b->first_row * b->samples + i_row) + 0.5) * step;
  for (int i = 0; i < CONIC_CUBE_SIDES; i++)
    boxes[i] = (gather_box){{HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF}};
  for (size_t x = 0; x < b->width; x++) {
    size_t i = i_row * b->width + x;
    double at[2] = {0.0, 0.0};
    int side = find_view_place(b, ((double)x + 0.5) * step, y, at);
    b->side[i] = (unsigned char)side;
    for (int axis = 0; axis < 2; axis++)
      b->place[i].at[axis] = (float)at[axis];
    if (side != NO_SIDE)
      widen_box(&boxes[side], b->place[i].at);
  }
}

/* A place's pixel in the side's grid. */
static long grid_pixel(const gather_band *b, int axis, float at) {
  return (long)floor((double)at * b->pixels_per_unit + b->g->options->shift[axis]);
}

/* The factor of a view's depths: the distance to the pixel's middle over its depth in the view. */
static double depth_factor(const gather_band *b, long column, long row) {
  const conic_gather_options *o = b->g->options;
  const double(*side)[3] = conic_cube_sides[b->i_side];
  const double at[2] = {((double)column + 0.5 - o->shift[0]) / b->pixels_per_unit,
                        ((double)row + 0.5 - o->shift[1]) / b->pixels_per_unit};
  double there[3];
  for (int axis = 0; axis < 3; axis++)
    there[axis] = (at[0] * side[0][axis] + at[1] * side[1][axis]) + side[2][axis];
  return o->camera.kind == CONIC_CAMERA_PERSPECTIVE && there[2] > 0.0 ? there[2] : conic_length(there);
}

static void gather_pixel(const gather_band *b, size_t from, size_t to, double factor) {
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    size_t n = (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    if (!b->fine->planes[i])
      continue;
    float *there = (float *)b->fine->planes[i] + to * n;
    memcpy(there, (const float *)b->view->planes[i] + from * n, n * sizeof *there);
    if (conic_gather_is_depth((conic_plane)i))
      *there = (float)(i == CONIC_PLANE_INVERSE_Z ? (double)*there / factor : (double)*there * factor);
  }
}

static void gather_row(void *data, size_t i_row) {
  const gather_band *b = data;
  size_t fine_row = b->fine == b->g->image ? b->first_row + i_row : i_row;
  for (size_t x = 0; x < b->width; x++) {
    size_t i = i_row * b->width + x;
    if (b->side[i] != b->i_side)
      continue;
    long column = grid_pixel(b, 0, b->place[i].at[0]), row = grid_pixel(b, 1, b->place[i].at[1]);
    size_t from = (size_t)(row - b->top) * (size_t)b->view->width + (size_t)(column - b->left);
    gather_pixel(b, from, fine_row * b->width + x, depth_factor(b, column, row));
  }
}

/* Clears samples whose camera sees no direction. */
static void empty_row(void *data, size_t i_row) {
  const gather_band *b = data;
  size_t fine_row = b->fine == b->g->image ? b->first_row + i_row : i_row;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    const conic_plane_description *plane = conic_plane_describe((conic_plane)i);
    size_t n = (size_t)plane->n_channels;
    int is_id = i == CONIC_PLANE_ID || i == CONIC_PLANE_CLUSTER || i == CONIC_PLANE_LAST;
    for (size_t x = 0; x < b->width && b->fine->planes[i]; x++) {
      uint32_t *there = (uint32_t *)b->fine->planes[i] + (fine_row * b->width + x) * n;
      if (b->side[i_row * b->width + x] != NO_SIDE)
        continue;
      memset(there, is_id ? 0xff : 0, n * sizeof *there);
      if (i == CONIC_PLANE_RGBA)
        memcpy(there, b->g->options->empty, sizeof b->g->options->empty);
    }
  }
}

/* --- views --- */

static conic_status draw_side(gather_band *b, const gather_box *box) {
  const conic_gather_options *o = b->g->options;
  conic_image image = {0};
  long right = grid_pixel(b, 0, box->high[0]) + 1, bottom = grid_pixel(b, 1, box->high[1]) + 1;
  b->left = grid_pixel(b, 0, box->low[0]);
  b->top = grid_pixel(b, 1, box->low[1]);
  double width = (double)right - (double)b->left, height = (double)bottom - (double)b->top;
  if (width > CONIC_IMAGE_MAX_SIZE || height > CONIC_IMAGE_MAX_SIZE || width * height > MOST_VIEW_PIXELS)
    return conic_fail(b->g->context, CONIC_ERROR_ARGUMENT,
                      "gather: a view of %.0f x %.0f pixels is too large; the lens distorts too much for the picture's "
                      "size",
                      width, height);
  static const double at_eye[3];
  conic_gather_view view = {
      .camera = conic_gather_side_camera(&o->camera, conic_cube_sides[b->i_side], o->focus > 0.0 ? o->lens : at_eye),
      .near_z = o->near_z,
      .samples = 1};
  view.camera.width = (int)width;
  view.camera.height = (int)height;
  view.camera.fx = view.camera.fy = b->pixels_per_unit;
  view.camera.cx = o->shift[0] - (double)b->left;
  view.camera.cy = o->shift[1] - (double)b->top;
  conic_status status = conic_gather_draw(b->g, &view, &image);
  b->view = &image;
  if (status == CONIC_OK)
    conic_parallel_for(b->g->context, b->n_rows * b->samples, gather_row, b);
  conic_image_release(b->g->context, &image);
  b->view = NULL;
  return status;
}

static conic_status gather_band_rows(gather_band *b) {
  size_t n_fine_rows = b->n_rows * b->samples;
  conic_status status = CONIC_OK;
  conic_parallel_for(b->g->context, n_fine_rows, look_up_row, b);
  for (b->i_side = 0; b->i_side < CONIC_CUBE_SIDES && status == CONIC_OK; b->i_side++) {
    gather_box box = b->boxes[b->i_side];
    for (size_t row = 1; row < n_fine_rows; row++) {
      const gather_box *other = &b->boxes[row * CONIC_CUBE_SIDES + (size_t)b->i_side];
      for (int axis = 0; axis < 2; axis++)
        CONIC_WIDEN(box.low[axis], box.high[axis], other->low[axis], other->high[axis]);
    }
    if (box.low[0] <= box.high[0])
      status = draw_side(b, &box);
  }
  if (status != CONIC_OK)
    return status;
  conic_parallel_for(b->g->context, n_fine_rows, empty_row, b);
  if (b->fine != b->g->image)
    conic_samples_reduce(b->g->context, b->fine, (int)b->samples, 0, (int)b->first_row, b->g->image);
  return CONIC_OK;
}

/* For as many rows as a band has, or fewer at the end. */
static conic_status allocate_band(gather_band *b, size_t n_rows, conic_image *fine) {
  conic_context *context = b->g->context;
  size_t n_fine_rows = n_rows * b->samples, n = n_fine_rows * b->width;
  if (conic_memory_allocate_these(context, CONIC_ROOM(b->side, n), CONIC_ROOM(b->place, n),
                                  CONIC_ROOM(b->boxes, CONIC_CUBE_SIDES * n_fine_rows)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  return b->samples == 1
             ? CONIC_OK
             : conic_samples_allocate(context, (int)b->width, (int)n_fine_rows, conic_image_planes(b->g->image), fine);
}

conic_status conic_gather_central(const conic_gathering *g) {
  const conic_gather_options *o = g->options;
  size_t height = (size_t)o->camera.height, samples = (size_t)o->samples;
  gather_band b = {.g = g, .samples = samples, .width = (size_t)o->camera.width * samples};
  size_t n_rows = BAND_SAMPLES / (b.width * samples);
  conic_image fine = {0};
  n_rows = n_rows < 1 ? 1 : n_rows > height ? height : n_rows;
  conic_camera_rays_init(&o->camera, &b.rays);
  if (samples > 1 && conic_image_planes(g->image) & ~conic_samples_planes())
    return conic_fail(g->context, CONIC_ERROR_ARGUMENT,
                      "gather: of several samples, some planes cannot be made one; draw one sample a pixel");
  conic_status status = plan_views(&b);
  if (status == CONIC_OK)
    status = allocate_band(&b, n_rows, &fine);
  b.fine = samples == 1 ? g->image : &fine;
  for (b.first_row = 0; b.first_row < height && status == CONIC_OK; b.first_row += n_rows) {
    b.n_rows = b.first_row + n_rows < height ? n_rows : height - b.first_row;
    fine.height = (int)(b.n_rows * samples);
    status = gather_band_rows(&b);
  }
  conic_image_release(g->context, &fine);
  conic_memory_release_these(g->context, b.boxes, b.place, b.side);
  return status;
}
