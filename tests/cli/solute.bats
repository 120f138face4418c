#!/usr/bin/env bats
# A solute in a finished flow: sphsolve run and explain of a scene with flow = { ... }; analyze dispersion.

bats_require_minimum_version 1.5.0
load programs
setup_file() {
  programs_setup
  cp "$ROOT/tests/cli/slit.cfg" .
  cat > carried.cfg <<'END'
scene  = { name = "carried"; };
flow   = { file = "slit.hdf"; };
solute = { diffusion = "1e-9 m^2/s"; peclet = [0.1, 1.0, 10.0, 100.0, 1000.0]; length = "1 mm"; };
END
  cat > resumed.cfg <<'END'
scene  = { name = "resumed"; };
flow   = { file = "slit.hdf"; };
solute = { peclet = [30.0]; length = "1 mm"; way = "both"; };
checkpoint = { interval = "0.05 s"; };
END
  sphsolve run slit.cfg -o slit > /dev/null
  sphsolve run carried.cfg -o carried --json > carried.json
  sphsolve run carried.cfg -o walked --json --error 5% --set 'solute.peclet=[30.0]' --set 'solute.way="both"' > walked.json
}

@test "a slit disperses as Taylor and Aris say, within 1 % and within the error that is stated" {
  /usr/bin/python3 - <<'P'
import json

r = json.load(open("carried.json"))
assert r["status"] == "converged" and r["peclet"] == [0.1, 1, 10, 100, 1000], r
assert abs(r["porosity"] - 20 / 24) < 1e-3, r["porosity"]
for pe, d, error, a in zip(r["peclet"], r["longitudinal"], r["longitudinal_error"], r["longitudinal_dispersivity"]):
    exact = 1 + pe * pe / 210
    assert abs(d / exact - 1) < 0.01, (pe, d, exact)
    assert abs(d - exact) <= error * d + 1e-9, (pe, d, exact, error)
    assert abs(a - d * 1e-3 / pe) < 1e-9 * a
assert all(t < 1e-6 for t in r["transverse"]), r["transverse"]
assert abs(r["formation_factor"] * r["porosity"] - 1) < 1e-3
# all that spreads along a slit is one way that stays faster than another: no sample of a soil says less of it
assert all(a < b for a, b in zip(r["longitudinal_sample"], r["longitudinal_sample"][1:])) and r["longitudinal_sample"][-1] > 1
assert abs(r["velocity_correlation_along"] / 0.15e-3 - 1) < 0.01, r["velocity_correlation_along"]  # half the box
assert 0.05e-3 < r["velocity_correlation_across"] < 0.4e-3, r["velocity_correlation_across"]
P
  sphsolve run carried.cfg -o table --set 'solute.peclet=[30.0]' > table.txt
  grep -q "^sample     0.3 mm along the flow; its velocity forgets itself in 0.15 mm, across in " table.txt
  grep -q "^others     by how much" table.txt
}

@test "the closure problem on cells with too large a Peclet number of their own says so, and how much less it knows" {
  sphsolve run carried.cfg -o cells --json --set 'solute.peclet=[1000.0, 1100.0]' > cells.json 2> cells.txt
  grep -q "Pe 1100 is 5[0-9.]* of a cell, too much for the closure problem" cells.txt
  run grep "Pe 1000 is" cells.txt
  [ "$status" -eq 1 ]
  /usr/bin/python3 -c 'import json; e = json.load(open("cells.json"))["longitudinal_error"]; assert e[1] > 2 * e[0] > 0, e'
}

@test "the random walk finds the same, within the error that it states" {
  /usr/bin/python3 - <<'P'
import json

r = json.load(open("walked.json"))
exact = 1 + 30**2 / 210
d, error = r["walk"]["longitudinal"][0], r["walk"]["longitudinal_error"][0]
assert r["status"] == "converged", r["status"]
assert 0 < error < 0.06, error
assert abs(d / exact - 1) < error, (d, error, exact)
assert r["longitudinal_error"][0] == min(error, r["closure"]["longitudinal_error"][0])
P
}

