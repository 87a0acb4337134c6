"""Opens a run by its own view.py, checks times, arrays and ranges, and draws what we have drawn.

usage: pvpython view_in_paraview.py FOLDER      (with expected.json of paraview_picture)
"""
import json
import math
import os
import runpy
import sys

folder = sys.argv[1]
script = os.path.join(folder, "view.py")
sys.argv = [script]
runpy.run_path(script)

from paraview.simple import *  # noqa: E402

with open(os.path.join(folder, "expected.json")) as lines:
    expected = json.load(lines)
wrong = []


def check(condition, what):
    if not condition:
        wrong.append(what)


def close(a, b):
    return len(a) == len(b) and all(math.isclose(x, y, rel_tol=1e-12, abs_tol=1e-12) for x, y in zip(a, b))


source, view = GetActiveSource(), GetActiveView()
times = [frame["time"] for frame in expected["frames"]]
check(close(list(source.TimestepValues), times), f"times {list(source.TimestepValues)} instead of {times}")
for frame in expected["frames"]:
    source.UpdatePipeline(frame["time"])
    check(source.GetDataInformation().GetNumberOfPoints() == expected["particles"], "number of particles")
    for name, values in frame["ranges"].items():
        found = source.PointData[name].GetRange(0)
        check(close(found, values), f"{name} at {frame['time']}: {found} instead of {values}")
source.UpdatePipeline(times[-1])

shown = GetDisplayProperties(source, view)
check(shown.Representation == "3D Glyphs", f"representation {shown.Representation}")
check(list(shown.ColorArrayName) == ["POINTS", "nonaffine_speed"], f"coloured by {list(shown.ColorArrayName)}")
now = GetAnimationScene().AnimationTime
check(close([now], [times[-1]]), f"shows the time {now} instead of {times[-1]}")
points = GetColorTransferFunction("nonaffine_speed").RGBPoints
check(close([points[0], points[-4]], [0, expected["colour_maximum"]]), f"colours from {points[0]} to {points[-4]}")

# again, as a macro on what is open: nothing is opened twice
runpy.run_path(script)
check(len(GetSources()) == 2, f"after two calls there are {list(GetSources())}")

camera = expected["camera"]
view.ViewSize = camera["size"]
view.CameraPosition, view.CameraFocalPoint = camera["position"], camera["focus"]
view.CameraViewUp, view.CameraViewAngle = camera["up"], camera["view_angle"]
view.OrientationAxesVisibility = 0
shown.SetScalarBarVisibility(view, False)
SaveScreenshot(os.path.join(folder, "theirs.png"), view, ImageResolution=camera["size"])
if wrong:
    sys.exit("wrong:\n" + "\n".join(wrong))
print("ParaView", GetParaViewVersion(), "shows the series as it should be")
