#include "core/base/nearest_word.h"

#include "core/base/base.h"

enum { MAX_LETTERS = 40 };

int conic_word_distance(const char *a, const char *b) {
  int cost[MAX_LETTERS + 1][MAX_LETTERS + 1]; /* of the first i letters of a against the first j of b */
  size_t n_a = strlen(a), n_b = strlen(b);
  if (n_a > MAX_LETTERS || n_b > MAX_LETTERS)
    return MAX_LETTERS;
  for (size_t i = 0; i <= n_a; i++) {
    for (size_t j = 0; j <= n_b; j++) {
      if (i == 0 || j == 0) {
        cost[i][j] = (int)(i + j);
        continue;
      }
      int replaced = cost[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
      cost[i][j] = conic_least(replaced, conic_least(cost[i - 1][j], cost[i][j - 1]) + 1);
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = conic_least(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[n_a][n_b];
}

const char *conic_nearer_word(const char *word, const char *best, const char *candidate) {
  int tolerated = (int)strlen(candidate) / 3 + 1;
  int distance = conic_word_distance(word, candidate);
  if (strlen(word) >= 3 && strncmp(word, candidate, strlen(word)) == 0)
    distance = 1; /* an abbreviation */
  if (distance > tolerated || distance >= (int)strlen(candidate) || distance >= (int)strlen(word))
    return best; /* too far, or not a letter in common */
  return best && conic_word_distance(word, best) <= distance ? best : candidate;
}
