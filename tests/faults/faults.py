#!/usr/bin/env python3
"""Experiments that break runs of sigmaflow and tally what survives.

    faults.py --program build/release/sigmaflow --library build/release/libfault_injection.so EXPERIMENT...

Experiments: kill-random kill-calls errors full-disk corruptions pairs signals walltime powercut all
--runs N sets how many (default: as many as README.md promises), --every K takes every K-th call only.
"Bitwise" is: every file of the folder equals that of an uninterrupted run, and there is no other file,
but for manifest.json (times) and .sigmaflow. Exit code 1 if anything is off; the folder of the first
failure is kept and named.
"""
import argparse
import collections
import concurrent.futures
import filecmp
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PICTURES = [
    {"step": "velocity_profile", "bins": 4, "spacing": 0.05, "width": 200, "height": 150},
    {"step": "snapshot", "width": 160, "height": 90},
]


def workflow(particles, fraction, stress, strain, pictures):
    """A thickened frictional run: packing, equilibration, shear with frames."""
    return {
        "name": "w",
        "suspension": {"particles": particles, "volume_fraction": fraction, "seed": 5},
        "steps": [
            {"step": "pack"},
            {"step": "equilibrate", "stress": stress, "series_interval": strain / 20, "minimum_strain": strain / 2,
             "window": strain / 4, "maximum_strain": strain / 2},
            {"step": "shear", "stress": stress, "strain": strain, "series_interval": strain / 20, "frame_interval": strain / 4},
        ] + (PICTURES if pictures else []),
    }


class Bench:
    """A folder for the experiments, with the uninterrupted run to compare with."""

    def __init__(self, options, flow):
        self.options = options
        self.folder = Path(tempfile.mkdtemp(prefix="sigmaflow_faults_"))
        self.flow = self.folder / "w.json"
        self.flow.write_text(json.dumps(flow))
        self.reference = self.folder / "reference"
        start = time.monotonic()
        done = self.run(self.reference)
        self.seconds = time.monotonic() - start
        if done.returncode != 0:
            sys.exit(f"the uninterrupted run fails: {done.stderr}")

    def command(self, out, *arguments):
        return [str(self.options.program), "run", str(self.flow), "--out", str(out), "-q",
                "--checkpoint-interval", "0", *arguments]

    def run(self, out, *arguments, **fault):
        return subprocess.run(self.command(out, *arguments), capture_output=True, text=True,
                              env=self.environment(out, **fault), timeout=600)

    def environment(self, out, **fault):
        if not fault:
            return dict(os.environ)
        # the address sanitizer wants to be loaded first; it works behind this library, too, but its
        # search for leaks at the end crashes now and then ("Tracer caught signal 11")
        return {**os.environ, "ASAN_OPTIONS": "verify_asan_link_order=0:detect_leaks=0",
                "LD_PRELOAD": str(self.options.library), "FAULT_FOLDER": str(out),
                **{f"FAULT_{name}": str(value) for name, value in fault.items()}}

    def differences(self, out):
        """What distinguishes a folder from the uninterrupted run."""
        def files(root):
            return {str(path.relative_to(root)) for path in root.rglob("*") if path.is_file()
                    and ".sigmaflow" not in path.parts and path.name != "manifest.json"}
        mine, theirs = files(out), files(self.reference)
        wrong = [f"missing {name}" for name in sorted(theirs - mine)]
        wrong += [f"too many {name}" for name in sorted(mine - theirs)]
        wrong += [f"other bytes {name}" for name in sorted(mine & theirs)
                  if not filecmp.cmp(out / name, self.reference / name, shallow=False)]
        return wrong

    def finish(self, out):
        """Goes on with the same command; what is wrong with the end."""
        done = self.run(out)
        if done.returncode != 0:
            return [f"exit code {done.returncode}: {done.stderr.strip()}"]
        return self.differences(out)


def calls_of(bench):
    """The calls of an undisturbed run that change files: their operations and paths, in order."""
    out, trace = bench.folder / "traced", bench.folder / "trace"
    done = bench.run(out, TRACE=trace)
    wrong = [f"exit code {done.returncode}"] if done.returncode else bench.differences(out)
    if wrong:
        sys.exit(f"the traced run differs: {wrong}")
    return read_trace(trace)


