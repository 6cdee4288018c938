/* The file OUT.frames, which says which frames are finished, as lines of text:
 *
 *   conic frames 1
 *   key KEY
 *   file SHA256 BYTES NAME      each file of a frame
 *   frame NUMBER                from 0, to which they belong
 *
 * Frames come in any order, and of two with one number the latter holds. What is behind the last frame's line means
 * nothing, so that the file is valid whenever a run that appends to it is ended. */
#ifndef CONIC_FRAMES_FILE_H
#define CONIC_FRAMES_FILE_H

#include "conic/context.h"
#include "core/files/sha256.h"

typedef struct cli_frames_file {
  char *text;
  size_t n_bytes;
  size_t *begins; /* of each frame the place of its first line; SIZE_MAX: it is not finished */
  int n_frames;
} cli_frames_file;

/* A line of a frame. */
typedef struct cli_finished_file {
  const char *hash, *name; /* 64 digits; as long as n_name */
  size_t n_name;
  uint64_t n_bytes;
} cli_finished_file;

/* Reads PATH, which is there. Errors: INPUT, MEMORY; also where it is of another key. */
conic_status cli_frames_file_read(conic_context *context, const char *path, const char *key, int n_frames,
                                  cli_frames_file *frames);
/* The same of a text, which the frames take over; what is left to say about it is only an error of MEMORY. */
conic_status cli_frames_file_parse(conic_context *context, char *text, size_t n_bytes, int n_frames,
                                   cli_frames_file *frames);
void cli_frames_file_release(conic_context *context, cli_frames_file *frames);

/* The next file of a frame: *at is begins[…] at first. 0: there is no more. */
int cli_frames_file_next(const cli_frames_file *frames, size_t *at, cli_finished_file *file);

/* Writes the file anew, with the frames that are finished; whole or not at all. Errors: IO, MEMORY. */
conic_status cli_frames_file_write(conic_context *context, const char *path, const char *key,
                                   const cli_frames_file *frames);

/* The length and SHA-256 of a file. Errors: IO, without a message. */
conic_status cli_file_hash(const char *path, uint64_t *n_bytes, char hash[CONIC_SHA256_ROOM]);

#endif
