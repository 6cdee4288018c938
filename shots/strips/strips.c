#include "shots/strips/strips.h"

#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"
#include "shots/strips/strips_writer.h"
#include "shots/windows.h"
#include "source/source_kind.h"

/* How many strips may be drawn, a process, before the first that is missing: they wait in a file. And how many each
 * gets where they are dealt out, if they can be so small. */
enum { STRIPS_AHEAD = 6, DEALT_EACH = 4 };

/* Beside a strip's pixels, rows of it are in memory while they are packed. */
enum { PARTS_OF_MEMORY = 2 };

typedef struct banded {
  conic_context *context;
  const conic_shot_work *work;
  const conic_executor *executor;
  const conic_camera *camera;
  const conic_strips_wish *wish;
  char *list_path, *part_path; /* where it is kept PATH.strips and PATH.part */
  conic_source_windows windows;
  conic_strip *strips;
  size_t n;
  size_t *drawn; /* of these, those that are drawn */
  size_t n_drawn;
  int *owners;     /* of those; null: they are not dealt out */
  unsigned planes; /* as bits */
  conic_exr_bands *packer;
  conic_window_counts counts;
  const conic_image *pixels; /* of the strip at hand, */
  const conic_strip *strip;
  char *piece; /* and what is handed over of it */
  size_t piece_room;
  uint64_t handed_bytes;
  conic_strips_writer writer; /* of the process that writes */
} banded;

static int is_writing(const banded *b) {
  return b->executor->index == 0;
}

/* Other threads write what others hand over, so that only who is alone may look what came of it. */
static conic_status status_of_writing(const banded *b) {
  return b->executor->count == 1 ? b->writer.status : CONIC_OK;
}

/* --- a strip --- */

static size_t plane_row_bytes(const banded *b, int i_plane) {
  return conic_planes_pixel_bytes(1u << i_plane) * (size_t)b->camera->width;
}

/* On any thread of the process that writes, one call at a time. Where something failed nobody is to wait for what does
 * not come. */
static void take_piece_of_strip(void *cookie, int from, const void *bytes, size_t n_bytes) {
  banded *b = cookie;
  conic_strip_piece piece;
  conic_moment start = conic_moment_now();
  memcpy(&piece, bytes, sizeof piece);
  conic_strips_writer_take(&b->writer, bytes);
  b->executor->allow(b->executor->data, b->writer.status == CONIC_OK
                                            ? b->writer.n_passed + (uint64_t)(STRIPS_AHEAD * b->executor->cut_for)
                                            : UINT64_MAX);
  conic_work_trace(b->work, "join", "rows", (uint64_t)piece.y, start, n_bytes);
  (void)from;
}

/* The piece's head, behind which its bytes stand. */
static void hand_piece(banded *b, conic_strip_piece piece) {
  char *bytes = b->piece + sizeof piece;
  size_t n_bytes = sizeof piece + (size_t)(piece.packed_bytes + piece.pixel_bytes);
  piece.y_begin = b->strip->y_begin;
  piece.y_end = b->strip->y_end;
  if (b->wish->key) {
    piece.checks[0] = conic_hash_bytes(bytes, (size_t)piece.packed_bytes);
    piece.checks[1] = conic_hash_bytes(bytes + piece.packed_bytes, (size_t)piece.pixel_bytes);
  }
  memcpy(b->piece, &piece, sizeof piece);
  b->handed_bytes += n_bytes;
  b->executor->hand(b->executor->data, b->piece, n_bytes);
}

static void hand_rows(banded *b, int y, int n_rows, const void *packed, size_t packed_bytes) {
  char *pixels = b->piece + sizeof(conic_strip_piece) + packed_bytes, *to = pixels;
  if (packed_bytes)
    memcpy(pixels - packed_bytes, packed, packed_bytes);
  for (int i = 0; i < CONIC_N_PLANES && (b->wish->hashes || !packed_bytes); i++)
    if (b->wish->written >> i & 1) {
      size_t n_bytes = plane_row_bytes(b, i) * (size_t)n_rows;
      memcpy(to, (const char *)b->pixels->planes[i] + plane_row_bytes(b, i) * (size_t)(y - b->strip->y_begin), n_bytes);
      to += n_bytes;
    }
  hand_piece(b, (conic_strip_piece){
                    .packed_bytes = packed_bytes, .pixel_bytes = (uint64_t)(to - pixels), .y = y, .n_rows = n_rows});
}

