"""A clamped strip that is pulled down at its end and released. Scene `cantilever_vibration`.

A beam of cubic Hermite elements (O. C. Zienkiewicz, The Finite Element Method) at deflections below 1 % of its length,
integrated by scipy.integrate.solve_ivp in its lowest modes.
"""
import functools
import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from description import Channel, Description, Effect, Family, Run, Stated, of, rounded, value

SIMULATOR = "scipy"
ELEMENTS, MODES = 16, 4


def describe(draw):
    length, thickness = rounded(draw.uniform(0.4, 0.55), 3), rounded(draw.uniform(8e-4, 1.2e-3), 2)
    stated = {"length": Stated(length, 5e-4), "thickness": Stated(thickness, 1e-5), "width": Stated(0.02, 0.0),
              "young_modulus": Stated(2.0e11, 8e9), "density": Stated(7800.0, 0.0)}
    bend = 2.0e11 * 0.02 * thickness**3 / 12.0
    times = np.arange(0.0, 1.0, 0.004)
    runs = []
    for share in (draw.uniform(0.002, 0.003), draw.uniform(0.005, 0.006), draw.uniform(0.009, 0.01)):
        pull = rounded(3.0 * bend / length**2 * share, 3)
        runs.append(Run(times, {"pull": Stated(pull, rounded(0.03 * pull, 2))}))
    return Description("cantilever_vibration", stated, runs, [Channel("tip_y", "tip_mm", 0.05, 0.1, 1e3)])


@functools.lru_cache(maxsize=1)
def beam():
    """(squared frequencies, deflections of the end) of the modes of a beam of unit length, stiffness and mass."""
    n, h = ELEMENTS, 1.0 / ELEMENTS
    k = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                  [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]) / h**3
    m = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                  [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]) * h / 420
    stiffness, mass = np.zeros((2 * n + 2,) * 2), np.zeros((2 * n + 2,) * 2)
    for e in range(n):
        part = slice(2 * e, 2 * e + 4)
        stiffness[part, part] += k
        mass[part, part] += m
    squares, modes = eigh(stiffness[2:, 2:], mass[2:, 2:], subset_by_index=[0, MODES - 1])
    return squares, modes[-2]


def simulate(numbers, run, times, effects):
    length, line = numbers["length"], numbers["density"] * numbers["width"] * numbers["thickness"]
    bend = numbers["young_modulus"] * numbers["width"] * numbers["thickness"]**3 / 12.0
    squares, end = beam()
    squares, end = squares * bend / (line * length**4), end / math.sqrt(line * length)
    viscous = value(effects, "viscoelastic_bending", "eta_over_B_s")
    branch, tau = (value(effects, "viscoelastic_bending", n, off) for n, off in (("branch_over_B", 0.0), ("tau_s", 1.0)))
    fall, time = (value(effects, "softening_over_time", n, off) for n, off in (("drop", 0.0), ("tau_s", 1.0)))
    pull, reach = (value(effects, "outside:magnet", n, off) for n, off in (("stiffness_N_m", 0.0), ("reach_m", 1.0)))
    stop, gap = (value(effects, "outside:bumper", n) for n in ("stiffness_N_m", "gap_m"))

    def change(t, y):  # deflections of the modes, their speeds, stress of the Maxwell branch
        a, v, s = y.reshape(3, MODES)
        tip = end @ a
        load = -pull * tip / (1.0 + (tip / reach)**2)**2 - stop * max(tip - gap, 0.0)
        soft = 1.0 - fall * (1.0 - math.exp(-t / time))
        return np.concatenate((v, -squares * (soft * a + viscous * v + s) + end * load, branch * v - s / tau))

    start = np.zeros((3, MODES))
    start[0] = -numbers["pull"] * end / squares
    y = solve_ivp(change, (0.0, times[-1]), start.ravel(), "DOP853", rtol=1e-8, atol=1e-11, dense_output=True).sol
    late = np.maximum(times - value(effects, "sensor_delay", "delay_s"), 0.0)
    return [end @ y(late)[:MODES]]


def _relaxation(draw):
    tau = math.exp(draw.uniform(math.log(0.02), math.log(0.2)))
    return lambda a: Effect("viscoelastic_bending", {"branch_over_B": 5e-3 * a, "tau_s": tau}, "standard linear solid")


def _fall(draw):
    time = draw.uniform(0.3, 1.0)
    return lambda a: Effect("softening_over_time", {"drop": min(0.8, 0.01 * a), "tau_s": time}, "exponential")


def _bumper(draw):
    gap = draw.uniform(5e-4, 1e-3)
    return lambda a: Effect("outside:bumper", {"stiffness_N_m": 2.0 * a, "gap_m": gap})


def _magnet(draw):
    """Beside the place of rest: it holds the end there, and lets go of it at a larger deflection."""
    reach = draw.uniform(1e-3, 2e-3)
    return lambda a: Effect("outside:magnet", {"stiffness_N_m": 0.5 * a, "reach_m": reach})


FAMILIES = [
    Family("kelvin_voigt", "viscoelastic_bending",
           of("viscoelastic_bending", "eta_over_B_s", 1e-4, "Kelvin-Voigt")),
    Family("relaxation", "viscoelastic_bending", _relaxation),
    Family("softening", "softening_over_time", _fall, 60.0),
    Family("delay", "sensor_delay", of("sensor_delay", "delay_s", 2e-3, "pure")),
]
OUTSIDE = [Family("magnet", "", _magnet), Family("bumper", "", _bumper)]
