/* The oracle: every pixel of a picture, by brute force, in double precision. */
#include "conic/oracle.h"

#include <stdatomic.h>
#include <string.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/base/threads.h"
#include "core/image/view_arguments.h"
#include "core/splats/columns.h"
#include "oracle/oracle_exact.h"
#include "oracle/oracle_pixel.h"
#include "oracle/oracle_triangle.h"

enum { BLOCK = 16, N_BINS = 1024 };

/* Errors of weights by size: sixteen bins to the octave. */
typedef struct histogram {
  size_t bins[N_BINS];
  double greatest;
} histogram;

/* What a thread keeps from block to block. */
typedef struct worker {
  oracle_candidate *candidates;
  oracle_exact *exacts;
  double *peaks;
  oracle_fragment *fragments;
  size_t room;
  uint32_t *triangles; /* of the mesh: those that may touch the block */
  size_t n_triangles;
  oracle_seen_triangle seen;
  histogram absolute, of_peak;
  double quadrature;
  size_t n_weights, covered, unstable, undecided_ids, by_reason[CONIC_N_UNSTABLE_REASONS];
} worker;

typedef struct job {
  conic_context *context;
  const conic_render_options *options;
  oracle_scene scene;
  oracle_mesh mesh;
  conic_reference *reference;
  worker *workers;
  size_t blocks_across, first_block;
  atomic_int failure; /* a conic_status */
} job;

const char *conic_oracle_question_name(conic_oracle_question question) {
  static const char *const names[] = {"method", "exact"};
  return (unsigned)question < 2 ? names[question] : NULL;
}

const char *conic_unstable_reason_name(conic_unstable_reason reason) {
  static const char *const names[CONIC_N_UNSTABLE_REASONS] = {"cutoff", "clip",       "visibility", "formula",
                                                              "facing", "weight_tie", "depth_tie",  "precision"};
  return (unsigned)reason < CONIC_N_UNSTABLE_REASONS ? names[reason] : NULL;
}

static void count_error(histogram *h, double error) {
  uint64_t bits;
  double scaled = error * 0x1p-960; /* so that 2⁻⁶³ is the least that has a bin of its own */
  memcpy(&bits, &scaled, sizeof bits);
  size_t bin = error > 0x1p-62 ? (size_t)(bits >> 48) : 0;
  h->bins[bin < N_BINS ? bin : N_BINS - 1]++;
  h->greatest = oracle_max(h->greatest, error);
}

/* The upper end of the bin that the percentile falls into. */
static double percentile(const histogram *h, double share) {
  size_t total = 0, sum = 0;
  for (int i = 0; i < N_BINS; i++)
    total += h->bins[i];
  for (int i = 0; i < N_BINS; i++) {
    sum += h->bins[i];
    if ((double)sum >= share * (double)total) {
      uint64_t bits = (uint64_t)(i + 1) << 48;
      double value;
      memcpy(&value, &bits, sizeof value);
      return i ? oracle_min(value * 0x1p960, h->greatest) : 0.0;
    }
  }
  return 0.0;
}

static int touches(const oracle_splat *splat, double x, double y) {
  return splat->box[0][0] <= x + BLOCK && splat->box[1][0] >= x && splat->box[0][1] <= y + BLOCK &&
         splat->box[1][1] >= y;
}

static void release_room(conic_context *context, worker *w) {
  conic_memory_release(context, w->candidates);
  conic_memory_release(context, w->exacts);
  conic_memory_release(context, w->peaks);
  conic_memory_release(context, w->fragments);
}

static int make_room_for_block(const job *j, worker *w, size_t n) {
  if (w->fragments && n <= w->room)
    return 1;
  release_room(j->context, w);
  w->room = n + n / 2;
  w->candidates = conic_memory_allocate(j->context, w->room, sizeof *w->candidates);
  w->exacts = conic_memory_allocate(j->context, w->room, sizeof *w->exacts);
  w->peaks = conic_memory_allocate(j->context, w->room, sizeof *w->peaks);
  w->fragments = conic_memory_allocate(j->context, w->room + 1, sizeof *w->fragments); /* and a triangle's */
  if (w->candidates && w->exacts && w->peaks && w->fragments)
    return 1;
  w->room = 0;
  return 0;
}

/* The splat's amplitude at its centre; 0 where it has none. */
static double peak_of(const oracle_view *view, const oracle_candidate *candidate, const oracle_exact *exact) {
  double values[ORACLE_N_VALUES];
  if (!candidate->is_drawn)
    return 0.0;
  if (candidate->shape.formula != ORACLE_RAY && candidate->shape.formula != ORACLE_LAPLACE)
    return candidate->shape.amplitude;
  if (!exact->is_center_in_front)
    return 0.0;
  conic_oracle_evaluate(view, &candidate->shape, exact->center_px[0], exact->center_px[1], values);
  return values[ORACLE_WEIGHT];
}

