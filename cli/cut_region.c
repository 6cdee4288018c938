#include "cli/cut_region.h"

#include "cli/arguments.h"
#include "core/files/input.h"
#include "core/files/number.h"
#include "core/splats/clip.h"
#include "core/splats/coordinate.h"
#include "core/splats/point_values.h"
#include "core/splats/splats_gather.h"

void cli_cut_region_init(cli_cut_region *region) {
  memset(region, 0, sizeof *region);
  for (int axis = 0; axis < 3; axis++) {
    region->low[axis] = -INFINITY;
    region->high[axis] = INFINITY;
  }
}

void cli_cut_region_release(conic_context *context, cli_cut_region *region) {
  conic_memory_release_these(context, region->corners, region->ends);
  cli_cut_region_init(region);
}

/* Numbers with one comma, or with blanks, between them; returns how many, or room + 1 where it is something else. */
static size_t list_numbers(const char *text, size_t length, char mark, double *values, size_t room) {
  const char *end = text + length;
  for (size_t n = 0;; n++) {
    while (text < end && (*text == ' ' || *text == '\t' || *text == '\r'))
      text++;
    if (text == end)
      return mark == ',' ? room + 1 : n;
    if (n == room)
      return room + 1;
    size_t used = conic_number_parse(text, (size_t)(end - text), &values[n]);
    text += used;
    if (used == 0 || !conic_is_finite(values[n]))
      return room + 1;
    if (mark == ',' && text == end)
      return n + 1;
    if (text < end && *text != mark && *text != '\t' && *text != '\r')
      return room + 1;
    text += mark == ',';
  }
}

int cli_cut_parse_box(const char *text, void *cookie) {
  cli_cut_region *region = cookie;
  double values[6];
  size_t n = list_numbers(text, strlen(text), ',', values, 6);
  if (n != 4 && n != 6)
    return cli_because("4 or 6 numbers are wanted");
  for (size_t axis = 0; axis < n / 2; axis++) {
    region->low[axis] = values[axis];
    region->high[axis] = values[n / 2 + axis];
    if (!(region->low[axis] <= region->high[axis]))
      return cli_because("the second corner is above the first");
  }
  return 1;
}

typedef struct polygon_reader {
  conic_input input;
  cli_cut_region *region;
  size_t corner_room, end_room;
} polygon_reader;

static conic_status end_polygon(polygon_reader *reader) {
  cli_cut_region *region = reader->region;
  size_t begin = region->n_ends ? region->ends[region->n_ends - 1] : 0;
  if (region->n_corners == begin)
    return CONIC_OK;
  if (region->n_corners - begin < 3)
    return conic_input_wrong(&reader->input, "a polygon has fewer than three corners");
  return conic_memory_append(reader->input.context, &region->ends, &region->n_ends, &reader->end_room,
                             &region->n_corners, sizeof *region->ends);
}

static conic_status take_corner(polygon_reader *reader, const char *text, size_t length) {
  cli_cut_region *region = reader->region;
  double place[2];
  const char *comment = memchr(text, '#', length);
  length = comment ? (size_t)(comment - text) : length;
  int is_parted = memchr(text, ',', length) != NULL;
  size_t n = list_numbers(text, length, is_parted ? ',' : ' ', place, 2);
  if (n == 0)
    return comment ? CONIC_OK : end_polygon(reader);
  if (n != 2)
    return conic_input_wrong(&reader->input, "a corner is no x and y");
  return conic_memory_append(reader->input.context, &region->corners, &region->n_corners, &reader->corner_room, place,
                             sizeof place);
}

/* Nothing outside of all polygons is kept. */
static void bound_by_polygons(cli_cut_region *region) {
  for (int axis = 0; axis < 2; axis++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < region->n_corners; i++) {
      low = fmin(low, region->corners[i][axis]);
      high = fmax(high, region->corners[i][axis]);
    }
    region->low[axis] = fmax(region->low[axis], low);
    region->high[axis] = fmin(region->high[axis], high);
  }
}

