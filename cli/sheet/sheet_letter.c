/* What stands on a sheet beside pictures: frames, grids with coordinates, captions, the lines of sections, a scale bar,
 * a north arrow, and the title. */
#include "cli/sheet/sheet.h"
#include "core/base/trigonometry.h"
#include "core/files/file.h"

/* Millimetres of paper: strokes, and heights of capitals. */
static const double thin = 0.13, medium = 0.2, strong = 0.35;
static const double small_text = 1.8, plain_text = 2.4, title_text = 4.2;

typedef struct lettering {
  cli_sheet_job *job;
  double mm; /* pixels */
} lettering;

static void write_text(const lettering *l, const char *text, double x, double y, double height_mm, double anchor,
                       int is_upwards) {
  const cli_lettering how = {.height = height_mm * l->mm,
                             .weight = (height_mm > 3.0 ? 0.13 : 0.115) * height_mm * l->mm,
                             .anchor = anchor,
                             .is_upwards = is_upwards,
                             .grey = 0.08f};
  cli_strokes_text(&l->job->strokes, text, x, y, &how);
}

static void draw_frame(const lettering *l, double x, double y, double width, double height, double weight) {
  cli_strokes *s = &l->job->strokes;
  double w = weight * l->mm;
  cli_strokes_block(s, x - w, y - w, width + 2.0 * w, w, 0.0f);
  cli_strokes_block(s, x - w, y + height, width + 2.0 * w, w, 0.0f);
  cli_strokes_block(s, x - w, y, w, height, 0.0f);
  cli_strokes_block(s, x + width, y, w, height, 0.0f);
}

/* --- grids --- */

/* Marks along one side of a panel: coordinates are sign · (place − origin). */
typedef struct scale_marks {
  double first, extent; /* the place at pixel 0, and the pixels' number */
  double sign, origin, step;
  int is_down;    /* places grow against the pixels */
  int n_decimals; /* of the step */
} scale_marks;

static scale_marks marks_of(const cli_sheet_job *job, const cli_panel *panel, int axis) {
  scale_marks marks = {.first = axis == 0 ? panel->left : panel->top,
                       .extent = axis == 0 ? panel->width : panel->height,
                       .is_down = axis == 1,
                       .sign = panel->signs[axis],
                       .origin = axis == 0 ? panel->from_line : 0.0};
  marks.step = job->grid > 0.0 ? job->grid : cli_round_step(20.0 * job->ppmm / job->ppu);
  for (double step = marks.step; fabs(step - floor(step + 0.5)) > 1e-6 * step && marks.n_decimals < 9; step *= 10.0)
    marks.n_decimals++;
  return marks;
}

/* The pixels from the panel's edge, and the coordinate, of mark i from the edge on; returns 0 past the last. */
static int mark_at(const cli_sheet_job *job, const scale_marks *marks, int i, double *px, double *coordinate) {
  double direction = marks->is_down ? -marks->sign : marks->sign; /* of coordinates along the pixels */
  double at_edge = marks->sign * (marks->first - marks->origin) / marks->step;
  double number = direction > 0.0 ? ceil(at_edge - 1e-9) + i : floor(at_edge + 1e-9) - i;
  *coordinate = number * marks->step;
  double place = marks->sign * *coordinate + marks->origin;
  *px = (marks->is_down ? marks->first - place : place - marks->first) * job->ppu;
  return *px <= marks->extent + 1e-6;
}

