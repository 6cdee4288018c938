#include "cli/points/points_share.h"

#include "cli/points/points_input.h"
#include "core/files/disk.h"

/* A cut nearer to an end of an input than this part of a share is moved to that end. */
static const double sliver = 1.0 / 32.0;

/* --- the list --- */

static conic_status count_names(cli_points_share *share, size_t n_bytes) {
  share->n_inputs = 0;
  for (size_t i = 0; i < n_bytes; i++)
    share->n_inputs += share->names[i] == '\0';
  share->inputs = conic_memory_allocate(share->session->context, (size_t)share->n_inputs + 1, sizeof *share->inputs);
  if (!share->inputs)
    return CONIC_ERROR_MEMORY;
  const char *name = share->names;
  for (int i = 0; i < share->n_inputs; i++, name += strlen(name) + 1)
    share->inputs[i] = name;
  return CONIC_OK;
}

static conic_status list_own(cli_points_share *share, const char *const *inputs, int n_inputs, size_t *n_bytes) {
  conic_context *context = share->session->context;
  size_t room = 0;
  conic_status status = CONIC_OK;
  for (int i = 0; i < n_inputs && status == CONIC_OK; i++)
    if (share->team && strcmp(inputs[i], "-") == 0)
      status = conic_fail(context, CONIC_ERROR_INPUT, "several processes cannot share standard input; give files");
    else
      status = cli_points_folder_list(context, inputs[i], NULL, &share->names, n_bytes, &room);
  return status;
}

/* The first process's list counts for all, whatever other processes see in a folder. */
static conic_status send_names(cli_points_share *share, size_t n_bytes) {
  uint64_t facts[2] = {n_bytes, (uint64_t)share->are_surveys};
  const conic_executor *team = share->session->team;
  conic_status status = CONIC_OK;
  team->broadcast(team->data, facts, sizeof facts);
  share->are_surveys = (int)facts[1];
  if (team->index > 0) {
    share->names = conic_memory_allocate(share->session->context, (size_t)facts[0], 1);
    status = share->names ? CONIC_OK : CONIC_ERROR_MEMORY;
  }
  status = conic_team_agree(share->team, status);
  if (status == CONIC_OK)
    team->broadcast(team->data, share->names, (size_t)facts[0]);
  return status == CONIC_OK && team->index > 0 ? count_names(share, (size_t)facts[0]) : status;
}

conic_status cli_points_share_list(cli_session *session, const char *const *inputs, int n_inputs, int n_uncut,
                                   cli_points_share *share) {
  *share = (cli_points_share){.session = session, .n_uncut = n_uncut};
  share->team = cli_team_of(session);
  conic_status status = CONIC_OK;
  size_t n_bytes = 0;
  if (cli_session_speaks(session)) {
    status = list_own(share, inputs, n_inputs, &n_bytes);
    if (status == CONIC_OK)
      status = count_names(share, n_bytes);
    share->are_surveys =
        status == CONIC_OK && cli_points_are_surveys(share->inputs + n_uncut, share->n_inputs - n_uncut);
  }
  status = conic_team_agree(share->team, status);
  if (status == CONIC_OK && share->team)
    status = conic_team_agree(share->team, send_names(share, n_bytes));
  return status;
}

void cli_points_share_end(cli_points_share *share) {
  if (!share->session)
    return;
  conic_context *context = share->session->context;
  conic_memory_release_these(context, share->names, share->inputs, share->cuts, share->pieces);
}

/* --- the cuts, by the first process --- */

static double bytes_of_input(const char *path) {
  conic_disk_entry found;
  return conic_disk_look(path, &found) && found.is_file ? (double)found.n_bytes + 1.0 : 1.0;
}

