# What the commands of the reference images begin with: $conic is the program, $here the folder of this file, $data that
# of the shared models; the picture goes to out.png and the statistics to out.json, in the current folder.
export LC_ALL=C

# sheet CENTER ALONG ACROSS N OUTLINE SQUARES COLORS: see sheet.awk
sheet() {
  awk -f "$here/sheet.awk" -v center="$1" -v along="$2" -v across="$3" -v n="$4" -v outline="$5" -v squares="$6" \
    -v colors="$7"
}

# camera WIDTH HEIGHT FOCAL [CX CY]: at the origin, looking along z with y down
camera() {
  local cx=${4:-} cy=${5:-}
  [[ -n $cx ]] || cx=$(awk "BEGIN { print $1 / 2 }")
  [[ -n $cy ]] || cy=$(awk "BEGIN { print $2 / 2 }")
  cat << END
{"width": $1, "height": $2, "fx": $3, "fy": $3, "cx": $cx, "cy": $cy,
 "world_to_camera": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}
END
}

# needs FILE: ends with the code for "skipped" where a shared model is not there
needs() {
  [[ -e $data/$1 ]] || {
    echo "skipped: $data/$1 is not there"
    exit 77
  }
}

draw() { # FILES and options of conic render
  "$conic" render --plain "$@" --quiet -o out.png --json out.json
}