static void draw_marks(const lettering *l, const cli_panel *panel) {
  const cli_sheet_job *job = l->job;
  cli_strokes *s = &l->job->strokes;
  const scale_marks across = marks_of(job, panel, 0), down = marks_of(job, panel, 1);
  const double tick = 1.3 * l->mm, w = medium * l->mm;
  double x, y, value, last = -HUGE_VAL;
  char text[48];
  for (int i = 0; mark_at(job, &across, i, &x, &value); i++) {
    x += panel->x;
    cli_strokes_block(s, x - 0.5 * w, panel->y + panel->height, w, tick, 0.0f);
    cli_strokes_block(s, x - 0.5 * w, panel->y - 0.6 * tick, w, 0.6 * tick, 0.0f);
    snprintf(text, sizeof text, "%.*f", across.n_decimals, value + 0.0);
    double half = 0.5 * cli_text_length(text, small_text * l->mm);
    if (x - half < last + 1.5 * l->mm)
      continue;
    write_text(l, text, x, panel->y + panel->height + 3.7 * l->mm, small_text, 0.5, 0);
    last = x + half;
  }
  last = -HUGE_VAL;
  for (int i = 0; mark_at(job, &down, i, &y, &value); i++) {
    y += panel->y;
    cli_strokes_block(s, panel->x - tick, y - 0.5 * w, tick, w, 0.0f);
    cli_strokes_block(s, panel->x + panel->width, y - 0.5 * w, 0.6 * tick, w, 0.0f);
    snprintf(text, sizeof text, "%.*f", down.n_decimals, value + 0.0);
    double half = 0.5 * cli_text_length(text, small_text * l->mm);
    if (y - half < last + 1.5 * l->mm)
      continue;
    write_text(l, text, panel->x - 2.2 * l->mm, y, small_text, 0.5, 1);
    last = y + half;
  }
  double cross = 1.2 * l->mm;
  for (int i = 0; panel->kind == CLI_PANEL_PLAN && mark_at(job, &across, i, &x, &value); i++)
    for (int k = 0; mark_at(job, &down, k, &y, &value); k++) {
      if (x < cross || y < cross || x > panel->width - cross || y > panel->height - cross)
        continue;
      for (int ink = 1; ink >= 0; ink--) { /* on a white ground, which pictures of any shade let see */
        double weight = (ink ? thin + 0.22 : thin) * l->mm;
        cli_strokes_line(s, panel->x + x - cross, panel->y + y, panel->x + x + cross, panel->y + y, weight, (float)ink);
        cli_strokes_line(s, panel->x + x, panel->y + y - cross, panel->x + x, panel->y + y + cross, weight, (float)ink);
      }
    }
}

/* --- lines of sections on a plan --- */

/* A place of a line's panel on the plan, in pixels of the sheet. */
static void place_on_plan(const cli_sheet_job *job, const cli_panel *plan, const double end[2], double at[2]) {
  at[0] = plan->x + (job->axis_signs[0] * end[0] - plan->left) * job->ppu;
  at[1] = plan->y + (plan->top - job->axis_signs[1] * end[1]) * job->ppu;
}

/* The part of a line within a panel, from t[0] to t[1] of it; returns 0 where there is none. */
static int clip_line(const cli_panel *panel, const double a[2], const double b[2], double t[2]) {
  const double low[2] = {panel->x, panel->y}, high[2] = {panel->x + panel->width, panel->y + panel->height};
  t[0] = 0.0;
  t[1] = 1.0;
  for (int axis = 0; axis < 2; axis++) {
    double step = b[axis] - a[axis];
    double first = (low[axis] - a[axis]) / step, last = (high[axis] - a[axis]) / step;
    if (step == 0.0 && (a[axis] < low[axis] || a[axis] > high[axis]))
      return 0;
    if (step == 0.0)
      continue;
    t[0] = fmax(t[0], fmin(first, last));
    t[1] = fmin(t[1], fmax(first, last));
  }
  return t[0] < t[1];
}

/* Dashes and dots, with an end in bold that has a letter and points the way that the viewer looks. */
static void draw_line_on_plan(const lettering *l, const cli_panel *plan, const cli_panel *line) {
  cli_strokes *s = &l->job->strokes;
  double ends[2][2], t[2];
  place_on_plan(l->job, plan, line->ends[0], ends[0]);
  place_on_plan(l->job, plan, line->ends[1], ends[1]);
  double along[2] = {ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]};
  double length = sqrt(along[0] * along[0] + along[1] * along[1]);
  if (!clip_line(plan, ends[0], ends[1], t))
    return;
  along[0] /= length;
  along[1] /= length;
  static const double dashes[] = {3.5, 0.9, 0.3, 0.9};
  double at = t[0] * length;
  for (int i = 0; at < t[1] * length; i = (i + 1) % 4) {
    double end = fmin(at + dashes[i] * l->mm, t[1] * length);
    for (int ink = 1; ink >= 0 && i % 2 == 0; ink--)
      cli_strokes_line(s, ends[0][0] + at * along[0], ends[0][1] + at * along[1], ends[0][0] + end * along[0],
                       ends[0][1] + end * along[1], (ink ? strong + 0.3 : 0.25) * l->mm, (float)ink);
    at = end;
  }
  for (int i = 0; i < 2; i++) {
    double x = ends[0][0] + t[i] * length * along[0], y = ends[0][1] + t[i] * length * along[1];
    double in = i == 0 ? 1.0 : -1.0, arm = 2.6 * l->mm; /* towards the middle, and the way that is looked */
    const double tip[2] = {x + arm * along[1], y - arm * along[0]};
    const double letter[2] = {x + in * 3.0 * l->mm * along[0] - 2.4 * l->mm * along[1],
                              y + in * 3.0 * l->mm * along[1] + 2.4 * l->mm * along[0]};
    const char name[] = {line->letter, i ? '\'' : '\0', '\0'};
    for (int ink = 1; ink >= 0; ink--) {
      double weight = (ink ? strong + 0.3 : strong) * l->mm;
      cli_strokes_line(s, x, y, tip[0], tip[1], weight, (float)ink);
      for (int side = -1; side <= 1; side += 2)
        cli_strokes_line(s, tip[0], tip[1], tip[0] - 1.0 * l->mm * along[1] + side * 0.6 * l->mm * along[0],
                         tip[1] + 1.0 * l->mm * along[0] + side * 0.6 * l->mm * along[1], weight, (float)ink);
      const cli_lettering how = {2.6 * l->mm, (ink ? 0.9 : 0.32) * l->mm, 0.5, 0, (float)ink};
      cli_strokes_text(s, name, letter[0], letter[1] + 1.3 * l->mm, &how);
    }
  }
}

