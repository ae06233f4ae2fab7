"""What users pass by mistake: an exception names the argument, the index and the remedy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

import touchoff

TRIANGLE = ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
DOWN = [0, 0, 1, 0, 0, 1]


@pytest.mark.parametrize(
    ("poses", "error", "words"),
    [
        ([], ValueError, ["poses", "(n, 6)"]),
        (np.zeros((0, 6)), ValueError, ["poses", "empty"]),
        (np.zeros((2, 5)), ValueError, ["poses", "(2, 5)", "(n, 4, 4)"]),
        ([DOWN, DOWN[:5]], ValueError, ["poses", "equally long"]),
        (np.ma.masked_array([DOWN, DOWN], mask=[[False] * 6, [True] * 6]), ValueError, ["poses", "masked"]),
        ([["a"] * 6], TypeError, ["poses", "dtype"]),
        ([[None] * 6], TypeError, ["poses", "dtype"]),
        (np.zeros((1, 6), dtype=complex), TypeError, ["poses", "complex"]),
        (np.zeros((1, 6), dtype=bool), TypeError, ["poses", "bool"]),
        ([DOWN, [0, 0, 1, 0, 0, 2]], ValueError, ["poses[1]", "axis"]),
        ([DOWN, [0, 0, np.nan, 0, 0, 1]], ValueError, ["poses[1]"]),
        ([[0, 0, 1, 0, 0, np.inf]], ValueError, ["poses[0]"]),
        ([[0, 0, 1, 0, 0, 0, 0]], ValueError, ["poses[0]", "quaternion"]),
        (np.eye(4) * 2, ValueError, ["poses[0]", "last row"]),
        (np.diag([2.0, 2.0, 2.0, 1.0]), ValueError, ["poses[0]", "rotation"]),
        (np.diag([1.0, 1.0, -1.0, 1.0]), ValueError, ["poses[0]", "rotation"]),
        (np.eye(4).T + [[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0]], ValueError, ["transpose"]),
    ],
)
def test_poses_are_refused(ball, block, poses, error, words):
    for query in (touchoff.wrench, touchoff.contacts, touchoff.detect, touchoff.certified_depth, touchoff.clearance):
        with pytest.raises(error) as raised:
            query(ball, block, poses)
        assert all(word in str(raised.value) for word in words), raised.value


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: touchoff.Part(*TRIANGLE), TypeError, ["unit", "mm"]),
        (lambda: touchoff.Part(*TRIANGLE, unit="cm"), ValueError, ["unit", "cm"]),
        (lambda: touchoff.Part(*TRIANGLE, unit=1), TypeError, ["unit"]),
        (lambda: touchoff.Part(TRIANGLE[0], unit="mm"), TypeError, ["faces"]),
        (lambda: touchoff.Part(TRIANGLE[0], [[0, 1, 3]], unit="mm"), ValueError, ["faces[0, 2]", "3"]),
        (lambda: touchoff.Part(TRIANGLE[0], [[0, 1, -1]], unit="mm"), ValueError, ["faces[0, 2]", "-1"]),
        (lambda: touchoff.Part(TRIANGLE[0], [[0.0, 1.0, 2.0]], unit="mm"), TypeError, ["faces", "float64"]),
        (lambda: touchoff.Part(TRIANGLE[0], [], unit="mm"), ValueError, ["faces", "empty"]),
        (lambda: touchoff.Part(TRIANGLE[0], [[0, 1]], unit="mm"), ValueError, ["faces", "(1, 2)"]),
        (lambda: touchoff.Part([[0, 0]] * 3, [[0, 1, 2]], unit="mm"), ValueError, ["vertices", "(3, 2)"]),
        (lambda: touchoff.Part([[0, 0, np.nan]] * 3, [[0, 1, 2]], unit="mm"), ValueError, ["vertex"]),
        (lambda: touchoff.Part([[0, 0, 0]] * 3, [[0, 1, 2]], unit="mm"), ValueError, ["area"]),
        (lambda: touchoff.Part(*TRIANGLE, unit="mm", points=0), ValueError, ["points"]),
        (lambda: touchoff.Part(*TRIANGLE, unit="mm", points=1.5), TypeError, ["points"]),
        (lambda: touchoff.Part.read("missing.stl", unit="mm"), FileNotFoundError, ["missing.stl"]),
        (lambda: touchoff.Part.read(__file__, unit="mm"), ValueError, ["test_inputs.py"]),
        (lambda: touchoff.Part.cuboid((0, 0, 0), (1, 1, 0), unit="mm"), ValueError, ["high"]),
        (lambda: touchoff.Part(TRIANGLE[0], [[0, 1, 2], [0, 1]], unit="mm"), ValueError, ["faces", "equally long"]),
        (lambda: touchoff.Part.read(3, unit="mm"), TypeError, ["path", "int"]),
        (lambda: touchoff.Tool.library(3), TypeError, ["name", "int"]),
        (lambda: touchoff.Tool.parse(b"tool"), TypeError, ["text", "bytes"]),
        (lambda: touchoff.Tool.parse("tool \udc80"), ValueError, ["text", "Unicode"]),
        (lambda: touchoff.PostureMap.read("missing.postures"), FileNotFoundError, ["missing.postures"]),
        (lambda: touchoff.Tool.library("Bal"), ValueError, ["Bal", "tool_names"]),
        (lambda: touchoff.Tool.load("missing.tool"), FileNotFoundError, ["missing.tool"]),
        (lambda: touchoff.Tool.parse("tool T { units mm; }"), touchoff.ToolError, ["error[T"]),
        (lambda: touchoff.Tool(), TypeError, ["Tool.load"]),
        (lambda: touchoff.import_tools("missing.json"), FileNotFoundError, ["missing.json"]),
        (lambda: touchoff.import_tools(__file__), ValueError, ["none of the formats"]),
        (lambda: touchoff.Part.read("missing.touchoff", unit="mm"), FileNotFoundError, ["missing.touchoff"]),
        (lambda: touchoff.Part.read("/", unit="mm"), OSError, ["regular file"]),
        (lambda: touchoff.Tool.library("Ball", q=1), touchoff.ToolError, ["q"]),
        (lambda: touchoff.Tool.library("Bal", D=1), ValueError, ["Bal", "tool_names"]),
        (lambda: touchoff.Job.load("missing.toml").check(), touchoff.JobError, ["missing.toml"]),
        (lambda: touchoff.Job.load("missing.toml").check(), FileNotFoundError, ["missing.toml"]),
        (lambda: touchoff.Job(part="p.stl", unit="mm", program="p.nc", tool={1: {"tool": "p.tool"}}).check(), FileNotFoundError, ["p."]),
        (lambda: touchoff.Job(part="p.stl").check(), touchoff.JobError, ["unit"]),
        (lambda: touchoff.Job(part="p.stl", colour=1).check(), touchoff.JobError, ["job: ", "colour"]),
        (lambda: touchoff.Job(part="p.stl", tool={1: {"allow": {"ball": np.nan}}}).check(), ValueError, ["tool.1.allow.ball", "NaN"]),
        (lambda: touchoff.Job(part=object()).check(), TypeError, ["part", "object", "paths"]),
        (lambda: touchoff.Job(program=["a", {1}]).check(), TypeError, ["program[1]", "set"]),
    ],
)
def test_mistakes_are_named(make, error, words):
    with pytest.raises(error) as raised:
        make()
    assert all(word in str(raised.value) for word in words), raised.value


def test_arguments_of_queries_are_checked(ball, block):
    with pytest.raises(TypeError, match="tool: a Tool is expected, not str"):
        touchoff.wrench("Ball", block, DOWN)
    with pytest.raises(TypeError, match="part: a Part is expected"):
        touchoff.wrench(ball, [[0, 0, 0]], DOWN)
    with pytest.raises(ValueError, match="law"):
        touchoff.wrench(ball, block, DOWN, law="hooke")
    with pytest.raises(ValueError, match="centre"):
        touchoff.wrench(ball, block, DOWN, centre=(0, 0))
    for tolerance, error in [(-1, ValueError), (np.nan, ValueError), ("small", TypeError), (True, TypeError)]:
        with pytest.raises(error, match="tolerance"):
            touchoff.certified_depth(ball, block, DOWN, tolerance=tolerance)
    with pytest.raises(ValueError, match="directions"):
        touchoff.sweep(block, ball, directions=100_000)
    with pytest.raises(ValueError, match="tools"):
        touchoff.sweep(block, [])
    for mistake, words in [
        ({"min_niceness": None}, "min_niceness"),
        ({"allow": {"ball": "deep"}}, r"allow\['ball'\]"),
        ({"allow": [("ball", 1)]}, "allow"),
        ({"tolerance": "small"}, "tolerance"),
    ]:
        with pytest.raises(TypeError, match=words):
            touchoff.sweep(block, ball, **mistake)
    with pytest.raises(TypeError, match="part: a Part is expected"):
        touchoff.sweep(ball, block)
    with pytest.raises(ValueError, match="too large"):
        touchoff.certified_depth(ball, block, DOWN, tolerance=10**400)
    assert touchoff.certified_depth(ball, block, DOWN, tolerance=np.array(1e-3)).high[0] < 1e-9
    # A compliance centre off the axis turns with the tool.
    with pytest.raises(ValueError, match=r"poses\[0\].*quaternions"):
        touchoff.wrench(ball, block, DOWN, centre=(1, 0, 0))
    # A solid without an axis needs its full rotation.
    with pytest.raises(ValueError, match=r"poses\[0\].*quaternions"):
        touchoff.wrench(touchoff.Tool.library("LBracket"), block, DOWN)


def test_non_contiguous_arrays_and_other_numbers_are_taken(ball, block):
    poses = np.tile(np.array(DOWN, dtype=float), (10, 1))
    poses[:, 2] = np.linspace(-1, 1, 10)
    expected = touchoff.certified_depth(ball, block, poses).low
    wide = np.zeros((10, 12))
    wide[:, ::2] = poses
    for same in (wide[:, ::2], np.asfortranarray(poses), poses.tolist(), poses.astype(">f8")):
        assert (touchoff.certified_depth(ball, block, same).low == expected).all()
    reverse = touchoff.certified_depth(ball, block, poses[::-1]).low
    assert np.allclose(reverse, expected[::-1], atol=2e-6)
    whole = touchoff.certified_depth(ball, block, np.array([DOWN, [0, 0, -1, 0, 0, 1]], dtype=np.int32))
    assert whole.high[0] < 1e-9 and whole.low[1] > 0.9


def test_ten_million_poses_need_no_copy_per_pose(ball, block):
    poses = np.tile(np.array([100.0, 0, 50, 0, 0, 1]), (10_000_000, 1))
    assert not touchoff.detect(ball, block, poses).any()


numbers = st.floats(allow_nan=True, allow_infinity=True, width=64)
shapes = arrays.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=7)
kinds = st.sampled_from([np.float64, np.float32, np.int64, np.uint8, np.bool_, np.complex128, np.str_, np.object_])


@settings(max_examples=300, deadline=None)
@given(poses=st.one_of(
    arrays.arrays(np.float64, shapes, elements=numbers),
    kinds.flatmap(lambda kind: arrays.arrays(kind, shapes) if kind is not np.object_ else st.just(np.array([object()]))),
))
def test_no_array_of_poses_ends_the_interpreter(ball, block, poses):
    for query in (touchoff.wrench, touchoff.contacts, touchoff.clearance, touchoff.signed_distance):
        try:
            query(ball, block, poses)
        except (TypeError, ValueError) as error:
            assert "poses" in str(error)


@settings(max_examples=200, deadline=None)
@given(
    vertices=arrays.arrays(np.float64, arrays.array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=5), elements=numbers),
    faces=arrays.arrays(np.int64, arrays.array_shapes(min_dims=1, max_dims=3, min_side=0, max_side=5)),
    points=st.one_of(st.integers(-2, 300), st.floats(), st.none()),
)
def test_no_mesh_ends_the_interpreter(ball, vertices, faces, points):
    try:
        part = touchoff.Part(vertices, faces, unit="mm", points=points)
        touchoff.wrench(ball, part, DOWN)
        touchoff.certified_depth(ball, part, DOWN)
    except (TypeError, ValueError) as error:
        assert str(error)


@settings(max_examples=200, deadline=None)
@given(text=st.one_of(st.text(), st.text(alphabet="tool unitsm;{}()<>=/*+-0123456789.profilestart,arcnecasutg \n")))
def test_no_text_of_a_tool_ends_the_interpreter(text):
    try:
        touchoff.Tool.parse(text)
    except touchoff.ToolError as error:
        assert "error" in str(error)


@settings(max_examples=100, deadline=None)
@given(keys=st.dictionaries(
    st.sampled_from(["part", "unit", "program", "tolerance", "tool", "stock", "fixture", "allow", "machine"]),
    st.recursive(st.one_of(st.none(), st.booleans(), numbers, st.text(), st.integers()), lambda inner: st.lists(inner, max_size=3), max_leaves=5),
))
def test_no_job_ends_the_interpreter(keys):
    try:
        touchoff.Job(**keys).check()
    except (TypeError, ValueError, OSError) as error:
        assert str(error)
