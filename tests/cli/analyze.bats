# analyze, driven as a user does, on runs made up by make_run.py.
load page
setup_file() {
  cd "$BATS_FILE_TMPDIR"
  export MAKE_RUN="$BATS_TEST_DIRNAME/make_run.py"
  /usr/bin/python3 "$MAKE_RUN" $(for g in 1 5 10; do echo d$g.hdf i=$g name=dense-${g}G noise=0.01 gauge=1 --; done) \
    l1.hdf i=1 k=2.25e-3 hash=0x99 model=loose.hdf name=loose-1G
}
setup() {
  cd "$BATS_FILE_TMPDIR"
  PATH="$BUILD/bin:$PATH"
}
# field FILE PATH: a value of a JSON file
field() { /usr/bin/python3 -c "import json,sys
v = json.load(open('$1'))
for key in '$2'.split('.'): v = v[int(key)] if key.isdigit() else v[key]
print(v)"; }
# absent ARGUMENTS: grep finds nothing (a bare "! grep" would not fail a bats test)
absent() { if grep "$@"; then return 1; fi; }
# near VALUE WANTED RELATIVE
near() { /usr/bin/python3 -c "import sys; sys.exit(abs($1 - $2) > $3 * abs($2))"; }

@test "help of every subcommand shows an example" {
  for command in darcy pdf history slice; do
    run analyze $command --help
    [ "$status" -eq 0 ]
    [[ "$output" == *"analyze $command"*".hdf"* ]]
  done
}

@test "darcy finds k, its error and the line" {
  run analyze darcy d1.hdf d5.hdf d10.hdf -o out
  [ "$status" -eq 0 ]
  [[ "$output" == *"cm/s"* && "$output" == *"m^2"* && "$output" == *"darcy"* ]]
  near "$(field out/darcy.json k_m_per_s)" 1.5e-3 0.005
  near "$(field out/darcy.json k_cm_per_s)" 0.15 0.005
  near "$(field out/darcy.json intrinsic_permeability_m2)" 1.5296e-10 0.005
  near "$(field out/darcy.json r_squared)" 1 1e-4
  [ "$(field out/darcy.json forchheimer.called_for)" = False ]
  for ending in csv gp svg png; do [ -s out/darcy.$ending ]; done
  grep -q "<svg" out/darcy.svg
}

@test "darcy finds a Forchheimer term that is there" {
  /usr/bin/python3 "$MAKE_RUN" $(for g in 1 2 4 8; do echo f$g.hdf i=$g b=20000 noise=0.002 --; done)
  analyze darcy f1.hdf f2.hdf f4.hdf f8.hdf --json > f.json
  [ "$(field f.json forchheimer.called_for)" = True ]
  near "$(field f.json forchheimer.b_s2_per_m2)" 20000 0.05
  near "$(field f.json k_m_per_s)" 1.5e-3 0.02
}

@test "k that falls with the gradient is told, of two runs too" {
  /usr/bin/python3 "$MAKE_RUN" w1.hdf i=1 b=4000 -- \
    w5.hdf i=5 b=4000
  run analyze darcy w1.hdf w5.hdf
  [[ "$output" == *"w1: k falls by "*" % from a gradient of 1 to 5"* ]]
  run analyze darcy d1.hdf d5.hdf d10.hdf
  [[ "$output" != *"k falls"* ]]
}

@test "runs of different models are refused unless told, and which they are is said" { different_models darcy report; }

# COMMAND...
different_models() {
  for command in "$@"; do
    run analyze $command d1.hdf l1.hdf d5.hdf -o mixed.html
    [ "$status" -eq 3 ]
    [ "${#lines[@]}" -eq 1 ]
    [ ! -e mixed.html ]
    [[ "$output" == *"2 different models: slit.hdf (d1.hdf and 1 more), loose.hdf (l1.hdf)"*"--mix"* ]]
    run analyze $command d1.hdf l1.hdf d5.hdf --mix -o mixed.html
    [ "$status" -eq 0 ]
    [[ "$output" == *"2 models together: slit.hdf (d1.hdf and 1 more), loose.hdf (l1.hdf)"* ]]
    rm -r mixed.html
  done
}

# bats test_tags=long
@test "runs of different models: other commands, a verdict of one of them, two spacings of one body" {
  different_models pdf history
  # The verdict is of one of them, and says of which.
  run analyze darcy d1.hdf l1.hdf d5.hdf --mix
  [[ "$output" == *"Verdict of "*" (wcsph, subvoxel walls): "* ]]
  run analyze darcy d1.hdf d5.hdf
  [[ "$output" == *"Verdict: "* ]]
  # Two spacings of one body are a study of the resolution; another model at one of them is not part of it.
  /usr/bin/python3 "$MAKE_RUN" m20.hdf n=20 spacing=4e-5 k=1.04e-3 method=stokes hash=0x20 -- \
    m40.hdf n=40 spacing=2e-5 k=1.01e-3 method=stokes hash=0x40 -- \
    other.hdf n=40 spacing=2e-5 k=2.01e-3 method=wcsph hash=0x41 model=other.hdf
  analyze converge m20.hdf m40.hdf > /dev/null
  analyze report m20.hdf m40.hdf -o levels.html > /dev/null
  for command in darcy pdf history; do
    run analyze $command m20.hdf m40.hdf
    [ "$status" -eq 3 ]
  done
  for command in converge "report -o levels.html"; do
    run analyze $command m20.hdf m40.hdf other.hdf
    [ "$status" -eq 3 ]
    [[ "$output" == *"other.hdf (other.hdf)"* ]]
  done
}

@test "darcy keeps different models apart, and says so" {
  run analyze darcy d1.hdf l1.hdf --mix
  [ "$status" -eq 0 ]
  [[ "$output" == *"2 groups"* ]]
  analyze darcy d1.hdf l1.hdf --mix --json > two.json
  run field two.json k_m_per_s
  [ "$status" -ne 0 ]
  near "$(field two.json groups.1.k_m_per_s)" 2.25e-3 0.01
}

@test "a stationary solution counts with its own error" {
  /usr/bin/python3 "$MAKE_RUN" st.hdf method=stokes rows=2 k_error=0.02 status=converged
  analyze darcy st.hdf --json > st.json
  near "$(field st.json k_m_per_s)" 1.5e-3 1e-9
  near "$(field st.json k_relative_error)" 0.02 1e-6
}

@test "a run that still drifts gives no k" {
  /usr/bin/python3 "$MAKE_RUN" dr.hdf tau=10 end=0.01
  run analyze darcy dr.hdf
  [ "$status" -eq 0 ]
  [[ "$output" == *"still drifts by"* && "$output" == *"k: none"* ]]
}

@test "pdf: range, integral and transverse share of a slit" {
  analyze pdf d1.hdf -o out > /dev/null
  near "$(field out/pdf.json normalised_velocity_max)" 1.478 0.002
  near "$(field out/pdf.json normalised_velocity_min)" 0.2836 0.002
  near "$(field out/pdf.json pore_mean_m_per_s)" 3e-3 1e-6
  [ "$(field out/pdf.json transverse_ratio)" = 0.0 ]
  /usr/bin/python3 - <<'PY'
import csv, json, math
whole = json.load(open("out/pdf.json"))
p = whole["pdf"]
e, d = p["bin_edges"], p["density"]
# The table has the densities at the middles of the bins.
rows, middle = list(csv.DictReader(open("out/pdf.csv"))), lambda e: [(a + b) / 2 for a, b in zip(e, e[1:])]
for of, name, density in (p, "normalised_velocity", "density"), (whole["pdf_m_per_s"], "velocity_m_per_s", "density_s_per_m"):
    for column, values in (name, middle(of["bin_edges"])), (density, of["density"]):
        table = [float(row[column]) for row in rows if row[column]]
        assert len(table) == len(values) and all(abs(a - b) <= 1e-7 * abs(b) for a, b in zip(table, values)), column
# The curves to compare with: exact densities, from one place for plot, file and page.
exact = {"slit": lambda s: 1 / (3 * math.sqrt(1 - s / 1.5)), "tube": lambda s: 0.5, "exponential": lambda s: math.exp(-s)}
curves = {c["name"]: c for c in whole["references"]}
assert set(curves) == set(exact) | {"power-exponential"}
for name, density in exact.items():
    c = curves[name]
    assert all(abs(y - density(s)) < 1e-9 * density(s) for s, y in zip(c["normalised_velocity"], c["density"])), name
c = curves["power-exponential"]  # integrates to 1 with what lies beyond its end
step, g = c["normalised_velocity"][1], whole["power_exponential"]
assert abs(step * (sum(c["density"]) - 0.5 * (c["density"][0] + c["density"][-1])) - 1) < 0.05, g
assert "exp(" not in open("out/pdf.gp").read().split("$raw0")[0] and "slit(s)" not in open("out/pdf.gp").read()
assert len(e) == len(d) + 1
assert abs(sum(x * (b - a) for x, a, b in zip(d, e, e[1:])) - 1) < 1e-9
PY
  [ -s out/pdf.png ]
}

@test "history: steadiness, density, and the columns a scene added" {
  analyze history d1.hdf d10.hdf -o out > /dev/null
  near "$(field out/history.json runs.1.density_max_rise_percent)" 10 1e-3
  near "$(field out/history.json runs.0.columns.gauge_inlet.last.0)" 10 1e-9
  [ "$(field out/history.json runs.0.steady)" = True ]
  head -1 out/history.csv | grep -q gauge_inlet
  [ -s out/history.png ]
  # What sloshes about nothing has no mean to be so many per cent off.
  /usr/bin/python3 "$MAKE_RUN" slosh.hdf k=1e-9 noise=90 tau=1e-9
  run analyze history slosh.hdf
  [[ "$output" == *" over 100 %"* ]]
}

@test "slice: vectors of the slab only, zoomed" {
  analyze slice d1.hdf --plane y=0.4mm --thickness 0.1mm --zoom 0.3mm,0.2mm,0.6mm,0.6mm -o out > /dev/null
  near "$(field out/slice.json speed_max_m_per_s)" 4.433e-3 1e-3
  /usr/bin/python3 - <<'PY'
import csv
rows = list(csv.DictReader(open("out/slice.csv")))
assert rows and all(0.25e-3 < float(r["x_m"]) < 0.65e-3 and float(r["velocity_z_m_per_s"]) < 0 for r in rows)
PY
  [ -s out/slice.png ]
}

@test "without gnuplot the numbers are there and one warning" {
  mkdir -p bin && ln -sf "$BUILD/bin/analyze" bin/analyze
  run env PATH="$PWD/bin" analyze darcy d1.hdf -o plain
  [ "$status" -eq 0 ]
  [ "$(grep -c 'gnuplot is not installed' <<< "$output")" -eq 1 ]
  [ -s plain/darcy.json ]
  [ -s plain/darcy.csv ]
  [ ! -e plain/darcy.png ]
}

@test "wrong input: message names the file and what to do" {
  run analyze darcy d1-0000.hdf
  [ "$status" -eq 3 ]
  [[ "$output" == *"snapshot"*"OUT.hdf"* ]]
  /usr/bin/python3 "$MAKE_RUN" bare.hdf snapshots=0
  run analyze pdf bare.hdf
  [ "$status" -eq 3 ]
  [[ "$output" == *"bare.hdf"*"no snapshots"* ]]
  cp d1.hdf lost.hdf; cp d1.hdf sub.hdf; mkdir -p far; cp d1.hdf far/
  mkdir -p lost
  run analyze darcy lost/
  [ "$status" -eq 3 ]
  [[ "$output" == *"lost/: is no file; lost.hdf is there" ]]
  run analyze pdf far/d1.hdf
  [ "$status" -ne 0 ]
  [[ "$output" == *"far/d1-0000.hdf: No such file or directory; the files of a run stay together: copy it there" ]]
  /usr/bin/python3 "$MAKE_RUN" still.hdf i=0 k=0 driving=0
  run analyze darcy still.hdf
  [ "$status" -eq 3 ]
  [[ "$output" == *"still.hdf"*"driving force"* ]]
}

@test "pdf: of water that no force drives round, the mean is rounding: nothing is normalised" {
  /usr/bin/python3 "$MAKE_RUN" undriven.hdf
  /usr/bin/python3 - << 'PY'
import h5py
with h5py.File("undriven-0000.hdf", "r+") as f:
    v = f["/VTKHDF/PointData/velocity"]
    v[...] -= v[...].mean(axis=0) * (1 - 1e-10)
PY
  run analyze pdf undriven.hdf
  [ "$status" -eq 3 ]
  [[ "$output" == *"undriven.hdf"*"rounding alone"*"no velocity to normalise"* ]]
}

@test "converge: limit, order and index of runs at three spacings" {
  # k = 1e-3 (1 + 4 (n/20)^-2): order 2, limit 1e-3
  /usr/bin/python3 "$MAKE_RUN" c20.hdf n=20 spacing=4e-5 k=1.04e-3 method=stokes k_error=1e-6 wall_time=1 -- \
    c40.hdf n=40 spacing=2e-5 k=1.01e-3 method=stokes k_error=1e-6 wall_time=9 -- \
    c80.hdf n=80 spacing=1e-5 k=1.0025e-3 method=stokes k_error=1e-6 wall_time=80 snapshots=0
  analyze converge c80.hdf c20.hdf c40.hdf -o out > /dev/null
  near "$(field out/converge.json k_m_per_s)" 1e-3 1e-6
  near "$(field out/converge.json observed_order)" 2 1e-4
  near "$(field out/converge.json grid_convergence_index)" 0.003117 0.01
  [ "$(field out/converge.json order_credible)" = True ]
  [ -s out/converge.png ]
  /usr/bin/python3 "$MAKE_RUN" c10.hdf n=10 spacing=8e-5 k=0.9e-3 method=stokes k_error=1e-6
  run analyze converge c80.hdf c20.hdf c10.hdf
  [ "$status" -eq 0 ]
  [[ "$output" == *"monoton"* ]]
  run analyze converge c20.hdf d1.hdf
  [ "$status" -eq 3 ]
  run analyze converge d1.hdf d5.hdf
  [ "$status" -eq 3 ]
  [[ "$output" == *"same spacing"* ]]
}

# The page's own copy of the numbers, or its text.
page_data() { /usr/bin/python3 -c "import json, sys; sys.path.insert(0, sys.argv[2]); import page; print(json.dumps(page.read(sys.argv[1])))" "$1" "$BATS_TEST_DIRNAME"; }

# bats test_tags=long
@test "converge, report: spacings too near each other tell nothing; a run's own lattices do" {
  /usr/bin/python3 "$MAKE_RUN" near1.hdf n=40 spacing=2e-5 k=1.3e-3 method=stokes model= levels=1 resolution=0.2 -- \
    near2.hdf n=36 spacing=2.2222222e-5 k=1.301e-3 method=stokes model= levels=1 resolution=0.25
  analyze converge near1.hdf near2.hdf > near.txt 2> said.txt
  grep -q "too near each other" said.txt
  grep -q "TOO NEAR" near.txt
  grep -q "near1 alone tells more, by its own lattices" near.txt
  analyze report near1.hdf near2.hdf -o near.html -q
  absent -q "Richardson extrapolation; the error holds" <(page near.html)
  said near.html -q "From the lattices of this run"
  # Without lattices of their own the finest stands, and its error is all of it.
  /usr/bin/python3 "$MAKE_RUN" $(for n in 1 2; do echo bare$n.hdf n=$((44 - 4 * n)) spacing=$((2000 + 222 * (n - 1)))e-8 k=1.3${n}e-3 method=stokes model= --; done)
  analyze converge bare1.hdf bare2.hdf --json 2> /dev/null > bare.json
  /usr/bin/python3 -c 'import json
s = json.load(open("bare.json"))["series"][0]
assert s["k_relative_error"] >= 1 and not s["extrapolated"] and abs(s["k_m_per_s"] / 1.31e-3 - 1) < 1e-6, s'
  analyze report bare1.hdf bare2.hdf -o bare.html -q 2> /dev/null
  said bare.html -q "too near each other to tell the error of the resolution"
}

@test "report: one self-contained page whose numbers are those of the JSON" {
  analyze report d1.hdf d5.hdf d10.hdf -o page.html > /dev/null
  [ "$(stat -c %s page.html)" -lt 3000000 ]
  absent -qE '(src|href)="?(https?:)?//|<link|@import' page.html
  page_data page.html > page.json
  analyze darcy d1.hdf d5.hdf d10.hdf --json > same.json
  /usr/bin/python3 - <<'PY'
import json
page, alone = json.load(open("page.json")), json.load(open("same.json"))
assert page["darcy"] == alone
for part in ("darcy", "history", "pdf", "slice"):
    assert part in page, part
PY
  # One block of data, and nothing of it in the markup.
  [ "$(grep -o 'type="application/json"' page.html | wc -l)" -eq 1 ]
  absent -q "dense-1G" <(sed '/id="data"/d' page.html)
  page page.html '[s["name"] for s in page["sections"]] == ["darcy", "pdf", "history"]' \
    'abs(page["verdict"][0]["k_m_per_s"] / 1.4981e-3 - 1) < 1e-3' '{"plane", "flow"} <= set(page["pictures"])' \
    '[r["effects"]["state"] for r in page["runs"]] == 3 * [["on", "off"]]' 'page["methods"]["text"].startswith("Flow was computed")'
}

# bats test_tags=long
@test "report: of several spacings and gradients the head is the k that is known best" {
  /usr/bin/python3 "$MAKE_RUN" $(for i in 1 5; do
    echo coarse$i.hdf n=20 i=$i spacing=4e-5 k=1.5e-3 method=stokes hash=0x20 k_error=.03 --
    echo fine$i.hdf n=40 i=$i spacing=2e-5 k=1.0e-3 method=stokes hash=0x40 k_error=.01 --
    echo another$i.hdf n=30 i=$i spacing=2e-5 k=2.0e-3 method=stokes hash=0x60 k_error=.001 --
  done)
  analyze report coarse1.hdf coarse5.hdf fine1.hdf fine5.hdf another1.hdf another5.hdf --mix -o best.html --json > best.json
  /usr/bin/python3 - <<'PY'
import json
heads = [round(v["k_m_per_s"], 6) for v in json.load(open("best.json"))["verdict"]]
assert heads == [1e-3, 1.5e-3, 2e-3], heads  # another body is not the first one's, however well known
PY
}

@test "report: nothing from a file is taken for HTML" {
  /usr/bin/python3 "$MAKE_RUN" evil.hdf 'name=</script><script>alert(1)</script>' 'model=a"onload="x.hdf' 'status=<b>&'
  analyze report evil.hdf -o evil.html > /dev/null
  absent -q '<script>alert' evil.html
  absent -q '"onload="' evil.html
  page evil.html 'page["history"]["runs"][0]["name"] == "</script><script>alert(1)</script>"'
}

@test "report and darcy: the model beside the run gives the specimen and its share of the error" {
  mkdir -p beside && /usr/bin/python3 "$MAKE_RUN" beside/run.hdf model=elsewhere/sand.hdf
  /usr/bin/python3 - <<'PY'
import h5py, numpy as np
with h5py.File("beside/sand.hdf", "w") as f:
    rng = np.random.default_rng(1)
    f["/model/solid"] = (rng.random((6, 8, 9)) < 0.6).astype(np.uint8)
    a = f["/model"].attrs
    a["spacing"], a["void_ratio"], a["void_ratio_measured"], a["threshold"] = [1e-5] * 3, 0.75, 0.74, 57.0
    t = np.arange(0, 120.0)
    f["/calibration/threshold"], f["/calibration/void_ratio"] = t, 0.013 * t
    f["/calibration/histogram"] = np.exp(-((t - 100) / 9) ** 2)
    f["/calibration/slice"] = (100 * rng.random((20, 30))).astype(np.float32)
    c = f["/calibration"].attrs
    c["pore_peak"], c["grain_peak"], c["threshold_original"], c["dthreshold_dvoid_ratio"] = 20.0, 100.0, 60.0, 70.0
    f["/quality/local_thickness"] = [0.125, 0.5, 0.375] + [0.0] * 61
    f["/quality/window"], f["/quality/windows"] = [4e-5, 8e-5], [5.0, 1.0]
    f["/quality/void_ratio"], f["/quality/void_ratio_deviation"] = [0.8, 0.8], [0.2, 0.0]
PY
  analyze report beside/run.hdf -o specimen.html
  page specimen.html 'page["models"][0]["quality"]["local_thickness"][:3] == [0.125, 0.5, 0.375]' \
    'page["models"][0]["model"]["attributes"]["void_ratio_measured"] == 0.74' \
    'page["models"][0]["calibration"]["threshold"][:2] == [0, 1] and "distance" not in page["pictures"]["slice"]'
  page_data specimen.html > specimen.json
  # Kozeny-Carman: d ln k/de = 3/0.75 - 1/1.75
  near "$(field specimen.json darcy.dlnk_dvoid_ratio)" 3.428571 1e-5
  near "$(field specimen.json darcy.error_budget.void_ratio)" 0.03428571 1e-5
  near "$(field specimen.json darcy.dlnk_dthreshold)" 0.0489796 1e-5
}

@test "report: runs without snapshots, without a force and of several spacings" {
  /usr/bin/python3 "$MAKE_RUN" nosnap.hdf snapshots=0
  run analyze report nosnap.hdf -o nosnap.html
  [ "$status" -eq 0 ]
  [[ "$output" == *"no velocity distribution"* ]]
  /usr/bin/python3 "$MAKE_RUN" calm.hdf i=0 k=0 driving=0
  run analyze report calm.hdf -o calm.html
  [ "$status" -eq 0 ]
  page calm.html '"there is no permeability" in page["headline"]["sentence"]'
  /usr/bin/python3 "$MAKE_RUN" tank.hdf method=isph tau=10 end=0.01 gauge=1
  analyze report tank.hdf -o tank.html
  page tank.html '"there is no permeability" in page["headline"]["sentence"]'
  /usr/bin/python3 "$MAKE_RUN" r20.hdf n=20 spacing=4e-5 k=1.04e-3 method=stokes -- \
    r40.hdf n=40 spacing=2e-5 k=1.01e-3 method=stokes
  analyze report r20.hdf r40.hdf -o conv.html > /dev/null
  said conv.html -q "Extrapolated to spacing 0"
  run analyze report d1.hdf
  [ "$status" -eq 2 ]
}

@test "report: renders in a browser without an error and draws in three dimensions" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  analyze report d1.hdf d10.hdf -o page.html > /dev/null
  chromium --headless --no-sandbox --disable-quic --no-first-run --disable-background-networking \
    --disable-component-update --disable-sync --user-data-dir="$PWD/profile" --use-angle=swiftshader \
    --enable-unsafe-swiftshader --virtual-time-budget=20000 --enable-logging=stderr \
    --dump-dom "file://$PWD/page.html" > dom.html 2> browser.log
  absent -iE "CONSOLE.*(error|exception|refused|three-dimensional)" browser.log
  [ "$(sed -n 's/.*data-drawn="\([0-9]*\)".*/\1/p' dom.html)" -gt 50 ] # pixels of the middle row
  [ "$(grep -o '<canvas' dom.html | wc -l)" -ge 10 ] # two a curve, a map, and the view
  grep -q '<var>k</var> = 0\.1[0-9]* cm/s' dom.html # written by the script
  absent -q ">undefined<\|>NaN<" dom.html
}

