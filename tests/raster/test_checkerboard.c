/* A checkerboard that runs towards the horizon (PAS Fig. 6), against the board filtered analytically: the average of
 * the exact board under the pixel's Gaussian. The prefilter must earn its keep where the squares are small. */
#include "tests/support/fixture.h"

enum { WIDTH = 320, HEIGHT = 200, N_SPLATS = 420 };

static const double camera_height = 0.25, focal_px = 280.0, half_board = 1.0, board_z = 1.6, squares_per_unit = 12.0;

static float board_color(double x, double z) {
  long column = (long)floor(x * squares_per_unit), row = (long)floor(z * squares_per_unit);
  return (column + row) & 1 ? 0.9f : 0.1f;
}

static void fill_board(fixture *f) {
  double spacing = 2.0 * half_board / N_SPLATS, sigma = spacing / 1.5;
  fixture_splats(f, (size_t)N_SPLATS * N_SPLATS);
  for (int j = 0; j < N_SPLATS; j++)
    for (int i = 0; i < N_SPLATS; i++) {
      double x = (i + 0.5) * spacing - half_board, z = (j + 0.5) * spacing - half_board + board_z;
      const double p[3] = {x, camera_height, z}, tu[3] = {sigma, 0, 0}, tv[3] = {0, 0, -sigma};
      float color = board_color(x, z);
      fixture_set(f, (size_t)j * N_SPLATS + (size_t)i, p, tu, tv, color, color, color);
    }
}

/* The board's average under a Gaussian of variance 1 px² about the pixel's centre; negative where that leaves the
 * board. */
static double filtered_board(int x_px, int y_px) {
  double sum = 0.0, weights = 0.0;
  enum { N = 24 };
  for (int j = -N; j <= N; j++)
    for (int i = -N; i <= N; i++) {
      double ox = 4.0 * i / N, oy = 4.0 * j / N, weight = exp(-0.5 * (ox * ox + oy * oy));
      double dx = (x_px + 0.5 + ox - WIDTH / 2) / focal_px, dy = (y_px + 0.5 + oy - HEIGHT / 2) / focal_px;
      double z = camera_height / dy, x = dx * z;
      if (dy <= 0.0 || fabs(x) > half_board || fabs(z - board_z) > half_board)
        return -1.0;
      sum += weight * (double)board_color(x, z);
      weights += weight;
    }
  return sum / weights;
}

typedef struct score {
  double far_psnr, near_psnr;
} score;

static score compare(const fixture *f, const double *expected) {
  double far_sum = 0.0, near_sum = 0.0;
  int n_far = 0, n_near = 0;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      double value = expected[y * WIDTH + x];
      if (value < 0.0)
        continue;
      CHECK(fixture_index(f, CONIC_PLANE_ID, x, y) != CONIC_NO_ID);
      double error = (double)fixture_pixel(f, CONIC_PLANE_RGBA, x, y)[0] - value;
      double z = camera_height * focal_px / (y + 0.5 - HEIGHT / 2);
      if (z > board_z)
        far_sum += error * error, n_far++;
      else
        near_sum += error * error, n_near++;
    }
  CHECK(n_far > 1000 && n_near > 1000);
  score s = {-10.0 * log10(far_sum / n_far), -10.0 * log10(near_sum / n_near)};
  return s;
}

int main(void) {
  static double expected[WIDTH * HEIGHT];
  fixture f = fixture_open(2);
  fixture_camera(&f, WIDTH, HEIGHT, focal_px);
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++)
      expected[y * WIDTH + x] = filtered_board(x, y);
  fill_board(&f);
  fixture_render(&f);
  score filtered = compare(&f, expected);
  f.options.kernel.cutoff = 3.0f; /* nearly the whole Gaussian, where 1.5 keeps its middle */
  fixture_render(&f);
  score whole = compare(&f, expected);
  f.options.kernel.cutoff = 1.5f;
  f.options.prefilter = 0.0f;
  fixture_render(&f);
  score unfiltered = compare(&f, expected);
  printf(
      "checkerboard, PSNR far / near: %.1f / %.1f dB, with a cutoff of 3 %.1f / %.1f, without prefilter %.1f / %.1f\n",
      filtered.far_psnr, filtered.near_psnr, whole.far_psnr, whole.near_psnr, unfiltered.far_psnr,
      unfiltered.near_psnr);
  CHECK(filtered.far_psnr > 22.0 && filtered.near_psnr > 23.0);
  CHECK(whole.far_psnr > 30.0 && whole.near_psnr > 27.0);
  CHECK(filtered.far_psnr >= unfiltered.far_psnr + 6.0);
  fixture_close(&f);
  return check_result();
}
