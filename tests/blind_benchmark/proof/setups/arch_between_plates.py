"""An arch that stands on its two ends and is squeezed by a plate: once slowly, twice fast, and held.

Recorded by the reference simulator of this project (tests/reference_simulator): `synthetic_cases --readings`.
"""
import json
import math
import os
import pathlib
import subprocess
import tempfile

import numpy as np

from description import Channel, Description, Effect, Family, Run, Stated, of, value

SIMULATOR = "reference"
DRIVES = [((0, 1, 13, 25, 26), (0, 0, 6, 0, 0), 20.0),
          ((0, 1, 2.2, 3.4, 4.6, 5.8, 6.8), (0, 0, 6, 0, 6, 0, 0), 60.0),
          ((0, 1, 4, 15, 18, 20), (0, 0, 6, 6, 0, 0), 20.0)]
ZERO = 0.5  # s, whose mean reading is subtracted
SURE = 0.25  # noise standard deviations (rms) that halving the resolution may change (decision 0089)


def describe(draw):
    width, radius = 1e-3 * round(draw.uniform(9.0, 12.4)), 1e-4 * round(draw.uniform(190.0, 210.0))
    half, thickness = math.pi * draw.uniform(0.45, 0.58), 5e-4
    modulus, line = 2.2e9 * width * thickness**3 / 12.0, 1270.0 * width * thickness
    height = 1e-7 * round(1e7 * (radius * (1.0 - math.cos(half)) + thickness + 4e-4))
    stated = {"bending_modulus": Stated(modulus, 0.06 * modulus), "natural_curvature": Stated(1.0 / radius, 0.005 / radius),
              "friction": Stated(0.01 * round(draw.uniform(25.0, 36.0)), 0.05), "thickness": Stated(thickness, 1e-5),
              "linear_mass": Stated(line, 0.02 * line), "gap_shift": Stated(0.0, 5e-5),
              "arc_length": Stated(2.0 * half * radius, 0.0), "width": Stated(width, 0.0),
              "plate_height": Stated(height, 0.0)}
    noise = 5e-4 * round(draw.uniform(4.0, 6.0))
    runs = [Run(np.arange(0.0, time[-1] - 1e-9, 1.0 / rate), drive=(time, tuple(1e-3 * d for d in way)))
            for time, way, rate in DRIVES]
    return Description("", stated, runs, [Channel("", "force_N", noise, 5.0 * noise, 1.0)])


def experiment_of(description, numbers=None):
    """experiment.json. numbers: true ones instead of those that are stated."""
    own = {name: s.value for name, s in description.stated.items()} | (numbers or {})
    unc = {name: s.half for name, s in description.stated.items()}
    plane = {"type": "plane", "point_m": [0.0, 0.0], "normal_towards_specimen": [0.0, 1.0], "carried_by": "ground"}
    plate = {**plane, "point_m": [0.0, own["plate_height"] + own["gap_shift"]], "normal_towards_specimen": [0.0, -1.0],
             "carried_by": "machine_head"}
    specimen = {"id": "A", "arc_length_m": own["arc_length"], "natural_curvature_1_m": own["natural_curvature"],
                "natural_curvature_rel_unc": unc["natural_curvature"] / own["natural_curvature"],
                "thickness_m": own["thickness"], "thickness_unc_m": unc["thickness"], "width_m": own["width"],
                "bending_modulus_N_m2": own["bending_modulus"],
                "bending_modulus_rel_unc": unc["bending_modulus"] / own["bending_modulus"],
                "stretch_modulus_N": 2.2e9 * own["width"] * 5e-4, "linear_mass_kg_m": own["linear_mass"],
                "linear_mass_rel_unc": unc["linear_mass"] / own["linear_mass"],
                "clamp": {"where": "none",
                          "initial_placement": "stands on the floor, apex at x=0, apex tangent horizontal"}}
    return {"schema": "rod-recordings/1", "protocol": "arch_between_plates", "gravity_m_s2": [0.0, -9.81],
            "uncertainty_meaning": "half-width of a uniform interval", "specimens": [specimen],
            "obstacles": [plane, plate],
            "friction": {"coefficient": own["friction"], "coefficient_unc": unc["friction"]},
            "initial_gap_unc_m": unc["gap_shift"],
            "runs": [{"file": f"run_{i + 1}.csv", "drive_time_s": list(run.drive[0]),
                      "drive_displacement_mm": [1e3 * d for d in run.drive[1]],
                      "sampling_hz": round(1.0 / (run.times[1] - run.times[0]), 6)}
                     for i, run in enumerate(description.runs)],
            "sensors": {"force_noise_std_N_approx": description.channels[0].noise,
                        "force_zero": f"the mean reading of the first {ZERO} s is subtracted",
                        "displacement_channel": "commanded cross-head displacement",
                        "displacement_noise_std_mm_approx": 1e-4}}


def zeroed(times, column):
    return column - np.mean(np.asarray(column)[times < ZERO])


