"""Forked processes, interrupts and pickles: what becomes of work and of parts that go to other processes."""

from __future__ import annotations

import multiprocessing
import pickle
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import BALL, write_ply

import touchoff
from touchoff import _touchoff

DOWN = [0.0, 0, -0.5, 0, 0, 1]


def write_cloud(path: Path, count: int, *, inward: bool = False) -> None:
    """Write points with normals on a sphere of 10 mm."""
    random = np.random.default_rng(count)
    normals = random.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    header = ["ply", "format ascii 1.0", f"element vertex {count}"]
    header += [f"property double {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    rows = np.hstack([10 * normals, -normals if inward else normals])
    path.write_text("\n".join([*header, "end_header", *(" ".join(map(repr, row)) for row in rows.tolist())]) + "\n")


@pytest.fixture
def files(tmp_path: Path, block) -> Path:
    """A folder with a mesh, a cloud, a tool and a job."""
    write_ply(tmp_path / "block.ply", block)
    write_cloud(tmp_path / "cloud.ply", 3_000)
    (tmp_path / "ball.tool").write_text(BALL)
    (tmp_path / "path.csv").write_text("x,y,z,i,j,k\n0,0,1,0,0,1\n1,0,1,0,0,1\n")
    return tmp_path


def cloud_query(files: Path) -> None:
    part = touchoff.Part.read(files / "cloud.ply", unit="mm")
    touchoff.wrench(touchoff.Tool.parse(BALL), part, DOWN)
    assert part.diagnostics == []


def mesh_queries(files: Path) -> None:
    part, tool = touchoff.Part.read(files / "block.ply", unit="mm"), touchoff.Tool.load(files / "ball.tool")
    for query in (touchoff.wrench, touchoff.contacts, touchoff.detect, touchoff.certified_depth, touchoff.clearance):
        query(tool, part, np.tile(DOWN, (500, 1)))
    assert touchoff.signed_distance(tool, part, DOWN).high[0] < 0
    assert part.is_solid and part.diagnostics


def a_sweep(files: Path) -> None:
    part, tool = touchoff.Part.read(files / "block.ply", unit="mm"), touchoff.Tool.load(files / "ball.tool")
    touchoff.sweep(part, tool, directions=5)
    study = _touchoff.Study(part._rust, [tool._rust], 5, None, 0.0, [], False)
    shard, table = files / "shard.parquet", files / "table.parquet"
    _touchoff.write_shard(str(shard), study.shard(1, 1, 2))
    assert study.is_done(str(shard), 1, 1)
    assert _touchoff.merge_shards([str(shard)], str(table)) == 12


def a_job(files: Path) -> None:
    job = touchoff.Job(folder=files, part="block.ply", unit="mm", program="path.csv", tool={1: {"tool": "ball.tool"}})
    assert job.check().verdict == "clean"


def pickles(files: Path) -> None:
    part = touchoff.Part.read(files / "cloud.ply", unit="mm")
    assert len(pickle.loads(pickle.dumps(part)).bounds) == 2


@pytest.mark.parametrize("work", [cloud_query, mesh_queries, a_sweep, a_job, pickles])
def test_a_forked_process_can_do_all_that_its_parent_did(files, work: Callable[[Path], None]):
    """The parent has run the same before, so that all of its threads were started."""
    work(files)
    worker = multiprocessing.get_context("fork").Process(target=work, args=(files,))
    worker.start()
    worker.join(timeout=120)
    hangs = worker.exitcode is None
    if hangs:
        worker.kill()
    assert not hangs and worker.exitcode == 0


def sphere(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of an octahedron whose faces are divided into four again and again, on a sphere of 20 mm."""
    vertices = [(1.0, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    corners = np.array(vertices)[np.array(faces)]
    for _ in range(subdivisions):
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        ab, bc, ca = ((one + other) / 2 for one, other in ((a, b), (b, c), (c, a)))
        corners = np.concatenate([np.stack(four, axis=1) for four in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    corners = 20 * corners / np.linalg.norm(corners, axis=2, keepdims=True)
    found, index = np.unique(corners.reshape(-1, 3).round(9), axis=0, return_inverse=True)
    return found, index.reshape(-1, 3)


def interrupted(number: int, frame: object) -> None:
    raise KeyboardInterrupt


def cpu_seconds(work: Callable[[], object], interrupt: float | None) -> float:
    """Return the CPU time that work takes, with an interrupt after some seconds."""
    previous = signal.signal(signal.SIGALRM, interrupted)
    begin, start = time.process_time(), time.perf_counter()
    try:
        if interrupt is None:
            work()
        else:
            signal.setitimer(signal.ITIMER_REAL, interrupt)
            with pytest.raises(KeyboardInterrupt):
                work()
            print(f"{time.perf_counter() - start - interrupt:.2f} s after the interrupt")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)
    return time.process_time() - begin


def sampling() -> Callable[[], object]:
    vertices, faces = sphere(4)
    tool = touchoff.Tool.library("D2Ball")
    return lambda: touchoff.detect(tool, touchoff.Part(vertices, faces, unit="mm", points=150_000), DOWN)


def a_cloud(folder: Path) -> Callable[[], object]:
    write_cloud(folder / "cloud.ply", 150_000)
    return lambda: touchoff.Part.read(folder / "cloud.ply", unit="mm")


def one_slow_stretch() -> Callable[[], object]:
    vertices, faces = sphere(5)
    tool, part = touchoff.Tool.library("FaceMill"), touchoff.Part(vertices, faces, unit="mm")
    touchoff.certified_depth(tool, part, DOWN)
    # Fewer poses than are queried at a time, each with a wide contact.
    steps = np.linspace(0, 3, 3_000)[:, None]
    poses = np.array([[0.0, 0, 15, 0, 0, 1]]) + steps * [1, 0.5, 0, 0, 0, 0]
    return lambda: touchoff.certified_depth(tool, part, poses, tolerance=1e-9)


def many_directions() -> Callable[[], object]:
    vertices, faces = sphere(3)
    tool, part = touchoff.Tool.library("BallEr16"), touchoff.Part(vertices, faces, unit="mm")
    # All triangles in two batches.
    return lambda: touchoff.sweep(part, tool, directions=2_000)


def a_long_program(folder: Path) -> Callable[[], object]:
    write_ply(folder / "block.ply", touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm"))
    angles = np.linspace(0, 2000, 400_000)
    rows = [f"{9 * np.cos(a):.6f},{9 * np.sin(a):.6f},-0.5,0,0,1" for a in angles]
    (folder / "long.csv").write_text("\n".join(["x,y,z,i,j,k", *rows]) + "\n")
    keys = {"part": "block.ply", "unit": "mm", "program": "long.csv", "tool": {1: {"tool": "D2Ball"}}}
    return touchoff.Job(folder=folder, tolerance=1.0, **keys).check


@pytest.mark.parametrize(
    "make", [lambda _: sampling(), a_cloud, lambda _: one_slow_stretch(), lambda _: many_directions(), a_long_program],
    ids=["points", "cloud", "certified", "sweep", "job"],
)
def test_an_interrupt_ends_long_work(make, tmp_path):
    """The work that is left after an interrupt is not done: neither before the exception nor behind it."""
    work = make(tmp_path)
    begin = time.perf_counter()
    whole = cpu_seconds(work, None)
    elapsed = time.perf_counter() - begin
    print(f"{whole:.2f} s of CPU time in {elapsed:.2f} s")
    assert cpu_seconds(work, 0.1 * elapsed) < 0.7 * whole
    # Threads that went on would take their time now.
    begin = time.process_time()
    time.sleep(0.3 * elapsed)
    assert time.process_time() - begin < 0.2 * whole


def test_an_interrupt_leaves_a_part_usable(ball, block):
    vertices, faces = sphere(4)
    part = touchoff.Part(vertices, faces, unit="mm", points=150_000)
    cpu_seconds(lambda: touchoff.detect(ball, part, DOWN), 0.1)
    assert touchoff.detect(ball, part, [0, 0, 19.5, 0, 0, 1])[0]


def test_a_pickled_part_is_the_same_part_or_none(files, block):
    for name, query in (("block.ply", touchoff.certified_depth), ("cloud.ply", touchoff.detect)):
        path = files / name
        part = touchoff.Part.read(path, unit="mm")
        pickled = pickle.dumps(part)
        assert pickle.loads(pickled).bounds.tolist() == part.bounds.tolist()
        query(touchoff.Tool.parse(BALL), pickle.loads(pickled), DOWN)
        other = touchoff.Part.cuboid((-9, -9, -9), (9, 9, 0), unit="mm")
        write_ply(path, other)
        with pytest.raises(ValueError, match=rf"{name} has changed since .* SHA-256 .*: read the part anew"):
            pickle.loads(pickled)
        # What was read stays what it was.
        assert part.bounds.tolist() != other.bounds.tolist()
        path.unlink()
        with pytest.raises(FileNotFoundError, match=name):
            pickle.loads(pickled)


def test_a_pickle_names_the_file_from_any_folder(files, monkeypatch):
    monkeypatch.chdir(files)
    part, tool = touchoff.Part.read("block.ply", unit="mm"), touchoff.Tool.load("ball.tool")
    pickled = pickle.dumps((part, tool))
    monkeypatch.chdir("/")
    part, tool = pickle.loads(pickled)
    assert len(part) == 12 and tool.name == "Ball"


def test_a_pickled_tool_is_the_same_tool_or_none(files):
    path = files / "ball.tool"
    tool = touchoff.Tool.load(path)
    pickled = pickle.dumps(tool)
    # Another title, another comment: the same tool.
    path.write_text("// a comment\n" + BALL)
    assert pickle.loads(pickled).radius == 3
    path.write_text(BALL.replace("(0, 6) center (0, 3)", "(0, 8) center (0, 4)"))
    with pytest.raises(ValueError, match=r"ball.tool has changed .*: load the tool anew"):
        pickle.loads(pickled)


def test_saved_points_are_read(program, files):
    command = [program, "sample", "--part", files / "block.ply", "--unit", "mm", "--points", "4000"]
    subprocess.run([*command, "-o", files / "block.touchoff"], check=True, capture_output=True)
    tool = touchoff.Tool.library("D2Ball")
    sampled = touchoff.Part.read(files / "block.ply", unit="mm", points=4_000)
    poses = np.tile(DOWN, (50, 1)) + np.linspace(0, 5, 50)[:, None] * [1, 1, 0, 0, 0, 0]
    for saved in (part := touchoff.Part.read(files / "block.touchoff", unit="mm"), pickle.loads(pickle.dumps(part))):
        assert "4000 points" in repr(saved) and saved.covering_radius == sampled.covering_radius
        assert (touchoff.wrench(tool, saved, poses).force == touchoff.wrench(tool, sampled, poses).force).all()
        assert any("12 triangles" in line for line in saved.diagnostics)
    inch = touchoff.Part.read(files / "block.touchoff", unit="inch")
    assert np.allclose(inch.bounds * 25.4, saved.bounds)
    (files / "block.touchoff").write_bytes(b"no part")
    with pytest.raises(ValueError, match="block.touchoff"):
        touchoff.Part.read(files / "block.touchoff", unit="mm")