# bats test_tags=long
@test "an error that is asked for and not reached is told" {
  run --separate-stderr sphsolve run carried.cfg -o wanted --error 0.1%
  [ "$status" -eq 0 ]
  [[ $stderr == *"--error: "*" of 5 Peclet numbers are known less well than 0.1 %, Pe 1000 to "*"finer lattice"* ]]
  run --separate-stderr sphsolve run carried.cfg -o wanted --error 5% --force
  [ "$status" -eq 0 ]
  [[ $stderr != *"--error"* ]]
}

@test "the same bits for any number of threads" {
  sphsolve run carried.cfg -o again --json --threads 2 > again.json
  grep -v wall_time carried.json > one
  grep -v wall_time again.json > two
  cmp one two
}

@test "without a list of Peclet numbers that of the flow as it is; without a length that of the grains" {
  sphsolve run carried.cfg -o own --json --set solute='{ diffusion = "1e-9 m^2/s"; length = "1 mm"; }' > own.json
  /usr/bin/python3 -c '
import json
r = json.load(open("own.json"))
assert len(r["peclet"]) == 1 and abs(r["peclet"][0] / (r["mean_velocity"] * 1e-3 / 1e-9) - 1) < 1e-9, r'
  sphsolve run carried.cfg -o auto --json --set solute='{ peclet = [1.0]; }' > auto.json
  /usr/bin/python3 -c '
import json
r = json.load(open("auto.json"))
assert abs(r["length"] / (6 * 0.2e-3 / 2) - 1) < 0.01, r["length"]  # 6 times the wall plate over its two sides'
}

@test "interrupted, killed and resumed it is, bit for bit, the run that never ended" {
  sphsolve run resumed.cfg -o never --error 30% --quiet --threads 1
  for signal in INT KILL; do
    rm -f ended.ckpt.1.hdf
    (exec sphsolve run resumed.cfg -o ended --error 30% --quiet --resume) &
    until [ -e ended.ckpt.1.hdf ] || ! kill -0 $! 2> /dev/null; do sleep 0.02; done
    kill -$signal $! 2> /dev/null || true
    wait $! || true
    [ ! -e ended.hdf ]
    [ -s ended.ckpt.hdf ]
  done
  run -3 --separate-stderr sphsolve run resumed.cfg -o ended --error 30% --quiet --resume --set 'solute.peclet=[10.0]'
  [[ $stderr == *"the scene has changed since: solute.peclet was 30 and is 10"* ]]
  sphsolve run resumed.cfg -o ended --error 30% --quiet --resume
  /usr/bin/python3 "$ROOT/tests/cli/same_run.py" never.hdf ended.hdf
  h5ls_walks='import h5py; w = h5py.File("ended.hdf")["solute/walk/0"]; print(w["track"].shape[1], w["passage_time"].shape)'
  [ "$(/usr/bin/python3 -c "$h5ls_walks")" = "64 (6, 200)" ]
}

@test "explain foretells memory and time" {
  sphsolve explain carried.cfg > explain.txt
  grep -q "^closure " explain.txt
  sphsolve explain carried.cfg --json > explain.json
  sphsolve explain carried.cfg --set 'solute.way="walk"' --error 5% > walk.txt
  grep -q "^walk .* walkers at each Peclet number, to 5 %, in about" walk.txt
  grep -q "^time       about" walk.txt
  /usr/bin/python3 -c '
import json
r = json.load(open("explain.json"))
assert r["method"] == "solute" and r["size"] == [24, 1, 6] and r["memory_bytes"] > 1e6 and r["seconds"] > 0, r'
}

@test "what cannot be is said in one line" {
  run -2 --separate-stderr sphsolve run carried.cfg -o x --time 60s
  [[ $stderr == *"--time is of a scene that solves a flow"* ]]
  run -2 --separate-stderr sphsolve run carried.cfg -o slit
  [[ $stderr == *"slit.hdf"* ]]
  cp slit.hdf alone.hdf
  run -3 --separate-stderr sphsolve run carried.cfg -o x --set flow.file=alone.hdf
  [[ $stderr == *"output.image"*"alone-image.hdf"* ]]
  run -3 --separate-stderr sphsolve run carried.cfg -o x --set flow.file=carried.hdf
  [[ $stderr == *"a run of method solute"* ]]
  [ ! -e x.hdf ]
}

