#include "core/formats/readers.h"

#include "core/base/vectors.h"
#include "core/formats/ply_columns.h"
#include "core/formats/ply_shares.h"
#include "core/formats/ply_texture.h"

/* State of reading the vertices. */
typedef struct vertex_reader {
  conic_ply_source *source;
  const conic_ply_property *properties;
  conic_ply_layout layout;
  conic_builder *builder;
  conic_ply_block block;
} vertex_reader;

/* The texture coordinates of the block's first `n` rows. */
static conic_status keep_coordinates(const vertex_reader *reader, size_t n) {
  conic_faces *faces = reader->builder->model->faces;
  conic_status status = CONIC_OK;
  if (!reader->layout.has_coordinates)
    return CONIC_OK;
  if (faces->n_coordinates + n > CONIC_MAX_POINTS)
    return conic_ply_wrong(reader->source, "too many texture coordinates");
  for (size_t i = 0; status == CONIC_OK && i < n; i++) {
    const double coordinate[2] = {reader->block[CONIC_PLY_COORDINATE][i], reader->block[CONIC_PLY_COORDINATE + 1][i]};
    status = conic_faces_add_coordinate(reader->builder->context, faces, coordinate);
  }
  return status;
}

/* Appends the block's first `n` rows to the points. A known file size has shown that all rows can be there; for a pipe,
 * the arrays grow with the rows that come. */
static conic_status append_block(vertex_reader *reader, size_t n) {
  conic_splats *points = &reader->builder->model->points;
  conic_status status = conic_builder_reserve_points(reader->builder, points->count + n);
  if (status != CONIC_OK)
    return status;
  conic_ply_layout_convert(&reader->layout, (const double(*)[CONIC_PLY_BLOCK])reader->block, n, points->count, points);
  points->count += n;
  status = keep_coordinates(reader, n);
  return status == CONIC_OK ? conic_builder_deliver(reader->builder, 0) : status;
}

/* Reads the next rows, up to before `end`, into the block. */
static conic_status read_ply_block(vertex_reader *reader, uint64_t end, size_t *n) {
  uint64_t left = end - reader->source->i_row;
  *n = left < CONIC_PLY_BLOCK ? (size_t)left : CONIC_PLY_BLOCK;
  return conic_ply_read_rows(reader->source, reader->properties, reader->layout.property, CONIC_PLY_N_COLUMNS,
                             CONIC_PLY_BLOCK, n, (double *)reader->block);
}

/* Skips rows that are not wanted; their first finite position is still the origin. */
static conic_status pass_rows(vertex_reader *reader, uint64_t end) {
  conic_ply_source *source = reader->source;
  conic_splats *points = &reader->builder->model->points;
  conic_status status = CONIC_OK;
  while (reader->layout.has_origin_positions && !reader->layout.is_origin_set && source->i_row < end) {
    size_t n = 0;
    status = read_ply_block(reader, end, &n);
    if (status == CONIC_OK)
      status = conic_builder_reserve_points(reader->builder, n);
    if (status != CONIC_OK)
      return status;
    conic_ply_layout_convert(&reader->layout, (const double(*)[CONIC_PLY_BLOCK])reader->block, n, 0, points);
  }
  uint64_t n_bytes = (end - source->i_row) * source->element->least_row_bytes, skipped;
  status = conic_input_skip(source->input, n_bytes, &skipped);
  source->i_row = end;
  return status == CONIC_OK && skipped < n_bytes ? conic_ply_truncated(source) : status;
}

static void convert_rows(void *data, const unsigned char *bytes, size_t n, size_t first, void *room) {
  vertex_reader *reader = data;
  double *block = room;
  size_t row_bytes = reader->source->element->least_row_bytes;
  conic_splats *points = &reader->builder->model->points;
  for (size_t k = 0; k < n; k += CONIC_PLY_BLOCK) {
    size_t n_now = n - k < CONIC_PLY_BLOCK ? n - k : CONIC_PLY_BLOCK;
    conic_ply_convert_rows(reader->source, reader->properties, reader->layout.property, CONIC_PLY_N_COLUMNS,
                           bytes + k * row_bytes, n_now, CONIC_PLY_BLOCK, block);
    conic_ply_layout_convert(&reader->layout, (const double(*)[CONIC_PLY_BLOCK])block, n_now, points->count + first + k,
                             points);
  }
}

