/* Batches of splats for set-up, packed column by column. Splats that surely face away are left out. Included by
 * project_body.h. */
/* The columns of the splats from `first` on; null where the set has none. */
CONIC_INLINE void find_columns(const conic_splats *splats, size_t first, const float *columns[N_COLUMNS]) {
  for (int axis = 0; axis < 3; axis++) {
    columns[POSITION + axis] = splats->position[axis] + first;
    columns[TANGENT_U + axis] = splats->tangent_u[axis] + first;
    columns[TANGENT_V + axis] = splats->tangent_v[axis] + first;
    columns[COLOR + axis] = splats->color[axis] ? splats->color[axis] + first : NULL;
  }
  columns[OPACITY] = splats->opacity ? splats->opacity + first : NULL;
}

/* Of the splats i … i + CONIC_LANES. */
CONIC_INLINE lanes_mask columns_face_away(const conic_view *view, const float *const columns[N_COLUMNS], size_t i) {
  lanes position[3], u[3], v[3];
  for (int axis = 0; axis < 3; axis++) {
    position[axis] = lanes_load(columns[POSITION + axis] + i);
    u[axis] = lanes_load(columns[TANGENT_U + axis] + i);
    v[axis] = lanes_load(columns[TANGENT_V + axis] + i);
  }
  return surely_faces_away(view, position, u, v);
}

/* Appends the kept lanes of each column. So many columns at a time are more than the hardware fetches ahead by itself.
 */
CONIC_INLINE void append_columns(const float *const columns[N_COLUMNS], size_t i, lanes_mask kept, batch *to,
                                 size_t n_packed) {
  enum { AHEAD = 256 };
  for (int column = 0; column < N_COLUMNS; column++)
    if (columns[column]) {
      __builtin_prefetch(columns[column] + i + AHEAD);
      lanes_append((uint32_t *)(void *)(to->columns[column] + n_packed), kept,
                   (index_lanes)lanes_load(columns[column] + i));
    }
}

/* Which of CONIC_LANES splats meet the band. */
CONIC_INLINE lanes_mask meet_band(const unsigned char *bands, unsigned band) {
  typedef unsigned char byte_lanes __attribute__((vector_size(CONIC_LANES)));
  byte_lanes bytes;
  memcpy(&bytes, bands, sizeof bytes);
  return lanes_has_bits(__builtin_convertvector(bytes, index_lanes), band);
}

/* Appends those of the n splats from `first` on that do not surely face away, or meet the band. */
static void pack_batch(const conic_view *view, const conic_splats *splats, size_t first, size_t n,
                       const conic_projected *projected, batch *to) {
  const float *columns[N_COLUMNS];
  size_t i = 0, n_packed = to->n;
  find_columns(splats, first, columns);
  for (; (view->cull_back || projected->band) && i + CONIC_LANES <= n; i += CONIC_LANES) {
    lanes_mask kept = projected->band ? meet_band(projected->bands + first + i, projected->band)
                                      : lanes_not(columns_face_away(view, columns, i));
    append_columns(columns, i, kept, to, n_packed);
    n_packed += lanes_append(to->index + n_packed, kept, lanes_ascending((uint32_t)(first + i)));
  }
  for (int column = 0; column < N_COLUMNS; column++)
    if (columns[column])
      memcpy(to->columns[column] + n_packed, columns[column] + i, (n - i) * sizeof(float));
  for (; i < n; i++)
    to->index[n_packed++] = (uint32_t)(first + i);
  to->n = n_packed;
}

/* Brings what is behind the first n to the front: less than a group. */
static void keep_rest(batch *of, size_t n) {
  size_t n_left = of->n > n ? of->n - n : 0;
  for (int column = 0; column < N_COLUMNS && n_left; column++)
    memmove(of->columns[column], of->columns[column] + n, n_left * sizeof(float));
  if (n_left)
    memmove(of->index, of->index + n, n_left * sizeof *of->index);
  of->n = n_left;
}

/* None are packed yet. A set without colours is white, one without opacities opaque. */
static void begin_batches(batch *packed) {
  packed->n = 0;
  for (int column = COLOR; column < N_COLUMNS; column++)
    for (size_t i = 0; i < BATCH_ROOM; i++)
      packed->columns[column][i] = 1.0f;
}
