#!/usr/bin/env bats
# One error, one name, one number: from the run to the page; and what the terminal shows of it.

bats_require_minimum_version 1.5.0
load programs
setup_file() {
  programs_setup
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725+-0.01 --voxel-size 8.745um --size 32x32x14 --blur keep -o m.hdf > model.txt
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o run --json > run.json
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o again > run.txt
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o again -v > verbose.txt
}

@test "run, its record, darcy and the page say the same error and the same shares" {
  analyze darcy run.hdf --json > darcy.json
  analyze report run.hdf -o run.html --json > page.json
  /usr/bin/python3 - <<'END'
import json
import re

import h5py
run, darcy, page = (json.load(open(f)) for f in ("run.json", "darcy.json", "page.json"))
record = h5py.File("run.hdf")["run"]
total = run["k_relative_error"]
verdict = page["verdict"][0]
for name, value in (("/run k_error", record.attrs["k_error"]), ("/run/error total", record["error"].attrs["total"]),
                    ("error.total", run["error"]["total"]), ("darcy", darcy["k_relative_error"]),
                    ("darcy budget", darcy["error_budget"]["total"]), ("page", verdict["k_relative_error"])):
    assert abs(value / total - 1) < 1e-6, (name, value, total)
for k in (record.attrs["k"], darcy["k_m_per_s"], verdict["k_m_per_s"]):
    assert abs(k / run["k"] - 1) < 1e-9
shares = [s for s in ("resolution", "scan", "sides", "void_ratio", "threshold") if run["error"][s] is not None]
assert len(shares) >= 4, shares
for share in shares:
    for said in (record["error"].attrs[share], darcy["error_budget"][share], verdict["error_budget"][share]):
        assert abs(said - run["error"][share]) < 1e-9, (share, said, run["error"][share])
text = open("run.txt").read()
bar = float(re.search(r"^k +\S+ cm/s \+- (\S+) %", text, re.M)[1])
assert abs(bar / (100 * total) - 1) < 0.06, (bar, total)
assert "uncertain" not in open("model.txt").read()  # a model has no k, and no error of it
END
}

@test "a measured void ratio without its uncertainty: run, darcy and page say what it is worth and that it is not counted" {
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,48,48,24 --size 16x16x8 -o bare.hdf -q
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=bare.hdf -o bare-run > bare.txt
  grep -q "the void ratio was given without its +-: each 0.01 is [0-9.]* % of k, not counted" bare.txt
  run grep "given without" run.txt
  [ "$status" -eq 1 ]
  for of in bare-run run; do
    analyze darcy $of.hdf > $of.darcy
    analyze report $of.hdf -o $of.html > told
  done
  grep -q "void ratio was given without its +-, which is not counted: each 0.01 moves k by" bare-run.darcy
  said bare-run.html -q "The void ratio was given without its ±, which is not counted"
  run grep "given without" run.darcy <(page run.html)
  [ "$status" -eq 1 ]
}

# bats test_tags=long
@test "velocities of several lattices are the finest's, and say so wherever they are shown" {
  analyze pdf run.hdf -o pdf > pdf.txt
  analyze slice run.hdf > slice.txt
  analyze report run.hdf -o run.html --quiet
  /usr/bin/python3 - <<'END'
import csv
import json
import re

import h5py
run = h5py.File("run.hdf")["run"].attrs
own, k = run["k_finest"], run["k"]
assert abs(own / k - 1) > 1e-3, (own, k)
# The mean of what is called the finest's is it: v = k i over the bulk, from the sites' own mean.
pdf = json.load(open("pdf/pdf.json"))
found = pdf["pore_mean_m_per_s"] * pdf["particles"] / float(run["bulk_count"])
assert abs(found / own - 1) < 0.02 and abs(pdf["k_of_velocities_m_per_s"] / own - 1) < 1e-9, (found, own, k)
assert all(abs(float(row["k_of_velocities_m_per_s"]) / own - 1) < 1e-6 for row in csv.DictReader(open("pdf/pdf.csv")))
said = f"k = {100 * own:.4g} cm/s; k from all lattices is {100 * k:.4g} cm/s"
for name in ("pdf.txt", "slice.txt"):
    assert said in open(name).read(), (name, said)
END
  # The page's pictures show the flow of its k.
  page run.html 'abs(page["velocity_scale"] * page["pdf"]["k_of_velocities_m_per_s"] / page["verdict"][0]["k_m_per_s"] - 1) < 1e-6'
}

