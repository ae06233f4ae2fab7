"""Sweeps: which triangles tools reach, and from where."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import _arrays, _touchoff
from ._arrays import Floats
from .part import Part
from .queries import Ints, _part, _tool
from .tool import Tool


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PostureMap:
    """Where t tools reach a part of n triangles, from m directions.

    Attributes
    ----------
    tools
        The names of the tools.
    directions
        The axes of the directions, m × 3.
    reached
        Set where a tool reaches a triangle from a direction, n × t × m.
    stickout
        The least stick-out that a tool needs for a triangle, n × t; NaN if it has no holder or does not reach it.
    tool
        The index of the tool with the best posture of a triangle; -1 if none reaches it.
    tip, axis
        The tip and the axis of the best posture, n × 3; NaN without one.
    niceness, depth, clearance
        The niceness of the best posture, its proved greatest depth, and the proved clearance of surfaces that do not cut.
    """

    tools: list[str]
    directions: Floats
    reached: NDArray[np.bool_]
    stickout: Floats
    tool: Ints
    tip: Floats
    axis: Floats
    niceness: Floats
    depth: Floats
    clearance: Floats

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> PostureMap:
        """Read a map that `touchoff sweep` or a recorder filled."""
        return _map(_touchoff.read_map(_arrays.path("path", path)))

    def __repr__(self) -> str:
        triangles, tools, directions = self.reached.shape
        return f"PostureMap({triangles} triangles, {tools} tools, {directions} directions)"

    @property
    def is_reached(self) -> NDArray[np.bool_]:
        """Whether any tool reaches a triangle, n."""
        return np.asarray(self.reached.any(axis=(1, 2)))


def sweep(
    part: Part,
    tools: Tool | Sequence[Tool],
    *,
    directions: int = 200,
    tolerance: float | None = None,
    min_niceness: float = 0.0,
    allow: Mapping[str, float] | None = None,
    surface_only: bool = False,
) -> PostureMap:
    """Try tools at every triangle of a part, from many directions; every posture that is reported is proved.

    Parameters
    ----------
    part, tools
        The part, and one tool or several.
    directions
        Number of directions per hemisphere.
    tolerance
        Depth that a cutting surface may have; 0.01 mm if none is given.
    min_niceness
        Niceness that a contact has to exceed.
    allow
        Depths that surfaces may have in the part, by their names; below 0 a distance to keep.
    surface_only
        Take a part whose mesh has no inside: a posture inside the material then counts as clear.

    Raises
    ------
    ValueError
        If the part has no inside, or the rules are invalid.
    """
    body = _part(part)
    rules = Rules.of(directions, tolerance, min_niceness, allow, surface_only)
    return _map(_touchoff.sweep(body, [_tool(tool) for tool in _listed(tools)], *rules.arguments()))


@dataclass(frozen=True, slots=True)
class Rules:
    """The directions that a sweep tries, and what it accepts."""

    directions: int
    tolerance: float | None
    min_niceness: float
    allow: list[tuple[str, float]]
    surface_only: bool

    @classmethod
    def of(
        cls,
        directions: int,
        tolerance: float | None,
        min_niceness: float,
        allow: Mapping[str, float] | None,
        surface_only: bool,
    ) -> Rules:
        """Check the arguments of :func:`sweep`."""
        if allow is not None and not isinstance(allow, Mapping):
            raise TypeError(f"allow: names with depths are expected, not {type(allow).__name__}")
        return cls(
            _arrays.count("directions", directions),
            None if tolerance is None else _arrays.length("tolerance", tolerance),
            _arrays.real("min_niceness", min_niceness),
            [(_arrays.text("allow", name), _arrays.real(f"allow[{name!r}]", depth)) for name, depth in (allow or {}).items()],
            bool(surface_only),
        )

    def arguments(self) -> tuple[int, float | None, float, list[tuple[str, float]], bool]:
        """Return the arguments of the extension module."""
        return self.directions, self.tolerance, self.min_niceness, self.allow, self.surface_only


def _listed(tools: Tool | Sequence[Tool]) -> list[Tool]:
    if not isinstance(tools, (Tool, list, tuple)):
        raise TypeError(f"tools: a Tool or a list of them is expected, not {type(tools).__name__}")
    listed = [tools] if isinstance(tools, Tool) else list(tools)
    if not listed:
        raise ValueError("tools: give one tool or more")
    return listed


def _map(arrays: _touchoff.MapArrays) -> PostureMap:
    return PostureMap(
        tools=arrays["tools"],
        directions=arrays["directions"],
        reached=arrays["reached"],
        stickout=arrays["stickout"],
        tool=arrays["tool"],
        tip=arrays["tip"],
        axis=arrays["axis"],
        niceness=arrays["niceness"],
        depth=arrays["depth"],
        clearance=arrays["clearance"],
    )
