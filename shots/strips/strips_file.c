#include "shots/strips/strips_file.h"

#include "core/files/guard.h"
#include "core/image/image_common.h"
#include "core/pictures/image_exr_bands.h"

enum { HEAD_BYTES = 128, N_DIGITS = CONIC_SHA256_ROOM - 1 };

static const char first_line[] = "conic strips 1\n";

/* --- records --- */

static uint64_t head_check(const conic_strip_piece *piece) {
  return conic_hash_bytes((const char *)piece + sizeof piece->check, sizeof *piece - sizeof piece->check);
}

static uint64_t following_bytes(const conic_strip_piece *piece) {
  return (piece->place ? 0 : piece->packed_bytes) + piece->pixel_bytes;
}

conic_status conic_strips_file_add(conic_strips_file *file, const conic_strip_piece *piece, const void *bytes,
                                   uint64_t *at) {
  conic_strip_piece head = *piece;
  head.check = head_check(&head);
  conic_status status = conic_pile_append(&file->list, &head, sizeof head, at);
  return status == CONIC_OK ? conic_pile_append(&file->list, bytes, (size_t)following_bytes(&head), at) : status;
}

conic_status conic_strips_file_get(const conic_strips_file *file, const conic_strip_record *record, void *bytes) {
  const conic_strip_piece *piece = &record->piece;
  conic_status status = CONIC_OK;
  char *to = bytes;
  if (piece->place)
    status = conic_scratch_read(&file->part, piece->place, to, (size_t)piece->packed_bytes);
  to += piece->place ? piece->packed_bytes : 0;
  return status == CONIC_OK ? conic_pile_read(&file->list, record->at, to, (size_t)following_bytes(piece)) : status;
}

/* --- what is there --- */

typedef struct strips_reading {
  conic_context *context;
  conic_strips_file *file;
  const conic_strips_size *size;
  uint64_t list_bytes, part_bytes;
  conic_strip_record *records; /* all */
  size_t n, room, found_room;
  char *bytes; /* of a record */
} strips_reading;

/* Whether a strip may begin or end there. */
static int is_place_of_strip(const conic_strips_size *size, int y) {
  return y == size->height || (y >= 0 && y < size->height && y % size->band_rows % size->step == 0);
}

/* Rows that are not packed lie between two multiples of those that are packed together. */
static int is_record_sound(const strips_reading *r, const conic_strip_piece *p) {
  const conic_strips_size *size = r->size;
  uint64_t row_bytes = (uint64_t)p->n_rows * size->row_bytes;
  if (!is_place_of_strip(size, p->y_begin) || !is_place_of_strip(size, p->y_end) || p->y_begin >= p->y_end ||
      p->y < p->y_begin || p->n_rows < 0 || p->n_rows > CONIC_EXR_BAND || p->y > p->y_end - p->n_rows)
    return 0;
  if (p->packed_bytes > size->most_bytes || p->pixel_bytes > size->most_bytes - p->packed_bytes)
    return 0;
  if (p->n_rows == 0)
    return p->y == p->y_end && !p->packed_bytes && !p->place && p->pixel_bytes == sizeof(conic_strip_end);
  if (p->place &&
      (!p->packed_bytes || p->pixel_bytes || p->place > r->part_bytes || p->packed_bytes > r->part_bytes - p->place))
    return 0;
  if (!p->packed_bytes && p->y / CONIC_EXR_BAND != (p->y + p->n_rows - 1) / CONIC_EXR_BAND)
    return 0;
  return p->pixel_bytes == row_bytes || (p->packed_bytes && !p->pixel_bytes);
}

