#!/usr/bin/env bash
# conic judge on the pictures of a renderer on OpenGL, as GPU viewers have them: right without a mistake, and each planted
# mistake is wrong and named first.
set -uo pipefail

source "$1/tests/support/program.bash"
gl=$3/tests/gl_renderer
export LP_NUM_THREADS=2 MESA_SHADER_CACHE_DISABLE=true
faults=(dilation-0 dilation-0.1 extent-3-sigma alpha-max-0.99 falloff-renormalised order-distance order-file sh-degree-0
  f-rest-interleaved quaternion-xyzw quaternion-not-normalised scale-linear opacity-linear half-pixel mirrored-x
  mirrored-y centre-ignored srgb-decoded srgb-encoded premultiplied background-white near)
if [[ ! -x $gl ]]; then
  echo "skipped: no EGL and OpenGL when this was built (Debian: libegl-dev)"
  exit 77
fi
if [[ $sanitized ]]; then
  faults=(half-pixel mirrored-y)
fi

# Draws OUT, and OUT.FAULT for each fault.
shaders=$1/tests/judge
draw() { # PROFILE OUT FAULT …
  local planted=() fault
  for fault in "${@:3}"; do
    planted+=(--fault "$fault")
  done
  "$gl" "$shaders" scene.ply camera.json --profile "$1" -o "$2" "${planted[@]}" > out 2> err
}

judge() { # EXIT_CODE PROFILE PICTURE
  local profile=$2
  [[ $profile == inria-2023 || $profile == 2dgs-2024 ]] && profile+=:ignore-center
  run "$1" judge scene.ply --camera camera.json --profile "$profile" --picture "$3" --json -
}

# The most likely fault.
first_named() {
  tr -d ' \n' < out | sed -n 's/.*"diagnosis":\[{"name":"\([^"]*\)".*/\1/p'
}

"$3/tests/plain_renderer" --make scene.ply camera.json 3 || fail "no scene"
sed -i 's/"width": [0-9]*, "height": [0-9]*/"width": 60, "height": 50/; s/"cx": [0-9.]*, "cy": [0-9.]*/"cx": 27.75, "cy": 27.5/' \
  camera.json # the part of it that has what all faults need
draw gsplat-1.5 drawn.npy "${faults[@]}"
case $? in
  0) ;;
  77) cat out && exit 77 ;;
  *) fail "no pictures: $(cat err)" ;;
esac
judge 0 gsplat-1.5 drawn.npy
grep -q '"verdict": "right"' out || fail "not right: $(cat out)"
for fault in "${faults[@]}"; do
  judge 1 gsplat-1.5 "drawn.$fault.npy"
  [[ $(first_named) == "$fault" ]] || fail "$fault: named $(first_named)"
done

# Other profiles, one of them blended; planes beside a PFM are judged, too.
for profile in inria-2023 khr-2026; do
  draw "$profile" drawn.pfm mirrored-y
  judge 0 "$profile" drawn.pfm
  judge 1 "$profile" drawn.mirrored-y.pfm
  [[ $(first_named) == mirrored-y ]] || fail "$profile: named $(first_named)"
done
[[ -s drawn.T.pfm && -s drawn.Z.pfm ]] || fail "no planes beside the PFM"

[[ $failures -eq 0 ]]
