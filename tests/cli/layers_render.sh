#!/usr/bin/env bash
# conic render of .lpc and .chy files and URLs: what the command line promises, against nginx on the loopback.
set -uo pipefail
# shellcheck source=tests/support/program.bash
source "$1/tests/support/program.bash"

export no_proxy=127.0.0.1
nginx=$(command -v nginx || ls /usr/sbin/nginx 2> /dev/null || true)
if ! "$conic" --version | grep '^In this build:' | grep zstd | grep -q CURL; then
  echo "skipped: this build is without zstd or libcurl" >&2
  exit 77
fi

value() { # KEY FILE: the first value of a key in a JSON file
  sed -nE "s/^ *\"$1\": \"?([^\",]*)\"?,?$/\1/p" "$2" | head -n 1
}

hashes() { # FILE
  sed -n '/"hash"/,/}/p' "$1"
}

same_picture() { # JSON JSON WHAT
  [[ -n $(hashes "$1") && $(hashes "$1") == "$(hashes "$2")" ]] || fail "$3: another picture"
}

run 0 make knot -n 24k -o knot.ply
run 0 layer knot.ply -o knot.lpc --cloud-size 256
"$1/scripts/terrain-mesh" 50 50 > hill.obj
run 0 hybrid hill.obj -o hill.chy
picture="--size 200x150 --aov all"

# A file: the same picture whatever the memory, threads and occlusion.
run 0 render knot.lpc -o all.pfm $picture --json all.json
[[ $(value splats_in all.json) -gt 0 && $(value places_coarser all.json) == 0 ]] || fail "render of all"
for options in "--memory 1" "--threads 1" "--threads 7" "--occlusion on" "--occlusion off" "--memory 2 --occlusion on"; do
  run 0 render knot.lpc -o other.pfm $picture $options --json other.json
  same_picture all.json other.json "$options"
done
run 0 render knot.lpc -o one.pfm $picture --error 2 --json error.json
[[ $(value splats_in error.json) -lt $(value splats_in all.json) ]] || fail "--error draws no less"
[[ $(value near error.json) == "$(value near all.json)" ]] || fail "--error: another near"
run 0 render knot.lpc -o one.pfm $picture --budget 5000 --json budget.json
[[ $(value splats_in budget.json) -le 5000 && $(value splats_in budget.json) -ge 1500 ]] || fail "--budget"
run 0 render knot.lpc -o turn.pfm --size 64x64 --turntable 3 --repeat 2
[[ -s turn.0003.pfm ]] || fail "no turntable"

# What passes no filter is refused as of a file; what passes and is out of sight is an empty picture.
run 3 render knot.lpc -o never.pfm --size 8x8 --where 'x > 100'
grep -q '^conic: error: knot.lpc: cannot be drawn: no point passes --where$' err || fail "none passes: $(cat err)"
run 0 render knot.lpc -o one.pfm --size 8x8 --where 'x > 0' --eye 0,0,99 --azimuth 90
# Beside other inputs, and where every splat is to be known, it is read whole.
run 0 render knot.lpc knot.lpc -o both.pfm --size 64x64 --json both.json
[[ $(value splats_in both.json) == 48000 ]] || fail "two clouds"
run 0 explain knot.lpc --size 64x64 --pixel 32,32 --json explain.json
run 2 explain knot.lpc --size 64x64 --pixel 32,32 --error 2
run 2 verify knot.lpc --size 64x64 --budget 5000

# Picture after picture, the last being the whole one.
run 0 render knot.lpc --progressive steps $picture --error 1 --json steps.json
run 0 render knot.lpc -o whole.exr $picture --error 1 --json whole.json
same_picture steps.json whole.json "--progressive"
n=$(value pictures steps.json)
[[ $n -ge 3 && -s steps/0001.exr && -s steps/$(printf %04d "$n").exr ]] || fail "--progressive wrote $n pictures"
run 1 diff steps/0001.exr steps/0002.exr
run 0 diff steps/"$(printf %04d "$n")".exr whole.exr

