#include "core/base/color.h"
#include "core/base/vectors.h"
#include "core/coloring/color_ramp.h"
#include "core/coloring/coloring_stream.h"
#include "core/splats/columns.h"
#include "core/splats/point_fields.h"

static const char *const ramp_names[CONIC_N_RAMPS] = {"sequential", "grey",  "heat",  "diverging", "terrain",
                                                      "viridis",    "magma", "turbo", "classes"};

/* What `by` says, if it is not "rgb". */
typedef enum coloring_kind { BY_VALUE, BY_HEIGHT, BY_NORMAL } coloring_kind;

/* The vertices of either set; the arrays belong to the set. */
typedef struct vertices {
  size_t count;
  const double *origin;
  double scalar_origin;
  float *const *position;
  float **color, **scalar;
  const conic_splats *splats; /* null for triangles */
  float *normal[3];           /* of triangles, if colours show normals */
} vertices;

typedef struct painting {
  conic_context *context;
  coloring_kind kind;
  double up[3];
  vertices sets[2];
  conic_coloring *coloring;
} painting;

CONIC_DEFINE_OPTIONS(conic_coloring_options, .by = "rgb")

const char *conic_ramp_name(int i) {
  return i >= 0 && i < CONIC_N_RAMPS ? ramp_names[i] : NULL;
}

static int find_ramp(const char *name) {
  int i = 0;
  while (i < CONIC_N_RAMPS && strcmp(ramp_names[i], name) != 0)
    i++;
  return i;
}

static int is_that_word(const char *by, const char *word) {
  return strcmp(by, word) == 0;
}

void conic_coloring_read(const conic_coloring_options *options, conic_read_options *reading) {
  conic_coloring_options own;
  conic_coloring_options_init(&own);
  if (!options || !conic_options_take(&own, options) || !own.by)
    return;
  int is_auto = is_that_word(own.by, "auto");
  if (is_that_word(own.by, "rgb") || is_that_word(own.by, "height") || is_that_word(own.by, "normal"))
    return;
  reading->field = is_auto ? "intensity" : own.by;
  reading->field_is_optional = is_auto;
}

/* --- values to colours --- */

static void paint_unknown(float linear[3]) {
  linear[0] = linear[1] = linear[2] = 0.2f;
}

/* `ramp`: the coloring's, or CONIC_N_RAMPS. */
static void paint_value(const conic_coloring *coloring, int ramp, double value, float linear[3]) {
  double extent = coloring->maximum - coloring->minimum;
  if (!(value - value == 0.0) || ramp == CONIC_N_RAMPS) {
    paint_unknown(linear);
    return;
  }
  if (ramp == CONIC_RAMP_CLASSES) {
    conic_class_color(value > 0.0 ? value < 4294967295.0 ? (uint32_t)value : UINT32_MAX : 0, linear);
    return;
  }
  double t = extent != 0.0 ? (value - coloring->minimum) / extent : 0.5;
  conic_ramp_color((conic_ramp)ramp, coloring->is_root && t > 0.0 ? sqrt(t) : t, linear);
}

void conic_coloring_color(const conic_coloring *coloring, double value, float linear[3]) {
  paint_value(coloring, coloring->ramp ? find_ramp(coloring->ramp) : CONIC_N_RAMPS, value, linear);
}

static double value_at_vertex(const painting *p, const vertices *set, size_t i) {
  double height = 0.0;
  if (p->kind == BY_VALUE)
    return *set->scalar ? set->scalar_origin + (double)(*set->scalar)[i] : NAN;
  for (int axis = 0; axis < 3; axis++)
    height += p->up[axis] * (set->origin[axis] + (double)set->position[axis][i]);
  return height;
}

static void normal_at_vertex(const vertices *set, size_t i, double normal[3]) {
  const conic_splats *s = set->splats;
  double u[3], v[3];
  int has_axes = s && s->tangent_u[0];
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = has_axes ? (double)s->tangent_u[axis][i] : 0.0;
    v[axis] = has_axes ? (double)s->tangent_v[axis][i] : 0.0;
    normal[axis] = s ? (double)(has_axes ? 0.0f : s->normal[axis][i]) : (double)set->normal[axis][i];
  }
  if (has_axes)
    conic_cross(u, v, normal);
}

