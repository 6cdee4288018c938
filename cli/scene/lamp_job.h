/* Lights that have a size or a place: --light with a radius, and lamps. */
#pragma once

#include "cli/json_write.h"
#include "cli/session.h"

struct cli_render_job;

/* Part of a cli_render_job. */
typedef struct cli_lamp_job {
  float sun_radius_deg[CONIC_MAX_LIGHTS]; /* of the options' lights */
  conic_lamp lamps[CONIC_MAX_LAMPS];      /* their axes once it is known what points up */
  double ahead[CONIC_MAX_LAMPS][3];       /* of one that is flat, where it shines to, of unit length */
  double upward[CONIC_MAX_LAMPS][3];      /* … and where to its height goes; zero: as what points up in the scene */
  double half[CONIC_MAX_LAMPS][2];        /* of its width and height */
  int n_lamps;
  int is_warned;
} cli_lamp_job;

/* What is behind lamp: in --light: X,Y,Z[:COLOR[:SIZE[:X,Y,Z[:X,Y,Z]]]], where SIZE is a radius, or WxH; 0: it is
 * none. */
int cli_parse_lamp(const char *text, struct cli_render_job *job);

/* The radius of a light's disc, such as 2deg. */
int cli_parse_sun_radius(const char *text, float *radius_deg);

/* Whether accumulation makes any of the lights softer. */
int cli_lamps_are_soft(const struct cli_render_job *job);

/* Lays the axes of flat lamps: the width at a right angle to what points up. */
void cli_lamps_turn(struct cli_render_job *job);

/* Says, once, what of the options about light changes nothing. */
void cli_lamps_warn(cli_session *session, struct cli_render_job *job);

/* The key "lamps" of the statistics, where there are any. */
void cli_lamps_report(cli_json *json, const struct cli_render_job *job);