# Wrong usage, wrong inputs.
run 2 render knot.ply -o x.pfm --progressive x
run 2 render knot.ply -o x.pfm --deadline 1
run 2 render knot.ply -o x.pfm --tolerate
run 2 render knot.lpc -o x.pfm --deep x.exr
run 2 render knot.lpc -o x.pfm --error 1 --budget 5000
run 0 render knot.lpc -o budget.pfm $picture --budget 1 --json budget.json
[[ $(value splats_in budget.json) -le 1 ]] || fail "--budget 1 draws more"
run 4 render knot.lpc --progressive /nowhere/x
head -c 30000 knot.lpc > cut.lpc
run 3 render cut.lpc -o x.pfm
run 4 render http://127.0.0.1:9/x.lpc -o x.pfm --timeout 1

# A byte that is wrong is no lateness.
cp knot.lpc flipped.lpc
last=$(tail -c 1 knot.lpc | od -An -tu1)
printf "\\x$(printf %02x $((last ^ 1)))" | dd of=flipped.lpc bs=1 seek=$(($(stat -c %s knot.lpc) - 1)) conv=notrunc 2> err
run 3 render flipped.lpc -o x.pfm --deadline 100
run 3 render flipped.lpc --progressive x
[[ $(grep -c '^conic: error: flipped.lpc: cannot read cloud ' err) -eq 1 ]] || fail "damage is not named: $(cat err)"
[[ ! -e x.pfm && -z $(find . -name '.x*') ]] || fail "a failed run left its output"
run 0 render flipped.lpc -o tolerated.pfm $picture --tolerate --json tolerated.json
[[ $(value clouds_damaged tolerated.json) == 1 && $(value places_coarser tolerated.json) -gt 0 ]] || fail "--tolerate"
grep -q '^conic: warning: flipped.lpc: cloud [0-9]*: .*sum' err || fail "--tolerate does not say what: $(cat err)"

if [[ -z $nginx ]]; then
  echo "skipped in part: nginx is not there (scripts/install-packages nginx-light)" >&2
  [[ $failures -eq 0 ]]
  exit
fi

# nginx as a process of ours, in this folder, at the first port that is free.
start_nginx() { # sets port and nginx_pid
  local i
  for i in 1 2 3 4 5 6 7 8; do
    port=$((20000 + (RANDOM * 32768 + RANDOM) % 30000))
    cat > nginx.conf << CONF
daemon off; master_process off; pid nginx.pid; error_log error.log; worker_processes 1;
events { worker_connections 64; }
http {
  access_log off; keepalive_timeout 30; sendfile off;
  client_body_temp_path temporary; proxy_temp_path temporary; fastcgi_temp_path temporary;
  uwsgi_temp_path temporary; scgi_temp_path temporary;
  server {
    listen 127.0.0.1:$port;
    root $PWD;
    location /whole/ { alias $PWD/; max_ranges 0; }
    location /moved/ { return 302 /knot.lpc; }
  }
}
CONF
    "$nginx" -p "$PWD" -c "$PWD/nginx.conf" -e "$PWD/error.log" > nginx.out 2>&1 &
    nginx_pid=$!
    for _ in {1..50}; do
      (exec 3<> "/dev/tcp/127.0.0.1/$port") 2> /dev/null && kill -0 $nginx_pid 2> /dev/null && return 0
      kill -0 $nginx_pid 2> /dev/null || break
      sleep 0.05
    done
    kill $nginx_pid 2> /dev/null
    wait $nginx_pid 2> /dev/null
  done
  return 1
}

stop_nginx() {
  kill "$1" 2> /dev/null
  wait "$1" 2> /dev/null
}

if ! start_nginx; then
  cat error.log nginx.out >&2
  fail "nginx does not start"
  exit 1
