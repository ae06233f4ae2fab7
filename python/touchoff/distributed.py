"""Sweeps and jobs on a cluster of Ray: `pip install "touchoff[ray]"`.

A sweep runs in shards, each a task. Parts lie in Ray's object store; a shard comes back as the bytes of its file, which is
written on the machine of the caller. Ray runs tasks again whose machine is lost, and at most `in_flight` of them are
submitted at a time. Shards that a folder has already are kept, so that a study goes on where it was stopped.

>>> import touchoff.distributed
>>> dataset = touchoff.distributed.sweep({"plate": part}, tools, folder="study")    # doctest: +SKIP
>>> dataset.to_table(filter=(pyarrow.compute.field("rank") == 0))    # doctest: +SKIP
"""

from __future__ import annotations

import functools
import os
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _arrays, _touchoff
from .job import Job, Report
from .part import Part
from .queries import _part, _tool
from .sweep import Rules, _listed
from .tool import Tool

if TYPE_CHECKING:
    import pyarrow
    import pyarrow.dataset

Progress = Callable[[int, int], None]
# The vertices, the triangles and the unit of a part.
_Arrays = tuple[Any, Any, str]


# The key and the sweep of the part that this worker had last, with its tree of triangles.
_kept: tuple[str, _touchoff.Study] | None = None


def _shard(key: str, part: _Arrays, tools: list[Tool], rules: Rules, number: int, count: int, threads: int) -> bytes:
    """Compute a shard: the task."""
    global _kept
    if _kept is None or _kept[0] != key:
        vertices, faces, unit = part
        _kept = key, _study(Part(vertices, faces, unit=unit), tools, rules)
    return _kept[1].shard(number, count, threads)


def _study(part: Part, tools: list[Tool], rules: Rules) -> _touchoff.Study:
    return _touchoff.Study(_part(part), [_tool(tool) for tool in tools], *rules.arguments())


class LostWorkerError(RuntimeError):
    """The failure of a job whose process ended without a report as often as it was tried.

    It was killed, as for the memory that it took, or its machine was lost.
    """


def _results(
    calls: Iterator[tuple[Any, Callable[[], Any]]], in_flight: int, max_retries: int | None = None
) -> Iterator[tuple[Any, Any]]:
    """Submit tasks, some at a time, and yield the label and the result of each as it ends.

    With `max_retries`, one whose process is lost is submitted again as often, and a failure is yielded in place of the result.
    """
    import ray

    open_tasks: dict[Any, tuple[Any, Callable[[], Any], int]] = {}
    while True:
        while len(open_tasks) < in_flight and (call := next(calls, None)) is not None:
            label, submit = call
            open_tasks[submit()] = label, submit, 1
        if not open_tasks:
            return
        ready, _ = ray.wait(list(open_tasks), num_returns=1)
        for reference in ready:
            label, submit, attempts = open_tasks.pop(reference)
            result: Any
            try:
                result = ray.get(reference)
            except ray.exceptions.RayTaskError as error:
                if max_retries is None:
                    raise
                result = error
            except ray.exceptions.RayError as error:
                if max_retries is None:
                    raise
                if attempts <= max_retries:
                    open_tasks[submit()] = label, submit, attempts + 1
                    continue
                reason = str(error).strip().partition("\n")[0]
                result = LostWorkerError(
                    f"{label}: no report after {attempts} attempts, as the process that checks it was lost ({reason}): verify it alone, "
                    "with a limit of memory, or raise `max_retries` if machines of the cluster are taken away"
                )
            yield label, result


