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


@dataclass(frozen=True, slots=True)
class PostureMap:
    """Where t tools reach a part of n triangles, from m directions."""

    #: The names of the tools.
    tools: list[str]
    #: The axes of the directions, m × 3.
    directions: Floats
    #: Whether a tool reaches a triangle from a direction, n × t × m.
    reached: NDArray[np.bool_]
    #: The least stick-out that a tool needs for a triangle, n × t; NaN if it has no holder or does not reach it.
    stickout: Floats
    #: The index of the tool with the best posture of a triangle; -1 if none reaches it.
    tool: Ints
    #: The tip and the axis of the best posture, n × 3; NaN without one.
    tip: Floats
    axis: Floats
    #: The niceness of the best posture, its proved greatest depth, and the proved clearance of surfaces that do not cut.
    niceness: Floats
    depth: Floats
    clearance: Floats

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> PostureMap:
        """Read a map that `touchoff sweep` or a recorder filled."""
        return _map(_touchoff.read_map(os.fspath(path)))

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
    """
    listed = [tools] if isinstance(tools, Tool) else list(tools)
    if not listed:
        raise ValueError("tools: give one tool or more")
    within = None if tolerance is None else _arrays.length("tolerance", tolerance)
    allowed = [(str(name), float(depth)) for name, depth in (allow or {}).items()]
    rust = [_tool(tool) for tool in listed]
    found = _touchoff.sweep(
        _part(part), rust, _arrays.count("directions", directions), within, float(min_niceness), allowed
    )
    return _map(found)


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
