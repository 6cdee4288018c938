/* Scenes of flat faces that meet in sharp edges: a cube, and a cube without an octant. Every face is perpendicular to
 * an axis. */

#include "core/scenes/scene_kind.h"

/* A face at axis = level, facing ±axis: the square [low, high]² of the next two axes, without its positive quarter
 * where it is notched. */
typedef struct box_face {
  int axis, is_notched;
  double side, level, low, high;
} box_face;

/* A rectangle of a face, sampled by itself; its area in 24ths of the whole. */
typedef struct box_piece {
  int i_face;
  double low[2], high[2];
  uint64_t area;
} box_piece;

enum { MAX_PIECES = 12, WHOLE = 24, CHECKERS = 8 };

typedef struct sharp_box {
  int n_pieces;
  const box_face *faces;
  box_piece pieces[MAX_PIECES];
} sharp_box;

static const box_face cube_faces[] = {{0, 0, -1.0, -0.5, -0.5, 0.5}, {1, 0, -1.0, -0.5, -0.5, 0.5},
                                      {2, 0, -1.0, -0.5, -0.5, 0.5}, {0, 0, 1.0, 0.5, -0.5, 0.5},
                                      {1, 0, 1.0, 0.5, -0.5, 0.5},   {2, 0, 1.0, 0.5, -0.5, 0.5}};

