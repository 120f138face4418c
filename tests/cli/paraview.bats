#!/usr/bin/env bats
# Models and snapshots open in ParaView: read by its own reader, and compared with what h5py reads.

bats_require_minimum_version 1.5.0
setup_file() {
  export BIN="${BUILD:-build}/bin" ROOT="$BATS_TEST_DIRNAME/../.."
  cd "$BATS_FILE_TMPDIR"
  "$BIN/ct2model" build "$ROOT/data-samples/small" --void-ratio 0.725 --voxel-size 8.745um --size 16x16x7 -o model.hdf --quiet
  "$BIN/sphsolve" run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=model.hdf -o pore --quiet
  "$BIN/sphsolve" run "$ROOT/data-samples/scenes/seepage-column.cfg" --set 'scene.end_time="0.01 s"' -o soil --quiet
}
setup() {
  cd "$BATS_FILE_TMPDIR"
  /usr/bin/python3 -c 'import h5py, vtkmodules.vtkIOHDF' 2> /dev/null || skip "python3-vtk9 and python3-h5py are not installed"
}

see() { /usr/bin/python3 "$BATS_TEST_DIRNAME/paraview_reader.py" "$1" > seen.json; }

@test "a model is an image of its voxel centres" {
  see model.hdf
  /usr/bin/python3 - << 'END'
import h5py, json
import numpy as np
seen, model = json.load(open("seen.json")), h5py.File("model.hdf")["model"]
nz, ny, nx = model["solid"].shape
dz, dy, dx = model.attrs["spacing"]
assert seen["kind"] == "vtkImageData" and seen["points"] == nx * ny * nz, seen
extent = np.ptp(np.reshape(seen["bounds"], (3, 2)), axis=1)
assert np.allclose(extent, [dx * (nx - 1), dy * (ny - 1), dz * (nz - 1)], rtol=1e-6), seen["bounds"]
for name in ("solid", "wall_distance", "grain_fraction"):
    assert np.isclose(seen["mean"][name], model[name][()].astype(float).mean(), rtol=1e-6), name
END
}

@test "snapshots of pore flow and of seepage are points with their fields" {
  for run in pore soil; do
    see "$(ls $run-[0-9]*.hdf | tail -1)"
    /usr/bin/python3 - $run << 'END'
import glob, h5py, json, sys
import numpy as np
seen = json.load(open("seen.json"))
grid = h5py.File(sorted(glob.glob(sys.argv[1] + "-[0-9]*.hdf"))[-1])["VTKHDF"]
assert seen["kind"] == "vtkUnstructuredGrid" and seen["points"] == len(grid["Points"]) == seen["cells"], seen
wanted = {"velocity", "pressure", "id"} | ({"porosity"} if sys.argv[1] == "soil" else set())
assert wanted <= set(seen["mean"]), seen["mean"].keys()
for name in wanted:
    assert np.allclose(seen["mean"][name], grid["PointData"][name][()].astype(float).mean(axis=0), rtol=1e-5, atol=1e-12), name
END
  done
}
