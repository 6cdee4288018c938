/* Gaussians in glTF, by KHR_gaussian_splatting and as it was before its name was settled: the points of primitives,
 * placed where the nodes put them. Nodes may move, turn and scale all axes alike. Some are packed as an .spz. */

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
        conic_gaussians_put_harmonic(reader->gaussians, reader->n_placed + i, (size_t)(i_harmonic + k), value);
    }
  conic_gltf_close_array(&reader->gltf, &array);
  return status;
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

/* What a node does, p → turn·p·scale + shift; 0 where it stretches or mirrors. */
typedef struct gltf_place {
  double turn[3][3], scale, shift[3];
} gltf_place;

static int find_place(const double world[3][4], gltf_place *place) {
  double columns[3][3], across[3], longest = 0.0, shortest = 0.0;
  for (int k = 0; k < 3; k++) {
    for (int row = 0; row < 3; row++)
      columns[k][row] = world[row][k];
    place->shift[k] = world[k][3];
    double length = conic_length(columns[k]);
    longest = k == 0 || length > longest ? length : longest;
    shortest = k == 0 || length < shortest ? length : shortest;
  }
  place->scale = fabs(longest - 1.0) < 1e-6 ? 1.0 : longest; /* what is rounded stays as it is */
  for (int row = 0; row < 3; row++)
    for (int k = 0; k < 3; k++)
      place->turn[row][k] = world[row][k] / place->scale;
  conic_cross(columns[0], columns[1], across);
  double volume = conic_dot(across, columns[2]) / (longest * longest * longest);
  return shortest > 0.9999 * longest && volume > 0.999;
}

/* Moves the Gaussians from n_placed on. */
static void put_in_place(gaussian_gltf_reader *reader, const gltf_place *place, size_t count) {
  static const gltf_place no_place = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0, {0, 0, 0}};
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
  conic_gaussians_rotate(reader->file->context, &part, place->turn);
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < count; i++) {
      part.position[axis][i] = (float)((double)part.position[axis][i] * place->scale + place->shift[axis]);
      part.scale[axis][i] = (float)((double)part.scale[axis][i] * place->scale);
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
  if (reader->gaussians)
    return status;
  reader->sh_degree = degree > reader->sh_degree ? degree : reader->sh_degree;
  reader->is_linear |= strncmp(primitive->color_space, "lin_", 4) == 0;
  tell_unknown(reader, "colour space", primitive->color_space, " srgb_rec709_display lin_rec709_display BT.709 ",
               strncmp(primitive->color_space, "lin_", 4) == 0 ? "lin_rec709_display" : "srgb_rec709_display");
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
    return conic_gltf_wrong(&reader->gltf, "a node stretches or mirrors its Gaussians, which is not read");
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
