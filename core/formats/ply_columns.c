#include "core/formats/ply_columns.h"

#include "core/base/color.h"
#include "core/base/gaussian.h"
#include "core/base/vectors.h"
#include "core/splats/ellipse.h"
#include "core/splats/point_fields.h"

/* The properties' names, for consecutive columns in their order. Where a file has several names for one column, the
 * first one listed here counts. */
static const struct {
  conic_ply_column first;
  const char *names[4];
} columns[] = {{CONIC_PLY_X, {"x", "y", "z"}},
               {CONIC_PLY_TANGENT_U, {"tu_x", "tu_y", "tu_z"}},
               {CONIC_PLY_TANGENT_V, {"tv_x", "tv_y", "tv_z"}},
               {CONIC_PLY_NORMAL, {"nx", "ny", "nz"}},
               {CONIC_PLY_RADIUS, {"radius"}},
               {CONIC_PLY_RED, {"red", "green", "blue"}},
               {CONIC_PLY_RED, {"diffuse_red", "diffuse_green", "diffuse_blue"}},
               {CONIC_PLY_RED, {"r", "g", "b"}},
               {CONIC_PLY_OPACITY, {"opacity"}},
               {CONIC_PLY_DOT, {"dot"}},
               {CONIC_PLY_SCALE, {"scale_0", "scale_1", "scale_2"}},
               {CONIC_PLY_ROTATION, {"rot_0", "rot_1", "rot_2", "rot_3"}},
               {CONIC_PLY_HARMONIC, {"f_dc_0", "f_dc_1", "f_dc_2"}}};

static int has_columns(const conic_ply_layout *layout, conic_ply_column first, int n) {
  for (int i = 0; i < n; i++)
    if (layout->property[(int)first + i] < 0)
      return 0;
  return 1;
}

static void drop_columns(conic_ply_layout *layout, conic_ply_column first, int n) {
  for (int i = 0; i < n; i++)
    layout->property[(int)first + i] = -1;
}

/* Whether the vertices have a value of that name, and which property it is. */
static int find_value(const conic_ply_header *header, const conic_ply_element *vertices, const char *name,
                      int *i_property) {
  *i_property = conic_ply_find_property(header, vertices, name);
  return *i_property >= 0 && !header->properties[vertices->first_property + (size_t)*i_property].is_list;
}

static void set_column(const conic_ply_header *header, const conic_ply_element *vertices, int column, int i_property,
                       conic_ply_layout *layout) {
  layout->property[column] = i_property;
  layout->type[column] = header->properties[vertices->first_property + (size_t)i_property].type;
}

static void find_columns(const conic_ply_header *header, const conic_ply_element *vertices, conic_ply_layout *layout) {
  for (int i = 0; i < CONIC_PLY_N_COLUMNS; i++)
    layout->property[i] = -1;
  for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
    for (int k = 0; k < 4 && columns[i].names[k]; k++) {
      int column = (int)columns[i].first + k, i_property;
      if (layout->property[column] < 0 && find_value(header, vertices, columns[i].names[k], &i_property))
        set_column(header, vertices, column, i_property, layout);
    }
}

/* The first pair of names that are both there. */
static void find_coordinates(const conic_ply_header *header, const conic_ply_element *vertices,
                             conic_ply_layout *layout) {
  static const char *const pairs[][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs && !layout->has_coordinates; i++) {
    int of_pair[2];
    if (!find_value(header, vertices, pairs[i][0], &of_pair[0]) ||
        !find_value(header, vertices, pairs[i][1], &of_pair[1]))
      continue;
    layout->has_coordinates = 1;
    for (int k = 0; k < 2; k++)
      set_column(header, vertices, CONIC_PLY_COORDINATE + k, of_pair[k], layout);
  }
}

/* Clip lines are in units of the tangent axes, and need them. */
static void find_clip_lists(const conic_ply_header *header, const conic_ply_element *vertices,
                            conic_ply_layout *layout) {
  static const char *const list_names[2] = {[CONIC_CLIP_AND] = "clip_and", [CONIC_CLIP_OR] = "clip_or"};
  for (int i = 0; i < 2; i++) {
    int i_property = conic_ply_find_property(header, vertices, list_names[i]);
    layout->clip_property[i] = -1;
    if (i_property >= 0 && layout->form == CONIC_PLY_AXES &&
        header->properties[vertices->first_property + (size_t)i_property].is_list)
      layout->clip_property[i] = i_property;
  }
}

/* An opacity is a logit beside scales and rotations, and a factor beside axes or radii if it is no integer. Elsewhere
 * its meaning is not known. */
