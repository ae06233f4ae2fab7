"""Sweeps and jobs on a cluster of Ray: the bytes of one machine, also if a machine is lost half way."""

import os
import signal
import subprocess
from pathlib import Path

import pytest
import touchoff

pytest.importorskip("ray", reason="the extra touchoff[ray] is not installed")
pyarrow = pytest.importorskip("pyarrow")

import ray  # noqa: E402
import touchoff.distributed  # noqa: E402
from ray.cluster_utils import Cluster  # noqa: E402

BALL = """
tool Ball "a ball on a straight shank" {
    units mm;
    profile { start (0, 0); arc to (3, 3) center (0, 3) as ball cutting; line to (3, 20), (0, 20) as shank; }
    niceness cutting: 1;
}
"""


@pytest.fixture(scope="module")
def cluster():
    """Three machines with a core each, of which the caller's has none."""
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
    nodes = [cluster.add_node(num_cpus=1) for _ in range(3)]
    ray.init(address=cluster.address, log_to_driver=False)
    cluster.wait_for_nodes()
    yield cluster, nodes
    ray.shutdown()
    cluster.shutdown()


def bumpy(size: int) -> touchoff.Part:
    """A block with a corrugated top, of some thousand triangles."""
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((40, 40, 20)).subdivide_to_size(40 / size)
    vertices = box.vertices.copy()
    top = vertices[:, 2] > 9.99
    vertices[top, 2] += 2 * ((vertices[top, 0] / 4).round() % 2)
    return touchoff.Part(vertices, box.faces, unit="mm")


RULES = {"directions": 20, "tolerance": 0.05}


def test_a_lost_machine_changes_no_byte(cluster, tmp_path):
    cluster, nodes = cluster
    parts = {"coarse": bumpy(12), "fine": bumpy(24)}
    tools = [touchoff.Tool.library("D2Ball"), touchoff.Tool.parse(BALL)]
    seen = []

    def progress(done: int, total: int) -> None:
        seen.append(done)
        if done == 3:
            cluster.remove_node(nodes.pop(), allow_graceful=False)

    found = touchoff.distributed.sweep(parts, tools, folder=tmp_path / "study", shards=8, progress=progress, **RULES)
    assert seen == list(range(1, 17))
    assert len(cluster.list_all_nodes()) == 3
    for name, part in parts.items():
        one = touchoff.distributed._touchoff.Study(
            part._rust, [tool._rust for tool in tools], 20, 0.05, 0.0, [], False
        )
        shard, table = tmp_path / f"{name}.parquet", tmp_path / f"{name}-table.parquet"
        touchoff.distributed._touchoff.write_shard(str(shard), one.shard(1, 1, 2))
        triangles = touchoff.distributed._touchoff.merge_shards([str(shard)], str(table))
        assert triangles == len(part.faces)
        assert table.read_bytes() == (tmp_path / "study" / f"part={name}" / "table.parquet").read_bytes()
    # The rows are those of a sweep here.
    best = found.to_table(filter=(pyarrow.compute.field("rank") == 0) & (pyarrow.compute.field("part") == "fine"))
    here = touchoff.sweep(parts["fine"], tools, **RULES)
    rows = best.sort_by("triangle").to_pydict()
    reached = here.is_reached.nonzero()[0]
    assert rows["triangle"] == reached.tolist()
    assert rows["tool_index"] == here.tool[reached].tolist()
    assert rows["x"] == here.tip[reached, 0].tolist()
    assert set(found.schema.names) >= {"part", "direction_set", "stickout", "area_reached"}


