#include "source/facts.h"

#include <stdarg.h>

void conic_facts_destroy(conic_facts *facts) {
  if (facts)
    conic_memory_release(facts->context, facts);
}

const conic_fact *conic_facts_at(const conic_facts *facts, size_t i) {
  return i < facts->n ? &facts->list[i] : NULL;
}

conic_fact conic_fact_text(conic_fact_type type, const char *key, const char *format, ...) {
  conic_fact fact = {.type = type, .key = key};
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(fact.text, sizeof fact.text, format, arguments);
  va_end(arguments);
  return fact;
}

void conic_facts_add(conic_facts *facts, const conic_fact *more, size_t n) {
  for (size_t i = 0; i < n && facts->n < CONIC_MOST_FACTS; i++)
    facts->list[facts->n++] = more[i];
}

/* "-y" for an axis, else three numbers. */
static void name_direction(const double up[3], char text[96]) {
  snprintf(text, 96, "%.6g %.6g %.6g", up[0], up[1], up[2]);
  for (int axis = 0; axis < 3; axis++)
    if (fabs(up[axis]) == 1.0)
      snprintf(text, 96, "%s%c", up[axis] < 0.0 ? "-" : "", 'x' + axis);
}

void conic_facts_add_up(conic_facts *facts, const double up[3], conic_up_basis basis) {
  char text[96];
  name_direction(up, text);
  CONIC_ADD_FACTS(facts, CONIC_ARRAY("up"), CONIC_NUMBER(NULL, up[0]), CONIC_NUMBER(NULL, up[1]),
                  CONIC_NUMBER(NULL, up[2]), CONIC_END,
                  conic_fact_text(CONIC_FACT_TEXT, "up_basis", "%s", conic_up_basis_name(basis)),
                  CONIC_LINE("up", "%s, %s", text, conic_up_basis_reason(basis)));
}

/* With seven digits, and as many more as both ends begin with alike, as times do. */
conic_fact conic_facts_range(int is_first, const char *name, double low, double high) {
  double extent = high - low, most = fmax(fabs(low), fabs(high));
  int digits = 7;
  for (; extent > 0.0 && most > 10.0 * extent && digits < 16; digits++)
    extent *= 10.0;
  return CONIC_LINE(is_first ? "values" : "", "%s: %.*g to %.*g", name, digits, low, digits, high);
}

void conic_facts_add_system(conic_facts *facts, const conic_georeference *reference) {
  if (reference->keys || reference->is_unknown)
    CONIC_ADD_FACTS(facts, CONIC_COUNT("epsg", reference->epsg),
                    reference->epsg ? CONIC_LINE("system", "EPSG:%u", reference->epsg)
                                    : CONIC_LINE("system", "one without an EPSG code"));
}

void conic_facts_add_bounds(conic_facts *facts, const double low[3], const double high[3]) {
  CONIC_ADD_FACTS(
      facts, CONIC_OBJECT("bounds"), CONIC_ARRAY("min"), CONIC_NUMBER(NULL, low[0]), CONIC_NUMBER(NULL, low[1]),
      CONIC_NUMBER(NULL, low[2]), CONIC_END, CONIC_ARRAY("max"), CONIC_NUMBER(NULL, high[0]),
      CONIC_NUMBER(NULL, high[1]), CONIC_NUMBER(NULL, high[2]), CONIC_END, CONIC_END,
      CONIC_LINE("bounds", "%.9g %.9g %.9g to %.9g %.9g %.9g", low[0], low[1], low[2], high[0], high[1], high[2]));
}
