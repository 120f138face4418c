"""A second scan simulator, which shares no model with ct2model or data-samples: parallel projections of a body (a cylinder of
grains in air), a detector spread with tails that is no Gaussian, fringes, photon noise, gains that make rings, two photon
energies, a smoothing or a Paganin filter, filtered back projection, 8 or 16 bit. `draw` gives bodies and scanners by seed, `make`
writes the scan and the true grains, and returns what the scan really is: transfer, contrast over noise, correlation of the noise.
Needs numpy. Lengths in voxels of the scan unless said."""
import math
import os
import random

import numpy as np

FINER = 2  # true voxels along a voxel of the scan
FOUND = 10  # slices beyond the scan at either end, which spreads and filters reach
BODIES = "sand round fines polyhedra sintered minerals".split()


def draw(seed):
    """Body and scanner of a seed."""
    r = random.Random(seed * 6007)
    spread = r.uniform(0.6, 2.2)
    filters = [("none", 0.0), ("gauss", r.uniform(0.6, 1.1)), ("paganin", r.uniform(0.7, 1.6)), ("hann", 0.0)][seed % 4]
    return {"seed": seed, "body": BODIES[seed // 2 % 6], "void_ratio": r.uniform(0.6, 0.95), "grain": r.uniform(18, 30), "spread": spread,
            "tail": r.choice([0, r.uniform(0.05, 0.25)]), "tail_length": spread * r.uniform(1.5, 3), "fringe": r.choice([0, 0.4]) if filters[0] != "paganin" else r.uniform(0.7, 1.3),
            "filter": filters[0], "filter_length": filters[1], "contrast_to_noise": 5 * 5 ** r.random(), "ring": r.choice([0, 0.02, 0.05]),
            "hardening": r.choice([0, 0, 0.15]), "bits": r.choice([8, 16]), "pore": r.uniform(0.05, 0.4)}


# ---- bodies: bool arrays [z][y][x], FINER times as fine as the scan ----

def coordinates(shape):
    return np.meshgrid(*((np.arange(n) + 0.5) / FINER for n in shape), indexing="ij", sparse=True)


def scattered(rng, box, apart):
    points = np.empty((0, 3))
    for _ in range(30000):
        p = rng.uniform(0, 1, 3) * box
        if not len(points) or (((points - p) ** 2).sum(1) > apart ** 2).all():
            points = np.vstack([points, p])
    return points


def ball_box(p, reach, shape):
    return tuple(slice(max(0, int((p[a] - reach) * FINER)), min(shape[a], int((p[a] + reach) * FINER) + 1)) for a in range(3))


def polyhedra(rng, shape, grain):
    """By what each Voronoi cell must be shrunk about its own point to reach a voxel: plane walls, nearly parallel gaps."""
    box = np.array(shape) / FINER
    points = scattered(rng, box + grain, 0.75 * grain) - 0.5 * grain
    level = np.full(shape, 9, np.float32)
    axes = [(np.arange(n, dtype=np.float32) + 0.5) / FINER for n in shape]
    for i, p in enumerate(points):
        d = points - p
        far = (d ** 2).sum(1)
        at = ball_box(p, 1.1 * grain, shape)
        if any(s.start >= s.stop for s in at):
            continue
        z, y, x = (axes[a][at[a]] - np.float32(p[a]) for a in range(3))
        own = np.zeros((len(z), len(y), len(x)), np.float32)
        for j in np.where((far > 0) & (far < (2 * grain) ** 2))[0]:
            u = (2 * d[j] / far[j]).astype(np.float32)
            np.maximum(own, (z * u[0])[:, None, None] + (y * u[1])[:, None] + (x * u[2]), out=own)
        np.minimum(level[at], own * np.float32(rng.uniform(0.93, 1.07)), out=level[at])
    return level


def sintered(rng, shape, grain):
    """Balls of several sizes, grown until they overlap, with rounded necks: a level set of a sum over them."""
    box = np.array(shape) / FINER
    points = scattered(rng, box + grain, 0.72 * grain) - 0.5 * grain
    total = np.zeros(shape, np.float32)
    axes = [(np.arange(n, dtype=np.float32) + 0.5) / FINER for n in shape]
    for p in points:
        radius = 0.5 * grain * rng.uniform(0.8, 1.2)
        at = ball_box(p, 2.2 * radius, shape)
        if any(s.start >= s.stop for s in at):
            continue
        z, y, x = (axes[a][at[a]] - np.float32(p[a]) for a in range(3))
        square = (z ** 2)[:, None, None] + (y ** 2)[:, None] + x ** 2
        total[at] += np.exp(8 * (1 - square / np.float32(radius ** 2)))
    return -np.log(total + 1e-30)


def solid_of(kind, request, shape, inside, folder, call):
    rng = np.random.default_rng(request["seed"])
    if kind in ("polyhedra", "sintered"):
        level = (polyhedra if kind == "polyhedra" else sintered)(rng, shape, request["grain"])
        return level < np.quantile(level[inside], 1 / (1 + request["void_ratio"]))
    options = {"round": ["--grains", "round"], "fines": ["--fines", "0.1"]}.get(kind, [])
    truth = os.path.join(folder, "projected-truth.raw")
    call("generate_sand", "--quiet", "--output", os.path.join(folder, "projected-sand"), "--size", "x".join(str(n // FINER) for n in shape[::-1]), "--truth", truth,
         "--truth-refine", FINER, "--seed", request["seed"], "--void-ratio", request["void_ratio"], "--grain-size", "%.4fum" % (5 * request["grain"]),
         "--voxel-size", "5um", *options)
    solid = np.fromfile(truth, np.uint8).reshape(shape) > 0
    os.remove(truth)
    return solid


def minerals(rng, solid, grain):
    """Greys of grains: cells of random points share one; most differ by some per cent, a few are much heavier."""
    shape = tuple(n // FINER for n in solid.shape)
    points = scattered(rng, np.array(shape), 0.8 * grain)
    grey = np.where(rng.random(len(points)) < 0.03, 2.2, 1 + 0.05 * rng.standard_normal(len(points))).astype(np.float32)
    best, out = np.full(shape, 1e9, np.float32), np.ones(shape, np.float32)
    axes = [np.arange(n, dtype=np.float32) + 0.5 for n in shape]
    for p, g in zip(points, grey):
        at = tuple(slice(max(0, int(p[a] - 1.3 * grain)), int(p[a] + 1.3 * grain) + 1) for a in range(3))
        z, y, x = (axes[a][at[a]] - np.float32(p[a]) for a in range(3))
        square = (z ** 2)[:, None, None] + (y ** 2)[:, None] + x ** 2
        nearer = square < best[at]
        best[at][nearer] = square[nearer]
        out[at][nearer] = g
    return out


# ---- the scanner ----

def projections(body, angles):
    """[angle][z][t] of body[z][y][x]: line integrals through its middle, bilinear between voxels."""
    nz, n, _ = body.shape
    rows = np.ascontiguousarray(body.transpose(1, 2, 0)).reshape(n * n, nz)
    t = np.arange(n) - 0.5 * (n - 1)
    out = np.empty((len(angles), nz, n), np.float32)
    for i, angle in enumerate(angles):
        c, s = math.cos(angle), math.sin(angle)
        total = np.zeros((n, nz), np.float32)
        for along in t:
            x, y = t * c - along * s + 0.5 * (n - 1), t * s + along * c + 0.5 * (n - 1)
            x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
            use = (x0 >= 0) & (y0 >= 0) & (x0 < n - 1) & (y0 < n - 1)
            if not use.any():
                continue
            x, y, x0, y0 = x[use], y[use], x0[use], y0[use]
            u, v, at = (x - x0).astype(np.float32)[:, None], (y - y0).astype(np.float32)[:, None], y0 * n + x0
            total[use] += (1 - v) * ((1 - u) * rows[at] + u * rows[at + 1]) + v * ((1 - u) * rows[at + n] + u * rows[at + n + 1])
        out[i] = total.T
    return out


def back_projection(sinogram, angles, side):
    """The inner side^2 pixels of each slice from filtered projections [angle][z][t]."""
    _, nz, n = sinogram.shape
    at = np.arange(side) - 0.5 * (side - 1)
    out = np.zeros((side * side, nz), np.float32)
    for p, angle in zip(sinogram, angles):
        t = (at[None, :] * math.cos(angle) + at[:, None] * math.sin(angle) + 0.5 * (n - 1)).ravel()
        low = np.floor(t).astype(int)
        u, columns = (t - low).astype(np.float32)[:, None], np.ascontiguousarray(p.T)
        out += (1 - u) * columns[low] + u * columns[low + 1]
    return (out * np.float32(math.pi / len(angles))).reshape(side, side, nz).transpose(2, 0, 1)


def filtered(images, transfer):
    """Images [..][z][t], extended by reflection, times transfer(q_z, q_t), wavenumbers in radians per voxel."""
    nz, nt = images.shape[-2:]
    wide = np.pad(images, [(0, 0)] * (images.ndim - 2) + [(16, 16), (nt // 2, nt // 2)], mode="edge")
    qz, qt = 2 * math.pi * np.fft.fftfreq(wide.shape[-2]), 2 * math.pi * np.fft.rfftfreq(wide.shape[-1])
    h = transfer(qz[:, None], qt[None, :])
    out = np.empty(images.shape, np.float32)
    for i in range(len(wide)):
        out[i] = np.fft.irfft2(np.fft.rfft2(wide[i]) * h, wide.shape[-2:])[16:16 + nz, nt // 2:nt // 2 + nt]
    return out


def detector(request):
    s, w, l = request["spread"], request["tail"], request["tail_length"]
    fringe = request["fringe"] * (request["filter_length"] ** 2 if request["filter"] == "paganin" else s * s)
    return lambda qz, qt: ((1 - w) * np.exp(-0.5 * s * s * (qz ** 2 + qt ** 2)) + w * (1 + l * l * (qz ** 2 + qt ** 2)) ** -1.5) * (1 + fringe * (qz ** 2 + qt ** 2))


def reconstruct(counts, angles, request, side):
    """Slices from intensities over that of the beam. Paganin's filter comes before the logarithm (Paganin 2002, eq. 10)."""
    kind, length = request["filter"], request["filter_length"]
    if kind == "paganin":
        counts = filtered(counts, lambda qz, qt: 1 / (1 + length ** 2 * (qz ** 2 + qt ** 2)))
    attenuation = -np.log(np.maximum(counts, 1e-4)).astype(np.float32)

    def transfer(qz, qt):
        square = qz ** 2 + qt ** 2
        h = np.abs(qt) / (2 * math.pi) * np.ones_like(qz)
        h[:, 0] = 0.25 * qt[0, 1] / (2 * math.pi)  # the integral of the ramp over the first bin
        if kind == "gauss":
            h = h * np.exp(-0.5 * length ** 2 * square)
        if kind == "hann":
            h = h * (0.5 + 0.5 * np.cos(np.minimum(np.abs(qt), math.pi)))
        return h

    return back_projection(filtered(attenuation, transfer), angles, side)


def scan_of(body, request, side, rng):
    n = body.shape[1]
    angles = np.arange(int(1.5 * n)) * math.pi / int(1.5 * n)
    scale = 1.0 / (0.6 * n)  # attenuation of a voxel of grain: 1 across the body
    paths = projections(body, angles) * np.float32(scale)
    if request["hardening"]:
        h = request["hardening"]
        paths = -np.log(0.5 * np.exp(-(1 + h) * paths) + 0.5 * np.exp(-(1 - h) * paths))
    beam = np.maximum(filtered(np.exp(-paths), detector(request)), 1e-3)
    # Photons for the contrast over noise that is asked for: the noise of a few slices, scaled.
    few, photons = beam[:, :24], 1e4
    noise = (reconstruct(rng.poisson(few * photons) / photons, angles, request, side) - reconstruct(few, angles, request, side))[8:16]
    wanted = scale * (1 - request["pore"]) / request["contrast_to_noise"]
    photons *= (noise.std() / wanted) ** 2
    counted = rng.poisson(beam * photons) / photons
    gain = rng.standard_normal((1, beam.shape[1], n)) * 0.3 + rng.standard_normal((1, 1, n))
    gain = 1 + request["ring"] * gain.astype(np.float32) * 0.02
    return [reconstruct((counts * gain).astype(np.float32), angles, request, side) / np.float32(scale) for counts in (counted, beam)]


# ---- what the scan is, from scan and body ----

def facts(scan, clean, body):
    """Transfer by wavenumber (radians per voxel) of the scan without noise against the body averaged over voxels; noise."""
    shape = scan.shape
    window = np.ones(shape)
    for a, n in enumerate(shape):
        window = window * np.hanning(n + 2)[1:-1].reshape([-1 if i == a else 1 for i in range(3)])
    o, r = (np.fft.rfftn((v - v.mean()) * window) for v in (body, clean))
    q = np.sqrt(sum(k ** 2 for k in np.meshgrid(*(2 * math.pi * np.fft.fftfreq(n) for n in shape[:2]), 2 * math.pi * np.fft.rfftfreq(shape[2]), indexing="ij")))
    edges = np.arange(0.1, 3.2, 0.1)
    shell = np.digitize(q.ravel(), edges)
    sums = [np.bincount(shell, v.ravel(), len(edges) + 1) for v in ((r * o.conj()).real, abs(o) ** 2)]
    h = sums[0] / np.maximum(sums[1], 1e-30)
    middle = np.concatenate([[0.05], edges + 0.05])
    level = h[1:3].mean()
    rest = scan - clean
    rest = rest - rest.mean()
    lag = lambda k: float(np.mean([(np.take(rest, range(k, rest.shape[a]), a) * np.take(rest, range(rest.shape[a] - k), a)).mean() for a in range(3)]) / rest.var())
    falls = lambda part: float(np.interp(-part, -np.minimum.accumulate(h[1:]) / level, middle[1:]))
    return {"q80": falls(0.8), "q50": falls(0.5), "q10": falls(0.1), "noise": float(rest.std() / level), "lags": [lag(k) for k in range(1, 5)]}


def make(name, request, size, folder, call):
    """Writes name.raw (the grains, FINER times as fine, uint8) and name.u8 or name.u16 (the scan), both of size = (x, y, z)
    voxels of the scan; returns the scan's path, its --raw, and its facts."""
    side, slices = max(size[:2]), size[2] + 2 * FOUND
    n = int(math.ceil(1.42 * side / 2 + 4) * 2)
    shape = (slices * FINER, n * FINER, n * FINER)
    middle = tuple(slice((m // FINER - s) // 2 * FINER, ((m // FINER - s) // 2 + s) * FINER) for m, s in zip(shape, size[::-1]))
    rng = np.random.default_rng(request["seed"] + 1)
    kind = request["body"]
    solid = solid_of("sand" if kind == "minerals" else kind, request, shape, middle, folder, call)
    share = solid.reshape(slices, FINER, n, FINER, n, FINER).mean(axis=(1, 3, 5), dtype=np.float32)
    body = share * (minerals(rng, solid, request["grain"]) if kind == "minerals" else 1) * np.float32(1 - request["pore"]) + np.float32(request["pore"])
    at = np.arange(n) - 0.5 * (n - 1)
    body *= (at[:, None] ** 2 + at[None, :] ** 2 <= (0.5 * n - 2) ** 2).astype(np.float32)
    scan, clean = scan_of(body, request, side, rng)
    inner = tuple(slice(m.start // FINER, m.stop // FINER) for m in middle)
    cut = tuple(slice((whole - s) // 2, (whole - s) // 2 + s) for whole, s in zip(scan.shape, size[::-1]))
    scan, clean, body = scan[cut], clean[cut], body[inner]
    solid[middle].astype(np.uint8).tofile(name + ".raw")
    low, high = np.quantile(scan, (0.0005, 0.9995))
    most = 2 ** request["bits"] - 1
    stored = np.clip(np.rint((scan - low) / (high - low) * most * 0.96 + 0.02 * most), 0, most)
    path = "%s.u%d" % (name, request["bits"])
    stored.astype("u1" if request["bits"] == 8 else "<u2").tofile(path)
    found = facts(scan, clean, body)
    return path, "%dx%dx%d:u8" % size if request["bits"] == 8 else "%dx%dx%d:u16le" % size, dict(found, contrast_to_noise=(1 - request["pore"]) / found["noise"])
