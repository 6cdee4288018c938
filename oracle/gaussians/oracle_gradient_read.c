/* Gradients of other programs: .ply with the properties of scenes, and .npz. */

#include "core/files/file.h"
#include "core/files/mapping.h"
#include "core/files/numpy_array.h"
#include "core/files/zip.h"
#include "core/formats/ply_source.h"
#include "oracle/gaussians/oracle_gradient_job.h"

static int degree_of_harmonics(size_t n) {
  for (int degree = 0; degree <= CONIC_MAX_SH_DEGREE; degree++)
    if (n == (size_t)(degree + 1) * (size_t)(degree + 1))
      return degree;
  return -1;
}

/* --- .ply --- */

/* The column that a property goes to: from *column on, `stride` apart. */
typedef struct gradient_target {
  double *column;
  size_t stride;
} gradient_target;

/* The number behind a name's start, of two digits at most; -1: the name is another. */
static int number_behind(const char *name, const char *start) {
  const size_t length = strlen(start);
  int number = 0, n_digits = 0;
  if (strncmp(name, start, length) != 0)
    return -1;
  for (name += length; *name >= '0' && *name <= '9' && n_digits < 3; name++, n_digits++)
    number = 10 * number + (*name - '0');
  return *name == '\0' && n_digits >= 1 && n_digits <= 2 ? number : -1;
}

static gradient_target find_gradient_target(conic_gaussian_gradient *g, const char *name) {
  const size_t n_sh = (size_t)(g->sh_degree + 1) * (size_t)(g->sh_degree + 1), n_rest = n_sh - 1;
  int k;
  if (strlen(name) == 1 && name[0] >= 'x' && name[0] <= 'z')
    return (gradient_target){g->mean[name[0] - 'x'], 1};
  if ((k = number_behind(name, "f_dc_")) >= 0 && k < 3)
    return (gradient_target){g->sh + k, 3 * n_sh};
  if ((k = number_behind(name, "f_rest_")) >= 0 && (size_t)k < 3 * n_rest)
    return (gradient_target){g->sh + 3 * ((size_t)k % n_rest + 1) + (size_t)k / n_rest, 3 * n_sh};
  if ((k = number_behind(name, "scale_")) >= 0 && k < 3)
    return (gradient_target){g->scale[k], 1};
  if ((k = number_behind(name, "rot_")) >= 0 && k < 4)
    return (gradient_target){g->rotation[k], 1};
  if (strncmp(name, "place_", 6) == 0 && (name[6] == 'x' || name[6] == 'y') && name[7] == '\0')
    return (gradient_target){g->place[name[6] - 'x'], 1};
  return (gradient_target){strcmp(name, "opacity") == 0 ? g->opacity : NULL, 1};
}

static conic_status read_gradient_rows(conic_ply_source *source, const conic_ply_property *properties,
                                       const gradient_target *targets, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    status = conic_ply_begin_row(source);
    for (size_t k = 0; k < source->element->n_properties && status == CONIC_OK; k++) {
      double value;
      status = conic_ply_read_value(source, properties[k].type, &value);
      if (targets[k].column)
        targets[k].column[i * targets[k].stride] = value;
    }
    if (status == CONIC_OK)
      status = conic_ply_end_row(source);
  }
  return status;
}

/* The harmonics' degree by the properties' names; and what is there. */
static int find_gradient_kinds(const conic_ply_header *header, const conic_ply_element *rows, uint64_t *lacks) {
  static const char *const names[CONIC_N_GRADIENT_KINDS][4] = {{"x", "y", "z", "x"},
                                                               {"scale_0", "scale_1", "scale_1", "scale_1"},
                                                               {"rot_0", "rot_1", "rot_2", "rot_3"},
                                                               {"opacity", "opacity", "opacity", "opacity"},
                                                               {"f_dc_0", "f_dc_1", "f_dc_2", "f_dc_0"},
                                                               {"place_x", "place_y", "place_y", "place_y"}};
  size_t n_rest = 0;
  for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++)
    for (int k = 0; k < 4; k++)
      if (conic_ply_find_property(header, rows, names[kind][k]) < 0)
        *lacks |= (uint64_t)1 << kind;
  for (size_t k = 0; k < rows->n_properties; k++)
    n_rest += number_behind(header->properties[rows->first_property + k].name, "f_rest_") >= 0;
  return n_rest % 3 ? -1 : degree_of_harmonics(n_rest / 3 + 1);
}

static conic_status read_gradient_ply(conic_context *context, conic_input *input, const conic_ply_header *header,
                                      conic_gaussian_gradient *g) {
  const conic_ply_element *rows = conic_ply_find_element(header, "vertex");
  uint64_t lacks = 0;
  const int degree = rows ? find_gradient_kinds(header, rows, &lacks) : 0;
  if (!rows || rows != header->elements || rows->has_lists || degree < 0 ||
      lacks == (1u << CONIC_N_GRADIENT_KINDS) - 1u)
    return conic_fail(context, CONIC_ERROR_INPUT,
                      "%s: a gradient begins with the element vertex, of x, f_dc_0, opacity, scale_0, rot_0 … (line 1)",
                      input->name);
  conic_ply_source source = {.input = input, .format = header->format, .element = rows};
  conic_status status = conic_ply_begin_whole(&source, rows); /* which knows whether so many rows can follow */
  if (status == CONIC_OK)
    status = conic_oracle_gradient_room(context, (size_t)rows->count, degree, 1, g);
  gradient_target *targets = conic_memory_allocate(context, rows->n_properties, sizeof *targets);
  if (status == CONIC_OK && !targets)
    status = CONIC_ERROR_MEMORY;
  const conic_ply_property *properties = header->properties + rows->first_property;
  g->lacks = lacks;
  for (size_t k = 0; k < rows->n_properties && status == CONIC_OK; k++)
    targets[k] = find_gradient_target(g, properties[k].name);
  if (status == CONIC_OK)
    status = read_gradient_rows(&source, properties, targets, g->count);
  if (source.is_cut)
    status = conic_ply_tell_cut(&source, 0);
  conic_memory_release(context, targets);
  return status;
}

