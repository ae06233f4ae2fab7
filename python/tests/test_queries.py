"""Queries, against closed forms and against the program."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import random_poses, write_ply

import touchoff


def ball_height(poses: np.ndarray) -> np.ndarray:
    """Height of the ball's lowest point above the block's top: its centre is 3 mm along the axis."""
    return poses[:, 2] + 3.0 * poses[:, 5] - 3.0


def test_certified_depth_is_that_of_a_ball_in_a_plane(ball, block):
    poses = random_poses(2_000, seed=1)
    height = ball_height(poses)
    found = touchoff.certified_depth(ball, block, poses, tolerance=1e-9)
    # The deepest point of the plane is below the centre, or above it; poses near the block's other faces are left out.
    expected = np.maximum(np.minimum(-height, 6 + height), 0)
    known = height > -6
    assert known.sum() > 1_000
    assert (found.low[known] <= expected[known] + 1e-12).all()
    assert (found.high[known] >= expected[known] - 1e-12).all()
    assert (found.high - found.low < 4e-9).all()
    touching = found.triangle >= 0
    assert touching.sum() > 200 and (found.surface[touching] == 0).all()
    assert np.isnan(found.point[~touching]).all()


def test_clearance_has_the_nearest_points_of_both(ball, block):
    poses = random_poses(2_000, seed=2)
    poses[:, 2] += 5
    height = ball_height(poses)
    found = touchoff.clearance(ball, block, poses, tolerance=1e-9)
    apart = height > 0.1
    assert apart.sum() > 1_000
    assert (np.abs(found.low - height)[apart] < 1e-8).all()
    # The nearest points are below the centre: on the plane and on the ball. Points off by the root of the tolerance are as near.
    centre = poses[:, :3] + 3.0 * poses[:, 3:]
    assert np.allclose(found.point[apart][:, :2], centre[apart][:, :2], atol=1e-3)
    assert np.allclose(found.point[apart][:, 2], 0, atol=1e-9)
    assert np.allclose(found.tool_point[apart], centre[apart] - [0, 0, 3], atol=1e-3)
    assert np.allclose(found.normal[apart], [0, 0, -1], atol=1e-3)


def test_signed_distance_continues_the_clearance_below_zero(ball, block):
    poses = np.zeros((201, 6))
    poses[:, 5] = 1
    poses[:, 2] = np.linspace(-2, 2, 201)
    found = touchoff.signed_distance(ball, block, poses, tolerance=1e-9)
    assert (found.low <= poses[:, 2] + 1e-12).all() and (found.high >= poses[:, 2] - 1e-12).all()
    assert (found.high - found.low < 1e-8).all()
    buried = touchoff.signed_distance(touchoff.Tool.library("UnitSphere"), block, [0, 0, -6, 0, 0, 1])
    assert buried.low[0] == -np.inf and buried.high[0] < -1


def test_poses_agree_in_all_formats(ball, block):
    turn = np.array([0.1, -0.2, 0.3, 0.9])
    x, y, z, w = turn / np.linalg.norm(turn)
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = 1, 2, -0.5
    axis = np.concatenate([matrix[:3, 3], matrix[:3, 2]])
    quaternion = np.concatenate([matrix[:3, 3], [x, y, z, w]])
    depths = [touchoff.certified_depth(ball, block, one).low[0] for one in (axis, quaternion, matrix)]
    assert depths[0] > 0 and np.ptp(depths) < 1e-12
    several = touchoff.detect(ball, block, np.stack([matrix, matrix]))
    assert several.dtype == bool and several.tolist() == [True, True]


def test_wrench_and_contacts_agree(ball, block):
    poses = random_poses(500, seed=3)
    found = touchoff.wrench(ball, block, poses, law="thesis")
    listed = touchoff.contacts(ball, block, poses)
    assert listed.offsets[0] == 0 and listed.offsets[-1] == len(listed) == found.colliding.sum()
    assert (np.diff(listed.offsets) == found.colliding).all()
    assert (np.bincount(listed.pose, minlength=500) == found.colliding).all()
    # The law of the thesis, summed here: weight times magnitude along the normal less the direction.
    terms = (listed.weight * listed.magnitude)[:, None] * (listed.normal - listed.direction)
    force = np.zeros((500, 3))
    np.add.at(force, listed.pose, terms)
    assert np.allclose(force, found.force, rtol=1e-12, atol=1e-9)
    deepest = np.zeros(500)
    np.maximum.at(deepest, listed.pose, listed.depth)
    assert (deepest == found.depth).all()
    assert (touchoff.detect(ball, block, poses) == (found.colliding > 0)).all()
    # Sampled depths are below certified ones, by the covering radius at most.
    bounds = touchoff.certified_depth(ball, block, poses)
    assert (found.depth <= bounds.high + 1e-9).all()
    assert block.covering_radius is not None
    assert (found.depth + block.covering_radius >= bounds.low - 1e-6).all()


@pytest.mark.parametrize("law", ["thesis", "gradient", "facing"])
def test_results_have_the_bits_of_the_program(program: Path, block, tmp_path: Path, law: str):
    """10,000 poses: the program prints each number with the digits that give it back."""
    poses = random_poses(10_000, seed=4)
    lines = ["x,y,z,i,j,k"] + [",".join(repr(float(v)) for v in row) for row in poses]
    (tmp_path / "poses.csv").write_text("\n".join(lines) + "\n")
    # The program reads the vertices as the file has them.
    part = tmp_path / "block.ply"
    write_ply(part, block)
    read = touchoff.Part.read(part, unit="mm")
    found = touchoff.wrench(touchoff.Tool.library("D2Ball"), read, poses, law=law)
    command = [program, "run", "--part", part, "--unit", "mm", "--tool", "D2Ball"]
    command += ["--program", tmp_path / "poses.csv", "--law", law, "--json"]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = [json.loads(line) for line in printed.splitlines()]
    assert len(rows) == 10_000
    assert [row["depth"] for row in rows] == found.depth.tolist()
    assert [row["force"] for row in rows] == found.force.tolist()
    assert [row["torque"] for row in rows] == found.torque.tolist()
    assert sum(depth > 0 for depth in found.depth) > 1_000


def test_threads_share_tool_and_part(ball, block):
    """The interpreter's lock is released: several threads run the same query, with the same bits."""
    from concurrent.futures import ThreadPoolExecutor

    poses = random_poses(3_000, seed=5)
    alone = touchoff.certified_depth(ball, block, poses)
    with ThreadPoolExecutor(4) as pool:
        several = list(pool.map(lambda _: touchoff.certified_depth(ball, block, poses), range(8)))
    assert all((one.low == alone.low).all() and (one.high == alone.high).all() for one in several)
