/* The mistakes that are tried, each in all its likely readings. */
#include <math.h>

#include "judge/planted.h"

enum {
  OF_PROFILE,
  OF_DILATION,
  OF_ALPHA_MOST,
  OF_FALLOFF,
  OF_EXTENT,
  OF_ORDER,
  OF_NEAR,
  OF_DEGREE,
  OF_HARMONICS,
  OF_ROTATION,
  OF_RAW_ROTATION,
  OF_SCALE,
  OF_OPACITY,
  OF_SHIFT, /* in pixels; then of the camera's principal point */
  OF_CENTER_SHIFT,
  OF_CAMERA_MIRROR,
  OF_CENTER,
  OF_FOCAL,
  OF_OWN_TRANSFER,
  OF_SIGNS,
  OF_OFFSET,
  OF_EYE,
  OF_FORM,
  OF_CROSS,
  OF_TURN,
  OF_AXES_ORDER,
  OF_SIZE,
  OF_ZOOM,
  OF_KEY_BITS,
  OF_WEIGHT,
  OF_ALPHA_LEAST,
  OF_BATCH,
  OF_LIMIT,
  OF_SURFACES,
  OF_METHOD,
  OF_SLIP,
  OF_AXES,
  OF_FACING,
  OF_MIRROR,
  OF_MOVE,
  OF_ALPHA, /* in finishing, from here on */
  OF_BACKGROUND,
  OF_BACKDROP,
  OF_TRANSFER,
  OF_BGR,
  OF_CLIP,
  OF_RAW_Z
};

/* A mistake in its n readings. A shift's `how` and value are half pixels in x and in y; falloffs end at 4, 4.5, ln 255
 * and 2. */
typedef struct suspected {
  const char *name;
  int kind, n;
  int how[19];
  double value[19];
} suspected;

#define EXTENTS                                                                                                        \
  CONIC_EXTENT_ELLIPSE, CONIC_EXTENT_BOX, CONIC_EXTENT_WHOLE_BOX, CONIC_EXTENT_SQUARE, CONIC_EXTENT_WHOLE_SQUARE,      \
      CONIC_EXTENT_CIRCLE, CONIC_EXTENT_WHOLE_CIRCLE, CONIC_EXTENT_LISTED, CONIC_EXTENT_WHOLE_LISTED,                  \
      CONIC_EXTENT_LISTED_SQUARE, CONIC_EXTENT_WHOLE_LISTED_SQUARE
#define EACH(x) x, x, x, x, x, x, x, x, x, x, x

