"""excavation_numbers.py: the flow nets of docs/excavation.md, in its folder, against Laplace's equation by finite
differences on cells of 20 cm (their own error: 1 %)."""
import json
import re

DX, NX, NZ, K = 0.2, 60, 30, 1e-4
TRENCH, RIVER = 4.4, 7.0


def solve(tip):
    """Heads [z][x] of the soil round a wall that ends `tip` rows above the bottom."""
    soil = [[(i < 20 and k < 20) or i >= 22 or (i < 22 and k < tip) for i in range(NX)] for k in range(NZ)]
    head = [[TRENCH if i < 21 else RIVER for i in range(NX)] for k in range(NZ)]
    links = []
    for k in range(NZ):
        for i in range(NX):
            if not soil[k][i]:
                continue
            beside = [(b, a) for b, a in ((k, i - 1), (k, i + 1), (k - 1, i), (k + 1, i))
                      if 0 <= a < NX and 0 <= b < NZ and soil[b][a]]
            given = [TRENCH] * (k == 19 and i < 20) + [RIVER] * (k == NZ - 1) + [RIVER] * (i == NX - 1)
            links.append((k, i, beside, 2 * sum(given), len(beside) + 2 * len(given)))
    for _ in range(500):
        for k, i, beside, given, weight in links:
            head[k][i] += 1.9 * ((given + sum(head[b][a] for b, a in beside)) / weight - head[k][i])
    return head


def check(name, tip, depth):
    head = solve(tip)
    flow = sum(2 * K * (head[19][i] - TRENCH) for i in range(20))
    columns = range(20 - round(depth / 2 / DX), 20)
    base = sum(0.5 * (head[tip - 1][i] + head[tip][i]) for i in columns) / len(columns)
    with open(f"excavation/{name}.txt") as file:
        text = file.read()
    net = re.search(r"flow net +\(([0-9.]+) \+- [0-9.]+\)(e-[0-9]+)", text)
    found = float(net[1] + net[2])
    prism = float(re.search(r"mean gradient ([0-9.]+)", text)[1])
    print(name, found, flow, prism, (base - TRENCH) / depth)
    assert abs(found / flow - 1) < 0.04, (name, found, flow)
    assert abs(prism / ((base - TRENCH) / depth) - 1) < 0.06, (name, prism, base)


check("trench", 10, 2.0)
check("short", 15, 1.0)
with open("excavation/trench/seepage.json") as file:
    results = json.load(file)
assert abs(results["exit"]["critical"] - 1.65 * 0.6) < 1e-9
# Mean of the uppermost 63 cm beside the wall, cells of 2.5 cm.
assert abs(results["exit"]["gradient"] / 0.3388 - 1) < 0.06, results["exit"]
assert abs(results["exit"]["gradient"] - 0.3388) < results["exit"]["error95"], results["exit"]
line = results["phreatic_line"]
assert all(abs(level - (TRENCH if x < 4 else RIVER)) < 0.02 for x, level in zip(line["x_m"], line["level_m"]))
# Water on both sides of the wall: the river's triangle less the trench's, and what the soil's flow changes of them.
assert -1.0e5 < results["walls"][0]["force_x_N_per_m"] < -6e4, results["walls"]
