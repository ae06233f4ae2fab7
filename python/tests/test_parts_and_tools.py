"""Parts, tools, libraries and maps."""

from __future__ import annotations

import json

import numpy as np
import pytest

import touchoff


def test_a_part_keeps_its_arrays(block):
    assert block.vertices.shape == (8, 3) and block.faces.shape == (12, 3) and len(block) == 12
    assert block.is_solid and block.unit == "mm" and "12 triangles" in repr(block)
    again = touchoff.Part(block.vertices, block.faces.astype(np.int64), unit="mm")
    assert (again.bounds == [[-20, -20, -10], [20, 20, 0]]).all()
    turned = touchoff.Part(block.vertices, block.faces[:, ::-1], unit="mm")
    assert not turned.is_solid and any("inside out" in line for line in turned.diagnostics)


def test_a_part_without_an_inside_is_refused_where_that_counts(ball, block):
    turned = touchoff.Part(block.vertices, block.faces[:, ::-1], unit="mm")
    buried = [0, 0, -9, 0, 0, 1]
    assert touchoff.signed_distance(ball, block, buried).high[0] < 0
    with pytest.raises(ValueError, match="surface_only"):
        touchoff.signed_distance(ball, turned, buried)
    assert touchoff.signed_distance(ball, turned, buried, surface_only=True).low[0] > 0
    with pytest.raises(ValueError, match="surface_only"):
        touchoff.sweep(turned, ball, directions=5)
    assert touchoff.sweep(turned, ball, directions=5, surface_only=True).reached.any()


