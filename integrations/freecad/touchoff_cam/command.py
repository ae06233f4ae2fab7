"""The command: verify the selected job, or the only one."""

import tempfile

from . import findings
from . import job as jobs


def verify(job, program=None, **more):
    """Verify a job, show its findings in the document, and return the report.

    `more` are further keys of a `touchoff.Job`, such as `control` and `machine`.
    """
    import touchoff

    with tempfile.TemporaryDirectory() as folder:
        # FreeCAD knows the post-processor, and not the control: without one, every control's way is checked.
        keys = {"control": "generic", **jobs.write(job, folder, program), **more}
        report = touchoff.Job(folder=folder, **keys).check()
    findings.show(job.Document, report, keys["program"])
    return report


class Verify:
    """The command of the workbench. It warns, and refuses nothing."""

    def GetResources(self):
        return {"MenuText": "Verify job", "ToolTip": "Prove every motion of the posted program, or show what is wrong"}

    def IsActive(self):
        import FreeCAD

        return FreeCAD.ActiveDocument is not None and bool(jobs.find(FreeCAD.ActiveDocument))

    def Activated(self):
        import FreeCAD
        import FreeCADGui

        selected = [obj for obj in FreeCADGui.Selection.getSelection() if jobs.is_job(obj)]
        for job in selected or jobs.find(FreeCAD.ActiveDocument):
            try:
                report = verify(job)
            except ValueError as error:
                FreeCAD.Console.PrintWarning(f"Touchoff: {error}\n")
                continue
            for line in report.refusals:
                FreeCAD.Console.PrintWarning(f"Touchoff: not verified: {line}\n")
            for finding in report.findings:
                FreeCAD.Console.PrintWarning(f"Touchoff: line {finding.line}: {finding.text}\n")
            for line in report.summaries:
                FreeCAD.Console.PrintMessage(f"Touchoff: {line}\n")


def register():
    """Add the command to FreeCAD."""
    import FreeCADGui

    FreeCADGui.addCommand("Touchoff_Verify", Verify())
