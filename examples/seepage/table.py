"""seepage.csv from the JSON of the runs: table.py FOLDER GRAIN_SIZE_MM..."""
import json
import math
import sys

POROSITY, VISCOSITY, GRAVITY, ALPHA, BETA = 0.4, 1e-6, 9.80665, 1000.0, 1.1  # of seepage-column.cfg and the defaults
print("grain_size_mm,v_darcy_m_per_s,k_cm_per_s,ergun_m_per_s")
for size in sys.argv[2:]:
    run = json.load(open(f"{sys.argv[1]}/grain-{size}.json"))
    d = float(size) * 1e-3
    a = ALPHA * VISCOSITY * (1 - POROSITY) ** 2 / (POROSITY**3 * d**2)
    b = BETA * (1 - POROSITY) / (POROSITY**3 * d)
    ergun = 2 * GRAVITY / (a + math.sqrt(a * a + 4 * b * GRAVITY))
    print(f"{size},{math.hypot(*run['darcy_velocity']):.5g},{100 * run['k']:.5g},{ergun:.5g}")