fi
trap 'stop_nginx $nginx_pid; rm -rf "$work"' EXIT
site=http://127.0.0.1:$port

for url in $site/knot.lpc $site/whole/knot.lpc $site/moved/knot.lpc; do
  run 0 render "$url" -o url.pfm $picture --json url.json
  same_picture all.json url.json "$url"
  [[ $(value bytes_received url.json) -gt 0 ]] || fail "$url: no bytes received"
done
for options in "--memory 1" "--occlusion on" "--threads 1"; do
  run 0 render $site/knot.lpc -o url.pfm $picture $options --json url.json
  same_picture all.json url.json "over HTTP, $options"
done
run 0 render $site/knot.lpc -o url.pfm $picture --error 8 --json url.json
[[ $(value bytes_received url.json) -lt $(($(stat -c %s knot.lpc) * 3 / 4)) ]] || fail "a coarse picture fetches everything"

# A hybrid model likewise: what is shown is read, and no more.
for options in "" "--error 1 --zoom 6" "--budget 300"; do
  run 0 render hill.chy -o hill.pfm $picture $options --json hill.json
  for memory in "" "--memory 22"; do
    run 0 render $site/hill.chy -o url.pfm $picture $options $memory --json url.json
    same_picture hill.json url.json "a hybrid over HTTP, $options $memory"
    [[ $(value bytes_received url.json) -ge $(value bytes_read url.json) ]] || fail "a hybrid's bytes over HTTP"
  done
done
[[ $(value bytes_read url.json) -lt $(($(stat -c %s hill.chy) / 2)) ]] || fail "a small budget fetches everything"
[[ $(value bytes_received url.json) -lt $(($(stat -c %s hill.chy) / 2)) ]] || fail "a small budget receives everything"
run 0 render $site/whole/hill.chy -o url.pfm $picture --budget 300 --json whole.json
same_picture url.json whole.json "a hybrid of a server without ranges"
run 3 render $site/missing.chy -o x.pfm
run 4 render http://127.0.0.1:9/x.chy -o x.pfm --timeout 1

run 0 render $site/knot.lpc --progressive remote $picture --error 1 --json url.json
for picture_file in steps/*.exr; do
  run 0 diff "$picture_file" remote/"$(basename "$picture_file")"
done
run 0 render $site/knot.lpc -o url.pfm $picture --deadline 100 --json url.json
same_picture all.json url.json "a deadline that is far"

# A slow line, which all requests share, and a deadline: coarser, and said so.
python3 "$1/tests/cli/slow_server.py" "$PWD" 40000 > slow.port &
slow_pid=$!
trap 'stop_nginx $nginx_pid; kill $slow_pid 2> /dev/null; rm -rf "$work"' EXIT
for _ in {1..100}; do
  [[ -s slow.port ]] && break
  sleep 0.05
done
slow=http://127.0.0.1:$(cat slow.port)
run 0 render $slow/knot.lpc -o late.pfm $picture --deadline 2.5 --json late.json
[[ $(value places_coarser late.json) -gt 0 && $(value clouds_missing late.json) -gt 0 ]] || fail "the deadline did nothing"
[[ $(value splats_in late.json) -lt $(value splats_in all.json) ]] || fail "late, and all the same"

run 3 render $site/none.lpc -o x.pfm
run 3 render $site/knot.ply -o x.pfm
grep -q "^conic: error: $site/knot.ply: " err || fail "a message without its file: $(cat err)"

# A server that dies midway.
"$conic" render --plain $slow/knot.lpc -o x.pfm $picture --timeout 1 2> err &
render_pid=$!
sleep 1.5
stop_nginx $slow_pid
wait $render_pid
[[ $? -eq 4 && $(grep -c '^conic: error: ' err) -eq 1 ]] || fail "a server that dies: $(cat err)"
[[ ! -e x.pfm && -z $(find . -name '.x*') ]] || fail "a failed run left its output"
[[ $failures -eq 0 ]]
