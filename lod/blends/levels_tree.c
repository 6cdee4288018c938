#include "lod/blends/levels_tree.h"

/* A context and a packer for each thread: what merges runs within a task. */
typedef struct tree_hand {
  conic_context *context;
  conic_zstd *zstd;
} tree_hand;

/* A level, the one of what came being 0: what has nothing above it yet, and the entries of what is written. */
typedef struct tree_level {
  conic_levels_cloud *waiting;
  size_t n_waiting, n_entries, entries_room;
  conic_levels_entry *entries;
} tree_level;

struct conic_levels_tree {
  conic_context *context;
  const char *path;
  FILE *to;
  conic_levels_header header;
  size_t n_row, n_at_once, n_hands;
  tree_hand *hands;
  tree_level levels[CONIC_LEVELS_MOST_DEPTH];
  uint64_t at; /* where the next cloud is written */
  uint64_t n_merged;
  size_t most;
};

/* Four clouds that become one, and their bytes. */
typedef struct cloud_joining {
  conic_levels_cloud *children, made;
  size_t n_children, n_bytes[CONIC_LEVELS_CHILDREN];
  unsigned char *bytes[CONIC_LEVELS_CHILDREN];
  conic_status status;
} cloud_joining;

typedef struct cloud_joinings {
  conic_levels_tree *tree;
  cloud_joining *list;
  int is_leaf;
} cloud_joinings;

conic_status conic_levels_cloud_allocate(conic_context *context, size_t n, size_t n_row, conic_levels_cloud *cloud) {
  cloud->n = n;
  return conic_memory_allocate_these(context, CONIC_ROOM(cloud->rows, n * n_row), CONIC_ROOM(cloud->parts, n),
                                     CONIC_ROOM(cloud->numbers, n));
}

static void release_cloud(conic_context *context, conic_levels_cloud *cloud) {
  conic_memory_release_these(context, cloud->rows, cloud->parts, cloud->numbers);
  memset(cloud, 0, sizeof *cloud);
}

/* Packs a cloud, with the numbers of what stands for each; null: nothing does. */
static conic_status pack_cloud(const conic_levels_tree *tree, const tree_hand *hand, const conic_levels_cloud *cloud,
                               const uint32_t *group, int is_leaf, unsigned char **bytes, size_t *n_bytes) {
  const size_t n = cloud->n, n_row = tree->n_row, n_columns = conic_levels_columns(&tree->header, is_leaf);
  uint32_t *columns;
  unsigned char *planes;
  conic_status status = conic_memory_allocate_these(tree->context, CONIC_ROOM(columns, n_columns * n),
                                                    CONIC_ROOM(planes, 4 * n_columns * n),
                                                    CONIC_ROOM(*bytes, conic_zstd_bound(4 * n_columns * n)));
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const uint32_t parent = group ? group[i] : 0;
    for (size_t k = 0; k < n_row; k++)
      columns[k * n + i] = conic_bits_of_float(cloud->rows[i * n_row + k]);
    const uint32_t *words = is_leaf ? &cloud->numbers[i] : (const uint32_t *)&cloud->parts[i];
    for (size_t k = n_row; k + 1 < n_columns; k++)
      columns[k * n + i] = words[k - n_row];
    columns[(n_columns - 1) * n + i] = is_leaf ? parent : parent | cloud->numbers[i] << CONIC_LEVELS_PARTS_BIT;
  }
  if (status == CONIC_OK) {
    *n_bytes = conic_levels_pack(hand->zstd, columns, n_columns, n, planes, *bytes);
    status = *n_bytes ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  conic_memory_release_these(tree->context, columns, planes);
  return status;
}

/* What merging some clouds takes. */
typedef struct join_room {
  conic_blend *blends, *sorted;
  uint32_t *group, *order, *first, *child; /* first: of each group in the order; child: of each blend */
} join_room;

