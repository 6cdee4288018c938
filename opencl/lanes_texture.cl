/* Textures a block at a time, a pixel a lane: raster/triangles/texture_body.h in its order of arithmetic. */

/* A texture's coordinates and the footprints' variances, in texels² of the first level. */
typedef struct lanes_footprints {
  const conic_texture *texture;
  lanes place[2], xx, xy, yy;
} lanes_footprints;

static lanes lanes_near_or_zero(lanes value) {
  return value >= -CONIC_TEXTURE_FARTHEST && value <= CONIC_TEXTURE_FARTHEST ? value : 0.0f;
}

static lanes lanes_side_of(lanes value, int size) {
  lanes side = lanes_near_or_zero(value) * (float)size;
  side = side > -CONIC_TEXTURE_WIDEST ? side : -CONIC_TEXTURE_WIDEST;
  return side < CONIC_TEXTURE_WIDEST ? side : CONIC_TEXTURE_WIDEST;
}

static lanes lanes_place_in(lanes value, int wrap) {
  value = lanes_near_or_zero(value);
  if (wrap == CONIC_WRAP_REPEAT)
    return value - floor(value);
  value = value > 0.0f ? value : 0.0f;
  return value < 1.0f ? value : 1.0f;
}

/* The eigenvalues of the variances. */
static void lanes_extents_of(const lanes_footprints *p, lanes *greater, lanes *smaller) {
  lanes mean = 0.5f * (p->xx + p->yy), half_apart = 0.5f * (p->xx - p->yy);
  lanes spread = sqrt(half_apart * half_apart + p->xy * p->xy);
  *greater = mean + spread;
  *smaller = mean > spread ? mean - spread : 0.0f;
}

static void lanes_begin_footprints(const conic_texture *texture, const lanes uv[2], const lanes along[2],
                                   const lanes across[2], lanes_footprints *p) {
  const conic_texture_level *level = &texture->levels[0];
  lanes ax = lanes_side_of(along[0], level->width), ay = lanes_side_of(along[1], level->height);
  lanes bx = lanes_side_of(across[0], level->width), by = lanes_side_of(across[1], level->height);
  lanes greater, smaller;
  p->texture = texture;
  for (int axis = 0; axis < 2; axis++)
    p->place[axis] = lanes_place_in(uv[axis], texture->wrap);
  p->xx = CONIC_FILTER_VARIANCE * (ax * ax + bx * bx);
  p->xy = -(CONIC_FILTER_VARIANCE * (ax * ay + bx * by));
  p->yy = CONIC_FILTER_VARIANCE * (ay * ay + by * by);
  lanes_extents_of(p, &greater, &smaller);
  lanes least = greater * (1.0f / (CONIC_FILTER_RATIO * CONIC_FILTER_RATIO));
  p->xx = smaller < least ? p->xx + (least - smaller) : p->xx;
  p->yy = smaller < least ? p->yy + (least - smaller) : p->yy;
}

/* The levels on which the footprints are as wide as they should be, and how far it is to those after. */
static int16 lanes_levels_of(const lanes_footprints *p, lanes *beyond) {
  int last = p->texture->n_levels - 1;
  lanes greater, smaller;
  lanes_extents_of(p, &greater, &smaller);
  lanes width = 2.0f * sqrt(smaller);
  int16 level = 0;
  for (;;) {
    int16 is_wide = (width >= 2.0f * CONIC_FILTER_WIDTH) & (level < last);
    if (!lanes_any(is_wide))
      break;
    width = is_wide ? width * 0.5f : width;
    level -= is_wide;
  }
  *beyond = (level < last) & (width >= CONIC_FILTER_WIDTH) ? (width - CONIC_FILTER_WIDTH) / CONIC_FILTER_WIDTH : 0.0f;
  return level;
}

/* From rows or columns of the endless picture to those of the level, which has `n`. */
static int16 lanes_wrapped(int16 i, int n, int wrap) {
  if (wrap == CONIC_WRAP_REPEAT) /* no quotient but a whole number is rounded up to one */
    return i - convert_int16(floor(convert_float16(i) / (float)n)) * n;
  return min(max(i, 0), n - 1);
}

/* Adds a texel a lane to the sums of colours and weights. */
static void lanes_add_texels(const conic_texel *texels, uint16 which, lanes weight, lanes sum[4]) {
  lanes color[3];
  for (int lane = 0; lane < 16; lane++) {
    float4 texel = vload4(((const uint *)&which)[lane], texels);
    ((float *)&color[0])[lane] = texel.x;
    ((float *)&color[1])[lane] = texel.y;
    ((float *)&color[2])[lane] = texel.z;
  }
  for (int channel = 0; channel < 3; channel++)
    sum[channel] += weight * color[channel];
  sum[3] += weight;
}

