"""What the hard cases share: scenes, models, runs, and checks that carry their threat and their bound."""
import json
import os
import re
import subprocess
import tempfile
import threading
import time

import h5py
import numpy as np

BUILD = os.path.abspath(os.environ.get("BUILD", "build"))
G = 9.80665
CASES = []
RUNS = threading.local()  # mine: runs of this thread's case whose balance has not been looked at
WATER = 'fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "%.17g Pa s"; } );\n'


def case(threat, fast=False):
    """Registers a function that yields rows of `row`; its name is the case's."""
    def register(function):
        CASES.append((function.__name__.replace("_", " "), threat, fast, function))
        return function
    return register


def row(what, bound_from, measured, reference, bound, status=None):
    """|measured - reference| <= bound; `bound_from`: where the bound comes from."""
    error = abs(measured - reference) if measured is not None and np.isfinite(measured) else np.inf
    return {"check": what, "why": bound_from, "reference": reference, "measured": measured, "bound": bound,
            "margin": 1 - error / bound if bound > 0 else float(error == 0),
            "status": status or ("pass" if error <= bound else "fail")}


def holds(what, bound_from, truth, measured=""):
    """A statement that is true or not."""
    return {"check": what, "why": bound_from or "yes or no", "reference": "yes", "measured": measured or ("yes" if truth else "no"),
            "bound": None, "margin": None, "status": "pass" if truth else "fail"}


class Run:
    """One run of sphsolve: code, message, JSON, history, facts of /run."""

    def __init__(self, text, sets=(), out=None, resume=False, limit=540):
        self.folder = tempfile.mkdtemp(prefix="tosui-hard-") if out is None else out
        self.scene = os.path.join(self.folder, "scene.cfg")
        self.prefix = os.path.join(self.folder, "out")
        if text is not None:
            with open(self.scene, "w") as file:
                file.write(text)
        command = [os.path.join(BUILD, "bin", "sphsolve"), "run", self.scene, "-o", self.prefix, "--json", "--threads", "1"]
        for item in sets:
            command += ["--set", item]
        done = subprocess.run(command + ["--resume"] * resume, capture_output=True, text=True, timeout=limit)
        self.code, self.message = done.returncode, done.stderr
        self.json = json.loads(done.stdout) if done.returncode == 0 else {}
        self.history, self.facts, self.limits, self.backs = {}, {}, {}, []
        self.budget, self.work, self.impulse = {}, {}, {}
        if done.returncode == 0:
            RUNS.mine.append(self)
            with h5py.File(self.prefix + ".hdf", "r") as file:
                self.history = {name: data[()] for name, data in file["history"].items()}
                self.facts = dict(file["run"].attrs)
                self.budget = dict(file["run/ledger"].attrs) if "run/ledger" in file else {}
                if "run/ledger/term" in file:
                    names = [n.decode() for n in file["run/ledger/term"][()]]
                    self.work = dict(zip(names, file["run/ledger/work"][()]))
                    self.impulse = dict(zip(names, file["run/ledger/impulse"][()]))
                self.effects = {n.decode(): s.decode() for n, s in zip(file["run/effects/name"][()], file["run/effects/state"][()])}
                if "run/limits" in file:
                    self.limits = {n.decode(): s for n, s in zip(file["run/limits/name"][()], file["run/limits/steps"][()])}
                if "run/watchdog" in file:
                    self.backs = [c.decode() for c in file["run/watchdog/cause"][()]]

    def snapshot(self, number=-1):
        names = sorted(n for n in os.listdir(self.folder) if re.fullmatch(r"out-\d+\.hdf", n))
        with h5py.File(os.path.join(self.folder, names[number]), "r") as file:
            data = {name: value[()] for name, value in file["VTKHDF/PointData"].items()}
            data["position"] = file["VTKHDF/Points"][()]
        return data