@test "analyze dispersion shows the curve, and the report has it beside its flow" {
  analyze dispersion carried.hdf -o shown > shown.txt
  grep -q "formation factor F = " shown.txt
  grep -q "error of D_L by closure, resolution: " shown.txt
  grep -q "error of D_L by closure, sample size: " shown.txt
  [ -s shown/dispersion.csv ]
  /usr/bin/python3 - <<'P'
import json

run, shown = json.load(open("carried.json")), json.load(open("shown/dispersion.json"))["runs"][0]
for key in ("peclet", "longitudinal", "transverse", "longitudinal_error"):
    assert all(abs(a - b) <= 1e-9 * abs(a) for a, b in zip(run[key], shown[key])), key
assert shown["closure"]["longitudinal"] == shown["longitudinal"]
for error, parts in zip(run["longitudinal_error"], zip(*(shown["closure"]["longitudinal_" + p] for p in ("resolution", "projection")))):
    assert abs(sum(p * p for p in parts) ** 0.5 - error) <= 1e-3 * error + 1e-4, (error, parts)
assert abs(shown["longitudinal_dispersivity_m"][1] / run["longitudinal_dispersivity"][1] - 1) < 1e-9
P
  analyze report slit.hdf carried.hdf -o page.html > /dev/null 2> said
  run grep 'passed over' said
  [ "$status" -eq 1 ]
  page page.html '"dispersion" in [s["name"] for s in page["sections"]]'
  if command -v chromium > /dev/null; then # what was asked comes first, then the flow
    browse page.html | grep -o '<p class="k" id="answer">[^<]*' | grep "Dispersion [0-9]"
  fi
  # Made again under its name: the ways of walkers are a product, too.
  for time in 1 2; do
    sphsolve run carried.cfg -o again --error 50% --set 'solute.peclet=[0.0]' --set 'solute.way="walk"' --quiet > /dev/null
  done
  analyze dispersion walked.hdf -o curves > curves.txt
  grep -q "^  Pe 30, D_L/D = " curves.txt
  [ -s curves/breakthrough.csv ]
  # gnuplot leaves out an axis' name that it has no room for.
  grep -q 'across (mm)' curves/film.svg && grep -q 'along the flow (mm)' curves/film.svg
  /usr/bin/python3 -c '
import re
places = [(float(y), re.sub("<[^>]*>", "", text)) for y, text in
          re.findall(r"translate\([\d.]+,([\d.]+)\)[^\n]*\n\t*<text>(.*)</text>", open("curves/breakthrough.svg").read())]
axis = max(y for y, text in places if "distance" in text)
key = min(y for y, text in places if text.startswith("Pe "))
assert key > axis + 10, places'
  /usr/bin/python3 - <<'P'
import json

planes = json.load(open("curves/dispersion.json"))["breakthrough"]["walks"][0]["planes"]
# 9.6 mm, where a solute has long forgotten where in the slit it began: D_L/D as Taylor and Aris have it
film = json.load(open("curves/dispersion.json"))["film"]
last = film["frames"][-1]
# the spread of the last picture is what D_L makes of its time, and its mean the way of the water
run = json.load(open("walked.json"))
d = run["mean_velocity"] * run["length"] / 30
assert abs(last["mean_m"] / (run["mean_velocity"] * last["time_s"]) - 1) < 0.05, last
assert abs(last["deviation_along_m"] ** 2 / (2 * 5.286 * d * last["time_s"]) - 1) < 0.15, last
far = next(p for p in planes if abs(p["distance_m"] / 9.6e-3 - 1) < 1e-6)
assert abs(far["longitudinal"] / (1 + 30**2 / 210) - 1) < 0.1, far["longitudinal"]
assert abs(far["velocity_over_mean"] - 1) < 0.02 and far["misfit"] < 0.02 and far["holds"], far
times = [t for t in far["time_s"] if t is not None]
assert times == sorted(times) and len(times) > 150
# half a gap on, most of a solute is still where it began: no such equation
assert not planes[0]["holds"] and planes[0]["misfit"] > 2 * far["misfit"], planes[0]["misfit"]
P
  PYTHONPATH="$ROOT/python" /usr/bin/python3 - <<'P'
import h5py
import numpy as np

import tosui
try:
    tosui.load("walked-tracks-0.hdf")
    raise SystemExit("taken for a run")
except tosui.TosuiError as error:
    assert "ways of walkers" in str(error), error
grid, walk = h5py.File("walked-tracks-0.hdf")["VTKHDF"], h5py.File("walked.hdf")["solute/walk/0"]
n, lines = len(grid["Points"]), len(grid["Offsets"]) - 1
assert lines == 64 and set(grid["Types"][()]) == {4} and grid["Offsets"][-1] == n == len(grid["Connectivity"])
time, id = (grid["PointData"][name][()].reshape(64, -1) for name in ("time", "id"))
assert (np.diff(time, axis=1) > 0).all() and (id == np.arange(64)[:, None]).all()
step = grid["Points"][()].reshape(64, -1, 3)[:, -1] - grid["Points"][()].reshape(64, -1, 3)[:, 0]
assert abs(step[:, 2]).mean() > 5 * abs(step[:, 0]).mean() > 0, step.mean(axis=0)
P
  /usr/bin/python3 -c 'import h5py; assert b"sphsolve run carried.cfg -o walked" in h5py.File("walked-tracks-0.hdf")["provenance"].attrs["command_line"]'
  analyze report slit.hdf walked.hdf -o walked.html > /dev/null 2>&1
  # Curves are drawn by the page; a picture is as wide as a telephone, or the letters are too small there.
  page walked.html '[len(s["charts"]) for s in page["sections"] if s["name"] == "breakthrough"] == [2]' \
    'all(len(c["series"]) == 2 and c["series"][0]["points"] for s in page["sections"] if s["name"] == "breakthrough" for c in s["charts"])' \
    '[s["width"] for s in page["sections"] if s["name"] == "film"] == [560]'
  run -3 --separate-stderr analyze darcy carried.hdf
  [[ $stderr == *"analyze dispersion carried.hdf"* ]]
  run -3 --separate-stderr analyze dispersion slit.hdf
  [[ $stderr == *"no solute in it"* ]]
}

