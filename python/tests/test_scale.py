"""The questions of docs/scale.md, in SQL and in Polars, against the arrays of a sweep."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
import touchoff
from touchoff import _touchoff

duckdb = pytest.importorskip("duckdb")
pl = pytest.importorskip("polars")
PAGE = Path(os.environ.get("DOCS", Path(__file__).parents[2] / "docs")) / "scale.md"
TOOLS = ["BallEr16", "D2Ball"]
RULES = (20, 0.05, 0.0, [], False)


def pocket(width: float, depth: float) -> touchoff.Part:
    """A block with a square pocket."""
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((40, 40, 30)).subdivide_to_size(3)
    vertices = box.vertices.copy()
    inside = (abs(vertices[:, :2]).max(axis=1) < width / 2) & (vertices[:, 2] > 14.9)
    vertices[inside, 2] -= depth
    return touchoff.Part(vertices, box.faces, unit="mm")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Three parts with their tables, and the arrays of the same sweep."""
    root = tmp_path_factory.mktemp("scale")
    parts = {"flat": pocket(20, 0), "wide": pocket(27, 27), "narrow": pocket(9, 25)}
    tools = [touchoff.Tool.library(name) for name in TOOLS]
    maps = {}
    for name, part in parts.items():
        shard, table = root / f"{name}.parquet", root / "study" / f"part={name}" / "table.parquet"
        table.parent.mkdir(parents=True)
        _touchoff.write_shard(str(shard), _touchoff.Study(part._rust, [t._rust for t in tools], *RULES).shard(1, 1, 2))
        _touchoff.merge_shards([str(shard)], str(table))
        maps[name] = touchoff.sweep(part, tools, directions=20, tolerance=0.05)
    return root, maps


def block(language: str, number: int) -> str:
    """Return a block of the page."""
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(), re.S)[number]


def answer(root: Path, query: str) -> list[tuple]:
    before = os.getcwd()
    os.chdir(root)
    try:
        return duckdb.sql(query).fetchall()
    finally:
        os.chdir(before)


def test_triangles_that_no_tool_reaches(study):
    root, maps = study
    found = [(part, triangle) for part, triangle, _ in answer(root, block("sql", 0))]
    expected = [(part, int(k)) for part in sorted(maps) for k in np.flatnonzero(~maps[part].is_reached)]
    assert found == expected
    assert 0 < len(found) < sum(len(m.is_reached) for m in maps.values())
    lines = block("python", 2)
    before = os.getcwd()
    os.chdir(root)
    try:
        names: dict = {}
        exec(lines, names)
    finally:
        os.chdir(before)
    assert names["unreached"].select("part", "triangle").rows() == expected


def test_the_least_stick_out(study):
    root, maps = study
    found = dict(answer(root, block("sql", 1)))
    for part, arrays in maps.items():
        of_triangle = np.fmin.reduce(arrays.stickout, axis=1)
        assert found[part] == np.nanmax(of_triangle), part
    assert len(set(found.values())) > 1


@pytest.mark.parametrize("limit", [95, 40])
def test_parts_that_fit_a_machine(study, limit):
    root, maps = study
    query = block("sql", 2)
    assert "<= 95 " in query
    found = {part: (fits, left) for part, fits, left in answer(root, query.replace("<= 95 ", f"<= {limit} "))}
    for part, arrays in maps.items():
        tilt = np.degrees(np.arccos(arrays.directions[:, 2]))
        within = arrays.reached[:, :, tilt <= limit].any(axis=(1, 2))
        fits = bool(within[arrays.is_reached].all())
        assert found[part][0] == fits, part
        assert (found[part][1] is None) == fits
    if limit == 40:
        assert not all(fits for fits, _ in found.values())
