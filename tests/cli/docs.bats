#!/usr/bin/env bats
# Each command in the documentation works as it stands, and prints what the page says it does.

load page
setup_file() {
  export ROOT=$(cd "$BATS_TEST_DIRNAME/../.." && pwd)
  local build=${BUILD:-build}
  case $build in /*) ;; *) build=$ROOT/$build ;; esac
  export PATH="$build/bin:$PATH"
}

run_blocks() { # runs all ```sh blocks of a page, in order, beside a copy of the samples
  cd "$BATS_TEST_TMPDIR"
  ln -s "$ROOT/data-samples" data-samples
  cp -r "$ROOT/examples" examples
  sed -n '/^```sh$/,/^```$/p' "$1" | grep -v '^```' > commands.sh
  [ -s commands.sh ]
  bash -e -x commands.sh > log 2>&1 || { tail -30 log; false; }
  python3 "$ROOT/tests/cli/quoted.py" "$1" log
}

# COUNT FOLDER: the first slices of the sample. What a study is made of does not hang on how many there are.
part_of_sample() {
  mkdir "$2"
  find "$ROOT"/data-samples/small -name 'slice_*.png' | sort | head -"$1" | xargs cp -t "$2"
}

@test "pages for readers: short lines, no commits, no history, links that lead somewhere" {
  python3 "$ROOT/tests/cli/readable.py" "$ROOT"
}

@test "a page that quotes what no command prints is found" {
  cd "$BATS_TEST_TMPDIR"
  printf '%s\n' '```text' 'k   0.0363 cm/s +- 23 %' 'Darcy 1 m/s ...' '```' > page.md
  printf '%s\n' 'k 0.0364 cm/s +- 23 %' 'Darcy 1.001 m/s (superficial)' > log
  python3 "$ROOT/tests/cli/quoted.py" page.md log
  printf '%s\n' 'k 0.0364 cm/s +- 24 %' 'Darcy 1.001 m/s (superficial)' > log
  run python3 "$ROOT/tests/cli/quoted.py" page.md log
  [ "$status" -eq 1 ] && [[ "$output" == *"k 0.0363 cm/s +- 23 %"* || "$output" == *"k   0.0363"* ]]
}

@test "readme: a scan, a scene of four lines, a report" {
  run_blocks "$ROOT/README.md"
  [ -s out.html ]
  # What to change for one's own scan, and for a segmented one, is said beside it; the first number is worth seeing.
  grep -q "for yours change the folder, the void ratio you measured and the voxel size" <(tr '\n' ' ' < "$ROOT/README.md")
  grep -q "^A segmented image?.*--segmented" <(tr '\n' ' ' < "$ROOT/README.md" | sed 's/A segmented image?/\n&/')
  [ "$(sed -n 's/^k .* +- \([0-9.]*\) % .*/\1/p' "$ROOT/README.md" | head -1 | cut -d. -f1)" -le 15 ]
  page out.html 'page["verdict"][0]["k_m_per_s"] > 0 and {"slice", "plane", "flow"} <= set(page["pictures"])'
}

@test "tutorial: from a scan to a number" {
  run_blocks "$ROOT/docs/tutorial.md"
  [ -s tutorial/converge/converge.json ]
  [ -s tutorial/report.html ]
  # Of one body's runs the finest is shown.
  page tutorial/report.html 'page["runs"][0]["name"] == "fine-run" and page["model"]["path"].endswith("tutorial/fine.hdf")'
}

# bats test_tags=long
@test "tutorial: what is advised at two other void ratios" {
  cd "$BATS_TEST_TMPDIR"
  ln -s "$ROOT/data-samples" data-samples
  mkdir tutorial
  for e in 0.695 0.75; do
    ct2model build data-samples/small --void-ratio $e --voxel-size 8.745um --size 32x32x14 -o tutorial/$e.hdf
    sphsolve run data-samples/scenes/demo.cfg --set model.file=tutorial/$e.hdf -o tutorial/$e-fine
    sphsolve run data-samples/scenes/demo.cfg --set model.file=tutorial/$e.hdf --set lattice.spacing='"70 um"' -o tutorial/$e-coarse
    analyze report tutorial/$e-coarse.hdf tutorial/$e-fine.hdf -o tutorial/$e.html
  done
  # Narrow pores leave 5 % little room beside the shares that no finer lattice lessens: where these are all but 5 %, a finer
  # scan is advised.
  /usr/bin/python3 - tutorial/0.695.html << 'P'
import json, re, sys
verdict = json.loads(re.search(r'id="data">(.*?)</script>', open(sys.argv[1]).read(), re.S)[1])["verdict"][0]
rest = sum(verdict["error_budget"][part] ** 2 for part in ("scan", "sides", "void_ratio")) ** 0.5
print(rest, verdict["advice"])
assert 0.04 < rest < 0.05
assert ("only just below" if rest >= 0.97 * 0.05 else "a scan with voxels of about") in verdict["advice"]
P
  # Where it leaves room, no model finer than the scan is advised.
  said tutorial/0.75.html -q "For 5 %: a scan with voxels of about [0-9.]* um; its own are 8.745 um"
}

