"""Reads run.h5 of write_example_run with h5py and checks every number, H5MD and the storage.

usage: python3 read_with_h5py.py FOLDER      exit code 77: h5py is not installed
"""
import csv
import os
import sys

try:
    import h5py
    import numpy as np
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)

import h5md  # noqa: E402, beside this file

PARTICLES, FRAMES, SAMPLES = 6, 4, 300
folder = sys.argv[1]
run = h5py.File(os.path.join(folder, "run.h5"), "r")


def check(condition, what):
    if not condition:
        sys.exit("wrong: " + what)


def text(attribute):
    """Texts have a fixed length: h5py gives bytes."""
    return attribute.decode("utf-8") if isinstance(attribute, bytes) else attribute


def check_equal(found, expected, what):
    found, expected = np.asarray(found), np.asarray(expected)
    check(found.shape == expected.shape and np.array_equal(found, expected),
          f"{what}: {found.tolist()} instead of {expected.tolist()}")


def check_element(element, name, samples, unit):
    """An H5MD element: step, time and value of the same length."""
    check_equal(element["step"], np.arange(samples), name + "/step")
    check_equal(element["time"], np.arange(samples) / 3.0, name + "/time")
    check(element["value"].shape[0] == samples, name + " has another length")
    check(text(element["value"].attrs["unit"]) == unit, f"{name} has the unit {element['value'].attrs['unit']}")


# H5MD 1.1: the whole convention, and what of it is ours
problems = h5md.problems(run)
check(not problems, "\n".join(problems))
h5md.check_the_checker(os.path.join(folder, "run.h5"), os.path.join(folder, "broken.h5"))
check_equal(run["h5md"].attrs["version"], [1, 1], "H5MD version")
check(text(run["h5md/creator"].attrs["name"]) == "sigmaflow", "creator")
check("name" in run["h5md/author"].attrs and "version" in run["h5md/creator"].attrs, "h5md texts")
box = run["particles/trajectory/box"]
check(box.attrs["dimension"] == 3, "dimension")
check(list(box.attrs["boundary"]) == [b"periodic"] * 3, "boundary")

# particles
i = np.arange(PARTICLES, dtype=float)
trajectory = run["particles/trajectory"]
check_equal(trajectory["radius"], np.where(i % 2 == 0, 1, 1.4), "radius")
check_equal(trajectory["species"], i.astype(int) % 2, "species")
units = {"position": "a", "velocity": "a rate0", "nonaffine_velocity": "a rate0", "angular_velocity": "rate0",
         "nonaffine_speed": "-", "contact_number": "-", "stress": "sigma0 a^3"}
check(set(trajectory) == set(units) | {"box", "radius", "species"}, f"arrays {list(trajectory)}")
for name, unit in units.items():
    check_element(trajectory[name], name, FRAMES, unit)
check_element(box["edges"], "edges", FRAMES, "a")
for step in range(FRAMES):
    at = f" of frame {step}"
    nonaffine = np.stack([0.01 * i * step, -0.02 * i, 0.5 + 0 * i], axis=1)
    position = np.stack([3 * i + 0.1 * step, i + 0.5, 2.5 + 0 * i], axis=1)
    affine = np.stack([position[:, 1], 0 * i, 0 * i], axis=1)
    check_equal(trajectory["position/value"][step], position, "position" + at)
    check_equal(trajectory["nonaffine_velocity/value"][step], nonaffine, "nonaffine_velocity" + at)
    check_equal(trajectory["velocity/value"][step], nonaffine + affine, "velocity" + at)
    check_equal(trajectory["angular_velocity/value"][step][:, 2], -0.5 - i, "angular_velocity" + at)
    check_equal(trajectory["contact_number/value"][step], i.astype(int) % 3, "contact_number" + at)
    check_equal(trajectory["stress/value"][step][:, 2, 1], 21 + i, "stress zy" + at)
    check(np.allclose(trajectory["nonaffine_speed/value"][step], np.linalg.norm(nonaffine, axis=1),
                      rtol=1e-15), "nonaffine_speed" + at)
    edges = [[20, 0, 0], [2.5 * step, 10, 0], [0, 0, 5]]
    check_equal(box["edges/value"][step], edges, "edges" + at)
    check_equal(box["offset/value"][step], 2.5 * step, "offset" + at)
    check_equal(run["state/strain/value"][step], 0.25 * step, "strain" + at)

    rows = run["contacts"]
    first, count = rows["first"][step], rows["count"][step]
    k = np.arange(step)
    check(first == step * (step - 1) // 2 and count == step, "rows of the contacts" + at)
    part = slice(first, first + count)
    check_equal(rows["i"][part], k, "i" + at)
    check_equal(rows["normal_force"][part], 1.5 * k + step, "normal_force" + at)
    check_equal(rows["tangential_force"][part], np.tile([3.0, 0, 4], (step, 1)), "tangential_force" + at)
    check_equal(rows["start"][part], position[:step], "start" + at)
    springs = run["state/contacts"]
    part = slice(springs["first"][step], springs["first"][step] + springs["count"][step])
    check_equal(springs["spring"][part], np.array([[n, step, 0.1] for n in k]).reshape(step, 3), "spring" + at)
    check_equal(springs["sliding"][part], k % 2, "sliding" + at)
check(text(rows["normal_force"].attrs["unit"]) == "F*", "unit of normal_force")

# the time series: the same numbers as in the text file
with open(os.path.join(folder, "series.csv")) as lines:
    described = dict(entry.rstrip("]").split(" [") for entry in lines.readline()[2:].strip().split(","))
    table = list(csv.DictReader(lines))
check(len(table) == SAMPLES, "rows of series.csv")
check(set(table[0]) == set(run["observables"]) - {"trajectory"}, "names of the series")
for name in table[0]:
    check_element(run["observables"][name], name, SAMPLES, described[name])
    check_equal(run["observables"][name]["value"], [float(row[name]) for row in table], name)
    check_equal(run["observables/trajectory"][name]["value"], run["observables"][name]["value"][:FRAMES],
                name + " of the frames")

# parameters, texts, storage
parameters, unit = run["parameters"].attrs, run["parameters/unit"].attrs
check(parameters["stress"] == 2 and "rate" not in parameters, "control")
check(text(parameters["contact_hydrodynamics"]) == "lubrication", "contact_hydrodynamics")
check(parameters["debye_length"] == 0.02 and text(unit["debye_length"]) == "a", "debye_length")
check(parameters["einstein"] == 1, "einstein")
check({name: text(value) for name, value in run["provenance"].attrs.items()} == {"version": "example", "seed": "42"}, "provenance")


def check_storage(name, entry):
    if isinstance(entry, h5py.Dataset):
        check(entry.fletcher32 and entry.compression is None and entry.chunks is not None,
              name + " must be chunked, with checksums, not compressed")
        check(entry.dtype.kind in "iu" or entry.dtype == np.dtype("<f8"), name + " must be double")


run.visititems(check_storage)
print("run.h5 is as it should be, h5py", h5py.__version__)
