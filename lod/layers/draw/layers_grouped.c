/* Places that are drawn as groups of their samples, an ellipse for each: some places at a time have all of their
 * samples gathered as they are, and these are grouped place by place. The splats come by place. */
#include "core/base/base.h"
#include "core/base/radix.h"
#include "core/base/vectors.h"
#include "core/splats/point_values.h"
#include "lod/layers/draw/layers_gather.h"
#include "lod/layers/format/layers_groups.h"
#include "lod/layers/format/layers_key.h"

/* What a thread needs for one place. */
typedef struct group_room {
  conic_layers_grouping grouping;
  uint64_t *keys;
  conic_layers_disc *members;
} group_room;

typedef struct grouped {
  conic_layers *layers;
  const conic_layers_gathering *asked;
  conic_layers_set *set;
  conic_layers_cut plain; /* the cut, of which all samples are gathered */
  conic_layers_set raw;   /* these, of the places in work: */
  size_t first, n_places; /* among the chosen */
  size_t *begin;          /* of each place's samples, in the order of their keys; by its number in the cut */
  conic_radix_item *items;
  size_t items_room, n_rooms;
  group_room *rooms; /* a thread */
} grouped;

static const conic_layers_place *place_of(const grouped *g, size_t i) {
  return &g->asked->cut->places[g->asked->chosen[g->first + i]];
}

static conic_status count_samples(void *cookie, conic_layers_set *raw) {
  grouped *g = cookie;
  for (size_t i = 0; i < raw->n_pieces; i++)
    g->begin[raw->pieces[i].i_place] += raw->pieces[i].n_chosen;
  return CONIC_OK;
}

/* Which places are worked on together: as many as have room, and those of one place, which share samples. */
static size_t count_places(const grouped *g) {
  const conic_layers_entry *entries = g->layers->entries;
  uint64_t most = conic_layers_drawing_bytes(g->layers) / (4 * CONIC_LAYERS_SPLAT_BYTES), n_samples = 0;
  size_t n = 0;
  for (; g->first + n < g->asked->n_chosen; n++) {
    const conic_layers_entry *entry = &entries[place_of(g, n)->node];
    n_samples += entry->n_drawn;
    if (n > 0 && n_samples > most && !conic_layers_is_same_place(entry, &entries[place_of(g, n - 1)->node]))
      break;
  }
  return n;
}

static uint64_t key_at(const conic_layers *layers, const conic_splats *splats, size_t i) {
  uint32_t step[3];
  for (int axis = 0; axis < 3; axis++)
    step[axis] = (uint32_t)((double)splats->position[axis][i] / layers->header.quantum);
  return conic_layers_key(step[0], step[1], step[2]);
}

/* Brings the samples into the order of their keys, which is that of the places. */
static conic_status sort_samples(grouped *g) {
  conic_context *context = g->layers->context;
  size_t n = g->raw.splats.count, sum = 0, most = 0;
  conic_status status = CONIC_OK;
  if (n > g->items_room)
    status = conic_memory_grow(context, &g->items, 0, n, sizeof *g->items);
  if (status != CONIC_OK)
    return status;
  g->items_room = n > g->items_room ? n : g->items_room;
  for (size_t i = 0; i < n; i++)
    g->items[i] = (conic_radix_item){key_at(g->layers, &g->raw.splats, i), (uint32_t)i};
  status = conic_radix_sort(context, g->items, n, 3 * (int)g->layers->header.bits);
  for (size_t i = 0; i < g->n_places; i++) {
    size_t *begin = &g->begin[g->asked->chosen[g->first + i]], n_own = *begin;
    most = n_own > most ? n_own : most;
    *begin = sum;
    sum += n_own;
  }
  for (size_t i = 0; i < g->n_rooms && status == CONIC_OK; i++) {
    group_room *room = &g->rooms[i];
    if (most <= room->grouping.room)
      continue;
    status = conic_memory_grow(context, &room->keys, 0, most, sizeof *room->keys);
    if (status == CONIC_OK)
      status = conic_memory_grow(context, &room->members, 0, most, sizeof *room->members);
    if (status == CONIC_OK)
      status = conic_layers_grouping_reserve(context, &room->grouping, most);
  }
  return status;
}

