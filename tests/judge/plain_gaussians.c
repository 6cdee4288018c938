/* A Gaussian at a pixel, and the pixels: what is in reach, front to back. */
#include "tests/judge/plain_footprint.h"

static void plain_cross(plain_floats *f, const float a[3], const float b[3], float product[3]) {
  for (int i = 0; i < 3; i++)
    product[i] = plain_mad(f, a[(i + 1) % 3], b[(i + 2) % 3], -(a[(i + 2) % 3] * b[(i + 1) % 3]));
}

/* Half of q, below 0 where there is none, and the depth there. Of an ellipse: */
static float plain_meet_ellipse(plain_frame *v, const plain_footprint *g, float x, float y) {
  plain_floats *f = &v->floats;
  const float dx = g->place[0] - x, dy = g->place[1] - y;
  const float along[2] = {plain_product(f, g->form[0], dx, dx), plain_product(f, g->form[2], dy, dy)};
  if (f->is_shuffled && plain_chance(f, 2))
    return plain_sum(f, 0.5f * along[0], 0.5f * along[1], plain_product(f, g->form[1], dx, dy));
  return plain_mad(f, g->form[1] * dx, dy, 0.5f * (along[0] + along[1]));
}

/* Of a disc, or of the dot that stands for it where it is smaller than a pixel. */
static float plain_meet_disc(plain_frame *v, const plain_footprint *g, float x, float y, float *z) {
  plain_floats *f = &v->floats;
  const float dx = g->place[0] - x, dy = g->place[1] - y;
  float k[3], l[3], p[3];
  for (int i = 0; i < 3; i++) {
    k[i] = plain_mad(f, x, g->rows[2][i], -g->rows[0][i]);
    l[i] = plain_mad(f, y, g->rows[2][i], -g->rows[1][i]);
  }
  plain_cross(f, k, l, p);
  if (p[2] == 0.0f)
    return -1.0f;
  const float u = plain_divide(f, p[0], p[2]), w = plain_divide(f, p[1], p[2]);
  const float hit[3] = {u, w, 1.0f};
  if (v->profile.disc_near > 0.0f)
    *z = plain_dot(f, hit, g->rows[2]);
  if (*z < v->profile.disc_near)
    return -1.0f;
  return fminf(0.5f * plain_mad(f, u, u, w * w), plain_mad(f, dx, dx, dy * dy));
}

/* Where the ray is nearest to the unit ball's centre. */
static float plain_meet_ball(plain_frame *v, const plain_footprint *g, float x, float y, float *z) {
  plain_floats *f = &v->floats;
  const float ray[3] = {plain_divide(f, x - v->center[0], v->camera->fx),
                        plain_divide(f, y - v->center[1], v->camera->fy), 1.0f};
  float along[3], across[3];
  for (int k = 0; k < 3; k++)
    along[k] = plain_dot(f, g->rows[k], ray);
  plain_cross(f, along, g->ball, across);
  const float over = plain_divide(f, 1.0f, plain_dot(f, along, along));
  *z = plain_dot(f, along, g->ball) * over;
  return *z > 0.0f ? 0.5f * (plain_dot(f, across, across) * over) : -1.0f;
}

/* α at a pixel, and the depth there; below 0 where it is left out. */
static float plain_alpha(plain_frame *v, const plain_footprint *g, float x, float y, float *z) {
  plain_floats *f = &v->floats;
  *z = g->z;
  const float half_q = v->profile.is_ray    ? plain_meet_ball(v, g, x, y, z)
                       : v->profile.is_disc ? plain_meet_disc(v, g, x, y, z)
                                            : plain_meet_ellipse(v, g, x, y);
  if (!(half_q >= 0.0f) || (v->profile.cutoff > 0.0f && half_q > 0.5f * v->profile.cutoff))
    return -1.0f;
  float falloff = plain_exponential(f, -half_q);
  if (plain_has(v->settings->faults, PLAIN_FALLOFF_RENORMALISED)) { /* so that it is 0 at √8 σ, or at 3 */
    const float end = v->settings->faults & PLAIN_OTHERWISE ? 0.011108997f : 0.018315639f;
    falloff = (falloff - end) / (1.0f - end);
  }
  const float alpha = fminf(v->profile.most_alpha, g->opacity * falloff);
  return alpha < v->profile.least_alpha ? -1.0f : alpha;
}

