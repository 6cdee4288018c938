/* The projected outline, box and normal against sampled contours and the splat's axes, through the projection stage
 * itself, from frontal to edge-on. */
#include "raster/project/projected.h"
#include "tests/support/fixture.h"

typedef struct contour {
  double x_min, x_max, y_min, y_max;
  double worst_q; /* largest | q/F² - 1 | over the samples */
} contour;

/* Projects points of the disc's outline in double and holds them against the footprint. */
static contour sample_contour(const fixture *f, const conic_footprint *footprint) {
  contour c = {HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL, 0.0};
  double cutoff = (double)f->options.kernel.cutoff;
  for (int i = 0; i < 20001; i++) {
    double angle = 2.0 * 3.14159265358979 * i / 20001.0, at[3];
    for (int axis = 0; axis < 3; axis++)
      at[axis] = (double)f->splats.position[axis][0] + cutoff * (cos(angle) * (double)f->splats.tangent_u[axis][0] +
                                                                 sin(angle) * (double)f->splats.tangent_v[axis][0]);
    double x = f->camera.cx + f->camera.fx * at[0] / at[2], y = f->camera.cy + f->camera.fy * at[1] / at[2];
    c.x_min = fmin(c.x_min, x);
    c.x_max = fmax(c.x_max, x);
    c.y_min = fmin(c.y_min, y);
    c.y_max = fmax(c.y_max, y);
    double dx = x - (footprint->x + 0.5) + (double)footprint->dx0,
           dy = y - (footprint->y + 0.5) + (double)footprint->dy0;
    double major = (double)footprint->s1 * dx + (double)footprint->s2 * dy, minor = (double)footprint->s3 * dy;
    c.worst_q = fmax(c.worst_q, fabs((major * major + minor * minor) / (cutoff * cutoff) - 1.0));
  }
  return c;
}

/* The unit normal of the splat's axes, on the side of the viewer. */
static void check_normal(const fixture *f, const conic_projected_surface *surface) {
  double u[3], v[3], n[3], length2 = 0.0, away = 0.0;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = (double)f->splats.tangent_u[axis][0];
    v[axis] = (double)f->splats.tangent_v[axis][0];
  }
  for (int axis = 0; axis < 3; axis++) {
    int next = (axis + 1) % 3, last = (axis + 2) % 3;
    n[axis] = u[next] * v[last] - u[last] * v[next];
    length2 += n[axis] * n[axis];
    away += n[axis] * (double)f->splats.position[axis][0];
  }
  for (int axis = 0; axis < 3; axis++)
    CHECK_NEAR((double)surface->normal[axis], (away > 0.0 ? -n[axis] : n[axis]) / sqrt(length2), 2e-5);
}

/* One splat without prefilter, so that the footprint is the outline itself. */
static int project_one(fixture *f, conic_footprint *footprint, conic_box *box) {
  conic_view view;
  conic_chunk chunk;
  conic_projected_surface surface;
  conic_ray ray;
  conic_projected projected = {1, 1, &chunk, footprint, box, &surface, &ray};
  f->options.prefilter = 0.0f;
  CHECK_OK(conic_view_init(f->context, &f->splats, &f->camera, &f->options, 1e-3, 1.0, &view));
  conic_project_chunk(&view, &f->splats, 0, &projected);
  if (chunk.n_drawn == 1)
    check_normal(f, &surface);
  return chunk.n_drawn == 1 && chunk.n_rays == 0;
}

