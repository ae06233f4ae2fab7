"""Verifies the posted program of a CAM job of FreeCAD with the Python package `touchoff`."""
