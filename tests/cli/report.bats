#!/usr/bin/env bats
# The report's page: what it says is so, and what it shows can be seen.

# SIZE OPTIONS...: of the first slices of the sample; what is said of it does not hang on how many there are.
part() { ct2model build part --voxel-size 8.745um -q --size "$@" > /dev/null; }
labels() { ct2model build labels.npy --segmented 0 --voxel-size 70um -q "$@" > /dev/null; }
# NAME...: models NAME.hdf, their runs run-NAME.hdf and pages NAME.html, made when a test first asks for them.
made() {
  local name
  for name in "$@"; do
    [ ! -e "$name.html" ] || continue
    case $name in
      matched) sample_model 16x16x7 matched.hdf ;;
      fine) sample_model 32x32x14 fine.hdf ;;
      given) part 16x16x3 --threshold 62 -o given.hdf ;;
      given-measured) part 16x16x3 --threshold=62 --void-ratio 0.725 -o given-measured.hdf ;;
      otsu) part 16x16x3 --threshold otsu --mirror none -o otsu.hdf ;;
      plain)
        /usr/bin/python3 - << END
import h5py, numpy as np
solid = h5py.File("matched.hdf")["model/solid"][()]
with h5py.File("plain.hdf", "w") as f:
    f["model/solid"] = solid
    f["model"].attrs["spacing"] = [7e-5] * 3
END
        ;;
      labels) labels --mirror none -o labels.hdf ;;
      mirrored | closed) labels --sides $name -o $name.hdf ;;
    esac
    sphsolve run scene.cfg --set model.file=$name.hdf -o run-$name -q > /dev/null
    analyze report run-$name.hdf -o $name.html -q > /dev/null
  done
}

bats_require_minimum_version 1.5.0
load programs
setup_file() {
  programs_setup
  cat > scene.cfg << END
scene  = { name = "sand"; };
model  = { file = "matched.hdf"; };
fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );
force  = { body_acceleration = ["0", "0", "-9.80665 m/s^2"]; };
END
  made matched
  mkdir part && cp "$ROOT"/data-samples/small/slice_00{0,1}?.png "$ROOT"/data-samples/small/slice_002{0,1,2,3}.png part
  /usr/bin/python3 -c 'import h5py, numpy; numpy.save("labels.npy", h5py.File("matched.hdf")["model/solid"][()] * 255)'
}

