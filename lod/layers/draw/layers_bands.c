/* A picture, or a window of it, drawn in bands, or in parts of bands, each with no more splats than memory holds. */
#include "lod/layers/draw/layers_spill.h"

#include "core/image/image_common.h"
#include "raster/frame/samples.h"
#include "raster/frame/statistics.h"

typedef struct bands {
  const conic_layers_band_drawing *d;
  conic_render_options render;
  size_t most, most_at_once; /* splats at a time, and of a part that is drawn at once */
  double n_expected;         /* splats of the places, */
  double n_here;             /* and of these in the part; an estimate, but of the whole picture */
  uint64_t block_bytes;      /* of what is put aside and not yet written */
  uint64_t pixel_bytes;
  conic_camera fine; /* of the picture of samples, */
  conic_window part; /* of which that is drawn */
  int band_rows;     /* of it, too */
  conic_layers_view view;
  conic_layers_windows windows;
  conic_layers_spill spill;
  conic_window window;       /* that is drawn, whole or in parts */
  int band_begin;            /* the first row of its band, */
  conic_camera band_camera;  /* whose camera this is */
  conic_image pixels;        /* the window's; with one sample a pixel, the image */
  unsigned char *is_counted; /* a splat of the set */
  size_t counted_room;
  uint64_t n_chosen;              /* splats that were put aside */
  conic_render_statistics counts; /* where the picture has several bands: of the splats */
  conic_render_statistics *sum;
} bands;

static int has_several_bands(const bands *b) {
  return b->band_rows < b->fine.height;
}

static conic_layers_gathering begin_gathering(const bands *b) {
  const conic_layers_band_drawing *d = b->d;
  return (conic_layers_gathering){.cut = d->cut,
                                  .chosen = d->chosen,
                                  .n_chosen = d->n_chosen,
                                  .is_counted = d->is_counted,
                                  .view = d->view,
                                  .cutoff = d->render->kernel.cutoff,
                                  .camera = d->camera,
                                  .until_s = HUGE_VAL};
}

/* Numbers in the set become numbers in the file. */
static void rename_window(const bands *b, const conic_window *window, const conic_window *image_window,
                          conic_image *image) {
  const conic_layers_set *set = b->d->set;
  uint32_t *ids = image->planes[CONIC_PLANE_ID];
  int x_begin = window->x_begin - image_window->x_begin, x_end = window->x_end - image_window->x_begin;
  for (int y = window->y_begin - image_window->y_begin; ids && y < window->y_end - image_window->y_begin; y++)
    for (int x = x_begin; x < x_end; x++) {
      uint32_t *id = &ids[(size_t)y * (size_t)image->width + (size_t)x];
      *id = *id < set->splats.count ? set->ids[*id] : *id;
    }
}

/* What meets the part alone; of several bands, what becomes of a splat is counted with its place. */
static conic_layers_gathering begin_gathering_part(const bands *b) {
  conic_layers_gathering gathering = begin_gathering(b);
  gathering.part_view = &b->view;
  gathering.takes_counted = has_several_bands(b);
  gathering.part = b->part;
  gathering.samples = b->d->samples;
  return gathering;
}

/* --- at once --- */

static conic_status draw_whole(bands *b, conic_render_statistics *statistics) {
  const conic_layers_band_drawing *d = b->d;
  const conic_window whole = {0, d->camera->width, 0, d->camera->height};
  conic_layers_gathering gathering = begin_gathering(b);
  conic_status status = conic_layers_gather(d->layers, &gathering, d->set);
  *d->n_turned += d->set->n_turned;
  if (status == CONIC_OK && d->is_gathered)
    d->is_gathered(d->data);
  const conic_drawing drawing = {.splats = &d->set->splats};
  if (status == CONIC_OK)
    status = conic_render_transparent(d->layers->context, d->renderer, &drawing, d->camera, d->render, d->transparency,
                                      d->chance, d->samples, d->image, statistics);
  if (status == CONIC_OK)
    rename_window(b, &whole, &whole, d->image);
  return status;
}

/* --- in windows --- */

static int draws_whole(const bands *b) {
  return memcmp(&b->part, &(conic_window){0, b->fine.width, 0, b->fine.height}, sizeof b->part) == 0;
}

/* Cuts the picture into windows, whose samples take an eighth of what there is for drawing. */
static conic_status plan_windows(bands *b) {
  enum { GOOD_BLOCK = 64 }; /* splats, that are written together */
  const conic_layers_band_drawing *d = b->d;
  double most_windows = (double)b->block_bytes / (double)(GOOD_BLOCK * conic_layers_spill_bytes(d->layers));
  double in_window = 1.5 * b->n_expected / most_windows;
  conic_layers_parting parting = {.layers = d->layers,
                                  .cut = d->cut,
                                  .part = b->part,
                                  .band_rows = b->band_rows,
                                  .samples = d->samples,
                                  .most_pixels =
                                      (double)conic_layers_drawing_bytes(d->layers) / (8.0 * (double)b->pixel_bytes),
                                  .most = in_window > 0.9 * (double)b->most ? in_window : 0.9 * (double)b->most,
                                  .margin_px = b->view.growth_px + 1.0};
  return conic_layers_windows_plan(&parting, &b->windows);
}

