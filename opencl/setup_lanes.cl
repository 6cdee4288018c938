/* Set-up of 16 splats at a time, for CPUs: the usual splats, in the order of arithmetic of raster/project/project_splats.c. What is
 * not usual (near the camera, not finite, not to be held by float) goes to project_one. */

typedef float16 lanes;
typedef double16 doubles;

enum { LANES_POSITION = 0, LANES_TANGENT_U = 3, LANES_TANGENT_V = 6, LANES_COLOR = 9, LANES_OPACITY = 12 };

/* Splats in camera space. */
typedef struct group_splats {
  doubles p[3], inverse_z;
  lanes tu[3], tv[3];
  lanes inverse_z_float, reach, nearest, farthest;
  lanes ux, uy, uz, vx, vy, vz, area;
  int16 usual, behind;
} group_splats;

static int lanes_any(int16 mask) {
  int8 a = mask.lo | mask.hi;
  int4 b = a.lo | a.hi;
  long2 c = as_long2(b);
  return (c.x | c.y) != 0;
}

static lanes lanes_max(lanes a, lanes b) {
  return a > b ? a : b;
}

static lanes lanes_min(lanes a, lanes b) {
  return a < b ? a : b;
}

static void rotate_lanes(const float m[3][3], const lanes *v, lanes result[3]) {
  for (int row = 0; row < 3; row++)
    result[row] = (m[row][0] * v[0] + m[row][1] * v[1]) + m[row][2] * v[2];
}

/* To camera space, which are usual, and what shearing to the centre gives. */
static void look_at(const conic_view *view, const lanes *columns, group_splats *g) {
  doubles x = convert_double16(columns[0]), y = convert_double16(columns[1]), z = convert_double16(columns[2]);
  for (int row = 0; row < 3; row++) {
    const double *m = view->rotation[row];
    g->p[row] = ((m[0] * x + m[1] * y) + m[2] * z) + view->translation[row];
  }
  rotate_lanes(view->rotation_float, columns + LANES_TANGENT_U, g->tu);
  rotate_lanes(view->rotation_float, columns + LANES_TANGENT_V, g->tv);
  doubles r = convert_double16(view->cutoff * sqrt(g->tu[2] * g->tu[2] + g->tv[2] * g->tv[2])), p_z = g->p[2];
  int16 finite = convert_int16((g->p[0] + g->p[1] + p_z + r) * 0.0 == 0.0);
  g->usual = finite & convert_int16(p_z - r > view->near_z);
  g->behind = finite & ~convert_int16(p_z + r > view->near_z);
  g->inverse_z = 1.0 / p_z;
  g->reach = convert_float16(r * g->inverse_z);
  g->nearest = convert_float16((p_z - r) * g->inverse_z);
  g->farthest = convert_float16((p_z + r) * g->inverse_z);
  lanes inverse_z = convert_float16(g->inverse_z);
  lanes over_x = convert_float16(g->p[0] * g->inverse_z), over_y = convert_float16(g->p[1] * g->inverse_z);
  float fx = (float)view->fx, fy = (float)view->fy;
  g->inverse_z_float = inverse_z;
  g->uz = g->tu[2] * inverse_z;
  g->vz = g->tv[2] * inverse_z;
  g->ux = fx * (g->tu[0] * inverse_z - over_x * g->uz);
  g->uy = fy * (g->tu[1] * inverse_z - over_y * g->uz);
  g->vx = fx * (g->tv[0] * inverse_z - over_x * g->vz);
  g->vy = fy * (g->tv[1] * inverse_z - over_y * g->vz);
  g->area = g->ux * g->vy - g->uy * g->vx;
}

/* The screen's side. */
typedef struct group_screen {
  lanes bx, by, inverse_w, rxx, rxy, ryy, root, vxx, vyy, determinant;
  int16 by_ray;
  lanes shift[2], half_width[2], center[2], fraction[2];
  int16 begin[2], end[2];
} group_screen;

/* dual_conic */
static void dual_conic_lanes(const group_splats *g, float cutoff, lanes w, group_screen *s) {
  lanes inverse_w = 1.0f / w;
  float cutoff_squared = cutoff * cutoff;
  lanes tilt = cutoff_squared * (inverse_w * inverse_w);
  s->bx = g->ux * g->uz + g->vx * g->vz;
  s->by = g->uy * g->uz + g->vy * g->vz;
  s->rxx = (g->ux * g->ux + g->vx * g->vx) * inverse_w + tilt * (s->bx * s->bx);
  s->rxy = (g->ux * g->uy + g->vx * g->vy) * inverse_w + tilt * (s->bx * s->by);
  s->ryy = (g->uy * g->uy + g->vy * g->vy) * inverse_w + tilt * (s->by * s->by);
  s->root = fabs(g->area) * (inverse_w * sqrt(inverse_w));
  s->shift[0] = -(cutoff_squared * inverse_w) * s->bx;
  s->shift[1] = -(cutoff_squared * inverse_w) * s->by;
  s->inverse_w = inverse_w;
}

