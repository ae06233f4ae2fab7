"""Cutting tools."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass

from . import _touchoff

Params = Mapping[str, float | int | str]


@dataclass(frozen=True, slots=True)
class Surface:
    """A surface of a tool."""

    name: str
    #: Whether it cuts.
    cutting: bool


class Tool:
    """A cutting tool: built in, or from a `.tool` file or its text.

    Use :meth:`library`, :meth:`load`, :meth:`parse` or :func:`import_tools` to make one.
    """

    _rust: _touchoff.Tool

    def __init__(self) -> None:
        raise TypeError("make a tool by Tool.library, Tool.load, Tool.parse or import_tools")

    @classmethod
    def library(cls, name: str) -> Tool:
        """Take a built-in tool, of those that `tool_names` lists. It is compiled, and faster than one from a file."""
        return cls._of(_touchoff.Tool.library(name))

    @classmethod
    def load(cls, path: str | os.PathLike[str], params: Params | None = None) -> Tool:
        """Load a `.tool` file, with values for its params: numbers in the tool's unit, or expressions as text.

        Raises
        ------
        OSError
            If the file cannot be read.
        ToolError
            If it does not compile; the message has the diagnostics with their codes.
        """
        return cls._of(_touchoff.Tool.load(os.fspath(path), _assignments(params)))

    @classmethod
    def parse(cls, text: str, params: Params | None = None, *, name: str = "tool") -> Tool:
        """Compile a tool's text; `name` stands for its file in diagnostics.

        Raises
        ------
        ToolError
            If it does not compile.
        """
        return cls._of(_touchoff.Tool.parse(text, _assignments(params), name))

    @classmethod
    def from_library_file(cls, path: str | os.PathLike[str], tool: str | int) -> Tool:
        """Take the tool with a name, a title or a number from a library of a CAM system.

        Raises
        ------
        KeyError
            If there is none, or several.
        """
        library = import_tools(path)
        found = [one for one in library.tools if tool in (one.tool.name, one.title, one.number)]
        if len(found) != 1:
            known = ", ".join(sorted(one.tool.name for one in library.tools))
            raise KeyError(f"{len(found)} tools are called {tool!r}; {os.fspath(path)} has {known}")
        return found[0].tool

    @classmethod
    def _of(cls, rust: _touchoff.Tool) -> Tool:
        tool = cls.__new__(cls)
        tool._rust = rust
        return tool

    @property
    def name(self) -> str:
        """The name."""
        return self._rust.name

    @property
    def title(self) -> str:
        """The title; empty if it has none."""
        return self._rust.title

    @property
    def unit(self) -> str:
        """The unit of its file."""
        return self._rust.unit

    @property
    def radius(self) -> float:
        """The largest distance from the axis, in the tool's unit."""
        return self._rust.radius

    @property
    def surfaces(self) -> list[Surface]:
        """The surfaces, in the order of their indices in results."""
        return [Surface(name, cutting) for name, cutting in self._rust.surfaces]

    @property
    def is_exact(self) -> bool:
        """Whether depth is proved to be the distance to the tool's surface."""
        return self._rust.is_exact

    @property
    def warnings(self) -> str:
        """The compiler's warnings; empty if there are none."""
        return self._rust.warnings

    def svg(self) -> str:
        """Draw the half section with its regions, as SVG."""
        return self._rust.svg()

    def _repr_svg_(self) -> str | None:
        try:
            return self.svg()
        except ValueError:
            return None

    def __repr__(self) -> str:
        return f"Tool({self.name!r}, unit={self.unit!r})"


@dataclass(frozen=True, slots=True)
class ImportedTool:
    """A tool of a library of a CAM system."""

    tool: Tool
    number: int | None
    title: str
    #: What the format leaves open or contradicts, a sentence each.
    notes: list[str]


@dataclass(frozen=True, slots=True)
class ToolLibrary:
    """A library of a CAM system."""

    tools: list[ImportedTool]
    #: The names of tools that are left out, with the reasons.
    left_out: list[tuple[str, str]]


def import_tools(path: str | os.PathLike[str]) -> ToolLibrary:
    """Import the tools of Fusion 360, FreeCAD, HSM, Kiri:Moto, CAMotics, LinuxCNC or an APT program.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is in none of these formats.
    """
    tools, left_out = _touchoff.import_library(os.fspath(path))
    imported = [ImportedTool(Tool._of(tool), number, title, notes) for tool, number, title, notes in tools]
    return ToolLibrary(imported, left_out)


def _assignments(params: Params | None) -> list[str]:
    if params is None:
        return []
    if not isinstance(params, Mapping):
        raise TypeError(f"params: names with values are expected, not {type(params).__name__}")
    return [f"{name}={value}" for name, value in params.items()]
