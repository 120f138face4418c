"""What ParaView 5.11's own reader (vtkHDFReader) sees in a file: kind, extent, points and arrays, as JSON."""
import json
import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

reader = vtkHDFReader()
reader.SetFileName(sys.argv[1])
if not reader.CanReadFile(sys.argv[1]):
    sys.exit(sys.argv[1] + ": the reader refuses it")
reader.Update()
grid = reader.GetOutputDataObject(0)
values = grid.GetPointData()
arrays = {values.GetArrayName(i): vtk_to_numpy(values.GetArray(i)) for i in range(values.GetNumberOfArrays())}
print(json.dumps({
    "kind": grid.GetClassName(), "points": grid.GetNumberOfPoints(), "cells": grid.GetNumberOfCells(),
    "bounds": grid.GetBounds(),
    "mean": {name: array.astype(float).mean(axis=0).tolist() for name, array in arrays.items()}}))
