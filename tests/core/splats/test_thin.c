/* The stable random choice: as many as asked for, in order, nested, even, by the seed alone. */
#include "tests/support/check.h"

enum { N = 20000 };

/* A set whose every value tells its index. */
static conic_splats numbered(conic_context *context, unsigned fields) {
  conic_splats splats;
  CHECK_OK(conic_splats_allocate(context, N, fields, &splats));
  for (int i = 0; i < N; i++) {
    for (int axis = 0; axis < 3; axis++) {
      splats.position[axis][i] = (float)(i + axis * N);
      if (splats.color[0])
        splats.color[axis][i] = (float)(i + axis);
      if (splats.tangent_u[0])
        splats.tangent_u[axis][i] = splats.tangent_v[axis][i] = (float)(-i);
    }
    if (splats.opacity)
      splats.opacity[i] = (float)i;
  }
  return splats;
}

/* The indices kept, as marks. */
static void thin(conic_context *context, size_t count, uint64_t seed, char kept[N]) {
  conic_splats splats = numbered(context, CONIC_SPLATS_COLORS | CONIC_SPLATS_OPACITIES | CONIC_SPLATS_TANGENTS);
  memset(kept, 0, N);
  CHECK_OK(conic_splats_thin(context, &splats, count, seed));
  CHECK(splats.count == (count < N ? count : N));
  for (size_t i = 0; i < splats.count; i++) {
    int index = (int)splats.position[0][i];
    CHECK(i == 0 || splats.position[0][i] > splats.position[0][i - 1]);
    CHECK(splats.position[2][i] == (float)(index + 2 * N) && splats.color[1][i] == (float)(index + 1));
    CHECK(splats.opacity[i] == (float)index && splats.tangent_v[2][i] == (float)-index);
    kept[index] = 1;
  }
  conic_splats_release(context, &splats);
}

static size_t count_kept(const char kept[N], int begin, int end) {
  size_t n = 0;
  for (int i = begin; i < end; i++)
    n += (size_t)kept[i];
  return n;
}

int main(void) {
  static char larger[N], smaller[N], other[N];
  conic_context *context = check_context(1);
  const size_t counts[] = {N + 5, N, N - 1, 12345, 5000, 100, 2, 1, 0};
  thin(context, counts[0], 1, larger);
  for (size_t i = 1; i < sizeof counts / sizeof counts[0]; i++) {
    thin(context, counts[i], 1, smaller);
    CHECK(count_kept(smaller, 0, N) == counts[i]);
    for (int j = 0; j < N; j++)
      CHECK(!smaller[j] || larger[j]);
    memcpy(larger, smaller, N);
  }
  thin(context, N / 4, 1, larger);
  thin(context, N / 4, 1, other);
  CHECK(memcmp(larger, other, N) == 0);
  thin(context, N / 4, 2, other);
  CHECK(memcmp(larger, other, N) != 0);
  /* A quarter of every part, to five standard deviations of a fair choice. */
  for (int part = 0; part < 20; part++)
    CHECK_NEAR((double)count_kept(larger, part * N / 20, (part + 1) * N / 20), 250.0, 70.0);
  /* Two seeds choose independently: about a sixteenth in common. */
  size_t n_common = 0;
  for (int i = 0; i < N; i++)
    n_common += (size_t)(larger[i] && other[i]);
  CHECK_NEAR((double)n_common, N / 16.0, 170.0);
  conic_context_destroy(context);
  return check_result();
}
