"""Made by bridge/python/generate.py from bridge/c/api.json: do not edit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Frame:
    """What a step did.

    advanced: s; less than dt if out of budget or failed
    work: in units of sc_world_set_frame_budget
    injected: by closing gaps, J
    energy_gained: alarm: energy that nobody gave, J
    steps: inner steps of all islands
    unconverged: of them above the contact tolerance
    budget_exhausted: the rest of dt was left out
    quarantined: shells in quarantine
    left_out: bodies or gravity with numbers that are not finite were left out
    """

    advanced: float
    work: float
    injected: float
    energy_gained: float
    steps: int
    unconverged: int
    budget_exhausted: bool
    quarantined: int
    left_out: bool


@dataclass(frozen=True, eq=False)
class Energy:
    """Energy balance of a world since it was made.

    kinetic: of the shells, J
    bending: elastic, of the shells, J
    gravity: potential, of the shells, J
    added: by creating, destroying, moving and changing shells, J
    work: by holds, joints, forces and driven bodies, J
    friction: dissipated, J
    impact: dissipated, J
    numerical: dissipated by the time integration, J
    position_correction: added by correcting penetrations and gaps, J
    injected: part of position_correction that closing gaps brought in, J
    effects: dissipated, J
    damping: dissipated by damping_ratio, J
    to_bodies: passed to dynamic bodies, J
    residual: what the terms leave unexplained, J
    """

    kinetic: float
    bending: float
    gravity: float
    added: float
    work: float
    friction: float
    impact: float
    numerical: float
    position_correction: float
    injected: float
    effects: float
    damping: float
    to_bodies: float
    residual: float


@dataclass(frozen=True, eq=False)
class Sleep:
    """When shells at rest fall asleep.

    automatic: shells at rest fall asleep with the bodies on them
    drift: largest displacement within `delay`, in thicknesses, 1
    delay: s
    """

    automatic: bool
    drift: float
    delay: float


@dataclass(frozen=True, eq=False)
class Recovery:
    """What becomes of quarantined shells.

    release: a quarantined shell moves again after a time
    after: s
    """

    release: bool
    after: float


@dataclass(frozen=True, eq=False)
class ShellState:
    """A shell as a whole.

    length: m
    mass: kg
    centre: of mass, m, x and y, shape (2,)
    momentum: kg m/s, x and y, shape (2,)
    angular_momentum: about the centre of mass, kg m^2/s
    kinetic: J
    stored: elastic, J
    max_strain: at the surface, 1
    lower: of the box around it, m, x and y, shape (2,)
    upper: m, x and y, shape (2,)
    quarantined: whether it is
    asleep: whether it is
    """

    length: float
    mass: float
    centre: NDArray[np.float64]
    momentum: NDArray[np.float64]
    angular_momentum: float
    kinetic: float
    stored: float
    max_strain: float
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    quarantined: bool
    asleep: bool


@dataclass(frozen=True, eq=False)
class Section:
    """One place of a shell.

    position: of the centre line, m, x and y, shape (2,)
    tangent: unit vector towards the last end, x and y, shape (2,)
    angle: of the tangent, continuous along the shell, rad
    velocity: m/s, x and y, shape (2,)
    spin: rad/s
    curvature: 1/m
    natural_curvature: 1/m
    moment: bending moment, N m
    strain: largest over the thickness, 1
    energy_density: J/m
    """

    position: NDArray[np.float64]
    tangent: NDArray[np.float64]
    angle: float
    velocity: NDArray[np.float64]
    spin: float
    curvature: float
    natural_curvature: float
    moment: float
    strain: float
    energy_density: float


@dataclass(frozen=True, eq=False)
class Filter:
    """Collision filter, as in Box2D.

    category: 16 bits
    mask: 16 bits
    group: 16 bits
    """

    category: int
    mask: int
    group: int


@dataclass(frozen=True, eq=False)
class Target:
    """Where a hold or the end of a tether goes.

    position: m, x and y, shape (2,)
    angle: rad, not modulo 2 pi; clamps only
    velocity: at and after the end of the frame, m/s, x and y, shape (2,)
    spin: rad/s; clamps only
    """

    position: NDArray[np.float64]
    angle: float
    velocity: NDArray[np.float64]
    spin: float


@dataclass(frozen=True, eq=False)
class Reaction:
    """Force and torque of a hold or joint.

    force: on the shell, N, x and y, shape (2,)
    torque: on the shell's section, N m
    """

    force: NDArray[np.float64]
    torque: float


@dataclass(frozen=True, eq=False)
class EventSettings:
    """What counts as an event.

    impulse_threshold: N s; infinite: no impulse events
    snap_energy: least energy released, in B / L, 1
    snap_time: in L^2 sqrt(lambda / B), 1
    """

    impulse_threshold: float
    snap_energy: float
    snap_time: float


@dataclass(frozen=True, eq=False)
class BodyState:
    """A rigid body.

    centre: of mass, m, x and y, shape (2,)
    angle: rad
    velocity: m/s, x and y, shape (2,)
    spin: rad/s
    mass: kg; 0: does not yield
    inertia: about the centre of mass, kg m^2
    type: SC_BODY_...
    awake: whether it is
    """

    centre: NDArray[np.float64]
    angle: float
    velocity: NDArray[np.float64]
    spin: float
    mass: float
    inertia: float
    type: int
    awake: bool
