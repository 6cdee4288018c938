#!/usr/bin/env bash
# Small pictures on Oclgrind, a simulator of OpenCL devices that watches every access: no data race and nothing out of
# bounds, and the pictures those of the CPU. The log stays in BUILD/oclgrind.log.
set -euo pipefail

root=$1 build=$3 log=$3/oclgrind.log
command -v oclgrind > /dev/null || { echo "skipped: oclgrind is not installed"; exit 77; }
[[ -x $build/bin/test_opencl_images ]] || { echo "skipped: this build has no OpenCL"; exit 77; }
# Its optimiser makes intrinsics that it does not know itself, and its check for uninitialised reads misreports `freeze`.
answer=0
: > "$log"
for test in images triangles gaussians; do
  oclgrind --data-races --build-options -cl-opt-disable "$build/bin/test_opencl_$test" "$root" small >> "$log" 2>&1 || answer=$?
done
grep -v -E 'log: opencl:[0-9.]+: .* may be off by|warnings? generated|^wild: |^skipped: .* is not there$' "$log" > "$log.findings" || true
cat "$log.findings"
[[ $answer -eq 0 && ! -s $log.findings ]] && echo "oclgrind: clean"
