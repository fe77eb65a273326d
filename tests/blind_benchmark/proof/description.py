"""What a set-up consists of: stated numbers, runs, channels, effects."""
import dataclasses
import math
import random
from typing import Callable

import numpy as np


@dataclasses.dataclass
class Stated:
    """A number of the description: the true one lies within `half` of `value`. SI units."""
    value: float
    half: float

    def json(self):
        return {"value": self.value, "unc": self.half}


@dataclasses.dataclass
class Run:
    times: np.ndarray                                   # s, of the rows
    parameters: dict = dataclasses.field(default_factory=dict)   # name: Stated, of this run
    drive: tuple = ()                                   # break points: times in s, values in m or of the parameter


@dataclasses.dataclass
class Channel:
    observe: str
    column: str
    noise: float                                        # rough standard deviation, in the unit of the column
    zero: float                                         # half-width, in the unit of the column
    scale: float                                        # unit of the column per SI unit, with the sign


@dataclasses.dataclass
class Effect:
    label: str
    parameters: dict                                    # names and units of docs/reference/effects.md
    variant: str = ""                                   # how the diagnosis calls the form of the law


@dataclasses.dataclass
class Description:
    scene: str
    stated: dict                                        # name: Stated, of the whole experiment
    runs: list
    channels: list
    drive: dict = dataclasses.field(default_factory=dict)        # key `drive` of the experiment
    extra: dict = dataclasses.field(default_factory=dict)        # further keys

    def numbers(self):
        """((run or None, name), Stated) of all stated numbers."""
        return [((None, n), s) for n, s in self.stated.items()] + \
            [((i, n), s) for i, run in enumerate(self.runs) for n, s in run.parameters.items()]


@dataclasses.dataclass
class Family:
    """Effects of one kind. `draw` draws the details once and gives the effect at any amplitude, 1 a noticeable one."""
    name: str
    label: str
    draw: Callable[[random.Random], Callable[[float], Effect]]
    largest: float = 50.0
    reach: float = math.inf  # standard deviations that no amplitude exceeds much: the readings saturate


def of(label, name, one, variant="", sign=False):
    """A `draw` for effects whose strength is one parameter. sign: of either sign."""
    def draw(random):
        unit = one * (random.choice((-1.0, 1.0)) if sign else 1.0)
        return lambda a: Effect(label, {name: a * unit}, variant)
    return draw


def value(effects, label, name, off=0.0):
    """A parameter of the effects; `off` where none has it."""
    return next((e.parameters[name] for e in effects if e.label == label and name in e.parameters), off)


def rounded(x, digits=4):
    """x with some significant digits, as a person would state it."""
    return 0.0 if x == 0.0 else round(x, digits - 1 - math.floor(math.log10(abs(x))))
