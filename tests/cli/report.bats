#!/usr/bin/env bats
# The report's page: what it says is so, and what it shows can be seen.

# SIZE OPTIONS...: of the first slices of the sample; what is said of it does not hang on how many there are.
part() { ct2model build part --voxel-size 8.745um --crop 0,0,0,64,64,12 -q --size "$@" > /dev/null; }
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

@test "sentences about specimen and method are what the provenance says: of greys, and of labels" {
  made labels given
  for model in matched labels given; do sentences $model.html run-$model.hdf; done
  said given.html -q "was taken out of the surface"
  said matched.html -q "was set so that the model has the void ratio measured"
  said labels.html -q "that was segmented before"
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" made.hdf method=wcsph wall=adami model=
  analyze report made.hdf -o made.html -q > /dev/null
  sentences made.html made.hdf
}

# bats test_tags=long
@test "every sentence about specimen and method is what the provenance says" {
  made given given-measured otsu plain labels mirrored closed
  for model in given given-measured otsu plain mirrored closed; do sentences $model.html run-$model.hdf; done
  said mirrored.html -q "; it is mirrored along x, y and z\."
  said closed.html -q "; it is mirrored along z; its sides are walls\."
  for model in given given-measured otsu plain labels; do page $model.html '"was set so that" not in page["methods"]["text"]' 'page["model"]["rule"] != "matched"'; done
  # A model that has gone, other methods and walls, several runs.
  mkdir -p alone && cp run-matched.hdf run-matched-0000.hdf alone
  (cd alone && analyze report run-matched.hdf -o page.html -q > /dev/null 2>&1 && sentences page.html run-matched.hdf)
  for words in "method=wcsph wall=adami" "method=wcsph wall=frozen" "method=isph wall=slip" "method=stokes"; do
    /usr/bin/python3 "$ROOT/tests/cli/make_run.py" made.hdf $words model=
    analyze report made.hdf -o made.html -q > /dev/null
    sentences made.html made.hdf
  done
  for i in 1 5; do /usr/bin/python3 "$ROOT/tests/cli/make_run.py" i$i.hdf i=$i model=; done
  analyze report i1.hdf i5.hdf -o i.html -q > /dev/null
  sentences i.html i1.hdf i5.hdf
}

@test "a synthetic scan is called synthetic" {
  cp -r part described && cp "$ROOT/data-samples/small/sand.json" described
  ct2model build described --voxel-size 8.745um --crop 0,0,0,64,64,12 -q --size 16x16x3 --threshold 62 --blur keep -o described.hdf > /dev/null
  sphsolve run scene.cfg --set model.file=described.hdf -o run-described -q > /dev/null
  analyze report run-described.hdf -o described.html -q > /dev/null
  page described.html 'page["model"]["origin"].startswith("synthetic")'
  made given
  page given.html 'page["model"]["origin"] == ""'
}

@test "of a model that was changed or replaced since the run nothing is taken, and all say so" {
  mkdir -p replaced && cp run-matched.hdf run-matched-0000.hdf replaced && made labels && cp labels.hdf replaced/matched.hdf
  cd replaced
  analyze report run-matched.hdf -o page.html 2> said
  [ "$(grep -c "not the one that was run" said)" -eq 1 ]
  said page.html -q "changed or replaced"
  page page.html 'page["model"]["state"] == "changed" and not page["models"] and "slice" not in page["pictures"]' \
    'page["verdict"][0].get("formulas") is None'
  analyze darcy run-matched.hdf 2> said > out
  grep -q "not the one that was run" said
  # The one that was run is taken, wherever of the places it lies.
  mkdir -p sub && cp run-matched.hdf run-matched-0000.hdf ../matched.hdf sub
  analyze report sub/run-matched.hdf -o page.html 2> said
  ! grep -q "not the one that was run" said
  said page.html -q "whose grey threshold"
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
    page blocked.html 'page["verdict"][0]["k_m_per_s"] == 0 and "plane" not in page["pictures"] and page["pictures"]["flow"]["lines"] == []' \
      'page["models"][0]["provenance"]["attributes"]["command_line"].startswith("ct2model build blocked.npy")'
  done
  page blocked.html '(lambda v: v["k_m_per_s"] == 0 and "nothing leads through" in v["good_for"])(page["verdict"][0])'
  run ! grep -qiw -- "-\?nan" <(page blocked.html)
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
}

