/* The LAZ decoder: points of every format, against what was packed; in pieces, in part, without a table, and spoiled.
 * Real files have the sums that lazrs's records of them have. `laz SOURCE FILE RECORDS` writes the records of a file,
 * and says how many seconds that took: see scripts/laz_peers. */
#include <fcntl.h>
#include <time.h>

#include "core/base/byte_order.h"
#include "core/files/mapping.h"
#include "core/laz/laz.h"
#include "core/laz/laz_table.h"
#include "tests/support/files.h"
#include "tests/support/laz_examples.h"

static conic_context *context;
static unsigned wanted = CONIC_LAZ_ALL; /* of the fields */

typedef struct unpacked {
  conic_laz_format format;
  size_t n_bytes, room;
  unsigned char *bytes;
  uint64_t n_points;
} unpacked;

static conic_status keep_records(void *cookie, const unsigned char *records, size_t n) {
  unpacked *to = cookie;
  size_t n_bytes = n * to->format.point_bytes;
  CHECK(n_bytes <= to->room - to->n_bytes);
  memcpy(to->bytes + to->n_bytes, records, n_bytes);
  to->n_bytes += n_bytes;
  return CONIC_OK;
}

/* LASzip's record in a file's bytes; null: none. */
static const unsigned char *find_packing(const unsigned char *bytes, size_t *n_bytes) {
  size_t at = (size_t)conic_load_bits(bytes + 94, 2);
  for (uint64_t n = conic_load_bits(bytes + 100, 4); n > 0; n--) {
    *n_bytes = (size_t)conic_load_bits(bytes + at + 20, 2);
    if (conic_load_bits(bytes + at + 18, 2) == 22204)
      return bytes + at + 54;
    at += 54 + *n_bytes;
  }
  return NULL;
}

/* All records of a file, from its path or, where `as_pipe`, out of a pipe that it is written to. */
static conic_status unpack_input(conic_context *own, conic_input *input, const unsigned char *bytes, unpacked *to) {
  size_t n_record = 0;
  uint64_t skipped;
  const unsigned char *record = find_packing(bytes, &n_record);
  memset(to, 0, sizeof *to);
  to->n_points = conic_load_bits(bytes + (bytes[25] >= 4 ? 247 : 107), bytes[25] >= 4 ? 8 : 4);
  conic_status status = record ? CONIC_OK : CONIC_ERROR_INPUT;
  if (status == CONIC_OK)
    status = conic_laz_format_read(own, "file", record, n_record, bytes[104] & 0x3f,
                                   (size_t)conic_load_bits(bytes + 105, 2), &to->format);
  to->room = (size_t)to->n_points * to->format.point_bytes;
  to->bytes = malloc(to->room + 1);
  if (status == CONIC_OK)
    status = conic_input_skip(input, conic_load_bits(bytes + 96, 4), &skipped);
  if (status == CONIC_OK)
    status = conic_laz_read(input, &to->format, to->n_points, 0, to->n_points, wanted, 0, keep_records, to);
  return status;
}

static conic_status unpack_file(conic_context *own, const char *path, const unsigned char *bytes, unpacked *to) {
  conic_input input;
  to->bytes = NULL;
  conic_status status = conic_input_open(own, path, &input);
  if (status == CONIC_OK) {
    status = unpack_input(own, &input, bytes, to);
    conic_input_close(&input);
  }
  return status;
}

static conic_status unpack_example(const las_file *file, size_t n_bytes, unpacked *to) {
  const char *path = files_write_bytes("a.laz", file->bytes, n_bytes);
  conic_status status = unpack_file(context, path, file->bytes, to);
  CHECK(unlink(path) == 0);
  return status;
}

static int are_records(const laz_example *example, const unpacked *to, size_t n) {
  unsigned char *records = laz_example_records(example, to->format.point_bytes);
  int is_same = to->n_bytes == n * to->format.point_bytes && to->bytes && memcmp(records, to->bytes, to->n_bytes) == 0;
  if (!is_same)
    fprintf(stderr, "format %d: %zu bytes for %zu, or others\n", example->format, to->n_bytes,
            n * to->format.point_bytes);
  free(records);
  return is_same;
}

/* Where chunks are of several sizes, LAStools says 0 for their size in COPC, and others the largest number. */
static void test_no_chunk_size(const laz_example *example) {
  las_file file = laz_example_file(example);
  unpacked to;
  CHECK(conic_load_bits(file.bytes + 375 + 54 + 12, 4) == UINT32_MAX);
  las_put(&file, 375 + 54 + 12, 0, 4);
  CHECK_OK(unpack_example(&file, file.n_bytes, &to));
  CHECK(are_records(example, &to, LAZ_EXAMPLE_POINTS));
  free(to.bytes);
  free(file.bytes);
}

