/* The cut through the levels that a picture shows. */

#include "core/base/radix.h"
#include "core/image/viewpoint.h"
#include "lod/blends/levels_read.h"

/* What reading and drawing take of a Gaussian that is drawn, beside its numbers: what is above it and beside it in its
 * clouds, and what a picture sets up. */
enum { DRAWING_BYTES = 320, WORDS_BESIDE = 6 };

/* Pixels that filters of a picture reach out of an outline. */
static const double margin_px = 4.0;

/* No more pixels of a veil are looked at to each side. */
static const double most_around = 8.0;

/* The root of the sum of the squares that an error in pixels allows is an eighth of it. */
static const double per_root = 8.0;

typedef struct chosen {
  uint32_t cloud, i;
} chosen;

typedef struct level_cutting {
  conic_levels_scene *scene;
  conic_levels *levels;
  const conic_levels_wish *wish;
  conic_viewpoint from;
  int is_plain; /* a pinhole without a lens: its sides are known */
  double focal;
  double error;
  chosen *list;
  size_t n, room;
  uint32_t *clouds[2]; /* to be looked at in this level and the next one */
  size_t n_clouds[2];
  uint64_t n_merged;
} level_cutting;

/* Those of all scenes of a picture. */
typedef struct level_cuttings {
  level_cutting *list;
  size_t n;
  uint64_t most, n_found; /* n_found: drawn of all, or the least that would be where that is more than `most` */
} level_cuttings;

uint64_t conic_levels_most(const conic_levels_scene *scenes, size_t n) {
  uint64_t most = UINT64_MAX;
  for (size_t i = 0; i < n; i++) {
    const conic_levels *l = scenes[i].levels;
    const uint64_t each = DRAWING_BYTES + UINT64_C(4) * WORDS_BESIDE * conic_levels_columns(&l->header, 0);
    if (l->memory_bytes > 0 && l->memory_bytes / each < most)
      most = l->memory_bytes / each + 1;
  }
  return most;
}

static float number_of(const conic_levels *l, uint32_t cloud, size_t column, size_t i) {
  return conic_float_of_bits(l->clouds[cloud].columns[column * l->entries[cloud].n + i]);
}

/* Of what is merged. */
static conic_blend_parts parts_of(const conic_levels *l, uint32_t cloud, size_t i) {
  float values[CONIC_BLEND_PARTS];
  conic_blend_parts parts;
  for (size_t k = 0; k < CONIC_BLEND_PARTS; k++)
    values[k] = number_of(l, cloud, conic_levels_row(&l->header) + k, i);
  memcpy(&parts, values, sizeof parts);
  return parts;
}

static int is_merged(const conic_levels *l, const chosen *one) {
  return one->cloud < l->shape.n_clouds - l->header.n_leaves && parts_of(l, one->cloud, one->i).light > 0.0f;
}

/* Whether a ball can be in sight; *scale gets how many pixels a length in it has at most, infinite where it reaches the
 * eye. */
static int look_at(const level_cutting *c, const float mean[3], double reach, double *scale) {
  double p[3];
  conic_viewpoint_move_floats(&c->from, mean, p);
  const double distance = conic_length(p), z = c->is_plain ? p[2] - reach : distance - reach;
  *scale = HUGE_VAL;
  if (c->scene->camera.kind == CONIC_CAMERA_ORTHOGRAPHIC)
    *scale = c->focal;
  else if (z > 0.0)
    *scale = c->is_plain ? c->focal * (distance + reach) / (z * z) : c->focal / z;
  return !c->is_plain || (!conic_viewpoint_misses(&c->from, p, reach) && p[2] + reach > 0.0);
}

/* What is left of the light within a deviation of what reaches so far, and may be merged: the root of the mean square.
 */
