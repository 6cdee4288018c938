#include "oracle/oracle_blocks.h"

#include <stdatomic.h>

#include "core/base/real.h"
#include "oracle/oracle_weights.h"

/* A block's edge in samples, and the splats that are set up at a time unless one pixel has more: what a thread needs
 * of memory. */
enum { BLOCK = 16, MOST_CANDIDATES = 8192 };

/* A pixel that is to be judged: its place, and its number in the reference. */
typedef struct place {
  int x, y;
  uint32_t number;
} place;

/* What a thread keeps from block to block. */
typedef struct worker {
  oracle_splat *splats;
  oracle_candidate *candidates;
  oracle_exact *exacts;
  double *peaks;
  oracle_fragment *fragments;
  oracle_part *parts;
  uint32_t *order;
  size_t room, n_candidates;
  uint32_t *triangles; /* of the mesh: those that may touch the block */
  size_t n_triangles, triangle_room;
  place places[BLOCK * BLOCK];
  int n_places;
  oracle_sample samples[CONIC_MAX_SAMPLES * CONIC_MAX_SAMPLES];
  oracle_seen_triangle seen;
  oracle_rivals rivals;
  oracle_doubts doubts, kept; /* of the samples of one pixel; of the pixels */
  oracle_weighing weighing;
  size_t covered, unstable, covered_samples, unstable_samples, undecided_ids, unbounded;
  size_t by_reason[CONIC_N_UNSTABLE_REASONS];
} worker;

/* A row of blocks: what may show in it. */
typedef struct row {
  const oracle_job *job;
  worker **workers;
  int edge, top; /* of its blocks, in pixels */
  uint32_t *splats, *triangles;
  size_t n_splats, splat_room, n_triangles, triangle_room;
  size_t first_number, end_number; /* of its pixels in the reference */
  double done;                     /* a share of the rows */
  atomic_int failure;              /* a conic_status */
} row;

/* A part of the picture, in pixels. */
typedef struct area {
  int left, top, width, height;
} area;

static int touches(const float box[2][2], double left, double top, double width, double height) {
  return (double)box[0][0] <= left + width && (double)box[1][0] >= left && (double)box[0][1] <= top + height &&
         (double)box[1][1] >= top;
}

static int touches_area(const row *r, const float box[2][2], const area *a) {
  double n = r->job->samples;
  return touches(box, n * a->left, n * a->top, n * a->width, n * a->height);
}

/* Whether any of the block's pixels may show it. */
static int touches_place(const row *r, const worker *w, const float box[2][2]) {
  double n = r->job->samples;
  for (int i = 0; i < w->n_places; i++)
    if (touches(box, n * w->places[i].x, n * w->places[i].y, n, n))
      return 1;
  return 0;
}

/* A piece of a triangle has its box in 1/256 sample; one that is unsure may be a step larger. */
static void box_of_piece(const oracle_triangle *t, float box[2][2]) {
  for (int axis = 0; axis < 2; axis++) {
    box[0][axis] = (float)((t->box[0][axis] - 1.0) / 256.0 - 1.0);
    box[1][axis] = (float)((t->box[1][axis] + 1.0) / 256.0 + 1.0);
  }
}

static conic_status note_number(conic_context *context, uint32_t **list, size_t *n, size_t *room, size_t i) {
  const uint32_t number = (uint32_t)i;
  return conic_memory_append(context, list, n, room, &number, sizeof number);
}

static conic_status find_in_row(row *r) {
  const oracle_job *job = r->job;
  const area whole = {0, r->top, job->reference->width, r->edge};
  conic_status status = CONIC_OK;
  r->n_splats = r->n_triangles = 0;
  for (size_t i = 0; i < job->scene->splats->count && status == CONIC_OK; i++)
    if (touches_area(r, (const float(*)[2])job->scene->reaches[i].box, &whole))
      status = note_number(job->context, &r->splats, &r->n_splats, &r->splat_room, i);
  for (size_t i = 0; i < job->mesh->n && status == CONIC_OK; i++) {
    float box[2][2];
    box_of_piece(&job->mesh->pieces[i], box);
    if (touches_area(r, (const float(*)[2])box, &whole))
      status = note_number(job->context, &r->triangles, &r->n_triangles, &r->triangle_room, i);
  }
  return status;
}

static uint32_t picture_pixel(const conic_reference *r, size_t number) {
  return r->pixels ? r->pixels[number] : (uint32_t)number;
}