# bats test_tags=long
@test "report puts a solute beside its own flow alone, and tells where it is from" {
  sphsolve run slit.cfg -o wider --set 'scene.name="wider"' --set 'regions.[1].box=["0","0","0.1 mm","0.3 mm"]' > /dev/null
  run -3 --separate-stderr analyze report wider.hdf carried.hdf -o other.html
  [ "${#stderr_lines[@]}" -eq 1 ]
  [[ $stderr == *"carried.hdf: carried by the flow of slit.hdf, another model (slit) than the runs' (wider)"* ]]
  [ ! -e other.html ]
  analyze report wider.hdf carried.hdf -o other.html --mix > /dev/null 2>&1
  # its flow moved: none of the runs, and not to be found
  mkdir -p moved
  cp carried.hdf moved/
  run -3 --separate-stderr analyze report wider.hdf moved/carried.hdf -o other.html
  [[ $stderr == *"another model"* ]] # found by the name it had
  mv slit.hdf elsewhere.hdf
  run --separate-stderr analyze report wider.hdf moved/carried.hdf -o moved.html
  analyze report elsewhere.hdf moved/carried.hdf -o right.html > /dev/null
  mv elsewhere.hdf slit.hdf
  [ "$status" -eq 3 ]
  [[ $stderr == *"none of the runs"* ]]
  page right.html 'len(page["runs"]) == 1 and [s["path"] for s in page["solutes"]] == ["moved/carried.hdf"]'
  said right.html -q "Brenner H (1980)"
  # one sample and its mirror image: what the solver warns of stands beside the curve
  analyze dispersion carried.hdf > plain.txt
  run grep -c "its own mirror image" plain.txt
  [ "$output" -eq "$(sphsolve run carried.cfg -o again --force 2>&1 > /dev/null | grep -c "its own mirror image")" ]
  /usr/bin/python3 -c 'import h5py; h5py.File("carried.hdf", "a")["solute"].attrs["mirrored"] = 1'
  analyze dispersion carried.hdf | grep -q "its own mirror image along the flow"
  analyze report slit.hdf carried.hdf -o mirrored.html > /dev/null
  grep -q "its own mirror image along the flow" mirrored.html
}
