"""Runs workflows and prints what `sigmaflow plan` had said of their time, as a Markdown table.

    python3 tests/benchmarks/plan_table.py build/release/sigmaflow [workflow.json ...]

Times are processor times of the whole program (on a busy machine wall times say nothing); without
workflows a set of sizes, volume fractions, stresses and schemes is run.
"""
import json
import os
import subprocess
import sys
import tempfile


def shear(particles, volume_fraction, strain, **parameters):
    return {
        "suspension": {"particles": particles, "volume_fraction": volume_fraction},
        "steps": [{"step": "pack"}, {"step": "shear", "strain": strain, **parameters}],
    }


SET = [
    ("n 100", shear(100, 0.50, 20, stress=1)),
    ("n 200", shear(200, 0.40, 10, stress=5)),
    ("n 200", shear(200, 0.57, 5, stress=0.3)),
    ("n 500", shear(500, 0.56, 3, stress=3)),
    ("n 500, rate 0.05", shear(500, 0.52, 3, rate=0.05, model={"stiffness_scale": "fixed"})),
    ("n 500, no friction", shear(500, 0.58, 3, stress=10,
                                 model={"friction_static": 0, "friction_dynamic": 0})),
    ("n 500, heun", shear(500, 0.50, 0.5, stress=2, scheme="heun")),
    ("n 200, euler", shear(200, 0.54, 1, stress=2, scheme="euler")),
    ("n 500, frames", shear(500, 0.54, 1, stress=2, frame_interval=0.02)),
    ("n 1000", shear(1000, 0.45, 2, stress=1)),
    ("n 2000", shear(2000, 0.55, 1, stress=1)),
    ("n 4500", shear(4500, 0.54, 0.4, stress=0.5)),
]


def taken(command):
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{command} failed")
    return usage.ru_utime + usage.ru_stime


def row(program, name, path, folder):
    said = subprocess.run([program, "plan", path, "--out", folder, "--json"], check=True,
                          capture_output=True, text=True)
    predicted = json.loads(said.stdout)
    seconds = taken([program, "run", path, "--out", folder, "-q"])
    factor = predicted["seconds"] / seconds
    print(f"| {name} | {predicted['seconds']:.2f} | {seconds:.2f} | {factor:.2f} |", flush=True)


def described(name, workflow):
    step = workflow["steps"][1]
    stress = f", stress {step['stress']}" if "stress" in step else ""
    return f"{name}, phi {workflow['suspension']['volume_fraction']}{stress}, strain {step['strain']}"


def main():
    program, *files = sys.argv[1:]
    print("| run | predicted [s] | taken [s] | factor |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for k, path in enumerate(files):
            row(program, os.path.basename(path), path, f"{folder}/file_{k}")
        if files:
            return
        for k, (name, workflow) in enumerate(SET):
            path = f"{folder}/w{k}.json"
            with open(path, "w", encoding="utf-8") as file:
                json.dump(workflow, file)
            row(program, described(name, workflow), path, f"{folder}/out_{k}")


main()
