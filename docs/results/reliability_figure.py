#!/usr/bin/env python3
"""Writes docs/pictures/diagnosis_reliability.svg from docs/results/proof/reliability.csv."""

import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "proof"))
sys.dont_write_bytecode = True
import print_tables  # noqa: E402  (the bins are those of the printed table)

SIZE, LEFT, TOP = 420, 70, 20
INK, GRID = "#1d2733", "#d5dce3"
COLOURS = {"all blind": "#1f5fa8", "near the limit": "#c2571a"}
FONT = "font-family='DejaVu Sans, Arial, sans-serif'"


def x_of(probability):
    return LEFT + SIZE * probability


def y_of(share):
    return TOP + SIZE * (1.0 - share)


def text(x, y, words, anchor="middle", extra=""):
    return f"<text x='{x:.1f}' y='{y:.1f}' {FONT} font-size='13' fill='{INK}' text-anchor='{anchor}'{extra}>{words}</text>"


def frame(up="share of cases in which it is the hidden effect"):
    out = []
    for tick in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0):
        out.append(f"<line x1='{x_of(tick)}' y1='{y_of(0)}' x2='{x_of(tick)}' y2='{y_of(1)}' stroke='{GRID}'/>")
        out.append(f"<line x1='{x_of(0)}' y1='{y_of(tick)}' x2='{x_of(1)}' y2='{y_of(tick)}' stroke='{GRID}'/>")
        out.append(text(x_of(tick), y_of(0) + 19, f"{tick:.1f}"))
        out.append(text(x_of(0) - 8, y_of(tick) + 4, f"{tick:.1f}", "end"))
    out.append(f"<line x1='{x_of(0)}' y1='{y_of(0)}' x2='{x_of(1)}' y2='{y_of(1)}' stroke='{INK}' "
               "stroke-dasharray='5 4'/>")
    out.append(text(x_of(0.5), y_of(0) + 42, "probability stated for the first label"))
    out.append(text(20, y_of(0.5), up, extra=f" transform='rotate(-90 20 {y_of(0.5)})'"))
    return out


def sets(reliability):
    """Every bin of every set, its area by the number of cases."""
    out = []
    for r in reliability:
        colour = COLOURS["near the limit" if r["set"].startswith("limit") else "all blind"]
        out.append(f"<circle cx='{x_of(float(r['said'])):.1f}' cy='{y_of(float(r['true'])):.1f}' "
                   f"r='{1.6 * int(r['n']) ** 0.5:.1f}' fill='{colour}' fill-opacity='0.16'/>")
    return out


def together(reliability):
    out = []
    for words, names in print_tables.kinds_of(reliability):
        if words not in COLOURS:
            continue
        colour, points = COLOURS[words], []
        for _, said, hits, n in print_tables.bins_of(reliability, names):
            low, high = print_tables.wilson(hits, n)
            x = x_of(said) + (4 if words == "near the limit" else -4)
            points.append((x, y_of(hits / n)))
            out.append(f"<line x1='{x:.1f}' y1='{y_of(low):.1f}' x2='{x:.1f}' y2='{y_of(high):.1f}' stroke='{colour}' "
                       "stroke-width='2'/>")
            out.append(f"<circle cx='{x:.1f}' cy='{y_of(hits / n):.1f}' r='5' fill='{colour}'/>")
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        out.append(f"<polyline points='{line}' fill='none' stroke='{colour}' stroke-width='1.2'/>")
    return out


def legend():
    out, x, y = [], x_of(1) + 24, TOP + 16
    for words, colour in COLOURS.items():
        out.append(f"<circle cx='{x}' cy='{y - 4}' r='5' fill='{colour}'/>")
        out.append(text(x + 12, y, {"all blind": "17 blind sets"}.get(words, "5 sets near the limit"), "start"))
        y += 22
    for words in ("bar: 90 % interval", "pale: one bin of one set,", "area by number of cases",
                  "dashed: calibrated"):
        out.append(text(x - 5, y + 6, words, "start"))
        y += 20
    return out


def write(name, body, beside):
    """A figure in docs/pictures; `beside` the axes is room for words."""
    width, height = LEFT + SIZE + beside, TOP + SIZE + 60
    svg = (f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' width='{width}' height='{height}' "
           "role='img' aria-label='Reliability diagram of the diagnosis'>\n"
           f"<rect width='{width}' height='{height}' fill='white'/>\n" + "\n".join(body) + "\n</svg>\n")
    with open(os.path.join(HERE, "..", "pictures", name), "w", encoding="utf-8") as file:
        file.write(svg)


def main():
    reliability = print_tables.read("reliability.csv")
    write("diagnosis_reliability.svg", frame() + sets(reliability) + together(reliability) + legend(), 220)


if __name__ == "__main__":
    main()