static conic_status reserve_counted(bands *b) {
  size_t room = b->d->set->room;
  if (room <= b->counted_room)
    return CONIC_OK;
  b->counted_room = 0;
  conic_status status = conic_memory_grow(b->d->layers->context, &b->is_counted, 0, room, 1);
  b->counted_room = status == CONIC_OK ? room : 0;
  return status;
}

/* In a picture in several bands: finds what becomes of the splats of the pieces that have just come. */
static conic_status count_part(bands *b, const conic_layers_set *set) {
  const unsigned char *is_place_counted = b->d->is_counted;
  conic_render_statistics counts = {.splats_in = 0};
  conic_status status = reserve_counted(b);
  if (status != CONIC_OK)
    return status;
  memset(b->is_counted, 0, set->splats.count);
  for (size_t i = 0; i < set->n_pieces; i++)
    if (!is_place_counted || is_place_counted[set->pieces[i].i_place])
      memset(b->is_counted + set->pieces[i].at, 1, set->pieces[i].n_chosen);
  status = conic_samples_count(b->d->layers->context, &set->splats, b->is_counted, &b->fine, b->d->render, &counts);
  conic_statistics_add(&counts, &b->counts);
  return status;
}

static conic_status take_part(void *cookie, conic_layers_set *set) {
  bands *b = cookie;
  conic_status status = conic_layers_spill_take(&b->spill);
  double fraction = (double)set->n_chosen / (b->n_expected + 1.0);
  if (status == CONIC_OK)
    status = conic_progress(b->d->layers->context, "gather", fraction < 1.0 ? fraction : 1.0);
  return status == CONIC_OK && has_several_bands(b) ? count_part(b, set) : status;
}

static conic_status look_at_new(void *cookie, conic_layers_set *set) {
  bands *b = cookie;
  conic_status status = conic_layers_spill_look(&b->spill);
  return status == CONIC_OK && has_several_bands(b) ? count_part(b, set) : status;
}

static conic_status put_all_aside(bands *b) {
  const conic_layers_band_drawing *d = b->d;
  conic_layers_gathering gathering = begin_gathering_part(b);
  gathering.receive = take_part;
  gathering.cookie = b;
  gathering.most = b->most;
  size_t block_count = (size_t)b->block_bytes / (b->windows.n_windows * conic_layers_spill_bytes(d->layers));
  conic_status status = conic_layers_spill_begin(block_count, &b->spill);
  if (status == CONIC_OK)
    status = conic_layers_gather(d->layers, &gathering, d->set);
  b->n_chosen = d->set->n_chosen;
  *d->n_turned += d->set->n_turned;
  return status == CONIC_OK ? conic_layers_spill_close(&b->spill) : status;
}

/* Each splat is counted in the window that has the first of its pixels. */
static conic_status choose_counted(bands *b, const conic_window *window) {
  conic_status status = reserve_counted(b);
  for (size_t i = 0; i < b->d->set->splats.count && status == CONIC_OK; i++) {
    const conic_box *box = &b->spill.boxes[i];
    b->is_counted[i] = !has_several_bands(b) && !conic_box_is_empty(box) && box->x_begin >= window->x_begin &&
                       box->y_begin >= window->y_begin && box->x_begin < window->x_end && box->y_begin < window->y_end;
  }
  return status;
}

static conic_status draw_window(bands *b, const conic_window *window) {
  const conic_layers_band_drawing *d = b->d;
  conic_render_statistics drawn;
  conic_part part = {.window = *window};
  conic_status status = choose_counted(b, window);
  if (status != CONIC_OK)
    return status;
  part.is_counted = b->is_counted;
  part.first_column = b->window.x_begin;
  part.first_row = b->window.y_begin - b->band_begin;
  part.window.y_begin -= b->band_begin;
  part.window.y_end -= b->band_begin;
  status = conic_render_part(d->renderer, &d->set->splats, &b->band_camera, &b->render, &part, &b->pixels, &drawn);
  if (status != CONIC_OK)
    return status;
  rename_window(b, window, &b->window, &b->pixels);
  conic_statistics_add(&drawn, b->sum);
  return CONIC_OK;
}

