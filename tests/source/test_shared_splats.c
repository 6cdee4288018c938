/* Splats of which several processes have parts: what holds of all of them has the bits of one that has all, and each
 * process gets those that its windows may see, in their order. */
#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/splats/shares.h"
#include "raster/framing/drawing_frame.h"
#include "source/splat_exchange.h"
#include "source/upright.h"
#include "source/window_deal.h"
#include "tests/support/thread_team.h"

/* So many that samples are taken of them, some of which are strays; and windows of 40 × 30 pixels. */
enum { COUNT = 61003, COLUMNS = 5, ROWS = 4, WINDOWS = COLUMNS * ROWS, SAMPLES = 2 };

static const conic_triangles no_triangles;

typedef struct findings {
  double bounds[2][3], length, near_z;
  conic_camera camera;
  conic_up_basis basis;
  double fronts[2][3];
} findings;

typedef struct shared_case {
  conic_splats splats;
  conic_box *boxes;
  conic_window windows[WINDOWS];
  size_t n; /* of these */
  int is_in_order, margin;
  findings found; /* by one process */
  uint64_t loads[THREAD_TEAM_MOST];
} shared_case;

static double draw_one(size_t i, int dimension) {
  return conic_random_uniform(5, i, (uint64_t)dimension);
}

/* A slab, so that it lies flat. */
static void scatter_splats(conic_context *context, shared_case *c) {
  conic_splats *s = &c->splats;
  CHECK_OK(conic_splats_allocate(context, COUNT, CONIC_SPLATS_TANGENTS | CONIC_SPLATS_OPACITIES, s));
  c->boxes = calloc(COUNT, sizeof *c->boxes);
  for (int axis = 0; axis < 3; axis++)
    s->origin[axis] = 1e5 * axis;
  for (size_t i = 0; i < COUNT; i++) {
    int is_stray = i % 300 == 7;
    for (int axis = 0; axis < 3; axis++) {
      s->position[axis][i] = (float)((axis == 2 ? 0.1 : 1.0 + axis) * (draw_one(i, axis) + (is_stray ? 900.0 : 0)));
      s->tangent_u[axis][i] = axis == 0 ? (float)draw_one(i, 3) : 0.0f;
      s->tangent_v[axis][i] = axis == 1 ? (float)draw_one(i, 4) : 0.0f;
    }
    s->opacity[i] = (float)i;
    if (i % 1000 == 3)
      s->position[i % 3][i] = (float)INFINITY;
    int x = (int)(draw_one(i, 5) * 400.0), y = (int)(draw_one(i, 6) * 240.0), side = i % 5000 ? 3 : 200;
    if (i % 4) /* the others are not drawn */
      c->boxes[i] = (conic_box){(uint16_t)x, (uint16_t)(x + side), (uint16_t)y, (uint16_t)(y + side)};
  }
}

static conic_splats part_of_splats(const conic_splats *all, size_t first, size_t end) {
  conic_splats part = *all;
  part.count = end - first;
  for (int axis = 0; axis < 3; axis++) {
    part.position[axis] += first;
    part.tangent_u[axis] += first;
    part.tangent_v[axis] += first;
  }
  part.opacity += first;
  return part;
}

static findings find_together(conic_context *context, const conic_splats_shares *shares, const conic_splats *splats) {
  findings found;
  conic_framing framing;
  const conic_drawing drawing = {splats, &no_triangles};
  memset(&found, 0, sizeof found);
  conic_framing_init(&framing);
  framing.width = 200;
  framing.height = 120;
  CHECK(conic_shares_bounds(shares, splats, found.bounds[0], found.bounds[1]) == COUNT - (COUNT + 996) / 1000);
  CHECK_OK(conic_shares_length(context, shares, splats, &found.length));
  CHECK_OK(conic_drawing_frame_shared(context, shares, &drawing, 1.5f, &framing, 3, &found.camera, &found.near_z));
  CHECK_OK(conic_upright_look(context, shares, &drawing, &found.basis, found.fronts));
  return found;
}

/* --- windows --- */

static int meets_window(const shared_case *c, size_t i_window, size_t i_splat) {
  const conic_window *w = &c->windows[i_window];
  const conic_box *b = &c->boxes[i_splat];
  return b->x_begin < b->x_end && b->x_begin - c->margin < SAMPLES * w->x_end &&
         b->x_end + c->margin > SAMPLES * w->x_begin && b->y_begin - c->margin < SAMPLES * w->y_end &&
         b->y_end + c->margin > SAMPLES * w->y_begin;
}

