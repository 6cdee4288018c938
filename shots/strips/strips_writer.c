#include "shots/strips/strips_writer.h"

#include "core/image/image_common.h"

conic_status conic_strips_writer_open(conic_strips_writer *w, const conic_render_statistics *statistics,
                                      int is_display) {
  const conic_strips_wish *wish = w->wish;
  conic_image header = {.width = w->camera->width, .height = w->camera->height, .is_display = (uint64_t)is_display};
  if (wish->describe)
    wish->describe(wish->cookie, w->camera, statistics, &header);
  return conic_exr_bands_open(w->context, wish->path, w->part, &header, wish->written, wish->writing, &w->file);
}

/* --- rows --- */

static conic_status append_odd(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes) {
  return conic_exr_bands_append_packed(cookie, y, n_rows, bytes, n_bytes);
}

/* A plane's part of some rows. */
static size_t plane_rows_bytes(const conic_strips_writer *w, int i_plane, int n_rows) {
  return conic_planes_pixel_bytes(1u << i_plane) * (size_t)w->camera->width * (size_t)n_rows;
}

/* Puts rows that are not packed behind those of the strip before; once there are enough, or no more, packs them. */
static conic_status take_odd_rows(conic_strips_writer *w, const conic_strip_piece *piece, const char *pixels) {
  conic_context *context = w->context;
  conic_status status = CONIC_OK;
  if (!conic_image_planes(&w->odd))
    status = conic_image_allocate(context, w->camera->width, CONIC_EXR_BAND, w->wish->written, &w->odd);
  if (status != CONIC_OK)
    return status;
  w->odd_y = w->n_odd ? w->odd_y : piece->y;
  if (piece->y != w->odd_y + w->n_odd || piece->n_rows > CONIC_EXR_BAND - w->n_odd)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: cannot go on: its strips do not follow each other",
                      w->wish->path);
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (w->wish->written >> i & 1) {
      size_t n_bytes = plane_rows_bytes(w, i, piece->n_rows);
      memcpy((char *)w->odd.planes[i] + plane_rows_bytes(w, i, w->n_odd), pixels, n_bytes);
      pixels += n_bytes;
    }
  w->n_odd += piece->n_rows;
  int end = w->odd_y + w->n_odd;
  if (end % CONIC_EXR_BAND != 0 && end < w->camera->height)
    return CONIC_OK;
  w->n_odd = 0;
  return conic_exr_pack(w->file, &w->odd, w->odd_y, w->odd_y, end, 1, append_odd, w->file);
}

static void hash_rows(conic_strips_writer *w, const conic_strip_piece *piece, const char *pixels) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (w->wish->written >> i & 1) {
      size_t n_bytes = plane_rows_bytes(w, i, piece->n_rows);
      w->wish->hashes[i] = conic_image_hash_on(w->wish->hashes[i], pixels, n_bytes);
      pixels += n_bytes;
    }
}

/* What is packed stands in its place already where it is kept there. */
static conic_status append_packed_rows(conic_strips_writer *w, const conic_strip_piece *piece, const char *bytes) {
  conic_status status =
      conic_exr_bands_append_packed(w->file, piece->y, piece->n_rows, bytes, (size_t)piece->packed_bytes);
  if (status != CONIC_OK || !piece->place || piece->place + piece->packed_bytes == conic_exr_bands_length(w->file))
    return status;
  return conic_fail(w->context, CONIC_ERROR_INPUT, "%s: cannot go on: its rows are packed otherwise", w->wish->path);
}

/* --- what is kept --- */

static conic_status keep_record(conic_strips_writer *w, const conic_strip_piece *piece, const void *bytes) {
  uint64_t at;
  return conic_strips_file_add(&w->kept, piece, bytes, &at);
}

/* Rows that were written: where they stand, or as they are until there are enough to be packed. */
static conic_status keep_rows(conic_strips_writer *w, const conic_strip_piece *piece, const char *bytes) {
  conic_strip_piece kept = *piece;
  if (!piece->packed_bytes)
    return keep_record(w, piece, bytes);
  kept.place = conic_exr_bands_length(w->file) - piece->packed_bytes;
  kept.pixel_bytes = 0;
  kept.checks[1] = conic_hash_bytes(NULL, 0);
  return keep_record(w, &kept, NULL);
}

/* Once its rows are the system's, so that no run's end takes them away. */
static conic_status keep_strip_end(conic_strips_writer *w, const conic_strip_piece *piece, const char *bytes) {
  conic_strip_piece kept = *piece;
  conic_strip_end end;
  conic_status status = conic_exr_bands_flush(w->file);
  memcpy(&end, bytes, sizeof end);
  end.has_hashes = w->wish->hashes != NULL;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    end.hashes[i] = w->wish->hashes ? w->wish->hashes[i] : 0;
  kept.checks[1] = conic_hash_bytes(&end, sizeof end);
  return status == CONIC_OK ? keep_record(w, &kept, &end) : status;
}

/* --- pieces in their turn --- */

