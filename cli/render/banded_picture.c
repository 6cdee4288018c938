#include "cli/render/banded_picture.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/render/frames.h"
#include "cli/render/gather_picture.h"
#include "cli/render/lit_picture.h"
#include "cli/render/sharing.h"
#include "cli/render/windows_team.h"
#include "core/base/machine.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/file.h"
#include "core/files/pile.h"
#include "core/image/image_common.h"
#include "core/pictures/image_exr_bands.h"

/* Strips a process at least, where they can be so small; and how many may be drawn, a process, before the first that is
 * missing: they wait in a file. */
enum { STRIPS_EACH = 4, STRIPS_AHEAD = 4 };

/* Some rows of a strip, as they are handed over: packed, or as pixels; those that are hashed are both. */
typedef struct piece_head {
  uint64_t i_strip;
  int32_t y, n_rows;
  uint64_t packed_bytes; /* 0: only pixels */
} piece_head;

/* A piece that came before its turn. */
typedef struct waiting_piece {
  uint64_t i_strip, at;
  size_t n_bytes;
} waiting_piece;

typedef struct banded {
  cli_session *session;
  cli_team *team; /* null: alone */
  cli_render_job *job;
  const conic_camera *camera;
  char *path;
  int i_frame;
  conic_source_windows windows;
  conic_window *strips;
  int *owners; /* of the strips; null: they are not dealt out */
  size_t n;
  unsigned planes, written; /* as bits: drawn, and of these in the file */
  int is_hashed;
  conic_exr_bands *packer;
  cli_window_counts counts;
  const conic_image *strip; /* at hand, */
  size_t i_strip;
  char *piece; /* and what is handed over of it */
  uint64_t handed_bytes;

  /* Of the process that writes: */
  conic_status status; /* of writing */
  conic_exr_bands *file;
  size_t next;     /* strip */
  conic_image odd; /* rows that are not yet enough to be packed, from */
  int odd_y, n_odd;
  conic_pile pile;
  waiting_piece *waiting;
  size_t n_waiting, waiting_room;
} banded;

/* --- which pictures --- */

static uint64_t picture_bytes(const cli_render_job *job, const conic_camera *camera) {
  return conic_planes_pixel_bytes(job->planes) * (uint64_t)camera->width * (uint64_t)camera->height;
}

/* What is said of memory; where nothing is, pictures of what is read whole may have a gibibyte. */
static uint64_t memory_for(const cli_render_job *job) {
  int is_bounded = job->is_memory_given || job->abilities & CONIC_SOURCE_STREAMS;
  return is_bounded && job->access.memory_bytes ? job->access.memory_bytes : UINT64_C(2) << 30;
}

/* Whether the file holds what is drawn, and nothing else is made of the picture. */
static int is_plain_exr(const cli_session *session, const cli_render_job *job) {
  const char *path = job->n_outputs == 1 ? job->outputs[0] : "";
  const char *ending = *conic_file_ending(path) ? conic_file_ending(path) : job->writing.format;
  int has_more = job->deep_path || job->overdraw_path || job->clusters_path || job->boxes_path || job->legend_path ||
                 job->has_legend || job->progressive_path || job->backdrop.is_given;
  return ending && strcasecmp(ending, "exr") == 0 && !has_more && !session->host &&
         !(job->planes & ~(unsigned)CLI_WINDOWS_PLANES);
}

int cli_is_banded(const cli_session *session, const cli_render_job *job, const conic_camera *camera) {
  return picture_bytes(job, camera) > memory_for(job) / 2 && is_plain_exr(session, job) && job->repeat == 1 &&
         !job->accumulating.n_samples && !job->is_exposure_automatic && !cli_light_is_wanted(job) &&
         !job->view.may_be_coarser && !cli_is_gathered(job, camera) &&
         conic_source_has_windows(job->source, job->renderer, job->is_transparent);
}

conic_status cli_refuse_too_large(const cli_session *session, const cli_render_job *job, const conic_camera *camera) {
  uint64_t all = conic_machine_memory(), bytes = picture_bytes(job, camera);
  if (!all || bytes <= all)
    return CONIC_OK;
  return conic_fail(
      session->context, CONIC_ERROR_MEMORY,
      "out of memory: a picture of %d × %d pixels takes %llu bytes, and the machine has %llu; only a lone "
      ".exr of planes as they are drawn is written strip by strip",
      camera->width, camera->height, (unsigned long long)bytes, (unsigned long long)all);
}

/* --- the writer --- */

static conic_status open_banded_file(banded *b, const conic_image *first) {
  conic_image header = *first;
  header.width = b->camera->width;
  header.height = b->camera->height;
  memset(header.planes, 0, sizeof header.planes);
  cli_frame_describe(b->job, b->camera, &header);
  return conic_exr_bands_open(b->session->context, b->path, &header, b->written, &b->job->writing, &b->file);
}

