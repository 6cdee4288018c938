/* Triangles of what is one, fitted to the mesh: the places of their vertices, and the normals of their corners. Both by
 * least squares over the middles of the mesh's faces, each weighted by its area, at what is nearest to it. */

#include "lod/clusters/cluster_simplifier.h"

/* --- values at corners, by least squares --- */

/* What draws all values towards none, as a part of the mean of the system's diagonal; and how many steps are taken. */
static const double hold = 1e-3;
enum { MOST_STEPS = 16 };
static const double enough = 1e-6; /* of what is left, squared */

/* Up to three values at a time, that are fitted each by itself. */
typedef struct corner_fit {
  conic_context *context;
  size_t n_triangles, n_unknowns;
  int n_values;
  uint32_t (*unknowns)[3]; /* of a triangle's corners; the caller fills them in. None: no such triangle */
  double (*squares)[6];    /* of each triangle, the system's entries for its corners 00, 01, 02, 11, 12, 22 */
  double *right[3], *solution;
  double *work; /* four arrays */
} corner_fit;

/* The caller releases the fit, on failure too. */
static conic_status corner_fit_init(conic_context *context, size_t n_triangles, size_t n_unknowns, int n_values,
                                    corner_fit *fit) {
  *fit = (corner_fit){.context = context, .n_triangles = n_triangles, .n_unknowns = n_unknowns, .n_values = n_values};
  conic_status status = conic_memory_allocate_these(
      context, CONIC_ROOM(fit->unknowns, n_triangles), CONIC_ZEROED(fit->squares, n_triangles),
      CONIC_ZEROED(fit->right[0], n_unknowns * (size_t)n_values), CONIC_ROOM(fit->solution, n_unknowns),
      CONIC_ROOM(fit->work, 4 * n_unknowns));
  for (int i = 1; i < n_values && status == CONIC_OK; i++)
    fit->right[i] = fit->right[i - 1] + n_unknowns;
  return status;
}

static void corner_fit_release(corner_fit *fit) {
  if (fit->context)
    conic_memory_release_these(fit->context, fit->unknowns, fit->squares, fit->right[0], fit->solution, fit->work);
}

/* Asks that at a place the sum of the corners' values times `parts` be `values`. `weight` says how much it matters. */
static void corner_fit_add(corner_fit *fit, size_t triangle, const double parts[3], const double *values,
                           double weight) {
  for (int i = 0, at = 0; i < 3; i++) {
    for (int k = i; k < 3; k++, at++)
      fit->squares[triangle][at] += weight * parts[i] * parts[k];
    for (int value = 0; value < fit->n_values; value++)
      fit->right[value][fit->unknowns[triangle][i]] += weight * parts[i] * values[value];
  }
}

/* The system times x, and x held. */
static void multiply(const corner_fit *fit, double held, const double *x, double *product) {
  for (size_t i = 0; i < fit->n_unknowns; i++)
    product[i] = held * x[i];
  for (size_t i = 0; i < fit->n_triangles; i++) {
    const uint32_t *u = fit->unknowns[i];
    const double *s = fit->squares[i];
    product[u[0]] += s[0] * x[u[0]] + s[1] * x[u[1]] + s[2] * x[u[2]];
    product[u[1]] += s[1] * x[u[0]] + s[3] * x[u[1]] + s[4] * x[u[2]];
    product[u[2]] += s[2] * x[u[0]] + s[4] * x[u[1]] + s[5] * x[u[2]];
  }
}

/* Fills in what the diagonal is with what holds, which is returned. */
static double find_diagonal(const corner_fit *fit, double *diagonal) {
  double sum = 0.0;
  memset(diagonal, 0, fit->n_unknowns * sizeof *diagonal);
  for (size_t i = 0; i < fit->n_triangles; i++) {
    const double *s = fit->squares[i];
    diagonal[fit->unknowns[i][0]] += s[0];
    diagonal[fit->unknowns[i][1]] += s[3];
    diagonal[fit->unknowns[i][2]] += s[5];
    sum += s[0] + s[3] + s[5];
  }
  double held = fit->n_unknowns ? hold * sum / (double)fit->n_unknowns : 0.0;
  for (size_t i = 0; i < fit->n_unknowns; i++)
    diagonal[i] += held;
  return held;
}

