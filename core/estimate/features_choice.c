/* Which clip lines a splat gets, where several creases are near. */

#include "core/base/base.h"
#include "core/estimate/features.h"

enum { MAX_CANDIDATES = 16 };

/* Lines whose directions differ by less than 15° are one crease. */
#define SAME_DIRECTION 0.966

static double length_of_line(const float line[3]) {
  return sqrt((double)line[0] * (double)line[0] + (double)line[1] * (double)line[1]);
}

void conic_clip_choice_add(conic_clip_choice *choice, const double line[3], double reach) {
  double length = sqrt(line[0] * line[0] + line[1] * line[1]), distance = line[2] / length;
  if (!(length > 0.0) || !(distance <= reach) || !(distance >= -0.25 * reach))
    return;
  int at = choice->n < MAX_CANDIDATES ? choice->n++ : MAX_CANDIDATES;
  for (; at > 0 && choice->distances[at - 1] > distance; at--)
    if (at < MAX_CANDIDATES) {
      choice->distances[at] = choice->distances[at - 1];
      memcpy(choice->lines[at], choice->lines[at - 1], sizeof choice->lines[at]);
    }
  if (at == MAX_CANDIDATES)
    return;
  choice->distances[at] = distance;
  for (int i = 0; i < 3; i++)
    choice->lines[at][i] = (float)(line[i] / length);
}

static int keeps(const conic_clip *clip, const double place[2], double slack) {
  double allowed = slack * sqrt(place[0] * place[0] + place[1] * place[1]);
  int n_keeping = 0;
  for (int i = 0; i < clip->n_lines; i++) {
    const float *line = clip->lines[i];
    n_keeping += (double)line[0] * place[0] + (double)line[1] * place[1] + (double)line[2] >= -allowed;
  }
  return clip->operation == CONIC_CLIP_OR ? n_keeping > 0 : n_keeping == clip->n_lines;
}

static int keeps_all(const conic_clip_choice *choice, const conic_clip *clip, const double (*places)[2],
                     size_t n_places, double slack) {
  size_t n_lost = 0;
  for (size_t i = 0; i < n_places; i++)
    n_lost += !keeps(clip, places[i], slack);
  return (double)n_lost <= choice->lost_share * (double)n_places;
}

/* Whether every place is kept by one of two lines; not where the lines face each other and keep everything. */
static int keeps_either(const conic_clip_choice *choice, const conic_clip *clip, const double (*places)[2],
                        size_t n_places, double slack) {
  const float *a = clip->lines[0], *b = clip->lines[1];
  int is_all =
      choice->lost_share > 0.0 && a[0] * b[0] + a[1] * b[1] < -0.5f * (float)(length_of_line(a) * length_of_line(b));
  return clip->n_lines == 2 && !is_all && keeps_all(choice, clip, places, n_places, slack);
}

int conic_clip_choose(const conic_clip_choice *choice, const double (*places)[2], size_t n_places, double slack,
                      conic_clip *clip) {
  int second = 1;
  if (choice->n == 0)
    return 0;
  const float *first = choice->lines[0];
  while (second < choice->n &&
         (double)first[0] * (double)choice->lines[second][0] + (double)first[1] * (double)choice->lines[second][1] >
             SAME_DIRECTION * length_of_line(first) * length_of_line(choice->lines[second]))
    second++;
  clip->n_lines = second < choice->n ? 2 : 1;
  clip->operation = CONIC_CLIP_AND;
  memset(clip->lines, 0, sizeof clip->lines);
  memcpy(clip->lines[0], first, sizeof clip->lines[0]);
  if (clip->n_lines == 2)
    memcpy(clip->lines[1], choice->lines[second], sizeof clip->lines[1]);
  if (keeps_all(choice, clip, places, n_places, slack))
    return 1;
  clip->operation = CONIC_CLIP_OR;
  if (keeps_either(choice, clip, places, n_places, slack))
    return 1;
  clip->operation = CONIC_CLIP_AND;
  clip->n_lines = 1;
  for (int i = 0; i < choice->n; i++) {
    memcpy(clip->lines[0], choice->lines[i], sizeof clip->lines[0]);
    if (keeps_all(choice, clip, places, n_places, slack)) {
      memset(clip->lines[1], 0, sizeof clip->lines[1]);
      return 1;
    }
  }
  return 0;
}