def test_parts_of_points(ball, tmp_path):
    random = np.random.default_rng(1)
    points = np.hstack([random.uniform(-5, 5, (500, 2)), np.zeros((500, 1)), np.tile([0, 0, 1.0], (500, 1))])
    header = ["ply", "format ascii 1.0", "element vertex 500"] + [f"property double {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    rows = [" ".join(map(repr, row)) for row in points.tolist()]
    (tmp_path / "points.ply").write_text("\n".join([*header, "end_header", *rows]) + "\n")
    part = touchoff.Part.read(tmp_path / "points.ply", unit="mm")
    assert part and len(part) == 0 and "500 points" in repr(part) and not hasattr(part, "vertices")
    assert np.allclose(part.bounds, [points[:, :3].min(axis=0), points[:, :3].max(axis=0)], atol=1e-5)
    assert part.covering_radius is not None and not part.covering_radius_is_proved
    assert touchoff.detect(ball, part, [0, 0, -0.5, 0, 0, 1])[0]
    with pytest.raises(ValueError, match="needs triangles"):
        touchoff.certified_depth(ball, part, [0, 0, -0.5, 0, 0, 1])


def test_copies_and_errors_go_to_other_processes(ball, block, tmp_path):
    import copy
    import pickle

    for part in (block, pickle.loads(pickle.dumps(block)), copy.deepcopy(block)):
        for tool in (ball, pickle.loads(pickle.dumps(ball)), copy.copy(ball)):
            depth = touchoff.certified_depth(tool, part, [0, 0, -0.5, 0, 0, 1])
            assert depth.low[0] <= 0.5 <= depth.high[0]
    assert pickle.loads(pickle.dumps(touchoff.Tool.library("D2Ball"))).name == "D2Ball"
    error = pickle.loads(pickle.dumps(touchoff.ToolError("said")))
    assert isinstance(error, touchoff.ToolError) and isinstance(error, ValueError)
    assert not block.vertices.flags.writeable


def test_assemblies_are_drawn():
    assert all(touchoff.Tool.library(name).svg().startswith("<svg") for name in touchoff.tool_names())


def test_meshes_of_trimesh_are_taken():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((2, 2, 2))
    assert touchoff.Part(box, unit="mm").is_solid
    box.units = "inches"
    assert touchoff.Part(box).unit == "inch"
    with pytest.raises(TypeError, match="faces"):
        touchoff.Part(box, [[0, 1, 2]], unit="mm")


def test_tools_from_everywhere(tmp_path):
    assert {"Ball", "D2Ball", "BallEr16"} <= set(touchoff.tool_names())
    ball = touchoff.Tool.library("D2Ball")
    assert ball.name == "D2Ball" and ball.unit == "mm" and ball.radius == 1 and ball.is_exact
    assert [surface.name for surface in ball.surfaces if surface.cutting]
    assert ball.svg().startswith("<svg") and ball._repr_svg_() == ball.svg()
    text = "tool Pin { units mm; param r = 2; profile { start (0, 0); line to (r, 0), (r, 9), (0, 9) as pin cutting; } }"
    (tmp_path / "pin.tool").write_text(text)
    for pin in (touchoff.Tool.load(tmp_path / "pin.tool", {"r": 3}), touchoff.Tool.parse(text, {"r": "1 + 2"})):
        assert pin.radius == 3 and pin.name == "Pin" and pin.title == ""
    with pytest.raises(touchoff.ToolError, match="error"):
        touchoff.Tool.parse(text, {"q": 3})
    with pytest.raises(TypeError, match="params"):
        touchoff.Tool.parse(text, ["r=3"])


def test_built_in_tools_take_params():
    import pickle

    wide = touchoff.Tool.library("Ball", D=6, flute="2*8")
    assert wide.radius == 3 and touchoff.Tool.library("Ball").radius == 5
    assert pickle.loads(pickle.dumps(wide)).radius == 3
    # A tool that mounts a holder finds it.
    assert touchoff.Tool.library("BallEr16", stickout=40).is_exact


def test_fields_of_results_are_documented():
    import dataclasses

    classes = [value for value in vars(touchoff).values() if dataclasses.is_dataclass(value)]
    assert len(classes) > 10
    for one in classes:
        documented = one.__doc__.split("Attributes\n    ----------")[1]
        listed = {name.strip() for line in documented.splitlines() if line.startswith("    ") for name in line.strip().split(",")}
        missing = {field.name for field in dataclasses.fields(one)} - listed
        assert not missing, (one, missing)


def test_the_first_query_shows_the_warnings_of_a_tool(block):
    import re
    import warnings

    text = "tool B { units mm; profile { start (0,0); arc to (0,6) center (0,3) as ball cutting; } %s }"
    pose = [0, 0, -0.5, 0, 0, 1]
    for law, words in (
        ("magnitude: 5;", "T0627.*exert no force"),
        ("magnitude: 2*depth;", "T0628.*counts in the force"),
        ("region low where z <= 3 { direction: (0, -1) allow oblique; } region high where z >= 3 {}", "T0629.*direction of low"),
    ):
        tool = touchoff.Tool.parse(text % law)
        with pytest.warns(touchoff.ToolWarning) as said:
            touchoff.wrench(tool, block, pose)
        assert len(said) == 1 and said[0].filename == __file__
        assert re.search(words, str(said[0].message), re.S), said[0].message
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            touchoff.wrench(tool, block, pose)
            touchoff.wrench(touchoff.Tool.parse(text % ""), block, pose)


def test_the_default_law_is_that_of_an_energy(block):
    """A factor of the magnitude counts squared, a constant one has no slope."""
    text = "tool B { units mm; profile { start (0,0); arc to (0,6) center (0,3) as ball cutting; } magnitude: %s; }"
    import warnings

    forces = {}
    for law in ("depth", "2*depth", "5"):
        tool = touchoff.Tool.parse(text % law)
        with warnings.catch_warnings(action="ignore"):
            found = touchoff.wrench(tool, block, [0, 0, -0.5, 0, 0, 1])
            assert (found.force == touchoff.wrench(tool, block, [0, 0, -0.5, 0, 0, 1], law="gradient").force).all()
        forces[law] = found.force[0, 2]
    assert forces["5"] == 0 and forces["2*depth"] == pytest.approx(4 * forces["depth"])


def test_normals_that_face_inward_are_named(tmp_path):
    from test_processes import write_cloud

    for inward, words in ((False, []), (True, ["the normals face into the material", "100 %"])):
        write_cloud(tmp_path / "scan.ply", 3_000, inward=inward)
        said = touchoff.Part.read(tmp_path / "scan.ply", unit="mm").diagnostics
        assert len(said) == (1 if inward else 0) and all(word in said[0] for word in words)


def test_libraries_of_cam_systems(tmp_path):
    entry = {
        "type": "ball end mill",
        "unit": "millimeters",
        "description": "D6 ball",
        "geometry": {"DC": 6, "RE": 3, "LCF": 20, "OAL": 50, "SFDM": 6},
        "post-process": {"number": 7},
    }
    file = tmp_path / "library.json"
    file.write_text(json.dumps({"data": [entry, {"type": "probe", "description": "touch probe"}]}))
    library = touchoff.import_tools(file)
    assert [tool.title for tool in library.tools] == ["D6 ball"] and len(library.left_out) == 1
    assert library.tools[0].number == 7 and library.tools[0].tool.radius == 3
    for known in (7, "7", "T7", "D6 ball"):
        assert touchoff.Tool.from_library_file(file, known).name == library.tools[0].tool.name
    with pytest.raises(KeyError, match="0 tools are called 8.*touch probe is left out"):
        touchoff.Tool.from_library_file(file, 8)
    with pytest.raises(TypeError, match="tool"):
        touchoff.Tool.from_library_file(file, None)
    assert library.tools[0].tool.svg().startswith("<svg")


def test_a_sweep_says_which_triangles_are_reached(block):
    ball = touchoff.Tool.library("D2Ball")
    found = touchoff.sweep(block, [ball], directions=20)
    triangles, tools, directions = found.reached.shape
    assert (triangles, tools, directions) == (12, 1, 40) and found.tools == ["D2Ball"]
    assert found.is_reached.all() and (found.tool == 0).all() and (found.depth <= 0.01).all()
    # No direction from behind a face reaches it.
    corners = block.vertices[block.faces.astype(np.int64)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    behind = normals @ found.directions.T < 0
    assert not (found.reached[:, 0] & behind & (found.directions @ [0, 0, 1] < -2)).any()
    assert np.isnan(found.stickout).all()
    best = np.hstack([found.tip, found.axis])
    assert (touchoff.certified_depth(ball, block, best).high <= found.depth + 1e-4).all()


def test_a_map_of_the_program_is_read(program, block, tmp_path):
    import subprocess

    stl = tmp_path / "block.stl"
    corners = block.vertices[block.faces.astype(np.int64)]
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corner) + "endloop\nendfacet\n"
        for corner in corners
    )
    stl.write_text(f"solid\n{facets}endsolid\n")
    command = [program, "sweep", "--part", stl, "--unit", "mm", "--tool", "D2Ball", "--directions", "20"]
    subprocess.run([*command, "-o", tmp_path / "block.postures"], check=True, capture_output=True)
    read = touchoff.PostureMap.read(tmp_path / "block.postures")
    found = touchoff.sweep(touchoff.Part.read(stl, unit="mm"), touchoff.Tool.library("D2Ball"), directions=20)
    assert (read.reached == found.reached).all() and (read.directions == found.directions).all()
    assert (read.tip == found.tip).all() and (read.clearance == found.clearance).all()
    with pytest.raises(ValueError, match="block.stl"):
        touchoff.PostureMap.read(stl)


