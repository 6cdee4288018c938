#include "mpi/ranks.h"

#include <mpi.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#include "mpi/outbox.h"

/* Counts of MPI are ints: what is longer goes in pieces. */
enum { PIECE_BYTES = 1 << 28 };

/* Messages to rank 0's thread, and its answers. */
enum tag { TAG_NEXT = 1, TAG_UNIT, TAG_STOP, TAG_HAND, TAG_HAND_PIECE, TAG_END, TAG_BLOB, TAG_PIECE };

static int own_index, n_ranks = 1;
static MPI_Comm service_line, main_line; /* the thread's, and that of the ranks among each other */
static pthread_t service;

/* On rank 0, of the shared work. */
static struct {
  pthread_mutex_t lock;
  uint64_t next, end, allowed;
  double begun_s, busy_s; /* since when, and how long the thread has taken what was handed over */
  conic_unit_taker *take;
  void *cookie;
  int *waiting; /* ranks that want a unit that is not allowed yet */
  int n_waiting;
  atomic_int is_wanted; /* rank 0 itself wants the lock, which the thread would else take again at once */
} work = {.lock = PTHREAD_MUTEX_INITIALIZER};

static pthread_mutex_t traffic_lock = PTHREAD_MUTEX_INITIALIZER;
static struct {
  uint64_t sent_bytes, received_bytes;
  double waited_seconds;
} traffic;
static _Thread_local int is_beside; /* the thread, whose waiting holds nothing up */

static void fail(const char *what) {
  fprintf(stderr, "conic: error: rank %d: %s\n", own_index, what);
  MPI_Abort(MPI_COMM_WORLD, 4);
}

static void *take_memory(size_t n_bytes) {
  void *bytes = malloc(n_bytes ? n_bytes : 1);
  if (!bytes)
    fail("out of memory");
  return bytes;
}

static void count_traffic(uint64_t sent_bytes, uint64_t received_bytes, double waited_seconds) {
  pthread_mutex_lock(&traffic_lock);
  traffic.sent_bytes += sent_bytes;
  traffic.received_bytes += received_bytes;
  traffic.waited_seconds += is_beside ? 0.0 : waited_seconds;
  pthread_mutex_unlock(&traffic_lock);
}

static void tell_traffic(void *unused, uint64_t *sent_bytes, uint64_t *received_bytes, double *waited_seconds) {
  (void)unused;
  pthread_mutex_lock(&traffic_lock);
  *sent_bytes = traffic.sent_bytes;
  *received_bytes = traffic.received_bytes;
  *waited_seconds = traffic.waited_seconds;
  pthread_mutex_unlock(&traffic_lock);
}

/* --- waiting asleep --- */

/* Sleeps the longer the longer nothing has come: 20 µs to 1 ms. */
static void doze(int *n_dozes) {
  long ns = 20000L << (*n_dozes < 48 ? *n_dozes / 8 : 6);
  struct timespec time = {0, ns < 1000000L ? ns : 1000000L};
  nanosleep(&time, NULL);
  ++*n_dozes;
}

static void wait_for(MPI_Request *request) {
  int is_done = 0, n_dozes = 0;
  double start = conic_seconds_now();
  MPI_Test(request, &is_done, MPI_STATUS_IGNORE);
  while (!is_done) {
    doze(&n_dozes);
    MPI_Test(request, &is_done, MPI_STATUS_IGNORE);
  }
  count_traffic(0, 0, n_dozes ? conic_seconds_now() - start : 0.0);
}

/* Of a piece the other side is at work on, too, and each test moves some of its bytes: who dozes long holds both up. */
static void move_piece(MPI_Request *request) {
  enum { YIELDS = 256 };
  int is_done = 0;
  double start = conic_seconds_now();
  MPI_Test(request, &is_done, MPI_STATUS_IGNORE);
  for (int n = 0; !is_done; n++) {
    int n_dozes = 0;
    if (n < YIELDS)
      sched_yield();
    else
      doze(&n_dozes);
    MPI_Test(request, &is_done, MPI_STATUS_IGNORE);
  }
  count_traffic(0, 0, conic_seconds_now() - start);
}

static int is_piece(int tag) {
  return tag == TAG_PIECE || tag == TAG_HAND_PIECE;
}

static void send_once(const void *bytes, size_t n_bytes, int to, int tag, MPI_Comm line) {
  MPI_Request request;
  MPI_Issend(bytes, (int)n_bytes, MPI_BYTE, to, tag, line, &request);
  (is_piece(tag) ? move_piece : wait_for)(&request);
  count_traffic(n_bytes, 0, 0.0);
}

