/* Visibility, and in how far it is certain. */
#include "oracle/oracle_pixel.h"

/* The two greatest of a set, and whose the greatest is. */
typedef struct greatest {
  double first, second;
  size_t whose;
} greatest;

static void raise(greatest *g, double value, size_t i) {
  if (value > g->first) {
    g->second = g->first;
    g->first = value;
    g->whose = i;
  } else if (value > g->second)
    g->second = value;
}
static double but_for(const greatest *g, size_t i) {
  return g->whose == i ? g->second : g->first;
}

/* A splat never hides itself, so each is held against the others only. */
unsigned conic_oracle_see(oracle_fragment *fragments, size_t n) {
  const greatest nothing = {-INFINITY, -INFINITY, (size_t)-1};
  greatest surely = nothing, maybe = nothing;
  double hidden_behind = -INFINITY;
  unsigned doubt = 0;
  for (size_t i = 0; i < n; i++) {
    const oracle_fragment *f = &fragments[i];
    if (f->covers)
      hidden_behind = oracle_max(hidden_behind, f->hides.value);
    if (!f->doubt)
      raise(&surely, f->hides.low, i);
    raise(&maybe, f->hides.high, i);
  }
  for (size_t i = 0; i < n; i++) {
    oracle_fragment *f = &fragments[i];
    f->is_visible = f->covers && f->seen.value >= hidden_behind;
    if (f->seen.high < but_for(&surely, i))
      continue; /* surely hidden, so that it hides nothing either */
    doubt |= f->doubt;
    if (!f->doubt && f->seen.low < but_for(&maybe, i))
      doubt |= 1u << CONIC_UNSTABLE_VISIBILITY;
  }
  return doubt;
}
