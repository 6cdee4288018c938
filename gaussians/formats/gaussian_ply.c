/* Gaussians in PLY, as 3DGS, 2DGS and Mip-Splatting write them: a row a Gaussian, before activation. */

#include "conic/version.h"
#include "core/files/number.h"
#include "core/formats/ply_shares.h"
#include "gaussians/formats/gaussian_formats.h"
#include "gaussians/scene/activation.h"

enum { BLOCK = 128, MOST_TARGETS = 24 + CONIC_MOST_HARMONICS };

/* A property of the file, and where its values go. */
typedef struct ply_target {
  float **column;  /* or */
  int i_harmonic;  /* a number of each Gaussian's harmonics; -1: a column */
  int origin_axis; /* of a position that has an origin; -1: none */
  double white;    /* of a colour that is no coefficient yet: what stands for 1; else 0 */
} ply_target;

typedef struct gaussian_reader {
  conic_ply_source *source;
  const conic_ply_header *header;
  const conic_ply_property *properties;
  conic_gaussians *gaussians;
  ply_target targets[MOST_TARGETS];
  int columns[MOST_TARGETS]; /* the targets' properties */
  int n_targets;
  size_t n_done; /* rows */
  float *filter; /* column of Mip-Splatting's filter_3D; null: none */
  size_t room;
  double block[MOST_TARGETS][BLOCK];
} gaussian_reader;

static int find_single(const conic_ply_header *header, const conic_ply_element *vertices, const char *name) {
  int i = conic_ply_find_property(header, vertices, name);
  return i >= 0 && header->properties[vertices->first_property + (size_t)i].is_list ? -1 : i;
}

static int has_values(const conic_ply_header *header, const char *const *names, size_t n) {
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  for (size_t i = 0; i < n; i++)
    if (!vertices || find_single(header, vertices, names[i]) < 0)
      return 0;
  return 1;
}

static const char *const coefficient_names[] = {"f_dc_0", "f_dc_1", "f_dc_2"};
static const char *const color_names[] = {"red", "green", "blue"}; /* nerfstudio's --ply-color-mode rgb */

int conic_ply_has_gaussians(const conic_ply_header *header) {
  static const char *const names[] = {"x",       "y",     "z",     "opacity", "scale_0",
                                      "scale_1", "rot_0", "rot_1", "rot_2",   "rot_3"};
  return has_values(header, names, sizeof names / sizeof *names) &&
         (has_values(header, coefficient_names, 3) || has_values(header, color_names, 3));
}

static void add_target(gaussian_reader *reader, const char *name, float **column, int i_harmonic) {
  int i = find_single(reader->header, reader->source->element, name);
  if (i < 0)
    return;
  reader->columns[reader->n_targets] = i;
  reader->targets[reader->n_targets++] = (ply_target){column, i_harmonic, -1, 0.0};
}

/* The colour seen from everywhere: a coefficient, or a display value. */
static void add_color(gaussian_reader *reader, int channel) {
  double least, white;
  if (has_values(reader->header, coefficient_names, 3)) {
    add_target(reader, coefficient_names[channel], NULL, channel);
    return;
  }
  add_target(reader, color_names[channel], NULL, channel);
  conic_ply_type_range(reader->properties[reader->columns[reader->n_targets - 1]].type, &least, &white);
  reader->targets[reader->n_targets - 1].white = white > 0.0 ? white : 1.0;
}

/* The degree that the columns f_rest_0 … are of; -1 after a message. */
static int find_degree(const conic_input *input, const conic_ply_header *header, const conic_ply_element *vertices) {
  char name[32];
  size_t n = 0;
  for (;; n++) {
    snprintf(name, sizeof name, "f_rest_%zu", n);
    if (find_single(header, vertices, name) < 0)
      break;
  }
  int degree = n % 3 ? -1 : conic_degree_of_coefficients(1 + n / 3);
  if (degree < 0)
    conic_fail(input->context, CONIC_ERROR_INPUT,
               "%s: %zu columns f_rest_… are of no degree of harmonics (9, 24, 45 or 72 are) (line %llu)", input->name,
               n, (unsigned long long)vertices->line);
  return degree;
}

