#!/usr/bin/env bash
# conic judge on the pictures of a plain renderer of Gaussians that shares nothing with conic: without a mistake they
# are right in every profile, and each planted mistake is wrong and named first. Of two at once, both shall be named.
#
# As a campaign, CONIC_JUDGE_SEEDS='1 2 3' bash tests/judge/plain_renderer.sh . "$PWD/build/bin/conic" "$PWD/build"
# takes these scenes, in all profiles, with all mistakes, and counts. It takes minutes a scene.
set -uo pipefail

source "$1/tests/support/program.bash"
plain=$3/tests/plain_renderer
seeds=${CONIC_JUDGE_SEEDS-}
faults=(dilation-0 dilation-0.1 extent-3-sigma alpha-max-0.999 alpha-max-0.99 falloff-renormalised order-distance
  order-file sh-degree-0 f-rest-interleaved quaternion-xyzw quaternion-not-normalised scale-linear opacity-linear
  half-pixel mirrored-x mirrored-y centre-ignored srgb-decoded srgb-encoded premultiplied background-white near)
codes_of_faults=${seeds:+0 }1 # a mistake need not show in every scene
declare -A n_planted n_named
n_pairs=0 n_pairs_named=0

# What the profile does anyhow is no mistake there.
is_no_mistake() { # PROFILE FAULT
  case $1:$2 in
    khr-2026:dilation-0 | khr-2026:order-distance | khr-2026:extent-3-sigma | 2dgs-*:dilation-* | exact:dilation-*) ;;
    inria-2023:extent-3-sigma | 2dgs-2024:extent-3-sigma | inria-2023:centre-ignored | 2dgs-2024:centre-ignored) ;;
    gsplat-1.5*:alpha-max-0.999 | gsplat-1.6*:alpha-max-0.99 | inria-2023:alpha-max-0.99) ;;
    2dgs-*:alpha-max-0.99 | exact:alpha-max-0.99) ;;
    *) return 1 ;;
  esac
}

# Of some two, one leaves nothing of the other.
can_be_together() { # FAULT FAULT
  case $1+$2 in
    *dilation*+*dilation* | alpha*+alpha* | order*+order* | srgb*+srgb* | sh-*+f-rest-* | f-rest-*+sh-*) return 1 ;;
  esac
  [[ $1 != "$2" ]]
}

# Draws with these faults and judges; leaves the exit code in `code`, and the names in `named`, the best first:
# draw EXIT_CODES PROFILE OTHERWISE FAULT …
draw() {
  local profile=$2 planted=(--otherwise "$3") fault
  for fault in "${@:4}"; do
    planted+=(--fault "$fault")
  done
  "$plain" scene.ply camera.json --profile "$profile" "${planted[@]}" -o drawn.npy || fail "${planted[*]}: no picture"
  [[ $profile == inria-2023 || $profile == 2dgs-2024 ]] && profile+=:ignore-center
  "$conic" judge scene.ply --camera camera.json --profile "$profile" --picture drawn.npy --json - \
    > out 2> err < /dev/null
  code=$?
  [[ " $1 " == *" $code "* ]] || fail "$profile ${planted[*]}: exit code $code instead of $1: $(head -c 300 err)"
  named=$(python3 -c 'import json; print(*[d["name"] for d in json.load(open("out"))["diagnosis"]])' 2> /dev/null)
}

# Right without a mistake; else the fault is the first that is named.
plant_one() { # PROFILE OTHERWISE FAULT
  is_no_mistake "$1" "$3" && return
  draw "$codes_of_faults" "$1" "$2" "$3"
  [[ $code -ne 0 ]] || return
  n_planted[$3]=$((${n_planted[$3]-0} + 1))
  if [[ ${named%% *} == "$3" ]]; then
    n_named[$3]=$((${n_named[$3]-0} + 1))
  else
    fail "$1, otherwise $2, $3: named ${named:-nothing}"
  fi
}

plant_two() { # PROFILE FAULT FAULT
  local first second
  is_no_mistake "$1" "$2" || is_no_mistake "$1" "$3" && return
  draw "$codes_of_faults" "$1" 0 "$2" "$3"
  [[ $code -ne 0 ]] || return
  read -r first second _ <<< "$named"
  ((n_pairs++))
  if [[ " $2 $3 " == *" $first "* && " $2 $3 " == *" $second "* && $first != "$second" ]]; then
    ((n_pairs_named++))
  else
    echo "$1, $2 and $3: named $named"
  fi
}

go_through() { # SEED PROFILE …
  local profile fault
  "$plain" --make scene.ply camera.json "$1" || fail "no scene"
  for profile in "${@:2}"; do
    draw 0 "$profile" 0
    for fault in "${faults[@]}"; do
      plant_one "$profile" $((RANDOM % 2)) "$fault"
    done
  done
}

RANDOM=$((${seeds%% *} + 1))
if ! python3 -c '' 2> /dev/null; then
  echo "skipped: there is no python3"
  exit 77
fi
all_profiles=(inria-2023 gsplat-1.5 gsplat-1.5-aa gsplat-1.6 gsplat-1.6-aa khr-2026 2dgs-2024 2dgs-gsplat exact)
if [[ -z $seeds ]]; then # test_diagnosis plants all of them
  "$plain" --make scene.ply camera.json 1
  for profile in "${all_profiles[@]}"; do
    draw 0 "$profile" 0
  done
  faults=(dilation-0.1 order-file f-rest-interleaved quaternion-xyzw opacity-linear half-pixel mirrored-y premultiplied)
  go_through 1 gsplat-1.6
  plant_one exact 0 quaternion-not-normalised # along rays there are two ways to do that
  plant_two gsplat-1.6 dilation-0 mirrored-y
  plant_two gsplat-1.6 dilation-0 order-distance # nearly khr-2026
fi
for seed in $seeds; do
  go_through "$seed" "${all_profiles[@]}"
  for ((i = 0; i < 20; i++)); do
    a=$((RANDOM % ${#faults[@]})) b=$((RANDOM % ${#faults[@]}))
    profile=${all_profiles[RANDOM % 9]}
    can_be_together "${faults[a]}" "${faults[b]}" && plant_two "$profile" "${faults[a]}" "${faults[b]}"
  done
done
for fault in "${faults[@]}"; do
  echo "$fault: named first ${n_named[$fault]-0} of ${n_planted[$fault]-0} times"
done
echo "pairs: both named $n_pairs_named of $n_pairs times"
[[ $failures -eq 0 ]]