/* --- .npz --- */

static const char *const npz_names[CONIC_N_GRADIENT_KINDS] = {"means.npy",     "scales.npy", "quats.npy",
                                                              "opacities.npy", "sh.npy",     "means2d.npy"};

typedef struct gradient_arrays {
  unsigned char *blocks[CONIC_N_GRADIENT_KINDS];
  conic_numpy_array arrays[CONIC_N_GRADIENT_KINDS];
  size_t n, n_columns[CONIC_N_GRADIENT_KINDS]; /* of a row */
} gradient_arrays;

static conic_status open_gradient_array(conic_context *context, const conic_zip *zip, int kind, gradient_arrays *a) {
  size_t n_bytes;
  if (!conic_zip_has(zip, npz_names[kind]))
    return CONIC_OK;
  conic_status status = conic_zip_read(zip, npz_names[kind], CONIC_MOST_BYTES, &a->blocks[kind], &n_bytes);
  conic_numpy_array *array = &a->arrays[kind];
  if (status == CONIC_OK)
    status = conic_numpy_array_open(context, zip->name, npz_names[kind], a->blocks[kind], n_bytes, array);
  if (status != CONIC_OK)
    return status;
  size_t n = array->n_axes ? array->shape[0] : 0, columns = 1;
  for (int axis = 1; axis < array->n_axes; axis++)
    columns *= array->shape[axis];
  const int is_right = kind == CONIC_GRADIENT_SH        ? columns % 3 == 0 && degree_of_harmonics(columns / 3) >= 0
                       : kind == CONIC_GRADIENT_SCALE   ? columns == 2 || columns == 3
                       : kind == CONIC_GRADIENT_OPACITY ? columns == 1
                       : kind == CONIC_GRADIENT_PLACE   ? columns == 2
                                                        : columns == (kind == CONIC_GRADIENT_MEAN ? 3 : 4);
  if (!is_right || n == 0 || (a->n && a->n != n))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: %s has no shape of a gradient, or of other rows (at byte 0)",
                      zip->name, npz_names[kind]);
  a->n = n;
  a->n_columns[kind] = columns;
  return CONIC_OK;
}

static void take_gradient_arrays(const gradient_arrays *a, conic_gaussian_gradient *g) {
  double *const *const columns[CONIC_N_GRADIENT_KINDS] = {g->mean,     g->scale, g->rotation,
                                                          &g->opacity, &g->sh,   g->place};
  for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++) {
    const size_t n = a->n_columns[kind];
    if (n == 0)
      g->lacks |= (uint64_t)1 << kind;
    for (size_t i = 0; i < a->n * n; i++)
      if (kind == CONIC_GRADIENT_SH)
        g->sh[i] = conic_numpy_array_at(&a->arrays[kind], i);
      else
        columns[kind][i % n][i / n] = conic_numpy_array_at(&a->arrays[kind], i);
  }
}

static conic_status read_gradient_npz(conic_context *context, const char *path, conic_gaussian_gradient *g) {
  conic_mapping file;
  conic_zip zip;
  gradient_arrays a = {.n = 0};
  conic_status status = conic_mapping_open(context, path, &file);
  if (status != CONIC_OK)
    return status;
  status = conic_zip_open(context, path, file.bytes, file.n_bytes, &zip);
  for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS && status == CONIC_OK; kind++)
    status = open_gradient_array(context, &zip, kind, &a);
  if (status == CONIC_OK && a.n == 0)
    status = conic_fail(context, CONIC_ERROR_INPUT,
                        "%s: it has none of means, scales, quats, opacities, sh and means2d (at byte 0)", path);
  const size_t n_sh = a.n_columns[CONIC_GRADIENT_SH] / 3;
  if (status == CONIC_OK)
    status = conic_oracle_gradient_room(context, a.n, n_sh ? degree_of_harmonics(n_sh) : 0, 1, g);
  if (status == CONIC_OK)
    take_gradient_arrays(&a, g);
  for (int kind = 0; kind < CONIC_N_GRADIENT_KINDS; kind++)
    conic_memory_release(context, a.blocks[kind]);
  conic_mapping_close(context, &file);
  return status;
}

conic_status conic_gaussian_gradient_read(conic_context *context, const char *path, conic_gaussian_gradient *gradient) {
  conic_input input;
  conic_ply_header header;
  memset(gradient, 0, sizeof *gradient);
  conic_status status;
  if (conic_file_begins_with(path, "PK\3\4", 4))
    status = read_gradient_npz(context, path, gradient);
  else {
    status = conic_input_open(context, path, &input);
    if (status != CONIC_OK)
      return status;
    status = conic_ply_header_read(&input, &header);
    if (status == CONIC_OK) {
      status = read_gradient_ply(context, &input, &header, gradient);
      conic_ply_header_release(context, &header);
    }
    conic_input_close(&input);
  }
  if (status != CONIC_OK)
    conic_gaussian_gradient_release(context, gradient);
  return status;
}