/* Each splat that meets one of its windows, once, in their order. */
static void check_held(const shared_case *c, int index, const int *owners, const conic_splats *held,
                       const uint32_t *ids) {
  size_t next = 0, n_wrong = 0;
  for (size_t i = 0; i < COUNT; i++) {
    int is_met = 0;
    for (size_t k = 0; k < c->n && !is_met; k++)
      is_met = owners[k] == index && meets_window(c, k, i);
    if (!is_met)
      continue;
    if (next < held->count)
      n_wrong += ids[next] != i || held->opacity[next] != (float)i ||
                 held->tangent_v[1][next] != c->splats.tangent_v[1][i] || held->origin[2] != c->splats.origin[2];
    next++;
  }
  CHECK(next == held->count && n_wrong == 0);
}

static void deal_windows(conic_context *context, shared_case *c, const conic_splats_shares *shares,
                         const conic_splats *part) {
  const conic_dealing dealing = {.team = shares->team,
                                 .boxes = c->boxes + shares->first,
                                 .n_splats = part->count,
                                 .list = c->windows,
                                 .n = c->n,
                                 .samples = SAMPLES,
                                 .margin = c->margin,
                                 .is_in_order = c->is_in_order};
  int owners[WINDOWS], n_first = 0;
  size_t begin[THREAD_TEAM_MOST + 1];
  uint32_t *list, *ids;
  conic_splats held;
  CHECK_OK(conic_windows_deal(context, &dealing, owners));
  CHECK(owners[0] == 0);
  for (size_t i = 0; i < c->n; i++)
    CHECK(owners[i] >= 0 && owners[i] < shares->team->count);
  for (int i = 0; i < shares->team->count; i++)
    n_first += owners[i] == shares->team->index;
  CHECK(!c->is_in_order || n_first > 0);
  CHECK_OK(conic_windows_list_splats(context, &dealing, owners, begin, &list));
  CHECK_OK(conic_splats_exchange(context, shares, part, begin, list, &held, &ids));
  check_held(c, shares->team->index, owners, &held, ids);
  c->loads[shares->team->index] = held.count;
  conic_memory_release(context, list);
  conic_memory_release(context, ids);
  conic_splats_release(context, &held);
}

static void do_part(const conic_team *team, void *cookie) {
  shared_case *c = cookie;
  conic_context *context;
  size_t n = (size_t)team->count, first = (COUNT * (size_t)team->index + n - 1) / n,
         end = (COUNT * (size_t)(team->index + 1) + n - 1) / n;
  const conic_splats_shares shares = {team, first, COUNT};
  const conic_splats part = part_of_splats(&c->splats, first, end);
  CHECK_OK(conic_context_create(NULL, &context));
  findings found = find_together(context, &shares, &part);
  CHECK(memcmp(&found, &c->found, sizeof found) == 0);
  deal_windows(context, c, &shares, &part);
  conic_context_destroy(context);
}

/* But for every other row, as if these were kept. */
static void list_test_windows(shared_case *c, int without_rows) {
  c->n = 0;
  for (int i = 0; i < WINDOWS; i++)
    if (!without_rows || i / COLUMNS % 2)
      c->windows[c->n++] =
          (conic_window){40 * (i % COLUMNS), 40 * (i % COLUMNS) + 40, 30 * (i / COLUMNS), 30 * (i / COLUMNS) + 30};
}

int main(void) {
  static shared_case c;
  const conic_splats_shares alone = {.team = NULL};
  conic_context *context;
  CHECK_OK(conic_context_create(NULL, &context));
  scatter_splats(context, &c);
  c.found = find_together(context, &alone, &c.splats);
  CHECK(c.found.basis == CONIC_UP_FLAT);
  list_test_windows(&c, 0);
  for (int count = 1; count <= 5; count += 2) {
    uint64_t least = COUNT, most = 0;
    c.margin = count;
    c.is_in_order = count == 3;
    thread_team_run(count, do_part, &c);
    for (int i = 0; i < count; i++) {
      least = c.loads[i] < least ? c.loads[i] : least;
      most = c.loads[i] > most ? c.loads[i] : most;
    }
    CHECK(4 * most <= 5 * least);
  }
  list_test_windows(&c, 1);
  thread_team_run(3, do_part, &c);
  conic_splats_release(context, &c.splats);
  free(c.boxes);
  conic_context_destroy(context);
  return check_result();
}
