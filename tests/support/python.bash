# Where the tests of Python find one with NumPy, and conic's package with the build's library: sourced with the script's
# own arguments. $python is the interpreter; without one the test is skipped.

export PYTHONPATH=$1/python CONIC_LIBRARY=$3/lib/libconic-hosted.so PYTHONDONTWRITEBYTECODE=1 CONIC_PROGRAM=$2
library=$(find "$3" -maxdepth 3 -name libconic-hosted.so 2> /dev/null | head -n 1)
if [[ ! $library ]]; then
  echo "skipped: libconic-hosted.so is not built"
  exit 77
fi
export CONIC_LIBRARY=$library

python=
for candidate in "${CONIC_PYTHON:-}" /usr/bin/python3 python3; do
  if [[ $candidate ]] && "$candidate" -c 'import sys, numpy; assert sys.version_info >= (3, 9)' 2> /dev/null; then
    python=$candidate
    break
  fi
done
if [[ ! $python ]]; then
  echo "skipped: no Python of 3.9 or later that has NumPy (python3-numpy)"
  exit 77
fi

# A sanitizer wants to be there first; Python itself never gives back what it had, and what is freed shall not be kept.
sanitizer=$(ldd "$library" | sed -n 's/.*=> \(.*lib\(asan\|tsan\)\.so[^ ]*\).*/\1/p')
with_conic() {
  env ${sanitizer:+LD_PRELOAD="$sanitizer"} ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0:quarantine_size_mb=1 "$@"
}