static double scaled_square(const double *values, const double *diagonal, size_t n) {
  double sum = 0.0;
  for (size_t i = 0; i < n; i++)
    sum += values[i] * values[i] / diagonal[i];
  return sum;
}

/* By conjugate gradients, scaled by the diagonal. */
/* Finds the best of one of the values: fit->solution, until the next is solved. It is small where nothing is known. */
static void corner_fit_solve(corner_fit *fit, int value) {
  size_t n = fit->n_unknowns;
  double *x = fit->solution, *left = fit->work, *way = left + n, *product = way + n, *diagonal = product + n;
  double held = find_diagonal(fit, diagonal);
  memset(x, 0, n * sizeof *x);
  if (!(held > 0.0))
    return;
  memcpy(left, fit->right[value], n * sizeof *left);
  for (size_t i = 0; i < n; i++)
    way[i] = left[i] / diagonal[i];
  double first = scaled_square(left, diagonal, n), now = first;
  for (int step = 0; step < MOST_STEPS && now > enough * first; step++) {
    double along = 0.0;
    multiply(fit, held, way, product);
    for (size_t i = 0; i < n; i++)
      along += way[i] * product[i];
    if (!(along > 0.0))
      return;
    for (size_t i = 0; i < n; i++) {
      x[i] += now / along * way[i];
      left[i] -= now / along * product[i];
    }
    double next = scaled_square(left, diagonal, n);
    for (size_t i = 0; i < n; i++)
      way[i] = left[i] / diagonal[i] + next / now * way[i];
    now = next;
  }
}

/* --- the simplifier's triangles --- */

/* Numbers what is alive; none else. Returns how many there are. */
static size_t number_alive(const conic_simplifier *s, uint32_t *numbers) {
  size_t n = 0;
  for (size_t i = 0; i < s->n_triangles; i++)
    numbers[i] = s->triangles[i].is_alive ? (uint32_t)n++ : CONIC_NONE;
  return n;
}

/* --- places --- */

/* Which way a vertex may be moved: along the mean normal of its triangles; not at all on a border. */
static void find_ways_of_vertices(const conic_simplifier *s, double (*ways)[3]) {
  memset(ways, 0, s->n_vertices * sizeof *ways);
  for (size_t i = 0; i < s->n_triangles; i++) {
    double cross[3];
    if (!s->triangles[i].is_alive)
      continue;
    conic_simplifier_twice_area(s, i, cross);
    for (int k = 0; k < 9; k++)
      ways[s->triangles[i].corners[k / 3]][k % 3] += cross[k % 3];
  }
  for (size_t i = 0; i < s->n_vertices; i++) {
    if (s->vertices[i].kind != CONIC_VERTEX_FREE)
      memset(ways[i], 0, sizeof ways[i]);
    conic_normalize(ways[i]);
  }
}

/* How far each face's middle is from the plane that is parallel to it where it is nearest. */
static void add_heights(const conic_simplifier *s, const uint32_t *numbers, double (*const ways)[3], corner_fit *fit) {
  for (size_t i = 0; i < s->n_triangles; i++) {
    const conic_simplifier_hit *hit = &s->hits[i];
    double parts[3], height = (double)hit->height;
    if (hit->triangle == CONIC_NONE)
      continue;
    for (int corner = 0; corner < 3; corner++)
      parts[corner] = (double)hit->bary[corner] *
                      conic_dot(ways[s->triangles[hit->triangle].corners[corner]], s->triangles[i].normal);
    corner_fit_add(fit, numbers[hit->triangle], parts, &height, (double)hit->area2);
  }
}

static int may_be_at(const conic_simplifier *s, uint32_t v, const double at[3]) {
  for (uint32_t slot = conic_simplifier_living(s, s->vertices[v].ring); slot != CONIC_NONE;
       slot = conic_simplifier_after(s, slot))
    if (!conic_simplifier_keeps_facing(s, slot, at))
      return 0;
  return 1;
}