static double find_left(const level_cutting *c, const float mean[3], double reach) {
  const conic_levels_veil *veil = c->wish->veil;
  double p[3], sum = 0.0, n = 0.0;
  if (!veil)
    return 1.0;
  conic_viewpoint_move_floats(&c->from, mean, p);
  const conic_camera *camera = &veil->camera;
  const double near = reach / (double)CONIC_BLEND_DEVIATIONS, z = (p[2] - near) * c->scene->unit;
  if (!(z > 0.0))
    return 1.0;
  const double x = p[0] / p[2] * camera->fx + camera->cx, y = p[1] / p[2] * camera->fy + camera->cy;
  const double around = fmin(near / (p[2] - near) * fmax(camera->fx, camera->fy), most_around);
  const int first[2] = {(int)fmax(x - around, 0.0), (int)fmax(y - around, 0.0)};
  if (!(x + around >= 0.0 && y + around >= 0.0 && x - around < camera->width && y - around < camera->height))
    return 1.0;
  for (int row = first[1]; row < camera->height && row <= y + around; row++)
    for (int column = first[0]; column < camera->width && column <= x + around; column++) {
      const float *depths = veil->depths + ((size_t)row * (size_t)camera->width + (size_t)column) * CONIC_VEIL_HALVES;
      double left2 = 1.0;
      for (int k = 0; k < CONIC_VEIL_HALVES && (double)depths[k] <= z; k++)
        left2 *= 0.25;
      sum += left2;
      n += 1.0;
    }
  return n > 0.0 ? sqrt(sum / n) : 1.0;
}

/* The light that is elsewhere, in pixels. */
static double light_of(const level_cutting *c, const conic_blend_parts *parts, const float mean[3], double scale) {
  if (parts->light == 0.0f)
    return 0.0;
  const double all = per_root * scale * sqrt((double)parts->light);
  return all > c->error ? all * find_left(c, mean, (double)parts->reach) : all;
}

static conic_status choose_one(level_cutting *c, uint32_t cloud, size_t i) {
  const chosen one = {cloud, (uint32_t)i};
  c->n_merged += (uint64_t)is_merged(c->levels, &one);
  return conic_memory_append(c->levels->context, &c->list, &c->n, &c->room, &one, sizeof one);
}

/* Looks at those of a cloud for which what stands for them is open; *parts gets the children that are to be looked at,
 * *n_open how many are open. */
static conic_status look_into(level_cutting *c, uint32_t cloud, const unsigned char *above, int is_leaf,
                              unsigned *parts, uint64_t *n_open) {
  const conic_levels *l = c->levels;
  const conic_levels_loaded *loaded = &l->clouds[cloud];
  const size_t n = l->entries[cloud].n;
  const uint32_t *link = loaded->columns + (conic_levels_columns(&l->header, is_leaf) - 1) * n;
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    double scale;
    loaded->is_open[i] = 0;
    if (above && !above[link[i] & CONIC_LEVELS_PARENT])
      continue;
    const float mean[3] = {number_of(l, cloud, 0, i), number_of(l, cloud, 1, i), number_of(l, cloud, 2, i)};
    const conic_blend_parts below = is_leaf ? (conic_blend_parts){.light = 0.0f} : parts_of(l, cloud, i);
    float reach = below.reach;
    for (size_t axis = 0; axis < 3 && is_leaf; axis++)
      reach = fmaxf(reach, CONIC_BLEND_DEVIATIONS * number_of(l, cloud, CONIC_BLEND_SCALE + axis, i));
    if (!look_at(c, mean, (double)reach, &scale))
      continue;
    if (!is_leaf && light_of(c, &below, mean, scale) > c->error) {
      loaded->is_open[i] = 1;
      *parts |= link[i] >> CONIC_LEVELS_PARTS_BIT;
      ++*n_open;
    } else
      status = choose_one(c, cloud, i);
  }
  return status;
}