/* As it is; with the table's place at the very end, as of a file that was written to a pipe; and without a table. */
static void test_files(const laz_example *example) {
  las_file file = laz_example_file(example);
  unpacked to;
  CHECK_OK(unpack_example(&file, file.n_bytes, &to));
  CHECK(are_records(example, &to, LAZ_EXAMPLE_POINTS));
  free(to.bytes);
  uint64_t table = conic_load_bits(file.bytes + file.points_offset, 8);
  file.bytes = realloc(file.bytes, file.n_bytes + 8);
  las_put(&file, file.points_offset, UINT64_MAX, 8);
  las_put(&file, file.n_bytes, table, 8);
  CHECK_OK(unpack_example(&file, file.n_bytes + 8, &to));
  CHECK(are_records(example, &to, LAZ_EXAMPLE_POINTS));
  free(to.bytes);
  las_put(&file, file.points_offset, 0, 8);
  files_warnings = 0;
  if (example->format == 2) { /* nothing says where its chunks end */
    files_check_failed("no table", unpack_example(&file, file.n_bytes, &to), "table", "byte", (const char *)NULL);
  } else {
    CHECK_OK(unpack_example(&file, file.n_bytes, &to));
    CHECK(are_records(example, &to, LAZ_EXAMPLE_POINTS) && files_warnings == 1);
  }
  free(to.bytes);
  free(file.bytes);
}

/* Of a file that was cut in its last chunk, the first is read. */
static void test_cut_chunk(const laz_example *example) {
  las_file file = laz_example_file(example);
  uint64_t table = conic_load_bits(file.bytes + file.points_offset, 8);
  unpacked to;
  files_warnings = 0;
  CHECK_OK(unpack_example(&file, (size_t)table - 30, &to));
  CHECK(files_warnings == 2 && are_records(example, &to, 25));
  free(to.bytes);
  free(file.bytes);
}

/* Without a table, whichever fields are read of spoiled layers, there are as many points. */
static void test_fields_agree(const laz_example *example) {
  las_file file = laz_example_file(example);
  size_t end = (size_t)conic_load_bits(file.bytes + file.points_offset, 8), n_fewer = 0;
  las_put(&file, file.points_offset, 0, 8);
  for (size_t i = file.points_offset + 8; i < end; i += 7) {
    unpacked all, places;
    file.bytes[i] ^= 0xff;
    conic_status status = unpack_example(&file, end, &all);
    wanted = CONIC_LAZ_Z;
    CHECK(unpack_example(&file, end, &places) == status && places.n_bytes == all.n_bytes);
    wanted = CONIC_LAZ_ALL;
    n_fewer += status == CONIC_OK && all.n_bytes < LAZ_EXAMPLE_POINTS * all.format.point_bytes;
    free(all.bytes);
    free(places.bytes);
    file.bytes[i] ^= 0xff;
  }
  CHECK(n_fewer > 0);
  free(file.bytes);
}

/* A chunk by itself: all at once, in pieces, and of layers only some. */
static void test_chunk(const laz_example *example) {
  las_file file = laz_example_file(example);
  unpacked to;
  conic_laz_decoder *decoder;
  CHECK_OK(unpack_example(&file, file.n_bytes, &to));
  const conic_laz_format *format = &to.format;
  const unsigned char *bytes = file.bytes + file.points_offset + 8;
  size_t n_bytes = (size_t)conic_load_bits(file.bytes + file.points_offset, 8) - file.points_offset - 8;
  size_t n_points = format->chunk_points == CONIC_LAZ_VARIABLE ? 1 : 25;
  unsigned char *records = calloc(25, format->point_bytes);
  CHECK_OK(conic_laz_decoder_create(context, &decoder));
  for (size_t piece = 1; piece <= 25; piece += 8) {
    memset(records, 0xAA, 25 * format->point_bytes);
    CHECK_OK(conic_laz_begin(decoder, format, bytes, n_bytes, n_points, CONIC_LAZ_ALL));
    for (size_t i = 0; i < n_points; i += piece)
      CHECK_OK(conic_laz_next(decoder, n_points - i < piece ? n_points - i : piece, records + i * format->point_bytes));
    CHECK(memcmp(records, to.bytes, n_points * format->point_bytes) == 0);
    CHECK(conic_laz_next(decoder, 1, records) == CONIC_ERROR_INPUT); /* there are no more */
  }
  CHECK_OK(conic_laz_decode(decoder, format, bytes, n_bytes, n_points, CONIC_LAZ_Z, records));
  for (size_t i = 0; i < n_points; i++) {
    const unsigned char *record = records + i * format->point_bytes, *whole = to.bytes + i * format->point_bytes;
    CHECK(memcmp(record, whole, 12) == 0 && record[14] == whole[14]);
    if (format->compressor == 3)
      CHECK(memcmp(record + 16, to.bytes + 16, format->point_bytes - 16) == 0);
  }
  conic_laz_decoder_destroy(decoder);
  free(records);
  free(to.bytes);
  free(file.bytes);
}

