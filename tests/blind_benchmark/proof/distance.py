#!/usr/bin/python3
"""Distance of the tool's simulator from the one that records, with the true numbers and effects.

    distance.py --program build/bin/supercircle --out FOLDER [--set-ups NAME,...] [--seed N] [--controls N] [--effects]

Prints, for controls and with --effects for each family at a noticeable size, the difference of the readings (rms) in
standard deviations of the noise, and writes FOLDER/distance.csv. Exit code 1: the median of the controls of a set-up
exceeds 0.5, so the set does not use it (docs/results/claims.md).
"""
import argparse
import csv
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import conceal  # noqa: E402
import plan as plans  # noqa: E402
import rivals  # noqa: E402

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


def distance(program, specimen, effects, folder):
    """Difference of the first channel (rms, noise standard deviations), of all runs together."""
    d, clean = specimen.description, specimen.readings(specimen.numbers, effects)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "experiment.json").write_text(json.dumps(conceal.experiment_of(d), indent=1))
    for i, run in enumerate(d.runs):
        (folder / f"run_{i + 1}.csv").write_text(conceal.csv_of(run, d, clean[i]))
    numbers = {key: v for key, v in specimen.numbers.items() if dict(d.numbers())[key].half > 0.0}
    done = subprocess.run([program, "replay", str(folder / "experiment.json"), "--out", str(folder / "replay"), "--quiet",
                           *flags(numbers, effects)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"replay ended with exit code {done.returncode}: {done.stderr.strip()[:300]}")
    squares = rows = 0.0
    for i in range(len(d.runs)):
        _, recorded, simulated = rivals.replayed(folder / "replay" / f"run_{i + 1}_replay.csv")
        squares += float(((recorded - simulated)**2).sum()) / specimen.noise[0]**2
        rows += len(recorded)
    return math.sqrt(squares / rows) if rows else math.inf


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--set-ups", default=",".join(s for s in plans.SET_UPS if s != "arch_between_plates"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--controls", type=int, default=3)
    parser.add_argument("--effects", action="store_true")
    o = parser.parse_args()
    out, far = [], []
    for name in o.set_ups.split(","):
        module = conceal.setup(name)
        for k in range(o.controls):
            out.append((name, "nothing", k))
        for family in module.FAMILIES if o.effects else []:
            out.append((name, family.name, 0))
    lines = []
    for name, what, k in out:
        draw = conceal.draw_of(o.seed, name, what, k)
        specimen = conceal.Specimen(conceal.setup(name), draw)
        family = next((f for f in conceal.setup(name).FAMILIES if f.name == what), None)
        effects = [family.draw(draw)(1.0)] if family else []
        try:
            far_by = distance(os.path.abspath(o.program), specimen, effects, pathlib.Path(o.out, name, f"{what}_{k}"))
        except RuntimeError as why:
            far_by = math.inf
            print(f"{name}, {what}: {why}", file=sys.stderr)
        lines.append({"set_up": name, "hidden": what, "rms": round(far_by, 4)})
        print(f"{name:22} {what:22} {far_by:8.3f}", flush=True)
    with open(pathlib.Path(o.out, "distance.csv"), "w", newline="", encoding="utf-8") as f:
        table = csv.DictWriter(f, ("set_up", "hidden", "rms"), lineterminator="\n")
        table.writeheader()
        table.writerows(lines)
    for name in dict.fromkeys(line["set_up"] for line in lines):
        controls = [line["rms"] for line in lines if line["set_up"] == name and line["hidden"] == "nothing"]
        if controls and statistics.median(controls) > LIMIT:
            far.append(name)
    if far:
        print(f"not used, controls differ by more than {LIMIT} noise standard deviations: {', '.join(far)}")
    return 1 if far else 0


if __name__ == "__main__":
    sys.exit(main())
