#include "gaussians/scene/gaussian_set.h"

#include "gaussians/scene/activation.h"

int conic_degree_of_coefficients(size_t n) {
  for (int degree = 0; degree <= CONIC_MAX_SH_DEGREE; degree++)
    if (conic_harmonics_of_degree(degree) == 3 * n)
      return degree;
  return -1;
}

/* Those of `fields` that are no mere choice; the first seven of a 2D set, eight of others, and three or four more. */
static int list_all_columns(conic_gaussians *gaussians, unsigned fields, float **columns[CONIC_MOST_GAUSSIAN_COLUMNS]) {
  int n = 0, n_scales = fields & CONIC_GAUSSIANS_2D ? 2 : 3;
  for (int i = 0; i < 3; i++)
    columns[n++] = &gaussians->position[i];
  for (int i = 0; i < n_scales; i++)
    columns[n++] = &gaussians->scale[i];
  for (int i = 0; i < 4; i++)
    columns[n++] = &gaussians->rotation[i];
  columns[n++] = &gaussians->opacity;
  if (fields & CONIC_GAUSSIANS_SOURCE) {
    for (int i = 0; i < n_scales; i++)
      columns[n++] = &gaussians->log_scale[i];
    columns[n++] = &gaussians->logit_opacity;
  }
  return n;
}

int conic_gaussians_list_columns(const conic_gaussians *gaussians, float **columns[CONIC_MOST_GAUSSIAN_COLUMNS]) {
  return list_all_columns((conic_gaussians *)gaussians, conic_gaussians_fields(gaussians), columns);
}

unsigned conic_gaussians_fields(const conic_gaussians *gaussians) {
  return (gaussians->scale[2] ? 0 : CONIC_GAUSSIANS_2D) | (gaussians->sh_half ? CONIC_GAUSSIANS_HALF : 0) |
         (gaussians->logit_opacity ? CONIC_GAUSSIANS_SOURCE : 0);
}

conic_status conic_gaussians_allocate(conic_context *context, size_t count, int sh_degree, unsigned fields,
                                      conic_gaussians *gaussians) {
  float **columns[CONIC_MOST_GAUSSIAN_COLUMNS];
  memset(gaussians, 0, sizeof *gaussians);
  if (sh_degree < 0 || sh_degree > CONIC_MAX_SH_DEGREE || fields > 7 || count > CONIC_MOST_GAUSSIANS)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "gaussians: no set has %zu Gaussians of degree %d", count,
                      sh_degree);
  int n = list_all_columns(gaussians, fields, columns), is_done = 1;
  for (int i = 0; is_done && i < n; i++)
    is_done = (*columns[i] = conic_memory_allocate(context, count, sizeof **columns[i])) != NULL;
  size_t n_numbers = count * conic_harmonics_of_degree(sh_degree);
  if (is_done && fields & CONIC_GAUSSIANS_HALF)
    is_done = (gaussians->sh_half = conic_memory_allocate(context, n_numbers, sizeof *gaussians->sh_half)) != NULL;
  else if (is_done)
    is_done = (gaussians->sh = conic_memory_allocate(context, n_numbers, sizeof *gaussians->sh)) != NULL;
  if (!is_done) {
    conic_gaussians_release(context, gaussians);
    return CONIC_ERROR_MEMORY;
  }
  gaussians->count = count;
  gaussians->sh_degree = sh_degree;
  memcpy(gaussians->frame, "rdf", sizeof gaussians->frame);
  return CONIC_OK;
}

conic_status conic_gaussians_grow(conic_context *context, conic_gaussians *gaussians, size_t used, size_t room) {
  float **columns[CONIC_MOST_GAUSSIAN_COLUMNS];
  const size_t n = conic_harmonics_of_degree(gaussians->sh_degree);
  int n_columns = conic_gaussians_list_columns(gaussians, columns);
  conic_status status = gaussians->sh
                            ? conic_memory_grow(context, &gaussians->sh, used, room, n * sizeof(float))
                            : conic_memory_grow(context, &gaussians->sh_half, used, room, n * sizeof(uint16_t));
  for (int i = 0; status == CONIC_OK && i < n_columns; i++)
    status = conic_memory_grow(context, columns[i], used, room, sizeof(float));
  return status;
}

void conic_gaussians_put(const conic_gaussians *from, conic_gaussians *to, size_t first) {
  float **columns[CONIC_MOST_GAUSSIAN_COLUMNS], **own[CONIC_MOST_GAUSSIAN_COLUMNS], room[CONIC_MOST_HARMONICS];
  const size_t n_from = conic_harmonics_of_degree(from->sh_degree), n = conic_harmonics_of_degree(to->sh_degree);
  conic_gaussians_list_columns(from, columns);
  for (int i = conic_gaussians_list_columns(to, own) - 1; i >= 0; i--)
    memcpy(*own[i] + first, *columns[i], from->count * sizeof(float));
  for (size_t i = 0; i < from->count; i++) {
    const float *harmonics = conic_gaussians_harmonics(from, i, room);
    for (size_t k = 0; k < n; k++) /* NOLINTNEXTLINE(clang-analyzer-core.*): n_from of them */
      conic_gaussians_put_harmonic(to, first + i, k, k < n_from ? harmonics[k] : 0.0f);
  }
}

