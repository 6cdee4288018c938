/* Putting facts together: CONIC_ADD_FACTS(facts, CONIC_COUNT("points", n), …). */
#pragma once

#include "conic/source.h"
#include "core/base/message.h"
#include "core/pictures/georeference.h"

#define CONIC_COUNT(name, value) ((conic_fact){.type = CONIC_FACT_COUNT, .key = (name), .count = (uint64_t)(value)})
#define CONIC_NUMBER(name, value) ((conic_fact){.type = CONIC_FACT_NUMBER, .key = (name), .number = (double)(value)})
#define CONIC_TRUTH(name, value) ((conic_fact){.type = CONIC_FACT_TRUTH, .key = (name), .count = (value) != 0})
#define CONIC_OBJECT(name) ((conic_fact){.type = CONIC_FACT_OBJECT, .key = (name)})
#define CONIC_ARRAY(name) ((conic_fact){.type = CONIC_FACT_ARRAY, .key = (name)})
#define CONIC_END ((conic_fact){.type = CONIC_FACT_END})
/* NOLINTBEGIN(bugprone-macro-parentheses): a text that fills an array stands bare */
#define CONIC_DEFECT(name, value, what)                                                                                \
  ((conic_fact){.type = CONIC_FACT_DEFECT, .key = (name), .count = (uint64_t)(value), .text = what})
/* NOLINTEND(bugprone-macro-parentheses) */
#define CONIC_LINE(label, ...) conic_fact_text(CONIC_FACT_LINE, label, __VA_ARGS__)

/* A fact of a type with text. */
conic_fact conic_fact_text(conic_fact_type type, const char *key, const char *format, ...) CONIC_AS_PRINTF(3, 4);

enum { CONIC_MOST_FACTS = 640 };

struct conic_facts {
  conic_context *context;
  size_t n;
  conic_fact list[CONIC_MOST_FACTS];
};

/* Leaves out facts that no longer fit. */
void conic_facts_add(conic_facts *facts, const conic_fact *more, size_t n);
#define CONIC_ADD_FACTS(facts, ...)                                                                                    \
  conic_facts_add(facts, (const conic_fact[]){__VA_ARGS__},                                                            \
                  sizeof((const conic_fact[]){__VA_ARGS__}) / sizeof(conic_fact))

/* Which way is up, and why, and their line. */
void conic_facts_add_up(conic_facts *facts, const double up[3], conic_up_basis basis);

/* The line of a value's range, the first one or another. */
conic_fact conic_facts_range(int is_first, const char *name, double low, double high);

/* The code of a coordinate system, and its line, where there is one. */
void conic_facts_add_system(conic_facts *facts, const conic_georeference *reference);

/* The object "bounds", and its line. */
void conic_facts_add_bounds(conic_facts *facts, const double low[3], const double high[3]);