static void set_tilted(fixture *f, const double p[3], double tilt, double roll, double su, double sv) {
  /* The normal leans `tilt` away from the view ray of p. */
  double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), v[3], a[3], b[3], n[3], tu[3], tv[3];
  for (int i = 0; i < 3; i++)
    v[i] = p[i] / length;
  double a_length = sqrt(v[0] * v[0] + v[2] * v[2]);
  a[0] = v[2] / a_length, a[1] = 0.0, a[2] = -v[0] / a_length;
  for (int i = 0; i < 3; i++)
    b[i] = v[(i + 1) % 3] * a[(i + 2) % 3] - v[(i + 2) % 3] * a[(i + 1) % 3];
  for (int i = 0; i < 3; i++)
    n[i] = cos(tilt) * v[i] + sin(tilt) * (a[i] * cos(roll) + b[i] * sin(roll));
  double helper[3] = {0.3, 1.0, 0.2}, norm = 0.0;
  for (int i = 0; i < 3; i++)
    tu[i] = n[(i + 1) % 3] * helper[(i + 2) % 3] - n[(i + 2) % 3] * helper[(i + 1) % 3];
  norm = sqrt(tu[0] * tu[0] + tu[1] * tu[1] + tu[2] * tu[2]);
  for (int i = 0; i < 3; i++)
    tu[i] /= norm;
  for (int i = 0; i < 3; i++)
    tv[i] = n[(i + 1) % 3] * tu[(i + 2) % 3] - n[(i + 2) % 3] * tu[(i + 1) % 3];
  for (int i = 0; i < 3; i++)
    tu[i] *= su, tv[i] *= sv;
  fixture_set(f, 0, p, tu, tv, 1, 1, 1);
}

int main(void) {
  fixture f = fixture_open(1);
  f.options.method = CONIC_METHOD_CONIC;
  uint64_t state = 7;
  int n_projected = 0;
  double worst_q = 0.0, worst_box = 0.0, worst_edge_on = 0.0;
  fixture_camera(&f, 1000, 800, 900.0);
  f.camera.fy = 850.0;
  fixture_splats(&f, 1);
  for (int i = 0; i < 600; i++) {
    double z = 1.0 + 9.0 * fixture_random(&state);
    double p[3] = {z * (fixture_random(&state) - 0.5), z * (fixture_random(&state) - 0.5), z};
    int is_edge_on = i % 6 == 5;
    double tilt = is_edge_on ? 1.5533 + 0.0172 * fixture_random(&state) : 1.55 * fixture_random(&state);
    double size = z * 0.12 * pow(10.0, -3.0 * fixture_random(&state));
    set_tilted(&f, p, tilt, 6.28 * fixture_random(&state), size, size * (0.1 + 0.9 * fixture_random(&state)));
    conic_footprint footprint;
    conic_box box;
    if (!project_one(&f, &footprint, &box))
      continue;
    n_projected++;
    contour c = sample_contour(&f, &footprint);
    if (is_edge_on) {
      worst_edge_on = fmax(worst_edge_on, c.worst_q);
      continue;
    }
    worst_q = fmax(worst_q, c.worst_q);
    /* Half the box is F_g·√V_xx, and V_xx = (s2² + s3²)/(s1·s3)². */
    double s1 = (double)footprint.s1, s2 = (double)footprint.s2, s3 = (double)footprint.s3;
    double half_x = 1.5 * sqrt(s2 * s2 + s3 * s3) / (s1 * s3), half_y = 1.5 / s3;
    double x_t = footprint.x + 0.5 - (double)footprint.dx0, y_t = footprint.y + 0.5 - (double)footprint.dy0;
    worst_box = fmax(worst_box, fabs(x_t - half_x - c.x_min));
    worst_box = fmax(worst_box, fabs(x_t + half_x - c.x_max));
    worst_box = fmax(worst_box, fabs(y_t - half_y - c.y_min));
    worst_box = fmax(worst_box, fabs(y_t + half_y - c.y_max));
    if (c.x_max > 1 && c.x_min < 999 && c.y_max > 1 && c.y_min < 799) {
      CHECK(box.x_begin <= fmax(0.0, ceil(c.x_min - 0.5)) && box.x_end >= fmin(1000.0, floor(c.x_max + 0.5)));
      CHECK(box.y_begin <= fmax(0.0, ceil(c.y_min - 0.5)) && box.y_end >= fmin(800.0, floor(c.y_max + 0.5)));
    }
  }
  printf("%d splats: outline value off by %.2g relative (%.2g from 89 to 89.98 degrees), box by %.2g px\n", n_projected,
         worst_q, worst_edge_on, worst_box);
  CHECK(n_projected > 450);
  CHECK(worst_q < 2e-4);
  CHECK(worst_edge_on < 2e-2);
  CHECK(worst_box < 1e-3);
  fixture_close(&f);
  return check_result();
}