sentences() { /usr/bin/python3 "$ROOT/tests/cli/report_sentences.py" "$@"; }
data() { /usr/bin/python3 -c 'import json, re, sys
page = json.loads(re.search(r"id=\"data\">(.*?)</script>", open(sys.argv[1]).read(), re.S)[1])
assert eval(sys.argv[2]), page["verdict"]' "$@"; }

@test "sentences about specimen and method are what the provenance says: of greys, and of labels" {
  made labels
  for model in matched labels; do sentences $model.html run-$model.hdf; done
  grep -q "was set so that the model has the void ratio measured" matched.html
  grep -q "that was segmented before" labels.html
  run ! grep -qE "was set so that|gives the measured void ratio" labels.html
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" made.hdf method=wcsph wall=adami model=
  analyze report made.hdf -o made.html -q > /dev/null
  sentences made.html made.hdf
}

# bats test_tags=long
@test "every sentence about specimen and method is what the provenance says" {
  made given given-measured otsu plain labels mirrored closed
  for model in given given-measured otsu plain labels mirrored closed; do sentences $model.html run-$model.hdf; done
  grep -q "; it is mirrored along x, y and z\." mirrored.html
  grep -q "; it is mirrored along z; its sides are walls\." closed.html
  for model in given given-measured otsu plain labels; do ! grep -qE "was set so that|gives the measured void ratio" $model.html; done
  # A model that has gone, other methods and walls, several runs.
  mkdir -p alone && cp run-matched.hdf run-matched-0000.hdf alone
  (cd alone && analyze report run-matched.hdf -o page.html -q > /dev/null 2>&1 && sentences page.html run-matched.hdf)
  for words in "method=wcsph wall=frozen" "method=isph wall=slip" "method=stokes"; do
    /usr/bin/python3 "$ROOT/tests/cli/make_run.py" made.hdf $words model=
    analyze report made.hdf -o made.html -q > /dev/null
    sentences made.html made.hdf
  done
  for i in 1 5; do /usr/bin/python3 "$ROOT/tests/cli/make_run.py" i$i.hdf i=$i model=; done
  analyze report i1.hdf i5.hdf -o i.html -q > /dev/null
  sentences i.html i1.hdf i5.hdf
}

@test "of a model that was changed or replaced since the run nothing is taken, and all say so" {
  mkdir -p replaced && cp run-matched.hdf run-matched-0000.hdf replaced && made labels && cp labels.hdf replaced/matched.hdf
  cd replaced
  analyze report run-matched.hdf -o page.html 2> said
  [ "$(grep -c "not the one that was run" said)" -eq 1 ]
  grep -q "changed or replaced" page.html
  ! grep -qE "Kozeny-Carman</th>|whose grey threshold|Void ratio</th>" page.html
  data page.html 'page["verdict"][0].get("formulas") is None'
  analyze darcy run-matched.hdf 2> said > out
  grep -q "not the one that was run" said
  # The one that was run is taken, wherever of the places it lies.
  mkdir -p sub && cp run-matched.hdf run-matched-0000.hdf ../matched.hdf sub
  analyze report sub/run-matched.hdf -o page.html 2> said
  ! grep -q "not the one that was run" said
  grep -q "whose grey threshold" page.html
}

@test "a model that nothing leads through: k is 0, the page says why it shows no velocity, and no nan" {
  /usr/bin/python3 -c 'import numpy as np
a = np.full((16, 16, 16), 255, np.uint8)
a[2:14, 3:8, 3:8] = 0
np.save("blocked.npy", a)'
  ct2model build blocked.npy --segmented 0 --voxel-size 2um -q -o blocked.hdf > /dev/null 2>&1
  for method in wcsph stokes; do # the last is read on
    sphsolve run scene.cfg --set model.file=blocked.hdf --set scene.method=$method --force -o run-blocked -q > /dev/null 2>&1
    analyze report run-blocked.hdf -o blocked.html --force -q > /dev/null
    grep -q "there is no velocity to show" blocked.html
    grep -q "<var>k</var> = 0 cm/s" blocked.html
    grep -q "<td>ct2model build blocked.npy" blocked.html # where the model comes from
    run ! grep -qE "For orientation|What the error is made of|has not settled|streamlines of" blocked.html
  done
  data blocked.html '(lambda v: v["k_m_per_s"] == 0 and "nothing leads through" in v["good_for"])(page["verdict"][0])'
  sed 's#<script.*##;/Dygraph=t/d;/NaN/d' blocked.html > text
  run ! grep -qiw -- "-\?nan" text
  analyze darcy run-blocked.hdf > said
  grep -q "k = 0: no pore leads through" said
  grep -q "^Verdict: nothing leads through" said
  run ! grep -qiw -- "-\?nan" said
  run -3 analyze converge run-blocked.hdf run-matched.hdf
  run -3 analyze pdf run-blocked.hdf
}

# bats test_tags=long
@test "a page that claims a match that was not made is found" {
  made given
  sed 's/at a given grey threshold of/whose grey threshold was set to match/' given.html > liar.html
  run sentences liar.html run-given.hdf
  [ "$status" -eq 1 ]
  [[ "$output" == *"not so"* ]]
  sed 's/>The slice at the threshold of the model</>The slice at the threshold that gives the measured void ratio</' given.html > liar.html
  run sentences liar.html run-given.hdf
  [ "$status" -eq 1 ]
}

# The calibration is drawn beyond the model's void ratio, measured or not.
drawn_beyond() {
  data $1.html '(lambda c: c["void_ratio_shown"] > 2 * min(zip((abs(t - c["threshold_chosen"]) for t in c["threshold"]), c["void_ratio"]))[1])(page["calibration"])'
}
class_of_interval() {
  for page in "$@"; do
    data $page.html '(lambda v: (" to " in v["class_din"]) == any(v["k_low_m_per_s"] < bound <= v["k_high_m_per_s"] for bound in (1e-8, 1e-6, 1e-4, 1e-2)))(page["verdict"][0])'
  done
}

# bats test_tags=long
@test "the class is that of the interval, the calibration is drawn to its end: of models given, by Otsu, of labels" {
  made given otsu labels
  drawn_beyond otsu
  class_of_interval given otsu labels
}

@test "a verdict first: k with its interval, its class, and what other formulas say" {
  for n in 20 40; do
    /usr/bin/python3 "$ROOT/tests/cli/make_run.py" r$n.hdf n=$n spacing=$((80 / n))e-5 k=1.0${n}e-3 method=stokes model=
  done
  analyze report r20.hdf r40.hdf -o levels.html -q > /dev/null
  # Two spacings are one result, with one card.
  data levels.html 'len(page["verdict"]) == 1 and "Extrapolated" in page["verdict"][0]["name"]'
  [ "$(grep -c 'class="card"' levels.html)" -eq 1 ]
  data matched.html '(lambda v: v["k_low_m_per_s"] < v["k_m_per_s"] < v["k_high_m_per_s"])(page["verdict"][0])'
  # A bar of 25 to 100 % is said to be its class at best; two classes are named where the interval holds a bound of them.
  made fine
  data fine.html '"its class and its order of magnitude" in page["verdict"][0]["good_for"]'
  # What lessens resolution, and what lessens the largest of the other shares, whichever that is; where these alone are
  # just below what is wanted, smaller voxels are said to be no more than enough.
  data matched.html '(lambda v, b: (lambda remedy, rest: (remedy + "; a model with smaller voxels alone takes it only just below"
    if 0.97 * 0.05 <= rest < 0.05 else "a model with smaller voxels, and " + remedy) in v["advice"])(
    {"scan": "a finer or sharper scan is needed", "sides": "a larger sample is needed"}[max(("scan", "sides", "void_ratio"), key=b.get)],
    (b["scan"] ** 2 + b["sides"] ** 2 + b["void_ratio"] ** 2) ** 0.5))(page["verdict"][0], page["verdict"][0]["error_budget"])'
  drawn_beyond matched
  made plain
  data plain.html '"a model with voxels of about" in page["verdict"][0]["advice"]'
  data plain.html 'page["verdict"][0]["k_low_m_per_s"] == 0 and "do not publish" in page["verdict"][0]["good_for"]'
  class_of_interval matched plain levels
  # K = n^3 / (5 S^2) of the model's own numbers; S as the file knows it.
  /usr/bin/python3 - << 'END'