/* is_coarse */
static int16 are_coarse(const conic_view *view, const group_splats *g, const group_screen *s) {
  float h = view->prefilter;
  lanes square = s->root * s->root;
  lanes determinant = (square + h * (s->rxx + s->ryy)) + h * h, inverse = 1.0f / determinant;
  lanes along = view->cutoff * g->reach;
  lanes moved = (along * along) * square + h * (s->shift[0] * s->shift[0] + s->shift[1] * s->shift[1]);
  return (square * inverse) * (moved * inverse) > view->auto_limit;
}

/* wants_ray */
static int16 want_ray(const conic_view *view, const group_splats *g, const group_screen *s) {
  lanes trace = s->rxx + s->ryy, difference = s->rxx - s->ryy;
  lanes spread = sqrt(difference * difference + 4.0f * (s->rxy * s->rxy));
  lanes smaller = 2.0f * (s->root * s->root) / (trace + spread);
  int16 thick = smaller >= view->thin;
  if (view->method == CONIC_METHOD_RAY)
    return thick;
  return thick & (view->method == CONIC_METHOD_AUTO ? are_coarse(view, g, s) : g->reach >= 0.25f);
}

/* is_steep */
static int16 are_steep(const conic_view *view, const group_splats *g) {
  float limit = CONIC_AUTO_CHANGE * CONIC_AUTO_CHANGE;
  lanes nx = g->uz * g->vy - g->uy * g->vz, ny = g->ux * g->vz - g->vx * g->uz;
  return view->prefilter * (nx * nx + ny * ny) > limit * (g->area * g->area);
}

/* The variance on the screen, which formula, and how far the box reaches. */
static void measure(const conic_view *view, const group_splats *g, group_screen *s) {
  float h = view->prefilter;
  s->by_ray = 0;
  if (view->method == CONIC_METHOD_AFFINE) {
    dual_conic_lanes(g, 0.0f, 1.0f, s);
  } else {
    dual_conic_lanes(g, view->cutoff, g->nearest * g->farthest, s);
    s->by_ray = g->usual & want_ray(view, g, s);
  }
  s->vxx = s->rxx + h;
  s->vyy = s->ryy + h;
  s->determinant = (s->root * s->root + h * (s->rxx + s->ryy)) + h * h;
  s->half_width[0] = s->by_ray ? view->cutoff * sqrt(s->rxx) + view->growth_px : view->cutoff * sqrt(s->vxx);
  s->half_width[1] = s->by_ray ? view->cutoff * sqrt(s->ryy) + view->growth_px : view->cutoff * sqrt(s->vyy);
}

/* pixel_range and set_reference along one axis; an empty box has its begin not before its end. */
static void place(const group_splats *g, int axis, double principal, double focal, int size, group_screen *s) {
  long16 by_ray = convert_long16(s->by_ray);
  doubles half_width = convert_double16(s->half_width[axis]), shift = convert_double16(s->shift[axis]);
  doubles reach = by_ray ? half_width : half_width * 1.0001 + 0.01; /* a_hair_more */
  doubles p = principal + focal * (g->p[axis] * g->inverse_z), middle = p + shift, center = by_ray ? p : middle;
  doubles low = middle - reach + 0.5, high = middle + reach + 0.5;
  low = low > 0.0 ? low : 0.0;
  low = low < (double)size ? low : (double)size;
  high = high < (double)size ? high : (double)size;
  high = high > 0.0 ? high : 0.0;
  center = center > -1e9 ? center : -1e9;
  center = center < 1e9 ? center : 1e9;
  s->begin[axis] = convert_int16(low);
  s->end[axis] = convert_int16(high);
  s->center[axis] = convert_float16(convert_int16(center));
  s->fraction[axis] = convert_float16((convert_double16(s->center[axis]) + 0.5) - center);
}

/* The finished records of a group, field by field as they lie in memory. */
typedef struct group_records {
  lanes footprint[16], surface[8], ray[12];
} group_records;

