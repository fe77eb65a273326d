"""An arch between plates, by the reference simulator: `synthetic_cases --arch` makes the files."""
import json
import os
import pathlib
import subprocess
import tempfile

from description import Family

SIMULATOR = "reference"
LABELS = {"relaxation": "viscoelastic_bending", "plasticity": "plasticity", "softening": "softening_over_time",
          "static_friction": "static_friction_excess", "logarithmic_friction": "rate_dependent_friction",
          "wear": "wear", "machine": "machine_compliance", "drift": "sensor_drift", "backlash": "backlash"}
FAMILIES = [Family(name, label, None) for name, label in LABELS.items()]
PAIR = ("static_friction", "drift")
OUTSIDE = [Family("periodic", "", None), Family("kelvin_voigt", "", None)]  # the second one leaves the catalogue
VARIANTS = {"rate_dependent_friction": ("Stribeck", "logarithmic", "viscous")}


def make_case(plan, seed):
    kind = {"control": "nothing", "below": "single", "limit": "single"}.get(plan["kind"], plan["kind"])
    if plan["families"] == ["kelvin_voigt"] and kind == "outside":
        kind = "removed"
    program = os.environ["SYNTHETIC_CASES"]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([program, "--arch", f"{kind}:{plan['strength']}:{'+'.join(plan['families'])}",
                               "--name", plan["name"], "--seed", str(seed), "--out", folder],
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(done.stderr.strip() or f"{program} ended with exit code {done.returncode}")
        files = {p.name: p.read_text() for p in pathlib.Path(folder).iterdir()}
    own = json.loads(files.pop("answer.json"))
    rows = sum(r["rows"] for r in own["runs"])
    noise = (sum(r["rows"] * r["rms_noise_N"]**2 for r in own["runs"]) / rows)**0.5
    effects = []
    for e in own["effects"]:
        variant = ""
        if e["label"] in VARIANTS:
            variant = VARIANTS[e["label"]][int(e["parameters"].pop("law"))]
        label = f"outside:{e['label']}" if plan["kind"] == "outside" else e["label"]
        effects.append({"label": label, "variant": variant, "parameters": e["parameters"]})
    moved = ["bending_modulus", "friction"] if kind == "swap" else []
    return files, {**plan, "simulator": SIMULATOR, "sigma": own["detectable"], "moved": moved, "effects": effects,
                   "without": own["diagnose_without"], "noise_rms": [noise],
                   "true_parameters": own["true_parameters"], "own_error": own["own_error"]}