def simulate(numbers, run, times, effects, resolution=1.0):
    description = Description("", {name: Stated(v, 0.0) for name, v in numbers.items()}, [run],
                              [Channel("", "force_N", 1e-3, 0.0, 1.0)])
    hidden = [{"label": e.label.removeprefix("outside:"), "parameters":
               {**e.parameters, **({"law": 1.0} if e.label == "rate_dependent_friction" else {})}}
              for e in effects if e.label != "outside:core"]
    with tempfile.TemporaryDirectory() as folder:
        files = [pathlib.Path(folder, "experiment.json"), pathlib.Path(folder, "effects.json")]
        for file, content in zip(files, (experiment_of(description), hidden)):
            file.write_text(json.dumps(content))
        program = os.environ["SYNTHETIC_CASES"]
        done = subprocess.run([program, "--readings", files[0], "--effects", files[1], "--resolution", str(resolution)],
                              capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip() or f"{program} ended with exit code {done.returncode}")
    force = np.array(json.loads(done.stdout)[0], float)
    if len(force) != len(times):
        raise RuntimeError(f"{program} gave {len(force)} readings; expected {len(times)}")
    core, begin = (value(effects, "outside:core", name) for name in ("stiffness_N_m", "begin_m"))
    return [force + core * np.maximum(np.interp(times, *run.drive) - begin, 0.0)]  # foam under the plate


def simulate_coarsely(numbers, run, times, effects):
    """The same on 60 edges, for the search of an amplitude."""
    return simulate(numbers, run, times, effects, 0.0)


def unsure(specimen, effects):
    """Whether the simulator does not know its own readings, as where a specimen sticks and slips."""
    fine, half = (specimen.readings(specimen.numbers, effects, simulation) for simulation in
                  (simulate, lambda *all: simulate(*all, 0.5)))
    apart = np.concatenate([a - b for (a,), (b,) in zip(fine, half)]) / specimen.noise[0]
    return math.sqrt(np.mean(np.minimum(apart**2, 64.0))) > SURE  # a jump that comes later counts as eight


def _relaxation(draw):
    time = math.exp(draw.uniform(math.log(0.5), math.log(5.0)))
    return lambda a: Effect("viscoelastic_bending", {"branch_over_B": 0.1 * a, "tau_s": time}, "standard linear solid")


def _plastic(draw):
    """Yield moment relative to the largest moment in the set-up."""
    hardening = draw.uniform(0.2, 0.6)
    return lambda a: Effect("plasticity", {"My_over_B_1_m": 33.0 * (1.0 - 0.12 * a), "H_over_B": hardening})


def _softening(draw):
    time = math.exp(draw.uniform(math.log(4.0), math.log(25.0)))
    return lambda a: Effect("softening_over_time", {"drop": min(0.8, 0.08 * a), "tau_s": time}, "exponential")


def _static(draw):
    length, heal = math.exp(draw.uniform(math.log(8e-5), math.log(4e-4))), draw.uniform(1.0, 5.0)
    return lambda a: Effect("static_friction_excess",
                            {"mu_s_over_mu_k": 1.0 + 0.3 * a, "Dc_m": length, "tau_heal_s": heal})


def _logarithmic(draw):
    speed = math.exp(draw.uniform(math.log(1e-5), math.log(2e-4)))
    return lambda a: Effect("rate_dependent_friction", {"strength": 0.04 * a, "speed_m_s": speed}, "logarithmic")


def _wear(draw):
    way, sign = math.exp(draw.uniform(math.log(0.01), math.log(0.06))), draw.choice((-1.0, 1.0))
    return lambda a: Effect("wear", {"change": max(-0.9, 0.25 * a * sign), "distance_m": way}, "exponential")


def _machine(draw):
    return lambda a: Effect("machine_compliance", {"k_N_m": 5000.0 / a})


def _drift(draw):
    time, sign = math.exp(draw.uniform(math.log(3.0), math.log(20.0))), draw.choice((-1.0, 1.0))
    return lambda a: Effect("sensor_drift", {"a_N": 0.035 * a * sign, "tau_s": time}, "towards an end")


def _periodic(draw):
    period = draw.uniform(2.5, 7.0)
    return lambda a: Effect("outside:periodic_disturbance", {"a_N": 0.014 * a, "period_s": period})


def _core(draw):
    begin = draw.uniform(2.5e-3, 3.5e-3)
    return lambda a: Effect("outside:core", {"stiffness_N_m": 3.0 * a, "begin_m": begin})


FAMILIES = [
    Family("relaxation", "viscoelastic_bending", _relaxation, 8.0),
    Family("plasticity", "plasticity", _plastic, 6.0),
    Family("softening", "softening_over_time", _softening, 10.0),
    Family("static_friction", "static_friction_excess", _static, 8.0),
    Family("logarithmic_friction", "rate_dependent_friction", _logarithmic, 12.0),
    Family("wear", "wear", _wear, 4.0),
    Family("machine", "machine_compliance", _machine, 12.0),
    Family("drift", "sensor_drift", _drift, 20.0),
    Family("backlash", "backlash", of("backlash", "play_m", 5e-5, "taken up at reversals"), 12.0),
]
OUTSIDE = [Family("periodic", "", _periodic, 20.0), Family("core", "", _core)]
