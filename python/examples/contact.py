"""From a part and a tool to an array of contacts."""

import touchoff

part = touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm")
tool = touchoff.Tool.library("D2Ball")
found = touchoff.contacts(tool, part, [[0, 0, -0.5, 0, 0, 1]])
print(len(found), "contacts, the deepest", found.depth.max(), part.unit)