/* Which side of a scanned surface is the front is a guess, the same for all of it. If more than half of the normals
 * point steeply down, the guess was wrong. */
static double front_of(const painting *p, const vertices *set) {
  size_t n_down = 0;
  double normal[3];
  for (size_t i = 0; i < set->count && set->splats; i++) {
    normal_at_vertex(set, i, normal);
    n_down += conic_normalize(normal) && conic_dot(normal, p->up) < -0.5;
  }
  return n_down > set->count / 2 ? -1.0 : 1.0;
}

/* Maps −1 … 1 to what a picture shows from black to white. */
static void paint_normal(double normal[3], double front, float linear[3]) {
  if (!conic_normalize(normal)) {
    paint_unknown(linear);
    return;
  }
  for (int axis = 0; axis < 3; axis++)
    linear[axis] = (float)conic_srgb_decode(0.5 + 0.5 * front * normal[axis]);
}

static void paint_vertices(const painting *p, const vertices *set) {
  double front = p->kind == BY_NORMAL ? front_of(p, set) : 1.0;
  int ramp = p->coloring->ramp ? find_ramp(p->coloring->ramp) : CONIC_N_RAMPS;
  for (size_t i = 0; i < set->count; i++) {
    float linear[3];
    double normal[3];
    if (p->kind == BY_NORMAL) {
      normal_at_vertex(set, i, normal);
      paint_normal(normal, front, linear);
    } else
      paint_value(p->coloring, ramp, value_at_vertex(p, set, i), linear);
    for (int channel = 0; channel < 3; channel++)
      set->color[channel][i] = linear[channel];
  }
}

/* --- what there is --- */

/* All three components or none. */
static conic_status need_colors(conic_context *context, const vertices *set) {
  float *color[3] = {NULL, NULL, NULL};
  if (set->color[0] || set->count == 0)
    return CONIC_OK;
  for (int channel = 0; channel < 3; channel++) {
    color[channel] = conic_memory_allocate(context, set->count, sizeof(float));
    if (!color[channel]) {
      conic_memory_release_these(context, color[0], color[1]);
      return CONIC_ERROR_MEMORY;
    }
  }
  memcpy(set->color, color, sizeof color);
  return CONIC_OK;
}

/* Takes the vertices' normals, not the corners'. */
static conic_status need_normals(painting *p, const conic_triangles *triangles) {
  conic_triangles smooth = *triangles;
  if (p->kind != BY_NORMAL || triangles->count == 0)
    return CONIC_OK;
  memset(smooth.normal, 0, sizeof smooth.normal);
  smooth.normal_corners = NULL;
  conic_status status = conic_triangles_smooth(p->context, &smooth);
  if (status == CONIC_OK)
    memcpy(p->sets[1].normal, smooth.normal, sizeof smooth.normal);
  return status;
}

static void whiten_materials(conic_triangles *triangles) {
  for (size_t i = 0; triangles->materials && i < triangles->n_materials; i++) {
    conic_material *material = &triangles->materials[i];
    conic_texture_destroy(material->texture);
    material->texture = NULL;
    material->color[0] = material->color[1] = material->color[2] = 1.0f;
  }
}

static conic_status find_limits(const painting *p, double *minimum, double *maximum) {
  conic_value_sample *sample = conic_memory_allocate_zeroed(p->context, 1, sizeof *sample);
  if (!sample)
    return CONIC_ERROR_MEMORY;
  for (int k = 0; k < 2; k++)
    for (size_t i = 0; i < p->sets[k].count; i++)
      conic_value_sample_add(sample, value_at_vertex(p, &p->sets[k], i));
  conic_value_sample_limits(sample, minimum, maximum);
  conic_memory_release(p->context, sample);
  return CONIC_OK;
}

/* Every class counts, however few points it has. */
static void list_classes(const painting *p) {
  conic_coloring *c = p->coloring;
  int is_first = 1;
  for (int k = 0; k < 2; k++)
    for (size_t i = 0; i < p->sets[k].count; i++) {
      double value = value_at_vertex(p, &p->sets[k], i);
      if (!(value - value == 0.0))
        continue;
      if (value >= 0.0 && value < 256.0)
        c->classes[(unsigned)value / 32] |= 1u << (unsigned)value % 32;
      c->minimum = is_first || value < c->minimum ? value : c->minimum;
      c->maximum = is_first || value > c->maximum ? value : c->maximum;
      is_first = 0;
    }
}

