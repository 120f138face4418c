"""Hard cases at the pore scale: methods wcsph and stokes."""
import math
import re

import numpy as np
from suite import RUNS, Run, case, engine, explain, force_power, holds, in_model, model, row, sand, slit, slit_velocity, spheres, whole

W, NU = 8e-4, 1e-6
MIDPOINT = "midpoint rule of the parabola: 0.5/N^2 (numerics.md), twice"


def half_n2(n):
    return 2 * 0.5 / n ** 2


@case("A wave of the lattice's shortest length grows once omega dt > 2 (leapfrog): dt is refused beyond, used up to, the limit", fast=True)
def dt_at_the_limit():
    limit = explain(slit(8))["dt_limit"]
    run = Run(slit(8), [f"wcsph.dt={0.95 * limit:.17g} s"])
    yield from whole(run, force_power([0.1, 0, 0]))
    yield row("k over exact at 0.95 of the limit", MIDPOINT, run.json["darcy_velocity"][0] / slit_velocity(W, 1e-3, 0.1), 1, half_n2(8))
    refused = Run(slit(8), [f"wcsph.dt={1.05 * limit:.17g} s"])
    yield row("exit code at 1.05 of the limit", "interfaces: bad input is 3", refused.code, 3, 0)
    yield holds("the message says the limit", "", "beyond the stable" in refused.message, refused.message.strip()[-150:])


def unstable(text, dt):
    """Stopped, stepped back, or, where no force feeds it, with more energy than at the start (what grows may stay within the watchdog's bounds)."""
    run = Run(text, [f"wcsph.dt={dt:.17g} s", "wcsph.force_dt=true"])
    if run.code == 4 or run.backs:
        return True
    energy = run.history["kinetic_energy"]
    return "force" not in text and energy[-1] > energy[0]


def bisected(text):
    """The step beyond which the watchdog trips, in units of h/c."""
    plan = explain(text)
    low, high = 0.6, 2.2
    for _ in range(6):
        middle = 0.5 * (low + high)
        if unstable(text, middle * plan["dt_limit"]):
            high = middle
        else:
            low = middle
    return 0.5 * (low + high) * plan["dt_limit"] * plan["sound_speed"] / (plan["support"] / 3), plan


CUBE = ('wcsph = { equation_of_state = "%s"; wall = "%s"; sound_speed = "1.5 m/s"; support = "0.29 mm"; };\n')
CUBE_END = f"{400 * 1e-4 / 1.5:.6g} s"


def cube(eos, wall):
    """A periodic cube of 8 sites a side with one grain, creeping: only sound matters."""
    return in_model(spheres(8, 0.1, 1e-4)[0], 1e-3, viscosity=1e-5, end=CUBE_END, tolerance=0, more=CUBE % (eos, wall))


def open_cube():
    """All water; one site starts with a little velocity, so that there is something to grow."""
    return ('scene = { method = "wcsph"; end_time = "%s"; steady_tolerance = 0; };\n' % CUBE_END
            + 'domain = { size = ["0.8 mm", "0.8 mm", "0.8 mm"]; spacing = "0.1 mm"; periodic = [true, true, true]; };\n'
            + 'fluids = ( { name = "water"; density = "1000 kg/m^3"; viscosity = "1e-5 Pa s"; } );\n'
            + 'regions = ( { type = "water"; box = ["0", "0", "0", "0.8 mm", "0.8 mm", "0.8 mm"]; },\n'
            + '  { type = "water"; box = ["0.3 mm", "0.3 mm", "0.3 mm", "0.4 mm", "0.4 mm", "0.4 mm"]; velocity = ["1 mm/s", "0", "0"]; } );\n'
            + 'effects = { shifting = "off"; };\n'  # it mends what grows, and the theory has none
            + CUBE % ("gauge", "subvoxel"))