/* Cuts one scene. It ends where more than so many are open or drawn: *n_found are at least. */
static conic_status cut_one(level_cutting *c, double error, uint64_t most, uint64_t *n_found) {
  conic_levels *l = c->levels;
  conic_status status = CONIC_OK;
  c->error = error;
  c->n = 0;
  c->n_merged = 0;
  c->clouds[0][0] = 0;
  c->n_clouds[0] = 1;
  *n_found = 0;
  for (int level = 0; level < l->shape.n_levels && status == CONIC_OK && *n_found <= most; level++) {
    const uint32_t *now = c->clouds[level % 2];
    uint32_t *next = c->clouds[!(level % 2)];
    const int is_leaf = level + 1 == l->shape.n_levels;
    uint64_t n_open = 0;
    size_t n_next = 0;
    status = conic_levels_load(l, now, c->n_clouds[level % 2]);
    for (size_t k = 0; k < c->n_clouds[level % 2] && status == CONIC_OK; k++) {
      const uint32_t at = now[k] - l->shape.first[level];
      const unsigned char *above =
          level ? l->clouds[l->shape.first[level - 1] + at / CONIC_LEVELS_CHILDREN].is_open : NULL;
      unsigned parts = 0;
      status = look_into(c, now[k], above, is_leaf, &parts, &n_open);
      for (uint32_t child = 0; child < CONIC_LEVELS_CHILDREN && !is_leaf; child++)
        if (parts >> child & 1 && CONIC_LEVELS_CHILDREN * at + child < l->shape.count[level + 1])
          next[n_next++] = l->shape.first[level + 1] + CONIC_LEVELS_CHILDREN * at + child;
    }
    c->n_clouds[!(level % 2)] = n_next;
    *n_found = c->n + n_open;
  }
  return status;
}

/* Cuts all scenes at one error; *is_over: more are to be drawn than may. */
static conic_status cut_at(level_cuttings *all, double error, int *is_over) {
  conic_status status = CONIC_OK;
  all->n_found = 0;
  for (size_t i = 0; i < all->n && status == CONIC_OK && all->n_found <= all->most; i++) {
    uint64_t n_found;
    status = cut_one(&all->list[i], error, all->most - all->n_found, &n_found);
    all->n_found += n_found;
  }
  *is_over = all->n_found > all->most;
  return status;
}

/* Says how many the least are that can be drawn. */
static conic_status refuse_few(level_cuttings *all, double error) {
  const uint64_t most = all->most;
  const level_cutting *first = all->list;
  int is_over;
  all->most = UINT64_MAX;
  conic_status status = cut_at(all, error, &is_over);
  return status != CONIC_OK
             ? status
             : conic_fail(first->levels->context, CONIC_ERROR_INPUT,
                          "%s: its coarsest picture has %llu Gaussians, and %s %llu", first->levels->name,
                          (unsigned long long)all->n_found,
                          first->wish->budget == most ? "the budget is" : "the memory holds", (unsigned long long)most);
}

/* The least error, to a 512th of it, at which no more are drawn than may. It comes from above, so that little more is
 * read than is needed. Errors: also INPUT (the coarsest picture has more). */
static conic_status find_error(level_cuttings *all, double least) {
  double high = 1e12, low = high;
  int is_over;
  conic_status status = cut_at(all, high, &is_over);
  if (status == CONIC_OK && is_over)
    return refuse_few(all, high);
  while (status == CONIC_OK && !is_over && low > least) {
    high = low;
    low = low > 1e-9 ? fmax(0.25 * low, least) : least;
    status = cut_at(all, low, &is_over);
  }
  if (!is_over)
    return status;
  while (status == CONIC_OK && high - low > high / 512.0) {
    const double middle = 0.5 * (low + high);
    status = cut_at(all, middle, &is_over);
    *(is_over ? &low : &high) = middle;
  }
  return status == CONIC_OK ? cut_at(all, high, &is_over) : status;
}

/* --- what is drawn --- */

