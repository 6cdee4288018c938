/* From a grown tree to a file. */
#include <unistd.h>

#include "core/files/disk.h"
#include "core/files/file.h"
#include "lod/layers/build/layers_grow.h"

/* --- the entries in the order of the file: by level, then by key --- */

/* So many entries are looked at at a time. */
enum { SOME_ENTRIES = 256 };

/* The entries of a grown tree in the order of the file: by level, then by key. They lie in a file, so that memory does
 * not grow with them. */
typedef struct entry_order {
  conic_scratch file; /* conic_layers_entry each, as in the file, but for the offset, which is in the pile */
  uint64_t n;
  uint32_t n_levels;
} entry_order;

/* A node whose children are yet to come. */
typedef struct pending_node {
  uint32_t level, number;
} pending_node;

/* Entries are looked at from the last to the first. Looked at so, behind each pair of siblings comes all that is below
 * the second, then all that is below the first. So the next pair's parent is the last node that still wants children,
 * and each level is passed through from its end. */
typedef struct order_walk {
  entry_order *order;
  const conic_layers_tree *tree;
  uint64_t left; /* nodes not yet read */
  size_t n_read;
  conic_layers_entry *entries; /* SOME_ENTRIES */
  size_t n_pending;
  pending_node pending[2 * CONIC_LAYERS_MOST_LEVELS];
  uint64_t ends[CONIC_LAYERS_MOST_LEVELS + 1];    /* of the levels: what is not numbered yet ends here */
  uint64_t claimed[CONIC_LAYERS_MOST_LEVELS + 1]; /* the same, of what is children of those numbered */
  int is_numbering;                               /* or counting the levels' nodes in `ends` */
} order_walk;

static conic_status read_last(order_walk *w, conic_layers_entry **node) {
  conic_status status = CONIC_OK;
  if (w->n_read == 0) {
    w->n_read = w->left < SOME_ENTRIES ? (size_t)w->left : SOME_ENTRIES;
    w->left -= w->n_read;
    status =
        conic_spool_read(&w->tree->entries, w->left * sizeof *w->entries, w->entries, w->n_read * sizeof *w->entries);
  }
  *node = &w->entries[w->n_read ? --w->n_read : 0];
  return status;
}

/* Gives a node the last place of its level that is free, and its children theirs. */
static conic_status number_node(order_walk *w, conic_layers_entry *node, uint32_t level, uint32_t parent,
                                uint32_t *number) {
  *number = (uint32_t)--w->ends[level];
  node->parent = parent;
  node->level = (uint16_t)level;
  if (node->child)
    node->child = (uint32_t)(w->claimed[level + 1] -= 2);
  return conic_scratch_write(&w->order->file, *number * sizeof *node, node, sizeof *node);
}

static conic_status visit_node(order_walk *w, conic_layers_entry *node, uint32_t level, uint32_t parent,
                               pending_node *found) {
  conic_status status = CONIC_OK;
  *found = (pending_node){.level = level};
  if (w->is_numbering)
    status = number_node(w, node, level, parent, &found->number);
  else
    w->ends[level]++;
  return status;
}

static conic_status visit_pair(order_walk *w) {
  pending_node parent = w->pending[--w->n_pending], found[2];
  int is_inner[2];
  if (parent.level + 1 >= CONIC_LAYERS_MOST_LEVELS)
    return conic_fail(w->tree->entries.context, CONIC_ERROR_INPUT, "%s: more than %d levels", w->order->file.path,
                      CONIC_LAYERS_MOST_LEVELS);
  for (int i = 1; i >= 0; i--) {
    conic_layers_entry *node;
    conic_status status = read_last(w, &node);
    if (status == CONIC_OK) {
      is_inner[i] = node->child != 0;
      status = visit_node(w, node, parent.level + 1, parent.number, &found[i]);
    }
    if (status != CONIC_OK)
      return status;
  }
  for (int i = 0; i < 2; i++)
    if (is_inner[i])
      w->pending[w->n_pending++] = found[i];
  return CONIC_OK;
}

static conic_status walk_all(order_walk *w) {
  conic_layers_entry *root;
  w->left = w->order->n;
  w->n_read = w->n_pending = 0;
  conic_status status = read_last(w, &root);
  if (status != CONIC_OK)
    return status;
  if (root->child)
    w->n_pending = 1;
  status = visit_node(w, root, 0, 0, &w->pending[0]);
  while (status == CONIC_OK && w->n_pending > 0)
    status = visit_pair(w);
  return status;
}