def limit_of_differences():
    """c dt/h of the leapfrog with pressure diffusion D = 0.1 h c whose own pressure is taken at the end of the step: a wave k
    lives while (c G dt)^2 + 2 D L dt < 4 (1 + D L0 dt), G(k) the gradient, L(k) the Laplacian, L0 its diagonal; cubic lattice."""
    h, worst = 2.9 / 3, np.inf
    r = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3, indexing="ij"), -1).reshape(-1, 3).astype(float)
    length = np.linalg.norm(r, axis=1)
    r, length = r[(length > 0) & (length < 2.9)], length[(length > 0) & (length < 2.9)]
    q, slope = length / h, np.zeros_like(length)
    for edge, weight in ((3, 1), (2, -6), (1, 15)):
        slope += np.where(q < edge, -5 * weight * (edge - q) ** 4, 0) / (120 * np.pi * h ** 4)
    each = -2 * slope / length
    for k in np.stack(np.meshgrid(*[np.linspace(0, np.pi, 17)] * 3, indexing="ij"), -1).reshape(-1, 3)[1:]:
        phase = r @ k
        g2 = np.sum(((slope / length)[:, None] * r * np.sin(phase)[:, None]).sum(0) ** 2)
        a, b = g2 * h * h, 0.1 * h * h * (2 * (each * (1 - np.cos(phase))).sum() - 4 * each.sum())
        if a > 1e-9:
            worst = min(worst, (-b + np.sqrt(b * b + 16 * a)) / (2 * a))  # x = c dt/h: a x^2 + b x = 4
    return worst


@case("omega_max of the lattice sets dt: c dt/h about 2.2 (gauge), 1.04 (absolute), numerics.md; pressure diffusion slows the shortest waves", fast=True)
def dt_limit_by_bisection():
    for kind, text, theory in (("gauge, frozen walls", cube("gauge", "frozen"), 2.19), ("absolute, frozen walls", cube("absolute", "frozen"), 1.04),
                               ("differences of pressure, no walls", open_cube(), limit_of_differences())):
        found, plan = bisected(text)
        c = "frozen" in kind
        yield row(f"c dt/h, {kind}", "within 10 % of " + ("numerics.md" if c else "the lattice's eigenvalues"), found, theory, 0.1 * theory)
        own = plan["dt_limit"] * plan["sound_speed"] / (plan["support"] / 3)
        if c:
            yield row(f"the same over explain's limit, {kind}", "within 10 %", found / own, 1, 0.1)
        else:
            yield row(f"explain's limit beyond the one found, {kind}", "explain leaves out what diffusion allows more: never beyond", max(0.0, own / found - 1), 0, 0.1)
    RUNS.mine.clear()  # half of them are beyond their limit: what they balance means nothing


@case("Sound too slow: density loses its meaning (u/c, gL/c^2); too fast: rounding of single precision, steps without end", fast=True)
def sound_speed_from_tenth_to_ten_times():
    auto = explain(slit(8))["sound_speed"]
    for factor in (0.1, 0.3, 1, 3, 10):
        run = Run(slit(8), [f"wcsph.sound_speed={factor * auto:.17g} m/s"])
        if run.code == 4:
            yield holds(f"c x {factor:g}: given up with cause and remedy", "u/c beyond 1 is no weakly compressible flow",
                        factor < 1 and "sound speed" in run.message, run.message.strip()[-150:])
            continue
        yield from (r | {"check": f"c x {factor:g}: {r['check']}"} for r in whole(run, force_power([0.1, 0, 0])))
        yield row(f"c x {factor:g}: k over exact", "pressure plays no part in a slit; " + MIDPOINT,
                  run.json["darcy_velocity"][0] / slit_velocity(W, 1e-3, 0.1), 1, half_n2(8))


@case("100 G: velocity, not pressure head, sets c; inertia lowers k (Mei, Auriault 1991), density stays within the 1 % that c was chosen for")
def hundred_g():
    path, radius = spheres(12, 0.216, 46.6e-6)
    slow = Run(in_model(path, 9.80665e-2, method="stokes"))
    # The automatic c follows the creeping estimate of the velocity, 83 m/s; inertia leaves about 5 m/s, ten of which make c.
    fast = Run(in_model(path, 980.665, end="8 ms", tolerance=1e-2), ["wcsph.sound_speed=50 m/s"], limit=240)
    yield from whole(fast, force_power([0, 0, 980.665]))
    if fast.code:
        return
    yield holds("k falls with inertia", "Mei, Auriault 1991: the first correction lowers k", 0 < fast.json["k"] < slow.json["k"],
                f"k(100 G)/k(creeping) = {fast.json['k'] / slow.json['k']:.3f}, Re = {fast.json['reynolds']:.3g}")
    yield row("largest density over that at rest", "gL/c^2 + (u/c)^2/2 <= 1 % each", fast.history["density_max"].max() / 1000, 1, 0.02)


