/* Projection where pieces of a surface meet. Each piece is fitted by its own samples alone. Its point counts up to
 * where another piece cuts it off; beyond, the point is on the edge between them, or on the corner of three. The
 * nearest of these points is the result. */

#include "core/base/vectors.h"
#include "surface/least_spread.h"
#include "surface/loops/weight.h"
#include "surface/mls_surface.h"

enum { MAX_NEAR = 512, N_BUCKETS = 256, MAX_PIECES = 4, LEAST_SAMPLES = 6, N_ROUNDS = 3, N_TERMS = 6 };

/* A piece has samples on one side only, so it looks this much farther. */
static const double WIDER = 2.0;

/* Two samples belong to one piece if they are linked: at most so many spacings apart, with normals at most 20° apart.
 * There is a crease only where a sample's normal is over 30° from the nearest one's. */
static const double LINK = 1.8, LINKED_COSINE = 0.93969262078590838, CREASE_COSINE = 0.86602540378443865;

/* A piece is bent if a quadratic fit reduces the residual by more than noise would. */
static const double BENT = 4.0;

/* A place that moves by less than this many h has settled. */
static const double SETTLED = 2e-3;

/* A piece is part of larger ones if its samples are off the nearest of them by so many spacings, rms. */
static const double IN_OTHERS = 0.5;

/* Edges and corners farther away than so many spacings are ignored. */
static const double FARTHEST_EDGE = 3.0;

/* The samples near a place, relative to it, and their pieces. */
typedef struct crease_scene {
  const conic_surface *surface;
  const conic_near *near;
  size_t n;
  double spacing, from_place2[MAX_NEAR];
  int8_t piece[MAX_NEAR];                    /* -1: none yet */
  int32_t cells[MAX_NEAR][3];                /* with sides as long as links */
  uint16_t heads[N_BUCKETS], next[MAX_NEAR]; /* samples without a piece, by hashed cell: lists of 1 + number; 0: the
                                                end */
  uint16_t by_distance[MAX_NEAR];
  int n_pieces;
  uint16_t members[MAX_NEAR];    /* the samples of the pieces, piece by piece */
  size_t starts[MAX_PIECES + 1]; /* in `members` */
  double weights[MAX_NEAR];      /* of a piece's members, about a place */
} crease_scene;

/* A point of a piece. */
typedef struct piece_point {
  double place[3], normal[3];
  int is_there;
} piece_point;

static const float *side_of_crease(const crease_scene *scene, size_t i) {
  return scene->surface->creases.side[scene->near->sources[i]];
}

static double turned(const crease_scene *scene, size_t i, size_t j) {
  const float *a = side_of_crease(scene, i), *b = side_of_crease(scene, j);
  return fabs((double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2]);
}

static double apart2(const crease_scene *scene, size_t i, size_t j) {
  double sum = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    double d = scene->near->offset[axis][i] - scene->near->offset[axis][j];
    sum += d * d;
  }
  return sum;
}

static unsigned link_bucket(const int32_t cell[3], int x, int y, int z) {
  uint32_t mixed = (uint32_t)(cell[0] + x) * UINT32_C(0x9E3779B1);
  mixed = (mixed + (uint32_t)(cell[1] + y)) * UINT32_C(0x9E3779B1);
  return ((mixed + (uint32_t)(cell[2] + z)) * UINT32_C(0x9E3779B1)) >> 24;
}

static void sort_into_link_cells(crease_scene *scene) {
  memset(scene->heads, 0, sizeof scene->heads);
  for (size_t i = 0; i < scene->n; i++) {
    for (int axis = 0; axis < 3; axis++) {
      double cell = floor(scene->near->offset[axis][i] / (LINK * scene->spacing));
      scene->cells[i][axis] = (int32_t)(fabs(cell) < 1e6 ? cell : 1e6);
    }
    unsigned bucket = link_bucket(scene->cells[i], 0, 0, 0);
    scene->next[i] = scene->heads[bucket];
    scene->heads[bucket] = (uint16_t)(i + 1);
  }
}

/* Sorts by distance, the nearest first. */
static void sort_by_distance(crease_scene *scene) {
  for (size_t gap = scene->n / 2; gap; gap /= 2) /* a shell sort: the gathered order is nearly sorted */
    for (size_t i = gap; i < scene->n; i++) {
      uint16_t moving = scene->by_distance[i];
      size_t at = i;
      for (; at >= gap && scene->from_place2[scene->by_distance[at - gap]] > scene->from_place2[moving]; at -= gap)
        scene->by_distance[at] = scene->by_distance[at - gap];
      scene->by_distance[at] = moving;
    }
}