def sweep(
    parts: Mapping[str, Part],
    tools: Tool | Sequence[Tool],
    *,
    folder: str | os.PathLike[str],
    shards: int = 16,
    directions: int = 200,
    tolerance: float | None = None,
    min_niceness: float = 0.0,
    allow: Mapping[str, float] | None = None,
    surface_only: bool = False,
    num_cpus: int = 1,
    max_retries: int = -1,
    in_flight: int = 64,
    progress: Progress | None = None,
) -> pyarrow.dataset.Dataset:
    """Try tools at every triangle of parts, as :func:`touchoff.sweep` does, as tasks of Ray.

    The tables have the same bytes for any cluster, and as those that `touchoff merge` writes.

    Parameters
    ----------
    parts
        The parts by their names, which become folders.
    tools
        One tool or several. They are made again on each machine: a `.tool` file has to be there, or give its text.
    folder
        Where the tables are written: `part=NAME/table.parquet`, and shards in `_shards/NAME`.
    shards
        Number of tasks per part.
    directions, tolerance, min_niceness, allow, surface_only
        As in :func:`touchoff.sweep`.
    num_cpus
        Cores that a task takes, and the threads that it has.
    max_retries
        How often Ray runs a task again whose machine is lost; -1 for any number of times.
    in_flight
        Tasks that are submitted at a time.
    progress
        Called after each shard with the number of shards that are there, and of all.

    Raises
    ------
    ValueError
        If a part has no inside, the rules are invalid, or the folder has shards of another sweep.
    OSError
        If a table cannot be written; shards that were written stay.
    """
    import pyarrow.dataset
    import ray

    rules = Rules.of(directions, tolerance, min_niceness, allow, surface_only)
    listed = _listed(tools)
    total, threads = _arrays.count("shards", shards), _arrays.count("num_cpus", num_cpus)
    limit = _arrays.count("in_flight", in_flight)
    root = Path(_arrays.path("folder", folder))
    files = {name: [root / "_shards" / _name(name) / f"{k}-of-{total}.parquet" for k in range(1, total + 1)] for name in parts}
    task = ray.remote(num_cpus=threads, max_retries=max_retries)(_shard)
    kept_tools = ray.put(listed)
    done = 0

    def calls() -> Iterator[tuple[Path, Callable[[], Any]]]:
        nonlocal done
        for name, part in parts.items():
            study = _study(part, listed, rules)
            files[name][0].parent.mkdir(parents=True, exist_ok=True)
            kept = None
            for number, file in enumerate(files[name], 1):
                if study.is_done(str(file), number, total):
                    done += 1
                    continue
                kept = ray.put((part.vertices, part.faces, part.unit)) if kept is None else kept
                yield file, functools.partial(task.remote, kept.hex(), kept, kept_tools, rules, number, total, threads)

    for file, shard in _results(calls(), limit):
        _touchoff.write_shard(str(file), shard)
        done += 1
        if progress is not None:
            progress(done, total * len(parts))
    tables = []
    for name in parts:
        table = root / f"part={_name(name)}" / "table.parquet"
        table.parent.mkdir(parents=True, exist_ok=True)
        _touchoff.merge_shards([str(file) for file in files[name]], str(table))
        tables.append(str(table))
    partitioning = pyarrow.dataset.partitioning(flavor="hive")
    return pyarrow.dataset.dataset(tables, format="parquet", partitioning=partitioning, partition_base_dir=str(root))


def _name(name: str) -> str:
    if not _arrays.text("parts", name) or any(sign in name for sign in "/\\=%") or name.startswith((".", "_")):
        raise ValueError(f"parts: {name!r} cannot be the name of a folder: take letters, digits, - and _")
    return name


def _check(path: str, max_time: float | None) -> Report | Exception:
    def end(*_: Any) -> None:
        raise TimeoutError(f"{path}: not checked within {max_time:g} s: verify it alone, or raise `max_time`")

    try:
        # A task of Ray runs in the main thread of its process, where the alarm interrupts a check as Ctrl-C does.
        if max_time is not None:
            signal.signal(signal.SIGALRM, end)
            signal.setitimer(signal.ITIMER_REAL, max_time)
        return Job.load(path).check()
    except (ValueError, OSError) as error:
        return error
    finally:
        if max_time is not None:
            signal.setitimer(signal.ITIMER_REAL, 0)