/* Whatever a chunk's bytes are, decoding ends, and stays in its room. */
static void test_spoiled(const laz_example *example) {
  las_file file = laz_example_file(example);
  unpacked to;
  conic_laz_decoder *decoder;
  CHECK_OK(unpack_example(&file, file.n_bytes, &to));
  unsigned char *bytes = file.bytes + file.points_offset + 8, *records = calloc(25, to.format.point_bytes);
  size_t n_bytes = file.n_bytes - file.points_offset - 8, n_refused = 0;
  CHECK_OK(conic_laz_decoder_create(context, &decoder));
  for (size_t i = 0; i < n_bytes; i++) {
    unsigned char *own = malloc(n_bytes - i), before = bytes[i];
    memcpy(own, bytes, n_bytes - i);
    n_refused += conic_laz_decode(decoder, &to.format, own, n_bytes - i, 25, CONIC_LAZ_ALL, records) != CONIC_OK;
    free(own);
    bytes[i] = i % 3 == 0 ? 0 : i % 3 == 1 ? 0xff : before ^ 0x10;
    conic_status status = conic_laz_decode(decoder, &to.format, bytes, n_bytes, 25, CONIC_LAZ_ALL, records);
    CHECK(status == CONIC_OK || status == CONIC_ERROR_INPUT);
    bytes[i] = before;
  }
  CHECK(n_refused > n_bytes / 4);
  conic_laz_decoder_destroy(decoder);
  free(records);
  free(to.bytes);
  free(file.bytes);
}

static void test_refused(void) {
  const struct {
    size_t at;
    unsigned value;
    const char *what;
  } wrong[] = {{0, 2, "compressor 2"}, {0, 0, "compressor 0"},  {2, 1, "coder"},     {32, 2, "early"},
               {34, 6, "other items"}, {36, 31, "other items"}, {38, 2, "version 2"}};
  las_file file = laz_example_file(&laz_examples[6]);
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
    unsigned char record[40];
    conic_laz_format format;
    memcpy(record, file.bytes + 375 + 54, sizeof record);
    record[wrong[i].at] = (unsigned char)wrong[i].value;
    files_check_failed(wrong[i].what, conic_laz_format_read(context, "a.laz", record, 40, 6, 30, &format),
                       "a.laz: ", wrong[i].what, (const char *)NULL);
  }
  free(file.bytes);
}

/* FNV-1a. */
static uint64_t sum_of(const unpacked *to) {
  uint64_t sum = UINT64_C(0xcbf29ce484222325);
  for (size_t i = 0; i < to->n_bytes; i++)
    sum = (sum ^ to->bytes[i]) * UINT64_C(0x100000001b3);
  return sum;
}

static void test_real_files(const char *source_folder) {
  static const struct {
    const char *name;
    uint64_t sum;
  } files[] = {
      {"clouds/autzen_trim.laz", UINT64_C(0x77ffea0676ab2716)},
      {"clouds/ellipsoid-1.4.laz", UINT64_C(0xe882ddd7ea88e2b9)},
      {"clouds/ellipsoid.copc.laz", UINT64_C(0x53a386236f11ab8d)},
      {"clouds/ellipsoid.laz", UINT64_C(0xd1b2dfc5693ac9c8)},
      {"clouds/extra.laz", UINT64_C(0x2779802fd6672310)},
      {"clouds/fullwave.laz", UINT64_C(0xf26df978390bb773)},
      {"clouds/simple.laz", UINT64_C(0xac5ceed2077b659c)},
      {"clouds/simple_with_page.copc.laz", UINT64_C(0x2b9c1be162ecbe35)},
  };
  conic_context *own = check_context(3);
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    const char *path = check_data(source_folder, files[i].name);
    conic_mapping mapping;
    unpacked to;
    if (!path || conic_mapping_open(own, path, &mapping) != CONIC_OK)
      continue;
    CHECK_OK(unpack_file(own, path, mapping.bytes, &to));
    if (sum_of(&to) != files[i].sum) {
      fprintf(stderr, "%s: 0x%llx\n", files[i].name, (unsigned long long)sum_of(&to));
      check_failures++;
    }
    free(to.bytes);
    conic_mapping_close(own, &mapping);
  }
  conic_context_destroy(own);
}

static int write_records(const char *path, const char *out) {
  conic_context *own = check_context(1);
  conic_mapping mapping;
  unpacked to;
  if (conic_mapping_open(own, path, &mapping) != CONIC_OK)
    return 1;
  clock_t begin = clock();
  conic_status status = unpack_file(own, path, mapping.bytes, &to);
  printf("%.6f\n", (double)(clock() - begin) / CLOCKS_PER_SEC);
  FILE *file = fopen(out, "wb");
  int is_written = file && fwrite(to.bytes, 1, to.n_bytes, file) == to.n_bytes && fclose(file) == 0;
  free(to.bytes);
  conic_mapping_close(own, &mapping);
  conic_context_destroy(own);
  return status != CONIC_OK || !is_written;
}

int main(int argc, char **argv) {
  if (argc == 4)
    return write_records(argv[2], argv[3]);
  context = files_context();
  for (size_t i = 0; i < LAZ_EXAMPLES; i++) {
    const laz_example *example = &laz_examples[i];
    test_files(example);
    if (example->format != 2 && example->format != 7)
      test_cut_chunk(example);
    else
      test_no_chunk_size(example);
    if (example->format > 7)
      test_fields_agree(example);
    test_chunk(example);
    test_spoiled(example);
  }
  test_refused();
  if (argc > 1)
    test_real_files(argv[1]);
  files_end(context);
  return check_result();
}