import h5py, json, math, re
page = json.loads(re.search(r'id="data">(.*?)</script>', open("matched.html").read(), re.S)[1])
model = h5py.File("matched.hdf")["model"].attrs
n, s = model["porosity"], model["specific_surface"]
d = model["specific_surface_error"] * 1e-3
decimals = max(0, 1 - math.floor(math.log10(d)))
known = f"{1e-3 * s:.{decimals}f} &plusmn; {d:.{decimals}f} 1/mm"
assert f"<tr><th>Specific surface</th><td>{known}" in open("matched.html").read(), known
kozeny = 9.80665e6 * n**3 / (5 * s * s)
assert abs(page["verdict"][0]["formulas"]["kozeny_carman"] / kozeny - 1) < 1e-9
d = 6 * (1 - n) / s
assert abs(page["verdict"][0]["formulas"]["hazen"] / (9.80665e6 * 6e-4 * (1 + 10 * (n - 0.26)) * d * d) - 1) < 1e-9
END
}

# bats test_tags=long
@test "results of one name, of runs that differ in their fluid, are told apart by fluid and run" {
  sphsolve run scene.cfg --set "fluids[0].viscosity=2e-3 Pa s" -o run-thick -q > /dev/null
  analyze report run-matched.hdf run-thick.hdf -o fluids.html -q > /dev/null
  data fluids.html 'sorted(r["name"].rsplit(", ", 1)[1] for r in page["verdict"]) == ["run-matched.hdf", "run-thick.hdf"]'
  data fluids.html 'sorted(r["name"].split(", ")[-3] for r in page["verdict"]) == ["0.001 Pa s", "0.002 Pa s"]'
  data matched.html 'page["verdict"][0]["name"].startswith("matched (") and ".hdf" not in page["verdict"][0]["name"]'
}

# bats test_tags=long
@test "a long body is drawn in its proportions" {
  /usr/bin/python3 - << 'END'
import numpy as np
z, y, x = np.indices((150, 12, 12))
np.save("long.npy", np.where((x - 5.5) ** 2 + (y - 5.5) ** 2 < 16, 0, 255).astype(np.uint8))
END
  ct2model build long.npy --segmented 0 --voxel-size 10um --mirror none -q -o long.hdf > /dev/null
  sphsolve run scene.cfg --set model.file=long.hdf -o run-long -q > /dev/null
  analyze report run-long.hdf -o long.html -q > /dev/null
  /usr/bin/python3 - << 'END'
import base64, json, re
import numpy as np
flow = json.loads(re.search(r'id="flow-data">(.*?)</script>', open("long.html").read(), re.S)[1])
size, cell = np.array(flow["size"]), np.array(flow["cell"])
assert cell.max() < 1.1 * cell.min(), (size, cell)
assert np.allclose(size * cell, (1.2e-4, 1.2e-4, 1.5e-3), rtol=1e-5)
points = np.frombuffer(base64.b64decode(flow["points"]), "<u2").reshape(-1, 4)[:, :3] / 500
assert (points <= size).all() and np.ptp(points, axis=0)[2] > 0.8 * size[2], (points.max(axis=0), size)
END
}