@test "converge: of a run of several lattices the finest's own k counts, not what they say of the limit" {
  for n in 20 40; do
    /usr/bin/python3 "$MAKE_RUN" many$n.hdf n=$n spacing=$((80 / n))e-5 k=1.0${n}e-3 method=stokes model= levels=1
  done
  analyze converge many20.hdf many40.hdf --json > many.json
  /usr/bin/python3 -c 'import json
rows = json.load(open("many.json"))["series"][0]["runs"]
assert len(rows) == 2 and all(abs(r["k_m_per_s"] / (1.02 * k) - 1) < 1e-6 for r, k in zip(rows, (1.040e-3, 1.020e-3))), rows'
  analyze converge many20.hdf many40.hdf | grep -q "the finest alone"
}

@test "converge, report: a run that knows k better by its own lattices than two spacings do is not joined to worse" {
  for n in 20 40; do
    /usr/bin/python3 "$MAKE_RUN" own$n.hdf n=$n spacing=$((80 / n))e-5 k=1.${n}e-3 method=stokes model= levels=1 resolution=0.05
  done
  analyze converge own20.hdf own40.hdf > own.txt
  analyze converge own20.hdf own40.hdf --json > own.json
  analyze darcy own40.hdf --json > own40.json
  analyze report own20.hdf own40.hdf -o own.html
  grep -q "alone tells more, by its own lattices: k = " own.txt
  said own.html -q "From the lattices of this run"
  absent -q "Richardson extrapolation; the error holds" <(page own.html)
  absent -q "extrapolated over the spacings of the runs" <(page own.html)
  /usr/bin/python3 -c 'import json
series, alone = json.load(open("own.json"))["series"][0], json.load(open("own40.json"))
assert series["better_run"]["path"] == "own40.hdf", series
assert abs(series["better_run"]["k_relative_error"] / alone["k_relative_error"] - 1) < 1e-6, (series, alone)
assert series["better_run"]["k_relative_error"] < series["k_relative_error"], series'
}

@test "numbers have the digits that their error leaves sense to, and no exponent below a million" {
  /usr/bin/python3 "$MAKE_RUN" wide.hdf k=0.397 levels=3 resolution=0.05 method=stokes name=wide
  analyze darcy wide.hdf > wide.txt
  # Of 41000 darcy the error is some 2000: the last two digits say nothing.
  grep -Eq '= [0-9]{3}00 \+- [0-9]{2}00 darcy' wide.txt || { cat wide.txt; false; }
}

@test "Methods tell the Reynolds number of a creeping flow without its inertia, where it counts" {
  /usr/bin/python3 "$MAKE_RUN" fast.hdf method=stokes k=1e-3 model=
  /usr/bin/python3 -c 'import h5py; h5py.File("fast.hdf", "a")["run"].attrs["reynolds"] = 24.1'
  analyze report fast.hdf -o fast.html --quiet
  said fast.html -q "Inertia is left out, at a Reynolds number of 24\."
  /usr/bin/python3 -c 'import h5py; h5py.File("fast.hdf", "a")["run"].attrs["reynolds"] = 0.01'
  analyze report fast.hdf -o slow.html --quiet
  absent "Inertia is left out" <(page slow.html)
}