def test_a_path_is_a_table_for_any_reader(program, tmp_path):
    import csv
    import subprocess

    from conftest import write_ply

    block = touchoff.Part.cuboid((-6, -6, -4), (6, 6, 0), unit="mm")
    write_ply(tmp_path / "block.ply", block)
    part = ["--part", tmp_path / "block.ply"]
    sweep = [program, "sweep", *part, "--unit", "mm", "--tool", "D2Ball", "--directions", "20", "-o", tmp_path / "block.postures"]
    path = [program, "path", tmp_path / "block.postures", *part, "--tool", "D2Ball", "--stepover", "4", "-o", tmp_path / "path.csv"]
    for command in (sweep, path):
        subprocess.run(command, check=True, capture_output=True)
    with open(tmp_path / "path.csv", newline="") as file:
        rows = list(csv.DictReader(file, strict=True))
    poses = np.array([[float(row[name]) for name in "xyzijk"] for row in rows])
    assert len(poses) > 20 and np.allclose(np.linalg.norm(poses[:, 3:], axis=1), 1)
    assert (touchoff.certified_depth(touchoff.Tool.library("D2Ball"), block, poses).low < 0.02).all()
    keys = {"part": "block.ply", "unit": "mm", "program": "path.csv", "tolerance": 0.02, "tool": {1: {"tool": "D2Ball"}}}
    assert touchoff.Job(folder=tmp_path, **keys).check().verdict == "clean"
    # The same with pandas, which knows no comments unless it is told.
    pandas = pytest.importorskip("pandas")
    table = pandas.read_csv(tmp_path / "path.csv")
    assert (table[list("xyzijk")].to_numpy(float) == poses).all()