def explain(text, sets=()):
    with tempfile.NamedTemporaryFile("w", suffix=".cfg") as file:
        file.write(text)
        file.flush()
        command = [os.path.join(BUILD, "bin", "sphsolve"), "explain", file.name, "--json", "--threads", "1"]
        for item in sets:
            command += ["--set", item]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def whole(run, work=None, backs=False):
    """Every run: it ends, its mass is exact, nobody is lost, no step had to be taken back; and its energy is never more than
    at the start plus the work of a force of given power (W, per row; False: walls do work that no row knows). `backs`: the step given is too long by
    intent, and taking it back is what is wanted."""
    yield holds("the run ends", "exit code 0", run.code == 0, run.message.strip()[-150:] if run.code else "")
    if run.code:
        return
    mass = run.history["mass"]
    moved = run.facts.get("particles_entered", 0) + run.facts.get("particles_left", 0)
    if not moved:
        yield row("mass, last over first", "particles carry their mass: rounding of a sum", mass[-1] / mass[0], 1, 1e-12)
    yield row("particles lost", "none may be", float(run.facts.get("particles_lost", 0)), 0, 0)
    if not backs:
        yield holds("no step was taken back", "the step's own limits are enough", not run.backs, "; ".join(run.backs)[:150])
    yield from balances(run)
    h = run.history
    if "potential_energy" in h and work is None and not moved:
        energy = h["kinetic_energy"] + h["potential_energy"]
        scale = max(abs(energy[0]), h["kinetic_energy"].max(), 1e-300)
        yield row("energy gained, of all there is", "nothing feeds it; a level within 0.1 dx (issue) at 20 particles of depth, M g H/2: 2 x 0.1/20",
                  max(0.0, (energy - energy[0]).max() / scale), 0, 0.01)
    elif work:
        power = work(h)
        given = np.concatenate([[0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(h["time"]))])
        gained = h["kinetic_energy"] - h["kinetic_energy"][0]
        scale = max(abs(given).max(), h["kinetic_energy"].max(), 1e-300)
        coarse = np.concatenate([[0], np.cumsum(0.5 * (power[2::2] + power[:-2:2]) * np.diff(h["time"][::2]))]) if len(power) > 4 else given[::2] + scale
        rule = abs(coarse - given[::2][:len(coarse)]).max() / scale
        yield row("kinetic energy beyond the work of the force, of that work", "viscosity only takes: the trapezoidal rule over the rows, against every other row, and the leapfrog's half step dt/t",
                  max(0.0, (gained - given).max() / scale), 0, rule + h["dt"].max() / h["time"][-1])
        g, t = work.acceleration, h["time"]
        impulse = mass * np.linalg.norm(g) * t
        taken = (h["momentum"] - h["momentum"][0]) @ g / np.linalg.norm(g)
        yield row("momentum beyond the impulse of the force, of that impulse", "walls only take; the leapfrog's half step, dt/t",
                  max(0.0, (taken - impulse).max() / impulse[-1]), 0, max(1e-6, h["dt"].max() / t[-1]))