def verify_many(
    jobs: Sequence[str | os.PathLike[str]],
    *,
    num_cpus: int = 1,
    max_retries: int = 2,
    max_time: float | None = None,
    in_flight: int = 64,
) -> Iterator[tuple[str, Report | Exception]]:
    """Check jobs as tasks of Ray, each as :meth:`touchoff.Job.check` does, in the order in which they end.

    The files of a job have to be on each machine, as in a folder that all share. A job that cannot be checked yields its
    exception in place of a report, and one whose process is lost each time a :class:`LostWorkerError`; the others go on.

    Parameters
    ----------
    jobs
        Job files.
    num_cpus, in_flight
        As in :func:`sweep`.
    max_retries
        How often a job is tried again whose process or machine is lost. A job that takes more memory than there is loses each.
    max_time
        Seconds after which a job yields a :class:`TimeoutError`.
    """
    import ray

    # Ray itself would try a task without end that the system killed for its memory, whatever the number.
    task = ray.remote(num_cpus=_arrays.count("num_cpus", num_cpus), max_retries=0)(_check)
    paths = [os.path.abspath(_arrays.path("jobs", job)) for job in jobs]
    limit, retries = _arrays.count("in_flight", in_flight), _arrays.count("max_retries", max_retries, least=0)
    seconds = None if max_time is None else _arrays.real("max_time", max_time)
    if seconds is not None and not 0.0 < seconds < float("inf"):
        raise ValueError(f"max_time: {seconds:g} is no positive number of seconds")
    yield from _results(((path, functools.partial(task.remote, path, seconds)) for path in paths), limit, retries)


def write_reports(
    results: Iterable[tuple[str, Report | Exception]], path: str | os.PathLike[str]
) -> pyarrow.dataset.Dataset:
    """Write the results of jobs to a Parquet file, a row each in the order of their names, and return it as an Arrow dataset.

    Columns: `job`; `verdict`, null for a job that could not be checked, and `error`, which says why; `findings`, a list with `kind`,
    `file`, `line`, `text`, the proved bounds `depth_low` and `depth_high`, and the point `x`, `y`, `z` in the unit of the part; `gaps`, a
    list with `file`, `line`, `open` and `reason`; `refusals`, a list of sentences.

    Parameters
    ----------
    results
        What :func:`verify_many` yields.
    path
        The file, which is there once all results are.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    import pyarrow
    import pyarrow.dataset
    import pyarrow.parquet

    file = Path(_arrays.path("path", path))
    rows = sorted((_row(job, result) for job, result in results), key=lambda row: row["job"])
    table = pyarrow.Table.from_pylist(rows, schema=_schema())
    file.parent.mkdir(parents=True, exist_ok=True)
    # A file that is there is whole.
    begun = file.with_name(f"{file.name}.begun")
    pyarrow.parquet.write_table(table, begun)
    begun.replace(file)
    return pyarrow.dataset.dataset(str(file), format="parquet")


def _row(job: str, result: Report | Exception) -> dict[str, Any]:
    if isinstance(result, Exception):
        return {"job": job, "error": str(result)}
    findings = []
    for finding in result.findings:
        (low, high), (x, y, z) = finding.depth or (None, None), finding.point or (None, None, None)
        place = {"kind": finding.kind, "file": finding.file, "line": finding.line, "text": finding.text}
        findings.append({**place, "depth_low": low, "depth_high": high, "x": x, "y": y, "z": z})
    gaps = [{"file": gap.file, "line": gap.line, "open": gap.open, "reason": gap.reason} for gap in result.gaps]
    return {"job": job, "verdict": result.verdict, "findings": findings, "gaps": gaps, "refusals": result.refusals}


def _schema() -> pyarrow.Schema:
    import pyarrow as pa

    place: list[tuple[str, pa.DataType]] = [("file", pa.string()), ("line", pa.int64())]
    numbers = [(name, pa.float64()) for name in ("depth_low", "depth_high", "x", "y", "z")]
    finding = pa.struct([("kind", pa.string()), *place, ("text", pa.string()), *numbers])
    gap = pa.struct([*place, ("open", pa.bool_()), ("reason", pa.string())])
    lists = [("findings", pa.list_(finding)), ("gaps", pa.list_(gap)), ("refusals", pa.list_(pa.string()))]
    return pa.schema([("job", pa.string()), ("verdict", pa.string()), ("error", pa.string()), *lists])