class_of_interval() { # NAME...
  for name in "$@"; do
    page $name.html '(lambda v: (" to " in v["class_din"]) == any(v["k_low_m_per_s"] < bound <= v["k_high_m_per_s"] for bound in (1e-8, 1e-6, 1e-4, 1e-2)))(page["verdict"][0])'
  done
}

# bats test_tags=long
@test "the class is that of the interval: of models given, by Otsu, of labels" {
  made given otsu labels
  class_of_interval given otsu labels
}

@test "a verdict first: k with its interval, its class, and what other formulas say" {
  for n in 20 40; do
    /usr/bin/python3 "$ROOT/tests/cli/make_run.py" r$n.hdf n=$n spacing=$((80 / n))e-5 k=1.0${n}e-3 method=stokes model=
  done
  analyze report r20.hdf r40.hdf -o levels.html -q > /dev/null
  # Two spacings are one result, with one card.
  page levels.html 'len(page["verdict"]) == 1 and "Extrapolated" in page["verdict"][0]["name"]'
  page matched.html '(lambda v: v["k_low_m_per_s"] < v["k_m_per_s"] < v["k_high_m_per_s"])(page["verdict"][0])'
  # A bar of 25 to 100 % is said to be its class at best; two classes are named where the interval holds a bound of them.
  made fine plain
  page fine.html '"its class and its order of magnitude" in page["verdict"][0]["good_for"]'
  # What lessens resolution, and what lessens the largest of the other shares, whichever that is; where these alone are
  # just below what is wanted, smaller voxels are said to be no more than enough.
  page matched.html '(lambda v, b: (lambda remedy, rest: ("a model with voxels of about" in v["advice"] and remedy not in v["advice"])
    if rest < 0.97 * 0.05 else (remedy + "; a model with smaller voxels alone takes it only just below"
    if rest < 0.05 else "a model with smaller voxels, and " + remedy) in v["advice"])(
    {"scan": "a finer or sharper scan is needed", "sides": "a larger sample is needed"}[max(("scan", "sides", "void_ratio"), key=b.get)],
    (b["scan"] ** 2 + b["sides"] ** 2 + b["void_ratio"] ** 2) ** 0.5))(page["verdict"][0], page["verdict"][0]["error_budget"])'
  page plain.html '"a model with voxels of about" in page["verdict"][0]["advice"]'
  page plain.html 'page["verdict"][0]["k_low_m_per_s"] == 0 and "do not publish" in page["verdict"][0]["good_for"]'
  class_of_interval matched plain levels
  # K = n^3 / (5 S^2) of the model's own numbers; S as the file knows it.
  page matched.html '(lambda n, s, f: abs(f["kozeny_carman"] / (9.80665e6 * n**3 / (5 * s * s)) - 1) < 1e-9
    and set(f) == {"kozeny_carman"})(
    page["models"][0]["model"]["attributes"]["porosity"], page["models"][0]["model"]["attributes"]["specific_surface"], page["verdict"][0]["formulas"])'
}

@test "the classes of an interval of k" {
  /usr/bin/python3 - << 'END'
import os, sys
sys.path.insert(0, os.environ["ROOT"] + "/tests/cli")
import page
for low, high, din, casagrande in (
    (2e-4, 3e-4, "strongly permeable", "good drainage"),
    (5e-7, 5e-6, "weakly permeable to permeable", "poor drainage to good drainage"),
    (0, 0, "very weakly permeable", "practically impervious"),
    (-2e-9, -1e-9, "very weakly permeable", "practically impervious"),  # what noise may leave of water at rest
):
    k = page.read("matched.html", lambda d: d["verdict"][0].update(k_m_per_s=(low + high) / 2, k_low_m_per_s=low, k_high_m_per_s=high))["verdict"][0]
    assert (k["class_din"], k["class_casagrande"]) == (din, casagrande), k
END
}

