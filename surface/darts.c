#include "surface/darts.h"

#include "core/base/vectors.h"

enum { N_COVERS = 32 };

/* The lattice's step, as a share of the radius. */
static const double STEP = 0.25;

/* On a surface of radius R, a corner at the distance d sees a place d² / 2R below its tangent plane; that is half of
 * how far the plane through the corners is below it. */
static const double LIFT = 0.5;

/* The share of a radius that rounding may take. */
static const double SAFETY = 1e-6;

conic_status conic_dart_board_begin(conic_context *context, double radius, size_t n_expected, conic_dart_board *board) {
  *board = (conic_dart_board){.context = context, .radius = radius, .inverse_side = 0.5 / radius, .n_heads = 1024};
  while (board->n_heads < n_expected && board->n_heads < SIZE_MAX / 16)
    board->n_heads *= 2;
  board->heads = conic_memory_allocate_zeroed(context, board->n_heads, sizeof *board->heads);
  return board->heads ? CONIC_OK : CONIC_ERROR_MEMORY;
}

void conic_dart_board_end(conic_dart_board *board) {
  conic_memory_release_these(board->context, board->places, board->next, board->heads);
  memset(board, 0, sizeof *board);
}

/* The number of a cell's column along an axis; columns beyond all numbers share the last. */
static int64_t dart_column(double scaled) {
  double column = floor(scaled);
  return column > -4e18 && column < 4e18 ? (int64_t)column : INT64_MAX / 2;
}

static size_t head_of(const conic_dart_board *board, int64_t x, int64_t y, int64_t z) {
  uint64_t mixed = (uint64_t)x * UINT64_C(0x9E3779B97F4A7C15) ^ (uint64_t)y * UINT64_C(0xC2B2AE3D27D4EB4F) ^
                   (uint64_t)z * UINT64_C(0x165667B19E3779F9);
  mixed ^= mixed >> 29;
  return (size_t)((mixed * UINT64_C(0xBF58476D1CE4E5B9)) >> 32) & (board->n_heads - 1);
}

static conic_status make_dart_room(conic_dart_board *board) {
  size_t room = board->room;
  conic_status status =
      conic_memory_reserve(board->context, &board->places, board->n, board->n + 1, &room, sizeof *board->places);
  if (status == CONIC_OK)
    status =
        conic_memory_reserve(board->context, &board->next, board->n, board->n + 1, &board->room, sizeof *board->next);
  return status;
}

conic_status conic_dart_board_add(conic_dart_board *board, const double place[3]) {
  if (board->n >= UINT32_MAX - 1 || (board->n >= board->room && make_dart_room(board) != CONIC_OK))
    return CONIC_ERROR_MEMORY;
  const double s = board->inverse_side;
  size_t head = head_of(board, dart_column(place[0] * s), dart_column(place[1] * s), dart_column(place[2] * s));
  memcpy(board->places[board->n], place, sizeof board->places[0]);
  board->next[board->n] = board->heads[head];
  board->heads[head] = (uint32_t)++board->n;
  return CONIC_OK;
}

static int is_dart_within(const double a[3], const double b[3], double radius) {
  double d[3];
  conic_subtract(a, b, d);
  return conic_dot(d, d) < radius * radius;
}

static int is_near_dart(const conic_dart_board *board, uint32_t i, const double place[3]) {
  return is_dart_within(board->places[i], place, board->radius);
}

int conic_dart_board_covers(conic_dart_board *board, const double place[3]) {
  if (board->last < board->n && is_near_dart(board, board->last, place))
    return 1;
  int64_t first[3];
  for (int axis = 0; axis < 3; axis++) /* a radius is half a side: two columns along each axis hold all neighbours */
    first[axis] = dart_column(place[axis] * board->inverse_side - 0.5);
  for (int i = 0; i < 8; i++) {
    size_t head = head_of(board, first[0] + (i & 1), first[1] + (i >> 1 & 1), first[2] + (i >> 2));
    for (uint32_t at = board->heads[head]; at; at = board->next[at - 1])
      if (is_near_dart(board, at - 1, place)) {
        board->last = at - 1;
        return 1;
      }
  }
  return 0;
}

static double edge_of(const conic_dart_triangle *triangle, int i) {
  double d[3];
  conic_subtract(triangle->corners[(i + 1) % 3], triangle->corners[i], d);
  return conic_length(d);
}

static double twice_area_of(const conic_dart_triangle *triangle) {
  double u[3], v[3], across[3];
  conic_subtract(triangle->corners[1], triangle->corners[0], u);
  conic_subtract(triangle->corners[2], triangle->corners[0], v);
  conic_cross(u, v, across);
  return conic_length(across);
}

double conic_dart_reach(const conic_dart_triangle *triangle) {
  double a = edge_of(triangle, 0), b = edge_of(triangle, 1), c = edge_of(triangle, 2);
  double longest = a > b ? (a > c ? a : c) : (b > c ? b : c);
  double twice_area = twice_area_of(triangle), jung = longest * 0.57735026918962584; /* 1/√3 */
  double circle = twice_area > 0.0 ? a * b * c / (2.0 * twice_area) : jung;
  return circle < jung ? circle : jung;
}

/* The place with these shares of the corners, lifted where the triangle is bent. */
static void place_in(const conic_dart_triangle *triangle, const double shares[3], double place[3]) {
  double flat[3], lift[3] = {0.0, 0.0, 0.0};
  for (int axis = 0; axis < 3; axis++)
    flat[axis] = shares[0] * triangle->corners[0][axis] + shares[1] * triangle->corners[1][axis] +
                 shares[2] * triangle->corners[2][axis];
  for (int i = 0; i < 3 && triangle->is_bent; i++) {
    double d[3];
    conic_subtract(triangle->corners[i], flat, d);
    double height = LIFT * shares[i] * conic_dot(d, triangle->normals[i]);
    for (int axis = 0; axis < 3; axis++)
      lift[axis] += height * triangle->normals[i][axis];
  }
  for (int axis = 0; axis < 3; axis++)
    place[axis] = flat[axis] + lift[axis];
}