/* The filter on one level. Pixels where the mask does not hold have no texels. */
static void lanes_sum_level(const lanes_footprints *p, int i_level, int16 mask, lanes sum[4]) {
  const conic_texture_level *level = &p->texture->levels[i_level];
  float shrunk = 1.0f / (float)(1 << i_level), scale = shrunk * shrunk;
  lanes xx = (mask ? p->xx * scale : 0.0f) + CONIC_FILTER_VARIANCE, xy = mask ? p->xy * scale : 0.0f;
  lanes yy = (mask ? p->yy * scale : 0.0f) + CONIC_FILTER_VARIANCE;
  lanes x = p->place[0] * (float)level->width - 0.5f, y = (1.0f - p->place[1]) * (float)level->height - 0.5f;
  lanes determinant = xx * yy - xy * xy, inverse = 1.0f / determinant;
  lanes of_yy = 1.0f / yy, slope = xy * of_yy, reach = determinant * of_yy;
  lanes reach_x = sqrt(CONIC_FILTER_SUPPORT * xx), reach_y = sqrt(CONIC_FILTER_SUPPORT * yy);
  int16 x_begin = convert_int16(floor(x - reach_x)) + 1, x_end = convert_int16(floor(x + reach_x)) + 1;
  int16 y_begin = convert_int16(floor(y - reach_y)) + 1, y_end = convert_int16(floor(y + reach_y)) + 1;
  y_end = mask ? y_end : y_begin;
  for (int16 j = y_begin; lanes_any(j < y_end); j += 1) {
    lanes dy = convert_float16(j) - y, skew = 2.0f * xy * dy, rise = xx * dy * dy;
    lanes left = CONIC_FILTER_SPAN - dy * dy * of_yy, half_row = sqrt(reach * (left > 0.0f ? left : 0.0f));
    lanes middle = x + slope * dy;
    int16 i = max(convert_int16(floor(middle - half_row)) + 1, x_begin);
    int16 end = min(convert_int16(floor(middle + half_row)) + 1, x_end);
    uint16 first = as_uint16(lanes_wrapped(j, level->height, p->texture->wrap)) * (uint)level->width;
    end = (j < y_end) & (left > 0.0f) ? end : i;
    for (; lanes_any(i < end); i += 1) {
      lanes dx = convert_float16(i) - x;
      lanes q = ((yy * dx - skew) * dx + rise) * inverse;
      lanes weight = lanes_exp_negative(-0.5f * q) - CONIC_FILTER_END;
      weight = (i < end) & (q < CONIC_FILTER_SUPPORT) ? weight : 0.0f;
      lanes_add_texels(conic_texels_of(level),
                       first + as_uint16(lanes_wrapped(i, level->width, p->texture->wrap)), weight, sum);
    }
  }
}

/* Replaces the colours where the mask holds. */
static void lanes_filter_level(const lanes_footprints *p, int i_level, int16 mask, lanes color[3]) {
  lanes sum[4] = {0.0f, 0.0f, 0.0f, 0.0f};
  if (i_level == p->texture->n_levels - 1) {
    for (int channel = 0; channel < 3; channel++)
      color[channel] = mask ? (lanes)conic_texels_of(&p->texture->levels[i_level])[channel] : color[channel];
    return;
  }
  lanes_sum_level(p, i_level, mask, sum);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = mask ? sum[channel] / sum[3] : color[channel];
}

/* Each pixel on its own level: nearly always they are all on one. */
static void lanes_filter_levels(const lanes_footprints *p, int16 levels, int16 mask, lanes color[3]) {
  for (int lane = 0; lane < 16; lane++) {
    int i_level = ((const int *)&levels)[lane];
    if (!((const int *)&mask)[lane])
      continue;
    int16 same = mask & (levels == i_level);
    lanes_filter_level(p, i_level, same, color);
    mask &= ~same;
  }
}

/* The texture's colours where the mask holds. */
static void lanes_sample_texture(const conic_texture *texture, const lanes uv[2], const lanes along[2],
                                 const lanes across[2], int16 mask, lanes color[3]) {
  lanes coarse[3] = {0.0f, 0.0f, 0.0f}, beyond;
  lanes_footprints p;
  lanes_begin_footprints(texture, uv, along, across, &p);
  int16 levels = lanes_levels_of(&p, &beyond);
  lanes_filter_levels(&p, levels, mask, color);
  lanes_filter_levels(&p, levels + 1, mask & (beyond > 0.0f), coarse);
  for (int channel = 0; channel < 3; channel++)
    color[channel] = beyond > 0.0f ? color[channel] + beyond * (coarse[channel] - color[channel]) : color[channel];
}