static lanes finite_or_zero(lanes value) {
  return value * 0.0f == 0.0f ? value : 0.0f;
}

/* project_ray_before_near: the ray's record, and what is other in the footprint's. */
static void set_rays(const conic_view *view, const group_splats *g, const group_screen *s, group_records *r) {
  lanes *f = r->footprint, scale = g->inverse_z_float / g->area;
  lanes widening = sqrt(f[10] * f[10] + f[11] * f[11]) * view->growth_px;
  float highest = (float)(1.0 / view->near_z);
  const float hair = 0x1p-20f;
  lanes low = (f[12] - widening) - hair * f[12];
  f[5] = s->by_ray ? 0.0f : f[5];
  f[6] = s->by_ray ? 0.0f : f[6];
  f[7] = s->by_ray ? g->inverse_z_float : f[7];
  f[8] = s->by_ray ? f[10] : f[8];
  f[9] = s->by_ray ? f[11] : f[9];
  f[15] = s->by_ray ? 1.0f : f[15];
  r->ray[0] = r->ray[3] = 0.0f;
  r->ray[1] = scale * g->vy;
  r->ray[2] = -(scale * g->vx);
  r->ray[4] = -(scale * g->uy);
  r->ray[5] = scale * g->ux;
  r->ray[6] = lanes_max(low, 0.0f);
  r->ray[7] = lanes_min(f[13] + widening, highest) + hair * f[13];
  for (int axis = 0; axis < 2; axis++) {
    r->ray[8 + 2 * axis] = (convert_float16(s->begin[axis]) - s->center[axis]) + s->fraction[axis];
    r->ray[9 + 2 * axis] = (convert_float16(s->end[axis] - 1) - s->center[axis]) + s->fraction[axis];
  }
}

/* project_variance and set_depth, in the order of conic_footprint's fields; all but nearness and opacity. */
static void set_footprints(const conic_view *view, const group_splats *g, const group_screen *s, group_records *r) {
  lanes *f = r->footprint, inverse_z = g->inverse_z_float;
  lanes factor = -inverse_z * (s->inverse_w * s->inverse_w), rgx = factor * s->bx, rgy = factor * s->by;
  f[0] = s->center[0];
  f[1] = s->center[1];
  f[2] = s->fraction[0];
  f[3] = s->fraction[1];
  f[4] = sqrt(s->vyy / s->determinant);
  f[5] = -(s->rxy / s->vyy) * f[4];
  f[6] = 1.0f / sqrt(s->vyy);
  f[7] = inverse_z * s->inverse_w;
  f[8] = (s->vyy * rgx - s->rxy * rgy) / s->determinant;
  f[9] = (s->vxx * rgy - s->rxy * rgx) / s->determinant;
  f[10] = finite_or_zero(-inverse_z * (g->uz * g->vy - g->uy * g->vz) / g->area);
  f[11] = finite_or_zero(-inverse_z * (g->ux * g->vz - g->vx * g->uz) / g->area);
  f[12] = inverse_z / g->farthest;
  f[13] = inverse_z / g->nearest;
  f[15] = s->root / sqrt(s->determinant);
  if (lanes_any(s->by_ray))
    set_rays(view, g, s, r);
}

/* world_normal, set_surface and set_weighing. */
static void set_surfaces(const conic_view *view, const lanes *columns, const group_splats *g, int16 index,
                         group_records *r) {
  const lanes *tu = columns + LANES_TANGENT_U, *tv = columns + LANES_TANGENT_V;
  lanes u[3], v[3], n[3];
  lanes u_length = sqrt((tu[0] * tu[0] + tu[1] * tu[1]) + tu[2] * tu[2]);
  lanes v_length = sqrt((tv[0] * tv[0] + tv[1] * tv[1]) + tv[2] * tv[2]);
  lanes longer = lanes_max(u_length, v_length), u_scale = 1.0f / u_length, v_scale = 1.0f / v_length;
  for (int axis = 0; axis < 3; axis++) {
    u[axis] = tu[axis] * u_scale;
    v[axis] = tv[axis] * v_scale;
  }
  n[0] = u[1] * v[2] - u[2] * v[1];
  n[1] = u[2] * v[0] - u[0] * v[2];
  n[2] = u[0] * v[1] - u[1] * v[0];
  lanes scale = 1.0f / sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]), sign = g->area > 0.0f ? -1.0f : 1.0f;
  lanes epsilon = lanes_min(view->epsilon_scale * (view->cutoff * longer), view->epsilon_cap);
  lanes from_eye = convert_float16(sqrt((g->p[0] * g->p[0] + g->p[1] * g->p[1]) + g->p[2] * g->p[2]));
  r->footprint[14] = from_eye > 0.0f ? 1.0f / (1.0f + epsilon / from_eye) : 0.0f;
  r->footprint[15] *= columns[LANES_OPACITY];
  for (int axis = 0; axis < 3; axis++) {
    r->surface[axis] = columns[LANES_COLOR + axis];
    r->surface[3 + axis] = sign * (n[axis] * scale);
  }
  r->surface[6] = as_float16(index);
  r->surface[7] = r->footprint[15];
}