conic_status cli_cut_read_polygons(conic_context *context, const char *path, cli_cut_region *region) {
  polygon_reader reader = {.region = region};
  int is_done = 0;
  conic_status status = conic_input_open(context, path, &reader.input);
  if (status != CONIC_OK)
    return status;
  status = conic_input_skip_mark(&reader.input);
  while (status == CONIC_OK && !is_done) {
    const char *text;
    size_t length;
    status = conic_input_line(&reader.input, &text, &length);
    if (status == CONIC_OK)
      status = take_corner(&reader, text, length);
    if (status == CONIC_OK)
      status = conic_input_next_line(&reader.input, &is_done);
  }
  if (status == CONIC_OK)
    status = end_polygon(&reader);
  if (status == CONIC_OK && region->n_ends == 0)
    status = conic_input_wrong(&reader.input, "there is no polygon in it");
  if (status == CONIC_OK)
    bound_by_polygons(region);
  conic_input_close(&reader.input);
  return status;
}

/* Whether a ray along x from the place crosses the polygons' sides an odd number of times. */
static int is_in_polygons(const cli_cut_region *region, double x, double y) {
  int is_in = 0;
  for (size_t k = 0, begin = 0; k < region->n_ends; begin = region->ends[k++])
    for (size_t i = begin, before = region->ends[k] - 1; i < region->ends[k]; before = i++) {
      const double *a = region->corners[i], *b = region->corners[before];
      if ((a[1] > y) != (b[1] > y) && x < (b[0] - a[0]) * ((y - a[1]) / (b[1] - a[1])) + a[0])
        is_in = !is_in;
    }
  return is_in;
}

static int is_in_region(const cli_cut_region *region, const conic_splats *batch, size_t i) {
  double place[3];
  for (int axis = 0; axis < 3; axis++) {
    place[axis] = conic_coordinate_of(batch->origin[axis], batch->position[axis][i]);
    if (!(place[axis] >= region->low[axis] && place[axis] <= region->high[axis]))
      return 0;
  }
  return !region->corners || is_in_polygons(region, place[0], place[1]);
}

static conic_status take_clips(conic_context *context, const conic_splats *batch, const uint32_t *sources,
                               conic_splats *kept) {
  if (batch->n_clips == 0)
    return CONIC_OK;
  kept->clips = conic_memory_allocate(context, batch->n_clips, sizeof *kept->clips);
  if (!kept->clips)
    return CONIC_ERROR_MEMORY;
  for (uint32_t i = 0; i < kept->count; i++) {
    size_t at = conic_clip_find(batch, sources[i]);
    if (at < batch->n_clips && batch->clips[at].splat == sources[i]) {
      kept->clips[kept->n_clips] = batch->clips[at];
      kept->clips[kept->n_clips++].splat = i;
    }
  }
  return CONIC_OK;
}

/* The values by name of those that are kept. */
static conic_status take_kept_values(conic_context *context, const conic_splats *batch, const uint32_t *sources,
                                     conic_splats *kept) {
  const conic_point_values *from = batch->values;
  if (!from || from->n == 0)
    return CONIC_OK;
  conic_point_values *to = kept->values = conic_memory_allocate_zeroed(context, 1, sizeof *to);
  if (!to)
    return CONIC_ERROR_MEMORY;
  to->n = to->n_columns = from->n;
  to->count = kept->count;
  memcpy(to->field, from->field, sizeof to->field);
  conic_status status = conic_point_values_reserve(context, to, kept->count);
  for (size_t k = 0; k < to->n && status == CONIC_OK; k++)
    for (size_t i = 0; i < kept->count; i++)
      to->value[k][i] = from->value[k][sources[i]];
  return status;
}

conic_status cli_cut_take(conic_context *context, const cli_cut_region *region, const conic_splats *batch,
                          conic_splats *kept) {
  uint32_t *sources = conic_memory_allocate(context, batch->count, sizeof *sources);
  size_t n = 0;
  memset(kept, 0, sizeof *kept);
  if (!sources)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < batch->count; i++) {
    sources[n] = (uint32_t)i;
    n += (size_t)is_in_region(region, batch, i);
  }
  conic_status status = conic_splats_gather(context, batch, sources, n, kept);
  if (status == CONIC_OK)
    status = take_clips(context, batch, sources, kept);
  if (status == CONIC_OK)
    status = take_kept_values(context, batch, sources, kept);
  conic_memory_release(context, sources);
  if (status != CONIC_OK)
    conic_splats_release(context, kept);
  return status;
}
