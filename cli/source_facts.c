#include "cli/source_facts.h"

#include <inttypes.h>

void cli_facts_report(cli_json *json, const conic_facts *facts, size_t first) {
  for (const conic_fact *fact; (fact = conic_facts_at(facts, first)); first++)
    switch (fact->type) {
    case CONIC_FACT_COUNT:
    case CONIC_FACT_DEFECT:
      cli_json_count(json, fact->key, fact->count);
      break;
    case CONIC_FACT_NUMBER:
      cli_json_number(json, fact->key, fact->number);
      break;
    case CONIC_FACT_TRUTH:
      cli_json_bool(json, fact->key, fact->count != 0);
      break;
    case CONIC_FACT_TEXT:
    case CONIC_FACT_FAULT:
      cli_json_text(json, fact->key, fact->text);
      break;
    case CONIC_FACT_OBJECT:
      cli_json_object(json, fact->key);
      break;
    case CONIC_FACT_ARRAY:
      cli_json_array(json, fact->key);
      break;
    case CONIC_FACT_END:
      cli_json_close(json);
      break;
    case CONIC_FACT_LINE:
      break;
    }
}

static int is_defect(const conic_fact *fact) {
  return fact->type == CONIC_FACT_FAULT || (fact->type == CONIC_FACT_DEFECT && fact->count > 0);
}

int cli_facts_are_sound(const conic_facts *facts) {
  const conic_fact *fact;
  for (size_t i = 0; (fact = conic_facts_at(facts, i)); i++)
    if (is_defect(fact))
      return 0;
  return 1;
}

void cli_facts_print(const conic_facts *facts) {
  const conic_fact *fact;
  int is_sound = cli_facts_are_sound(facts), is_told = 0;
  for (size_t i = 0; (fact = conic_facts_at(facts, i)); i++) {
    int is_looked_for = fact->type == CONIC_FACT_FAULT || fact->type == CONIC_FACT_DEFECT;
    if (fact->type == CONIC_FACT_LINE)
      printf("%-10s %s\n", fact->key, fact->text);
    if (is_looked_for && !is_told)
      printf("sound      %s\n", is_sound ? "yes" : "no");
    is_told |= is_looked_for;
    if (fact->type == CONIC_FACT_FAULT)
      printf("  cannot be drawn: %s\n", fact->text);
    else if (is_defect(fact))
      printf("  %" PRIu64 " %s\n", fact->count, fact->text);
  }
}