# bats test_tags=long
@test "calibration: from a measured void ratio to its share in the error of k" {
  # The study's first two thresholds, of part of the scan; as it stands it would make a model of the whole for each.
  export THRESHOLDS="54 58" SLICES=$BATS_TEST_TMPDIR/part
  part_of_sample 24 "$SLICES"
  run_blocks "$ROOT/docs/calibration.md"
  k() { sed -n 's/^  "k": \([0-9.e-]*\),/\1/p' "calibration/run-$1.json"; }
  awk -v a="$(k 0.705)" -v b="$(k 0.725)" -v c="$(k 0.745)" 'BEGIN { exit !(0 < a && a < b && b < c && sprintf("%.2f", (c - a) / 2 / b) == 0.04) }'
  [ "$(bash -c "$(grep '^grep' "$ROOT/docs/calibration.md")" | wc -l)" -eq 3 ] # of the runs, not of their lattices
  [ "$(wc -l < calibration/study/calibration.csv)" -eq 4 ]
  unset THRESHOLDS SLICES
  make -n -C examples/calibration "BIN=${PATH%%:*}/" "OUT=$PWD/all" > all.txt
  for threshold in "" "--threshold 54 " "--threshold 58 " "--threshold 62 " "--threshold 66 " "--threshold 70 "; do
    grep -q "ct2model build .*data-samples/small --void-ratio 0.725+-0.005 --voxel-size 8.745um --size 32x32x14 $threshold--json" all.txt
  done
}

# bats test_tags=long
@test "micropores: from three labels to k over the permeability of one" {
  /usr/bin/python3 -c 'import h5py' 2> /dev/null || skip "python3-h5py is not installed"
  export OMP_NUM_THREADS=1
  run_blocks "$ROOT/docs/micropores.md"
  page micropores/sure.html '"micro" in page["runs"][0]'
  # Its greys hold soil so tight that no solve goes on to the end; how much the sides matter is found all the same.
  sed 's/clods.hdf/greys.hdf/' micropores/clods.cfg > micropores/greys.cfg
  run sphsolve run micropores/greys.cfg -o micropores/greys-run
  [ "$status" -eq 0 ] && [[ "$output" == *"sides "* && "$output" != *"not known"* ]] || { echo "$output"; false; }
}

@test "seepage: a column, two heads, a dam on soil" {
  export OMP_NUM_THREADS=1
  run_blocks "$ROOT/docs/seepage.md"
  python3 "$BATS_TEST_DIRNAME/seepage_numbers.py"
}

@test "excavation: flow, exit gradient and heave against finite differences" {
  export OMP_NUM_THREADS=1
  run_blocks "$ROOT/docs/excavation.md"
  [ -s excavation/trench/seepage.png ]
  # The page begins with what flows and how safe it is; its picture has letters for a telephone's width.
  page excavation/trench.html '1.00e-4 <= page["headline"]["value"] < 1.01e-4 and 0 < page["headline"]["error"] < 1e-5' \
    'page["headline"]["text"] == "through the soil, by the flow net"' \
    'next(s["width"] for s in page["sections"] if s["name"] == "seepage") <= 600'
  said excavation/trench.html -q "Against its being lifted the soil has a factor of 2.7[0-9]*, 2.6[0-9]* at least: it stays"
  python3 "$BATS_TEST_DIRNAME/excavation_numbers.py"
}