static void choose_opacity(conic_ply_layout *layout) {
  int is_factor = (layout->form == CONIC_PLY_AXES || layout->form == CONIC_PLY_CIRCLES) &&
                  !conic_ply_type_is_integer(layout->type[CONIC_PLY_OPACITY]);
  if (layout->form != CONIC_PLY_GAUSSIANS && !is_factor)
    drop_columns(layout, CONIC_PLY_OPACITY, 1);
}

/* Takes alpha where there is no opacity. */
static void use_alpha(const conic_ply_header *header, const conic_ply_element *vertices, conic_ply_layout *layout) {
  int i_property;
  if (layout->form == CONIC_PLY_GAUSSIANS || has_columns(layout, CONIC_PLY_OPACITY, 1) ||
      !find_value(header, vertices, "alpha", &i_property))
    return;
  set_column(header, vertices, CONIC_PLY_OPACITY, i_property, layout);
  layout->is_alpha = 1;
}

static void choose_form(conic_ply_layout *layout) {
  int has_normals = has_columns(layout, CONIC_PLY_NORMAL, 3);
  layout->form = has_normals ? CONIC_PLY_NORMALS : CONIC_PLY_POINTS;
  if (has_normals && has_columns(layout, CONIC_PLY_RADIUS, 1))
    layout->form = CONIC_PLY_CIRCLES;
  if (has_columns(layout, CONIC_PLY_SCALE, 2) && has_columns(layout, CONIC_PLY_ROTATION, 4))
    layout->form = CONIC_PLY_GAUSSIANS;
  if (has_columns(layout, CONIC_PLY_TANGENT_U, 6))
    layout->form = CONIC_PLY_AXES;
  if (layout->form != CONIC_PLY_AXES)
    drop_columns(layout, CONIC_PLY_TANGENT_U, 6);
  if (layout->form != CONIC_PLY_AXES && layout->form != CONIC_PLY_CIRCLES)
    drop_columns(layout, CONIC_PLY_DOT, 1);
  if (layout->form != CONIC_PLY_NORMALS && layout->form != CONIC_PLY_CIRCLES)
    drop_columns(layout, CONIC_PLY_NORMAL, 3);
  if (layout->form != CONIC_PLY_CIRCLES)
    drop_columns(layout, CONIC_PLY_RADIUS, 1);
  layout->n_scales = has_columns(layout, CONIC_PLY_SCALE, 3) ? 3 : 2;
  layout->has_harmonics = layout->form == CONIC_PLY_GAUSSIANS && has_columns(layout, CONIC_PLY_HARMONIC, 3);
  if (layout->form != CONIC_PLY_GAUSSIANS)
    drop_columns(layout, CONIC_PLY_SCALE, 7);
  if (!layout->has_harmonics)
    drop_columns(layout, CONIC_PLY_HARMONIC, 3);
  if (layout->has_harmonics || !has_columns(layout, CONIC_PLY_RED, 3))
    drop_columns(layout, CONIC_PLY_RED, 3);
  choose_opacity(layout);
}

/* A float cannot hold a double or a 32-bit integer: such positions are measured from an origin near them. */
static int needs_origin(conic_ply_type type) {
  return type == CONIC_PLY_DOUBLE || type == CONIC_PLY_INT32 || type == CONIC_PLY_UINT32;
}

int conic_ply_layout_has_codes(const conic_ply_layout *layout) {
  return layout->colors_are == CONIC_COLORS_DISPLAY ||
         (layout->colors_are == CONIC_COLORS_CODES && layout->type[CONIC_PLY_RED] == CONIC_PLY_UINT16);
}

conic_color_meaning conic_ply_colors_are(int is_conics, const conic_read_options *options, conic_ply_type type) {
  if (conic_ply_type_is_integer(type))
    return CONIC_COLORS_CODES;
  if (options->colors_are)
    return (conic_color_meaning)options->colors_are;
  return is_conics ? CONIC_COLORS_LINEAR : CONIC_COLORS_DISPLAY;
}