@test "a line through one point and a record of one row wait behind a fold; effects that are off, too" {
  /usr/bin/python3 - << 'END'
import re
page = open("matched.html").read()
for part in ("darcy", "history"):
    section = re.search(f'<section id="{part}">(.*?)</section>', page, re.S)[1]
    assert "<details>" in section and section.index("<details>") < section.index("<figure>"), part
effects = re.search('<section id="effects">(.*?)</section>', page, re.S)[1]
open_part, fold = effects.split("<details>")
assert 'class="off"' not in open_part and 'class="on"' in open_part and 'class="off"' in fold
for anchor in re.findall(r'<a href="#(\w+)"', page):
    assert f'id="{anchor}"' in page, anchor
END
}

@test "pictures: outlines lie on the walls, half of the flow is half of it, PNGs are sound" {
  made fine
  /usr/bin/python3 "$ROOT/tests/cli/report_pictures.py" fine.html run-fine.hdf fine.hdf run-fine-0000.hdf
}

# bats test_tags=long
@test "pictures without a model; numbers of colour bars stay short" {
  # Without a model the lattice's own walls do.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" made.hdf model= pressure=1
  analyze report made.hdf -o made.html -q > /dev/null
  [ "$(grep -o 'class="map"' made.html | wc -l)" -eq 2 ]
  # A gas moves by millipascals: the colour bar's numbers stay short enough for their place.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" gas.hdf model= pressure=5e-6
  analyze report gas.hdf -o gas.html -q > /dev/null
  grep -q '">mPa</text>' gas.html
  for pressure in 6.4e-4 3.4; do
    /usr/bin/python3 "$ROOT/tests/cli/make_run.py" other-$pressure.hdf model= pressure=$pressure
    analyze report other-$pressure.hdf -o other-$pressure.html -q > /dev/null
  done
  /usr/bin/python3 -c '
import html, re, sys
for page in sys.argv[1:]:
    for svg in re.findall("<svg class=.map.*?</svg>", open(page).read(), re.S):
        numbers = [html.unescape(t) for t in re.findall("<text [^>]*>([^<]*)</text>", svg)][1:6]
        assert len(numbers) == 5 and all(len(t) <= 7 and "e" not in t for t in numbers), (page, numbers)' \
    gas.html other-6.4e-4.html other-3.4.html
}

# bats test_tags=long
@test "a TMPDIR that is not there costs the page no picture" {
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" placed.hdf method=stokes k=1e-3 model= levels=1
  TMPDIR=/nothere analyze report placed.hdf -o placed.html > said 2>&1
  run ! grep nothere said
  analyze report placed.hdf -o usual.html -q > /dev/null
  [ "$(grep -o '<svg' placed.html | wc -l)" -eq "$(grep -o '<svg' usual.html | wc -l)" ]
}

@test "a run that was interrupted: the page's first lines say so" {
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" stopped.hdf method=stokes k=1e-3 model= status=interrupted
  analyze report stopped.hdf -o stopped.html -q > /dev/null
  grep -q '<p>1 run, interrupted</p>' stopped.html
  grep -q '<p class="verdict">.*The run was interrupted: sphsolve run --resume goes on' stopped.html
  analyze darcy stopped.hdf | grep -q '^Verdict: .*The run was interrupted'
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" ended.hdf method=stokes k=1e-3 model=
  analyze report ended.hdf -o ended.html -q > /dev/null
  # One that drifts so far that there is no k is driven none the less.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" early.hdf k=1e-3 model= tau=1
  analyze report early.hdf -o early.html -q > /dev/null 2>&1
  grep -q 'The flow has not settled, so there is no permeability' early.html
  ! grep -q 'interrupted' <(sed 's/<script.*//' ended.html)
}