static conic_status share_rows(vertex_reader *reader, uint64_t end) {
  const conic_ply_taker taker = {convert_rows, reader, sizeof(conic_ply_block)};
  const uint64_t before = reader->source->i_row;
  conic_status status = conic_ply_share_rows(reader->source, end - before, &taker);
  reader->builder->model->points.count += (size_t)(reader->source->i_row - before);
  return status;
}

/* Whether threads may read the rows: those of a whole file, of whose points nothing is made one after the other. */
static int can_share_rows(const vertex_reader *reader) {
  const conic_ply_layout *layout = &reader->layout;
  return reader->source->input->has_size && !reader->builder->delivery && !layout->has_coordinates &&
         (!layout->has_origin_positions || layout->is_origin_set);
}

/* Binary rows of one size, column by column. */
static conic_status read_blocks(vertex_reader *reader) {
  conic_ply_source *source = reader->source;
  uint64_t count = source->element->count;
  conic_points_range range = {0, count};
  if (reader->builder->delivery && reader->builder->delivery->range)
    range = *reader->builder->delivery->range;
  range.end = range.end < count ? range.end : count;
  if (range.first >= range.end)
    return CONIC_OK;
  conic_status status = range.first > 0 ? pass_rows(reader, range.first) : CONIC_OK;
  while (status == CONIC_OK && source->i_row < range.end) {
    size_t n = 0;
    status = read_ply_block(reader, range.end, &n);
    if (status == CONIC_OK)
      status = append_block(reader, n);
    if (status == CONIC_OK && range.end - source->i_row > CONIC_PLY_SHARED_ROWS && can_share_rows(reader))
      status = share_rows(reader, range.end);
  }
  return status;
}

/* Reads a list of clip lines, three values each, into the row's record. A row may have both lists if one of them is
 * empty. */
static conic_status read_clip_list(vertex_reader *reader, const conic_ply_property *property,
                                   conic_clip_operator operation, conic_clip *clip) {
  conic_ply_source *source = reader->source;
  uint64_t count;
  conic_status status = conic_ply_read_list_length(source, property, &count);
  if (status != CONIC_OK || count == 0)
    return status;
  if (count != 3 && count != 6)
    return conic_ply_wrong(source, "a list of clip lines holds neither 0 nor 3 nor 6 values");
  if (clip->n_lines)
    return conic_ply_wrong(source, "a vertex has clip lines in both clip_and and clip_or");
  clip->operation = (uint16_t)operation;
  for (uint64_t i = 0; status == CONIC_OK && i < count; i++) {
    double value = 0.0;
    status = conic_ply_read_value(source, property->type, &value);
    clip->lines[i / 3][i % 3] = (float)value;
  }
  clip->n_lines = (uint16_t)(count / 3);
  return status;
}

/* One row, value by value, into row `i_row` of the block. */
static conic_status read_row(vertex_reader *reader, const int *column_of_property, size_t i_row) {
  conic_ply_source *source = reader->source;
  const int *clip_property = reader->layout.clip_property;
  conic_clip clip = {.splat = (uint32_t)(reader->builder->model->points.count + i_row)};
  conic_status status = conic_ply_begin_row(source);
  for (size_t i = 0; status == CONIC_OK && i < source->element->n_properties; i++) {
    const conic_ply_property *property = &reader->properties[i];
    uint64_t count = 1;
    if (column_of_property[i] >= 0) {
      status = conic_ply_read_value(source, property->type, &reader->block[column_of_property[i]][i_row]);
      continue;
    }
    if ((int)i == clip_property[CONIC_CLIP_AND] || (int)i == clip_property[CONIC_CLIP_OR]) {
      status = read_clip_list(reader, property, (int)i == clip_property[CONIC_CLIP_OR] ? CONIC_CLIP_OR : CONIC_CLIP_AND,
                              &clip);
      continue;
    }
    if (property->is_list)
      status = conic_ply_read_list_length(source, property, &count);
    if (status == CONIC_OK)
      status = conic_ply_skip_values(source, property->type, count);
  }
  if (status == CONIC_OK && clip.n_lines)
    status = conic_builder_add_clip(reader->builder, &clip);
  return status == CONIC_OK ? conic_ply_end_row(source) : status;
}

