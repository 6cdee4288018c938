#include "cli/render/kept_frames.h"

#include "cli/render/fill_shot.h"
#include "cli/render/frame_files.h"
#include "cli/render/frames.h"
#include "cli/render/shot_record.h"
#include "cli/render/strip_pictures.h"
#include "cli/render/units.h"
#include "core/files/disk.h"
#include "core/files/file.h"
#include "core/files/finished.h"
#include "shots/shot_text.h"

struct cli_kept_frames {
  conic_context *context;
  char *path;                  /* OUT.frames */
  FILE *stream;                /* of it, in the first process */
  conic_finished found;        /* when it began */
  conic_finished_part *frames; /* of it, by number; without words: it is not finished */
  conic_text names;            /* of the files of the frame that is drawn, each with a zero behind it */
  conic_text lines;            /* of the frame that is finished */
  int n_finished;              /* in the first process: frames that were there */
  int error;                   /* and what became of writing: an errno, or 0 */
};

/* --- the options --- */

static int reads_stream(const cli_render_job *job) {
  for (int i = 0; i < job->n_inputs; i++)
    if (strcmp(job->inputs[i], "-") == 0)
      return 1;
  return 0;
}

static int refuse_kept(void) {
  return cli_usage("render: --resumable and --resume are of several frames, of --accumulate N, or of one .exr that is "
                   "larger than half of --memory and is drawn in strips");
}

conic_status cli_refuse_kept_picture(const cli_render_job *job) {
  if (!*job->kept_key || job->kept)
    return CONIC_OK;
  refuse_kept();
  return CONIC_ERROR_ARGUMENT;
}

int cli_kept_frames_check(const cli_session *session, const cli_render_job *job) {
  const cli_accumulate_job *own = &job->accumulating;
  int is_several = cli_frames_are_several(job), has_file = job->n_outputs > 0 && strcmp(job->outputs[0], "-") != 0;
  int is_placed = is_several || !own->n_samples;
  if (!own->is_resumable && !own->resume_path)
    return CLI_DONE;
  if (is_placed && !is_several && !cli_may_be_in_strips(session, job))
    return refuse_kept();
  if ((own->is_resumable || is_placed) && !has_file)
    return cli_usage("render: --resumable keeps what is finished beside the picture; give a file with -o");
  if (is_placed && own->resume_path && strcmp(own->resume_path, job->outputs[0]) != 0)
    return cli_usage("render: --resume goes on with pictures where they are; give -o %s, too", own->resume_path);
  if (is_placed && reads_stream(job))
    return cli_usage("render: what standard input shows cannot be gone on with; give files");
  return CLI_DONE;
}

/* --- what was written --- */

/* Notes the name of a file that was written, once. Sums are no part of a frame. */
static void note_name(void *cookie, const char *path) {
  cli_kept_frames *kept = cookie;
  const char *end = kept->names.bytes + kept->names.n;
  for (const char *name = kept->names.bytes; kept->names.n && name < end; name += strlen(name) + 1)
    if (strcmp(name, path) == 0)
      return;
  if (!conic_file_has_ending(path, "sums"))
    conic_text_add(&kept->names, path, strlen(path) + 1);
}

static conic_status add_file_line(cli_kept_frames *kept, const char *name) {
  char hash[CONIC_SHA256_ROOM], head[CONIC_FINISHED_HEAD_ROOM];
  uint64_t n_bytes;
  if (conic_file_hash(name, &n_bytes, hash) != CONIC_OK)
    return conic_fail(kept->context, CONIC_ERROR_IO, "%s: cannot read what was written: %s", name, strerror(errno));
  conic_text_add(&kept->lines, head, conic_finished_file_head(hash, n_bytes, head));
  conic_text_say(&kept->lines, name);
  conic_text_say(&kept->lines, "\n");
  return kept->lines.status;
}

/* --- the file --- */

static char *name_list(const cli_render_job *job) {
  const cli_frames *frames = &job->frames;
  size_t room = strlen(job->outputs[0]) + 64;
  char *path = malloc(room);
  int from = job->is_every_view ? -1 : 0; /* as users count */
  if (path && frames->is_given)
    snprintf(path, room, "%s.%d-%d-%d.frames", job->outputs[0], frames->first + from, frames->last + from,
             frames->step);
  else if (path)
    snprintf(path, room, "%s.frames", job->outputs[0]);
  return path;
}