static const suspected of_gaussians[] = {
    {"surfaces-behind", OF_SURFACES, 1, {CONIC_SURFACES_BEHIND_ALL}, {0.0}},
    {"surfaces-before", OF_SURFACES, 1, {CONIC_SURFACES_BEFORE_ALL}, {0.0}},
    {"surfaces-linear", OF_SURFACES, 1, {CONIC_SURFACES_LINEAR}, {0.0}},
    {"half-pixel", OF_SHIFT, 8, {-1, 1, -1, 1, -1, 1, 0, 0}, {-1.0, 1.0, 1.0, -1.0, 0.0, 0.0, -1.0, 1.0}},
    {"dilation-0", OF_DILATION, 1, {0}, {0.0}},
    {"dilation-0.1", OF_DILATION, 1, {0}, {0.1}},
    {"dilation-0.5", OF_DILATION, 1, {0}, {0.5}},
    {"dilation-1", OF_DILATION, 1, {0}, {1.0}},
    {"extent-3-sigma", OF_EXTENT, 12, {EXTENTS, CONIC_EXTENT_TILES}, {EACH(3.0), 3.0}},
    {"extent-2-sigma", OF_EXTENT, 11, {EXTENTS}, {EACH(2.0)}},
    {"extent-1-sigma", OF_EXTENT, 11, {EXTENTS}, {EACH(1.0)}},
    {"extent-exact", OF_EXTENT, 1, {CONIC_EXTENT_EXACT}, {0.0}},
    {"alpha-max-0.999", OF_ALPHA_MOST, 1, {0}, {0.999}},
    {"alpha-max-0.99", OF_ALPHA_MOST, 1, {0}, {0.99}},
    {"alpha-max-1", OF_ALPHA_MOST, 1, {0}, {1.0}},
    {"alpha-min-0", OF_ALPHA_LEAST, 1, {0}, {1e-9}},
    {"exp2", OF_FORM, 1, {0}, {0.6931471805599453}},
    {"falloff-not-halved", OF_FORM, 1, {0}, {2.0}},
    {"cross-term", OF_CROSS, 4, {0}, {0.5, 2.0, -1.0, 0.0}},
    {"falloff-renormalised", OF_FALLOFF, 5, {0, 0, 0, 0, 1}, {4.0, 4.5, 5.5412635, 2.0, 0.0}},
    {"order-distance", OF_ORDER, 2, {0, 1}, {CONIC_ORDER_DISTANCE, CONIC_ORDER_DISTANCE}},
    {"order-file", OF_ORDER, 2, {0, 1}, {CONIC_ORDER_FILE, CONIC_ORDER_FILE}},
    {"order-z", OF_ORDER, 1, {0}, {CONIC_ORDER_Z}},
    {"order-reversed", OF_ORDER, 1, {1}, {CONIC_ORDER_OWN}},
    {"order-coarse", OF_KEY_BITS, 2, {10, 7}, {0.0}}, /* half floats, and the upper half of a float */
    {"near",
     OF_NEAR,
     19,
     {0},
     {0.0, 0.001, 0.01, 0.05, 0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 10.0}},
    {"sh-degree-0", OF_DEGREE, 1, {0}, {0.0}},
    {"sh-degree-1", OF_DEGREE, 1, {1}, {0.0}},
    {"sh-degree-2", OF_DEGREE, 1, {2}, {0.0}},
    {"sh-direction", OF_SIGNS, 1, {0xfe0e}, {0.0}}, /* odd degrees change their signs with the direction */
    {"sh-direction", OF_EYE, 2, {0, 1}, {0.0}},
    {"sh-sign",
     OF_SIGNS,
     18,
     {2, 4, 8, 10, 14, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768, 65534},
     {0.0}},
    {"sh-offset", OF_OFFSET, 1, {0}, {-0.5}},
    {"colours-not-clamped", OF_LIMIT, 1, {0}, {0.0}},
    {"colours-clamped", OF_LIMIT, 1, {1}, {0.0}},
    {"f-rest-interleaved", OF_HARMONICS, 2, {CONIC_READING_RAW, CONIC_READING_TWICE}, {0.0}},
    {"quaternion-xyzw", OF_ROTATION, 2, {CONIC_READING_RAW, CONIC_READING_TWICE}, {0.0}},
    {"quaternion-conjugate", OF_ROTATION, 1, {CONIC_READING_CONJUGATE}, {0.0}},
    {"quaternion-not-normalised", OF_RAW_ROTATION, 3, {0, 0, CONIC_READING_LENGTH_SQUARED}, {2.0, 3.0, 0.0}},
    {"scale-linear", OF_SCALE, 2, {CONIC_READING_RAW, CONIC_READING_TWICE}, {0.0}},
    {"scale-order", OF_AXES_ORDER, 5, {1, 2, 3, 4, 5}, {0.0}},
    {"scale-factor", OF_SIZE, 9, {0}, {0.25, 0.5, 0.7, 0.85, 0.95, 1.1, 1.4, 2.0, 3.0}},
    {"jacobian-sign", OF_TURN, 1, {CONIC_TURN_HALF}, {0.0}},
    {"view-rotation", OF_TURN, 2, {CONIC_TURN_NONE, CONIC_TURN_TRANSPOSED}, {0.0}},
    {"alpha-twice", OF_WEIGHT, 2, {1, 2}, {0.0}},
    {"transmittance-after", OF_WEIGHT, 2, {3, 4}, {0.0}},
    {"last-batch", OF_BATCH, 6, {32, 64, 128, 256, 512, 1024}, {0.0}},
    {"opacity-linear", OF_OPACITY, 3, {CONIC_READING_RAW, CONIC_READING_RAW_LIMITED, CONIC_READING_TWICE}, {0.0}},
    {"srgb-decoded", OF_OWN_TRANSFER, 1, {CONIC_TRANSFER_DECODED}, {0.0}},
    {"srgb-encoded", OF_OWN_TRANSFER, 1, {CONIC_TRANSFER_ENCODED}, {0.0}},
};