static conic_status append_odd(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes) {
  return conic_exr_bands_append_packed(cookie, y, n_rows, bytes, n_bytes);
}

static size_t plane_row_bytes(const banded *b, int i_plane) {
  return conic_planes_pixel_bytes(1u << i_plane) * (size_t)b->camera->width;
}

/* Puts rows that are not packed behind those of the strip before; once there are enough, or no more, packs them. */
static conic_status take_odd_rows(banded *b, const piece_head *head, const char *pixels) {
  conic_context *context = b->session->context;
  conic_status status = CONIC_OK;
  if (!conic_image_planes(&b->odd))
    status = conic_image_allocate(context, b->camera->width, CONIC_EXR_BAND, b->written, &b->odd);
  if (status != CONIC_OK)
    return status;
  b->odd_y = b->n_odd ? b->odd_y : head->y;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (b->written >> i & 1) {
      size_t n_bytes = plane_row_bytes(b, i) * (size_t)head->n_rows;
      memcpy((char *)b->odd.planes[i] + plane_row_bytes(b, i) * (size_t)b->n_odd, pixels, n_bytes);
      pixels += n_bytes;
    }
  b->n_odd += head->n_rows;
  int end = b->odd_y + b->n_odd;
  if (end % CONIC_EXR_BAND != 0 && end < b->camera->height)
    return CONIC_OK;
  b->n_odd = 0;
  return conic_exr_pack(b->file, &b->odd, b->odd_y, b->odd_y, end, 1, append_odd, b->file);
}

static void hash_rows(banded *b, const piece_head *head, const char *pixels) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    if (b->written >> i & 1) {
      size_t n_bytes = plane_row_bytes(b, i) * (size_t)head->n_rows;
      b->job->hashes[i] = conic_image_hash_on(b->job->hashes[i], pixels, n_bytes);
      pixels += n_bytes;
    }
}

/* A piece of the strip whose turn it is. */
static void write_piece(banded *b, const char *bytes) {
  piece_head head;
  memcpy(&head, bytes, sizeof head);
  const char *packed = bytes + sizeof head, *pixels = packed + head.packed_bytes;
  if (b->is_hashed)
    hash_rows(b, &head, pixels);
  b->status = head.packed_bytes
                  ? conic_exr_bands_append_packed(b->file, head.y, head.n_rows, packed, (size_t)head.packed_bytes)
                  : take_odd_rows(b, &head, pixels);
  b->next += head.y + head.n_rows == b->strips[b->next].y_end;
}

static conic_status put_piece_off(banded *b, uint64_t i_strip, const void *bytes, size_t n_bytes) {
  conic_context *context = b->session->context;
  conic_status status =
      conic_memory_reserve(context, &b->waiting, b->n_waiting, b->n_waiting + 1, &b->waiting_room, sizeof *b->waiting);
  if (status == CONIC_OK && !b->pile.file.context)
    status = conic_pile_begin(context, b->path, &b->pile);
  if (status != CONIC_OK)
    return status;
  waiting_piece *w = &b->waiting[b->n_waiting];
  *w = (waiting_piece){.i_strip = i_strip, .n_bytes = n_bytes};
  status = conic_pile_append(&b->pile, bytes, n_bytes, &w->at);
  b->n_waiting += status == CONIC_OK;
  return status;
}

/* What has waited, as far as its turn has come. Pieces of a strip wait in their order. */
static void write_waiting(banded *b) {
  for (size_t i = 0; i < b->n_waiting && b->status == CONIC_OK; i++) {
    const waiting_piece w = b->waiting[i];
    if (w.i_strip != b->next)
      continue;
    char *bytes = malloc(w.n_bytes);
    b->status = bytes ? conic_pile_read(&b->pile, w.at, bytes, w.n_bytes) : CONIC_ERROR_MEMORY;
    if (b->status == CONIC_OK)
      write_piece(b, bytes);
    free(bytes);
    memmove(&b->waiting[i], &b->waiting[i + 1], (--b->n_waiting - i) * sizeof *b->waiting);
    i = w.i_strip == b->next ? i - 1 : SIZE_MAX; /* another strip's may stand before */
  }
}

/* On any thread of the process that writes, one call at a time. */
static void take_piece_of_strip(void *cookie, int from, void *bytes, size_t n_bytes) {
  banded *b = cookie;
  piece_head head;
  double start = cli_seconds();
  memcpy(&head, bytes, sizeof head);
  if (b->status != CONIC_OK)
    return;
  size_t before = b->next;
  if (head.i_strip == b->next)
    write_piece(b, bytes);
  else
    b->status = put_piece_off(b, head.i_strip, bytes, n_bytes);
  if (b->next > before)
    write_waiting(b);
  if (b->team) /* where something failed nobody is to wait for what does not come */
    b->team->allow(b->status == CONIC_OK ? b->next + (uint64_t)(STRIPS_AHEAD * b->team->count) : UINT64_MAX);
  cli_team_trace(b->session, "join", "rows", (uint64_t)head.y, start, n_bytes);
  (void)from;
}

