"""The flow through the pores in ParaView 5.11 and newer: grain walls, a slice of the speed and streamlines.

    cd FOLDER_OF_THE_RUN; paraview --state=flow.py       or File > Load State, and this file
    pvpython flow.py OUT-image.hdf flow.png              a picture without a window

In the window the file is the one that TOSUI_IMAGE names, else the newest *-image.hdf of the folder.
"""
import glob
import os
import sys

from paraview.simple import *

words = sys.argv[1:]
path = words[0] if words else os.environ.get("TOSUI_IMAGE")
if not path:
    found = sorted(glob.glob("*-image.hdf"), key=os.path.getmtime)
    if not found:
        raise SystemExit("no *-image.hdf here; set TOSUI_IMAGE, or change to the folder of a run")
    path = found[-1]

flow = VTKHDFReader(registrationName=os.path.basename(path), FileName=os.path.abspath(path))
flow.UpdatePipeline()
view = GetActiveViewOrCreate("RenderView")
view.ViewSize = [1200, 900]
view.Background = [1, 1, 1]
view.UseColorPaletteForBackground = 0
view.OrientationAxesVisibility = 1

if not flow.PointData["velocity"] or not flow.PointData["wall_distance"]:
    raise SystemExit(f"{path}: not the OUT-image.hdf of a run: no velocity and no distance to walls in it")
bounds = flow.GetDataInformation().GetBounds()
low, high = bounds[::2], bounds[1::2]
middle = [(a + b) / 2 for a, b in zip(low, high)]
size = max(b - a for a, b in zip(low, high))
fastest = flow.PointData["velocity"].GetRange(-1)[1]

speed = GetColorTransferFunction("velocity")
speed.VectorMode = "Magnitude"
speed.ApplyPreset("Viridis (matplotlib)", True)


def show(source, colours=True, opacity=1.0):
    shown = Show(source, view)
    shown.Opacity = opacity
    if colours:
        ColorBy(shown, ("POINTS", "velocity", "Magnitude"))
    else:
        ColorBy(shown, None)
        shown.AmbientColor = shown.DiffuseColor = [0.75, 0.71, 0.64]
    return shown


# The walls that the flow feels: where the distance to them is 0.
walls = Contour(registrationName="walls", Input=flow)
walls.ContourBy = ["POINTS", "wall_distance"]
walls.Isosurfaces = [0.0]
show(walls, colours=False, opacity=0.12)

plane = Slice(registrationName="speed in the middle", Input=flow)
plane.SliceType.Origin = middle
plane.SliceType.Normal = [1, 0, 0]
show(plane)

seeds = StreamTracer(registrationName="streamlines", Input=flow, SeedType="Point Cloud")
seeds.Vectors = ["POINTS", "velocity"]
seeds.MaximumStreamlineLength = 4 * size
seeds.SeedType.Center = middle
seeds.SeedType.Radius = size / 2
seeds.SeedType.NumberOfPoints = 300
lines = Tube(registrationName="streamlines as tubes", Input=seeds)
lines.Radius = size / 400
show(lines).SetScalarBarVisibility(view, True)
bar = GetScalarBar(speed, view)
bar.Title, bar.ComponentTitle = "speed, m/s", ""
bar.TitleColor = bar.LabelColor = [0, 0, 0]

speed.RescaleTransferFunction(0, 0.25 * fastest)  # after the last show(), each of which sets the range of its own data
Render(view)  # the first sets the camera
view.CameraPosition = [middle[0] + 2.0 * size, middle[1] - 2.0 * size, middle[2] + 1.2 * size]
view.CameraFocalPoint = middle
view.CameraViewUp = [0, 0, 1]
view.CameraViewAngle = 32
Render(view)
if len(words) > 1:
    SaveScreenshot(words[1], view)
