"""Makes a case: recordings with their description, and the answer that stays apart from them."""
import hashlib
import importlib
import json
import math
import pathlib
import random
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from description import Stated  # noqa: E402
from detectability import Baseline, amplitude_for, outside_amplitude  # noqa: E402

STRENGTHS = {"strong": (40.0, 150.0), "limit": (4.5, 8.0), "below": (0.3, 0.8)}  # sigma, drawn logarithmically
ATTEMPTS = 30


def draw_of(seed, *words):
    """Random numbers that depend on the seed and the words alone."""
    return random.Random(hashlib.sha256(":".join([str(seed), *map(str, words)]).encode()).digest())


def setup(name):
    return importlib.import_module("setups." + name)


class Specimen:
    """A description and a true specimen inside its intervals, with the noise of its sensors."""

    def __init__(self, module, draw):
        self.module, self.description = module, module.describe(draw)
        self.numbers = {key: s.value + draw.uniform(-1.0, 1.0) * s.half for key, s in self.description.numbers()}
        self.noise = [c.noise * draw.uniform(0.75, 1.3) for c in self.description.channels]
        self.quantum = [n * draw.uniform(0.2, 1.0) if draw.random() < 0.5 else 0.0 for n in self.noise]
        self.heavy = draw.random() < 0.25
        self.zero = [draw.uniform(-1.0, 1.0) * c.zero for c in self.description.channels]

    def readings(self, numbers, effects, simulate=None):
        """[run][channel] without noise and zero, in the unit of the column."""
        simulate = simulate or self.module.simulate
        out = []
        for i, run in enumerate(self.description.runs):
            own = {name: v for (r, name), v in numbers.items() if r in (None, i)}
            columns = simulate(own, run, run.times, effects)
            out.append([column * c.scale for column, c in zip(columns, self.description.channels)])
        if not all(np.isfinite(column).all() for run in out for column in run):
            raise RuntimeError("the simulation gives no finite readings")
        return out

    def scaled(self, numbers, effects):
        """All readings behind each other, in standard deviations of their noise; for searches, by the cheaper
        simulation of a set-up that has one."""
        quick = getattr(self.module, "simulate_coarsely", None)
        return np.concatenate([column / n for run in self.readings(numbers, effects, quick)
                               for column, n in zip(run, self.noise)])

    def zeros(self):
        """Columns of the free zeros: one a run and channel."""
        out, at = [], 0
        sizes = [(len(run.times), c) for run in self.description.runs for c in range(len(self.noise))]
        total = sum(size for size, _ in sizes)
        for size, c in sizes:
            column = np.zeros(total)
            column[at:at + size] = self.description.channels[c].zero / self.noise[c] / math.sqrt(3.0)
            out.append(column)
            at += size
        return out

    def baseline(self):
        return Baseline(self.scaled, self.numbers, self.description.numbers(), self.zeros())

    def noisy(self, draw, column, c):
        def one():
            if not self.heavy:
                return draw.gauss(0.0, 1.0)
            chi = sum(draw.gauss(0.0, 1.0)**2 for _ in range(5)) / 5.0  # Student's t, five degrees, unit variance
            return draw.gauss(0.0, 1.0) / math.sqrt(chi) * math.sqrt(3.0 / 5.0)
        out = [v + self.zero[c] + self.noise[c] * one() for v in column]
        q = self.quantum[c]
        return [q * round(v / q) for v in out] if q else out


def another_specimen(draw, specimen):
    """Moves one or two stated numbers of the specimen three to six half-widths away from what is stated.

    Their names, or None where what lies outside the intervals is not as strong as a strong effect: all other numbers
    may absorb it."""
    free = [key for key, s in specimen.description.numbers() if s.half > 0.0 and key[0] is None]
    stated = dict(specimen.description.numbers())
    moved = draw.sample(free, min(len(free), draw.choice((1, 2))))
    edge = dict(specimen.numbers)
    for key in moved:
        sign, away = draw.choice((-1, 1)), draw.uniform(3.0, 6.0)
        if stated[key].value >= stated[key].half and stated[key].value - away * stated[key].half < 0.0:
            sign = 1  # a number that is positive by nature stays so
        edge[key] = stated[key].value + sign * stated[key].half
        specimen.numbers[key] = stated[key].value + sign * away * stated[key].half
    at_edge = Baseline(specimen.scaled, edge, specimen.description.numbers(), specimen.zeros())
    seen = at_edge.sigma_left(specimen.scaled(specimen.numbers, []), moved)
    return [name for _, name in moved] if seen >= STRENGTHS["strong"][0] else None


def hidden_effects(draw, plan, specimen):
    """([effects], sigma) or None where no plausible amplitude has the wanted strength."""
    if not plan["families"]:
        return [], 0.0
    baseline = specimen.baseline()
    known = {f.name: f for f in [*specimen.module.FAMILIES, *specimen.module.OUTSIDE]}
    parts, effects = [], []
    low, high = STRENGTHS[plan["strength"]]
    for name in plan["families"]:
        make = known[name].draw(draw)
        most = max(low, min(high, known[name].reach))
        wanted = low * math.exp(draw.random() * math.log(most / low))
        amplitude = amplitude_for(baseline, make, wanted, known[name].largest)
        if amplitude is not None and plan["kind"] == "outside":
            amplitude, sigma = outside_amplitude(baseline, make, amplitude, known[name].largest, low,
                                                 [f.draw(draw) for f in [*specimen.module.FAMILIES,
                                                                         *getattr(specimen.module, "IMITATIONS", [])]])
        if amplitude is None:
            return None
        parts.append((make, amplitude))
        effects.append(make(amplitude))
    if plan["kind"] == "pair":  # neither is what the other one imitates
        readings = specimen.scaled(specimen.numbers, effects)
        sigma = min(baseline.sigma_left(readings, imitation=make, start=amplitude) for make, amplitude in parts)
    elif plan["kind"] != "outside":
        sigma = baseline.sigma(effects)
    return (effects, sigma) if 0.8 * low <= sigma <= 2.0 * high else None