static const suspected of_surfels[] = {
    {"affine", OF_METHOD, 1, {0}, {CONIC_METHOD_AFFINE}},
    {"no-amplitude", OF_SLIP, 1, {CONIC_SLIP_AMPLITUDE}, {0.0}},
    {"epsilon-in-z", OF_SLIP, 1, {CONIC_SLIP_EPSILON}, {0.0}},
    {"radius-as-sigma", OF_AXES, 2, {1, -1}, {0.0}},
    {"no-normalisation", OF_ALPHA, 2, {CONIC_ALPHA_WEIGHTED, CONIC_ALPHA_WEIGHTED_LIMITED}, {0.0}},
    {"back-faces", OF_FACING, 1, {0}, {0.0}},
    {"near",
     OF_NEAR,
     13,
     {0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1},
     {0.01, 0.1, 0.2, 0.5, 1.0, 2.0, 10.0, 100.0, 1e3, 2e3, 5e3, 1e4, 1.5e4}},
};

static const suspected of_all[] = {
    {"half-pixel", OF_CENTER_SHIFT, 8, {-1, 1, -1, 1, -1, 1, 0, 0}, {-1.0, 1.0, 1.0, -1.0, 0.0, 0.0, -1.0, 1.0}},
    {"mirrored-x", OF_MIRROR, 1, {0}, {0.0}},
    {"mirrored-x", OF_CAMERA_MIRROR, 1, {0}, {0.0}},
    {"mirrored-y", OF_MIRROR, 1, {1}, {0.0}},
    {"mirrored-y", OF_CAMERA_MIRROR, 1, {1}, {0.0}},
    {"shifted", OF_MOVE, 8, {-1, 1, 0, 0, -1, 1, -1, 1}, {0.0, 0.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0}},
    {"shifted", OF_CENTER_SHIFT, 8, {-2, 2, 0, 0, -2, 2, -2, 2}, {0.0, 0.0, -2.0, 2.0, -2.0, 2.0, 2.0, -2.0}},
    {"bgr", OF_BGR, 1, {0}, {0.0}},
    {"clipped", OF_CLIP, 1, {0}, {0.0}},
    {"z-not-divided", OF_RAW_Z, 1, {0}, {0.0}},
    {"centre-ignored", OF_CENTER, 3, {3, 1, 2}, {0.0}},
    {"centre-flipped", OF_CENTER, 3, {4, 8, 12}, {0.0}},
    {"field-of-view", OF_FOCAL, 4, {0, 1, 2, 3}, {0.0}},
    {"focal-exchanged", OF_FOCAL, 1, {4}, {0.0}},
    {"focal-length",
     OF_ZOOM,
     14,
     {0},
     {0.5, 0.65, 0.8, 0.9, 0.95, 0.98, 0.995, 1.005, 1.02, 1.05, 1.1, 1.25, 1.5, 2.0}},
    {"srgb-decoded",
     OF_TRANSFER,
     3,
     {CONIC_TRANSFER_DECODED, CONIC_TRANSFER_DECODED_BY_POWER, CONIC_TRANSFER_DECODED_TWICE},
     {0.0}},
    {"srgb-encoded",
     OF_TRANSFER,
     3,
     {CONIC_TRANSFER_ENCODED, CONIC_TRANSFER_ENCODED_BY_POWER, CONIC_TRANSFER_ENCODED_TWICE},
     {0.0}},
    {"premultiplied", OF_ALPHA, 2, {CONIC_ALPHA_MULTIPLIED, CONIC_ALPHA_DIVIDED}, {0.0}},
    {"background-white", OF_BACKGROUND, 2, {1, 0}, {1.0, 1.0}},
    {"background-black", OF_BACKGROUND, 2, {1, 0}, {0.0}},
    {"background-twice", OF_BACKDROP, 2, {0, 1}, {0.0}},
};