/* Half the window, in whole steps, along its longer side. 0 where it is one step wide and high. */
static int halve_window(conic_window *first, conic_window *second) {
  int width = first->x_end - first->x_begin, height = first->y_end - first->y_begin;
  int is_along_x = width >= height, half = (is_along_x ? width : height) / 2;
  half = (half + CONIC_WINDOW_STEP - 1) / CONIC_WINDOW_STEP * CONIC_WINDOW_STEP;
  if (half >= (is_along_x ? width : height))
    return 0;
  *second = *first;
  if (is_along_x)
    first->x_end = second->x_begin = first->x_begin + half;
  else
    first->y_end = second->y_begin = first->y_begin + half;
  return 1;
}

/* Windows are planned by estimates: one with more than there is memory for is drawn in parts, as small as it takes. */
static conic_status draw_planned(bands *b, size_t i_window, int *n_bands) {
  enum { MOST_OPEN = 64 };
  conic_window open[MOST_OPEN];
  int n_open = 1;
  conic_status status = CONIC_OK;
  open[0] = b->windows.windows[i_window];
  while (n_open > 0 && status == CONIC_OK) {
    conic_window window = open[n_open - 1], first = window, second;
    int has_halves = n_open < MOST_OPEN && halve_window(&first, &second), is_too_much;
    status = conic_layers_spill_load(&b->spill, i_window, &window, has_halves ? b->most : 0, &is_too_much);
    if (status != CONIC_OK)
      return status;
    if (is_too_much) {
      open[n_open - 1] = second;
      open[n_open++] = first;
      continue;
    }
    status = draw_window(b, &window);
    n_open--;
    ++*n_bands;
  }
  return status;
}

/* What the next window is drawn into. */
static conic_status begin_window(bands *b, const conic_window *window) {
  const conic_layers_band_drawing *d = b->d;
  int samples = d->samples;
  b->band_begin = window->y_begin / b->band_rows * b->band_rows;
  int band_end = b->band_begin + b->band_rows < b->fine.height ? b->band_begin + b->band_rows : b->fine.height;
  b->band_camera =
      conic_samples_camera(d->camera, samples, b->band_begin / samples, (band_end - b->band_begin) / samples);
  b->window = samples > 1 ? *window : b->part;
  if (samples > 1)
    return conic_samples_allocate(d->layers->context, window->x_end - window->x_begin, window->y_end - window->y_begin,
                                  conic_image_planes(d->image) & CONIC_DRAWN_PLANES, &b->pixels);
  b->pixels = *d->image;
  return CONIC_OK;
}

static void end_window(bands *b, conic_status status) {
  const conic_layers_band_drawing *d = b->d;
  int n = d->samples;
  if (status == CONIC_OK && n > 1)
    conic_samples_reduce(d->layers->context, &b->pixels, n, b->window.x_begin / n - d->window.x_begin,
                         b->window.y_begin / n - d->window.y_begin, d->image);
  if (n > 1)
    conic_image_release(d->layers->context, &b->pixels);
}

static conic_status draw_all_windows(bands *b, int *n_bands) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < b->windows.n_windows && status == CONIC_OK; i++) {
    status = begin_window(b, &b->windows.windows[i]);
    if (status == CONIC_OK)
      status = draw_planned(b, i, n_bands);
    end_window(b, status);
  }
  return status;
}

/* A part whose splats have room all at once; where more of them meet it than was thought, *n_bands stays 0. */
static conic_status draw_gathered(bands *b, int *n_bands) {
  const conic_layers_band_drawing *d = b->d;
  conic_layers_gathering gathering = begin_gathering_part(b);
  gathering.look = look_at_new;
  gathering.cookie = b;
  gathering.most = b->most_at_once;
  conic_status status = conic_layers_gather(d->layers, &gathering, d->set);
  if (status == CONIC_OK && d->set->is_cut_short) {
    memset(&b->counts, 0, sizeof b->counts);
    return CONIC_OK;
  }
  b->n_chosen = d->set->n_chosen;
  *d->n_turned += d->set->n_turned;
  if (status == CONIC_OK)
    status = begin_window(b, &b->part);
  if (status != CONIC_OK)
    return status;
  status = draw_window(b, &b->part);
  end_window(b, status);
  *n_bands = 1;
  return status;
}

static conic_status draw_put_aside(bands *b, int *n_bands) {
  const conic_layers_band_drawing *d = b->d;
  conic_renderer_give_back(d->renderer); /* which putting aside takes in its place */
  conic_status status = plan_windows(b);
  if (status == CONIC_OK)
    status = put_all_aside(b);
  if (status == CONIC_OK && d->is_gathered)
    d->is_gathered(d->data);
  if (status == CONIC_OK)
    status = draw_all_windows(b, n_bands);
  conic_layers_windows_release(d->layers->context, &b->windows);
  return status;
}