static void take_children(const conic_levels_tree *tree, const cloud_joining *j, join_room *room) {
  size_t at = 0;
  for (size_t c = 0; c < j->n_children; c++)
    for (size_t i = 0; i < j->children[c].n; i++, at++) {
      const conic_levels_cloud *cloud = &j->children[c];
      conic_blend *b = &room->blends[at];
      conic_blend_take(cloud->rows + i * tree->n_row, (int)tree->header.sh_degree, b);
      b->parts = cloud->parts[i];
      room->child[at] = (uint32_t)c;
    }
}

/* Orders by groups, and finds where each begins. */
static void order_by_group(const uint32_t *group, size_t n, size_t n_groups, uint32_t *first, uint32_t *order) {
  memset(first, 0, (n_groups + 1) * sizeof *first);
  for (size_t i = 0; i < n; i++)
    first[group[i] + 1]++;
  for (size_t g = 0; g < n_groups; g++)
    first[g + 1] += first[g];
  for (size_t i = 0; i < n; i++)
    order[first[group[i]]++] = (uint32_t)i;
  for (size_t g = n_groups; g > 0; g--)
    first[g] = first[g - 1];
  first[0] = 0;
}

/* Makes the cloud above. */
static void merge_groups(const conic_levels_tree *tree, cloud_joining *j, const join_room *room, size_t n_groups) {
  const int degree = (int)tree->header.sh_degree;
  for (size_t g = 0; g < n_groups; g++) {
    const size_t n = room->first[g + 1] - room->first[g];
    float *row = j->made.rows + g * tree->n_row;
    conic_blend whole;
    j->made.numbers[g] = 0;
    for (size_t i = 0; i < n; i++) {
      room->sorted[i] = room->blends[room->order[room->first[g] + i]];
      j->made.numbers[g] |= 1u << room->child[room->order[room->first[g] + i]];
    }
    if (n == 1)
      memcpy(row, room->sorted[0].row, tree->n_row * sizeof *row);
    else
      conic_blend_merge(room->sorted, n, degree, row);
    conic_blend_take(row, degree, &whole);
    conic_blend_find_parts(room->sorted, n, degree, &whole);
    j->made.parts[g] = whole.parts;
  }
}

static conic_status pack_children(const cloud_joinings *all, const tree_hand *hand, cloud_joining *j,
                                  const uint32_t *group) {
  conic_status status = CONIC_OK;
  for (size_t c = 0; c < j->n_children && status == CONIC_OK; c++) {
    status = pack_cloud(all->tree, hand, &j->children[c], group, all->is_leaf, &j->bytes[c], &j->n_bytes[c]);
    group += j->children[c].n;
  }
  return status;
}

static void join_clouds(void *data, size_t i_item, int i_thread) {
  const cloud_joinings *all = data;
  const conic_levels_tree *tree = all->tree;
  const tree_hand *hand = &tree->hands[i_thread];
  cloud_joining *j = &all->list[i_item];
  join_room room;
  size_t n = 0, n_groups = 0;
  for (size_t c = 0; c < j->n_children; c++)
    n += j->children[c].n;
  j->status = conic_memory_allocate_these(
      tree->context, CONIC_ROOM(room.blends, n), CONIC_ROOM(room.sorted, CONIC_BLEND_MOST_PARTS),
      CONIC_ROOM(room.group, n), CONIC_ROOM(room.order, n), CONIC_ROOM(room.first, n + 1), CONIC_ROOM(room.child, n));
  if (j->status == CONIC_OK) {
    take_children(tree, j, &room);
    j->status = conic_blend_group(hand->context, room.blends, n,
                                  (n + CONIC_LEVELS_CHILDREN - 1) / CONIC_LEVELS_CHILDREN, room.group, &n_groups);
  }
  if (j->status == CONIC_OK)
    j->status = conic_levels_cloud_allocate(tree->context, n_groups, tree->n_row, &j->made);
  if (j->status == CONIC_OK) {
    order_by_group(room.group, n, n_groups, room.first, room.order);
    merge_groups(tree, j, &room, n_groups);
    j->status = pack_children(all, hand, j, room.group);
  }
  conic_memory_release_these(tree->context, room.blends, room.sorted, room.group, room.order, room.first, room.child);
}

