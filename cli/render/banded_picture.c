#include "cli/render/banded_picture.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cli/host.h"
#include "cli/render/frames.h"
#include "cli/render/sharing.h"
#include "cli/render/strips_writer.h"
#include "cli/session_team.h"
#include "core/base/machine.h"
#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/image/image_common.h"
#include "core/pictures/image_exr_bands.h"
#include "shots/windows.h"

/* How many strips may be drawn, a process, before the first that is missing: they wait in a file. And how many each
 * gets where they are dealt out, if they can be so small. */
enum { STRIPS_AHEAD = 6, DEALT_EACH = 4 };

typedef struct banded {
  cli_session *session;
  cli_team *team; /* null: alone */
  cli_render_job *job;
  conic_shot_work work; /* as the library has it */
  const conic_camera *camera;
  char *path, *list_path, *part_path; /* OUT, and where it is kept OUT.strips and OUT.part */
  int is_kept;
  conic_source_windows windows;
  cli_strip *strips;
  size_t n;
  size_t *drawn; /* of these, those that are drawn */
  size_t n_drawn;
  int *owners;     /* of those; null: they are not dealt out */
  unsigned planes; /* as bits */
  conic_exr_bands *packer;
  conic_window_counts counts;
  const conic_image *pixels; /* of the strip at hand, */
  const cli_strip *strip;
  char *piece; /* and what is handed over of it */
  size_t piece_room;
  uint64_t handed_bytes;
  cli_strips_writer writer; /* of the process that writes */
} banded;

/* --- which pictures --- */

static uint64_t picture_bytes(const cli_render_job *job, const conic_camera *camera) {
  return conic_planes_pixel_bytes(job->shot.planes) * (uint64_t)camera->width * (uint64_t)camera->height;
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
                 job->has_legend || job->progressive_path || job->shot.has_backdrop;
  return ending && strcasecmp(ending, "exr") == 0 && !has_more && !(session->host && session->host->lay_out) &&
         !(job->shot.planes & ~(unsigned)CONIC_WINDOWS_PLANES);
}

int cli_may_be_banded(const cli_session *session, const cli_render_job *job) {
  return is_plain_exr(session, job) && job->repeat == 1 && !job->top.is_wanted && !job->accumulating.n_samples &&
         !job->is_exposure_automatic && !conic_shot_is_lit(&job->shot) && !job->shot.view.may_be_coarser;
}

