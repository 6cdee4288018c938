#!/usr/bin/env bash
# Layered clouds over ranks, and pictures that nobody holds: the same files as one process writes at once.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/ranks.bash"

# What is counted of the picture, whoever counts it
counts() { # JSON FILE
  grep -E '"(splats_[a-z]*|fragments|pixels_covered|clouds_drawn|places|error_px|conic|ray)"' "$1"
}
same() { # WHAT, JSON FILE, JSON FILE, EXR, EXR
  same_hashes "$2" "$3" "$1"
  cmp "$4" "$5" || fail "the file of $1 differs"
  [[ $(counts "$2") == "$(counts "$3")" ]] || fail "the counts of $1 differ: $(diff <(counts "$2") <(counts "$3"))"
}

"$conic" make knot -n 500 -o knot.ply

# A full disk is told once, and leaves nothing, while other things are tried.
mkdir full
full=(render knot.ply --plain --size 1100x1000 --threads 1 --compression none --memory 8 -o full/a.exr)
(ulimit -f 16000 && told_once err1 2 4 'full/a.exr: cannot write' "${full[@]}") & job=$! # MPI's own files are smaller

"$conic" make gyroid -n 20000 -o gyroid.ply
"$conic" layer gyroid.ply -o gyroid.lpc --cloud-size 500

# In windows: an error, a budget, culling, occlusion, several samples a pixel
cloud=(render gyroid.lpc --plain --size 200x130 --threads 1)
run_as_typed 0 "${cloud[@]}" --error 1 --aov rgba,Z,N,id,count -o alone.exr --json alone.json
ranks 3 0 "${cloud[@]}" --error 1 --aov rgba,Z,N,id,count -o together.exr --json together.json
same "a layered cloud on three ranks" alone.json together.json alone.exr together.exr
grep -q '"shares": "windows"' together.json || fail "a layered cloud is not drawn in windows"
run_as_typed 0 "${cloud[@]}" --budget 5000 --cull back --samples 2 --occlusion on -o alone.exr --json alone.json
ranks 2 0 "${cloud[@]}" --budget 5000 --cull back --samples 2 --occlusion on -o together.exr --json together.json
same "a budget on two ranks" alone.json together.json alone.exr together.exr

# What is seen all around, from which the camera follows, each rank draws from other sides.
seen=(render gyroid.lpc --size 200x130 --error 1 --threads 1)
run_as_typed 0 "${seen[@]}" -o alone.exr --json alone.json
ranks 4 0 "${seen[@]}" -o together.exr --json together.json
same "a camera that four ranks find" alone.json together.json alone.exr together.exr

# Strip by strip, where half of the memory would not hold the planes: alone, and over ranks that come out of turn
large=(render gyroid.lpc --plain --size 300x300 --error 2 --occlusion off --threads 1)
run_as_typed 0 "${large[@]}" -o whole.exr --json whole.json
run_as_typed 0 "${large[@]}" --memory 2 -o strips.exr --json strips.json
same "a picture in strips" whole.json strips.json whole.exr strips.exr
[[ $(grep '"bands"' whole.json) != "$(grep '"bands"' strips.json)" ]] || fail "the picture was not drawn in strips"
ranks 3 0 "${large[@]}" --memory 2 -o together.exr --json together.json
same "a picture in strips on three ranks" whole.json together.json whole.exr together.exr
bands=(render gyroid.lpc --plain --size 1200x70 --fov 8 --error 2 --samples 16 --occlusion off --threads 1)
run_as_typed 0 "${bands[@]}" -o whole.exr --json whole.json
ranks 2 0 "${bands[@]}" --memory 1 -o together.exr --json together.json
same "strips of several bands of samples" whole.json together.json whole.exr together.exr
odd=(render knot.ply --plain --size 1200x70 --samples 16 --fov 2 --compression piz --exr half --threads 1)
run_as_typed 0 "${odd[@]}" -o whole.exr --json whole.json
ranks 2 0 "${odd[@]}" --memory 1 -o together.exr --json together.json
same "strips that end between rows that are packed together" whole.json together.json whole.exr together.exr

# A disk that is full leaves what is finished, which any number of ranks go on with, of any number's strips.
mkdir kept
kept=(render knot.ply --plain --size 1100x1000 --threads 1 --compression none --memory 8)
kept+=(--resumable --resume kept/a.exr -o kept/a.exr)
run_as_typed 0 "${kept[@]}" --json whole.json && mv kept/a.exr whole.exr
(ulimit -f 16000 && told_once err2 3 4 'kept/a.exr.*: cannot write' "${kept[@]}" --json together.json; exit $failures) ||
  fail "strips on a full disk"
cp -r kept stopped
for n in 1 2; do
  rm -r kept && cp -r stopped kept
  ranks $n 0 "${kept[@]}" --json together.json
  grep -q 'rows were finished' err || fail "nothing was kept: $(cat err)"
  same "strips that $n ranks go on with" whole.json together.json whole.exr kept/a.exr
  [[ $(ls -A kept) == a.exr ]] || fail "beside a whole picture lies $(ls -A kept)"
done

# What is written at once and cannot be held is refused.
run_as_typed 4 render knot.ply --plain --size 65535x65535 --aov rgba,Z,N,albedo,P,count,id,weight -o full.exr
grep -q 'bytes, and the machine has' err || fail "told is not that the picture is too large: $(cat err)"
wait "$job" || failures=$((failures + 1))
[[ -z $(ls -A full) ]] || fail "a full disk leaves $(ls -A full)"
exit $((failures > 0))
