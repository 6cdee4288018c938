#include "lod/blends/levels_format.h"

#include "core/base/byte_order.h"
#include "core/files/file.h"
#include "lod/ranges/ranges.h"

/* No coordinate is larger. */
static const double farthest = 1e15;

#define IN_LEVELS(member) CONIC_FILE_FIELD(conic_levels_header, member)
#define IN_LEVELS_ENTRY(member) CONIC_FILE_FIELD(conic_levels_entry, member)

static const conic_file_field header_fields[] = {
    IN_LEVELS(version),  IN_LEVELS(flags),     IN_LEVELS(n),     IN_LEVELS(n_merged), IN_LEVELS(cloud_size),
    IN_LEVELS(n_leaves), IN_LEVELS(sh_degree), IN_LEVELS(most),  IN_LEVELS(origin),   IN_LEVELS(low),
    IN_LEVELS(high),     IN_LEVELS(up),        IN_LEVELS(frame), IN_LEVELS(index_at), IN_LEVELS(index_sum)};
static const conic_file_field entry_fields[] = {IN_LEVELS_ENTRY(offset), IN_LEVELS_ENTRY(sum), IN_LEVELS_ENTRY(n_bytes),
                                                IN_LEVELS_ENTRY(n)};
enum { N_ENTRY_FIELDS = sizeof entry_fields / sizeof *entry_fields };

static const char *find_fault(const void *numbers) {
  const conic_levels_header *h = numbers;
  if (h->flags & ~(uint32_t)(CONIC_LEVELS_ANTIALIASED | CONIC_LEVELS_LINEAR))
    return "unknown flags";
  if (h->n == 0 || h->n > CONIC_MOST_GAUSSIANS || h->n_merged > 2 * (uint64_t)CONIC_MOST_GAUSSIANS)
    return "no Gaussian, or too many";
  if (h->cloud_size == 0 || h->cloud_size > CONIC_LEVELS_MOST_CLOUD || h->most < 1 || h->most > CONIC_LEVELS_PARENT + 1)
    return "clouds that are too large";
  if (h->n_leaves != (h->n + h->cloud_size - 1) / h->cloud_size)
    return "another number of clouds than its Gaussians need";
  if (h->sh_degree > CONIC_MAX_SH_DEGREE)
    return "an unknown degree of harmonics";
  for (int axis = 0; axis < 3; axis++)
    if (!(fabs(h->origin[axis]) <= farthest && fabs(h->low[axis]) <= farthest && fabs(h->high[axis]) <= farthest &&
          h->low[axis] <= h->high[axis] && conic_is_finite((double)h->up[axis])))
      return "a box, an origin or a direction that is out of range";
  if (!conic_frame_is_one(h->frame))
    return "no frame";
  return NULL;
}

static const conic_file_kind levels_kind = {.magic = "CONICLP\n",
                                            .ending = ".lpc",
                                            .version = CONIC_LEVELS_VERSION,
                                            .made_by = "conic layer",
                                            .fields = header_fields,
                                            .n_fields = sizeof header_fields / sizeof *header_fields,
                                            .fault = find_fault};

int conic_levels_is_file(const char *path) {
  static const unsigned char start[12] = "CONICLP\n\5", older[12] = "CONICLP\n\4";
  if (conic_ranges_is_url(path))
    return conic_file_has_ending(path, "gaussians.lpc");
  return conic_file_begins_with(path, start, sizeof start) || conic_file_begins_with(path, older, sizeof older);
}

void conic_levels_find_shape(uint32_t n_leaves, conic_levels_shape *shape) {
  uint32_t count = n_leaves;
  memset(shape, 0, sizeof *shape);
  for (shape->n_levels = 1; count > 1; shape->n_levels++)
    count = (count + CONIC_LEVELS_CHILDREN - 1) / CONIC_LEVELS_CHILDREN;
  count = n_leaves;
  for (int level = shape->n_levels - 1; level >= 0; level--) {
    shape->count[level] = count;
    count = (count + CONIC_LEVELS_CHILDREN - 1) / CONIC_LEVELS_CHILDREN;
  }
  for (int level = 0; level < shape->n_levels; level++) {
    shape->first[level] = shape->n_clouds;
    shape->n_clouds += shape->count[level];
  }
}

conic_status conic_levels_read_header(conic_context *context, const char *name, const unsigned char *bytes,
                                      size_t n_bytes, uint64_t file_bytes, conic_levels_header *header) {
  conic_levels_shape shape;
  memset(header, 0, sizeof *header);
  conic_status status = conic_file_read_header(context, name, &levels_kind, bytes, n_bytes, header);
  if (status != CONIC_OK)
    return status;
  conic_levels_find_shape(header->n_leaves, &shape);
  const uint64_t n_index = (uint64_t)shape.n_clouds * CONIC_LEVELS_ENTRY_BYTES;
  if (header->index_at < CONIC_FILE_HEADER_BYTES || header->index_at > file_bytes ||
      file_bytes - header->index_at != n_index)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: its index does not end with the file (at byte 8)", name);
  return CONIC_OK;
}