static conic_status read_rows(vertex_reader *reader) {
  const conic_ply_element *element = reader->source->element;
  conic_context *context = reader->source->input->context;
  conic_status status = CONIC_OK;
  int *column_of_property = conic_memory_allocate(context, element->n_properties, sizeof *column_of_property);
  if (!column_of_property)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < element->n_properties; i++)
    column_of_property[i] = -1;
  for (int column = 0; column < CONIC_PLY_N_COLUMNS; column++)
    if (reader->layout.property[column] >= 0)
      column_of_property[reader->layout.property[column]] = column;
  for (uint64_t done = 0; status == CONIC_OK && done < element->count;) {
    uint64_t left = element->count - done;
    size_t n = left < CONIC_PLY_BLOCK ? (size_t)left : CONIC_PLY_BLOCK;
    for (size_t i = 0; status == CONIC_OK && i < n; i++)
      status = read_row(reader, column_of_property, i);
    n = (size_t)(reader->source->i_row - done);
    if (status == CONIC_OK || (reader->source->is_cut && n > 0))
      status = append_block(reader, n) == CONIC_OK ? status : CONIC_ERROR_MEMORY;
    done += n;
  }
  conic_memory_release(context, column_of_property);
  return status;
}

/* Of n_there rows at most. */
static conic_status read_vertices(vertex_reader *reader, uint64_t n_there) {
  const conic_ply_source *source = reader->source;
  const conic_ply_element *element = source->element;
  const uint64_t count = element->count < n_there ? element->count : n_there;
  conic_status status = CONIC_OK;
  if (reader->layout.has_coordinates)
    conic_faces_begin_vertices(reader->builder->model->faces);
  if (source->input->has_size && !reader->builder->delivery)
    status = conic_builder_reserve_points_exactly(reader->builder, (size_t)count);
  if (status != CONIC_OK)
    return status;
  return conic_ply_is_plain(source->format, element) ? read_blocks(reader) : read_rows(reader);
}

/* Elements are in the header's order; unknown ones are skipped. */
static conic_status read_elements(vertex_reader *reader, const conic_ply_header *header,
                                  const conic_ply_element *vertices, const conic_read_options *options) {
  conic_ply_source *source = reader->source;
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < header->n_elements; i++) {
    const conic_ply_element *element = &header->elements[i];
    const uint64_t n_there = conic_ply_begin_element(source, element);
    if (element == vertices)
      status = read_vertices(reader, n_there);
    else if ((!reader->builder->delivery || reader->builder->delivery->receive_faces) && element->count > 0 &&
             (strcmp(element->name, "face") == 0 || strcmp(element->name, "tristrips") == 0))
      status = conic_ply_read_faces(source, header, vertices->count, options, reader->builder);
    else
      status = conic_ply_skip_element(source, header);
    if (element == vertices && source->i_row < element->count)
      return status; /* the reader of the last part takes what follows */
  }
  return status;
}

