/* What a mistyped word may have meant. */
#ifndef CONIC_NEAREST_WORD_H
#define CONIC_NEAREST_WORD_H

/* How many letters must be inserted, left out, replaced or swapped with their neighbour to make one of the other. */
int conic_word_distance(const char *a, const char *b);

/* The name nearest to `word` so far, for a loop over candidates: `best` or `candidate`, and null while none is near
 * enough. */
const char *conic_nearer_word(const char *word, const char *best, const char *candidate);

#endif
