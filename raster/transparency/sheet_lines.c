#include "core/base/base.h"
#include "raster/transparency/pixel_sheets.h"

/* What stops all but this much of the light shows nothing behind it. */
#define LEAST_LIGHT 0x1p-26

/* A thread's, from line to line. */
typedef struct line_room {
  uint32_t *first_splat, *last_splat, *first_triangle; /* of each of the line's pixels up to the image's last */
  conic_sheet_splat *splats;
  size_t n_splats, splat_room;
  conic_sheet_triangle *triangles;
  size_t n_triangles, triangle_room;
  conic_kept_memory ranked, ranked_triangles;
  conic_status status;
} line_room;

typedef struct sheet_work {
  const conic_sheet_picture *picture;
  line_room *rooms; /* a thread */
} sheet_work;

/* Of a line that the image has. */
static size_t image_pixel(const conic_sheet_picture *p, int x, int y) {
  return (size_t)(y - p->first_row) * (size_t)p->image->width + (size_t)(x - p->first_column);
}

static int last_column(const conic_sheet_picture *p) {
  return p->first_column + p->image->width;
}

static int is_in_mask(const conic_sheet_picture *p, int x, int y) {
  return x >= p->first_column && x < last_column(p) && p->mark[3 * image_pixel(p, x, y)] > 0.0f;
}

/* --- what covers the line's pixels --- */