/* --- choosing --- */

static void name_coloring(painting *p, coloring_kind kind, const char *field, const char *ramp) {
  conic_coloring *c = p->coloring;
  int is_intensity = conic_field_is(field, "intensity");
  p->kind = kind;
  snprintf(c->field, sizeof c->field, "%s", field);
  c->ramp = kind == BY_NORMAL                         ? NULL
            : ramp                                    ? ramp
            : kind == BY_HEIGHT                       ? ramp_names[CONIC_RAMP_TERRAIN]
            : is_intensity                            ? ramp_names[CONIC_RAMP_GREY]
            : conic_field_is(field, "classification") ? ramp_names[CONIC_RAMP_CLASSES]
                                                      : ramp_names[CONIC_RAMP_SEQUENTIAL];
  c->is_root = kind == BY_VALUE && is_intensity;
}

/* Sets the values of the ramp's ends. */
static conic_status scale_coloring(painting *p, const conic_coloring_options *options) {
  conic_coloring *c = p->coloring;
  if (p->kind == BY_NORMAL)
    return CONIC_OK;
  if (is_that_word(c->ramp, ramp_names[CONIC_RAMP_CLASSES])) {
    list_classes(p);
    return CONIC_OK;
  }
  c->minimum = options->minimum;
  c->maximum = options->maximum;
  return options->has_range ? CONIC_OK : find_limits(p, &c->minimum, &c->maximum);
}

/* Takes the intensity, else the height, else nothing: the first that differs between points. */
static conic_status choose_by_itself(painting *p, const conic_coloring_options *options) {
  conic_coloring *c = p->coloring;
  conic_status status = CONIC_OK;
  if (!*p->sets[0].scalar && !*p->sets[1].scalar)
    return CONIC_OK;
  for (coloring_kind kind = BY_VALUE; status == CONIC_OK && kind <= BY_HEIGHT; kind++) {
    name_coloring(p, kind, kind == BY_VALUE ? "intensity" : "height", options->ramp);
    status = scale_coloring(p, options);
    if (c->maximum != c->minimum)
      return status;
  }
  c->field[0] = 0;
  return status;
}

static conic_status choose_coloring(painting *p, const conic_coloring_options *options, int has_colors) {
  const char *by = options->by;
  if (is_that_word(by, "rgb") || (is_that_word(by, "auto") && has_colors))
    return CONIC_OK;
  if (is_that_word(by, "auto"))
    return choose_by_itself(p, options);
  coloring_kind kind = is_that_word(by, "height") ? BY_HEIGHT : is_that_word(by, "normal") ? BY_NORMAL : BY_VALUE;
  if (kind == BY_VALUE && !*p->sets[0].scalar && !*p->sets[1].scalar)
    return conic_fail(p->context, CONIC_ERROR_INPUT, "colouring: the points have no '%s'", by);
  name_coloring(p, kind, by, options->ramp);
  return scale_coloring(p, options);
}

static conic_status check_options(conic_context *context, const conic_coloring_options *given,
                                  conic_coloring_options *options) {
  conic_coloring_options_init(options);
  if (!conic_options_take(options, given) || !options->by || !*options->by)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "colouring: the options were not initialised");
  if (options->ramp && find_ramp(options->ramp) == CONIC_N_RAMPS)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "colouring: there is no ramp '%s'", options->ramp);
  if (options->has_range && !(options->maximum - options->minimum < HUGE_VAL && options->minimum < options->maximum))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "colouring: the range's first end is not below its second");
  return CONIC_OK;
}

static void drop_scalars(conic_context *context, float **scalar) {
  conic_memory_release(context, *scalar);
  *scalar = NULL;
}

