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
  ln -sfn "$ROOT/data-samples" data-samples
  [ -e examples ] || cp -r "$ROOT/examples" examples
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

@test "pages that sources cite are there, and theory pages say where their constants come from" {
  cd "$ROOT"
  for page in $(grep -rhoE 'docs/[a-z0-9/_-]+\.md' --include='*.[ch]' --include='*.py' --include='*.bats' --include='*.cfg' \
    common ct2model sphsolve analyze tests data-samples scripts | sort -u); do
    [ -e "$page" ] || { echo "$page is cited, and not there"; false; }
  done
  for page in docs/physics/*.md; do
    [[ $page == */index.md ]] || grep -q '^## Where the constants come from$' "$page" || { echo "$page: no constants"; false; }
  done
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

@test "readme: a scan, labels, soil and water" {
  run_blocks "$ROOT/README.md"
  [ -s sand.html ] && [ -s trench/seepage.png ]
  # What to change for one's own scan, and for a segmented one, is said beside it; the first number is worth seeing.
  grep -q "for yours change the folder, the void ratio you measured and the voxel size" <(tr '\n' ' ' < "$ROOT/README.md")
  grep -q "A segmented image needs no void ratio.*--segmented" <(tr '\n' ' ' < "$ROOT/README.md")
  [ "$(sed -n 's/^k .* +- \([0-9.]*\) % .*/\1/p' "$ROOT/README.md" | head -1 | cut -d. -f1)" -le 15 ]
  page sand.html 'page["verdict"][0]["k_m_per_s"] > 0 and {"slice", "plane", "flow"} <= set(page["pictures"])'
}

@test "pages that show the sample scan say that it is synthetic, and the crop of rock has licence and origin" {
  for page in README.md docs/tutorial.md docs/errors.md docs/dispersion.md data-samples/README.md data-samples/small/README.md; do
    grep -qi synthetic "$ROOT/$page" || { echo "$page"; false; }
  done
  grep -q "CC BY 4.0" "$ROOT/README.md"
  grep -q "CC BY 4.0" "$ROOT/data-samples/berea/README.md" && grep -q "Imperial College" "$ROOT/data-samples/berea/README.md"
  [ "$(ct2model info "$ROOT/data-samples/berea/berea-96.tif" --json | grep -c 96)" -ge 1 ]
}

@test "validation: the page is what its script makes of the tables" {
  diff "$ROOT/docs/validation.md" <("$ROOT/scripts/studies/validation-page")
  # No row is both used to set constants and judged, and the figure's sands are of the one kind.
  python3 - "$ROOT/docs/figures" << 'P'
import csv, sys
for name in "validation.csv", "scan-draws.csv", "scan-quality.csv":
    rows = list(csv.DictReader(open(f"{sys.argv[1]}/{name}")))
    assert rows and all(r["use"] in ("exact", "judged", "set") for r in rows), name
P
}

# bats test_tags=long
@test "tutorial: from a scan to a number, and from labels" {
  run_blocks "$ROOT/docs/tutorial.md"
  [ -s tutorial/darcy/darcy.json ]
  [ -s tutorial/rock.html ]
  # The example of the page on errors is this run.
  python3 "$ROOT/tests/cli/quoted.py" "$ROOT/docs/errors.md" log
}

# bats test_tags=long
@test "labels: from a segmented image to k, and to half its resolution" {
  run_blocks "$ROOT/docs/labels.md"
}

@test "models of two resolutions: converge, and a report that shows the finer one" {
  cd "$BATS_TEST_TMPDIR"
  mkdir tutorial
  source "$BATS_TEST_DIRNAME/sample.bash"
  sample_model 16x16x7 tutorial/coarse.hdf
  sample_model 32x32x14 tutorial/fine.hdf
  for name in coarse fine; do
    sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=tutorial/$name.hdf -o tutorial/$name-run
  done
  analyze converge tutorial/coarse-run.hdf tutorial/fine-run.hdf -o tutorial/converge
  analyze report tutorial/coarse-run.hdf tutorial/fine-run.hdf -o tutorial/report.html
  [ -s tutorial/converge/converge.json ]
  # Of one body's runs the finest is shown.
  page tutorial/report.html 'page["runs"][0]["name"] == "fine-run" and any(f.endswith("tutorial/fine.hdf") for f in page["runs"][0]["provenance"]["input_files"])'
}

