#include "lod/layers/draw/layers_gather.h"

#include "core/splats/point_values.h"
#include "lod/layers/draw/layers_octree.h"

/* Pieces are small: so many make a task. */
enum { PIECES_A_TASK = 16 };

typedef struct gather gather;

typedef void piece_function(const gather *g, conic_layers_piece *piece);

/* Which of the chosen places lie below a cloud: they follow each other, as the cut is in the order of the keys. */
typedef struct place_range {
  uint32_t first, end;
} place_range;

struct gather {
  conic_layers *layers;
  const conic_layers_gathering *asked;
  conic_layers_set *set;
  place_range *below; /* a cloud */
  piece_function *function;
};

/* Walks from every chosen place up to the root, but where it has stand-ins. */
static void find_places_below(gather *g) {
  const conic_layers_entry *entries = g->layers->entries;
  for (size_t k = 0; k < g->asked->n_chosen; k++) {
    const conic_layers_place *place = &g->asked->cut->places[g->asked->chosen[k]];
    uint32_t first = place->stand_ins ? place->stand_ins : place->node;
    for (uint32_t node = first; place->state != CONIC_PLACE_HIDDEN; node = entries[node].parent) {
      place_range *below = &g->below[node];
      below->first = below->end ? below->first : (uint32_t)k;
      below->end = (uint32_t)k + 1;
      if (node == 0 || place->stand_ins)
        break;
    }
  }
}

/* Whether something of the cloud is drawn of a place below it. */
static int is_drawn_from(const conic_layers_place *place, uint32_t cloud) {
  return place->state != CONIC_PLACE_HIDDEN && (!place->stand_ins || place->stand_ins == cloud);
}

/* Lists the pieces of some clouds by cloud, each cloud's in the order of its keys. */
static conic_status list_pieces(gather *g, const uint32_t *clouds, size_t n_clouds) {
  conic_layers_set *set = g->set;
  size_t n = 0;
  for (size_t i = 0; i < n_clouds; i++)
    n += g->below[clouds[i]].end - g->below[clouds[i]].first;
  set->n_pieces = 0;
  if (n > set->pieces_room) {
    conic_status status = conic_memory_grow(g->layers->context, &set->pieces, 0, n, sizeof *set->pieces);
    if (status != CONIC_OK)
      return status;
    set->pieces_room = n;
  }
  for (size_t i = 0; i < n_clouds; i++)
    for (uint32_t k = g->below[clouds[i]].first; k < g->below[clouds[i]].end; k++)
      if (is_drawn_from(&g->asked->cut->places[g->asked->chosen[k]], clouds[i]))
        set->pieces[set->n_pieces++] = (conic_layers_piece){.cloud = clouds[i], .i_place = g->asked->chosen[k]};
  return CONIC_OK;
}

/* What of a piece's samples is taken. */
typedef struct sieve {
  const conic_layers_cloud *cloud;
  const conic_layers_place *place;
  const conic_layers_view *view;
  const conic_layers_turned *turned;  /* null: nothing of it faces away */
  const conic_layers_gathering *part; /* null: all of the place lies in the part that is gathered for */
  double reach_px;                    /* of its splats, there */
  uint64_t n_of;                      /* not 0: so many of the cloud's are chosen, evenly in the order of their keys */
} sieve;

/* Of a piece's cloud: it is in memory. */
static const conic_layers_cloud *cloud_of(const conic_layers *layers, const conic_layers_piece *piece) {
  return layers->store.slots[piece->cloud].cloud;
}

static int is_place_counted(const conic_layers_gathering *asked, uint32_t i_place) {
  return !asked->is_counted || asked->is_counted[i_place];
}