static int are_linked(const crease_scene *scene, size_t i, size_t j) {
  return apart2(scene, i, j) <= LINK * LINK * scene->spacing * scene->spacing && turned(scene, i, j) >= LINKED_COSINE;
}

/* Gives all samples linked to `first` the number, if they are enough, else the strays' number. Returns whether they are
 * enough. */
static int grow_piece(crease_scene *scene, size_t first, int8_t number) {
  uint16_t queue[MAX_NEAR];
  size_t n = 0;
  queue[n++] = (uint16_t)first;
  scene->piece[first] = number;
  for (uint16_t *link = &scene->heads[link_bucket(scene->cells[first], 0, 0, 0)]; *link;
       link = &scene->next[*link - 1u])
    if (*link == first + 1) {
      *link = scene->next[first];
      break;
    }
  for (size_t at = 0; at < n; at++)
    for (int step = 0; step < 27; step++) {
      unsigned bucket = link_bucket(scene->cells[queue[at]], step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1);
      for (uint16_t *link = &scene->heads[bucket]; *link;) {
        size_t i = *link - 1u;
        int is_taken = are_linked(scene, queue[at], i);
        if (is_taken) {
          scene->piece[i] = number;
          queue[n++] = (uint16_t)i;
          *link = scene->next[i];
        } else
          link = &scene->next[i];
      }
    }
  for (size_t i = 0; i < n && n < LEAST_SAMPLES; i++)
    scene->piece[queue[i]] = MAX_PIECES;
  return n >= LEAST_SAMPLES;
}

/* Whether a sample would have weight for the place on a surface that is not sharp. */
static int is_in_reach(const crease_scene *scene, size_t i) {
  return scene->from_place2[i] * scene->near->inverse_h2[i] < scene->surface->weighing.end;
}

static void list_piece_members(crease_scene *scene) {
  size_t n = 0;
  for (int piece = 0; piece < scene->n_pieces; piece++) {
    scene->starts[piece] = n;
    for (size_t i = 0; i < scene->n; i++)
      if (scene->piece[i] == piece)
        scene->members[n++] = (uint16_t)i;
  }
  scene->starts[scene->n_pieces] = n;
}

/* Splits the samples into pieces; returns 0 where those in reach are one piece. */
static int split(crease_scene *scene) {
  int has_crease = 0, is_mixed = 0;
  size_t first = 0;
  for (size_t i = 0; i < scene->n; i++) {
    double sum = 0.0;
    for (int axis = 0; axis < 3; axis++)
      sum += scene->near->offset[axis][i] * scene->near->offset[axis][i];
    scene->from_place2[i] = sum;
    scene->piece[i] = -1;
    scene->by_distance[i] = (uint16_t)i;
    first = sum < scene->from_place2[first] ? i : first;
  }
  if (!scene->n)
    return 0;
  scene->spacing = (double)scene->surface->creases.spacing[scene->near->sources[first]];
  for (size_t i = 0; i < scene->n && !has_crease; i++)
    has_crease = is_in_reach(scene, i) && turned(scene, first, i) < CREASE_COSINE;
  if (!has_crease)
    return 0;
  sort_by_distance(scene);
  sort_into_link_cells(scene);
  for (size_t i = 0; i < scene->n && scene->n_pieces < MAX_PIECES; i++)
    if (scene->piece[scene->by_distance[i]] == -1)
      scene->n_pieces += grow_piece(scene, scene->by_distance[i], (int8_t)scene->n_pieces);
  list_piece_members(scene);
  for (size_t i = 0; i < scene->n && scene->n_pieces > 1; i++)
    is_mixed |= scene->piece[i] > 0 && scene->piece[i] < scene->n_pieces && is_in_reach(scene, i);
  return is_mixed;
}

static double weight_at(const crease_scene *scene, size_t i, const double at[3]) {
  const conic_near *near = scene->near;
  double d[3] = {near->offset[0][i] - at[0], near->offset[1][i] - at[1], near->offset[2][i] - at[2]};
  double s = conic_dot(d, d) * near->inverse_h2[i] / (WIDER * WIDER);
  return conic_weight_at(&scene->surface->weighing, s).value * near->mass[i];
}

/* Solves the n by n system in place by elimination without pivoting, as sums of squares allow; returns 0 where there is
 * no solution. */
