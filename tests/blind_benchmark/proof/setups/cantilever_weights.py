"""A clamped strip with weights at its end, loaded and unloaded. Scene `cantilever_weights`.

CalculiX (Debian: calculix-ccx): quadratic plane elements of reduced integration, because full integration stiffens what
bends by 0.3 %; large rotations; one static step a weight. Poisson's
ratio is 0: CalculiX gives plane elements one solid element across the width, which suppresses anticlastic bending.
"""
import math
import os
import pathlib
import subprocess
import tempfile

import numpy as np

from description import Channel, Description, Effect, Family, Run, Stated, of, rounded, value

SIMULATOR = "calculix"
GRAVITY, ELEMENTS, LAYERS = 9.81, 24, 2
READ = (0.0, 1.0, 2.0, 3.0, 4.0)  # s, after a weight is hung; the next one follows after 10 s
PLAN = [(0, 0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, 0.0), (0, 0.25, 0.5, 0.25, 0.0, 0.35, 0.7, 0.9, 0.35, 0.0),
        (0, 0.5, 1.0, 0.5, 0.0, 0.5, 1.0, 0.5, 0.0)]  # shares of the largest weight, a run each


def describe(draw):
    length, thickness = rounded(draw.uniform(0.25, 0.35), 3), rounded(draw.uniform(8e-4, 1.2e-3), 2)
    most = rounded(1.6 * 2.0e11 * 0.02 * thickness**3 / 12.0 / length**2, 2)  # N; the end turns by some 40 degrees
    stated = {"length": Stated(length, 5e-4), "thickness": Stated(thickness, 1e-5), "width": Stated(0.02, 0.0),
              "young_modulus": Stated(2.0e11, 8e9), "density": Stated(7800.0, 0.0),
              "natural_curvature": Stated(0.0, 0.02)}
    runs = []
    for shares in PLAN:
        hung = 10.0 * np.arange(len(shares))
        runs.append(Run(np.add.outer(hung, READ).ravel(), drive=(
            tuple(np.add.outer(hung, (0.0, READ[-1])).ravel()), tuple(round(s * most, 2) for s in shares for _ in (0, 1)))))
    channels = [Channel("tip_y", "deflection_mm", 0.1, 0.2, -1e3), Channel("tip_angle", "angle_deg", 0.05, 0.1, -180 / math.pi)]
    return Description("cantilever_weights", stated, runs, channels,
                       {"parameter": "weight", "column": "weight_N", "scale": 1.0})


def simulate_coarsely(numbers, run, times, effects):
    """The same on a coarser mesh, for the search of an amplitude: sigma of an effect is 1 % smaller to 10 % larger (with
    8 elements, local damage 25 %)."""
    return simulate(numbers, run, times, effects, elements=16, residual=1e-4)