/* Where a place's samples end. */
static size_t end_of(const grouped *g, size_t i) {
  return i + 1 < g->n_places ? g->begin[g->asked->chosen[g->first + i + 1]] : g->raw.splats.count;
}

static void copy_splat(const conic_layers_set *from, size_t i, const conic_layers_set *to, size_t k) {
  for (int axis = 0; axis < 3; axis++) {
    to->splats.position[axis][k] = from->splats.position[axis][i];
    to->splats.tangent_u[axis][k] = from->splats.tangent_u[axis][i];
    to->splats.tangent_v[axis][k] = from->splats.tangent_v[axis][i];
    if (to->splats.color[axis])
      to->splats.color[axis][k] = from->splats.color[axis][i];
  }
  if (to->splats.opacity)
    to->splats.opacity[k] = from->splats.opacity[i];
  if (to->splats.dot)
    to->splats.dot[k] = from->splats.dot[i];
  if (to->lines)
    to->lines[k] = from->lines[i];
  for (size_t v = 0; to->named && v < to->named->n; v++)
    to->named->value[v][k] = from->named->value[v][i];
  to->ids[k] = from->ids[i];
}

/* A sample as a member, from how it would be drawn. */
static void make_member(const grouped *g, size_t i, conic_layers_disc *member) {
  const conic_splats *splats = &g->raw.splats;
  double u[3], v[3], normal[3];
  conic_vector_at(splats->tangent_u, i, u);
  conic_vector_at(splats->tangent_v, i, v);
  conic_cross(u, v, normal);
  double length = conic_length(normal), longer = conic_length(u), other = conic_length(v);
  longer = other > longer ? other : longer;
  for (int axis = 0; axis < 3; axis++) {
    member->center[axis] = splats->position[axis][i];
    member->normal[axis] = length > 0.0 ? (float)(normal[axis] / length) : axis == 2 ? 1.0f : 0.0f;
    member->major[axis] = 0.0f;
  }
  member->radius = member->longer = (float)(longer * (double)g->asked->cutoff);
}

/* The mean of an array's values, weighed by area. */
static float mean_of(const grouped *g, const group_room *room, const conic_layers_group *group, size_t first,
                     const float *values) {
  double sum = 0.0, weight = 0.0;
  for (uint32_t i = group->begin; i < group->end; i++) {
    uint32_t k = room->grouping.order[i];
    double w = (double)room->members[k].radius * (double)room->members[k].radius + 1e-30;
    sum += w * (double)values[g->items[first + k].value];
    weight += w;
  }
  return (float)(sum / weight);
}

static void put_group(const grouped *g, const group_room *room, const conic_layers_group *group, size_t first,
                      size_t k) {
  const conic_layers_set *set = g->set;
  conic_layers_disc ellipse;
  float u[3], v[3], cutoff = g->asked->cutoff;
  copy_splat(&g->raw, g->items[first + room->grouping.order[group->begin]].value, set, k);
  if (group->end - group->begin == 1)
    return;
  conic_layers_fit_group(&room->grouping, group, room->members,
                         (g->layers->header.flags & CONIC_LAYERS_UNORIENTED) != 0, &ellipse);
  conic_layers_disc_axes(&ellipse, u, v);
  for (int axis = 0; axis < 3; axis++) {
    set->splats.position[axis][k] = ellipse.center[axis];
    set->splats.tangent_u[axis][k] = u[axis] * ellipse.longer / cutoff;
    set->splats.tangent_v[axis][k] = v[axis] * ellipse.radius / cutoff;
    if (set->splats.color[axis])
      set->splats.color[axis][k] = mean_of(g, room, group, first, g->raw.splats.color[axis]);
  }
  if (set->splats.opacity)
    set->splats.opacity[k] = mean_of(g, room, group, first, g->raw.splats.opacity);
  if (set->splats.dot)
    set->splats.dot[k] = mean_of(g, room, group, first, g->raw.splats.dot) > 0.5f ? 1.0f : 0.0f;
  if (set->lines)
    set->lines[k].kind = 0;
}