/* A cut after that fraction of an input; it moves to an end that is near, or if the input cannot be read in parts. */
static conic_status find_cut(const cli_points_share *share, const conic_read_options *options, int can_part,
                             uint64_t most_whole, double fraction, cli_points_cut *cut) {
  conic_status status = CONIC_OK;
  if (can_part && cut->shape.n_points == 0)
    status = conic_model_look(share->session->context, share->inputs[cut->input], options, &cut->shape);
  const conic_model_shape *shape = &cut->shape;
  can_part = can_part && shape->can_part && !(shape->is_raw && shape->n_points <= most_whole);
  uint64_t n_steps = shape->n_points / CONIC_PART_STEP;
  cut->point = can_part ? (uint64_t)(fraction * (double)n_steps + 0.5) * CONIC_PART_STEP : 0;
  if (can_part && cut->input == 0 && cut->point == 0) /* the first process gets at least something */
    cut->point = CONIC_PART_STEP;
  if ((can_part && cut->point >= shape->n_points) || (!can_part && (fraction >= 0.5 || cut->input == 0)))
    *cut = (cli_points_cut){.input = cut->input + 1};
  return status;
}

static conic_status find_cuts(cli_points_share *share, const conic_read_options *options, uint64_t most_whole) {
  double all = 0.0, before = 0.0, own;
  int n_shares = share->team->count;
  conic_status status = CONIC_OK;
  for (int i = 0; i < share->n_inputs; i++)
    all += bytes_of_input(share->inputs[i]);
  cli_points_cut cut = {.input = 0};
  for (int k = 1; k < n_shares && status == CONIC_OK; k++) {
    double at = all * (double)k / (double)n_shares;
    int i = cut.input;
    for (; i < share->n_inputs && before + (own = bytes_of_input(share->inputs[i])) <= at; i++)
      before += own;
    if (i > cut.input)
      cut = (cli_points_cut){.input = i};
    if (i == share->n_inputs)
      break;
    own = bytes_of_input(share->inputs[i]);
    double past = at - before, near = sliver * all / (double)n_shares;
    share->cuts[k] = cut;
    int can_part =
        i >= share->n_uncut && past > near && own - past > near && !cli_points_are_hierarchy(share->inputs[i]);
    status = find_cut(share, options, can_part, most_whole, past / own, &share->cuts[k]);
    cut.shape = share->cuts[k].input == i ? share->cuts[k].shape : cut.shape;
  }
  return status;
}

/* --- pieces --- */

static conic_status list_share_pieces(cli_points_share *share) {
  int index = share->team ? share->team->index : 0;
  const cli_points_cut *from = &share->cuts[index], *to = from + 1;
  share->n = 0;
  conic_memory_release(share->session->context, share->pieces);
  size_t most = (size_t)(to->input - from->input) + 1;
  share->pieces = conic_memory_allocate_zeroed(share->session->context, most, sizeof *share->pieces);
  if (!share->pieces)
    return CONIC_ERROR_MEMORY;
  for (int i = from->input; i < to->input + (to->point > 0); i++) {
    cli_points_piece *piece = &share->pieces[share->n];
    piece->input = i;
    piece->range = (conic_points_range){i == from->input ? from->point : 0, i == to->input ? to->point : UINT64_MAX};
    piece->is_whole = piece->range.first == 0 && piece->range.end == UINT64_MAX;
    share->n += piece->range.first < piece->range.end;
  }
  return CONIC_OK;
}

/* The facts of this process's first and last piece; only these can be parts of an input. */
typedef struct part_facts {
  int input[2];
  conic_model_survey survey[2];
} part_facts;

static const conic_model_shape *shape_of_piece(const cli_points_share *share, const cli_points_piece *piece) {
  const cli_points_cut *from = &share->cuts[share->team->index];
  return piece->range.first > 0 ? &from->shape : &from[1].shape;
}

static int is_surveyed(const conic_model_shape *shape, const conic_read_options *options) {
  return shape->needs_survey || (shape->is_raw && options->where);
}