static int plain_compare(const void *a, const void *b) {
  const plain_footprint *x = a, *y = b;
  if (x->key != y->key)
    return x->key > y->key ? 1 : -1;
  return (x->index > y->index) - (x->index < y->index);
}

static int plain_compare_hits(const void *a, const void *b) {
  const plain_hit *x = a, *y = b;
  if (x->z != y->z)
    return x->z > y->z ? 1 : -1;
  return (x->g->index > y->g->index) - (x->g->index < y->g->index);
}

/* Which Gaussians have a pixel in their reach. */
static size_t plain_meet(plain_frame *v, const plain_footprint *all, const uint32_t *list, size_t n, float x, float y) {
  const unsigned orders = 1u << PLAIN_ORDER_FILE | 1u << PLAIN_ORDER_DISTANCE;
  size_t n_hits = 0;
  float z;
  for (size_t i = 0; i < n; i++) {
    const plain_footprint *g = &all[list[i]];
    if (x < g->reach[0][0] || x > g->reach[1][0] || y < g->reach[0][1] || y > g->reach[1][1])
      continue;
    const float alpha = plain_alpha(v, g, x, y, &z);
    if (alpha >= 0.0f)
      v->hits[n_hits++] = (plain_hit){g, alpha, 1.0f, z};
  }
  if (v->profile.is_ray && !(v->settings->faults & orders))
    qsort(v->hits, n_hits, sizeof *v->hits, plain_compare_hits);
  return n_hits;
}

/* The light that comes to each, front to back. Returns how many are seen, and the rest of the light. */
static size_t plain_let_through(plain_frame *v, size_t n_hits, float *rest) {
  const float stop = v->profile.stop;
  float T = 1.0f;
  size_t n = 0;
  for (; n < n_hits; n++) {
    const float alpha = v->hits[n].alpha;
    const float next = v->settings->manner.subtracts_weights ? plain_mad(&v->floats, -alpha, T, T) : T * (1.0f - alpha);
    if (next < stop || (v->profile.stops_at && next == stop))
      break;
    v->hits[n].before = T;
    T = next;
  }
  *rest = T;
  return n;
}

static void plain_shuffle(plain_floats *f, plain_hit *hits, size_t n) {
  for (size_t i = n; i > 1; i--) {
    const size_t other = plain_chance(f, (uint32_t)i);
    const plain_hit kept = hits[i - 1];
    hits[i - 1] = hits[other];
    hits[other] = kept;
  }
}

static void plain_composite(plain_frame *v, const plain_footprint *all, const uint32_t *list, size_t n, int column,
                            int row, plain_picture *picture) {
  plain_floats *f = &v->floats;
  const plain_manner *manner = &v->settings->manner;
  const int is_off = plain_has(v->settings->faults, PLAIN_HALF_PIXEL);
  const float half = !is_off ? 0.5f : v->settings->faults & PLAIN_OTHERWISE ? 1.0f : 0.0f;
  const size_t at = (size_t)row * (size_t)picture->width + (size_t)column;
  float T, color[3] = {0.0f, 0.0f, 0.0f}, weights = 0.0f, depths = 0.0f;
  const size_t n_met = plain_meet(v, all, list, n, (float)column + half, (float)row + half);
  const size_t n_hits = plain_let_through(v, n_met, &T);
  if (manner->sums_in_any_order)
    plain_shuffle(f, v->hits, n_hits);
  for (size_t i = 0; i < n_hits; i++) {
    const plain_hit *hit = &v->hits[i];
    const float weight = hit->alpha * hit->before;
    for (int c = 0; c < 3; c++)
      color[c] = f->is_shuffled && plain_chance(f, 2)
                     ? plain_mad(f, hit->g->color[c] * hit->alpha, hit->before, color[c])
                     : plain_mad(f, hit->g->color[c], weight, color[c]);
    depths = plain_mad(f, hit->z, weight, depths);
    weights += weight;
  }
  const float alpha = manner->sums_weights ? weights : 1.0f - T;
  const float all_weights = manner->divides_by_alpha ? alpha : weights;
  for (int c = 0; c < 3; c++) {
    float behind = plain_has(v->settings->faults, PLAIN_BACKGROUND_WHITE) ? 1.0f : v->settings->background[c];
    picture->rgb[3 * at + (size_t)c] = plain_mad(f, T, behind, color[c]);
  }
  picture->T[at] = T;
  picture->alpha[at] = alpha;
  picture->z[at] = all_weights > 0.0f ? plain_divide(f, depths, all_weights) : 0.0f;
  picture->count[at] = (float)n_hits;
}

