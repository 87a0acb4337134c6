"""Checks files against H5MD 1.1.0 (https://www.nongnu.org/h5md/releases/h5md-1.1.0.html), by its text alone.

usage: python3 h5md.py PROGRAM FOLDER      runs a small workflow, then checks its run.h5
exit code 77: h5py is not installed
"""
import json
import os
import shutil
import subprocess
import sys

try:
    import h5py
    import numpy as np
except ImportError as error:
    print("skipped:", error)
    sys.exit(77)


class Checker:
    def __init__(self, root):
        self.root, self.found, self.clocks = root, [], {}

    def need(self, condition, what):
        if not condition:
            self.found.append(what)
        return condition

    def fixed_text(self, group, name, shape=()):
        """A text attribute of fixed length."""
        if not self.need(name in group.attrs, f"{group.name} has no attribute {name}"):
            return None
        attribute = group.attrs.get_id(name)
        kind = attribute.get_type()
        self.need(isinstance(kind, h5py.h5t.TypeStringID) and not kind.is_variable_str(),
                  f"{group.name}: {name} is no text of fixed length")
        self.need(attribute.shape == shape, f"{group.name}: {name} has the shape {attribute.shape}, not {shape}")
        return group.attrs[name]

    def subgroup(self, group, name):
        there = name in group and isinstance(group[name], h5py.Group)
        return group[name] if self.need(there, f"{group.name} has no group {name}") else None

    def metadata(self):
        h5md = self.subgroup(self.root, "h5md")
        if h5md is None:
            return
        version = h5md.attrs.get("version")
        self.need(version is not None and version.shape == (2,) and version.dtype.kind in "iu"
                  and list(version) == [1, 1], f"version {version}")
        for name, texts in (("author", ["name"]), ("creator", ["name", "version"])):
            group = self.subgroup(h5md, name)
            for text in texts if group is not None else []:
                self.fixed_text(group, text)

    def element(self, item, shape=None):
        """A dataset (fixed in time) or a group of step, (time) and value. Returns the shape of one sample."""
        if isinstance(item, h5py.Dataset):
            self.need(shape is None or item.shape == shape, f"{item.name} has the shape {item.shape}, not {shape}")
            return item.shape
        if not self.need("step" in item and "value" in item, f"{item.name} lacks step or value"):
            return None
        step, value = item["step"], item["value"]
        rows = value.shape[0] if value.shape else -1
        self.need(step.dtype.kind in "iu" and step.ndim == 1, f"{step.name} must be a list of integers")
        self.need(step.shape == (rows,), f"{step.name} is not as long as the value")
        self.need(np.all(np.diff(step[:]) > 0), f"{step.name} does not increase")
        if "time" in item:
            time = item["time"]
            self.need(time.shape == (rows,) and time.dtype.kind in "fiu", f"{time.name} is not as long as the value")
            self.need(np.all(np.diff(time[:]) >= 0), f"{time.name} decreases")
            for number, at in zip(step[:].tolist(), time[:].tolist()):
                self.need(self.clocks.setdefault(number, at) == at, f"{step.name}: step {number} is at two times")
        self.need(shape is None or value.shape[1:] == shape, f"{value.name} has the shape {value.shape}")
        return value.shape[1:]

    def box(self, group, dimension):
        box = self.subgroup(group, "box")
        if box is None:
            return
        found = box.attrs.get("dimension")
        self.need(found is not None and np.ndim(found) == 0 and np.asarray(found).dtype.kind in "iu"
                  and found == dimension, f"{box.name}: dimension {found}")
        boundary = self.fixed_text(box, "boundary", (dimension,))
        words = [] if boundary is None else [word.decode() for word in boundary]
        self.need(all(word in ("periodic", "none") for word in words), f"{box.name}: boundary {words}")
        if not self.need("edges" in box or all(word == "none" for word in words), f"{box.name} has no edges"):
            return
        shape = self.element(box["edges"])
        self.need(shape in ((dimension,), (dimension, dimension)), f"{box.name}/edges has the shape {shape}")
        if isinstance(box["edges"], h5py.Group) and "position" in group:
            for name in ("step", "time"):
                self.need(name in box["edges"] and box["edges"][name] == group["position"][name],
                          f"{box.name}/edges/{name} is not that of position")

    def particles(self, group):
        shape = self.element(group["position"]) if "position" in group else None
        if not self.need(shape is not None and len(shape) == 2, f"{group.name} has no positions of shape [N][D]"):
            return
        count, dimension = shape
        self.box(group, dimension)
        for name, item in group.items():
            if name == "box":
                continue
            one = self.element(item)
            self.need(one is None or one[:1] == (count,), f"{item.name} is not one of {count} particles")
        for name in ("velocity", "force", "image"):
            if name in group:
                self.element(group[name], (count, dimension))
        for name in ("species", "id"):
            if name in group:
                data = group[name] if isinstance(group[name], h5py.Dataset) else group[name]["value"]
                self.need(data.dtype.kind in "iu", f"{data.name} must have integers")

    def observables(self, group):
        for item in group.values():
            if isinstance(item, h5py.Group) and "value" not in item and "step" not in item:
                self.observables(item)  # of a part of the system
            else:
                self.element(item)


