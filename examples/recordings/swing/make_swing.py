#!/usr/bin/env python3
"""Makes the recordings of the tutorial "a recording diagnosed": three free swings of a rod, as a camera sees them.

    make_swing.py FOLDER

The equation is integrated here by the classical Runge-Kutta method; nothing of Supercircle is used. What the tutorial's
description leaves out stands in `moment`.
"""
import pathlib
import random
import sys
from math import cos, degrees, radians, sin

LENGTH, MASS, GRAVITY = 0.302, 0.0518, 9.81  # m, kg, m/s^2
INERTIA = MASS * LENGTH**2 / 3
RATE, NOISE_DEG = 20.0, 0.15  # Hz, and the camera's noise


def moment(angle, spin):
    """N m around the hinge."""
    weight = -MASS * GRAVITY * LENGTH / 2 * sin(angle)
    return weight - 1.1e-4 * spin * abs(spin)  # hidden: drag of the air, proportional to the square of the speed


def rates(angle, spin):
    return spin, moment(angle, spin) / INERTIA


def swing(release, seconds, steps=40):
    angle, spin, h = radians(release), 0.0, 1.0 / (RATE * steps)
    rows = []
    for i in range(int(seconds * RATE * steps) + 1):
        if i % steps == 0:
            rows.append((i * h, degrees(angle)))
        k1 = rates(angle, spin)
        k2 = rates(angle + h / 2 * k1[0], spin + h / 2 * k1[1])
        k3 = rates(angle + h / 2 * k2[0], spin + h / 2 * k2[1])
        k4 = rates(angle + h * k3[0], spin + h * k3[1])
        angle += h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        spin += h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    return rows


folder, noise = pathlib.Path(sys.argv[1]), random.Random(7)
for name, release in (("swing_1", 62.0), ("swing_2", 36.0), ("swing_3", 61.0)):
    lines = ["time_s,angle_deg"] + [f"{t:.4f},{a + noise.gauss(0, NOISE_DEG):.2f}" for t, a in swing(release, 4.0)]
    (folder / f"{name}.csv").write_text("\n".join(lines) + "\n")
