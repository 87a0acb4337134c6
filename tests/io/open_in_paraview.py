"""Opens the series of write_example_run in ParaView and checks times, arrays and ranges.

usage: pvpython open_in_paraview.py FOLDER
"""
import math
import os
import sys

from paraview.simple import GetParaViewVersion, OpenDataFile, XMLPolyDataReader

PARTICLES, FRAMES = 6, 4
folder = sys.argv[1]
wrong = []


def check(condition, what):
    if not condition:
        wrong.append(what)


def close(found, expected, what):
    check(len(found) == len(expected) and all(math.isclose(a, b, rel_tol=1e-12, abs_tol=1e-12)
                                              for a, b in zip(found, expected)),
          f"{what}: {found} instead of {expected}")


def opened(name):
    reader = OpenDataFile(os.path.join(folder, name))
    reader.UpdatePipeline()
    check(list(reader.TimestepValues) == [0.25 * step for step in range(FRAMES)],
          f"{name} has the times {list(reader.TimestepValues)}")
    return reader


def names(data):
    return {array.GetName() for array in data}


particles = opened("particles.pvd")
for step in range(FRAMES):
    particles.UpdatePipeline(0.25 * step)
    at = f" at step {step}"
    information = particles.GetDataInformation()
    check(information.GetNumberOfPoints() == PARTICLES, "number of particles" + at)
    check(information.GetNumberOfCells() == PARTICLES, "number of vertices" + at)
    arrays = particles.PointData
    check(names(arrays) == {"nonaffine_speed", "radius", "velocity", "nonaffine_velocity", "angular_velocity",
                            "contact_number", "species", "stress", "id"}, f"arrays {names(arrays)}" + at)
    close(arrays["radius"].GetRange(), (1, 1.4), "radius" + at)
    close(arrays["velocity"].GetRange(0), (0.5, 5.5 + 0.05 * step), "velocity x" + at)
    close(arrays["nonaffine_velocity"].GetRange(1), (-0.1, 0), "nonaffine_velocity y" + at)
    close(arrays["angular_velocity"].GetRange(2), (-5.5, -0.5), "angular_velocity z" + at)
    close(arrays["nonaffine_speed"].GetRange(), (0.5, math.hypot(0.05 * step, 0.1, 0.5)), "speed" + at)
    close(arrays["contact_number"].GetRange(), (0, 2), "contact_number" + at)
    close(arrays["species"].GetRange(), (0, 1), "species" + at)
    check(arrays["stress"].GetNumberOfComponents() == 9, "stress has 9 components" + at)
    close(arrays["stress"].GetRange(7), (21, 26), "stress zy" + at)
    close(information.GetBounds(), (0.1 * step, 15 + 0.1 * step, 0.5, 5.5, 2.5, 2.5), "bounds" + at)
    fields = particles.FieldData
    close(fields["strain"].GetRange(), (0.25 * step, 0.25 * step), "strain" + at)
    close(fields["box_offset"].GetRange(), (2.5 * step, 2.5 * step), "box_offset" + at)
    close(fields["volume_fraction"].GetRange(), (0.3, 0.3), "volume_fraction" + at)

contacts = opened("contacts.pvd")
for step in range(FRAMES):
    contacts.UpdatePipeline(0.25 * step)
    at = f" at step {step}"
    check(contacts.GetDataInformation().GetNumberOfCells() == step, "number of contacts" + at)
    if step > 0:  # ParaView lists no arrays of a part without cells
        check(names(contacts.CellData) == {"normal_force", "tangential_force", "xi", "sliding", "frictional", "i", "j"},
              f"contact arrays {names(contacts.CellData)}" + at)
        close(contacts.CellData["normal_force"].GetRange(), (step, 1.5 * (step - 1) + step), "normal_force" + at)
        close(contacts.CellData["tangential_force"].GetRange(), (5, 5), "tangential_force" + at)

box = XMLPolyDataReader(FileName=[os.path.join(folder, "box.vtp")])
box.UpdatePipeline()
close(box.GetDataInformation().GetBounds(), (0, 20, 0, 10, 0, 5), "box")

# What ParaView colours by on its own: the active scalars.
from paraview import servermanager  # noqa: E402

active = servermanager.Fetch(particles).GetPointData().GetScalars()
check(active is not None and active.GetName() == "nonaffine_speed", "active scalars")

if wrong:
    sys.exit("wrong:\n" + "\n".join(wrong))
print("ParaView", str(GetParaViewVersion()), "opens the series as it should be")