static void receive_once(void *bytes, size_t n_bytes, int from, int tag, MPI_Comm line) {
  MPI_Request request;
  MPI_Irecv(bytes, (int)n_bytes, MPI_BYTE, from, tag, line, &request);
  (is_piece(tag) ? move_piece : wait_for)(&request);
  count_traffic(0, n_bytes, 0.0);
}

static size_t piece_bytes(size_t offset, size_t n_bytes) {
  size_t rest = n_bytes - offset;
  return rest < PIECE_BYTES ? rest : PIECE_BYTES;
}

/* The size first, then the pieces, for which the other then waits. */
static void send_blob(int to, const void *bytes, size_t n_bytes, int tag, int piece_tag, MPI_Comm line) {
  uint64_t size = n_bytes;
  send_once(&size, sizeof size, to, tag, line);
  for (size_t at = 0; at < n_bytes; at += piece_bytes(at, n_bytes))
    send_once((const char *)bytes + at, piece_bytes(at, n_bytes), to, piece_tag, line);
}

static void *receive_pieces(int from, size_t n_bytes, int piece_tag, MPI_Comm line) {
  char *bytes = take_memory(n_bytes);
  for (size_t at = 0; at < n_bytes; at += piece_bytes(at, n_bytes))
    receive_once(bytes + at, piece_bytes(at, n_bytes), from, piece_tag, line);
  return bytes;
}

/* --- the thread of rank 0 --- */

/* Under the lock. Whether the next unit, or that there is none, is known. */
static int take_unit(uint64_t *unit) {
  *unit = work.next < work.end ? work.next : CONIC_NO_UNIT;
  if (*unit != CONIC_NO_UNIT && *unit >= work.allowed)
    return 0;
  work.next += *unit != CONIC_NO_UNIT;
  return 1;
}

static void take_hand(int from, uint64_t n_bytes) {
  double start = conic_seconds_now();
  void *bytes = receive_pieces(from, (size_t)n_bytes, TAG_HAND_PIECE, service_line);
  if (work.take)
    work.take(work.cookie, from, bytes, (size_t)n_bytes);
  free(bytes);
  work.busy_s += conic_seconds_now() - start;
}

/* Under the lock. Whether the thread goes on. */
static int heed(MPI_Message *message, const MPI_Status *status) {
  uint64_t word = 0;
  MPI_Mrecv(&word, sizeof word, MPI_BYTE, message, MPI_STATUS_IGNORE);
  if (status->MPI_TAG == TAG_NEXT)
    work.waiting[work.n_waiting++] = status->MPI_SOURCE;
  else if (status->MPI_TAG == TAG_STOP)
    work.end = 0;
  else if (status->MPI_TAG == TAG_HAND)
    take_hand(status->MPI_SOURCE, word);
  return status->MPI_TAG != TAG_END;
}

/* Whoever wants a unit does nothing until it has one; what is handed over can wait. No piece is found: those come only
 * after their size was matched, to who waits for them. */
static int find_message(MPI_Message *message, MPI_Status *status) {
  int is_found = 0;
  MPI_Improbe(MPI_ANY_SOURCE, TAG_NEXT, service_line, &is_found, message, status);
  if (!is_found)
    MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, service_line, &is_found, message, status);
  return is_found;
}

/* A message is matched under the lock: who holds the lock knows that what was sent has been dealt with. */
static void *serve(void *unused) {
  int is_going_on = 1, n_dozes = 0;
  (void)unused;
  while (is_going_on) {
    MPI_Message message;
    MPI_Status status;
    pthread_mutex_lock(&work.lock);
    int is_found = find_message(&message, &status);
    if (is_found)
      is_going_on = heed(&message, &status);
    /* Under the lock; what is sent is small, and somebody waits for it. */
    uint64_t unit;
    while (work.n_waiting > 0 && take_unit(&unit))
      MPI_Send(&unit, sizeof unit, MPI_BYTE, work.waiting[--work.n_waiting], TAG_UNIT, service_line);
    pthread_mutex_unlock(&work.lock);
    while (atomic_load(&work.is_wanted))
      sched_yield();
    if (is_found)
      n_dozes = 0;
    else
      doze(&n_dozes);
  }
  return NULL;
}

static void tell_service(int tag) {
  const uint64_t word = 0;
  send_once(&word, sizeof word, 0, tag, service_line);
}

/* --- the job --- */