static conic_status hand_packed(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes) {
  banded *b = cookie;
  hand_rows(b, y, n_rows, bytes, n_bytes);
  return status_of_writing(b);
}

static void hand_end(banded *b, const conic_render_statistics *drawn, const uint64_t tallies[CONIC_SOURCE_TALLIES]) {
  conic_strip_end end;
  memset(&end, 0, sizeof end);
  end.statistics = *drawn;
  end.statistics.isa = NULL;
  memset(&end.statistics.ms, 0, sizeof end.statistics.ms);
  for (int i = 0; i < CONIC_SOURCE_TALLIES; i++)
    end.tallies[i] = b->windows.tallies[i] - tallies[i];
  end.is_display = b->pixels->is_display != 0;
  memcpy(b->piece + sizeof(conic_strip_piece), &end, sizeof end);
  hand_piece(b, (conic_strip_piece){.pixel_bytes = sizeof end, .y = b->strip->y_end});
}

/* What lies between multiples of the rows that are packed together is packed; what is left above and below goes as it
 * is to who has the rows beside it. */
static conic_status hand_strip(banded *b) {
  const conic_strip *s = b->strip;
  int begin = (s->y_begin + CONIC_EXR_BAND - 1) / CONIC_EXR_BAND * CONIC_EXR_BAND,
      end = s->y_end == b->camera->height ? s->y_end : s->y_end / CONIC_EXR_BAND * CONIC_EXR_BAND;
  conic_status status = CONIC_OK;
  if (begin > end) /* all of it is between two */
    begin = end = s->y_end;
  if (s->y_begin < begin)
    hand_rows(b, s->y_begin, begin - s->y_begin, NULL, 0);
  if (begin < end)
    status = conic_exr_pack(b->packer, b->pixels, s->y_begin, begin, end, 0, hand_packed, b);
  if (status == CONIC_OK && end < s->y_end)
    hand_rows(b, end, s->y_end - end, NULL, 0);
  return status == CONIC_OK ? status_of_writing(b) : status;
}

static conic_status draw_strip(banded *b, size_t i_strip) {
  const conic_strip *s = &b->strips[i_strip];
  const conic_window window = {0, b->camera->width, s->y_begin, s->y_end};
  conic_context *context = b->context;
  conic_render_statistics drawn;
  conic_image pixels;
  uint64_t tallies[CONIC_SOURCE_TALLIES];
  conic_moment start = conic_moment_now();
  conic_status status = conic_progress(context, "draw", (double)s->y_begin / (double)b->camera->height);
  if (status == CONIC_OK)
    status = conic_image_allocate(context, b->camera->width, s->y_end - s->y_begin, b->planes, &pixels);
  if (status != CONIC_OK)
    return status;
  b->pixels = &pixels;
  b->strip = s;
  b->handed_bytes = 0;
  memcpy(tallies, b->windows.tallies, sizeof tallies);
  status = conic_source_windows_draw(&b->windows, &window, &pixels, &drawn);
  if (status == CONIC_OK) {
    conic_windows_count(&b->windows, &drawn, &b->counts);
    if (i_strip == 0)
      status = conic_strips_writer_open(&b->writer, &drawn, pixels.is_display != 0);
  }
  if (status == CONIC_OK)
    status = hand_strip(b);
  if (status == CONIC_OK)
    hand_end(b, &drawn, tallies);
  conic_image_release(context, &pixels);
  b->executor->did(b->executor->data, "window", i_strip, start, b->handed_bytes);
  return status;
}

/* The first is the first process's, which then knows what the header says. */
static conic_status draw_strips(banded *b) {
  const size_t n = b->n_drawn;
  const conic_executor *x = b->executor;
  uint64_t unit;
  x->share(x->data, b->owners || !n ? 0 : (uint64_t)n - 1, is_writing(b) ? take_piece_of_strip : NULL, b);
  conic_status status = n > 0 && is_writing(b) ? draw_strip(b, b->drawn[0]) : CONIC_OK;
  for (size_t i = 1; i < n && b->owners && status == CONIC_OK; i++)
    status = b->owners[i] == x->index ? draw_strip(b, b->drawn[i]) : CONIC_OK;
  while (!b->owners && status == CONIC_OK && (unit = x->next(x->data)) != CONIC_NO_UNIT)
    status = draw_strip(b, b->drawn[unit + 1]);
  return status;
}

/* --- which strips --- */