/* --- a strip --- */

static void hand_piece(banded *b, int y, int n_rows, const void *packed, size_t packed_bytes) {
  piece_head head = {b->i_strip, y, n_rows, packed_bytes};
  const conic_window *strip = &b->strips[b->i_strip];
  char *to = b->piece + sizeof head;
  memcpy(b->piece, &head, sizeof head);
  if (packed_bytes)
    memcpy(to, packed, packed_bytes);
  to += packed_bytes;
  for (int i = 0; i < CONIC_N_PLANES && (b->is_hashed || !packed_bytes); i++)
    if (b->written >> i & 1) {
      size_t n_bytes = plane_row_bytes(b, i) * (size_t)n_rows;
      memcpy(to, (const char *)b->strip->planes[i] + plane_row_bytes(b, i) * (size_t)(y - strip->y_begin), n_bytes);
      to += n_bytes;
    }
  size_t n_bytes = (size_t)(to - b->piece);
  b->handed_bytes += n_bytes;
  if (b->team)
    b->team->hand(b->piece, n_bytes);
  else
    take_piece_of_strip(b, 0, b->piece, n_bytes);
}

static conic_status hand_packed(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes) {
  banded *b = cookie;
  hand_piece(b, y, n_rows, bytes, n_bytes);
  return b->team ? CONIC_OK : b->status;
}

/* What lies between multiples of the rows that are packed together is packed; what is left above and below goes as it
 * is to who has the rows beside it. */
static conic_status hand_strip(banded *b) {
  const conic_window *s = &b->strips[b->i_strip];
  int begin = (s->y_begin + CONIC_EXR_BAND - 1) / CONIC_EXR_BAND * CONIC_EXR_BAND,
      end = s->y_end == b->camera->height ? s->y_end : s->y_end / CONIC_EXR_BAND * CONIC_EXR_BAND;
  conic_status status = CONIC_OK;
  if (begin > end) /* all of it is between two */
    begin = end = s->y_end;
  if (s->y_begin < begin)
    hand_piece(b, s->y_begin, begin - s->y_begin, NULL, 0);
  if (begin < end)
    status = conic_exr_pack(b->packer, b->strip, s->y_begin, begin, end, 0, hand_packed, b);
  if (status == CONIC_OK && end < s->y_end)
    hand_piece(b, end, s->y_end - end, NULL, 0);
  return b->team || status != CONIC_OK ? status : b->status;
}

static conic_status draw_strip(banded *b, size_t i_strip) {
  const conic_window *s = &b->strips[i_strip];
  conic_context *context = b->session->context;
  conic_render_statistics drawn;
  conic_image pixels;
  double start = cli_seconds();
  conic_status status = conic_progress(context, "draw", (double)s->y_begin / (double)b->camera->height);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, b->camera->width, s->y_end - s->y_begin, b->planes, &pixels);
  if (status != CONIC_OK)
    return status;
  b->strip = &pixels;
  b->i_strip = i_strip;
  b->handed_bytes = 0;
  status = conic_source_windows_draw(&b->windows, s, &pixels, &drawn);
  if (status == CONIC_OK) {
    cli_windows_count(&b->windows, &drawn, &b->counts);
    b->job->statistics = drawn; /* which the file's header tells of */
    if (i_strip == 0)
      status = open_banded_file(b, &pixels);
  }
  if (status == CONIC_OK)
    status = hand_strip(b);
  conic_image_release(context, &pixels);
  cli_sharing_note(b->session, b->job, "window", i_strip, start, b->handed_bytes);
  return status;
}

/* The first is the first process's, which then knows what the header says. */
static conic_status draw_strips(banded *b) {
  uint64_t unit;
  if (b->team)
    b->team->share(b->owners ? 0 : (uint64_t)b->n - 1, b->team->index == 0 ? take_piece_of_strip : NULL, b);
  conic_status status = !b->team || b->team->index == 0 ? draw_strip(b, 0) : CONIC_OK;
  for (size_t i = 1; i < b->n && (!b->team || b->owners) && status == CONIC_OK; i++)
    status = !b->team || b->owners[i] == b->team->index ? draw_strip(b, i) : CONIC_OK;
  while (b->team && !b->owners && status == CONIC_OK && (unit = b->team->next()) != CLI_NO_UNIT)
    status = draw_strip(b, (size_t)unit + 1);
  return status;
}

/* --- the picture --- */

