"""The JSON Schema of workflows, used by an independent validator (Python's jsonschema), against the program's own reader.

    python3 schema_agrees.py PROGRAM FOLDER_OF_WORKFLOWS FOLDER_OF_BAD_INPUTS

- Every shipped workflow is accepted by both.
- Every bad one is refused by both, but for those that only the program can refuse: beyond_schema.json says why for each.
- Values of shipped workflows are replaced by others, right and wrong ones: what the schema refuses the program refuses, and what the
  program alone refuses is not called an unknown key or a wrong type.
Exit code 77 where jsonschema is not installed.
"""
import copy
import json
import pathlib
import random
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("jsonschema is not installed")
    sys.exit(77)

program, shipped_folder, bad_folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
schema = json.loads(subprocess.run([program, "schema"], capture_output=True, check=True).stdout)
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
failures = []


def expect(condition, text):
    if not condition:
        failures.append(text)


class NotJson(Exception):
    pass


def strict(text):
    """JSON as RFC 8259 has it: Python's own reader keeps the last of equal keys and knows NaN."""

    def members(pairs):
        if len({key for key, _ in pairs}) != len(pairs):
            raise NotJson("equal keys")
        return dict(pairs)

    def constant(name):
        raise NotJson(name)

    try:
        value = json.loads(text.decode("utf-8"), object_pairs_hook=members, parse_constant=constant)
    except (ValueError, RecursionError, NotJson) as error:
        raise NotJson(str(error)) from error
    if text.startswith(b"\xef\xbb\xbf"):
        raise NotJson("byte-order mark")
    return value


def schema_accepts(text):
    try:
        return validator.is_valid(strict(text))
    except NotJson:
        return False


def program_refusals(paths):
    """What the program says of each file that it refuses."""
    said = subprocess.run([program, "validate", *map(str, paths)], capture_output=True, text=True, errors="replace")
    refusals = {}
    for line in said.stderr.splitlines():
        for path in paths:
            if line.startswith(f"sigmaflow: error: {path}:"):
                refusals.setdefault(path, []).append(line)
    accepted = [path for path in paths if f"{path}: workflow" in said.stdout]
    expect(len(accepted) + len(refusals) == len(paths), f"neither accepted nor refused: {set(paths) - set(accepted) - set(refusals)}")
    return refusals


# Shipped workflows are accepted by both.
shipped = sorted(path for path in shipped_folder.rglob("*.json") if not path.name.endswith(".schema.json") and '"steps"' in path.read_text())
refused = program_refusals(shipped)
for path in shipped:
    expect(schema_accepts(path.read_bytes()), f"{path}: refused by the schema: {list(validator.iter_errors(json.loads(path.read_text())))[:1]}")
    needs_result = any("must be a file, there is none" in line for line in refused.get(path, []))  # of another workflow
    expect(path not in refused or needs_result, f"{path}: {refused.get(path)}")

# Bad ones are refused by both, but for what no schema can say.
beyond = json.loads((bad_folder / "beyond_schema.json").read_text())
for path in sorted((bad_folder / "workflows").iterdir()):
    if not path.is_file():
        continue
    accepts = schema_accepts(path.read_bytes())
    expect(accepts == (path.name in beyond), f"{path.name}: the schema {'accepts' if accepts else 'refuses'} it, beyond_schema.json says otherwise")

# Wrong values in good workflows.
rng = random.Random(20150512)
wrong_values = [None, True, 7, -1, 0, 1e300, -1e300, 1.5, "", "zzz", [], [0.5, 1], ["a"], {}, {"a": 1}]
mutants = {}
with tempfile.TemporaryDirectory() as folder:
    sources = [json.loads(path.read_text()) for path in shipped if path not in refused]
    for number in range(400):
        workflow = copy.deepcopy(rng.choice(sources))
        objects = [workflow, workflow.get("suspension", workflow), *workflow["steps"], *workflow["steps"], *workflow["steps"]]
        target = rng.choice(objects)
        if rng.random() < 0.15:
            target[rng.choice(["strian", "x", "Stress", "particle"])] = 1
        else:
            target[rng.choice(list(target))] = rng.choice(wrong_values)
        path = pathlib.Path(folder) / f"mutant_{number}.json"
        path.write_text(json.dumps(workflow, indent=1))
        mutants[path] = workflow
    both = only_program = 0
    said = program_refusals(list(mutants))
    for path, workflow in mutants.items():
        refused_by_schema = not validator.is_valid(workflow)
        if refused_by_schema:
            expect(path in said, f"only the schema refuses: {list(validator.iter_errors(workflow))[0].message[:200]}\n{path.read_text()}")
            both += path in said
        elif path in said:
            only_program += 1
            of_structure = [line for line in said[path] if "unknown key" in line or "must be a number" in line or "must be an integer" in line]
            expect(not of_structure, f"only the program refuses: {of_structure}")
    expect(both > 100, f"only {both} of the 400 changed workflows are wrong in structure")

print(f"{len(shipped)} shipped and {len(list((bad_folder / 'workflows').iterdir()))} bad workflows; of 400 changed ones {both} refused by both, "
      f"{only_program} by the program alone")
for text in failures:
    print("FAILED:", text)
sys.exit(1 if failures else 0)