static int solve(int n, double m[N_TERMS][N_TERMS], double x[N_TERMS]) {
  for (int i = 0; i < n; i++) {
    if (!(m[i][i] > 1e-10))
      return 0;
    for (int j = i + 1; j < n; j++) {
      double share = m[j][i] / m[i][i];
      for (int k = i; k < n; k++)
        m[j][k] -= share * m[i][k];
      x[j] -= share * x[i];
    }
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++)
      x[i] -= m[i][k] * x[k];
    x[i] /= m[i][i];
  }
  return 1;
}

/* Fits heights over a frame at a place, by least squares: 1, x, y, and for n = 6 also x², xy, y², in units of `unit`.
 * Returns the weighted mean square of the residuals, or infinity. */
static double fit_heights(const crease_scene *scene, int piece, const double at[3], double frame[3][3], double unit,
                          int n, double solution[N_TERMS]) {
  double m[N_TERMS][N_TERMS] = {{0.0}}, right[N_TERMS] = {0.0}, squares = 0.0, sum = 0.0;
  for (size_t k = scene->starts[piece]; k < scene->starts[piece + 1]; k++) {
    size_t i = scene->members[k];
    double w = scene->weights[k], local[3];
    if (!(w > 0.0))
      continue;
    for (int row = 0; row < 3; row++)
      local[row] =
          ((scene->near->offset[0][i] - at[0]) * frame[row][0] + (scene->near->offset[1][i] - at[1]) * frame[row][1] +
           (scene->near->offset[2][i] - at[2]) * frame[row][2]) /
          unit;
    const double terms[N_TERMS] = {
        1.0, local[0], local[1], local[0] * local[0], local[0] * local[1], local[1] * local[1]};
    for (int row = 0; row < n; row++) {
      right[row] += w * terms[row] * local[2];
      for (int column = 0; column < n; column++)
        m[row][column] += w * terms[row] * terms[column];
    }
    squares += w * local[2] * local[2];
    sum += w;
  }
  for (int row = 0; row < n; row++) {
    solution[row] = right[row] / sum;
    for (int column = 0; column < n; column++)
      m[row][column] /= sum;
  }
  if (!(sum > 0.0) || !solve(n, m, solution))
    return HUGE_VAL;
  for (int row = 0; row < n; row++)
    squares -= solution[row] * right[row];
  return squares > 0.0 ? squares / sum : 0.0;
}

/* Finds a piece's weights about a place, and the frame whose normal is the direction of least spread. Returns how many
 * samples have weight. */
static size_t frame_of(crease_scene *scene, int piece, const double at[3], double frame[3][3]) {
  double sum = 0.0, mean[3] = {0.0}, products[6] = {0.0};
  size_t count = 0;
  for (size_t at_member = scene->starts[piece]; at_member < scene->starts[piece + 1]; at_member++) {
    size_t i = scene->members[at_member];
    double w = scene->weights[at_member] = weight_at(scene, i, at), d[3];
    if (!(w > 0.0))
      continue;
    for (int axis = 0; axis < 3; axis++) {
      d[axis] = scene->near->offset[axis][i] - at[axis];
      mean[axis] += w * d[axis];
    }
    for (int a = 0, k = 0; a < 3; a++)
      for (int b = a; b < 3; b++, k++)
        products[k] += w * d[a] * d[b];
    sum += w;
    count++;
  }
  if (count < LEAST_SAMPLES)
    return 0;
  for (int axis = 0; axis < 3; axis++)
    mean[axis] /= sum;
  for (int a = 0, k = 0; a < 3; a++)
    for (int b = a; b < 3; b++, k++)
      products[k] = products[k] / sum - mean[a] * mean[b];
  conic_least_spread(products, frame);
  return count;
}

/* The piece's point for a place: on the plane of its samples, or, where that fits badly, on a bent surface. */
static piece_point land_on(crease_scene *scene, int piece, const double from[3], double h) {
  piece_point point = {.is_there = 0};
  memcpy(point.place, from, sizeof point.place);
  for (int round = 0; round < N_ROUNDS; round++) {
    double frame[3][3], flat[N_TERMS], bent[N_TERMS], n[3];
    size_t count = frame_of(scene, piece, point.place, frame);
    point.is_there = 0;
    if (!count)
      return point;
    double left = fit_heights(scene, piece, point.place, frame, h, 3, flat);
    double left_bent =
        count >= (size_t)2 * N_TERMS ? fit_heights(scene, piece, point.place, frame, h, N_TERMS, bent) : HUGE_VAL;
    int is_bent = (left - left_bent) / 3.0 > BENT * left_bent / (double)(count - N_TERMS) && left_bent < HUGE_VAL;
    const double *fit = is_bent ? bent : flat;
    if (!is_bent && !(left < HUGE_VAL))
      return point;
    for (int axis = 0; axis < 3; axis++)
      n[axis] = frame[2][axis] - fit[1] * frame[0][axis] - fit[2] * frame[1][axis];
    conic_normalize(n);
    double move = h * fit[0] * conic_dot(n, frame[2]);
    for (int axis = 0; axis < 3; axis++)
      point.place[axis] += move * n[axis];
    memcpy(point.normal, n, sizeof n);
    point.is_there = 1;
    if (fabs(move) < SETTLED * h)
      break;
  }
  return point;
}