@test "run and darcy: twelve lines and a verdict; the rest with -v" {
  [ "$(wc -l < run.txt)" -le 12 ]
  grep -q "^verdict  .*known to .* %" run.txt
  [ "$(wc -l < verbose.txt)" -gt "$(wc -l < run.txt)" ]
  grep -q "^Darcy " verbose.txt
  run ! grep -q "^Darcy " run.txt
  analyze darcy run.hdf > darcy.txt
  [ "$(grep -c . darcy.txt)" -le 12 ]
  grep -q "^Verdict: " darcy.txt
  analyze darcy run.hdf -v | grep -q "superficial"
  run ! grep -q "averaging 0" darcy.txt
}

@test "of each method twelve lines, a verdict among them; the terms of its budget with -v" {
  scene wcsph m.hdf > wcsph.cfg
  sample_model 16x16x7 m16.hdf
  wcsph() { sphsolve run wcsph.cfg --set model.file=m16.hdf -o lines "$@"; }
  isph() { sphsolve run "$ROOT/data-samples/scenes/seepage-heads.cfg" --set scene.method=isph --set scene.end_time='"0.2 s"' -o lines "$@"; }
  for method in wcsph isph; do
    $method > brief.txt
    $method -v > all.txt
    [ "$(wc -l < brief.txt)" -le 12 ] || { cat brief.txt; false; }
    [ $method = isph ] || grep -q "^verdict " brief.txt # isph has no k
    run ! grep -q -e "--error" brief.txt # which neither takes
    grep -qE "momentum, energy: of the largest term [0-9.e-]+ %, [0-9.e-]+ % are not accounted for" brief.txt
    grep -q "momentum (kg m/s)" all.txt
    grep -q "energy (J)" all.txt
  done
}

# bats test_tags=long
@test "a threshold that no measured void ratio stands behind: what lessens its error is to measure one" {
  ct2model build "$ROOT/data-samples/small" --threshold 64 --voxel-size 8.745um --crop 0,0,0,96,96,24 -o guessed.hdf --quiet
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=guessed.hdf -o by-guess --error 10% > guessed.txt
  grep -q "^verdict .*; most of it is the threshold: measure the void ratio$" guessed.txt || { cat guessed.txt; false; }
}

@test "what lessens the error of resolution: a finer lattice, past the model's voxels a model, past the scan's a scan" {
  needs() { # WORD ...: of a run, on stdout's verdict, in its record and in darcy
    local word=$1
    shift
    sphsolve run "$ROOT/data-samples/scenes/demo.cfg" -o needs "$@" > needs.txt
    grep -q "^verdict .* resolution: a $word" needs.txt || { cat needs.txt; false; }
    word=${word#finer }
    analyze darcy needs.hdf --json | grep -q "\"resolution_needs\": \"${word%% *}\""
  }
  needs "finer lattice" --set model.file=m.hdf --set lattice.spacing='"60 um"' 2> said.txt
  grep -qE "close [1-9][0-9]* throats of the model's and open [0-9]" said.txt
  needs "model with smaller voxels" --set model.file=m.hdf
  ct2model build "$ROOT/data-samples/small" --threshold 62 --voxel-size 8.745um --crop 0,0,0,20,20,10 --sides mirrored -o own.hdf --quiet
  # Without what is known of their greys and scanner no share of the scan is larger.
  /usr/bin/python3 -c 'import h5py; f = h5py.File("own.hdf", "r+"); del f["calibration"], f["scanner"]'
  needs "scan with smaller voxels" --set model.file=own.hdf
}

@test "however short --time is, k holds that of a longer run: one lattice alone is no k" {
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o long --error 10% --json > long.json
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o brief --time 1us --json > brief.json 2> said.txt
  grep -q "^lattice 1: .* no estimate from one lattice" said.txt
  grep -q "takes no less: two lattices" said.txt
  /usr/bin/python3 -c 'import json
long, brief = json.load(open("long.json")), json.load(open("brief.json"))
assert len(brief["levels"]) == 2 and brief["status"] == "budget", brief
assert brief["k_low"] < long["k"] < brief["k_high"], (brief["k_low"], long["k"], brief["k_high"])
assert brief["levels"][0]["low"] is None and brief["levels"][1]["high"] > 0
assert abs(brief["error"]["sides"] / long["error"]["sides"] - 1) < 0.05 # after the lattices, not left out'
}

# bats test_tags=long
@test "on a terminal each lattice is drawn: its estimate within its bar, on one scale; elsewhere not" {
  /usr/bin/python3 - <<'END'
import os, pty, re, subprocess
master, slave = pty.openpty()
command = ["sphsolve", "run", os.environ["ROOT"] + "/data-samples/scenes/demo.cfg", "--set", "model.file=m.hdf", "-o", "drawn", "--error", "50%"]
run = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=slave)
os.close(slave)
said = b""
while True:
    try:
        part = os.read(master, 65536)
    except OSError:
        break
    if not part:
        break
    said += part
assert run.wait() == 0
lines = re.findall(r"([\d.]+) s \|([ o-]{56})\| (\S+) cm/s", said.decode())
told = re.findall(r"estimate (\S+) cm/s (?:-\S+ \+\S+|\+- \S+) %", said.decode())
lattices = said.count(b"M points: k ")
assert len(lines) == len(told) == lattices - 1 >= 2, said  # the first says nothing of its error
for (seconds, bar, k), other in zip(lines, told):
    assert bar.count("o") == 1 and re.fullmatch(r" *-*o-* *", bar) and abs(float(k) / float(other) - 1) < 1e-3
scale = [float(k) / (bar.index("o") + 0.5) for _, bar, k in lines]
assert max(scale) / min(scale) < 1.2, scale
assert b"m/slattice" not in said  # a live line is cleared before what is told
END
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o drawn --error 50% 2> told.txt > /dev/null
  grep -q "^lattice 3" told.txt
  run ! grep -q "|" told.txt
}

