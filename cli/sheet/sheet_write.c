/* A sheet as a file: as pixels, from the top, a few rows at a time; or as a page of pictures and strokes. */
#include "cli/sheet/sheet.h"
#include "core/files/file.h"
#include "core/pictures/image_png.h"
#include "core/pictures/pdf_page.h"
#include "core/pictures/tiff_tiles.h"

enum { BAND = CONIC_TIFF_TILE };

/* The rows that are at hand. */
typedef struct sheet_rows {
  cli_sheet_job *job;
  unsigned char *rgba, *rgb; /* BAND rows of the sheet, and one of a panel */
  int first_row, n_rows;
} sheet_rows;

static conic_status put_panel_row(const sheet_rows *rows, const cli_panel *panel, int y) {
  conic_status status = cli_top_store_get(&panel->store, 0, (size_t)(y - panel->y), rows->rgb, (size_t)panel->width);
  unsigned char *to = rows->rgba + 4 * ((size_t)(y - rows->first_row) * (size_t)rows->job->width + (size_t)panel->x);
  for (size_t i = 0; i < (size_t)panel->width && status == CONIC_OK; i++)
    memcpy(to + 4 * i, rows->rgb + 3 * i, 3);
  return status;
}

static conic_status make_rows(sheet_rows *rows, int first_row) {
  const cli_sheet_job *job = rows->job;
  conic_status status = CONIC_OK;
  rows->first_row = first_row;
  rows->n_rows = job->height - first_row < BAND ? job->height - first_row : BAND;
  memset(rows->rgba, 0xff, (size_t)4 * (size_t)job->width * BAND);
  for (int i = 0; i < job->n_panels; i++) {
    const cli_panel *panel = &job->panels[i];
    int begin = panel->y > first_row ? panel->y : first_row, end = panel->y + panel->height;
    for (int y = begin; y < end && y < first_row + rows->n_rows && status == CONIC_OK; y++)
      status = put_panel_row(rows, panel, y);
  }
  cli_strokes_paint(&job->strokes, first_row, rows->n_rows, job->width, rows->rgba);
  return status;
}

static conic_status next_png_row(void *cookie, int y, unsigned char *row) {
  sheet_rows *rows = cookie;
  size_t n_bytes = (size_t)4 * (size_t)rows->job->width;
  conic_status status = y % BAND == 0 ? make_rows(rows, y) : CONIC_OK;
  memcpy(row, rows->rgba + (size_t)(y - rows->first_row) * n_bytes, n_bytes);
  return status;
}

static conic_status write_tiles(sheet_rows *rows, conic_tiff *tiff) {
  size_t width = (size_t)rows->job->width;
  unsigned char *tile = conic_memory_allocate(rows->job->session->context, (size_t)BAND * BAND, 4);
  conic_status status = tile ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (int y = 0; y < rows->job->height && status == CONIC_OK; y += BAND) {
    status = make_rows(rows, y);
    for (size_t x = 0; x < width && status == CONIC_OK; x += BAND) {
      size_t n = width - x < BAND ? width - x : BAND;
      memset(tile, 0xff, (size_t)BAND * BAND * 4);
      for (size_t row = 0; row < BAND; row++)
        memcpy(tile + 4 * row * BAND, rows->rgba + 4 * (row * width + x), 4 * n);
      status = conic_tiff_append(tiff, tile);
    }
  }
  conic_memory_release(rows->job->session->context, tile);
  return status;
}

static conic_status write_pixels(cli_sheet_job *job) {
  conic_context *context = job->session->context;
  sheet_rows rows = {.job = job};
  conic_status status = conic_memory_allocate_these(context, CONIC_ROOM(rows.rgba, (size_t)job->width * BAND * 4),
                                                    CONIC_ROOM(rows.rgb, (size_t)job->width * 3));
  if (status == CONIC_OK && conic_file_has_ending(job->output, "png")) {
    const conic_png_rows png = {job->width, job->height, job->dpi, &rows, next_png_row};
    status = conic_png_write_rows(context, job->output, &png);
  } else if (status == CONIC_OK) {
    const conic_tiff_layout layout = {
        .width = (uint64_t)job->width, .height = (uint64_t)job->height, .dpi = job->dpi, .description = job->title};
    conic_tiff *tiff = NULL;
    status = conic_tiff_open(context, job->output, &layout, &tiff);
    if (status == CONIC_OK)
      status = conic_tiff_end(tiff, write_tiles(&rows, tiff));
  }
  conic_memory_release_these(context, rows.rgba, rows.rgb);
  return status;
}

/* --- PDF --- */

static conic_status put_panel(conic_pdf *pdf, const cli_panel *panel, unsigned char *rgb) {
  conic_status status = conic_pdf_picture(pdf, panel->width, panel->height);
  if (status != CONIC_OK)
    return status;
  for (int y = 0; y < panel->height && status == CONIC_OK; y++) {
    status = cli_top_store_get(&panel->store, 0, (size_t)y, rgb, (size_t)panel->width);
    if (status == CONIC_OK)
      conic_pdf_rows(pdf, rgb, (size_t)panel->width * 3);
  }
  conic_pdf_picture_end(pdf);
  return status;
}

static void put_strokes(conic_pdf *pdf, const cli_strokes *strokes) {
  const cli_stroke *last = NULL;
  for (size_t i = 0; i < strokes->n; i++) {
    const cli_stroke *s = &strokes->list[i];
    int goes_on = last && last->width == s->width && last->grey == s->grey && last->is_flat == s->is_flat;
    if (!goes_on)
      conic_pdf_print(pdf, "%s%.3f w %d J %.3f G\n", last ? "S\n" : "", s->width, s->is_flat ? 0 : 1, (double)s->grey);
    if (!goes_on || last->to[0] != s->from[0] || last->to[1] != s->from[1])
      conic_pdf_print(pdf, "%.3f %.3f m ", s->from[0], s->from[1]);
    conic_pdf_print(pdf, "%.3f %.3f l\n", s->to[0], s->to[1]);
    last = s;
  }
  conic_pdf_print(pdf, last ? "S\n" : "");
}

static conic_status write_pdf(cli_sheet_job *job) {
  conic_context *context = job->session->context;
  const double points = 72.0 / job->dpi, size_pt[2] = {job->width * points, job->height * points};
  conic_pdf *pdf = NULL;
  unsigned char *rgb = conic_memory_allocate(context, (size_t)job->width, 3);
  conic_status status = rgb ? conic_pdf_open(context, job->output, size_pt, &pdf) : CONIC_ERROR_MEMORY;
  for (int i = 0; i < job->n_panels && status == CONIC_OK; i++)
    status = put_panel(pdf, &job->panels[i], rgb);
  if (status == CONIC_OK) {
    conic_pdf_print(pdf, "%.9g 0 0 %.9g 0 %.9g cm 1 j\n", points, -points, size_pt[1]); /* pixels, downwards */
    for (int i = 0; i < job->n_panels; i++) {
      const cli_panel *panel = &job->panels[i];
      conic_pdf_print(pdf, "q %d 0 0 %d %d %d cm /P%d Do Q\n", panel->width, -panel->height, panel->x,
                      panel->y + panel->height, i);
    }
    put_strokes(pdf, &job->strokes);
  }
  status = conic_pdf_end(pdf, status);
  conic_memory_release(context, rgb);
  return status;
}

conic_status cli_sheet_write(cli_sheet_job *job) {
  return conic_file_has_ending(job->output, "pdf") ? write_pdf(job) : write_pixels(job);
}