static size_t n_members(const crease_scene *scene, int piece) {
  return scene->starts[piece + 1] - scene->starts[piece];
}

/* Finds the planes of all larger pieces near this one's middle. */
static void land_larger(crease_scene *scene, int piece, double h, piece_point planes[MAX_PIECES]) {
  double middle[3] = {0.0};
  for (size_t k = scene->starts[piece]; k < scene->starts[piece + 1]; k++)
    for (int axis = 0; axis < 3; axis++)
      middle[axis] += scene->near->offset[axis][scene->members[k]] / (double)n_members(scene, piece);
  for (int other = 0; other < scene->n_pieces; other++) {
    planes[other].is_there = 0;
    if (n_members(scene, other) > n_members(scene, piece))
      planes[other] = land_on(scene, other, middle, h);
  }
}

/* Gives the samples of a piece to larger pieces if they lie in those: then noise has given them wrong sides, as happens
 * near an edge. Returns whether it did. */
/* NOLINTBEGIN(clang-analyzer-core.*): a plane that is not there has no place, and none is as near as any limit */
static int give_away(crease_scene *scene, int piece, double h) {
  piece_point planes[MAX_PIECES];
  int8_t nearest[MAX_NEAR];
  double sum = 0.0, limit = IN_OTHERS * scene->spacing;
  size_t n = 0;
  land_larger(scene, piece, h, planes);
  for (size_t k = scene->starts[piece]; k < scene->starts[piece + 1]; k++, n++) {
    double least = HUGE_VAL;
    for (int other = 0; other < scene->n_pieces; other++) {
      double d[3];
      for (int axis = 0; axis < 3; axis++)
        d[axis] = scene->near->offset[axis][scene->members[k]] - planes[other].place[axis];
      double height = planes[other].is_there ? fabs(conic_dot(d, planes[other].normal)) : HUGE_VAL;
      nearest[n] = height < least ? (int8_t)other : nearest[n];
      least = height < least ? height : least;
    }
    sum += least * least;
  }
  if (!(sum <= (double)n * limit * limit))
    return 0;
  for (size_t k = 0; k < n; k++)
    scene->piece[scene->members[scene->starts[piece] + k]] = nearest[k];
  return 1;
}
/* NOLINTEND(clang-analyzer-core.*) */

/* Keeps the pieces that others do not contain; returns whether there are several. */
static int join_pieces(crease_scene *scene, double h) {
  for (int piece = scene->n_pieces - 1; piece >= 0 && scene->n_pieces > 1; piece--) {
    if (!give_away(scene, piece, h))
      continue;
    scene->n_pieces--;
    for (size_t i = 0; i < scene->n; i++)
      if (scene->piece[i] > piece && scene->piece[i] <= scene->n_pieces)
        scene->piece[i]--;
    list_piece_members(scene);
  }
  return scene->n_pieces > 1;
}

/* On which side of another piece's plane the samples of a piece are, as a sum of heights. */
static double lean(const crease_scene *scene, int piece, const piece_point *other) {
  double sum = 0.0;
  for (size_t k = scene->starts[piece]; k < scene->starts[piece + 1]; k++) {
    double d[3];
    for (int axis = 0; axis < 3; axis++)
      d[axis] = scene->near->offset[axis][scene->members[k]] - other->place[axis];
    sum += conic_dot(d, other->normal);
  }
  return sum;
}