/* The tiles that a footprint may reach: first and behind the last, by axis. */
static void plain_tiles_of(const plain_footprint *g, int across, int down, int tiles[2][2]) {
  const int n[2] = {across, down};
  for (int axis = 0; axis < 2; axis++) {
    tiles[0][axis] = (int)plain_clamp(floorf(g->reach[0][axis] / TILE), 0.0f, (float)n[axis]);
    tiles[1][axis] = (int)plain_clamp(floorf(g->reach[1][axis] / TILE) + 1.0f, 0.0f, (float)n[axis]);
  }
}

/* Each tile's list holds what may reach it, in the order of all. The lists stand one behind the other; returns where
 * each begins, and puts the last one's end behind. */
static size_t *plain_bin(const plain_footprint *all, size_t n, int across, int down, uint32_t **lists) {
  const size_t n_tiles = (size_t)across * (size_t)down;
  size_t *begin = calloc(n_tiles + 1, sizeof *begin);
  int t[2][2];
  *lists = NULL;
  for (int pass = 0; pass < 2 && begin; pass++) { /* counts, then puts */
    for (size_t i = 0; i < n; i++) {
      plain_tiles_of(&all[i], across, down, t);
      for (int y = t[0][1]; y < t[1][1]; y++)
        for (int x = t[0][0]; x < t[1][0]; x++) {
          size_t *place = &begin[(size_t)y * (size_t)across + (size_t)x];
          if (pass)
            (*lists)[*place] = (uint32_t)i;
          ++*place;
        }
    }
    size_t sum = 0;
    for (size_t k = 0; k <= n_tiles && !pass; k++) {
      size_t count = begin[k];
      begin[k] = sum;
      sum += count;
    }
    if (!pass)
      *lists = calloc(sum + 1, sizeof **lists);
    if (!*lists)
      plain_give_up("memory", "there is not enough");
  }
  for (size_t k = n_tiles; k-- > 0;) /* where its end was left, the next one begins */
    begin[k + 1] = begin[k];
  begin[0] = 0;
  return begin;
}

void plain_gaussians_draw(const plain_scene *scene, const plain_camera *camera, const plain_settings *settings,
                          plain_picture *picture) {
  plain_frame v = plain_look(scene, camera, settings);
  plain_footprint *all = calloc(scene->count + 1, sizeof *all);
  const int across = (camera->width + TILE - 1) / TILE, down = (camera->height + TILE - 1) / TILE;
  uint32_t *lists;
  size_t n = 0;
  v.hits = calloc(scene->count + 1, sizeof *v.hits);
  if (!all || !v.hits)
    plain_give_up("memory", "there is not enough");
  for (size_t i = 0; i < scene->count; i++)
    n += plain_place(&v, i, &all[n]) != 0;
  if (!plain_has(settings->faults, PLAIN_ORDER_FILE))
    qsort(all, n, sizeof *all, plain_compare);
  size_t *begin = plain_bin(all, n, across, down, &lists);
  for (int y = 0; y < camera->height; y++)
    for (int x = 0; x < camera->width; x++) {
      const size_t tile = (size_t)(y / TILE) * (size_t)across + (size_t)(x / TILE);
      plain_composite(&v, all, lists + begin[tile], begin[tile + 1] - begin[tile], x, y, picture);
    }
  plain_picture_spoil(picture, settings->faults);
  free(begin);
  free(lists);
  free(v.hits);
  free(all);
}