# bats test_tags=long
@test "results of one name, of runs that differ in their fluid, are told apart by fluid and run" {
  sphsolve run scene.cfg --set "fluids[0].viscosity=2e-3 Pa s" -o run-thick -q > /dev/null
  analyze report run-matched.hdf run-thick.hdf -o fluids.html -q > /dev/null
  page fluids.html 'sorted(r["name"].rsplit(", ", 1)[1] for r in page["verdict"]) == ["run-matched.hdf", "run-thick.hdf"]'
  page fluids.html 'sorted(r["name"].split(", ")[-3] for r in page["verdict"]) == ["0.001 Pa s", "0.002 Pa s"]'
  page matched.html 'page["verdict"][0]["name"].startswith("matched (") and ".hdf" not in page["verdict"][0]["name"]'
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
import base64, os, sys
import numpy as np
sys.path.insert(0, os.environ["ROOT"] + "/tests/cli")
import page
flow = page.read("long.html")["pictures"]["flow"]
size, cell = np.array(flow["size"]), np.array(flow["cell_m"])
assert cell.max() < 1.1 * cell.min(), (size, cell)
assert np.allclose(size * cell, (1.2e-4, 1.2e-4, 1.5e-3), rtol=1e-5)
points = np.frombuffer(base64.b64decode(flow["points"]), "<u2").reshape(-1, 4)[:, :3] / 500
assert (points <= size).all() and np.ptp(points, axis=0)[2] > 0.8 * size[2], (points.max(axis=0), size)
END
}

@test "a line through one point and a record of one row are no sections; effects and balance are in the provenance" {
  page matched.html '{"darcy", "history"} <= set(page) and not {"darcy", "history"} & {s["name"] for s in page["sections"]}' \
    '{"on", "off"} == set(page["runs"][0]["effects"]["state"]) and page["runs"][0]["ledger"]["attributes"]["flux_open"] < 0.1'
  # What page.js fills is there.
  for id in $(grep -o "by('[a-z-]*')" "$ROOT/analyze/report/page.js" | sort -u | cut -d"'" -f2); do
    grep -q "id=\"$id\"" "$ROOT/analyze/report/page.html" || { echo "no $id in page.html"; false; }
  done
}

@test "pictures: walls, speeds and greys are the files', half of the flow is half of it" {
  made fine
  /usr/bin/python3 "$ROOT/tests/cli/report_pictures.py" fine.html run-fine.hdf fine.hdf run-fine-0000.hdf
  # Without a model the lattice's own walls do.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" made.hdf model= pressure=1
  analyze report made.hdf -o made.html -q > /dev/null
  page made.html 'set(page["pictures"]) == {"plane", "flow"} and {"pressure", "speed"} <= set(page["pictures"]["plane"])' \
    'abs(field(page["pictures"]["plane"]["distance"]) - 0.5).max() < 0.02' # the middle of the slit
}

@test "grain sizes: those of spheres of two sizes" {
  /usr/bin/python3 - << 'END'
import h5py, numpy as np
n = 60
grid = np.indices((n, n, n)) + 0.5
spheres = [((20, 20, 20), 14.0), ((20, 20, 44), 7.0), ((44, 44, 20), 7.0), ((44, 20, 44), 7.0), ((46, 46, 46), 7.0)]
distance = np.min([np.sqrt(((grid - np.array(c)[:, None, None, None]) ** 2).sum(axis=0)) - r for c, r in spheres], axis=0)
with h5py.File("spheres.hdf", "w") as f:
    f["model/solid"], f["model/wall_distance"] = (distance < 0).astype(np.uint8), (1e-5 * distance).astype(np.float32)
    f["model"].attrs["spacing"] = [1e-5] * 3
END
  sphsolve run scene.cfg --set model.file=spheres.hdf --set scene.method=stokes --set lattice.spacing='"30 um"' -o run-spheres -q > /dev/null 2>&1
  analyze report run-spheres.hdf -o spheres.html -q > /dev/null
  # By volume 4 x 7^3 / (14^3 + 4 x 7^3) = a third is finer than 0.28 mm, and nothing than 0.13 mm.
  page spheres.html '(lambda d, f: f[min(range(40), key=lambda i: abs(d[i] - 1.2e-4))] < 0.1 and f[-1] == 1
    and abs(f[min(range(40), key=lambda i: abs(d[i] - 2.2e-4))] - 1 / 3) < 0.06)(page["grain_sizes"]["diameter_m"], page["grain_sizes"]["finer"])'
}

