"""The verified job: a program with its tools, against the part, fixtures and stock."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from . import _arrays, _touchoff

if TYPE_CHECKING:
    import pandas

Verdict = Literal["clean", "findings", "none"]


@dataclass(frozen=True, slots=True)
class Finding:
    """What is wrong on some consecutive motions of a program.

    Attributes
    ----------
    text
        The sentence, as the program `touchoff verify` prints it.
    kind
        `deep`, `near`, `inside`, `stock`, `limit` and others; see docs/verify.md.
    file
        The program.
    line
        The line of the worst motion, from 1.
    row
        All of the finding, in the format of `touchoff verify --json`.
    """

    text: str
    kind: str
    file: str
    line: int
    row: dict[str, Any]

    @property
    def depth(self) -> tuple[float, float] | None:
        """Proved bounds on the depth found; None for a finding without a depth."""
        depth = self.row.get("depth")
        return None if not isinstance(depth, list) else (float(depth[0]), float(depth[1]))

    @property
    def point(self) -> tuple[float, float, float] | None:
        """The point on the part or the fixture; None without one."""
        point = self.row.get("point")
        return None if point is None else (float(point[0]), float(point[1]), float(point[2]))


@dataclass(frozen=True, slots=True)
class Gap:
    """What was not checked.

    Attributes
    ----------
    file, line
        The program, and the line, from 1.
    open
        Set if there is no verdict because of it.
    reason
        The sentence.
    """

    file: str
    line: int
    open: bool
    reason: str


@dataclass(frozen=True, slots=True)
class Report:
    """The result of a check.

    Attributes
    ----------
    verdict
        `clean` if the program is proved, `findings`, or `none` if something stands in the way of a verdict.
    findings
        What is wrong.
    gaps
        What was not checked.
    refusals
        Obstacles to a proof; without findings there is no verdict because of it.
    summaries
        A sentence for each tool at each body.
    surface_only
        Set if only the surface of the part was checked, since its mesh has no inside.
    sarif
        The findings in SARIF 2.1.0, for services of continuous integration.
    """

    verdict: Verdict
    findings: list[Finding]
    gaps: list[Gap]
    refusals: list[str]
    summaries: list[str]
    surface_only: bool
    sarif: dict[str, Any]

    def to_dataframe(self) -> pandas.DataFrame:
        """Return the findings as a table of pandas, a row each."""
        import pandas

        return pandas.DataFrame([finding.row for finding in self.findings])

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(finding.file)}:{finding.line}</td><td>{html.escape(finding.text)}</td></tr>"
            for finding in self.findings
        )
        said = "".join(f"<li>{html.escape(line)}</li>" for line in self.refusals + self.summaries)
        return f"<p>verdict: <b>{self.verdict}</b></p><ul>{said}</ul><table>{rows}</table>"


class Job:
    """A program with its tools, against the part, fixtures and stock.

    Parameters are the keys of a job file, for which docs/verify.md is the reference, and paths are relative to `folder`:

    >>> job = Job(part="plate.stl", unit="mm", program="plate.nc", tool={1: {"tool": "D2Ball"}})
    """

    def __init__(self, *, folder: str | os.PathLike[str] = ".", **keys: Any) -> None:
        # The name gives the folder; the file need not exist.
        self._path = os.path.join(_arrays.path("folder", folder), "job.toml")
        self._keys: dict[str, Any] | None = _plain(keys)
        self._root: str | None = None

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, root: str | os.PathLike[str] | None = None) -> Job:
        """Take a job from its file, which is read by :meth:`check`.

        The file may be a stranger's: it may name files within `root` only, its own folder by default.
        """
        job = cls.__new__(cls)
        job._path, job._keys = _arrays.path("path", path), None
        job._root = None if root is None else _arrays.path("root", root)
        return job

    def check(self) -> Report:
        """Read what the job names, and prove every motion or find what is wrong.

        Raises
        ------
        JobError
            If the job or a file that it names cannot be read; the message names the file. If a file is missing, it is a
            `JobFileNotFoundError`, which is a `FileNotFoundError`, too. A line of a program that is not understood is among the
            refusals, and the program is checked up to there.
        """
        checked = json.loads(_touchoff.check_job(self._path, self._keys, self._root))
        return Report(
            verdict=checked["verdict"],
            findings=[_finding(row) for row in checked["findings"]],
            gaps=[Gap(gap["file"], gap["line"], gap["open"], gap["reason"]) for gap in checked["gaps"]],
            refusals=checked["refusals"],
            summaries=checked["summaries"],
            surface_only=checked["surface_only"],
            sarif=checked["sarif"],
        )


def _finding(row: dict[str, Any]) -> Finding:
    return Finding(row["text"], row["kind"], row["file"], row["line"], row)


def _plain(value: Any) -> Any:
    """Return a value of a job as JSON has it: numbers of tools are keys, and paths are text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, os.PathLike):
        return os.fsdecode(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    return value
