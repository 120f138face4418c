"""Of `ct2model info --json`: sizes of models so many voxels wide whose voxels are cubes, as 16x16x7."""
import json
import sys

try:
    scan = json.load(sys.stdin)["files"][0]
    edges = [n * voxel for n, voxel in zip(scan["size"], scan["voxel_size_m"])]
except (ValueError, KeyError, IndexError, TypeError):  # ct2model build says what is wrong with the scan
    edges = [1.0, 1.0, 1.0]
for wide in map(int, sys.argv[1:]):
    print("x".join(str(max(1, round(wide * edge / edges[0]))) for edge in edges))