def read_trace(path):
    """All calls that succeeded, in their order; the others have numbers, too."""
    data, at, calls = path.read_bytes(), 0, []
    while at < len(data):
        end = data.index(b"\n", at)
        op, number, offset, size, name, to = data[at:end].decode().split("\t")
        at = end + 1
        content = None
        if op == "write" and int(size) > 0:
            content = data[at:at + int(size)]
            at += int(size) + 1
        calls.append(Call(op, int(offset), name, to, content, int(number)))
    return calls


class Call(collections.namedtuple("Call", "op offset path to content number")):
    """One call of the traced run; offset: flags of an open, length of a truncate."""


def tally(bench, what, tries, start, details=""):
    """Prints one line; `tries` are lists of (name of the folder, what was wrong)."""
    failed = [one for one in tries if one[1]]
    print(f"{what}: {len(tries) - len(failed)} of {len(tries)}{details}, "
          f"{time.monotonic() - start:.0f} s", flush=True)
    for name, wrong in failed[:5]:
        print(f"    {name}: {'; '.join(wrong[:4])}", flush=True)
    if not failed and bench:
        shutil.rmtree(bench.folder, ignore_errors=True)
    return not failed


def in_parallel(options, work, numbers):
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        return list(pool.map(work, numbers))


def cleaned(out, wrong):
    if not wrong:
        shutil.rmtree(out, ignore_errors=True)
    return str(out), wrong