/* f_rest_… has a channel after the other. */
static void find_harmonics(gaussian_reader *reader, int file_degree) {
  size_t n_kept = conic_harmonics_of_degree(reader->gaussians->sh_degree) / 3;
  size_t n_rest = conic_harmonics_of_degree(file_degree) / 3 - 1;
  char name[32];
  for (size_t channel = 0; channel < 3; channel++) {
    add_color(reader, (int)channel);
    for (size_t k = 1; k < n_kept; k++) {
      snprintf(name, sizeof name, "f_rest_%zu", channel * n_rest + k - 1);
      add_target(reader, name, NULL, (int)(3 * k + channel));
    }
  }
}

static int has_wide_positions(const gaussian_reader *reader) {
  int is_wide = 0;
  for (int axis = 0; axis < 3; axis++) {
    conic_ply_type type = reader->properties[reader->columns[axis]].type;
    is_wide |= type == CONIC_PLY_DOUBLE || type == CONIC_PLY_INT32 || type == CONIC_PLY_UINT32;
  }
  return is_wide;
}

/* What a Gaussian is made of, and the normals that no file needs. */
static int count_others(const gaussian_reader *reader, int file_degree) {
  int n = (int)reader->source->element->n_properties - reader->n_targets;
  n -= (int)(conic_harmonics_of_degree(file_degree) - conic_harmonics_of_degree(reader->gaussians->sh_degree));
  for (const char *name = "nx\0ny\0nz\0"; *name; name += 3)
    n -= conic_ply_find_property(reader->header, reader->source->element, name) >= 0;
  return n > 0 ? n : 0;
}

static void find_targets(gaussian_reader *reader, int file_degree) {
  static const char *const names[] = {"x",       "y",     "z",     "scale_0", "scale_1",
                                      "scale_2", "rot_0", "rot_1", "rot_2",   "rot_3"};
  conic_gaussians *gaussians = reader->gaussians;
  for (int i = 0; i < 10; i++)
    if (i != 5 || gaussians->scale[2])
      add_target(reader, names[i],
                 i < 3   ? &gaussians->position[i]
                 : i < 6 ? &gaussians->scale[i - 3]
                         : &gaussians->rotation[i - 6],
                 -1);
  add_target(reader, "opacity", &gaussians->opacity, -1);
  add_target(reader, "filter_3D", &reader->filter, -1);
  find_harmonics(reader, file_degree);
  gaussians->n_left_out = count_others(reader, file_degree);
  if (has_wide_positions(reader))
    for (int axis = 0; axis < 3; axis++)
      reader->targets[axis].origin_axis = axis;
}

/* The first finite place of a file becomes the origin of all. */
static void settle_origin(gaussian_reader *reader, size_t n) {
  double *origin = reader->gaussians->origin;
  for (size_t i = 0; i < n && reader->targets[0].origin_axis == 0; i++)
    if (conic_is_finite(reader->block[0][i]) && conic_is_finite(reader->block[1][i]) &&
        conic_is_finite(reader->block[2][i])) {
      for (int axis = 0; axis < 3; axis++) {
        origin[axis] = reader->block[axis][i];
        reader->targets[axis].origin_axis = axis + 3; /* it is known */
      }
    }
}

static void store_block(gaussian_reader *reader, size_t first, size_t n) {
  conic_gaussians *gaussians = reader->gaussians;
  size_t n_harmonics = conic_harmonics_of_degree(gaussians->sh_degree);
  settle_origin(reader, n);
  for (int t = 0; t < reader->n_targets; t++) {
    const ply_target *target = &reader->targets[t];
    double *values = reader->block[t];
    double origin = target->origin_axis >= 0 ? gaussians->origin[target->origin_axis % 3] : 0.0;
    for (size_t i = 0; target->white > 0.0 && i < n; i++)
      values[i] = (values[i] / target->white - 0.5) / CONIC_SH_CONSTANT;
    if (target->column)
      for (size_t i = 0; i < n; i++)
        (*target->column)[first + i] = (float)(origin != 0.0 ? values[i] - origin : values[i]);
    else if (gaussians->sh)
      for (size_t i = 0; i < n; i++)
        gaussians->sh[(first + i) * n_harmonics + (size_t)target->i_harmonic] = (float)values[i];
    else
      for (size_t i = 0; i < n; i++)
        conic_gaussians_put_harmonic(gaussians, first + i, (size_t)target->i_harmonic, (float)values[i]);
  }
  conic_gaussians_activate(gaussians, first, n);
}