void conic_gaussians_release(conic_context *context, conic_gaussians *gaussians) {
  float **columns[CONIC_MOST_GAUSSIAN_COLUMNS];
  int n = list_all_columns(gaussians, CONIC_GAUSSIANS_SOURCE, columns);
  for (int i = 0; i < n; i++)
    conic_memory_release(context, *columns[i]);
  conic_memory_release_these(context, gaussians->sh, gaussians->sh_half);
  memset(gaussians, 0, sizeof *gaussians);
}

conic_status conic_gaussians_check(conic_context *context, const conic_gaussians *gaussians, const char *name) {
  float **columns[CONIC_MOST_GAUSSIAN_COLUMNS];
  int n = conic_gaussians_list_columns(gaussians, columns);
  int is_whole = (gaussians->sh || gaussians->sh_half) && gaussians->sh_degree >= 0 &&
                 gaussians->sh_degree <= CONIC_MAX_SH_DEGREE && gaussians->count <= CONIC_MOST_GAUSSIANS;
  for (int i = 0; i < n; i++)
    is_whole = is_whole && *columns[i];
  for (size_t i = 0; i < sizeof gaussians->reserved / sizeof *gaussians->reserved; i++)
    is_whole = is_whole && !gaussians->reserved[i];
  return is_whole ? CONIC_OK
                  : conic_fail(context, CONIC_ERROR_ARGUMENT, "%s: the Gaussians lack arrays, or are not known", name);
}

const float *conic_gaussians_harmonics(const conic_gaussians *gaussians, size_t i, float room[CONIC_MOST_HARMONICS]) {
  size_t n = conic_harmonics_of_degree(gaussians->sh_degree);
  if (gaussians->sh)
    return gaussians->sh + i * n;
  for (size_t k = 0; k < n; k++)
    room[k] = conic_float_of_half(gaussians->sh_half[i * n + k]);
  return room;
}

float conic_gaussians_log_scale(const conic_gaussians *gaussians, int axis, size_t i) {
  return gaussians->log_scale[axis] ? gaussians->log_scale[axis][i] : conic_log_of_scale(gaussians->scale[axis][i]);
}

float conic_gaussians_logit(const conic_gaussians *gaussians, size_t i) {
  return gaussians->logit_opacity ? gaussians->logit_opacity[i] : conic_logit_of_opacity(gaussians->opacity[i]);
}

size_t conic_gaussians_bounds(const conic_gaussians *gaussians, double minimum[3], double maximum[3]) {
  size_t n_finite = 0;
  for (size_t i = 0; i < gaussians->count; i++) {
    double mean[3];
    int is_finite = 1;
    for (int axis = 0; axis < 3; axis++)
      is_finite &= conic_is_finite(mean[axis] = conic_gaussians_mean(gaussians, axis, i));
    for (int axis = 0; is_finite && axis < 3; axis++) {
      minimum[axis] = n_finite == 0 || mean[axis] < minimum[axis] ? mean[axis] : minimum[axis];
      maximum[axis] = n_finite == 0 || mean[axis] > maximum[axis] ? mean[axis] : maximum[axis];
    }
    n_finite += (size_t)is_finite;
  }
  for (int axis = 0; axis < 3 && n_finite == 0; axis++)
    minimum[axis] = maximum[axis] = 0.0;
  return n_finite;
}

void conic_gaussians_find_defects(const conic_gaussians *gaussians, conic_gaussians_defects *defects) {
  size_t n_harmonics = conic_harmonics_of_degree(gaussians->sh_degree);
  float room[CONIC_MOST_HARMONICS];
  memset(defects, 0, sizeof *defects);
  for (size_t i = 0; i < gaussians->count; i++) {
    int positions = 1, scales = 1, harmonics = 1;
    double length = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      positions &= conic_is_finite((double)gaussians->position[axis][i]);
      scales &= !gaussians->scale[axis] ||
                (gaussians->scale[axis][i] >= 0.0f && conic_is_finite((double)gaussians->scale[axis][i]));
    }
    for (int k = 0; k < 4; k++)
      length += (double)gaussians->rotation[k][i] * (double)gaussians->rotation[k][i];
    const float *sh = conic_gaussians_harmonics(gaussians, i, room);
    for (size_t k = 0; k < n_harmonics; k++)
      harmonics &= conic_is_finite((double)sh[k]);
    defects->positions += !positions;
    defects->scales += !scales;
    defects->rotations += !(length > 0.0 && conic_is_finite(length));
    defects->opacities += !(gaussians->opacity[i] >= 0.0f && gaussians->opacity[i] <= 1.0f);
    defects->harmonics += !harmonics;
  }
}