/* One of them, or one angle, for both sides, in pixels or by the sides; or each the other one. */
static void change_focal(conic_camera *camera, int how) {
  const double fx = camera->fx, fy = camera->fy, width = camera->width, height = camera->height;
  camera->fx = how == 1 || how == 4 ? fy : how == 2 ? fy * width / height : fx;
  camera->fy = how == 0 || how == 4 ? fx : how == 3 ? fx * height / width : fy;
}

static void plant_profile(conic_planted *p, conic_gaussian_profile profile) {
  p->profile = profile;
  p->rules = *conic_profile_row_of(profile);
  p->prefilter = profile == CONIC_PROFILE_EXACT ? p->prefilter : 0.0;
  if (p->rules.takes_middle) {
    p->camera.cx = 0.5 * p->camera.width;
    p->camera.cy = 0.5 * p->camera.height;
  }
}

static void plant_dilation(conic_planted *p, double value) {
  if (p->rules.shape == CONIC_SHAPE_RAY)
    p->prefilter = value;
  else
    p->rules.dilation = value;
}

static void plant_extent(conic_planted *p, conic_planted_extent extent, double sigmas) {
  p->extent = extent;
  p->extent_sigmas = (float)sigmas;
  if (extent == CONIC_EXTENT_TILES)
    p->rules.coverage = CONIC_COVERAGE_TILES;
  if (extent == CONIC_EXTENT_EXACT) {
    p->rules.coverage = CONIC_COVERAGE_ALPHA;
    p->rules.greatest_half_q = 0.0;
    p->rules.alpha_least = 1.0 / 255.0;
  }
}

/* With `how`, for surfels, `factor` multiplies the right value; else it is the value. */
static void plant_near(conic_planted *p, int how, double factor) {
  const double value = how ? factor * p->options.near_z : factor;
  p->rules.near_z = p->least_z = p->options.near_z = value;
  p->rules.disc_near = p->rules.disc_near > 0.0 ? (value > 0.0 ? value : 1e-6) : 0.0;
}

/* Mirrors about the principal point. The renderer of surfels refuses a camera that mirrors, but its picture can be
 * mirrored. */
static void plant_mirror(conic_planted *p, int axis) {
  conic_camera *camera = &p->camera;
  for (int k = 0; k < 4 && !p->is_of_surfels; k++)
    camera->cam_from_world[axis][k] = -camera->cam_from_world[axis][k];
  if (!p->is_of_surfels)
    return;
  p->mirrors[axis] = !p->mirrors[axis];
  camera->cx = axis == 0 ? camera->width - camera->cx : camera->cx;
  camera->cy = axis == 1 ? camera->height - camera->cy : camera->cy;
}

static void plant_in_camera(conic_camera *camera, const conic_suspect *s) {
  if (s->kind == OF_CENTER_SHIFT) {
    camera->cx += 0.5 * s->how;
    camera->cy += 0.5 * s->value;
  } else if (s->kind == OF_CENTER) {
    camera->cx = s->how & 1 ? 0.5 * camera->width : camera->cx;
    camera->cy = s->how & 2 ? 0.5 * camera->height : camera->cy;
    camera->cx = s->how & 4 ? camera->width - camera->cx : camera->cx;
    camera->cy = s->how & 8 ? camera->height - camera->cy : camera->cy;
  } else if (s->kind == OF_ZOOM) {
    camera->fx *= s->value;
    camera->fy *= s->value;
  } else
    change_focal(camera, s->how);
}