/* Whether threads may read the rows: those of a whole file, of floats that are stored as they are. */
static int can_share_rows(const gaussian_reader *reader) {
  const conic_ply_source *source = reader->source;
  int can = source->input->has_size && source->format == CONIC_PLY_LITTLE_ENDIAN && reader->gaussians->sh &&
            conic_ply_is_plain(source->format, source->element);
  for (int t = 0; t < reader->n_targets; t++)
    can = can && reader->properties[reader->columns[t]].type == CONIC_PLY_FLOAT && reader->targets[t].white == 0.0;
  return can;
}

/* The same of such rows, straight from them: a column at a time, and the harmonics row by row. */
static void copy_rows(gaussian_reader *reader, const unsigned char *bytes, size_t first, size_t n) {
  const size_t row_bytes = reader->source->element->least_row_bytes,
               n_harmonics = conic_harmonics_of_degree(reader->gaussians->sh_degree);
  size_t from[MOST_TARGETS], to[MOST_TARGETS], n_copied = 0;
  for (int t = 0; t < reader->n_targets; t++) {
    const size_t offset = reader->properties[reader->columns[t]].row_offset;
    float *column = reader->targets[t].column ? *reader->targets[t].column + first : NULL;
    for (size_t i = 0; column && i < n; i++)
      column[i] = conic_load_float(bytes + i * row_bytes + offset);
    from[n_copied] = offset;
    to[n_copied] = (size_t)reader->targets[t].i_harmonic;
    n_copied += !column;
  }
  for (size_t i = 0; i < n; i++) {
    float *sh = reader->gaussians->sh + (first + i) * n_harmonics;
    for (size_t k = 0; k < n_copied; k++)
      sh[to[k]] = conic_load_float(bytes + i * row_bytes + from[k]);
  }
}

static void take_rows(void *data, const unsigned char *bytes, size_t n, size_t first, void *room) {
  gaussian_reader *reader = data;
  (void)room;
  copy_rows(reader, bytes, reader->n_done + first, n);
  conic_gaussians_activate(reader->gaussians, reader->n_done + first, n);
}

/* Of a pipe that says that much comes, arrays grow with what has really come. */
static conic_status make_gaussian_room(gaussian_reader *reader, size_t used) {
  conic_context *context = reader->source->input->context;
  const size_t count = reader->gaussians->count;
  if (used + BLOCK <= reader->room || reader->room == count)
    return CONIC_OK;
  reader->room = 2 * reader->room < count ? 2 * reader->room : count;
  conic_status status = conic_gaussians_grow(context, reader->gaussians, used, reader->room);
  if (status == CONIC_OK && reader->filter)
    status = conic_memory_grow(context, &reader->filter, used, reader->room, sizeof(float));
  return status;
}

static conic_status read_gaussian_rows(gaussian_reader *reader) {
  const size_t count = (size_t)reader->source->element->count;
  const conic_ply_taker taker = {take_rows, reader, 0};
  conic_status status = can_share_rows(reader) ? conic_ply_share_rows(reader->source, count, &taker) : CONIC_OK;
  for (size_t n; status == CONIC_OK && (reader->n_done = (size_t)reader->source->i_row) < count;) {
    n = count - reader->n_done;
    status = make_gaussian_room(reader, reader->n_done);
    if (status == CONIC_OK)
      status = conic_ply_read_rows(reader->source, reader->properties, reader->columns, reader->n_targets, BLOCK, &n,
                                   (double *)reader->block);
    if (status == CONIC_OK)
      store_block(reader, reader->n_done, n);
  }
  return status;
}

/* Mip-Splatting's smallest size: s ← √(s² + f²), o ← o √(Π s² / Π (s² + f²)). What was kept of the file is made anew,
 * so that it stands for what there is now. */
static void fold_filter(conic_gaussians *gaussians, const float *filter) {
  for (size_t i = 0; i < gaussians->count; i++) {
    double f2 = (double)filter[i] * (double)filter[i], share = 1.0;
    for (int axis = 0; axis < 3; axis++) {
      float *scale = gaussians->scale[axis] ? &gaussians->scale[axis][i] : NULL;
      double s2 = scale ? (double)*scale * (double)*scale : 0.0;
      if (!scale || f2 == 0.0)
        continue;
      share *= s2 / (s2 + f2);
      *scale = (float)sqrt(s2 + f2);
      if (gaussians->log_scale[axis])
        *scale = conic_scale_of_log(gaussians->log_scale[axis][i] = conic_log_of_scale(*scale));
    }
    if (f2 == 0.0)
      continue;
    float *opacity = &gaussians->opacity[i];
    *opacity = (float)((double)*opacity * sqrt(share));
    if (gaussians->logit_opacity)
      *opacity = conic_opacity_of_logit(gaussians->logit_opacity[i] = conic_logit_of_opacity(*opacity));
  }
}

