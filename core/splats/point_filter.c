#include "core/splats/point_filter.h"

#include "core/files/number.h"

/* So many comparisons, and so deep. */
enum { MOST_STEPS = 256, MOST_DEPTH = 64, NAME_ROOM = 40 };

typedef enum step_kind { STEP_RANGE, STEP_AND, STEP_OR, STEP_NOT } step_kind;

/* Of the expression in postfix order: a range that a value has to be in, or what is made of the answers before. */
typedef struct filter_step {
  step_kind kind;
  int name;              /* of a range: whose */
  double low, high;      /* its ends, */
  int has_low, has_high; /* which belong to it, or not */
} filter_step;

struct conic_filter {
  size_t n_names, n_steps;
  char names[CONIC_FILTER_MOST_NAMES][NAME_ROOM];
  filter_step steps[MOST_STEPS];
};

typedef struct filter_parser {
  conic_context *context;
  const char *text, *at;
  conic_filter *filter;
  int depth;
} filter_parser;

void conic_filter_destroy(conic_context *context, conic_filter *filter) {
  conic_memory_release(context, filter);
}

size_t conic_filter_names(const conic_filter *filter) {
  return filter->n_names;
}

const char *conic_filter_name(const conic_filter *filter, size_t i) {
  return filter->names[i];
}

static conic_status wrong_filter(const filter_parser *p, const char *what) {
  return conic_fail(p->context, CONIC_ERROR_ARGUMENT, "'%s': %s (at character %zu)", p->text, what,
                    (size_t)(p->at - p->text) + 1);
}

static void skip_filter_blanks(filter_parser *p) {
  while (*p->at == ' ' || *p->at == '\t' || *p->at == '\n')
    p->at++;
}

static int is_filter_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (unsigned char)c >= 0x80;
}

static int is_in_filter_name(char c) {
  return is_filter_letter(c) || (c >= '0' && c <= '9') || c == '-';
}

/* Takes a sign, or a word that ends there. */
static int take_filter_token(filter_parser *p, const char *token) {
  size_t n = strlen(token);
  skip_filter_blanks(p);
  for (size_t i = 0; i < n; i++) {
    char c = p->at[i];
    if (c >= 'A' && c <= 'Z' && is_filter_letter(token[0]))
      c = (char)(c - 'A' + 'a');
    if (c != token[i])
      return 0;
  }
  if (is_filter_letter(token[0]) && is_in_filter_name(p->at[n]))
    return 0;
  p->at += n;
  return 1;
}

static conic_status add_filter_step(filter_parser *p, filter_step step) {
  if (p->filter->n_steps == MOST_STEPS)
    return wrong_filter(p, "more comparisons than 256");
  p->filter->steps[p->filter->n_steps++] = step;
  return CONIC_OK;
}

/* A word, or anything in double quotes. */
static conic_status take_filter_name(filter_parser *p, int *name) {
  char word[NAME_ROOM];
  size_t n = 0;
  skip_filter_blanks(p);
  int is_quoted = *p->at == '"';
  if (!is_quoted && !is_filter_letter(*p->at))
    return wrong_filter(p, *p->at ? "a name is expected here, in double quotes if it has other signs than letters"
                                  : "it ends where a name is expected");
  p->at += is_quoted;
  for (; is_quoted ? *p->at && *p->at != '"' : is_in_filter_name(*p->at); p->at++)
    if (n + 1 < sizeof word)
      word[n++] = *p->at;
  if (is_quoted && !*p->at)
    return wrong_filter(p, "a quoted name does not end");
  p->at += is_quoted;
  word[n] = 0;
  for (*name = 0; (size_t)*name < p->filter->n_names; ++*name)
    if (strcmp(p->filter->names[*name], word) == 0)
      return CONIC_OK;
  if (p->filter->n_names == CONIC_FILTER_MOST_NAMES)
    return wrong_filter(p, "more names than 16");
  memcpy(p->filter->names[p->filter->n_names++], word, n + 1);
  return CONIC_OK;
}

/* A number; of "2..5" the first. */
static conic_status take_filter_number(filter_parser *p, double *number) {
  size_t n = 0;
  skip_filter_blanks(p);
  while (p->at[n] && !strchr(" \t\n,)(<>=!", p->at[n]) && !(p->at[n] == '.' && p->at[n + 1] == '.'))
    n++;
  if (n == 0 || conic_number_parse(p->at, n, number) != n)
    return wrong_filter(p, *p->at ? "a number is expected here" : "it ends where a number is expected");
  p->at += n;
  return CONIC_OK;
}

/* "2", "2..5" or "2, 4..6": any of them. */
static conic_status take_filter_list(filter_parser *p, int name) {
  conic_status status = CONIC_OK;
  for (int n = 0; status == CONIC_OK && (n == 0 || take_filter_token(p, ",")); n++) {
    filter_step step = {.kind = STEP_RANGE, .name = name, .has_low = 1, .has_high = 1};
    status = take_filter_number(p, &step.low);
    step.high = step.low;
    if (status == CONIC_OK && take_filter_token(p, ".."))
      status = take_filter_number(p, &step.high);
    if (status == CONIC_OK && step.high < step.low)
      return wrong_filter(p, "a range ends before it begins");
    if (status == CONIC_OK)
      status = add_filter_step(p, step);
    if (status == CONIC_OK && n > 0)
      status = add_filter_step(p, (filter_step){.kind = STEP_OR});
  }
  return status;
}

