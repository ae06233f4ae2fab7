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
    assert touchoff.Tool.from_library_file(file, 7).name == library.tools[0].tool.name
    with pytest.raises(KeyError, match="0 tools are called 8"):
        touchoff.Tool.from_library_file(file, 8)


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
