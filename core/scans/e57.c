#include "core/formats/readers.h"

#include "core/base/trigonometry.h"
#include "core/scans/e57_file.h"
#include "core/scans/sight.h"
#include "core/splats/point_fields.h"

/* The meanings of a scan's columns. */
enum {
  PLACE,
  COLOR = 3,
  NORMAL = 6,
  POINT_INVALID = 9,
  COLOR_INVALID,
  INTENSITY_INVALID,
  VALUES, /* the requested ones */
  N_SLOTS = VALUES + CONIC_MOST_POINT_VALUES
};

static const char *const cartesian[] = {"cartesianX", "cartesianY", "cartesianZ"};
static const char *const spherical[] = {"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
static const char *const others[] = {"colorRed", "colorGreen", "colorBlue", "normalX", "normalY", "normalZ"};

typedef struct e57_reader {
  conic_e57_file *file;
  const conic_e57_scan *scan; /* the current one */
  conic_builder builder;
  int n_slots;
  int is_spherical, has_sights;
  int drops_zeros;      /* of the current scan: what lies at the scanner was not measured */
  uint64_t n_zeros;     /* of all scans, that were left out */
  int columns[N_SLOTS]; /* −1: the scan lacks it */
  double rotation[3][3], color_low, color_high;
  double block[N_SLOTS][CONIC_E57_BLOCK];
  uint64_t n_done, n_all;
} e57_reader;

int conic_e57_is(const char *bytes, size_t n) {
  return n >= 8 && memcmp(bytes, "ASTM-E57", 8) == 0;
}

static int has_all(const conic_e57_scan *scan, const char *const names[3]) {
  return conic_e57_column_find(scan, names[0]) >= 0 && conic_e57_column_find(scan, names[1]) >= 0 &&
         conic_e57_column_find(scan, names[2]) >= 0;
}

/* Clouds that were merged from others have no pose, and were not seen from their origin. */
static int has_station(const conic_e57_scan *scan) {
  return scan->has_pose || has_all(scan, spherical) ||
         (conic_e57_column_find(scan, "rowIndex") >= 0 && conic_e57_column_find(scan, "columnIndex") >= 0);
}

/* Takes the limits that the scan states, else those of the column's type. */
static void find_color_scale(e57_reader *reader) {
  const conic_e57_column *red = &reader->scan->columns[reader->columns[COLOR]];
  const conic_e57_limits *stated = &reader->scan->color;
  int is_real = red->type == CONIC_E57_SINGLE || red->type == CONIC_E57_DOUBLE;
  reader->color_low = is_real ? 0.0 : (double)red->low * red->scale + red->offset;
  reader->color_high = is_real ? 1.0 : (double)red->high * red->scale + red->offset;
  if (stated->is_there && stated->high > stated->low) {
    reader->color_low = stated->low;
    reader->color_high = stated->high;
  }
}

static const char *name_of_field(const e57_reader *reader, int field) {
  return reader->builder.model->fields[field].name;
}

/* Finds the columns of the slots. */
static conic_status choose_columns(e57_reader *reader) {
  const conic_e57_scan *scan = reader->scan;
  reader->is_spherical = !has_all(scan, cartesian);
  if (reader->is_spherical && !has_all(scan, spherical))
    return conic_e57_wrong(reader->file, "the points of a scan have no coordinates", scan->records_offset);
  for (int i = 0; i < 3; i++)
    reader->columns[PLACE + i] = conic_e57_column_find(scan, reader->is_spherical ? spherical[i] : cartesian[i]);
  for (int i = 0; i < 6; i++)
    reader->columns[COLOR + i] =
        has_all(scan, others + (size_t)i / 3 * 3) ? conic_e57_column_find(scan, others[i]) : -1;
  reader->columns[POINT_INVALID] =
      conic_e57_column_find(scan, reader->is_spherical ? "sphericalInvalidState" : "cartesianInvalidState");
  reader->columns[COLOR_INVALID] = conic_e57_column_find(scan, "isColorInvalid");
  reader->columns[INTENSITY_INVALID] = conic_e57_column_find(scan, "isIntensityInvalid");
  for (int slot = VALUES; slot < reader->n_slots; slot++) {
    int field = conic_builder_column_field(&reader->builder, (size_t)(slot - VALUES));
    reader->columns[slot] = field >= 0 ? conic_e57_column_find(scan, name_of_field(reader, field)) : -1;
  }
  reader->has_sights = has_station(scan);
  conic_rotation_of(reader->scan->rotation, reader->rotation);
  if (reader->columns[COLOR] >= 0)
    find_color_scale(reader);
  return CONIC_OK;
}

/* Without this check a few bytes could claim any number of points. */
static conic_status check_size(const e57_reader *reader) {
  unsigned bits = 0;
  for (size_t i = 0; i < reader->scan->n_columns; i++)
    bits += reader->scan->columns[i].bits;
  if (reader->scan->n_records > 0 && (bits == 0 || reader->scan->n_records / 8 > reader->file->mapping.n_bytes / bits))
    return conic_e57_wrong(reader->file, "a scan has more points than its file has bytes for",
                           reader->scan->records_offset);
  return CONIC_OK;
}

static void to_cartesian(double place[3]) {
  double range = place[0], azimuth = place[1], elevation = place[2], across = range * conic_cos(elevation);
  place[0] = across * conic_cos(azimuth);
  place[1] = across * conic_sin(azimuth);
  place[2] = range * conic_sin(elevation);
}

static void turn_by_pose(const e57_reader *reader, const double from[3], double to[3]) {
  for (int axis = 0; axis < 3; axis++)
    to[axis] =
        reader->rotation[axis][0] * from[0] + reader->rotation[axis][1] * from[1] + reader->rotation[axis][2] * from[2];
}

static int is_set(const e57_reader *reader, int slot, size_t i) {
  return reader->columns[slot] >= 0 && reader->block[slot][i] != 0.0;
}

static void store_color(const e57_reader *reader, size_t i, size_t at) {
  float *const *color = reader->builder.model->points.color;
  double scale = 65535.0 / (reader->color_high - reader->color_low);
  for (int channel = 0; channel < 3 && color[channel]; channel++) {
    double code = 65535.0;
    if (reader->columns[COLOR] >= 0 && !is_set(reader, COLOR_INVALID, i))
      code = floor((reader->block[COLOR + channel][i] - reader->color_low) * scale + 0.5);
    color[channel][at] = (float)(code > 0.0 ? code < 65535.0 ? code : 65535.0 : 0.0);
  }
}

static void store_point(e57_reader *reader, size_t i) {
  conic_splats *points = &reader->builder.model->points;
  double local[3], place[3], normal[3] = {0.0, 0.0, 0.0}, sight[3] = {0.0, 0.0, 0.0};
  for (int axis = 0; axis < 3; axis++) {
    local[axis] = reader->block[PLACE + axis][i];
    normal[axis] = reader->columns[NORMAL] >= 0 ? reader->block[NORMAL + axis][i] : 0.0;
  }
  if (reader->is_spherical)
    to_cartesian(local);
  turn_by_pose(reader, local, place);
  for (int axis = 0; axis < 3; axis++)
    place[axis] += reader->scan->translation[axis];
  conic_builder_store_position(&reader->builder, place);
  if (reader->has_sights)
    conic_sight_find(reader->scan->translation, place, sight);
  store_color(reader, i, points->count);
  if (reader->columns[NORMAL] >= 0) {
    double turned[3];
    turn_by_pose(reader, normal, turned);
    memcpy(normal, turned, sizeof normal);
  }
  for (int axis = 0; axis < 3; axis++) {
    if (points->normal[axis])
      points->normal[axis][points->count] = (float)normal[axis];
    if (points->sight[axis])
      points->sight[axis][points->count] = (float)sight[axis];
  }
  for (int slot = VALUES; slot < reader->n_slots; slot++) {
    int field = conic_builder_column_field(&reader->builder, (size_t)(slot - VALUES));
    int is_none = reader->columns[slot] < 0 ||
                  (strcmp(name_of_field(reader, field), "intensity") == 0 && is_set(reader, INTENSITY_INVALID, i));
    *conic_builder_column(&reader->builder, (size_t)(slot - VALUES)) = is_none ? NAN : reader->block[slot][i];
  }
  points->count++;
}

static int is_zero(const e57_reader *reader, size_t i) {
  int n_zero = 0;
  for (int axis = 0; axis < (reader->is_spherical ? 1 : 3); axis++)
    n_zero += reader->block[PLACE + axis][i] == 0.0;
  return n_zero == (reader->is_spherical ? 1 : 3);
}

static conic_status store_scan_block(e57_reader *reader, size_t n) {
  conic_builder *builder = &reader->builder;
  if (conic_builder_points(builder) + n > CONIC_MAX_POINTS)
    return conic_e57_wrong(reader->file, "too many points", reader->scan->records_offset);
  conic_status status = conic_builder_reserve_points(builder, builder->model->points.count + n);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const int is_phantom = reader->drops_zeros && is_zero(reader, i), is_invalid = is_set(reader, POINT_INVALID, i);
    reader->n_zeros += (uint64_t)(is_phantom && !is_invalid);
    builder->model->n_unmeasured += (uint64_t)(is_phantom || is_invalid);
    if (!is_phantom && !is_invalid)
      store_point(reader, i);
  }
  reader->n_done += n;
  if (status == CONIC_OK)
    status = conic_progress(builder->context, "read", (double)reader->n_done / (double)reader->n_all);
  return status == CONIC_OK ? conic_builder_deliver(builder, 0) : status;
}

