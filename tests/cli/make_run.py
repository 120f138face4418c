#!/usr/bin/python3
"""Writes made-up runs (OUT.hdf, OUT-0000.hdf) from docs/formats.md alone, for the tests of analyze.

make_run.py OUT.hdf [key=value ...] [-- OUT.hdf ...]; keys and defaults below. The flow is that of a slit between grains at low
and high x: parabola v(x), driven along -z, so that every number analyze prints is known.
"""
import sys
import h5py
import numpy as np

DEFAULTS = dict(k=1.5e-3, i=1.0, n=20, rows=200, tau=0.005, end=0.1, noise=0.0, hash="0x1234", name="slit", method="wcsph",
                wall="subvoxel", snapshots=1, density=1000.0, viscosity=1e-3, drift=0.0, spacing=4.6e-5, k_error=0.01,
                b=0.0, gauge=0, wall_time=12.5, model="slit.hdf", status="steady", driving=1.0, solid=1,
                levels=0, pressure=0.0, resolution=0.0)


def make(out, *words):
    o = dict(DEFAULTS)
    for item in words:
        key, value = item.split("=", 1)
        if key not in o:
            sys.exit(f"make_run.py: unknown key {key}")
        o[key] = type(o[key])(value)
    n, dx = o["n"], o["spacing"]
    rng = np.random.default_rng(7)

    # darcy velocity v along -z: i = v/k + b v^2
    v = o["k"] * o["i"] if o["b"] == 0 else (-1 / o["k"] + np.sqrt(1 / o["k"] ** 2 + 4 * o["b"] * o["i"])) / (2 * o["b"])
    t = np.linspace(0, o["end"], o["rows"])
    series = v * (1 - np.exp(-t / o["tau"])) * (1 + o["noise"] * rng.standard_normal(t.size)) + o["drift"] * v * t / o["end"]

    solid = np.zeros((n, n, n), np.uint8)
    solid[:, :, : n // 4] = 1
    solid[:, :, n - n // 4 :] = 1
    z, y, x = np.nonzero(solid == 0)
    gap = n - 2 * (n // 4)
    s = (x - n // 4 + 0.5) / gap
    velocity = np.zeros((x.size, 3))
    profile = 6 * s * (1 - s)
    velocity[:, 2] = -v * n / gap * profile / profile.mean()

    with h5py.File(out, "w") as f:
        def column(name, values, unit):
            f["/history/" + name] = values
            f["/history/" + name].attrs["unit"] = np.bytes_(unit)
        column("time", t, "s")
        column("step", np.arange(t.size, dtype=float), "-")
        column("dt", np.full(t.size, t[1] - t[0] if t.size > 1 else 1.0), "s")
        column("darcy_velocity", np.stack([0 * t, 0 * t, -series], 1), "m/s")
        column("density_max", 1000 * (1 + 0.01 * o["i"] * (1 - np.exp(-t / o["tau"]))), "kg/m^3")
        if o["gauge"]:
            column("gauge_inlet", 100 * t, "Pa")
        r = f.create_group("run")
        a = r.attrs
        for key in ("method", "wall", "status"):
            a[key] = np.bytes_(o[key])
        a["scene_name"], a["model_path"], a["model_hash"] = np.bytes_(o["name"]), np.bytes_(o["model"]), np.bytes_(o["hash"])
        a["k"], a["k_error"], a["hydraulic_gradient"] = v / (o["i"] or 1), o["k_error"], o["i"]
        a["intrinsic_permeability"] = v / (o["i"] or 1) * o["viscosity"] / o["density"] / 9.80665
        a["darcy_velocity"] = [0.0, 0.0, -v]
        a["driving"] = [0.0, 0.0, -9.80665 * o["i"] * o["driving"]]
        a["density"], a["viscosity"] = o["density"], o["viscosity"]
        a["spacing"], a["origin"] = [dx] * 3, [dx / 2] * 3
        a["size"], a["dimensions"] = np.array([n] * 3, np.uint64), 3
        a["bulk_count"], a["fluid_count"], a["wall_count"] = n**3, x.size, n**3 - x.size
        a["steps"] = 1000
        text = h5py.string_dtype()
        if o["solid"]:
            r["solid"] = solid
        if o["levels"]:  # four lattices, and an interval of the run's own
            h = dx * np.array([4, 3, 2, 1.0])
            r["levels/spacing"], r["levels/k"] = h, o["k"] * (1 + (h / dx) ** 2 / 50)
            r["levels/iterations"], r["levels/seconds"] = [20.0, 25, 30, 40], [0.1, 0.4, 2, 20]
            a["k_low"], a["k_high"], a["k_finest"] = 0.9 * o["k"], 1.2 * o["k"], 1.02 * o["k"]
        if o["resolution"]:
            r.create_group("error").attrs["resolution"] = o["resolution"]
        r["scene"] = 'scene = { name = "%s"; };' % o["name"]
        e = r.create_group("effects")
        e.create_dataset("name", data=["body_force", "turbulence"], dtype=text)
        e.create_dataset("state", data=["on", "off"], dtype=text)
        e.create_dataset("reason", data=["a force drives the flow", "Re = 0.2 < 1000"], dtype=text)
        e.create_dataset("model", data=["constant acceleration", "Smagorinsky"], dtype=text)
        e.create_dataset("citation", data=["", "Smagorinsky 1963"], dtype=text)
        r.create_dataset("timing/name", data=["pairs", "output"], dtype=text)
        r["timing/seconds"] = [11.0, 1.5]
        r["timing"].attrs["wall_time"] = o["wall_time"]
        if o["snapshots"]:
            base = out.rsplit("/", 1)[-1][: -len(".hdf")]
            r.create_dataset("snapshots/name", data=[base + "-0000.hdf"], dtype=text)
            r["snapshots/time"] = [o["end"]]
        p = f.create_group("provenance")
        p.attrs["program"], p.attrs["version"], p.attrs["schema_version"] = np.bytes_("sphsolve"), np.bytes_("0.1.0"), 1
        p.attrs["command_line"] = np.bytes_("sphsolve run slit.cfg -o slit")
        p.attrs["host"], p.attrs["time"] = np.bytes_("test"), np.bytes_("2026-01-01T00:00:00Z")
        p.create_dataset("input_files", data=["slit.cfg"], dtype=text)
        p.create_dataset("input_hashes", data=["00000000000000ff"], dtype=text)

    if o["snapshots"]:
        with h5py.File(out[: -len(".hdf")] + "-0000.hdf", "w") as f:
            f.attrs["time"], f.attrs["step"] = o["end"], 1000
            f["/VTKHDF/Points"] = (np.stack([x, y, z], 1) + 0.5) * dx
            f["/VTKHDF/PointData/velocity"] = velocity
            if o["pressure"]:
                f["/VTKHDF/PointData/pressure"] = 100 * o["pressure"] * np.cos(2 * np.pi * (x + z) / n)
            f["/VTKHDF/PointData/density"] = 1000 * (1 + 0.01 * o["i"] * rng.random(x.size))


runs = [[]]
for word in sys.argv[1:]:
    runs.append([]) if word == "--" else runs[-1].append(word)
for run in runs:
    if run:
        make(*run)