# bats test_tags=long
@test "examples: each study runs, and runs again only what changed" {
  local bin=${PATH%%:*}/
  cp -r "$ROOT/examples" "$BATS_TEST_TMPDIR" && cd "$BATS_TEST_TMPDIR/examples"
  unset MAKEFLAGS MFLAGS # those of a make that runs this test are not meant for these
  # A bare Debian with the package has no column, of bsdextrautils.
  mkdir none && ln -s /bin/false none/column
  local PATH="$PWD/none:$PATH"
  part_of_sample 24 part
  local settings=("BIN=$bin" "SLICES=$PWD/part" "ROOT=$ROOT")
  make -C specimen "${settings[@]}" SIZES="16x16x3 32x32x6" > log 2>&1 || { cat log; false; }
  make -C calibration "${settings[@]}" SIZE=32x32x6 THRESHOLDS="58 66" > log 2>&1 || { cat log; false; }
  make -C gradients "${settings[@]}" SIZE=16x16x3 VOID_RATIOS=0.942 GRADIENTS="5 10" > log 2>&1 || { cat log; false; }
  make -C seepage "${settings[@]}" GRAIN_SIZES="5" > log 2>&1 || { cat log; false; }
  [ -s specimen/out/report.html ]
  [ -s specimen/out/converge/converge.json ]
  [ -s gradients/out/darcy/darcy.json ]
  awk -F, 'NR > 1 { if ($2 <= e || $3 <= k) exit 1; e = $2; k = $3; n++ } END { exit n != 3 }' calibration/out/calibration.csv
  awk -F, 'NR == 2 { exit ($2 / $4 - 1) ^ 2 > 1e-6 }' seepage/out/seepage.csv
  run make -C specimen "${settings[@]}" SIZES="16x16x3 32x32x6"
  [[ "$output" == *"Nothing to be done"* ]]
  touch specimen/out/model-32x32x6.hdf
  run make -C specimen "${settings[@]}" SIZES="16x16x3 32x32x6"
  [ "$status" -eq 0 ]
  [[ "$output" == *"run-32x32x6"* && "$output" != *"model-16x16x3.hdf -o"* ]]
}

@test "examples: a scan of another shape than the sample's needs no SIZE, and BIN no slash" {
  local bin=${PATH%%:*}
  cp -r "$ROOT/examples" "$BATS_TEST_TMPDIR" && cd "$BATS_TEST_TMPDIR/examples"
  unset MAKEFLAGS MFLAGS
  part_of_sample 20 thin
  local settings=("BIN=$bin" "SLICES=$PWD/thin" "ROOT=$ROOT")
  make -n -C specimen "${settings[@]}" | grep -q -- "--size 48x48x8 "
  make -C calibration "${settings[@]}" THRESHOLDS=62 > log 2>&1 || { cat log; false; }
  grep -q -- "^$bin/ct2model build .*--size 32x32x5 " log
  make -n -C gradients "${settings[@]}" | grep -q -- "--size 16x16x2 "
}

@test "examples: a study made with another variable is made anew, each of them" {
  local bin=${PATH%%:*}/
  cp -r "$ROOT/examples" "$BATS_TEST_TMPDIR" && cd "$BATS_TEST_TMPDIR/examples"
  unset MAKEFLAGS MFLAGS
  # A program that only writes what it was called with shows what a make would have run.
  mkdir fake
  cat > fake/ct2model <<'END'
#!/bin/bash
words="$*"
while [ $# -gt 0 ]; do [ "$1" = -o ] && out=$2; shift; done
case $out in */) mkdir -p "$out" ;; esac
[[ $words == darcy* || $words == converge* ]] && { mkdir -p "$out"; out=$out/$(basename "$out").json; }
[[ $words == run* ]] && out=$out.hdf
echo "$words" > "$out"
echo '{"threshold": 1, "void_ratio": 1, "k": 1, "darcy_velocity": [0, 0, 1]}'
END
  chmod +x fake/ct2model && cp fake/ct2model fake/sphsolve && cp fake/ct2model fake/analyze
  mkdir scan1 scan2 && touch scan1/a.png scan2/a.png
  printf 'print("table")\n' > calibration/table.py && cp calibration/table.py seepage/table.py
  local first=("BIN=$PWD/fake/" "SLICES=$PWD/scan1" "ROOT=$ROOT")
  for study in calibration gradients specimen seepage; do
    make -C $study "${first[@]}" > log 2>&1 || { cat log; false; }
    make -C $study "${first[@]}" | grep -q "Nothing to be done\|table" || { echo "$study: made again"; false; }
    cp -a $study/out $study/made
  done
  with() { # STUDY VARIABLE=VALUE: what is run with it after a make without
    rm -r "$1/out" && cp -a "$1/made" "$1/out"
    run make -C "$1" "${first[@]}" "$2"
    [ "$status" -eq 0 ] || { echo "$output"; false; }
    [[ "$output" == *"fake/"* || "$output" == *table.py* ]] || { echo "$1 $2: nothing was made anew: $output"; false; }
  }
  for study in calibration gradients specimen; do
    for change in VOID_RATIO=0.8 VOXEL_SIZE=9um SLICES="$PWD/scan2"; do
      with $study "$change"
      [[ "$output" == *"build "*"${change#*=}"* || $study$change == gradientsVOID_RATIO* ]]
    done
  done
  with calibration "THRESHOLDS=54 58"
  with calibration SIZE=8x8x8
  with gradients SIZE=8x8x8
  with gradients "GRADIENTS=1 5"
  with gradients "VOID_RATIOS=0.9"
  with specimen "SIZES=8x8x8 9x9x9"
  with specimen "SIZES=16x16x7 32x32x14"
  with seepage "GRAIN_SIZES=1 2"
}