/* A strip's pixels take a quarter of the memory; it has a multiple of the rows that are packed together, where bands of
 * samples let it. */
static conic_status list_strips(banded *b) {
  const conic_camera *camera = b->camera;
  int band_rows = b->windows.band_rows, step = CONIC_EXR_BAND;
  uint64_t row = conic_planes_pixel_bytes(b->planes) * (uint64_t)camera->width, rows = memory_for(b->job) / 4 / row;
  uint64_t each = (uint64_t)camera->height / (uint64_t)(STRIPS_EACH * (b->team ? b->team->count : 1));
  while (step % b->windows.step)
    step += CONIC_EXR_BAND;
  if (b->team && rows > each)
    rows = each;
  rows = rows < (uint64_t)step ? (uint64_t)step : rows / (uint64_t)step * (uint64_t)step;
  int side = rows < (uint64_t)camera->height ? (int)rows : camera->height;
  size_t most = ((size_t)camera->height / (size_t)band_rows + 1) * ((size_t)band_rows / (size_t)side + 1);
  b->strips = calloc(most, sizeof *b->strips);
  if (!b->strips)
    return CONIC_ERROR_MEMORY;
  for (int band = 0; band < camera->height; band += band_rows) {
    int band_end = camera->height - band < band_rows ? camera->height : band + band_rows;
    for (int y = band; y < band_end; y += side)
      b->strips[b->n++] = (conic_window){0, camera->width, y, band_end - y < side ? band_end : y + side};
  }
  return CONIC_OK;
}

/* A piece has at most so many rows' pixels, and what packing makes of them is not much more. */
static conic_status begin_pieces(banded *b) {
  size_t rows_bytes = conic_planes_pixel_bytes(b->written) * (size_t)b->camera->width * CONIC_EXR_BAND;
  conic_status status = conic_exr_packer_open(b->session->context, b->camera->width, b->camera->height, b->written,
                                              &b->job->writing, &b->packer);
  if (status != CONIC_OK)
    return status;
  b->piece = malloc(sizeof(piece_head) + 2 * rows_bytes + (1 << 16));
  b->windows.other_bytes = conic_exr_packer_bytes(b->packer) + (b->team && b->team->index == 0 ? 3 : 1) * rows_bytes;
  return b->piece ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status begin_banded(banded *b) {
  b->path = cli_frame_name(b->job, b->job->outputs[0], b->i_frame);
  if (!b->path)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    b->job->hashes[i] = b->is_hashed && b->written >> i & 1 ? CONIC_IMAGE_HASH_START : 0;
  conic_source_view view = b->job->view;
  view.occlusion = CONIC_OCCLUSION_OFF; /* which needs to hold how deep every pixel hides */
  conic_status status = conic_source_windows_begin(b->job->source, b->job->renderer, b->camera, &b->job->options, &view,
                                                   b->planes, &b->windows);
  if (status == CONIC_OK)
    status = list_strips(b);
  return status == CONIC_OK ? begin_pieces(b) : status;
}

static conic_status agree(const banded *b, conic_status status) {
  return b->team ? cli_sharing_end(b->session, b->job, status) : status;
}

static void release_banded(banded *b) {
  conic_exr_bands_end(b->packer, CONIC_ERROR_CANCELLED);
  conic_source_windows_end(&b->windows);
  conic_pile_end(&b->pile);
  conic_image_release(b->session->context, &b->odd);
  conic_memory_release(b->session->context, b->waiting);
  free(b->strips);
  free(b->owners);
  free(b->piece);
  free(b->path);
}

conic_status cli_render_banded(cli_session *session, cli_render_job *job, int i_frame, const conic_camera *camera,
                               conic_render_statistics *statistics) {
  banded b = {.session = session,
              .team = job->sharing == CLI_SHARES_WINDOWS ? session->team : NULL,
              .job = job,
              .camera = camera,
              .i_frame = i_frame,
              .planes = job->planes,
              .written = job->planes & ~job->unwritten_planes,
              .is_hashed = session->json_path != NULL};
  double start = cli_seconds();
  conic_status status = agree(&b, begin_banded(&b));
  if (status == CONIC_OK && b.team)
    status = cli_windows_deal(session, &b.windows, b.strips, b.n, 1, &b.owners);
  if (status == CONIC_OK)
    status = agree(&b, draw_strips(&b));
  if (status == CONIC_OK)
    status = b.status;
  status = conic_exr_bands_end(b.file, status);
  status = agree(&b, status);
  if (status == CONIC_OK)
    status = cli_windows_sum(b.team, &b.windows, &b.counts);
  job->banded_planes = b.written;
  *statistics = b.counts.statistics;
  statistics->ms.frame = 1e3 * (cli_seconds() - start);
  release_banded(&b);
  return status;
}
