/* Values at the corners of triangles that fit best, by least squares, what is known at places on these. */
#include "lod/clusters/cluster_simplifier.h"

#include <string.h>

#include "core/base/memory.h"

/* What draws all values towards none, as a part of the mean of the system's diagonal; and how many steps are taken. */
static const double hold = 1e-3;
enum { MOST_STEPS = 16 };
static const double enough = 1e-6; /* of what is left, squared */

conic_status conic_corner_fit_init(conic_context *context, size_t n_triangles, size_t n_unknowns, int n_values,
                                   conic_corner_fit *fit) {
  *fit = (conic_corner_fit){
      .context = context, .n_triangles = n_triangles, .n_unknowns = n_unknowns, .n_values = n_values};
  fit->unknowns = conic_memory_allocate(context, n_triangles, sizeof *fit->unknowns);
  fit->squares = conic_memory_allocate_zeroed(context, n_triangles, sizeof *fit->squares);
  fit->right[0] = conic_memory_allocate_zeroed(context, n_unknowns, (size_t)n_values * sizeof **fit->right);
  fit->solution = conic_memory_allocate(context, n_unknowns, sizeof *fit->solution);
  fit->work = conic_memory_allocate(context, n_unknowns, 4 * sizeof *fit->work);
  if (!fit->unknowns || !fit->squares || !fit->right[0] || !fit->solution || !fit->work)
    return CONIC_ERROR_MEMORY;
  for (int i = 1; i < n_values; i++)
    fit->right[i] = fit->right[i - 1] + n_unknowns;
  return CONIC_OK;
}

void conic_corner_fit_release(conic_corner_fit *fit) {
  void *parts[] = {fit->unknowns, fit->squares, fit->right[0], fit->solution, fit->work};
  for (size_t i = 0; i < sizeof parts / sizeof *parts && fit->context; i++)
    conic_memory_release(fit->context, parts[i]);
  memset(fit, 0, sizeof *fit);
}

void conic_corner_fit_add(conic_corner_fit *fit, size_t triangle, const double parts[3], const double *values,
                          double weight) {
  for (int i = 0, at = 0; i < 3; i++) {
    for (int k = i; k < 3; k++, at++)
      fit->squares[triangle][at] += weight * parts[i] * parts[k];
    for (int value = 0; value < fit->n_values; value++)
      fit->right[value][fit->unknowns[triangle][i]] += weight * parts[i] * values[value];
  }
}

/* The system times x, and x held. */
static void multiply(const conic_corner_fit *fit, double held, const double *x, double *product) {
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
static double find_diagonal(const conic_corner_fit *fit, double *diagonal) {
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
void conic_corner_fit_solve(conic_corner_fit *fit, int value) {
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
