/* Where panels look, and what part of the scene is on each. */
#include "cli/sheet/sheet.h"
#include "core/base/vectors.h"
#include "core/image/framing.h"

/* What rounding leaves of a zero would shift coordinates of maps. */
static void clean_axis(double axis[3]) {
  for (int i = 0; i < 3; i++)
    if (fabs(axis[i]) < 1e-14)
      axis[i] = 0.0;
    else if (fabs(fabs(axis[i]) - 1.0) < 1e-14)
      axis[i] = axis[i] > 0.0 ? 1.0 : -1.0;
}

/* Right, up and away of a viewer at an azimuth, level with the scene or above it. */
static void find_axes(const cli_sheet_job *job, double azimuth_deg, double elevation_deg, double axes[3][3]) {
  conic_framing framing = job->scene.framing;
  double rows[3][3];
  framing.azimuth_deg = azimuth_deg;
  framing.elevation_deg = elevation_deg;
  if (!job->scene.is_up_given)
    memcpy(framing.up, conic_source_measure(job->scene.source)->up, sizeof framing.up);
  conic_framing_rotation(&framing, rows);
  for (int i = 0; i < 3; i++) {
    axes[0][i] = rows[0][i];
    axes[1][i] = -rows[1][i];
    axes[2][i] = rows[2][i];
  }
  for (int i = 0; i < 3; i++)
    clean_axis(axes[i]);
}

/* By which a coordinate of the file is a place along a direction: -1 against one of its axes, else 1. */
static double sign_along(const double axis[3]) {
  for (int i = 0; i < 3; i++)
    if (axis[i] == -1.0)
      return -1.0;
  return 1.0;
}

/* The scene's box along a direction. */
static void span_box(const cli_sheet_job *job, const double axis[3], double span[2]) {
  const conic_source_scale *scale = conic_source_measure(job->scene.source);
  span[0] = span[1] = 0.0;
  for (int i = 0; i < 3; i++) {
    const double a = axis[i] * scale->minimum[i], b = axis[i] * scale->maximum[i];
    span[0] += a < b ? a : b;
    span[1] += a < b ? b : a;
  }
}

/* Along a line from A, which is on the left, to B. */
static conic_status face_line(cli_sheet_job *job, cli_panel *panel, const double plan[3][3]) {
  double along[2], at[3], down[3];
  for (int i = 0; i < 2; i++)
    along[i] = job->axis_signs[i] * (panel->ends[1][i] - panel->ends[0][i]);
  double length = sqrt(along[0] * along[0] + along[1] * along[1]);
  for (int i = 0; i < 3; i++) {
    panel->axes[0][i] = (plan[0][i] * along[0] + plan[1][i] * along[1]) / length;
    at[i] = job->axis_signs[0] * panel->ends[0][0] * plan[0][i] + job->axis_signs[1] * panel->ends[0][1] * plan[1][i];
    panel->axes[1][i] = -plan[2][i];
    down[i] = plan[2][i];
  }
  conic_cross(panel->axes[0], down, panel->axes[2]);
  for (int i = 0; i < 3; i++)
    clean_axis(panel->axes[i]);
  panel->from_line = panel->low[0] = conic_dot(at, panel->axes[0]);
  panel->high[0] = panel->low[0] + length;
  panel->near_away = conic_dot(at, panel->axes[2]);
  span_box(job, panel->axes[2], panel->box_away);
  if (length > 0.0 && panel->near_away < panel->box_away[1])
    return CONIC_OK;
  return conic_fail(job->session->context, CONIC_ERROR_ARGUMENT,
                    "%s: a line from A to B has a length, and something of the scene behind it", job->scene.inputs[0]);
}

static void name_facade(const cli_sheet_job *job, cli_panel *panel) {
  static const char *const north[] = {"South", "South-east", "East", "North-east",
                                      "North", "North-west", "West", "South-west"};
  static const char *const local[] = {"Front", "Right", "Back", "Left"};
  int has_north = job->reference.keys != NULL || job->is_north_given;
  double azimuth = panel->azimuth_deg + (has_north ? job->north_deg : 0.0);
  azimuth -= 360.0 * floor(azimuth / 360.0);
  int eighth = (int)floor(azimuth / 45.0 + 0.5) % 8;
  if (has_north)
    snprintf(panel->caption, sizeof panel->caption,
             "%s fa\xc3\xa7"
             "ade",
             north[eighth]);
  else if (azimuth == 90.0 * floor(azimuth / 90.0))
    snprintf(panel->caption, sizeof panel->caption, "%s", local[(int)(azimuth / 90.0) % 4]);
  else
    snprintf(panel->caption, sizeof panel->caption,
             "Fa\xc3\xa7"
             "ade from %g\xc2\xb0",
             azimuth);
}

static conic_status place_panel(cli_sheet_job *job, cli_panel *panel, const double plan[3][3], int *n_lines) {
  const conic_source_scale *scale = conic_source_measure(job->scene.source);
  double reach = scale->n_triangles ? 0.0 : scale->splat_length;
  conic_status status = CONIC_OK;
  find_axes(job, panel->azimuth_deg, panel->kind == CLI_PANEL_PLAN ? 90.0 : 0.0, panel->axes);
  span_box(job, panel->axes[2], panel->box_away);
  if (panel->has_line) {
    panel->letter = (char)('A' + (*n_lines)++);
    status = face_line(job, panel, plan);
  }
  for (int i = panel->has_line; i < 2 && status == CONIC_OK; i++) {
    double span[2];
    span_box(job, panel->axes[i], span);
    panel->low[i] = span[0] - reach;
    panel->high[i] = span[1] + reach;
  }
  panel->signs[0] = panel->has_line ? 1.0 : sign_along(panel->axes[0]);
  panel->signs[1] = sign_along(panel->axes[1]);
  if (panel->kind == CLI_PANEL_PLAN)
    snprintf(panel->caption, sizeof panel->caption, "Plan");
  else if (panel->has_line)
    snprintf(panel->caption, sizeof panel->caption, "%s %c\xe2\x80\x93%c\xe2\x80\x99",
             panel->kind == CLI_PANEL_SECTION ? "Section" : "View", panel->letter, panel->letter);
  else
    name_facade(job, panel);
  return status;
}

conic_status cli_sheet_place(cli_sheet_job *job) {
  double plan[3][3];
  int n_lines = 0;
  conic_status status = CONIC_OK;
  find_axes(job, 0.0, 90.0, plan);
  for (int i = 0; i < 2; i++)
    job->axis_signs[i] = sign_along(plan[i]);
  for (int i = 0; i < job->n_panels && status == CONIC_OK; i++)
    if (job->panels[i].kind != CLI_PANEL_LEGEND)
      status = place_panel(job, &job->panels[i], (const double(*)[3])plan, &n_lines);
  return status;
}
