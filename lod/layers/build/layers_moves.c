#include "lod/layers/build/layers_moves.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "core/base/memory.h"
#include "core/base/message.h"
#include "core/files/disk.h"
#include "lod/layers/build/layers_order.h"

/* What a message is: the first process's says what comes, the others' only whether they have failed. */
typedef enum word_kind { BEGIN, MOVE, END, FAILED } word_kind;

enum { LONGEST_PATH = 4096 };

typedef struct word {
  uint64_t kind, n; /* moves */
  union {
    char path[LONGEST_PATH];
    conic_layers_move moves[CONIC_LAYERS_SOME_NODES];
  } body;
} word;

/* Everybody's word to everybody, of which *first is that of the first process. Where one has failed, all have. */
static conic_status exchange_words(conic_layers_moving *m, conic_status status, word *first, size_t n_bytes) {
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

static conic_status cannot_write(const conic_layers_moving *m) {
  return conic_fail(m->context, CONIC_ERROR_IO, "%s: cannot write: %s", m->path, strerror(errno));
}

static conic_status move_one(conic_layers_moving *m, const conic_layers_move *move) {
  const uint64_t in_pile = move->from & ((UINT64_C(1) << CONIC_LAYERS_RANK_SHIFT) - 1);
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

static conic_status move_own(conic_layers_moving *m, const conic_layers_move *moves, size_t n) {
  conic_status status = CONIC_OK;
  for (size_t i = 0; i < n && status == CONIC_OK; i++)
    if ((int)(moves[i].from >> CONIC_LAYERS_RANK_SHIFT) == m->team->index)
      status = move_one(m, &moves[i]);
  return status;
}

conic_status conic_layers_moves_begin(conic_layers_moving *moving, const char *temporary, int descriptor) {
  word own = {.kind = BEGIN};
  conic_status status = CONIC_OK;
  moving->descriptor = descriptor;
  if (!temporary || strlen(temporary) >= LONGEST_PATH)
    status = conic_fail(moving->context, CONIC_ERROR_IO, "%s: cannot write: several processes write to files alone",
                        moving->path);
  else
    memcpy(own.body.path, temporary, strlen(temporary));
  return exchange_words(moving, status, &own, sizeof own);
}

conic_status conic_layers_moves_tell(conic_layers_moving *moving, conic_status status, const conic_layers_move *moves,
                                     size_t n) {
  word own = {.kind = n ? MOVE : END, .n = n};
  if (moving->is_over)
    return status;
  if (n > 0)
    memcpy(own.body.moves, moves, n * sizeof *moves);
  status = exchange_words(moving, status, &own, sizeof own);
  if (status == CONIC_OK && n > 0)
    return move_own(moving, moves, n);
  if (status != CONIC_OK)
    return status;
  moving->is_over = 1;
  return conic_team_agree(moving->team, CONIC_OK); /* now all is written */
}

/* What comes after BEGIN; whoever has failed says so the next time. */
static conic_status follow_moves(conic_layers_moving *m, FILE **stream) {
  conic_status status = CONIC_OK;
  word *told = conic_memory_allocate(m->context, 1, sizeof *told);
  word without = {.kind = FAILED};
  if (!told) {
    exchange_words(m, CONIC_ERROR_MEMORY, &without, sizeof without);
    return CONIC_ERROR_MEMORY;
  }
  while (!m->is_over) {
    told->kind = MOVE;
    status = exchange_words(m, status, told, sizeof *told);
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

conic_status conic_layers_moves_end(conic_layers_moving *moving, conic_status status) {
  FILE *stream = NULL;
  if (moving->team->index > 0)
    status = follow_moves(moving, &stream);
  else if (!moving->is_over)
    status = conic_layers_moves_tell(moving, status, NULL, 0);
  if (stream)
    fclose(stream);
  conic_memory_release(moving->context, moving->bytes);
  return status;
}
