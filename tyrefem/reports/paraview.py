"""A ParaView script that shows a run at once: temperatures with their colours, regions, isotherms, time.

A script in place of a state file: short enough to read and change, and the same for every version of ParaView.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.reports.temperature_colours import COLOURS

if TYPE_CHECKING:
    from tyrefem.simulation.result import ResultData

_TEMPLATE = '''"""ParaView shows {title} at once.

    paraview --script={name}.py       in the window; press play
    pvbatch {name}.py picture.png     a picture of the last time
"""

import os
import sys

from paraview.simple import *

STEM = {stem}
TITLE = {title_text}
# degC, over all times
LOW = {low!r}
HIGH = {high!r}
REGIONS = {regions}
COLOURS = {colours}

here = os.path.dirname(os.path.abspath(__file__)) if "__file__" in globals() else os.getcwd()
run = PVDReader(registrationName=STEM, FileName=os.path.join(here, STEM + ".pvd"))
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.GoToLast()
view = GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = [1.0, 1.0, 1.0]
view.OrientationAxesVisibility = 0
view.ViewSize = [1200, 800]

# A half section is shown with its mirror image; a ring is cut open.
tyre = run
{steps}
shown = Show(tyre, view)
ColorBy(shown, ("POINTS", "temperature_degC"))
colours = GetColorTransferFunction("temperature_degC")
colours.RGBPoints = [x for place, *rgb in COLOURS for x in (LOW + place * (HIGH - LOW), *rgb)]
colours.ColorSpace = "RGB"
shown.SetScalarBarVisibility(view, True)
bar = GetScalarBar(colours, view)
bar.Title, bar.ComponentTitle = "temperature [degC]", ""
bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]
bar.AutomaticLabelFormat, bar.LabelFormat, bar.RangeLabelFormat = 0, "%.0f", "%.0f"

# The numbers of "region" by name, for whoever colours by it.
names = GetColorTransferFunction("region")
names.InterpretValuesAsCategories = 1
names.Annotations = [text for number, name in enumerate(REGIONS, 1) for text in (str(number), name)]
names.IndexedColors = [x for number in range(len(REGIONS)) for x in COLOURS[(number * 7) % len(COLOURS)][1:]]

title = Text(registrationName="title")
title.Text = TITLE
label = Show(title, view)
label.WindowLocation, label.Color, label.FontSize = "Upper Center", [0.0, 0.0, 0.0], 18
clock = AnnotateTimeFilter(registrationName="time", Input=run)
clock.Format = {clock}
label = Show(clock, view)
label.WindowLocation, label.Color, label.FontSize = "Lower Center", [0.0, 0.0, 0.0], 18

{camera}
Render(view)
if len(sys.argv) > 1 and sys.argv[-1].endswith(".png"):
    SaveScreenshot(sys.argv[-1], view, ImageResolution=[1200, 800])
'''
_MIRROR = '''tyre = Reflect(registrationName="both sides", Input=tyre)
try:
    tyre.Plane = "X Min"
except Exception:  # ParaView 5.13 and newer
    tyre.ReflectionPlane = "X Min"'''
_OPENED = """tyre = Clip(registrationName="cut open", Input=tyre)
tyre.ClipType = "Plane"
tyre.ClipType.Origin, tyre.ClipType.Normal = [0.0, 0.0, 0.0], [0.0, 0.7071, 0.7071]
tyre.Invert = 1"""
_OUTLINES = """edges = FeatureEdges(registrationName="outline", Input=Clean(Input=ExtractSurface(Input=tyre)))
drawn = Show(edges, view)
drawn.ColorArrayName = [None, ""]
drawn.AmbientColor = drawn.DiffuseColor = [0.2, 0.2, 0.2]
levels = [LOW + (HIGH - LOW) * k / 8 for k in range(1, 8)]
isotherms = Contour(registrationName="isotherms", Input=tyre, Isosurfaces=levels)
isotherms.ContourBy = ["POINTS", "temperature_degC"]
drawn = Show(isotherms, view)
drawn.ColorArrayName = [None, ""]
drawn.AmbientColor = drawn.DiffuseColor = [1.0, 1.0, 1.0]"""

_FROM_ABOVE = """view.CameraPosition, view.CameraFocalPoint = [1.0, 0.7, 1.3], [0.0, 0.0, 0.0]
view.CameraViewUp = [0.0, 1.0, 0.0]
ResetCamera(view)"""


def _literal(value: str | list[str]) -> str:
    """Text or texts in Python. JSON's escapes of signs beyond U+FFFF are others there, so they stay as they are."""
    return json.dumps(value, ensure_ascii=False)


def script(result: ResultData, stem: str, saved: Sequence[int], *, solid: bool) -> str:
    """The script that shows ``<stem>.pvd``, which lies beside it.

    ``saved``: numbers of the readings in it; ``solid``: a ring, not the section.
    """
    values = np.asarray(result.history.values)[list(saved)]
    low, high = float(values.min()), float(values.max())
    steps = [_MIRROR] if result.study.section.half else []
    if solid:
        steps.append(_OPENED)
        camera = _FROM_ABOVE
    else:
        steps.append(_OUTLINES)
        camera = 'view.InteractionMode = "2D"\nResetCamera(view)'
    return _TEMPLATE.format(
        name=stem,
        title=" ".join(result.study.title.split()).replace("\\", "/").replace('"', "'"),
        title_text=_literal(result.study.title),
        stem=_literal(stem),
        low=round(low, 2),
        high=round(max(high, low + 0.01), 2),
        regions=_literal(list(result.study.section.regions)),
        colours=json.dumps(COLOURS),
        steps="\n".join(steps),
        clock='"{time:.0f} s"',
        camera=camera,
    )