# bats test_tags=long
@test "a run without k beside one that has one takes nothing from it: the page is about the latter, in either order" {
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" ended.hdf method=stokes k=1e-3 model=
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" soil.hdf method=isph k=1e-3 model= tau=1 name=soil
  for order in "soil.hdf ended.hdf" "ended.hdf soil.hdf"; do
    analyze report $order --mix -o both.html -q > /dev/null 2>&1
    grep -q '<p class="k"><var>k</var> = 0.1000 cm/s' both.html
    grep -q '<td>soil (isph)</td><td>none: not settled</td>' both.html
    run ! grep -q 'no permeability to give' both.html
  done
}

# bats test_tags=long
@test "a body one voxel wide: its map is the plane along it; names of a narrow map have room" {
  /usr/bin/python3 -c '
import numpy as np
z, x = np.indices((40, 30))
np.save("plate.npy", np.repeat((((z % 20 - 10) ** 2 + (x % 15 - 7) ** 2) < 30).astype(np.uint8)[:, None, :], 1, 1))
np.save("column.npy", np.repeat((((z % 20 - 10) ** 2 + (x % 15 - 7) ** 2) < 30).astype(np.uint8)[:, None, :12], 12, 1))'
  for body in plate:"x across, z up" column:"y across, z up"; do
    name=${body%%:*}
    size=$([ $name = plate ] && echo "--size 30x1x40" || true)
    ct2model build $name.npy --voxel-size 5um --segmented 0 --mirror none $size -o $name.hdf -q 2> /dev/null
    printf '%s\n' "model = { file = \"$name.hdf\"; };" 'fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );' \
      'scene = { name = "body"; method = "stokes"; };' 'force = { body_acceleration = ["0", "0", "-9.80665 m/s^2"]; };' > $name.cfg
    sphsolve run $name.cfg -o $name-run -q > /dev/null 2>&1
    analyze report $name-run.hdf -o $name.html -q > /dev/null 2>&1
    grep -q "${body#*:}" $name.html
  done
  # On a line of their own, below the scale of lengths.
  /usr/bin/python3 -c '
import re
for svg in re.findall("<svg class=.map.*?</svg>", open("column.html").read(), re.S):
    (scale, _), (names, _) = re.findall(r"y=.([\d.]+).[^>]*>([^<]*(?:&#181;m|across)[^<]*)</text>", svg)[-2:]
    assert float(names) >= float(scale) + 22, (scale, names)
    assert float(names) < float(re.search(r"viewBox=.0 0 \d+ (\d+)", svg)[1])'
}

# bats test_tags=long
@test "a run that solved several lattices: its own interval, and k of each against time" {
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" levels.hdf method=stokes k=1e-3 model= levels=1
  analyze report levels.hdf -o levels.html -q > /dev/null
  data levels.html '(lambda v: abs(v["k_low_m_per_s"] / 0.9e-3 - 1) < 1e-9 and abs(v["k_high_m_per_s"] / 1.2e-3 - 1) < 1e-9)(page["verdict"][0])'
  grep -q 'section id="levels"' levels.html
  # Its two sides stay what they are where the error by its parts is the larger of them.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" sided.hdf method=wcsph k=1e-3 model= levels=1 resolution=0.2
  analyze report sided.hdf -o sided.html -q > /dev/null
  data sided.html '(lambda v: abs(v["k_low_m_per_s"] / 0.9e-3 - 1) < 1e-9 and abs(v["k_high_m_per_s"] / 1.2e-3 - 1) < 1e-9)(page["verdict"][0])'
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" one.hdf method=stokes k=1e-3 model=
  analyze report one.hdf -o one.html -q > /dev/null
  ! grep -q 'section id="levels"' one.html
  # Of a run of ours, each estimate with its bar, too.
  /usr/bin/python3 -c '
import base64, re
section = re.search("id=.levels.>.*?base64,([A-Za-z0-9+/=]*)", open("matched.html").read(), re.S)[1]
svg = base64.b64decode(section).decode()
# The names stand below the axis, not among the points; and what is on a map can be read at half its size.
def at(text): return float(re.search(r"translate\([\d.]+,([\d.]+)\)[^<]*(?:<[^>]*>\s*)*" + text, svg)[1])
assert at("estimate so far, resolution alone") > at("Processor time") > 0.6 * 440
page = open("matched.html").read()
maps = re.findall(r"<svg class=.map.[^>]*viewBox=.0 0 (\d+) \d+.[^>]*font-size=.(\d+).", page)
assert len(maps) == 2 and all(float(size) * 374 / float(width) > 9.5 for width, size in maps), maps'
}

