/* The shot of a picture as text: what is written of it, and what it is drawn again from. */
#pragma once

#include "shots/shot_inputs.h"

/* Part of a cli_render_job. */
typedef struct cli_shot_job {
  const char *save_path;        /* --save-shot; null: none */
  int is_left_out;              /* --no-shot: pictures do not carry it */
  int has_inputs;               /* the next are known: */
  conic_shot_inputs inputs;     /* of all frames */
  char *text;                   /* of the frame that is drawn, for files of what was drawn */
  char *shown_text;             /* the same for those that show it: with their curve, and what is behind */
  const char *again_path;       /* --again; null: none */
  struct cli_shot_again *again; /* what is drawn again (cli/render/shot_again.h); null: nothing */
  /* Of what is drawn again, while the arguments are read: its inputs, and what it says of options (scene_options.h). */
  const char *const *scene;
  int n_scene;
  const struct cli_scene_words *words;
} cli_shot_job;

struct cli_render_job;
struct cli_session;

/* What cli_scene_parse returns where the arguments name a shot, so that they have to be read again with it. */
enum { CLI_AGAIN = -2 };

/* Whether they do, now that they are read once. */
int cli_shot_is_again(const struct cli_session *session, const struct cli_render_job *job);