def balances(run):
    """The budget of momentum and energy, of a run that ended (docs/physics/index.md).

    Both are identities of the steps, as long as no effect is forgotten. Each of S steps adds some ten numbers a
    particle, as large as the energy that is there, T + M f L, and as M f t, with a rounding of 2^-53 (isph), or keeps
    velocities with one of 2^-24 (wcsph): at most 10 S of it. What is there at the end is a sum over N particles, one by one,
    that rounds N times by 2^-53. What wcsph does not sample is bounded by its own rule.

    Action against reaction: what walls, soil and windows give by their own pressure against what the water feels.
    - isph. Gradients take no pairs with walls and surfaces: beside one a half of the neighbourhood's second moment is
      missing, and up to half of what the pressure and the force give along it. So at most half the impulse of those
      particles, the share that stands within a support of a side or is on the surface (here: at the end). Across a face of soil
      the moment lacks up to .2 (isph/moment.c), which is made up for to the first order: .2^2 is left.
    - wcsph, frozen: action is reaction, pair by pair: rounding and samples.
    - wcsph, others: they differ by 2 V P grad C (pairs_budget.h). Shifting moves a particle by A U h grad C, A = 16, and by
      U/4 where that is more: h |grad C| is about 1/64 where shifting keeps up. Against the force on the particle, V rho f, that
      is |P|/(32 h rho f), here with the mean of |P| at the end and as if all pointed one way."""
    budget, h = run.budget, run.history
    RUNS.mine.remove(run)
    if "force_open" in budget and np.isfinite(budget["force_open"]):
        yield row("force that walls and pressure leave", "a sum of N residuals is at most N of their rms, the solver's own", budget["force_open"], 0, run.facts["residual"])
    if "energy_open" not in budget:
        return
    acceleration = np.linalg.norm(run.facts["driving"])
    sides = run.facts["size"] * run.facts["spacing"]
    method, wall = (bytes(run.facts[name]).decode() for name in ("method", "wall"))
    isph = method == "isph"
    size = max(h["kinetic_energy"].max(), abs(budget["energy_start"]), abs(budget["energy_end"])) + h["mass"].max() * acceleration * sides.max()
    rounding = 10 * run.facts["steps"] * (2.0 ** -53 if isph else 2.0 ** -24) + run.facts["fluid_count"] * 2.0 ** -53
    yield row("energy not accounted for, of all there is", "10 roundings a particle and step, and one of each in the last sum" + ("" if isph else ", and what samples may miss"),
              abs(budget["energy_open"]) / max(size, 1e-300), 0, rounding + budget["energy_sampling_error"] / max(size, 1e-300))
    scale = max([np.linalg.norm(v) for v in run.impulse.values()] + [np.linalg.norm(budget["account_momentum_start"]), np.linalg.norm(budget["account_momentum_end"]), 1e-300])
    sampled = budget["momentum_sampling_error"] / scale
    yield row("momentum not accounted for, of the largest term", "10 roundings a particle and step, and one of each in the last sum" + ("" if isph else ", and what samples may miss"),
              np.linalg.norm(budget["momentum_open"]) / scale, 0, rounding + sampled)
    share, what = np.linalg.norm(run.impulse["projection"]) / scale, "pressure that nothing returns, of the largest term"
    if isph:
        data = run.snapshot()
        support, low, used = 2.4 * run.facts["spacing"].max(), run.facts["origin"] - 0.5 * run.facts["spacing"], run.facts["size"] > 1
        x = data["position"][:, used]
        near = data["surface"] > 0
        if "wall_pressure" in run.impulse:  # there are walls: which sides are closed no file says
            near |= ((x - low[used] < support) | (low[used] + sides[used] - x < support)).any(axis=1)
        yield row(what, "particles beside walls and surfaces miss half a moment; the solver's tolerance", share, 0,
                  0.5 * near.mean() + 0.2 ** 2 * ("soil_pressure" in run.impulse) + 1e-6)
    elif wall == "frozen":
        yield row(what, "pairs are symmetric: roundings and samples", share, 0, sampled + rounding)
    else:
        pressure = np.abs(run.snapshot()["pressure"]).mean() / (32 * run.facts["smoothing_length"] * run.facts["density"] * max(acceleration, 1e-300))
        yield row(what, "2 V P grad C, h |grad C| = 1/64; roundings, samples", share, 0, sampled + rounding + pressure)


def force_power(acceleration):
    """Power of a constant acceleration, from momentum."""
    def power(h):
        return h["momentum"] @ power.acceleration
    power.acceleration = np.asarray(acceleration, float)
    return power


def slit(n, width=8e-4, viscosity=1e-3, g=0.1, method="wcsph", end="1 s", tolerance=1e-3, more="", length=6):
    """2-D, n particles across, driven along x."""
    dx = width / n
    return (f'scene = {{ name = "slit"; method = "{method}"; end_time = "{end}"; steady_tolerance = {tolerance}; }};\n'
            f'domain = {{ size = ["{length * dx:.12g} m", "{width:.12g} m"]; spacing = "{dx:.12g} m"; periodic = [true, false]; }};\n'
            f'regions = ( {{ type = "water"; box = ["0", "0", "{length * dx:.12g} m", "{width:.12g} m"]; }} );\n'
            + WATER % viscosity + f'force = {{ body_acceleration = ["{g:.17g} m/s^2", "0"]; }};\n' + more)