def duct_series(t, width, nu, g):
    """Mean velocity of a slit started from rest over its final one (Morris, Fox, Zhu 1997)."""
    n = np.arange(1, 200, 2)
    return 1 - 96 / np.pi ** 4 * np.sum(np.exp(-n ** 2 * np.pi ** 2 * nu * t / width ** 2) / n ** 4)


@case("A force from one step to the next rings sound; the mean flow must follow the exact start-up", fast=True)
def force_at_once():
    text = slit(16, tolerance=0, end="0.2 s", g=0.01)
    run = Run(text, ["output.history_interval=0.02 s"])
    yield from whole(run, force_power([0.01, 0, 0]))
    final = slit_velocity(W, 1e-3, 0.01)
    for t in (0.04, 0.1, 0.2):
        i = int(np.argmin(abs(run.history["time"] - t)))
        exact = final * duct_series(run.history["time"][i], W, NU, 0.01)
        yield row(f"mean velocity at {t:g} s over exact", "0.5/N^2 in space twice, first order in dt: nu pi^2 dt/w^2",
                  run.history["darcy_velocity"][i, 0] / exact, 1, half_n2(16) + NU * np.pi ** 2 * run.history["dt"][-1] / W ** 2)


@case("A force that turns at once or swings: what a lag of the wall's velocity would show (Womersley number 0.3 to 3)", fast=True)
def force_reversed_and_oscillating():
    for name, r in engine("force").items():
        yield row(name, "0.5/N^2 twice and first order in dt", r["measured"], r["reference"], r["bound"])


@case("Particles off their lattice by 0.4 dx: pair pressures of O(c^2) at start, voids, clumps (jitter is the largest perturbation that keeps order)", fast=True)
def jittered_start():
    for name, r in engine("jitter").items():
        yield row(name, r["why"], r["measured"], r["reference"], r["bound"])


@case("A throat of one voxel: one particle sees nothing but walls; image velocities of both sides meet", fast=True)
def throat_one_voxel_wide():
    for n in (1, 2):
        for method in ("wcsph", "stokes"):
            run = Run(slit(n, width=n * 1e-4, g=0.01, method=method))
            yield row(f"{method}, {n} wide: k over exact", "midpoint rule of the parabola on N sites, 1 + 0.5/N^2, and as much again",
                      run.json["darcy_velocity"][0] / slit_velocity(n * 1e-4, 1e-3, 0.01), 1, half_n2(n))


@case("No path: what moves is noise, and k must be 0 with its reason", fast=True)
def model_that_does_not_percolate():
    solid = np.zeros((8, 8, 8), np.uint8)
    solid[3:6] = 1
    for method in ("wcsph", "stokes"):
        run = Run(in_model(model(solid, 1e-4), 1.0, method=method))
        yield holds(f"{method}: ends well", "", run.code == 0, run.message[-150:])
        yield row(f"{method}: k", "nothing flows: exactly 0", run.json.get("k"), 0, 0)
        yield holds(f"{method}: the reason is given", "", run.json.get("status") == "blocked" and "k" in run.message, run.message.strip()[-150:])
        along = Run(in_model(model(solid, 1e-4), 1.0, method=method, axis=0))
        yield row(f"{method}: along the slit, k over exact", MIDPOINT + "; voxel faces",
                  along.json["darcy_velocity"][0] / (5 / 8 * slit_velocity(5e-4, 1e-3, 1.0)), 1, half_n2(5))


