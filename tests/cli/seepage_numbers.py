"""seepage_numbers.py: the results of the commands of docs/seepage.md, in its folder, against exact and expected values."""
import json
import re


def within(value, wanted, share):
    assert abs(value / wanted - 1) < share, (value, wanted, share)


with open("seepage/darcy/darcy.json") as file:
    darcy = json.load(file)
drag = 1000 * 1e-6 * 0.6**2 / (0.4**3 * 5e-3**2)  # a of the page, 1/s
within(darcy["k_m_per_s"], 9.80665 / drag, 0.001)
with open("seepage/heads.txt") as file:
    flux, above, below = map(float, re.findall(r"(?:mid|a|b): ([0-9.e-]+)", file.read()))
within(flux / 0.1, 0.01862, 0.05)
within(above - below, 0.1, 0.03)
with open("seepage/embankment.txt") as file:
    crest = float(re.search(r"crest: ([0-9.e-]+)", file.read()).group(1))
within(crest, 0.0061, 0.06)  # finite volumes with a free surface
with open("seepage/dam.txt") as file:
    rows = [line for line in file if "bottom after" in line]
dam, paper = [list(map(float, re.findall(r" ([0-9.]+)", row))) for row in rows]
for time, share, pressure in (dam, paper):
    assert abs(share - 0.5) < 0.02, share
    within(pressure, 2940, 0.04)
within(dam[0], 0.449, 0.1)
within(paper[0], 0.324, 0.1)
