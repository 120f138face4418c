#!/usr/bin/env bats
# The permeability tensor: sphsolve run --tensor, and what analyze shows of it.

bats_require_minimum_version 1.5.0
load programs
setup_file() {
  programs_setup
  /usr/bin/python3 "$BATS_TEST_DIRNAME/tensor_models.py"
  scene stokes turned.hdf > turned.cfg
  scene stokes mirrored.hdf > mirrored.cfg
}

@test "slits across a diagonal: the tensor, its principal axes and its units are those of theory" {
  sphsolve run turned.cfg -o tu --tensor --json > turned.json
  analyze darcy tu.hdf --json > darcy.json
  analyze darcy tu.hdf > darcy.txt
  grep -q "principal value" darcy.txt
  run ! grep "axes mean little" darcy.txt
  # Within their errors nothing tells the axes, and the page says so as the run does.
  /usr/bin/python3 - <<'P'
import shutil
import h5py
shutil.copy("tu.hdf", "alike.hdf")
with h5py.File("alike.hdf", "a") as file:
    file["run/tensor/principal_low"][...] = 0
P
  analyze darcy alike.hdf | grep -q "No two principal values differ by more than their errors: the axes mean little"
  [ -e tu-x.hdf ]
  [ -e tu-y.hdf ]
  [ ! -e tu-z.hdf ]
  /usr/bin/python3 - <<'P'
import json
import math

import h5py

run, shown = json.load(open("turned.json"))["tensor"], json.load(open("darcy.json"))["tensor"]
# Slits of width b between plates, a period of 2 b across them: K = b^2 / 12 * 1/2 along them, 0 across.
h = 10e-6
b = 16 * h / math.sqrt(2) / 2
K = b * b / 24
t = run["permeability_m2"]
truth = [[K / 2, -K / 2, 0], [-K / 2, K / 2, 0], [0, 0, K]]
assert all(abs(t[i][j] - truth[i][j]) < 0.02 * K for i in range(3) for j in range(3)), (t, truth)
assert run["asymmetry"] < 1e-3, run["asymmetry"]
assert run["mirrored"] == ["z"], run["mirrored"]
assert t[0][2] == t[2][0] == t[1][2] == t[2][1] == 0
least = run["principal"][2]
assert abs(least["permeability_m2"]) < 0.01 * K and all(abs(abs(a) - math.sqrt(0.5)) < 0.01 for a in least["axis"][:2])
for one in run["principal"][:2]:
    assert abs(one["permeability_m2"] / K - 1) < 0.02
    assert one["k_low_m_per_s"] <= one["k_m_per_s"] <= one["k_high_m_per_s"]
    assert abs(one["k_m_per_s"] * 1e-6 / 9.80665 / one["permeability_m2"] - 1) < 1e-9
    assert abs(one["k_cm_per_s"] / one["k_m_per_s"] / 100 - 1) < 1e-9
    assert abs(one["permeability_darcy"] * 9.869233e-13 / one["permeability_m2"] - 1) < 1e-9
    assert abs(one["permeability_voxel2"] * h * h / one["permeability_m2"] - 1) < 1e-6
for key in ("k_m_per_s", "permeability_m2", "permeability_darcy", "permeability_voxel2"):  # analyze shows the same
    assert all(abs(run[key][i][j] - shown[key][i][j]) <= 1e-9 * abs(run[key][2][2]) for i in range(3) for j in range(3)), key
with h5py.File("tu.hdf") as file:
    assert abs(file["run/tensor/k"][2, 2] / file["run"].attrs["k"] - 1) < 1e-12
    assert [n.decode() if isinstance(n, bytes) else n for n in file["run/tensor/file"][()]] == ["tu-x.hdf", "tu-y.hdf", "tu.hdf"]
P
}

@test "a mirrored model has no terms off the diagonal, and it is said" {
  sphsolve run mirrored.cfg -o mi --tensor > mirrored.txt
  grep -q "its own mirror image along x, y, z: all terms off the diagonal are zero by symmetry" mirrored.txt
  run ! grep -q "it wraps" mirrored.txt
  sphsolve run mirrored.cfg -o mi --tensor --json |
    /usr/bin/python3 -c 'import json, sys; t = json.load(sys.stdin)["tensor"]
assert t["asymmetry"] is None and t["mirrored"] == list("xyz"), t
assert all(t["k_m_per_s"][i][j] == 0 for i in range(3) for j in range(3) if i != j)
d = [t["k_m_per_s"][i][i] for i in range(3)]
assert max(d) / min(d) < 1 + 1e-3, d  # a cubic array: the same along all axes
assert t["isotropic_within_error"]'
}

@test "directions that nothing leads along have 0, not what sums round" {
  scene stokes tube.hdf > tube.cfg
  sphsolve run tube.cfg -o tube-run --tensor --json |
    /usr/bin/python3 -c 'import json, sys; t = json.load(sys.stdin)["tensor"]
assert [p["permeability_m2"] for p in t["principal"][1:]] == [0, 0] and t["principal"][0]["permeability_m2"] > 0, t'
}

