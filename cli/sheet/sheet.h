/* conic sheet: measured drawings on paper. Each panel is an orthographic shot of the scene, of whole pixels of the
 * sheet; around them stand frames, grids and words. */
#pragma once

#include "cli/scene/render_job.h"
#include "cli/sheet/strokes.h"
#include "cli/top/top_store.h"
#include "core/pictures/georeference.h"

enum { CLI_MOST_PANELS = 24 };

typedef enum cli_panel_kind {
  CLI_PANEL_PLAN = 0,
  CLI_PANEL_FACADE = 1,
  CLI_PANEL_SECTION = 2,
  CLI_PANEL_LEGEND
} cli_panel_kind;

typedef struct cli_panel {
  /* What was asked for. */
  cli_panel_kind kind;
  int has_line;       /* from A to B, in the plan's coordinates; else by azimuth */
  double ends[2][2];  /* A and B */
  double azimuth_deg; /* where the viewer stands */
  double depth;       /* of a section's band, in world units; 0: as much as is visible on paper */

  /* Where it is in the world: unit directions to the right, up and away from the viewer, and what part of the first
   * two is on the panel. Places along a line count from A; coordinates of the file are places times the signs. */
  double axes[3][3], low[2], high[2], from_line, signs[2];
  double near_away, box_away[2]; /* along the third: of a line's plane, and of the scene's box */
  char letter;                   /* of its line's ends on the plan, A and A'; 0: it has none */
  char caption[96];

  double left, top;        /* the world's places at its left and upper edges */
  int x, y, width, height; /* on the sheet, in pixels */
  cli_top_store store;     /* its pixels: R, G, B, a byte each */
} cli_panel;

typedef struct cli_sheet_job {
  cli_session *session;
  cli_render_job scene;
  const char *output, *title;
  cli_panel panels[CLI_MOST_PANELS];
  int n_panels;
  conic_image legend; /* of values that are coloured: the last panel, several pixels a pixel */
  int legend_pixels;
  double scale; /* 1:scale; 0: as fits */
  double gsd;   /* world units of a pixel; 0: by the scale */
  double dpi, paper_mm[2];
  int is_paper_given, is_unit_given;
  double unit_m;    /* metres of a world unit */
  const char *unit; /* its sign */
  double beyond;    /* what lies behind a section's band is drawn so far; infinite: all */
  double grid;      /* from one line to the next, in world units; 0: as fits */
  double north_deg; /* of north from the plan's up, clockwise */
  int is_north_given;
  uint64_t memory_bytes; /* of a panel's pixels while they are drawn */

  conic_georeference reference;
  double axis_signs[2]; /* by which a coordinate of the file is one along the plan's right and up */
  double ppu, ppmm;     /* pixels of a world unit, and of a millimetre of paper */
  int width, height;    /* of the sheet in pixels */
  cli_strokes strokes;
  conic_render_statistics statistics; /* of the panels together */
  double draw_seconds, write_seconds;
} cli_sheet_job;

/* What the panels show of an open scene, and which way they look. Errors: ARGUMENT. */
conic_status cli_sheet_place(cli_sheet_job *job);
/* Sets the scale, unless it is given, and where on the sheet each panel is. Errors: ARGUMENT (no such paper). */
conic_status cli_sheet_lay_out(cli_sheet_job *job);
/* The exposure of all panels, where it is to be found, is one panel's. */
conic_status cli_panel_expose(cli_sheet_job *job, const cli_panel *panel);
/* Draws a panel into its store. Collective, where several processes share pictures. */
conic_status cli_panel_draw(cli_sheet_job *job, cli_panel *panel);
/* The strokes around the panels, and on them. Errors: MEMORY. */
conic_status cli_sheet_letter(cli_sheet_job *job);
/* Writes the sheet. Errors: IO, MEMORY, UNSUPPORTED. */
conic_status cli_sheet_write(cli_sheet_job *job);

/* 1, 2 or 5 times a power of ten: the least that is no less. */
double cli_round_step(double least);

/* Room around a panel for its words, and around all, in millimetres of paper. */
enum { CLI_ROOM_LEFT = 8, CLI_ROOM_TOP = 7, CLI_ROOM_RIGHT = 3, CLI_ROOM_BOTTOM = 6, CLI_SHEET_MARGIN = 10 };
enum { CLI_TITLE_HEIGHT = 18, CLI_SCALE_BAR = 60 };
