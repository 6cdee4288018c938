# What the tests of conic-mpi share: sourced after program.bash, it skips the test where there is no MPI. $launcher is
# that of the MPI which conic-mpi was built with.

conic_mpi=$3/bin/conic-mpi
launcher=("$(sed -n 's/^MPIEXEC_EXECUTABLE:[A-Z]*=//p' "$3/CMakeCache.txt")")
if grep -q '^MPI_C_LIB_NAMES:STRING=.*mpich' "$3/CMakeCache.txt"; then # where Open MPI's has the plain name
  launcher=("$(command -v mpiexec.mpich || echo "${launcher[0]}")")
fi
if [[ ! -x $conic_mpi ]] || ! command -v "${launcher[0]}" > /dev/null; then
  echo "skipped: there is no conic-mpi, or nothing to start it with"
  exit 77
fi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_plm=isolated OMPI_MCA_pml=ob1 OMPI_MCA_btl=self,vader # this machine alone, which it need not look for
export OMPI_MCA_btl_vader_single_copy_mechanism=none                  # which containers forbid
export LSAN_OPTIONS=detect_leaks=0                                    # MPI's own

# ranks N EXIT_CODE ARGUMENTS …: with what it prints in `err`, or in the file that $err names.
ranks() {
  local n=$1 wanted=$2 got to=${err:-err}
  "${launcher[@]}" -n "$n" "$conic_mpi" "${@:3}" > "$to.out" 2> "$to" < /dev/null
  got=$?
  [[ $got -eq $wanted ]] || fail "$n ranks: conic-mpi ${*:3}: exit code $got instead of $wanted: $(head -c 600 "$to")"
  [[ $got -eq $wanted ]]
}
# What more ranks would do, by a trace: so many estimates, in model.json. Without Python nothing models it.
simulator=$1/scripts/simulate
model() { # ESTIMATES, TRACE, OPTIONS …
  command -v python3 > /dev/null || return
  python3 "$simulator" "${@:2}" --json model.json > out 2> err || fail "$2 is not modelled: $(cat err)"
  [[ $(grep -c '"rank_hours"' model.json) -eq $1 ]] || fail "not $1 estimates by $2: $(cat model.json)"
}
hashes() { # JSON FILE: of all planes
  sed -n '/"hash": {/,/}/p' "$1"
}
same_hashes() { # JSON FILE, JSON FILE, WHAT
  [[ -n $(hashes "$1") && $(hashes "$1") == "$(hashes "$2")" ]] || fail "$3 has other bits"
}

# What goes wrong is told in one line, whoever it befell.
told_once() { # ERR, RANKS, EXIT_CODE, WORDS, ARGUMENTS …
  err=$1 ranks "$2" "$3" "${@:5}" || return 1
  [[ $(grep -c '^conic: ' "$1") -eq 1 ]] && grep -q -- "^conic: error: .*$4" "$1" && return
  fail "told is not once $4: $(cat "$1")"
  return 1
}
