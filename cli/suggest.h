/* What a mistyped word may have meant. */
#ifndef CONIC_SUGGEST_H
#define CONIC_SUGGEST_H

/* How many letters must be inserted, left out, replaced or swapped with their neighbour to make one of the other. */
int cli_word_distance(const char *a, const char *b);

/* The name nearest to `word` so far, for a loop over candidates: `best` or `candidate`, and null while none is near
 * enough. */
const char *cli_nearer_word(const char *word, const char *best, const char *candidate);

#endif
