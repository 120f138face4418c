"""report_sentences.py PAGE.html RUN.hdf...: every sentence of the page's Methods is one of those below and true of what
runs and model say of themselves. Exits 1 with what is not."""
import os
import re
import sys

import h5py

from page import read

page_path, run_paths = sys.argv[1], sys.argv[2:]
methods = read(page_path)["methods"]


def text_of(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def attributes(file, group):
    return {k: text_of(v) if isinstance(v, (bytes, str)) else v for k, v in file[group].attrs.items()} if group in file else {}


runs = []
for path in run_paths:
    with h5py.File(path) as file:
        runs.append({**attributes(file, "run"), "error": attributes(file, "run/error"),
                     "levels": list(file["run/levels/spacing"][()]) if "run/levels" in file else [], "tensor": "run/tensor" in file})
first, levels = runs[0], runs[0]["levels"]
model, command = None, ""
named = first.get("model_path", "")
for path in (named, os.path.join(os.path.dirname(run_paths[0]), os.path.basename(named))):
    if named and model is None and os.path.exists(path):
        with h5py.File(path) as file:
            model = attributes(file, "model")
            model["program"] = attributes(file, "provenance").get("program", "")
            model["wall_distance"], model["grain_fraction"] = ("model/" + n in file for n in ("wall_distance", "grain_fraction"))
            model["segmented"] = attributes(file, "calibration").get("segmented", 0) == 1
            model["smoothing"] = attributes(file, "calibration").get("smoothing", 0)
            model["smoothing_even"] = attributes(file, "calibration").get("smoothing_even", 0)
            model["scanner"] = attributes(file, "scanner")
            command = attributes(file, "provenance").get("command_line", "")

scanned = model is not None and model["program"] == "ct2model"
given = re.search(r"--threshold[ =](\S+)", command)
matched = scanned and (given is None or given[1] == "auto") and not model["segmented"]
measured = model.get("void_ratio_measured", float("nan")) if model else float("nan")


def near(a, b):
    return abs(float(a) - float(b)) <= 1e-3 * abs(float(b))


mirrored = r"(?:; it is mirrored along ([xyz](?:(?:, [xyz])? and [xyz])?))?(; its sides are walls)?"
unmatched = r"(?:; ([\d.]+) was measured on the specimen|; no measured void ratio was given)" + mirrored


def is_mirror(axes, walls):
    sides = model.get("sides", "periodic")
    true = {model["mirror_axis"]} - {"none"} | (set("xy") if sides == "mirrored" else set())
    true |= {axis for axis, by_run in zip("xyz", first.get("mirrored", (0, 0, 0))) if by_run}
    return set(re.findall(r"\b[xyz]\b", axes or "")) == true and bool(walls) == (sides == "closed")


def is_unmatched(e, told, axes, walls):
    return near(e, model["void_ratio"]) and is_mirror(axes, walls) and (near(told, measured) if told else not measured > 0)


GEOMETRY = [
    (r"", lambda: not named),
    (r", from a model file that could not be read when this page was made", lambda: named and model is None),
    (r", from a voxel model", lambda: model is not None and not scanned),
    (r", made by ct2model from an image whose grey threshold \(([\d.]+)\) was set so that the model has the void ratio measured on "
     r"the specimen, ([\d.]+)(?: \(it has ([\d.]+)\))?" + mirrored,
     lambda t, e, has, axes, walls: matched and near(t, model["threshold"]) and near(e, measured) and is_mirror(axes, walls)
     and (near(has, model["void_ratio"]) if has else abs(model["void_ratio"] / measured - 1) <= 0.01)),
    (r", made by ct2model from an image at the grey threshold of Otsu.s method \[\d+\], ([\d.]+), which gives a void ratio of ([\d.]+)"
     + unmatched, lambda t, e, told, axes, walls: given[1] == "otsu" and near(t, model["threshold"]) and is_unmatched(e, told, axes, walls)),
    (r", made by ct2model from an image at a given grey threshold of ([\d.]+), which gives a void ratio of ([\d.]+)" + unmatched,
     lambda t, e, told, axes, walls: near(t, given[1]) and is_unmatched(e, told, axes, walls)),
    (r", made by ct2model from an image that was segmented before; the model has a void ratio of ([\d.]+)" + unmatched,
     lambda e, told, axes, walls: model["segmented"] and is_unmatched(e, told, axes, walls)),
]
WALLS = {"the model's signed distances to the grain surface": lambda: model["wall_distance"],
         "found from the grain fraction of the voxels": lambda: not model["wall_distance"] and model["grain_fraction"],
         "the faces of the voxels": lambda: not model["wall_distance"] and not model["grain_fraction"]}
spacings = {round(float(r["spacing"][0]) * 1e12) for r in runs}
gradients = {round(float(r["hydraulic_gradient"]), 9) for r in runs}


def is_geometry(nx, ny, nz, spacing, rest):
    if [int(n) for n in (nx, ny, nz)] != [int(n) for n in first["size"]] or not near(spacing, 1e6 * first["spacing"][0]):
        return False
    return any((m := re.fullmatch(pattern, rest)) and true(*m.groups()) for pattern, true in GEOMETRY)


SENTENCES = [
    (r"Flow was computed with Tosui [\d.]+ \[1\] on a lattice of (\d+) × (\d+) × (\d+) points of ([\d.]+) µm(.*)", is_geometry),
    (r"The fluid had a density of (\S+) kg/m³ and a viscosity of (\S+) Pa s",
     lambda rho, mu: near(rho, first["density"]) and near(mu, first["viscosity"])),
    (r"Walls are drawn through the labels smoothed by a Gaussian with a standard deviation of ([\d.]+) µm, where they are even enough "
     r"of ([\d.]+) µm without its second moment, at the volume of their pores",
     lambda width, even: model["segmented"] and near(width, 1e6 * model["smoothing"]) and
     near(even, 1e6 * model["smoothing_even"])),
    (r"The scanner's blur, by the edges of the scan a Gaussian with a standard deviation of ([\d.]+) µm, was taken out of the "
     r"surface", lambda blur: model["scanner"]["removed"] == 1 and near(blur, 1e6 * model["scanner"]["blur"])),
    (r"The steady creeping flow was solved with .*", lambda: first["method"] == "stokes"),
    (r"Inertia is left out, at a Reynolds number of (\S+)", lambda re: abs(float(re) / first["reynolds"] - 1) < 0.06 and
     first["reynolds"] > 0.1 and first["method"] == "stokes"),
    (r"The unified Navier-Stokes and extended Darcy equations were integrated .*", lambda: first["method"] == "isph"),
    (r"Weakly compressible smoothed particle hydrodynamics with a quintic spline .*", lambda: first["method"] == "wcsph"),
    (r"Grain surfaces carry dummy velocities \[\d+\]", lambda: first["wall"] == "adami"),
    (r"Grains are frozen fluid particles after \[\d+\], which .*", lambda: first["wall"] == "frozen"),
    (r"No slip holds at the wall itself, by image velocities from the distance to it, after \[\d+\](?:; walls are (.*))?",
     lambda walls: first["wall"] == "subvoxel" and (WALLS[walls]() if walls else model is None)),
    (r"(\d+) runs entered this page; lattice, model and fluid are the first's", lambda n: int(n) == len(runs) > 1),
    (r"The Darcy velocity was averaged after the start-up, .*", lambda: any(r["method"] != "stokes" for r in runs)),
    (r"Permeability is the slope of the superficial velocity against the hydraulic gradient(, extrapolated over .*)?; errors are 95 % "
     r"half widths", lambda more: len(gradients) > 1 and (not more or len(spacings) > 1)),
    (r"Permeability is the superficial velocity over the hydraulic gradient(, extrapolated over .*)?; errors are 95 % half widths",
     lambda more: len(gradients) == 1 and (not more or len(spacings) > 1)),
    (r"The tensor of permeability is from three flows, each driven along one of x, y and z", lambda: first["tensor"]),
    (r"The error of resolution is a grid convergence index \[\d+\]", lambda: len(spacings) > 1),
    (r"The error of resolution is that of the limit of (\d+) lattices with spacings from ([\d.]+) to ([\d.]+) µm, averaged over the "
     r"orders of convergence \[\d+\](; the permeability is that limit)?",
     lambda n, coarsest, finest, limit: int(n) == len(levels) > 1 and near(coarsest, 1e6 * levels[0])
     and near(finest, 1e6 * levels[-1]) and bool(limit) == (first["method"] == "stokes")),
]

bad = []
# What a reader needs to repeat the model, and what the run leaves out, is not left unsaid.
needed = []
if scanned and model["segmented"] and model["smoothing"] > 0:
    needed.append("the labels smoothed")
if scanned and model["scanner"].get("removed") == 1:
    needed.append("blur, by the edges of the scan")
if first["method"] == "stokes" and first.get("reynolds", 0) > 0.1:
    needed.append("Inertia is left out")
if first["tensor"]:
    needed.append("from three flows")
prose = methods["text"].strip()
bad += [f"({words} is missing)" for words in needed if words not in prose]
for sentence in re.split(r"\. (?=[A-Z0-9])|\.$", prose):
    sentence = sentence.strip()
    found = [m for pattern, true in SENTENCES if (m := re.fullmatch(pattern, sentence)) and true(*m.groups())]
    if sentence and not found:
        bad.append(sentence)
cited = list(dict.fromkeys(int(n) for n in re.findall(r"\[(\d+)\]", prose)))
listed = len(methods["references"])
if cited != list(range(1, listed + 1)):
    bad.append(f"references {cited} are cited and {listed} are listed")
for line in bad:
    print(f"{page_path}: not so: {line}")
sys.exit(len(bad) > 0)
