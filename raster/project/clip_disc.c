#include "raster/project/clip_disc.h"

#include <math.h>

/* The outline is P(θ) = p + F_g (t_u cos θ + t_v sin θ). Along a direction e, scaled by the focal lengths, a point's
 * place on the screen is (e·P)/P_z; its derivative by θ vanishes, and P_z equals near, each where
 * a cos θ + b sin θ + c = 0: a pair of (cos θ, sin θ) without an angle. */
typedef struct outline {
  double constant[3], cosine[3], sine[3]; /* P(θ), by coordinate */
} outline;

static outline outline_of(const conic_view *view, const conic_disc *disc) {
  outline made;
  double f[3] = {view->fx, view->fy, 1.0};
  for (int i = 0; i < 3; i++) { /* x and y in pixels times depth */
    made.constant[i] = f[i] * disc->p[i];
    made.cosine[i] = f[i] * (double)view->cutoff * disc->tu[i];
    made.sine[i] = f[i] * (double)view->cutoff * disc->tv[i];
  }
  return made;
}

int conic_clip_solve(double a, double b, double c, double solutions[2][2]) {
  double length_squared = a * a + b * b, rest = length_squared - c * c;
  if (!(length_squared > 0.0) || !(rest >= 0.0))
    return 0;
  double root = sqrt(rest);
  solutions[0][0] = (-a * c + b * root) / length_squared;
  solutions[0][1] = (-b * c - a * root) / length_squared;
  solutions[1][0] = (-a * c - b * root) / length_squared;
  solutions[1][1] = (-b * c + a * root) / length_squared;
  return 1;
}

typedef struct extremes {
  const double *direction_px;
  int n_points;
  double least_along, most_along;
  conic_screen_point least, most;
} extremes;

static void consider(extremes *found, const conic_view *view, double x, double y, double z) {
  conic_screen_point point = {view->cx + x / z, view->cy + y / z, z};
  double along = found->direction_px[0] * (x / z) + found->direction_px[1] * (y / z);
  if (found->n_points == 0 || along < found->least_along) {
    found->least_along = along;
    found->least = point;
  }
  if (found->n_points == 0 || along > found->most_along) {
    found->most_along = along;
    found->most = point;
  }
  found->n_points++;
}

static void consider_angle(extremes *found, const conic_view *view, const outline *o, const double angle[2],
                           int on_near) {
  double at[3];
  for (int i = 0; i < 3; i++)
    at[i] = o->constant[i] + o->cosine[i] * angle[0] + o->sine[i] * angle[1];
  if (on_near)
    at[2] = view->near_z;
  if (at[2] >= view->near_z)
    consider(found, view, at[0], at[1], at[2]);
}

int conic_clip_disc(const conic_view *view, const conic_disc *disc, const double direction_px[2],
                    conic_screen_point *least, conic_screen_point *most) {
  outline o = outline_of(view, disc);
  double along[3], solutions[2][2]; /* e·P: constant, cosine, sine */
  extremes found = {.direction_px = direction_px};
  along[0] = direction_px[0] * o.constant[0] + direction_px[1] * o.constant[1];
  along[1] = direction_px[0] * o.cosine[0] + direction_px[1] * o.cosine[1];
  along[2] = direction_px[0] * o.sine[0] + direction_px[1] * o.sine[1];
  const double z[3] = {o.constant[2], o.cosine[2], o.sine[2]};
  if (conic_clip_solve(along[2] * z[0] - along[0] * z[2], along[0] * z[1] - along[1] * z[0],
                       along[2] * z[1] - along[1] * z[2], solutions))
    for (int i = 0; i < 2; i++)
      consider_angle(&found, view, &o, solutions[i], 0);
  if (conic_clip_solve(z[1], z[2], z[0] - view->near_z, solutions))
    for (int i = 0; i < 2; i++)
      consider_angle(&found, view, &o, solutions[i], 1);
  *least = found.least;
  *most = found.most;
  return found.n_points > 0;
}
