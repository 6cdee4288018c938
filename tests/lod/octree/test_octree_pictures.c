/* Pictures of what is chosen against pictures of everything, from 26 sides: the promise about their coverage, no holes
 * at any error, a picture that gets no worse as the error falls, and no pops when the camera moves in.
 *
 * A hole is a pixel that shows nothing, or what lies far behind, in the middle of a surface: all pixels around it up to
 * the error and the pixel's own size show one surface in the picture of everything, also without the prefilter, which
 * closes gaps of up to three pixels in a scan, and more of them the smaller the splats are. Where pixels side by side
 * are farther apart than four pixels' sizes one sheet ends before another, and two borders may each move by the error:
 * what opens between them is no hole in either. */
#include "core/base/memory.h"
#include "tests/support/octree_fixture.h"

enum { SIZE = 256, N_SIDES = 26, N_ERRORS = 5, REACH = 10 };

static const double errors_px[N_ERRORS] = {8.0, 4.0, 2.0, 1.0, 0.5};

/* What is kept of a picture. */
typedef struct picture {
  float rgba[4 * SIZE * SIZE], z[SIZE * SIZE];
} picture;

static void keep(const fixture *f, picture *kept) {
  memcpy(kept->rgba, f->image.planes[CONIC_PLANE_RGBA], sizeof kept->rgba);
  memcpy(kept->z, f->image.planes[CONIC_PLANE_Z], sizeof kept->z);
}

static int is_covered(const picture *p, int x, int y) {
  return x >= 0 && y >= 0 && x < SIZE && y < SIZE && p->rgba[4 * (y * SIZE + x) + 3] > 0.0f;
}

/* The farthest that a pixel that `a` covers is from those that `b` does, in pixels, up to REACH. */
static double distance(const picture *a, const picture *b) {
  double farthest = 0.0;
  for (int y = 0; y < SIZE; y++)
    for (int x = 0; x < SIZE; x++) {
      double nearest = REACH;
      if (!is_covered(a, x, y) || is_covered(b, x, y))
        continue;
      for (int dy = -REACH; dy <= REACH; dy++)
        for (int dx = -REACH; dx <= REACH; dx++)
          if (is_covered(b, x + dx, y + dy))
            nearest = fmin(nearest, hypot(dx, dy));
      farthest = fmax(farthest, nearest);
    }
  return farthest;
}

/* Whether the picture is covered from -reach to reach around the pixel and nowhere steps by more than `step`; the range
 * of its depths. */
static int is_one_surface(const picture *p, int x, int y, int reach, float step, float *low, float *high) {
  *low = HUGE_VALF;
  *high = 0.0f;
  for (int dy = -reach; dy <= reach; dy++)
    for (int dx = -reach; dx <= reach; dx++) {
      const float *z = &p->z[(y + dy) * SIZE + x + dx];
      if (!is_covered(p, x + dx, y + dy) || (dx < reach && fabsf(z[1] - z[0]) > step) ||
          (dy < reach && fabsf(z[SIZE] - z[0]) > step))
        return 0;
      *low = *z < *low ? *z : *low;
      *high = *z > *high ? *z : *high;
    }
  return 1;
}

/* Holes of `b` in what is one surface in `a` up to `reach` pixels around; a depth may lie `deep` behind. Counts the
 * pixels that were looked at, too. */
static int count_holes(const picture *a, const picture *b, int reach, float deep, float step, int *n_seen) {
  int n = 0;
  for (int y = reach; y < SIZE - reach; y++)
    for (int x = reach; x < SIZE - reach; x++) {
      float low, high;
      if (is_one_surface(a, x, y, reach, step, &low, &high) && high - low < deep) {
        n += !is_covered(b, x, y) || b->z[y * SIZE + x] > high + deep;
        ++*n_seen;
      }
    }
  return n;
}

static double squared_difference(const picture *a, const picture *b) {
  double sum = 0.0;
  for (int i = 0; i < 4 * SIZE * SIZE; i++) {
    double apart = (double)a->rgba[i] - (double)b->rgba[i];
    sum += apart * apart;
  }
  return sum / (4.0 * SIZE * SIZE);
}