double conic_layers_share_of_place(const conic_layers_gathering *asked, uint32_t i_place) {
  if (!asked->part_view || (asked->takes_counted && is_place_counted(asked, i_place)))
    return 1.0;
  conic_window pixels = conic_layers_fine_pixels(&asked->cut->places[i_place], asked->samples),
               in = conic_window_meet(&pixels, &asked->part);
  if (in.x_begin >= in.x_end || in.y_begin >= in.y_end)
    return 0.0;
  return (double)(in.x_end - in.x_begin) / (double)(pixels.x_end - pixels.x_begin) *
         ((double)(in.y_end - in.y_begin) / (double)(pixels.y_end - pixels.y_begin));
}

static sieve begin_sieve(const gather *g, const conic_layers_piece *piece, const conic_layers_cloud *cloud) {
  const conic_layers_place *place = &g->asked->cut->places[piece->i_place];
  const conic_layers_gathering *part = conic_layers_share_of_place(g->asked, piece->i_place) < 1.0 ? g->asked : NULL;
  const conic_layers_turned *turned = g->asked->cut->turned ? &g->asked->cut->turned[piece->i_place] : NULL;
  return (sieve){
      .cloud = cloud,
      .place = place,
      .view = g->asked->view,
      .part = part,
      .reach_px =
          part ? conic_layers_reach(part->part_view, conic_layers_place_entry(g->layers, place), &place->sight) : 0.0,
      .n_of = g->asked->cut->n_root < cloud->count ? g->asked->cut->n_root : 0,
      .turned = turned && turned->is_any && cloud->facing ? turned : NULL};
}

static inline int is_dot(const conic_layers_cloud *cloud, size_t i) {
  return cloud->dot && cloud->dot[i] != 0.0f;
}

static inline int is_turned(const sieve *s, size_t i) {
  return s->turned && conic_layers_is_turned(s->turned, s->cloud->facing[i]) && !is_dot(s->cloud, i);
}

/* Whether a splat is one of those asked for and passes the filter; and, of a place that is hidden otherwise, may be
 * seen: its plane is near the eye. */
static inline int is_chosen(const sieve *s, size_t i) {
  double along = 0.0;
  if (s->n_of && i * s->n_of / s->cloud->count == (i + 1) * s->n_of / s->cloud->count)
    return 0;
  if (s->cloud->is_left_out && s->cloud->is_left_out[i])
    return 0;
  if (s->place->state != CONIC_PLACE_GRAZING || !s->view || is_dot(s->cloud, i))
    return 1;
  for (int axis = 0; axis < 3; axis++)
    along += (double)s->cloud->normal[axis][i] * ((double)s->cloud->position[axis][i] - s->view->from.eye[axis]);
  return !(fabs(along) >= s->place->offset);
}

/* Whether a splat surely meets no pixel of the part. */
static inline int is_elsewhere(const sieve *s, size_t i) {
  if (!s->part)
    return 0;
  const float position[3] = {s->cloud->position[0][i], s->cloud->position[1][i], s->cloud->position[2][i]};
  return !conic_layers_may_meet(s->part->part_view, position, s->reach_px, &s->part->part);
}

static void count_piece(const gather *g, conic_layers_piece *piece) {
  conic_layers *layers = g->layers;
  const conic_layers_place *place = &g->asked->cut->places[piece->i_place];
  const conic_layers_cloud *cloud = cloud_of(layers, piece);
  size_t first = 0, end = cloud->count;
  if (piece->cloud != place->node && !place->stand_ins)
    conic_layers_range(&layers->header, cloud, &layers->entries[place->node], &first, &end);
  piece->first = (uint32_t)first;
  piece->end = (uint32_t)end;
  sieve s = begin_sieve(g, piece, cloud);
  piece->n_chosen = piece->end - piece->first;
  piece->n_turned = piece->n_elsewhere = 0;
  if (place->state != CONIC_PLACE_GRAZING && !s.turned && !s.n_of && !s.part && !cloud->is_left_out)
    return;
  piece->n_chosen = 0;
  for (size_t i = first; i < end; i++) {
    if (!is_chosen(&s, i))
      continue;
    uint32_t *n = is_turned(&s, i) ? &piece->n_turned : is_elsewhere(&s, i) ? &piece->n_elsewhere : &piece->n_chosen;
    ++*n;
  }
}

