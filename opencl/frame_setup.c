/* Set-up: the splats of a part to the device, their records, and these in order. */

#include "opencl/frame.h"
#include "raster/project/clip_lines.h"
#include "raster/view/method.h"

static void note_splats(const conic_frame *f, conic_splats_on_device *list) {
  const conic_splats *s = f->splats;
  memset(list, 0, sizeof *list);
  list->version = f->splats_version;
  list->count = s->count;
  list->n_clips = s->n_clips;
  list->clips = s->clips;
  for (int axis = 0; axis < 3; axis++) {
    list->columns[axis] = s->position[axis];
    list->columns[3 + axis] = s->tangent_u[axis];
    list->columns[6 + axis] = s->tangent_v[axis];
    list->columns[9 + axis] = s->color[axis];
  }
  list->columns[12] = s->opacity;
}

static conic_status write_columns(const conic_frame *f, const conic_splats_on_device *list) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < CONIC_N_COLUMNS && status == CONIC_OK; i++) {
    const float *column = list->columns[i];
    status = conic_frame_give(f, CONIC_BUFFER_COLUMNS + i, column ? column + f->first : NULL,
                              column ? f->n * sizeof(float) : 0);
  }
  return status;
}

/* The clip lines of the part's splats. */
static conic_status write_clips(const conic_frame *f, size_t *n_clips) {
  const conic_splats *s = f->splats;
  size_t begin = 0, end;
  while (begin < s->n_clips && s->clips[begin].splat < f->first)
    begin++;
  for (end = begin; end < s->n_clips && s->clips[end].splat < f->first + f->n;)
    end++;
  *n_clips = end - begin;
  return end == begin ? CONIC_OK
                      : conic_frame_copy(f, CONIC_BUFFER_CLIPS, s->clips + begin, (end - begin) * sizeof *s->clips);
}

/* The part's splats to the device, unless they are there from the picture before; and how many of them have clip
 * lines. A CPU's device reads them where they are, and holds no copy. */
static conic_status bring_splats(const conic_frame *f, uint32_t *n_clips) {
  conic_opencl *opencl = f->opencl;
  conic_splats_on_device list;
  size_t n = f->splats->n_clips;
  note_splats(f, &list);
  int is_whole = f->first == 0 && f->n == f->splats->count,
      may_keep = is_whole && list.version && !opencl->device.is_cpu;
  conic_status status = CONIC_OK;
  if (!may_keep || memcmp(&list, &opencl->kept, sizeof list) != 0) {
    opencl->kept.version = 0;
    status = write_columns(f, &list);
    if (status == CONIC_OK)
      status = write_clips(f, &n);
    if (status == CONIC_OK && may_keep)
      opencl->kept = list;
  }
  if (status == CONIC_OK && n)
    status = conic_frame_room(f, CONIC_BUFFER_CLIP_RECORDS, f->n, sizeof(conic_clip_record));
  *n_clips = (uint32_t)n;
  return status;
}

static conic_status make_room_for_records(const conic_frame *f) {
  const struct {
    int buffer;
    size_t count, size;
  } needed[] = {{CONIC_BUFFER_FOOTPRINTS, f->n, sizeof(conic_footprint)},
                {CONIC_BUFFER_BOXES, f->n, sizeof(conic_box)},
                {CONIC_BUFFER_SURFACES, f->n, sizeof(conic_projected_surface)},
                {CONIC_BUFFER_RAYS, f->n, sizeof(conic_ray)},
                {CONIC_BUFFER_ORDER, f->n, sizeof(uint32_t)},
                {CONIC_BUFFER_N_DRAWN, f->n_items, sizeof(uint32_t)},
                {CONIC_BUFFER_PLACES, f->n_items + (size_t)1, sizeof(uint64_t)}};
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < sizeof needed / sizeof needed[0] && status == CONIC_OK; i++)
    status = conic_frame_room(f, needed[i].buffer, needed[i].count, needed[i].size);
  return status;
}

static conic_status project_on_device(conic_frame *f) {
  conic_queue *queue = &f->opencl->queue;
  uint32_t n_clips = 0, fields = 0, first = (uint32_t)f->first;
  conic_argument arguments[27];
  int n = 0;
  fields |= f->splats->color[0] ? CONIC_DEVICE_HAS_COLOR : 0;
  fields |= f->splats->opacity ? CONIC_DEVICE_HAS_OPACITY : 0;
  conic_status status = bring_splats(f, &n_clips);
  if (status == CONIC_OK)
    status = conic_queue_fill_zero(queue, &f->opencl->buffers[CONIC_BUFFER_COUNTS],
                                   CONIC_DEVICE_N_COUNTS * sizeof(uint32_t));
  if (status != CONIC_OK)
    return status;
  arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_VIEW);
  arguments[n++] = CONIC_ARGUMENT(f->n);
  arguments[n++] = CONIC_ARGUMENT(first);
  arguments[n++] = CONIC_ARGUMENT(f->splats_per_item);
  arguments[n++] = CONIC_ARGUMENT(fields);
  for (int column = 0; column < CONIC_N_COLUMNS; column++)
    arguments[n++] = conic_frame_argument(f, CONIC_BUFFER_COLUMNS + column);
  arguments[n++] = CONIC_ARGUMENT(n_clips);
  for (int buffer = CONIC_BUFFER_CLIPS; buffer <= CONIC_BUFFER_COUNTS; buffer++)
    arguments[n++] = conic_frame_argument(f, buffer);
  int is_in_lanes = f->opencl->work == CONIC_OPENCL_WORK_TILES && !conic_method_is_dot(f->view->method);
  return conic_frame_run(f, CONIC_STAGE_SETUP, is_in_lanes ? CONIC_ENTRY_PROJECT_LANES : CONIC_ENTRY_PROJECT, arguments,
                         n, f->n_items);
}

static conic_status compact(conic_frame *f) {
  uint64_t n_drawn;
  conic_status status =
      conic_frame_scan(f, CONIC_STAGE_SETUP, f->n_items, CONIC_BUFFER_N_DRAWN, CONIC_BUFFER_PLACES, &n_drawn);
  if (status != CONIC_OK)
    return status;
  f->n_drawn = (uint32_t)n_drawn;
  const conic_argument arguments[] = {
      CONIC_ARGUMENT(f->n_items), CONIC_ARGUMENT(f->splats_per_item), conic_frame_argument(f, CONIC_BUFFER_N_DRAWN),
      conic_frame_argument(f, CONIC_BUFFER_PLACES), conic_frame_argument(f, CONIC_BUFFER_ORDER)};
  return conic_frame_run(f, CONIC_STAGE_SETUP, CONIC_ENTRY_COMPACT, arguments, 5, f->n_items);
}

conic_status conic_frame_project(conic_frame *f, size_t first, size_t n) {
  f->first = first;
  f->n = (uint32_t)n;
  f->n_drawn = 0;
  f->splats_per_item =
      f->opencl->work == CONIC_OPENCL_WORK_TILES || f->opencl->projects_on_host ? CONIC_SETUP_SPLATS : 1;
  f->n_items = (f->n + f->splats_per_item - 1) / f->splats_per_item;
  conic_status status = make_room_for_records(f);
  if (status != CONIC_OK || n == 0)
    return status;
  status = f->opencl->projects_on_host ? conic_frame_project_on_host(f) : project_on_device(f);
  return status == CONIC_OK ? compact(f) : status;
}