static conic_status take_filter_range(filter_parser *p, int name) {
  int is_bracketed = take_filter_token(p, "(");
  conic_status status = take_filter_list(p, name);
  if (status == CONIC_OK && is_bracketed && !take_filter_token(p, ")"))
    return wrong_filter(p, "a list does not end");
  return status;
}

static conic_status take_filter_comparison(filter_parser *p) {
  filter_step step = {.kind = STEP_RANGE};
  conic_status status = take_filter_name(p, &step.name);
  if (status != CONIC_OK)
    return status;
  int is_not = take_filter_token(p, "!=") || take_filter_token(p, "<>");
  if (is_not || take_filter_token(p, "==") || take_filter_token(p, "=") || take_filter_token(p, "in")) {
    status = take_filter_range(p, step.name);
    return status == CONIC_OK && is_not ? add_filter_step(p, (filter_step){.kind = STEP_NOT}) : status;
  }
  int is_least = take_filter_token(p, ">="), is_most = !is_least && take_filter_token(p, "<=");
  int is_above = !is_least && !is_most && take_filter_token(p, ">");
  int is_below = !is_least && !is_most && !is_above && take_filter_token(p, "<");
  if (!is_least && !is_most && !is_above && !is_below)
    return wrong_filter(p, *p->at
                               ? "=, !=, <, <=, >, >= or in is expected here; a name with blanks or signs in it stands "
                                 "in double quotes, as '\"point density\" > 3'"
                               : "=, !=, <, <=, >, >= or in is expected here");
  status = take_filter_number(p, is_least || is_above ? &step.low : &step.high);
  if (is_least || is_above)
    step.high = HUGE_VAL;
  else
    step.low = -HUGE_VAL;
  step.has_low = is_least || is_most || is_below;
  step.has_high = is_most || is_least || is_above;
  return status == CONIC_OK ? add_filter_step(p, step) : status;
}

static conic_status take_filter_any(filter_parser *p);

static conic_status take_filter_one(filter_parser *p) {
  conic_status status;
  if (++p->depth > MOST_DEPTH)
    return wrong_filter(p, "it is nested too deeply");
  if (take_filter_token(p, "not") || take_filter_token(p, "!")) {
    status = take_filter_one(p);
    if (status == CONIC_OK)
      status = add_filter_step(p, (filter_step){.kind = STEP_NOT});
  } else if (take_filter_token(p, "(")) {
    status = take_filter_any(p);
    if (status == CONIC_OK && !take_filter_token(p, ")"))
      status = wrong_filter(p, "a ) is expected here");
  } else
    status = take_filter_comparison(p);
  p->depth--;
  return status;
}

static conic_status take_filter_all(filter_parser *p) {
  conic_status status = take_filter_one(p);
  while (status == CONIC_OK && (take_filter_token(p, "and") || take_filter_token(p, "&&"))) {
    status = take_filter_one(p);
    if (status == CONIC_OK)
      status = add_filter_step(p, (filter_step){.kind = STEP_AND});
  }
  return status;
}

static conic_status take_filter_any(filter_parser *p) {
  conic_status status = take_filter_all(p);
  while (status == CONIC_OK && (take_filter_token(p, "or") || take_filter_token(p, "||"))) {
    status = take_filter_all(p);
    if (status == CONIC_OK)
      status = add_filter_step(p, (filter_step){.kind = STEP_OR});
  }
  return status;
}

conic_status conic_filter_parse(conic_context *context, const char *expression, conic_filter **filter) {
  *filter = conic_memory_allocate_zeroed(context, 1, sizeof **filter);
  if (!*filter)
    return CONIC_ERROR_MEMORY;
  filter_parser p = {.context = context, .text = expression, .at = expression, .filter = *filter};
  conic_status status = take_filter_any(&p);
  skip_filter_blanks(&p);
  if (status == CONIC_OK && *p.at)
    status = wrong_filter(&p, "'and' or 'or' is expected here");
  if (status != CONIC_OK) {
    conic_filter_destroy(context, *filter);
    *filter = NULL;
  }
  return status;
}

static int is_in_filter_step(const filter_step *step, double value) {
  return (step->has_low ? value >= step->low : value > step->low) &&
         (step->has_high ? value <= step->high : value < step->high);
}

/* NOLINTBEGIN(clang-analyzer-core.*): the parser puts every step behind the answers that it takes */
int conic_filter_passes(const conic_filter *filter, const double *values) {
  unsigned char answers[MOST_STEPS];
  size_t n = 0;
  for (size_t i = 0; i < filter->n_steps; i++) {
    const filter_step *step = &filter->steps[i];
    if (step->kind == STEP_RANGE)
      answers[n++] = (unsigned char)is_in_filter_step(step, values[step->name]);
    else if (step->kind == STEP_NOT)
      answers[n - 1] = !answers[n - 1];
    else {
      n--;
      answers[n - 1] =
          (unsigned char)(step->kind == STEP_AND ? answers[n - 1] & answers[n] : answers[n - 1] | answers[n]);
    }
  }
  return answers[0];
}
/* NOLINTEND(clang-analyzer-core.*) */
