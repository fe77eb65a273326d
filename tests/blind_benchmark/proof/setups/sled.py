"""A sled that a machine pulls by a spring: slow, fast, with a dwell and back. Scene `sled`."""
import bisect
import math

import numpy as np

from description import Channel, Description, Effect, Family, Run, Stated, of, rounded, value
from motion import motion

SIMULATOR = "scipy"
DRIVES = [((0, 1, 13, 14), (0, 0, 12, 12)),                              # s, mm: slow
          ((0, 1, 4, 5), (0, 0, 15, 15)),                                # fast
          ((0, 1, 4, 8, 11, 12, 15, 16), (0, 0, 6, 6, 12, 12, 6, 6))]    # a dwell, and back


def describe(draw):
    normal, mu = rounded(draw.uniform(1.5, 3.0), 3), rounded(draw.uniform(0.2, 0.4), 2)
    stiffness = rounded(draw.uniform(400, 700), 3)
    stated = {"mass": Stated(0.2, 0.01), "normal_force": Stated(normal, 0.0), "mu": Stated(mu, rounded(0.1 * mu, 2)),
              "stiffness": Stated(stiffness, rounded(0.03 * stiffness, 2)), "viscosity": Stated(15.0, 3.0)}
    # No row lies at a corner of the drive, where the damper of the spring has two forces.
    runs = [Run(np.arange(0.025, time[-1], 0.05), drive=(time, tuple(1e-3 * d for d in way)))
            for time, way in DRIVES]
    return Description("sled", stated, runs, [Channel("force", "force_N", 0.004, 0.01, 1.0)])


def simulate(numbers, run, times, effects):
    corners, way = run.drive
    at = lambda t: float(np.interp(t, corners, way))
    speeds = [(b - a) / (u - t) for a, b, t, u in zip(way, way[1:], corners, corners[1:])]
    speed = lambda t: speeds[min(bisect.bisect_right(corners, t), len(speeds)) - 1]  # at a corner what follows
    stiffness, viscosity, normal = (numbers[n] for n in ("stiffness", "viscosity", "normal_force"))
    ratio, slip, heal = (value(effects, "static_friction_excess", n, off) for n, off in
                         (("mu_s_over_mu_k", 1.0), ("Dc_m", 1.0), ("tau_heal_s", 1.0)))
    strength, scale = (value(effects, "rate_dependent_friction", n, off) for n, off in
                       (("strength", 0.0), ("speed_m_s", 1.0)))
    logarithmic = any(e.variant == "logarithmic" for e in effects)
    change, distance = (value(effects, "wear", n, off) for n, off in (("change", 0.0), ("distance_m", 1.0)))
    waves, pitch = (value(effects, "outside:wavy_track", n, off) for n, off in (("share", 0.0), ("pitch_m", 1.0)))

    def force(t, x, v):
        return stiffness * (at(t) - x) + viscosity * (speed(t) - v)

    def dry(t, x, v, z):  # z: state of rest (1 after a long one), way slid
        fast = math.log1p(abs(v) / scale) if logarithmic else 1.0 - math.exp(-abs(v) / scale)
        factor = (1.0 + (ratio - 1.0) * z[0]) * (1.0 + strength * fast) * \
            (1.0 + change * (1.0 - math.exp(-z[1] / distance)))
        return numbers["mu"] * normal * factor * (1.0 + waves * math.sin(2.0 * math.pi * x / pitch))

    def rate(v, z):
        return np.array([(1.0 - z[0]) / heal - z[0] * abs(v) / slip, abs(v)])

    x, v = motion(numbers["mass"], force, (0.0, 0.0), times, 0.05, dry, (1.0, 0.0), rate, corners)[:2]
    reading = np.array([force(t, *y) for t, y in zip(times, zip(x, v))])
    reading = reading * (1.0 + value(effects, "sensor_gain", "error"))
    drift, time = (value(effects, "sensor_drift", n, off) for n, off in (("a_N", 0.0), ("tau_s", 1.0)))
    thumps, period = (value(effects, "outside:thumps", n, off) for n, off in (("a_N", 0.0), ("period_s", 1.0)))
    beat = np.exp(-0.5 * ((times % period - 0.5 * period) / 0.15)**2) if thumps else 0.0
    return [reading + drift * (1.0 - np.exp(-times / time)) + thumps * beat]


def _static(draw):
    slip, heal = math.exp(draw.uniform(math.log(2e-4), math.log(1e-3))), draw.uniform(1.0, 4.0)
    return lambda a: Effect("static_friction_excess",
                            {"mu_s_over_mu_k": 1.0 + 0.1 * a, "Dc_m": slip, "tau_heal_s": heal})


def _rate(law):
    def draw(random):
        speed = math.exp(random.uniform(math.log(5e-4), math.log(2e-3)))
        return lambda a: Effect("rate_dependent_friction", {"strength": 0.03 * a, "speed_m_s": speed}, law)
    return draw


def _wear(draw):
    sign, distance = draw.choice((-1.0, 1.0)), draw.uniform(3e-3, 1e-2)
    return lambda a: Effect("wear", {"change": max(-0.9, 0.05 * a * sign), "distance_m": distance})


def _drift(draw):
    sign, time = draw.choice((-1.0, 1.0)), draw.uniform(2.0, 8.0)
    return lambda a: Effect("sensor_drift", {"a_N": 0.01 * a * sign, "tau_s": time})


def _wavy(draw):
    pitch = draw.uniform(2e-3, 4e-3)
    return lambda a: Effect("outside:wavy_track", {"share": min(0.6, 0.02 * a), "pitch_m": pitch})


def _thumps(draw):
    period = draw.uniform(2.6, 3.7)
    return lambda a: Effect("outside:thumps", {"a_N": 0.01 * a, "period_s": period})


FAMILIES = [
    Family("static_friction", "static_friction_excess", _static, 20.0),
    Family("stribeck", "rate_dependent_friction", _rate("Stribeck"), 20.0),
    Family("logarithmic_friction", "rate_dependent_friction", _rate("logarithmic"), 20.0),
    Family("wear", "wear", _wear, 18.0),
    Family("drift", "sensor_drift", _drift),
]
OUTSIDE = [Family("wavy_track", "", _wavy, 30.0), Family("thumps", "", _thumps)]
