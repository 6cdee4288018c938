/* Planes without end, many in every pixel: most are decided by their inverse depth alone, and the picture and its
 * counts are those of plain C, which evaluates each. Where they need not be counted, most are left out. */
#include "core/lanes/instruction_sets.h"
#include "tests/support/fixture.h"

/* Discs in a cube about (0, 0, middle), of which the given share has the radius `great`, and the others a small one. */
static void fill_crowd(fixture *f, size_t count, double middle, double great, double share) {
  uint64_t state = 7;
  fixture_splats(f, count);
  for (size_t i = 0; i < count; i++) {
    double p[3], a[3], b[3], u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
      p[axis] = 2.0 * fixture_random(&state) - 1.0 + (axis == 2 ? middle : 0.0);
      a[axis] = fixture_random(&state) - 0.5;
      b[axis] = fixture_random(&state) - 0.5;
    }
    double radius = fixture_random(&state) < share ? great : 0.02, along = 0.0, size_a = 0.0, size_b = 0.0;
    for (int axis = 0; axis < 3; axis++) {
      along += a[axis] * b[axis];
      size_a += a[axis] * a[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
      b[axis] -= along / size_a * a[axis];
      size_b += b[axis] * b[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
      u[axis] = a[axis] / sqrt(size_a) * radius;
      v[axis] = b[axis] / sqrt(size_b) * radius * (0.5 + 0.5 * fixture_random(&state));
    }
    fixture_set(f, i, p, u, v, (float)fixture_random(&state), (float)fixture_random(&state), 0.5f);
  }
}

/* The same picture, without counts. */
static void check_skipping(fixture *f, const uint64_t *hashes) {
  f->options.skip_hidden = 1;
  CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &f->image, &f->statistics));
  f->options.skip_hidden = 0;
  for (int plane = 0; plane < (int)CONIC_N_DRAWN_PLANES; plane++)
    CHECK(!f->image.planes[plane] || conic_image_hash(&f->image, (conic_plane)plane) == hashes[plane]);
  CHECK(f->statistics.fragments == 0);
}

/* All planes, which keeps nothing of the first pass, and colour alone, which keeps some of it. */
static void check_isas(fixture *f, unsigned planes) {
  uint64_t hashes[CONIC_N_DRAWN_PLANES] = {0}, n_fragments = 0;
  for (int isa = CONIC_ISA_SCALAR; isa < CONIC_N_ISAS; isa++) {
    if (!conic_isa_is_here((conic_isa)isa))
      continue;
    f->options.isa = (conic_isa)isa;
    conic_image_release(f->context, &f->image);
    CHECK_OK(conic_image_allocate(f->context, f->camera.width, f->camera.height, planes, &f->image));
    CHECK_OK(conic_render(f->renderer, &f->splats, &f->camera, &f->options, &f->image, &f->statistics));
    for (int plane = 0; plane < (int)CONIC_N_DRAWN_PLANES; plane++) {
      uint64_t hash = f->image.planes[plane] ? conic_image_hash(&f->image, (conic_plane)plane) : 0;
      CHECK(isa == CONIC_ISA_SCALAR || hash == hashes[plane]);
      hashes[plane] = hash;
    }
    CHECK(isa == CONIC_ISA_SCALAR || f->statistics.fragments == n_fragments);
    n_fragments = f->statistics.fragments;
    if (isa != CONIC_ISA_SCALAR) /* which is slow, and walks the same way */
      check_skipping(f, hashes);
    f->statistics.fragments = n_fragments;
  }
  f->options.isa = CONIC_ISA_AUTO;
}

static void check_crowd(fixture *f, double middle, double great, double share, size_t least) {
  fill_crowd(f, 1400, middle, great, share);
  check_isas(f, ALL_PLANES);
  check_isas(f, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z);
  size_t n_pixels = (size_t)f->camera.width * (size_t)f->camera.height;
  CHECK(f->statistics.fragments > least * n_pixels);
}

int main(void) {
#ifdef __SANITIZE_ADDRESS__ /* ten times slower */
  static const double greats[] = {1e4, 10.0};
#else
  static const double greats[] = {1e9, 1e4, 100.0, 10.0, 2.0};
#endif
  fixture f = fixture_open(2);
  fixture_camera(&f, 35, 18, 60.0);
  for (size_t i = 0; i < sizeof greats / sizeof greats[0]; i++)
    for (int is_inside = 0; is_inside < 2; is_inside++) {
      double middle = is_inside ? 0.0 : 4.0;
      size_t least = greats[i] > 9.0 ? 512 : 0;
      check_crowd(&f, middle, greats[i], 1.0, least); /* all of them blend: ε is as large as they are */
      check_crowd(&f, middle, greats[i], 0.45, 0);    /* and hide each other, where it is not */
    }
  f.options.epsilon = 0.01;
  check_crowd(&f, 4.0, 1e9, 1.0, 512);
  check_crowd(&f, 4.0, 30.0, 1.0, 512);
  f.options.prefilter = 0.0f;
  check_crowd(&f, 4.0, 1e9, 1.0, 512);
  f.options.prefilter = 4.0f; /* inverse depths are less steep than their planes */
  for (double small = 0.3; small < 0.7; small *= 2.0) {
    fill_crowd(&f, 7000, 4.0, small, 1.0);
    check_isas(&f, 1u << CONIC_PLANE_RGBA | 1u << CONIC_PLANE_Z);
  }
  f.options.epsilon = -1.0;
  for (int kernel = 0; kernel < CONIC_N_KERNELS; kernel++) {
    f.options.kernel.type = (conic_kernel_type)kernel;
    f.options.kernel.cutoff = 3.0f;
    f.options.prefilter = kernel ? 100.0f : 0.5f;
    check_crowd(&f, 4.0, 1e9, 1.0, 512);
    check_crowd(&f, 4.0, 100.0, 1.0, 512);
    check_crowd(&f, 4.0, 1e4, 1.0, 512);
  }
  fixture_close(&f);
  return check_result();
}