static conic_status write_cloud(conic_levels_tree *tree, tree_level *level, const unsigned char *bytes, size_t n_bytes,
                                size_t n) {
  const conic_levels_entry entry = {tree->at, conic_checksum(bytes, n_bytes), (uint32_t)n_bytes, (uint32_t)n};
  tree->at += n_bytes;
  tree->most = n > tree->most ? n : tree->most;
  tree->n_merged += level == tree->levels ? 0 : n;
  if (fwrite(bytes, 1, n_bytes, tree->to) != n_bytes)
    return conic_fail(tree->context, CONIC_ERROR_IO, "%s: cannot write: %s", tree->path, strerror(errno));
  return conic_memory_append(tree->context, &level->entries, &level->n_entries, &level->entries_room, &entry,
                             sizeof entry);
}

/* Writes clouds that are joined, and drops them; hands over what was made of them. */
static conic_status take_joining(conic_levels_tree *tree, tree_level *level, cloud_joining *j) {
  conic_status status = j->status;
  for (size_t c = 0; c < j->n_children; c++) {
    if (status == CONIC_OK)
      status = write_cloud(tree, level, j->bytes[c], j->n_bytes[c], j->children[c].n);
    conic_memory_release(tree->context, j->bytes[c]);
    release_cloud(tree->context, &j->children[c]);
  }
  if (status == CONIC_OK && j->made.n > CONIC_LEVELS_PARENT)
    status = conic_fail(tree->context, CONIC_ERROR_INPUT, "%s: its Gaussians cannot be merged", tree->path);
  if (status == CONIC_OK)
    level[1].waiting[level[1].n_waiting++] = j->made;
  else
    release_cloud(tree->context, &j->made);
  return status;
}

static conic_status raise_level(conic_levels_tree *tree, tree_level *level);

/* Takes what is above a level's waiting clouds up. */
static conic_status join_waiting(conic_levels_tree *tree, tree_level *level) {
  const size_t n = (level->n_waiting + CONIC_LEVELS_CHILDREN - 1) / CONIC_LEVELS_CHILDREN;
  cloud_joinings all = {tree, conic_memory_allocate_zeroed(tree->context, n, sizeof *all.list), level == tree->levels};
  conic_status status = all.list ? CONIC_OK : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK && !level[1].waiting)
    status = conic_memory_allocate_these(tree->context,
                                         CONIC_ZEROED(level[1].waiting, CONIC_LEVELS_CHILDREN * tree->n_at_once));
  if (status == CONIC_OK) {
    for (size_t i = 0; i < n; i++) {
      const size_t first = i * CONIC_LEVELS_CHILDREN, left = level->n_waiting - first;
      all.list[i].children = level->waiting + first;
      all.list[i].n_children = left < CONIC_LEVELS_CHILDREN ? left : CONIC_LEVELS_CHILDREN;
    }
    conic_parallel_for(tree->context, n, join_clouds, &all);
    for (size_t i = 0; i < n; i++) {
      const conic_status taken = take_joining(tree, level, &all.list[i]);
      status = status == CONIC_OK ? taken : status;
    }
    level->n_waiting = 0;
  }
  conic_memory_release(tree->context, all.list);
  return status == CONIC_OK ? raise_level(tree, level + 1) : status;
}

static conic_status raise_level(conic_levels_tree *tree, tree_level *level) {
  return level->n_waiting < CONIC_LEVELS_CHILDREN * tree->n_at_once ? CONIC_OK : join_waiting(tree, level);
}

conic_status conic_levels_tree_create(conic_context *context, const conic_levels_header *header, size_t n_at_once,
                                      FILE *to, const char *path, conic_levels_tree **tree) {
  conic_context_options alone;
  conic_levels_tree *t = *tree = conic_memory_allocate_zeroed(context, 1, sizeof *t);
  if (!t)
    return CONIC_ERROR_MEMORY;
  *t = (conic_levels_tree){.context = context,
                           .path = path,
                           .to = to,
                           .header = *header,
                           .n_row = conic_levels_row(header),
                           .n_at_once = n_at_once,
                           .n_hands = (size_t)conic_context_threads(context),
                           .at = CONIC_FILE_HEADER_BYTES};
  conic_context_options_init(&alone);
  alone.threads = 1;
  conic_status status =
      conic_memory_allocate_these(context, CONIC_ZEROED(t->hands, t->n_hands),
                                  CONIC_ZEROED(t->levels[0].waiting, CONIC_LEVELS_CHILDREN * n_at_once));
  for (size_t i = 0; i < t->n_hands && status == CONIC_OK; i++) {
    status = conic_context_create(&alone, &t->hands[i].context);
    if (status == CONIC_OK)
      status = conic_zstd_create(context, &t->hands[i].zstd);
  }
  return status;
}