static conic_status begin_gaussians(gaussian_reader *reader, const conic_gaussians_read_options *options,
                                    int file_degree) {
  const conic_ply_element *vertices = reader->source->element;
  conic_input *input = reader->source->input;
  int is_2d = find_single(reader->header, vertices, "scale_2") < 0 || reader->header->splat_mode == CONIC_PLY_MODE_2D;
  reader->room = input->has_size ? (size_t)vertices->count : 65536;
  reader->room = reader->room < vertices->count ? reader->room : (size_t)vertices->count;
  conic_status status =
      conic_gaussians_begin(input->context, input->name, options, reader->room, file_degree,
                            CONIC_GAUSSIANS_SOURCE | (is_2d ? CONIC_GAUSSIANS_2D : 0), reader->gaussians);
  if (status == CONIC_OK && find_single(reader->header, vertices, "filter_3D") >= 0) {
    reader->filter = conic_memory_allocate(input->context, reader->room, sizeof *reader->filter);
    status = reader->filter ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  reader->gaussians->count = (size_t)vertices->count;
  conic_gaussians_take_comments(reader->header, reader->gaussians);
  return status;
}

static conic_status read_gaussian_elements(gaussian_reader *reader, const conic_gaussians_read_options *options,
                                           const conic_ply_element *vertices) {
  conic_ply_source *source = reader->source;
  conic_context *context = source->input->context;
  conic_status status = CONIC_OK;
  for (const conic_ply_element *element = reader->header->elements; status == CONIC_OK && element < vertices;
       element++) {
    status = conic_ply_begin_whole(source, element);
    if (status == CONIC_OK)
      status = conic_ply_skip_element(source, reader->header);
  }
  if (status == CONIC_OK)
    status = conic_ply_begin_whole(source, vertices);
  int degree = status == CONIC_OK ? find_degree(source->input, reader->header, vertices) : 0;
  if (degree < 0)
    return CONIC_ERROR_INPUT;
  if (status == CONIC_OK)
    status = begin_gaussians(reader, options, degree);
  if (status == CONIC_OK) {
    find_targets(reader, degree);
    status = read_gaussian_rows(reader);
  }
  if (status == CONIC_OK && reader->filter)
    fold_filter(reader->gaussians, reader->filter);
  conic_memory_release(context, reader->filter);
  return status;
}

conic_status conic_gaussian_ply_read(conic_input *input, const conic_ply_header *header,
                                     const conic_gaussians_read_options *options, conic_gaussians *gaussians) {
  const conic_ply_element *vertices = conic_ply_find_element(header, "vertex");
  conic_ply_source source = {.input = input, .format = header->format, .element = vertices};
  gaussian_reader *reader = conic_memory_allocate_zeroed(input->context, 1, sizeof *reader);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->source = &source;
  reader->header = header;
  reader->properties = header->properties + vertices->first_property;
  reader->gaussians = gaussians;
  conic_status status = read_gaussian_elements(reader, options, vertices);
  if (source.is_cut)
    status = conic_ply_tell_cut(&source, 0);
  conic_memory_release(input->context, reader);
  return status;
}

/* --- what .ply and .compressed.ply say besides --- */

void conic_gaussians_take_comments(const conic_ply_header *header, conic_gaussians *gaussians) {
  gaussians->is_antialiased = header->splat_mode == CONIC_PLY_MODE_MIP;
  memcpy(gaussians->up, header->up, sizeof gaussians->up);
}

void conic_gaussian_writer_put_comments(const conic_gaussian_writer *writer, int says_flat) {
  const conic_gaussians *gaussians = writer->gaussians;
  char up[3][CONIC_NUMBER_ROOM];
  if (gaussians->is_antialiased || says_flat)
    fprintf(writer->to, "comment SplatRenderMode: %s\n", says_flat ? "2dgs" : "mip");
  for (int axis = 0; axis < 3; axis++)
    conic_number_print_float(up[axis], gaussians->up[axis]);
  if (gaussians->up[0] != 0.0f || gaussians->up[1] != 0.0f || gaussians->up[2] != 0.0f)
    fprintf(writer->to, "comment Vertical axis: %s %s %s\n", up[0], up[1], up[2]);
}

/* --- writing --- */

static void print_gaussian_header(const conic_gaussian_writer *writer, int is_wide, size_t n_rest) {
  const conic_gaussians *gaussians = writer->gaussians;
  const char *wide = is_wide ? "double" : "float";
  fprintf(writer->to, "ply\nformat binary_little_endian 1.0\ncomment conic %s\n", conic_version());
  conic_gaussian_writer_put_comments(writer, 0);
  fprintf(writer->to, "element vertex %zu\nproperty %s x\nproperty %s y\nproperty %s z\n", gaussians->count, wide, wide,
          wide);
  if (!writer->lacks_normals)
    fprintf(writer->to, "property float nx\nproperty float ny\nproperty float nz\n");
  for (int i = 0; i < 3; i++)
    fprintf(writer->to, "property float f_dc_%d\n", i);
  for (size_t i = 0; i < 3 * n_rest; i++)
    fprintf(writer->to, "property float f_rest_%zu\n", i);
  fprintf(writer->to, "property float opacity\n");
  for (int i = 0; i < (gaussians->scale[2] ? 3 : 2); i++)
    fprintf(writer->to, "property float scale_%d\n", i);
  for (int i = 0; i < 4; i++)
    fprintf(writer->to, "property float rot_%d\n", i);
  fprintf(writer->to, "end_header\n");
}

static unsigned char *put_value(unsigned char *to, float value) {
  conic_store_float(to, value);
  return to + sizeof value;
}

static unsigned char *put_gaussian(const conic_gaussian_writer *writer, size_t i, int is_wide, size_t n_rest,
                                   unsigned char *to) {
  const conic_gaussians *gaussians = writer->gaussians;
  float room[CONIC_MOST_HARMONICS];
  const float *sh = conic_gaussians_harmonics(gaussians, i, room);
  for (int axis = 0; axis < 3; axis++) {
    double mean = conic_gaussians_mean(gaussians, axis, i);
    if (!is_wide) {
      to = put_value(to, (float)mean);
      continue;
    }
    conic_store_double(to, mean);
    to += 8;
  }
  for (int k = 0; k < 3 && !writer->lacks_normals; k++)
    to = put_value(to, 0.0f);
  for (int channel = 0; channel < 3; channel++)
    to = put_value(to, sh[channel]);
  for (size_t channel = 0; channel < 3; channel++)
    for (size_t k = 1; k <= n_rest; k++)
      to = put_value(to, sh[3 * k + channel]);
  to = put_value(to, conic_gaussians_logit(gaussians, i));
  for (int axis = 0; axis < 3; axis++)
    if (gaussians->scale[axis])
      to = put_value(to, conic_gaussians_log_scale(gaussians, axis, i));
  for (int k = 0; k < 4; k++)
    to = put_value(to, gaussians->rotation[k][i]);
  return to;
}

conic_status conic_gaussian_ply_write(const conic_gaussian_writer *writer) {
  const conic_gaussians *gaussians = writer->gaussians;
  unsigned char rows[64 * (6 * 4 + (14 + CONIC_MOST_HARMONICS) * 4)], *end = rows;
  size_t n_rest = conic_harmonics_of_degree(writer->sh_degree) / 3 - 1;
  int is_wide = gaussians->origin[0] != 0.0 || gaussians->origin[1] != 0.0 || gaussians->origin[2] != 0.0;
  conic_status status = CONIC_OK;
  print_gaussian_header(writer, is_wide, n_rest);
  for (size_t i = 0; status == CONIC_OK && i < gaussians->count; i++) {
    end = put_gaussian(writer, i, is_wide, n_rest, end);
    if (i % 64 != 63 && i + 1 < gaussians->count)
      continue;
    status = conic_gaussian_writer_put(writer, rows, (size_t)(end - rows));
    end = rows;
    if (status == CONIC_OK)
      status = conic_gaussian_writer_tell(writer, i);
  }
  return status;
}
