#include "io/paraview_view.h"

namespace sigmaflow::io {

std::string_view view_script()
{
    return R"python(# The particles of this folder in ParaView: spheres at their true radii, coloured by
# nonaffine_speed, in their box. One of
#   paraview --script=view.py     the particles.pvd beside this file
#   File > Load State... view.py  after opening particles.pvd (ParaView does not tell a script where
#                                 it lies)
#   Macros > Import new macro...  once; then a click shows the particles.pvd that is open
#   pvpython view.py picture.png  a picture of the last frame, without a window
import math
import os
import sys

from paraview.simple import *

ARRAY = "nonaffine_speed"


def open_series():
    """The particles that are open already, the selected ones first."""
    found = [GetActiveSource()] + list(GetSources().values())
    for source in found:
        name = getattr(source, "FileName", "") if source else ""
        if os.path.basename(str(name)) == "particles.pvd":
            return source
    return None


def folders():
    """Where this script may lie."""
    yield os.path.dirname(os.path.abspath(globals().get("__file__") or "view.py"))
    words = list(sys.argv)
    try:  # the ParaView window does not tell, its command line does
        with open("/proc/self/cmdline") as line:
            words += line.read().split("\0")
    except OSError:
        pass
    for word in words:
        path = word.split("=", 1)[-1]
        if path.endswith("view.py"):
            yield os.path.dirname(os.path.abspath(path))
    yield os.getcwd()


def series():
    source = open_series()
    if source:
        return source
    for folder in folders():
        path = os.path.join(folder, "particles.pvd")
        if os.path.exists(path):
            return PVDReader(registrationName="particles", FileName=path)
    raise RuntimeError("open particles.pvd first (File > Open), then run view.py again")


def round_up(value):
    """To at most seven steps of 1, 2 or 5 times a power of ten."""
    step = next(digit * 10.0 ** power for power in range(-12, 13) for digit in (1, 2, 5)
                if value <= 7 * digit * 10.0 ** power)
    return step * math.ceil(value / step - 1e-6)


def largest_colour(source):
    """Nearly all values lie below it."""
    values = servermanager.Fetch(source).GetPointData().GetArray(ARRAY)
    numbers = sorted(values.GetValue(k) for k in range(values.GetNumberOfTuples()))
    high = numbers[round(0.99 * (len(numbers) - 1))] if numbers else 1
    return round_up(high) if high > 0 else 1


def set_colours(colours, largest):
    """Inferno without its darkest colours, which hide the shading."""
    darkest = 0.13
    colours.ApplyPreset("Inferno (matplotlib)", True)
    colours.RescaleTransferFunction(0, 1)
    old = list(colours.RGBPoints)
    kept = [old[k:k + 4] for k in range(0, len(old), 4) if old[k] >= darkest]
    kept[0][0] = darkest
    colours.RGBPoints = [number for share, *rgb in kept
                         for number in [(share - darkest) / (1 - darkest) * largest] + rgb]


def show_spheres(source, view):
    shown = Show(source, view)
    shown.SetRepresentationType("3D Glyphs")
    shown.GlyphType = "Sphere"
    shown.GlyphType.Radius = 1
    fine = source.GetDataInformation().GetNumberOfPoints() < 1500
    shown.GlyphType.ThetaResolution = shown.GlyphType.PhiResolution = 32 if fine else 16
    shown.Scaling = 1
    shown.ScaleMode = "Magnitude"
    shown.SelectScaleArray = "radius"
    shown.ScaleFactor = 1
    shown.Orient = 0
    ColorBy(shown, ("POINTS", ARRAY))
    colours = GetColorTransferFunction(ARRAY)
    set_colours(colours, largest_colour(source))
    bar = GetScalarBar(colours, view)
    bar.Title = "non-affine speed / (rate a)"
    bar.ComponentTitle = ""
    bar.TitleColor = bar.LabelColor = [0, 0, 0]
    bar.TitleFontSize = bar.LabelFontSize = 16
    bar.LabelFormat = bar.RangeLabelFormat = "%-#6.3g"
    shown.SetScalarBarVisibility(view, True)


def show_box(source, view):
    array = servermanager.Fetch(source).GetFieldData().GetArray("box_length")
    x, y, z = (array.GetValue(k) for k in range(3))
    box = FindSource("box") or Box(registrationName="box")
    box.XLength, box.YLength, box.ZLength = x, y, z
    box.Center = [x / 2, y / 2, z / 2]
    shown = Show(box, view)
    shown.SetRepresentationType("Outline")
    shown.AmbientColor = shown.DiffuseColor = [0.13, 0.13, 0.16]


def main():
    source = series()
    view = GetActiveViewOrCreate("RenderView")
    picture = sys.argv[-1] if sys.argv[-1].endswith(".png") else ""
    if picture:
        view.ViewSize = [1280, 720]
    scene = GetAnimationScene()
    source.UpdatePipelineInformation()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = source.TimestepValues  # one time is no list
    last = times if isinstance(times, float) else times[-1]
    scene.AnimationTime = last
    source.UpdatePipeline(last)
    show_spheres(source, view)
    show_box(source, view)
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesLabelColor = [0, 0, 0]
#from the front, a little from the right and from above : flow to the right, gradient up
    view.CameraFocalPoint = [0, 0, 0]
    view.CameraPosition = [0.374, 0.258, 0.891]
    view.CameraViewUp = [0, 1, 0]
    ResetCamera(view)
    view.GetActiveCamera().Dolly(1.25)  # nearer
    SetActiveSource(source)
    Render(view)
    if picture:
        SaveScreenshot(picture, view)


main()
)python";
}

}
