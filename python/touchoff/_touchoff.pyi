"""The extension module: what the package's own modules call, with checked arrays."""

from typing import TypedDict, final, type_check_only

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

class ToolError(ValueError): ...
class JobError(ValueError): ...

@final
class Part:
    def __new__(cls, vertices: Floats, faces: NDArray[np.uint32], unit_name: str, points: int) -> Part: ...
    @staticmethod
    def read(path: str, unit_name: str, points: int) -> Part: ...
    @property
    def unit(self) -> str: ...
    @property
    def vertices(self) -> Floats: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def bounds(self) -> Floats: ...
    @property
    def is_solid(self) -> bool: ...
    @property
    def diagnostics(self) -> list[str]: ...
    @property
    def covering_radius(self) -> float | None: ...

@final
class Tool:
    @staticmethod
    def library(name: str) -> Tool: ...
    @staticmethod
    def parse(text: str, params: list[str], name: str) -> Tool: ...
    @staticmethod
    def load(path: str, params: list[str]) -> Tool: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def surfaces(self) -> list[tuple[str, bool]]: ...
    @property
    def radius(self) -> float: ...
    @property
    def is_exact(self) -> bool: ...
    @property
    def warnings(self) -> str: ...
    def svg(self) -> str: ...

@type_check_only
class WrenchArrays(TypedDict):
    force: Floats
    torque: Floats
    depth: Floats
    niceness: Floats
    colliding: NDArray[np.uint64]
    energy: Floats
    point: Floats
    triangle: Ints
    force_error: Floats
    torque_error: Floats

@type_check_only
class ContactArrays(TypedDict):
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

@type_check_only
class DistanceArrays(TypedDict):
    low: Floats
    high: Floats

@type_check_only
class DepthArrays(DistanceArrays):
    point: Floats
    triangle: Ints
    surface: Ints

@type_check_only
class ClearanceArrays(DepthArrays):
    tool_point: Floats
    normal: Floats

@type_check_only
class MapArrays(TypedDict):
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

def tool_names() -> list[str]: ...
def import_library(
    path: str,
) -> tuple[list[tuple[Tool, int | None, str, list[str]]], list[tuple[str, str]]]: ...
def wrench(
    tool: Tool, part: Part, poses: Floats, law: str, weights: str, centre: tuple[float, float, float]
) -> WrenchArrays: ...
def contacts(tool: Tool, part: Part, poses: Floats) -> ContactArrays: ...
def detect(tool: Tool, part: Part, poses: Floats) -> NDArray[np.bool_]: ...
def certified_depth(tool: Tool, part: Part, poses: Floats, tolerance: float) -> DepthArrays: ...
def clearance(tool: Tool, part: Part, poses: Floats, tolerance: float) -> ClearanceArrays: ...
def signed_distance(tool: Tool, part: Part, poses: Floats, tolerance: float) -> DistanceArrays: ...
def sweep(
    part: Part,
    tools: list[Tool],
    directions: int,
    tolerance: float | None,
    min_niceness: float,
    allow: list[tuple[str, float]],
) -> MapArrays: ...
def read_map(path: str) -> MapArrays: ...
def check_job(path: str, keys: str | None) -> str: ...