/* Faces, edges and corners of the cube. */
static void side_direction(int i, double *azimuth, double *elevation) {
  if (i < 2) {
    *azimuth = 0.0;
    *elevation = i ? -90.0 : 90.0;
  } else {
    *azimuth = (i - 2) % 8 * 45.0;
    *elevation = (i - 2) / 8 * 40.0 - 40.0;
  }
}

typedef struct tally {
  double apart_px, squares; /* the greatest distance of coverage, the sum of squared differences */
  int n_holes, n_seen;      /* of so many pixels inside of surfaces */
  size_t n_splats;
} tally;

static void test_sides(fixture *f, const char *what) {
  static picture whole, bare, chosen;
  tally tallies[N_ERRORS] = {{0}};
  conic_selection selection = {0};
  conic_octree *octree = octree_build(f->context, &f->splats, 0);
  f->options.near_z = conic_octree_near(octree);
  for (int side = 0; side < N_SIDES; side++) {
    double azimuth, elevation;
    side_direction(side, &azimuth, &elevation);
    octree_frame(f, SIZE, azimuth, elevation, 1.0);
    fixture_render(f);
    keep(f, &whole);
    f->options.prefilter = 0.0f;
    fixture_render(f);
    keep(f, &bare);
    f->options.prefilter = 1.0f;
    for (int i = 0; i < N_ERRORS; i++) {
      octree_select(octree, f, errors_px[i], 0, &selection);
      octree_draw(f, octree, &selection);
      keep(f, &chosen);
      int reach = (int)ceil(errors_px[i] + 1.0);
      double pixel = (double)f->camera.cam_from_world[2][3] / f->camera.fx; /* in world units, at the middle */
      double apart = fmax(distance(&whole, &chosen), distance(&chosen, &whole));
      tallies[i].apart_px = fmax(tallies[i].apart_px, apart);
      tallies[i].n_holes += count_holes(&bare, &chosen, reach, (float)(fabs(pixel) * (8.0 + 4.0 * errors_px[i])),
                                        (float)(fabs(pixel) * 4.0), &tallies[i].n_seen);
      tallies[i].squares += squared_difference(&whole, &chosen) / N_SIDES;
      tallies[i].n_splats += selection.splats.count / N_SIDES;
    }
  }
  for (int i = 0; i < N_ERRORS; i++) {
    fprintf(stderr, "%s, error %g px: %zu of %zu splats, coverage %.2f px apart, %.1f dB, %d holes in %d\n", what,
            errors_px[i], tallies[i].n_splats, f->splats.count, tallies[i].apart_px, -10.0 * log10(tallies[i].squares),
            tallies[i].n_holes, tallies[i].n_seen);
    CHECK(tallies[i].n_holes == 0 && tallies[i].n_seen > 2000);
    /* Pixels are told by their centres: what moves by less than the error may so be a pixel's diagonal more. */
    CHECK(tallies[i].apart_px <= errors_px[i] + 1.4143);
    if (i > 0) {
      CHECK(tallies[i].squares <= tallies[i - 1].squares);
      CHECK(tallies[i].apart_px <= tallies[i - 1].apart_px);
    }
  }
  conic_selection_release(f->context, &selection);
  conic_octree_destroy(octree);
}

/* The camera moves in by 1 % a frame. Where a node gives way to its children, the picture must not change much more
 * than that of everything does by itself: neither on the whole nor in its most changed block of 8 × 8. */
static double worst_block(const picture *a, const picture *b) {
  enum { BLOCK = 8 };
  double worst = 0.0;
  for (int y = 0; y < SIZE; y += BLOCK)
    for (int x = 0; x < SIZE; x += BLOCK) {
      double sum = 0.0;
      for (int k = 0; k < BLOCK * BLOCK; k++)
        for (int channel = 0; channel < 3; channel++) {
          int at = 4 * ((y + k / BLOCK) * SIZE + x + k % BLOCK) + channel;
          double apart = (double)a->rgba[at] - (double)b->rgba[at];
          sum += apart * apart / (3.0 * BLOCK * BLOCK);
        }
      worst = fmax(worst, sum);
    }
  return worst;
}