static conic_status keep_sheet_splat(conic_context *context, line_room *room, int x, uint32_t i_footprint,
                                     const conic_fragment *fragment) {
  if (room->n_splats == room->splat_room &&
      conic_memory_reserve(context, &room->splats, room->n_splats, room->n_splats + 1, &room->splat_room,
                           sizeof *room->splats) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  uint32_t i = (uint32_t)room->n_splats++;
  room->splats[i] = (conic_sheet_splat){i_footprint, CONIC_NO_SHEET_PART, *fragment};
  if (room->first_splat[x] == CONIC_NO_SHEET_PART)
    room->first_splat[x] = i;
  else
    room->splats[room->last_splat[x]].next = i;
  room->last_splat[x] = i;
  return CONIC_OK;
}

/* Splats that no picture draws are none here. */
static int is_sheet_splat(const conic_sheet_scene *scene, uint32_t i_footprint) {
  uint32_t i = scene->contributions->projected.surfaces[i_footprint].index;
  return !scene->opacity || scene->opacity[i] <= CONIC_GREATEST_OPACITY;
}

static conic_status list_line_splats(const conic_sheet_picture *p, int y, line_room *room) {
  const conic_contributions *c = p->scene.contributions;
  size_t band = (size_t)y / CONIC_CONTRIBUTION_BAND;
  for (size_t i = c->band_begin[band]; i < c->band_begin[band + 1]; i++) {
    uint32_t i_footprint = c->references[i];
    conic_reach reach = conic_reach_of(c, i_footprint);
    if (y < reach.y_begin || y >= reach.y_end || !is_sheet_splat(&p->scene, i_footprint))
      continue;
    for (int x = reach.x_begin; x < reach.x_end; x++) {
      conic_fragment fragment;
      if (is_in_mask(p, x, y) &&
          conic_fragment_at(&c->view, &c->projected, &c->projected.footprints[i_footprint], x, y, &fragment) &&
          keep_sheet_splat(c->context, room, x, i_footprint, &fragment) != CONIC_OK)
        return CONIC_ERROR_MEMORY;
    }
  }
  return CONIC_OK;
}

static conic_status keep_sheet_triangle(conic_context *context, line_room *room, int x,
                                        const conic_triangle_record *record, float iz) {
  if (room->n_triangles == room->triangle_room &&
      conic_memory_reserve(context, &room->triangles, room->n_triangles, room->n_triangles + 1, &room->triangle_room,
                           sizeof *room->triangles) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  uint32_t i = (uint32_t)room->n_triangles++;
  room->triangles[i] = (conic_sheet_triangle){record, iz, room->first_triangle[x]};
  room->first_triangle[x] = i;
  return CONIC_OK;
}

static conic_status list_record(const conic_sheet_picture *p, const conic_triangle_record *record, int x_begin,
                                int x_end, int y, line_room *room) {
  const conic_box *box = &record->box;
  conic_triangle_edges edges;
  if (y < box->y_begin || y >= box->y_end)
    return CONIC_OK;
  int first = box->x_begin > x_begin ? box->x_begin : x_begin, last = box->x_end < x_end ? box->x_end : x_end;
  conic_triangle_edges_of(record, &edges);
  for (int x = first; x < last; x++) {
    float iz;
    if (is_in_mask(p, x, y) && conic_triangle_sample(record, &edges, x, y, &iz) &&
        keep_sheet_triangle(p->scene.contributions->context, room, x, record, iz) != CONIC_OK)
      return CONIC_ERROR_MEMORY;
  }
  return CONIC_OK;
}

static conic_status list_tile_triangles(const conic_sheet_picture *p, int x_begin, int y, line_room *room) {
  const conic_triangle_frame *frame = &p->scene.contributions->triangles;
  size_t i_tile = (size_t)(y >> frame->tile_bits) * (size_t)frame->n_tiles_x + (size_t)(x_begin >> frame->tile_bits);
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < frame->n_chunks; i++) {
    const conic_triangle_chunk *chunk = &frame->chunks[i];
    const uint32_t *begin = frame->tile_begin + i * (frame->n_tiles + 1) + i_tile;
    for (uint32_t k = begin[0]; k < begin[1] && status == CONIC_OK; k++)
      status = list_record(p, &frame->records[chunk->first_record + frame->entries[chunk->first_entry + k]], x_begin,
                           x_begin + frame->tile, y, room);
  }
  return status;
}

static conic_status list_line_triangles(const conic_sheet_picture *p, int y, line_room *room) {
  conic_status status = CONIC_OK;
  int tile = p->scene.contributions->triangles.tile;
  if (!p->scene.contributions->drawing.triangles)
    return CONIC_OK;
  for (int x = p->first_column / tile * tile; x < last_column(p) && status == CONIC_OK; x += tile)
    status = list_tile_triangles(p, x, y, room);
  return status;
}

/* --- a pixel --- */

static conic_status begin_sheet_pixel(const conic_sheet_picture *p, int x, int y, line_room *room,
                                      conic_pixel_sheets *sheets) {
  conic_context *context = p->scene.contributions->context;
  *sheets =
      (conic_pixel_sheets){.scene = &p->scene, .splats = room->splats, .triangles = room->triangles, .x = x, .y = y};
  for (uint32_t i = room->first_splat[x]; i != CONIC_NO_SHEET_PART; i = room->splats[i].next)
    sheets->n++;
  for (uint32_t i = room->first_triangle[x]; i != CONIC_NO_SHEET_PART; i = room->triangles[i].next)
    sheets->n_triangles++;
  sheets->ranked = conic_keep_room(context, &room->ranked, sheets->n, sizeof *sheets->ranked);
  sheets->ranked_triangles =
      conic_keep_room(context, &room->ranked_triangles, sheets->n_triangles, sizeof *sheets->ranked_triangles);
  if (!sheets->ranked || !sheets->ranked_triangles)
    return CONIC_ERROR_MEMORY;
  size_t n = 0, n_triangles = 0;
  for (uint32_t i = room->first_splat[x]; i != CONIC_NO_SHEET_PART; i = room->splats[i].next)
    sheets->ranked[n++].i_splat = i;
  for (uint32_t i = room->first_triangle[x]; i != CONIC_NO_SHEET_PART; i = room->triangles[i].next)
    sheets->ranked_triangles[n_triangles++] = (conic_ranked_triangle){room->triangles[i].iz, i};
  conic_contribution_ray(&p->scene.contributions->view, x, y, sheets->ray);
  conic_pixel_sheets_begin(sheets);
  return CONIC_OK;
}

/* What a pixel shows: colours times what reaches the viewer of them, and of all else the first surface. */
typedef struct shown_pixel {
  double rgb[3], albedo[3], light; /* light: what still comes through */
  conic_sheet front;
  int is_covered;
} shown_pixel;

static void show_sheet(const conic_sheet *sheet, double opacity, shown_pixel *shown) {
  double part = shown->light * opacity;
  for (int channel = 0; channel < 3; channel++) {
    shown->rgb[channel] += part * (double)sheet->pixel.rgba[channel];
    shown->albedo[channel] += part * (double)sheet->pixel.albedo[channel];
  }
  if (!shown->is_covered)
    shown->front = *sheet;
  shown->is_covered = 1;
  shown->light *= 1.0 - opacity;
}

static void show_layers(conic_pixel_sheets *sheets, shown_pixel *shown) {
  conic_sheet sheet;
  while (shown->light > LEAST_LIGHT && conic_pixel_sheets_next(sheets, &sheet))
    show_sheet(&sheet, (double)sheet.opacity, shown);
}

/* A number in [0, 1) of the pixel's own. */
static double turn_of_line(int x, int y) {
  uint32_t h = (uint32_t)x * UINT32_C(0x9e3779b1) ^ (uint32_t)y * UINT32_C(0x85ebca77);
  h = (h ^ h >> 15) * UINT32_C(0x2c1b3c6d);
  h = (h ^ h >> 12) * UINT32_C(0x297a2d39);
  return (double)(h ^ h >> 15) * 0x1p-32;
}

/* The surface behind which no more light than the chance says is left. */
static void show_one(const conic_sheet_picture *p, conic_pixel_sheets *sheets, shown_pixel *shown) {
  double chance = p->chance + turn_of_line(sheets->x, sheets->y), light = 1.0;
  conic_sheet sheet;
  chance -= chance < 1.0 ? 0.0 : 1.0;
  while (light > LEAST_LIGHT && conic_pixel_sheets_next(sheets, &sheet)) {
    light *= 1.0 - (double)sheet.opacity;
    if (1.0 - light > chance) {
      show_sheet(&sheet, 1.0, shown);
      return;
    }
  }
}

static void store_sheet_floats(const conic_image *image, conic_plane plane, size_t at, const float *values, size_t n) {
  float *to = image->planes[plane];
  if (to)
    memcpy(to + at * n, values, n * sizeof *to);
}

static void store_sheet_index(const conic_image *image, conic_plane plane, size_t at, uint32_t value) {
  uint32_t *to = image->planes[plane];
  if (to)
    to[at] = value;
}

static void store_shown_pixel(const conic_sheet_picture *p, size_t at, const shown_pixel *shown) {
  static const conic_sheet nothing = {.id = CONIC_NO_ID};
  const conic_sheet *front = shown->is_covered ? &shown->front : &nothing;
  const float *background = p->scene.finish->background;
  float rgba[4], albedo[3], alpha = shown->light > LEAST_LIGHT ? (float)(1.0 - shown->light) : 1.0f;
  for (int channel = 0; channel < 3; channel++) {
    rgba[channel] = (float)(shown->rgb[channel] + shown->light * (double)background[channel]);
    albedo[channel] = (float)shown->albedo[channel];
  }
  rgba[3] = background[3] > 0.0f ? 1.0f : alpha;
  store_sheet_floats(p->image, CONIC_PLANE_RGBA, at, rgba, 4);
  store_sheet_floats(p->image, CONIC_PLANE_ALBEDO, at, albedo, 3);
  store_sheet_floats(p->image, CONIC_PLANE_NORMAL, at, front->pixel.normal, 3);
  store_sheet_floats(p->image, CONIC_PLANE_Z, at, &front->z, 1);
  store_sheet_floats(p->image, CONIC_PLANE_WEIGHT, at, &front->weight, 1);
  store_sheet_index(p->image, CONIC_PLANE_COUNT, at, front->count);
  store_sheet_index(p->image, CONIC_PLANE_ID, at, front->id);
}

static conic_status draw_sheet_pixel(const conic_sheet_picture *p, int x, int y, line_room *room) {
  conic_pixel_sheets sheets;
  shown_pixel shown;
  conic_status status = begin_sheet_pixel(p, x, y, room, &sheets);
  if (status != CONIC_OK)
    return status;
  memset(&shown, 0, sizeof shown);
  shown.light = 1.0;
  if (p->how == CONIC_TRANSPARENCY_CHANCE)
    show_one(p, &sheets, &shown);
  else
    show_layers(&sheets, &shown);
  store_shown_pixel(p, image_pixel(p, x, y), &shown);
  return CONIC_OK;
}

/* --- all lines --- */

static void draw_sheet_line(void *data, size_t i_item, int i_thread) {
  const sheet_work *work = data;
  const conic_sheet_picture *p = work->picture;
  line_room *room = &work->rooms[i_thread];
  size_t width = (size_t)last_column(p);
  int y = p->first_row + (int)i_item, x = p->first_column;
  while (x < last_column(p) && !is_in_mask(p, x, y))
    x++;
  if (x == last_column(p) || room->status != CONIC_OK)
    return;
  memset(room->first_splat, 0xff, width * sizeof *room->first_splat);
  memset(room->first_triangle, 0xff, width * sizeof *room->first_triangle);
  room->n_splats = room->n_triangles = 0;
  room->status = list_line_splats(p, y, room);
  if (room->status == CONIC_OK)
    room->status = list_line_triangles(p, y, room);
  for (; x < last_column(p) && room->status == CONIC_OK; x++)
    if (is_in_mask(p, x, y))
      room->status = draw_sheet_pixel(p, x, y, room);
}

static conic_status begin_line_room(conic_context *context, size_t width, line_room *room) {
  return conic_memory_allocate_these(context, CONIC_ROOM(room->first_splat, width), CONIC_ROOM(room->last_splat, width),
                                     CONIC_ROOM(room->first_triangle, width));
}

static void release_line_room(conic_context *context, line_room *room) {
  void *all[] = {room->first_splat, room->last_splat,     room->first_triangle,          room->splats,
                 room->triangles,   room->ranked.pointer, room->ranked_triangles.pointer};
  for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
    conic_memory_release(context, all[i]);
}

conic_status conic_sheet_lines_draw(const conic_sheet_picture *picture) {
  conic_context *context = picture->scene.contributions->context;
  size_t n_threads = (size_t)conic_context_threads(context);
  sheet_work work = {picture, conic_memory_allocate_zeroed(context, n_threads, sizeof *work.rooms)};
  if (!work.rooms)
    return CONIC_ERROR_MEMORY;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n_threads && status == CONIC_OK; i++)
    status = begin_line_room(context, (size_t)last_column(picture), &work.rooms[i]);
  if (status == CONIC_OK)
    status =
        conic_parallel_told(context, "transparency", 0.0, 1.0, (size_t)picture->image->height, draw_sheet_line, &work);
  for (size_t i = 0; i < n_threads; i++) {
    status = status == CONIC_OK ? work.rooms[i].status : status;
    release_line_room(context, &work.rooms[i]);
  }
  conic_memory_release(context, work.rooms);
  return status;
}