/* Turns how many nodes the levels have into where they end. */
static void lay_out_levels(order_walk *w) {
  uint64_t n = 0;
  for (uint32_t i = 0; i < CONIC_LAYERS_MOST_LEVELS; i++) {
    if (w->ends[i])
      w->order->n_levels = i + 1;
    w->ends[i] = n += w->ends[i];
  }
  memcpy(w->claimed, w->ends, sizeof w->claimed);
}

/* `path`: beside which the file lies. Errors: INPUT (more than a file may have), MEMORY, IO. */
static conic_status order_entries(conic_context *context, const char *path, const conic_layers_tree *tree,
                                  entry_order *order) {
  memset(order, 0, sizeof *order);
  order->n = conic_spool_bytes(&tree->entries) / sizeof(conic_layers_entry);
  if (order->n >= UINT32_MAX)
    return conic_fail(context, CONIC_ERROR_INPUT, "%s: not written: more clouds than a file may have", path);
  order_walk *w = conic_memory_allocate_zeroed(context, 1, sizeof *w);
  conic_layers_entry *entries = conic_memory_allocate(context, SOME_ENTRIES, sizeof *entries);
  conic_status status = w && entries ? conic_scratch_open(context, path, &order->file) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK) {
    w->order = order;
    w->tree = tree;
    w->entries = entries;
    status = walk_all(w);
  }
  if (status == CONIC_OK) {
    lay_out_levels(w);
    w->is_numbering = 1;
    status = walk_all(w);
  }
  conic_memory_release_these(context, entries, w);
  return status;
}

/* Reads entries from number `first` on, SOME_ENTRIES or what there are; *n says how many. */
static conic_status read_in_order(const entry_order *order, uint64_t first, conic_layers_entry *entries, size_t *n) {
  *n = order->n - first < SOME_ENTRIES ? (size_t)(order->n - first) : SOME_ENTRIES;
  return conic_scratch_read(&order->file, first * sizeof *entries, entries, *n * sizeof *entries);
}

/* --- clouds that several processes have packed --- */

/* What a message says. The first process's tells what comes, the others' only whether they have failed. */
typedef enum message_kind { BEGIN, MOVE, END, FAILED } message_kind;

enum { LONGEST_PATH = 4096 };

/* A cloud's bytes: where they are, with the index of the process in the upper bits, and where in the file they go. */
typedef struct cloud_move {
  uint64_t from, to, n_bytes;
} cloud_move;

/* Clouds that several processes have packed, on their way into one file. */
typedef struct cloud_moving {
  conic_context *context;
  const conic_team *team;
  const char *path; /* for messages */
  const conic_pile *clouds;
  int descriptor; /* of the file */
  int is_over;    /* nothing more is told */
  unsigned char *bytes;
  size_t room;
} cloud_moving;

typedef struct file_message {
  uint64_t kind, n; /* moves */
  union {
    char path[LONGEST_PATH];
    cloud_move moves[SOME_ENTRIES];
  } body;
} file_message;

/* Every process tells all others; *first becomes what the first process tells. Where one has failed, all have. */
static conic_status tell_all(cloud_moving *m, conic_status status, file_message *first, size_t n_bytes) {
  const conic_team *team = m->team;
  size_t sizes[CONIC_MOST_IN_TEAM], at = 0;
  if (status != CONIC_OK)
    first->kind = FAILED;
  char *all = team->collect(team->data, first, team->index == 0 ? n_bytes : sizeof first->kind, sizes);
  for (int i = 0; i < team->count; at += sizes[i], i++) {
    uint64_t kind;
    memcpy(&kind, all + at, sizeof kind);
    if (kind == FAILED && status == CONIC_OK)
      status = CONIC_ERROR_CANCELLED;
  }
  memcpy(first, all, sizes[0]);
  team->release(team->data, all);
  m->is_over |= status != CONIC_OK;
  return status;
}

static conic_status cannot_write(const cloud_moving *m) {
  return conic_fail(m->context, CONIC_ERROR_IO, "%s: cannot write: %s", m->path, strerror(errno));
}

