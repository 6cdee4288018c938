/* Gaussians in glTF, by KHR_gaussian_splatting and as it was before its name was settled: the points of primitives,
 * placed where the nodes put them. Nodes may move, turn and scale. Some are packed as an .spz. */

#include "core/base/eigen.h"
#include "core/base/vectors.h"
#include "core/gltf/gltf.h"
#include "gaussians/formats/gaussian_formats.h"
#include "gaussians/scene/activation.h"

typedef struct gaussian_gltf_reader {
  const conic_gaussian_bytes *file;
  conic_gltf gltf;
  conic_gaussians *gaussians; /* null: they are counted */
  size_t n_placed;
  int sh_degree, is_linear; /* of all */
  int has_both;             /* colour spaces: linear and not */
  int n_others;             /* primitives that are no Gaussians */
} gaussian_gltf_reader;

/* --- attributes --- */

static const char prefix[] = "KHR_gaussian_splatting:";

/* The accessor of an attribute of Gaussians: with the extension's prefix, or as it was first. */
static double find_attribute(const gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive,
                             const char *name) {
  char full[CONIC_JSON_KEY_ROOM];
  snprintf(full, sizeof full, "%s%s", prefix, name);
  double accessor = conic_gltf_find(&reader->gltf, primitive->attributes, full);
  snprintf(full, sizeof full, "_%s", name);
  return accessor == CONIC_GLTF_NONE ? conic_gltf_find(&reader->gltf, primitive->attributes, full) : accessor;
}

/* The accessor of coefficient i of the harmonics. */
static double find_harmonic(const gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive, int i) {
  char name[40];
  int degree = i >= 9 ? 3 : i >= 4 ? 2 : i >= 1;
  degree = i >= 16 ? 4 : degree;
  snprintf(name, sizeof name, "SH_DEGREE_%d_COEF_%d", degree, i - degree * degree);
  return find_attribute(reader, primitive, name);
}

/* Whether it is by the text that was settled in 2026, and not by a draft, in which less was said. */
static int is_settled(const gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive) {
  int has_prefix = 0;
  for (size_t i = 0; i < primitive->attributes.n; i++) {
    const conic_gltf_attribute *attribute =
        conic_gltf_item(&reader->gltf, CONIC_GLTF_ATTRIBUTES, primitive->attributes, i);
    has_prefix |= strncmp(attribute->name, prefix, sizeof prefix - 1) == 0;
  }
  return has_prefix && primitive->spz_view == CONIC_GLTF_NONE && strncmp(primitive->color_space, "BT.709", 6) != 0;
}

static int is_gaussian(const gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive) {
  return primitive->is_gaussian || primitive->spz_view != CONIC_GLTF_NONE ||
         find_attribute(reader, primitive, "ROTATION") != CONIC_GLTF_NONE;
}

/* The degree up to which all coefficients are there. */
static int find_primitive_degree(const gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive) {
  int degree = 0;
  for (int i = 1; i < CONIC_MOST_HARMONICS / 3; i++) {
    if (find_harmonic(reader, primitive, i) == CONIC_GLTF_NONE)
      break;
    if (i + 1 == (degree + 2) * (degree + 2))
      degree++;
  }
  return degree;
}

/* One attribute of a primitive into the next Gaussians; components go to columns, or to harmonics from `i_harmonic`. */
static conic_status take_attribute(gaussian_gltf_reader *reader, double accessor, int n, size_t count, float **columns,
                                   int first_component, double factor, double offset, int i_harmonic) {
  conic_gltf_array array;
  conic_status status = conic_gltf_open_array(&reader->gltf, accessor, &array);
  if (status == CONIC_OK && (array.count != count || array.n < first_component + n))
    status = conic_gltf_wrong(&reader->gltf, "attributes of the same Gaussians are of different numbers or types");
  for (int k = 0; status == CONIC_OK && k < n; k++)
    for (size_t i = 0; i < count; i++) {
      float value = (float)conic_gltf_value(&array, i, first_component + k);
      value = factor == 1.0 ? value : (float)((double)value * factor + offset);
      if (columns)
        columns[k][reader->n_placed + i] = value;
      else
        conic_gaussians_put_harmonic(reader->gaussians, reader->n_placed + i, (size_t)i_harmonic + (size_t)k, value);
    }
  conic_gltf_close_array(&reader->gltf, &array);
  return status;
}

