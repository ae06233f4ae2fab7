"""Queries at many poses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arrays, _touchoff
from ._arrays import Floats
from .part import Part
from .tool import Tool

Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Wrench:
    """Force and torque of the whole contact at n poses, in the world's frame.

    Attributes
    ----------
    force
        Force, n × 3.
    torque
        Torque about the compliance centre, n × 3.
    depth
        Depth of the deepest point; 0 without contact.
    niceness
        Least niceness of the contact; NaN without contact.
    colliding
        Number of points inside.
    energy
        Energy of the contact, half the weighted sum of squared magnitudes.
    point
        The deepest point, n × 3; NaN without contact.
    triangle
        Its triangle; -1 without contact.
    force_rounding
        Bound on the rounding of the force as a sum over the part's points. How far that sum is from the force of the surface
        between them is not bounded.
    torque_rounding
        The same of the torque.
    rounding_error
        Bound on the rounding error of a point's depth; None if it is unknown for the tool.
    sampling_error
        Bound on how much deeper the surface between the points is; None if it is unknown, and an estimate where the part's
        covering radius is one.
    """

    force: Floats
    torque: Floats
    depth: Floats
    niceness: Floats
    colliding: NDArray[np.uint64]
    energy: Floats
    point: Floats
    triangle: Ints
    force_rounding: Floats
    torque_rounding: Floats
    rounding_error: float | None
    sampling_error: float | None

    def __repr__(self) -> str:
        return f"Wrench({len(self.depth)} poses)"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Contacts:
    """The points of the part inside the tool at n poses, one after the other.

    Those of pose k are from `offsets[k]` to `offsets[k + 1]`.

    Attributes
    ----------
    offsets
        n + 1 positions.
    pose
        The index of the pose.
    point, normal
        The point, and the part's outward normal there.
    direction
        Unit vector to the tool's nearest surface.
    gradient
        The gradient of the magnitude.
    triangle
        The triangle that the point lies on.
    surface
        Index in `Tool.surfaces`.
    region
        Index of the tool's region, in the order of its file.
    depth
        Depth of the point in the tool.
    magnitude
        The number from which the force law computes the force.
    niceness
        Rating of the contact.
    weight
        The point's share of the surface.
    rounding_error
        Bound on the rounding error of a point's depth; None if it is unknown for the tool.
    """

    offsets: Ints
    pose: Ints
    point: Floats
    normal: Floats
    direction: Floats
    gradient: Floats
    triangle: Ints
    surface: Ints
    region: Ints
    depth: Floats
    magnitude: Floats
    niceness: Floats
    weight: Floats
    rounding_error: float | None

    def __len__(self) -> int:
        return len(self.pose)

    def __repr__(self) -> str:
        return f"Contacts({len(self)} at {len(self.offsets) - 1} poses)"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Depth:
    """Proved bounds on the greatest depth of the part's triangles in the tool, at n poses.

    Attributes
    ----------
    low, high
        The bounds, n.
    point
        A point at least as deep as the lower bound, n × 3; NaN if none was found inside.
    triangle, surface
        Its triangle, and the index of the nearest surface of the tool; -1 without a point.
    """

    low: Floats
    high: Floats
    point: Floats
    triangle: Ints
    surface: Ints

    def __repr__(self) -> str:
        return f"Depth({len(self.low)} poses)"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Clearance:
    """Proved bounds on the distance between the surfaces of part and tool at n poses; 0 in contact.

    A tool that is wholly inside the material has a distance, too: see `signed_distance`.

    Attributes
    ----------
    low, high
        The bounds, n.
    point
        The nearest point of the part, n × 3.
    triangle, surface
        Its triangle, and the index of the nearest surface of the tool.
    tool_point, normal
        The nearest point of the tool, and the tool's outward unit normal there, n × 3.
    """

    low: Floats
    high: Floats
    point: Floats
    triangle: Ints
    surface: Ints
    tool_point: Floats
    normal: Floats

    def __repr__(self) -> str:
        return f"Clearance({len(self.low)} poses)"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Distance:
    """Proved bounds on the signed distance between part and tool at n poses: below 0 the depth in contact.

    Attributes
    ----------
    low, high
        The bounds, n.
    """

    low: Floats
    high: Floats

    def __repr__(self) -> str:
        return f"Distance({len(self.low)} poses)"


def wrench(
    tool: Tool,
    part: Part,
    poses: ArrayLike,
    *,
    law: Literal["thesis", "gradient", "facing"] = "gradient",
    weights: Literal["area", "unit"] = "area",
    centre: ArrayLike = (0.0, 0.0, 0.0),
) -> Wrench:
    """Compute force, torque and depth of the whole contact at the part's points.

    Parameters
    ----------
    tool, part
        The tool, and the part with its points.
    poses
        Tips and axes (n, 6), tips and quaternions x, y, z, w (n, 7), or matrices (n, 4, 4); or one pose.
    law
        The force of a contact: the gradient of an energy, that of Ho's thesis, or the thesis's without points that face away. Under
        `gradient` it is the magnitude times its slope: a constant magnitude exerts no force, a factor counts squared, and directions
        that the tool's file writes are not used.
    weights
        A point's weight: its share of the surface, or 1.
    centre
        The compliance centre, in the tool's frame and the part's unit. Off the axis it turns with the tool, so that poses need
        their full rotation.

    Notes
    -----
    Force and torque are in the world's frame; the torque is about the compliance centre.
    """
    rows = _arrays.poses(poses)
    middle = _arrays.vector("centre", centre)
    names = _arrays.text("law", law), _arrays.text("weights", weights)
    return Wrench(**_touchoff.wrench(_tool(tool), _part(part), rows, *names, middle))


def contacts(tool: Tool, part: Part, poses: ArrayLike) -> Contacts:
    """List the points of the part inside the tool, with all outputs there."""
    return Contacts(**_touchoff.contacts(_tool(tool), _part(part), _arrays.poses(poses)))


def detect(tool: Tool, part: Part, poses: ArrayLike) -> NDArray[np.bool_]:
    """Tell whether any point of the part is inside the tool."""
    return _touchoff.detect(_tool(tool), _part(part), _arrays.poses(poses))


def certified_depth(tool: Tool, part: Part, poses: ArrayLike, *, tolerance: float = 1e-6) -> Depth:
    """Prove bounds on the greatest depth of the part's triangles in the tool.

    The interval is at most as wide as the tolerance and the rounding error. A tool that is wholly inside the material touches no
    triangle, and has depth 0: `signed_distance` finds it.
    """
    rows, within = _arrays.poses(poses), _arrays.length("tolerance", tolerance)
    return Depth(**_touchoff.certified_depth(_tool(tool), _part(part), rows, within))


def clearance(tool: Tool, part: Part, poses: ArrayLike, *, tolerance: float = 1e-6) -> Clearance:
    """Prove bounds on the distance between the surfaces of part and tool, with the nearest points of both."""
    rows, within = _arrays.poses(poses), _arrays.length("tolerance", tolerance)
    return Clearance(**_touchoff.clearance(_tool(tool), _part(part), rows, within))


def signed_distance(
    tool: Tool, part: Part, poses: ArrayLike, *, tolerance: float = 1e-6, surface_only: bool = False
) -> Distance:
    """Prove bounds on the signed distance between part and tool.

    It is the distance where they are apart, and below 0 the depth of the deepest point in contact. A tool that is wholly inside
    the material has no lower bound: -inf. A part whose mesh has no inside is refused, unless `surface_only` is set: then a tool
    inside it counts as apart.
    """
    rows, within = _arrays.poses(poses), _arrays.length("tolerance", tolerance)
    return Distance(**_touchoff.signed_distance(_tool(tool), _part(part), rows, within, bool(surface_only)))


def _tool(tool: object) -> _touchoff.Tool:
    if not isinstance(tool, Tool):
        raise TypeError(f"tool: a Tool is expected, not {type(tool).__name__}: see Tool.library and Tool.load")
    tool._warn()
    return tool._rust


def _part(part: object) -> _touchoff.Part:
    if not isinstance(part, Part):
        raise TypeError(f"part: a Part is expected, not {type(part).__name__}: see Part and Part.read")
    return part._rust
