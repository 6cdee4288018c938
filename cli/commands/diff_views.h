/* The pictures of two folders or patterns, and which of them show the same view. */
#pragma once

#include "cli/commands/diff_job.h"

typedef struct cli_diff_file {
  char *path;
  const char *name; /* the part without folders */
  int n_stem;       /* letters of the name without pictures' endings, by which files are matched */
  long number;      /* of a frame, "name.NNNN"; -1: none */
} cli_diff_file;

typedef struct cli_diff_list {
  cli_diff_file *files; /* in the order of their names; numbers in names by value */
  size_t n;
} cli_diff_list;

typedef struct cli_diff_view {
  const cli_diff_file *files[2];
  conic_difference difference;
  int is_past;
} cli_diff_view;

typedef struct cli_diff_views {
  cli_diff_list lists[2];
  cli_diff_view *views; /* in the order of the first list */
  size_t n;
  unsigned char *has_view[2]; /* for each file of the lists */
  cli_diff_match match;       /* how they were matched */
} cli_diff_views;

/* Lists both and matches them. The caller releases them with cli_diff_views_release, after a failure, too. Returns the
 * exit code, after a message. */
int cli_diff_views_find(const cli_diff_job *job, cli_diff_views *views);
void cli_diff_views_release(cli_diff_views *views);
