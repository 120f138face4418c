"""include_circles.py: exit 1 where includes run in a circle, or up the order of the rooms.

A module is NAME.h with NAME.c, NAME_PART.h and NAME_PART.c of the same folder, and all PREFIX_*.[ch] beside a
PREFIX_internal.h; registries (.def) count as modules. A folder's effects are part of their method's room."""
import os
import re
import subprocess
import sys

# From the lowest: a room includes those before it, and itself. "" are the files at the top of a program; its main is
# above all.
ROOMS = {
    "sphsolve": ["scene", "geometry", "plan", "output", "parallel", "march", "stokes", "solute", "wcsph", "isph", "richards"],
    "ct2model": ["readers", "calibrate", "scan", "resample", "surface", "scanner", "model", ""],
    "analyze": ["", "seepage", "report"],
}
SOURCE = re.compile(r"\.(c|cc|h|def)$")
files = [f for f in subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "common", *ROOMS], text=True,
                                   capture_output=True, check=True).stdout.split()
         if SOURCE.search(f) and os.path.exists(f)]
headers = {f[:-2] for f in files if f.endswith(".h")}
internal = {h[: -len("_internal")] for h in headers if h.endswith("_internal")}


def module(path):
    name = SOURCE.sub("", path).replace(".avx2", "").replace(".avx512", "")
    folder, base = os.path.split(name)
    parts = base.split("_")
    for n in range(1, len(parts) + 1):
        prefix = os.path.join(folder, "_".join(parts[:n]))
        if prefix in headers or prefix in internal:
            return prefix
    return name


def room(path):
    parts = path.split("/")
    return parts[1] if len(parts) > 2 else ""


includes, bad = {}, []
for path in files:
    for line in open(path, encoding="utf-8"):
        match = re.match(r'\s*#\s*include "((?:common|ct2model|sphsolve|analyze)/[^"]*)"', line)
        if not match:
            continue
        other = match.group(1)
        if module(path) != module(other):
            includes.setdefault(module(path), {})[module(other)] = f"{path} includes {other}"
        program, here, there = path.split("/")[0], room(path), room(other)
        order = ROOMS.get(program, [])
        if program == other.split("/")[0] and here in order and module(path) != f"{program}/{program}":
            if there not in order or order.index(there) > order.index(here):
                bad.append(f"{path} includes {other}: {here} stands below {there or 'the top'}")

# Circles, by depth first; each is told once.
state, stack = {}, []


def visit(node):
    state[node] = "open"
    stack.append(node)
    for other in sorted(includes.get(node, ())):
        if state.get(other) == "open":
            ring = stack[stack.index(other):] + [other]
            bad.append("a circle: " + "; ".join(includes[a][b] for a, b in zip(ring, ring[1:])))
        elif other not in state:
            visit(other)
    stack.pop()
    state[node] = "done"


for start in sorted(includes):
    if start not in state:
        visit(start)
for line in bad:
    print(f"check-includes: {line}")
sys.exit(bool(bad))
