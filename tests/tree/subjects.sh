#!/usr/bin/env bash
# The subjects of the last 20 commits fit into 72 characters, as lists of commits show them, and no commit adds what is
# no text, but for pictures of docs/ and refimages/: packages, programs and the like come in by mistake.
set -euo pipefail

oldest=$(git -C "$1" log --max-count=1 --format=%H --grep='^Move files into rooms$' 2> /dev/null || true)
if [[ -z $oldest ]]; then # the rule is no older
  echo "skipped: no history here"
  exit 77
fi
long=$(git -C "$1" log --max-count=20 --format=%s "$oldest"..HEAD | LC_ALL=C.UTF-8 grep -E '^.{73,}$' || true)
if [[ -n $long ]]; then
  echo "more than 72 characters:"
  echo "$long"
  exit 1
fi

# What `git log --numstat` counts no lines of, but for pictures where they belong.
strangers() {
  grep -P '^-\t-\t' | grep -vP '^-\t-\t(docs|refimages)/.*\.(png|jpg)$'
}
strange=$(git -C "$1" log --max-count=20 --diff-filter=A --format= --numstat "$oldest"..HEAD | strangers || true)
if [[ -n $strange ]]; then
  echo "no text, and no picture of docs/ or refimages/:"
  echo "$strange"
  exit 1
fi
for line in $'-\t-\ta.deb' $'-\t-\tdocs/a.deb' $'-\t-\tcore/a.png'; do # the rule sees what breaks it
  strangers <<< "$line" > /dev/null || { echo "the rule does not see $line"; exit 1; }
done