/* Sets up every splat that may touch the block; -1 without memory. */
static ptrdiff_t find_candidates(const job *j, worker *w, double x, double y) {
  const oracle_scene *scene = &j->scene;
  size_t n = 0;
  for (size_t i = 0; i < scene->n; i++)
    n += (size_t)touches(&scene->splats[i], x, y);
  if (!make_room_for_block(j, w, n))
    return -1;
  n = 0;
  for (size_t i = 0; i < scene->n; i++) {
    if (!touches(&scene->splats[i], x, y))
      continue;
    conic_oracle_candidate(&scene->view, &scene->splats[i], &w->candidates[n]);
    if (j->reference->question == CONIC_ORACLE_EXACT) {
      conic_oracle_exact(&scene->view, &scene->splats[i].placed, &w->exacts[n]);
      w->peaks[n] = peak_of(&scene->view, &w->candidates[n], &w->exacts[n]);
    }
    n++;
  }
  return (ptrdiff_t)n;
}

/* The triangles that may touch the block; 0 without memory. */
static int find_triangles(const job *j, worker *w, double x, double y) {
  w->n_triangles = 0;
  if (j->mesh.n && !w->triangles)
    w->triangles = conic_memory_allocate(j->context, j->mesh.n, sizeof *w->triangles);
  if (j->mesh.n && !w->triangles)
    return 0;
  for (size_t i = 0; i < j->mesh.n; i++) {
    const double(*box)[2] = (const double(*)[2])j->mesh.pieces[i].box;
    if (box[0][0] <= 256.0 * (x + BLOCK) && box[1][0] >= 256.0 * x && box[0][1] <= 256.0 * (y + BLOCK) &&
        box[1][1] >= 256.0 * y)
      w->triangles[w->n_triangles++] = (uint32_t)i;
  }
  return 1;
}

/* Replaces the method's weights of what is visible by the exact ones. */
static void weigh_exactly(const job *j, worker *w, double x, double y, size_t n_fragments) {
  for (size_t i = 0; i < n_fragments; i++) {
    oracle_fragment *f = &w->fragments[i];
    size_t which = (size_t)(f->candidate - w->candidates);
    double change, weight, error;
    if (!f->is_visible || f->candidate == &w->seen.candidate)
      continue;
    weight = conic_oracle_exact_weight(&j->scene.view, &w->exacts[which], x, y, &change);
    error = fabs(f->values[ORACLE_WEIGHT] - weight);
    count_error(&w->absolute, error);
    if (w->peaks[which] > 0.0)
      count_error(&w->of_peak, error / w->peaks[which]);
    w->quadrature = oracle_max(w->quadrature, change);
    w->n_weights++;
    f->weight = oracle_max(weight * f->candidate->splat->opacity, 0x1p-60);
  }
}

static void store_pixel(const job *j, size_t at, const oracle_pixel *pixel, const double rgba[4]) {
  double *const *planes = j->reference->planes;
  memcpy(planes[CONIC_PLANE_RGBA] + 4 * at, rgba, 4 * sizeof *rgba);
  memcpy(planes[CONIC_PLANE_NORMAL] + 3 * at, pixel->normal, sizeof pixel->normal);
  memcpy(planes[CONIC_PLANE_ALBEDO] + 3 * at, pixel->albedo, sizeof pixel->albedo);
  planes[CONIC_PLANE_Z][at] = pixel->z;
  planes[CONIC_PLANE_WEIGHT][at] = pixel->weight;
  planes[CONIC_PLANE_COUNT][at] = (double)pixel->count;
  planes[CONIC_PLANE_ID][at] = (double)pixel->id;
}