# bats test_tags=long
@test "dispersion: from a flow to coefficients, a walk and one page" {
  run_blocks "$ROOT/docs/dispersion.md"
  [ -s dispersion/walked/breakthrough.svg ] && [ -s dispersion/both.html ]
}

# bats test_tags=long
@test "tutorial: what is advised at two other void ratios" {
  cd "$BATS_TEST_TMPDIR"
  ln -s "$ROOT/data-samples" data-samples
  mkdir tutorial
  # Mirrored: the sides, which neither a model nor a scan of smaller voxels lessens, leave the advice to those.
  for given in 0.695+-0.005 0.75; do
    e=${given%+*}
    ct2model build data-samples/small --void-ratio $given --sides mirrored --voxel-size 8.745um --size 32x32x14 -o tutorial/$e.hdf
    sphsolve run data-samples/scenes/demo.cfg --set model.file=tutorial/$e.hdf -o tutorial/$e-fine
    sphsolve run data-samples/scenes/demo.cfg --set model.file=tutorial/$e.hdf --set lattice.spacing='"70 um"' -o tutorial/$e-coarse
    analyze report tutorial/$e-coarse.hdf tutorial/$e-fine.hdf -o tutorial/$e.html
  done
  # Narrow pores leave 5 % little room beside the parts that no finer lattice lessens: where these are all but 5 %, a finer
  # scan is advised. Where there is room, a model is, and no finer one than the scan.
  /usr/bin/python3 - << 'P'
import json, re
for e, least, most in ("0.695", 0.04, 0.05), ("0.75", 0, 0.04):
    verdict = json.loads(re.search(r'id="data">(.*?)</script>', open(f"tutorial/{e}.html").read(), re.S)[1])["verdict"][0]
    rest = sum((verdict["error_budget"][part] or 0) ** 2 for part in ("scan", "sides", "void_ratio", "threshold")) ** 0.5
    print(e, rest, verdict["advice"])
    assert least < rest < most
    what, voxel = re.search(r"a (scan|model) with voxels of about ([0-9.]+) um", verdict["advice"]).groups()
    assert what == ("scan" if least > 0 else "model") and (float(voxel) < 8.745) == (what == "scan")
assert "its own are 8.745 um" in open("tutorial/0.695.html").read()
P
}

# bats test_tags=long
@test "void ratio: what its uncertainty does to k is what three models show, and the study of thresholds" {
  cd "$BATS_TEST_TMPDIR"
  mkdir calibration
  # 48 voxels: with fewer the lattices of a model differ by more than models of these void ratios do.
  for e in 0.705 0.725+-0.02 0.745; do
    ct2model build "$ROOT/data-samples/small" --void-ratio $e --voxel-size 8.745um --size 48x48x22 -o calibration/e${e%+*}.hdf
    sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file="$PWD/calibration/e${e%+*}.hdf" -o calibration/run-${e%+*} --json \
      > calibration/run-${e%+*}.json
  done
  k() { sed -n 's/^  "k": \([0-9.e-]*\),/\1/p' "calibration/run-$1.json"; }
  awk -v a="$(k 0.705)" -v b="$(k 0.725)" -v c="$(k 0.745)" 'BEGIN { exit !(0 < a && a < b && b < c && sprintf("%.2f", (c - a) / 2 / b) == 0.04) }'
  # The share of the middle one's +-0.02, of a wall that is moved as a whole, is no less.
  /usr/bin/python3 - << 'P'
import json, math
run = {e: json.load(open(f"calibration/run-{e}.json")) for e in ("0.705", "0.725", "0.745")}
shown, told = 0.5 * math.log(run["0.745"]["k"] / run["0.705"]["k"]), run["0.725"]["error"]["threshold"]
print(shown, told)
assert shown <= told < 1.5 * shown
P
  [ "$(grep -l '^  "k"' calibration/run-*.json | wc -l)" -eq 3 ] # of the runs, not of their lattices
  # The study's first two thresholds, of part of the scan; as it stands it would make a model of the whole for each.
  cp -r "$ROOT/examples" examples && ln -s "$ROOT/data-samples" data-samples
  part_of_sample 24 "$PWD/part"
  make -C examples/calibration "BIN=${PATH%%:*}/" "OUT=$PWD/calibration/study" THRESHOLDS="54 58" SLICES="$PWD/part"
  [ "$(wc -l < calibration/study/calibration.csv)" -eq 4 ]
  make -n -C examples/calibration "BIN=${PATH%%:*}/" "OUT=$PWD/all" > all.txt
  for threshold in "" "--threshold 54 " "--threshold 58 " "--threshold 62 " "--threshold 66 " "--threshold 70 "; do
    grep -q "ct2model build .*data-samples/small --void-ratio 0.725+-0.005 --voxel-size 8.745um --size 32x32x14 $threshold--json" all.txt
  done
}