@case("Degenerate models: all grain, all pore, one pore voxel", fast=True)
def all_grain_all_pore_one_pore():
    n = 6
    for method in ("wcsph", "stokes"):
        grain = Run(in_model(model(np.ones((n, n, n)), 1e-4), 1.0, method=method))
        yield holds(f"{method}, all grain: refused or 0, with the reason", "", grain.code == 3 or grain.json.get("k") == 0, grain.message.strip()[-150:])
        solid = np.ones((n, n, n), np.uint8)
        solid[3, 3, 3] = 0
        lone = Run(in_model(model(solid, 1e-4), 1.0, method=method))
        yield holds(f"{method}, one pore: k = 0 with the reason", "", lone.code == 0 and lone.json["k"] == 0 and lone.json["status"] == "blocked",
                    lone.message.strip()[-150:])
    pore = Run(in_model(model(np.zeros((n, n, n)), 1e-4), 1.0, end="1 ms", tolerance=0))
    yield from whole(pore, force_power([0, 0, 1.0]))
    t = pore.history["time"][-1]
    yield row("wcsph, all pore: velocity over g t", "momentum balance: single precision of a sum over steps, 6e-8 sqrt(steps) and the step's own",
              pore.history["darcy_velocity"][-1, 2] / t, 1, 1e-5)
    still = Run(in_model(model(np.zeros((n, n, n)), 1e-4), 1.0, method="stokes"))
    yield holds("stokes, all pore: refused, nothing holds the water", "", still.code == 3, still.message.strip()[-150:])


def hasimoto(c):
    """Drag of simple cubic spheres over Stokes': Hasimoto 1959, Sangani, Acrivos 1982; to 1e-4 below c = .1."""
    return 1 / (1 - 1.7601 * c ** (1 / 3) + c - 1.5593 * c ** 2 + 3.9799 * c ** (8 / 3) - 3.0734 * c ** (10 / 3))


@case("Void ratio 0.1: narrow ducts in rock; 10: spheres far apart, walls are a minority")
def void_ratio_tenth_and_ten():
    n, b = 20, 6
    solid = np.ones((n, n, n), np.uint8)
    solid[:, 7:7 + b, 7:7 + b] = 0
    x = np.arange(n) + 0.5
    gap = np.minimum(x - 7, 7 + b - x)
    distance = np.minimum(gap[:, None], gap[None, :])
    outside = np.hypot(np.minimum(gap[:, None], 0), np.minimum(gap[None, :], 0))
    distance = np.where(distance > 0, distance, -outside)
    path = model(solid, 1e-4, np.broadcast_to(distance, (n, n, n)) * 1e-4)
    exact = (b * 1e-4) ** 4 / 12 * 0.421731 / (n * 1e-4) ** 2
    for method in ("stokes", "wcsph"):
        run = Run(in_model(path, 0.01, method=method))
        yield row(f"{method}, e = 0.099, square duct of 6 sites: k over exact", "0.5/N^2 in both directions, twice",
                  run.json["intrinsic_permeability"] / exact, 1, 2 * half_n2(b))
    c = 1 / 11
    for method, n in (("stokes", 20), ("wcsph", 14)):
        path, radius = spheres(n, c, 1e-4)
        exact = 2 * radius ** 2 / (9 * c * hasimoto(c))
        run = Run(in_model(path, 0.01, method=method, tolerance=1e-2, end="5 s"))
        yield row(f"{method}, e = 10, spheres of {2 * radius * 1e4:.1f} sites: k over exact", "1 % at 24 sites a side (verification.md), as 1/n^2",
                  run.json["intrinsic_permeability"] / exact, 1, 0.01 * (24 / n) ** 2)


@case("Viscosity over eleven decades at one Reynolds number: no hidden scale, no underflow of single precision", fast=True)
def viscosity_1e_8_to_1e3():
    for mu in (1e-8, 1e-5, 1e-2, 1, 1e3):
        nu = mu / 1000
        g = 0.01 * 12 * nu ** 2 / W ** 3  # Re = u w / nu = 0.01
        for method in ("wcsph", "stokes"):
            run = Run(slit(8, viscosity=mu, g=g, method=method, end=f"{2 * W * W / nu:.6g} s"))
            if run.code:
                yield holds(f"{method}, mu = {mu:g} Pa s", "", False, run.message.strip()[-150:])
                continue
            yield row(f"{method}, mu = {mu:g} Pa s: k over exact", MIDPOINT, run.json["darcy_velocity"][0] / slit_velocity(W, mu, g), 1, half_n2(8))


