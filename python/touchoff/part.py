"""Workpieces."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _touchoff

if TYPE_CHECKING:
    from ._arrays import Floats

_DEFAULT_POINTS = 20_000

Number = TypeVar("Number", bound=np.generic)


@runtime_checkable
class MeshLike(Protocol):
    """What has vertices and faces, as a mesh of trimesh."""

    @property
    def vertices(self) -> ArrayLike: ...
    @property
    def faces(self) -> ArrayLike: ...


class Part:
    """A workpiece: triangles for proved answers, and points sampled on them for fast ones.

    Parameters
    ----------
    vertices
        Vertices, n × 3; or a mesh with the attributes `vertices` and `faces`, such as one of trimesh.
    faces
        Triangles, m × 3 indices of vertices, counter-clockwise seen from outside the material.
    unit
        `"mm"`, `"inch"` or `"m"`. A mesh of trimesh that states its units needs none.
    points
        Number of points to sample; the sampling error falls with its square root.

    Raises
    ------
    TypeError
        If an argument has the wrong type, or the unit is missing.
    ValueError
        If an array has the wrong shape, is empty, has a number that is not finite, or an index out of range.
    """

    _rust: _touchoff.Part
    # The call that made the part, for copies in other processes.
    _made: tuple[Any, tuple[Any, ...], dict[str, Any]]

    def __init__(
        self,
        vertices: ArrayLike | MeshLike,
        faces: ArrayLike | None = None,
        *,
        unit: str | None = None,
        points: int = _DEFAULT_POINTS,
    ) -> None:
        if faces is None:
            if not isinstance(vertices, MeshLike):
                raise TypeError("faces: give the triangles, or a mesh with `vertices` and `faces` in place of the vertices")
            mesh = vertices
            unit = unit if unit is not None else getattr(mesh, "units", None)
            vertices, faces = mesh.vertices, mesh.faces
        elif isinstance(vertices, MeshLike):
            raise TypeError("faces: the mesh has its own: leave them out")
        corners = _arrays.numbers("vertices", vertices)
        if corners.ndim != 2 or corners.shape[1] != 3:
            raise ValueError(f"vertices: the shape {corners.shape} is not (n, 3)")
        indices = _indices(faces, len(corners))
        self._rust = _touchoff.Part(corners, indices, _unit(unit), _arrays.count("points", points))
        self._made = (type(self), (corners, indices), {"unit": self._rust.unit, "points": points})

    @classmethod
    def read(
        cls, path: str | os.PathLike[str], *, unit: str | None = None, points: int = _DEFAULT_POINTS
    ) -> Part:
        """Read a mesh in STL, PLY or OBJ, points with normals in PLY, or points that `touchoff sample` saved (`.touchoff`).

        A pickle of the part has the path of the file and the SHA-256 of its content: it is read again, and refused if its content is
        another. Points from a file are all used, whatever `points` is.

        Raises
        ------
        OSError
            If the file cannot be read; `FileNotFoundError` if there is none.
        ValueError
            If it is damaged; the message names the line or the byte.
        """
        return cls._read(_arrays.path("path", path), unit, points, None)

    @classmethod
    def _read(cls, file: str, unit: str | None, points: int, digest: str | None) -> Part:
        """Read a file, which must have the digest if one is given."""
        part = cls._of(_touchoff.Part.read(file, _unit(unit), _arrays.count("points", points), digest))
        part._made = (cls._read, (os.path.abspath(file), unit, points, part._rust.digest), {})
        return part

    @classmethod
    def cuboid(
        cls, low: ArrayLike, high: ArrayLike, *, unit: str | None = None, points: int = _DEFAULT_POINTS
    ) -> Part:
        """Make a block from its lowest and its highest corner."""
        x0, y0, z0 = _arrays.vector("low", low)
        x1, y1, z1 = _arrays.vector("high", high)
        if not (x0 < x1 and y0 < y1 and z0 < z1):
            raise ValueError("high: the highest corner is above the lowest in x, in y and in z")
        corners = [(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
        return cls(corners, faces, unit=unit, points=points)

    @classmethod
    def _of(cls, rust: _touchoff.Part) -> Part:
        part = cls.__new__(cls)
        part._rust = rust
        return part

    def __reduce__(self) -> tuple[Any, ...]:
        return _remade, self._made

    def __copy__(self) -> Part:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Part:
        return self

    @property
    def unit(self) -> str:
        """The unit of every length."""
        return self._rust.unit

    @property
    def vertices(self) -> Floats:
        """The vertices, n × 3, as a copy that cannot be written. Of a part of points an `AttributeError`."""
        return _fixed(self._rust.vertices)

    @property
    def faces(self) -> NDArray[np.uint32]:
        """The triangles, m × 3, as a copy that cannot be written. Of a part of points an `AttributeError`."""
        return _fixed(self._rust.faces)

    @property
    def bounds(self) -> Floats:
        """The lowest and the highest corner of the box of triangles or points, 2 × 3."""
        return self._rust.bounds

    @property
    def is_solid(self) -> bool:
        """Whether the mesh is closed and oriented outward, so that it has an inside."""
        return self._rust.is_solid

    @property
    def diagnostics(self) -> list[str]:
        """What is noteworthy about the mesh, or about the normals of points, a sentence each."""
        return self._rust.diagnostics

    @property
    def covering_radius(self) -> float | None:
        """The largest distance of a point of the surface from the nearest sampled point; None if it is unknown.

        It is proved for points that were sampled on triangles, and an estimate for points from a file; see
        `covering_radius_is_proved`.
        """
        cover = self._rust.covering_radius
        return None if cover is None else cover[0]

    @property
    def covering_radius_is_proved(self) -> bool:
        """Whether the covering radius is proved, and not estimated."""
        cover = self._rust.covering_radius
        return cover is not None and cover[1]

    def __len__(self) -> int:
        """Return the number of triangles."""
        return self._rust.triangle_count

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        count = f"{len(self)} triangles" if len(self) else f"{self._rust.point_count} points"
        return f"Part({count}, unit={self.unit!r})"


def _remade(make: Callable[..., Part], positional: tuple[Any, ...], named: dict[str, Any]) -> Part:
    return make(*positional, **named)


def _fixed(array: NDArray[Number]) -> NDArray[Number]:
    array.flags.writeable = False
    return array


def _unit(unit: object) -> str:
    if unit is None:
        raise TypeError('unit: state it, since most files have none: unit="mm", "inch" or "m"')
    if not isinstance(unit, str):
        raise TypeError(f"unit: a name is expected, not {type(unit).__name__}")
    names = {"millimeters": "mm", "millimetres": "mm", "inches": "inch", "in": "inch", "meters": "m", "metres": "m"}
    return names.get(unit, unit)


def _indices(faces: ArrayLike, vertices: int) -> NDArray[np.uint32]:
    array = _arrays.plain("faces", faces)
    if array.size == 0:
        raise ValueError("faces: the array is empty: give one triangle or more")
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"faces: the shape {array.shape} is not (m, 3)")
    if array.dtype.kind not in "iu":
        raise TypeError(f"faces: indices are whole numbers, and this has the dtype {array.dtype}")
    outside = np.argwhere((array < 0) | (array >= vertices))
    if len(outside):
        row, column = outside[0].tolist()
        raise ValueError(f"faces[{row}, {column}]: {array[row, column]} is no index of {vertices} vertices")
    return np.ascontiguousarray(array, dtype=np.uint32)