conic_status conic_ply_layout_find(conic_input *input, const conic_ply_header *header,
                                   const conic_ply_element *vertices, const conic_read_options *options,
                                   int keeps_coordinates, conic_ply_layout *layout) {
  memset(layout, 0, sizeof *layout);
  find_columns(header, vertices, layout);
  if (!has_columns(layout, CONIC_PLY_X, 3)) {
    int is_packed = conic_ply_find_property(header, vertices, "packed_position") >= 0;
    return conic_fail(input->context, CONIC_ERROR_INPUT, "%s: %s (line %llu)", input->name,
                      is_packed
                          ? "the vertices are packed, as SuperSplat packs Gaussians: save them as a plain PLY there"
                          : "the vertices lack x, y or z",
                      (unsigned long long)vertices->line);
  }
  choose_form(layout);
  if (options->keeps_alpha)
    use_alpha(header, vertices, layout);
  find_clip_lists(header, vertices, layout);
  if (keeps_coordinates)
    find_coordinates(header, vertices, layout);
  layout->cutoff = options->cutoff;
  conic_srgb_decode_table(layout->srgb);
  for (int axis = 0; axis < 3; axis++)
    layout->has_origin_positions |= needs_origin(layout->type[CONIC_PLY_X + axis]);
  if (layout->form >= CONIC_PLY_CIRCLES)
    layout->fields |= CONIC_SPLATS_TANGENTS;
  if (layout->form == CONIC_PLY_NORMALS)
    layout->fields |= CONIC_SPLATS_NORMALS;
  if (layout->has_harmonics)
    layout->colors_are = CONIC_COLORS_TRAINED;
  else if (has_columns(layout, CONIC_PLY_RED, 3))
    layout->colors_are =
        conic_ply_colors_are(header->is_conics || layout->form == CONIC_PLY_AXES, options, layout->type[CONIC_PLY_RED]);
  if (layout->colors_are)
    layout->fields |= CONIC_SPLATS_COLORS;
  if (has_columns(layout, CONIC_PLY_OPACITY, 1))
    layout->fields |= CONIC_SPLATS_OPACITIES;
  if (has_columns(layout, CONIC_PLY_DOT, 1))
    layout->fields |= CONIC_SPLATS_DOTS;
  return CONIC_OK;
}

static int column_of(const conic_ply_layout *layout, int i_property) {
  int column = 0;
  while (column < CONIC_PLY_FIELD && layout->property[column] != i_property)
    column++;
  return column;
}

conic_status conic_ply_layout_choose_fields(conic_input *input, const conic_ply_header *header,
                                            const conic_ply_element *vertices, const conic_read_options *options,
                                            conic_builder *builder, conic_ply_layout *layout) {
  const conic_ply_property *properties = header->properties + vertices->first_property;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < vertices->n_properties && status == CONIC_OK; i++)
    if (!properties[i].is_list)
      status = conic_fields_add(builder, properties[i].name, strlen(properties[i].name),
                                conic_ply_type_name(properties[i].type));
  conic_read_options asked = *options;
  int i_confidence;
  if (asked.field_is_optional && find_value(header, vertices, "confidence", &i_confidence))
    asked.field = NULL; /* the intensity beside it, as in Stanford's scans, tells of measuring, and is no colour */
  if (status == CONIC_OK)
    status = conic_fields_choose(builder, input->name, &asked);
  layout->n_values = status == CONIC_OK ? (int)conic_builder_columns(builder) : 0;
  for (int k = 0; k < layout->n_values; k++) {
    int field = conic_builder_column_field(builder, (size_t)k);
    layout->value_column[k] = -1;
    if (field < 0)
      continue;
    int i_property = conic_ply_find_property(header, vertices, builder->model->fields[field].name);
    layout->value_column[k] = column_of(layout, i_property);
    if (layout->value_column[k] == CONIC_PLY_FIELD) {
      layout->value_column[k] += k;
      set_column(header, vertices, CONIC_PLY_FIELD + k, i_property, layout);
    }
  }
  return status;
}

static void find_origin(conic_ply_layout *layout, const conic_ply_block block, size_t n, conic_splats *points) {
  for (size_t i = 0; i < n && !layout->is_origin_set; i++) {
    double x = block[CONIC_PLY_X][i], y = block[CONIC_PLY_X + 1][i], z = block[CONIC_PLY_X + 2][i];
    if (!(x - x == 0.0 && y - y == 0.0 && z - z == 0.0))
      continue;
    points->origin[0] = x;
    points->origin[1] = y;
    points->origin[2] = z;
    layout->is_origin_set = 1;
  }
}

static void store_column(const double *values, size_t n, double origin, float *to) {
  for (size_t i = 0; i < n; i++)
    to[i] = (float)(values[i] - origin);
}

static void store_vectors(const conic_ply_block block, conic_ply_column first_column, size_t n, size_t first,
                          float *const to[3]) {
  for (int axis = 0; axis < 3; axis++)
    store_column(block[(int)first_column + axis], n, 0.0, to[axis] + first);
}

static void store_axes(conic_splats *points, size_t i, const double tangent_u[3], const double tangent_v[3]) {
  for (int axis = 0; axis < 3; axis++) {
    points->tangent_u[axis][i] = (float)tangent_u[axis];
    points->tangent_v[axis][i] = (float)tangent_v[axis];
  }
}