@case("Inertia: drag grows as Re^2 first (Mei, Auriault 1991; Hill, Koch, Ladd 2001), then about as Re; wakes need shifting")
def reynolds_up_to_200():
    n, dx = 12, 1e-4
    path, radius = spheres(n, 0.216, dx)
    creeping = 2 * radius ** 2 / (9 * 0.216 * 7.4419)  # m^2
    d, drag = 2 * radius, {}
    for re in (0.001, 1, 20, 60, 200):
        guess = re * NU / d * NU / creeping * (1 + 0.02 * re)
        c = f"wcsph.sound_speed={max(30 * re * NU / d, math.sqrt(guess * n * dx / 0.01)):.6g} m/s"  # u_max about 3 u
        run = Run(in_model(path, guess, tolerance=1e-2, end="1 s" if re < 10 else "0.15 s"), [c] * (re > 10), limit=240)
        yield from (r | {"check": f"Re about {re:g}: {r['check']}"} for r in whole(run, force_power([0, 0, guess])))
        if run.code:
            continue
        u = run.json["darcy_velocity"][2]
        drag[re] = (u * d / NU, guess * creeping / (NU * u))
    base = drag[0.001][1]
    yield row("Re 0.001: drag over exact", "1 % at 24 sites a side (verification.md), as 1/n^2", base, 1, 0.01 * (24 / n) ** 2)
    grows = [f / base for _, f in drag.values()]
    yield holds("drag grows with Re", "k falls with inertia", all(b > a - 0.01 for a, b in zip(grows, grows[1:])),
                ", ".join(f"Re {r:.3g}: {f / base:.3f}" for r, f in drag.values()))


def published_drag(phi, re):
    """Mean force on a sphere of a random array over 3 pi mu d U (U superficial, the mean pressure gradient's share with it), re = U d/nu:
    Hill, Koch, Ladd 2001 (J. Fluid Mech. 448, 243; F_0, and F_2 + F_3 Re beyond Re of about 4, theirs with the radius), and Beetstra,
    van der Hoef, Kuipers 2007 (AIChE J. 53, 489; theirs without that share, so over 1 - phi). Both from lattice-Boltzmann runs. As MFIX has them
    (DRAG_KOCH_HILL, DRAG_BVK); at Re = 0 and phi > .4 both are Carman's k."""
    eps, w = 1 - phi, math.exp(-10 * (0.4 - phi) / phi)

    def creeping(a, b, c):
        return (1 - w) * (1 + 3 * math.sqrt(phi / 2) + 135 / 64 * phi * math.log(phi) + a * phi) / (1 + 0.681 * phi - b * phi ** 2 + c * phi ** 3) + w * 10 * phi / eps ** 3
    hill = creeping(17.14, 8.48, 8.16) if re == 0 else creeping(17.89, 11.03, 15.41) + (0.0673 + 0.212 * phi + 0.0232 / eps ** 5) * re / 2
    inertia = 0.413 * re / (24 * eps ** 2) * (1 / eps + 3 * eps * phi + 8.4 * re ** -0.343) / (1 + 10 ** (3 * phi) * re ** (-(1 + 4 * phi) / 2)) if re else 0
    return hill, (10 * phi / eps ** 2 + eps ** 2 * (1 + 1.5 * math.sqrt(phi)) + inertia) / eps


def random_spheres(seed, n, diameter, side):
    """side^3 equal spheres in a periodic box of n sites: hard spheres in equilibrium, by Monte Carlo from a lattice. Their model."""
    random, x = np.random.default_rng(seed), np.arange(n) + 0.5
    centres = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3) * (n / side)
    for i in np.tile(np.arange(side ** 3), 1000):
        moved = (centres[i] + random.uniform(-0.3 * diameter, 0.3 * diameter, 3)) % n
        apart = np.delete(centres, i, 0) - moved
        apart -= n * np.round(apart / n)
        if (np.sum(apart ** 2, 1) > diameter ** 2).all():
            centres[i] = moved
    distance = np.full((n, n, n), np.inf)
    for centre in centres:
        a = [np.minimum(np.abs(x - c), n - np.abs(x - c)) for c in centre]
        distance = np.minimum(distance, np.sqrt(a[2][:, None, None] ** 2 + a[1][None, :, None] ** 2 + a[0][None, None, :] ** 2) - diameter / 2)
    return model(distance <= 0, 1e-4, distance * 1e-4)