/* Moves a place the shortest way onto 1 to 3 planes; returns 0 where they do not meet. */
static int meet_planes(const piece_point *const planes[3], int n, double place[3]) {
  double m[N_TERMS][N_TERMS] = {{0.0}}, x[N_TERMS] = {0.0};
  for (int i = 0; i < n; i++) {
    double d[3];
    conic_subtract(planes[i]->place, place, d);
    x[i] = conic_dot(d, planes[i]->normal);
    for (int k = 0; k < n; k++)
      m[i][k] = conic_dot(planes[i]->normal, planes[k]->normal);
    m[i][i] += 1e-9;
  }
  for (int i = 1; i < n; i++) /* two planes are nearly the same */
    for (int k = 0; k < i; k++)
      if (fabs(m[i][k]) > LINKED_COSINE)
        return 0;
  if (!solve(n, m, x))
    return 0;
  for (int i = 0; i < n; i++)
    for (int axis = 0; axis < 3; axis++)
      place[axis] += x[i] * planes[i]->normal[axis];
  return 1;
}

/* The piece's own point, if no other piece cuts it off there; else a point of the edge, or the corner. */
static piece_point land_within(crease_scene *scene, int piece, double h) {
  static const double origin[3] = {0.0, 0.0, 0.0};
  piece_point points[MAX_PIECES], result = land_on(scene, piece, origin, h);
  const piece_point *cutting[3] = {&points[piece]};
  int n_cutting = 1, is_cutting[MAX_PIECES] = {0};
  points[piece] = result;
  for (int round = 0; round < MAX_PIECES - 1 && result.is_there && n_cutting < 3; round++) {
    int n_before = n_cutting;
    for (int other = 0; other < scene->n_pieces && n_cutting < 3; other++) {
      double d[3];
      if (other == piece || is_cutting[other])
        continue;
      points[other] = land_on(scene, other, result.place, h);
      conic_subtract(result.place, points[other].place, d);
      double side = points[other].is_there ? lean(scene, piece, &points[other]) : 0.0;
      double over = conic_dot(d, points[other].normal);
      if (!(side * over < 0.0) || fabs(conic_dot(points[other].normal, result.normal)) > LINKED_COSINE)
        continue;
      is_cutting[other] = 1;
      cutting[n_cutting++] = &points[other];
      break;
    }
    if (n_cutting == n_before)
      break;
    double place[3];
    memcpy(place, result.place, sizeof place);
    for (int turn = 0; turn < 2; turn++) {
      if (!meet_planes(cutting, n_cutting, place))
        break;
      for (int i = 0; i < MAX_PIECES && turn == 0; i++) /* the planes of bent pieces differ there */
        if (i == piece || is_cutting[i]) {
          piece_point there = land_on(scene, i, place, h);
          points[i] = there.is_there ? there : points[i];
        }
    }
    memcpy(result.place, place, sizeof place);
  }
  if (n_cutting > 1 && conic_length(result.place) > FARTHEST_EDGE * scene->spacing)
    result.is_there = 0;
  return result;
}

int conic_creases_project(const conic_surface *surface, const double r[3], double h, uint32_t except,
                          conic_workspace *workspace, conic_landing *landing) {
  const double box[6] = {r[0], r[1], r[2], r[0], r[1], r[2]};
  double margin = (WIDER - 1.0) * surface->options.neglect * h, nearest = HUGE_VAL;
  crease_scene scene;
  piece_point best = {.is_there = 0};
  int best_piece = -1;
  conic_surface_gather(surface, box, margin, workspace, &workspace->single);
  conic_surface_select(surface, &workspace->single, r, margin, except, workspace);
  scene.surface = surface;
  scene.near = &workspace->near;
  scene.n_pieces = 0;
  scene.n = workspace->near.n < MAX_NEAR ? workspace->near.n : MAX_NEAR;
  if (!split(&scene))
    return 0;
  if (!join_pieces(&scene, h))
    return 0;
  workspace->n_evaluations++;
  for (int piece = 0; piece < scene.n_pieces; piece++) {
    piece_point point = land_within(&scene, piece, h);
    if (!point.is_there || !(conic_length(point.place) < nearest))
      continue;
    nearest = conic_length(point.place);
    best = point;
    best_piece = piece;
  }
  landing->outcome = best.is_there ? CONIC_SURFACE_DONE : CONIC_SURFACE_ILL_CONDITIONED;
  landing->n_neighbours = 0;
  for (size_t i = 0; i < workspace->near.n_padded; i++) {
    workspace->near.weights[i] = i < scene.n && scene.piece[i] == best_piece ? weight_at(&scene, i, best.place) : 0.0;
    landing->n_neighbours += workspace->near.weights[i] > 0.0;
  }
  for (int axis = 0; axis < 3; axis++) {
    landing->offset[axis] = landing->foot[axis] = best.place[axis];
    landing->normal[axis] = landing->plane_normal[axis] = best.normal[axis];
  }
  return 1;
}