static void do_pixel(const job *j, worker *w, int column, int row, size_t n_candidates) {
  static const oracle_pixel nothing = {.id = CONIC_NO_ID, .tied_id = CONIC_NO_ID};
  double x = column + 0.5, y = row + 0.5, rgba[4];
  size_t n = 0, at = (size_t)row * (size_t)j->reference->width + (size_t)column;
  int is_covered = 0;
  for (size_t i = 0; i < n_candidates; i++)
    if (conic_oracle_fragment(&j->scene.view, &w->candidates[i], x, y, &w->fragments[n])) {
      is_covered |= w->fragments[n].covers;
      n++;
    }
  if (w->n_triangles && conic_oracle_mesh_at(&j->mesh, &j->scene.view, w->triangles, w->n_triangles, column, row,
                                             &w->seen, &w->fragments[n])) {
    is_covered = 1;
    n++;
  }
  oracle_pixel pixel = nothing;
  unsigned doubt = conic_oracle_see(w->fragments, n);
  int is_exact = j->reference->question == CONIC_ORACLE_EXACT;
  if (is_covered) {
    if (is_exact)
      weigh_exactly(j, w, x, y, n);
    conic_oracle_blend(w->fragments, n, j->options->passes, is_exact, &pixel);
    conic_oracle_shade(&j->scene.view.camera, j->options, x, y, &pixel, rgba);
  } else
    conic_oracle_background(j->options, rgba);
  doubt |= pixel.doubt;
  store_pixel(j, at, &pixel, rgba);
  j->reference->unstable[at] = (uint8_t)doubt;
  j->reference->tied_id[at] = pixel.tied_id;
  w->covered += (size_t)is_covered;
  w->unstable += doubt != 0;
  w->undecided_ids += pixel.tied_id == CONIC_ANY_ID;
  for (int i = 0; i < CONIC_N_UNSTABLE_REASONS; i++)
    w->by_reason[i] += doubt >> i & 1;
}

/* A pixel may take milliseconds, so that each is reported: by the thread that may, which is the first. */
static void report_pixel(job *j, size_t block) {
  size_t n_blocks = j->blocks_across * (((size_t)j->reference->height + BLOCK - 1) / BLOCK);
  if (conic_progress(j->context, "verify", (double)block / (double)n_blocks) != CONIC_OK)
    atomic_store(&j->failure, CONIC_ERROR_CANCELLED);
}

static void do_block(void *data, size_t i_item, int i_thread) {
  job *j = data;
  worker *w = &j->workers[i_thread];
  size_t block = j->first_block + i_item;
  int left = (int)(block % j->blocks_across) * BLOCK, top = (int)(block / j->blocks_across) * BLOCK;
  if (atomic_load(&j->failure) != CONIC_OK)
    return;
  ptrdiff_t n = find_candidates(j, w, (double)left, (double)top);
  if (n < 0 || !find_triangles(j, w, (double)left, (double)top)) {
    atomic_store(&j->failure, CONIC_ERROR_MEMORY);
    return;
  }
  for (int y = top; y < top + BLOCK && y < j->reference->height; y++)
    for (int x = left; x < left + BLOCK && x < j->reference->width; x++) {
      if (i_thread == 0)
        report_pixel(j, block);
      if (atomic_load(&j->failure) != CONIC_OK)
        return;
      do_pixel(j, w, x, y, (size_t)n);
    }
}

static void add_histogram(histogram *to, const histogram *from) {
  for (int i = 0; i < N_BINS; i++)
    to->bins[i] += from->bins[i];
  to->greatest = oracle_max(to->greatest, from->greatest);
}

/* What the threads have counted, put together. */
static void gather_workers(job *j, int n_threads) {
  conic_reference *r = j->reference;
  worker *sum = &j->workers[0];
  for (int t = 0; t < n_threads; t++) {
    const worker *w = &j->workers[t];
    r->covered_pixels += w->covered;
    r->unstable_pixels += w->unstable;
    r->undecided_ids += w->undecided_ids;
    for (int i = 0; i < CONIC_N_UNSTABLE_REASONS; i++)
      r->unstable_by_reason[i] += w->by_reason[i];
    r->weight_error.n_weights += w->n_weights;
    r->weight_error.quadrature = oracle_max(r->weight_error.quadrature, w->quadrature);
    if (t) {
      add_histogram(&sum->absolute, &w->absolute);
      add_histogram(&sum->of_peak, &w->of_peak);
    }
  }
  r->weight_error.max_abs = sum->absolute.greatest;
  r->weight_error.p999 = percentile(&sum->absolute, 0.999);
  r->weight_error.max_of_peak = sum->of_peak.greatest;
  r->weight_error.p999_of_peak = percentile(&sum->of_peak, 0.999);
}

static conic_status compute(job *j) {
  int n_threads = conic_context_threads(j->context);
  size_t blocks_down = ((size_t)j->reference->height + BLOCK - 1) / BLOCK;
  j->blocks_across = ((size_t)j->reference->width + BLOCK - 1) / BLOCK;
  j->workers = conic_memory_allocate_zeroed(j->context, (size_t)n_threads, sizeof *j->workers);
  conic_status status = j->workers ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t row = 0; row < blocks_down && status == CONIC_OK; row++) {
    j->first_block = row * j->blocks_across;
    conic_parallel_for(j->context, j->blocks_across, do_block, j);
    status = (conic_status)atomic_load(&j->failure);
    if (status == CONIC_OK)
      status = conic_progress(j->context, "verify", (double)(row + 1) / (double)blocks_down);
  }
  if (status == CONIC_OK)
    gather_workers(j, n_threads);
  j->reference->samples = 1;
  j->reference->covered_samples = j->reference->covered_pixels;
  j->reference->unstable_samples = j->reference->unstable_pixels;
  for (int t = 0; t < n_threads && j->workers; t++) {
    release_room(j->context, &j->workers[t]);
    conic_memory_release(j->context, j->workers[t].triangles);
  }
  conic_memory_release(j->context, j->workers);
  return status;
}

