"""Simple rules on the same fits, and a Gaussian process that learns the discrepancy instead of a law."""
import collections
import csv
import math
import warnings

import numpy as np

NOTHING = "nothing"
ROWS = 250  # of the training runs that the process sees: its cost goes with the cube; twice as many change 2 %


def error(of, which):
    """training_rmse or heldout_rmse in the unit of the channel, which ends its key; None where there is none."""
    return next((v for key, v in of.items() if key.startswith(which + "_rmse_")), None)


def smallest(diagnosis, which):
    tried = [e for e in diagnosis["effects"] if (error(e, which) or 0.0) > 0.0]
    best = min(tried, key=lambda e: error(e, which), default=None)
    return best["label"] if best and error(best, which) < error(diagnosis["fit"]["baseline"], which) else NOTHING


def least_training_error(diagnosis, rows):
    return smallest(diagnosis, "training")


def bic(diagnosis, rows):
    """The smallest chi-squared + k ln n; the baseline has k = 0."""
    def gain(effect):
        own = len(effect["parameters"])
        others = [len(e["parameters"]) for e in diagnosis["effects"] if e["label"] in effect["joint_with"]]
        return effect["delta_chi2"] - (own + sum(others[:1])) * math.log(rows)
    best = max(diagnosis["effects"], key=gain, default=None)
    return best["label"] if best and gain(best) > 0.0 else NOTHING


def heldout_error(diagnosis, rows):
    return smallest(diagnosis, "heldout")


RULES = {"training": least_training_error, "bic": bic, "heldout": heldout_error}


def commonest_labels(rows):
    """{set-up: the label that is hidden most often in its single effects}."""
    count = collections.defaultdict(collections.Counter)
    for r in rows:
        if r["kind"] in ("single", "limit"):
            count[r["set_up"]][r["hidden"]] += 1
    return {s: min(c, key=lambda label: (-c[label], label)) for s, c in count.items()}


def right(kind, hidden, label):
    """A rule names one label or nothing. Without an effect, and outside the catalogue, nothing is right or an alarm."""
    if kind in ("control", "below", "swap"):
        return label == NOTHING
    return kind != "outside" and label in hidden.split("|")


def replayed(file):
    """(time, recorded, simulated) of the first channel of a NAME_replay.csv; rows without a reading are left out."""
    with open(file, newline="", encoding="utf-8") as f:
        head, *lines = list(csv.reader(f))
    columns = [next(k for k, name in enumerate(head) if word in name) for word in ("time_s", "recorded", "simulated")]
    cells = [[line[k].strip() for k in columns] for line in lines]
    return np.array([[float(c) for c in row] for row in cells if all(row)]).T


def process_error(replays):
    """Error (rms) of a Gaussian process that forecasts the residual of each run from the other runs.

    replays: CSV files of `supercircle replay --with DIAGNOSIS:nothing`.
    It sees the simulated reading, its rate and the time (C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for
    Machine Learning (2006), chapter 2)."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
    inputs, outputs = [], []
    for file in replays:
        time, recorded, simulated = replayed(file)
        inputs.append(np.column_stack([simulated, np.gradient(simulated, time), time]))
        outputs.append(recorded - simulated)
    if len(inputs) < 2:
        return None
    squares = count = 0.0
    for left in range(len(inputs)):
        x = np.concatenate([a for i, a in enumerate(inputs) if i != left])
        y = np.concatenate([a for i, a in enumerate(outputs) if i != left])
        centre, scale = x.mean(axis=0), x.std(axis=0) + 1e-30
        size = y.std() + 1e-30
        some = np.linspace(0, len(y) - 1, min(ROWS, len(y))).astype(int)
        kernel = ConstantKernel(1.0) * RBF([1.0, 1.0, 1.0], (1e-2, 1e3)) + WhiteKernel(0.1, (1e-4, 10.0))
        process = GaussianProcessRegressor(kernel, normalize_y=False, random_state=0)
        with warnings.catch_warnings():  # an input that does not matter ends at the bound of its length
            warnings.simplefilter("ignore")
            process.fit((x[some] - centre) / scale, y[some] / size)
        forecast = size * process.predict((inputs[left] - centre) / scale)
        squares += float(np.sum((outputs[left] - forecast)**2))
        count += len(forecast)
    return math.sqrt(squares / count)