/* What came stands in its own order, before all that is merged. */
static conic_status order_chosen(const level_cutting *c, conic_radix_item *items) {
  const conic_levels *l = c->levels;
  const uint32_t first_leaf = l->shape.n_clouds - l->header.n_leaves;
  for (size_t i = 0; i < c->n; i++) {
    const chosen *one = &c->list[i];
    const uint32_t *numbers = l->clouds[one->cloud].columns + conic_levels_row(&l->header) * l->entries[one->cloud].n;
    items[i] = (conic_radix_item){one->cloud < first_leaf ? l->header.n + i : numbers[one->i], (uint32_t)i};
  }
  return conic_radix_sort(l->context, items, c->n, 34);
}

static void fill_row(const level_cutting *c, const chosen *one, size_t at, conic_gaussians *set) {
  const conic_levels *l = c->levels;
  const size_t n = conic_harmonics_of_degree(set->sh_degree);
  float row[CONIC_BLEND_MOST_FLOATS] = {0.0f};
  for (size_t k = 0; k < CONIC_BLEND_HARMONICS + n; k++)
    row[k] = number_of(l, one->cloud, k, one->i);
  if (c->wish->dilation > 0.0 && is_merged(l, one)) {
    double p[3];
    conic_viewpoint_move_floats(&c->from, row, p);
    const double length = p[2] / c->focal; /* of a pixel there */
    const conic_blend_parts parts = parts_of(l, one->cloud, one->i);
    if (length > 0.0)
      conic_blend_dilate(&parts, c->wish->dilation * length * length, row);
  }
  for (size_t k = 0; k < 3; k++) {
    set->position[k][at] = row[k];
    set->scale[k][at] = row[CONIC_BLEND_SCALE + k];
  }
  for (size_t k = 0; k < 4; k++)
    set->rotation[k][at] = row[CONIC_BLEND_ROTATION + k];
  set->opacity[at] = row[CONIC_BLEND_OPACITY];
  memcpy(set->sh + at * n, row + CONIC_BLEND_HARMONICS, n * sizeof *row);
}

static conic_status fill_set(const level_cutting *c, int is_all, conic_gaussians *set) {
  const conic_levels *l = c->levels;
  conic_radix_item *items = conic_memory_allocate(l->context, c->n, sizeof *items);
  conic_status status = items ? order_chosen(c, items) : CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < c->n && is_all && status == CONIC_OK; i++)
    if (items[i].key != i)
      status = conic_fail(l->context, CONIC_ERROR_INPUT, "%s: is damaged: it has no Gaussian %zu, or two", l->name, i);
  if (status == CONIC_OK)
    status = conic_gaussians_allocate(l->context, c->n, (int)l->header.sh_degree, 0, set);
  if (status == CONIC_OK) {
    memcpy(set->origin, l->header.origin, sizeof set->origin);
    memcpy(set->frame, l->header.frame, sizeof set->frame);
    memcpy(set->up, l->header.up, sizeof set->up);
    set->is_antialiased = (l->header.flags & CONIC_LEVELS_ANTIALIASED) != 0;
    set->is_linear = (l->header.flags & CONIC_LEVELS_LINEAR) != 0;
    for (size_t i = 0; i < c->n; i++)
      fill_row(c, &c->list[items[i].value], i, set);
  }
  conic_memory_release(l->context, items);
  return status;
}

/* Takes every Gaussian of a level, whatever is in sight. */
static conic_status take_level(level_cutting *c, int level) {
  conic_levels *l = c->levels;
  conic_status status = CONIC_OK;
  for (uint32_t k = 0; k < l->shape.count[level] && status == CONIC_OK; k++) {
    const uint32_t cloud = l->shape.first[level] + k;
    status = conic_levels_load(l, &cloud, 1);
    for (size_t i = 0; i < l->entries[cloud].n && status == CONIC_OK; i++)
      status = choose_one(c, cloud, i);
  }
  return status;
}