# bats test_tags=long
@test "a crop whose pores do not meet is mirrored along x and y as along z, each for its own flow" {
  for axis in z x; do
    ct2model build zigzag.npy --segmented 0 --voxel-size 10um --flow $axis --quiet -o zigzag-$axis.hdf
    scene stokes zigzag-$axis.hdf > zigzag-$axis.cfg
  done
  sphsolve run zigzag-x.cfg -o zz --json > turned-about.json
  run --separate-stderr sphsolve run zigzag-z.cfg -o zi --tensor --json
  [ "$status" -eq 0 ]
  echo "$output" > zigzag.json
  [[ "$stderr" == *"direction x, mirrored along it: pores do not meet"* ]]
  [[ "$stderr" != *"direction z, mirrored"* ]]
  /usr/bin/python3 - <<'P'
import json

k, t = json.load(open("turned-about.json"))["k"], json.load(open("zigzag.json"))["tensor"]
d = [t["k_m_per_s"][i][i] for i in range(3)]
assert abs(d[0] / k - 1) < 0.01, (d, k)  # the slit goes on into its image; where it wraps round it is shut
assert d[1] == 0 and t["mirrored"] == ["x", "z"], t
P
  analyze darcy zi.hdf | grep -q "sample is its own mirror image along x, z: .*; along x by the run, as pores do not meet"
  analyze report zi-x.hdf -o zigzag.html --quiet
  /usr/bin/python3 "$ROOT/tests/cli/report_sentences.py" zigzag.html zi-x.hdf
  said zigzag.html -q "it is mirrored along x and z"
  analyze report zi.hdf -o tensor.html --quiet
  /usr/bin/python3 "$ROOT/tests/cli/report_sentences.py" tensor.html zi.hdf
  # A run of its own keeps the model as it is.
  sphsolve run zigzag-z.cfg -o plain --set 'force={body_acceleration=["9.80665 m/s^2","0","0"];}' --json > plain.json
  /usr/bin/python3 -c 'import json; assert json.load(open("plain.json"))["k"] == 0'
  run --separate-stderr sphsolve run zigzag-z.cfg -o zi --tensor --resume
  [[ "$stderr" == *"direction x, mirrored along it"*": its record is there already"* ]]
}

# bats test_tags=long
@test "the tensor to an asked error, each direction by its own lattices; --resume takes what is there" {
  sphsolve run mirrored.cfg -o open --tensor --error 20% --json > open.json
  before=$(md5sum < open-x.hdf)
  run --separate-stderr sphsolve run mirrored.cfg -o open --tensor --error 20% --resume --json
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"direction x: its record is there already"* ]]
  [ "$before" = "$(md5sum < open-x.hdf)" ]
  [ "$(/usr/bin/python3 -c 'import json, sys; print(json.load(sys.stdin)["tensor"])' <<< "$output")" = \
    "$(/usr/bin/python3 -c 'import json; print(json.load(open("open.json"))["tensor"])')" ]
  /usr/bin/python3 -c 'import json; r = json.load(open("open.json")); t = r["tensor"]
assert len(r["levels"]) >= 3 and abs(t["k_m_per_s"][2][2] / r["k"] - 1) < 1e-9
assert abs(t["k_high_m_per_s"][2][2] / r["k_high"] - 1) < 1e-9
assert all((t["k_high_m_per_s"][i][i] / t["k_m_per_s"][i][i] - 1) <= 0.2 for i in range(3))'
  # Another scene's records are not taken.
  run --separate-stderr sphsolve run mirrored.cfg -o open --tensor --error 20% --resume --set fluids.[0].viscosity='"2e-3 Pa s"'
  [[ "$stderr" != *"already"* ]]
}

@test "the page shows the tensor" {
  [ -e tu.hdf ] || sphsolve run turned.cfg -o tu --tensor --quiet
  analyze report tu.hdf -o turned.html --quiet
  page turned.html '"mirror image along z" in page["tensor"]["note"]'
  # Beside an axis that is mirrored those that are not have the sample's sides in them.
  said turned.html -q "Along x, y it wraps round: unless the sample repeats itself there"
  # Each body its own: of another the page's card shows none, and darcy each below its k.
  [ -e mi.hdf ] || sphsolve run mirrored.cfg -o mi --tensor --quiet
  /usr/bin/python3 "$ROOT/tests/cli/make_run.py" made.hdf method=stokes k=1e-3 model=
  analyze report made.hdf tu.hdf --mix -o mixed.html --quiet > /dev/null
  page mixed.html '"tensor" not in page'
  analyze darcy tu.hdf made.hdf mi.hdf --mix --json > mixed.json
  /usr/bin/python3 - <<'P'
import json

mixed, alone = json.load(open("mixed.json")), json.load(open("darcy.json"))
groups = mixed["groups"]
assert ["tensor" in group for group in groups] == [True, False, True] and "tensor" not in mixed
assert groups[0]["tensor"] == alone["tensor"] and groups[2]["tensor"] != alone["tensor"]
P
}

@test "an output that may not be is refused before the first direction" {
  run --separate-stderr sphsolve run mirrored.cfg -o mirrored --tensor
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"mirrored.hdf"*"input"* ]]
  [ ! -e mirrored-x.hdf ]
}

@test "--tensor where there is none is refused" {
  run --separate-stderr sphsolve run "$ROOT/data-samples/scenes/dam-break.cfg" -o dam --tensor
  [ "$status" -eq 2 ]
  [[ "$stderr" == *"--tensor"* ]]
  [ ! -e dam.hdf ]
}