static conic_status list_strip_records(strips_reading *r) {
  uint64_t at = HEAD_BYTES;
  conic_status status = CONIC_OK;
  conic_strip_record record;
  while (status == CONIC_OK && at <= r->list_bytes && r->list_bytes - at >= sizeof record.piece) {
    status = conic_pile_read(&r->file->list, at, &record.piece, sizeof record.piece);
    record.at = at + sizeof record.piece;
    if (status != CONIC_OK || record.piece.check != head_check(&record.piece) ||
        record.piece.packed_bytes > r->size->most_bytes || record.piece.pixel_bytes > r->size->most_bytes ||
        following_bytes(&record.piece) > r->list_bytes - record.at)
      break;
    at = record.at + following_bytes(&record.piece);
    record.i = r->n;
    if (is_record_sound(r, &record.piece))
      status = conic_memory_append(r->context, &r->records, &r->n, &r->room, &record, sizeof record);
  }
  atomic_store(&r->file->list.n_bytes, at);
  return status;
}

/* Strip by strip from the top, and of one in the order in which they came. */
static int compare_strip_records(const void *a, const void *b) {
  const conic_strip_record *first = a, *second = b;
  if (first->piece.y_begin != second->piece.y_begin)
    return first->piece.y_begin < second->piece.y_begin ? -1 : 1;
  if (first->piece.y_end != second->piece.y_end)
    return first->piece.y_end < second->piece.y_end ? -1 : 1;
  return (first->i > second->i) - (first->i < second->i);
}

static int is_record_whole(const strips_reading *r, const conic_strip_record *record) {
  const conic_strip_piece *p = &record->piece;
  return conic_strips_file_get(r->file, record, r->bytes) == CONIC_OK &&
         conic_hash_bytes(r->bytes, (size_t)p->packed_bytes) == p->checks[0] &&
         conic_hash_bytes(r->bytes + p->packed_bytes, (size_t)p->pixel_bytes) == p->checks[1];
}

/* Whether the records from `first` to `end`, the strip's last, are whole; and the hashes known, where they are needed.
 */
static int is_strip_there(const strips_reading *r, size_t first, size_t end) {
  conic_strip_end about;
  int has_pixels = 1;
  for (size_t i = first; i <= end; i++) {
    if (!is_record_whole(r, &r->records[i]))
      return 0;
    has_pixels &= r->records[i].piece.pixel_bytes > 0;
  }
  memcpy(&about, r->bytes, sizeof about);
  return !r->size->is_hashed || has_pixels || about.has_hashes;
}

static conic_status keep_strip(strips_reading *r, size_t first, size_t end) {
  conic_strips_file *file = r->file;
  size_t n = end + 1 - first;
  conic_status status = conic_memory_reserve(r->context, &file->found, file->n_found, file->n_found + n, &r->found_room,
                                             sizeof *file->found);
  if (status != CONIC_OK)
    return status;
  memcpy(file->found + file->n_found, r->records + first, n * sizeof *file->found);
  file->n_found += n;
  return CONIC_OK;
}

/* A strip that was begun again has records of both times: those count that are its rows in their order. */
static conic_status find_strips(strips_reading *r) {
  int kept_end = 0;
  size_t first = SIZE_MAX;
  conic_status status = CONIC_OK;
  if (r->n)
    qsort(r->records, r->n, sizeof *r->records, compare_strip_records);
  for (size_t i = 0; i < r->n && status == CONIC_OK; i++) {
    const conic_strip_piece *p = &r->records[i].piece, *before = i ? &r->records[i - 1].piece : NULL;
    int is_next = first != SIZE_MAX && before->y_begin == p->y_begin && before->y_end == p->y_end &&
                  before->y + before->n_rows == p->y && before->n_rows > 0;
    if (!is_next)
      first = p->y == p->y_begin && p->n_rows > 0 ? i : SIZE_MAX;
    if (first == SIZE_MAX || p->n_rows > 0 || p->y_begin < kept_end || !is_strip_there(r, first, i))
      continue;
    kept_end = p->y_end;
    status = keep_strip(r, first, i);
  }
  return status;
}

/* Of the picture as far as it was written stays what belongs to finished strips. */
static uint64_t part_in_use(const conic_strips_file *file) {
  uint64_t end = 0;
  for (size_t i = 0; i < file->n_found; i++) {
    const conic_strip_piece *p = &file->found[i].piece;
    if (p->place && p->place + p->packed_bytes > end)
      end = p->place + p->packed_bytes;
  }
  return end;
}