static conic_status choose_some(level_cuttings *all, const conic_levels_wish *wish, uint64_t memory, int *is_short) {
  int is_over = 0;
  conic_status status = CONIC_OK;
  all->most = wish->budget && wish->budget < memory ? wish->budget : memory;
  if (!wish->budget)
    status = cut_at(all, wish->error, &is_over);
  *is_short = status == CONIC_OK && is_over;
  return status == CONIC_OK && (wish->budget || is_over) ? find_error(all, wish->budget ? 0.0 : wish->error) : status;
}

/* Drops all clouds, where memory is scarce: what draws needs it. */
static void drop_many(const level_cuttings *all, uint64_t most) {
  uint64_t n = 0;
  for (int is_dropping = 0; is_dropping < 2; is_dropping++)
    for (size_t k = 0; k < all->n && (!is_dropping || n > most / 2); k++) {
      conic_levels *l = all->list[k].levels;
      for (uint32_t i = 0; i < l->shape.n_clouds; i++)
        if (is_dropping)
          conic_levels_drop(l, i);
        else
          n += l->clouds[i].columns ? l->entries[i].n : 0;
    }
}

/* Takes or chooses of each scene. */
static conic_status fill_cuts(level_cuttings *all, const conic_levels_wish *wish, uint64_t memory, int is_all) {
  const int is_whole_level = is_all || wish->part == CONIC_LEVELS_ROOT;
  int is_short = 0;
  conic_status status = is_whole_level ? CONIC_OK : choose_some(all, wish, memory, &is_short);
  for (size_t i = 0; i < all->n && status == CONIC_OK; i++) {
    level_cutting *c = &all->list[i];
    if (is_whole_level)
      status = take_level(c, is_all ? c->levels->shape.n_levels - 1 : 0);
    if (status == CONIC_OK)
      status = fill_set(c, is_all, &c->scene->set);
    c->scene->cut = (conic_levels_cut){c->error, c->n, c->n_merged, is_all, is_short};
  }
  return status;
}

conic_status conic_levels_choose(conic_levels_scene *scenes, size_t n, const conic_levels_wish *wish) {
  conic_context *context = scenes[0].levels->context;
  level_cuttings all = {.list = conic_memory_allocate_zeroed(context, n, sizeof *all.list), .n = n};
  conic_status status = all.list ? CONIC_OK : CONIC_ERROR_MEMORY;
  const uint64_t memory = conic_levels_most(scenes, n);
  uint64_t n_all = 0;
  for (size_t i = 0; i < n; i++)
    n_all += scenes[i].levels->header.n;
  const int is_all = wish->part == CONIC_LEVELS_ALL ||
                     (wish->part == CONIC_LEVELS_CUT && wish->error == 0.0 && !wish->budget && n_all <= memory);
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const conic_camera *camera = &scenes[i].camera;
    level_cutting *c = &all.list[i];
    *c = (level_cutting){.scene = &scenes[i],
                         .levels = scenes[i].levels,
                         .wish = wish,
                         .focal = fmax(camera->fx, camera->fy),
                         .is_plain = camera->kind == CONIC_CAMERA_PERSPECTIVE && camera->lens == CONIC_LENS_NONE};
    if (!is_all && wish->part == CONIC_LEVELS_CUT)
      conic_viewpoint_init(&c->from, camera, c->levels->header.origin, margin_px);
    status = conic_memory_allocate_these(context, CONIC_ROOM(c->clouds[0], c->levels->shape.n_clouds),
                                         CONIC_ROOM(c->clouds[1], c->levels->shape.n_clouds));
  }
  if (status == CONIC_OK)
    status = fill_cuts(&all, wish, memory, is_all);
  for (size_t i = 0; i < n && all.list; i++)
    conic_memory_release_these(context, all.list[i].clouds[0], all.list[i].clouds[1], all.list[i].list);
  if (status == CONIC_OK)
    drop_many(&all, memory);
  conic_memory_release(context, all.list);
  return status;
}