@test "make: a name with a space in it is refused, not taken for two that clean removes" {
  cp -r "$ROOT/examples" "$BATS_TEST_TMPDIR" && cd "$BATS_TEST_TMPDIR"
  unset MAKEFLAGS MFLAGS
  mkdir -p "a b" a
  touch a/kept
  for words in "examples/specimen:OUT" "examples/specimen:SLICES" "$ROOT:BUILD" "$ROOT:PREFIX"; do
    name=${words##*:}
    run make -C "${words%:*}" clean "$name=$PWD/a b"
    [ "$status" -eq 2 ] && [[ "$output" == *"$name=\"$PWD/a b\": make takes no name with a space"* ]] || { echo "$words: $output"; false; }
  done
  [ -e a/kept ] && [ -d "a b" ]
}

@test "examples: where numbers are written with a comma, scenes still get a point" {
  mkdir "$BATS_TEST_TMPDIR/locales"
  localedef -i de_DE -f UTF-8 "$BATS_TEST_TMPDIR/locales/de_DE.UTF-8" 2> /dev/null || skip "no localedef, or without the locales' sources"
  export LOCPATH="$BATS_TEST_TMPDIR/locales" LC_ALL=de_DE.UTF-8
  [ "$(awk 'BEGIN { printf "%.1f", 0.5 }')" = 0,5 ] || skip "this awk writes a point"
  part_of_sample 21 "$BATS_TEST_TMPDIR/part"
  make -s -C "$ROOT/examples/gradients" OUT="$BATS_TEST_TMPDIR" BIN="${PATH%%:*}/" SLICES="$BATS_TEST_TMPDIR/part" SIZE=12x12x2 \
    GRADIENTS=0.5 VOID_RATIOS=0.7 > /dev/null 2> "$BATS_TEST_TMPDIR/log" || { cat "$BATS_TEST_TMPDIR/log"; false; }
  python3 -c '
import json, sys
assert json.load(open(sys.argv[1]))["k"] > 0' "$BATS_TEST_TMPDIR/e0.7-i0.5.json"
  # The same of what pages show.
  ! grep -n '=$(awk' "$ROOT"/README.md "$ROOT"/docs/*.md
}

@test "examples: a specimen's runs have one method and one limit, however coarse the first is" {
  part_of_sample 24 "$BATS_TEST_TMPDIR/part"
  make -s -C "$ROOT/examples/specimen" OUT="$BATS_TEST_TMPDIR" BIN="${PATH%%:*}/" SLICES="$BATS_TEST_TMPDIR/part" \
    SIZES="12x12x2 16x16x3" > /dev/null 2>&1
  python3 -c '
import json, sys
assert len(json.load(open(sys.argv[1]))["series"]) == 1' "$BATS_TEST_TMPDIR/converge/converge.json"
}

@test "the examples of --help use options that exist" {
  for program in ct2model sphsolve analyze; do
    for command in $("$program" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z0-9]*\) .*/\1/p'); do
      help=$("$program" "$command" --help)
      known=$(echo "$help" | sed -n '/^Options:/,/^Example:/p' | grep -oE -- '--[a-z][a-z-]*' | sort -u)
      for option in $(echo "$help" | sed -n '/^Example:/,$p' | grep -oE -- ' --[a-z][a-z-]*' | sort -u); do
        grep -qx -- "$option" <<< "$known" || { echo "$program $command: $option"; false; }
      done
      [ "$(echo "$help" | wc -l)" -le 45 ]
    done
  done
}