/* Puts a place's splats into the set, where its piece says. */
static void group_place(void *data, size_t i, int i_thread) {
  const grouped *g = data;
  group_room *room = &g->rooms[i_thread];
  conic_layers_piece *piece = &g->set->pieces[i];
  size_t first = g->begin[piece->i_place], n = end_of(g, i) - first;
  if (!place_of(g, i)->is_grouped) {
    for (size_t k = 0; k < n; k++)
      copy_splat(&g->raw, g->items[first + k].value, g->set, piece->at + k);
    return;
  }
  for (size_t k = 0; k < n; k++) {
    room->keys[k] = g->items[first + k].key;
    make_member(g, g->items[first + k].value, &room->members[k]);
  }
  (void)conic_layers_group_all(g->layers->context, &room->grouping, room->keys, n); /* it has room */
  conic_layers_part_groups(&room->grouping, piece->n_chosen);
  conic_layers_sort_groups(&room->grouping);
  piece->n_chosen = (uint32_t)room->grouping.n_groups;
  for (size_t k = 0; k < room->grouping.n_groups; k++)
    put_group(g, room, &room->grouping.groups[k], first, piece->at + k);
}

/* Whether a splat of a place that is hidden otherwise may be seen: its plane is near the eye. */
static int may_be_seen(const grouped *g, const conic_layers_place *place, size_t k) {
  const conic_splats *splats = &g->set->splats;
  double u[3], v[3], normal[3], along = 0.0;
  if (place->state != CONIC_PLACE_GRAZING || !g->asked->view || (splats->dot && splats->dot[k] != 0.0f))
    return 1;
  conic_vector_at(splats->tangent_u, k, u);
  conic_vector_at(splats->tangent_v, k, v);
  conic_cross(u, v, normal);
  for (int axis = 0; axis < 3; axis++)
    along += normal[axis] * ((double)splats->position[axis][k] - g->asked->view->from.eye[axis]);
  return !(fabs(along) >= place->offset * conic_length(normal));
}

/* Keeps of a piece's splats those that may meet the part, and moves them to `at`. */
static void sift_piece(const grouped *g, conic_layers_piece *piece, size_t at) {
  const conic_layers_gathering *asked = g->asked;
  const conic_layers_place *place = &asked->cut->places[piece->i_place];
  const conic_splats *splats = &g->set->splats;
  int is_whole = !(conic_layers_share_of_place(asked, piece->i_place) < 1.0);
  double reach = is_whole ? 0.0 : conic_layers_reach(asked->part_view, &g->layers->entries[place->node], &place->sight);
  uint32_t n = 0;
  for (size_t k = piece->at; k < piece->at + piece->n_chosen; k++) {
    const float position[3] = {splats->position[0][k], splats->position[1][k], splats->position[2][k]};
    if (!may_be_seen(g, place, k))
      continue;
    if (!is_whole && !conic_layers_may_meet(asked->part_view, position, reach, &asked->part)) {
      piece->n_elsewhere++;
      continue;
    }
    if (k != at + n)
      copy_splat(g->set, k, g->set, at + n);
    n++;
  }
  piece->at = at;
  piece->end = piece->n_chosen = n;
}

static conic_status begin_pieces(grouped *g, size_t *count) {
  conic_layers_set *set = g->set;
  conic_status status =
      conic_memory_reserve(g->layers->context, &set->pieces, 0, g->n_places, &set->pieces_room, sizeof *set->pieces);
  set->n_pieces = 0;
  for (size_t i = 0; i < g->n_places && status == CONIC_OK; i++) {
    const conic_layers_place *place = place_of(g, i);
    uint32_t i_place = g->asked->chosen[g->first + i];
    size_t n = end_of(g, i) - g->begin[i_place];
    n = place->is_grouped && place->n_splats < n ? place->n_splats : n;
    set->pieces[set->n_pieces++] =
        (conic_layers_piece){.cloud = place->node, .i_place = i_place, .n_chosen = (uint32_t)n, .at = *count};
    *count += n;
  }
  return status;
}