# bats test_tags=long
@test "micropores: from three labels to k over the permeability of one" {
  export OMP_NUM_THREADS=1
  run_blocks "$ROOT/docs/micropores.md"
  page micropores/sure.html '"micro" in page["runs"][0]'
  # Its greys hold soil so tight that no solve goes on to the end; how much the sides matter is found all the same.
  sed 's/clods.hdf/greys.hdf/' micropores/clods.cfg > micropores/greys.cfg
  run sphsolve run micropores/greys.cfg -o micropores/greys-run
  [ "$status" -eq 0 ] && [[ "$output" == *"sides "* && "$output" != *"not known"* ]] || { echo "$output"; false; }
}

# bats test_tags=long
@test "seepage: a column, two heads, a dam on soil" {
  export OMP_NUM_THREADS=1
  for page in seepage regions unsaturated; do run_blocks "$ROOT/docs/$page.md"; done
  python3 "$BATS_TEST_DIRNAME/seepage_numbers.py"
}

# bats test_tags=long
@test "excavation: flow, exit gradient and heave against finite differences" {
  export OMP_NUM_THREADS=1
  run_blocks "$ROOT/docs/excavation.md"
  [ -s excavation/trench/seepage.png ]
  # The page begins with what flows and how safe it is; its picture has letters for a telephone's width.
  page excavation/trench.html '1.00e-4 <= page["headline"]["value"] < 1.01e-4 and 0 < page["headline"]["error"] < 1e-5' \
    'page["headline"]["text"] == "through the soil, by the flow net"' \
    'next(s["width"] for s in page["sections"] if s["name"] == "seepage") <= 600'
  said excavation/trench.html -q "Factor of safety against uplift 2.7[0-9]*, 2.6[0-9]* at least: it stays"
  python3 "$BATS_TEST_DIRNAME/excavation_numbers.py"
  analyze seepage excavation/trench.hdf --json > seepage.json
  python3 "$BATS_TEST_DIRNAME/documented_keys.py" "$ROOT/docs" seepage.json
}

# bats test_tags=long
@test "embankment: filled, held and drawn down, at two spacings" {
  export OMP_NUM_THREADS=1
  run_blocks "$ROOT/docs/embankment.md"
  [ -s embankment/dam/moisture.png ]
  # What enters the core leaves it; Dupuit over its mean thickness is about that; and no water is lost.
  /usr/bin/python3 - << 'P'
import csv
for run, wide in ("dam", 1), ("fine", 0.5):
    rows = list(csv.DictReader(open(f"embankment/{run}/history.csv")))
    held = next(r for r in rows if float(r["time"]) >= 86400 * 99)
    core, came = float(held["flux_core"]) / wide, float(held["inflow_6"]) / wide
    assert abs(core / 7.8e-9 - 1) < 0.12, core
    # the fine run's crest still draws water up
    assert 0.99 < came / core < (1.06 if run == "dam" else 2), (came, core)
    assert all(abs(float(r["water_open"])) < 1e-10 * float(r["water"]) for r in rows)
    for r in rows:  # nowhere higher than the reservoir has been
        assert not float(r["level_core"]) > 10.001 and not float(r["level_shell"]) > 10.001, r
P
}