/* Which strips are finished. */
static conic_status list_kept(const banded *b, conic_strip **kept, size_t *n) {
  const conic_strips_file *file = &b->writer.kept;
  int n_rows = 0;
  *kept = conic_memory_allocate(b->context, file->n_found, sizeof **kept);
  *n = 0;
  for (size_t i = 0; *kept && i < file->n_found; i++) {
    const conic_strip_piece *p = &file->found[i].piece;
    if (p->n_rows > 0) /* it is not the last of its strip */
      continue;
    (*kept)[(*n)++] = (conic_strip){p->y_begin, p->y_end, 1};
    n_rows += p->y_end - p->y_begin;
  }
  if (n_rows && b->wish->found)
    b->wish->found(b->wish->cookie, n_rows);
  return *kept ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* A strip has a multiple of the rows that are packed together, where bands of
 * samples let it. */
static conic_status list_strips(banded *b) {
  int step = CONIC_EXR_BAND, n_processes = b->executor->cut_for;
  uint64_t row = conic_planes_pixel_bytes(b->planes) * (uint64_t)b->camera->width, rows = b->wish->strip_bytes / row;
  uint64_t each = (uint64_t)b->camera->height / (uint64_t)(DEALT_EACH * n_processes);
  int is_even = conic_source_windows_are_dealt(&b->windows); /* no process knows how much there is in each */
  rows = is_even && rows > each ? each : rows;
  while (step % b->windows.step)
    step += CONIC_EXR_BAND;
  rows = rows < (uint64_t)step ? (uint64_t)step : rows / (uint64_t)step * (uint64_t)step;
  int most = rows < (uint64_t)b->camera->height ? (int)rows : b->camera->height;
  conic_strip *kept;
  size_t n_kept;
  conic_status status = list_kept(b, &kept, &n_kept);
  if (status == CONIC_OK)
    status = conic_list_strips(&b->windows, kept, n_kept, step, most, is_even ? 1 : n_processes, &b->strips, &b->n);
  conic_memory_release(b->context, kept);
  return status;
}

static conic_status list_drawn(banded *b) {
  b->drawn = conic_memory_allocate(b->context, b->n, sizeof *b->drawn);
  for (size_t i = 0; b->drawn && i < b->n; i++)
    if (!b->strips[i].is_kept)
      b->drawn[b->n_drawn++] = i;
  return b->drawn ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* Those that are drawn, where the source wants it. */
static conic_status deal_strips(banded *b) {
  conic_window *list = conic_memory_allocate(b->context, b->n_drawn, sizeof *list);
  for (size_t i = 0; list && i < b->n_drawn; i++)
    list[i] = (conic_window){0, b->camera->width, b->strips[b->drawn[i]].y_begin, b->strips[b->drawn[i]].y_end};
  conic_status status = conic_work_agree(b->work, list ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK && b->n_drawn > 0)
    status = conic_shot_windows_deal(b->work, &b->windows, list, b->n_drawn, 1, &b->owners);
  conic_memory_release(b->context, list);
  return status;
}

/* To all what the first, which alone knows what is kept, has listed. */
static conic_status spread_strips(banded *b) {
  const conic_executor *x = b->executor;
  uint64_t n = b->n;
  x->broadcast(x->data, &n, sizeof n);
  conic_status status = CONIC_OK;
  if ((size_t)n > b->n)
    status = conic_memory_grow(b->context, &b->strips, b->n, (size_t)n, sizeof *b->strips);
  status = conic_work_agree(b->work, status);
  if (status != CONIC_OK)
    return status;
  b->n = (size_t)n;
  x->broadcast(x->data, b->strips, b->n * sizeof *b->strips);
  return CONIC_OK;
}

/* --- what is kept --- */

static char *add_ending(conic_context *context, const char *path, const char *ending) {
  size_t n = strlen(path), room = n + strlen(ending) + 1;
  char *name = conic_memory_allocate(context, room, 1);
  if (name)
    snprintf(name, room, "%s%s", path, ending);
  return name;
}

/* Beside the file that PATH leads to, of which the one becomes the other. */
static conic_status begin_kept_strips(banded *b) {
  const conic_strips_wish *wish = b->wish;
  const conic_strips_size size = {.height = b->camera->height,
                                  .step = b->windows.step,
                                  .band_rows = b->windows.band_rows,
                                  .row_bytes = conic_planes_pixel_bytes(wish->written) * (uint64_t)b->camera->width,
                                  .most_bytes = b->piece_room - sizeof(conic_strip_piece),
                                  .is_hashed = wish->hashes != NULL};
  char target[4096];
  conic_disk_entry entry;
  if (!conic_file_follow(wish->path, target, sizeof target))
    return conic_fail(b->context, CONIC_ERROR_IO, "%s: cannot write: the name is too long, or links to itself",
                      wish->path);
  b->list_path = add_ending(b->context, target, ".strips");
  b->writer.part = b->part_path = add_ending(b->context, target, ".part");
  if (!b->list_path || !b->part_path)
    return CONIC_ERROR_MEMORY;
  int is_going_on = wish->goes_on && (!wish->may_begin || conic_disk_look(b->list_path, &entry));
  return conic_strips_file_begin(b->context, b->list_path, b->part_path, wish->key, &size, is_going_on,
                                 &b->writer.kept);
}

/* What finished strips add to the counts, and the header knows. */
static conic_status take_kept_strips(banded *b) {
  const conic_strips_file *kept = &b->writer.kept;
  const conic_isa isa = b->work->shot->render.isa;
  conic_status status = CONIC_OK;
  conic_strip_end end;
  for (size_t i = 0; i < kept->n_found && status == CONIC_OK; i++) {
    const conic_strip_piece *p = &kept->found[i].piece;
    if (p->n_rows > 0)
      continue;
    status = conic_strips_file_get(kept, &kept->found[i], &end);
    if (status != CONIC_OK)
      break;
    end.statistics.isa = conic_isa_name(isa == CONIC_ISA_AUTO ? conic_isa_best() : isa);
    end.statistics.threads = conic_parallel_threads(b->context);
    conic_windows_count(&b->windows, &end.statistics, &b->counts);
    for (int k = 0; k < CONIC_SOURCE_TALLIES; k++)
      b->windows.tallies[k] += end.tallies[k];
    if (b->strips[0].is_kept && p->y_begin == 0)
      status = conic_strips_writer_open(&b->writer, &end.statistics, end.is_display);
  }
  return status == CONIC_OK ? conic_strips_writer_go_on(&b->writer) : status;
}

/* --- the picture --- */

/* A piece has at most so many rows' pixels, and what packing makes of them is not much more. */
static conic_status begin_pieces(banded *b) {
  const conic_strips_wish *wish = b->wish;
  size_t rows_bytes = conic_planes_pixel_bytes(wish->written) * (size_t)b->camera->width * CONIC_EXR_BAND;
  conic_status status =
      conic_exr_packer_open(b->context, b->camera->width, b->camera->height, wish->written, wish->writing, &b->packer);
  if (status != CONIC_OK)
    return status;
  int takes_others = b->executor->count > 1 && is_writing(b);
  b->piece_room = sizeof(conic_strip_piece) + 2 * rows_bytes + (1 << 16);
  b->piece = conic_memory_allocate(b->context, b->piece_room, 1);
  b->windows.other_bytes = conic_exr_packer_bytes(b->packer) + (takes_others ? 3 : 1) * rows_bytes;
  return b->piece ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status begin_banded(banded *b) {
  const conic_shot *shot = b->work->shot;
  const conic_strips_wish *wish = b->wish;
  for (int i = 0; i < CONIC_N_PLANES && wish->hashes; i++)
    wish->hashes[i] = wish->written >> i & 1 ? CONIC_IMAGE_HASH_START : 0;
  conic_source_view view = shot->view;
  view.occlusion = CONIC_OCCLUSION_OFF; /* which needs to hold how deep every pixel hides */
  conic_status status = conic_source_windows_begin(b->work->source, b->work->renderer, b->camera, &shot->render, &view,
                                                   b->planes, &b->windows);
  if (status == CONIC_OK)
    status = begin_pieces(b);
  if (status == CONIC_OK && wish->key && is_writing(b))
    status = begin_kept_strips(b);
  if (status == CONIC_OK)
    status = list_strips(b);
  b->writer.strips = b->strips;
  return status == CONIC_OK && wish->key && is_writing(b) ? take_kept_strips(b) : status;
}

/* What is finished stands under its name; what was kept of it is no more of use. */
static conic_status end_banded(banded *b, conic_status status) {
  status = conic_strips_writer_end(&b->writer, status == CONIC_OK ? b->writer.status : status);
  if (status == CONIC_OK && b->list_path)
    conic_disk_remove(b->list_path);
  return conic_work_agree(b->work, status);
}

static void release_banded(banded *b) {
  conic_exr_bands_end(b->packer, CONIC_ERROR_CANCELLED);
  conic_source_windows_end(&b->windows);
  conic_memory_release_these(b->context, b->strips, b->drawn, b->owners, b->piece, b->list_path, b->part_path);
}

conic_status conic_strips_draw(conic_shot_work *work, const conic_camera *camera, const conic_strips_wish *wish,
                               conic_render_statistics *statistics) {
  banded b = {.context = work->context,
              .work = work,
              .executor = work->executor,
              .camera = camera,
              .wish = wish,
              .planes = work->planes};
  b.writer = (conic_strips_writer){.context = work->context, .camera = camera, .wish = wish};
  conic_moment start = conic_moment_now();
  conic_status status = begin_banded(&b);
  conic_work_trace(work, "open", "picture", (uint64_t)work->shot->frame, start, 0);
  status = conic_work_agree(work, status);
  if (status == CONIC_OK && wish->key)
    status = spread_strips(&b);
  if (status == CONIC_OK)
    status = conic_work_agree(work, list_drawn(&b));
  b.writer.strips = b.strips;
  if (status == CONIC_OK)
    status = deal_strips(&b);
  if (status == CONIC_OK)
    status = conic_work_agree(work, draw_strips(&b));
  status = end_banded(&b, status);
  if (status == CONIC_OK)
    status = conic_windows_sum(work, &b.windows, &b.counts);
  *statistics = b.counts.statistics;
  statistics->ms.frame = 1e3 * (conic_seconds_now() - start.clock_s);
  release_banded(&b);
  return status;
}

/* --- of a shot --- */

/* Null where a plan's picture can be drawn in strips; else a short reason, as "it is lit". */
static const char *strips_stranger(const conic_shot_work *work) {
  const conic_shot *shot = work->shot;
  if (work->plan.is_accumulated)
    return "it is a mean of samples";
  if (work->plan.lit != CONIC_LIT_NOT)
    return "its light may be hidden";
  if (shot->light.dome_stops > 0.0)
    return "its pixels take light from each other";
  if (work->plan.is_gathered)
    return "its camera's picture is gathered from views";
  if (shot->has_backdrop)
    return "it has a backdrop";
  if (work->planes & ~(unsigned)CONIC_WINDOWS_PLANES)
    return "it has planes that are made of others";
  if (shot->view.may_be_coarser)
    return "it is finished within a time";
  return work->plan.has_windows ? NULL : "its source has no windows";
}

static conic_status check_strips_shot(const conic_shot_work *work, const char *path) {
  const char *stranger = strips_stranger(work);
  if (!conic_file_has_ending(path, "exr"))
    return conic_fail(work->context, CONIC_ERROR_ARGUMENT, "%s: a picture in strips becomes an .exr", path);
  if (stranger)
    return conic_fail(work->context, CONIC_ERROR_UNSUPPORTED, "%s: the picture cannot be drawn in strips: %s", path,
                      stranger);
  return CONIC_OK;
}

conic_status conic_shot_write_strips(conic_source *source, conic_renderer *renderer, const conic_shot *given,
                                     const char *path, uint64_t most_bytes, conic_shot_outcome *outcome) {
  conic_shot shot;
  conic_shot_work work;
  conic_camera camera;
  conic_image_options writing;
  conic_render_statistics statistics;
  conic_shot_init(&shot);
  conic_image_options_init(&writing);
  if (!conic_options_take(&shot, given))
    return conic_fail(source->context, CONIC_ERROR_ARGUMENT, "%s: the shot was not initialised", source->name);
  conic_source_settle(source, &shot.render);
  conic_status status = conic_shot_work_begin(source, renderer, &shot, &work);
  if (status == CONIC_OK)
    status = check_strips_shot(&work, path);
  if (status == CONIC_OK)
    status = conic_shot_camera(source->context, &shot, 0.5, &camera);
  const conic_strips_wish wish = {
      .path = path, .written = shot.planes, .writing = &writing, .strip_bytes = most_bytes / PARTS_OF_MEMORY};
  if (status == CONIC_OK)
    status = conic_strips_draw(&work, &camera, &wish, &statistics);
  if (status == CONIC_OK && outcome)
    *outcome = (conic_shot_outcome){.statistics = statistics, .noise = -1.0};
  return status;
}
