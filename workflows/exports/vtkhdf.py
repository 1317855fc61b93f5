"""A deformed film over time as one VTKHDF file.

Quadrilaterals on a fixed grid of material points; points and fields change with time, the cells are
stored once. Open the file in ParaView 5.12 or newer and press play.

References
----------
VTK file formats, "VTKHDF file format", unstructured grids with temporal data.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TypeAlias

import h5py
import numpy as np
from numpy.typing import NDArray

from stages.numerics.bsplines import Array
from workflows.exports.files import replacing
from workflows.exports.sampling import FilmGrid

VTK_QUAD = 9

POINTS = "Points"

Field: TypeAlias = Callable[[float], Array]
"""Values at a time, ms: at the control points, or at the grid."""


def write_film(
    path: Path, grid: FilmGrid, time: Array, displacement: Field, scalars: Mapping[str, Field]
) -> None:
    """Write the film at some times.

    Parameters
    ----------
    path
        File to write.
    grid
        Points that are shown.
    time
        ms, shape ``(frames,)``.
    displacement
        Of the control points, mm, shape ``(control point, 3)``.
    scalars
        Fields at the grid by name, shape ``(n1, n2)``.
    """

    def frames() -> Iterator[Mapping[str, Array]]:
        for t in time:
            moved = grid.displacement(displacement(t))
            fields = {name: field(t) for name, field in scalars.items()}
            yield {POINTS: grid.reference + moved, "displacement": moved, **fields}

    write_grid(path, grid.shape, time, {"displacement": 3, **dict.fromkeys(scalars, 1)}, frames())


def write_grid(
    path: Path,
    shape: tuple[int, int],
    time: Array,
    components: Mapping[str, int],
    frames: Iterable[Mapping[str, Array]],
) -> None:
    """Write fields on a grid of points at some times.

    The file is put together in memory: HDF5 crashes when it closes a file on a full disk.

    Parameters
    ----------
    path
        File to write.
    shape
        Numbers of points in both directions.
    time
        Of the frames, shape ``(frames,)``.
    components
        Fields by name, 1 or 3 components each.
    frames
        For each time the fields, and the places of the points under the name ``POINTS``.
    """
    with h5py.File(path.name, "w", driver="core", backing_store=False) as file:
        _write_series(file, shape, time, components, frames)
        file.flush()
        image = file.id.get_file_image()
    with replacing(path) as temporary:
        temporary.write_bytes(image)


def quads(shape: tuple[int, int]) -> NDArray[np.int64]:
    """Corners of each cell of a grid, counter-clockwise, shape ``(cells, 4)``.

    Examples
    --------
    >>> quads((2, 3)).tolist()
    [[0, 3, 4, 1], [1, 4, 5, 2]]
    """
    index = np.arange(shape[0] * shape[1], dtype=np.int64).reshape(shape)
    corners = (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    return np.stack([corner.ravel() for corner in corners], axis=-1)


def _write_series(
    file: h5py.File,
    shape: tuple[int, int],
    time: Array,
    components: Mapping[str, int],
    frames: Iterable[Mapping[str, Array]],
) -> None:
    n_points, n_frames = shape[0] * shape[1], time.size
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = np.array([2, 0], dtype=np.int64)
    root.attrs.create("Type", b"UnstructuredGrid", dtype=h5py.string_dtype("ascii", 16))
    _write_cells(root, quads(shape), n_points)
    _write_steps(root, time, n_points, tuple(components))

    kept = {POINTS: _per_frame(root, POINTS, n_frames, n_points, 3)}
    data = root.create_group("PointData")
    for name, count in components.items():
        kept[name] = _per_frame(data, name, n_frames, n_points, *([count] if count > 1 else []))
    for number, frame in enumerate(frames):
        rows = slice(number * n_points, (number + 1) * n_points)
        for name, values in frame.items():
            kept[name][rows] = values.reshape(kept[name][rows].shape)


def _write_cells(root: h5py.Group, corners: NDArray[np.int64], n_points: int) -> None:
    """One part: its sizes, the corners of all cells, where each cell starts, and their kind."""
    root.create_dataset("NumberOfPoints", data=np.array([n_points], dtype=np.int64))
    root.create_dataset("NumberOfCells", data=np.array([len(corners)], dtype=np.int64))
    root.create_dataset("NumberOfConnectivityIds", data=np.array([corners.size], dtype=np.int64))
    root.create_dataset("Connectivity", data=corners.ravel())
    root.create_dataset("Offsets", data=4 * np.arange(len(corners) + 1, dtype=np.int64))
    root.create_dataset("Types", data=np.full(len(corners), VTK_QUAD, dtype=np.uint8))


def _write_steps(root: h5py.Group, time: Array, n_points: int, fields: tuple[str, ...]) -> None:
    """Where each frame starts: points and fields move on, the part and its cells stay."""
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(time.size)
    steps.create_dataset("Values", data=time)
    stay = np.zeros(time.size, dtype=np.int64)
    move = n_points * np.arange(time.size, dtype=np.int64)
    steps.create_dataset("PartOffsets", data=stay)
    steps.create_dataset("NumberOfParts", data=np.ones(time.size, dtype=np.int64))
    steps.create_dataset("PointOffsets", data=move)
    steps.create_dataset("CellOffsets", data=stay[:, None])
    steps.create_dataset("ConnectivityIdOffsets", data=stay[:, None])
    offsets = steps.create_group("PointDataOffsets")
    for name in fields:
        offsets.create_dataset(name, data=move)


def _per_frame(
    group: h5py.Group, name: str, n_frames: int, n_points: int, *components: int
) -> h5py.Dataset:
    """Data set of all frames, one chunk per frame; single precision is what a screen can show."""
    return group.create_dataset(
        name,
        shape=(n_frames * n_points, *components),
        dtype=np.float32,
        chunks=(n_points, *components),
        compression="gzip",
        compression_opts=1,
        shuffle=True,
    )
