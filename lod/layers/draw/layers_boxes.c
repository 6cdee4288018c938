/* How a layered cloud parts its samples, as a picture (after LPC's Figs. 1 and 4). */

#include "core/coloring/color_ramp.h"
#include "core/image/box_lines.h"
#include "core/image/image_common.h"
#include "lod/layers/draw/layers_scene.h"
#include "lod/layers/format/layers_key.h"

/* Where the level is not said, it is the one with the most places, but no more than that. */
enum { MOST_BOXES = 64 };

static int choose_level(const conic_layers *layers) {
  int chosen = 0, most = 0;
  for (int level = 0; level < (int)layers->header.n_levels; level++) {
    int n = 0;
    for (uint32_t i = 0; i < layers->header.n_clouds; i++)
      n += (int)layers->entries[i].level == level;
    if (n >= most && n <= MOST_BOXES) {
      chosen = level;
      most = n;
    }
  }
  return chosen;
}

/* The cell of the grid that holds a place: the bits that its key has in common leave so many steps on each axis. */
static void find_cell(const conic_layers_header *header, const conic_layers_entry *entry, double box[2][3]) {
  int n_free = 3 * (int)header->bits - (int)entry->depth;
  for (int axis = 0; axis < 3; axis++) {
    double low = (double)conic_layers_step(entry->key, axis), n_steps = (double)(1u << ((n_free + axis) / 3));
    box[0][axis] = header->origin[axis] + low * header->quantum;
    box[1][axis] = box[0][axis] + n_steps * header->quantum;
  }
}

conic_status conic_layers_draw_boxes(conic_layers *layers, const conic_camera *camera, int level,
                                     const conic_image *image, conic_image *map) {
  conic_context *context = layers->context;
  memset(map, 0, sizeof *map);
  if (!image->planes[CONIC_PLANE_RGBA] || !image->planes[CONIC_PLANE_Z] || image->width != camera->width ||
      image->height != camera->height)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "boxes: the image has not rgba and Z of that camera");
  conic_status status = conic_image_allocate(context, image->width, image->height, 1u << CONIC_PLANE_RGBA, map);
  if (status != CONIC_OK)
    return status;
  memcpy(map->planes[CONIC_PLANE_RGBA], image->planes[CONIC_PLANE_RGBA], 4 * sizeof(float) * conic_image_pixels(image));
  level = level < 0 ? choose_level(layers) : level;
  for (uint32_t i = 0; i < layers->header.n_clouds; i++) {
    double box[2][3];
    float color[3];
    if (layers->entries[i].level != level)
      continue;
    find_cell(&layers->header, &layers->entries[i], box);
    conic_number_color(i, color);
    conic_box_lines_paint(camera, layers->header.near_z, image->planes[CONIC_PLANE_Z], map, (const double(*)[3])box,
                          color);
  }
  return CONIC_OK;
}