/* The most that place_in lifts a place of the triangle. Each pair of corners lifts by the product of their shares;
 * these products add up to at most 1/3. */
static double greatest_lift(const conic_dart_triangle *triangle) {
  double greatest = 0.0;
  for (int i = 0; i < 3 && triangle->is_bent; i++) {
    double d[3];
    conic_subtract(triangle->corners[i], triangle->corners[(i + 1) % 3], d);
    double height = fabs(conic_dot(d, triangle->normals[i])) + fabs(conic_dot(d, triangle->normals[(i + 1) % 3]));
    greatest = height > greatest ? height : greatest;
  }
  return LIFT * greatest / 3.0;
}

/* How many steps from `from`, a place of the flat triangle, stay within `reach` of `center`; 0 where it is not within
 * reach itself. */
static double steps_within(const double from[3], const double step[3], const double center[3], double reach) {
  double d[3], step2 = conic_dot(step, step);
  conic_subtract(from, center, d);
  double along = conic_dot(d, step), rest = reach * reach - conic_dot(d, d);
  return reach > 0.0 && rest > 0.0 && step2 > 0.0 ? floor((sqrt(along * along + step2 * rest) - along) / step2) : 0.0;
}

/* Places that covered parts of a triangle: its corners, and the latest others. */
typedef struct triangle_covers {
  double places[N_COVERS][3];
  int n, last; /* how many there are, and the one used last */
} triangle_covers;

static void add_cover(triangle_covers *covers, const double place[3]) {
  covers->last = covers->n < N_COVERS ? covers->n++ : covers->last < N_COVERS - 1 ? covers->last + 1 : 3;
  memcpy(covers->places[covers->last], place, sizeof covers->places[0]);
}

/* Whether the place is covered: first by places that covered others in its triangle, which is quick, then by any. */
static int is_covered_here(conic_dart_board *board, const double place[3], triangle_covers *covers) {
  if (is_dart_within(covers->places[covers->last], place, board->radius))
    return 1;
  for (int i = 0; i < covers->n; i++)
    if (is_dart_within(covers->places[i], place, board->radius)) {
      covers->last = i;
      return 1;
    }
  if (!conic_dart_board_covers(board, place))
    return 0;
  add_cover(covers, board->places[board->last]);
  return 1;
}

static conic_status throw_at(conic_dart_board *board, const conic_dart_triangle *triangle, uint32_t number,
                             const double shares[3], triangle_covers *covers, conic_darts *darts) {
  conic_dart dart = {.shares = {shares[0], shares[1]}, .triangle = number};
  place_in(triangle, shares, dart.place);
  if (is_covered_here(board, dart.place, covers))
    return CONIC_OK;
  if (conic_memory_append(board->context, &darts->list, &darts->n, &darts->room, &dart, sizeof dart) != CONIC_OK)
    return CONIC_ERROR_MEMORY;
  add_cover(covers, dart.place);
  return conic_dart_board_add(board, dart.place);
}

conic_status conic_darts_throw(conic_dart_board *board, const conic_dart_triangle *triangle, uint32_t number,
                               size_t limit, conic_darts *darts) {
  double edges[3] = {edge_of(triangle, 0), edge_of(triangle, 1), edge_of(triangle, 2)}, step = STEP * board->radius;
  /* Rows are parallel to the longest edge, which is from corner a to b, and go up to c. */
  int a = edges[0] >= edges[1] ? (edges[0] >= edges[2] ? 0 : 2) : (edges[1] >= edges[2] ? 1 : 2);
  int b = (a + 1) % 3, c = (a + 2) % 3;
  conic_status status = CONIC_OK;
  if (!(conic_dart_reach(triangle) > board->radius))
    return CONIC_OK; /* its corners cover it */
  double height = twice_area_of(triangle) / edges[a], n_rows = height > step ? ceil(height / step) : 1.0;
  triangle_covers covers = {.n = 3};
  memcpy(covers.places, triangle->corners, sizeof triangle->corners);
  double reach = (1.0 - SAFETY) * board->radius - greatest_lift(triangle);
  for (double row = 0.0; row < n_rows && status == CONIC_OK; row++) {
    double up = (row + 0.5) / n_rows, n = ceil((1.0 - up) * edges[a] / step);
    double flat[3], steps[3], ahead = 0.0;
    for (int axis = 0; axis < 3; axis++)
      steps[axis] = (1.0 - up) / n * (triangle->corners[b][axis] - triangle->corners[a][axis]);
    for (double k = 0.0; k < n && status == CONIC_OK && darts->n < limit; k += 1.0 + ahead) {
      double along = (1.0 - up) * (k + 0.5) / n, shares[3];
      shares[a] = (1.0 - up) - along;
      shares[b] = along;
      shares[c] = up;
      status = throw_at(board, triangle, number, shares, &covers, darts);
      for (int axis = 0; axis < 3; axis++)
        flat[axis] = shares[0] * triangle->corners[0][axis] + shares[1] * triangle->corners[1][axis] +
                     shares[2] * triangle->corners[2][axis];
      ahead = status == CONIC_OK ? steps_within(flat, steps, covers.places[covers.last], reach) : 0.0;
    }
  }
  return status;
}
