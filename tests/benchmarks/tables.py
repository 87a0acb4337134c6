#!/usr/bin/env python3
"""Runs bench_step on dense states and prints Markdown tables: solvers, threads, scaling.

    python3 tests/benchmarks/tables.py build/states --json lines.json

FOLDER holds n500.json, n2000.json, n4500.json; a state that is missing is made (n = 4500: minutes).
"""
import argparse
import json
import pathlib
import subprocess
import sys

PRE_SHEAR = {500: 1.0, 2000: 0.8, 4500: 0.6}  # strain of the states
HEUN = "--scheme heun --displacement 1e-3 --tolerance 1e-4".split()
IMPLICIT = "--scheme implicit --displacement 1e-2 --tolerance 1e-3 --strain 0.06".split()
# steps of the direct solvers, which take up to seconds each
FEW = {500: 100, 2000: 10, 4500: 3}
SCALING = [500, 1000, 2000, 5000, 10000, 20000, 50000, 100000]


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="of the states")
    root = pathlib.Path(__file__).resolve().parents[2]
    parser.add_argument("--bench", type=pathlib.Path, default=root / "build/release/bench_step")
    parser.add_argument("--json", type=pathlib.Path, help="file for the lines of bench_step")
    parser.add_argument("--peer", type=pathlib.Path,
                        help="another code: lines of n, ms per step, s per unit strain")
    parser.add_argument("--largest", type=int, default=SCALING[-1],
                        help="n of the scaling table (default: %(default)s)")
    return parser.parse_args()


class Bench:
    """bench_step; keeps every measured line in a file, if there is one."""

    def __init__(self, program, json_file):
        if not program.is_file():
            sys.exit(f"tables.py: {program} is missing: build it with "
                     "'bash workflows/setup.sh bench_step' or name it with --bench")
        self.program = program.resolve()
        self.json_file = json_file
        if json_file:
            json_file.write_text("")

    def run(self, *options, measures=True):
        command = [str(self.program), *map(str, options)]
        print("#", *command, file=sys.stderr, flush=True)
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
        try:
            if done.returncode != 0:
                raise ValueError(f"exit code {done.returncode}")
            line = json.loads(done.stdout)
        except ValueError as error:
            sys.exit(f"tables.py: {' '.join(command)}: {error}")
        if self.json_file and measures:
            with self.json_file.open("a") as file:
                file.write(json.dumps(line) + "\n")
        return line


def state_of(bench, folder, n):
    path = folder / f"n{n}.json"
    if not path.is_file():
        folder.mkdir(parents=True, exist_ok=True)
        bench.run("--particles", n, "--pre-shear", PRE_SHEAR[n], "--save", path, "--steps", 1,
                  measures=False)
    return path


def read_peer(path):
    """{n: (ms per step, s per unit strain)}"""
    peer = {}
    for number, text in enumerate(path.read_text().splitlines(), 1):
        fields = text.split("#")[0].split()
        if not fields:
            continue
        try:
            n, step, strain = fields
            peer[int(n)] = float(step), float(strain)
        except ValueError:
            sys.exit(f"tables.py: {path}:{number}: expected n, ms per step, s per unit strain")
    return peer


def digits(x):
    return f"{x:.0f}" if x >= 100 else f"{x:.3g}"


def times_faster(line, peer):
    """Per step, for the same kind of step only, and per unit strain."""
    if line["particles"] not in peer:
        return ""
    step, strain = peer[line["particles"]]
    per_strain = f"strain {digits(strain / line['seconds_per_strain'])}"
    if line["scheme"] == "implicit":
        return per_strain
    return f"step {digits(step / line['ms_per_step'])}, {per_strain}"


COLUMNS = {
    "n": lambda line: line["particles"],
    "scheme": lambda line: line["scheme"],
    "solver": lambda line: line["solver"],
    "threads": lambda line: line["threads"],
    "pairs": lambda line: line["pairs"],
    "contacts": lambda line: f"{line['contact_number']:.2f}",
    "steps": lambda line: line["steps"],
    "ms per step": lambda line: digits(line['ms_per_step']),
    "us per particle and step": lambda line: digits(1e3 * line['ms_per_step'] / line['particles']),
    "iterations": lambda line: f"{line['iterations']:.1f}",
    "s per unit strain": lambda line: digits(line['seconds_per_strain']),
    "core memory [MB]": lambda line: f"{line['core_memory_MB']:.1f}",
    "rate": lambda line: f"{line['mean_shear_rate']:.5f}",
}


def print_table(title, names, lines, peer=None):
    columns = {name: COLUMNS[name] for name in names}
    if peer:
        columns["times faster"] = lambda line: times_faster(line, peer)
    print(f"\n{title}\n")
    print("|", " | ".join(columns), "|")
    print("|", " | ".join("---" for _ in columns), "|")
    for line in lines:
        print("|", " | ".join(str(value(line)) for value in columns.values()), "|")
    sys.stdout.flush()


def main():
    arguments = read_arguments()
    peer = read_peer(arguments.peer) if arguments.peer else None
    bench = Bench(arguments.bench, arguments.json)

    solvers, threads, scaling = [], [], []
    for n, few in FEW.items():
        start = ["--state", state_of(bench, arguments.folder, n)]
        heun = bench.run(*start, *HEUN)
        implicit = bench.run(*start, *IMPLICIT)
        solvers += [heun, *(bench.run(*start, *HEUN, "--solver", solver, "--steps", few)
                            for solver in ("lagged_cholesky", "cholesky")), implicit]
        if n > 500:
            for one, options in ((heun, HEUN), (implicit, IMPLICIT)):
                threads += [one, bench.run(*start, *options, "--threads", 2)]
    for n in (n for n in SCALING if n <= arguments.largest):
        scaling.append(bench.run("--particles", n, "--pre-shear", 0.2, *HEUN, "--steps", 20))

    cost = ["ms per step", "us per particle and step", "iterations"]
    print_table("Solvers and schemes, one thread (CPU time):",
                ["n", "scheme", "solver", "steps", *cost, "s per unit strain", "core memory [MB]",
                 "rate"], solvers, peer)
    print_table("Threads (one: CPU time, two: wall time):",
                ["n", "scheme", "threads", *cost, "s per unit strain", "core memory [MB]", "rate"],
                threads, peer)
    print_table("Scaling, one thread, heun, pcg, packings sheared by 0.2:",
                ["n", "pairs", "contacts", *cost, "core memory [MB]"], scaling)


if __name__ == "__main__":
    main()