static void test_zoom(fixture *f, const char *what) {
  static picture pictures[2], wholes[2];
  enum { N_FRAMES = 30 };
  conic_selection selection = {0};
  conic_octree *octree = octree_build(f->context, &f->splats, 0);
  f->options.near_z = conic_octree_near(octree);
  double changed = 0.0, changed_whole = 0.0, pop = 0.0, pop_whole = 0.0, zoom = 0.5;
  for (int frame = 0; frame < N_FRAMES; frame++, zoom *= 1.01) {
    octree_frame(f, SIZE, 30.0, 15.0, zoom);
    fixture_render(f);
    keep(f, &wholes[frame % 2]);
    octree_select(octree, f, 1.0, 0, &selection);
    octree_draw(f, octree, &selection);
    keep(f, &pictures[frame % 2]);
    if (frame == 0)
      continue;
    changed += squared_difference(&pictures[0], &pictures[1]);
    changed_whole += squared_difference(&wholes[0], &wholes[1]);
    pop = fmax(pop, worst_block(&pictures[0], &pictures[1]));
    pop_whole = fmax(pop_whole, worst_block(&wholes[0], &wholes[1]));
  }
  fprintf(stderr, "%s, zoom at 1 px: changes %.3f of everything's, worst block %.3f\n", what,
          sqrt(changed / changed_whole), sqrt(pop / pop_whole));
  CHECK(changed <= changed_whole * 1.1 * 1.1);
  CHECK(pop <= pop_whole * 1.25 * 1.25);
  conic_selection_release(f->context, &selection);
  conic_octree_destroy(octree);
}

/* At 1 px on 512², two fifths of the leaves give the picture to 40 dB, from six sides; with --cull back of those drawn
 * a little more, as nodes at the edges are opened. */
static void test_share(fixture *f) {
  enum { WIDE = 512, N_VIEWS = 6 };
  conic_selection selection = {0};
  conic_octree *octree = octree_build(f->context, &f->splats, 0);
  f->options.near_z = conic_octree_near(octree);
  for (int cull_back = 0; cull_back < 2; cull_back++) {
    double squares = 0.0, n_whole = 0.0, n_chosen = 0.0;
    f->options.cull_back = cull_back;
    for (int view = 0; view < N_VIEWS; view++) {
      octree_frame(f, WIDE, 30.0 + view * 360.0 / N_VIEWS, 15.0, 1.0);
      fixture_render(f);
      n_whole += (double)f->statistics.splats_drawn;
      float *whole = f->image.planes[CONIC_PLANE_RGBA];
      f->image.planes[CONIC_PLANE_RGBA] = NULL;
      octree_select(octree, f, 1.0, 0, &selection);
      octree_draw(f, octree, &selection);
      n_chosen += (double)f->statistics.splats_drawn;
      const float *chosen = f->image.planes[CONIC_PLANE_RGBA];
      for (int i = 0; i < 4 * WIDE * WIDE; i++) {
        double apart = (double)whole[i] - (double)chosen[i];
        squares += apart * apart / (4.0 * WIDE * WIDE * N_VIEWS);
      }
      conic_memory_release(f->context, whole);
    }
    fprintf(stderr, "lion, 512², 1 px, cull %d: %.1f %% of the splats drawn, %.2f dB\n", cull_back,
            100.0 * n_chosen / n_whole, -10.0 * log10(squares));
    CHECK(n_chosen <= (cull_back ? 0.415 : 0.38) * n_whole);
    CHECK(squares <= 1e-4);
  }
  f->options.cull_back = 0;
  conic_selection_release(f->context, &selection);
  conic_octree_destroy(octree);
}

int main(int argc, char **argv) {
  const char *source_folder = argc > 1 ? argv[1] : ".";
  fixture f = fixture_open(0);
  fixture_scene(&f, CONIC_SCENE_KNOT, 150000);
  test_sides(&f, "knot");
  test_zoom(&f, "knot");
  if (octree_read_scan(&f, source_folder, "bunny.obj"))
    test_sides(&f, "bunny");
  if (octree_read_scan(&f, source_folder, "lion.ply")) {
    test_sides(&f, "lion");
    test_share(&f);
    test_zoom(&f, "lion");
  }
  fixture_close(&f);
  return check_result();
}