int cli_is_banded(const cli_session *session, const cli_render_job *job, const conic_camera *camera) {
  return picture_bytes(job, camera) > memory_for(job) / 2 && cli_may_be_banded(session, job) &&
         !conic_shot_is_gathered(&job->shot, job->abilities, camera) &&
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

/* --- a strip --- */

static size_t plane_row_bytes(const banded *b, int i_plane) {
  return conic_planes_pixel_bytes(1u << i_plane) * (size_t)b->camera->width;
}

/* On any thread of the process that writes, one call at a time. Where something failed nobody is to wait for what does
 * not come. */
static void take_piece_of_strip(void *cookie, int from, void *bytes, size_t n_bytes) {
  banded *b = cookie;
  cli_strip_piece piece;
  conic_moment start = conic_moment_now();
  memcpy(&piece, bytes, sizeof piece);
  cli_strips_writer_take(&b->writer, bytes);
  if (b->team)
    b->team->allow(b->writer.status == CONIC_OK ? b->writer.n_passed + (uint64_t)(STRIPS_AHEAD * b->team->cut_for)
                                                : UINT64_MAX);
  cli_team_trace(b->session, "join", "rows", (uint64_t)piece.y, start, n_bytes);
  (void)from;
}

/* The piece's head, behind which its bytes stand. */
static void hand_piece(banded *b, cli_strip_piece piece) {
  char *bytes = b->piece + sizeof piece;
  size_t n_bytes = sizeof piece + (size_t)(piece.packed_bytes + piece.pixel_bytes);
  piece.y_begin = b->strip->y_begin;
  piece.y_end = b->strip->y_end;
  if (b->is_kept) {
    piece.checks[0] = conic_hash_bytes(bytes, (size_t)piece.packed_bytes);
    piece.checks[1] = conic_hash_bytes(bytes + piece.packed_bytes, (size_t)piece.pixel_bytes);
  }
  memcpy(b->piece, &piece, sizeof piece);
  b->handed_bytes += n_bytes;
  if (b->team)
    b->team->hand(b->piece, n_bytes);
  else
    take_piece_of_strip(b, 0, b->piece, n_bytes);
}

static void hand_rows(banded *b, int y, int n_rows, const void *packed, size_t packed_bytes) {
  char *pixels = b->piece + sizeof(cli_strip_piece) + packed_bytes, *to = pixels;
  if (packed_bytes)
    memcpy(pixels - packed_bytes, packed, packed_bytes);
  for (int i = 0; i < CONIC_N_PLANES && (b->writer.is_hashed || !packed_bytes); i++)
    if (b->writer.written >> i & 1) {
      size_t n_bytes = plane_row_bytes(b, i) * (size_t)n_rows;
      memcpy(to, (const char *)b->pixels->planes[i] + plane_row_bytes(b, i) * (size_t)(y - b->strip->y_begin), n_bytes);
      to += n_bytes;
    }
  hand_piece(b, (cli_strip_piece){
                    .packed_bytes = packed_bytes, .pixel_bytes = (uint64_t)(to - pixels), .y = y, .n_rows = n_rows});
}

static conic_status hand_packed(void *cookie, int y, int n_rows, const void *bytes, size_t n_bytes) {
  banded *b = cookie;
  hand_rows(b, y, n_rows, bytes, n_bytes);
  return b->team ? CONIC_OK : b->writer.status;
}

static void hand_end(banded *b, const conic_render_statistics *drawn, const uint64_t tallies[CONIC_SOURCE_TALLIES]) {
  cli_strip_end end;
  memset(&end, 0, sizeof end);
  end.statistics = *drawn;
  end.statistics.isa = NULL;
  memset(&end.statistics.ms, 0, sizeof end.statistics.ms);
  for (int i = 0; i < CONIC_SOURCE_TALLIES; i++)
    end.tallies[i] = b->windows.tallies[i] - tallies[i];
  end.is_display = b->pixels->is_display != 0;
  memcpy(b->piece + sizeof(cli_strip_piece), &end, sizeof end);
  hand_piece(b, (cli_strip_piece){.pixel_bytes = sizeof end, .y = b->strip->y_end});
}

/* What lies between multiples of the rows that are packed together is packed; what is left above and below goes as it
 * is to who has the rows beside it. */
static conic_status hand_strip(banded *b) {
  const cli_strip *s = b->strip;
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
  return b->team || status != CONIC_OK ? status : b->writer.status;
}

static conic_status draw_strip(banded *b, size_t i_strip) {
  const cli_strip *s = &b->strips[i_strip];
  const conic_window window = {0, b->camera->width, s->y_begin, s->y_end};
  conic_context *context = b->session->context;
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
    b->job->statistics = drawn; /* which the file's header tells of */
    if (i_strip == 0)
      status = cli_strips_writer_open(&b->writer, pixels.is_display != 0);
  }
  if (status == CONIC_OK)
    status = hand_strip(b);
  if (status == CONIC_OK)
    hand_end(b, &drawn, tallies);
  conic_image_release(context, &pixels);
  cli_sharing_note(b->session, b->job, "window", i_strip, start, b->handed_bytes);
  return status;
}

/* The first is the first process's, which then knows what the header says. */
static conic_status draw_strips(banded *b) {
  const size_t n = b->n_drawn;
  uint64_t unit;
  if (b->team)
    b->team->share(b->owners || !n ? 0 : (uint64_t)n - 1, b->team->index == 0 ? take_piece_of_strip : NULL, b);
  conic_status status = n > 0 && (!b->team || b->team->index == 0) ? draw_strip(b, b->drawn[0]) : CONIC_OK;
  for (size_t i = 1; i < n && (!b->team || b->owners) && status == CONIC_OK; i++)
    status = !b->team || b->owners[i] == b->team->index ? draw_strip(b, b->drawn[i]) : CONIC_OK;
  while (b->team && !b->owners && status == CONIC_OK && (unit = b->team->next()) != CONIC_NO_UNIT)
    status = draw_strip(b, b->drawn[unit + 1]);
  return status;
}

