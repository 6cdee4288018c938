#include "core/base/base.h"
#include "judge/diagnosis_samples.h"

/* A mistake that explains less than half of the difference says nothing. */
static const double least_share = 0.5;
/* A picture is explained if less than the first is left. If less than the second is left, it is explained except for
 * something small: then second mistakes are only tried beside that one. */
static const double least_left = 2e-5, little_left = 0.02;
/* A second mistake must explain this part of what the first leaves. */
static const double second_share = 0.6;

enum { MOST_FIRST = 8, MOST_REMEMBERED = 64, NARROWINGS = 4, NARROWER = 9, MOST_TURNS = 4, MOST_CLAIMS = 6 };

typedef struct trial {
  int first, second; /* suspects; second below 0: none */
  double left;       /* share of the difference */
} trial;

typedef struct trial_run {
  conic_trials *t;
  conic_channels *ours, *drawn, *finished;
  double whole;      /* the difference between the right picture and the judged one */
  int drawn_suspect; /* the only mistake in `drawn`; -1: none, it is right; -2: nothing is drawn yet */
  size_t n_done, n_planned;
  double from, to; /* of progress */
} trial_run;

static conic_status draw_planted(trial_run *r, const conic_planted *planted, int suspect) {
  if (suspect >= -1 && r->drawn_suspect == suspect)
    return CONIC_OK;
  r->drawn_suspect = -2;
  conic_status status = r->t->draw(r->t->world, planted, r->t->samples, r->drawn);
  if (status == CONIC_OK)
    r->drawn_suspect = suspect;
  return status;
}

static conic_status tell_trial(trial_run *r) {
  double done = r->n_planned ? (double)r->n_done / (double)r->n_planned : 1.0;
  r->n_done++;
  return conic_progress(r->t->context, "diagnose", r->from + (r->to - r->from) * (done < 1.0 ? done : 1.0));
}

/* Plants one mistake or two. Returns which of the drawn pictures it needs: that of a suspect, of none (-1), or a new
 * one (-3), since mistakes in finishing need none. */
static int plant_trial(const conic_trials *t, const trial *tried, conic_planted *planted) {
  const conic_suspect *a = tried->first >= 0 ? &t->suspects[tried->first] : NULL;
  const conic_suspect *b = tried->second >= 0 ? &t->suspects[tried->second] : NULL;
  *planted = *t->right;
  if (a && b && conic_suspect_rank(b) < conic_suspect_rank(a)) {
    const conic_suspect *other = a;
    a = b;
    b = other;
  }
  if (a)
    conic_suspect_plant(a, planted);
  if (b)
    conic_suspect_plant(b, planted);
  return b && !conic_suspect_is_finish(b) ? -3 : a && !conic_suspect_is_finish(a) ? (int)(a - t->suspects) : -1;
}

static conic_status try_planted(trial_run *r, trial *tried) {
  conic_planted planted;
  const int drawn = plant_trial(r->t, tried, &planted);
  conic_status status = tell_trial(r);
  if (status == CONIC_OK)
    status = draw_planted(r, &planted, drawn);
  if (status != CONIC_OK)
    return status;
  memcpy(r->finished, r->drawn, r->t->samples->n * sizeof *r->finished);
  conic_planted_finish(&planted, r->t->samples->n, r->finished);
  const double distance =
      conic_diagnosis_distance(r->t->samples, (const conic_channels *)r->finished, (const conic_channels *)r->ours);
  tried->left = r->whole > 0.0 ? distance / r->whole : distance;
  return CONIC_OK;
}

static int is_same_name(const conic_trials *t, int a, int b) {
  return a >= 0 && b >= 0 && strcmp(t->suspects[a].name, t->suspects[b].name) == 0;
}

/* Trials, the best first. */
typedef struct trial_list {
  int n, most, a_name; /* a_name: how many readings of a name are kept */
  trial trials[MOST_REMEMBERED + 1];
} trial_list;

