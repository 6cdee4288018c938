/* Intermediates as an .npz, and as a table. */

#include "core/base/byte_order.h"
#include "core/files/file.h"
#include "core/files/numpy_array.h"
#include "core/files/zip.h"
#include "oracle/gaussians/oracle_intermediates.h"

typedef struct npz_writer {
  conic_context *context;
  conic_zip_writer zip;
  conic_status status;
} npz_writer;

typedef enum number_type { DOUBLES, WHOLE_DOUBLES, INTS, LONGS } number_type;

/* Adds an array of (rows, columns) numbers, or of (rows) where there are no columns. */
static void add_array(npz_writer *w, const char *name, const char *behind, const void *numbers, number_type type,
                      size_t rows, size_t columns) {
  static const char *const types[] = {[DOUBLES] = "<f8", [WHOLE_DOUBLES] = "<i4", [INTS] = "<i4", [LONGS] = "<i8"};
  const size_t shape[2] = {rows, columns}, n = rows * (columns ? columns : 1);
  const size_t n_bytes = type == DOUBLES || type == LONGS ? 8 : 4;
  char file[40];
  unsigned char *bytes =
      w->status == CONIC_OK ? conic_memory_allocate(w->context, n * n_bytes + CONIC_NUMPY_HEAD, 1) : NULL;
  if (!bytes) {
    w->status = w->status == CONIC_OK ? CONIC_ERROR_MEMORY : w->status;
    return;
  }
  conic_numpy_head(types[type], shape, columns ? 2 : 1, bytes);
  for (size_t i = 0; i < n; i++) {
    unsigned char *to = bytes + CONIC_NUMPY_HEAD + i * n_bytes;
    if (type == DOUBLES)
      conic_store_double(to, ((const double *)numbers)[i]);
    else if (type == WHOLE_DOUBLES)
      conic_store_32(to, (uint32_t)oracle_min(oracle_max(((const double *)numbers)[i], 0.0), INT32_MAX));
    else if (type == INTS)
      conic_store_32(to, (uint32_t)((const int32_t *)numbers)[i]);
    else
      conic_store_64(to, (uint64_t)((const int64_t *)numbers)[i]);
  }
  snprintf(file, sizeof file, "%s%s.npy", name, behind);
  conic_zip_add(&w->zip, file, bytes, n * n_bytes + CONIC_NUMPY_HEAD);
  conic_memory_release(w->context, bytes);
}

static int is_whole(int kind) {
  return kind == CONIC_INTERMEDIATE_RADII || kind == CONIC_INTERMEDIATE_TILE_BOXES ||
         kind == CONIC_INTERMEDIATE_TILES_PER_GAUSS;
}

static conic_status write_npz(conic_context *context, FILE *to, const conic_gaussian_intermediates *found) {
  npz_writer *w = conic_memory_allocate_zeroed(context, 1, sizeof *w);
  if (!w)
    return CONIC_ERROR_MEMORY;
  *w = (npz_writer){.context = context, .zip = {.to = to}};
  for (int kind = 0; kind < CONIC_N_INTERMEDIATES; kind++) {
    const conic_intermediate_array *a = &found->arrays[kind];
    const char *name = conic_intermediate_name((conic_intermediate)kind);
    const size_t columns = a->n_columns > 1 ? (size_t)a->n_columns : 0;
    if (!a->n_columns)
      continue;
    add_array(w, name, "", a->value, is_whole(kind) ? WHOLE_DOUBLES : DOUBLES, found->count, columns);
    add_array(w, name, "_low", a->low, DOUBLES, found->count, columns);
    add_array(w, name, "_high", a->high, DOUBLES, found->count, columns);
  }
  if (found->tile_width) {
    add_array(w, "isect_ids", "", found->isect_ids, LONGS, found->n_isects, 0);
    add_array(w, "flatten_ids", "", found->flatten_ids, INTS, found->n_isects, 0);
    add_array(w, "isect_offsets", "", found->isect_offsets, INTS, (size_t)found->tile_height,
              (size_t)found->tile_width);
  }
  conic_status status = w->status;
  if (!conic_zip_end(&w->zip) && status == CONIC_OK)
    status = conic_fail(context, CONIC_ERROR_IO, "the .npz cannot be written, or would be larger than 4 GiB");
  conic_memory_release(context, w);
  return status;
}

static void print_names(FILE *to, const char *name, int column, int n_columns) {
  static const char *const behind[] = {"", "_low", "_high"};
  for (int k = 0; k < 3; k++)
    if (n_columns > 1)
      fprintf(to, ",%s_%d%s", name, column, behind[k]);
    else
      fprintf(to, ",%s%s", name, behind[k]);
}

static conic_status write_table(conic_context *context, FILE *to, const conic_gaussian_intermediates *found) {
  conic_status status = CONIC_OK;
  fputs("gaussian", to);
  for (int kind = 0; kind < CONIC_N_INTERMEDIATES; kind++)
    for (int k = 0; k < found->arrays[kind].n_columns; k++)
      print_names(to, conic_intermediate_name((conic_intermediate)kind), k, found->arrays[kind].n_columns);
  fputc('\n', to);
  for (size_t i = 0; i < found->count && status == CONIC_OK; i++) {
    fprintf(to, "%zu", i);
    for (int kind = 0; kind < CONIC_N_INTERMEDIATES; kind++) {
      const conic_intermediate_array *a = &found->arrays[kind];
      for (size_t at = i * (size_t)a->n_columns; at < (i + 1) * (size_t)a->n_columns; at++)
        fprintf(to, ",%.9g,%.9g,%.9g", a->value[at], a->low[at], a->high[at]);
    }
    fputc('\n', to);
    if (i % 4096 == 0)
      status = conic_progress(context, "write", (double)i / (double)found->count);
  }
  return status;
}

conic_status conic_gaussian_intermediates_write(conic_context *context, const char *path,
                                                const conic_gaussian_intermediates *found) {
  const size_t n = strlen(path);
  const int is_table = n >= 4 && strcmp(path + n - 4, ".csv") == 0;
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  status = (is_table ? write_table : write_npz)(context, conic_output_stream(output), found);
  return conic_output_end(output, status);
}
