"""Parts and poses that tests share."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest

import touchoff

#: The tool of most tests: 6 mm ball, written out so that expected values are derived from it.
BALL = """tool Ball "6 mm ball" {
    units mm;
    profile { start (0, 0); arc to (0, 6) center (0, 3) as ball cutting; }
    niceness cutting: 1 - depth/3;
}"""


@pytest.fixture(scope="session")
def ball() -> touchoff.Tool:
    return touchoff.Tool.parse(BALL)


@pytest.fixture(scope="session")
def block() -> touchoff.Part:
    """A block whose top is the plane z = 0."""
    return touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm")


@pytest.fixture(scope="session")
def program() -> Path:
    """The program `touchoff`, which is built from the same sources."""
    path = os.environ.get("TOUCHOFF") or shutil.which("touchoff")
    if path is None:
        pytest.skip("the program touchoff is not installed: set TOUCHOFF to its path")
    return Path(path)


def write_ply(path: Path, part: touchoff.Part) -> None:
    """Write a mesh with the digits that give its numbers back."""
    lines = ["ply", "format ascii 1.0", f"element vertex {len(part.vertices)}"]
    lines += [f"property double {name}" for name in "xyz"]
    lines += [f"element face {len(part)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(repr, vertex)) for vertex in part.vertices.tolist()]
    lines += [" ".join(map(str, [3, *face])) for face in part.faces.tolist()]
    path.write_text("\n".join(lines) + "\n")


def random_poses(count: int, *, seed: int, spread: float = 8.0) -> np.ndarray:
    """Tips about the block's top, with axes in the upper half space."""
    random = np.random.default_rng(seed)
    tips = random.uniform(-spread, spread, (count, 3)) * (1, 1, 0.4)
    axes = random.normal(size=(count, 3))
    axes[:, 2] = np.abs(axes[:, 2]) + 0.1
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    return np.hstack([tips, axes])