def test_a_study_goes_on_where_it_was_stopped(cluster, tmp_path):
    parts, tool = {"coarse": bumpy(12)}, touchoff.Tool.library("D2Ball")

    def stop(done: int, total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        touchoff.distributed.sweep(parts, tool, folder=tmp_path, shards=5, progress=stop, **RULES)
    shards = sorted((tmp_path / "_shards" / "coarse").iterdir())
    assert len(shards) == 2
    times = [shard.stat().st_mtime_ns for shard in shards]
    seen = []
    touchoff.distributed.sweep(
        parts, tool, folder=tmp_path, shards=5, progress=lambda done, total: seen.append((done, total)), **RULES
    )
    assert seen == [(3, 5), (4, 5), (5, 5)]
    assert [shard.stat().st_mtime_ns for shard in shards] == times
    with pytest.raises(ValueError, match="of another sweep than this one"):
        touchoff.distributed.sweep(parts, tool, folder=tmp_path, shards=5, directions=21, tolerance=0.05)
    # A damaged shard is computed again.
    whole = shards[0].read_bytes()
    shards[0].write_bytes(whole[:100])
    touchoff.distributed.sweep(parts, tool, folder=tmp_path, shards=5, **RULES)
    assert shards[0].read_bytes() == whole


def test_the_program_merges_the_same_shards(cluster, tmp_path):
    touchoff.distributed.sweep({"coarse": bumpy(12)}, touchoff.Tool.library("D2Ball"), folder=tmp_path, shards=3, **RULES)
    shards = [str(path) for path in (tmp_path / "_shards" / "coarse").iterdir()]
    table = tmp_path / "merged.parquet"
    merged = subprocess.run([os.environ["TOUCHOFF"], "merge", *shards, "-o", str(table)], capture_output=True, text=True)
    assert merged.returncode == 0, merged.stderr
    assert table.read_bytes() == (tmp_path / "part=coarse" / "table.parquet").read_bytes()


def test_names_and_shards_that_cannot_be(cluster, tmp_path):
    part, tool = touchoff.Part.cuboid((0, 0, 0), (9, 9, 9), unit="mm"), touchoff.Tool.library("D2Ball")
    for name in ["", "a/b", ".hidden", "_shards", "x=1"]:
        with pytest.raises(ValueError, match="parts: "):
            touchoff.distributed.sweep({name: part}, tool, folder=tmp_path)
    with pytest.raises(ValueError, match="shards"):
        touchoff.distributed.sweep({"a": part}, tool, folder=tmp_path, shards=0)


def test_jobs_are_checked_and_none_is_lost(cluster, tmp_path):
    block = touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm")
    trimesh = pytest.importorskip("trimesh")
    trimesh.Trimesh(block.vertices, block.faces).export(tmp_path / "block.stl")
    jobs = []
    for index, depth in enumerate([1.0, -1.0, 2.0, -2.0]):
        program = tmp_path / f"{index}.nc"
        program.write_text(f"G21 G90 G94 G54\nT1 M6\nS900 M3\nG0 X0 Y0 Z50\nG1 Z{depth} F100\nG0 Z50\nM30\n")
        job = tmp_path / f"{index}.toml"
        job.write_text(
            f'part = "block.stl"\nunit = "mm"\nprogram = "{program.name}"\ncontrol = "linuxcnc"\nmachine = "3-axis"\n'
            'anyway = true\n[tool.1]\ntool = "D2Ball"\n'
        )
        jobs.append(job)
    jobs.append(tmp_path / "missing.toml")
    found = dict(touchoff.distributed.verify_many(jobs, in_flight=2))
    assert sorted(found) == sorted(str(job) for job in jobs)
    assert isinstance(found[str(jobs[-1])], (OSError, ValueError))
    for job in jobs[:-1]:
        report, here = found[str(job)], touchoff.Job.load(job).check()
        assert isinstance(report, touchoff.Report), report
        assert (report.verdict, [f.row for f in report.findings]) == (here.verdict, [f.row for f in here.findings])
    assert {found[str(job)].verdict for job in jobs[:-1]} >= {"findings"}
    assert Path(jobs[0]).exists()
    # The order in which jobs end does not change the table.
    file = tmp_path / "night" / "reports.parquet"
    dataset = touchoff.distributed.write_reports(found.items(), file)
    whole = file.read_bytes()
    touchoff.distributed.write_reports(reversed(found.items()), file)
    assert file.read_bytes() == whole
    rows = {row["job"]: row for row in dataset.to_table().to_pylist()}
    assert list(rows) == sorted(str(job) for job in jobs)
    for job in jobs[:-1]:
        report, row = found[str(job)], rows[str(job)]
        assert (row["verdict"], row["error"]) == (report.verdict, None)
        assert [(f["kind"], f["line"], f["text"]) for f in row["findings"]] == [(f.kind, f.line, f.text) for f in report.findings]
        bounds = [f.depth or (None, None) for f in report.findings]
        assert [(f["depth_low"], f["depth_high"]) for f in row["findings"]] == bounds
        assert [(f["x"], f["y"], f["z"]) for f in row["findings"]] == [f.point or (None,) * 3 for f in report.findings]
        assert [(g["line"], g["open"]) for g in row["gaps"]] == [(g.line, g.open) for g in report.gaps]
    missing = rows[str(jobs[-1])]
    assert missing["verdict"] is None and "missing.toml" in missing["error"]
    deep = dataset.to_table(filter=pyarrow.compute.field("verdict") == "findings")
    assert set(deep["job"].to_pylist()) == {str(jobs[1]), str(jobs[3])}


def test_a_job_that_takes_too_long_is_a_failure(cluster, tmp_path):
    block = touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm")
    trimesh = pytest.importorskip("trimesh")
    trimesh.Trimesh(block.vertices, block.faces).export(tmp_path / "block.stl")
    # Some minutes of motions, each of which is checked.
    lines = "".join(f"X{i % 7} Y{i % 5} Z{1 + i % 3}\n" for i in range(2_000_000))
    (tmp_path / "long.nc").write_text(f"G21 G90 G94 G54\nT1 M6\nS900 M3\nG0 X0 Y0 Z50\nG1 F100\n{lines}M30\n")
    job = tmp_path / "long.toml"
    job.write_text(
        'part = "block.stl"\nunit = "mm"\nprogram = "long.nc"\ncontrol = "linuxcnc"\nmachine = "3-axis"\n[tool.1]\ntool = "D2Ball"\n'
    )
    [(name, failure)] = touchoff.distributed.verify_many([job], max_time=1.5)
    assert isinstance(failure, TimeoutError) and "not checked within 1.5 s" in str(failure), (name, failure)
    for seconds in [0, -1, float("nan"), float("inf")]:
        with pytest.raises(ValueError, match="max_time"):
            next(touchoff.distributed.verify_many([job], max_time=seconds))


def test_a_job_that_loses_its_process_is_a_failure(cluster, tmp_path, monkeypatch):
    attempts = tmp_path / "attempts"

    def check(path, max_time):
        if path.endswith("other.toml"):
            return ValueError("no job")
        with attempts.open("a") as file:
            file.write("x")
        if path.endswith("fails.toml"):
            raise MemoryError
        os.kill(os.getpid(), signal.SIGKILL)

    monkeypatch.setattr(touchoff.distributed, "_check", check)
    jobs = [str(tmp_path / name) for name in ["kills.toml", "other.toml"]]
    found = dict(touchoff.distributed.verify_many(jobs, max_retries=1))
    assert attempts.read_text() == "xx"
    lost = found[jobs[0]]
    assert isinstance(lost, touchoff.distributed.LostWorkerError)
    assert "kills.toml: no report after 2 attempts" in str(lost)
    assert str(found[jobs[1]]) == "no job"
    # What a check raises is its answer, which another attempt would not change.
    [(_, failure)] = touchoff.distributed.verify_many([tmp_path / "fails.toml"])
    assert isinstance(failure, MemoryError) and attempts.read_text() == "xxx"
    for count in [-1, 0.5]:
        with pytest.raises((TypeError, ValueError), match="max_retries"):
            list(touchoff.distributed.verify_many(jobs, max_retries=count))