@test "a flow with a surface: six times of water and soil, and heads, fluxes and forces first" {
  sphsolve run "$ROOT/data-samples/scenes/excavation.cfg" --set scene.end_time='"2 s"' --set output.interval='"0.25 s"' -o pit -q > /dev/null
  analyze report pit.hdf -o pit.html -q > /dev/null
  page pit.html '(lambda f: len(f["times_s"]) == len(f["values"]) == len(f["kinds"]) == 6 and f["times_s"] == sorted(f["times_s"]))(page["pictures"]["frames"])' \
    'abs(page["pictures"]["frames"]["times_s"][-1] - 2) < 0.05 and page["pictures"]["frames"]["value"] == "pressure"' \
    '(lambda f: set(__import__("base64").b64decode(f["kinds"][-1])) == {0, 1, 2, 3})(page["pictures"]["frames"])'
  # The water's pressure at the bottom is that of what stands over it.
  page pit.html '(lambda f, n: abs(field(f["values"][-1])[n - 2] / (9810 * 6.9) - 1) < 0.1)(page["pictures"]["frames"], page["pictures"]["frames"]["size"][0])'
}

@test "water that moves through space is stored at six times where the scene names no interval; a steady flow at its end alone" {
  sphsolve run "$ROOT/data-samples/scenes/seepage-column.cfg" -o fallen -q > /dev/null
  analyze report fallen.hdf -o fallen.html -q > /dev/null
  page fallen.html '(lambda t: len(t) == 6 and t[0] == 0 and max(abs(t[i] / t[5] - i / 5) for i in range(6)) < 0.05)(page["pictures"]["frames"]["times_s"])' \
    '"pdf" not in [s["name"] for s in page["sections"]]' # one velocity has no distribution
  [ -e run-matched-0000.hdf ] && [ ! -e run-matched-0001.hdf ]
}

@test "free water: the page begins with where it is" {
  sphsolve run "$ROOT/data-samples/scenes/dam-break.cfg" --set scene.end_time='"0.1 s"' --set domain.spacing='"1.46 cm"' -o fall -q > /dev/null
  analyze report fall.hdf -o fall.html -q > /dev/null
  page fall.html 'page["headline"]["text"].startswith("Water after 0.1") and "It lies between x = 0" in page["headline"]["sentence"]' \
    'page["pictures"]["frames"]["times_s"] and "permeability" not in page["headline"]["sentence"]'
}

@test "in a browser: free water shows where it is before anything of a soil, and a section without content goes" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  browse fall.html > fall.dom
  browse matched.html > matched.dom
  /usr/bin/python3 - << 'END'
import re
dom = open("fall.dom").read()
history, fold = re.search('<section id="history">(.*?)</section>', dom, re.S)[1].split("<details>")
assert "Front high" in history and "Velocity rms" in history and "Darcy" not in history and "darcy velocity" in fold, history[:500]
assert 'id="specimen"' not in dom and "of a soil" not in dom and ">false<" not in dom and ">undefined<" not in dom
assert "output.interval in its scene" in dom  # one time alone
dom = open("matched.dom").read()
assert "k against the size of the sample" in dom and ">false<" not in dom
budget = re.search('<table class="budget">(.*?)</table>', dom, re.S)[1]
assert "resolution" in budget and "steadiness" not in budget and "e-" not in re.sub("<[^>]*>", "", budget), budget
END
}

