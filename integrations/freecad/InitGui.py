"""The workbench: one command, which verifies the selected job."""

import FreeCADGui


class TouchoffWorkbench(FreeCADGui.Workbench):
    """A workbench with the command that verifies a job."""

    MenuText = "Touchoff"
    ToolTip = "Verify the posted program of a CAM job"

    def Initialize(self):
        from touchoff_cam import command

        command.register()
        names = ["Touchoff_Verify"]
        self.appendToolbar("Touchoff", names)
        self.appendMenu("Touchoff", names)

    def GetClassName(self):
        return "Gui::PythonWorkbench"


FreeCADGui.addWorkbench(TouchoffWorkbench())