/* Types of components, as bits. */
#define COMPONENT(name) (1u << (CONIC_GLTF_##name - CONIC_GLTF_INT8))
enum { OF_FLOATS = COMPONENT(FLOAT), OF_WHOLE = COMPONENT(UINT8) | COMPONENT(UINT16) };

/* Whether an attribute has a type that the text admits: of numbers as they are, or normalised. */
static conic_status check_type(const gaussian_gltf_reader *reader, double number, const char *name, const char *type,
                               unsigned plain, unsigned normalized) {
  const conic_gltf_accessor *accessor = conic_gltf_at(&reader->gltf, CONIC_GLTF_ACCESSORS, number);
  if (!accessor)
    return conic_gltf_wrong(&reader->gltf, "its Gaussians have no %s", name);
  const double code = accessor->component - CONIC_GLTF_INT8;
  if (strcmp(accessor->type, type) != 0 || !conic_gltf_is_index(code, 7) ||
      !((accessor->is_normalized ? normalized : plain) >> (unsigned)code & 1))
    return conic_gltf_wrong(&reader->gltf, "the %s of its Gaussians: the text admits no such type", name);
  return CONIC_OK;
}

static conic_status check_harmonics(const gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive) {
  const int degree = find_primitive_degree(reader, primitive);
  conic_status status = CONIC_OK;
  for (int i = 0; status == CONIC_OK && i < CONIC_MOST_HARMONICS / 3; i++) {
    const double accessor = find_harmonic(reader, primitive, i);
    if (i < (degree + 1) * (degree + 1))
      status = check_type(reader, accessor, "harmonics", "VEC3", OF_FLOATS, 0);
    else if (accessor != CONIC_GLTF_NONE)
      return conic_gltf_wrong(&reader->gltf, "of a degree of harmonics, or of a lower one, some are not there");
  }
  return status;
}

/* What the text says that there must be. */
static conic_status check_settled(const gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive) {
  if (primitive->mode != 0.0)
    return conic_gltf_wrong(&reader->gltf, "a primitive of Gaussians is not of points");
  if (!primitive->kernel[0] || !primitive->color_space[0])
    return conic_gltf_wrong(&reader->gltf, "KHR_gaussian_splatting has no kernel, or no colorSpace");
  conic_status status = check_type(reader, find_attribute(reader, primitive, "ROTATION"), "rotation", "VEC4", OF_FLOATS,
                                   COMPONENT(INT8) | COMPONENT(INT16));
  if (status == CONIC_OK)
    status =
        check_type(reader, find_attribute(reader, primitive, "SCALE"), "scale", "VEC3", OF_FLOATS | OF_WHOLE, OF_WHOLE);
  if (status == CONIC_OK)
    status = check_type(reader, find_attribute(reader, primitive, "OPACITY"), "opacity", "SCALAR", OF_FLOATS, OF_WHOLE);
  return status == CONIC_OK ? check_harmonics(reader, primitive) : status;
}

/* The ranges of the text. */
static conic_status check_values(const gaussian_gltf_reader *reader, size_t count) {
  const conic_gaussians *set = reader->gaussians;
  for (size_t i = reader->n_placed; i < reader->n_placed + count; i++) {
    if (set->scale[0][i] < 0.0f || set->scale[1][i] < 0.0f || set->scale[2][i] < 0.0f)
      return conic_gltf_wrong(&reader->gltf, "a scale of Gaussian %zu is negative", i);
    if (set->opacity[i] < 0.0f || set->opacity[i] > 1.0f)
      return conic_gltf_wrong(&reader->gltf, "the opacity of Gaussian %zu is not within 0 and 1", i);
  }
  return CONIC_OK;
}

/* Drafts of the extension had logarithms; a scale below 0 tells them. */
static void activate_old_scales(conic_gaussians *gaussians, size_t first, size_t count) {
  int is_log = 0;
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = first; i < first + count; i++)
      is_log |= gaussians->scale[axis][i] < 0.0f;
  for (int axis = 0; is_log && axis < 3; axis++)
    for (size_t i = first; i < first + count; i++)
      gaussians->scale[axis][i] = conic_scale_of_log(gaussians->scale[axis][i]);
}