/* A piece's samples and their places in the set. */
typedef struct splat_copying {
  const conic_layers_cloud *cloud;
  const conic_layers_entry *entry; /* the place's */
  float cutoff;
  const float *restrict position[3], *restrict normal[3], *restrict color[3], *restrict outline;
  float *restrict to_position[3], *restrict to_u[3], *restrict to_v[3], *restrict to_color[3];
  float *restrict to_opacity, *restrict to_dot;
  conic_layers_lines *to_lines;
  uint32_t *restrict to_id;
  float most;        /* no outline is larger, */
  float growth;      /* but for this, where not all of the root's samples are drawn */
  const double *eye; /* from the origin; null: nobody looks */
  const conic_layers *layers;
  const uint64_t *keys;
  uint32_t i_cloud;
} splat_copying;

/* Those that are drawn of a cloud stand for all of its area. */
static float growth_of(const gather *g, const conic_layers_cloud *cloud) {
  uint64_t n_root = g->asked->cut->n_root;
  return n_root > 0 && n_root < cloud->count ? (float)sqrt((double)cloud->count / (double)n_root) : 1.0f;
}

static splat_copying begin_copy(const gather *g, const conic_layers_piece *piece) {
  const conic_splats *to = &g->set->splats;
  const conic_layers_cloud *cloud = cloud_of(g->layers, piece);
  const conic_layers_place *place = &g->asked->cut->places[piece->i_place];
  uint32_t node = place->node;
  size_t from = piece->first, at = piece->at;
  int is_from_above = g->layers->octree && piece->cloud != node;
  splat_copying c = {.cloud = cloud,
                     .entry = conic_layers_place_entry(g->layers, place),
                     .cutoff = g->asked->cutoff,
                     .outline = cloud->outline ? cloud->outline + from : NULL,
                     .to_opacity = to->opacity ? to->opacity + at : NULL,
                     .to_dot = to->dot ? to->dot + at : NULL,
                     .to_lines = g->set->lines ? g->set->lines + at : NULL,
                     .to_id = g->set->ids + at,
                     .most = is_from_above ? conic_layers_octree_outline(g->layers, node) : INFINITY,
                     .growth = growth_of(g, cloud),
                     .eye = g->asked->view ? g->asked->view->from.eye : NULL,
                     .layers = g->layers,
                     .keys = cloud->keys + from,
                     .i_cloud = piece->cloud};
  for (int axis = 0; axis < 3; axis++) {
    c.position[axis] = cloud->position[axis] + from;
    c.normal[axis] = cloud->normal[axis] + from;
    c.to_position[axis] = to->position[axis] + at;
    c.to_u[axis] = to->tangent_u[axis] + at;
    c.to_v[axis] = to->tangent_v[axis] + at;
    c.color[axis] = cloud->color[axis] ? cloud->color[axis] + from : NULL;
    c.to_color[axis] = to->color[axis] ? to->color[axis] + at : NULL;
  }
  return c;
}

/* The unit normal of a sample that has none: as above it, or else to the eye, or up. */
static void guess_normal_of(const splat_copying *c, size_t i, float normal[3]) {
  double to[3] = {0.0, 0.0, 1.0}, length = 0.0;
  if (c->layers->octree && conic_layers_octree_guess(c->layers, c->i_cloud, c->keys[i], normal))
    return;
  for (int axis = 0; axis < 3; axis++) {
    to[axis] = c->eye ? c->eye[axis] - (double)c->position[axis][i] : to[axis];
    length += to[axis] * to[axis];
  }
  length = sqrt(length);
  for (int axis = 0; axis < 3; axis++)
    normal[axis] = length > 0.0 ? (float)(to[axis] / length) : axis == 2 ? 1.0f : 0.0f;
}