/* Makes splats of the samples that have been gathered. */
static conic_status group_samples(grouped *g) {
  conic_layers_set *set = g->set;
  size_t used = set->splats.count, count = used;
  conic_status status = sort_samples(g);
  if (status == CONIC_OK)
    status = begin_pieces(g, &count);
  if (status == CONIC_OK)
    status = conic_layers_set_reserve(g->layers, set, used, count > set->room && used ? count + count / 4 : count);
  if (status != CONIC_OK)
    return status;
  conic_parallel_for(g->layers->context, g->n_places, group_place, g);
  for (size_t i = 0; i < set->n_pieces; i++) {
    conic_layers_piece *piece = &set->pieces[i];
    sift_piece(g, piece, used);
    used += piece->n_chosen;
    if (!g->asked->is_counted || g->asked->is_counted[piece->i_place])
      set->n_chosen += piece->n_chosen + piece->n_elsewhere;
  }
  set->is_cut_short = !g->asked->receive && g->asked->most && used > g->asked->most;
  set->splats.count = used;
  return CONIC_OK;
}

static conic_status hand_groups_over(const grouped *g) {
  const conic_layers_gathering *asked = g->asked;
  conic_layers_set *set = g->set;
  if (!asked->receive)
    return asked->look && !set->is_cut_short ? asked->look(asked->cookie, set) : CONIC_OK;
  conic_status status = conic_layers_set_face(g->layers, set, asked->camera);
  if (status == CONIC_OK)
    status = asked->receive(asked->cookie, set);
  set->splats.count = 0;
  return status;
}

static conic_status group_places(grouped *g) {
  const conic_layers_gathering *asked = g->asked;
  conic_status status = CONIC_OK;
  for (; g->first < asked->n_chosen && status == CONIC_OK && !g->set->is_cut_short; g->first += g->n_places) {
    g->n_places = count_places(g);
    conic_layers_gathering gathering = {.cut = &g->plain,
                                        .chosen = asked->chosen + g->first,
                                        .n_chosen = g->n_places,
                                        .cutoff = asked->cutoff,
                                        .until_s = asked->until_s,
                                        .is_for_groups = 1,
                                        .look = count_samples,
                                        .cookie = g};
    status = conic_layers_gather(g->layers, &gathering, &g->raw);
    if (status == CONIC_OK)
      status = group_samples(g);
    if (status == CONIC_OK)
      status = hand_groups_over(g);
  }
  return status;
}

conic_status conic_layers_gather_groups(conic_layers *layers, const conic_layers_gathering *asked,
                                        conic_layers_set *set) {
  conic_context *context = layers->context;
  grouped g = {.layers = layers, .asked = asked, .set = set, .plain = *asked->cut};
  g.plain.is_grouped = 0;
  g.plain.turned = NULL;
  g.n_rooms = (size_t)conic_context_threads(context);
  conic_status status = conic_layers_set_begin(layers, set);
  if (status == CONIC_OK)
    status = conic_memory_allocate_these(context, CONIC_ZEROED(g.rooms, g.n_rooms), CONIC_ZEROED(g.begin, g.plain.n));
  if (status == CONIC_OK)
    status = group_places(&g);
  for (size_t i = 0; g.rooms && i < g.n_rooms; i++) {
    conic_memory_release_these(context, g.rooms[i].keys, g.rooms[i].members);
    conic_layers_grouping_release(context, &g.rooms[i].grouping);
  }
  conic_layers_set_release(context, &g.raw);
  conic_memory_release_these(context, g.items, g.rooms, g.begin);
  if (status != CONIC_OK || asked->receive)
    return status;
  if (set->named)
    set->named->count = set->splats.count;
  status = conic_layers_set_face(layers, set, asked->camera);
  return status == CONIC_OK ? conic_layers_set_list_lines(layers, set) : status;
}