/* The pixels of the area that are to be judged. */
static void list_places(const row *r, worker *w, const area *a) {
  const conic_reference *reference = r->job->reference;
  w->n_places = 0;
  if (!reference->pixels) {
    for (int y = a->top; y < a->top + a->height; y++)
      for (int x = a->left; x < a->left + a->width; x++)
        w->places[w->n_places++] = (place){x, y, (uint32_t)y * (uint32_t)reference->width + (uint32_t)x};
    return;
  }
  for (size_t i = r->first_number; i < r->end_number; i++) {
    int x = (int)(reference->pixels[i] % (uint32_t)reference->width);
    int y = (int)(reference->pixels[i] / (uint32_t)reference->width);
    if (x >= a->left && x < a->left + a->width && y >= a->top && y < a->top + a->height)
      w->places[w->n_places++] = (place){x, y, (uint32_t)i};
  }
}

static void release_room(conic_context *context, worker *w) {
  conic_memory_release_these(context, w->splats, w->candidates, w->exacts, w->peaks, w->fragments, w->parts, w->order);
}

static int make_block_room(const oracle_job *j, worker *w, size_t n) {
  size_t n_exact = j->reference->question == CONIC_ORACLE_EXACT ? n + n / 2 : 0;
  if (w->fragments && n <= w->room)
    return 1;
  release_room(j->context, w);
  w->room = n + n / 2;
  const size_t n_fragments = w->room + 1; /* one is a triangle's */
  if (conic_memory_allocate_these(j->context, CONIC_ROOM(w->splats, w->room), CONIC_ROOM(w->candidates, w->room),
                                  CONIC_ROOM(w->exacts, n_exact), CONIC_ROOM(w->peaks, n_exact),
                                  CONIC_ROOM(w->fragments, n_fragments), CONIC_ROOM(w->parts, n_fragments),
                                  CONIC_ROOM(w->order, n_fragments)) == CONIC_OK)
    return 1;
  w->room = 0;
  return 0;
}

static int may_show(const row *r, const worker *w, size_t i, const area *a) {
  const float(*box)[2] = (const float(*)[2])r->job->scene->reaches[i].box;
  return touches_area(r, box, a) && (!r->job->reference->pixels || touches_place(r, w, box));
}

static size_t count_candidates(const row *r, const worker *w, const area *a) {
  size_t n = 0;
  for (size_t i = 0; i < r->n_splats; i++)
    n += (size_t)may_show(r, w, r->splats[i], a);
  return n;
}

/* Sets up every splat that may show in the area, n of them at most; 0 without memory. */
static int set_up_splats(const row *r, worker *w, const area *a, size_t n) {
  const oracle_scene *scene = r->job->scene;
  w->n_candidates = 0;
  if (!make_block_room(r->job, w, n))
    return 0;
  for (size_t i = 0; i < r->n_splats; i++) {
    size_t at = w->n_candidates;
    oracle_candidate *candidate = &w->candidates[at];
    if (!may_show(r, w, r->splats[i], a) || !conic_oracle_scene_place(scene, r->splats[i], &w->splats[at]))
      continue;
    conic_oracle_candidate(&scene->view, &w->splats[at], candidate);
    if (r->job->reference->question == CONIC_ORACLE_EXACT) {
      conic_oracle_exact(&scene->view, &w->splats[at].placed, &w->exacts[at]);
      w->peaks[at] = conic_oracle_peak(&scene->view, candidate, &w->exacts[at]);
    }
    w->n_candidates++;
  }
  return 1;
}

/* The triangles that may touch the area; 0 without memory. */
static int find_triangles(const row *r, worker *w, const area *a) {
  conic_status status = CONIC_OK;
  w->n_triangles = 0;
  for (size_t i = 0; i < r->n_triangles && status == CONIC_OK; i++) {
    float box[2][2];
    box_of_piece(&r->job->mesh->pieces[r->triangles[i]], box);
    if (touches_area(r, (const float(*)[2])box, a))
      status = note_number(r->job->context, &w->triangles, &w->n_triangles, &w->triangle_room, r->triangles[i]);
  }
  return status == CONIC_OK;
}

/* Gives the visible fragments their exact weights in place of the method's. */
static void weigh_exactly(const oracle_job *j, worker *w, double x, double y, size_t n_fragments) {
  for (size_t i = 0; i < n_fragments; i++) {
    oracle_fragment *f = &w->fragments[i];
    size_t which = (size_t)(f->candidate - w->candidates);
    if (f->is_visible && f->candidate != &w->seen.candidate)
      conic_oracle_weigh(&j->scene->view, &w->exacts[which], w->peaks[which], x, y, &w->weighing, f);
  }
}