static conic_status check_strips_head(strips_reading *r, const char *path, const char *key) {
  char head[HEAD_BYTES];
  size_t n = sizeof first_line - 1;
  if (r->list_bytes < sizeof head || conic_pile_read(&r->file->list, 0, head, sizeof head) != CONIC_OK ||
      memcmp(head, first_line, n) != 0)
    return conic_fail(r->context, CONIC_ERROR_INPUT, "%s: cannot go on: it is no list of finished strips", path);
  if (memcmp(head + n, key, N_DIGITS) != 0)
    return conic_fail(r->context, CONIC_ERROR_INPUT,
                      "%s: cannot go on: it was begun with other inputs or options, or by another version", path);
  return CONIC_OK;
}

static conic_status read_strips(strips_reading *r) {
  r->bytes = conic_memory_allocate(r->context, (size_t)r->size->most_bytes, 1);
  conic_status status = r->bytes ? list_strip_records(r) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = find_strips(r);
  conic_memory_release_these(r->context, r->records, r->bytes);
  return status;
}

/* --- the files --- */

/* Opens one, which is made where it is not there. */
static conic_status open_kept_file(conic_context *context, const char *path, conic_scratch *file, uint64_t *n_bytes) {
  conic_disk_entry entry = {0};
  *file = (conic_scratch){context, path, -1, 1};
  if (conic_disk_look(path, &entry)) {
    conic_status status = conic_guard_check(context, path, &entry);
    if (status != CONIC_OK)
      return status;
    if (!entry.is_file)
      return conic_fail(context, CONIC_ERROR_IO, "%s: cannot write: it is no file", path);
  }
  *n_bytes = entry.n_bytes;
  file->descriptor = conic_disk_open_to_change(path);
  return file->descriptor >= 0 ? CONIC_OK
                               : conic_fail(context, CONIC_ERROR_IO, "%s: cannot write: %s", path, strerror(errno));
}

static conic_status cut_kept_file(const conic_scratch *file, uint64_t n_bytes) {
  return conic_disk_cut(file->descriptor, n_bytes)
             ? CONIC_OK
             : conic_fail(file->context, CONIC_ERROR_IO, "%s: cannot write: %s", file->path, strerror(errno));
}

static conic_status begin_strips_list(conic_strips_file *file, const char *key) {
  char head[HEAD_BYTES] = "";
  uint64_t at;
  snprintf(head, sizeof head, "%s%s\n", first_line, key);
  atomic_store(&file->list.n_bytes, 0);
  return conic_pile_append(&file->list, head, sizeof head, &at);
}

conic_status conic_strips_file_begin(conic_context *context, const char *list, const char *part, const char *key,
                                     const conic_strips_size *size, int is_going_on, conic_strips_file *file) {
  strips_reading r = {.context = context, .file = file, .size = size};
  conic_disk_entry entry;
  memset(file, 0, sizeof *file);
  file->part.descriptor = -1;
  if (is_going_on && !conic_disk_look(list, &entry))
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot read: %s", list, strerror(errno));
  conic_status status = open_kept_file(context, list, &file->list.file, &r.list_bytes);
  if (status == CONIC_OK && is_going_on)
    status = check_strips_head(&r, list, key);
  if (status == CONIC_OK)
    status = open_kept_file(context, part, &file->part, &r.part_bytes);
  if (status == CONIC_OK && is_going_on)
    status = read_strips(&r);
  if (status == CONIC_OK && !is_going_on)
    status = begin_strips_list(file, key);
  if (status == CONIC_OK)
    status = cut_kept_file(&file->list.file, atomic_load(&file->list.n_bytes));
  return status == CONIC_OK ? cut_kept_file(&file->part, part_in_use(file)) : status;
}

void conic_strips_file_end(conic_context *context, conic_strips_file *file) {
  conic_pile_end(&file->list);
  conic_scratch_close(&file->part);
  conic_memory_release(context, file->found);
  file->found = NULL;
}
