#!/usr/bin/env bash
# Runs the commands of docs/json.md: each must give the keys of the sample below it, no more and no fewer; and among
# them are those that scripts rely on.
set -euo pipefail

source_folder=$1
program=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

conic() {
  "$program" "$@"
}

# The paths of all keys of a JSON text on standard input that is laid out as conic does: `ms.read` …
keys() {
  perl -ne '
    next unless /^( *)"([^"]+)": (.*)/;
    my $depth = length($1) / 2 - 1;
    @path = (@path[0 .. $depth - 1], $2);
    print join(".", @path), "\n";' | sort
}

# Splits the page: N.sh is the command of a section, N.json its sample, N.name its heading.
perl -ne '
  if (/^## (.*)/) { $n++; open $to, ">", "$n.name"; print $to "$1\n"; close $to; }
  elsif (/^```(sh|json)/) { open $to, ">", "$n.$1"; $is_open = 1; }
  elsif (/^```/) { close $to; $is_open = 0; }
  elsif ($is_open) { print $to $_; }' "$source_folder/docs/json.md"

declare -A wanted=(
  [make]="points_in points_out seconds.read seconds.work seconds.write seconds.total points_per_s peak_rss_bytes
    skipped.nan skipped.zero skipped.duplicate skipped.isolated skipped.failed"
  [render]="splats_in splats_culled splats_skipped splats_drawn splats_fallback fragments pixels_covered overdraw method
    methods.conic device isa threads tile epsilon_mode epsilon near primitives.splats clouds_culled hash.rgba hash.Z
    ms.read ms.estimate ms.lod ms.setup ms.bin ms.visibility ms.accumulate ms.resolve ms.write ms.frame ms.total
    ms_first msplats_per_s drawn_msplats_per_s mfragments_per_s peak_rss_bytes"
  [diff]="identical max_abs rmse p999 psnr ssim flip over_code differing_pixels largest_hole planes.rgba.max_abs planes.rgba.rmse"
  [verify]="against method planes.rgba.max_abs planes.rgba.p999 planes.id.max_abs bound.rgba bound.Z compared_pixels
    unstable_pixels covered_pixels undecided_ids unstable_limit unstable_by_reason.cutoff unstable_by_reason.visibility
    ms.render ms.oracle pass"
  [chart]="scenes methods points seconds"
  [explain]="method pixel planes.rgba planes.weight planes.id threshold counts.visible counts.hidden contributions"
  [bench]="lines wrong_pictures peak_rss_bytes machine"
  [info]="kind points bytes bytes_per_point bounds.min bounds.max sound"
)
wanted[prepare]=${wanted[make]}
wanted[octree]="${wanted[make]} bytes_per_point inner_nodes levels"
wanted["mls project"]="${wanted[make]} type plane weight h degree outcomes.done outcomes.too_few moved.rms moved.max"
wanted["mls thin"]="${wanted[make]} error hausdorff to_thinned.max from_thinned.max"
wanted["mls densify"]=${wanted[make]}
wanted["info of an octree"]="kind points nodes inner_nodes levels bytes bytes_per_point bounds.min bounds.max sound"
wanted["render of a mesh"]="${wanted[render]/methods.conic /} primitives.triangles triangles_in triangles_culled triangles_skipped
  triangles_drawn triangle_fragments mtriangles_per_s"
wanted[layer]="${wanted[make]} clouds levels bytes bits_per_sample spacing quantum"
wanted["info of a layered cloud"]="kind points clouds levels bytes bytes_per_point bits_per_sample bits.position bits.normal bits.colour
  bits.index bounds.min bounds.max sound"
wanted["render of an octree"]="${wanted[render]} primitives.inner_nodes primitives.leaves error_px"
wanted["render of a layered cloud"]="${wanted[render]} error_px layers.clouds layers.places_coarser layers.clouds_missing"
wanted["render of patches"]="${wanted[render]} primitives.patches primitives.samples"

wanted[hybrid]="triangles surfels clusters seconds.read seconds.work seconds.write seconds.total peak_rss_bytes skipped.nan"
wanted["render of a hybrid"]="${wanted[render]} triangles_drawn primitives.triangles primitives.surfel_patches error_px"
wanted["explain of a hybrid"]="method pixel planes.rgba planes.cluster threshold contributions blended triangles"
wanted["info of a hybrid"]="kind triangles surfels nodes levels bytes bounds.min bounds.max sound"

if ! "$program" --version | grep -q '^In this build:.*OpenEXR'; then
  echo "skipped: the samples are of EXR files, which this build has not"
  exit 77
fi
for ((n = 1; ; n++)); do
  [[ -e $n.sh ]] || break
  name=$(cat $n.name)
  if grep -q 'lpc' $n.sh && ! "$program" --version | grep -q '^In this build:.*zstd'; then
    unset "wanted[$name]"
    continue
  fi
  # shellcheck disable=SC1090 # the command of the page
  source $n.sh > $n.out 2> err < /dev/null || [[ $? -eq 1 && $name == diff ]] || fail "$name: $(cat err)"
  keys < $n.json > $n.sample
  keys < $n.out > $n.keys
  [[ $(wc -l < $n.sample) -ge 5 ]] || fail "$name: no sample"
  diff $n.sample $n.keys || fail "$name: the page's keys (<) are not those of the run (>)"
  for key in ${wanted[$name]:-}; do
    grep -qxF "$key" $n.keys || fail "$name: no $key"
  done
  unset "wanted[$name]"
done
[[ ${#wanted[@]} -eq 0 ]] || fail "no sample of ${!wanted[*]}"
[[ $failures -eq 0 ]]
