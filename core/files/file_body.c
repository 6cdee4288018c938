#include "core/files/file_body.h"

#include "core/base/byte_order.h"
#include "core/files/file.h"

/* The byte order is changed in pieces of whole records. */
enum { ALIGNMENT = 64, PIECE = 4096, MOST_AT_ONCE = CONIC_IS_BIG_ENDIAN ? PIECE : 1 << 24 };

void conic_file_add_array(conic_file_layout *layout, size_t n_bytes, conic_file_record record) {
  layout->arrays[layout->n++] = (conic_file_array){layout->n_bytes, n_bytes, record};
  layout->n_bytes = (layout->n_bytes + n_bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Whole records, between a file's order and the machine's. */
static void turn_records(conic_file_record record, unsigned char *bytes, size_t n_bytes) {
  if (record[1] == 0) {
    conic_turn_words(bytes, n_bytes / (size_t)(*record - '0'), (size_t)(*record - '0'));
    return;
  }
  const unsigned char *const end = CONIC_IS_BIG_ENDIAN ? bytes + n_bytes : bytes;
  while (bytes < end)
    for (const char *member = record; *member; bytes += *member++ - '0')
      conic_turn_words(bytes, 1, (size_t)(*member - '0'));
}

/* A piece of an array as it is in the file: the piece itself or a copy. */
static const unsigned char *as_in_file(const conic_file_array *array, const unsigned char *bytes, size_t n_bytes,
                                       unsigned char piece[PIECE]) {
  if (!CONIC_IS_BIG_ENDIAN || strcmp(array->record, "1") == 0)
    return bytes;
  memcpy(piece, bytes, n_bytes);
  turn_records(array->record, piece, n_bytes);
  return piece;
}

typedef struct sum_job {
  const conic_file_layout *layout;
  const void *const *arrays;
  int is_file; /* the arrays are in the file's byte order */
  uint64_t sums[CONIC_FILE_MOST_ARRAYS];
} sum_job;

static void sum_task(void *data, size_t i) {
  sum_job *job = data;
  const conic_file_array *array = &job->layout->arrays[i];
  const unsigned char *bytes = job->arrays[i];
  if (job->is_file || !CONIC_IS_BIG_ENDIAN) {
    job->sums[i] = conic_checksum(bytes, array->n_bytes);
    return;
  }
  unsigned char piece[PIECE];
  conic_checksumming part;
  conic_checksum_begin(&part);
  for (size_t at = 0, n; at < array->n_bytes; at += n) {
    n = array->n_bytes - at < PIECE ? array->n_bytes - at : PIECE;
    conic_checksum_add(&part, as_in_file(array, bytes + at, n, piece), n);
  }
  job->sums[i] = conic_checksum_end(&part);
}

static uint64_t sum_all(conic_context *context, sum_job *job) {
  unsigned char bytes[8 * CONIC_FILE_MOST_ARRAYS];
  size_t n = (size_t)job->layout->n;
  if (context)
    conic_parallel_for(context, n, sum_task, job);
  for (size_t i = 0; i < n; i++) {
    if (!context)
      sum_task(job, i);
    conic_store_64(bytes + 8 * i, job->sums[i]);
  }
  return conic_checksum(bytes, 8 * n);
}

uint64_t conic_file_sum_arrays(conic_context *context, const conic_file_layout *layout, const void *const *arrays) {
  sum_job job = {.layout = layout, .arrays = arrays};
  return sum_all(context, &job);
}

uint64_t conic_file_sum_bytes(conic_context *context, const conic_file_layout *layout, const unsigned char *bytes) {
  const void *arrays[CONIC_FILE_MOST_ARRAYS];
  sum_job job = {.layout = layout, .arrays = arrays, .is_file = 1};
  for (int i = 0; i < layout->n; i++)
    arrays[i] = bytes + layout->arrays[i].offset;
  return sum_all(context, &job);
}

/* Where the next array begins. */
static size_t end_of_array(const conic_file_layout *layout, int i) {
  return i + 1 < layout->n ? layout->arrays[i + 1].offset : layout->n_bytes;
}

static conic_status write_array(conic_context *context, const conic_file_layout *layout, int i,
                                const unsigned char *bytes, FILE *stream) {
  static const unsigned char zeros[ALIGNMENT];
  unsigned char piece[PIECE];
  size_t begin = layout->arrays[i].offset, n_bytes = layout->arrays[i].n_bytes;
  conic_status status = CONIC_OK;
  for (size_t at = 0, n; at < n_bytes && status == CONIC_OK && !ferror(stream); at += n) {
    n = n_bytes - at < MOST_AT_ONCE ? n_bytes - at : MOST_AT_ONCE;
    fwrite(as_in_file(&layout->arrays[i], bytes + at, n, piece), 1, n, stream);
    status = conic_progress(context, "write", (double)(begin + at + n) / (double)layout->n_bytes);
  }
  fwrite(zeros, 1, end_of_array(layout, i) - begin - n_bytes, stream);
  return status;
}

conic_status conic_file_put_arrays(conic_context *context, FILE *stream, const conic_file_kind *kind,
                                   const void *numbers, const conic_file_layout *layout, const void *const *arrays) {
  unsigned char header[CONIC_FILE_HEADER_BYTES];
  conic_status status = CONIC_OK;
  conic_file_make_header(kind, numbers, header);
  fwrite(header, 1, sizeof header, stream);
  for (int i = 0; i < layout->n && status == CONIC_OK; i++)
    status = write_array(context, layout, i, arrays[i], stream);
  return status;
}

conic_status conic_file_write_arrays(conic_context *context, const char *path, const conic_file_kind *kind,
                                     const void *numbers, const conic_file_layout *layout, const void *const *arrays) {
  conic_output *output;
  conic_status status = conic_output_open(context, path, &output);
  if (status != CONIC_OK)
    return status;
  status = conic_file_put_arrays(context, conic_output_stream(output), kind, numbers, layout, arrays);
  if (status == CONIC_OK)
    status = conic_progress(context, "write", 1.0);
  return conic_output_end(output, status);
}

void conic_file_turn_arrays(const conic_file_layout *layout, unsigned char *bytes) {
  for (int i = 0; CONIC_IS_BIG_ENDIAN && i < layout->n; i++)
    turn_records(layout->arrays[i].record, bytes + layout->arrays[i].offset, layout->arrays[i].n_bytes);
}

conic_status conic_file_take_arrays(conic_context *context, const char *path, conic_mapping *file,
                                    const conic_file_layout *layout, uint64_t sum) {
  if (file->n_bytes != layout->n_bytes)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: has %zu bytes where its header tells of %zu (at byte %zu)", path,
                      file->n_bytes, layout->n_bytes,
                      file->n_bytes < layout->n_bytes ? file->n_bytes : layout->n_bytes);
  for (int i = 0; i < layout->n; i++)
    for (size_t at = layout->arrays[i].offset + layout->arrays[i].n_bytes; at < end_of_array(layout, i); at++)
      if (file->bytes[at])
        return conic_fail(context, CONIC_ERROR_INPUT, "%s: is damaged (at byte %zu)", path, at);
  if (conic_file_sum_bytes(context, layout, file->bytes) != sum)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: is damaged: its sum is not that of its header (at byte %d)",
                      path, CONIC_FILE_HEADER_BYTES);
  conic_file_turn_arrays(layout, file->bytes);
  return CONIC_OK;
}