def simulate(numbers, run, times, effects, elements=ELEMENTS, residual=1e-5):
    length, thick, bow = numbers["length"], numbers["thickness"], numbers["natural_curvature"]
    tilt, stop = (value(effects, f"outside:{n}", p) for n, p in (("tilted_string", "tilt_rad"),
                                                                 ("soft_stop", "stiffness_N_m")))
    at, nodes, solids = {}, [], []
    place, long, bend = (value(effects, "natural_curvature_defect", n, off) for n, off in
                         (("arc_fraction", 0.5), ("length_m", 1.0), ("curvature_change_1_m", 0.0)))
    s = np.linspace(0.0, length, 20 * 2 * elements + 1)  # places along the strip without load
    turns = bow * s + bend * np.clip(s - place * length + 0.5 * long, 0.0, long)
    middle = 0.5 * (turns[1:] + turns[:-1])
    line = np.array([np.concatenate(([0.0], np.cumsum(part) * s[1])) for part in (np.cos(middle), np.sin(middle))])
    for i in range(2 * elements + 1):
        for j in range(2 * LAYERS + 1):
            if i % 2 and j % 2:
                continue
            z, turn, (x, y) = thick * (j / (2 * LAYERS) - 0.5), turns[20 * i], line[:, 20 * i]
            at[i, j] = len(nodes) + 1
            nodes.append(f"{at[i, j]}, {x - z * math.sin(turn):.12g}, {y + z * math.cos(turn):.12g}, 0")
    for e in range(elements):
        for k in range(LAYERS):
            a, b = 2 * e, 2 * k
            around = [(a, b), (a + 2, b), (a + 2, b + 2), (a, b + 2), (a + 1, b), (a + 2, b + 1), (a + 1, b + 2), (a, b + 1)]
            solids.append((e, f"{len(solids) + 1}, " + ", ".join(str(at[p]) for p in around)))
    deck = ["*NODE, NSET=ALL", *nodes]
    for e in range(elements):
        deck += [f"*ELEMENT, TYPE=CPS8R, ELSET=E{e}", *(line for own, line in solids if own == e),
                 f"*MATERIAL, NAME=M{e}", *_material(numbers, (e + 0.5) / elements, effects), "*DENSITY",
                 f"{numbers['density']}", f"*SOLID SECTION, ELSET=E{e}, MATERIAL=M{e}", f"{numbers['width']}"]
    tip, end = at[2 * elements, LAYERS], [at[2 * elements, j] for j in (0, 2 * LAYERS)]
    root = ", ".join(str(at[0, j]) for j in range(2 * LAYERS + 1))
    deck += ["*NSET, NSET=ROOT", root, "*NSET, NSET=END", f"{end[0]}, {tip}, {end[1]}", "*BOUNDARY", "ROOT, 1, 2"]
    if stop:  # a spring that begins to resist when the end has sunk by 0.15 of the length; it hangs far above
        far = len(nodes) + 1
        deck[1:1] = [f"{far}, {line[0, -1]:.12g}, 1000., 0."]
        deck += ["*BOUNDARY", f"{far}, 1, 3", "*ELEMENT, TYPE=SPRINGA, ELSET=STOP", f"{len(solids) + 1}, {tip}, {far}",
                 "*SPRING, ELSET=STOP, NONLINEAR", "", f"0., {-length:.9g}", f"0., {0.15 * length:.9g}",
                 f"{stop * 0.85 * length:.9g}, {length:.9g}"]
    weights = np.interp(times, *run.drive)
    changes = np.concatenate(([True], np.diff(weights) != 0.0))
    for weight in weights[changes]:
        # CalculiX stops at residuals of 0.5 % by itself, which moves the end by 0.3 %.
        deck += ["*STEP, NLGEOM, INC=1000", "*STATIC", "0.5, 1., 1e-4, 1.", "*CONTROLS, PARAMETERS=FIELD", f"{residual}, 1e-3", "*CLOAD", f"{tip}, 1, {weight * math.sin(tilt):.12g}",
                 f"{tip}, 2, {-weight * math.cos(tilt):.12g}", "*DLOAD"] + \
            [f"E{e}, GRAV, {GRAVITY}, 0., -1., 0." for e in range(elements)] + \
            ["*NODE PRINT, NSET=END, FREQUENCY=10000", "U", "*END STEP"]
    moved = _run("\n".join(deck) + "\n", int(changes.sum()))[np.cumsum(changes) - 1]
    start = (-thick * math.sin(turns[-1]), thick * math.cos(turns[-1]))
    up = moved[:, end[1]] - moved[:, end[0]] + start
    angle = np.arctan2(-up[:, 0], up[:, 1])
    down, turn = moved[:, tip, 1] + line[1, -1], angle
    if value(effects, "nonlinear_elasticity", "share"):
        more, less = _elastica(numbers, weights, effects), _elastica(numbers, weights, [])
        down, turn = down + more[0] - less[0], turn + more[1] - less[1]
    read = down * (1.0 + value(effects, "sensor_gain", "error"))
    wave, period = (value(effects, "outside:periodic_scale", n, off) for n, off in (("wave_m", 0.0), ("period_m", 1.0)))
    return [read + wave * np.sin(2.0 * math.pi * read / period), turn]


def _elastica(numbers, weights, effects):
    """Deflection and angle of the end of a beam whose curvature grows as u (1 + share (|u| / 3)^(exponent - 1)), with
    u (1/m) that of linear elasticity: what nonlinear elasticity changes. CalculiX has no such law that converges."""
    share, exponent = (value(effects, "nonlinear_elasticity", n, off) for n, off in (("share", 0.0), ("exponent", 2.0)))
    bend = numbers["young_modulus"] * numbers["width"] * numbers["thickness"]**3 / 12.0
    weight = numbers["density"] * numbers["width"] * numbers["thickness"] * GRAVITY  # N/m
    step = numbers["length"] / 80
    ends = []
    for load in np.unique(weights):
        turn = np.zeros(81)  # of the strip, downwards; at nodes
        for _ in range(200):
            x = np.concatenate(([0.0], np.cumsum(np.cos(0.5 * (turn[1:] + turn[:-1]))) * step))
            beyond = np.concatenate((np.cumsum((0.5 * (x[1:] + x[:-1]))[::-1])[::-1], [0.0])) * step  # of x, to the end
            left = step * np.arange(80, -1, -1)
            u = (load * (x[-1] - x) + weight * (beyond - left * x)) / bend
            curvature = u * (1.0 + share * (np.abs(u) / 3.0)**(exponent - 1.0)) - numbers["natural_curvature"]
            before, turn = turn, np.concatenate(([0.0], np.cumsum(0.5 * (curvature[1:] + curvature[:-1])) * step))
            turn = 0.5 * (turn + before)
            if np.abs(turn - before).max() < 1e-10:
                break
        else:
            raise RuntimeError("the beam does not converge")
        ends.append((-step * np.sum(np.sin(0.5 * (turn[1:] + turn[:-1]))), -turn[-1]))
    return np.array(ends)[np.searchsorted(np.unique(weights), weights)].T