# bats test_tags=long
@test "names and shares of bars do not run into each other" {
  /usr/bin/python3 - << 'END'
import re
import h5py, numpy as np
with h5py.File("matched.hdf") as source, h5py.File("bars.hdf", "w") as f:
    for name in ("model", "calibration", "provenance"):
        source.copy(name, f)
    f["quality/local_thickness"] = np.full(64, 1 / 64)
    n = np.arange(1.0, 15)
    f["quality/window"], f["quality/windows"] = 1.2345e-5 * n, 4 * n
    f["quality/void_ratio"], f["quality/void_ratio_deviation"] = 0.7 + 0 * n, 0.1234 / n
END
  mkdir -p bars && cp run-matched.hdf run-matched-0000.hdf bars && cp bars.hdf bars/matched.hdf
  /usr/bin/python3 -c 'import h5py; del h5py.File("bars/run-matched.hdf", "r+")["run"].attrs["model_hash"]' # another file
  (cd bars && analyze report run-matched.hdf -o page.html -q > /dev/null)
  /usr/bin/python3 - << 'END'
import re
charts = re.findall(r'<figure class="bars">(.*?)</svg>', open("bars/page.html").read(), re.S)
assert len(charts) == 2
for chart in charts:
    bars = len(re.findall("<rect", chart))
    texts = [(float(x), float(y), t) for x, y, t in re.findall(r'<text x="([\d.]+)" y="([\d.]+)">(.*?)</text>', chart)]
    names = sorted((x, t) for x, y, t in texts if y > 120)
    shares = sorted((x, t) for x, y, t in texts if y < 120)
    # Nor does a share lie over a taller neighbour: it is no wider than its bar.
    widths = [float(w) for w in re.findall(r'<rect[^>]*width="([\d.]+)"', chart)]
    assert len(shares) == bars and all(5.5 * len(t) <= widths[0] + 1 for x, t in shares), (widths[0], shares)
    assert bars >= 14 and len(names) >= 5
    for row in (names, shares):
        for (a, left), (b, right) in zip(row, row[1:]):
            assert b - a >= 5.5 * (len(left) + len(right)) / 2, (left, right, b - a)
END
}

@test "on a telephone nothing is wider than the screen" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  narrow matched
}

# bats test_tags=long
@test "on a telephone nothing is wider than the screen: a tensor, a flow net" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  sphsolve run scene.cfg --set model.file=matched.hdf -o run-tensor --tensor -q > /dev/null
  analyze report run-tensor.hdf -o tensor.html -q > /dev/null
  sphsolve run "$ROOT/data-samples/scenes/excavation.cfg" --set scene.end_time='"2 s"' -o trench -q > /dev/null
  analyze report trench.hdf -o trench.html -q > /dev/null
  grep -q 'class="tensor"' tensor.html
  grep -q "by the flow net" trench.html
  narrow tensor trench
  # All that a run of isph records would be screens of charts: the last page's wait behind a fold.
  /usr/bin/python3 - << 'END'
import re
section = re.search('<section id="history">(.*?)</section>', open("dom.html").read(), re.S)[1]
open_part, fold = section.split("<details>")
assert open_part.count('class="plot"') <= 3 < fold.count('class="plot"'), (open_part.count('class="plot"'), fold.count('class="plot"'))
assert re.search("<summary>[0-9]+ more: [^<]*particles", fold), fold[:300]
END
}

# Chromium has no window under 500 pixels: each page is held to 390, and its widest element is measured.
narrow() {
  for page in "$@"; do
    sed 's#</head>#<style>html { width: 390px; }</style></head>#;s#</body>#<script>setTimeout(() => {\
      const inside = e => e \&\& (["auto", "scroll", "hidden"].includes(getComputedStyle(e).overflowX) || inside(e.parentElement));\
      const wide = [...document.body.querySelectorAll("*")].filter(e => (!inside(e.parentElement) || e.closest(".tensor")) \&\&\
        e.getBoundingClientRect().right > 391).map(e => e.tagName + "." + e.className);\
      document.title = "wide:" + wide.join(",") + ";"; }, 3000)</script></body>#' $page.html > narrow.html
    timeout 120 chromium --headless --no-sandbox --disable-quic --no-first-run --disable-background-networking \
      --disable-component-update --disable-sync --user-data-dir="$PWD/profile" --use-angle=swiftshader --window-size=500,900 \
      --enable-unsafe-swiftshader --virtual-time-budget=20000 --dump-dom "file://$PWD/narrow.html" > dom.html 2> /dev/null
    grep -o "<title>[^<]*" dom.html
    grep -q "<title>wide:;" dom.html || { echo "$page"; false; }
  done
}