/* Among equal trials, the first one stays first. */
static void remember_trial(const conic_trials *t, const trial *new, trial_list *list) {
  trial *trials = list->trials;
  int n_alike = 0, worst = -1, at = list->n;
  for (int i = 0; i < list->n; i++)
    if (is_same_name(t, trials[i].first, new->first)) {
      n_alike++;
      worst = i;
    }
  if (n_alike == list->a_name) {
    if (!(new->left < trials[worst].left))
      return;
    memmove(trials + worst, trials + worst + 1, (size_t)(list->n - worst - 1) * sizeof *trials);
    at = --list->n;
  }
  while (at > 0 && new->left < trials[at - 1].left)
    at--;
  memmove(trials + at + 1, trials + at, (size_t)(list->n - at) * sizeof *trials);
  trials[at] = *new;
  list->n += list->n < list->most;
}

static conic_status try_all_alone(trial_run *r, trial_list *best, trial_list *first) {
  conic_status status = CONIC_OK;
  /* Mistakes in finishing come first, while the right picture is drawn. */
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < r->t->n_suspects && status == CONIC_OK; i++) {
      trial new = {.first = i, .second = -1};
      if (conic_suspect_is_finish(&r->t->suspects[i]) == pass)
        continue;
      status = try_planted(r, &new);
      if (status != CONIC_OK)
        return status;
      remember_trial(r->t, &new, best);
      remember_trial(r->t, &new, first);
    }
  return status;
}

/* Tries a value between the listed ones. */
static conic_status try_value(trial_run *r, const conic_suspect *like, double value, trial *new) {
  conic_trials *t = r->t;
  t->suspects[t->n_suspects] = *like;
  t->suspects[t->n_suspects].value = value;
  *new = (trial){.first = t->n_suspects++, .second = -1};
  return try_planted(r, new);
}

/* Narrows the value of a mistake that may have any value, around the best one tried. */
static conic_status narrow_value(trial_run *r, trial_list *best, trial_list *first, int which) {
  const conic_suspect found = r->t->suspects[best->trials[which].first];
  double low = 0.0, high = 4.0 * found.value, at = found.value;
  trial nearest = best->trials[which];
  for (int i = 0; i < r->t->n_suspects; i++) {
    const conic_suspect *s = &r->t->suspects[i];
    int is_like = strcmp(s->name, found.name) == 0 && s->kind == found.kind && s->how == found.how;
    low = is_like && s->value < found.value && s->value > low ? s->value : low;
    high = is_like && s->value > found.value && s->value < high ? s->value : high;
  }
  for (int round = 0; round < NARROWINGS; round++) {
    const double from = low, step = (high - low) / (NARROWER + 1);
    for (int i = 1; i <= NARROWER && r->t->n_suspects < CONIC_MOST_SUSPECTS; i++) {
      trial new;
      conic_status status = try_value(r, &found, from + step * i, &new);
      if (status != CONIC_OK)
        return status;
      if (new.left < nearest.left) {
        nearest = new;
        at = from + step * i;
      }
    }
    low = at - step > low ? at - step : low;
    high = at + step < high ? at + step : high;
  }
  remember_trial(r->t, &nearest, best);
  remember_trial(r->t, &nearest, first);
  return CONIC_OK;
}

static int has_profile(const conic_trials *t, const trial *pair) {
  return pair->first >= 0 &&
         (conic_suspect_is_profile(&t->suspects[pair->first]) || conic_suspect_is_profile(&t->suspects[pair->second]));
}

/* Two mistakes win over a profile that explains the same. */
static int is_better_pair(const conic_trials *t, const trial *new, const trial *old) {
  const double slack = old->first >= 0 ? 1e-5 + 0.1 * old->left : 0.0;
  const int gained = has_profile(t, old) - has_profile(t, new);
  return new->left < (gained > 0 ? old->left + slack : gained < 0 ? old->left - slack : old->left);
}

/* Tries all others beside one; mistakes in finishing come first, while the first one's picture is drawn. */
static conic_status try_beside(trial_run *r, int first, trial *pair) {
  conic_status status = CONIC_OK;
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < r->t->n_suspects && status == CONIC_OK; i++) {
      trial new = {.first = first, .second = i};
      if (is_same_name(r->t, first, i) || conic_suspect_is_alone(&r->t->suspects[i]) ||
          conic_suspect_is_finish(&r->t->suspects[i]) == pass ||
          (conic_suspect_is_profile(&r->t->suspects[i]) && conic_suspect_is_profile(&r->t->suspects[first])))
        continue;
      status = try_planted(r, &new);
      if (status == CONIC_OK && is_better_pair(r->t, &new, pair))
        *pair = new;
    }
  return status;
}

