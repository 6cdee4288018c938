/* An .npz of view matrices, as gsplat takes them: viewmats (n, 4, 4), Ks (n, 3, 3), width and height. */

#include "core/cameras/camera_list.h"
#include "core/files/numpy_array.h"
#include "core/files/zip.h"

typedef enum npz_part { VIEW_MATRICES, INTRINSICS, WIDTHS, HEIGHTS, N_PARTS } npz_part;

typedef struct npz_reader {
  conic_camera_list *list;
  const char *names[N_PARTS]; /* null: not there */
  unsigned char *blocks[N_PARTS];
  conic_numpy_array arrays[N_PARTS];
  size_t n;
} npz_reader;

static const size_t most_array_bytes = (size_t)1 << 28;

static conic_status open_npz_part(npz_reader *reader, const conic_zip *zip, int part) {
  static const char *const names[N_PARTS][3] = {{"viewmats.npy", "viewmat.npy", NULL},
                                                {"Ks.npy", "K.npy", NULL},
                                                {"width.npy", "widths.npy", NULL},
                                                {"height.npy", "heights.npy", NULL}};
  size_t n;
  for (int i = 0; names[part][i] && !reader->names[part]; i++)
    if (conic_zip_has(zip, names[part][i]))
      reader->names[part] = names[part][i];
  const char *name = reader->names[part];
  if (!name && part <= INTRINSICS)
    return conic_fail(reader->list->context, CONIC_ERROR_INPUT,
                      "%s: it has no %s; cameras are viewmats and Ks (at byte 0)", reader->list->name, names[part][0]);
  if (!name)
    return CONIC_OK;
  conic_status status = conic_zip_read(zip, name, most_array_bytes, &reader->blocks[part], &n);
  return status == CONIC_OK ? conic_numpy_array_open(reader->list->context, reader->list->name, name,
                                                     reader->blocks[part], n, &reader->arrays[part])
                            : status;
}

/* Whether an array holds `n` items of such a shape, or one for all; n = 0 is replaced by the number found. */
static int has_npz_shape(const conic_numpy_array *array, size_t *n, size_t rows, size_t columns) {
  int n_axes = (rows > 0) + (columns > 0), first = array->n_axes - n_axes;
  if (first < 0 || first > 1 || (rows && array->shape[first] != rows) ||
      (columns && array->shape[array->n_axes - 1] != columns))
    return 0;
  size_t found = first ? array->shape[0] : 1;
  if (*n == 0)
    *n = found;
  return found > 0 && (found == *n || found == 1);
}

static conic_status check_npz_shapes(npz_reader *reader) {
  const conic_numpy_array *arrays = reader->arrays;
  conic_context *context = reader->list->context;
  const char *file = reader->list->name;
  if (!has_npz_shape(&arrays[VIEW_MATRICES], &reader->n, 4, 4) &&
      (reader->n = 0, !has_npz_shape(&arrays[VIEW_MATRICES], &reader->n, 3, 4)))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s is of the shape (n, 4, 4) (at byte 0)", file,
                      reader->names[0]);
  int is_list = arrays[INTRINSICS].n_axes == 1; /* fx, fy, cx, cy */
  if (!(is_list ? arrays[INTRINSICS].shape[0] == 4 : has_npz_shape(&arrays[INTRINSICS], &reader->n, 3, 3)))
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: %s is of the shape (n, 3, 3), as many as there are %s (at byte 0)", file,
                      reader->names[INTRINSICS], reader->names[VIEW_MATRICES]);
  if (!reader->names[WIDTHS] != !reader->names[HEIGHTS])
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: it has one of width and height (at byte 0)", file);
  for (int part = WIDTHS; part <= HEIGHTS; part++)
    if (reader->names[part] && !has_npz_shape(&arrays[part], &reader->n, 0, 0))
      return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s is one number, or as many as there are %s (at byte 0)",
                        file, reader->names[part], reader->names[VIEW_MATRICES]);
  return CONIC_OK;
}

/* The numbers of view i. */
static void take_npz_numbers(const conic_numpy_array *array, size_t i, size_t n_numbers, double *numbers) {
  size_t n = 1;
  for (int axis = 0; axis < array->n_axes; axis++)
    n *= array->shape[axis];
  for (size_t k = 0; k < n_numbers; k++)
    numbers[k] = conic_numpy_array_at(array, (n == n_numbers ? 0 : i * n_numbers) + k);
}

static const char *take_intrinsics(const conic_numpy_array *array, size_t i, conic_camera *camera) {
  double k[9];
  if (array->n_axes == 1) {
    take_npz_numbers(array, 0, 4, k);
    camera->fx = k[0];
    camera->fy = k[1];
    camera->cx = k[2];
    camera->cy = k[3];
    return NULL;
  }
  take_npz_numbers(array, i, 9, k);
  camera->fx = k[0];
  camera->cx = k[2];
  camera->fy = k[4];
  camera->cy = k[5];
  if (k[1] != 0.0 || k[3] != 0.0)
    return "K has a skew, which is not drawn";
  return k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0 ? "the last row of K is 0 0 1" : NULL;
}

static const char *take_view_matrix(const conic_numpy_array *array, size_t i, conic_camera *camera) {
  static const double last[4] = {0.0, 0.0, 0.0, 1.0};
  size_t n_rows = array->shape[array->n_axes - 2];
  double m[16];
  take_npz_numbers(array, i, 4 * n_rows, m);
  memcpy(camera->cam_from_world, m, sizeof camera->cam_from_world);
  for (int k = 0; k < 4 && n_rows == 4; k++)
    if (m[12 + k] != last[k])
      return "the last row of its view matrix is 0 0 0 1";
  return NULL;
}

static conic_status add_npz_camera(npz_reader *reader, size_t i) {
  conic_camera camera = {.width = 0};
  double size[2] = {0.0, 0.0};
  const char *wrong = take_view_matrix(&reader->arrays[VIEW_MATRICES], i, &camera);
  if (!wrong)
    wrong = take_intrinsics(&reader->arrays[INTRINSICS], i, &camera);
  if (wrong)
    return conic_camera_list_wrong(reader->list, wrong);
  for (int axis = 0; axis < 2 && reader->names[WIDTHS]; axis++)
    take_npz_numbers(&reader->arrays[WIDTHS + axis], i, 1, &size[axis]);
  camera.width = conic_camera_pixels(size[0]);
  camera.height = conic_camera_pixels(size[1]);
  conic_status status = CONIC_OK;
  if (!reader->names[WIDTHS])
    status = conic_camera_list_size(reader->list, NULL, &camera.width, &camera.height);
  return status == CONIC_OK ? conic_camera_list_add(reader->list, &camera, "", 0) : status;
}

conic_status conic_camera_numpy_read(conic_camera_list *list, const unsigned char *bytes, size_t n_bytes) {
  npz_reader reader = {.list = list};
  conic_zip zip;
  list->cameras->kind = CONIC_CAMERA_FILE_NUMPY;
  conic_status status = conic_zip_open(list->context, list->name, bytes, n_bytes, &zip);
  for (int part = 0; part < N_PARTS && status == CONIC_OK; part++)
    status = open_npz_part(&reader, &zip, part);
  if (status == CONIC_OK)
    status = check_npz_shapes(&reader);
  for (size_t i = 0; i < reader.n && status == CONIC_OK; i++)
    status = add_npz_camera(&reader, i);
  for (int part = 0; part < N_PARTS; part++)
    conic_memory_release(list->context, reader.blocks[part]);
  return status;
}