/* Lanes whose records are finite and within what the sums of a pixel can hold. */
static int16 are_fine(const lanes *columns, const group_screen *s, const group_records *r) {
  lanes sum = (r->footprint[2] + r->footprint[3]) * 0.0f, of_rays = 0.0f;
  for (int field = 4; field < 16; field++)
    sum += r->footprint[field] * 0.0f;
  for (int field = 0; field < 6; field++)
    sum += r->surface[field] * 0.0f;
  for (int field = 0; field < 8; field++)
    of_rays += r->ray[field] * 0.0f;
  sum += s->by_ray ? of_rays : 0.0f;
  int16 fine = (sum == 0.0f) & (columns[LANES_OPACITY] <= CONIC_GREATEST_OPACITY);
  for (int axis = 0; axis < 3; axis++)
    fine &= fabs(columns[LANES_COLOR + axis]) <= CONIC_GREATEST_COLOR;
  return fine;
}

/* What becomes of a group's lanes; what is in none is culled. */
typedef struct group_verdict {
  int16 drawn, unusual, skipped;
} group_verdict;

static void set_up_group(const conic_view *view, const lanes *columns, int16 index, group_screen *s, group_records *r,
                         group_verdict *verdict) {
  group_splats g;
  look_at(view, columns, &g);
  int16 faces = view->cull_back ? ~(g.area > 0.0f) : (int16)-1;
  measure(view, &g, s);
  int16 usual = g.usual & faces, has_area = s->by_ray | (s->determinant > 0.0f);
  verdict->skipped = usual & ~has_area;
  usual &= has_area;
  place(&g, 0, view->cx, view->fx, view->width, s);
  place(&g, 1, view->cy, view->fy, view->height, s);
  int16 on_screen = (s->begin[0] < s->end[0]) & (s->begin[1] < s->end[1]);
  int16 squares = s->by_ray | (s->determinant * 0.0f == 0.0f);
  for (int field = 0; field < 12; field++)
    r->ray[field] = 0.0f;
  set_footprints(view, &g, s, r);
  set_surfaces(view, columns, &g, index, r);
  /* A determinant that float cannot hold is not culled by a box of float's. */
  int16 odd = usual & ~(squares & are_fine(columns, s, r)) & (on_screen | ~squares);
  if (view->method == CONIC_METHOD_AUTO) /* drawn by Laplace's method */
    odd |= usual & s->by_ray & on_screen & are_steep(view, &g);
  verdict->unusual = odd | ~(g.usual | g.behind);
  verdict->drawn = usual & on_screen & ~odd;
}

static lanes zip_low(lanes a, lanes b) {
  return (lanes)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3, a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7);
}

static lanes zip_high(lanes a, lanes b) {
  return (lanes)(a.s8, b.s8, a.s9, b.s9, a.sa, b.sa, a.sb, b.sb, a.sc, b.sc, a.sd, b.sd, a.se, b.se, a.sf, b.sf);
}

/* Numbers that lie by field and then by lane come to lie by lane and then by field; n, a power of two, is how many
 * fields there are. Each round takes the highest bit of a number's place to the end. */
static void turn(lanes *fields, int n) {
  lanes turned[16];
  for (int round = 1; round < n; round *= 2) {
    for (int i = 0; i < n / 2; i++) {
      turned[2 * i] = zip_low(fields[i], fields[i + n / 2]);
      turned[2 * i + 1] = zip_high(fields[i], fields[i + n / 2]);
    }
    for (int i = 0; i < n; i++)
      fields[i] = turned[i];
  }
}

