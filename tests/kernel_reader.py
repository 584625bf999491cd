"""STEP files as OpenCASCADE reads them, the extra ``kernel``; a test that calls it is skipped without that extra."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest


def kernel_shape(path: Path) -> Any:
    """Everything in a STEP file as one shape."""
    pytest.importorskip("OCP")
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    return reader.OneShape()


def is_valid(shape: Any) -> bool:
    """Whether every face, edge and shell is valid."""
    from OCP.BRepCheck import BRepCheck_Analyzer

    return bool(BRepCheck_Analyzer(shape, True).IsValid())


def volumes(shape: Any, accuracy: float) -> list[float]:
    """Volume of each solid [mm³], by quadrature to a relative accuracy."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.TopAbs import TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    result = []
    solids = TopExp_Explorer(shape, TopAbs_SOLID)
    while solids.More():
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(solids.Current(), properties, accuracy)
        result.append(float(properties.Mass()))
        solids.Next()
    return result


def face_points(shape: Any, count: int) -> list[np.ndarray]:
    """Random points (n, 3) [mm] of each face, between the limits of its parameters."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepTools import BRepTools
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    generator, result = np.random.default_rng(11), []
    faces = TopExp_Explorer(shape, TopAbs_FACE)
    while faces.More():
        face = TopoDS.Face_s(faces.Current())
        low_u, high_u, low_v, high_v = BRepTools.UVBounds_s(face)
        surface = BRep_Tool.Surface_s(face)
        u, v = generator.uniform((low_u, low_v), (high_u, high_v), (count, 2)).T
        points = [surface.Value(*at) for at in zip(u.tolist(), v.tolist(), strict=True)]
        result.append(np.array([(p.X(), p.Y(), p.Z()) for p in points]))
        faces.Next()
    return result


def cut_by_sheets(shape: Any) -> Any:
    """The parts into which the sheets of a shape cut its solid."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Splitter
    from OCP.TopAbs import TopAbs_SHELL, TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopTools import TopTools_ListOfShape

    solids, sheets = TopTools_ListOfShape(), TopTools_ListOfShape()
    solids.Append(TopExp_Explorer(shape, TopAbs_SOLID).Current())
    shells = TopExp_Explorer(shape, TopAbs_SHELL, TopAbs_SOLID)
    while shells.More():
        sheets.Append(shells.Current())
        shells.Next()
    splitter = BRepAlgoAPI_Splitter()
    splitter.SetArguments(solids)
    splitter.SetTools(sheets)
    splitter.SetFuzzyValue(1e-4)
    splitter.Build()
    return splitter.Shape()
