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
        The posted program; if none is given, the file to which FreeCAD posts the job.
    """
    program = program or output_file(job)
    if not os.path.isfile(program):
        raise NotReady(f"the job `{job.Label}` has no posted program at `{program}`: post-process it first")
    _stl([model.Shape for model in job.Model.Group], os.path.join(folder, "part.stl"))
    keys = {"part": "part.stl", "unit": "mm", "program": os.path.abspath(program), "tolerance": 0.01, "tool": {}}
    bits = []
    known = {}
    for controller in _controllers(job):
        number = controller.ToolNumber
        stated = _stated(controller)
        tool = stated or _bit(controller.Tool)
        # Controllers of one tool have feeds and speeds of their own, and bits that are copies under other names.
        shape = stated or {**tool, "name": ""}
        if number in known:
            if known[number] != shape:
                raise NotReady(f"the job `{job.Label}` has two tools T{number}: give `{controller.Label}` another number")
            continue
        known[number] = shape
        if stated:
            keys["tool"][str(number)] = {"tool": stated}
        else:
            bits.append({"nr": number, "path": f"T{number}.fctb"})
            _json(tool, os.path.join(folder, f"T{number}.fctb"))
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


def output_file(job):
    """Return the file to which FreeCAD posts a job: what the job or the preferences state, with their substitutes, and the document's
    folder and name for what they do not state (FilenameGenerator of `Path/Post/Utils.py`)."""
    folder, name = os.path.split(job.PostProcessorOutputFile or _preferred_file())
    name, ending = os.path.splitext(name)
    own = os.path.dirname(job.Document.FileName)
    folder = (folder or own).replace("%D", own or ".").replace("%M", _macros())
    path = os.path.join(folder, (name or job.Document.Label) + (ending or ".nc"))
    # A job that is posted to one file has no number of a part, and %S is 0.
    for key, value in (("%d", job.Document.Label), ("%j", job.Label), ("%S", "0")):
        path = path.replace(key, value)
    return os.path.abspath(path)


def _preferred_file():
    """Return the output file of FreeCAD's preferences."""
    try:
        from Path import Preferences
    except ImportError:
        try:
            # FreeCAD before 0.21.
            from PathScripts import PathPreferences as Preferences
        except ImportError:
            return ""
    return Preferences.defaultOutputFile() or ""


def _macros():
    """Return the folder of the user's macros."""
    try:
        import FreeCAD
    except ImportError:
        return ""
    return os.path.dirname(FreeCAD.getUserMacroDir())


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
    # The hand of its edges, of FreeCAD from 1.1 on.
    attributes = {"SpindleDirection": bit.SpindleDirection} if hasattr(bit, "SpindleDirection") else {}
    return {"version": 2, "name": bit.Label, "shape": shape, "parameter": parameters, "attribute": attributes}


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
