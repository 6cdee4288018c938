/* A panel's picture: an orthographic shot, in bands of rows where it is large. */
#include "cli/render/fill_shot.h"
#include "cli/render/units.h"
#include "cli/sheet/sheet.h"
#include "core/pictures/image_samples.h"

/* Views of orthographic cameras lie in blocks of so many rows (conic/gather.h): bands of these have the same bits as
 * the whole. */
enum { BLOCK_ROWS = 256, MOST_SAMPLED = 65535 };

/* Where the camera is: so far before the plane of the line, or before all of the scene. */
static double stand_back(const cli_panel *panel) {
  return 1.0 + panel->box_away[1] - panel->box_away[0];
}

static double first_away(const cli_panel *panel) {
  return panel->has_line ? panel->near_away : panel->box_away[0];
}

static conic_camera camera_of(const cli_sheet_job *job, const cli_panel *panel, int first_row, int n_rows) {
  conic_camera camera = {.width = panel->width,
                         .height = n_rows,
                         .fx = job->ppu,
                         .fy = job->ppu,
                         .cy = -(double)first_row,
                         .kind = CONIC_CAMERA_ORTHOGRAPHIC};
  for (int i = 0; i < 3; i++) {
    camera.cam_from_world[0][i] = panel->axes[0][i];
    camera.cam_from_world[1][i] = -panel->axes[1][i];
    camera.cam_from_world[2][i] = panel->axes[2][i];
  }
  camera.cam_from_world[0][3] = -panel->left;
  camera.cam_from_world[1][3] = panel->top;
  camera.cam_from_world[2][3] = stand_back(panel) - first_away(panel);
  return camera;
}

/* On white paper. Of a section, what is cut is dark, and what lies behind it light, or not there. What covers no middle
 * of a pixel has no depth, and is not cut. */
static void put_on_paper(const cli_sheet_job *job, const cli_panel *panel, const conic_image *image) {
  float *rgba = image->planes[CONIC_PLANE_RGBA];
  const float *z = image->planes[CONIC_PLANE_Z];
  const double cut = stand_back(panel) + panel->depth, last = cut + job->beyond;
  for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
    float *pixel = rgba + 4 * i, share = 1.0f, paper = 0.0f;
    const double depth = panel->kind != CLI_PANEL_SECTION ? 0.0
                         : z[i] > 0.0f                    ? (double)z[i]
                                                          : stand_back(panel) + panel->box_away[1] - panel->near_away;
    if (panel->kind == CLI_PANEL_SECTION && depth <= cut)
      share = 0.0f;
    else if (panel->kind == CLI_PANEL_SECTION && depth <= last)
      share = 0.6f, paper = 0.4f;
    else if (panel->kind == CLI_PANEL_SECTION)
      memset(pixel, 0, 4 * sizeof *pixel);
    for (int c = 0; c < 3; c++)
      pixel[c] = share * pixel[c] + paper * pixel[3] + (1.0f - pixel[3]);
    pixel[3] = 1.0f;
  }
}

/* Keeps the rows from first_row to before end_row, of an image that begins at image_row. */
static conic_status keep_rows(cli_sheet_job *job, cli_panel *panel, const conic_image *image, int image_row,
                              const int kept[2]) {
  conic_context *context = job->session->context;
  const conic_samples_layout bytes = {.n_channels = 3, .sample_bytes = 1, .is_display = image->is_display != 0};
  size_t width = (size_t)image->width;
  unsigned char *rows = conic_memory_allocate(context, width * (size_t)image->height, 3);
  conic_status status = rows ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (rows)
    conic_samples_from_rgba(context, image->planes[CONIC_PLANE_RGBA], image->width, image->height, bytes, rows);
  for (int y = kept[0]; y < kept[1] && status == CONIC_OK; y++)
    status = cli_top_store_put(&panel->store, 0, (size_t)y, rows + 3 * width * (size_t)(y - image_row), width);
  conic_memory_release(context, rows);
  return status;
}

static void look_at_rows(cli_sheet_job *job, const cli_panel *panel, int first_row, int n_rows) {
  cli_render_job *scene = &job->scene;
  scene->shot.camera = camera_of(job, panel, first_row, n_rows);
  scene->shot.render.near_z = (panel->has_line ? 1.0 : 0.5) * stand_back(panel);
}

conic_status cli_panel_expose(cli_sheet_job *job, const cli_panel *panel) {
  look_at_rows(job, panel, 0, panel->height);
  return cli_choose_exposure(&job->scene);
}