@test "soil between two heads: darcy and the page take k and error of the run's record" {
  sphsolve run "$ROOT/data-samples/scenes/seepage-heads.cfg" --set scene.end_time='"1 s"' --set output.history_interval='"0.05 s"' -o heads --json > heads.json
  analyze darcy heads.hdf --json > darcy.json
  analyze report heads.hdf -o heads.html --json > page.json
  /usr/bin/python3 - <<'END'
import json
run, darcy, page = (json.load(open(f)) for f in ("heads.json", "darcy.json", "page.json"))
verdict = page["verdict"][0]
for k in (darcy["k_m_per_s"], verdict["k_m_per_s"], darcy["groups"][0]["runs"][0]["k_m_per_s"]):
    assert abs(k / run["k"] - 1) < 1e-9, (k, run["k"])
for error in (darcy["k_relative_error"], verdict["k_relative_error"]):
    assert abs(error / run["k_relative_error"] - 1) < 1e-9, error
assert 0 < run["error"]["resolution"] < 1e-4
for share in ("resolution", "steadiness"):
    for budget in (darcy["error_budget"], verdict["error_budget"]):
        assert abs(budget[share] - run["error"][share]) < 1e-12, share
END
}

@test "an error asked for that was not reached is said" {
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o short --error 0.1% --time 1us > short.txt 2> /dev/null
  grep -q "the error asked for, 0.1 %, was not reached: the next lattice would take longer than --time" short.txt
  grep -q "^status     budget: short of the error asked for, after" short.txt
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o short --error 0.1% > all.txt 2> /dev/null
  grep -q "was not reached: the last lattice has the model's own points" all.txt
  run ! grep -q "was not reached" run.txt
}

# [--time ...]
sides_count() {
  /usr/bin/python3 - <<'END'
import numpy as np
n = 30
at = np.indices((n, n, n)) + 0.5
balls = ((7.5, 10.5, 9), 7.5), ((22.5, 19.5, 21), 8.25), ((18, 22.5, 7.5), 6.75)
solid = [sum(np.minimum(abs(p - q), n - abs(p - q)) ** 2 for p, q in zip(at, c)) < r * r for c, r in balls]
np.save("balls.npy", np.any(solid, axis=0).astype(np.uint8))
END
  ct2model build balls.npy --segmented 0 --voxel-size 10um --mirror none -q -o balls.hdf
  scene stokes balls.hdf > balls.cfg
  sphsolve run balls.cfg -o balls-run --error 12% $1 --json > balls.json 2> /dev/null
  sphsolve run balls.cfg -o balls-run --error 12% $1 > balls.txt 2> /dev/null
  /usr/bin/python3 -c 'import json; run = json.load(open("balls.json")); e = run["error"]
assert run["status"] == "budget" and e["sides"] > 0.12 > e["resolution"] + e["scan"], run'
  grep -q "12 %, was not reached: what no lattice lessens is more" balls.txt || { cat balls.txt; false; }
}
@test "the part of the sides counts in whether an error was reached, and why not" { sides_count; }

# bats test_tags=long
@test "the part of the sides, which a run with a time solves last, counts in whether its error was reached, and why not" {
  sides_count "--time 60s"
}

