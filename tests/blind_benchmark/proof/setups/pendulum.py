"""A rod on a bearing, released from rest at three angles. Scene `pendulum`."""
import math

import numpy as np

from description import Channel, Description, Effect, Family, Run, Stated, of, rounded, value
from motion import motion

GRAVITY, DEGREE = 9.81, math.pi / 180.0
SIMULATOR = "scipy"


def describe(draw):
    length = rounded(draw.uniform(0.15, 0.3), 3)
    mass = rounded(0.1 * length, 3)
    stated = {"length": Stated(length, rounded(0.02 * length, 2)), "mass": Stated(mass, 0.0),
              "hub_inertia": Stated(rounded(0.05 * mass * length**2, 2), rounded(0.02 * mass * length**2, 2)),
              "lean": Stated(0.0, 0.01)}
    times = np.arange(0.0, 6.0, 0.02)
    runs = [Run(times, {"release_angle": Stated(rounded(sign * draw.uniform(*span) * DEGREE, 3), 0.02),
                        "release_spin": Stated(0.0, 0.2)})
            for sign, span in ((-1, (40, 60)), (1, (80, 100)), (-1, (120, 140)))]
    return Description("pendulum", stated, runs, [Channel("angle", "angle_deg", 0.1, 0.3, 1.0 / DEGREE)])


def simulate(numbers, run, times, effects):
    length, mass = numbers["length"], numbers["mass"]
    inertia = mass * length**2 / 3.0 + numbers["hub_inertia"]
    gravity = mass * GRAVITY * 0.5 * length
    viscous = value(effects, "bearing_friction", "viscous_N_m_s")
    air = value(effects, "air_drag", "quadratic_N_s2_m3") * length**4 / 4.0  # of a thin rod hinged at its end
    torque, arm = (value(effects, "bearing_friction", n) for n in ("torque_N_m", "arm_m"))
    brake, width = (value(effects, "outside:eddy_brake", n) for n in ("viscous_N_m_s", "width_rad"))
    shake, pulse = (value(effects, "outside:shaken_bearing", n) for n in ("acceleration_m_s2", "pulse_1_s"))

    def force(t, x, v):
        wind = mass * 0.5 * length * math.cos(x) * shake * math.sin(pulse * t)
        sector = brake * math.exp(-0.5 * (x / width)**2) if brake else 0.0
        return -gravity * math.sin(x - numbers["lean"]) - viscous * v - air * abs(v) * v - sector * v - wind

    def dry(t, x, v, z):  # with the load: the reaction of the bearing, weight and inertia of the centre of mass
        spin = force(t, x, v) / inertia
        along = mass * (GRAVITY * math.cos(x) + 0.5 * length * v**2)
        across = mass * (GRAVITY * math.sin(x) + 0.5 * length * spin)
        return torque + arm * math.hypot(along, across)

    start = (numbers["release_angle"], numbers["release_spin"])
    x = motion(inertia, force, start, times, 0.05, dry if torque or arm else None)[0]
    return [x * (1.0 + value(effects, "sensor_gain", "error"))]


def _torque(share):
    return share * 0.02 * GRAVITY * 0.1  # about, of a rod of 0.2 m and 0.02 kg


FAMILIES = [
    Family("dry_bearing", "bearing_friction", of("bearing_friction", "torque_N_m", _torque(0.01), "dry")),
    Family("loaded_bearing", "bearing_friction", of("bearing_friction", "arm_m", 1e-3, "dry, with the load")),
    Family("viscous_bearing", "bearing_friction", of("bearing_friction", "viscous_N_m_s", _torque(0.002), "viscous")),
    Family("quadratic_drag", "air_drag", of("air_drag", "quadratic_N_s2_m3", 0.01, "quadratic")),
    Family("gain", "sensor_gain", of("sensor_gain", "error", 0.02, sign=True), 5.0),
]
OUTSIDE = [
    Family("eddy_brake", "", lambda draw: lambda a: Effect(
        "outside:eddy_brake", {"viscous_N_m_s": a * _torque(0.005), "width_rad": 0.15})),
    Family("shaken_bearing", "", lambda draw: (lambda pulse: lambda a: Effect(
        "outside:shaken_bearing", {"acceleration_m_s2": 0.05 * a, "pulse_1_s": pulse}))(draw.uniform(17.0, 23.0))),
]
