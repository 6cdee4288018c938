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

/* Adds an array of (rows, columns) numbers, or of (rows) where a row has one: doubles, or else whole numbers. */
static void add_array(npz_writer *w, const char *name, const char *behind, const double *doubles,
                      const int64_t *integers, size_t rows, size_t columns) {
  const size_t shape[2] = {rows, columns}, n = rows * columns, n_bytes = 8 * n + CONIC_NUMPY_HEAD;
  char file[40];
  unsigned char *bytes = conic_memory_allocate(w->context, n_bytes, 1);
  if (!bytes) {
    w->status = CONIC_ERROR_MEMORY;
    return;
  }
  conic_numpy_head(doubles ? "<f8" : "<i8", shape, columns > 1 ? 2 : 1, bytes);
  for (size_t i = 0; i < n && doubles; i++)
    conic_store_64(bytes + CONIC_NUMPY_HEAD + 8 * i, conic_bits_of_double(doubles[i]));
  for (size_t i = 0; i < n && integers; i++)
    conic_store_64(bytes + CONIC_NUMPY_HEAD + 8 * i, (uint64_t)integers[i]);
  snprintf(file, sizeof file, "%s%s.npy", name, behind);
  conic_zip_add(&w->zip, file, bytes, n_bytes);
  conic_memory_release(w->context, bytes);
}

static conic_status write_npz(conic_context *context, FILE *to, const conic_gaussian_intermediates *found) {
  npz_writer *w = conic_memory_allocate_zeroed(context, 1, sizeof *w);
  if (!w)
    return CONIC_ERROR_MEMORY;
  *w = (npz_writer){.context = context, .zip = {.to = to}};
  for (int kind = 0; kind < CONIC_N_INTERMEDIATES; kind++) {
    const conic_intermediate_array *a = &found->arrays[kind];
    const char *name = conic_intermediate_name((conic_intermediate)kind);
    const size_t columns = (size_t)a->n_columns;
    if (!columns)
      continue;
    add_array(w, name, "", a->value, NULL, found->count, columns);
    add_array(w, name, "_low", a->low, NULL, found->count, columns);
    add_array(w, name, "_high", a->high, NULL, found->count, columns);
  }
  if (found->tile_width) {
    add_array(w, "isect_ids", "", NULL, found->isect_ids, found->n_isects, 1);
    add_array(w, "flatten_ids", "", NULL, found->flatten_ids, found->n_isects, 1);
    add_array(w, "isect_offsets", "", NULL, found->isect_offsets, (size_t)found->tile_height,
              (size_t)found->tile_width);
  }
  conic_status status = w->status;
  if (!conic_zip_end(&w->zip) && status == CONIC_OK)
    status = conic_fail(context, CONIC_ERROR_IO, "the .npz cannot be written, or would be larger than 4 GiB");
  conic_memory_release(context, w);
  return status;
}

/* The columns of the table, or, with a Gaussian, its line. */
static void print_line(FILE *to, const conic_gaussian_intermediates *found, const size_t *gaussian) {
  for (int kind = 0; kind < CONIC_N_INTERMEDIATES; kind++)
    for (int k = 0; k < found->arrays[kind].n_columns; k++) {
      const conic_intermediate_array *a = &found->arrays[kind];
      const char *name = conic_intermediate_name((conic_intermediate)kind);
      const size_t at = gaussian ? *gaussian * (size_t)a->n_columns + (size_t)k : 0;
      if (gaussian)
        fprintf(to, ",%.9g,%.9g,%.9g", a->value[at], a->low[at], a->high[at]);
      else
        fprintf(to, ",%s_%d,%s_%d_low,%s_%d_high", name, k, name, k, name, k);
    }
  fputc('\n', to);
}

static conic_status write_table(conic_context *context, FILE *to, const conic_gaussian_intermediates *found) {
  conic_status status = CONIC_OK;
  fputs("gaussian", to);
  print_line(to, found, NULL);
  for (size_t i = 0; i < found->count && status == CONIC_OK; i++) {
    fprintf(to, "%zu", i);
    print_line(to, found, &i);
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