static void plant_in_scene(const conic_suspect *s, conic_planted *p) {
  switch (s->kind) {
  case OF_DEGREE:
    p->most_degree = s->how;
    break;
  case OF_HARMONICS:
    p->harmonics = (conic_planted_reading)s->how;
    break;
  case OF_ROTATION:
    p->rotation = (conic_planted_reading)s->how;
    break;
  case OF_RAW_ROTATION:
    p->rules.takes_rotation_as_is = s->how ? p->rules.takes_rotation_as_is : (int)s->value;
    p->scale = s->how ? (conic_planted_reading)s->how : p->scale;
    break;
  case OF_SCALE:
    p->scale = (conic_planted_reading)s->how;
    break;
  case OF_OPACITY:
    p->opacity = (conic_planted_reading)s->how;
    break;
  case OF_SIGNS:
    p->harmonic_signs = (unsigned)s->how;
    break;
  case OF_OFFSET:
    p->color_offset = (float)s->value;
    break;
  case OF_EYE:
    p->takes_translation = s->how;
    p->turns_directions = !s->how;
    break;
  case OF_FORM: /* e^(-v q/2) of a Gaussian is e^(-q/2) of one that is narrower by √v */
    p->size = (float)(1.0 / sqrt(s->value));
    p->rules.dilation /= s->value;
    break;
  case OF_TURN:
    p->turn = (conic_planted_turn)s->how;
    break;
  case OF_AXES_ORDER:
    p->axes_order = s->how;
    break;
  case OF_SIZE:
    p->size = (float)s->value;
    break;
  case OF_KEY_BITS:
    p->key_bits = s->how;
    break;
  case OF_WEIGHT:
    p->reweighs = s->how;
    break;
  case OF_BATCH:
    p->n_whole -= p->n_whole % (size_t)s->how;
    break;
  case OF_CROSS:
    p->changes_cross = 1;
    p->cross_factor = (float)s->value;
    break;
  case OF_LIMIT:
    p->takes_any_color = !s->how;
    p->limits_color = s->how;
    break;
  case OF_SURFACES:
    p->surfaces_are = (conic_planted_surfaces)s->how;
    break;
  case OF_OWN_TRANSFER:
    p->own_transfer = (conic_planted_transfer)s->how;
    break;
  case OF_METHOD:
    p->options.method = (conic_method)s->value;
    break;
  case OF_SLIP:
    p->slips |= (unsigned)s->how;
    break;
  case OF_AXES:
    p->axes = s->how > 0 ? (double)p->options.kernel.cutoff : 1.0 / (double)p->options.kernel.cutoff;
    break;
  default:
    p->options.cull_back = !p->options.cull_back;
  }
}

static void plant_in_picture(const conic_suspect *s, conic_planted *p) {
  if (s->kind == OF_MIRROR)
    p->mirrors[s->how] = 1;
  else if (s->kind == OF_ALPHA)
    p->alpha = (conic_planted_alpha)s->how;
  else if (s->kind == OF_MOVE) {
    p->moves[0] = s->how;
    p->moves[1] = (int)s->value;
  } else if (s->kind == OF_BGR)
    p->is_bgr = 1;
  else if (s->kind == OF_CLIP)
    p->is_clipped = 1;
  else if (s->kind == OF_RAW_Z)
    p->has_raw_z = 1;
  else if (s->kind == OF_TRANSFER)
    p->transfer = (conic_planted_transfer)s->how;
  else if (s->kind == OF_BACKDROP) {
    p->adds_whole = s->how;
    for (int c = 0; c < 3 && !s->how; c++)
      p->behind[c] *= 2.0f;
  } else {
    p->behind[0] = p->behind[1] = p->behind[2] = (float)s->value;
    p->is_opaque |= s->how;
  }
}