void conic_levels_tree_destroy(conic_levels_tree *tree) {
  if (!tree)
    return;
  for (int k = 0; k < CONIC_LEVELS_MOST_DEPTH; k++) {
    tree_level *level = &tree->levels[k];
    for (size_t i = 0; i < level->n_waiting; i++)
      release_cloud(tree->context, &level->waiting[i]);
    conic_memory_release_these(tree->context, level->waiting, level->entries);
  }
  for (size_t i = 0; tree->hands && i < tree->n_hands; i++) {
    conic_zstd_destroy(tree->context, tree->hands[i].zstd);
    conic_context_destroy(tree->hands[i].context);
  }
  conic_memory_release_these(tree->context, tree->hands, tree);
}

conic_status conic_levels_tree_add(conic_levels_tree *tree, conic_levels_cloud *cloud) {
  tree_level *leaves = &tree->levels[0];
  for (size_t i = 0; i < cloud->n; i++) {
    conic_blend blend;
    conic_blend_take(cloud->rows + i * tree->n_row, (int)tree->header.sh_degree, &blend);
    cloud->parts[i] = blend.parts;
  }
  leaves->waiting[leaves->n_waiting++] = *cloud;
  memset(cloud, 0, sizeof *cloud);
  return raise_level(tree, leaves);
}

static conic_status write_root(conic_levels_tree *tree, tree_level *level) {
  unsigned char *bytes;
  size_t n_bytes = 0;
  conic_status status = pack_cloud(tree, tree->hands, level->waiting, NULL, level == tree->levels, &bytes, &n_bytes);
  if (status == CONIC_OK)
    status = write_cloud(tree, level, bytes, n_bytes, level->waiting->n);
  conic_memory_release(tree->context, bytes);
  return status;
}

static conic_status write_index(conic_levels_tree *tree, int n_levels, conic_levels_header *header) {
  size_t n = 0, at = 0;
  for (int k = 0; k < n_levels; k++)
    n += tree->levels[k].n_entries;
  unsigned char *bytes = conic_memory_allocate(tree->context, n, CONIC_LEVELS_ENTRY_BYTES);
  if (!bytes)
    return CONIC_ERROR_MEMORY;
  for (int k = n_levels - 1; k >= 0; at += tree->levels[k--].n_entries)
    conic_levels_write_entries(tree->levels[k].entries, tree->levels[k].n_entries,
                               bytes + at * CONIC_LEVELS_ENTRY_BYTES);
  header->index_at = tree->at;
  header->index_sum = conic_checksum(bytes, n * CONIC_LEVELS_ENTRY_BYTES);
  header->most = (uint32_t)tree->most;
  header->n_merged = tree->n_merged;
  int is_written = fwrite(bytes, CONIC_LEVELS_ENTRY_BYTES, n, tree->to) == n;
  conic_memory_release(tree->context, bytes);
  return is_written ? CONIC_OK
                    : conic_fail(tree->context, CONIC_ERROR_IO, "%s: cannot write: %s", tree->path, strerror(errno));
}

conic_status conic_levels_tree_end(conic_levels_tree *tree, conic_levels_header *header) {
  conic_status status = CONIC_OK;
  int k = 0;
  for (; status == CONIC_OK && tree->levels[k].n_entries + tree->levels[k].n_waiting > 1; k++)
    if (tree->levels[k].n_waiting > 0)
      status = join_waiting(tree, &tree->levels[k]);
  if (status == CONIC_OK)
    status = write_root(tree, &tree->levels[k]);
  return status == CONIC_OK ? write_index(tree, k + 1, header) : status;
}