/* Of two frames with one number the latter holds. */
static conic_status find_frames(cli_kept_frames *kept, int n_frames) {
  conic_finished_part part;
  uint64_t number;
  kept->frames = conic_memory_allocate_zeroed(kept->context, (size_t)n_frames, sizeof *kept->frames);
  if (!kept->frames)
    return CONIC_ERROR_MEMORY;
  for (size_t at = 0; conic_finished_next(&kept->found, &at, &part);)
    if (conic_finished_numbers(&part, "frame", &number, 1) && number < (uint64_t)n_frames)
      kept->frames[number] = part;
  return CONIC_OK;
}

/* Writes the list anew, with the frames that are finished; whole or not at all. */
static conic_status write_frame_list(const cli_kept_frames *kept, const char *key, int n_frames) {
  conic_output *output;
  conic_status status = conic_output_open(kept->context, kept->path, &output);
  if (status != CONIC_OK)
    return status;
  FILE *stream = conic_output_stream(output);
  conic_finished_write_head(stream, "frames", key); /* the stream remembers what fails, and commit says so */
  for (int i = 0; i < n_frames; i++)
    if (kept->frames[i].n_words)
      conic_finished_write_part(stream, &kept->found, &kept->frames[i]);
  return conic_output_commit(output);
}

/* By the shot of the first frame, after which all inputs have been read. */
static conic_status make_key(cli_session *session, cli_render_job *job) {
  conic_status status = CONIC_OK;
  if (cli_session_speaks(session) || job->units == CONIC_UNITS_WINDOWS)
    status = cli_shot_fill(session, job, job->frames.first - 1);
  if (status == CONIC_OK && cli_session_speaks(session))
    status = cli_shot_kept_key(session, job, job->kept_key);
  status = cli_units_agree(job, status);
  if (status == CONIC_OK)
    cli_units_broadcast(job, job->kept_key, sizeof job->kept_key);
  return status;
}

/* In the first process. */
static conic_status open_list(cli_session *session, cli_render_job *job) {
  cli_kept_frames *kept = job->kept;
  const cli_accumulate_job *own = &job->accumulating;
  conic_disk_entry entry;
  conic_status status = CONIC_OK;
  if (own->resume_path && (!own->is_resumable || conic_disk_look(kept->path, &entry)))
    status = conic_finished_read(session->context, kept->path, "frames", job->kept_key, &kept->found);
  if (status == CONIC_OK)
    status = find_frames(kept, job->n_frames);
  if (status == CONIC_OK)
    status = write_frame_list(kept, job->kept_key, job->n_frames);
  if (status != CONIC_OK)
    return status;
  kept->stream = conic_disk_open_stream(kept->path, "ab");
  return kept->stream
             ? CONIC_OK
             : conic_fail(session->context, CONIC_ERROR_IO, "%s: cannot write: %s", kept->path, strerror(errno));
}

/* To all what the first has found. */
static conic_status spread_list(cli_session *session, cli_render_job *job) {
  cli_kept_frames *kept = job->kept;
  uint64_t n_bytes = kept->found.n_bytes;
  cli_units_broadcast(job, &n_bytes, sizeof n_bytes);
  if (!cli_session_speaks(session)) {
    kept->found.text = conic_memory_allocate(session->context, (size_t)n_bytes, 1);
    kept->found.n_bytes = kept->found.text ? (size_t)n_bytes : 0;
  }
  int has_room = kept->found.text || !n_bytes;
  conic_status status = cli_units_agree(job, has_room ? CONIC_OK : CONIC_ERROR_MEMORY);
  if (status == CONIC_OK)
    cli_units_broadcast(job, kept->found.text, (size_t)n_bytes);
  if (!cli_session_speaks(session) && status == CONIC_OK)
    status = find_frames(kept, job->n_frames);
  return cli_units_agree(job, status);
}

conic_status cli_kept_frames_begin(cli_session *session, cli_render_job *job) {
  cli_accumulate_job *own = &job->accumulating;
  int is_several = cli_frames_are_several(job);
  if ((!own->is_resumable && !own->resume_path) || (!is_several && own->n_samples))
    return CONIC_OK;
  conic_status status = make_key(session, job);
  if (!is_several || status != CONIC_OK)
    return status;
  job->kept = calloc(1, sizeof *job->kept);
  if (!job->kept || !(job->kept->path = name_list(job)))
    status = CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    job->kept->context = job->kept->names.context = job->kept->lines.context = session->context;
    status = cli_session_speaks(session) ? open_list(session, job) : CONIC_OK;
    conic_outputs_watch(session->context, note_name, job->kept);
  }
  own->is_resumable = 1; /* also of who goes on */
  status = cli_units_agree(job, status);
  return status == CONIC_OK && job->units != CONIC_UNITS_NONE ? spread_list(session, job) : status;
}