/* Tries two mistakes in finishing, for which only the right picture is drawn. */
static conic_status try_finishes(trial_run *r, trial *pair) {
  conic_status status = CONIC_OK;
  for (int i = 0; i < r->t->n_suspects; i++)
    for (int k = 0; k < i && status == CONIC_OK; k++) {
      trial new = {.first = k, .second = i};
      if (is_same_name(r->t, i, k) || conic_suspect_is_alone(&r->t->suspects[i]) ||
          conic_suspect_is_alone(&r->t->suspects[k]) || !conic_suspect_is_finish(&r->t->suspects[i]) ||
          !conic_suspect_is_finish(&r->t->suspects[k]))
        continue;
      status = try_planted(r, &new);
      if (status == CONIC_OK && is_better_pair(r->t, &new, pair))
        *pair = new;
    }
  return status;
}

/* Tries all beside each of the best; then beside each of the two that were found, as long as that improves. A mistake
 * that explains nothing alone may be one of two. */
static conic_status try_all_pairs(trial_run *r, const trial_list *list, trial *pair) {
  conic_status status = CONIC_OK;
  const trial *best = list->trials;
  const int is_alone = best[0].left <= little_left && !conic_suspect_is_profile(&r->t->suspects[best[0].first]);
  int n_first = 0;
  while (n_first < list->n && (!is_alone || is_same_name(r->t, best[0].first, best[n_first].first)))
    n_first++;
  r->n_planned = r->n_done + (size_t)((n_first + 2) * r->t->n_suspects);
  if (!is_alone)
    status = try_finishes(r, pair);
  for (int i = 0; i < n_first && (pair->left > least_left || has_profile(r->t, pair)) && status == CONIC_OK; i++)
    status = try_beside(r, best[i].first, pair);
  for (int turn = 0; turn < MOST_TURNS && !is_alone && pair->left > least_left && status == CONIC_OK; turn++) {
    const trial before = *pair;
    status = try_beside(r, before.second, pair);
    if (status == CONIC_OK && pair->left == before.left)
      status = try_beside(r, before.first, pair);
    if (pair->left == before.left)
      break;
  }
  return status;
}

/* Mistakes win over profiles that explain the same. */
static void settle_ties(const conic_trials *t, trial_list *list) {
  trial *best = list->trials;
  for (int i = 1; i < list->n; i++)
    for (int at = i; at > 0; at--) {
      const trial *a = &best[at - 1], *b = &best[at];
      int is_tie = b->left - a->left <= 1e-5 + 0.1 * a->left;
      if (!is_tie || !conic_suspect_is_profile(&t->suspects[a->first]) ||
          conic_suspect_is_profile(&t->suspects[b->first]))
        break;
      const trial moved = best[at];
      best[at] = best[at - 1];
      best[at - 1] = moved;
    }
}

/* What a mistake of that name leaves alone. */
static double alone_of(const conic_trials *t, const trial_list *best, int suspect) {
  for (int i = 0; i < best->n; i++)
    if (is_same_name(t, best->trials[i].first, suspect))
      return best->trials[i].left;
  return INFINITY;
}

static void add_diagnosis(const conic_trials *t, const trial *tried, const conic_counter_check *check,
                          conic_diagnosis *found, int room, int *n_found) {
  const int suspects[2] = {tried->first, tried->second};
  for (int k = 0; k < 2 && suspects[k] >= 0 && *n_found < room; k++)
    found[(*n_found)++] = (conic_diagnosis){.name = t->suspects[suspects[k]].name,
                                            .with = suspects[1 - k] >= 0 ? t->suspects[suspects[1 - k]].name : NULL,
                                            .share = check->share,
                                            .righted = (uint32_t)check->righted,
                                            .spoilt = (uint32_t)check->spoilt,
                                            .is_nearest = !conic_counter_check_is_passed(check)};
}