/* A circle's axes, for a unit normal anywhere: as conic_layers_frame has them. */
static inline void set_axes(const splat_copying *c, size_t i, size_t k, float sigma) {
  float normal[3] = {c->normal[0][i], c->normal[1][i], c->normal[2][i]};
  if (normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f)
    guess_normal_of(c, i, normal);
  float nx = normal[0], ny = normal[1], nz = normal[2];
  float sign = nz >= 0.0f ? 1.0f : -1.0f, a = -1.0f / (sign + nz), b = nx * ny * a;
  c->to_u[0][k] = (1.0f + sign * (nx * nx) * a) * sigma;
  c->to_u[1][k] = sign * b * sigma;
  c->to_u[2][k] = -sign * nx * sigma;
  c->to_v[0][k] = b * sigma;
  c->to_v[1][k] = (sign + ny * ny * a) * sigma;
  c->to_v[2][k] = -ny * sigma;
}

static inline float drawn_sigma(const splat_copying *c, size_t i) {
  float outline = conic_layers_outline(c->entry, c->outline ? c->outline[i] : 0.0f);
  return c->growth * (outline < c->most ? outline : c->most) / c->cutoff;
}

static void copy_values(const gather *g, const conic_layers_cloud *cloud, size_t i_cloud, size_t k) {
  for (size_t v = 0; g->set->named && v < g->set->named->n; v++)
    g->set->named->value[v][k] = cloud->values[v * cloud->count + i_cloud];
}

static int has_payload(const splat_copying *c) {
  return c->cloud->axis[0] || c->cloud->dot || c->to_lines;
}

/* What else a splat has. At full resolution it is drawn as it came, in coarser places as a circle without lines. */
static void copy_payload(const splat_copying *c, size_t i_cloud, size_t k) {
  const conic_layers_cloud *cloud = c->cloud;
  int is_full = c->entry->child == 0 && cloud->axis[0];
  for (int axis = 0; axis < 3 && is_full; axis++) {
    c->to_u[axis][k] = c->growth * cloud->axis[axis][i_cloud];
    c->to_v[axis][k] = c->growth * cloud->axis[3 + axis][i_cloud];
  }
  if (c->to_opacity)
    c->to_opacity[k] = cloud->opacity[i_cloud];
  if (c->to_dot)
    c->to_dot[k] = cloud->dot[i_cloud];
  if (c->to_lines) {
    c->to_lines[k].kind = 0;
    if (is_full)
      c->to_lines[k] = cloud->lines[i_cloud];
  }
}

static void copy_all(const splat_copying *c, size_t n, uint32_t first_id) {
  for (int axis = 0; axis < 3; axis++) {
    memcpy(c->to_position[axis], c->position[axis], n * sizeof(float));
    if (c->to_color[axis])
      memcpy(c->to_color[axis], c->color[axis], n * sizeof(float));
  }
  const splat_copying local = *c;
  for (size_t i = 0; i < n; i++)
    set_axes(&local, i, i, drawn_sigma(&local, i));
  for (size_t i = 0; i < n; i++)
    local.to_id[i] = first_id + (uint32_t)i;
}

static void copy_one(const splat_copying *c, size_t i, size_t k, uint32_t id) {
  for (int axis = 0; axis < 3; axis++) {
    c->to_position[axis][k] = c->position[axis][i];
    if (c->to_color[axis] && c->color[axis])
      c->to_color[axis][k] = c->color[axis][i];
  }
  set_axes(c, i, k, drawn_sigma(c, i));
  c->to_id[k] = id;
}