static void count_windows(const bands *b, conic_render_statistics *statistics) {
  if (has_several_bands(b)) {
    conic_render_statistics drawn = *statistics;
    conic_statistics_add(&b->counts, &drawn);
    statistics->splats_skipped = drawn.splats_skipped;
    statistics->splats_drawn = drawn.splats_drawn;
    statistics->splats_fallback = drawn.splats_fallback;
    statistics->splats_by_laplace = drawn.splats_by_laplace;
    memcpy(statistics->splats_by_method, drawn.splats_by_method, sizeof drawn.splats_by_method);
  }
  statistics->splats_in = b->n_chosen;
  statistics->splats_culled = statistics->splats_in - statistics->splats_drawn - statistics->splats_skipped;
}

static conic_status draw_windows(bands *b, int is_room, conic_render_statistics *statistics, int *n_bands) {
  const conic_layers_band_drawing *d = b->d;
  *n_bands = 0;
  memset(statistics, 0, sizeof *statistics);
  b->sum = statistics;
  b->render = *d->render;
  b->spill = (conic_layers_spill){.layers = d->layers,
                                  .cut = d->cut,
                                  .view = &b->view,
                                  .samples = d->samples,
                                  .windows = &b->windows,
                                  .set = d->set};
  conic_layers_view_init(&d->layers->header, &b->fine, d->render, d->render->near_z, &b->view);
  conic_status status = conic_renderer_check_parts(d->renderer);
  if (status == CONIC_OK)
    status = is_room ? draw_gathered(b, n_bands) : CONIC_OK;
  if (status == CONIC_OK && *n_bands == 0)
    status = draw_put_aside(b, n_bands);
  if (status == CONIC_OK)
    count_windows(b, statistics);
  conic_layers_spill_end(&b->spill);
  conic_layers_set_release(d->layers->context, d->set); /* so that there is room for what is made of the picture */
  conic_renderer_give_back(d->renderer);
  conic_memory_release(d->layers->context, b->is_counted);
  return status;
}

/* Whether all that is drawn, and of the picture of its samples, has room: of a whole picture this is no estimate, but
 * of grazing places. */
static int fits(bands *b) {
  enum { PROJECTED_BYTES = 144 }; /* what transparency keeps of a splat besides */
  const conic_layers_band_drawing *d = b->d;
  double splat_bytes = CONIC_LAYERS_SPLAT_BYTES + (d->transparency ? PROJECTED_BYTES : 0);
  double room = (double)conic_layers_drawing_bytes(d->layers);
  const conic_layers_gathering gathering = begin_gathering_part(b);
  int height = b->part.y_end - b->part.y_begin, rows = b->band_rows < height ? b->band_rows : height;
  for (size_t i = 0; i < d->n_chosen; i++) {
    double weight = conic_layers_place_weight(&d->cut->places[d->chosen[i]]);
    b->n_expected += weight;
    b->n_here += weight * conic_layers_share_of_place(&gathering, d->chosen[i]);
  }
  if (d->samples > 1 && conic_renderer_has_parts(d->renderer))
    room -= (double)rows * (double)(b->part.x_end - b->part.x_begin) * (double)b->pixel_bytes;
  b->most_at_once = room > splat_bytes ? (size_t)(room / splat_bytes) : 1;
  return b->n_here * splat_bytes <= room;
}

conic_status conic_layers_draw_bands(const conic_layers_band_drawing *drawing, conic_render_statistics *statistics,
                                     int *n_bands) {
  const conic_window *window = &drawing->window;
  int n = drawing->samples;
  bands b = {.d = drawing,
             .pixel_bytes = conic_planes_pixel_bytes(conic_image_planes(drawing->image) & CONIC_DRAWN_PLANES)};
  b.block_bytes = conic_layers_drawing_bytes(drawing->layers) / 2;
  b.most = (size_t)(conic_layers_drawing_bytes(drawing->layers) / CONIC_LAYERS_SPLAT_BYTES) + 1;
  b.fine = conic_samples_camera(drawing->camera, n, 0, drawing->camera->height);
  b.part = (conic_window){n * window->x_begin, n * window->x_end, n * window->y_begin, n * window->y_end};
  b.band_rows = n * conic_samples_band_rows(drawing->camera, n);
  *n_bands = 1;
  int is_room = fits(&b), is_at_once = is_room && draws_whole(&b);
  if (drawing->transparency && !is_at_once)
    return conic_fail(drawing->layers->context, CONIC_ERROR_MEMORY,
                      "%s: transparency wants all %.0f splats of the picture in memory at once, where fewer may be",
                      drawing->layers->name, b.n_expected);
  return is_at_once ? draw_whole(&b, statistics) : draw_windows(&b, is_room, statistics, n_bands);
}