static conic_status read_body(conic_input *input, const conic_read_options *options, const conic_ply_header *header,
                              const conic_delivery *delivery, conic_model *model) {
  conic_builder builder;
  conic_ply_source source = {.input = input, .format = header->format};
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  if (!vertices)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: no element 'vertex' in the header (line %llu)",
                      input->name, (unsigned long long)(input->line - 1));
  if (vertices->count > CONIC_MAX_POINTS)
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: %llu vertices are too many (line %llu)", input->name,
                      (unsigned long long)vertices->count, (unsigned long long)vertices->line);
  vertex_reader *reader = conic_memory_allocate(input->context, 1, sizeof *reader);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->source = &source;
  reader->builder = &builder;
  const conic_delivery *at_end = NULL;
  int keeps_coordinates = options->keeps_faces && !delivery;
  conic_status status = conic_ply_layout_find(input, header, vertices, options, keeps_coordinates, &reader->layout);
  if (status == CONIC_OK) {
    reader->layout.keeps_codes = conic_ply_layout_has_codes(&reader->layout) && !(delivery && delivery->receive_faces);
    if (reader->layout.keeps_codes && delivery && !delivery->is_survey && !delivery->is_again) {
      at_end = delivery; /* a pipe can be read once only */
      delivery = NULL;
    }
    reader->properties = header->properties + vertices->first_property; /* there are some, as x, y and z were found */
    status = conic_builder_begin(input->context, model, reader->layout.fields, delivery, &builder);
  }
  if (status == CONIC_OK)
    status = conic_ply_layout_choose_fields(input, header, vertices, options, &builder, &reader->layout);
  if (status == CONIC_OK && keeps_coordinates &&
      (reader->layout.has_coordinates || conic_ply_has_texture_corners(header)))
    status = conic_ply_begin_textures(input, header, model);
  if (status == CONIC_OK)
    status = read_elements(reader, header, vertices, options);
  if (source.is_cut)
    status = conic_ply_tell_cut(&source, conic_builder_points(&builder) > 0);
  if (!model->colors_are)
    model->colors_are = reader->layout.colors_are;
  if (status == CONIC_OK && reader->layout.keeps_codes && !delivery)
    status = conic_raw_colors_decode(input->context, &model->points, conic_raw_kind_of(reader->layout.colors_are),
                                     &model->colors_are);
  if (at_end)
    builder.delivery = at_end;
  if (status == CONIC_OK)
    status = conic_builder_deliver(&builder, 1);
  model->follows_cutoff = reader->layout.form == CONIC_PLY_CIRCLES;
  for (int axis = 0; axis < 3; axis++)
    model->up[axis] = (double)header->up[axis];
  const int is_said = conic_normalize(model->up);
  if (!is_said && reader->layout.form == CONIC_PLY_GAUSSIANS && reader->layout.fields & CONIC_SPLATS_COLORS)
    model->up[1] = -1.0; /* Gaussians are trained in the frame of the first camera, or of COLMAP: y points down */
  conic_memory_release(input->context, reader);
  return status;
}

conic_status conic_ply_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  conic_ply_header header;
  conic_status status = conic_ply_header_read(input, &header);
  if (status != CONIC_OK)
    return status;
  status = read_body(input, options, &header, delivery, model);
  conic_ply_header_release(input->context, &header);
  return status;
}

static int has_faces(const conic_ply_header *header) {
  for (size_t i = 0; i < header->n_elements; i++)
    if (header->elements[i].count > 0 &&
        (strcmp(header->elements[i].name, "face") == 0 || strcmp(header->elements[i].name, "tristrips") == 0))
      return 1;
  return 0;
}

conic_status conic_ply_look(conic_input *input, const conic_read_options *options, conic_model_shape *shape) {
  conic_ply_header header;
  conic_ply_layout layout;
  conic_status status = conic_ply_header_read(input, &header);
  if (status != CONIC_OK)
    return status;
  const conic_ply_element *vertices = conic_ply_find_element(&header, "vertex");
  if (vertices && vertices->count <= CONIC_MAX_POINTS && conic_ply_is_plain(header.format, vertices)) {
    status = conic_ply_layout_find(input, &header, vertices, options, 0, &layout);
    const uint64_t n_there = conic_input_remaining_bytes(input) / vertices->least_row_bytes; /* a file may be cut */
    *shape = (conic_model_shape){.can_part = status == CONIC_OK,
                                 .is_raw = !(layout.fields & (CONIC_SPLATS_TANGENTS | CONIC_SPLATS_NORMALS)),
                                 .needs_survey = conic_ply_layout_has_codes(&layout),
                                 .raw_kind = conic_raw_kind_of(layout.colors_are),
                                 .n_points = vertices->count < n_there ? vertices->count : n_there,
                                 .fields = has_faces(&header) || layout.has_harmonics ? 0 : layout.fields};
  }
  conic_ply_header_release(input->context, &header);
  return status;
}