void conic_levels_write_header(const conic_levels_header *header, unsigned char bytes[CONIC_FILE_HEADER_BYTES]) {
  conic_file_make_header(&levels_kind, header, bytes);
}

static const char *check_levels_entry(const conic_levels_header *header, const conic_levels_entry *entry, int is_leaf,
                                      int is_last) {
  const uint64_t whole = 4 * conic_levels_columns(header, is_leaf) * (uint64_t)entry->n;
  const uint64_t left = header->n - (uint64_t)(header->n_leaves - 1) * header->cloud_size;
  if (entry->n == 0 || entry->n > header->most || (is_leaf && entry->n != (is_last ? left : header->cloud_size)))
    return "a cloud has another number of Gaussians than it should";
  if (entry->n_bytes == 0 || entry->n_bytes > conic_zstd_bound((size_t)whole))
    return "a cloud is too long";
  if (entry->offset < CONIC_FILE_HEADER_BYTES || entry->offset > header->index_at ||
      entry->n_bytes > header->index_at - entry->offset)
    return "a cloud lies outside of the file";
  return NULL;
}

conic_status conic_levels_read_index(conic_context *context, const char *name, const conic_levels_header *header,
                                     const unsigned char *bytes, conic_levels_entry *entries) {
  conic_levels_shape shape;
  const char *wrong = NULL;
  uint64_t n_merged = 0;
  conic_levels_find_shape(header->n_leaves, &shape);
  const size_t n_bytes = (size_t)shape.n_clouds * CONIC_LEVELS_ENTRY_BYTES;
  const uint32_t first_leaf = shape.n_clouds - header->n_leaves;
  if (conic_checksum(bytes, n_bytes) != header->index_sum)
    wrong = "its sum is another";
  for (uint32_t i = 0; i < shape.n_clouds && !wrong; i++) {
    conic_file_fields_read(entry_fields, N_ENTRY_FIELDS, bytes + (size_t)i * CONIC_LEVELS_ENTRY_BYTES, &entries[i]);
    wrong = check_levels_entry(header, &entries[i], i >= first_leaf, i + 1 == shape.n_clouds);
    n_merged += i < first_leaf ? entries[i].n : 0;
  }
  if (!wrong && n_merged != header->n_merged)
    wrong = "the merged Gaussians are not as many as the header says";
  return wrong ? conic_fail(context, CONIC_ERROR_INPUT, "%s: the index is damaged: %s (at byte %llu)", name, wrong,
                            (unsigned long long)header->index_at)
               : CONIC_OK;
}

void conic_levels_write_entries(const conic_levels_entry *entries, size_t n, unsigned char *bytes) {
  for (size_t i = 0; i < n; i++)
    conic_file_fields_write(entry_fields, N_ENTRY_FIELDS, &entries[i], bytes + i * CONIC_LEVELS_ENTRY_BYTES);
}

/* Links mostly ascend, and are kept as differences. */
static int is_counted(size_t i_column, size_t n_columns) {
  return i_column + 1 == n_columns;
}

size_t conic_levels_pack(conic_zstd *zstd, const uint32_t *columns, size_t n_columns, size_t n, unsigned char *planes,
                         unsigned char *to) {
  for (size_t c = 0; c < n_columns; c++) {
    uint32_t before = 0;
    for (size_t i = 0; i < n; i++) {
      const uint32_t value = columns[c * n + i] - before;
      before = is_counted(c, n_columns) ? columns[c * n + i] : 0;
      for (size_t k = 0; k < 4; k++)
        planes[(4 * c + k) * n + i] = (unsigned char)(value >> 8 * k);
    }
  }
  return conic_zstd_pack_whole(zstd, planes, 4 * n_columns * n, to);
}

int conic_levels_unpack(conic_zstd *zstd, const unsigned char *from, size_t n_bytes, size_t n_columns, size_t n,
                        unsigned char *planes, uint32_t *columns) {
  if (!conic_zstd_unpack(zstd, from, n_bytes, planes, 4 * n_columns * n))
    return 0;
  for (size_t c = 0; c < n_columns; c++) {
    uint32_t before = 0;
    const unsigned char *plane = planes + 4 * c * n;
    for (size_t i = 0; i < n; i++) {
      const uint32_t value =
          plane[i] | (uint32_t)plane[n + i] << 8 | (uint32_t)plane[2 * n + i] << 16 | (uint32_t)plane[3 * n + i] << 24;
      columns[c * n + i] = value + before;
      before = is_counted(c, n_columns) ? columns[c * n + i] : 0;
    }
  }
  return 1;
}
