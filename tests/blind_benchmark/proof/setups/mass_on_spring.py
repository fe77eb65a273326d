"""A weight on a spring and a straight guide, released at three heights. Scene `mass_on_spring`."""
import math

import numpy as np

from description import Channel, Description, Effect, Family, Run, Stated, of, rounded, value
from motion import motion

SIMULATOR = "scipy"


def describe(draw):
    frequency = rounded(draw.uniform(1.2, 2.0), 3)
    stated = {"mass": Stated(rounded(draw.uniform(0.3, 0.7), 3), 0.0),
              "frequency": Stated(frequency, rounded(0.03 * frequency, 2))}
    times = np.arange(0.0, 6.0, 0.02)
    runs = [Run(times, {"release_y": Stated(rounded(sign * draw.uniform(*span), 3), 0.002),
                        "release_vy": Stated(0.0, 0.02)})
            for sign, span in ((1, (0.015, 0.025)), (-1, (0.03, 0.04)), (1, (0.05, 0.06)))]
    return Description("mass_on_spring", stated, runs, [Channel("position", "position_mm", 0.2, 1.0, 1e3)])


def simulate(numbers, run, times, effects):
    mass = numbers["mass"]
    stiffness = mass * (2.0 * math.pi * numbers["frequency"])**2
    cubic = value(effects, "nonlinear_spring", "cubic_1_m2")
    dry, viscous, quadratic = (value(effects, "guide_friction", n)
                               for n in ("force_N", "viscous_N_s_m", "quadratic_N_s2_m2"))
    gap = value(effects, "outside:loose_spring", "play_m")
    fall, time = (value(effects, "outside:tiring_spring", n, off) for n, off in (("drop", 0.0), ("tau_s", 1.0)))

    def force(t, x, v):
        stretch = x - max(-0.5 * gap, min(0.5 * gap, x))
        spring = stiffness * (1.0 - fall * (1.0 - math.exp(-t / time))) * stretch * (1.0 + cubic * stretch**2)
        return -spring - viscous * v - quadratic * abs(v) * v

    start = (numbers["release_y"], numbers["release_vy"])
    return [motion(mass, force, start, times, 0.03, (lambda t, x, v, z: dry) if dry else None)[0]]


FAMILIES = [
    Family("dry_guide", "guide_friction", of("guide_friction", "force_N", 0.01, "dry")),
    Family("viscous_guide", "guide_friction", of("guide_friction", "viscous_N_s_m", 0.02, "viscous")),
    Family("quadratic_guide", "guide_friction", of("guide_friction", "quadratic_N_s2_m2", 0.05, "quadratic")),
    Family("hardening_spring", "nonlinear_spring", of("nonlinear_spring", "cubic_1_m2", 5.0)),
    Family("softening_spring", "nonlinear_spring", of("nonlinear_spring", "cubic_1_m2", -5.0), 16.0),
]
OUTSIDE = [
    Family("loose_spring", "", of("outside:loose_spring", "play_m", 1e-4)),
    Family("tiring_spring", "", lambda draw: (lambda time: lambda a: Effect(
        "outside:tiring_spring", {"drop": 0.01 * a, "tau_s": time}))(draw.uniform(0.5, 2.0)), 30.0),
]