static conic_status read_scan_records(e57_reader *reader, conic_e57_records *records) {
  conic_status status = CONIC_OK;
  size_t n = 1;
  for (int slot = 0; slot < reader->n_slots; slot++)
    if (reader->columns[slot] >= 0)
      records->streams[reader->columns[slot]].is_wanted = 1;
  while (status == CONIC_OK && n > 0) {
    status = conic_e57_records_fill(records, &n);
    for (int slot = 0; slot < reader->n_slots && status == CONIC_OK && n > 0; slot++) {
      int first = 0; /* a column may be in two slots, and is read once */
      while (reader->columns[first] != reader->columns[slot])
        first++;
      if (first < slot)
        memcpy(reader->block[slot], reader->block[first], sizeof reader->block[slot]);
      else if (reader->columns[slot] >= 0)
        conic_e57_records_take(records, reader->columns[slot], n, reader->block[slot]);
    }
    if (status == CONIC_OK && n > 0)
      status = store_scan_block(reader, n);
  }
  return status;
}

/* A single point of a cloud may lie at its origin; several were never measured. */
static conic_status look_for_zeros(e57_reader *reader) {
  conic_e57_records records;
  size_t n = 1, n_zeros = 0;
  reader->drops_zeros = reader->has_sights;
  if (reader->drops_zeros)
    return CONIC_OK;
  conic_status status = conic_e57_records_open(reader->file, reader->scan, &records);
  for (int axis = 0; axis < 3 && status == CONIC_OK; axis++)
    records.streams[reader->columns[PLACE + axis]].is_wanted = 1;
  while (status == CONIC_OK && n > 0 && n_zeros < 2) {
    status = conic_e57_records_fill(&records, &n);
    for (int axis = 0; axis < 3 && status == CONIC_OK && n > 0; axis++)
      conic_e57_records_take(&records, reader->columns[PLACE + axis], n, reader->block[PLACE + axis]);
    for (size_t i = 0; i < n && status == CONIC_OK; i++)
      n_zeros += (size_t)is_zero(reader, i);
  }
  conic_e57_records_close(&records);
  reader->drops_zeros = n_zeros > 1;
  return status;
}