def problems(root):
    """What is against the convention, in words."""
    checker = Checker(root)
    checker.metadata()
    for name in ("particles", "observables"):
        checker.subgroup(root, name)
    for group in root.get("particles", {}).values():
        checker.particles(group)
    if "observables" in root:
        checker.observables(root["observables"])
    return checker.found


def replace_attribute(group, name, value):
    del group.attrs[name]
    if value is not None:
        group.attrs[name] = value


def replace(group, name, value):
    del group[name]
    group[name] = value


DAMAGE = {
    "no author": lambda f: f["h5md"].pop("author"),
    "no name": lambda f: replace_attribute(f["h5md/author"], "name", None),
    "no version of the creator": lambda f: replace_attribute(f["h5md/creator"], "version", None),
    "text of any length": lambda f: replace_attribute(f["h5md/creator"], "name", "sigmaflow"),
    "another version": lambda f: replace_attribute(f["h5md"], "version", np.array([2, 0])),
    "no box": lambda f: f["particles/trajectory"].pop("box"),
    "wrong dimension": lambda f: replace_attribute(f["particles/trajectory/box"], "dimension", 2),
    "unknown boundary": lambda f: replace_attribute(f["particles/trajectory/box"], "boundary",
                                                    np.array([b"periodic", b"sheared", b"none"])),
    "no edges": lambda f: f["particles/trajectory/box"].pop("edges"),
    "copied step of the edges": lambda f: replace(f["particles/trajectory/box/edges"], "step",
                                                  f["particles/trajectory/position/step"][:]),
    "no step": lambda f: f["particles/trajectory/velocity"].pop("step"),
    "steps of another length": lambda f: replace(f["particles/trajectory/velocity"], "step", np.arange(3)),
    "steps that repeat": lambda f: replace(f["particles/trajectory/velocity"], "step",
                                           0 * f["particles/trajectory/position/step"][:]),
    "steps that are no integers": lambda f: replace(f["observables/viscosity"], "step",
                                                    1. * f["observables/viscosity/step"][:]),
    "times that decrease": lambda f: replace(f["observables/viscosity"], "time",
                                             -f["observables/viscosity/time"][:]),
    "another time at the same step": lambda f: replace(f["particles/trajectory/velocity"], "time",
                                                       1 + f["particles/trajectory/velocity/time"][:]),
    "a particle too few": lambda f: replace(f["particles/trajectory"], "species", np.zeros(2, int)),
}


def check_the_checker(good, broken):
    """Every damage must be found; the checker that finds nothing proves nothing."""
    for name, damage in DAMAGE.items():
        shutil.copy(good, broken)
        with h5py.File(broken, "r+") as file:
            damage(file)
            if not problems(file):
                sys.exit("wrong: nothing was found in a file with " + name)
    os.remove(broken)


def main(program, folder):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    workflow = os.path.join(folder, "flow.json")
    with open(workflow, "w") as file:
        json.dump({"suspension": {"particles": 30, "volume_fraction": 0.4, "size_ratio": 1.4, "seed": 3},
                   "steps": [{"step": "pack"},
                             {"step": "shear", "stress": 2, "strain": 0.3, "series_interval": 0.02,
                              "frame_interval": 0.1}]}, file)
    subprocess.run([program, "run", "-q", workflow, "--out", os.path.join(folder, "out")], check=True,
                   stdout=subprocess.DEVNULL)
    path = os.path.join(folder, "out/shear/run.h5")
    with h5py.File(path, "r") as run:
        found = problems(run)
        samples = dict(zip(run["observables/strain/step"][:].tolist(), run["observables/strain/value"][:].tolist()))
        frames = run["observables/trajectory/strain"]
        for step, strain in zip(frames["step"][:].tolist(), frames["value"][:].tolist()):
            if samples.get(step) != strain:
                found.append(f"the frame of step {step} is at strain {strain}, the sample at {samples.get(step)}")
        edges = run["particles/trajectory/box/edges/value"][:]
        if not np.allclose(np.mod(edges[:, 1, 0] - frames["value"][:] * edges[:, 1, 1] + 1e-9, edges[:, 0, 0]), 0, atol=1e-6):
            found.append("the offset of the box is not strain times height")
    if found:
        sys.exit("wrong:\n" + "\n".join(found))
    check_the_checker(path, os.path.join(folder, "broken.h5"))
    print("run.h5 keeps H5MD 1.1;", len(DAMAGE), "kinds of damage are found")


if __name__ == "__main__":
    main(*sys.argv[1:])