static conic_status end_strip(conic_strips_writer *w, const conic_strip_piece *piece, const char *bytes, int is_new) {
  conic_strip_end end;
  conic_status status = w->part && is_new ? keep_strip_end(w, piece, bytes) : CONIC_OK;
  memcpy(&end, bytes, sizeof end);
  for (int i = 0; i < CONIC_N_PLANES && w->wish->hashes && !is_new && end.has_hashes; i++)
    w->wish->hashes[i] = end.hashes[i];
  w->n_passed += !w->strips[w->next].is_kept;
  w->next++;
  return status;
}

/* Of the strip whose turn it is; is_new: nothing knows it. */
static conic_status write_piece(conic_strips_writer *w, const conic_strip_piece *piece, const char *bytes, int is_new) {
  const char *pixels = bytes + piece->packed_bytes;
  if (piece->n_rows == 0)
    return end_strip(w, piece, bytes, is_new);
  if (w->wish->hashes && piece->pixel_bytes)
    hash_rows(w, piece, pixels);
  conic_status status = piece->packed_bytes ? append_packed_rows(w, piece, bytes) : take_odd_rows(w, piece, pixels);
  return status == CONIC_OK && w->part && is_new ? keep_rows(w, piece, bytes) : status;
}

/* --- pieces before their turn --- */

static conic_status wait_with(conic_strips_writer *w, const conic_strip_record *record) {
  if (w->first_waiting == w->n_waiting)
    w->first_waiting = w->n_waiting = 0;
  return conic_memory_append(w->context, &w->waiting, &w->n_waiting, &w->waiting_room, record, sizeof *record);
}

static conic_status put_piece_off(conic_strips_writer *w, const conic_strip_piece *piece, const char *bytes) {
  conic_strip_record record = {.piece = *piece};
  conic_status status = CONIC_OK;
  if (w->part)
    status = conic_strips_file_add(&w->kept, piece, bytes, &record.at);
  else if (!w->pile.file.context)
    status = conic_pile_begin(w->context, w->wish->path, &w->pile);
  if (!w->part && status == CONIC_OK)
    status = conic_pile_append(&w->pile, bytes, (size_t)(piece->packed_bytes + piece->pixel_bytes), &record.at);
  return status == CONIC_OK ? wait_with(w, &record) : status;
}

static conic_status write_record(conic_strips_writer *w, const conic_strip_record *record) {
  size_t n_bytes = (size_t)(record->piece.packed_bytes + record->piece.pixel_bytes);
  char *bytes = conic_memory_allocate(w->context, n_bytes, 1);
  if (!bytes)
    return CONIC_ERROR_MEMORY;
  conic_status status =
      w->part ? conic_strips_file_get(&w->kept, record, bytes) : conic_pile_read(&w->pile, record->at, bytes, n_bytes);
  if (status == CONIC_OK)
    status = write_piece(w, &record->piece, bytes, 0);
  conic_memory_release(w->context, bytes);
  return status;
}

/* What has waited, as far as its turn has come, strip by strip: pieces of one wait in their order. */
static void write_waiting(conic_strips_writer *w) {
  size_t before;
  do {
    const int32_t turn = w->first_waiting < w->n_waiting ? w->strips[w->next].y_begin : 0;
    before = w->next;
    for (size_t i = w->first_waiting; i < w->n_waiting && w->status == CONIC_OK; i++)
      if (w->waiting[i].piece.y_begin == turn) {
        w->status = write_record(w, &w->waiting[i]);
        w->waiting[i].piece.y_begin = -1; /* it waits no more */
      }
    while (w->first_waiting < w->n_waiting && w->waiting[w->first_waiting].piece.y_begin < 0)
      w->first_waiting++;
  } while (w->next > before && w->status == CONIC_OK && w->first_waiting < w->n_waiting);
}

conic_status conic_strips_writer_go_on(conic_strips_writer *w) {
  for (size_t i = 0; i < w->kept.n_found && w->status == CONIC_OK; i++)
    w->status = wait_with(w, &w->kept.found[i]);
  if (w->status == CONIC_OK && w->file)
    write_waiting(w);
  return w->status;
}

void conic_strips_writer_take(conic_strips_writer *w, const void *bytes) {
  conic_strip_piece piece;
  const char *following = (const char *)bytes + sizeof piece;
  size_t before = w->next;
  memcpy(&piece, bytes, sizeof piece);
  if (w->status != CONIC_OK)
    return;
  w->status = piece.y_begin == w->strips[w->next].y_begin ? write_piece(w, &piece, following, 1)
                                                          : put_piece_off(w, &piece, following);
  if (w->next > before)
    write_waiting(w);
}

conic_status conic_strips_writer_end(conic_strips_writer *w, conic_status status) {
  conic_context *context = w->context;
  status = conic_exr_bands_end(w->file, status);
  conic_pile_end(&w->pile);
  conic_image_release(context, &w->odd);
  conic_memory_release(context, w->waiting);
  conic_strips_file_end(context, &w->kept);
  return status;
}