static void fill_piece(const gather *g, conic_layers_piece *piece) {
  conic_layers *layers = g->layers;
  const conic_layers_cloud *cloud = cloud_of(layers, piece);
  uint32_t first_id = (uint32_t)(layers->first_sample[piece->cloud] + piece->first);
  size_t n = piece->end - piece->first, k = 0;
  if (piece->n_chosen == 0)
    return;
  splat_copying c = begin_copy(g, piece);
  if (piece->n_chosen == n) {
    copy_all(&c, n, first_id);
    for (size_t i = 0; i < n && has_payload(&c); i++)
      copy_payload(&c, piece->first + i, i);
    for (size_t i = 0; i < n && g->set->named; i++)
      copy_values(g, cloud, piece->first + i, piece->at + i);
    return;
  }
  sieve s = begin_sieve(g, piece, cloud);
  for (size_t i = 0; i < n && k < piece->n_chosen; i++)
    if (!is_turned(&s, piece->first + i) && is_chosen(&s, piece->first + i) && !is_elsewhere(&s, piece->first + i)) {
      copy_one(&c, i, k, first_id + (uint32_t)i);
      if (has_payload(&c))
        copy_payload(&c, piece->first + i, k);
      copy_values(g, cloud, piece->first + i, piece->at + k);
      k++;
    }
}

static void piece_task(void *data, size_t i_task) {
  const gather *g = data;
  size_t begin = i_task * PIECES_A_TASK, end = begin + PIECES_A_TASK;
  for (size_t i = begin; i < end && i < g->set->n_pieces; i++)
    g->function(g, &g->set->pieces[i]);
}

static void for_pieces(gather *g, piece_function *function) {
  g->function = function;
  conic_parallel_for(g->layers->context, (g->set->n_pieces + PIECES_A_TASK - 1) / PIECES_A_TASK, piece_task, g);
}

/* Gives the pieces their places in the set. Returns where they end. */
static size_t place_pieces(gather *g) {
  const conic_layers_entry *entries = g->layers->entries;
  const conic_layers_place *places = g->asked->cut->places;
  conic_layers_set *set = g->set;
  size_t at = set->splats.count;
  for (size_t i = 0; i < set->n_pieces; i++) {
    conic_layers_piece *piece = &set->pieces[i];
    const conic_layers_piece *before = i > 0 ? &set->pieces[i - 1] : NULL;
    if (before && before->cloud == piece->cloud &&
        conic_layers_is_same_place(&entries[places[before->i_place].node], &entries[places[piece->i_place].node]))
      piece->n_chosen = piece->n_turned = piece->n_elsewhere = 0;
    piece->at = at;
    at += piece->n_chosen;
    int is_counted = is_place_counted(g->asked, piece->i_place);
    set->n_chosen += is_counted ? piece->n_chosen + piece->n_elsewhere : 0;
    set->n_turned += is_counted ? piece->n_turned : 0;
  }
  return at;
}

/* Takes over what the pieces' clouds, now in memory, have. */
static conic_status take_pieces(gather *g) {
  for_pieces(g, count_piece);
  size_t count = place_pieces(g), used = g->set->splats.count;
  if (!g->asked->receive && g->asked->most && count > g->asked->most) {
    g->set->is_cut_short = 1;
    return CONIC_OK;
  }
  size_t wanted = count > g->set->room && used ? count + count / 4 : count;
  conic_status status = conic_layers_set_reserve(g->layers, g->set, used, wanted);
  if (status != CONIC_OK)
    return status;
  for_pieces(g, fill_piece);
  g->set->splats.count = count;
  return CONIC_OK;
}

/* Turns the set's dots to the camera. */
static conic_status face_dots(const gather *g) {
  conic_splats *splats = &g->set->splats;
  if (!splats->dot || !g->asked->camera || splats->count == 0)
    return CONIC_OK;
  return conic_splats_face(g->layers->context, splats, g->asked->camera, splats->tangent_u, splats->tangent_v);
}

