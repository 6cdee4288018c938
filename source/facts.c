#include "source/facts.h"

#include <stdarg.h>

#include "core/base/base.h"

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

void conic_facts_add_bounds(conic_facts *facts, const double low[3], const double high[3]) {
  CONIC_ADD_FACTS(
      facts, CONIC_OBJECT("bounds"), CONIC_ARRAY("min"), CONIC_NUMBER(NULL, low[0]), CONIC_NUMBER(NULL, low[1]),
      CONIC_NUMBER(NULL, low[2]), CONIC_END, CONIC_ARRAY("max"), CONIC_NUMBER(NULL, high[0]),
      CONIC_NUMBER(NULL, high[1]), CONIC_NUMBER(NULL, high[2]), CONIC_END, CONIC_END,
      CONIC_LINE("bounds", "%.9g %.9g %.9g to %.9g %.9g %.9g", low[0], low[1], low[2], high[0], high[1], high[2]));
}
