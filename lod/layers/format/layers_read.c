#include "lod/layers/format/layers_read.h"

#include <string.h>

#include "conic/layers.h"
#include "core/base/memory.h"
#include "core/base/message.h"

static conic_status read_view(conic_layers_view *view) {
  conic_status status =
      conic_layers_read_header(view->context, view->name, view->mapping.bytes, view->mapping.n_bytes, &view->header);
  if (status != CONIC_OK)
    return status;
  if (view->header.file_bytes != view->mapping.n_bytes)
    return conic_fail(view->context, CONIC_ERROR_INPUT, "%s: %zu bytes, where the header tells of %llu (at byte %zu)",
                      view->name, view->mapping.n_bytes, (unsigned long long)view->header.file_bytes,
                      view->mapping.n_bytes);
  view->entries = conic_memory_allocate(view->context, view->header.n_clouds, sizeof *view->entries);
  if (!view->entries)
    return CONIC_ERROR_MEMORY;
  return conic_layers_read_index(view->context, view->name, &view->header,
                                 view->mapping.bytes + CONIC_LAYERS_HEADER_BYTES, view->entries);
}

conic_status conic_layers_view_open(conic_context *context, const char *path, conic_layers_view *view) {
  memset(view, 0, sizeof *view);
  view->context = context;
  view->name = strcmp(path, "-") == 0 ? "standard input" : path;
  conic_status status = conic_mapping_open(context, path, &view->mapping);
  if (status == CONIC_OK)
    status = read_view(view);
  if (status != CONIC_OK)
    conic_layers_view_close(view);
  return status;
}

void conic_layers_view_close(conic_layers_view *view) {
  if (!view->context)
    return;
  conic_memory_release(view->context, view->entries);
  conic_mapping_close(view->context, &view->mapping);
  memset(view, 0, sizeof *view);
}

static double bits_a_sample(uint64_t n_bytes, const conic_layers_header *header) {
  return 8.0 * (double)n_bytes / (double)header->n_samples;
}

static void describe(const conic_layers_header *header, conic_layers_info *info) {
  memset(info, 0, sizeof *info);
  info->n_samples = header->n_samples;
  info->n_clouds = header->n_clouds;
  info->n_levels = (int)header->n_levels;
  info->n_bytes = header->file_bytes;
  info->cloud_size = header->cloud_size;
  info->most_samples = header->most_samples;
  info->has_colors = (header->flags & CONIC_LAYERS_COLORS) != 0;
  info->is_unoriented = (header->flags & CONIC_LAYERS_UNORIENTED) != 0;
  memcpy(info->minimum, header->low, sizeof info->minimum);
  memcpy(info->maximum, header->high, sizeof info->maximum);
  info->spacing = header->spacing;
  info->quantum = header->quantum;
  info->position_error = conic_layers_position_error(header);
  info->splat_radius = header->splat_radius;
  info->near_z = header->near_z;
  info->bits_position = bits_a_sample(header->position_bytes, header);
  info->bits_normal = bits_a_sample(header->normal_bytes, header);
  info->bits_color = bits_a_sample(header->color_bytes, header);
  info->bits_index = bits_a_sample(CONIC_LAYERS_HEADER_BYTES + conic_layers_index_bytes(header), header);
}

conic_status conic_layers_describe(conic_context *context, const char *path, conic_layers_info *info) {
  conic_layers_view view;
  conic_status status = conic_layers_view_open(context, path, &view);
  if (status != CONIC_OK)
    return status;
  describe(&view.header, info);
  conic_layers_view_close(&view);
  return CONIC_OK;
}
