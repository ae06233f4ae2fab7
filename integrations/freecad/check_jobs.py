"""Runs in `freecadcmd`: the jobs of `integrations/jobs` as jobs of FreeCAD, with the verdicts that they must have.

`TOUCHOFF_ADDON` is this folder. Ends with status 1 if a verdict differs.
"""

import json
import os
import sys
import tempfile
import traceback

ADDON = os.environ["TOUCHOFF_ADDON"]
JOBS = os.path.join(ADDON, "..", "jobs")
sys.path.insert(0, ADDON)

import FreeCAD
import Part
from FreeCAD import Vector

try:
    import Path.Main.Job as PathJob
except ImportError:
    # FreeCAD before 0.21.
    import PathScripts.PathJob as PathJob

from touchoff_cam import command, findings
from touchoff_cam import job as jobs


def bracket(document):
    """The finished part of the jobs, as a solid."""
    outline = [(0, 0), (60, 0), (60, 40), (40, 40), (40, 10), (0, 10), (0, 0)]
    face = Part.Face(Part.makePolygon([Vector(x, 0, z) for x, z in outline]))
    part = document.addObject("Part::Feature", "Bracket")
    part.Shape = face.extrude(Vector(0, 40, 0))
    return part


def clamp(document):
    """The clamp beside it, in the group of fixtures."""
    block = document.addObject("Part::Box", "Clamp")
    block.Length, block.Width, block.Height = 10, 20, 60
    block.Placement.Base = Vector(0, 45, 0)
    block.Label = "clamp"
    group = document.addObject("App::DocumentObjectGroup", "Fixtures")
    group.addObject(block)


def check(name, tool=None):
    """Verify a job with a stated tool, or with FreeCAD's own bit, and return the report and the findings' marks."""
    document = FreeCAD.newDocument(name)
    part = bracket(document)
    clamp(document)
    document.recompute()
    job = PathJob.Create("Job", [part])
    controller = job.Tools.Group[0]
    if tool is not None:
        controller.addProperty("App::PropertyString", jobs.TOOL_FILE, "Touchoff", "the tool with its holder")
        setattr(controller, jobs.TOOL_FILE, tool)
    document.recompute()
    report = command.verify(job, os.path.join(JOBS, f"{name}.nc"), control="linuxcnc")
    group = next(obj for obj in document.Objects if obj.Name.startswith(findings.GROUP))
    marks = list(group.Group)
    # A second check replaces the marks of the first.
    command.verify(job, os.path.join(JOBS, f"{name}.nc"), control="linuxcnc")
    groups = [obj for obj in document.Objects if obj.Name.startswith(findings.GROUP)]
    assert len(groups) == 1 and len(groups[0].Group) == len(marks), groups
    marks = [(mark.Line, mark.Text, getattr(mark, "Placement", None)) for mark in groups[0].Group]
    FreeCAD.closeDocument(document.Name)
    return report, marks


def controllers():
    """Write a job with two controllers of one bit, whose program is where a template of FreeCAD's own posts it."""
    with tempfile.TemporaryDirectory() as folder:
        document = FreeCAD.newDocument("controllers")
        job = PathJob.Create("Job", [bracket(document)])
        document.saveAs(os.path.join(folder, "bracket.FCStd"))
        copy = document.copyObject(job.Tools.Group[0], True)
        copy.ToolNumber = job.Tools.Group[0].ToolNumber
        job.Proxy.addToolController(copy)
        job.PostProcessorOutputFile = "%D/%d-posted.ngc"
        posted = os.path.join(folder, f"{document.Label}-posted.ngc")
        with open(posted, "w") as file:
            file.write("M2\n")
        keys = jobs.write(job, folder)
        assert os.path.samefile(keys["program"], posted), keys
        with open(os.path.join(folder, "bits.fctl")) as file:
            bits = json.load(file)["tools"]
        assert len(job.Tools.Group) == 2 and len(bits) == 1, bits
        copy.Tool.Diameter = copy.Tool.Diameter.Value + 1
        try:
            jobs.write(job, folder)
        except jobs.NotReady as error:
            assert "another number" in str(error)
        else:
            raise AssertionError("two tools of one number are refused")
        FreeCAD.closeDocument(document.Name)


def main():
    mill = os.path.join(JOBS, "mill.tool")
    for name, verdict, surface, body in (
        ("clean", "clean", None, None),
        ("shank", "findings", "shank", "the part"),
        ("clamp", "findings", "holder", "clamp"),
    ):
        report, marks = check(name, mill)
        assert report.verdict == verdict, (name, report.verdict, report.refusals, report.findings)
        found = {(finding.row["surface"], finding.row["body"]) for finding in report.findings}
        assert found == ({(surface, body)} if surface else set()), (name, found)
        assert len(marks) == len(report.findings)
        for (line, text, placement), finding in zip(marks, report.findings):
            assert line == finding.line and text == finding.text
            assert (placement.Base - Vector(*finding.point)).Length < 1e-9
        print(f"{name}: {report.verdict}, {[finding.text for finding in report.findings]}")
    # FreeCAD's end mill of 5 mm has a thin shank and no holder: it reaches all of the wall.
    report, _ = check("shank")
    assert report.verdict == "clean", (report.refusals, report.findings)
    print(f"with FreeCAD's own bit: {report.verdict}")
    controllers()
    try:
        check("clean", "/none/mill.tool")
    except jobs.NotReady as error:
        assert "correct its property" in str(error)
    else:
        raise AssertionError("a missing tool file is refused")


try:
    main()
    print("touchoff: the add-on's jobs have their verdicts")
    status = 0
except BaseException:
    traceback.print_exc()
    status = 1
# `freecadcmd` goes on to an interactive prompt otherwise.
sys.stdout.flush()
os._exit(status)