static conic_status move_one(cloud_moving *m, const cloud_move *move) {
  const uint64_t in_pile = move->from & ((UINT64_C(1) << CONIC_LAYERS_TEAM_SHIFT) - 1);
  conic_status status = conic_memory_reserve(m->context, &m->bytes, 0, (size_t)move->n_bytes, &m->room, 1);
  if (status == CONIC_OK)
    status = conic_pile_read(m->clouds, in_pile, m->bytes, (size_t)move->n_bytes);
  for (size_t done = 0; done < move->n_bytes && status == CONIC_OK;) {
    ptrdiff_t n = conic_disk_write_at(m->descriptor, m->bytes + done, (size_t)move->n_bytes - done, move->to + done);
    if (n > 0)
      done += (size_t)n;
    else if (n == 0 || errno != EINTR)
      status = cannot_write(m);
  }
  return status;
}

static conic_status move_own(cloud_moving *m, const cloud_move *moves, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    if ((int)(moves[i].from >> CONIC_LAYERS_TEAM_SHIFT) == m->team->index)
      status = move_one(m, &moves[i]);
  return status;
}

/* In the first process, before anything else is told: tells under which name the file stands that all write to, and
 * takes note where this one writes. Errors: IO (it has no name). */
static conic_status begin_moves(cloud_moving *m, const char *temporary, int descriptor) {
  file_message own = {.kind = BEGIN};
  conic_status status = CONIC_OK;
  m->descriptor = descriptor;
  if (!temporary || strlen(temporary) >= LONGEST_PATH)
    status =
        conic_fail(m->context, CONIC_ERROR_IO, "%s: cannot write: several processes write to files alone", m->path);
  else
    memcpy(own.body.path, temporary, strlen(temporary));
  return tell_all(m, status, &own, sizeof own);
}

/* In the first process: tells what is moved next, SOME_ENTRIES at most, and moves its own. 0: there is no
 * more, or, where `status` is a failure, there will not be. */
static conic_status tell_moves(cloud_moving *m, conic_status status, const cloud_move *moves, size_t n) {
  file_message own = {.kind = n ? MOVE : END, .n = n};
  if (m->is_over)
    return status;
  if (n > 0)
    memcpy(own.body.moves, moves, n * sizeof *moves);
  status = tell_all(m, status, &own, sizeof own);
  if (status == CONIC_OK && n > 0)
    return move_own(m, moves, n);
  if (status != CONIC_OK)
    return status;
  m->is_over = 1;
  return conic_team_agree(m->team, CONIC_OK); /* now all is written */
}

/* Follows what the first process tells. A failure here is told the next time. */
static conic_status follow_moves(cloud_moving *m, FILE **stream) {
  conic_status status = CONIC_OK;
  file_message *told = conic_memory_allocate(m->context, 1, sizeof *told);
  file_message without = {.kind = FAILED};
  if (!told) {
    tell_all(m, CONIC_ERROR_MEMORY, &without, sizeof without);
    return CONIC_ERROR_MEMORY;
  }
  while (!m->is_over) {
    told->kind = MOVE;
    status = tell_all(m, status, told, sizeof *told);
    if (m->is_over)
      break;
    if (told->kind == BEGIN) {
      *stream = conic_disk_open_stream(told->body.path, "r+b");
      status = *stream ? CONIC_OK : cannot_write(m);
      m->descriptor = *stream ? fileno(*stream) : -1;
    } else if (told->kind == MOVE)
      status = move_own(m, told->body.moves, (size_t)told->n);
    else {
      m->is_over = 1;
      if (fclose(*stream) != 0)
        status = cannot_write(m);
      *stream = NULL;
      status = conic_team_agree(m->team, status);
    }
  }
  conic_memory_release(m->context, told);
  return status;
}

/* In the others: moves what the first process tells of, until it is over. `status` is the first one's, which may have
 * failed before it told of anything. */
static conic_status end_moves(cloud_moving *m, conic_status status) {
  FILE *stream = NULL;
  if (m->team->index > 0)
    status = follow_moves(m, &stream);
  else if (!m->is_over)
    status = tell_moves(m, status, NULL, 0);
  if (stream)
    fclose(stream);
  conic_memory_release(m->context, m->bytes);
  return status;
}

/* --- writing --- */

typedef struct writing {
  conic_context *context;
  const conic_team *team; /* null: one process writes all */
  const conic_layers_tree *tree;
  conic_layers_header *header;
  entry_order order;
  conic_layers_entry *entries; /* some at a time */
  unsigned char *bytes;        /* of as many entries, or of a cloud */
  uint64_t offset;             /* where the next cloud's bytes will be */
  uint64_t stand_in_bytes;     /* of all */
  int is_of_stand_ins;         /* these are written, which come before all clouds */
  conic_checksumming sum;
  FILE *stream;
  cloud_moving *moving; /* likewise */
} writing;

