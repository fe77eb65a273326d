#!/usr/bin/env python3
"""Writes docs/pictures/SET_reliability.svg from docs/results/proof/SET.csv, of every set of ./prove.sh."""

import glob
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.join(HERE, "..", "..")
sys.path[:0] = [HERE, os.path.join(TOP, "tests", "blind_benchmark", "proof")]
sys.dont_write_bytecode = True
import print_page  # noqa: E402  (the bins are those of the printed table)
import reliability_figure as axes  # noqa: E402
import scoring  # noqa: E402

COLOUR = axes.COLOURS["all blind"]


def points(rows):
    """(mean probability, cases whose group holds the truth, cases) of each bin: single effects, strong and near the limit."""
    chosen = [r for r in rows if r["kind"] in ("single", "limit") and r["p_group"] != "" and r["first"]]
    for low, high in print_page.BINS:
        of = [r for r in chosen if low <= float(r["p_group"]) < high]
        if of:
            yield (sum(float(r["p_group"]) for r in of) / len(of),
                   sum(r["hidden"] in r["group"].split("|") for r in of), len(of))


def draw(table):
    _, rows = print_page.read(table)
    out = axes.frame("share of cases in which its group holds the hidden effect")
    for said, hits, n in points(rows):
        low, high = scoring.wilson(hits, n)
        x, y = axes.x_of(said), axes.y_of(hits / n)
        out.append(f"<line x1='{x:.1f}' y1='{axes.y_of(low):.1f}' x2='{x:.1f}' y2='{axes.y_of(high):.1f}' "
                   f"stroke='{COLOUR}' stroke-width='2'/>")
        out.append(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='5' fill='{COLOUR}'/>")
        out.append(axes.text(x - 9, y + 16, f"{hits} of {n}", "end"))
    y = axes.TOP + 22
    for words in ("bar: 90 % interval", "dashed: calibrated"):
        out.append(axes.text(axes.x_of(1) + 19, y, words, "start"))
        y += 20
    axes.write(os.path.basename(table)[:-len(".csv")] + "_reliability.svg", out, 160)


def main():
    for table in sorted(glob.glob(os.path.join(HERE, "proof", "proof_[0-9].csv"))):
        draw(table)


if __name__ == "__main__":
    main()