void ranks_begin(int *argc, char ***argv) {
  int provided;
  MPI_Init_thread(argc, argv, MPI_THREAD_MULTIPLE, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &own_index);
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  if (n_ranks == 1)
    return;
  if (provided < MPI_THREAD_MULTIPLE)
    fail("this MPI has no threads (MPI_THREAD_MULTIPLE)");
  MPI_Comm_dup(MPI_COMM_WORLD, &service_line);
  MPI_Comm_dup(MPI_COMM_WORLD, &main_line);
  if (own_index > 0)
    return;
  work.waiting = take_memory((size_t)n_ranks * sizeof *work.waiting);
  if (pthread_create(&service, NULL, serve, NULL) != 0)
    fail("cannot start a thread");
}

void ranks_end(void) {
  outbox_end();
  if (n_ranks > 1) {
    ranks_barrier();
    if (own_index == 0) {
      tell_service(TAG_END);
      pthread_join(service, NULL);
      free(work.waiting);
    }
    ranks_barrier(); /* nobody leaves a message on its way */
  }
  MPI_Finalize();
}

int ranks_index(void) {
  return own_index;
}

int ranks_count(void) {
  return n_ranks;
}

int ranks_on_machine(void) {
  MPI_Comm machine;
  int n;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &n);
  MPI_Comm_free(&machine);
  return n;
}

void ranks_library(char *text, size_t room) {
  char whole[MPI_MAX_LIBRARY_VERSION_STRING];
  int length;
  MPI_Get_library_version(whole, &length);
  whole[strcspn(whole, ",\n")] = '\0';
  for (char *c = whole; *c; c++)
    *c = (char)(*c == '\t' ? ' ' : *c);
  snprintf(text, room, "%s", whole);
}

/* --- units --- */

static void lock_of_first(void) {
  atomic_store(&work.is_wanted, 1);
  pthread_mutex_lock(&work.lock);
  atomic_store(&work.is_wanted, 0);
}

static void share_units(void *unused, uint64_t n, conic_unit_taker *take, void *cookie) {
  (void)unused;
  if (n_ranks > 1)
    ranks_barrier();
  if (own_index == 0) {
    pthread_mutex_lock(&work.lock);
    work.next = 0;
    work.end = n;
    work.allowed = UINT64_MAX;
    work.begun_s = conic_seconds_now();
    work.busy_s = 0.0;
    work.take = take;
    work.cookie = cookie;
    pthread_mutex_unlock(&work.lock);
  }
  if (n_ranks > 1)
    ranks_barrier();
}

/* Under the lock. While its thread takes what others hand over, rank 0 gets on more slowly, and should not be the last
 * to end. So it leaves the rest to them once there are fewer units for each than eight times the part of its time that
 * went so. That part is not known before the first results come, so it is taken to be n_ranks / 64 at least. */
static int leaves_rest(void) {
  double left = work.end > work.next ? (double)(work.end - work.next) : 0.0,
         lasted_s = conic_seconds_now() - work.begun_s, part = lasted_s > 0.0 ? work.busy_s / lasted_s : 0.0,
         least = n_ranks / 64.0;
  return work.take && left < 8.0 * n_ranks * (part > least ? part : least);
}

static uint64_t next_of_first(void) {
  uint64_t unit = CONIC_NO_UNIT;
  int n_dozes = 0, is_known;
  do {
    lock_of_first();
    is_known = leaves_rest() || take_unit(&unit);
    pthread_mutex_unlock(&work.lock);
    if (!is_known)
      doze(&n_dozes);
  } while (!is_known);
  return unit;
}

static uint64_t next_unit(void *unused) {
  uint64_t unit;
  (void)unused;
  if (own_index == 0)
    return next_of_first();
  tell_service(TAG_NEXT);
  receive_once(&unit, sizeof unit, 0, TAG_UNIT, service_line);
  return unit;
}

/* Nobody is given any more. */
static void stop_units(void) {
  if (own_index > 0) {
    tell_service(TAG_STOP);
    return;
  }
  pthread_mutex_lock(&work.lock);
  work.end = 0;
  pthread_mutex_unlock(&work.lock);
}

static void allow_units(void *unused, uint64_t end) {
  (void)unused;
  work.allowed = end; /* by `take`, which is called under the lock, or before any unit is taken */
}

static void send_hand(const void *bytes, size_t n_bytes) {
  is_beside = 1;
  send_blob(0, bytes, n_bytes, TAG_HAND, TAG_HAND_PIECE, service_line);
}

static void hand_to_first(void *unused, const void *bytes, size_t n_bytes) {
  (void)unused;
  if (own_index > 0) {
    double start = conic_seconds_now();
    if (!outbox_put(bytes, n_bytes, send_hand))
      fail("out of memory");
    count_traffic(0, 0, conic_seconds_now() - start);
    return;
  }
  lock_of_first();
  if (work.take)
    work.take(work.cookie, 0, bytes, n_bytes);
  pthread_mutex_unlock(&work.lock);
}