@test "a part of the error that rounds to nothing is not shown, whichever it is" {
  page matched.html '(lambda b: b["shown"] == [p for p in ("resolution", "scan", "sides", "void_ratio", "threshold", "micro", "averaging", "steadiness")
    if b[p] is not None and b[p] >= 0.01 * b["total"] and b[p] > 0] and 0 < b["steadiness"] < 0.01 * b["total"])(page["verdict"][0]["error_budget"])'
  analyze darcy run-matched.hdf -o darcy-shown > said
  grep "error of k" said
  run ! grep "steadiness" said
}

# bats test_tags=long
@test "a TMPDIR that is not there costs the page no picture" {
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" placed.hdf method=stokes k=1e-3 model= levels=1
  TMPDIR=/nothere analyze report placed.hdf -o placed.html > said 2>&1
  run ! grep nothere said
  analyze report placed.hdf -o usual.html > /dev/null
  cmp <(sed 's/placed.html//' placed.html) <(sed 's/usual.html//' usual.html)
}

@test "a run that was interrupted: the page's first lines say so" {
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" stopped.hdf method=stokes k=1e-3 model= status=interrupted
  analyze report stopped.hdf -o stopped.html -q > /dev/null
  page stopped.html 'page["runs"][0]["run"]["attributes"]["status"] == "interrupted"' \
    'page["verdict"][0]["advice"].startswith("The run was interrupted: sphsolve run --resume goes on")'
  analyze darcy stopped.hdf | grep -q '^Verdict: .*The run was interrupted'
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" ended.hdf method=stokes k=1e-3 model=
  analyze report ended.hdf -o ended.html -q > /dev/null
  # One that drifts so far that there is no k is driven none the less.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" early.hdf k=1e-3 model= tau=1
  analyze report early.hdf -o early.html -q > /dev/null 2>&1
  page early.html 'page["headline"]["sentence"].startswith("The flow has not settled, so there is no permeability")'
  # Beside one that has a k it takes nothing from that: the page is about the one that has it, in either order.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" soil.hdf method=isph k=1e-3 model= tau=1 name=soil
  for order in "soil.hdf ended.hdf" "ended.hdf soil.hdf"; do
    analyze report $order --mix -o both.html -q > /dev/null 2>&1
    page both.html 'abs(page["verdict"][0]["k_m_per_s"] / 1e-3 - 1) < 1e-3 and "headline" not in page' \
      '[(r["name"], r["driven"]) for r in page["runs"] if not r["has_k"]] == [("soil", True)]'
  done
}

# bats test_tags=long
@test "a body one voxel wide: its map is the plane along it" {
  /usr/bin/python3 -c '
import numpy as np
z, x = np.indices((40, 30))
np.save("plate.npy", np.repeat((((z % 20 - 10) ** 2 + (x % 15 - 7) ** 2) < 30).astype(np.uint8)[:, None, :], 1, 1))
np.save("column.npy", np.repeat((((z % 20 - 10) ** 2 + (x % 15 - 7) ** 2) < 30).astype(np.uint8)[:, None, :12], 12, 1))'
  for body in plate:xz column:yz; do
    name=${body%%:*}
    size=$([ $name = plate ] && echo "--size 30x1x40" || true)
    ct2model build $name.npy --voxel-size 5um --segmented 0 --mirror none $size -o $name.hdf -q 2> /dev/null
    printf '%s\n' "model = { file = \"$name.hdf\"; };" 'fluids = ( { density = "1000 kg/m^3"; viscosity = "1e-3 Pa s"; } );' \
      'scene = { name = "body"; method = "stokes"; };' 'force = { body_acceleration = ["0", "0", "-9.80665 m/s^2"]; };' > $name.cfg
    sphsolve run $name.cfg -o $name-run -q > /dev/null 2>&1
    analyze report $name-run.hdf -o $name.html -q > /dev/null 2>&1
    page $name.html "(lambda p: p['across'] + p['up'] == '${body#*:}')(page['pictures']['plane'])"
  done
}