/* Harmonics, or else the colour that degree 0 stands for; coefficients that are not there are 0. */
static conic_status take_harmonics(gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive, size_t count) {
  conic_gaussians *gaussians = reader->gaussians;
  conic_status status = CONIC_OK;
  const double color = conic_gltf_find(&reader->gltf, primitive->attributes, "COLOR_0");
  const int has_harmonics = find_harmonic(reader, primitive, 0) != CONIC_GLTF_NONE;
  int degree = has_harmonics ? find_primitive_degree(reader, primitive) : 0;
  int n = (gaussians->sh_degree + 1) * (gaussians->sh_degree + 1);
  if (!has_harmonics)
    status = take_attribute(reader, color, 3, count, NULL, 0, 1.0 / CONIC_SH_CONSTANT, -0.5 / CONIC_SH_CONSTANT, 0);
  for (int i = !has_harmonics; status == CONIC_OK && i < n; i++)
    if (i < (degree + 1) * (degree + 1))
      status = take_attribute(reader, find_harmonic(reader, primitive, i), 3, count, NULL, 0, 1.0, 0.0, 3 * i);
    else
      for (size_t k = 0; k < 3 * count; k++)
        conic_gaussians_put_harmonic(gaussians, reader->n_placed + k / 3, 3 * (size_t)i + k % 3, 0.0f);
  return status;
}