def _material(numbers, place, effects):
    """Cards of the material of an element. place: arc fraction."""
    drop, centre, width = (value(effects, "local_damage", n, off) for n, off in
                           (("stiffness_drop", 0.0), ("arc_fraction", 0.5), ("gauss_width_m", 1.0)))
    gradient = value(effects, "stiffness_gradient", "gradient")
    s = (place - centre) * numbers["length"]
    modulus = numbers["young_modulus"] * (1.0 - drop * math.exp(-0.5 * (s / width)**2)) * \
        (1.0 + gradient * (2.0 * place - 1.0))
    stress = value(effects, "plasticity", "yield_stress_Pa")
    if stress:
        return ["*ELASTIC", f"{modulus:.9g}, 0.", "*PLASTIC", f"{stress:.9g}, 0.", f"{stress + 0.3 * modulus:.9g}, 1."]
    return ["*ELASTIC", f"{modulus:.9g}, 0."]


def _run(deck, steps):
    """Displacements [step, node, axis] of the printed nodes."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "strip.inp").write_text(deck)
        try:
            done = subprocess.run(["ccx", "-i", "strip"], cwd=folder, capture_output=True, text=True, timeout=300,
                                  env={**os.environ, "OMP_NUM_THREADS": "1"})
        except subprocess.TimeoutExpired as why:
            raise RuntimeError("CalculiX takes longer than 300 s") from why
        blocks, out = -1, {}
        for line in (path / "strip.dat").read_text().splitlines() if (path / "strip.dat").exists() else []:
            words = line.split()
            if "displacements" in line:
                blocks += 1
            elif len(words) == 4:
                out[blocks, int(words[0])] = [float(w) for w in words[1:3]]
    if done.returncode != 0 or blocks + 1 != steps:
        raise RuntimeError("CalculiX does not converge")
    nodes = max(n for _, n in out) + 1
    moved = np.full((steps, nodes, 2), np.nan)
    for (step, node), u in out.items():
        moved[step, node] = u
    return moved


def _damage(draw):
    place, width = draw.uniform(0.15, 0.4), draw.uniform(0.01, 0.02)
    return lambda a: Effect("local_damage", {"stiffness_drop": min(0.9, 0.1 * a), "arc_fraction": place,
                                             "gauss_width_m": width})


def _gradient(draw):
    sign = draw.choice((-1.0, 1.0))
    return lambda a: Effect("stiffness_gradient", {"gradient": 0.05 * a * sign}, "modulus")


def _plastic(draw):
    return lambda a: Effect("plasticity", {"yield_stress_Pa": 4e8 / (1.0 + 0.3 * a)}, "another law")


def _bend(draw):
    place, length, sign = draw.uniform(0.1, 0.3), draw.uniform(0.015, 0.04), draw.choice((-1.0, 1.0))
    return lambda a: Effect("natural_curvature_defect", {"curvature_change_1_m": sign * a, "arc_fraction": place,
                                                         "length_m": length})


FAMILIES = [
    Family("plasticity", "plasticity", _plastic, 3.0, 60.0),
    Family("bend", "natural_curvature_defect", _bend, 30.0),
    Family("damage", "local_damage", _damage, 9.0),
    Family("gradient", "stiffness_gradient", _gradient, 16.0),
    Family("gain", "sensor_gain", of("sensor_gain", "error", 0.02, sign=True), 10.0),
]
def _scale(draw):
    """A gauge whose reading goes wrong and right again within a part of the way."""
    period = draw.uniform(0.02, 0.05)
    return lambda a: Effect("outside:periodic_scale", {"wave_m": 2e-4 * a, "period_m": period})


def _ramberg_osgood(exponent):
    return lambda draw: lambda a: Effect("nonlinear_elasticity", {"share": 0.1 * a, "exponent": exponent})


# Of the catalogue, but not hidden: a tilted string is what they imitate (two sets called it nonlinear elasticity).
IMITATIONS = [Family(f"nonlinear_{n:g}", "nonlinear_elasticity", _ramberg_osgood(n)) for n in (2.0, 3.0)]
OUTSIDE = [
    Family("tilted_string", "", of("outside:tilted_string", "tilt_rad", 0.05, sign=True), 10.0),
    Family("soft_stop", "", of("outside:soft_stop", "stiffness_N_m", 1.0)),
    Family("periodic_scale", "", _scale),
]
