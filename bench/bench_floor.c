/* The machine's rates, and what the stages of a frame would take if nothing but those held them up. */
#include "bench/bench.h"

void cli_bench_print_machine(const cli_bench_machine *machine) {
  printf("%d thread%s: reads %.1f, writes %.1f, copies %.1f, moves %.1f GB/s; %.1f G multiplications and additions, "
         "%.1f G divisions and roots, %.1f G gathered a second (%s)\n",
         machine->threads, machine->threads == 1 ? "" : "s", 1e-9 * machine->read_bytes_per_s,
         1e-9 * machine->write_bytes_per_s, 1e-9 * machine->copy_bytes_per_s, 1e-9 * machine->moved_bytes_per_s,
         1e-9 * machine->operations_per_s, 1e-9 * machine->divisions_per_s, 1e-9 * machine->gathered_per_s,
         conic_isa_name(conic_isa_best()));
}

void cli_bench_report_machine(cli_json *json, const cli_bench_machine *machines, int n_machines) {
  cli_json_array(json, "machine");
  for (int i = 0; i < n_machines; i++) {
    cli_json_object(json, NULL);
    cli_json_count(json, "threads", (uint64_t)machines[i].threads);
    cli_json_text(json, "isa", conic_isa_name(conic_isa_best()));
    cli_json_figures(
        json, NULL, {"read_bytes_per_s", machines[i].read_bytes_per_s},
        {"write_bytes_per_s", machines[i].write_bytes_per_s}, {"copy_bytes_per_s", machines[i].copy_bytes_per_s},
        {"moved_bytes_per_s", machines[i].moved_bytes_per_s}, {"operations_per_s", machines[i].operations_per_s},
        {"divisions_per_s", machines[i].divisions_per_s}, {"gathered_per_s", machines[i].gathered_per_s});
    cli_json_close(json);
  }
  cli_json_close(json);
}

/* How much of a frame's time its threads worked: others take the rest of it. */
static double share_of_work(const cli_bench_line *line) {
  double share = line->cpu_ms / ((double)line->threads * line->statistics.ms.frame);
  return share > 0.0 && share < 1.0 ? share : 1.0;
}

static double stage_ms(const cli_bench_line *line, int i) {
  return share_of_work(line) * cli_bench_stage_ms(&line->statistics.ms, i);
}

/* A stage's floor over what it takes. */
static double share_of_floor(const cli_bench_line *line, const cli_bench_machine *machine, int i) {
  double ms = stage_ms(line, i);
  return ms > 0.0 ? cli_bench_floor_ms(&line->work[i], machine) / ms : 0.0;
}

static double memory_ms(const cli_bench_work *work, const cli_bench_machine *machine) {
  return 1e3 * (work->read_bytes / machine->read_bytes_per_s + work->written_bytes / machine->write_bytes_per_s +
                work->moved_bytes / machine->moved_bytes_per_s);
}

static double compute_ms(const cli_bench_work *work, const cli_bench_machine *machine) {
  return 1e3 * ((work->operations - work->divisions) / machine->operations_per_s +
                work->divisions / machine->divisions_per_s + work->gathered / machine->gathered_per_s);
}

double cli_bench_floor_ms(const cli_bench_work *work, const cli_bench_machine *machine) {
  double memory = memory_ms(work, machine), compute = compute_ms(work, machine);
  return memory > compute ? memory : compute;
}

void cli_bench_print_floor(const cli_bench_line *line, const cli_bench_machine *machine) {
  double floor_ms = 0.0;
  printf("\n%s, %d x %d\n\n", line->name, line->width, line->height);
  puts("| stage | reads, MB | writes, MB | moves, MB | M operations | M divisions | M gathered | memory, ms | vectors, "
       "ms "
       "| floor, ms | measured, ms | share |");
  puts("|---|---|---|---|---|---|---|---|---|---|---|---|");
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++) {
    const cli_bench_work *work = &line->work[i];
    double least = cli_bench_floor_ms(work, machine), ms = stage_ms(line, i);
    floor_ms += least;
    if (least == 0.0 && ms == 0.0) /* a stage that these do not have */
      continue;
    printf("| %s | %.1f | %.1f | %.1f | %.0f | %.1f | %.1f | %.2f | %.2f | %.2f | %.2f | %.0f %% |\n",
           cli_bench_stages[i], 1e-6 * work->read_bytes, 1e-6 * work->written_bytes, 1e-6 * work->moved_bytes,
           1e-6 * work->operations, 1e-6 * work->divisions, 1e-6 * work->gathered, memory_ms(work, machine),
           compute_ms(work, machine), least, ms, 100.0 * share_of_floor(line, machine, i));
  }
  printf("| frame | | | | | | | | | %.2f | %.2f | %.0f %% |\n", floor_ms,
         share_of_work(line) * line->statistics.ms.frame,
         100.0 * floor_ms / (share_of_work(line) * line->statistics.ms.frame));
}

void cli_bench_report_shares(cli_json *json, const cli_bench_line *line, const cli_bench_machine *machine) {
  double floor_ms = 0.0;
  cli_json_object(json, line->name);
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++) {
    floor_ms += cli_bench_floor_ms(&line->work[i], machine);
    cli_json_number(json, cli_bench_stages[i], share_of_floor(line, machine, i));
  }
  cli_json_number(json, "frame", floor_ms / (share_of_work(line) * line->statistics.ms.frame));
  cli_json_close(json);
}

void cli_bench_report_floor(cli_json *json, const cli_bench_line *line, const cli_bench_machine *machine) {
  double floor_ms = 0.0;
  cli_json_object(json, line->name);
  for (int i = 0; i < CLI_BENCH_N_STAGES; i++) {
    double least = cli_bench_floor_ms(&line->work[i], machine);
    floor_ms += least;
    cli_json_number(json, cli_bench_stages[i], least);
  }
  cli_json_number(json, "frame", floor_ms);
  cli_json_close(json);
}
