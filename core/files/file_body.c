#include "core/files/file_body.h"

#include <stdio.h>

#include "core/base/message.h"
#include "core/base/threads.h"
#include "core/files/file.h"

enum { ALIGNMENT = 64, MOST_AT_ONCE = 1 << 24 };

void conic_file_add_array(conic_file_layout *layout, size_t n_bytes) {
  layout->arrays[layout->n++] = (conic_file_array){layout->n_bytes, n_bytes};
  layout->n_bytes = (layout->n_bytes + n_bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

void conic_file_list_arrays(const conic_file_layout *layout, const unsigned char *bytes,
                            const void *arrays[CONIC_FILE_MOST_ARRAYS]) {
  for (int i = 0; i < layout->n; i++)
    arrays[i] = bytes + layout->arrays[i].offset;
}

typedef struct sum_job {
  const conic_file_layout *layout;
  const void *const *arrays;
  uint64_t sums[CONIC_FILE_MOST_ARRAYS];
} sum_job;

static void sum_task(void *data, size_t i, int i_thread) {
  sum_job *job = data;
  (void)i_thread;
  job->sums[i] = conic_checksum(job->arrays[i], job->layout->arrays[i].n_bytes);
}

uint64_t conic_file_sum_arrays(conic_context *context, const conic_file_layout *layout, const void *const *arrays) {
  sum_job job = {.layout = layout, .arrays = arrays};
  unsigned char bytes[8 * CONIC_FILE_MOST_ARRAYS];
  size_t n = (size_t)layout->n;
  if (context)
    conic_parallel_for(context, n, sum_task, &job);
  for (size_t i = 0; i < n; i++) {
    if (!context)
      sum_task(&job, i, 0);
    conic_file_put(bytes + 8 * i, 8, job.sums[i]);
  }
  return conic_checksum(bytes, 8 * n);
}

/* Where what follows the array begins. */
static size_t end_of_array(const conic_file_layout *layout, int i) {
  return i + 1 < layout->n ? layout->arrays[i + 1].offset : layout->n_bytes;
}

static conic_status write_array(conic_context *context, const conic_file_layout *layout, int i,
                                const unsigned char *bytes, FILE *stream) {
  static const unsigned char zeros[ALIGNMENT];
  size_t begin = layout->arrays[i].offset, n_bytes = layout->arrays[i].n_bytes;
  conic_status status = CONIC_OK;
  for (size_t at = 0, n; at < n_bytes && status == CONIC_OK && !ferror(stream); at += n) {
    n = n_bytes - at < MOST_AT_ONCE ? n_bytes - at : MOST_AT_ONCE;
    fwrite(bytes + at, 1, n, stream);
    status = conic_progress(context, "write", (double)(begin + at + n) / (double)layout->n_bytes);
  }
  fwrite(zeros, 1, end_of_array(layout, i) - begin - n_bytes, stream);
  return status;
}

conic_status conic_file_write_arrays(conic_context *context, const char *path, const conic_file_kind *kind,
                                     const void *numbers, const conic_file_layout *layout, const void *const *arrays) {
  unsigned char header[CONIC_FILE_HEADER_BYTES];
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  conic_file_make_header(kind, numbers, header);
  fwrite(header, 1, sizeof header, conic_output_stream(output)); /* a failure is seen when the file is committed */
  for (int i = 0; i < layout->n && status == CONIC_OK; i++)
    status = write_array(context, layout, i, arrays[i], conic_output_stream(output));
  if (status == CONIC_OK)
    status = conic_progress(context, "write", 1.0);
  return conic_output_end(output, status);
}

conic_status conic_file_check_arrays(conic_context *context, const char *path, const conic_mapping *file,
                                     const conic_file_layout *layout, uint64_t sum) {
  const void *arrays[CONIC_FILE_MOST_ARRAYS];
  if (file->n_bytes != layout->n_bytes)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: has %zu bytes where its header tells of %zu (at byte %zu)", path,
                      file->n_bytes, layout->n_bytes,
                      file->n_bytes < layout->n_bytes ? file->n_bytes : layout->n_bytes);
  for (int i = 0; i < layout->n; i++)
    for (size_t at = layout->arrays[i].offset + layout->arrays[i].n_bytes; at < end_of_array(layout, i); at++)
      if (file->bytes[at])
        return conic_fail(context, CONIC_ERROR_INPUT, "%s: is damaged (at byte %zu)", path, at);
  conic_file_list_arrays(layout, file->bytes, arrays);
  if (conic_file_sum_arrays(context, layout, arrays) != sum)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: is damaged: its sum is not that of its header (at byte %d)",
                      path, CONIC_FILE_HEADER_BYTES);
  return CONIC_OK;
}
