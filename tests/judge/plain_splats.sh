#!/usr/bin/env bash
# conic judge on the pictures of a plain renderer of surface splats that shares nothing with conic: without a mistake
# they are right, by conic and by affine, also where its floats are chosen by chance, and each planted mistake is wrong
# and named first. CONIC_JUDGE_SEEDS='1 2 3' takes so many scenes more.
set -uo pipefail

source "$1/tests/support/program.bash"
plain=$3/tests/plain_splats
faults=(affine no-amplitude epsilon-in-z radius-as-sigma no-normalisation back-faces half-pixel mirrored-x mirrored-y
  centre-ignored srgb-decoded srgb-encoded background-white)
n_planted=0 n_named=0

# Draws with what else is said and judges. draw EXIT_CODE METHOD OPTION …
draw() {
  local wanted=$1 method=$2
  "$plain" scene.ply camera.json --method "$method" "${@:3}" -o drawn.npy || fail "$*: no picture"
  run "$wanted" judge scene.ply --camera camera.json --method "$method" --shade none --samples 1 --plain \
    --picture drawn.npy --json -
}

plant() { # FAULT
  draw 1 conic --fault "$1"
  named=$(python3 -c 'import json; print(*[d["name"] for d in json.load(open("out"))["diagnosis"]])' 2> /dev/null)
  ((n_planted++))
  if [[ ${named%% *} == "$1" ]]; then
    ((n_named++))
  else
    fail "$1: named ${named:-nothing}"
  fi
}

make_scene() { # SEED SCENE SPLATS
  run 0 make "$2" -n "$3" --seed "$1" --jitter 0.3 -o scene.ply
  cat > camera.json << END
{"width": 80, "height": 72, "fx": 70.5, "fy": 71.25, "cx": 38.25, "cy": 37.5, "world_to_camera":
 [[0.94385835636601738, 0, -0.33035042472810605, 0.02], [0.090002640422315071, -0.9621710845147493, 0.25715040120661453,
 -0.01], [-0.3178536264305498, -0.2724459655118999, -0.9081532183729997, 3.25], [0, 0, 0, 1]]}
END
}

if ! python3 -c '' 2> /dev/null; then
  echo "skipped: there is no python3"
  exit 77
fi
make_scene 1 knot 2000
for method in conic affine; do
  draw 0 $method
  draw 0 $method --floats 3
done
for fault in "${faults[@]}"; do
  plant "$fault"
done
for seed in ${CONIC_JUDGE_SEEDS-}; do
  for scene in knot torus sphere; do
    make_scene "$seed" $scene $((500 + seed * 977 % 4000))
    draw 0 conic --floats "$seed"
    for fault in "${faults[@]}"; do
      plant "$fault"
    done
  done
done
echo "named first $n_named of $n_planted times"
[[ $failures -eq 0 ]]
