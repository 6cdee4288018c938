/* The files of a suite: writing them, and the list of all with sizes and hashes. */
#pragma once

#include "cli/judge/suite_scenes.h"
#include "core/files/file.h"
#include "core/files/sha256.h"

extern const char cli_suite_readme[]; /* its README.md */

enum { SUITE_PATH_ROOM = 96, SUITE_MOST_FILES = 2048 };

typedef struct suite_file {
  char path[SUITE_PATH_ROOM]; /* within the suite */
  uint64_t bytes;
  char sha256[CONIC_SHA256_ROOM];
} suite_file;

typedef struct suite_files {
  conic_context *context;
  const char *folder;
  int n;
  suite_file files[SUITE_MOST_FILES];
} suite_files;

/* FOLDER/PATH into `full`, which has `room` bytes. Errors: ARGUMENT (it is too long). */
conic_status cli_suite_join(conic_context *context, const char *folder, const char *path, char *full, size_t room);

/* Makes a folder, which may exist already. Errors: IO. */
conic_status cli_suite_make_folder(suite_files *suite, const char *path);

/* Adds a written file to the list, by its bytes on the disk. Errors: IO. */
conic_status cli_suite_add_file(suite_files *suite, const char *path);

/* Opens a file of the suite for writing; ends it, and adds it. Errors: as conic_output_open and _end. */
conic_status cli_suite_open_file(suite_files *suite, const char *path, conic_output **output);
conic_status cli_suite_end_file(suite_files *suite, const char *path, conic_output *output);

/* Writes a text file, and adds it. Errors: as conic_output_open and _end. */
conic_status cli_suite_write_text(suite_files *suite, const char *path, const char *text);

/* The contents of a scene's .ply, of one of these kinds. */
typedef struct suite_content {
  conic_gaussians gaussians;
  conic_model model; /* surface splats */
} suite_content;

void cli_suite_release_content(conic_context *context, suite_content *content);

/* Writes a scene in all its formats to scenes/ and its camera in all conventions to cameras/, and adds the files. On
 * success the caller releases *content. Errors: as conic_gaussians_write, conic_splats_write, and the readers of the
 * files. */
conic_status cli_suite_write_scene(suite_files *suite, const suite_scene *scene, suite_content *content);
conic_status cli_suite_write_camera(suite_files *suite, const suite_scene *scene);
