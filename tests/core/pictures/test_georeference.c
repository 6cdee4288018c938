/* Coordinate systems: what text and a LAS say of them, and what says nothing. */
#include "core/base/byte_order.h"
#include "core/pictures/georeference.h"
#include "tests/support/check.h"

static unsigned code_of(const char *text) {
  return conic_georeference_find_epsg(text, strlen(text));
}

/* The system's own code, not that of what it is made of. */
static void check_texts(void) {
  CHECK(code_of("PROJCS[\"a\",GEOGCS[\"b\",AUTHORITY[\"EPSG\",\"4269\"]],AUTHORITY[\"EPSG\",\"26910\"]]") == 26910);
  CHECK(code_of("PROJCS[\"a\",GEOGCS[\"b\",AUTHORITY[\"EPSG\",\"4269\"]]]") == 0);
  CHECK(code_of("COMPD_CS[\"PROJCS[\",PROJCS[\"a]\",AUTHORITY[\"EPSG\",\"2992\"]],AUTHORITY[\"EPSG\",\"1\"]]") == 2992);
  CHECK(code_of("PROJCRS[\"a\",BASEGEOGCRS[\"b\",ID[\"EPSG\",4326]],CS[Cartesian,2],ID[\"EPSG\",32610]]") == 32610);
  CHECK(code_of("GEOGCS[\"b\",DATUM[\"c\",AUTHORITY[\"EPSG\",\"6326\"]],AUTHORITY[\"EPSG\",\"4326\"]]") == 4326);
  CHECK(code_of("PROJCS[\"a\",AUTHORITY[\"ESRI\",\"102100\"]]") == 0);
  CHECK(code_of("PROJCS[\"a\",AUTHORITY[\"EPSG\",\"99999\"]]") == 0);
  CHECK(code_of("EPSG:3857") == 3857 && code_of("+proj=utm +zone=10") == 0 && code_of("") == 0);
}

/* A head of a LAS with one record of keys, of so many bytes. */
static conic_georeference read_keys(conic_context *context, const uint16_t *keys, size_t n_bytes) {
  unsigned char head[227 + 54 + 64] = "LASF";
  conic_georeference reference;
  head[94] = 227;
  head[100] = 1;
  snprintf((char *)head + 227 + 2, 16, "LASF_Projection");
  conic_store_bits(head + 227 + 18, 2, 34735);
  conic_store_bits(head + 227 + 20, 2, n_bytes);
  memcpy(head + 227 + 54, keys, n_bytes);
  conic_turn_words(head + 227 + 54, n_bytes / 2, 2);
  CHECK_OK(conic_georeference_of_las(context, head, 227 + 54 + n_bytes, &reference));
  return reference;
}

/* Keys stay in their order, and the one that says what a pixel is, is 1. */
static void check_keys(conic_context *context) {
  static const uint16_t points[] = {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 2, 3072, 0, 1, 26910};
  static const uint16_t custom[] = {1, 1, 0, 2, 2048, 0, 1, 4269, 3072, 0, 1, 32767};
  static const uint16_t beyond[] = {1, 1, 0, 1, 2062, 34736, 1, 0};
  static const uint16_t elsewhere[] = {1, 1, 0, 1, 3073, 34735, 4, 100};
  static const uint16_t too_few[] = {1, 1, 0, 9, 3072, 0, 1, 26910};
  conic_georeference found = read_keys(context, points, sizeof points);
  CHECK(found.n_keys == 16 && found.epsg == 26910 && found.keys[8] == 1025 && found.keys[11] == 1);
  conic_georeference_release(context, &found);
  found = read_keys(context, custom, sizeof custom);
  CHECK(found.n_keys == 16 && found.epsg == 0 && found.keys[3] == 3 && found.keys[4] == 1025 && found.keys[8] == 2048);
  conic_georeference_release(context, &found);
  CHECK(!read_keys(context, beyond, sizeof beyond).keys);
  CHECK(!read_keys(context, elsewhere, sizeof elsewhere).keys);
  CHECK(!read_keys(context, too_few, sizeof too_few).keys);
}

static void check_codes(conic_context *context) {
  conic_georeference plane, ball, copy;
  CHECK_OK(conic_georeference_of_epsg(context, 32610, &plane));
  CHECK_OK(conic_georeference_of_epsg(context, 4326, &ball));
  CHECK_OK(conic_georeference_copy(context, &plane, &copy));
  CHECK(plane.keys[7] == 1 && plane.keys[12] == 3072 && plane.keys[15] == 32610);
  CHECK(ball.keys[7] == 2 && ball.keys[12] == 2048 && ball.keys[15] == 4326);
  CHECK(copy.n_keys == plane.n_keys && memcmp(copy.keys, plane.keys, 32) == 0 && copy.epsg == 32610);
  conic_georeference_release(context, &plane);
  conic_georeference_release(context, &ball);
  conic_georeference_release(context, &copy);
}

int main(void) {
  conic_context *context = check_context(1);
  check_texts();
  check_keys(context);
  check_codes(context);
  conic_context_destroy(context);
  return check_result();
}
