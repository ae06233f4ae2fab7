"""What a job of FreeCAD says about tools, model, stock and fixtures, as a job of Touchoff.

A job has one model or several, which are verified as one part; a stock; tool controllers with tool bits; and a posted program. Fixtures
are the objects of the group `Fixtures`. All are in millimetres, in the frame of the document, which is that of G54.
"""

import json
import os

#: Deviation of triangles from curved faces, in mm.
DEFLECTION = 0.005

#: The group whose objects are fixtures.
FIXTURES = "Fixtures"

#: A property of a tool controller: the `.tool` file of its tool, with holder and spindle nose. FreeCAD's bits have no holder.
TOOL_FILE = "TouchoffTool"


class NotReady(ValueError):
    """What a job lacks before it can be verified; the message has the remedy."""


def is_job(obj):
    """Return whether an object is a CAM job; of FreeCAD 0.20 and of 1.0."""
    return type(getattr(obj, "Proxy", None)).__name__ == "ObjectJob"


def find(document):
    """Return the jobs of a document."""
    return [obj for obj in document.Objects if is_job(obj)]


def write(job, folder, program=None):
    """Write the files of a job to a folder, and return the keys of a `touchoff.Job` there.

    Parameters
    ----------
    job
        The job's object.
    folder
        An existing folder.
    program
        The posted program; the job's output file if none is given.
    """
    program = program or job.PostProcessorOutputFile
    if not program or not os.path.isfile(program):
        raise NotReady(f"the job `{job.Label}` has no posted program at `{program}`: post-process it first")
    _stl([model.Shape for model in job.Model.Group], os.path.join(folder, "part.stl"))
    keys = {"part": "part.stl", "unit": "mm", "program": os.path.abspath(program), "tolerance": 0.01, "tool": {}}
    bits = []
    for controller in _controllers(job):
        number = controller.ToolNumber
        stated = _stated(controller)
        if stated:
            keys["tool"][str(number)] = {"tool": stated}
        else:
            bits.append({"nr": number, "path": f"T{number}.fctb"})
            _json(_bit(controller.Tool), os.path.join(folder, f"T{number}.fctb"))
    if bits:
        # The import of FreeCAD's own files knows the shapes of bits.
        _json({"version": 1, "tools": bits}, os.path.join(folder, "bits.fctl"))
        keys["tools"] = "bits.fctl"
    if not bits and not keys["tool"]:
        raise NotReady(f"the job `{job.Label}` has no tool controllers: add the tools of its program")
    keys["fixture"] = []
    for index, obj in enumerate(_fixtures(job.Document)):
        name = f"fixture{index}.stl"
        _stl([obj.Shape], os.path.join(folder, name))
        keys["fixture"].append({"name": obj.Label, "mesh": name})
    if not keys["fixture"]:
        del keys["fixture"]
    return keys


def _controllers(job):
    group = job.Tools.Group if hasattr(job, "Tools") else job.ToolController
    return sorted(group, key=lambda controller: controller.ToolNumber)


def _fixtures(document):
    groups = [obj for obj in document.Objects if obj.Label == FIXTURES and hasattr(obj, "Group")]
    return [obj for group in groups for obj in group.Group if hasattr(obj, "Shape")]


def _stated(controller):
    """Return the `.tool` file that a controller states; None if it states none."""
    stated = getattr(controller, TOOL_FILE, "")
    if stated and not os.path.isfile(stated):
        raise NotReady(
            f"`{controller.Label}` states the tool file `{stated}`, which does not exist: correct its property {TOOL_FILE}"
        )
    return os.path.abspath(stated) if stated else None


def _bit(bit):
    """Return a tool bit as FreeCAD saves it."""
    shape = os.path.basename(getattr(bit, "BitShape", "") or getattr(bit, "ShapeID", "") or "endmill.fcstd")
    parameters = {}
    for name in bit.PropertiesList:
        quantity = getattr(bit, name)
        if bit.getGroupOfProperty(name) in ("Shape", "Bit") and hasattr(quantity, "UserString"):
            # Values are in millimetres and degrees, whatever the user is shown.
            parameters[name] = f"{quantity.Value} {'deg' if quantity.Unit.Type == 'Angle' else 'mm'}"
    return {"version": 2, "name": bit.Label, "shape": shape, "parameter": parameters, "attribute": {}}


def _json(content, path):
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file)


def _stl(shapes, path):
    with open(path, "w", encoding="ascii") as file:
        file.write("solid part\n")
        for shape in shapes:
            points, triangles = shape.tessellate(DEFLECTION)
            for triangle in triangles:
                file.write("facet normal 0 0 0\nouter loop\n")
                for index in triangle:
                    point = points[index]
                    file.write(f"vertex {point.x!r} {point.y!r} {point.z!r}\n")
                file.write("endloop\nendfacet\n")
        file.write("endsolid part\n")
