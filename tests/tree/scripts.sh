#!/usr/bin/env bash
# `--help` of every script says what it is for, and does nothing else. None is given a program that could do more.
set -uo pipefail

source_folder=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/programs" "$work/here"
for program in bash perl sed; do
  found=$(command -v "$program") && ln -s "$found" "$work/programs/$program"
done
found=$(python3 -c 'import sys; print(sys.executable)') && ln -s "$found" "$work/programs/python3" # which may be a script
cd "$work/here" || exit 1
failures=0

# check SCRIPT WORDS …
check() {
  local script=$1 interpreter
  shift
  interpreter=$(sed -n '1s/^#!\/usr\/bin\/env //p' "$script")
  [[ -e $work/programs/$interpreter ]] || return 0
  PATH=$work/programs PYTHONDONTWRITEBYTECODE=1 TMPDIR=$work/here "$interpreter" "$script" "$@" > ../out 2> ../err < /dev/null
  [[ $? -eq 0 && -s ../out && ! -s ../err && -z $(ls -A) ]]
}
for script in "$source_folder"/scripts/*; do
  [[ -f $script ]] || continue # a folder of parts
  check "$script" --help || {
    echo "FAILED: ${script##*/} --help: $(head -c 300 ../out ../err)"
    failures=$((failures + 1))
  }
done

# What is no help is seen.
printf '#!/usr/bin/env bash\n# Works.\n> file\n' > ../works
printf '#!/usr/bin/env bash\n# Fails.\ncmake --version\n' > ../fails
for script in works fails; do
  check "../$script" --help && { echo "FAILED: what $script is taken for help"; failures=$((failures + 1)); }
done
exit $((failures > 0))
