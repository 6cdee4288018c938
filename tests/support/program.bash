# What the tests of the program share: sourced with the script's own arguments, it moves to an empty folder that goes away
# with the script. $conic is the program, $failures what `fail` has counted; $sanitized says what sanitizers the build
# has, under which all takes ten times as long.

conic=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
sanitized=$(sed -n 's/^CONIC_SANITIZE:[A-Z]*=//p' "$3/CMakeCache.txt")

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# Runs conic; its output is then in `out` and `err`. Commands that draw do so --plain: what looks best may change, and
# is tested by default_picture.sh. run EXIT_CODE ARGUMENTS …
run() {
  case "${2-} ${3-}" in
    'judge --suite') run_as_typed "$@" ;;
    'render '* | 'explain '* | 'verify '* | 'judge '* | 'gradient '* | 'project '*)
      run_as_typed "$1" "$2" --plain "${@:3}" ;;
    *) run_as_typed "$@" ;;
  esac
}

# The same without a word more.
run_as_typed() {
  local wanted=$1 got
  shift
  "$conic" "$@" > out 2> err < /dev/null
  got=$?
  [[ $got -eq $wanted ]] || fail "conic $*: exit code $got instead of $wanted: $(head -c 300 out err)"
}