/* How many of the first clouds are taken together. */
static size_t clouds_together(const gather *g, const uint32_t *clouds, size_t n) {
  const conic_layers *layers = g->layers;
  size_t n_fit = conic_layers_store_fit(layers, clouds, n, conic_layers_cache_bytes(layers) / 2), n_samples = 0;
  for (size_t i = 0; i < n_fit && g->asked->receive; i++) {
    n_samples += layers->entries[clouds[i]].n_samples;
    if (n_samples > g->asked->most)
      return i ? i : 1;
  }
  return n_fit;
}

/* Hands over what there is. */
static conic_status hand_over(gather *g) {
  conic_status status = face_dots(g);
  if (status == CONIC_OK)
    status = g->asked->receive(g->asked->cookie, g->set);
  g->set->splats.count = 0;
  return status;
}

static conic_status take_clouds(gather *g, const uint32_t *clouds, size_t n) {
  conic_layers *layers = g->layers;
  conic_status status = CONIC_OK;
  for (size_t done = 0; done < n && status == CONIC_OK && !g->set->is_cut_short;) {
    conic_layers_loading loading = {.clouds = clouds + done, .until_s = g->asked->until_s};
    loading.n = clouds_together(g, clouds + done, n - done);
    status = conic_layers_store_load(layers, &loading);
    if (status != CONIC_OK)
      break;
    status = list_pieces(g, loading.clouds, loading.n);
    if (status == CONIC_OK)
      status = take_pieces(g);
    conic_layers_store_unpin(layers, &loading);
    if (status == CONIC_OK && g->asked->receive)
      status = hand_over(g);
    else if (status == CONIC_OK && g->asked->look && !g->set->is_cut_short)
      status = g->asked->look(g->asked->cookie, g->set);
    done += loading.n;
  }
  return status;
}

/* What the set will come to: all of the places that are shown, and some of the others'; of parts, there is no telling.
 */
static size_t expect(const gather *g) {
  size_t n = 0;
  for (size_t k = 0; k < g->asked->n_chosen && !g->asked->receive; k++) {
    const conic_layers_place *place = &g->asked->cut->places[g->asked->chosen[k]];
    size_t n_drawn = (size_t)((double)place->n_splats * conic_layers_share_of_place(g->asked, g->asked->chosen[k]));
    n += place->state == CONIC_PLACE_SHOWN ? n_drawn : place->state == CONIC_PLACE_GRAZING ? n_drawn / 16 : 0;
  }
  return n < g->asked->most || !g->asked->most ? n + 1 : g->asked->most + 1;
}

/* The clouds that have something below which a chosen place lies. */
static conic_status gather_clouds(gather *g) {
  conic_layers *layers = g->layers;
  uint32_t *clouds = conic_memory_allocate(layers->context, conic_layers_all(layers), sizeof *clouds);
  if (!clouds)
    return CONIC_ERROR_MEMORY;
  size_t n = 0;
  for (uint32_t i = 0; i < conic_layers_all(layers); i++)
    if (g->below[i].end && layers->entries[i].n_samples > 0)
      clouds[n++] = i;
  conic_status status = take_clouds(g, clouds, n);
  conic_memory_release(layers->context, clouds);
  return status;
}

conic_status conic_layers_gather(conic_layers *layers, const conic_layers_gathering *gathering, conic_layers_set *set) {
  gather g = {.layers = layers, .asked = gathering, .set = set};
  conic_status status = conic_layers_set_begin(layers, set);
  if (status == CONIC_OK)
    status = conic_layers_set_reserve(layers, set, 0, expect(&g));
  if (status != CONIC_OK)
    return status;
  g.below = conic_memory_allocate_zeroed(layers->context, conic_layers_all(layers), sizeof *g.below);
  if (!g.below)
    return CONIC_ERROR_MEMORY;
  find_places_below(&g);
  status = gather_clouds(&g);
  conic_memory_release(layers->context, g.below);
  if (status != CONIC_OK || gathering->receive)
    return status;
  if (set->named)
    set->named->count = set->splats.count;
  status = face_dots(&g);
  return status == CONIC_OK ? conic_layers_set_list_lines(layers, set) : status;
}