@test "a run replaces no model, a model no run, unless by force; its own kind as ever" {
  cp m.hdf kept.hdf
  cp run.hdf kept-run.hdf
  run -2 sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o kept
  [[ "$output" == *"kept.hdf: is there already and is a model"* ]]
  cmp m.hdf kept.hdf
  run -2 ct2model build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,48,48,24 --size 16x16x8 --blur keep -o kept-run.hdf
  [[ "$output" == *"kept-run.hdf: is there already and is a run"* ]]
  cmp run.hdf kept-run.hdf
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,48,48,24 --size 16x16x8 --blur keep -o kept-run.hdf -q --force > /dev/null
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --crop 0,0,0,48,48,24 --size 16x16x8 --blur keep -o kept-run.hdf -q > /dev/null
}

@test "past the limit of a file's size a line says so, and nothing half-written stays" {
  run -1 bash -c 'ulimit -f 4; analyze report run.hdf -o limited.html -q'
  [[ "$output" == *"limited.html: cannot be written"* ]]
  [ "$(ls limited* 2> /dev/null | wc -l)" -eq 0 ]
}

@test "a list of numbers is asked for by numbers" {
  printf 'scene = { name = "s"; };\nflow = { file = "run.hdf"; };\nsolute = { peclet = []; };\n' > empty.cfg
  run -3 sphsolve run empty.cfg -o empty
  [[ "$output" == *"numbers is wanted, like [1.0"* ]]
}

@test "the lattices, their error and their time are what explain says they will be" {
  sphsolve explain "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf --json > plan.json
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=m.hdf -o foretold --error 0.1% --json > foretold.json
  /usr/bin/python3 - <<'END'
import json
plan, run = json.load(open("plan.json")), json.load(open("foretold.json"))
solved = run["levels"][-len(plan["levels"]):]
assert len(plan["levels"]) >= 2
for expected, level in zip(plan["levels"], solved):
    assert abs(expected["spacing"] / level["spacing"] - 1) < 0.01, (expected, level)
    assert abs(expected["sites"] / level["sites"] - 1) < 0.1, (expected, level)
    assert 0.4 < level["high"] / expected["expected_error"] < 2.6, (expected, level)
END
  # The seconds hold what is solved beside the lattices: the scan's share and the sides' are in them.
  for less in none scanner sides; do
    cp m.hdf less.hdf
    LESS=$less /usr/bin/python3 - <<'END'
import os
import h5py
with h5py.File("less.hdf", "r+") as f:
    if os.environ["LESS"] == "scanner": del f["scanner"], f["calibration"]
    if os.environ["LESS"] == "sides": del f["model"].attrs["sides"]
END
    sphsolve explain "$ROOT/data-samples/scenes/demo.cfg" --set model.file=less.hdf --json > less-$less.json
  done
  /usr/bin/python3 - <<'END'
import json
none, scanner, sides = ([l["seconds"] for l in json.load(open(f"less-{n}.json"))["levels"]] for n in ("none", "scanner", "sides"))
assert all(a > b for a, b in zip(none, scanner)) and all(a > b for a, b in zip(none, sides)), (none, scanner, sides)
END
}

# bats test_tags=long
@test "the last lattice is the coarsest that is expected to reach the error asked for, and explain foretells it" {
  ct2model build "$ROOT/data-samples/small" --void-ratio 0.725+-0.01 --voxel-size 8.745um -o whole.hdf --quiet
  sphsolve explain "$ROOT/data-samples/scenes/demo.cfg" --set model.file=whole.hdf --error 8.7% --json > asked_plan.json
  sphsolve run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=whole.hdf -o asked --error 8.7% --json > asked.json
  /usr/bin/python3 - <<'END'
import json, math
plan, run = json.load(open("asked_plan.json")), json.load(open("asked.json"))
steps = lambda levels: [4 * math.log2(a["spacing"] / b["spacing"]) for a, b in zip(levels, levels[1:])]
taken = steps(run["levels"])
assert all(abs(s - round(s)) < 1e-6 for s in taken), taken
taken = [round(s) for s in taken]
assert len(taken) > 3 and set(taken[:3]) == {2} and taken[-1] != 2 and 1 <= taken[-1] <= 4, taken
assert 0.071 < run["error"]["total"] < 0.087 and run["status"] == "converged", run["error"]
foretold = plan["levels"][-1]
assert foretold["expected_error_with_scan"] < 0.087, foretold
assert abs(4 * math.log2(foretold["spacing"] / run["levels"][-1]["spacing"])) < 1.01, (foretold, run["levels"][-1])
END
}