/* Where a section cuts triangles, which have no thickness by themselves: what is solid has its outline. */
static void draw_cut(const lettering *l, const cli_panel *panel) {
  const conic_triangles *set = conic_source_chosen(l->job->scene.source)->drawing.triangles;
  for (size_t i = 0; set && i < set->count; i++) {
    double at[3][3], ends[2][2], t[2]; /* to the right, up and away from the plane */
    int n = 0;
    for (int k = 0; k < 3; k++) {
      const uint32_t vertex = set->corners[i][k];
      for (int axis = 0; axis < 3; axis++) {
        at[k][axis] = axis == 2 ? -panel->near_away : 0.0;
        for (int c = 0; c < 3; c++)
          at[k][axis] += panel->axes[axis][c] * (set->origin[c] + (double)set->position[c][vertex]);
      }
    }
    for (int k = 0; k < 3 && n < 2; k++) {
      const double *a = at[k], *b = at[(k + 1) % 3], share = a[2] / (a[2] - b[2]);
      if ((a[2] < 0.0) == (b[2] < 0.0))
        continue;
      ends[n][0] = panel->x + (a[0] + share * (b[0] - a[0]) - panel->left) * l->job->ppu;
      ends[n++][1] = panel->y + (panel->top - a[1] - share * (b[1] - a[1])) * l->job->ppu;
    }
    if (n == 2 && clip_line(panel, ends[0], ends[1], t)) {
      const double along[2] = {ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]};
      cli_strokes_line(&l->job->strokes, ends[0][0] + t[0] * along[0], ends[0][1] + t[0] * along[1],
                       ends[0][0] + t[1] * along[0], ends[0][1] + t[1] * along[1], strong * l->mm, 0.0f);
    }
  }
}

static void letter_panel(const lettering *l, const cli_panel *panel) {
  const cli_sheet_job *job = l->job;
  if (panel->kind == CLI_PANEL_LEGEND)
    return;
  if (panel->kind == CLI_PANEL_SECTION)
    draw_cut(l, panel);
  draw_frame(l, panel->x, panel->y, panel->width, panel->height, medium);
  draw_marks(l, panel);
  write_text(l, panel->caption, panel->x, panel->y - 2.0 * l->mm, plain_text, 0.0, 0);
  for (int i = 0; i < job->n_panels && panel->kind == CLI_PANEL_PLAN; i++)
    if (job->panels[i].has_line)
      draw_line_on_plan(l, panel, &job->panels[i]);
}

/* --- the foot of the sheet --- */

/* A whole number of round units, as long as fits. */
static void draw_scale_bar(const lettering *l, double right, double y) {
  cli_sheet_job *job = l->job;
  cli_strokes *s = &job->strokes;
  enum { PARTS = 5 };
  double most = CLI_SCALE_BAR * l->mm / PARTS / job->ppu, part = cli_round_step(most);
  part = part > most ? cli_round_step(part / 2.6) : part;
  double length = part * job->ppu, x = right - PARTS * length, height = 1.3 * l->mm;
  char text[64];
  for (int i = 0; i <= PARTS; i++) {
    snprintf(text, sizeof text, i == PARTS ? "%.10g %s" : "%.10g", part * i, job->unit);
    double anchor = 0.5;
    if (i == PARTS) /* the number is in the middle, and the unit behind it */
      anchor -= 0.5 * cli_text_length(job->unit, 1.0) / cli_text_length(text, 1.0);
    write_text(l, text, x + i * length, y - 1.3 * l->mm, small_text, anchor, 0);
    if (i < PARTS)
      cli_strokes_block(s, x + i * length, y, length, height, i % 2 ? 1.0f : 0.0f);
  }
  draw_frame(l, x, y, PARTS * length, height, thin);
  snprintf(text, sizeof text, job->scale >= 1.0 ? "1:%.6g" : "%.6g:1", job->scale >= 1.0 ? job->scale : 1 / job->scale);
  write_text(l, text, x, y - 4.8 * l->mm, 3.0, 0.0, 0);
}

