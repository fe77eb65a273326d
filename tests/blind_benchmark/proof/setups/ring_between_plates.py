"""A closed elastic ring between two plates: slow, fast, and in two depths. Scene `ring_between_plates`.

A quarter of the inextensible elastica from the side to the top carries half of the load and is symmetric at both ends.
"""
import functools
import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from description import Channel, Description, Effect, Family, Run, Stated, of, rounded, value

SIMULATOR = "scipy"
DRIVES = [((0, 1, 13, 15, 27, 28), (0, 0, 6, 6, 0, 0)),
          ((0, 1, 4, 7, 10, 13, 14), (0, 0, 6, 0, 6, 0, 0)),
          ((0, 1, 9, 17, 29, 33, 34), (0, 0, 4, 2, 8, 8, 8))]
LOADS = np.linspace(0.0, 5.0, 41)  # in B / R^2; 4.0 presses by 0.9 R
DEEPEST = 0.45                     # of R, that the drives press with all numbers at the ends of their intervals
FULL = 0.99                        # of the moment at which the softening law has no stiffness: as far as it is used


def describe(draw):
    radius, thickness = rounded(draw.uniform(0.018, 0.022), 3), rounded(draw.uniform(4.5e-4, 5.5e-4), 3)
    modulus = rounded(draw.uniform(1.8e9, 2.4e9), 3)
    stated = {"radius": Stated(radius, 1e-4), "thickness": Stated(thickness, 5e-6), "width": Stated(0.01, 5e-5),
              "young_modulus": Stated(modulus, rounded(0.1 * modulus, 2)), "density": Stated(1200.0, 0.0),
              "mu": Stated(0.3, 0.0), "plate_gap": Stated(2e-4, 1e-4)}
    runs = [Run(np.arange(0.0, time[-1] + 1e-9, 0.1), drive=(time, tuple(1e-3 * d for d in way)))
            for time, way in DRIVES]
    return Description("ring_between_plates", stated, runs, [Channel("force", "force_N", 0.008, 0.02, 1.0)])


def _bend(moment, knee):
    """Curvature change u for M / B = u / sqrt(1 + (u / knee)^2)."""
    if not knee:
        return moment
    used = min(max(moment, -FULL * knee), FULL * knee)  # straight on beyond it, while the moments are sought
    share = 1.0 - (used / knee)**2
    return used / math.sqrt(share) + (moment - used) / share**1.5


@functools.lru_cache(maxsize=64)
def pressed(knee):
    """(loads, deflections over R) of a ring of radius 1 and B = 1, as far as its law goes. knee: of it, 0: linear."""
    def quarter(moment, load):
        def change(s, y):  # tangent angle, x, y
            return [1.0 + _bend(moment + 0.5 * load * y[1], knee), math.cos(y[0]), math.sin(y[0])]
        return solve_ivp(change, (0.0, 0.5 * math.pi), [0.5 * math.pi, 0.0, 0.0], "DOP853", rtol=1e-9, atol=1e-11).y[:, -1]

    heights, side = [], 0.0
    for load in LOADS:
        side = brentq(lambda m: quarter(m, load)[0] - math.pi, side - 0.2, side + 0.5, xtol=1e-12)
        _, across, height = quarter(side, load)
        if knee and max(abs(side), abs(side + 0.5 * load * across)) > FULL * knee:
            break
        heights.append(height)
    ways = 2.0 * (1.0 - np.array(heights))
    if ways[-1] < DEEPEST:
        raise ValueError("the moment reaches the end of the law before the ring is pressed")
    return LOADS[:len(ways)], ways


def simulate(numbers, run, times, effects):
    radius = numbers["radius"]
    stiffness = numbers["young_modulus"] * numbers["width"] * numbers["thickness"]**3 / 12.0
    knee = value(effects, "nonlinear_elasticity", "uc_1_m") * radius
    loads, ways = pressed(knee)
    load = PchipInterpolator(ways * radius, loads * stiffness / radius**2)
    corners, way = run.drive
    play = value(effects, "backlash", "play_m")
    fall, tau = (value(effects, "softening_over_time", n, off) for n, off in (("drop", 0.0), ("tau_s", 1.0)))
    soft = 1.0 / value(effects, "machine_compliance", "k_N_m", math.inf)
    core, begin = (value(effects, "outside:core", n) for n in ("stiffness_N_m", "begin_m"))
    fine = np.arange(0.0, times[-1] + 5e-3, 5e-3)
    head, at = np.zeros(len(fine)), 0.0
    for i, d in enumerate(np.interp(fine, corners, way)):  # each reversal loses the play, the start does not
        at = min(max(at, d), d + play)
        head[i] = at
    press = np.maximum(head - numbers["plate_gap"], 0.0)
    factor = 1.0 - fall * (1.0 - np.exp(-fine / tau))
    force = factor * load(press) + core * np.maximum(press - begin, 0.0)
    for _ in range(60 if soft else 0):  # head behind the machine's own deflection
        behind = np.maximum(press - soft * force, 0.0)
        force = 0.5 * force + 0.5 * (factor * load(behind) + core * np.maximum(behind - begin, 0.0))
    force = np.interp(fine - value(effects, "sensor_delay", "delay_s"), fine, force)
    drift, time = (value(effects, "sensor_drift", n, off) for n, off in (("a_N", 0.0), ("tau_s", 1.0)))
    thumps, period = (value(effects, "outside:thumps", n, off) for n, off in (("a_N", 0.0), ("period_s", 1.0)))
    beat = np.exp(-0.5 * ((times % period - 0.5 * period) / 0.3)**2) if thumps else 0.0
    return [np.interp(times, fine, force) + drift * (1.0 - np.exp(-times / time)) + thumps * beat]


def _knee(draw):
    return lambda a: Effect("nonlinear_elasticity", {"uc_1_m": rounded(150.0 / math.sqrt(a), 8)}, "softening")


def _soft(draw):
    return lambda a: Effect("machine_compliance", {"k_N_m": 5000.0 / a})


def _drift(draw):
    sign, time = draw.choice((-1.0, 1.0)), draw.uniform(3.0, 15.0)
    return lambda a: Effect("sensor_drift", {"a_N": 0.01 * a * sign, "tau_s": time}, "towards an end")


def _fall(draw):
    time = draw.uniform(4.0, 15.0)
    return lambda a: Effect("softening_over_time", {"drop": min(0.8, 0.02 * a), "tau_s": time}, "exponential")


def _core(draw):
    begin = draw.uniform(2.5e-3, 3.5e-3)
    return lambda a: Effect("outside:core", {"stiffness_N_m": 5.0 * a, "begin_m": begin})


def _thumps(draw):
    period = draw.uniform(4.1, 5.9)
    return lambda a: Effect("outside:thumps", {"a_N": 0.01 * a, "period_s": period})


FAMILIES = [
    Family("softening_moment", "nonlinear_elasticity", _knee, 12.0),
    Family("machine", "machine_compliance", _soft),
    Family("backlash", "backlash", of("backlash", "play_m", 5e-5, "taken up at reversals"), 20.0),
    Family("drift", "sensor_drift", _drift),
    Family("softening", "softening_over_time", _fall, 40.0),
    Family("delay", "sensor_delay", of("sensor_delay", "delay_s", 0.02, "pure")),
]
OUTSIDE = [Family("core", "", _core), Family("thumps", "", _thumps)]