static conic_status read_scan(e57_reader *reader) {
  conic_e57_records records;
  conic_status status = choose_columns(reader);
  if (status == CONIC_OK)
    status = check_size(reader);
  if (status == CONIC_OK)
    status = look_for_zeros(reader);
  if (status != CONIC_OK)
    return status;
  status = conic_e57_records_open(reader->file, reader->scan, &records);
  if (status == CONIC_OK)
    status = read_scan_records(reader, &records);
  conic_e57_records_close(&records);
  return status;
}

static const char *type_name(const conic_e57_column *column) {
  if (column->type == CONIC_E57_SINGLE)
    return "float";
  if (column->type != CONIC_E57_INTEGER)
    return "double";
  return column->low >= 0 ? column->high <= UINT8_MAX    ? "uint8"
                            : column->high <= UINT16_MAX ? "uint16"
                                                         : "uint32"
                          : "int32";
}

/* The fields of all scans, by name. */
static conic_status list_fields(e57_reader *reader, const conic_e57_scan *scan) {
  conic_model *model = reader->builder.model;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < scan->n_columns && status == CONIC_OK; i++) {
    const conic_e57_column *column = &scan->columns[i];
    size_t k = 0;
    while (k < model->n_fields && strcmp(model->fields[k].name, column->name) != 0)
      k++;
    if (k == model->n_fields)
      status = conic_fields_add(&reader->builder, column->name, strlen(column->name), type_name(column));
  }
  return status;
}

