#include "core/scenes/scene_kind.h"

#include "core/base/color.h"
#include "core/base/random.h"
#include "core/base/trigonometry.h"
#include "core/splats/columns.h"
#include "core/splats/ellipse.h"

static const conic_scene_kind *const kinds[CONIC_N_SCENES] = {
    [CONIC_SCENE_PLANE] = &conic_scene_plane,     [CONIC_SCENE_SPHERE] = &conic_scene_sphere,
    [CONIC_SCENE_TORUS] = &conic_scene_torus,     [CONIC_SCENE_KNOT] = &conic_scene_knot,
    [CONIC_SCENE_TERRAIN] = &conic_scene_terrain, [CONIC_SCENE_GYROID] = &conic_scene_gyroid,
    [CONIC_SCENE_CUBE] = &conic_scene_cube,       [CONIC_SCENE_CORNER] = &conic_scene_corner};

/* Pictures number their splats with 32 bits, and the last number means none. */
#define MAX_COUNT (CONIC_NO_ID - 1)

/* Dimensions of the random numbers; the Gaussian takes three. */
enum { DIMENSION_JITTER_RADIUS = 0, DIMENSION_JITTER_ANGLE = 1, DIMENSION_NOISE = 2 };

/* Limit of jitter and noise, in spacings: more than anyone needs, and too little for floats to overflow. */
#define MAX_SPACINGS 1e6

/* Samples that one task places. */
enum { CHUNK = 4096 };

static const conic_scene_kind *kind_of(conic_scene_type type) {
  return (int)type >= 0 && (int)type < CONIC_N_SCENES ? kinds[type] : NULL;
}

const char *conic_scene_name(conic_scene_type type) {
  return kind_of(type) ? kind_of(type)->name : NULL;
}

const char *conic_scene_summary(conic_scene_type type) {
  return kind_of(type) ? kind_of(type)->summary : NULL;
}

unsigned conic_scene_fields(conic_scene_type type) {
  const conic_scene_kind *kind = kind_of(type);
  unsigned fields = (unsigned)CONIC_SPLATS_TANGENTS | (unsigned)CONIC_SPLATS_COLORS;
  return !kind ? 0 : kind->edges ? fields | (unsigned)CONIC_SPLATS_CLIPS : fields;
}

CONIC_DEFINE_OPTIONS(conic_scene_options, .type = CONIC_SCENE_SPHERE, .count = 100000, .cutoff = 1.5f)

static conic_status check_scene_options(conic_context *context, const conic_scene_options *given,
                                        conic_scene_options *options) {
  conic_scene_options_init(options);
  if (!conic_options_take(options, given) || !kind_of(options->type))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "scene: options that are none");
  if (options->count < 1 || options->count > MAX_COUNT)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "scene: the count must be from 1 to %llu",
                      (unsigned long long)MAX_COUNT);
  if (!(options->jitter >= 0.0 && options->jitter <= MAX_SPACINGS))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "scene: the jitter must be from 0 to %g spacings", MAX_SPACINGS);
  if (!(options->noise >= 0.0 && options->noise <= MAX_SPACINGS))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "scene: the noise must be from 0 to %g spacings", MAX_SPACINGS);
  if (!(options->cutoff > 0.0f && conic_is_finite((double)options->cutoff)))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "scene: the cutoff must be finite and above 0");
  for (int axis = 0; axis < 3; axis++)
    if (!conic_is_finite(options->offset[axis]))
      return conic_fail(context, CONIC_ERROR_ARGUMENT, "scene: the offset must be finite");
  return CONIC_OK;
}

conic_status conic_scene_create(conic_context *context, const conic_scene_options *given, conic_scene **scene) {
  conic_scene_options options;
  *scene = NULL;
  conic_status status = check_scene_options(context, given, &options);
  if (status != CONIC_OK)
    return status;
  conic_scene *made = conic_memory_allocate_zeroed(context, 1, sizeof *made);
  if (!made)
    return CONIC_ERROR_MEMORY;
  made->context = context;
  made->options = options;
  made->kind = kind_of(options.type);
  conic_srgb_decode_table(made->decode);
  status = made->kind->prepare(made);
  if (status != CONIC_OK) {
    conic_scene_destroy(made);
    return status;
  }
  made->spacing = sqrt(made->area / (double)options.count);
  *scene = made;
  return CONIC_OK;
}