static void draw_north(const lettering *l, double x, double y) {
  cli_strokes *s = &l->job->strokes;
  double angle = conic_radians(l->job->north_deg), up[2] = {conic_sin(angle), -conic_cos(angle)};
  double size = 5.5 * l->mm, half = 1.9 * l->mm;
  double tip[2] = {x + size * up[0], y + size * up[1]}, foot[2] = {x - size * up[0], y - size * up[1]};
  double notch[2] = {x - 0.55 * size * up[0], y - 0.55 * size * up[1]};
  for (int side = -1; side <= 1; side += 2) { /* the left half is filled */
    double wing[2] = {foot[0] - side * half * up[1], foot[1] + side * half * up[0]};
    for (int i = 0; i < 40 && side < 0; i++) {
      double t = i / 39.0;
      cli_strokes_line(s, tip[0], tip[1], wing[0] + t * (notch[0] - wing[0]), wing[1] + t * (notch[1] - wing[1]),
                       medium * l->mm, 0.0f);
    }
    cli_strokes_line(s, tip[0], tip[1], wing[0], wing[1], medium * l->mm, 0.0f);
    cli_strokes_line(s, wing[0], wing[1], notch[0], notch[1], medium * l->mm, 0.0f);
  }
  const double at[2] = {x + (size + 2.4 * l->mm) * up[0], y + (size + 2.4 * l->mm) * up[1]};
  write_text(l, "N", at[0], at[1] + 1.1 * l->mm, 2.2, 0.5, 0);
}

static void describe_sheet(const cli_sheet_job *job, char *text, size_t room) {
  const conic_georeference *reference = &job->reference;
  char system[48] = "";
  if (reference->epsg)
    snprintf(system, sizeof system, "   EPSG:%u", reference->epsg);
  const char *name = conic_file_name(job->scene.inputs[0]);
  const conic_source_scale *scale = conic_source_measure(job->scene.source);
  char wide[96] = ""; /* as a splat reaches beyond the last point */
  if (scale->n_splats && scale->splat_length > 0.0)
    snprintf(wide, sizeof wide, "   outlines of points lie about %.2g %s outside", scale->splat_length, job->unit);
  snprintf(text, room, "%.80s%s   coordinates in %s%s", strcmp(name, job->title) ? name : "", system, job->unit, wide);
}

static void letter_foot(const lettering *l) {
  cli_sheet_job *job = l->job;
  const double margin = CLI_SHEET_MARGIN * l->mm, right = job->width - margin, bottom = job->height - margin;
  double top = bottom - (CLI_TITLE_HEIGHT - 4) * l->mm, bar_right = right - 5.0 * l->mm;
  int has_plan = 0;
  char text[256];
  for (int i = 0; i < job->n_panels; i++)
    has_plan |= job->panels[i].kind == CLI_PANEL_PLAN;
  draw_frame(l, 0.5 * margin, 0.5 * margin, job->width - margin, job->height - margin, strong);
  cli_strokes_block(&job->strokes, margin, top, right - margin, medium * l->mm, 0.0f);
  if (has_plan && (job->reference.keys || job->is_north_given)) {
    draw_north(l, right - 5.0 * l->mm, top + 10.2 * l->mm);
    bar_right -= 12.0 * l->mm;
  }
  draw_scale_bar(l, bar_right, top + 10.5 * l->mm);
  double most = bar_right - (CLI_SCALE_BAR + 4) * l->mm - margin, height = title_text;
  double length = cli_text_length(job->title, height * l->mm);
  height *= length > most ? fmax(most / length, 0.2) : 1.0;
  write_text(l, job->title, margin, top + 6.9 * l->mm, height, 0.0, 0);
  describe_sheet(job, text, sizeof text);
  length = cli_text_length(text, small_text * l->mm);
  write_text(l, text, margin, top + 11.8 * l->mm, small_text * (length > most ? fmax(most / length, 0.2) : 1.0), 0.0,
             0);
}

conic_status cli_sheet_letter(cli_sheet_job *job) {
  const lettering l = {job, job->ppmm};
  job->strokes.context = job->session->context;
  for (int i = 0; i < job->n_panels; i++)
    letter_panel(&l, &job->panels[i]);
  letter_foot(&l);
  return job->strokes.status;
}
