"""calibration.csv from the JSON of models and runs: table.py FOLDER CASE..."""
import json
import math
import sys

folder, cases = sys.argv[1], sys.argv[2:]
rows = []
for case in cases:
    model = json.load(open(f"{folder}/model-{case}.json"))
    run = json.load(open(f"{folder}/run-{case}.json"))
    rows.append((model["threshold_original"], model["void_ratio"], 100 * run["k"], run["k_relative_error"], "matched" if case == "matched" else ""))
rows.sort()
print("threshold,void_ratio,k_cm_per_s,k_relative_error,dlnk_de,note")
for i, (threshold, void_ratio, k, error, note) in enumerate(rows):
    below, above = rows[max(i - 1, 0)], rows[min(i + 1, len(rows) - 1)]
    slope = math.log(above[2] / below[2]) / (above[1] - below[1])
    print(f"{threshold:.2f},{void_ratio:.4f},{k:.4g},{error:.2g},{slope:.2f},{note}")