void conic_suspect_plant(const conic_suspect *s, conic_planted *p) {
  switch (s->kind) {
  case OF_PROFILE:
    plant_profile(p, (conic_gaussian_profile)s->how);
    break;
  case OF_DILATION:
    plant_dilation(p, s->value);
    break;
  case OF_ALPHA_MOST:
    p->rules.alpha_most = s->value;
    break;
  case OF_ALPHA_LEAST:
    p->rules.alpha_least = s->value;
    break;
  case OF_FALLOFF:
    p->falloff_end = (float)s->value;
    p->has_unit_volume = s->how;
    break;
  case OF_EXTENT:
    plant_extent(p, (conic_planted_extent)s->how, s->value);
    break;
  case OF_ORDER:
    p->order = (conic_planted_order)s->value;
    p->is_reversed = s->how;
    break;
  case OF_NEAR:
    plant_near(p, s->how, s->value);
    break;
  case OF_SHIFT:
    p->shift_px[0] = 0.5f * (float)s->how;
    p->shift_px[1] = 0.5f * (float)s->value;
    break;
  case OF_CAMERA_MIRROR:
    plant_mirror(p, s->how);
    break;
  case OF_CENTER_SHIFT:
  case OF_CENTER:
  case OF_FOCAL:
  case OF_ZOOM:
    plant_in_camera(&p->camera, s);
    break;
  case OF_MIRROR:
  case OF_MOVE:
  case OF_ALPHA:
  case OF_BACKGROUND:
  case OF_BACKDROP:
  case OF_TRANSFER:
  case OF_BGR:
  case OF_CLIP:
  case OF_RAW_Z:
    plant_in_picture(s, p);
    break;
  default:
    plant_in_scene(s, p);
  }
}

int conic_suspect_rank(const conic_suspect *suspect) {
  return suspect->kind;
}

int conic_suspect_is_finish(const conic_suspect *suspect) {
  return suspect->kind >= OF_ALPHA;
}

int conic_suspect_is_alone(const conic_suspect *suspect) {
  return (suspect->kind >= OF_SIGNS && suspect->kind <= OF_LIMIT) || suspect->kind == OF_MOVE ||
         suspect->kind >= OF_BGR;
}

int conic_suspect_is_rough(const conic_suspect *suspect) {
  return suspect->kind == OF_SLIP && suspect->how == CONIC_SLIP_EPSILON; /* each ray has its own length */
}

int conic_suspect_is_any(const conic_suspect *suspect) {
  return suspect->kind == OF_NEAR || suspect->kind == OF_SIZE || suspect->kind == OF_ZOOM;
}

int conic_suspect_is_profile(const conic_suspect *suspect) {
  return suspect->kind == OF_PROFILE;
}

static int has_other_center(const conic_camera *c, int how) {
  int across = fabs(c->cx - 0.5 * c->width) > 1e-6, down = fabs(c->cy - 0.5 * c->height) > 1e-6;
  if (how > 3)
    return (across || how == 8) && (down || how == 4);
  return how == 3 ? across || down : across && down && how; /* a single axis only where both would be moved */
}

static int changes_focal(const conic_camera *camera, int how) {
  conic_camera other = *camera;
  change_focal(&other, how);
  return fabs(other.fx - camera->fx) > 1e-9 * camera->fx || fabs(other.fy - camera->fy) > 1e-9 * camera->fy;
}