/* --- which strips --- */

static conic_status agree(const banded *b, conic_status status) {
  return b->team ? cli_sharing_end(b->session, b->job, status) : status;
}

static int is_writing(const banded *b) {
  return !b->team || b->team->index == 0;
}

/* Which strips are finished. */
static conic_status list_kept(const banded *b, cli_strip **kept, size_t *n) {
  const cli_strips_file *file = &b->writer.kept;
  int n_rows = 0;
  *kept = conic_memory_allocate(b->session->context, file->n_found, sizeof **kept);
  *n = 0;
  for (size_t i = 0; *kept && i < file->n_found; i++) {
    const cli_strip_piece *p = &file->found[i].piece;
    if (p->n_rows > 0) /* it is not the last of its strip */
      continue;
    (*kept)[(*n)++] = (cli_strip){p->y_begin, p->y_end, 1};
    n_rows += p->y_end - p->y_begin;
  }
  if (n_rows)
    cli_note(b->session, "%d of %d rows were finished", n_rows, b->camera->height);
  return *kept ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* A strip's pixels take a quarter of the memory; it has a multiple of the rows that are packed together, where bands of
 * samples let it. */
static conic_status list_strips(banded *b) {
  int step = CONIC_EXR_BAND, n_processes = b->team ? b->team->cut_for : 1;
  uint64_t row = conic_planes_pixel_bytes(b->planes) * (uint64_t)b->camera->width, rows = memory_for(b->job) / 4 / row;
  uint64_t each = (uint64_t)b->camera->height / (uint64_t)(DEALT_EACH * n_processes);
  int is_even = conic_source_windows_are_dealt(&b->windows); /* no process knows how much there is in each */
  rows = is_even && rows > each ? each : rows;
  while (step % b->windows.step)
    step += CONIC_EXR_BAND;
  rows = rows < (uint64_t)step ? (uint64_t)step : rows / (uint64_t)step * (uint64_t)step;
  int most = rows < (uint64_t)b->camera->height ? (int)rows : b->camera->height;
  cli_strip *kept;
  size_t n_kept;
  conic_status status = list_kept(b, &kept, &n_kept);
  if (status == CONIC_OK)
    status = cli_list_strips(&b->windows, kept, n_kept, step, most, is_even ? 1 : n_processes, &b->strips, &b->n);
  conic_memory_release(b->session->context, kept);
  return status;
}

static conic_status list_drawn(banded *b) {
  b->drawn = conic_memory_allocate(b->session->context, b->n, sizeof *b->drawn);
  for (size_t i = 0; b->drawn && i < b->n; i++)
    if (!b->strips[i].is_kept)
      b->drawn[b->n_drawn++] = i;
  return b->drawn ? CONIC_OK : CONIC_ERROR_MEMORY;
}

/* Those that are drawn, where the source wants it. */
static conic_status deal_strips(banded *b) {
  conic_window *list = calloc(b->n_drawn + 1, sizeof *list);
  for (size_t i = 0; list && i < b->n_drawn; i++)
    list[i] = (conic_window){0, b->camera->width, b->strips[b->drawn[i]].y_begin, b->strips[b->drawn[i]].y_end};
  conic_status status = agree(b, list ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK && b->n_drawn > 0)
    status = conic_shot_windows_deal(&b->work, &b->windows, list, b->n_drawn, 1, &b->owners);
  free(list);
  return status;
}

/* To all what the first, which alone knows what is kept, has listed. */
static conic_status spread_strips(banded *b) {
  uint64_t n = b->n;
  b->team->broadcast(&n, sizeof n);
  cli_strip *strips = realloc(b->strips, (size_t)n * sizeof *strips);
  conic_status status = cli_sharing_end(b->session, b->job, strips ? CONIC_OK : CONIC_ERROR_MEMORY);
  b->strips = strips ? strips : b->strips;
  if (status != CONIC_OK)
    return status;
  b->n = (size_t)n;
  b->team->broadcast(b->strips, b->n * sizeof *b->strips);
  return CONIC_OK;
}

/* --- what is kept --- */

static char *add_ending(const char *path, const char *ending) {
  size_t n = strlen(path), room = n + strlen(ending) + 1;
  char *name = malloc(room);
  if (name)
    snprintf(name, room, "%s%s", path, ending);
  return name;
}

/* Beside the file that OUT leads to, of which the one becomes the other. */
static conic_status begin_kept_strips(banded *b) {
  const cli_accumulate_job *own = &b->job->accumulating;
  const cli_strips_size size = {.height = b->camera->height,
                                .step = b->windows.step,
                                .band_rows = b->windows.band_rows,
                                .row_bytes = conic_planes_pixel_bytes(b->writer.written) * (uint64_t)b->camera->width,
                                .most_bytes = b->piece_room - sizeof(cli_strip_piece),
                                .is_hashed = b->writer.is_hashed};
  char target[4096];
  conic_disk_entry entry;
  if (!conic_file_follow(b->path, target, sizeof target))
    return conic_fail(b->session->context, CONIC_ERROR_IO, "%s: cannot write: the name is too long, or links to itself",
                      b->path);
  b->list_path = add_ending(target, ".strips");
  b->writer.part = b->part_path = add_ending(target, ".part");
  if (!b->list_path || !b->part_path)
    return CONIC_ERROR_MEMORY;
  int may_begin = own->is_resumable,
      is_going_on = own->resume_path && (!may_begin || conic_disk_look(b->list_path, &entry));
  return cli_strips_file_begin(b->session->context, b->list_path, b->part_path, b->job->kept_key, &size, is_going_on,
                               &b->writer.kept);
}

/* What finished strips add to the counts, and the header knows. */
static conic_status take_kept_strips(banded *b) {
  const cli_strips_file *kept = &b->writer.kept;
  conic_status status = CONIC_OK;
  cli_strip_end end;
  for (size_t i = 0; i < kept->n_found && status == CONIC_OK; i++) {
    const cli_strip_piece *p = &kept->found[i].piece;
    if (p->n_rows > 0)
      continue;
    status = cli_strips_file_get(kept, &kept->found[i], &end);
    if (status != CONIC_OK)
      break;
    end.statistics.isa =
        conic_isa_name(b->job->shot.render.isa == CONIC_ISA_AUTO ? conic_isa_best() : b->job->shot.render.isa);
    end.statistics.threads = conic_parallel_threads(b->session->context);
    conic_windows_count(&b->windows, &end.statistics, &b->counts);
    for (int k = 0; k < CONIC_SOURCE_TALLIES; k++)
      b->windows.tallies[k] += end.tallies[k];
    b->job->statistics = end.statistics;
    if (b->strips[0].is_kept && p->y_begin == 0)
      status = cli_strips_writer_open(&b->writer, end.is_display);
  }
  return status == CONIC_OK ? cli_strips_writer_go_on(&b->writer) : status;
}

/* --- the picture --- */

/* A piece has at most so many rows' pixels, and what packing makes of them is not much more. */
static conic_status begin_pieces(banded *b) {
  const cli_strips_writer *writer = &b->writer;
  size_t rows_bytes = conic_planes_pixel_bytes(writer->written) * (size_t)b->camera->width * CONIC_EXR_BAND;
  conic_status status = conic_exr_packer_open(b->session->context, b->camera->width, b->camera->height, writer->written,
                                              &b->job->writing, &b->packer);
  if (status != CONIC_OK)
    return status;
  b->piece_room = sizeof(cli_strip_piece) + 2 * rows_bytes + (1 << 16);
  b->piece = malloc(b->piece_room);
  b->windows.other_bytes = conic_exr_packer_bytes(b->packer) + (b->team && b->team->index == 0 ? 3 : 1) * rows_bytes;
  return b->piece ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status begin_banded(banded *b, int i_frame) {
  cli_render_job *job = b->job;
  b->writer.path = b->path = cli_frame_name(job, job->outputs[0], i_frame);
  if (!b->path)
    return CONIC_ERROR_MEMORY;
  for (int i = 0; i < CONIC_N_PLANES; i++)
    job->hashes[i] = b->writer.is_hashed && b->writer.written >> i & 1 ? CONIC_IMAGE_HASH_START : 0;
  conic_source_view view = job->shot.view;
  view.occlusion = CONIC_OCCLUSION_OFF; /* which needs to hold how deep every pixel hides */
  conic_status status = conic_source_windows_begin(job->source, job->renderer, b->camera, &job->shot.render, &view,
                                                   b->planes, &b->windows);
  if (status == CONIC_OK)
    status = begin_pieces(b);
  if (status == CONIC_OK && b->is_kept && is_writing(b))
    status = begin_kept_strips(b);
  if (status == CONIC_OK)
    status = list_strips(b);
  b->writer.strips = b->strips;
  return status == CONIC_OK && b->is_kept && is_writing(b) ? take_kept_strips(b) : status;
}

/* What is finished stands under its name; what was kept of it is no more of use. */
static conic_status end_banded(banded *b, conic_status status) {
  status = cli_strips_writer_end(&b->writer, status == CONIC_OK ? b->writer.status : status);
  if (status == CONIC_OK && b->list_path)
    conic_disk_remove(b->list_path);
  return agree(b, status);
}

static void release_banded(banded *b) {
  conic_context *context = b->session->context;
  conic_exr_bands_end(b->packer, CONIC_ERROR_CANCELLED);
  conic_source_windows_end(&b->windows);
  free(b->strips);
  conic_memory_release(context, b->drawn);
  conic_memory_release(context, b->owners);
  free(b->piece);
  free(b->path);
  free(b->list_path);
  free(b->part_path);
}

conic_status cli_render_banded(cli_session *session, cli_render_job *job, int i_frame, const conic_camera *camera,
                               conic_render_statistics *statistics) {
  banded b = {.session = session,
              .team = job->sharing == CONIC_UNITS_WINDOWS ? session->team : NULL,
              .job = job,
              .camera = camera,
              .is_kept = *job->kept_key != 0,
              .planes = job->shot.planes};
  b.work = (conic_shot_work){.context = session->context,
                             .source = job->source,
                             .renderer = job->renderer,
                             .shot = &job->shot,
                             .executor = b.team ? cli_sharing_executor(job) : NULL,
                             .units = job->sharing};
  b.writer = (cli_strips_writer){.session = session,
                                 .job = job,
                                 .camera = camera,
                                 .written = job->shot.planes & ~job->unwritten_planes,
                                 .is_hashed = session->json_path != NULL};
  conic_moment start = conic_moment_now();
  conic_status status = begin_banded(&b, i_frame);
  cli_team_trace(session, "open", "picture", (uint64_t)i_frame, start, 0);
  status = agree(&b, status);
  if (status == CONIC_OK && b.team && b.is_kept)
    status = spread_strips(&b);
  if (status == CONIC_OK)
    status = agree(&b, list_drawn(&b));
  b.writer.strips = b.strips;
  if (status == CONIC_OK && b.team)
    status = deal_strips(&b);
  if (status == CONIC_OK)
    status = agree(&b, draw_strips(&b));
  status = end_banded(&b, status);
  if (status == CONIC_OK)
    status = conic_windows_sum(&b.work, &b.windows, &b.counts);
  job->banded_planes = b.writer.written;
  *statistics = b.counts.statistics;
  statistics->ms.frame = 1e3 * (cli_seconds() - start.clock_s);
  release_banded(&b);
  return status;
}