void cli_kept_frames_release(cli_session *session, cli_render_job *job) {
  cli_kept_frames *kept = job->kept;
  if (!kept)
    return;
  conic_outputs_watch(session->context, NULL, NULL);
  if (kept->stream)
    fclose(kept->stream);
  conic_finished_release(session->context, &kept->found);
  conic_memory_release(session->context, kept->frames);
  conic_text_release(&kept->names);
  conic_text_release(&kept->lines);
  free(kept->path);
  free(kept);
  job->kept = NULL;
}

/* --- frames --- */

static int is_frame_there(const cli_kept_frames *kept, int i_frame) {
  size_t at = kept->frames[i_frame].files_at;
  conic_finished_file file;
  if (!kept->frames[i_frame].n_words)
    return 0;
  while (conic_finished_next_file(&kept->found, &at, &file))
    if (!conic_finished_is_there("", &file))
      return 0;
  return 1;
}

/* In the first process, one call at a time: the lines of a finished frame; none: it was there. */
void cli_kept_frames_take(void *cookie, int from, const void *bytes, size_t n_bytes) {
  cli_kept_frames *kept = cookie;
  (void)from;
  if (!n_bytes)
    kept->n_finished++;
  else if (!kept->error && (fwrite(bytes, 1, n_bytes, kept->stream) != n_bytes || fflush(kept->stream) != 0))
    kept->error = errno ? errno : EIO;
}

static void hand_lines(const cli_render_job *job, const conic_text *lines) {
  if (job->units == CONIC_UNITS_FRAMES)
    job->executor->hand(job->executor->data, lines->bytes, lines->n);
  else
    cli_kept_frames_take(job->kept, 0, lines->bytes, lines->n);
}

static conic_status tell_error(const cli_kept_frames *kept) {
  return kept->error
             ? conic_fail(kept->context, CONIC_ERROR_IO, "%s: cannot write: %s", kept->path, strerror(kept->error))
             : CONIC_OK;
}

conic_status cli_kept_frames_look(cli_session *session, cli_render_job *job, int i_frame, int *is_finished) {
  cli_kept_frames *kept = job->kept;
  const conic_text nothing = {0};
  *is_finished = 0;
  if (!kept)
    return CONIC_OK;
  conic_status status = conic_progress(session->context, "draw", 0.0);
  if (cli_units_make_picture(session, job))
    *is_finished = status == CONIC_OK && is_frame_there(kept, i_frame);
  if (job->units > CONIC_UNITS_FRAMES)
    cli_units_broadcast(job, is_finished, sizeof *is_finished);
  if (*is_finished && cli_units_make_picture(session, job))
    hand_lines(job, &nothing);
  if (!*is_finished && !job->accumulating.resume_path &&
      cli_units_make_picture(session, job)) /* sums of another time */
    cli_sums_forget(job, i_frame);
  return status;
}

conic_status cli_kept_frames_add(cli_session *session, cli_render_job *job, int i_frame) {
  cli_kept_frames *kept = job->kept;
  if (!kept || !cli_units_make_picture(session, job))
    return CONIC_OK;
  conic_status status = kept->names.status;
  kept->lines.n = 0;
  for (size_t at = 0; at < kept->names.n && status == CONIC_OK; at += strlen(kept->names.bytes + at) + 1)
    status = add_file_line(kept, kept->names.bytes + at);
  kept->names.n = 0;
  conic_text_print(&kept->lines, "frame %d\n", i_frame);
  status = status == CONIC_OK ? kept->lines.status : status;
  if (status == CONIC_OK) {
    hand_lines(job, &kept->lines);
    cli_sums_forget(job, i_frame);
  }
  return status == CONIC_OK ? tell_error(kept) : status;
}

int cli_kept_frames_count(const cli_render_job *job) {
  return job->kept ? job->kept->n_finished : 0;
}

conic_status cli_kept_frames_end(cli_session *session, cli_render_job *job) {
  cli_kept_frames *kept = job->kept;
  if (!kept)
    return CONIC_OK;
  if (kept->n_finished)
    cli_note(session, "%d of %d frames were finished", kept->n_finished, cli_frames_count(job));
  return cli_units_agree(job, tell_error(kept));
}
