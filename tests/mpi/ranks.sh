#!/usr/bin/env bash
# conic-mpi: what several ranks draw together has the bits of one, and what goes wrong on any rank is told once.
set -uo pipefail

source "$1/tests/support/program.bash"
source "$1/tests/support/ranks.bash"

mkdir alone together
"$conic" make knot -n 3000 -o knot.ply
frames=(render knot.ply --plain --size 48x32 --turntable 5 --exposure auto --threads 1)
samples=(render knot.ply --plain --size 48x32 --accumulate 20 --aperture 0.2 --aov rgba,Z,samples,variance --threads 1)

# Their mpiruns take a second each to end, so together.
told_once err1 3 3 nothing.ply render nothing.ply -o a.pfm & jobs=$!
told_once err2 2 2 '--size' render knot.ply --sise 3 -o a.pfm & jobs+=" $!"
told_once err3 2 4 '/f.000[1345].pfm' "${frames[@]}" -o nowhere/f.pfm & jobs+=" $!"
told_once err4 2 2 'standard output' "${frames[@]}" -o - & jobs+=" $!"
told_once err5 2 2 '--time' "${samples[@]}" --time 3 -o a.exr & jobs+=" $!"

# So is what goes wrong on rank 1 alone: its disk is full, it sees other files, or it has no memory.
cat > ill << 'END'
#!/usr/bin/env bash
if [[ ${OMPI_COMM_WORLD_RANK:-${PMI_RANK:-}} == 1 ]]; then
  case $1 in
    disk) trap '' XFSZ && ulimit -f 20000 ;; # KiB: MPI writes some, too
    path) mkdir -p elsewhere/ill.out && cd elsewhere && echo ply > knot.ply ;;
    memory) ulimit -v 500000 ;;
  esac
fi
exec "$CONIC_MPI" "${@:2}"
END
chmod +x ill
mkdir ill.out
export CONIC_MPI=$conic_mpi
told_once_ill() { # as told_once
  conic_mpi=./ill told_once "$@"
}
large=("${frames[@]}" -q --size 1400x1100 --compression none)
told_once_ill err7 3 4 'ill.out/d.000.*cannot write' disk "${large[@]}" -o ill.out/d.exr & jobs+=" $!"
told_once_ill err8 3 3 'knot.ply' path "${frames[@]}" -o ill.out/p.pfm & jobs+=" $!"
if [[ ! $sanitized ]]; then
  told_once_ill err9 2 4 'memory' memory "${samples[@]}" -q --size 4000x3000 -o ill.out/m.exr & jobs+=" $!"
fi

# Frames, the exposure being the first one's whoever draws it
run_as_typed 0 "${frames[@]}" -o alone/f.pfm --json alone.json
ranks 3 0 "${frames[@]}" -o together/f.pfm --json together.json
diff -r alone together || fail "frames of three ranks have other bits"
same_hashes alone.json together.json "the last frame"
[[ $(grep -c '"busy_ms"' together.json) -eq 3 ]] || fail "the report is not about three ranks: $(cat together.json)"
grep -o '"units": [0-9]*' together.json | awk '{n += $2} END {exit n != 5}' || fail "frames were drawn twice, or not"

# Frames that are finished stay, whoever drew them; those that are not as they were written, or missing, come again.
kept=("${frames[@]}" -o together/f.pfm --resume together/f.pfm)
ranks 2 0 "${frames[@]}" -o together/f.pfm --resumable
cp together/f.pfm.frames list
echo 'file torn' >> together/f.pfm.frames
rm together/f.0002.pfm
printf x | dd of=together/f.0004.pfm bs=1 seek=99 conv=notrunc 2> dd.err
touch -d @1 together/f.0003.pfm
ranks 3 0 "${kept[@]}" --json kept.json
grep -q '"frames_finished": 2,' kept.json || fail "which frames were there is not told: $(grep finished kept.json)"
diff -r -x '*.frames' alone together || fail "frames that were gone on with have other bits"
[[ $(stat -c %Y together/f.0003.pfm) -eq 1 ]] || fail "a finished frame is drawn again"
diff <(grep -A1 ^file list | sort -u) <(grep -A1 ^file together/f.pfm.frames | sort -u) || fail "the list has other frames"
run_as_typed 0 "${kept[@]}"
grep -q '^conic: 5 of 5 frames were finished' err || fail "conic does not go on with ranks' frames: $(cat err)"
cp knot.ply other.ply
printf x | dd of=other.ply bs=1 seek=2000 conv=notrunc 2> dd.err
run_as_typed 3 render other.ply "${kept[@]:2}"
mv knot.ply first.ply && cp other.ply knot.ply
run_as_typed 3 "${kept[@]}"
mv first.ply knot.ply
told_once err6 2 3 'together/f.pfm.frames: cannot go on: .*options' "${kept[@]}" --zoom 2 & jobs+=" $!"

