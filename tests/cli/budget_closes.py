"""budget_closes.py, in the folder of runs flow, pore, slit and creep: their budgets close as far as arithmetic lets them."""
import h5py, numpy as np
def of(name):
    file = h5py.File(name + ".hdf")
    budget = file["run/ledger"]
    rows = dict(zip(budget["term"].asstr()[:], zip(budget["impulse"][:], budget["work"][:]))) if "term" in budget else {}
    return file, budget.attrs, rows
for name in "flow", "pore":
    _, l, _ = of(name)
    n = {k: int(l["particles_" + k]) for k in ("start", "entered", "left", "lost", "end", "open")}
    assert n["open"] == 0 and n["start"] + n["entered"] - n["left"] - n["lost"] == n["end"], n
    # As many masses added, each rounded by 2^-53 of the sum at most.
    assert abs(l["mass_open"]) <= sum(n.values()) * 2**-53 * l["mass_start"], l["mass_open"]
    assert all(k in l for k in ("momentum_start", "momentum_end", "impulse_of_force", "work_of_force", "energy_taken"))
flow, l, terms = of("flow")
assert l["particles_left"] > 0
# Both are identities, of products of some ten factors added over 64 particles, chunks and steps: 2^-53 for each, in each term.
rounding = (len(terms) + 1) * (10 + 64 + 402 / 64 + flow["run"].attrs["steps"]) * 2**-53
assert l["energy_open_share"] < rounding and l["momentum_open_share"] < rounding, dict(l)
# What heads give soil and walls take, the walls by the pressure at their faces, which is known to half a spacing of the ten
# that the water is deep.
assert np.abs(terms["projection"][0]).max() < 0.05 * np.abs(terms["force"][0]).max(), terms
assert terms["drag_linear"][1] < 0 and terms["open_sides"][1] > 0 and "turbulence" not in terms, terms
# What is left is what samples may miss and rounding: velocities of 24 bits, in each step, of which sum m |v| is at most
# sqrt(2 T M), and pressures of 24 bits, whose energy is at most that of the end, the flow starting from rest.
pore, l, terms = of("pore")
kinetic, mass, steps = pore["history/kinetic_energy"][:].max(), l["mass_end"], pore["run"].attrs["steps"]
momentum_rounding, energy_rounding = steps * 2**-24 * (2 * kinetic * mass) ** 0.5, steps * 2**-24 * 2 * (kinetic + l["energy_end"])
assert np.linalg.norm(l["momentum_open"]) <= l["momentum_sampling_error"] + momentum_rounding, (dict(l), momentum_rounding)
assert abs(l["energy_open"]) <= l["energy_sampling_error"] + energy_rounding, (dict(l), energy_rounding)
# Frozen grains: action is reaction, pair by pair, of 102 pairs added with 24 bits; pressures are at most the force's over the
# box of 13 spacings, and the sum of V |grad W| is 2.28/h = 2.28 / .967 spacings.
assert np.abs(terms["projection"][0]).max() <= 102 * 2**-24 * 2 * 13 * 2.28 / 0.967 * np.abs(terms["force"][0]).max(), terms
for name in "slit", "creep":
    file, l, _ = of(name)
    residual, count = file["run"].attrs["residual"], file["run"].attrs["fluid_count"]
    # A sum of N residuals is at most N of their rms, the solver's own; their work sqrt N of it.
    assert 0 <= l["force_open"] < residual and 0 <= l["power_open"] < residual * count**0.5, (name, residual, dict(l))
    if name == "slit": # through planes that are equal: what residuals make of velocities, the largest 1.5 times the mean
        assert l["flux_open"] < 1.5 * count**0.5 * residual, (residual, dict(l))
# Of a sand of few sites the plain sums over planes leave out the walls' shares within a site: of a site beside a wall at most
# half.
solid, snapshot = file["run/solid"][:] > 0, h5py.File("creep-0000.hdf")["VTKHDF"]
at = np.rint((snapshot["Points"][:] - file["run"].attrs["origin"]) / file["run"].attrs["spacing"]).astype(int).T[::-1]
speed, beside = np.zeros(solid.shape), np.zeros(solid.shape, bool)
speed[tuple(at)] = snapshot["PointData/velocity"][:, 2]
for axis in range(3):
    beside |= np.roll(solid, 1, axis) | np.roll(solid, -1, axis)
share = 0.5 * np.abs(speed * beside).sum((1, 2)) / abs(speed.sum((1, 2)).mean())
assert l["flux_open"] < np.sqrt((share**2).mean()), (l["flux_open"], share)