static conic_status take_plain(gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive, size_t count) {
  conic_gaussians *gaussians = reader->gaussians;
  float *rotation[4] = {gaussians->rotation[1], gaussians->rotation[2], gaussians->rotation[3], gaussians->rotation[0]};
  const double opacity = find_attribute(reader, primitive, "OPACITY");
  conic_status status = take_attribute(reader, conic_gltf_find(&reader->gltf, primitive->attributes, "POSITION"), 3,
                                       count, gaussians->position, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = take_attribute(reader, find_attribute(reader, primitive, "ROTATION"), 4, count, rotation, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status =
        take_attribute(reader, find_attribute(reader, primitive, "SCALE"), 3, count, gaussians->scale, 0, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = opacity != CONIC_GLTF_NONE
                 ? take_attribute(reader, opacity, 1, count, &gaussians->opacity, 0, 1.0, 0.0, 0)
                 : take_attribute(reader, conic_gltf_find(&reader->gltf, primitive->attributes, "COLOR_0"), 1, count,
                                  &gaussians->opacity, 3, 1.0, 0.0, 0);
  if (status == CONIC_OK)
    status = take_harmonics(reader, primitive, count);
  if (status == CONIC_OK && is_settled(reader, primitive))
    return check_values(reader, count);
  if (status == CONIC_OK)
    activate_old_scales(gaussians, reader->n_placed, count);
  return status;
}

/* --- packed as .spz, in the axes of the glTF --- */

static conic_status read_packed(gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive,
                                conic_gaussians *packed) {
  conic_gltf_bytes view;
  conic_status status = conic_gltf_open_view(&reader->gltf, primitive->spz_view, &view);
  const conic_gaussian_bytes file = {reader->file->context, reader->file->name,   NULL, view.bytes,
                                     view.n_bytes,          reader->file->options};
  return status == CONIC_OK ? conic_spz_read(&file, packed) : status;
}

/* --- the nodes --- */

/* What a node does, p → turn·(scale × p) + shift; 0 where it shears or mirrors. */
typedef struct gltf_place {
  double turn[3][3], scale[3], shift[3];
} gltf_place;

static int find_place(const double world[3][4], gltf_place *place) {
  double columns[3][3], across[3], longest = 0.0, shortest = 0.0;
  for (int k = 0; k < 3; k++) {
    for (int row = 0; row < 3; row++)
      columns[k][row] = world[row][k];
    place->shift[k] = world[k][3];
    place->scale[k] = conic_length(columns[k]);
    longest = k == 0 || place->scale[k] > longest ? place->scale[k] : longest;
    shortest = k == 0 || place->scale[k] < shortest ? place->scale[k] : shortest;
  }
  const int is_even = shortest > 0.9999 * longest;
  conic_cross(columns[0], columns[1], across);
  double volume = conic_dot(across, columns[2]) / (place->scale[0] * place->scale[1] * place->scale[2]);
  for (int k = 0; k < 3; k++) {
    if (is_even)
      place->scale[k] = fabs(longest - 1.0) < 1e-6 ? 1.0 : longest; /* what is rounded stays as it is */
    for (int row = 0; row < 3; row++)
      place->turn[row][k] = world[row][k] / place->scale[k];
  }
  return shortest > 0.0 && conic_is_finite(longest) && volume > 0.999;
}

/* Gaussian i stretched along x, y and z: the axes of its new ellipsoid are found anew. */
static void stretch(conic_gaussians *set, size_t i, const double by[3]) {
  double q[4], turn[3][3], axes[3][3], columns[3][3], squares[6] = {0}, values[3];
  if (set->rotation[0][i] == 0.0f && set->rotation[1][i] == 0.0f && set->rotation[2][i] == 0.0f &&
      set->rotation[3][i] == 0.0f)
    return; /* it stays without a rotation */
  conic_gaussians_unit_rotation(set, i, q);
  conic_rotation_of(q, turn);
  for (int k = 0; k < 3; k++) {
    for (int row = 0; row < 3; row++)
      axes[k][row] = by[row] * turn[row][k] * (double)set->scale[k][i];
    conic_add_outer(squares, axes[k], axes[k]);
    set->position[k][i] = (float)((double)set->position[k][i] * by[k]);
  }
  conic_eigen3(squares, values, axes);
  conic_cross(axes[0], axes[1], axes[2]);
  for (int k = 0; k < 3; k++) {
    for (int row = 0; row < 3; row++)
      columns[row][k] = axes[k][row];
    set->scale[k][i] = (float)sqrt(values[k] > 0.0 ? values[k] : 0.0);
  }
  conic_gaussians_find_quaternion((const double(*)[3])columns, q);
  for (int k = 0; k < 4; k++)
    set->rotation[k][i] = (float)q[k];
}

/* Moves the Gaussians from n_placed on. */
static void put_in_place(gaussian_gltf_reader *reader, const gltf_place *place, size_t count) {
  static const gltf_place no_place = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {1, 1, 1}, {0, 0, 0}};
  conic_gaussians part = *reader->gaussians;
  if (memcmp(place, &no_place, sizeof no_place) == 0)
    return;
  for (int k = 0; k < 4; k++) {
    part.rotation[k] += reader->n_placed;
    if (k == 3)
      break;
    part.position[k] += reader->n_placed;
    part.scale[k] += reader->n_placed;
  }
  size_t n_harmonics = conic_harmonics_of_degree(part.sh_degree) * reader->n_placed;
  part.count = count;
  part.sh = part.sh ? part.sh + n_harmonics : NULL;
  part.sh_half = part.sh_half ? part.sh_half + n_harmonics : NULL;
  const int is_even = place->scale[0] == place->scale[1] && place->scale[0] == place->scale[2];
  for (size_t i = 0; !is_even && i < count; i++)
    stretch(&part, i, place->scale);
  conic_gaussians_rotate(reader->file->context, &part, place->turn);
  const double scale = is_even ? place->scale[0] : 1.0;
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < count; i++) {
      part.position[axis][i] = (float)((double)part.position[axis][i] * scale + place->shift[axis]);
      part.scale[axis][i] = (float)((double)part.scale[axis][i] * scale);
    }
}

/* --- the scene --- */

static void tell_unknown(const gaussian_gltf_reader *reader, const char *what, const char *value, const char *known,
                         const char *taken) {
  char quoted[48];
  snprintf(quoted, sizeof quoted, " %s ", value);
  if (value[0] && !strstr(known, quoted))
    conic_gltf_warn(&reader->gltf, "the %s %s of its Gaussians is not known; they are taken as %s", what, value, taken);
}

/* What there is before it is taken: how many, of which degree, and what of it is not known. */
static conic_status count_primitive(gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive,
                                    conic_gaussians *packed, size_t *count) {
  const conic_gltf_accessor *positions = conic_gltf_at(
      &reader->gltf, CONIC_GLTF_ACCESSORS, conic_gltf_find(&reader->gltf, primitive->attributes, "POSITION"));
  int degree = find_primitive_degree(reader, primitive);
  conic_status status = CONIC_OK;
  if (primitive->spz_view != CONIC_GLTF_NONE) {
    status = read_packed(reader, primitive, packed);
    *count = packed->count;
    degree = packed->sh_degree;
  } else if (!positions || !conic_gltf_is_index(positions->count, CONIC_MOST_GAUSSIANS))
    return conic_gltf_wrong(&reader->gltf, "an accessor of Gaussians is not there, or is of too many");
  else
    *count = (size_t)positions->count;
  if (status == CONIC_OK && is_settled(reader, primitive))
    status = check_settled(reader, primitive);
  if (reader->gaussians)
    return status;
  reader->sh_degree = degree > reader->sh_degree ? degree : reader->sh_degree;
  const int is_linear = strncmp(primitive->color_space, "lin_", 4) == 0;
  reader->has_both |= reader->n_placed && is_linear != reader->is_linear;
  reader->is_linear |= is_linear;
  tell_unknown(reader, "colour space", primitive->color_space, " srgb_rec709_display lin_rec709_display BT.709 ",
               is_linear ? "lin_rec709_display" : "srgb_rec709_display");
  tell_unknown(reader, "kernel", primitive->kernel, " ellipse ", "ellipses");
  tell_unknown(reader, "projection", primitive->projection, " perspective ", "perspective");
  tell_unknown(reader, "sorting method", primitive->sorting, " cameraDistance ", "sorted as --profile says");
  return status;
}

static conic_status place_primitive(gaussian_gltf_reader *reader, const conic_gltf_primitive *primitive,
                                    const double world[3][4]) {
  const size_t most = reader->gaussians ? reader->gaussians->count : CONIC_MOST_GAUSSIANS;
  conic_gaussians packed = {.count = 0};
  gltf_place place;
  size_t count = 0;
  if (!find_place(world, &place))
    return conic_gltf_wrong(&reader->gltf, "a node shears or mirrors its Gaussians, which is not read");
  conic_status status = count_primitive(reader, primitive, &packed, &count);
  if (status == CONIC_OK && reader->n_placed + count > most)
    status = conic_gltf_wrong(&reader->gltf, "too many Gaussians");
  if (status == CONIC_OK && reader->gaussians) {
    if (primitive->spz_view == CONIC_GLTF_NONE)
      status = take_plain(reader, primitive, count);
    else
      conic_gaussians_put(&packed, reader->gaussians, reader->n_placed);
    reader->gaussians->is_antialiased |= packed.is_antialiased;
    if (status == CONIC_OK)
      put_in_place(reader, &place, count);
  }
  conic_gaussians_release(reader->file->context, &packed);
  reader->n_placed += count;
  return status;
}

static conic_status visit_mesh(void *cookie, const conic_gltf_node *node, const double world[3][4]) {
  gaussian_gltf_reader *reader = cookie;
  const conic_gltf_mesh *mesh = conic_gltf_at(&reader->gltf, CONIC_GLTF_MESHES, node->mesh);
  conic_status status = CONIC_OK;
  for (size_t i = 0; status == CONIC_OK && i < mesh->primitives.n; i++) {
    const conic_gltf_primitive *primitive = conic_gltf_item(&reader->gltf, CONIC_GLTF_PRIMITIVES, mesh->primitives, i);
    if (is_gaussian(reader, primitive))
      status = place_primitive(reader, primitive, world);
    else
      reader->n_others++;
  }
  return status;
}

static conic_status read_scene(gaussian_gltf_reader *reader, conic_gaussians *gaussians) {
  const conic_gaussian_bytes *file = reader->file;
  conic_gltf *gltf = &reader->gltf;
  conic_status status = conic_gltf_open(file->context, file->name, file->path, file->bytes, file->n_bytes, gltf);
  if (status == CONIC_OK)
    status = conic_gltf_check_extensions(gltf);
  if (status == CONIC_OK)
    status = conic_gltf_link_nodes(gltf);
  if (status == CONIC_OK)
    status = conic_gltf_visit_meshes(gltf, visit_mesh, reader);
  if (status == CONIC_OK && reader->n_placed == 0)
    status = conic_gltf_wrong(gltf, "there are no Gaussians in it");
  if (status == CONIC_OK && reader->n_others)
    conic_gltf_warn(gltf, "%d meshes beside its Gaussians are left out", reader->n_others);
  if (status == CONIC_OK && reader->has_both)
    conic_gltf_warn(gltf, "its Gaussians are of two colour spaces; all are taken as lin_rec709_display");
  if (status == CONIC_OK)
    status = conic_gaussians_begin(file->context, file->name, file->options, reader->n_placed, reader->sh_degree, 0,
                                   gaussians);
  if (status != CONIC_OK)
    return status;
  gaussians->is_linear |= reader->is_linear;
  reader->gaussians = gaussians;
  reader->n_placed = 0;
  memcpy(gaussians->frame, "luf", sizeof gaussians->frame);
  return conic_gltf_visit_meshes(gltf, visit_mesh, reader);
}

conic_status conic_gaussian_gltf_read(const conic_gaussian_bytes *file, conic_gaussians *gaussians) {
  gaussian_gltf_reader *reader = conic_memory_allocate_zeroed(file->context, 1, sizeof *reader);
  if (!reader)
    return CONIC_ERROR_MEMORY;
  reader->file = file;
  reader->gltf.context = file->context;
  conic_status status = read_scene(reader, gaussians);
  conic_gltf_close(&reader->gltf);
  conic_memory_release(file->context, reader);
  return status;
}
