/* Loops that a team shares: all have all values, whoever made them, wherever they stand; and whoever leaves is missed
 * at the next. */
#include "core/base/team_runs.h"
#include "tests/support/thread_team.h"

enum { ITEMS = 1003, AN_ITEM = 5, VALUES = ITEMS * AN_ITEM - 2, LAST = 7 };

typedef struct loops {
  int n_made; /* by this process */
  uint32_t places[VALUES];
  uint32_t plain[VALUES], moved[VALUES];
  double by_item[ITEMS];
  uint8_t uneven[ITEMS * LAST];
} loops;

static size_t first_uneven(const void *data, size_t i_item) {
  (void)data; /* items of 0 to LAST - 1 values */
  return i_item / LAST * (LAST * (LAST - 1) / 2) + i_item % LAST * (i_item % LAST - (i_item % LAST > 0)) / 2;
}

static void make_values(void *data, size_t i_item) {
  loops *l = data;
  l->n_made++;
  l->by_item[i_item] = 0.5 * (double)i_item;
  for (size_t i = i_item * AN_ITEM; i < (i_item + 1) * AN_ITEM && i < VALUES; i++) {
    l->plain[i] = (uint32_t)(3 * i);
    l->moved[l->places[i]] = (uint32_t)i;
  }
}

static void make_uneven(void *data, size_t i_item) {
  loops *l = data;
  for (size_t i = first_uneven(l, i_item); i < first_uneven(l, i_item + 1); i++)
    l->uneven[i] = (uint8_t)(i % 251 + 1);
}

static void check_values(const loops *l) {
  int n_wrong = 0;
  for (size_t i = 0; i < VALUES; i++)
    n_wrong += l->plain[i] != 3 * i || l->moved[l->places[i]] != i;
  for (size_t i = 0; i < ITEMS; i++)
    n_wrong += l->by_item[i] != 0.5 * (double)i;
  for (size_t i = 0; i < first_uneven(l, ITEMS); i++)
    n_wrong += l->uneven[i] != i % 251 + 1;
  CHECK(n_wrong == 0);
}

typedef struct loops_case {
  int leaver; /* the process that fails between two loops; -1: none */
  int n_made[THREAD_TEAM_MOST];
  conic_status statuses[THREAD_TEAM_MOST];
} loops_case;

static conic_status share_loops(conic_context *context, loops *l, int is_leaving) {
  const conic_team_loop first = {"first",
                                 0.0,
                                 0.5,
                                 ITEMS,
                                 16,
                                 CONIC_TASK(make_values),
                                 l,
                                 .n_an_item = AN_ITEM,
                                 .n_values = VALUES,
                                 .columns = {{l->plain, sizeof *l->plain},
                                             {NULL, 0},
                                             {l->moved, sizeof *l->moved, l->places},
                                             {l->by_item, sizeof *l->by_item, .is_by_item = 1}}};
  const conic_team_loop second = {
      "second", 0.5, 1.0, ITEMS, 0, CONIC_TASK(make_uneven), l, .first_of = first_uneven, .columns = {{l->uneven, 1}}};
  conic_status status = conic_team_runs(context, &first);
  if (status == CONIC_OK && is_leaving)
    return CONIC_ERROR_IO;
  return status == CONIC_OK ? conic_team_runs(context, &second) : status;
}

static void share_with(const conic_team *team, void *cookie) {
  loops_case *c = cookie;
  conic_context *context = check_context(1);
  loops *l = calloc(1, sizeof *l);
  if (!l)
    exit(1);
  for (uint32_t i = 0; i < VALUES; i++)
    l->places[i] = (i * 17 + 3) % VALUES;
  CHECK(!conic_context_join(context, team));
  conic_status status = share_loops(context, l, team->index == c->leaver);
  size_t total = (size_t)l->n_made;
  if (status == CONIC_OK) {
    CHECK_OK(conic_team_total(context, &total));
    CHECK(total == ITEMS);
    check_values(l);
  }
  c->statuses[team->index] = conic_context_part(context, status);
  c->n_made[team->index] = l->n_made;
  CHECK(!conic_context_join(context, NULL));
  free(l);
  conic_context_destroy(context);
}

int main(void) {
  static const int counts[] = {1, 2, 3, 7};
  for (int i = 0; i < 4; i++) {
    loops_case c = {.leaver = -1};
    thread_team_run(counts[i], share_with, &c);
    for (int k = 0; k < counts[i]; k++) { /* each does its part of it */
      CHECK(c.statuses[k] == CONIC_OK);
      CHECK(abs(c.n_made[k] - ITEMS / counts[i]) <= ITEMS / counts[i] / 8);
    }
  }
  loops_case c = {.leaver = 1};
  thread_team_run(3, share_with, &c);
  CHECK(c.statuses[0] == CONIC_ERROR_CANCELLED && c.statuses[1] == CONIC_ERROR_IO &&
        c.statuses[2] == CONIC_ERROR_CANCELLED);
  return check_result();
}
