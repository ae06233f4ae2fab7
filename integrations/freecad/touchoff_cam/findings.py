"""Findings in the tree and in 3-D: a group per check, an object per finding with a ball at its place."""

GROUP = "TouchoffFindings"

#: Radius of the ball at a finding, in mm.
MARK = 1.0


def show(document, report, program):
    """Replace the findings of an earlier check by those of a report, and return the group."""
    clear(document)
    group = document.addObject("App::DocumentObjectGroup", GROUP)
    count = len(report.findings)
    group.Label = f"Touchoff: {report.verdict}" if count == 0 else f"Touchoff: {count} finding{'' if count == 1 else 's'}"
    for finding in report.findings:
        point = finding.point
        kind = "Part::Sphere" if point is not None else "App::FeaturePython"
        mark = document.addObject(kind, "TouchoffFinding")
        mark.Label = f"line {finding.line}: {finding.text}"
        for name, value in (("Line", finding.line), ("Text", finding.text), ("Kind", finding.kind), ("Program", program)):
            mark.addProperty("App::PropertyInteger" if name == "Line" else "App::PropertyString", name, "Touchoff", "")
            setattr(mark, name, value)
        if point is not None:
            mark.Radius = MARK
            mark.Placement.Base = point
            if getattr(mark, "ViewObject", None) is not None:
                mark.ViewObject.ShapeColor = (1.0, 0.0, 0.0)
        group.addObject(mark)
    document.recompute()
    return group


def clear(document):
    """Remove the findings of an earlier check."""
    for group in [obj for obj in document.Objects if obj.Name.startswith(GROUP)]:
        for mark in group.Group:
            document.removeObject(mark.Name)
        document.removeObject(group.Name)