static conic_status survey_parts(const cli_points_share *share, const conic_read_options *options, part_facts *facts) {
  conic_status status = CONIC_OK;
  *facts = (part_facts){.input = {-1, -1}};
  for (size_t i = 0; i < share->n && status == CONIC_OK; i++) {
    const cli_points_piece *piece = &share->pieces[i];
    int k = i > 0;
    if (piece->is_whole)
      continue;
    facts->input[k] = piece->input;
    if (is_surveyed(shape_of_piece(share, piece), options))
      status = conic_model_survey_part(share->session->context, share->inputs[piece->input], options, &piece->range,
                                       &facts->survey[k]);
  }
  return status;
}

static void add_facts_of(cli_points_piece *piece, const part_facts *all, int count) {
  for (int i = 0; i < 2 * count; i++)
    if (all[i / 2].input[i % 2] == piece->input)
      conic_model_survey_add(&piece->survey, &all[i / 2].survey[i % 2]);
}

/* Undoes the cuts of an input with few wanted points: the process before its first cut takes it whole. */
static int mend_cuts(cli_points_share *share, const conic_read_options *options, const part_facts *all,
                     uint64_t most_whole) {
  int is_mended = 0;
  for (int k = 1; k < share->team->count; k++) {
    cli_points_cut *cut = &share->cuts[k];
    cli_points_piece piece = {.input = cut->input};
    add_facts_of(&piece, all, share->team->count);
    if (cut->point == 0 || !cut->shape.is_raw || !is_surveyed(&cut->shape, options) ||
        piece.survey.n_wanted > most_whole)
      continue;
    *cut = (cli_points_cut){.input = cut->input + 1};
    is_mended = 1;
  }
  return is_mended;
}

static conic_status settle_parts(cli_points_share *share, const conic_read_options *options, uint64_t most_whole) {
  conic_context *context = share->session->context;
  part_facts own, *all = conic_memory_allocate(context, (size_t)share->team->count, sizeof *all);
  conic_status status = survey_parts(share, options, &own);
  status = conic_team_agree(share->team, status == CONIC_OK && !all ? CONIC_ERROR_MEMORY : status);
  if (status == CONIC_OK) {
    conic_team_collect(share->team, &own, sizeof own, all);
    if (mend_cuts(share, options, all, most_whole))
      status = list_share_pieces(share);
    for (size_t i = 0; i < share->n && status == CONIC_OK; i++)
      if (!share->pieces[i].is_whole)
        add_facts_of(&share->pieces[i], all, share->team->count);
  }
  conic_memory_release(context, all);
  return conic_team_agree(share->team, status);
}

conic_status cli_points_share_out(cli_points_share *share, const conic_read_options *options, uint64_t most_whole) {
  size_t n_shares = share->team ? (size_t)share->team->count : 1;
  share->cuts = conic_memory_allocate_zeroed(share->session->context, n_shares + 1, sizeof *share->cuts);
  conic_status status = share->cuts ? CONIC_OK : CONIC_ERROR_MEMORY;
  for (size_t k = 1; k <= n_shares && status == CONIC_OK; k++)
    share->cuts[k] = (cli_points_cut){.input = share->n_inputs};
  if (!share->team)
    return status == CONIC_OK ? list_share_pieces(share) : status;
  if (status == CONIC_OK && share->team->index == 0)
    status = find_cuts(share, options, most_whole);
  status = conic_team_agree(share->team, status);
  if (status != CONIC_OK)
    return status;
  const conic_executor *team = share->session->team;
  team->broadcast(team->data, share->cuts, (n_shares + 1) * sizeof *share->cuts);
  status = conic_team_agree(share->team, list_share_pieces(share));
  return status == CONIC_OK ? settle_parts(share, options, most_whole) : status;
}

conic_status cli_points_share_stream(const cli_points_share *share, const cli_points_piece *piece,
                                     const conic_read_options *options, conic_batch_receiver *receive, void *cookie) {
  const char *path = share->inputs[piece->input];
  return piece->is_whole ? cli_points_stream(share->session, path, options, receive, cookie)
                         : conic_model_stream_part(share->session->context, path, options, &piece->range,
                                                   &piece->survey, receive, cookie);
}
