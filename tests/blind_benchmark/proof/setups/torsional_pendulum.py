"""A disc on a spiral spring, released at three angles. Scene `torsional_pendulum`."""
import math

import numpy as np

from description import Channel, Description, Effect, Family, Run, Stated, of, rounded, value
from motion import motion

DEGREE = math.pi / 180.0
SIMULATOR = "scipy"


def describe(draw):
    frequency = rounded(draw.uniform(0.6, 1.2), 3)
    stated = {"inertia": Stated(rounded(draw.uniform(5e-4, 2e-3), 3), 0.0),
              "frequency": Stated(frequency, rounded(0.03 * frequency, 2))}
    times = np.arange(0.0, 9.0, 0.03)
    runs = [Run(times, {"release_angle": Stated(rounded(sign * draw.uniform(*span), 3), 0.02),
                        "release_spin": Stated(0.0, 0.1)})
            for sign, span in ((1, (0.3, 0.4)), (-1, (0.7, 0.9)), (1, (1.2, 1.5)))]
    return Description("torsional_pendulum", stated, runs, [Channel("angle", "angle_deg", 0.2, 0.5, 1.0 / DEGREE)])


def simulate(numbers, run, times, effects):
    inertia = numbers["inertia"]
    stiffness = inertia * (2.0 * math.pi * numbers["frequency"])**2
    cubic = value(effects, "nonlinear_spring", "cubic_1_rad2")
    dry, viscous = (value(effects, "bearing_friction", n) for n in ("torque_N_m", "viscous_N_m_s"))
    fan = value(effects, "outside:fan", "quadratic_N_m_s2")
    poles = value(effects, "outside:magnets", "torque_N_m")

    def force(t, x, v):
        return -stiffness * x * (1.0 + cubic * x**2) - viscous * v - fan * abs(v) * v - poles * math.sin(6.0 * x)

    start = (numbers["release_angle"], numbers["release_spin"])
    x = motion(inertia, force, start, times, 0.05, (lambda t, x, v, z: dry) if dry else None)[0]
    return [x]


FAMILIES = [
    Family("dry_bearing", "bearing_friction", of("bearing_friction", "torque_N_m", 1e-4, "dry")),
    Family("viscous_bearing", "bearing_friction", of("bearing_friction", "viscous_N_m_s", 5e-5, "viscous")),
    Family("hardening_spring", "nonlinear_spring", of("nonlinear_spring", "cubic_1_rad2", 0.01, "turning")),
    Family("softening_spring", "nonlinear_spring", of("nonlinear_spring", "cubic_1_rad2", -0.01, "turning"), 16.0),
]
OUTSIDE = [
    Family("fan", "", of("outside:fan", "quadratic_N_m_s2", 2e-5)),
    Family("magnets", "", of("outside:magnets", "torque_N_m", 2e-4, sign=True)),
]
