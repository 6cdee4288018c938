/* A whole .lpc file in memory: for looking at it, not for drawing. */
#include "lod/layers/format/layers_format.h"

#include "conic/layers.h"

static conic_status read_tables(conic_layers_file *file) {
  conic_status status =
      conic_layers_read_header(file->context, file->name, file->mapping.bytes, file->mapping.n_bytes, &file->header);
  if (status != CONIC_OK)
    return status;
  if (file->header.file_bytes != file->mapping.n_bytes)
    return conic_fail(file->context, CONIC_ERROR_INPUT, "%s: %zu bytes, where the header tells of %llu (at byte %zu)",
                      file->name, file->mapping.n_bytes, (unsigned long long)file->header.file_bytes,
                      file->mapping.n_bytes);
  file->entries = conic_memory_allocate(file->context, conic_layers_all_entries(&file->header), sizeof *file->entries);
  if (!file->entries)
    return CONIC_ERROR_MEMORY;
  return conic_layers_read_index(file->context, file->name, &file->header,
                                 file->mapping.bytes + CONIC_LAYERS_HEADER_BYTES, file->entries);
}

conic_status conic_layers_file_open(conic_context *context, const char *path, conic_layers_file *file) {
  memset(file, 0, sizeof *file);
  file->context = context;
  file->name = strcmp(path, "-") == 0 ? "standard input" : path;
  conic_status status = conic_mapping_open(context, path, &file->mapping);
  if (status == CONIC_OK)
    status = read_tables(file);
  if (status != CONIC_OK)
    conic_layers_file_close(file);
  return status;
}

void conic_layers_file_close(conic_layers_file *file) {
  if (!file->context)
    return;
  conic_memory_release(file->context, file->entries);
  conic_mapping_close(file->context, &file->mapping);
  memset(file, 0, sizeof *file);
}

static double bits_a_sample(uint64_t n_bytes, const conic_layers_header *header) {
  return 8.0 * (double)n_bytes / (double)header->n_samples;
}

static void describe_header(const conic_layers_header *header, conic_layers_info *info) {
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
  for (int axis = 0; axis < 3; axis++)
    info->up[axis] = (double)header->up[axis];
  info->bits_position = bits_a_sample(header->position_bytes, header);
  info->bits_normal = bits_a_sample(header->normal_bytes, header);
  info->bits_color = bits_a_sample(header->color_bytes, header);
  uint64_t n_index = CONIC_LAYERS_HEADER_BYTES + conic_layers_index_bytes(header);
  uint64_t n_known = n_index + header->position_bytes + header->normal_bytes + header->color_bytes;
  info->bits_more = header->file_bytes > n_known ? bits_a_sample(header->file_bytes - n_known, header) : 0.0;
  info->bits_index = bits_a_sample(n_index, header);
}

conic_status conic_layers_describe(conic_context *context, const char *path, conic_layers_info *info) {
  conic_layers_file file;
  conic_status status = conic_layers_file_open(context, path, &file);
  if (status != CONIC_OK)
    return status;
  describe_header(&file.header, info);
  conic_layers_file_close(&file);
  return CONIC_OK;
}
