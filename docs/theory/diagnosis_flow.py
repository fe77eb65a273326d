#!/usr/bin/env python3
"""Writes docs/pictures/diagnosis_flow.svg, the flow chart of docs/theory/diagnosis.md."""

import html
import os

WIDTH, HEIGHT = 960, 1000
INK, LINE, STEP, TEST, RESULT = "#1d2733", "#5b6b7c", "#e8f0f8", "#fdf3dc", "#e6f4e6"
FONT = "font-family='DejaVu Sans, Arial, sans-serif'"

parts = []


def text(x, y, words, size=14, bold=False, colour=INK, anchor="middle"):
    weight = " font-weight='bold'" if bold else ""
    parts.append(f"<text x='{x}' y='{y}' {FONT} font-size='{size}' fill='{colour}' text-anchor='{anchor}'{weight}>"
                 f"{html.escape(words)}</text>")


def lines(x, y, title, detail):
    """A title and lines below it, centred on (x, y)."""
    top = y - 8.5 * len(detail) + 5
    text(x, top, title, 15, True)
    for i, words in enumerate(detail):
        text(x, top + 18 + 17 * i, words, 12.5)


def box(x, y, w, h, title, detail, fill=STEP):
    parts.append(f"<rect x='{x - w / 2}' y='{y - h / 2}' width='{w}' height='{h}' rx='7' fill='{fill}' "
                 f"stroke='{LINE}' stroke-width='1.3'/>")
    lines(x, y, title, detail)


def diamond(x, y, w, h, title, detail):
    points = f"{x},{y - h / 2} {x + w / 2},{y} {x},{y + h / 2} {x - w / 2},{y}"
    parts.append(f"<polygon points='{points}' fill='{TEST}' stroke='{LINE}' stroke-width='1.3'/>")
    lines(x, y, title, detail)


def arrow(*points, label=None, at=None, anchor="start"):
    """A line through the points with a head at the last one."""
    parts.append(f"<polyline points='{' '.join(f'{x},{y}' for x, y in points)}' fill='none' stroke='{LINE}' "
                 "stroke-width='1.6'/>")
    (x0, y0), (x1, y1) = points[-2], points[-1]
    length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
    ux, uy = (x1 - x0) / length, (y1 - y0) / length
    head = [(x1, y1), (x1 - 10 * ux - 5 * uy, y1 - 10 * uy + 5 * ux), (x1 - 10 * ux + 5 * uy, y1 - 10 * uy - 5 * ux)]
    parts.append(f"<polygon points='{' '.join(f'{x:.1f},{y:.1f}' for x, y in head)}' fill='{LINE}'/>")
    if label:
        text(at[0], at[1], label, 12.5, False, LINE, anchor)


def draw():
    middle, right, left = 400, 800, 130
    box(middle, 42, 440, 56, "Recordings and description", ["readings, drive, stated values with half-widths"], RESULT)
    arrow((middle, 70), (middle, 92))
    box(middle, 126, 440, 68, "Noise", ["white + AR(1) from rests, scatter from repeats,",
                                        "error of the simulator from a finer mesh"])
    arrow((middle, 160), (middle, 182))
    box(middle, 216, 440, 68, "Baseline fit", ["stated parameters inside their intervals,",
                                               "whitened least squares, several starts"])
    arrow((middle, 250), (middle, 272))
    box(middle, 314, 440, 84, "Screening and localisation",
        ["signature of every effect at finite amplitudes;", "windows and signatures, max-T, family-wise p;",
         "detectable strength of every effect"])
    arrow((middle, 356), (middle, 378))
    diamond(middle, 432, 350, 108, "Baseline doubtful?", ["marginal misfit, or fit", "held at a branch edge"])
    arrow((middle - 175, 432), (left, 432), (left, 216), (middle - 220, 216))
    text(left + 6, 423, "yes: more starts", 11.5, False, LINE, "start")
    arrow((middle, 486), (middle, 512), label="no", at=(middle + 10, 503))
    box(middle, 554, 440, 84, "Fits of single effects",
        ["up to six labels with gain > 8, two starts each;", "each scored on runs that were left out",
         "(log predictive density)"])
    arrow((middle, 596), (middle, 618))
    diamond(middle, 672, 350, 108, "Residual left?", ["significant after the", "best effect, p <= 0.01"])
    arrow((middle + 175, 672), (right - 135, 672), label="yes", at=(middle + 185, 664))
    box(right, 640, 270, 118, "Wider hypotheses",
        ["other forms of the best laws,", "two effects together, learned laws;", "each must beat its parts",
         "on held-out runs"])
    arrow((right, 699), (right, 784), (middle + 220, 784))
    arrow((middle, 726), (middle, 750), label="no", at=(middle + 10, 742))
    box(middle, 784, 440, 68, "Model weights", ["pseudo-BMA, Bayesian bootstrap over strokes,",
                                                "evidence bounded by the family-wise p"])
    arrow((middle, 818), (middle, 840))
    box(middle, 880, 440, 80, "Verdict, intervals",
        ["adequate, identified, ambiguous,", "outside the catalogue, inconclusive;", "profile likelihood intervals"],
        RESULT)
    arrow((middle + 220, 880), (right - 95, 880), label="still open", at=(middle + 226, 872))
    box(right + 20, 880, 230, 80, "Next experiment", ["the runs that separate the", "competing hypotheses best"],
        RESULT)
    arrow((right + 20, 920), (right + 20, 970), (60, 970), (60, 42), (middle - 220, 42))
    text(right, 962, "make it and diagnose again", 12.5, False, LINE, "end")


def main():
    draw()
    svg = (f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' width='{WIDTH}' height='{HEIGHT}' "
           "role='img' aria-label='Flow chart of the diagnosis'>\n"
           f"<rect width='{WIDTH}' height='{HEIGHT}' fill='white'/>\n" + "\n".join(parts) + "\n</svg>\n")
    out = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "pictures", "diagnosis_flow.svg")
    with open(out, "w", encoding="utf-8") as file:
        file.write(svg)


if __name__ == "__main__":
    main()
