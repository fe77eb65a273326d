"""Signal of the best possible test for a hidden effect (docs/decisions/0090-detectability.md).

The readings of an effect, in standard deviations of the noise, less what stated numbers, release and zero can absorb.
Their intervals enter as normal priors of the same variance. What is left of a reading counts as 8 standard deviations
at most.
"""
import math

import numpy as np

LARGEST_DEVIATION = 8.0
SMALL = 0.1  # amplitude of an imitation at which its derivatives are taken
FREE = 1e3  # its amplitude in units of a priori standard deviations: nothing holds it
STEP = 0.3  # of a half-width, towards the middle of the interval; the readings are nearly linear in it


class Baseline:
    """The readings without the effect and their derivatives.

    simulate(numbers, effects): readings of all runs and channels behind each other, in units of their noise.
    numbers: {key: true value}; stated: [(key, Stated)]; zeros: one array of units for each zero, in the same order."""

    def __init__(self, simulate, numbers, stated, zeros):
        self.simulate, self.numbers = simulate, numbers
        self.readings = simulate(numbers, [])
        columns, self.keys = list(zeros), [None] * len(zeros)
        self.deviation = {key: number.half / math.sqrt(3.0) for key, number in stated}  # of a number in its interval
        for key, number in stated:
            if number.half == 0.0:
                continue
            step = -STEP if numbers[key] > number.value else STEP
            moved = simulate({**numbers, key: numbers[key] + step * number.half}, [])
            columns.append((moved - self.readings) / step / math.sqrt(3.0))
            self.keys.append(key)
        self.columns = np.array(columns).T

    def sigma(self, effects):
        """Detectability of these effects, in standard deviations of the test's statistic."""
        return self.sigma_of(self.simulate(self.numbers, effects) - self.readings)

    def sigma_of(self, change, without=()):
        """The same of any change of the readings, which these numbers do not absorb. A few readings that differ by much
        more than the limit do not steer what the numbers absorb (Huber's weights)."""
        columns = self.columns[:, [key is None or key not in without for key in self.keys]]
        x, rest = np.zeros(columns.shape[1]), change
        for _ in range(100):
            weighted = columns.T * (LARGEST_DEVIATION / np.maximum(np.abs(rest), LARGEST_DEVIATION))
            before, x = x, np.linalg.solve(weighted @ columns + np.eye(len(x)), weighted @ change)
            rest = change - columns @ x
            if np.abs(x - before).max(initial=0.0) < 1e-3:
                break
        clipped = np.clip(rest, -LARGEST_DEVIATION, LARGEST_DEVIATION)
        return math.sqrt(clipped @ clipped + x @ x)

    def sigma_left(self, wanted, without=(), imitation=None, start=0.0):
        """The same of readings that differ by more than the derivatives reach, such as another frequency: what is left
        of them after the numbers, but for these, have absorbed what they can (Gauss and Newton). imitation(amplitude):
        an effect that absorbs too, at any amplitude; the search begins at `start`."""
        used = [i for i, key in enumerate(self.keys) if key is None or key not in without]
        columns = self.columns[:, used]
        if imitation:
            there = self.simulate(self.numbers, [imitation(start)]) if start else self.readings
            change = self.simulate(self.numbers, [imitation(start + SMALL)]) - there
            columns = np.column_stack([columns, FREE * change / SMALL])

        def left(x):
            numbers, linear = dict(self.numbers), np.zeros_like(self.readings)
            for value, i in zip(x, used):
                if self.keys[i] is None:
                    linear = linear + value * self.columns[:, i]
                else:
                    numbers[self.keys[i]] += value * self.deviation[self.keys[i]]
            effects = [imitation(FREE * x[-1])] if imitation and x[-1] != 0.0 else []
            return wanted - linear - self.simulate(numbers, effects)

        x = np.zeros(columns.shape[1])
        if imitation:
            x[-1] = start / FREE
        rest = left(x)
        cost = rest @ rest
        for _ in range(20):
            normal = columns.T @ columns + np.eye(len(x))
            step = np.linalg.solve(normal, columns.T @ rest - x)
            for share in (1.0, 0.4, 0.15):
                try:
                    following = left(x + share * step)
                except (RuntimeError, ValueError):
                    continue
                lower = following @ following + np.sum((x + share * step)**2)
                if lower < cost:
                    break
            else:
                break
            # The derivatives learn from what the step did (Broyden).
            columns = columns + np.outer(rest - following - share * (columns @ step), step) / (share * (step @ step))
            x, rest, before, cost = x + share * step, following, cost, lower
            if cost > 0.99 * before:
                break
        clipped = np.clip(rest, -LARGEST_DEVIATION, LARGEST_DEVIATION)
        return math.sqrt(clipped @ clipped + x @ x)


def amplitude_for(baseline, effect, wanted, largest, tolerance=0.1):
    """Amplitude at which effect(amplitude) has the wanted detectability; None where no plausible one has."""
    low, high, a, best = 0.0, 0.0, 1.0, None
    for _ in range(12):
        try:
            seen = max(baseline.sigma([effect(a)]), 1e-6)
        except (RuntimeError, ValueError):  # too strong for the simulator
            seen = 1e6
        miss = abs(math.log(seen / wanted))
        if miss < tolerance:
            return a
        if miss < 0.25 and (best is None or miss < best[0]):
            best = (miss, a)
        low, high = (a, high) if seen < wanted else (low, a)
        following = math.sqrt(low * high) if low and high else a * min(10.0, max(0.1, wanted / seen))
        following = min(following, largest)
        if following == a:
            break
        a = following
    return best[1] if best else None


def outside_amplitude(baseline, effect, amplitude, largest, wanted, catalogue):
    """(amplitude, detectability) from an amplitude upwards, at which the effect has the wanted detectability behind the
    numbers and each effect of the catalogue by itself; (None, 0) where no plausible one has. What the catalogue imitates
    is not outside."""
    for _ in range(8):
        try:
            readings, seen = baseline.simulate(baseline.numbers, [effect(amplitude)]), math.inf
            for imitation in (None, *catalogue):
                seen = min(seen, baseline.sigma_left(readings, imitation=imitation))
                if seen < wanted:
                    break
            else:
                return amplitude, seen
        except (RuntimeError, ValueError):  # too strong for the simulator
            break
        if amplitude == largest:
            break
        amplitude = min(largest, amplitude * min(3.0, max(1.2, 1.1 * wanted / seen)))
    return None, 0.0