/* Stores zero axes, to be repaired later, where the normal or the radius cannot be used. */
static void store_circles(const conic_ply_layout *layout, const conic_ply_block block, size_t n, size_t first,
                          conic_splats *points) {
  for (size_t i = 0; i < n; i++) {
    double tangent_u[3], tangent_v[3], sigma = block[CONIC_PLY_RADIUS][i] / (double)layout->cutoff;
    double normal[3] = {block[CONIC_PLY_NORMAL][i], block[CONIC_PLY_NORMAL + 1][i], block[CONIC_PLY_NORMAL + 2][i]};
    int is_usable = conic_normalize(normal) && sigma > 0.0 && sigma - sigma == 0.0;
    conic_tangent_basis(normal, tangent_u, tangent_v);
    for (int axis = 0; axis < 3; axis++) {
      tangent_u[axis] = is_usable ? tangent_u[axis] * sigma : 0.0;
      tangent_v[axis] = is_usable ? tangent_v[axis] * sigma : 0.0;
    }
    store_axes(points, first + i, tangent_u, tangent_v);
  }
}

static void store_gaussians(const conic_ply_layout *layout, const conic_ply_block block, size_t n, size_t first,
                            conic_splats *points) {
  for (size_t i = 0; i < n; i++) {
    double scales[3] = {0, 0, 0}, rotation[4], tangent_u[3], tangent_v[3];
    for (int k = 0; k < layout->n_scales; k++)
      scales[k] = block[CONIC_PLY_SCALE + k][i];
    for (int k = 0; k < 4; k++)
      rotation[k] = block[CONIC_PLY_ROTATION + k][i];
    conic_gaussian_axes(scales, layout->n_scales, rotation, tangent_u, tangent_v);
    store_axes(points, first + i, tangent_u, tangent_v);
  }
}

/* Integers are sRGB codes, of 16 bits or of 8. Of 16 bits, many programs use 8. */
static void store_colors(const conic_ply_layout *layout, const double *values, size_t n, conic_ply_type type,
                         float *to) {
  for (size_t i = 0; i < n; i++) {
    double value = values[i];
    if (layout->has_harmonics)
      to[i] = (float)conic_gaussian_color(value);
    else if (layout->keeps_codes || layout->colors_are == CONIC_COLORS_LINEAR)
      to[i] = (float)value;
    else if (layout->colors_are == CONIC_COLORS_DISPLAY || type == CONIC_PLY_UINT16)
      to[i] = (float)conic_srgb_decode(type == CONIC_PLY_UINT16 ? value / 65535.0 : value);
    else
      to[i] = layout->srgb[value > 0.0 ? value < 255.0 ? (int)value : 255 : 0];
  }
}

static void store_opacities(const conic_ply_layout *layout, const double *values, size_t n, float *to) {
  conic_ply_type type = layout->type[CONIC_PLY_OPACITY];
  double whole = !layout->is_alpha || !conic_ply_type_is_integer(type) ? 1.0
                 : type == CONIC_PLY_UINT16                            ? 65535.0
                                                                       : 255.0;
  for (size_t i = 0; i < n; i++)
    to[i] = (float)(layout->form == CONIC_PLY_GAUSSIANS ? conic_gaussian_opacity(values[i]) : values[i] / whole);
}

void conic_ply_layout_convert(conic_ply_layout *layout, const conic_ply_block block, size_t n, size_t first,
                              conic_splats *points) {
  int first_color = layout->has_harmonics ? CONIC_PLY_HARMONIC : CONIC_PLY_RED;
  if (layout->has_origin_positions && !layout->is_origin_set)
    find_origin(layout, block, n, points);
  for (int axis = 0; axis < 3; axis++)
    store_column(block[CONIC_PLY_X + axis], n, points->origin[axis], points->position[axis] + first);
  if (layout->form == CONIC_PLY_AXES) {
    store_vectors(block, CONIC_PLY_TANGENT_U, n, first, points->tangent_u);
    store_vectors(block, CONIC_PLY_TANGENT_V, n, first, points->tangent_v);
  } else if (layout->form == CONIC_PLY_CIRCLES)
    store_circles(layout, block, n, first, points);
  else if (layout->form == CONIC_PLY_GAUSSIANS)
    store_gaussians(layout, block, n, first, points);
  else if (layout->form == CONIC_PLY_NORMALS)
    store_vectors(block, CONIC_PLY_NORMAL, n, first, points->normal);
  for (int axis = 0; axis < 3 && points->color[0]; axis++)
    store_colors(layout, block[first_color + axis], n, layout->type[first_color + axis], points->color[axis] + first);
  if (points->opacity)
    store_opacities(layout, block[CONIC_PLY_OPACITY], n, points->opacity + first);
  for (size_t i = 0; points->dot && i < n; i++)
    points->dot[first + i] = block[CONIC_PLY_DOT][i] != 0.0 ? 1.0f : 0.0f;
  for (int k = 0; k < layout->n_values; k++)
    if (layout->value_column[k] >= 0)
      memcpy(points->values->value[k] + first, block[layout->value_column[k]], n * sizeof **block);
}