/* Appends the record of one lane of a turned group. */
static void write_lane(const group_screen *s, const group_records *r, int lane, record_places *to) {
  vstore16(r->footprint[lane], 0, (__global float *)&to->footprints[to->at]);
  vstore8(lane % 2 ? r->surface[lane / 2].hi : r->surface[lane / 2].lo, 0, (__global float *)&to->surfaces[to->at]);
  conic_box box = {(ushort)((const int *)&s->begin[0])[lane], (ushort)((const int *)&s->end[0])[lane],
                   (ushort)((const int *)&s->begin[1])[lane], (ushort)((const int *)&s->end[1])[lane]};
  to->boxes[to->at] = box;
  if (((const int *)&s->by_ray)[lane]) {
    __global float *ray = (__global float *)&to->rays[to->at];
    for (int field = 0; field < 12; field++)
      ray[field] = ((const float *)&r->ray[field])[lane];
    to->footprints[to->at].i_ray = to->at;
  }
  to->at++;
}

/* A column's numbers at the places. */
static lanes pick(__global const float *column, const uint *p) {
  return (lanes)(column[p[0]], column[p[1]], column[p[2]], column[p[3]], column[p[4]], column[p[5]], column[p[6]],
                 column[p[7]], column[p[8]], column[p[9]], column[p[10]], column[p[11]], column[p[12]], column[p[13]],
                 column[p[14]], column[p[15]]);
}

/* The first n_valid of sixteen splats by their places in the columns. */
static void project_group(const conic_view *view, splat_columns *from, const uint *places, uint n_valid,
                          record_places *to, uint counts[CONIC_DEVICE_N_COUNTS]) {
  lanes columns[13];
  group_screen s;
  group_records r;
  group_verdict verdict;
  for (int column = 0; column < 13; column++) {
    int is_there = column < LANES_COLOR || (column < LANES_OPACITY ? from->fields & CONIC_DEVICE_HAS_COLOR
                                                                   : from->fields & CONIC_DEVICE_HAS_OPACITY);
    columns[column] = is_there ? pick(from->values[column], places) : 1.0f;
  }
  set_up_group(view, columns, as_int16(vload16(0, places) + from->first), &s, &r, &verdict);
  turn(r.footprint, 16);
  turn(r.surface, 8);
  for (int lane = 0; lane < (int)n_valid; lane++) {
    if (((const int *)&verdict.drawn)[lane]) {
      count_outcome(view, ((const int *)&s.by_ray)[lane] ? CONIC_DRAWN_RAY : CONIC_DRAWN_VARIANCE, counts);
      write_lane(&s, &r, lane, to);
      if (from->n_clips)
        clip_record(view, from, places[lane], to);
    } else if (((const int *)&verdict.unusual)[lane]) {
      project_one(view, from, places[lane], to, counts);
    } else {
      count_outcome(view, ((const int *)&verdict.skipped)[lane] ? CONIC_SKIPPED : CONIC_CULLED, counts);
    }
  }
}

/* The places of those of the item's splats that do not face away or lie behind; whole groups are looked at. Returns how
 * many. */
static uint find_facing(const conic_view *view, const splat_columns *from, uint begin, uint end, uint *places) {
  uint n = 0, i = begin;
  for (; view->cull_back && i + 16 <= end; i += 16) {
    lanes columns[9];
    group_splats g;
    for (int column = 0; column < 9; column++)
      columns[column] = vload16(0, from->values[column] + i);
    look_at(view, columns, &g);
    int16 away = g.behind | (g.usual & (g.area > 0.0f));
    for (int lane = 0; lane < 16; lane++) {
      places[n] = i + (uint)lane;
      n += ((const int *)&away)[lane] == 0;
    }
  }
  for (; i < end; i++)
    places[n++] = i;
  return n;
}

/* The same as the kernel `project`, of all methods but point and disc. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void lanes_project(SETUP_ARGUMENTS) {
  conic_view view = *frame_view;
  uint item = (uint)get_global_id(0), begin = item * splats_per_item, own[CONIC_DEVICE_N_COUNTS] = {0};
  uint end = n - begin < splats_per_item ? n : begin + splats_per_item, places[CONIC_SETUP_SPLATS + 16];
  splat_columns columns = SETUP_COLUMNS;
  record_places to = {footprints, boxes, surfaces, rays, records, begin};
  seek_clip(&columns, first + begin);
  uint n_facing = find_facing(&view, &columns, begin, end, places), i = 0;
  own[CONIC_DEVICE_CULLED] = end - begin - n_facing;
  for (uint spare = 0; spare < 16; spare++) /* the last group's spare lanes repeat the first splat */
    places[n_facing + spare] = begin;
  for (; i < n_facing; i += 16)
    project_group(&view, &columns, places + i, min(n_facing - i, 16u), &to, own);
  n_drawn[item] = to.at - begin;
  add_counts(own, counts);
}