typedef conic_status take_entries(writing *w, size_t n);

static conic_status for_entries(writing *w, take_entries *take) {
  conic_status status = CONIC_OK;
  w->offset = CONIC_LAYERS_HEADER_BYTES + conic_layers_index_bytes(w->header);
  w->offset += w->is_of_stand_ins ? 0 : w->stand_in_bytes;
  for (uint64_t first = 0; first < w->order.n && status == CONIC_OK; first += SOME_ENTRIES) {
    size_t n;
    status = read_in_order(&w->order, first, w->entries, &n);
    if (status == CONIC_OK)
      status = take(w, n);
  }
  return status;
}

/* Makes the bytes of entries as they will be in the file. */
static void make_entries(writing *w, size_t n) {
  for (size_t i = 0; i < n; i++) {
    w->entries[i].offset = w->offset;
    w->offset += w->entries[i].n_bytes;
  }
  conic_layers_write_entries(w->entries, n, w->bytes);
}

static conic_status measure_stand_ins(writing *w, size_t n) {
  for (size_t i = 0; i < n; i++)
    w->stand_in_bytes += w->entries[i].stand_in_bytes;
  return CONIC_OK;
}

static conic_status measure_clouds(writing *w, size_t n) {
  conic_layers_header *header = w->header;
  for (size_t i = 0; i < n; i++) {
    const conic_layers_entry *entry = &w->entries[i];
    header->n_samples += entry->n_samples;
    uint32_t n_most = entry->n_samples > entry->n_stand_ins ? entry->n_samples : entry->n_stand_ins;
    uint32_t n_bytes = entry->n_bytes > entry->stand_in_bytes ? entry->n_bytes : entry->stand_in_bytes;
    header->most_samples = n_most > header->most_samples ? n_most : header->most_samples;
    header->most_bytes = n_bytes > header->most_bytes ? n_bytes : header->most_bytes;
  }
  make_entries(w, n);
  conic_checksum_add(&w->sum, w->bytes, n * CONIC_LAYERS_ENTRY_BYTES);
  return CONIC_OK;
}

static void count_attribute(conic_layers_header *header, conic_layers_attribute *attribute, uint64_t n_bytes) {
  attribute->n_bytes = n_bytes;
  if (attribute->kind == CONIC_LAYERS_POSITION)
    header->position_bytes = n_bytes;
  else if (attribute->kind == CONIC_LAYERS_NORMAL || attribute->kind == CONIC_LAYERS_AXES)
    header->normal_bytes = n_bytes;
  else if (attribute->kind == CONIC_LAYERS_COLOR)
    header->color_bytes = n_bytes;
}

/* Finds all that header and index say. */
static conic_status measure_file(writing *w) {
  conic_layers_header *header = w->header;
  header->n_clouds = (uint32_t)w->order.n;
  header->n_levels = w->order.n_levels;
  header->splat_radius = w->tree->outline;
  for (uint32_t i = 0; i < header->schema.n; i++)
    count_attribute(header, &header->schema.list[i], w->tree->attribute_bytes[i]);
  conic_layers_write_table(header, w->bytes);
  conic_checksum_begin(&w->sum);
  conic_checksum_add(&w->sum, w->bytes, conic_layers_table_bytes(header));
  conic_status status = for_entries(w, measure_stand_ins);
  if (status == CONIC_OK)
    status = for_entries(w, measure_clouds);
  if (status != CONIC_OK)
    return status;
  header->file_bytes = w->offset;
  header->index_sum = conic_checksum_end(&w->sum);
  return status;
}

/* The next of the stand-ins' bytes, which lie behind their cloud's until then, or of the clouds'. */
static cloud_move move_of_entry(writing *w, const conic_layers_entry *entry) {
  cloud_move move = {entry->offset, w->offset, entry->n_bytes};
  if (w->is_of_stand_ins)
    move = (cloud_move){entry->offset + entry->n_bytes, w->offset, entry->stand_in_bytes};
  w->offset += move.n_bytes;
  return move;
}

/* Does so with all stand-ins, and then with all clouds. */
static conic_status for_all_bytes(writing *w, take_entries *take) {
  w->is_of_stand_ins = 1;
  conic_status status = for_entries(w, take);
  w->is_of_stand_ins = 0;
  return status == CONIC_OK ? for_entries(w, take) : status;
}

/* A failed write is seen when the file is committed. */
static conic_status write_entries(writing *w, size_t n) {
  make_entries(w, n);
  fwrite(w->bytes, CONIC_LAYERS_ENTRY_BYTES, n, w->stream);
  return CONIC_OK;
}