/* --- among each other --- */

void ranks_barrier(void) {
  MPI_Request request;
  if (n_ranks == 1)
    return;
  MPI_Ibarrier(main_line, &request);
  wait_for(&request);
}

static void broadcast_from(int root, void *bytes, size_t n_bytes) {
  for (size_t at = 0; at < n_bytes && n_ranks > 1; at += piece_bytes(at, n_bytes)) {
    MPI_Request request;
    MPI_Ibcast((char *)bytes + at, (int)piece_bytes(at, n_bytes), MPI_BYTE, root, main_line, &request);
    wait_for(&request);
  }
  count_traffic(own_index == root ? n_bytes : 0, own_index == root ? 0 : n_bytes, 0.0);
}

static void broadcast(void *unused, void *bytes, size_t n_bytes) {
  (void)unused;
  broadcast_from(0, bytes, n_bytes);
}

static int worst_of_ranks(void *unused, int code, char *message, size_t room) {
  struct {
    int code, rank;
  } own = {code, own_index}, worst = own;
  (void)unused;
  if (n_ranks == 1)
    return code;
  if (code > 0)
    stop_units();
  /* All that this rank has handed over is rank 0's, or on its way to the one thread that takes it. */
  double start = conic_seconds_now();
  outbox_wait();
  count_traffic(0, 0, conic_seconds_now() - start);
  MPI_Request request;
  MPI_Iallreduce(&own, &worst, 1, MPI_2INT, MPI_MAXLOC, main_line, &request);
  wait_for(&request);
  if (own_index == 0) { /* whatever was matched before has been taken */
    pthread_mutex_lock(&work.lock);
    pthread_mutex_unlock(&work.lock);
  }
  broadcast_from(worst.rank, message, room);
  return worst.code;
}

static void send_bytes(void *unused, int to, const void *bytes, size_t n_bytes) {
  (void)unused;
  send_blob(to, bytes, n_bytes, TAG_BLOB, TAG_PIECE, main_line);
}

static void *receive_bytes(void *unused, int from, size_t *n_bytes) {
  uint64_t size;
  (void)unused;
  receive_once(&size, sizeof size, from, TAG_BLOB, main_line);
  *n_bytes = (size_t)size;
  return receive_pieces(from, (size_t)size, TAG_PIECE, main_line);
}

void *ranks_gather(const void *bytes, size_t n_bytes, size_t *sizes) {
  if (own_index > 0) {
    send_bytes(NULL, 0, bytes, n_bytes);
    return NULL;
  }
  size_t total = n_bytes;
  char *all = malloc(n_bytes ? n_bytes : 1);
  if (all && n_bytes)
    memcpy(all, bytes, n_bytes);
  sizes[0] = n_bytes;
  for (int from = 1; from < n_ranks; from++) {
    void *part = receive_bytes(NULL, from, &sizes[from]);
    char *longer = all ? realloc(all, total + sizes[from] + 1) : NULL;
    if (longer)
      memcpy(longer + total, part, sizes[from]);
    else
      free(all);
    all = longer;
    total += sizes[from];
    free(part);
  }
  return all;
}

static void release_bytes(void *unused, void *bytes) {
  (void)unused;
  free(bytes);
}

/* Gathered on rank 0, and from there to all. */
static void *collect_bytes(void *unused, const void *bytes, size_t n_bytes, size_t *sizes) {
  size_t total = 0;
  char *all = ranks_gather(bytes, n_bytes, sizes);
  (void)unused;
  broadcast_from(0, sizes, (size_t)n_ranks * sizeof *sizes);
  for (int i = 0; i < n_ranks; i++)
    total += sizes[i];
  if (own_index > 0)
    all = take_memory(total);
  else if (!all)
    fail("out of memory");
  broadcast_from(0, all, total);
  return all;
}

void ranks_fill(conic_executor *executor, conic_team *team) {
  *team = (conic_team){.index = own_index,
                       .count = n_ranks,
                       .send = send_bytes,
                       .receive = receive_bytes,
                       .release = release_bytes,
                       .collect = collect_bytes};
  *executor = (conic_executor){.index = own_index,
                               .count = n_ranks,
                               .cut_for = n_ranks,
                               .team = n_ranks > 1 ? team : NULL,
                               .share = share_units,
                               .next = next_unit,
                               .allow = allow_units,
                               .hand = hand_to_first,
                               .worst = worst_of_ranks,
                               .broadcast = broadcast,
                               .count_traffic = tell_traffic};
}