# bats test_tags=long
@test "examples: a scan of another shape than the sample's is calibrated" {
  cp -r "$ROOT/examples" "$BATS_TEST_TMPDIR" && cd "$BATS_TEST_TMPDIR/examples"
  unset MAKEFLAGS MFLAGS
  part_of_sample 20 thin
  make -C calibration "BIN=${PATH%%:*}" "SLICES=$PWD/thin" "ROOT=$ROOT" THRESHOLDS=62 > log 2>&1 || { cat log; false; }
  grep -q -- "^${PATH%%:*}/ct2model build .*--size 32x32x5 " log
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
  make -n -C calibration "${settings[@]}" THRESHOLDS=62 | grep -q -- "$bin/ct2model build .*--size 32x32x5 "
  make -n -C gradients "${settings[@]}" | grep -q -- "--size 16x16x2 "
}

# STUDY...: made with another variable each is made anew.
made_anew() {
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
  for study in "$@"; do
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
  for study in "$@"; do
    [ $study != seepage ] || continue # has no scan
    for change in VOID_RATIO=0.8 VOXEL_SIZE=9um SLICES="$PWD/scan2"; do
      with $study "$change"
      [[ "$output" == *"build "*"${change#*=}"* || $study$change == gradientsVOID_RATIO* ]]
    done
  done
  local variables=("calibration THRESHOLDS=54 58" "calibration SIZE=8x8x8" "gradients SIZE=8x8x8" "gradients GRADIENTS=1 5"
    "gradients VOID_RATIOS=0.9" "specimen SIZES=8x8x8 9x9x9" "specimen SIZES=16x16x7 32x32x14" "seepage GRAIN_SIZES=1 2")
  for change in "${variables[@]}"; do
    [[ " $* " != *" ${change%% *} "* ]] || with "${change%% *}" "${change#* }"
  done
}
@test "examples: a study made with another variable is made anew" { made_anew gradients; }

# bats test_tags=long
@test "examples: each study made with another variable is made anew" { made_anew calibration specimen seepage; }

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

# bats test_tags=long
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

# bats test_tags=long
@test "examples: a specimen's runs have one method and one limit, however coarse the first is" {
  part_of_sample 24 "$BATS_TEST_TMPDIR/part"
  make -s -C "$ROOT/examples/specimen" OUT="$BATS_TEST_TMPDIR" BIN="${PATH%%:*}/" SLICES="$BATS_TEST_TMPDIR/part" \
    SIZES="12x12x2 16x16x3" > /dev/null 2>&1
  python3 -c '
import json, sys
assert len(json.load(open(sys.argv[1]))["series"]) == 1' "$BATS_TEST_TMPDIR/converge/converge.json"
}

@test "the reference of ct2model names every option" {
  for command in build sweep info export; do
    for option in $(ct2model $command --help | sed -n '/^Options:/,/^Example:/p' | grep -oE -- '--[a-z][a-z-]*' | sort -u); do
      grep -qE -- "$option([^a-z-]|$)" "$ROOT/docs/ct2model.md" || { echo "docs/ct2model.md: no $option, of $command"; false; }
    done
  done
}

@test "the reference of JSON names every key" {
  cd "$BATS_TEST_TMPDIR"
  source "$BATS_TEST_DIRNAME/sample.bash"
  local scene=$ROOT/data-samples/scenes/demo.cfg
  sample_model 16x16x7 coarse.hdf
  sample_model 32x32x14 fine.hdf
  ct2model build "$ROOT/data-samples/berea/berea-96.tif" --segmented 0 --voxel-size 5.345um --size 24x24x24 -o rock.hdf --json > build.json
  ct2model sweep "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,64,64,28 --size 16x16x7 --json > sweep.json
  ct2model info fine.hdf "$ROOT/data-samples/small" --json > info.json
  sphsolve explain "$scene" --set model.file="$PWD/fine.hdf" --error 50% --json > explain.json
  for name in coarse fine; do sphsolve run "$scene" --set model.file="$PWD/$name.hdf" -o $name-run --json > $name.json; done
  for analysis in darcy pdf history slice; do analyze $analysis fine-run.hdf --json > $analysis.json; done
  analyze converge coarse-run.hdf fine-run.hdf --json > converge.json
  sphsolve run "$ROOT/data-samples/scenes/recharge.cfg" --set 'domain.spacing="20 cm"' -o recharge --json > recharge.json
  analyze moisture recharge.hdf --json > moisture.json
  python3 "$BATS_TEST_DIRNAME/documented_keys.py" "$ROOT/docs" *.json
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
