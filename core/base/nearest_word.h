/* The word that a mistyped word may have meant. */
#pragma once

/* How many letters must be inserted, left out, replaced or swapped with their neighbour to turn one word into the
 * other. */
int conic_word_distance(const char *a, const char *b);

/* The better match of `word` so far, `best` or `candidate`, for a loop over candidates; null while none is near
 * enough. */
const char *conic_nearer_word(const char *word, const char *best, const char *candidate);
