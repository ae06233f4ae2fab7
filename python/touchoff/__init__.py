"""Contact between a cutting tool and a workpiece, at any pose.

Arrays of poses in, arrays of answers out. Every answer states its error: sampled depths have a covering radius and a
rounding error, certified ones an interval that is proved.

>>> import touchoff
>>> tool = touchoff.Tool.library("Ball")
>>> part = touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm")
>>> touchoff.certified_depth(tool, part, [[0, 0, -0.5, 0, 0, 1]], tolerance=1e-9).low.round(6)
array([0.5])

Lengths are in the part's unit, frames are right-handed, and a tool's axis points from the tip to the spindle.
"""

from ._touchoff import JobError, JobFileNotFoundError, ToolError, tool_names
from .job import Finding, Gap, Job, Report
from .part import Part
from .queries import (
    Clearance,
    Contacts,
    Depth,
    Distance,
    Wrench,
    certified_depth,
    clearance,
    contacts,
    detect,
    signed_distance,
    wrench,
)
from .sweep import PostureMap, sweep
from .tool import ImportedTool, Surface, Tool, ToolLibrary, ToolWarning, import_tools

__all__ = [
    "Clearance",
    "Contacts",
    "Depth",
    "Distance",
    "Finding",
    "Gap",
    "ImportedTool",
    "Job",
    "JobError",
    "JobFileNotFoundError",
    "Part",
    "PostureMap",
    "Report",
    "Surface",
    "Tool",
    "ToolError",
    "ToolLibrary",
    "ToolWarning",
    "Wrench",
    "certified_depth",
    "clearance",
    "contacts",
    "detect",
    "import_tools",
    "signed_distance",
    "sweep",
    "tool_names",
    "wrench",
]
