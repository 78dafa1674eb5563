#!/usr/bin/env python3
"""Flows on grids, for "fluid_velocity grid FILE" (PKG-STOKESDYN/doc/pair_stokes_dynamics.md has the format).

As a program: VTK files (of OpenFOAM, FEniCSx, ParaView, ...) to a grid. Needs python3-vtk9.

    flow_grid.py flow.vtu -o flow.grid --nodes 200 50 1 --velocity U
    flow_grid.py t0.vtu t1.vtu t2.vtu -o flow.grid --nodes 64 64 64 --times 0 0.5 1 --beyond x periodic --binary

As a module: write(path, axes, velocity, ...) for arrays of numpy."""
import argparse
import sys

import numpy as np

NAMES = ("x", "y", "z", "time")


def write(path, axes, velocity, viscosity=None, times=None, beyond=None, binary=False):
    """axes: coordinates of the nodes along x, y, z, a list each. velocity: [nt, nz, ny, nx, 3], without nt if there are
    no times; viscosity: the same without the 3. beyond: {"x": "clamp" or "periodic", ...}; "error" where it does not
    say."""
    axes = [np.atleast_1d(np.asarray(axis, float)) for axis in axes]
    times = None if times is None else np.atleast_1d(np.asarray(times, float))
    shape = (() if times is None else (len(times),)) + tuple(len(axis) for axis in axes[::-1])
    rows = [np.asarray(velocity, float).reshape(shape + (3,))]
    if viscosity is not None:
        rows.append(np.asarray(viscosity, float).reshape(shape + (1,)))
    rows = np.concatenate(rows, axis=-1).reshape(-1, 3 + (viscosity is not None))
    header = ["stokesdyn_grid 1"]
    for name, nodes in zip(NAMES, axes + ([] if times is None else [times])):
        even = np.linspace(nodes[0], nodes[-1], len(nodes))
        told = nodes[[0, -1]] if len(nodes) > 2 and np.abs(nodes - even).max() <= 1e-14 * np.abs(nodes).max() else nodes
        header.append(" ".join([name, str(len(nodes)), *(repr(float(c)) for c in told),
                                (beyond or {}).get(name, "error")]))
    header += ["columns ux uy uz" + " eta" * (viscosity is not None), "rows " + ("binary" if binary else "text")]
    with open(path, "wb") as out:
        out.write(("\n".join(header) + "\n").encode())
        if binary:
            out.write(rows.astype("<f8").tobytes())
        else:
            np.savetxt(out, rows, fmt="%.17g")


# --- from VTK ---------------------------------------------------------------------------------------------------------

def read_vtk(path):
    """Whatever VTK reads: .vtu, .vts, .vti, ..., .vtm (its first block), and the old .vtk."""
    import vtk
    reader = vtk.vtkGenericDataObjectReader() if path.endswith(".vtk") else vtk.vtkXMLGenericDataObjectReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    while data is not None and data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    if data is None or data.GetNumberOfPoints() == 0:
        sys.exit(f"flow_grid.py: '{path}' holds no data set that VTK can read")
    return data


def at_points(data, name, path):
    """Values of cells are averaged to the points, so that the field is continuous."""
    import vtk
    if data.GetPointData().HasArray(name):
        return data
    if not data.GetCellData().HasArray(name):
        known = [part.GetArrayName(k) for part in (data.GetPointData(), data.GetCellData())
                 for k in range(part.GetNumberOfArrays())]
        sys.exit(f"flow_grid.py: '{path}' has no field '{name}'; it has {', '.join(sorted(set(known))) or 'none'}")
    convert = vtk.vtkCellDataToPointData()
    convert.SetInputData(data)
    convert.Update()
    return convert.GetOutput()


def sample(data, axes, name, path):
    """The field at all nodes [nz, ny, nx, components], and where there is any."""
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    grid = vtk.vtkRectilinearGrid()
    grid.SetDimensions(*(len(axis) for axis in axes))
    for axis, put in zip(axes, (grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates)):
        put(numpy_to_vtk(axis, deep=True))
    probe = vtk.vtkProbeFilter()
    probe.SetInputData(grid)
    probe.SetSourceData(at_points(data, name, path))
    probe.Update()
    found = probe.GetOutput().GetPointData()
    shape = tuple(len(axis) for axis in axes[::-1])
    values = vtk_to_numpy(found.GetArray(name)).reshape(shape + (-1,)).astype(float)
    return values, vtk_to_numpy(found.GetArray(probe.GetValidPointMaskArrayName())).reshape(shape).astype(bool)


def axes_of(data, nodes, box):
    """Even axes. One node stands in the middle. The ends lie within the mesh, not a rounding outside of it."""
    bounds = np.array(box or data.GetBounds()).reshape(3, 2)
    inset = 1e-7 * np.ptp(bounds, axis=1).max() * (box is None)
    return [np.array([0.5 * (lo + hi)]) if n == 1 else np.linspace(lo + inset, hi - inset, n)
            for n, (lo, hi) in zip(nodes, bounds)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", help="one, or one for each time")
    parser.add_argument("-o", "--out", required=True)
    parser.add_argument("--nodes", type=int, nargs=3, required=True, metavar=("NX", "NY", "NZ"),
                        help="1: nothing varies along it")
    parser.add_argument("--box", type=float, nargs=6, metavar=("XLO", "XHI", "YLO", "YHI", "ZLO", "ZHI"),
                        help="default: the mesh")
    parser.add_argument("--velocity", default="U", help="name of the field")
    parser.add_argument("--viscosity", help="name of the field; default: none is written")
    parser.add_argument("--times", type=float, nargs="+")
    parser.add_argument("--beyond", nargs=2, action="append", default=[], metavar=("AXIS", "WHAT"),
                        help="clamp or periodic")
    parser.add_argument("--binary", action="store_true")
    given = parser.parse_args()
    if len(given.files) != len(given.times or [0.0]):
        parser.error(f"{len(given.files)} files and {len(given.times or [])} times")

    frames, viscosities, axes = [], [], None
    for path in given.files:
        data = read_vtk(path)
        axes = axes or axes_of(data, given.nodes, given.box)
        u, there = sample(data, axes, given.velocity, path)
        frames.append(np.where(there[..., None], u, 0.0))
        if given.viscosity:
            eta, _ = sample(data, axes, given.viscosity, path)
            viscosities.append(np.where(there, eta[..., 0], eta[..., 0][there].mean() if there.any() else 1.0))
        print(f"{path}: {there.sum()} of {there.size} nodes are within the fluid; velocity 0 at the others")
    write(given.out, axes, np.array(frames) if given.times else frames[0],
          (np.array(viscosities) if given.times else viscosities[0]) if given.viscosity else None, given.times,
          dict(given.beyond), given.binary)


if __name__ == "__main__":
    main()
