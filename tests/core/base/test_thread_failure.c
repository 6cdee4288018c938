/* A system that gives fewer threads than asked for, or none: the work is done all the same, to the same bits. */
#include <errno.h>
#include <pthread.h>

#include "tests/support/fixture.h"

/* The linker sends calls of pthread_create here (tests/CMakeLists.txt). */
static int n_threads_left;

/* NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl*): the linker's names */
int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument);

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*start)(void *), void *argument) {
  return n_threads_left-- > 0 ? __real_pthread_create(thread, attributes, start, argument) : EAGAIN;
}
/* NOLINTEND(bugprone-reserved-identifier,cert-dcl*) */

static uint64_t draw(int n_threads_given) {
  uint64_t hash = 0;
  n_threads_left = n_threads_given;
  fixture f = fixture_open(8);
  CHECK(n_threads_left < 0 || n_threads_given >= 7); /* it was asked, and refused */
  CHECK(conic_context_threads(f.context) == (n_threads_given < 7 ? n_threads_given + 1 : 8));
  fixture_scene(&f, CONIC_SCENE_SPHERE, 3000);
  fixture_camera(&f, 100, 80, 100.0);
  f.camera.cam_from_world[2][3] = 3.0;
  fixture_render(&f);
  CHECK(f.statistics.pixels_covered > 1000);
  for (int plane = 0; plane < CONIC_N_DRAWN_PLANES; plane++)
    hash = hash * 31 + conic_image_hash(&f.image, (conic_plane)plane);
  fixture_close(&f);
  return hash;
}

int main(void) {
  uint64_t with_all = draw(100);
  CHECK(draw(7) == with_all);
  CHECK(draw(3) == with_all);
  CHECK(draw(1) == with_all);
  CHECK(draw(0) == with_all);
  return check_result();
}