def slit_velocity(width, viscosity, g):
    """Mean velocity of a slit, g w^2 / (12 nu)."""
    return g * width ** 2 / (12 * viscosity / 1000)


def model(solid, spacing, distance=None, path=None):
    """Writes a voxel model: solid [nz][ny][nx], distance in m, positive in the pore."""
    path = path or os.path.join(tempfile.mkdtemp(prefix="tosui-hard-"), "model.hdf")
    with h5py.File(path, "w") as file:
        group = file.create_group("model")
        group["solid"] = np.asarray(solid, np.uint8)
        group.attrs["spacing"] = [spacing] * 3
        if distance is not None:
            group["wall_distance"] = np.asarray(distance, np.float32)
    return path


def spheres(n, c, spacing):
    """Simple cubic array, n sites a side, solid fraction c: one sphere at the corner."""
    radius = n * (3 * c / (4 * np.pi)) ** (1 / 3)
    x = np.arange(n) + 0.5
    x = np.minimum(x, n - x)
    r = np.sqrt(x[:, None, None] ** 2 + x[None, :, None] ** 2 + x[None, None, :] ** 2)
    return model(r < radius, spacing, (r - radius) * spacing), radius * spacing


def sand(n, spacing, porosity=0.42, radius=2.6):
    """Overlapping spheres at random, periodic, until so much pore is left."""
    random, x = np.random.default_rng(2006), np.arange(n) + 0.5
    distance = np.full((n, n, n), np.inf)
    while (distance > 0).mean() > porosity:
        centre = random.uniform(0, n, 3)
        d = [np.abs(x - c) for c in centre]
        d = [np.minimum(a, n - a) for a in d]
        distance = np.minimum(distance, np.sqrt(d[2][:, None, None] ** 2 + d[1][None, :, None] ** 2 + d[0][None, None, :] ** 2) - radius)
    return model(distance <= 0, spacing, distance * spacing)


def in_model(path, g, viscosity=1e-3, method="wcsph", end="10 s", tolerance=5e-3, more="", axis=2):
    force = ["0", "0", "0"]
    force[axis] = f"{g:.17g} m/s^2"
    return (f'scene = {{ name = "model"; method = "{method}"; end_time = "{end}"; steady_tolerance = {tolerance}; }};\n'
            f'model = {{ file = "{path}"; }};\n' + WATER % viscosity
            + 'force = { body_acceleration = ["%s", "%s", "%s"]; };\n' % tuple(force) + more)


def engine(name, *arguments):
    """A case of the program hard_engine (starts no scene can give): its numbers."""
    done = subprocess.run([os.path.join(BUILD, "tests", "hard_engine"), name, *map(str, arguments)], capture_output=True,
                          text=True, timeout=540)
    if done.returncode:
        raise RuntimeError(done.stderr.strip()[-200:])
    return json.loads(done.stdout)


def measure(entry):
    """All rows of one case."""
    name, threat, fast, function = entry
    started, rows = time.time(), []
    RUNS.mine = []
    try:
        for r in function():
            rows.append(r)
        rest = [list(balances(run)) for run in list(RUNS.mine)]
        rest = [of_run for of_run in rest if of_run]
        for what in sorted({r["check"] for of_run in rest for r in of_run}):
            same = [r for of_run in rest for r in of_run if r["check"] == what]
            rows.append({**min(same, key=lambda r: r["margin"]), "check": f"{what}, the worst of {len(same)} runs"})
    except Exception as problem:  # a case that cannot be carried out has failed
        rows.append(holds("the case can be carried out", "", False, f"{type(problem).__name__}: {problem}"[:200]))
    seconds = time.time() - started
    margins = [r["margin"] for r in rows if r["margin"] is not None]
    least = f"least margin {min(margins):.2g}, " if margins else ""
    group = f"{name}. {threat}. {len(rows)} checks, {least}{seconds:.1f} s" + (", fast" if fast else "")
    return [{"case": f"{name}: {r['check']}", "group": group, "threat": threat, "fast": fast, "seconds": seconds / len(rows), **r} for r in rows]