static conic_status begin_points(e57_reader *reader, const conic_e57_tree *tree, const conic_read_options *options) {
  const conic_e57_scan *scans = tree->scans;
  conic_status status = CONIC_OK;
  unsigned fields = 0;
  for (size_t i = 0; i < tree->n_scans && status == CONIC_OK; i++) {
    fields |= has_all(&scans[i], others) ? (unsigned)CONIC_SPLATS_COLORS : 0u;
    fields |= has_all(&scans[i], others + 3) ? (unsigned)CONIC_SPLATS_NORMALS : 0u;
    fields |= has_station(&scans[i]) ? (unsigned)CONIC_SPLATS_SIGHTS : 0u;
    reader->n_all += scans[i].n_records;
    status = list_fields(reader, &scans[i]);
  }
  for (unsigned field = CONIC_SPLATS_NORMALS; field <= CONIC_SPLATS_SIGHTS && status == CONIC_OK; field *= 2)
    if (fields & field)
      status = conic_builder_add_field(&reader->builder, (conic_splats_field)field);
  if (status == CONIC_OK)
    status = conic_fields_choose(&reader->builder, reader->file->name, options);
  reader->n_slots = VALUES + (int)conic_builder_columns(&reader->builder);
  return status;
}

static conic_status read_scans(e57_reader *reader, const conic_e57_tree *tree, const conic_read_options *options) {
  conic_status status = begin_points(reader, tree, options);
  for (size_t i = 0; i < tree->n_scans && status == CONIC_OK; i++) {
    reader->scan = &tree->scans[i];
    if (reader->scan->records_offset)
      status = read_scan(reader);
  }
  return status;
}

static conic_status read_opened(e57_reader *reader, const conic_read_options *options) {
  conic_e57_tree tree;
  conic_status status = conic_e57_tree_read(reader->file, &tree);
  if (status != CONIC_OK)
    return status;
  status = read_scans(reader, &tree, options);
  conic_e57_tree_release(reader->file->context, &tree);
  const conic_delivery *delivery = reader->builder.delivery;
  if (status == CONIC_OK && reader->n_zeros && !(delivery && delivery->is_again))
    conic_log(reader->file->context, CONIC_LOG_WARNING,
              "%s: %llu points at 0 0 0 of their scans were not measured, and are left out", reader->file->name,
              (unsigned long long)reader->n_zeros);
  if (status == CONIC_OK && !reader->builder.delivery)
    status = conic_raw_colors_decode(reader->file->context, &reader->builder.model->points, 0,
                                     &reader->builder.model->colors_are);
  return status == CONIC_OK ? conic_builder_deliver(&reader->builder, 1) : status;
}

conic_status conic_e57_read(conic_input *input, const conic_read_options *options, const conic_delivery *delivery,
                            conic_model *model) {
  conic_e57_file file;
  e57_reader *reader = conic_memory_allocate_zeroed(input->context, 1, sizeof *reader);
  memset(model, 0, sizeof *model);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  conic_status status = conic_builder_begin(input->context, model, 0, delivery, &reader->builder);
  if (status == CONIC_OK)
    status = conic_e57_file_open(input, &file);
  if (status == CONIC_OK) {
    reader->file = &file;
    status = read_opened(reader, options);
    conic_e57_file_close(&file);
  }
  conic_memory_release(input->context, reader);
  return status;
}