static conic_status write_clouds(writing *w, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++) {
    const cloud_move move = move_of_entry(w, &w->entries[i]);
    status = conic_pile_read(&w->tree->clouds, move.from, w->bytes, (size_t)move.n_bytes);
    if (status == CONIC_OK)
      fwrite(w->bytes, 1, (size_t)move.n_bytes, w->stream);
  }
  if (status == CONIC_OK && ferror(w->stream)) /* soon, where the disk is full */
    status = CONIC_ERROR_IO;
  return status == CONIC_OK ? conic_progress(w->context, "write", (double)w->offset / (double)w->header->file_bytes)
                            : status;
}

/* Tells every process where its clouds go. */
static conic_status move_clouds(writing *w, size_t n) {
  cloud_move moves[SOME_ENTRIES];
  for (size_t i = 0; i < n; i++)
    moves[i] = move_of_entry(w, &w->entries[i]);
  conic_status status = conic_progress(w->context, "write", (double)w->offset / (double)w->header->file_bytes);
  return tell_moves(w->moving, status, moves, n);
}

static conic_status write_clouds_together(writing *w) {
  conic_moment start = conic_moment_now();
  conic_status status = fflush(w->stream) == 0 ? for_all_bytes(w, move_clouds) : CONIC_ERROR_IO;
  status = tell_moves(w->moving, status, NULL, 0);
  conic_team_note(w->team, "write", start, w->header->file_bytes);
  return status;
}

static conic_status write_file(writing *w) {
  unsigned char head[CONIC_LAYERS_HEADER_BYTES];
  conic_layers_write_header(w->header, head);
  conic_layers_write_table(w->header, w->bytes);
  fwrite(head, 1, sizeof head, w->stream);
  fwrite(w->bytes, 1, conic_layers_table_bytes(w->header), w->stream);
  conic_status status = for_entries(w, write_entries);
  if (w->moving)
    return status == CONIC_OK ? write_clouds_together(w) : status;
  if (status == CONIC_OK)
    status = conic_memory_grow(w->context, &w->bytes, 0, w->header->most_bytes, 1);
  return status == CONIC_OK ? for_all_bytes(w, write_clouds) : status;
}

static conic_status write_measured(writing *w, const char *path) {
  conic_output *output;
  conic_status status = conic_output_open(w->context, path, &output);
  if (status != CONIC_OK)
    return status;
  w->stream = conic_output_stream(output);
  if (w->moving)
    status = begin_moves(w->moving, conic_output_temporary(output), fileno(w->stream));
  if (status == CONIC_OK)
    status = write_file(w);
  return ferror(w->stream) ? conic_output_commit(output) : conic_output_end(output, status);
}

static conic_status write_all_bytes(conic_context *context, const char *path, const conic_layers_tree *tree,
                                    conic_layers_header *header, cloud_moving *together) {
  conic_moment start = conic_moment_now();
  writing w = {.context = context,
               .team = together ? together->team : NULL,
               .tree = tree,
               .header = header,
               .moving = together,
               .entries = conic_memory_allocate(context, SOME_ENTRIES, sizeof *w.entries),
               .bytes = conic_memory_allocate(context, SOME_ENTRIES, CONIC_LAYERS_ENTRY_BYTES)};
  conic_status status =
      w.entries && w.bytes ? order_entries(context, tree->entries.path, tree, &w.order) : CONIC_ERROR_MEMORY;
  if (status == CONIC_OK)
    status = measure_file(&w);
  conic_team_note(w.team, "order", start, w.order.n);
  if (status == CONIC_OK)
    status = write_measured(&w, path);
  conic_scratch_close(&w.order.file);
  conic_memory_release_these(context, w.entries, w.bytes);
  return status;
}

conic_status conic_layers_write(conic_context *context, const char *path, const conic_team *team,
                                const conic_layers_tree *tree, conic_layers_header *header) {
  cloud_moving own = {.context = context, .team = team, .path = path, .clouds = &tree->clouds};
  if (!team)
    return write_all_bytes(context, path, tree, header, NULL);
  conic_status status = team->index == 0 ? write_all_bytes(context, path, tree, header, &own) : CONIC_OK;
  conic_moment start = conic_moment_now();
  status = end_moves(&own, status);
  if (team->index > 0)
    conic_team_note(team, "write", start, conic_spool_bytes(&tree->entries));
  return status;
}
