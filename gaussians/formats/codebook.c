#include "gaussians/formats/codebook.h"

/* A value's numbers lie in at most WIDEST bins, around which it lies in their middle half at worst: 256 such cells hold
 * all bins, and no number is further from its value than by 256 equal steps. */
enum { BINS = 1 << 18, WIDEST = 1028, ROUNDS = 24 };

/* How many numbers lie in each of equal steps, and what they and their squares add up to, from `low` in steps. */
typedef struct histogram {
  double low, step;
  double counts[BINS], sums[BINS], squares[BINS];
} histogram;

/* The bins from `first` on whose numbers have one value, in steps from the histogram's low end; the last one ends where
 * the next cell begins. */
typedef struct code_cell {
  int first, last; /* with numbers; first > last: there are none */
  double value, loss;
} code_cell;

/* Where in n ascending codes a value stands, or would. */
static int place_in(const float *codebook, int n, float value) {
  int low = 0;
  while (low < n) {
    int middle = (low + n) / 2;
    if (codebook[middle] < value)
      low = middle + 1;
    else
      n = middle;
  }
  return low;
}

/* Whether there are no more than 256 values; then these, ascending, the last repeated. */
static int find_all_values(const void *numbers, conic_number_at *number_at, size_t n, float codebook[CONIC_CODES]) {
  int n_found = 0;
  for (size_t i = 0; i < n; i++) {
    float value = number_at(numbers, i);
    if (value - value != 0.0f)
      continue;
    int low = place_in(codebook, n_found, value);
    if (low < n_found && codebook[low] == value)
      continue;
    if (n_found == CONIC_CODES)
      return 0;
    memmove(codebook + low + 1, codebook + low, (size_t)(n_found - low) * sizeof *codebook);
    codebook[low] = value;
    n_found++;
  }
  for (int i = n_found; i < CONIC_CODES; i++)
    codebook[i] = n_found ? codebook[n_found - 1] : 0.0f;
  return 1;
}

/* Of a cell's bins, the value of least loss that is near enough to all of them. */
static void settle_cell(const histogram *found, code_cell *of) {
  double count = 0.0, sum = 0.0, squares = 0.0;
  while (of->first <= of->last && found->counts[of->first] == 0.0)
    of->first++;
  while (of->first <= of->last && found->counts[of->last] == 0.0)
    of->last--;
  for (int bin = of->first; bin <= of->last; bin++) {
    count += found->counts[bin];
    sum += found->sums[bin];
    squares += found->squares[bin];
  }
  of->loss = 0.0;
  if (count == 0.0)
    return;
  enum { HALF = WIDEST / 2 };
  double least = (double)(of->last + 1 - HALF), most = (double)(of->first + HALF);
  double value = sum / count;
  of->value = value < least ? least : value > most ? most : value;
  of->loss = squares - of->value * (2.0 * sum - of->value * count);
}

/* The fewest cells that hold all numbers. */
static int place_cells(const histogram *found, code_cell cells[CONIC_CODES]) {
  int n = 0;
  for (int bin = 0; bin < BINS; bin++)
    if (found->counts[bin] > 0.0) {
      cells[n] = (code_cell){bin, bin + WIDEST - 1 < BINS ? bin + WIDEST - 1 : BINS - 1, 0.0, 0.0};
      bin = cells[n].last;
      settle_cell(found, &cells[n++]);
    }
  return n;
}

/* Splits the cell that loses most, again and again, until there are 256; returns how many there are. */
static int split_cells(const histogram *found, code_cell cells[CONIC_CODES], int n) {
  while (n < CONIC_CODES) {
    int worst = 0;
    for (int i = 1; i < n; i++)
      if (cells[i].loss > cells[worst].loss)
        worst = i;
    if (cells[worst].first >= cells[worst].last)
      break;
    memmove(cells + worst + 1, cells + worst, (size_t)(n - worst) * sizeof *cells);
    int middle = (int)floor(cells[worst].value);
    middle = middle < cells[worst].last ? middle : cells[worst].last - 1;
    cells[worst].last = middle > cells[worst].first ? middle : cells[worst].first;
    cells[worst + 1].first = cells[worst].last + 1;
    settle_cell(found, &cells[worst]);
    settle_cell(found, &cells[worst + 1]);
    n++;
  }
  return n;
}

/* Lloyd's round: each bin goes to the nearest value, which then settles; values without numbers are dropped. */
static int improve_cells(const histogram *found, code_cell cells[CONIC_CODES], int n) {
  int n_kept = 0, end = cells[n - 1].last;
  for (int i = 0, bin = cells[0].first; i < n; i++) {
    code_cell next = {bin, end, 0.0, 0.0};
    if (i + 1 < n) {
      double between = 0.5 * (cells[i].value + cells[i + 1].value);
      next.last = (int)ceil(between - 0.5) - 1; /* a bin lies where its middle does */
      next.last = next.last < end ? next.last : end;
    }
    bin = next.last + 1 > bin ? next.last + 1 : bin;
    settle_cell(found, &next);
    if (next.first <= next.last)
      cells[n_kept++] = next;
  }
  return n_kept;
}

static void fill_histogram(const void *numbers, conic_number_at *number_at, size_t n, histogram *found) {
  double high = 0.0;
  int is_begun = 0;
  for (size_t i = 0; i < n; i++) {
    double value = (double)number_at(numbers, i);
    if (!conic_is_finite(value))
      continue;
    found->low = !is_begun || value < found->low ? value : found->low;
    high = !is_begun || value > high ? value : high;
    is_begun = 1;
  }
  found->step = (high - found->low) / BINS;
  for (size_t i = 0; i < n; i++) {
    double value = ((double)number_at(numbers, i) - found->low) / found->step;
    if (!conic_is_finite(value))
      continue;
    int bin = value < (double)BINS ? (int)value : BINS - 1;
    found->counts[bin]++;
    found->sums[bin] += value;
    found->squares[bin] += value * value;
  }
}

conic_status conic_codebook_make(conic_context *context, const void *numbers, conic_number_at *number_at, size_t n,
                                 float codebook[CONIC_CODES]) {
  code_cell cells[CONIC_CODES];
  if (find_all_values(numbers, number_at, n, codebook))
    return CONIC_OK;
  histogram *found = conic_memory_allocate_zeroed(context, 1, sizeof *found);
  if (!found)
    return CONIC_ERROR_MEMORY;
  fill_histogram(numbers, number_at, n, found);
  int n_cells = split_cells(found, cells, place_cells(found, cells));
  for (int i = 0; i < ROUNDS; i++)
    n_cells = split_cells(found, cells, improve_cells(found, cells, n_cells));
  for (int code = 0; code < CONIC_CODES; code++)
    codebook[code] = (float)(found->low + found->step * cells[code < n_cells ? code : n_cells - 1].value);
  conic_memory_release(context, found);
  return CONIC_OK;
}

unsigned char conic_codebook_find(const float codebook[CONIC_CODES], float value) {
  int low = place_in(codebook, CONIC_CODES - 1, value);
  if (low > 0 && value - codebook[low - 1] < codebook[low] - value)
    low--;
  return (unsigned char)low;
}
