#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The fingerpad authors
# SPDX-License-Identifier: MIT
# program.sh RECORDING REPLAY RENDER SLIP_TRIALS: the programs as a user meets them. Exit statuses,
# one line on standard error, nothing left behind; the recording is rendered again byte for byte;
# labels that nobody knows are refused.
set -uo pipefail
export LC_ALL=C
recording=$1
replay=$2
render=$3
slip_trials=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# refuses STATUS PATTERN ARGUMENTS...: replay exits with STATUS, says one line that matches
# PATTERN (status 2: any number of lines) and leaves nothing behind.
refuses() {
  local status=$1 pattern=$2
  shift 2
  local before after actual
  before=$(find "$work" -not -name stderr | sort)
  "$replay" "$@" >/dev/null 2>"$work/stderr"
  actual=$?
  after=$(find "$work" -not -name stderr | sort)
  [[ $actual == "$status" ]] || fail "status $actual, not $status: replay $*"
  grep -q -- "$pattern" "$work/stderr" || fail "'$(cat "$work/stderr")' for: replay $*"
  [[ $status == 2 || $(wc -l <"$work/stderr") == 1 ]] || fail "not one line: replay $*"
  [[ $before == "$after" ]] || fail "something was left behind: replay $*"
}

broken=$work/broken
cp -r "$recording" "$broken"
refuses 2 "RECORDING" --out "$work/out"
refuses 2 "out" "$recording"
refuses 2 "A:B" "$recording" --out "$work/out" --frames three
refuses 2 "smoothing" "$recording" --out "$work/out" --smoothing gauss
refuses 1 "window_px = 28" "$recording" --out "$work/out" --smoothing 28
refuses 1 "^replay: $work/none: there is no such folder" "$work/none" --out "$work/out"
refuses 1 "frames 0 to 10" "$recording" --out "$work/out" --frames 4:90
refuses 1 "which replay did not write" "$recording" --out "$broken"
refuses 1 "is not a folder" "$recording" --out "$broken/sensor.json"
refuses 1 "sensor.json: cannot be written" "$recording" --out "$broken/sensor.json/out"
refuses 2 "--headless" "$recording" --video "$work/none.avi" --out "$work/out"
refuses 2 "--camera or --video" "$recording" --headless --out "$work/out"
refuses 1 "none.avi: there is no such video" "$recording" --video "$work/none.avi" --headless \
  --out "$work/out"
# 8 x 4000 px by its container, 8 x 8 px by its stream: OpenCV 4.6 crashes.
mkdir "$work/hostile" && echo '{"video": "film.webm"}' >"$work/hostile/sensor.json"
cp "$(dirname "$0")/../fuzz/corpus/video/other_height.webm" "$work/hostile/film.webm"
refuses 1 "^replay: $work/hostile/film.webm: " "$work/hostile" --out "$work/out"
# Drivers of cameras leak, which LeakSanitizer would tell.
ASAN_OPTIONS=detect_leaks=0 \
  refuses 1 "camera 99: cannot be opened" "$recording" --camera 99 --headless --out "$work/out"
[[ $(id -u) == 0 ]] || { mkdir "$work/locked" && chmod 500 "$work/locked" &&
  refuses 1 "locked" "$recording" --out "$work/locked/out"; }

head -c 50000 "$recording/frames/000003.png" >"$broken/frames/000003.png"
refuses 1 "frames/000003.png: cannot be read" "$broken" --out "$work/out" --frames 3:4
# 30000 x 30000 px in 110 kB, which would be decoded to 0.9 GB.
python3 - "$broken/frames/000003.png" <<'END'
import struct, sys, zlib
def chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
head = struct.pack(">IIBBBBB", 30000, 30000, 1, 0, 0, 0, 0)
rows = zlib.compress(bytes((1 + 3750) * 30000))
with open(sys.argv[1], "wb") as file:
    file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b""))
END
refuses 1 "frames/000003.png: cannot be read as an image" "$broken" --out "$work/out" --frames 3:4
rm -r "$broken/frames" && mkdir "$broken/frames"
refuses 1 "frames: holds no frames" "$broken" --out "$work/out"
sed 's/"pitch_mm": 0.08$/"pitch": 0.08/' "$recording/sensor.json" >"$broken/sensor.json"
refuses 1 "sensor.json: unknown key camera.pitch " "$broken" --out "$work/out"
rm "$broken/sensor.json"
refuses 1 "sensor.json: cannot be read" "$broken" --out "$work/out"

"$replay" --help | grep -q -- "--raw" || fail "--help does not explain --raw"