conic_status conic_coloring_of_range(conic_context *context, const conic_coloring_options *options, const char *field,
                                     const double typical[2], double least, double greatest, conic_coloring *coloring) {
  conic_coloring_options own;
  painting p = {.coloring = coloring};
  memset(coloring, 0, sizeof *coloring);
  conic_status status = check_options(context, options, &own);
  if (status != CONIC_OK)
    return status;
  name_coloring(&p, BY_VALUE, field, own.ramp);
  int is_of_classes = is_that_word(coloring->ramp, ramp_names[CONIC_RAMP_CLASSES]);
  coloring->minimum = is_of_classes ? least : own.has_range ? own.minimum : typical[0];
  coloring->maximum = is_of_classes ? greatest : own.has_range ? own.maximum : typical[1];
  for (unsigned i = 0; i < 256 && is_of_classes; i++)
    if ((double)i >= least && (double)i <= greatest)
      coloring->classes[i / 32] |= 1u << i % 32;
  return CONIC_OK;
}

int conic_coloring_needs_range(const conic_coloring_options *options) {
  int is_of_classes = options->ramp ? is_that_word(options->ramp, ramp_names[CONIC_RAMP_CLASSES])
                                    : conic_field_is(options->by, "classification");
  return !options->has_range && !is_of_classes && !is_that_word(options->by, "normal") &&
         !is_that_word(options->by, "rgb");
}

void conic_coloring_sample(const conic_coloring_options *options, const conic_splats *batch,
                           conic_value_sample *sample) {
  painting p = {.kind = is_that_word(options->by, "height") ? BY_HEIGHT : BY_VALUE,
                .up = {options->up[0], options->up[1], options->up[2]}};
  float *scalar = batch->scalar;
  const vertices set = {.count = batch->count,
                        .origin = batch->origin,
                        .scalar_origin = batch->scalar_origin,
                        .position = batch->position,
                        .scalar = &scalar};
  if (!conic_normalize(p.up))
    p.up[1] = 1.0;
  for (size_t i = 0; i < batch->count; i++)
    conic_value_sample_add(sample, value_at_vertex(&p, &set, i));
}

static conic_status paint_all(painting *p, conic_triangles *triangles) {
  conic_status status = need_normals(p, triangles);
  for (int k = 0; k < 2 && status == CONIC_OK; k++)
    status = need_colors(p->context, &p->sets[k]);
  for (int k = 0; k < 2 && status == CONIC_OK; k++)
    paint_vertices(p, &p->sets[k]);
  if (status == CONIC_OK)
    whiten_materials(triangles);
  for (int axis = 0; axis < 3; axis++)
    conic_memory_release(p->context, p->sets[1].normal[axis]);
  return status;
}

conic_status conic_drawing_color(conic_context *context, const conic_coloring_options *options, conic_splats *splats,
                                 conic_triangles *triangles, conic_coloring *coloring) {
  conic_coloring_options own;
  conic_splats no_splats = {.count = 0};
  conic_triangles no_triangles = {.count = 0};
  conic_splats *s = splats ? splats : &no_splats;
  conic_triangles *t = triangles ? triangles : &no_triangles;
  memset(coloring, 0, sizeof *coloring);
  conic_status status = check_options(context, options, &own);
  if (status == CONIC_OK)
    status = conic_splats_check_own(context, "colouring", s);
  if (status == CONIC_OK)
    status = conic_triangles_check_own(context, "colouring", t);
  if (status != CONIC_OK)
    return status;
  painting p = {context, BY_VALUE, {own.up[0], own.up[1], own.up[2]}, .coloring = coloring};
  p.sets[0] =
      (vertices){s->count, s->origin, s->scalar_origin, s->position, s->color, &s->scalar, s, {NULL, NULL, NULL}};
  p.sets[1] = (vertices){t->n_vertices, t->origin, t->scalar_origin,  t->position, t->color,
                         &t->scalar,    NULL,      {NULL, NULL, NULL}};
  if (!conic_normalize(p.up))
    p.up[1] = 1.0;
  status = choose_coloring(&p, &own, s->color[0] || t->color[0] || t->n_materials);
  if (status == CONIC_OK && p.kind == BY_NORMAL && s->count && !s->tangent_u[0] && !s->normal[0])
    status = conic_fail(context, CONIC_ERROR_ARGUMENT, "colouring: the points have no normals");
  if (status == CONIC_OK && coloring->field[0])
    status = paint_all(&p, t);
  drop_scalars(context, &s->scalar);
  drop_scalars(context, &t->scalar);
  return status;
}