def kill_random(options):
    bench = Bench(options, workflow(60, 0.56, 5, 0.2, True))
    start, kills = time.monotonic(), []

    def one(number):
        chance = random.Random(number)
        out = bench.folder / f"kill_{number}"
        for _ in range(chance.randint(1, 3)):
            process = subprocess.Popen(bench.command(out), stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            try:
                process.wait(chance.uniform(0, 1.5 * bench.seconds))
            except subprocess.TimeoutExpired:
                process.kill()
                kills.append(number)
                process.wait()
        return cleaned(out, bench.finish(out))

    tries = in_parallel(options, one, range(options.runs or 200))
    return tally(bench, "kill -9 at random instants, same bytes", tries, start, f", {len(kills)} kills")


def kill_calls(options):
    bench = Bench(options, workflow(12, 0.2, 5, 0.02, False))
    calls, start = calls_of(bench), time.monotonic()

    def one(call):
        number = call.number
        out = bench.folder / f"call_{number}"
        done = bench.run(out, AT=number, DO="half" if number % 2 else "kill")
        wrong = [] if done.returncode == -signal.SIGKILL else [f"not killed: {done.returncode}"]
        return cleaned(out, wrong + bench.finish(out))

    tries = in_parallel(options, one, calls[::options.every])
    return tally(bench, "killed at each write, fsync, rename, close, ..., same bytes", tries, start,
                 f" ({len(calls)} calls)")


def errors(options):
    bench = Bench(options, workflow(12, 0.2, 5, 0.02, False))
    calls, start = calls_of(bench), time.monotonic()
    silent = []

    def one(task):
        call, error = task
        op, path = call.op, call.path
        out = bench.folder / f"{error}_{call.number}"
        done = bench.run(out, AT=call.number, DO=error)
        wrong = []
        if done.returncode == 0:
            # removing what is no longer needed may fail
            silent.append((op, Path(path).name))
            if op not in ("unlink", "rmdir") and Path(path).name != "owner":
                wrong.append(f"exit code 0 after {op} of {path}")
            wrong += bench.differences(out) if op not in ("unlink", "rmdir") else []
        elif done.returncode not in (73, 74):
            wrong.append(f"exit code {done.returncode} after {op}: {done.stderr.strip()}")
        elif error in ("ENOSPC", "EDQUOT") and done.returncode != 74 and op in ("write", "open"):
            wrong.append(f"exit code {done.returncode}, not 74, after {op}")
        elif "out" not in done.stderr and bench.folder.name not in done.stderr:
            wrong.append(f"no file is named: {done.stderr.strip()}")
        return cleaned(out, wrong + bench.finish(out))

    tasks = [(call, error) for call in calls[::options.every]
             for error in (("ENOSPC", "EIO") if call.op != "close" else ("EIO",))]
    tries = in_parallel(options, one, tasks)
    return tally(bench, "ENOSPC and EIO at each call, code 73 or 74, same bytes afterwards", tries, start,
                 f" ({len(silent)} removals that may fail)")


def full_disk(options):
    bench = Bench(options, workflow(12, 0.2, 5, 0.02, False))
    calls, start = calls_of(bench), time.monotonic()

    def one(call):
        out = bench.folder / f"full_{call.number}"
        done = bench.run(out, AT=call.number, DO="full")
        last = all(later.op not in ("write", "open", "mkdir") for later in calls
                   if later.number >= call.number)
        good = done.returncode in ((0, 74) if last else (73, 74))
        wrong = [] if good else [f"exit code {done.returncode}: {done.stderr.strip()}"]
        return cleaned(out, wrong + bench.finish(out))

    tries = in_parallel(options, one, calls[::options.every])
    return tally(bench, "disk full from each call on, code 73 or 74, same bytes afterwards", tries, start)


def corruptions(options):
    bench = Bench(options, workflow(30, 0.45, 5, 0.05, False))
    start = time.monotonic()
    broken = bench.folder / "broken"
    marks = [call.number for call in calls_of(bench)
             if call.op == "rename" and "checkpoint" in call.to]
    done = bench.run(broken, AT=marks[len(marks) * 3 // 4], DO="kill")
    assert done.returncode == -signal.SIGKILL, done
    generations = sorted((broken / ".sigmaflow").glob("checkpoint.[01]"),
                         key=lambda path: path.stat().st_mtime_ns)
    assert len(generations) == 2, generations

    def damage(path, number):
        chance, data = random.Random(number), bytearray(path.read_bytes())
        place = chance.randrange(len(data))
        if number % 3 == 0:
            data[place] ^= 1 << chance.randrange(8)
        elif number % 3 == 1:
            old = bytes(data[place:place + 8])
            while bytes(data[place:place + 8]) == old:
                data[place:place + 8] = chance.randbytes(len(old))
        else:
            del data[place:]
        path.write_bytes(data)

    def one(number):
        out = bench.folder / f"corrupt_{number}"
        shutil.copytree(broken, out)
        damage(out / ".sigmaflow" / generations[1].name, number)
        done = bench.run(out)
        wrong = [] if done.returncode == 0 else [f"exit code {done.returncode}: {done.stderr}"]
        if "warning" not in done.stderr:
            wrong.append("not noticed")
        return cleaned(out, wrong + bench.differences(out))

    tries = in_parallel(options, one, range(options.runs or 300))
    good = tally(None, "newest checkpoint damaged: noticed, older one used, same bytes", tries, start)

    def both(number):
        out = bench.folder / f"both_{number}"
        shutil.copytree(broken, out)
        for path in generations:
            damage(out / ".sigmaflow" / path.name, number)
        before = {path: path.read_bytes() for path in out.rglob("*")
                  if path.is_file() and path.name != "owner" and path.suffix != ".tmp"}
        done = bench.run(out)
        wrong = [] if done.returncode == 66 else [f"exit code {done.returncode}: {done.stderr}"]
        wrong += [f"{path} was changed" for path in before if path.read_bytes() != before[path]]
        done = bench.run(out, "--force")
        wrong += [] if done.returncode == 0 else [f"--force: {done.stderr}"]
        return cleaned(out, wrong + bench.differences(out))

    tries = in_parallel(options, both, range((options.runs or 300) // 15 + 1))
    return tally(bench, "both checkpoints damaged: code 66, nothing changed, --force mends", tries,
                 start) and good


def pairs(options):
    bench = Bench(options, workflow(30, 0.45, 5, 0.05, False))
    start = time.monotonic()

    def one(number):
        out = bench.folder / f"pair_{number}"
        other = out
        if number % 3 == 2:  # the same folder by another name
            other = bench.folder / f"link_{number}"
            other.symlink_to(out)
            out.mkdir()
        processes = [subprocess.Popen(bench.command(path), stderr=subprocess.PIPE, text=True,
                                      stdout=subprocess.DEVNULL) for path in (out, other)]
        said = [process.communicate()[1] for process in processes]
        codes = [process.returncode for process in processes]
        wrong = []
        if sorted(codes) != [0, 75] and codes != [0, 0]:  # one after the other
            wrong.append(f"exit codes {codes}: {said}")
        if 75 in codes:
            first = processes[codes.index(0)] if 0 in codes else None
            named = re.search(r"process (\d+) on \S+ is writing", said[codes.index(75)])
            if not named or first is None or int(named[1]) != first.pid:
                wrong.append(f"the first is not named: {said}")
        process = subprocess.Popen(bench.command(out, "--force"), stderr=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL)
        time.sleep(random.Random(number).uniform(0, bench.seconds))
        process.kill()  # leaves no lock behind
        process.wait()
        return cleaned(out, wrong + bench.finish(out))

    tries = in_parallel(options, one, range(options.runs or 50))
    return tally(bench, "two processes on one folder: one runs; no lock survives a kill", tries, start)


def signals(options):
    bench = Bench(options, workflow(30, 0.5, 5, 0.1, True))
    calls, start = calls_of(bench), time.monotonic()
    names = ["SIGTERM", "SIGINT", "SIGUSR1", "SIGHUP", "SIGXCPU", "SIGINT2"]
    share = max(1, len(calls) // (options.runs or 20))
    # after the last step has begun there is nothing to interrupt any more
    last = max(call.number for call in calls if call.to.endswith("velocity_profile.step"))

    def one(task):
        call, name = task
        out = bench.folder / f"{name}_{call.number}"
        done = bench.run(out, AT=call.number, DO=name)
        wrong = []
        if done.returncode != 3 and not (done.returncode == 0 and call.number >= last):
            wrong.append(f"exit code {done.returncode}: {done.stderr}")
        if done.returncode == 3 and name != "SIGINT2" and "interrupted" not in done.stderr:
            wrong.append(f"says {done.stderr}")
        return cleaned(out, wrong + bench.finish(out))

    tasks = [(call, name) for name in names for call in calls[::share]]
    tries = in_parallel(options, one, tasks)
    return tally(bench, "signals: code 3 (0 when all steps were done), same bytes afterwards", tries, start)


def walltime(options):
    bench = Bench(options, workflow(100, 0.5, 5, 4, False))
    start = time.monotonic()

    def one(number):
        out = bench.folder / f"wall_{number}"
        limit = 2 + number % 3
        begin = time.monotonic()
        done = bench.run(out, "--max-walltime", str(limit))
        taken = time.monotonic() - begin
        wrong = [] if done.returncode in (0, 3) else [f"exit code {done.returncode}: {done.stderr}"]
        if taken > limit:
            wrong.append(f"{taken:.2f} s of {limit} s")
        for _ in range(200):
            if done.returncode != 3:
                break
            done = bench.run(out, "--max-walltime", str(limit))
        return cleaned(out, wrong + bench.finish(out))

    tries = in_parallel(options, one, range(options.runs or 20))
    return tally(bench, "--max-walltime: ends before, again and again to the same bytes", tries, start)


class Disk:
    """What a power cut leaves of a trace: what was synced for sure, the rest by chance.

    Contents are only safe up to the last fsync of the file, names up to the last fsync of their folder
    (later ones survive in the order in which they were made, up to some instant).
    """

    def __init__(self, calls, root, chance):
        self.root, self.chance = root, chance
        names, open_now = {}, {}        # path -> inode, while the program runs
        self.content, self.safe = {}, {}  # of inodes
        self.changes = []               # (folder, function that changes names)
        self.synced = {}                # folder -> how many of its changes are on the disk
        inodes = 0

        def change(path, action, *arguments):
            self.changes.append((os.path.dirname(path), action, arguments))

        for op, offset, path, to, data, _ in calls:
            if op == "mkdir":
                change(path, "mkdir", path)
            elif op == "open":
                if path not in names:
                    inodes += 1
                    names[path] = inodes
                    self.content[inodes], self.safe[inodes] = b"", b""
                    change(path, "name", path, inodes)
                if offset & os.O_TRUNC:
                    self.content[names[path]] = b""
                open_now[path] = names[path]
            elif op == "write":
                old = self.content[open_now[path]]
                old = old.ljust(offset, b"\0")
                self.content[open_now[path]] = old[:offset] + (data or b"") + old[offset + len(data or b""):]
            elif op == "truncate":
                self.content[open_now[path]] = self.content[open_now[path]][:offset].ljust(offset, b"\0")
            elif op == "fsync":
                if path in names:
                    self.safe[names[path]] = self.content[names[path]]
                else:
                    self.synced[path] = len(self.changes)
            elif op == "rename":
                names[to] = names.pop(path)
                change(to, "rename", path, to)
            elif op in ("unlink", "rmdir"):
                names.pop(path, None)
                change(path, "unlink", path)

    def write_to(self, out):
        """Makes the folder that is found after the power is back."""
        reached = self.chance.randint(0, len(self.changes))
        names, folders = {}, {self.root}
        for k, (folder, action, arguments) in enumerate(self.changes):
            if k >= self.synced.get(folder, 0) and k >= reached:
                continue
            if action == "mkdir":
                folders.add(arguments[0])
            elif action == "name":
                names[arguments[0]] = arguments[1]
            elif action == "rename" and arguments[0] in names:
                names[arguments[1]] = names.pop(arguments[0])
            elif action == "unlink":
                names.pop(arguments[0], None)
        shutil.rmtree(out, ignore_errors=True)
        for folder in sorted(folders):
            (out / os.path.relpath(folder, self.root)).mkdir(parents=True, exist_ok=True)
        for path, inode in names.items():
            target = out / os.path.relpath(path, self.root)
            if not target.parent.is_dir():
                continue  # its folder was lost
            now, safe = self.content[inode], self.safe[inode]
            fate = self.chance.randrange(3)
            if fate == 1:
                now = safe + b"\0" * max(0, len(now) - len(safe))
            elif fate == 2:
                now = safe
            target.write_bytes(now)


def powercut(options):
    bench = Bench(options, workflow(12, 0.2, 5, 0.02, False))
    calls, start = calls_of(bench), time.monotonic()
    root, whole = str(bench.folder / "traced"), bench.folder / "whole"

    class Certain(random.Random):  # nothing is lost: checks the replay itself
        def randint(self, low, high):
            return high

        def randrange(self, *_):
            return 0

    Disk(calls, root, Certain()).write_to(whole)
    if bench.differences(whole):
        sys.exit(f"the replay differs from the files: {bench.differences(whole)}")
    mended = []

    def one(number):
        chance = random.Random(number)
        out = bench.folder / f"power_{number}"
        Disk(calls[:chance.randint(1, len(calls))], root, chance).write_to(out)
        done = bench.run(out)
        if done.returncode == 66:
            mended.append(number)
            done = bench.run(out, "--force")
        wrong = [] if done.returncode == 0 else [f"exit code {done.returncode}: {done.stderr}"]
        return cleaned(out, wrong + bench.differences(out))

    tries = in_parallel(options, one, range(options.runs or 500))
    return tally(bench, "power cut, unsynced data lost: same bytes", tries, start,
                 f", {len(mended)} only by --force") and not mended


EXPERIMENTS = {"kill-random": kill_random, "kill-calls": kill_calls, "errors": errors,
               "full-disk": full_disk, "corruptions": corruptions, "pairs": pairs,
               "signals": signals, "walltime": walltime, "powercut": powercut}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="+", choices=[*EXPERIMENTS, "all"])
    parser.add_argument("--program", required=True, type=Path)
    parser.add_argument("--library", required=True, type=Path)
    parser.add_argument("--runs", type=int, help="how many; default: those of README.md")
    parser.add_argument("--every", type=int, default=1, help="only every K-th call")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    for number in (signal.SIGINT, signal.SIGHUP):  # a shell may have them ignored in the background
        signal.signal(number, signal.SIG_DFL)
    options.program, options.library = options.program.resolve(), options.library.resolve()
    chosen = EXPERIMENTS if "all" in options.experiments else options.experiments
    good = [EXPERIMENTS[name](options) for name in chosen]
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
