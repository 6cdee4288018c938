/* The rules of gsplat 1.6, for runner.c: a renderer as plain as numpy-renderer.py. */
#pragma once

static void harmonics(const double v[3], double Y[16]) {
  const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), x = v[0] / length, y = v[1] / length,
               z = v[2] / length;
  const double all[16] = {0.28209479177387814,
                          -0.4886025119029199 * y,
                          0.4886025119029199 * z,
                          -0.4886025119029199 * x,
                          1.0925484305920792 * x * y,
                          -1.0925484305920792 * y * z,
                          0.31539156525252005 * (3 * z * z - 1),
                          -1.0925484305920792 * x * z,
                          0.5462742152960396 * (x * x - y * y),
                          -0.5900435899266435 * y * (3 * x * x - y * y),
                          2.890611442640554 * x * y * z,
                          -0.4570457994644658 * y * (5 * z * z - 1),
                          0.3731763325901154 * z * (5 * z * z - 3),
                          -0.4570457994644658 * x * (5 * z * z - 1),
                          1.445305721320277 * z * (x * x - y * y),
                          -0.5900435899266435 * x * (x * x - 3 * y * y)};
  memcpy(Y, all, sizeof all);
}

static double limited(double v, double low, double high) {
  return v < low ? low : v > high ? high : v;
}

/* Returns 0 for what is too near. */
static int set_up(gaussian *g, int n_sh, const camera *c) {
  const double size[2] = {c->width, c->height}, f[2] = {c->fx, c->fy}, middle[2] = {c->cx, c->cy};
  const double *q = g->rotation, unit = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double w = q[0] * unit, x = q[1] * unit, y = q[2] * unit, z = q[3] * unit;
  const double turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  double p[3], direction[3], Y[16], M[2][3] = {{0}}, s[3] = {0.3, 0.0, 0.3}; /* the dilation */
  for (int k = 0; k < 3; k++) {
    p[k] = c->view[k][3];
    direction[k] = g->mean[k]; /* from the eye, which is -R' t */
    for (int i = 0; i < 3; i++) {
      p[k] += c->view[k][i] * g->mean[i];
      direction[k] += c->view[i][k] * c->view[i][3];
    }
  }
  g->z = p[2];
  if (g->z < 0.01)
    return 0;
  for (int row = 0; row < 2; row++) {
    g->place[row] = f[row] * p[row] / g->z + middle[row];
    const double slope = limited(p[row] / g->z, -(middle[row] + 0.15 * size[row]) / f[row],
                                 (size[row] - middle[row] + 0.15 * size[row]) / f[row]);
    for (int axis = 0; axis < 3; axis++)
      for (int k = 0; k < 3; k++)
        M[row][axis] += f[row] / g->z * (c->view[row][k] - slope * c->view[2][k]) * turn[k][axis] * g->scale[axis];
  }
  for (int axis = 0; axis < 3; axis++)
    for (int k = 0; k < 3; k++)
      s[k] += M[k / 2][axis] * M[(k + 1) / 2][axis];
  const double det = s[0] * s[2] - s[1] * s[1];
  g->form[0] = s[2] / det, g->form[1] = -s[1] / det, g->form[2] = s[0] / det;
  harmonics(direction, Y);
  for (int channel = 0; channel < 3; channel++) {
    g->color[channel] = 0.5;
    for (int k = 0; k < n_sh; k++)
      g->color[channel] += Y[k] * g->sh[channel][k];
    g->color[channel] = fmax(g->color[channel], 0.0);
  }
  return 1;
}

static int compare(const void *a, const void *b) { /* by depth as floats; of equal ones, as in the file */
  const gaussian *p = *(const gaussian *const *)a, *q = *(const gaussian *const *)b;
  return (float)p->z != (float)q->z ? ((float)p->z > (float)q->z) - ((float)p->z < (float)q->z) : (p > q) - (p < q);
}

static void draw(gaussian *all, size_t n, int n_sh, const camera *c, const float behind[3], float *rgba) {
  gaussian **order = malloc((n + 1) * sizeof *order);
  size_t n_shown = 0;
  for (size_t i = 0; i < n; i++)
    if (set_up(&all[i], n_sh, c))
      order[n_shown++] = &all[i];
  qsort(order, n_shown, sizeof *order, compare);
  for (int y = 0; y < c->height; y++)
    for (int x = 0; x < c->width; x++, rgba += 4) {
      double T = 1.0, color[3] = {0.0, 0.0, 0.0};
      for (size_t i = 0; i < n_shown; i++) {
        const gaussian *g = order[i];
        const double dx = x + 0.5 - g->place[0], dy = y + 0.5 - g->place[1];
        const double q = 0.5 * (g->form[0] * dx * dx + g->form[2] * dy * dy) + g->form[1] * dx * dy;
        const double alpha = fmin(g->opacity * exp(-q), 0.99);
        if (q < 0.0 || alpha < 1.0 / 255.0)
          continue;
        if (T * (1.0 - alpha) <= 1e-4) /* this one is left out, and all behind it */
          break;
        for (int k = 0; k < 3; k++)
          color[k] += alpha * T * g->color[k];
        T *= 1.0 - alpha;
      }
      for (int k = 0; k < 3; k++)
        rgba[k] = (float)(color[k] + T * behind[k]);
      rgba[3] = (float)(1.0 - T);
    }
  free(order);
}