static const sharp_box cube = {
    6,
    cube_faces,
    {{0, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {1, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {2, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {3, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {4, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {5, {-0.5, -0.5}, {0.5, 0.5}, 4}},
};

static const box_face corner_faces[] = {
    {0, 0, -1.0, -0.5, -0.5, 0.5}, {1, 0, -1.0, -0.5, -0.5, 0.5}, {2, 0, -1.0, -0.5, -0.5, 0.5},
    {0, 1, 1.0, 0.5, -0.5, 0.5},   {1, 1, 1.0, 0.5, -0.5, 0.5},   {2, 1, 1.0, 0.5, -0.5, 0.5},
    {0, 0, 1.0, 0.0, 0.0, 0.5},    {1, 0, 1.0, 0.0, 0.0, 0.5},    {2, 0, 1.0, 0.0, 0.0, 0.5}};

static const sharp_box corner = {
    12,
    corner_faces,
    {{0, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {1, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {2, {-0.5, -0.5}, {0.5, 0.5}, 4},
     {3, {-0.5, -0.5}, {0.5, 0.0}, 2},
     {3, {-0.5, 0.0}, {0.0, 0.5}, 1},
     {4, {-0.5, -0.5}, {0.5, 0.0}, 2},
     {4, {-0.5, 0.0}, {0.0, 0.5}, 1},
     {5, {-0.5, -0.5}, {0.5, 0.0}, 2},
     {5, {-0.5, 0.0}, {0.0, 0.5}, 1},
     {6, {0.0, 0.0}, {0.5, 0.5}, 1},
     {7, {0.0, 0.0}, {0.5, 0.5}, 1},
     {8, {0.0, 0.0}, {0.5, 0.5}, 1}},
};

/* A light and a dark checker for each face. */
static const uint8_t palette[][2][3] = {
    {{0xe8, 0x6a, 0x5c}, {0xc9, 0x4f, 0x43}}, {{0xf2, 0xc1, 0x4e}, {0xd8, 0xa4, 0x2f}},
    {{0x5b, 0xa8, 0x8e}, {0x43, 0x8c, 0x73}}, {{0x4f, 0x8f, 0xc0}, {0x39, 0x75, 0xa5}},
    {{0xe9, 0xe4, 0xd4}, {0xcf, 0xc8, 0xb2}}, {{0x9a, 0x7b, 0xb8}, {0x80, 0x61, 0x9f}},
    {{0xd9, 0x8c, 0x5f}, {0xbd, 0x72, 0x47}}, {{0x8f, 0xb3, 0x5a}, {0x76, 0x98, 0x43}},
    {{0x6f, 0x7f, 0x92}, {0x59, 0x68, 0x7a}}};

static const sharp_box *box_of(const conic_scene *scene) {
  return scene->options.type == CONIC_SCENE_CUBE ? &cube : &corner;
}

static conic_status prepare_box(conic_scene *scene) {
  scene->area = 6.0; /* without the octant, the outside has three quarters less, and the inside three more */
  return CONIC_OK;
}

/* The piece of sample i, and the sample's number among the piece's n. */
static const box_piece *piece_at(const conic_scene *scene, uint64_t i, uint64_t *i_in_piece, uint64_t *n) {
  const sharp_box *b = box_of(scene);
  uint64_t count = scene->options.count, area = 0, first = 0;
  for (int k = 0;; k++) {
    area += b->pieces[k].area;
    uint64_t end = count * area / WHOLE;
    if (i < end || k == b->n_pieces - 1) {
      *i_in_piece = i - first;
      *n = end - first;
      return &b->pieces[k];
    }
    first = end;
  }
}

static void place_on_box(const conic_scene *scene, uint64_t i, conic_scene_point *point) {
  uint64_t i_in_piece, n;
  double at[2];
  const box_piece *piece = piece_at(scene, i, &i_in_piece, &n);
  const box_face *face = &box_of(scene)->faces[piece->i_face];
  conic_scene_golden(i_in_piece, n, &at[0], &at[1]);
  *point = (conic_scene_point){.position = {0.0, 0.0, 0.0}};
  point->position[face->axis] = face->level;
  point->normal[face->axis] = face->side;
  int parity = 0;
  for (int k = 0; k < 2; k++) {
    double coordinate = piece->low[k] + at[k] * (piece->high[k] - piece->low[k]);
    point->position[(face->axis + 1 + k) % 3] = coordinate;
    parity += (int)((coordinate + 0.5) * CHECKERS);
  }
  for (int c = 0; c < 3; c++)
    point->color[c] = palette[piece->i_face][parity % 2][c];
}

static void add_edge(conic_scene_edges *edges, const box_face *face, int k, double side, double distance) {
  if (edges->n < CONIC_SCENE_MAX_EDGES) {
    for (int axis = 0; axis < 3; axis++)
      edges->inward[edges->n][axis] = axis == (face->axis + 1 + k) % 3 ? side : 0.0;
    edges->distance[edges->n] = distance;
  }
  edges->n++;
}

/* Finds the edges nearer than `reach`. At the notch's tip the face is the side before either of its edges; past the tip
 * the other edge does not concern the splat. Returns 0 where clip lines cannot express that. */
static int find_edges(const box_face *face, const double at[2], double reach, conic_scene_edges *edges) {
  edges->n = 0;
  edges->operation = CONIC_CLIP_AND;
  double past[2] = {at[0] > 0.0 ? 0.0 : -at[0], at[1] > 0.0 ? 0.0 : -at[1]};
  if (face->is_notched && past[0] * past[0] + past[1] * past[1] < reach * reach) {
    if (at[0] < reach)
      add_edge(edges, face, 0, -1.0, -at[0]);
    if (at[1] < reach)
      add_edge(edges, face, 1, -1.0, -at[1]);
    if (edges->n == 2)
      edges->operation = CONIC_CLIP_OR;
  }
  int n_of_notch = edges->n;
  for (int k = 0; k < 2; k++) {
    if (at[k] - face->low < reach)
      add_edge(edges, face, k, 1.0, at[k] - face->low);
    if (face->high - at[k] < reach)
      add_edge(edges, face, k, -1.0, face->high - at[k]);
  }
  return edges->n <= CONIC_SCENE_MAX_EDGES && !(n_of_notch == 2 && edges->n > 2);
}

/* Finds all edges that a splat twice as large would touch, so that the prefilter does not widen it beyond its face; if
 * these are too many, only those that it touches itself. */
static void edges_at(const conic_scene *scene, uint64_t i, const double position[3], double radius,
                     conic_scene_edges *edges) {
  uint64_t i_in_piece, n;
  const box_face *face = &box_of(scene)->faces[piece_at(scene, i, &i_in_piece, &n)->i_face];
  const double at[2] = {position[(face->axis + 1) % 3], position[(face->axis + 2) % 3]};
  if (!find_edges(face, at, 2.0 * radius, edges))
    find_edges(face, at, radius, edges);
  edges->n = edges->n < CONIC_SCENE_MAX_EDGES ? edges->n : CONIC_SCENE_MAX_EDGES;
}

const conic_scene_kind conic_scene_cube = {.name = "cube",
                                           .summary = "edge 1, sharp by clip lines; from 60 splats on",
                                           .prepare = prepare_box,
                                           .place = place_on_box,
                                           .edges = edges_at};
const conic_scene_kind conic_scene_corner = {.name = "corner",
                                             .summary = "a cube without an octant: concave edges too; from 220 on",
                                             .prepare = prepare_box,
                                             .place = place_on_box,
                                             .edges = edges_at};