static void keep_pixel(const oracle_pixel *pixel, oracle_sample *sample) {
  memcpy(sample->values + ORACLE_AT_NORMAL, pixel->normal, sizeof pixel->normal);
  memcpy(sample->values + ORACLE_AT_ALBEDO, pixel->albedo, sizeof pixel->albedo);
  sample->values[ORACLE_AT_Z] = pixel->z;
  sample->values[ORACLE_AT_WEIGHT] = pixel->weight;
  sample->values[ORACLE_AT_COUNT] = (double)pixel->count;
  sample->id = pixel->id;
  sample->doubt |= pixel->doubt;
}

/* What may be as near as the one that the id names. */
static conic_status admit_rivals(worker *w, size_t n, const oracle_sample *sample, uint32_t number) {
  const oracle_fragment *nearest = NULL;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n; i++)
    if (w->fragments[i].is_visible && w->fragments[i].candidate->splat->index == sample->id)
      nearest = &w->fragments[i];
  for (size_t i = 0; i < n && nearest && status == CONIC_OK; i++)
    if (w->fragments[i].is_visible && conic_oracle_is_rival(&w->fragments[i], nearest))
      status = conic_oracle_doubts_admit(&w->doubts, sample->first_id, number, w->fragments[i].candidate->splat->index);
  return status;
}

/* The alternatives of a sample in doubt. */
static conic_status bound_sample(const oracle_job *j, worker *w, int column, int row_number, uint32_t number, size_t n,
                                 oracle_sample *sample) {
  const oracle_bounding room = {&j->scene->view.camera, j->options, w->parts, w->order};
  if (w->n_triangles)
    conic_oracle_mesh_rivals(j->mesh, &j->scene->view, w->triangles, w->n_triangles, column, row_number, &w->rivals);
  return conic_oracle_bound(&room, column + 0.5, row_number + 0.5, number, w->fragments, n,
                            w->n_triangles ? &w->rivals : NULL, &w->doubts, &sample->is_unbounded);
}

static conic_status do_sample(const oracle_job *j, worker *w, int column, int row_number, uint32_t number,
                              oracle_sample *sample) {
  double x = column + 0.5, y = row_number + 0.5;
  size_t n = 0, n_splats;
  int is_covered = 0, is_exact = j->reference->question == CONIC_ORACLE_EXACT;
  oracle_pixel pixel = {.id = CONIC_NO_ID};
  conic_status status = CONIC_OK;
  memset(sample, 0, sizeof *sample);
  sample->first_alternative = w->doubts.n;
  sample->first_id = w->doubts.n_ids;
  for (size_t i = 0; i < w->n_candidates; i++)
    if (conic_oracle_fragment(&j->scene->view, &w->candidates[i], x, y, &w->fragments[n])) {
      is_covered |= w->fragments[n].covers;
      n++;
    }
  n_splats = n;
  if (w->n_triangles && conic_oracle_mesh_at(j->mesh, &j->scene->view, w->triangles, w->n_triangles, column, row_number,
                                             &w->seen, &w->fragments[n], &sample->doubt)) {
    is_covered = 1;
    n++;
  }
  sample->doubt |= conic_oracle_see(w->fragments, n);
  if (is_covered) {
    if (is_exact)
      weigh_exactly(j, w, x, y, n);
    conic_oracle_blend(w->fragments, n, j->options->passes, is_exact, &pixel);
    conic_oracle_shade(&j->scene->view.camera, j->options, x, y, &pixel, sample->values + ORACLE_AT_RGBA);
  } else
    conic_oracle_background(j->options, sample->values + ORACLE_AT_RGBA);
  keep_pixel(&pixel, sample);
  if (sample->doubt && !is_exact)
    status = bound_sample(j, w, column, row_number, number, n_splats, sample);
  else if (pixel.has_rivals)
    status = admit_rivals(w, n, sample, number);
  sample->n_alternatives = w->doubts.n - sample->first_alternative;
  sample->n_ids = w->doubts.n_ids - sample->first_id;
  w->covered_samples += (size_t)is_covered;
  w->unstable_samples += sample->doubt != 0;
  for (int i = 0; i < CONIC_N_UNSTABLE_REASONS; i++)
    w->by_reason[i] += sample->doubt >> i & 1;
  return status;
}

