#include "lod/mesh/face_tree.h"

#include "core/base/radix.h"
#include "core/base/random.h"
#include "core/base/vectors.h"

enum { LEAF_FACES = 2, CODE_BITS = 10 };

/* A search looks at no more leaves. Meshes of scanners and modellers need fewer (nefertiti.obj: 786); where thousands
 * of faces have one edge, boxes tell nothing, and what the search has found by then is an upper bound. */
enum { MOST_LEAVES = 2048 };

/* --- faces --- */

/* The places of a face's corners, the lowest first, whatever corner it begins with and however it is wound. */
static void sorted_places(const conic_mesh *mesh, const conic_adjacency *adjacency, size_t face, uint32_t places[3]) {
  for (int corner = 0; corner < 3; corner++) {
    uint32_t place = adjacency->place[mesh->faces[face][corner]];
    int k = corner;
    for (; k > 0 && places[k - 1] > place; k--)
      places[k] = places[k - 1];
    places[k] = place;
  }
}

/* Where in a table a face's places are, or would be. */
static size_t slot_of(const conic_mesh *mesh, const conic_adjacency *adjacency, const uint32_t *table, size_t room,
                      const uint32_t places[3]) {
  uint64_t hash = conic_random_mix(conic_random_mix((uint64_t)places[0] << 32 | places[1]) + places[2]);
  size_t slot = (size_t)hash & (room - 1);
  for (; table[slot] != UINT32_MAX; slot = (slot + 1) & (room - 1)) {
    uint32_t there[3];
    sorted_places(mesh, adjacency, table[slot], there);
    if (memcmp(there, places, sizeof there) == 0)
      break;
  }
  return slot;
}

/* The faces of use, without those that lie where one before them does: they are as far from everywhere, so that no box
 * would keep a search from looking at all of them. */
static conic_status list_faces(conic_context *context, const conic_adjacency *adjacency, conic_face_tree *tree) {
  const conic_mesh *mesh = tree->mesh;
  size_t room = (size_t)1 << (conic_bits_below(mesh->n_faces) + 1);
  uint32_t *table = conic_memory_allocate(context, room, sizeof *table);
  if (!table)
    return CONIC_ERROR_MEMORY;
  memset(table, 0xFF, room * sizeof *table);
  for (size_t i = 0; i < mesh->n_faces; i++) {
    uint32_t places[3];
    if (!adjacency->side[i])
      continue;
    sorted_places(mesh, adjacency, i, places);
    size_t slot = slot_of(mesh, adjacency, table, room, places);
    if (table[slot] != UINT32_MAX)
      continue;
    table[slot] = (uint32_t)i;
    tree->faces[tree->n_faces++] = (uint32_t)i;
  }
  conic_memory_release(context, table);
  return CONIC_OK;
}

static void middle_of(const conic_mesh *mesh, size_t face, double middle[3]) {
  middle[0] = middle[1] = middle[2] = 0.0;
  for (int corner = 0; corner < 3; corner++)
    for (int axis = 0; axis < 3; axis++)
      middle[axis] += (double)mesh->position[axis][mesh->faces[face][corner]] / 3.0;
}

/* Puts the faces in the order of a space-filling curve. */
static conic_status order_faces(conic_context *context, conic_face_tree *tree) {
  const conic_mesh *mesh = tree->mesh;
  conic_radix_item *items = conic_memory_allocate(context, tree->n_faces + 1, sizeof *items);
  double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, middle[3];
  if (!items)
    return CONIC_ERROR_MEMORY;
  for (size_t i = 0; i < tree->n_faces; i++) {
    middle_of(mesh, tree->faces[i], middle);
    conic_widen_box(low, high, middle);
  }
  for (size_t i = 0; i < tree->n_faces; i++) {
    items[i] = (conic_radix_item){.key = 0, .value = tree->faces[i]};
    middle_of(mesh, items[i].value, middle);
    for (int axis = 0; axis < 3; axis++) {
      double side = high[axis] - low[axis], share = side > 0.0 ? (middle[axis] - low[axis]) / side : 0.0;
      items[i].key |= conic_spread_bits((uint64_t)(share * 1023.0)) << axis;
    }
  }
  conic_status status = conic_radix_sort(context, items, tree->n_faces, 3 * CODE_BITS);
  for (size_t i = 0; i < tree->n_faces; i++)
    tree->faces[i] = items[i].value;
  conic_memory_release(context, items);
  return status;
}

/* --- boxes --- */

static void add_to_box(conic_face_box *box, const conic_face_box *more) {
  for (int axis = 0; axis < 3; axis++)
    CONIC_WIDEN(box->low[axis], box->high[axis], more->low[axis], more->high[axis]);
}

