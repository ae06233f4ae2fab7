"""The verified job, against the program."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from conftest import write_ply

import touchoff

PROGRAM = """G21 G90 G54 G0 X-30. Y0. Z5.
T1 M6
S900 M3
G43 H1 Z5.
G0 Z{depth}
G1 X30. F100.
G0 Z5.
G49
M30
"""

TOOL = """tool Mill {
    units mm;
    profile {
        start (0, 0); line to (5, 0) as tip cutting; line to (5, 20) as flute cutting;
        line to (5, 50) as shank; line to (0, 50) as top;
    }
    niceness cutting: 1;
}"""


@pytest.fixture
def folder(block, tmp_path: Path) -> Path:
    write_ply(tmp_path / "block.ply", block)
    (tmp_path / "mill.tool").write_text(TOOL)
    return tmp_path


def job(folder: Path, depth: float, **more: object) -> touchoff.Job:
    (folder / "plate.nc").write_text(PROGRAM.format(depth=depth))
    keys = {"part": "block.ply", "unit": "mm", "program": "plate.nc", "control": "linuxcnc", "tolerance": 0.01}
    return touchoff.Job(folder=folder, tool={1: {"tool": "mill.tool"}}, **keys, **more)


def test_a_gouge_is_found_and_a_clean_program_is_proved(folder):
    report = job(folder, -0.5).check()
    assert report.verdict == "findings" and not report.refusals
    finding = report.findings[0]
    assert finding.kind == "deep" and finding.line == 6 and "0.5000 mm" in finding.text
    assert finding.depth is not None and finding.depth[0] <= 0.5 <= finding.depth[1] + 1e-3
    assert finding.point is not None and abs(finding.point[2]) < 1e-9
    assert report.sarif["version"] == "2.1.0" and "0.5000 mm" in report._repr_html_()
    clean = job(folder, 1.0).check()
    assert clean.verdict == "clean" and clean.findings == [] and clean.summaries


def test_a_job_file_reads_within_its_folder_or_the_root(folder):
    job(folder, 1.0)
    (folder / "jobs").mkdir()
    text = 'part = "../block.ply"\nunit = "mm"\nprogram = "../plate.nc"\ncontrol = "linuxcnc"\n[tool.1]\ntool = "../mill.tool"\n'
    (folder / "jobs" / "job.toml").write_text(text)
    with pytest.raises(touchoff.JobError, match="outside"):
        touchoff.Job.load(folder / "jobs" / "job.toml").check()
    assert touchoff.Job.load(folder / "jobs" / "job.toml", root=folder).check().summaries


def test_findings_are_those_of_the_program(folder, program):
    job(folder, -0.5)
    text = 'part = "block.ply"\nunit = "mm"\nprogram = "plate.nc"\ncontrol = "linuxcnc"\ntolerance = 0.01\n'
    (folder / "job.toml").write_text(text + '[tool.1]\ntool = "mill.tool"\n')
    loaded = touchoff.Job.load(folder / "job.toml").check()
    printed = subprocess.run([program, "verify", folder / "job.toml", "--json"], capture_output=True, text=True)
    rows = [json.loads(line) for line in printed.stdout.splitlines()]
    assert printed.returncode == 1 and [finding.row for finding in loaded.findings] == rows[: len(loaded.findings)]
    assert len(rows) == len(loaded.findings) + len(loaded.gaps)


def test_fixtures_stock_and_built_in_tools(folder):
    (folder / "plate.nc").write_text(PROGRAM.format(depth=1.0))
    keys = {"part": "block.ply", "unit": "mm", "program": "plate.nc", "control": "linuxcnc"}
    built_in = touchoff.Job(folder=folder, tool={"1": {"tool": "Ball"}}, **keys).check()
    assert built_in.verdict == "clean"
    clamp = [{"name": "clamp", "mesh": "block.ply", "margin": 2.5}]
    held = touchoff.Job(folder=folder, tool={1: {"tool": "mill.tool"}}, fixture=clamp, **keys).check()
    assert {finding.kind for finding in held.findings} == {"near"}
    assert all(finding.row["body"] == "clamp" for finding in held.findings)
    # The flute is 20 mm long: of a stock of 40 mm the shank meets the upper part.
    for height, verdict, kinds in ((3, "clean", set()), (40, "findings", {"stock"})):
        stock = {"box": [[-22, -22, -10], [22, 22, height]], "spacing": 1.0}
        cut = touchoff.Job(folder=folder, tool={1: {"tool": "mill.tool"}}, stock=stock, **keys).check()
        assert cut.verdict == verdict and {finding.kind for finding in cut.findings} == kinds
        assert all(finding.row["surface"] == "shank" for finding in cut.findings)


def test_an_allowance_may_be_infinite(folder):
    allow = {"tip": float("inf"), "flute": float("inf")}
    assert job(folder, -0.5).check().verdict == "findings"
    assert job(folder, -0.5, allow=allow).check().verdict == "clean"


def test_findings_become_a_table(folder):
    pandas = pytest.importorskip("pandas")
    table = job(folder, -0.5).check().to_dataframe()
    assert isinstance(table, pandas.DataFrame) and {"text", "line", "kind", "surface"} <= set(table.columns)


def test_errors_name_the_file_and_the_line(folder):
    (folder / "plate.nc").write_text("G21 G90\nG1 X1. Q9 W\n")
    keys = {"unit": "mm", "program": "plate.nc", "control": "linuxcnc", "tool": {1: {"tool": "Ball"}}}
    broken = touchoff.Job(folder=folder, part="block.ply", **keys)
    report = broken.check()
    assert report.verdict == "none" and not report.findings
    assert any("plate.nc:2: Q is used by no G or M word" in reason or "plate.nc:2: W" in reason for reason in report.refusals)
    missing = touchoff.Job(folder=folder, part="none.ply", **keys)
    (folder / "plate.nc").write_text(PROGRAM.format(depth=1.0))
    with pytest.raises(touchoff.JobError, match="none.ply"):
        missing.check()