conic_status conic_oracle_allocate(conic_context *context, conic_reference *r) {
  size_t n = (size_t)r->width * (size_t)r->height;
  for (int i = 0; i < CONIC_N_PLANES; i++) {
    size_t n_channels = (size_t)conic_plane_describe((conic_plane)i)->n_channels;
    r->planes[i] = conic_memory_allocate_zeroed(context, n * n_channels, sizeof(double));
    if (!r->planes[i])
      return CONIC_ERROR_MEMORY;
  }
  r->unstable = conic_memory_allocate_zeroed(context, n, sizeof *r->unstable);
  r->tied_id = conic_memory_allocate_zeroed(context, n, sizeof *r->tied_id);
  return r->unstable && r->tied_id ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static conic_status check(conic_context *context, const conic_splats *splats, conic_oracle_question question) {
  if (splats->count && (!splats->tangent_u[0] || !splats->tangent_v[0]))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "the splats have no tangent axes");
  if (!conic_oracle_question_name(question))
    return conic_fail(context, CONIC_ERROR_ARGUMENT, "no question to the oracle has the number %d", (int)question);
  return CONIC_OK;
}

/* The picture of what was checked; near_z is found where it is 0. */
static conic_status answer_drawing(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                                   conic_render_options *settled, conic_oracle_question question,
                                   conic_reference *reference) {
  if (!(settled->near_z > 0.0) && drawing->triangles)
    settled->near_z = conic_drawing_near(drawing);
  job j = {.context = context, .options = settled, .reference = reference};
  reference->width = camera->width;
  reference->height = camera->height;
  reference->question = question;
  reference->white = conic_oracle_exp(settled->exposure * 0.69314718055994530942);
  conic_status status = conic_oracle_allocate(context, reference);
  if (status == CONIC_OK)
    status = conic_oracle_scene_create(context, drawing->splats, camera, settled, &j.scene);
  if (status == CONIC_OK) {
    status = conic_oracle_mesh_create(context, drawing, &j.scene, settled, &j.mesh);
    if (status == CONIC_OK)
      status = compute(&j);
    conic_oracle_mesh_release(context, &j.mesh);
    conic_oracle_scene_release(context, &j.scene);
  }
  if (status != CONIC_OK)
    conic_reference_release(context, reference);
  return status;
}

conic_status conic_oracle_draw(conic_context *context, const conic_drawing *drawing, const conic_camera *camera,
                               const conic_render_options *options, conic_oracle_question question,
                               conic_reference *reference) {
  conic_entered_drawing entered;
  const conic_drawing whole = {&entered.splats, drawing->triangles ? &entered.triangles : NULL};
  conic_render_options settled;
  memset(reference, 0, sizeof *reference);
  conic_status status = conic_view_arguments_take(context, "the oracle", camera, options, &settled);
  if (status != CONIC_OK)
    return status;
  status = conic_drawing_enter(context, "the oracle", drawing, &entered);
  if (status == CONIC_OK)
    status = check(context, &entered.splats, question);
  if (status == CONIC_OK)
    status = answer_drawing(context, &whole, camera, &settled, question, reference);
  conic_drawing_leave(context, &entered);
  return status;
}

conic_status conic_oracle_render(conic_context *context, const conic_splats *splats, const conic_camera *camera,
                                 const conic_render_options *options, conic_oracle_question question,
                                 conic_reference *reference) {
  const conic_drawing alone = {.splats = splats};
  memset(reference, 0, sizeof *reference);
  return splats ? conic_oracle_draw(context, &alone, camera, options, question, reference)
                : conic_fail(context, CONIC_ERROR_ARGUMENT, "the oracle needs splats");
}

void conic_reference_release(conic_context *context, conic_reference *reference) {
  for (int i = 0; i < CONIC_N_PLANES; i++)
    conic_memory_release(context, reference->planes[i]);
  conic_memory_release(context, reference->unstable);
  conic_memory_release(context, reference->tied_id);
  memset(reference, 0, sizeof *reference);
}