static void store_pixel(const oracle_job *j, worker *w, const oracle_sample *pixel, size_t number) {
  for (int plane = 0, at = 0; plane <= CONIC_PLANE_COUNT; plane++) {
    int n_channels = conic_plane_describe((conic_plane)plane)->n_channels;
    memcpy(j->reference->planes[plane] + number * (size_t)n_channels, pixel->values + at,
           (size_t)n_channels * sizeof(double));
    at += n_channels;
  }
  j->reference->planes[CONIC_PLANE_ID][number] = (double)pixel->id;
  j->reference->unstable[number] = (uint8_t)pixel->doubt;
  w->covered += pixel->values[ORACLE_AT_COUNT] > 0.0;
  w->unstable += pixel->doubt != 0;
  w->unbounded += (size_t)pixel->is_unbounded;
  w->undecided_ids += pixel->n_ids && w->kept.ids[pixel->first_id].id == CONIC_ANY_ID;
}

static conic_status do_pixel(const oracle_job *j, worker *w, const place *at) {
  conic_status status = CONIC_OK;
  oracle_sample pixel;
  w->doubts.n = w->doubts.n_ids = 0;
  for (int i = 0; i < j->samples * j->samples && status == CONIC_OK; i++)
    status = do_sample(j, w, at->x * j->samples + i % j->samples, at->y * j->samples + i / j->samples, (uint32_t)i,
                       &w->samples[i]);
  if (status == CONIC_OK)
    status = conic_oracle_reduce(w->samples, j->samples, &w->doubts, at->number, &w->kept, &pixel);
  if (status == CONIC_OK)
    store_pixel(j, w, &pixel, at->number);
  return status;
}

/* A pixel may take milliseconds, so that each is reported: by the thread that may, which is the first. */
static void report_pixel(row *r) {
  if (conic_progress(r->job->context, "verify", r->done) != CONIC_OK)
    atomic_store(&r->failure, CONIC_ERROR_CANCELLED);
}

/* Does the area whole, or, where too many splats show in it, its quarters. */
static void do_area(row *r, worker *w, int i_thread, const area *a) {
  const oracle_job *j = r->job;
  list_places(r, w, a);
  if (!w->n_places || atomic_load(&r->failure) != CONIC_OK)
    return;
  size_t n = count_candidates(r, w, a);
  if (n > MOST_CANDIDATES && a->width * a->height > 1) {
    int half = (a->width + 1) / 2, upper = (a->height + 1) / 2;
    for (int i = 0; i < 4; i++) {
      const area part = {a->left + i % 2 * half, a->top + i / 2 * upper, i % 2 ? a->width - half : half,
                         i / 2 ? a->height - upper : upper};
      if (part.width > 0 && part.height > 0)
        do_area(r, w, i_thread, &part);
    }
    return;
  }
  if (!set_up_splats(r, w, a, n) || !find_triangles(r, w, a)) {
    atomic_store(&r->failure, CONIC_ERROR_MEMORY);
    return;
  }
  for (int i = 0; i < w->n_places && atomic_load(&r->failure) == CONIC_OK; i++) {
    if (i_thread == 0)
      report_pixel(r);
    conic_status status = do_pixel(j, w, &w->places[i]);
    if (status != CONIC_OK)
      atomic_store(&r->failure, (int)status);
  }
}

static void do_block(void *data, size_t i_item, int i_thread) {
  row *r = data;
  const conic_reference *reference = r->job->reference;
  int left = (int)i_item * r->edge;
  const area block = {left, r->top, conic_least(r->edge, reference->width - left),
                      conic_least(r->edge, reference->height - r->top)};
  do_area(r, r->workers[i_thread], i_thread, &block);
}

static conic_status do_row(row *r) {
  const conic_reference *reference = r->job->reference;
  size_t end = (size_t)conic_least(r->top + r->edge, reference->height) * (size_t)reference->width;
  r->first_number = r->end_number;
  while (r->end_number < reference->n_pixels && picture_pixel(reference, r->end_number) < end)
    r->end_number++;
  if (r->first_number == r->end_number)
    return CONIC_OK;
  conic_status status = find_in_row(r);
  if (status == CONIC_OK)
    conic_parallel_for(r->job->context, ((size_t)reference->width + (size_t)r->edge - 1) / (size_t)r->edge, do_block,
                       r);
  return status == CONIC_OK ? (conic_status)atomic_load(&r->failure) : status;
}