void conic_scene_destroy(conic_scene *scene) {
  if (!scene)
    return;
  conic_context *context = scene->context;
  conic_lattice_release(context, &scene->lattice);
  conic_memory_release_these(context, scene->surface, scene);
}

void *conic_scene_surface(conic_scene *scene, size_t bytes) {
  scene->surface = conic_memory_allocate_zeroed(scene->context, 1, bytes);
  return scene->surface;
}

void conic_scene_golden(uint64_t i, uint64_t n, double *u, double *v) {
  *u = ((double)i + 0.5) / (double)n;
  /* 2⁶⁴/φ and 2⁶³: the sum wraps around as turns do. */
  *v = (double)((i * UINT64_C(0x9e3779b97f4a7c15) + UINT64_C(0x8000000000000000)) >> 11) * 0x1p-53;
}

double conic_scene_equal_area_angle(double turns, double e) {
  double mean = 2.0 * CONIC_PI * turns;
  double angle = mean + e * conic_sin(mean) / (1.0 - e * conic_cos(mean));
  for (int i = 0; i < 3; i++)
    angle = angle - (angle - e * conic_sin(angle) - mean) / (1.0 - e * conic_cos(angle));
  return angle;
}

void conic_scene_blend(const uint8_t (*stops)[3], int n, double t, uint8_t color[3]) {
  double place = (t > 0.0 ? t < 1.0 ? t : 1.0 : 0.0) * (double)(n - 1);
  int i = (int)place < n - 1 ? (int)place : n - 2;
  double part = place - (double)i;
  for (int c = 0; c < 3; c++)
    color[c] = (uint8_t)((double)stops[i][c] * (1.0 - part) + (double)stops[i + 1][c] * part + 0.5);
}

/* Moves the place by jitter and noise, and stores it as splat `at` of the set. */
static void finish_splat(const conic_scene *scene, uint64_t i, const conic_scene_point *point, conic_splats *splats,
                         size_t at) {
  const conic_scene_options *options = &scene->options;
  double sigma = 1.5 * scene->spacing / (double)options->cutoff;
  double u[3], v[3], along_u = 0.0, along_v = 0.0, along_normal = 0.0;
  conic_tangent_basis(point->normal, u, v);
  if (options->jitter > 0.0) {
    double reach = options->jitter * scene->spacing;
    double radius = reach * sqrt(conic_random_uniform(options->seed, i, DIMENSION_JITTER_RADIUS));
    double angle = 2.0 * CONIC_PI * conic_random_uniform(options->seed, i, DIMENSION_JITTER_ANGLE);
    along_u = radius * conic_cos(angle);
    along_v = radius * conic_sin(angle);
  }
  if (options->noise > 0.0)
    along_normal = options->noise * scene->spacing * conic_random_gaussian(options->seed, i, DIMENSION_NOISE);
  for (int axis = 0; axis < 3; axis++) {
    double moved = u[axis] * along_u + v[axis] * along_v + point->normal[axis] * along_normal;
    splats->position[axis][at] = (float)(point->position[axis] + moved);
    splats->tangent_u[axis][at] = (float)(sigma * u[axis]);
    splats->tangent_v[axis][at] = (float)(sigma * v[axis]);
    splats->color[axis][at] = scene->decode[point->color[axis]];
  }
}

typedef struct sampling {
  const conic_scene *scene;
  conic_splats *splats;
  uint64_t first, n;
  size_t first_slab;
} sampling;

static void place_chunk(void *data, size_t i_item) {
  const sampling *work = data;
  uint64_t begin = (uint64_t)i_item * CHUNK, end = begin + CHUNK < work->n ? begin + CHUNK : work->n;
  for (uint64_t k = begin; k < end; k++) {
    conic_scene_point point;
    work->scene->kind->place(work->scene, work->first + k, &point);
    finish_splat(work->scene, work->first + k, &point, work->splats, (size_t)k);
  }
}

