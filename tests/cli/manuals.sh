#!/usr/bin/env bash
# Help, manual pages, completion and docs say the same: every option of every command stands in each of the first three,
# and every option that the docs and the examples name exists. The pages are clean, and a shell completes.
set -uo pipefail

source "$1/tests/support/program.bash"
python=$(command -v python3) || {
  echo "skipped: python3 is not installed"
  exit 77
}
mkdir -p help man1

run 0 help --format json
cp out table.json
commands=$("$python" -c 'import json; print(*[c["name"] for c in json.load(open("table.json"))["commands"]])')
[[ $(wc -w <<< "$commands") -gt 10 ]] || fail "there are only these commands: $commands"
for command in $commands; do
  run 0 help --all "$command"
  cp out "help/$command"
  run 0 help "$command" # of few options all are shown, and of many those that the command line wants
  [[ $(grep -c '^  -' "help/$command") -gt 40 ]] || cmp -s out "help/$command" || fail "help $command leaves options out"
  ! grep -q '^usage: .* -o ' out || grep -q '^  -o ' out || fail "help $command leaves -o out"
  run 0 help --format man "$command"
  cp out "man1/conic-$command.1"
done
run 0 help --format man
cp out man1/conic.1
for shell in bash zsh fish; do
  run 0 help --format=$shell
  cp out completion.$shell
done
run 2 help --format troff
run 2 help --format bash render
run 2 help --format man rendr
"$python" "$1/tests/cli/manuals.py" "$1" || fail "tables, pages and docs do not agree"

# The library's pages: one for every function that the headers declare, with its prototype.
if command -v perl > /dev/null; then
  "$1/scripts/library-manual" "$1/include/conic" . 1.2.3 || fail "the library's pages are not written"
  functions=$(perl -0777 -ne 's{/\*.*?\*/}{}gs; print "$1\n" while /\bCONIC_API\b[^;(]*?(\w+)\s*\(/g' "$1"/include/conic/*.h | grep -v '^__')
  [[ $(wc -w <<< "$functions") -gt 100 ]] || fail "the headers' functions are not found"
  for function in $functions; do
    read -r request page < "man3/$function.3" || fail "no page for $function"
    [[ $request == .so ]] || page=man3/$function.3
    grep -q "\b$function(" "$page" || fail "$page does not show $function"
  done
  grep -q '^CONIC_API' man3/*.3 && fail "a page has CONIC_API in it"
fi

# What mandoc warns of; it wants a date, which would make every build another one.
if command -v mandoc > /dev/null; then
  mandoc -T lint -W warning man1/*.1 $(grep -L '^\.so ' man3/*.3 /dev/null | grep man3) | grep -v 'missing date' > lint
  [[ ! -s lint ]] || fail "manual pages are not clean: $(head -c 2000 lint)"
else
  echo "not linted: mandoc is not installed"
fi
if command -v groff > /dev/null && groff -man -Tutf8 -ww -z /dev/null 2> /dev/null; then
  groff -man -Tutf8 -Kutf8 -ww -z man1/*.1 2> lint || true
  [[ ! -s lint ]] || fail "groff warns of manual pages: $(head -c 2000 lint)"
fi

# completes LINE WORDS …: bash, at the end of the line, offers all these words.
completes() {
  local offered
  read -ra COMP_WORDS <<< "$1"
  [[ $1 == *' ' ]] && COMP_WORDS+=('')
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  COMPREPLY=()
  _conic
  offered=" ${COMPREPLY[*]} "
  for word in "${@:2}"; do
    [[ $offered == *" $word "* ]] || fail "\"$1\" is not completed by $word, but by$offered"
  done
}
source completion.bash
complete -p conic > /dev/null || fail "bash knows of no completion"
touch scan.ply
mkdir folder
completes 'conic re' render
completes 'conic ' render make help --version
completes 'conic render --ele' --elevation
completes 'conic render sc' scan.ply
completes 'conic render scan.ply --profile gsplat-1.6' gsplat-1.6 gsplat-1.6-aa
completes 'conic render --exr = h' half
completes 'conic render --exr =' float half
completes 'conic render --camera sc' scan.ply
completes 'conic render --progressive ' folder
completes 'conic mls ' project thin densify scan.ply
completes 'conic make ' plane gaussians
completes 'conic bench --scenes nee' needles
completes 'conic help ver' verify
completes 'conic info -' --check -q
[[ ${COMPREPLY[*]} != *elevation* ]] || fail "options of other commands are offered"
completes 'conic render --fov '
[[ ${#COMPREPLY[@]} -eq 0 ]] || fail "a number is completed by ${COMPREPLY[*]}"
completes 'conic render --progressive sc'
[[ ${#COMPREPLY[@]} -eq 0 ]] || fail "a folder is completed by ${COMPREPLY[*]}"
if command -v zsh > /dev/null; then
  zsh -n completion.zsh || fail "zsh does not read its completion"
fi
if command -v fish > /dev/null; then
  fish --no-config -c 'source completion.fish; complete -C "conic render --exr "' > offered 2> err
  grep -q '^half' offered && [[ ! -s err ]] || fail "fish does not complete: $(cat offered err)"
  fish --no-config -c 'source completion.fish; complete -C "conic re"' | grep -q '^render' || fail "fish knows no commands"
fi

exit $((failures > 0))