# Rendered again: the same bytes.
rendered() {
  mkdir "$work/again"
  cp -r "$recording/membrane" "$recording/sensor.json" "$recording"/*.csv "$work/again"
  "$render" "$work/again" >/dev/null || fail "the recording cannot be rendered"
  diff -r "$recording" "$work/again" || fail "the bundled recording is not what render makes"
}
rendered

deepest() {
  "$replay" "$recording" --out "$work/out" --no-pictures --frames 4:5 --smoothing "$1" |
    sed -n 's/^max depth *\([0-9.]*\) mm/\1/p'
}
awk "BEGIN { exit !($(deepest 1) > $(deepest 29) + 0.3) }" ||
  fail "--smoothing 1 does not show the noise of single pixels"

"$replay" "$recording" --out "$work/out" --frames 4:7 >"$work/table" || fail "replay with pictures"
grep -q "^frames  *3$" "$work/table" || fail "the printed table: $(cat "$work/table")"
grep -Eq "^mean error   0\.[0-9]+ N normal, 0\.0[0-9] N tangential, 0\.[0-9]+ N mm moment" \
  "$work/table" || fail "the printed errors of the look-up: $(cat "$work/table")"
for file in frames.csv pictures/montage.png \
            pictures/{depth,side,stick,traction}_000006.png; do
  [[ -s $work/out/$file ]] || fail "$file is missing"
done
if /usr/bin/python3 -c 'import matplotlib' 2>/dev/null; then
  root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
  "$replay" "$root/examples/data/foam" --out "$work/foam" >/dev/null || fail "replay of a foam array"
  for of in out:press foam:foam; do
    /usr/bin/python3 -B "$root/examples/programs/plot.py" "$work/${of%:*}" \
      "$root/examples/data/${of#*:}" || fail "plot.py ${of#*:}"
  done
  for file in out/pictures/{motion,stick_ratio,forces}.png foam/pictures/{preslip,array}.png; do
    [[ -s $work/$file ]] || fail "plot.py does not draw $file"
  done
  # A folder with charts is still one of replay's.
  "$replay" "$recording" --out "$work/out" --frames 4:7 --no-pictures >/dev/null ||
    fail "a folder with charts"
fi
[[ ! -e $work/out/depth ]] || fail "the depth maps of the earlier run are still there"

# Interrupted while it writes: nothing half-written.
for signal in TERM HUP; do
  rm -rf "$work/out"
  "$replay" "$recording" --out "$work/out" >/dev/null 2>&1 &
  while [[ -z $(find "$work" -name '.out.*') ]] && kill -0 $! 2>/dev/null; do
    sleep 0.01
  done
  kill -$signal $! 2>/dev/null
  wait $!
  status=$?
  if [[ $status != 0 ]]; then # 0: it was done before the signal came
    [[ $status == 130 ]] || fail "status $status, not 130, after SIG$signal"
    [[ -z $(find "$work" -name '*out*') ]] || fail "a run left something behind after SIG$signal"
  fi
done

# A disk that is full, in the first picture or in a later one; a limit on the size of a file, to fail
# in the same call.
rm -rf "$work/out"
for kib in 60 400; do
  printf '#!/usr/bin/env bash\ntrap "" XFSZ\nulimit -f %d\nexec "%s" "$@"\n' "$kib" "$replay" \
    >"$work/full_disk"
  chmod +x "$work/full_disk"
  replay=$work/full_disk refuses 1 "pictures/.*: cannot be written" \
    "$recording" --out "$work/out" --frames 4:6
done

# Labelled trials: success is a hold, fail a slip; another label is no slip, but refused.
for object in disc rod; do
  for trial in 1 2; do
    mkdir -p "$work/trials/$object/$trial"
    cp "$recording"/frames/00000[0-3].png "$work/trials/$object/$trial"
  done
  printf '5 success 1 0 3 2 1\n5 fail 0 0 3 2 2\n' >"$work/trials/${object}_result.dat"
done
"$slip_trials" "$work/trials" >"$work/table" || fail "slip_trials"
grep -q "^hold  1 " "$work/table" && grep -q "^slip  2 " "$work/table" ||
  fail "slip_trials does not read success and fail: $(cat "$work/table")"
# equal recordings: half of the pairs are in order, of each object and of all
[[ $(grep -cE "^  rod +0\.500 " "$work/table") == $(grep -cE "^  object +AUC" "$work/table") ]] ||
  fail "slip_trials does not tell the AUC per object: $(cat "$work/table")"
printf '5 slipped 0 0 3 2 2\n' >>"$work/trials/rod_result.dat"
"$slip_trials" "$work/trials" >/dev/null 2>"$work/stderr"
[[ $? == 1 ]] && grep -q 'rod_result.dat: unknown label "slipped"' "$work/stderr" ||
  fail "slip_trials on an unknown label: $(cat "$work/stderr")"
printf '5 success\n' >"$work/trials/rod_result.dat"
"$slip_trials" "$work/trials" >/dev/null 2>"$work/stderr"
[[ $? == 1 ]] && grep -q 'rod_result.dat: line "5 success" names no trial' "$work/stderr" ||
  fail "slip_trials on a line without a trial"
rm "$work"/trials/*_result.dat
"$slip_trials" "$work/trials" >/dev/null 2>"$work/stderr"
[[ $? == 1 ]] && grep -q 'trials: unknown label "disc"' "$work/stderr" ||
  fail "slip_trials on a folder that is no label"

# What is wrong with a recording, before anything is computed.
"$replay" "$recording" --check >"$work/said" || fail "the bundled recording: $(cat "$work/said")"
sed 's/"max_depth_mm": 18.0/"max_depth_mm": 9/' "$recording/sensor.json" >"$broken/sensor.json"
cp -r "$recording/frames" "$broken/"
"$replay" "$broken" --check >"$work/said" && fail "a wrong recording has exit status 0"
grep -q "max_depth_mm: the value is 9, but the free pad is 13" "$work/said" || fail "--check: $(cat "$work/said")"

((failures == 0)) && echo "all as it should be"