def pairs(module):
    """All pairs of effects with two labels."""
    return [[a.name, b.name] for i, a in enumerate(module.FAMILIES) for b in module.FAMILIES[i + 1:] if a.label != b.label]


def described(module, description):
    """experiment.json of a set-up: of a scene, or in a form of its own."""
    return getattr(module, "experiment_of", experiment_of)(description)


def experiment_of(description):
    """experiment.json of a scene."""
    out = {"schema": "rod-recordings/1", "protocol": "scene", "scene": description.scene,
           "scene_parameters": {n: s.json() if s.half else s.value for n, s in description.stated.items()},
           "channels": [{"observe": c.observe, "column": c.column, "sign": 1 if c.scale > 0 else -1,
                         "noise_std": c.noise, "zero": {"value": 0, "unc": c.zero}} for c in description.channels],
           **description.extra, "runs": []}
    if description.drive:
        out["drive"] = description.drive
    for i, run in enumerate(description.runs):
        entry = {"file": f"run_{i + 1}.csv"}
        if run.parameters:
            entry["parameters"] = {n: s.json() for n, s in run.parameters.items()}
        if run.drive and not description.drive:
            entry["drive_time_s"] = list(run.drive[0])
            entry["drive_displacement_mm"] = [1e3 * d for d in run.drive[1]]
        out["runs"].append(entry)
    return out


def csv_of(run, description, columns):
    names = ["time_s"] + (["displacement_mm"] if run.drive and not description.drive else []) + \
        ([description.drive["column"]] if description.drive else []) + [c.column for c in description.channels]
    lines = [",".join(names)]
    for i, t in enumerate(run.times):
        row = [f"{t:.4f}"]
        if run.drive:
            scale = 1.0 / description.drive["scale"] if description.drive else 1e3
            row.append(f"{scale * np.interp(t, *run.drive):.5f}")
        lines.append(",".join(row + [f"{column[i]:.6g}" for column in columns]))
    return "\n".join(lines) + "\n"


def stand_ins(plan, module, seed):
    """The plan, then the same with each other effect or pair of its kind, for the seed may draw one that no specimen
    shows."""
    yield plan
    if not plan["families"]:
        return
    own = plan["families"]
    if plan["kind"] == "pair":
        others = [pair for pair in pairs(module) if pair != own]
    else:
        others = [[f.name] for f in (module.OUTSIDE if plan["kind"] == "outside" else module.FAMILIES) if [f.name] != own]
    draw_of(seed, plan["name"], "stand-ins").shuffle(others)
    yield from ({**plan, "families": names, "instead_of": "+".join(own)} for names in others)


def make_case(plan, seed, distance=False):
    """({file name: text}, answer) of a planned case. distance: also the readings without noise, in the answer."""
    module = setup(plan["set_up"])
    why = None
    for other in stand_ins(plan, module, seed):
        try:
            return shown(other, module, seed, distance)
        except RuntimeError as one:
            why = why or one
    raise why


def shown(plan, module, seed, distance):
    """The case with the effects of the plan, on the first specimen that shows them."""
    for attempt in range(ATTEMPTS):
        draw = draw_of(seed, plan["name"], attempt)
        try:
            specimen = Specimen(module, draw)
            drawn = hidden_effects(draw, plan, specimen)
            if drawn is None:
                continue
            effects, sigma = drawn
            moved = another_specimen(draw, specimen) if plan["kind"] == "swap" else []
            if moved is None:
                continue
            if hasattr(module, "unsure") and module.unsure(specimen, effects):
                continue
            clean = specimen.readings(specimen.numbers, effects)
        except (RuntimeError, ValueError):  # too strong for the simulator
            continue
        break
    else:
        raise RuntimeError(f"{plan['name']}: no specimen shows {plan['families']} with the wanted strength")
    description = specimen.description
    files = {"experiment.json": json.dumps(described(module, description), indent=1) + "\n"}
    squares, rows = [0.0] * len(specimen.noise), [0] * len(specimen.noise)
    for i, run in enumerate(description.runs):
        columns = []
        for c, column in enumerate(clean[i]):
            noisy, zero = specimen.noisy(draw, column, c), specimen.zero[c]
            if hasattr(module, "zeroed"):
                noisy, zero = module.zeroed(run.times, noisy), 0.0
            squares[c] += sum((a - b - zero)**2 for a, b in zip(noisy, column))
            rows[c] += len(noisy)
            columns.append(noisy)
        files[f"run_{i + 1}.csv"] = csv_of(run, description, columns)
    answer = {**plan, "simulator": module.SIMULATOR, "attempt": attempt, "sigma": sigma, "moved": moved,
              "effects": [{"label": e.label, "variant": e.variant, "parameters": e.parameters} for e in effects],
              "noise_rms": [math.sqrt(s / n) for s, n in zip(squares, rows)],
              "true_parameters": {(n if r is None else f"{n}_run{r + 1}"): v
                                  for (r, n), v in specimen.numbers.items()}}
    if distance:
        answer["clean"] = [[list(map(float, column)) for column in run] for run in clean]
    return files, answer
