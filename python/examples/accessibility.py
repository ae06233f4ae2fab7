"""Which triangles of a pocket a tool reaches, and how much stick-out its holder leaves."""

import numpy as np

import touchoff

# A block with a square pocket: a ring of quads, the pocket's walls, its floor, and the outside.
outer = np.array([[-15, -15], [15, -15], [15, 15], [-15, 15]], dtype=float)
inner = outer * 0.4


def ring(corners: np.ndarray, height: float) -> list[list[float]]:
    return [[x, y, height] for x, y in corners.tolist()]


vertices = ring(outer, 0) + ring(outer, 14) + ring(inner, 14) + ring(inner, 2)
faces = [[0, 3, 2], [0, 2, 1], [12, 13, 14], [12, 14, 15]]
for level in (0, 4, 8):
    for k in range(4):
        a, b = level + k, level + (k + 1) % 4
        faces += [[a, b, b + 4], [a, b + 4, a + 4]]

part = touchoff.Part(vertices, faces, unit="mm")
print(part, "solid" if part.is_solid else part.diagnostics)
tools = [touchoff.Tool.library(name) for name in ("D2Ball", "BallEr16")]
found = touchoff.sweep(part, tools, directions=50)
for index, tool in enumerate(tools):
    share = found.reached[:, index].any(axis=1).mean()
    print(f"{tool.name} reaches {share:.0%} of the triangles")