static void fill_boxes(conic_face_tree *tree) {
  const conic_face_box empty = {{HUGE_VALF, HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF}};
  for (size_t i = 0; i < 2 * tree->n_leaves; i++)
    tree->boxes[i] = empty;
  for (size_t i = 0; i < tree->n_faces; i++)
    for (int corner = 0; corner < 3; corner++) {
      conic_face_box point;
      for (int axis = 0; axis < 3; axis++) {
        float at = tree->mesh->position[axis][tree->mesh->faces[tree->faces[i]][corner]];
        point.low[axis] = point.high[axis] = tree->corners[i][corner][axis] = at;
      }
      add_to_box(&tree->boxes[tree->n_leaves + i / LEAF_FACES], &point);
    }
  for (size_t i = tree->n_leaves - 1; i > 0; i--) {
    add_to_box(&tree->boxes[i], &tree->boxes[2 * i]);
    add_to_box(&tree->boxes[i], &tree->boxes[2 * i + 1]);
  }
}

conic_status conic_face_tree_build(conic_context *context, const conic_mesh *mesh, const conic_adjacency *adjacency,
                                   conic_face_tree *tree) {
  memset(tree, 0, sizeof *tree);
  tree->mesh = mesh;
  tree->n_leaves = (size_t)1 << conic_bits_below((mesh->n_faces + LEAF_FACES - 1) / LEAF_FACES);
  tree->faces = conic_memory_allocate(context, mesh->n_faces, sizeof *tree->faces);
  tree->boxes = conic_memory_allocate(context, 2 * tree->n_leaves, sizeof *tree->boxes);
  conic_status status = tree->faces && tree->boxes ? list_faces(context, adjacency, tree) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = order_faces(context, tree);
  if (status == CONIC_OK && !(tree->corners = conic_memory_allocate(context, tree->n_faces + 1, sizeof *tree->corners)))
    status = CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    fill_boxes(tree);
  else
    conic_face_tree_release(context, tree);
  return status;
}

void conic_face_tree_release(conic_context *context, conic_face_tree *tree) {
  conic_memory_release_these(context, tree->faces, tree->corners, tree->boxes);
  memset(tree, 0, sizeof *tree);
}

/* --- distances --- */

static double distance2_to_box(const conic_face_box *box, const double at[3]) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double below = (double)box->low[axis] - at[axis], above = at[axis] - (double)box->high[axis];
    double out = below > above ? below : above;
    out = out > 0.0 ? out : 0.0; /* no branch: chance would decide it */
    sum += out * out;
  }
  return sum;
}

static double distance2_in_leaf(const conic_face_tree *tree, size_t leaf, const double at[3], double least2,
                                uint32_t *nearest) {
  for (size_t i = leaf * LEAF_FACES; i < (leaf + 1) * LEAF_FACES && i < tree->n_faces; i++) {
    double corners[3][3];
    for (int corner = 0; corner < 3; corner++)
      for (int axis = 0; axis < 3; axis++)
        corners[corner][axis] = (double)tree->corners[i][corner][axis];
    double distance2 = conic_distance2_to_triangle(at, corners[0], corners[1], corners[2]);
    *nearest = distance2 < least2 ? tree->faces[i] : *nearest;
    least2 = distance2 < least2 ? distance2 : least2;
  }
  return least2;
}

/* The least squared distance, where least2 is one that is known to be there: the nearest face's, or more where too many
 * are about as near. Nearer children first; done where something is near enough. */
static double search(const conic_face_tree *tree, const double at[3], double least2, double known, uint32_t *nearest) {
  size_t stack[64];
  double distances2[64], known2 = known * known;
  int n = 1, n_leaves = 0;
  stack[0] = 1;
  distances2[0] = 0.0;
  while (n > 0 && least2 > known2 && n_leaves < MOST_LEAVES) {
    size_t i = stack[--n];
    if (distances2[n] >= least2)
      continue;
    if (i >= tree->n_leaves) {
      least2 = distance2_in_leaf(tree, i - tree->n_leaves, at, least2, nearest);
      n_leaves++;
      continue;
    }
    double first2 = distance2_to_box(&tree->boxes[2 * i], at), second2 = distance2_to_box(&tree->boxes[2 * i + 1], at);
    size_t farther = first2 <= second2;
    stack[n] = 2 * i + farther;
    distances2[n++] = farther ? second2 : first2;
    stack[n] = 2 * i + !farther;
    distances2[n++] = farther ? first2 : second2;
  }
  return least2;
}

double conic_face_tree_farther(const conic_face_tree *tree, const double at[3], double known) {
  uint32_t nearest = 0;
  double least2 = search(tree, at, HUGE_VAL, known, &nearest);
  return least2 > known * known && least2 < HUGE_VAL ? sqrt(least2) : known;
}

double conic_face_distance(const conic_mesh *mesh, uint32_t face, const double at[3]) {
  double distance2 = conic_distance2_to_face(mesh, face, at);
  return distance2 >= 0.0 ? sqrt(distance2) : HUGE_VAL;
}

double conic_face_tree_farther_by(const conic_face_tree *tree, const double at[3], uint32_t guess, double known) {
  double bound = conic_face_tree_bound(tree, at, &guess, known);
  return bound > known ? bound : known;
}

double conic_face_tree_bound(const conic_face_tree *tree, const double at[3], uint32_t *near, double enough) {
  double guessed2 = conic_distance2_to_face(tree->mesh, *near, at);
  double least2 = search(tree, at, guessed2 >= 0.0 ? guessed2 : HUGE_VAL, enough, near);
  return least2 < HUGE_VAL ? sqrt(least2) : enough;
}
