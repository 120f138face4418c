#!/usr/bin/env bats
# Models and snapshots open in ParaView: read by its own reader, and compared with what h5py reads.

bats_require_minimum_version 1.5.0
load sample
setup_file() {
  export BIN="${BUILD:-build}/bin" ROOT="$BATS_TEST_DIRNAME/../.."
  cd "$BATS_FILE_TMPDIR"
  (PATH="$BIN:$PATH" && sample_model 16x16x7 model.hdf)
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

@test "pore flow is an image too: velocity, pressure and wall distance of the snapshot's sites, on the whole lattice" {
  see pore-image.hdf
  /usr/bin/python3 - << 'END'
import h5py, json
import numpy as np
seen, image, points = json.load(open("seen.json")), h5py.File("pore-image.hdf")["VTKHDF"], h5py.File("pore-0000.hdf")["VTKHDF"]
run = h5py.File("pore.hdf")["run"]
nx, ny, nz = (int(n) for n in run.attrs["size"])
assert seen["kind"] == "vtkImageData" and seen["points"] == nx * ny * nz, seen
assert [seen["bounds"][i] for i in (0, 2, 4)] == list(run.attrs["origin"])
assert np.allclose([seen["bounds"][2 * a + 1] - seen["bounds"][2 * a] for a in range(3)],
                   run.attrs["spacing"] * (run.attrs["size"] - 1.0), rtol=1e-9)
velocity, data = image["PointData/velocity"][()], points["PointData"]
assert velocity.shape == (nz, ny, nx, 3) and image["PointData/velocity"].attrs["unit"] == b"m/s"
at = np.rint((points["Points"][()] - run.attrs["origin"]) / run.attrs["spacing"]).astype(int)
assert np.array_equal(velocity[at[:, 2], at[:, 1], at[:, 0]], data["velocity"][()])
assert np.array_equal(image["PointData/pressure"][()][at[:, 2], at[:, 1], at[:, 0]], data["pressure"][()])
assert not velocity[run["solid"][()] == 1].any()
assert ((image["PointData/wall_distance"][()] < 0) == (run["solid"][()] == 1)).all()
for name in ("velocity", "pressure", "wall_distance"):  # as ParaView's reader sees them
    mean = image["PointData"][name][()].astype(float).reshape(nx * ny * nz, -1).mean(axis=0)
    assert np.allclose(np.ravel(seen["mean"][name]), mean, rtol=1e-5, atol=1e-12), name
# The mean of the velocity over the whole lattice is the Darcy velocity of the finest lattice, but for walls within a site.
assert abs(seen["mean"]["velocity"][2] / (run.attrs["darcy_velocity"][2] * run.attrs["k_finest"] / run.attrs["k"]) - 1) < 0.1
END
}

@test "output.image = false leaves the image out, and what stands beside a run is no run" {
  "$BIN/sphsolve" run "$ROOT/data-samples/scenes/demo.cfg" --set model.file=model.hdf --set output.image=false -o bare --quiet
  [ -e bare-0000.hdf ]
  [ ! -e bare-image.hdf ]
  run --separate-stderr "$BIN/analyze" darcy pore*.hdf --json --verbose
  [ "$status" -eq 0 ]
  [[ "$stderr" == *"pore-image.hdf: no run"* ]]
  [[ "$stderr" == *"no runs but models or files beside a run: passed over"* ]]
  [[ "$output" == *'"runs_in_fit": 1'* ]]
}

# What the state file asks of the reader, slices, walls and streamlines, by VTK alone; with pvpython (PVPYTHON) the file.
@test "the image gives walls, a slice and streamlines that follow the flow; the state file draws them" {
  /usr/bin/python3 - << 'END'
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane, vtkDataObject
from vtkmodules.vtkFiltersCore import vtkContourFilter, vtkCutter
from vtkmodules.vtkFiltersFlowPaths import vtkStreamTracer
from vtkmodules.vtkFiltersSources import vtkPointSource
from vtkmodules.vtkIOHDF import vtkHDFReader
import numpy as np

reader = vtkHDFReader()
reader.SetFileName("pore-image.hdf")
reader.Update()
bounds = reader.GetOutputDataObject(0).GetBounds()
middle, size = [(bounds[2 * a] + bounds[2 * a + 1]) / 2 for a in range(3)], bounds[5] - bounds[4]
walls = vtkContourFilter()
walls.SetInputConnection(reader.GetOutputPort())
walls.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "wall_distance")
walls.SetValue(0, 0.0)
walls.Update()
assert walls.GetOutput().GetNumberOfCells() > 1000
plane, cut = vtkPlane(), vtkCutter()
plane.SetOrigin(middle)
plane.SetNormal(1, 0, 0)
cut.SetInputConnection(reader.GetOutputPort())
cut.SetCutFunction(plane)
cut.Update()
assert cut.GetOutput().GetNumberOfPoints() > 100
seeds, tracer = vtkPointSource(), vtkStreamTracer()
seeds.SetCenter(middle)
seeds.SetRadius(size / 2)
seeds.SetNumberOfPoints(200)
tracer.SetInputConnection(reader.GetOutputPort())
tracer.SetSourceConnection(seeds.GetOutputPort())
tracer.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "velocity")
tracer.SetMaximumPropagation(4 * size)
tracer.SetIntegrationDirectionToForward()
tracer.Update()
lines = tracer.GetOutput()
assert lines.GetNumberOfLines() > 20
fallen = []
for i in range(lines.GetNumberOfCells()):
    points = vtk_to_numpy(lines.GetCell(i).GetPoints().GetData())
    if len(points) > 5:
        fallen.append(points[-1, 2] - points[0, 2])
assert np.mean(fallen) < -0.1 * size, np.mean(fallen)  # along the force, down
END
  /usr/bin/python3 -c 'import sys; compile(open(sys.argv[1]).read(), "flow.py", "exec")' "$ROOT/examples/paraview/flow.py"
  pv=${PVPYTHON:-$(command -v pvpython)} || pv=
  if [ -n "$pv" ]; then
    $pv "$ROOT/examples/paraview/flow.py" pore-image.hdf flow.png
    [ "$(stat -c %s flow.png)" -gt 50000 ]
    # The fast water is yellow: the colours' range is the flow's, not that of what was shown last.
    /usr/bin/python3 - << 'END'
from vtkmodules.vtkIOImage import vtkPNGReader
from vtkmodules.util.numpy_support import vtk_to_numpy
reader = vtkPNGReader()
reader.SetFileName("flow.png")
reader.Update()
red, green, blue = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int).T[:3]
share = ((red > 130) & (green > 110) & (blue < 80)).mean()
assert share > 0.01, share
END
    run ! $pv "$ROOT/examples/paraview/flow.py" model.hdf flow.png
    [[ $output == *"model.hdf: not the OUT-image.hdf of a run"* ]]
  fi
}
