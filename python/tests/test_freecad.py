"""The add-on of FreeCAD, as far as it needs no FreeCAD: `integrations/freecad/test` has the rest."""

import json
import math
from pathlib import Path
from types import SimpleNamespace

import pytest

import touchoff

ADDON = Path(__file__).parents[2] / "integrations" / "freecad"


class Bit(SimpleNamespace):
    """A tool bit with the properties of FreeCAD that the add-on reads."""

    @property
    def PropertiesList(self):
        return list(vars(self))

    def getGroupOfProperty(self, name):
        return "Base" if name in ("Label", "BitShape") else "Shape"


def quantity(value, kind):
    return SimpleNamespace(Value=value, UserString="shown to the user", Unit=SimpleNamespace(Type=kind))


@pytest.mark.skipif(not ADDON.exists(), reason="the sources of the add-on are elsewhere")
def test_lengths_and_angles_of_a_bit_are_read_again(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(ADDON))
    from touchoff_cam import job

    drill = Bit(
        Label="Drill",
        BitShape="/usr/share/drill.fcstd",
        Diameter=quantity(8.0, "Length"),
        Length=quantity(80.0, "Length"),
        TipAngle=quantity(140.0, "Angle"),
        CuttingEdgeHeight=quantity(40.0, "Length"),
        Flutes=2,
    )
    file = tmp_path / "drill.fctb"
    file.write_text(json.dumps(job._bit(drill)))
    library = touchoff.import_tools(file)
    assert library.left_out == []
    [imported] = library.tools
    # A point of 140° that is 1 deep: the distance from the axis to its cone.
    block = touchoff.Part.cuboid((-20, -20, -10), (20, 20, 0), unit="mm")
    depth = touchoff.certified_depth(imported.tool, block, [[0, 0, -1, 0, 0, 1]])
    assert depth.high[0] == pytest.approx(math.sin(math.radians(70)), abs=1e-4)