/* Pixels may take light from others: what is kept has as many rows around it as reach it. */
static conic_status draw_rows(cli_sheet_job *job, cli_panel *panel, const int kept[2]) {
  cli_render_job *scene = &job->scene;
  conic_image image = {0};
  conic_shot_outcome outcome;
  int makes = cli_units_make_picture(job->session, scene), is_domed = scene->shot.light.dome_stops > 0.0;
  int first_row = is_domed && kept[0] > BLOCK_ROWS ? kept[0] - BLOCK_ROWS : 0;
  int end_row = is_domed && kept[1] + BLOCK_ROWS < panel->height ? kept[1] + BLOCK_ROWS : panel->height;
  first_row = is_domed ? first_row : kept[0];
  end_row = is_domed ? end_row : kept[1];
  int n_rows = end_row - first_row;
  look_at_rows(job, panel, first_row, n_rows);
  conic_status status = conic_image_allocate(job->session->context, panel->width, n_rows, scene->shot.planes, &image);
  if (status == CONIC_OK)
    status = cli_render_picture(scene, &image, &outcome);
  if (status == CONIC_OK && makes) {
    job->statistics.pixels_covered += outcome.statistics.pixels_covered;
    put_on_paper(job, panel, &image);
    status = keep_rows(job, panel, &image, first_row, kept);
  }
  conic_image_release(job->session->context, &image);
  return status;
}

/* On white paper, each of its pixels as a square. */
static conic_status draw_legend(cli_sheet_job *job, cli_panel *panel) {
  conic_context *context = job->session->context;
  const conic_samples_layout bytes = {.n_channels = 3, .sample_bytes = 1};
  const size_t width = (size_t)job->legend.width, height = (size_t)job->legend.height, n = (size_t)job->legend_pixels;
  unsigned char *from, *row;
  conic_status status = conic_memory_allocate_these(context, CONIC_ROOM(from, 3 * width * height),
                                                    CONIC_ROOM(row, 3 * (size_t)panel->width));
  if (status == CONIC_OK) {
    put_on_paper(job, panel, &job->legend);
    conic_samples_from_rgba(context, job->legend.planes[CONIC_PLANE_RGBA], job->legend.width, job->legend.height, bytes,
                            from);
  }
  if (status == CONIC_OK)
    status = cli_top_store_open(context, job->output, (size_t)panel->width, 3, (size_t)panel->height,
                                job->memory_bytes / 8, &panel->store);
  for (size_t y = 0; y < (size_t)panel->height && status == CONIC_OK; y++) {
    for (size_t x = 0; x < (size_t)panel->width; x++)
      memcpy(row + 3 * x, from + 3 * (y / n * width + x / n), 3);
    status = cli_top_store_put(&panel->store, 0, y, row, (size_t)panel->width);
  }
  conic_memory_release_these(context, from, row);
  return status;
}

conic_status cli_panel_draw(cli_sheet_job *job, cli_panel *panel) {
  cli_render_job *scene = &job->scene;
  if (panel->kind == CLI_PANEL_LEGEND)
    return draw_legend(job, panel);
  enum { PIXEL_BYTES = 4 * (4 + 1 + 3 + 3) + 3 }; /* rgba, Z and, where light is hidden, N and albedo */
  uint64_t row_bytes = (uint64_t)panel->width * PIXEL_BYTES;
  uint64_t rows = job->memory_bytes / 2 / row_bytes / BLOCK_ROWS * BLOCK_ROWS;
  int samples = scene->shot.view.samples, step = rows < BLOCK_ROWS ? BLOCK_ROWS : rows < 65536 ? (int)rows : 65536;
  if (panel->depth == 0.0 && panel->kind == CLI_PANEL_SECTION)
    panel->depth = 0.7 * job->ppmm / job->ppu;
  if (panel->width * samples > MOST_SAMPLED || (panel->height < step ? panel->height : step) * samples > MOST_SAMPLED)
    scene->shot.view.samples = 1;
  if (conic_shot_is_lit(&scene->shot)) /* by what hides it, wherever that is */
    step = panel->height;
  conic_status status = cli_top_store_open(job->session->context, job->output, (size_t)panel->width, 3,
                                           (size_t)panel->height, job->memory_bytes / 8, &panel->store);
  for (int y = 0; y < panel->height && status == CONIC_OK; y += step) {
    cli_session_part(job->session, "panel", (int)(panel - job->panels) + 1, job->n_panels);
    status = draw_rows(job, panel, (const int[2]){y, panel->height - y < step ? panel->height : y + step});
  }
  scene->shot.view.samples = samples;
  return status;
}
