#!/usr/bin/env bash
# The subjects of the last 20 commits fit into 72 characters, as lists of commits show them.
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
