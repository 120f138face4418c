"""Order and cost of the cases of make verify: the observed order from errors against a known reference at two resolutions,
as a column of the table, and error against time, as a plot. (Without a reference: `analyze converge`.)"""
import math
import os
import re
import subprocess

# A case's name ends with its resolution: a spacing, or particles across.
SPACING = re.compile(r"^(.*?),? (?:spacing )?([\d.]+) (mm|cm)$")
ACROSS = re.compile(r"^(.*?), (\d+)(?:\^2| across| sites)$")


def resolution(case):
    """Stem of the name and spacing, mm or of 1 / number across; None without one."""
    found = SPACING.match(case)
    if found:
        return found[1], float(found[2]) * (10 if found[3] == "cm" else 1)
    found = ACROSS.match(case)
    return (found[1], 1 / float(found[2])) if found else None


def error(r):
    return abs(r["measured"] - r["reference"]) / (abs(r["reference"]) or 1)


def add(results):
    """Sets "order" of the finer row of every case that stands there with two resolutions or more. Returns the series."""
    series = {}
    for r in results:
        at = resolution(r["case"]) if isinstance(r["measured"], (int, float)) else None
        if at:
            series.setdefault(at[0], []).append((at[1], error(r), r))
    series = {stem: sorted(rows, key=lambda row: -row[0]) for stem, rows in series.items() if len(rows) > 1}
    for rows in series.values():
        for (wide, before, _), (fine, after, r) in zip(rows, rows[1:]):
            if before > 0 and after > 0 and wide > fine:
                r["order"] = round(math.log(before / after) / math.log(wide / fine), 2)
    return series


def plot(series, folder, name):
    """folder/name.svg, by gnuplot where it is: a line from coarse to fine for each case, a colour for each family."""
    families = sorted({stem.split(":")[1].strip() for stem in series})
    body = "set terminal svg size 1000,700\nset logscale xy\nset xlabel 'time, s'\nset ylabel 'error (relative, where the reference is not 0)'\n"
    body += f"set output '{os.path.join(folder, name)}.svg'\nset key outside\n"
    lines = []
    for k, family in enumerate(families):
        rows = [series[stem] for stem in series if stem.split(":")[1].strip() == family]
        data = "\n\n".join("\n".join(f"{max(r['seconds'], 1e-3):.4g} {max(e, 1e-6):.4g}" for _, e, r in part) for part in rows)
        body += f"$d{k} << EOD\n{data}\nEOD\n"
        lines.append(f"$d{k} with linespoints lc {k + 1} pt {k % 8 + 4} ps .6 title \"{family}\" noenhanced")
    if lines:
        try:
            subprocess.run(["gnuplot"], input=body + "plot " + ", ".join(lines) + "\n", text=True, check=True)
        except (OSError, subprocess.CalledProcessError):
            print("no plot: gnuplot is missing")
