#!/usr/bin/env python3
"""Writes docs/pictures/order.svg: error of a swinging, spinning, falling shell over the steps of a period.

order_figure.py [PROGRAM]: PROGRAM is build/tests/test_step, which computes the errors.
"""

import csv
import os
import subprocess
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

TOP = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")


def table(program):
    """(steps a period, error of second order, of first order), of R."""
    out = subprocess.run([program, "[.order]"], check=True, capture_output=True, text=True).stdout.splitlines()
    start = next(i for i, line in enumerate(out) if line.startswith("steps_a_period"))
    rows = [line for line in out[start + 1:] if line[:1].isdigit()]
    return [tuple(float(x) for x in row) for row in csv.reader(rows)]


def main():
    rows = table(sys.argv[1] if len(sys.argv) > 1 else os.path.join(TOP, "build", "tests", "test_step"))
    steps = [r[0] for r in rows]
    plt.rcParams.update({"svg.hashsalt": "order", "font.size": 11, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(figsize=(6.4, 4.2))
    for column, name, colour, order in ((2, "ordinary step", "#b3541e", 0), (1, "free motion", "#1f5fa8", 2)):
        errors = [r[column] for r in rows]
        axes.loglog(steps, errors, "o-", color=colour, label=name)
        if order:
            guide = [errors[-1] * (steps[-1] / s) ** order for s in steps]
            axes.loglog(steps, guide, ":", color=colour, label=f"order {order}")
    axes.set_ylim(1e-8, 10)
    axes.set_xlabel("steps a period")
    axes.set_ylabel("error of the tip after half a period / R")
    axes.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(os.path.join(TOP, "docs", "pictures", "order.svg"), metadata={"Date": None})


if __name__ == "__main__":
    main()
