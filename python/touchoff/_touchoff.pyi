"""The extension module: what the package's own modules call, with checked arrays."""

from typing import Any, TypedDict, final, type_check_only

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_Ints = NDArray[np.int64]

__all__ = [
    "JobError",
    "JobFileNotFoundError",
    "Part",
    "Study",
    "Tool",
    "ToolError",
    "certified_depth",
    "check_job",
    "clearance",
    "contacts",
    "detect",
    "import_library",
    "merge_shards",
    "read_map",
    "signed_distance",
    "sweep",
    "tool_names",
    "wrench",
    "write_shard",
]

class ToolError(ValueError): ...
class JobError(ValueError): ...
class JobFileNotFoundError(JobError, FileNotFoundError): ...

@final
class Part:
    def __new__(cls, vertices: _Floats, faces: NDArray[np.uint32], unit_name: str, points: int) -> Part: ...
    @staticmethod
    def read(path: str, unit_name: str, points: int, digest: str | None) -> Part: ...
    @property
    def digest(self) -> str | None: ...
    @property
    def unit(self) -> str: ...
    @property
    def vertices(self) -> _Floats: ...
    @property
    def faces(self) -> NDArray[np.uint32]: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def bounds(self) -> _Floats: ...
    @property
    def is_solid(self) -> bool: ...
    @property
    def diagnostics(self) -> list[str]: ...
    @property
    def covering_radius(self) -> tuple[float, bool] | None: ...
    @property
    def point_count(self) -> int: ...

@final
class Tool:
    @staticmethod
    def library(name: str, params: list[str]) -> Tool: ...
    @staticmethod
    def parse(text: str, params: list[str], name: str) -> Tool: ...
    @staticmethod
    def load(path: str, params: list[str]) -> Tool: ...
    @property
    def digest(self) -> int: ...
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
    force: _Floats
    torque: _Floats
    depth: _Floats
    niceness: _Floats
    colliding: NDArray[np.uint64]
    energy: _Floats
    point: _Floats
    triangle: _Ints
    force_rounding: _Floats
    torque_rounding: _Floats
    rounding_error: float | None
    sampling_error: float | None

@type_check_only
class ContactArrays(TypedDict):
    offsets: _Ints
    pose: _Ints
    point: _Floats
    normal: _Floats
    direction: _Floats
    gradient: _Floats
    triangle: _Ints
    surface: _Ints
    region: _Ints
    depth: _Floats
    magnitude: _Floats
    niceness: _Floats
    weight: _Floats
    rounding_error: float | None

@type_check_only
class DistanceArrays(TypedDict):
    low: _Floats
    high: _Floats

@type_check_only
class DepthArrays(DistanceArrays):
    point: _Floats
    triangle: _Ints
    surface: _Ints

@type_check_only
class ClearanceArrays(DepthArrays):
    tool_point: _Floats
    normal: _Floats

@type_check_only
class MapArrays(TypedDict):
    tools: list[str]
    directions: _Floats
    reached: NDArray[np.bool_]
    stickout: _Floats
    tool: _Ints
    tip: _Floats
    axis: _Floats
    niceness: _Floats
    depth: _Floats
    clearance: _Floats

def tool_names() -> list[str]: ...
def import_library(
    path: str,
) -> tuple[list[tuple[Tool, int | None, str, list[str]]], list[tuple[str, str]]]: ...
def wrench(
    tool: Tool, part: Part, poses: _Floats, law: str, weights: str, centre: tuple[float, float, float]
) -> WrenchArrays: ...
def contacts(tool: Tool, part: Part, poses: _Floats) -> ContactArrays: ...
def detect(tool: Tool, part: Part, poses: _Floats) -> NDArray[np.bool_]: ...
def certified_depth(tool: Tool, part: Part, poses: _Floats, tolerance: float) -> DepthArrays: ...
def clearance(tool: Tool, part: Part, poses: _Floats, tolerance: float) -> ClearanceArrays: ...
def signed_distance(
    tool: Tool, part: Part, poses: _Floats, tolerance: float, surface_only: bool
) -> DistanceArrays: ...
def sweep(
    part: Part,
    tools: list[Tool],
    directions: int,
    tolerance: float | None,
    min_niceness: float,
    allow: list[tuple[str, float]],
    surface_only: bool,
) -> MapArrays: ...
def read_map(path: str) -> MapArrays: ...
@final
class Study:
    def __new__(
        cls,
        part: Part,
        tools: list[Tool],
        directions: int,
        tolerance: float | None,
        min_niceness: float,
        allow: list[tuple[str, float]],
        surface_only: bool,
    ) -> Study: ...
    def shard(self, number: int, count: int, threads: int) -> bytes: ...
    def is_done(self, path: str, number: int, count: int) -> bool: ...

def write_shard(path: str, bytes: bytes) -> None: ...
def merge_shards(files: list[str], table: str) -> int: ...
def check_job(path: str, keys: dict[str, Any] | None, root: str | None) -> str: ...
