/* What two shots differ in. */

#include "shots/shot_text.h"

/* Keeps a path and a value, each with a zero behind it. */
static void keep_field_text(void *cookie, const conic_field_visit *visit) {
  conic_text *text = cookie;
  conic_text_add(text, visit->path, strlen(visit->path) + 1);
  conic_text_value(text, visit->row, visit->value);
  conic_text_add(text, "", 1);
}

/* The value of a field from a place on, which is where most are; null: there is none. */
static const char *find_field_value(const conic_text *text, const char *path, size_t *at) {
  for (int i = 0; i < 2; i++) {
    size_t end = text->n;
    for (size_t from = i == 0 ? *at : 0; from < end;) {
      const char *name = text->bytes + from, *value = name + strlen(name) + 1;
      from = (size_t)(value - text->bytes) + strlen(value) + 1;
      if (strcmp(name, path) != 0)
        continue;
      *at = from;
      return value;
    }
  }
  return NULL;
}

typedef struct comparing {
  conic_shot_difference *receive;
  void *cookie;
} comparing;

/* Tells of those of `a` that differ; of the second of two shots, of those that the first has not. */
static void compare_texts(const comparing *c, const conic_text *a, const conic_text *b, int is_second) {
  for (size_t from = 0, at = 0; from < a->n;) {
    const char *path = a->bytes + from, *value = path + strlen(path) + 1, *other = find_field_value(b, path, &at);
    from = (size_t)(value - a->bytes) + strlen(value) + 1;
    if (is_second && !other)
      c->receive(c->cookie, path, NULL, value);
    else if (!is_second && (!other || strcmp(value, other) != 0))
      c->receive(c->cookie, path, value, other);
  }
}

static void print_input(conic_text *text, const conic_shot_input *input) {
  conic_text_say(text, "\"");
  conic_text_print(text, "%.400s %.12s\"", input->name, *input->sha256 ? input->sha256 : "?");
}

/* By what they hold: names decide nothing. */
static conic_status compare_inputs(conic_context *context, const comparing *c, const conic_shot_file *a,
                                   const conic_shot_file *b) {
  size_t n = a->n_inputs > b->n_inputs ? a->n_inputs : b->n_inputs;
  conic_text texts[2] = {{.context = context}, {.context = context}};
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const conic_shot_input *first = i < a->n_inputs ? &a->inputs[i] : NULL,
                           *second = i < b->n_inputs ? &b->inputs[i] : NULL;
    char path[32];
    if (first && second && first->role == second->role && first->n_bytes == second->n_bytes &&
        strcmp(first->sha256, second->sha256) == 0 && (*first->sha256 || strcmp(first->name, second->name) == 0))
      continue;
    snprintf(path, sizeof path, "inputs[%zu]", i);
    texts[0].n = texts[1].n = 0;
    if (first)
      print_input(&texts[0], first);
    if (second)
      print_input(&texts[1], second);
    status = texts[0].status != CONIC_OK ? texts[0].status : texts[1].status;
    if (status == CONIC_OK)
      c->receive(c->cookie, path, first ? texts[0].bytes : NULL, second ? texts[1].bytes : NULL);
  }
  conic_text_release(&texts[0]);
  conic_text_release(&texts[1]);
  return status;
}

conic_status conic_shot_file_compare(conic_context *context, const conic_shot_file *a, const conic_shot_file *b,
                                     conic_shot_difference *receive, void *cookie) {
  const comparing c = {receive, cookie};
  conic_text first = {.context = context}, second = {.context = context};
  conic_fields_visit(a, keep_field_text, &first);
  conic_fields_visit(b, keep_field_text, &second);
  conic_status status = first.status != CONIC_OK ? first.status : second.status;
  if (status == CONIC_OK) {
    compare_texts(&c, &first, &second, 0);
    compare_texts(&c, &second, &first, 1);
    status = compare_inputs(context, &c, a, b);
  }
  conic_text_release(&first);
  conic_text_release(&second);
  return status;
}