typedef struct slab_sampling {
  const sampling *work;
  uint64_t n_found, n_kept; /* points of the lattice so far */
} slab_sampling;

static void sample_lattice_point(void *cookie, const double start[3]) {
  slab_sampling *slab = cookie;
  const sampling *work = slab->work;
  uint64_t i = slab->n_kept;
  slab->n_kept = conic_lattice_kept(&work->scene->lattice, ++slab->n_found);
  if (slab->n_kept == i || i < work->first || i - work->first >= work->n)
    return;
  conic_scene_point point;
  work->scene->kind->project(work->scene->surface, start, &point);
  finish_splat(work->scene, i, &point, work->splats, (size_t)(i - work->first));
}

static void sample_slab(void *data, size_t i_item) {
  const sampling *work = data;
  const conic_scene *scene = work->scene;
  size_t i_slab = work->first_slab + i_item;
  uint64_t n_found = scene->lattice.found_before[i_slab];
  slab_sampling slab = {work, n_found, conic_lattice_kept(&scene->lattice, n_found)};
  scene->kind->walk(scene->surface, &scene->lattice, i_slab, sample_lattice_point, &slab);
}

/* The clip lines of splat `at`, from the values that were stored. Returns whether it has some. */
static int clip_splat(const conic_scene *scene, uint64_t i, const conic_splats *splats, size_t at, conic_clip *clip) {
  double position[3];
  conic_scene_edges edges;
  for (int axis = 0; axis < 3; axis++)
    position[axis] = (double)splats->position[axis][at];
  scene->kind->edges(scene, i, position, 1.5 * scene->spacing, &edges);
  *clip = (conic_clip){.splat = (uint32_t)at, .n_lines = (uint16_t)edges.n, .operation = (uint16_t)edges.operation};
  for (int k = 0; k < edges.n; k++) {
    double a = 0.0, b = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      a += edges.inward[k][axis] * (double)splats->tangent_u[axis][at];
      b += edges.inward[k][axis] * (double)splats->tangent_v[axis][at];
    }
    clip->lines[k][0] = (float)a;
    clip->lines[k][1] = (float)b;
    clip->lines[k][2] = (float)edges.distance[k];
  }
  return edges.n > 0;
}

static void add_clips(const sampling *work) {
  conic_splats *splats = work->splats;
  splats->n_clips = 0;
  for (uint64_t k = 0; k < work->n; k++)
    splats->n_clips +=
        (size_t)clip_splat(work->scene, work->first + k, splats, (size_t)k, &splats->clips[splats->n_clips]);
}

conic_status conic_scene_sample(conic_scene *scene, size_t first, size_t n, conic_splats *splats) {
  conic_context *context = scene->context;
  size_t count = scene->options.count;
  if (first > count || n > count - first)
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "scene: samples %zu to %zu of %zu", first, first + n, count);
  conic_status status = conic_splats_check_own(context, "scene", splats);
  if (status != CONIC_OK)
    return status;
  unsigned needed = conic_scene_fields(scene->options.type);
  if ((conic_splats_fields(splats) & needed) != needed)
    return conic_fail(context, CONIC_ERROR_ARGUMENT,
                      "scene: a set without tangent axes, colours or room for clip lines");
  splats->count = n;
  memcpy(splats->origin, scene->options.offset, sizeof splats->origin);
  sampling work = {scene, splats, first, n, 0};
  if (scene->kind->place)
    conic_parallel_for(context, n / CHUNK + (n % CHUNK != 0), place_chunk, &work);
  else if (n)
    conic_parallel_for(context, conic_lattice_slabs(&scene->lattice, first, n, &work.first_slab), sample_slab, &work);
  if (scene->kind->edges)
    add_clips(&work);
  return conic_progress(context, "sample", (double)(first + n) / (double)count);
}
