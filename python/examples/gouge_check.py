"""A program is checked against the finished part: the line, the depth and the remedy."""

import tempfile
from pathlib import Path

import touchoff

PROGRAM = """G21 G90 G54 G0 X-30. Y0. Z5.
T1 M6
S9000 M3
G43 H1 Z5.
G0 Z{depth}
G1 X30. F500.
G0 Z5.
G49
M30
"""

# A plate as an ASCII STL file, from a part in memory.
plate = touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm")
facets = ""
for a, b, c in plate.faces.tolist():
    corners = [plate.vertices[index].tolist() for index in (a, b, c)]
    loop = "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners)
    facets += f"facet normal 0 0 0\nouter loop\n{loop}endloop\nendfacet\n"

with tempfile.TemporaryDirectory() as folder:
    Path(folder, "plate.stl").write_text(f"solid plate\n{facets}endsolid plate\n")
    for depth in (0.2, -0.2):
        Path(folder, "plate.nc").write_text(PROGRAM.format(depth=depth))
        job = touchoff.Job(
            folder=folder,
            part="plate.stl",
            unit="mm",
            program="plate.nc",
            control="linuxcnc",
            tool={1: {"tool": "D2Ball"}},
        )
        report = job.check()
        print(f"to Z{depth}: {report.verdict}")
        for finding in report.findings:
            print(f"  {Path(finding.file).name}:{finding.line}: {finding.text}")