@case("Forchheimer's law in random spheres (phi .3, Re 40 and 80): wakes in narrow pores, a flow that no symmetry steadies")
def forchheimer_in_random_spheres():
    phi, n, side, dx, arrays = 0.3, 19, 2, 1e-4, 6
    sites = n / side * (6 * phi / math.pi) ** (1 / 3)  # across a sphere
    d, drag = sites * dx, []
    for seed in range(1, arrays + 1):
        path = random_spheres(seed, n, sites, side)
        stokes = Run(in_model(path, 1e-6, method="stokes"))
        drag.append([(0, d * d / (18 * phi * stokes.json["intrinsic_permeability"]))])
        for re in (40, 80):
            u = re * NU / d
            g = 18 * NU * phi * np.mean(published_drag(phi, re)) * u / d ** 2
            # The largest velocity is about 4 u, and a step of .05 dx/u is a fifth of a spacing there.
            run = Run(in_model(path, g, tolerance=0, end=f"{6 * d / u:.6g} s"), [f"wcsph.sound_speed={40 * u:.6g} m/s", f"wcsph.dt={0.05 * dx / u:.6g} s"])
            yield from (r | {"check": f"array {seed}, Re {re}: {r['check']}"} for r in whole(run, force_power([0, 0, g])))
            if run.code:
                return
            u = run.history["darcy_velocity"][run.history["time"] > 4 * d / u, 2].mean()
            drag[-1].append((u * d / NU, g * d * d / (18 * NU * phi * u)))
    creeping, slopes, wanted = [], [], []
    for (_, f0), (r1, f1), (r2, f2) in drag:
        creeping.append(f0)
        slopes.append((f2 - f1) / (r2 - r1) / f0)
        wanted.append((np.array(published_drag(phi, r2)) - published_drag(phi, r1)) / (r2 - r1) / published_drag(phi, 0))
    for what, found, (hill, beetstra) in (("creeping drag over that of a lone sphere", creeping, published_drag(phi, 0)),
                                          ("Forchheimer's coefficient, d(k(0)/k)/d Re", slopes, np.mean(wanted, 0))):
        middle = 0.5 * (hill + beetstra)
        error = 2 * np.std(found, ddof=1) / math.sqrt(arrays)
        yield row(f"{what}, mean of {arrays} arrays of {side ** 3}", f"half-way between Hill et al. ({hill:.4g}) and Beetstra et al. ({beetstra:.4g}): half of what they differ, 10 % (what Beetstra et al. "
                  f"say their data scatter), two standard errors of the mean ({error:.2g}); {sites:.1f} sites across a sphere: 1 % at 24 sites a side as 1/n^2",
                  np.mean(found), middle, 0.5 * abs(hill - beetstra) + (0.1 + 0.01 * (24 * (0.216 * 6 / math.pi) ** (1 / 3) / sites) ** 2) * middle + error)


@case("A million steps: rounding of single precision, drift of the mean pressure, order of the particles")
def million_steps():
    # Two runs of 12 particles: the end of the long one against the end of the short one.
    text = slit(4, width=4e-4, g=1.0, tolerance=0, length=6)
    dt = explain(text)["dt"]
    short, long = (Run(text.replace('"1 s"', f'"{dt * steps:.9g} s"'), [f"output.history_interval={dt * steps / 200:.9g} s"]) for steps in (2e4, 1e6))
    yield from whole(long, force_power([1.0, 0, 0]))
    yield row("steps", "", float(long.json["steps"]), 1e6, 1e3)
    a, b = (np.mean(r.history["darcy_velocity"][-100:, 0]) for r in (short, long))
    yield row("mean velocity, last half of 1e6 steps over that of 2e4", "the scheme's own error, 0.5/N^2, must not grow by as much", b / a, 1, 0.5 / 16)
    yield row("velocity over exact after a million steps", "0.5/N^2 twice", b / slit_velocity(4e-4, 1e-3, 1.0), 1, half_n2(4))
    yield row("mean density over that at rest", "mean pressure is held at 0: single precision", long.history["density_mean"][-1] / 1000, 1, 1e-4)