CONIC_DEFINE_ORDER_BY_TWO(by_pixel, conic_alternative, pixel, number)
CONIC_DEFINE_ORDER_BY_TWO(by_pixel_and_id, conic_admissible_id, pixel, id)

/* Puts what the threads have noted of pixels in doubt into the order of the pixels, whoever did which. */
static conic_status gather_doubts(const oracle_job *j, worker *const *workers, int n_threads) {
  conic_reference *r = j->reference;
  for (int t = 0; t < n_threads; t++) {
    r->n_alternatives += workers[t]->kept.n;
    r->n_ids += workers[t]->kept.n_ids;
  }
  if (conic_memory_allocate_these(j->context, CONIC_ROOM(r->alternatives, r->n_alternatives),
                                  CONIC_ROOM(r->ids, r->n_ids)) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  size_t n = 0, n_ids = 0;
  for (int t = 0; t < n_threads; t++) {
    const oracle_doubts *kept = &workers[t]->kept;
    for (size_t i = 0; i < kept->n; i++) { /* a pixel's stand together */
      int is_next = i && kept->alternatives[i].pixel == kept->alternatives[i - 1].pixel;
      r->alternatives[n] = kept->alternatives[i];
      r->alternatives[n].number = is_next ? r->alternatives[n - 1].number + 1 : 0;
      n++;
    }
    for (size_t i = 0; i < kept->n_ids; i++)
      r->ids[n_ids++] = kept->ids[i];
  }
  qsort(r->alternatives, n, sizeof *r->alternatives, by_pixel);
  qsort(r->ids, n_ids, sizeof *r->ids, by_pixel_and_id);
  return CONIC_OK;
}

/* What the threads have counted, put together. */
static void gather_counts(const oracle_job *j, worker *const *workers, int n_threads) {
  conic_reference *r = j->reference;
  oracle_weighing *first = &workers[0]->weighing;
  r->samples = j->samples;
  for (int t = 0; t < n_threads; t++) {
    const worker *w = workers[t];
    r->covered_pixels += w->covered;
    r->unstable_pixels += w->unstable;
    r->covered_samples += w->covered_samples;
    r->unstable_samples += w->unstable_samples;
    r->undecided_ids += w->undecided_ids;
    r->unbounded_pixels += w->unbounded;
    for (int i = 0; i < CONIC_N_UNSTABLE_REASONS; i++)
      r->unstable_by_reason[i] += w->by_reason[i];
    if (t)
      conic_oracle_add_weights(first, &w->weighing);
  }
  r->weight_error = conic_oracle_weight_error(first);
}

static conic_status make_workers(const oracle_job *j, int n_threads, worker ***workers) {
  *workers = conic_memory_allocate_zeroed(j->context, (size_t)n_threads, sizeof **workers);
  for (int t = 0; t < n_threads && *workers; t++) {
    worker *w = (*workers)[t] = conic_memory_allocate_zeroed(j->context, 1, sizeof *w);
    if (!w)
      return CONIC_ERROR_MEMORY;
    w->doubts.context = w->kept.context = j->context;
  }
  return *workers ? CONIC_OK : CONIC_ERROR_MEMORY;
}

static void release_workers(conic_context *context, int n_threads, worker **workers) {
  for (int t = 0; t < n_threads && workers && workers[t]; t++) {
    release_room(context, workers[t]);
    conic_memory_release(context, workers[t]->triangles);
    conic_oracle_doubts_release(&workers[t]->doubts);
    conic_oracle_doubts_release(&workers[t]->kept);
    conic_memory_release(context, workers[t]);
  }
  conic_memory_release(context, workers);
}

conic_status conic_oracle_work(const oracle_job *job) {
  int n_threads = conic_context_threads(job->context), height = job->reference->height;
  row r = {.job = job, .edge = job->samples < BLOCK ? BLOCK / job->samples : 1};
  conic_status status = make_workers(job, n_threads, &r.workers);
  for (; r.top < height && status == CONIC_OK; r.top += r.edge) {
    r.done = 0.05 + 0.95 * (double)r.top / (double)height;
    status = conic_progress(job->context, "verify", r.done);
    if (status == CONIC_OK)
      status = do_row(&r);
  }
  if (status == CONIC_OK)
    status = gather_doubts(job, r.workers, n_threads);
  if (status == CONIC_OK) {
    gather_counts(job, r.workers, n_threads);
    status = conic_progress(job->context, "verify", 1.0);
  }
  release_workers(job->context, n_threads, r.workers);
  conic_memory_release_these(job->context, r.splats, r.triangles);
  return status;
}
