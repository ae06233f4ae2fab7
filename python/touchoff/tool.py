"""Cutting tools."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from . import _arrays, _touchoff

Params = Mapping[str, float | int | str]


@dataclass(frozen=True, slots=True)
class Surface:
    """A surface of a tool.

    Attributes
    ----------
    name
        The name, as in findings.
    cutting
        Set if it cuts.
    """

    name: str
    cutting: bool


class ToolWarning(UserWarning):
    """What the compiler notices about a tool that is in use; see `Tool.warnings`."""


class Tool:
    """A cutting tool: built in, or from a `.tool` file or its text.

    Use :meth:`library`, :meth:`load`, :meth:`parse` or :func:`import_tools` to make one.
    """

    _rust: _touchoff.Tool
    # The call that made the tool, for copies in other processes.
    _made: tuple[Callable[..., Tool], tuple[Any, ...]]
    # Set once the compiler's warnings were shown.
    _warned: bool

    def __init__(self) -> None:
        raise TypeError("make a tool by Tool.library, Tool.load, Tool.parse or import_tools")

    @classmethod
    def library(cls, name: str, **params: float | int | str) -> Tool:
        """Take a built-in tool, of those that `tool_names` lists, with values for its params: numbers in its unit, or expressions.

        Without params it is compiled to machine code, and faster than one from a file.

        >>> Tool.library("Ball", D=6).radius
        3.0

        Raises
        ------
        ValueError
            If no built-in tool has the name.
        ToolError
            If the tool has no such params, or does not compile with these.
        """
        rust = _touchoff.Tool.library(_arrays.text("name", name), _assignments(params))
        return cls._of(rust, _from_library, name, params)

    @classmethod
    def load(cls, path: str | os.PathLike[str], params: Params | None = None) -> Tool:
        """Load a `.tool` file, with values for its params: numbers in the tool's unit, or expressions as text.

        Raises
        ------
        OSError
            If the file cannot be read; `FileNotFoundError` if there is none.
        ToolError
            If it does not compile; the message has the diagnostics with their codes.
        """
        file = _arrays.path("path", path)
        rust = _touchoff.Tool.load(file, _assignments(params))
        return cls._of(rust, _load_again, os.path.abspath(file), params, rust.digest)

    @classmethod
    def parse(cls, text: str, params: Params | None = None, *, name: str = "tool") -> Tool:
        """Compile a tool's text; `name` stands for its file in diagnostics.

        Raises
        ------
        ToolError
            If it does not compile.
        """
        rust = _touchoff.Tool.parse(_arrays.text("text", text), _assignments(params), _arrays.text("name", name))
        return cls._of(rust, cls.parse, text, params)

    @classmethod
    def from_library_file(cls, path: str | os.PathLike[str], tool: str | int) -> Tool:
        """Take the tool with a name, a title or a number from a library of a CAM system.

        Raises
        ------
        KeyError
            If there is none, or several.
        """
        if isinstance(tool, bool) or not isinstance(tool, (str, int)):
            raise TypeError(f"tool: a name, a title or a number is expected, not {type(tool).__name__}")
        library = import_tools(path)
        number = int(tool.lstrip("Tt")) if isinstance(tool, str) and tool.lstrip("Tt").isdecimal() else tool
        found = [one for one in library.tools if tool in (one.tool.name, one.title) or number == one.number]
        if len(found) != 1:
            known = ", ".join(f"{one.tool.name} (T{one.number}, {one.title})" for one in library.tools)
            left_out = "; ".join(f"{name} is left out: {reason}" for name, reason in library.left_out)
            raise KeyError(f"{len(found)} tools are called {tool!r}; {os.fsdecode(path)} has {known or 'none'}; {left_out}")
        return found[0].tool

    @classmethod
    def _of(cls, rust: _touchoff.Tool, make: Callable[..., Tool], *arguments: Any) -> Tool:
        tool = cls.__new__(cls)
        tool._rust = rust
        tool._made = (make, arguments)
        tool._warned = False
        return tool

    def _warn(self) -> None:
        """Show the compiler's warnings, at the first query with the tool."""
        if not self._warned:
            self._warned = True
            if self.warnings:
                # Shown where the query is called.
                warnings.warn(self.warnings, ToolWarning, stacklevel=4)

    def __reduce__(self) -> tuple[Any, ...]:
        return self._made

    def __copy__(self) -> Tool:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Tool:
        return self

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
        """The largest distance from the axis, in the tool's unit; of a solid an upper bound."""
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
        """The compiler's warnings and notes, which the first query shows as a `ToolWarning`; empty if there are none."""
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
    """A tool of a library of a CAM system.

    Attributes
    ----------
    tool
        The tool.
    number
        Its number; None if it has none.
    title
        Its description in the library.
    notes
        Notes on what the format leaves open or contradicts, a sentence each.
    """

    tool: Tool
    number: int | None
    title: str
    notes: list[str]


@dataclass(frozen=True, slots=True)
class ToolLibrary:
    """A library of a CAM system.

    Attributes
    ----------
    tools
        The tools, in the order of the library.
    left_out
        The names of tools that are left out, with the reasons.
    """

    tools: list[ImportedTool]
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
    file = _arrays.path("path", path)
    tools, left_out = _touchoff.import_library(file)
    imported = [
        ImportedTool(Tool._of(tool, _import_again, os.path.abspath(file), index, tool.digest), number, title, notes)
        for index, (tool, number, title, notes) in enumerate(tools)
    ]
    return ToolLibrary(imported, left_out)


def _from_library(name: str, params: dict[str, float | int | str]) -> Tool:
    return Tool.library(name, **params)


def _load_again(path: str, params: Params | None, digest: int) -> Tool:
    return _same(Tool.load(path, params), digest, path)


def _import_again(path: str, index: int, digest: int) -> Tool:
    tools = import_tools(path).tools
    return _same(tools[index].tool if index < len(tools) else None, digest, path)


def _same(tool: Tool | None, digest: int, path: str) -> Tool:
    """Return a tool if it is the one that was pickled."""
    if tool is None or tool._rust.digest != digest:
        raise ValueError(
            f"{path} has changed since the tool was loaded from it: load the tool anew, and pickle that; or restore the file"
        )
    return tool


def _assignments(params: Params | None) -> list[str]:
    if params is None:
        return []
    if not isinstance(params, Mapping):
        raise TypeError(f"params: names with values are expected, not {type(params).__name__}")
    return [f"{name}={value}" for name, value in params.items()]