@case("P = c^2 rho puts c^2 rho_0 behind every pair: the particles lock into a crystal that does not flow (S06 corrected)", fast=True)
def absolute_equation_of_state():
    path = sand(12, 46.6e-6)
    more = 'wcsph = { equation_of_state = "%s"; wall = "frozen"; sound_speed = "1.5 m/s"; };\n'
    flows, locked = (Run(in_model(path, 9.80665, end="0.1 s", tolerance=0, more=more % eos)) for eos in ("gauge", "absolute"))
    yield holds("the crystal is detected and named", "k of a body that does not flow is none",
                locked.code in (0, 4) and "crystal" in locked.message, locked.message.strip()[-150:] or f"k = {locked.json.get('k')}")
    yield holds("the gauge form flows", "", flows.code == 0 and flows.json["k"] > 0 and "crystal" not in flows.message,
                f"k = {flows.json.get('k')}")


@case("Tensile instability and shear without viscosity: Taylor-Green at Re 1000, energy known (exp(-16 pi^2 t/Re))")
def taylor_green_re_1000():
    for name, r in engine("vortex").items():
        yield row(name, r["why"], r["measured"], r["reference"], r["bound"])


@case("Single precision: forces are sums of near-opposite numbers; condition number of the slit's operator about (N/pi)^2", fast=True)
def single_against_double():
    n = 16
    exact = lattice_slit(n, W, NU, 1e-6)
    run = Run(slit(n, g=1e-6, tolerance=0, end="1.5 s", more='wcsph = { wall = "frozen"; sound_speed = "0.05 m/s"; };\n'))
    steps = run.json["steps"]
    yield row("frozen slit of 16: flow over the same lattice equations in double precision", "6e-8 a step over the flow's memory, w^2/(pi^2 nu dt) steps",
              run.history["darcy_velocity"][-1, 0] / exact, 1, max(6e-8 * (W + W / n) ** 2 / (np.pi ** 2 * NU * run.history["dt"][-1]), 1e-6) + math.exp(-np.pi ** 2 * NU * 1.5 / (W + W / n) ** 2))


def quintic_slope(r, h):
    """W'(r) in two dimensions."""
    q, alpha = r / h, 7 / (478 * np.pi * h ** 2)
    out = np.zeros_like(q)
    for edge, weight in ((3, 1), (2, -6), (1, 15)):
        out += np.where(q < edge, -5 * weight * (edge - q) ** 4, 0)
    return alpha * out / h


def quintic(r, h):
    q, alpha = r / h, 7 / (478 * np.pi * h ** 2)
    out = np.zeros_like(q)
    for edge, weight in ((3, 1), (2, -6), (1, 15)):
        out += np.where(q < edge, weight * (edge - q) ** 5, 0)
    return alpha * out


def lattice_slit(n, width, nu, g):
    """Mean velocity of frozen walls on the undisturbed lattice, solved in double precision."""
    dx = width / n
    h = 2.9 * dx / 3
    i, k = np.meshgrid(np.arange(-3, 4), np.arange(-3, 4), indexing="ij")
    r = dx * np.hypot(i, k)
    inside = (r > 0) & (r < 3 * h)
    c = np.where(inside, -2 * dx * dx * nu * quintic_slope(np.where(r > 0, r, 1), h) / np.where(r > 0, r, 1), 0)
    density = dx * dx * quintic(r, h).sum()
    weight = c.sum(axis=0) / density ** 2
    a = np.zeros((n, n))
    for row_ in range(n):
        for d in range(-3, 4):
            if d == 0:
                continue
            a[row_, row_] += weight[d + 3]
            if 0 <= row_ + d < n:
                a[row_, row_ + d] -= weight[d + 3]
    return np.linalg.solve(a, np.full(n, g)).mean()