/* One after the other, so that no triangle turns over. */
static void move_vertices(const conic_simplifier *s, double (*const ways)[3], const double *steps) {
  for (uint32_t v = 0; v < s->n_vertices; v++) {
    double at[3];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = (double)(float)(s->vertices[v].at[axis] + steps[v] * ways[v][axis]);
    if (!s->vertices[v].is_gone && may_be_at(s, v, at))
      memcpy(s->vertices[v].at, at, sizeof at);
  }
}

/* Without colours they were put where the quadric is least, from where this would put outlines out too far. */
conic_status conic_simplifier_fit_places(conic_simplifier *s) {
  corner_fit fit = {0};
  if (!s->contrasts)
    return CONIC_OK;
  uint32_t *numbers = conic_memory_allocate(s->context, s->n_triangles, sizeof *numbers);
  double(*ways)[3] = conic_memory_allocate(s->context, s->n_vertices, sizeof *ways);
  conic_status status = numbers && ways ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = corner_fit_init(s->context, number_alive(s, numbers), s->n_vertices, 1, &fit);
  if (status == CONIC_OK) {
    for (size_t i = 0; i < s->n_triangles; i++)
      if (numbers[i] != CONIC_NONE)
        memcpy(fit.unknowns[numbers[i]], s->triangles[i].corners, sizeof *fit.unknowns);
    find_ways_of_vertices(s, ways);
    add_heights(s, numbers, ways, &fit);
    corner_fit_solve(&fit, 0);
    move_vertices(s, ways, fit.solution);
  }
  corner_fit_release(&fit);
  conic_memory_release_these(s->context, ways, numbers);
  return status;
}

/* --- normals --- */

/* The cosine of the angle up to which triangles about a vertex have one normal there, both as they lie and as the mesh
 * has it: large triangles that meet at more look more like the mesh with a crease between them. */
static const double crease = 0.8660254037844387; /* 30° */

static double along_normals(const conic_simplifier *s, uint32_t a, uint32_t b) {
  float *const *normal = s->mesh->triangles->normal;
  double along = 0.0;
  for (int axis = 0; axis < 3; axis++)
    along += (double)normal[axis][a] * (double)normal[axis][b];
  return along;
}

/* Whether two corners at one vertex lie beside each other without a crease. */
static int meet_smoothly(const conic_simplifier *s, uint32_t a, uint32_t b) {
  const conic_simplifier_triangle *first = &s->triangles[a / 3], *second = &s->triangles[b / 3];
  uint32_t own = s->originals[a / 3][a % 3], other = s->originals[b / 3][b % 3];
  double normals[2][3];
  if (first->corners[(a % 3 + 1) % 3] != second->corners[(b % 3 + 2) % 3] &&
      first->corners[(a % 3 + 2) % 3] != second->corners[(b % 3 + 1) % 3])
    return 0;
  double length = conic_simplifier_twice_area(s, a / 3, normals[0]) * conic_simplifier_twice_area(s, b / 3, normals[1]);
  return conic_dot(normals[0], normals[1]) >= crease * length &&
         (own == other || along_normals(s, own, other) >= crease);
}

/* Gives a corner's number to all that are smooth with it, and so on, unless there are many; `found` has room for all
 * triangles. */
static void spread_number(const conic_simplifier *s, uint32_t from, uint32_t *found, uint32_t (*of_corner)[3]) {
  uint32_t vertex = s->triangles[from / 3].corners[from % 3], number = of_corner[from / 3][from % 3];
  size_t n_found = 1;
  if (conic_simplifier_has_many(s, vertex))
    return;
  found[0] = from;
  for (size_t i = 0; i < n_found; i++)
    for (uint32_t slot = conic_simplifier_living(s, s->vertices[vertex].ring); slot != CONIC_NONE;
         slot = conic_simplifier_after(s, slot))
      if (of_corner[slot / 3][slot % 3] == CONIC_NONE && meet_smoothly(s, found[i], slot)) {
        of_corner[slot / 3][slot % 3] = number;
        found[n_found++] = slot;
      }
}

