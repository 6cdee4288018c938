#!/usr/bin/env bash
# Every fault of tests/mutants.list has its place in the source, so that scripts/mutants can try it. When a line changes
# that the list names, the list changes with it.
exec bash "$1/scripts/mutants" --check