/* --- the header --- */

enum { AT_SUM = CONIC_FILE_HEADER_BYTES - 8 };

int conic_file_is_of_kind(const conic_file_kind *kind, const char *path) {
  return conic_file_begins_with(path, kind->magic, sizeof kind->magic);
}

void conic_file_make_header(const conic_file_kind *kind, const void *numbers,
                            unsigned char bytes[CONIC_FILE_HEADER_BYTES]) {
  memset(bytes, 0, CONIC_FILE_HEADER_BYTES);
  memcpy(bytes, kind->magic, sizeof kind->magic);
  conic_file_mend_header(kind, numbers, bytes);
}

void conic_file_mend_header(const conic_file_kind *kind, const void *numbers, unsigned char *bytes) {
  if (numbers)
    conic_file_fields_write(kind->fields, kind->n_fields, numbers, bytes + sizeof kind->magic);
  conic_store_64(bytes + AT_SUM, conic_checksum(bytes, AT_SUM));
}

conic_status conic_file_read_header(conic_context *context, const char *path, const conic_file_kind *kind,
                                    const unsigned char *bytes, size_t n_bytes, void *numbers) {
  if (n_bytes < sizeof kind->magic || memcmp(bytes, kind->magic, sizeof kind->magic) != 0)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: no %s file (at byte 0)", path, kind->ending);
  if (n_bytes < CONIC_FILE_HEADER_BYTES)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: ends within its header (at byte %zu)", path, n_bytes);
  uint32_t version = conic_load_32(bytes + sizeof kind->magic);
  if (kind->made_by && version < kind->version)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: made by an older version; make it again with %s", path,
                      kind->made_by);
  if (version != kind->version)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: version %u of the format is not known (at byte 8)", path,
                      (unsigned)version);
  if (conic_load_64(bytes + AT_SUM) != conic_checksum(bytes, AT_SUM))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: the header is damaged (at byte %d)", path, AT_SUM);
  conic_file_fields_read(kind->fields, kind->n_fields, bytes + sizeof kind->magic, numbers);
  const char *wrong = kind->fault(numbers);
  return wrong ? conic_fail(context, CONIC_ERROR_INPUT, "%s: the header has %s (at byte 8)", path, wrong) : CONIC_OK;
}

conic_status conic_file_open_kind(conic_context *context, const char *path, const conic_file_kind *kind,
                                  conic_mapping *file, void *numbers) {
  conic_status status = conic_mapping_open(context, path, file);
  return status == CONIC_OK ? conic_file_read_header(context, path, kind, file->bytes, file->n_bytes, numbers) : status;
}

/* --- fields --- */

size_t conic_file_fields_bytes(const conic_file_field *fields, size_t n) {
  size_t n_bytes = 0;
  for (size_t i = 0; i < n; i++)
    n_bytes += fields[i].n_bytes;
  return n_bytes;
}

static void copy_field(const conic_file_field *field, const void *from, void *to) {
  memcpy(to, from, field->n_bytes);
  conic_turn_words(to, field->n_bytes / field->word_bytes, field->word_bytes);
}

void conic_file_fields_write(const conic_file_field *fields, size_t n, const void *from, unsigned char *bytes) {
  for (size_t i = 0; i < n; bytes += fields[i++].n_bytes)
    copy_field(&fields[i], (const char *)from + fields[i].offset, bytes);
}

void conic_file_fields_read(const conic_file_field *fields, size_t n, const unsigned char *bytes, void *to) {
  for (size_t i = 0; i < n; bytes += fields[i++].n_bytes)
    copy_field(&fields[i], bytes, (char *)to + fields[i].offset);
}