# bats test_tags=long
@test "a run that solved several lattices: its own interval, and k of each against its spacing" {
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" levels.hdf method=stokes k=1e-3 model= levels=1
  analyze report levels.hdf -o levels.html -q > /dev/null
  page levels.html '(lambda v: abs(v["k_low_m_per_s"] / 0.9e-3 - 1) < 1e-9 and abs(v["k_high_m_per_s"] / 1.2e-3 - 1) < 1e-9)(page["verdict"][0])'
  page levels.html 'len(page["runs"][0]["levels"]["spacing"]) == len(page["runs"][0]["levels"]["k"]) == 4' 'abs(page["velocity_scale"] * 1.02 - 1) < 1e-9'
  # Its two sides stay what they are where the error by its parts is the larger of them.
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" sided.hdf method=wcsph k=1e-3 model= levels=1 resolution=0.2
  analyze report sided.hdf -o sided.html -q > /dev/null
  page sided.html '(lambda v: abs(v["k_low_m_per_s"] / 0.9e-3 - 1) < 1e-9 and abs(v["k_high_m_per_s"] / 1.2e-3 - 1) < 1e-9)(page["verdict"][0])'
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" one.hdf method=stokes k=1e-3 model=
  analyze report one.hdf -o one.html -q > /dev/null
  page one.html '"levels" not in page["runs"][0] and page["velocity_scale"] == 1'
  # Both intervals where a run has them: of this image, and of its material.
  /usr/bin/python3 -c 'import h5py
a = h5py.File("levels.hdf", "r+")["run"].attrs
a["k_low_image"], a["k_high_image"] = 0.95e-3, 1.1e-3'
  analyze report levels.hdf -o levels.html --force -q > /dev/null
  page levels.html '[page["verdict"][0][k] for k in ("k_low_m_per_s", "k_low_image_m_per_s", "k_high_image_m_per_s", "k_high_m_per_s")] == [9e-4, 9.5e-4, 1.1e-3, 1.2e-3]'
}

@test "on a telephone nothing is wider than the screen" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  narrow matched
}

@test "on paper: at most five sheets" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  printed=$(sheets matched.html)
  [ "$printed" -ge 2 ] && [ "$printed" -le 5 ]
}

@test "a flow in two dimensions: a map of its plane, without a pressure that is rounding" {
  sphsolve run "$ROOT/data-samples/scenes/poiseuille.cfg" -o slit -q > /dev/null
  analyze report slit.hdf -o slit.html -q > /dev/null
  page slit.html '(lambda p: set(p) == {"plane"} and {p["plane"]["across"], p["plane"]["up"]} == {"x", "z"} and "pressure" not in p["plane"])(page["pictures"])'
}

# bats test_tags=long
@test "on a telephone nothing is wider than the screen: a tensor, a flow net" {
  command -v chromium > /dev/null || skip "chromium is not installed"
  sphsolve run scene.cfg --set model.file=matched.hdf -o run-tensor --tensor -q > /dev/null
  analyze report run-tensor.hdf -o tensor.html -q > /dev/null
  sphsolve run "$ROOT/data-samples/scenes/excavation.cfg" --set scene.end_time='"2 s"' -o trench -q > /dev/null
  analyze report trench.hdf -o trench.html -q > /dev/null
  narrow tensor trench
  # All that a run of isph records would be screens of charts: what the scene did not ask for waits behind a fold.
  /usr/bin/python3 - << 'END'
import re
section = re.search('<section id="history">(.*?)</section>', open("dom.html").read(), re.S)[1]
open_part, fold = section.split("<details>")
assert 1 <= open_part.count('class="plot"') <= 6 and "Head" in open_part, open_part.count('class="plot"')
assert re.search("<summary>[0-9]+ more: [^<]*particles", fold), fold[:300]
END
}