/* Whether it would be a mistake under these rules. */
static int is_mistake(const conic_planted *right, const conic_suspect *s) {
  const conic_profile_row *rules = &right->rules;
  const int is_ray = rules->shape == CONIC_SHAPE_RAY, is_ellipse = rules->shape == CONIC_SHAPE_ELLIPSE;
  switch (s->kind) {
  case OF_DILATION:
    return rules->shape != CONIC_SHAPE_DISC && (is_ray ? right->prefilter : rules->dilation) != s->value &&
           (is_ellipse || right->prefilter > 0.0);
  case OF_ALPHA_MOST:
    return (float)rules->alpha_most != (float)s->value;
  case OF_EXTENT:
    if (s->how == CONIC_EXTENT_EXACT)
      return rules->coverage != CONIC_COVERAGE_ALPHA || rules->greatest_half_q > 0.0;
    return s->how == CONIC_EXTENT_ELLIPSE ? !(rules->greatest_half_q > 0.0)
           : s->how == CONIC_EXTENT_TILES ? is_ellipse && rules->coverage != CONIC_COVERAGE_TILES
                                          : is_ellipse;
  case OF_ORDER:
    return s->value == CONIC_ORDER_Z          ? is_ray || rules->orders_by_distance
           : s->value == CONIC_ORDER_DISTANCE ? s->how || !rules->orders_by_distance
                                              : 1;
  case OF_FALLOFF:
    return !s->how || is_ellipse;
  case OF_DEGREE:
  case OF_HARMONICS:
    return right->most_degree > (s->kind == OF_DEGREE ? s->how : 0);
  case OF_SIGNS:
    return s->how == 0xfe0e || s->how == 65534 ? right->most_degree > 0
           : s->how < 16                       ? right->most_degree > 0
           : s->how < 512                      ? right->most_degree > 1
                                               : right->most_degree > 2;
  case OF_SURFACES:
    return right->surfaces && !(s->how == CONIC_SURFACES_LINEAR && right->surfaces->is_linear);
  case OF_FORM:
  case OF_CROSS:
    return is_ellipse;
  case OF_TURN:
    return is_ellipse || s->how != CONIC_TURN_HALF;
  case OF_ALPHA_LEAST:
    return (float)rules->alpha_least > (float)s->value;
  case OF_EYE:
    return right->most_degree > 0;
  case OF_NEAR:
    return rules->near_z != s->value;
  case OF_CENTER:
    return has_other_center(&right->camera, s->how);
  case OF_FOCAL:
    return changes_focal(&right->camera, s->how);
  case OF_METHOD:
    return right->options.method != (conic_method)s->value;
  case OF_SLIP:
    return s->how == CONIC_SLIP_AMPLITUDE ? right->options.prefilter > 0.0f : right->options.passes != 1;
  case OF_BATCH:
    return right->n_whole % (size_t)s->how != 0 && right->n_whole > (size_t)s->how;
  case OF_BACKDROP:
    return right->behind[0] != 0.0f || right->behind[1] != 0.0f || right->behind[2] != 0.0f;
  case OF_BACKGROUND:
    return right->behind[0] != (float)s->value || right->behind[1] != (float)s->value ||
           right->behind[2] != (float)s->value;
  default:
    return 1;
  }
}

static int add_suspects(const conic_planted *right, const suspected *from, size_t n, conic_suspect *suspects) {
  int n_added = 0;
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < from[i].n; k++) {
      const conic_suspect s = {from[i].name, from[i].kind, from[i].how[k], from[i].value[k]};
      if (is_mistake(right, &s))
        suspects[n_added++] = s;
    }
  return n_added;
}

int conic_suspects_of_gaussians(const conic_planted *right, conic_suspect suspects[CONIC_MOST_SUSPECTS]) {
  const int is_pinhole =
      right->camera.kind == CONIC_CAMERA_PERSPECTIVE && !right->camera.lens && !right->camera.shutter;
  int n = add_suspects(right, of_gaussians, sizeof of_gaussians / sizeof *of_gaussians, suspects);
  n += add_suspects(right, of_all, sizeof of_all / sizeof *of_all, suspects + n);
  for (int profile = 0; is_pinhole && profile < CONIC_N_GAUSSIAN_PROFILES; profile++)
    if (profile != (int)right->profile)
      suspects[n++] =
          (conic_suspect){conic_gaussian_profile_name((conic_gaussian_profile)profile), OF_PROFILE, profile, 0.0};
  return n;
}

int conic_suspects_of_surfels(const conic_planted *right, conic_suspect suspects[CONIC_MOST_SUSPECTS]) {
  int n = add_suspects(right, of_surfels, sizeof of_surfels / sizeof *of_surfels, suspects);
  return n + add_suspects(right, of_all, sizeof of_all / sizeof *of_all, suspects + n);
}