# Samples, however they are shared out, with a focus that the picture shows, and with an end that the noise decides
run_as_typed 0 "${samples[@]}" -o alone.exr --json alone.json
ranks 2 0 "${samples[@]}" -o together.exr --json together.json
same_hashes alone.json together.json "the mean of 20 samples on two ranks"
run_as_typed 0 "${samples[@]}" --noise 0.006 --accumulate 70 --resumable -o alone.exr --json alone.json 2> /dev/null
ranks 3 0 "${samples[@]}" --noise 0.006 --accumulate 70 --resumable -o together.exr --json together.json
same_hashes alone.json together.json "the mean of samples up to a noise on three ranks"
cmp alone.exr.sums together.exr.sums || fail "the sums that are kept differ"
grep -q '"samples": 64' together.json || fail "the noise ends it elsewhere: $(grep '"samples": [0-9]' together.json)"

# Windows of one picture, of splats and of an octree's, also of several samples a pixel; what has none is drawn by one
windows=(render knot.ply --plain --size 200x130 --aov rgba,Z,N,id,count --threads 1)
run_as_typed 0 "${windows[@]}" -o alone.exr --json alone.json
ranks 3 0 "${windows[@]}" -o together.exr --json together.json
same_hashes alone.json together.json "a picture in windows on three ranks"
cmp alone.exr together.exr || fail "the file of a picture in windows differs"
for key in splats_in splats_drawn fragments pixels_covered; do
  [[ $(grep "\"$key\"" alone.json) == "$(grep "\"$key\"" together.json)" ]] || fail "$key of windows differs"
done
"$conic" octree knot.ply -o knot.cot
octree=(render knot.cot --plain --size 160x130 --samples 2 --error 1 --aov rgba,id --threads 1)
run_as_typed 0 "${octree[@]}" -o alone.exr --json alone.json
ranks 2 0 "${octree[@]}" -o together.exr --json together.json
same_hashes alone.json together.json "an octree in windows on two ranks"
grep -q '"shares": "windows"' together.json || fail "an octree is not drawn in windows"

# A trace says what each rank did, and what more of them would do. On a busy machine a rank that begins late may find
# nothing left to do.
for _ in {1..5}; do
  ranks 2 0 "${octree[@]}" -o traced.exr --trace trace.json
  ! grep -q '"cat": "unit".*"pid": 1.*"sent_bytes": [1-9]' trace.json || break
done
model 4 trace.json --ranks 1,2,64
[[ $(grep -c '"cat": "open"' trace.json) -eq 4 ]] || fail "a trace lacks what a rank opened, or set up"
grep -q '"cat": "unit".*"pid": 1.*"sent_bytes": [1-9]' trace.json || fail "a trace lacks the units of rank 1"
run_as_typed 0 "${octree[@]}" --size 512x400 -o alone.exr
ranks 2 0 "${octree[@]}" --size 512x400 -o cut.exr --trace cut.json --trace-ranks=64
model 2 cut.json --processor --ranks 64
[[ $(grep -c '"cat": "unit"' cut.json) -eq 56 ]] || fail "the units are not cut for 64 ranks"
cmp alone.exr cut.exr || fail "smaller windows have other bits"
told_once err10 2 2 '--trace-ranks' render knot.ply --trace-ranks 8 -o a.pfm & jobs+=" $!"

for job in $jobs; do
  wait "$job" || failures=$((failures + 1))
done
compgen -G 'ill.out/.*.*' > left && fail "a rank that failed leaves $(cat left)"
compgen -G 'ill.out/m*' > left && fail "a picture without one rank's samples is written"
exit $((failures > 0))