/* What may be told, the best first: two mistakes, then each alone. Returns how many. */
static int choose_claims(const conic_trials *t, const trial_list *list, const trial *pair, trial claims[MOST_CLAIMS]) {
  const trial *best = list->trials;
  int n = 0;
  if (pair->first >= 0 && pair->left < 1.0 - least_share && pair->left < (1.0 - second_share) * best[0].left) {
    const int is_turned = alone_of(t, list, pair->second) < alone_of(t, list, pair->first);
    claims[n++] = is_turned ? (trial){pair->second, pair->first, pair->left} : *pair;
  }
  for (int i = 0; i < list->n && n < MOST_CLAIMS && best[i].left <= 1.0 - least_share; i++)
    claims[n++] = best[i];
  return n;
}

/* Tells what passes the counter-check, or else what comes nearest. */
static conic_status tell_explanations(conic_trials *t, const trial_list *list, const trial *pair,
                                      conic_diagnosis *found, int room, int *n_found) {
  trial claims[MOST_CLAIMS];
  conic_counter_check checks[MOST_CLAIMS];
  const int n = choose_claims(t, list, pair, claims);
  int best = -1, nearest = -1;
  for (int i = 0; i < n; i++) {
    plant_trial(t, &claims[i], &checks[i].planted);
    checks[i].is_rough = claims[i].second < 0 && conic_suspect_is_rough(&t->suspects[claims[i].first]);
  }
  conic_status status = conic_counter_check_all(t, (size_t)n, checks);
  for (int i = 0; i < n && status == CONIC_OK; i++) {
    const int is_passed = conic_counter_check_is_passed(&checks[i]);
    if (is_passed &&
        (best < 0 || (claims[best].second < 0 && claims[i].left <= 2.0 * claims[best].left + little_left))) {
      add_diagnosis(t, &claims[i], &checks[i], found, room, n_found);
      best = best < 0 ? i : best;
    }
    nearest = nearest < 0 || checks[i].share > checks[nearest].share ? i : nearest;
  }
  if (best < 0 && nearest >= 0 && checks[nearest].share >= least_share)
    add_diagnosis(t, &claims[nearest], &checks[nearest], found, room, n_found);
  return status;
}

static conic_status explain_picture(trial_run *r, conic_diagnosis *found, int room, int *n_found) {
  trial_list best = {.most = MOST_REMEMBERED, .a_name = 1}, first = {.most = MOST_FIRST, .a_name = 2};
  trial pair = {.first = -1, .left = INFINITY};
  r->n_planned = (size_t)r->t->n_suspects;
  r->to = 0.3;
  conic_status status = try_all_alone(r, &best, &first);
  if (status != CONIC_OK || !best.n)
    return status;
  for (int i = 0; i < 3 && i < best.n && status == CONIC_OK; i++) {
    const trial *tried = &best.trials[i];
    if (conic_suspect_is_any(&r->t->suspects[tried->first]) && tried->left > least_left && tried->left < 1.0)
      status = narrow_value(r, &best, &first, i);
  }
  if (status != CONIC_OK)
    return status;
  settle_ties(r->t, &best);
  r->from = 0.3;
  r->to = 1.0;
  r->n_done = 0;
  if (best.trials[0].left > least_left)
    status = try_all_pairs(r, &first, &pair);
  if (status == CONIC_OK)
    status = tell_explanations(r->t, &best, &pair, found, room, n_found);
  return status;
}

conic_status conic_trials_run(conic_trials *t, conic_diagnosis *found, int room, int *n_found) {
  const size_t n = t->samples->n;
  trial_run r = {.t = t, .drawn_suspect = -2};
  conic_channels *ours;
  conic_status status =
      conic_memory_allocate_these(t->context, CONIC_ROOM(r.drawn, n), CONIC_ROOM(r.finished, n), CONIC_ROOM(ours, n));
  trial right = {.first = -1, .second = -1};
  if (status == CONIC_OK)
    status = try_planted(&r, &right);
  if (status == CONIC_OK) {
    memcpy(ours, r.finished, n * sizeof *ours);
    r.ours = ours;
    r.whole = conic_diagnosis_distance(t->samples, (const conic_channels *)ours, (const conic_channels *)ours);
    if (r.whole > 0.0)
      status = explain_picture(&r, found, room, n_found);
  }
  conic_memory_release_these(t->context, r.drawn, r.finished, ours);
  return status == CONIC_OK ? conic_progress(t->context, "diagnose", 1.0) : status;
}
