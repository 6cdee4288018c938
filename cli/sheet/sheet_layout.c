/* The scale of a sheet, and where its panels are. */
#include "cli/sheet/sheet.h"

enum { MOST_PIXELS = 65535 };

double cli_round_step(double least) {
  double power = 1e-9;
  while (power * 10.0 <= least)
    power *= 10.0;
  return least <= power         ? power
         : least <= 2.0 * power ? 2.0 * power
         : least <= 5.0 * power ? 5.0 * power
                                : 10.0 * power;
}

/* Sets the pixels of a world unit, and with it the panels' sizes; returns 0 where one is too large. */
static int size_panels(cli_sheet_job *job) {
  int is_fine = 1;
  job->ppu = job->gsd > 0.0 ? 1.0 / job->gsd : job->dpi / 0.0254 * job->unit_m / job->scale;
  for (int i = 0; i < job->n_panels; i++) {
    cli_panel *panel = &job->panels[i];
    double free_px = ceil(1.5 * job->ppmm), size[2]; /* outlines stand free of the frame, but where a line ends */
    if (panel->kind == CLI_PANEL_LEGEND) {
      panel->width = job->legend_pixels * job->legend.width;
      panel->height = job->legend_pixels * job->legend.height;
      continue;
    }
    double pad[2] = {panel->has_line ? 0.0 : free_px, free_px};
    for (int axis = 0; axis < 2; axis++) {
      double extent = (panel->high[axis] - panel->low[axis]) * job->ppu;
      size[axis] = fmax(ceil(extent - 1e-6) + 2.0 * pad[axis], free_px);
      is_fine &= size[axis] <= MOST_PIXELS;
    }
    panel->left = panel->low[0] - pad[0] / job->ppu;
    panel->top = panel->high[1] + pad[1] / job->ppu;
    panel->width = is_fine ? (int)size[0] : 0;
    panel->height = is_fine ? (int)size[1] : 0;
  }
  return is_fine;
}

static int mm(const cli_sheet_job *job, double length) {
  return (int)floor(length * job->ppmm + 0.5);
}

/* Puts the panels side by side, and below each other where `most` pixels are not enough; those of a row stand on one
 * line. Returns 0 where one is wider. */
static int put_in_rows(cli_sheet_job *job, double most, double size[2]) {
  const int left = mm(job, CLI_ROOM_LEFT), right = mm(job, CLI_ROOM_RIGHT);
  size[0] = size[1] = 0.0;
  for (int first = 0, last; first < job->n_panels; first = last) {
    double x = 0.0;
    int height = 0;
    for (last = first; last < job->n_panels; last++) {
      cli_panel *panel = &job->panels[last];
      if (last > first && x + left + panel->width + right > most)
        break;
      panel->x = (int)x + left;
      x += left + panel->width + right;
      height = panel->height > height ? panel->height : height;
    }
    size[0] = fmax(size[0], x);
    size[1] += mm(job, CLI_ROOM_TOP) + height;
    for (int i = first; i < last; i++)
      job->panels[i].y = (int)size[1] - job->panels[i].height;
    size[1] += mm(job, CLI_ROOM_BOTTOM);
  }
  return size[0] <= most;
}

/* What words and the scale bar take at least. */
static double least_width(const cli_sheet_job *job) {
  return mm(job, CLI_SCALE_BAR + 50) + fmin(cli_text_length(job->title, mm(job, 4.2)), mm(job, 120));
}

/* Without a paper: rows whose sheet is the nearest to a paper's shape. */
static void choose_rows(cli_sheet_job *job, double size[2]) {
  double best = HUGE_VAL, best_width = 0.0, width = 0.0;
  for (int i = 0; i < job->n_panels; i++) {
    width += job->panels[i].width + mm(job, CLI_ROOM_LEFT) + mm(job, CLI_ROOM_RIGHT);
    if (!put_in_rows(job, width, size))
      continue;
    double ratio = fmax(size[0], least_width(job)) / (size[1] + mm(job, CLI_TITLE_HEIGHT)) / 1.4142;
    ratio = ratio < 1.0 ? 1.0 / ratio : ratio;
    if (ratio < best) {
      best = ratio;
      best_width = width;
    }
  }
  put_in_rows(job, best_width, size);
}

static void move_panels(cli_sheet_job *job, double right, double down) {
  for (int i = 0; i < job->n_panels; i++) {
    job->panels[i].x += (int)right;
    job->panels[i].y += (int)down;
  }
}

/* Returns 0 where the panels do not fit. */
static int fill_paper(cli_sheet_job *job) {
  const int margin = mm(job, CLI_SHEET_MARGIN), title = mm(job, CLI_TITLE_HEIGHT);
  double size[2];
  if (!size_panels(job))
    return 0;
  if (!job->is_paper_given) {
    choose_rows(job, size);
    double width = fmax(size[0], least_width(job)) + 2.0 * margin, height = size[1] + 2.0 * margin + title;
    if (width > MOST_PIXELS || height > MOST_PIXELS)
      return 0;
    job->width = (int)ceil(width);
    job->height = (int)ceil(height);
  } else {
    job->width = mm(job, job->paper_mm[0]);
    job->height = mm(job, job->paper_mm[1]);
    if (!put_in_rows(job, job->width - 2.0 * margin, size) || size[1] > job->height - 2.0 * margin - title)
      return 0;
  }
  move_panels(job, margin + floor(0.5 * (job->width - 2.0 * margin - size[0])),
              margin + floor(0.5 * (job->height - 2.0 * margin - title - size[1])));
  return 1;
}

/* The scales that drawings have. */
static double scale_at(int i) {
  static const double steps[] = {1.0, 2.0, 2.5, 5.0};
  double power = 1e-3;
  for (int k = 0; k < i / 4; k++)
    power *= 10.0;
  return steps[i % 4] * power;
}

conic_status cli_sheet_lay_out(cli_sheet_job *job) {
  enum { MOST_SCALES = 72, USUAL_MM = 400 };
  conic_context *context = job->session->context;
  int is_chosen = job->scale == 0.0 && job->gsd == 0.0, had_paper = job->is_paper_given, fits = 0;
  job->ppmm = job->dpi / 25.4;
  if (is_chosen && !had_paper) { /* as large as on an A3 */
    job->is_paper_given = 1;
    job->paper_mm[0] = 420.0;
    job->paper_mm[1] = 297.0;
  }
  for (int i = 0; i < MOST_SCALES && is_chosen && !fits; i++) {
    job->scale = scale_at(i);
    fits = fill_paper(job);
  }
  if (is_chosen)
    job->is_paper_given = had_paper;
  fits = fill_paper(job);
  if (job->gsd > 0.0)
    job->scale = job->dpi / 0.0254 * job->unit_m * job->gsd;
  if (!fits && !job->is_paper_given)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "%s: at 1:%.6g and %g dpi the sheet has more than %d pixels a side", job->scene.inputs[0],
                      job->scale, job->dpi, MOST_PIXELS);
  if (!fits)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: at 1:%.6g it does not fit on %g x %g mm of paper",
                      job->scene.inputs[0], job->scale, job->paper_mm[0], job->paper_mm[1]);
  return CONIC_OK;
}