/* Numbers what has a normal of its own, and returns how many there are. */
static size_t number_normals(const conic_simplifier *s, uint32_t *found, uint32_t (*of_corner)[3]) {
  size_t n = 0;
  memset(of_corner, 0xFF, s->n_triangles * sizeof *of_corner);
  for (uint32_t slot = 0; slot < 3 * s->n_triangles; slot++)
    if (s->triangles[slot / 3].is_alive && of_corner[slot / 3][slot % 3] == CONIC_NONE) {
      of_corner[slot / 3][slot % 3] = (uint32_t)n++;
      spread_number(s, slot, found, of_corner);
    }
  return n;
}

/* What they are at first: the means of those that the mesh has at the corners. */
static void begin_normals(const conic_simplifier *s, conic_simplifier_normals *n, size_t n_normals) {
  memset(n->normals, 0, n_normals * sizeof *n->normals);
  for (size_t i = 0; i < s->n_triangles; i++) {
    double cross[3], area2;
    if (!s->triangles[i].is_alive)
      continue;
    area2 = conic_simplifier_twice_area(s, i, cross);
    for (int k = 0; k < 9; k++)
      n->normals[n->of_corner[i][k / 3]][k % 3] +=
          area2 * (double)s->mesh->triangles->normal[k % 3][s->originals[i][k / 3]];
  }
  for (size_t i = 0; i < n_normals; i++)
    conic_normalize(n->normals[i]);
}

/* What the mean normal of each face differs from what is there. */
static void add_turns_of_faces(const conic_simplifier *s, const uint32_t *numbers, const conic_simplifier_normals *n,
                               corner_fit *fit) {
  for (size_t i = 0; i < s->n_triangles; i++) {
    const conic_simplifier_hit *hit = &s->hits[i];
    if (hit->triangle == CONIC_NONE)
      continue;
    double parts[3], turn[3] = {(double)hit->normal[0], (double)hit->normal[1], (double)hit->normal[2]};
    for (int k = 0; k < 9; k++) {
      parts[k / 3] = (double)hit->bary[k / 3];
      turn[k % 3] -= parts[k / 3] * n->normals[n->of_corner[hit->triangle][k / 3]][k % 3];
    }
    corner_fit_add(fit, numbers[hit->triangle], parts, turn, (double)hit->area2);
  }
}

static conic_status solve_normals(const conic_simplifier *s, const uint32_t *numbers, conic_simplifier_normals *n,
                                  size_t n_normals, size_t n_alive) {
  corner_fit fit;
  conic_status status = corner_fit_init(s->context, n_alive, n_normals, 3, &fit);
  if (status == CONIC_OK) {
    for (size_t i = 0; i < s->n_triangles; i++)
      if (numbers[i] != CONIC_NONE)
        memcpy(fit.unknowns[numbers[i]], n->of_corner[i], sizeof *fit.unknowns);
    begin_normals(s, n, n_normals);
    add_turns_of_faces(s, numbers, n, &fit);
    for (int axis = 0; axis < 3; axis++) {
      corner_fit_solve(&fit, axis);
      for (size_t i = 0; i < n_normals; i++)
        n->normals[i][axis] += fit.solution[i];
    }
    for (size_t i = 0; i < n_normals; i++)
      conic_normalize(n->normals[i]);
  }
  corner_fit_release(&fit);
  return status;
}

conic_status conic_simplifier_fit_normals(const conic_simplifier *s, conic_simplifier_normals *n) {
  conic_status status = CONIC_ERROR_MEMORY;
  memset(n, 0, sizeof *n);
  if (!s->mesh->triangles->normal[0])
    return CONIC_OK;
  uint32_t *numbers = conic_memory_allocate(s->context, s->n_triangles, sizeof *numbers);
  n->of_corner = conic_memory_allocate(s->context, s->n_triangles, sizeof *n->of_corner);
  if (numbers && n->of_corner) {
    size_t n_normals = number_normals(s, numbers, n->of_corner), n_alive = number_alive(s, numbers);
    n->normals = conic_memory_allocate(s->context, n_normals, sizeof *n->normals);
    if (n->normals)
      status = solve_normals(s, numbers, n, n_normals, n_alive);
  }
  conic_memory_release(s->context, numbers);
  return status;
}

void conic_simplifier_normals_release(const conic_simplifier *s, conic_simplifier_normals *n) {
  conic_memory_release_these(s->context, n->of_corner, n->normals);
}
