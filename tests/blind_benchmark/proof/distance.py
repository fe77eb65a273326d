#!/usr/bin/python3
"""Distance of the tool's simulator from the one that records, with the true numbers and effects.

    distance.py --program build/bin/supercircle --out FOLDER [--set-ups NAME,...] [--seed N] [--controls N] [--effects]
                [--jobs N]

Prints, for controls and with --effects for each family at a noticeable size, the difference of the readings (rms) in
standard deviations of the noise, and writes FOLDER/distance.csv. Exit code 1: the median of the controls of a set-up
exceeds 0.5, so the set does not use it (docs/results/claims.md).
"""
import argparse
import concurrent.futures
import csv
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import numpy as np  # noqa: E402

import conceal  # noqa: E402
import plan as plans  # noqa: E402

LIMIT = 0.5  # noise standard deviations


def flags(numbers, effects):
    """Options of `supercircle replay` for these true numbers and effects."""
    out = []
    for (run, name), value in numbers.items():
        out += ["--param", f"{name if run is None else f'{name}_run{run + 1}'}={value:.17g}"]
    laws = {"Stribeck": "stribeck", "logarithmic": "logarithmic", "Kelvin-Voigt": "kelvin_voigt",
            "standard linear solid": "standard_linear_solid", "modulus": "modulus"}
    for e in effects:
        if e.variant in laws:
            out += ["--effect", f"{e.label}:law={laws[e.variant]}"]
        for name, value in e.parameters.items():
            out += ["--effect", f"{e.label}:{name}={value:.17g}"]
    return out


def compared(file):
    """[(recorded, simulated)] of each channel of a NAME_replay.csv; rows without a reading are left out."""
    with open(file, newline="", encoding="utf-8") as f:
        head, *lines = list(csv.reader(f))
    out = []
    for k, name in enumerate(head):
        if "_recorded" in name:
            other = head.index(name.replace("_recorded", "_simulated"))
            pairs = [(line[k].strip(), line[other].strip()) for line in lines]
            out.append(np.array([(float(a), float(b)) for a, b in pairs if a and b]).T)
    return out


def of(program, specimen, effects, folder):
    """Difference of the readings (rms, noise standard deviations): the largest of the channels, of all runs together."""
    d, clean = specimen.description, specimen.readings(specimen.numbers, effects)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "experiment.json").write_text(json.dumps(conceal.described(specimen.module, d), indent=1))
    for i, run in enumerate(d.runs):
        (folder / f"run_{i + 1}.csv").write_text(conceal.csv_of(run, d, clean[i]))
    numbers = {key: v for key, v in specimen.numbers.items() if dict(d.numbers())[key].half > 0.0}
    done = subprocess.run([program, "replay", str(folder / "experiment.json"), "--out", str(folder / "replay"), "--quiet",
                           *flags(numbers, effects)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"replay ended with exit code {done.returncode}: {done.stderr.strip()[:300]}")
    squares, rows = [0.0] * len(specimen.noise), [0] * len(specimen.noise)
    for i in range(len(d.runs)):
        channels = compared(folder / "replay" / f"run_{i + 1}_replay.csv")
        if len(channels) != len(specimen.noise):
            raise RuntimeError(f"the replay compares {len(channels)} channels, expected {len(specimen.noise)}")
        for c, (recorded, simulated) in enumerate(channels):
            squares[c] += float(((recorded - simulated)**2).sum()) / specimen.noise[c]**2
            rows[c] += len(recorded)
    return max(math.sqrt(s / n) if n else math.inf for s, n in zip(squares, rows))


def one(program, name, what, k, seed, folder):
    """A line of the table: control `k` of a set-up, or one of its families at a noticeable size."""
    module, draw = conceal.setup(name), conceal.draw_of(seed, name, what, k)
    specimen = conceal.Specimen(module, draw)
    family = next((f for f in module.FAMILIES if f.name == what), None)
    try:
        far = of(os.path.abspath(program), specimen, [family.draw(draw)(1.0)] if family else [],
                 pathlib.Path(folder, name, f"{what}_{k}"))
    except RuntimeError as why:
        far = math.inf
        print(f"{name}, {what}: {why}", file=sys.stderr)
    return {"set_up": name, "hidden": what, "rms": round(far, 4)}


def measure(program, set_ups, folder, seed=1, controls=3, effects=False, jobs=1):
    """Lines of controls and, if wanted, of all families."""
    todo = [(name, what, k) for name in set_ups for what, k in
            [("nothing", k) for k in range(controls)] +
            [(f.name, 0) for f in conceal.setup(name).FAMILIES if effects]]
    with concurrent.futures.ProcessPoolExecutor(max(1, jobs)) as pool:
        lines = []
        for done in [pool.submit(one, program, *what, seed, folder) for what in todo]:
            lines.append(done.result())
            print("{set_up:22} {hidden:22} {rms:8.3f}".format(**lines[-1]), flush=True)
    return lines


def write_lines(lines, file):
    with open(file, "w", newline="", encoding="utf-8") as f:
        table = csv.DictWriter(f, ("set_up", "hidden", "rms"), lineterminator="\n")
        table.writeheader()
        table.writerows(lines)


def read_lines(file):
    with open(file, newline="", encoding="utf-8") as f:
        return [{**line, "rms": float(line["rms"])} for line in csv.DictReader(f)]


def too_far(lines):
    """Set-ups whose controls differ by more than the limit (median)."""
    return [name for name in dict.fromkeys(line["set_up"] for line in lines)
            if statistics.median(line["rms"] for line in lines
                                 if line["set_up"] == name and line["hidden"] == "nothing") > LIMIT]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--set-ups", default=",".join(plans.SET_UPS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--controls", type=int, default=3)
    parser.add_argument("--effects", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    o = parser.parse_args()
    lines = measure(o.program, o.set_ups.split(","), o.out, o.seed, o.controls, o.effects, o.jobs)
    write_lines(lines, pathlib.Path(o.out, "distance.csv"))
    far = too_far(lines)
    if far:
        print(f"not used, controls differ by more than {LIMIT} noise standard deviations: {', '.join(far)}")
    return 1 if far else 0


if __name__ == "__main__":
    sys.exit(main())
