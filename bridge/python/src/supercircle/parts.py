"""What lives in a world: shells, holds, joints, springs, forces, bodies, zones.

All of them are context managers that remove what they stand for, and refuse with StaleError once it is gone.
"""

from __future__ import annotations

import json
from ctypes import byref, c_uint64
from types import TracebackType
from typing import TYPE_CHECKING, Any, Mapping, Sequence, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from . import _api, _convert, records
from ._convert import Floats, Point
from ._loader import core
from .errors import Error

if TYPE_CHECKING:
    from .world import World

Self = TypeVar("Self", bound="Part")
HOLDS = {"pin": _api.SC_HOLD_PIN, "clamp": _api.SC_HOLD_CLAMP}
BASES = {"fixed": _api.SC_BASE_FIXED, "moving": _api.SC_BASE_MOVING}
JOINTS = {"pin": _api.SC_JOINT_PIN, "weld": _api.SC_JOINT_WELD, "tether": _api.SC_JOINT_TETHER}


class Part:
    """Something in a world. Two objects are equal if they stand for the same thing."""

    _kind = ""  # as in the names of its calls

    def __init__(self, world: World, handle: Any) -> None:
        self.world = world
        self._handle = handle

    def _call(self, name: str, *arguments: Any) -> Any:
        return getattr(core(), f"sc_{self._kind}_{name}")(self.world._handle, self._handle, *arguments)

    @property
    def valid(self) -> bool:
        """Whether it still exists."""
        return bool(self._call("valid"))

    def destroy(self) -> None:
        """Removes it from the world."""
        self._call("destroy")

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.valid:
            self.destroy()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Part) and self._kind == other._kind and self._handle.id == other._handle.id

    def __hash__(self) -> int:
        return hash((self._kind, self._handle.id))

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self._handle.id:#x}>"


class Shell(Part):
    """A flexible shell. Places on it are arc fractions from 0 to 1; 0.5 is the middle."""

    _kind = "shell"

    def __repr__(self) -> str:
        try:
            return f"Shell({self.name!r}, centre {np.round(self.state.centre, 6).tolist()} m)"
        except Error:
            return super().__repr__()

    @property
    def name(self) -> str:
        """Its name; may be set."""
        return str(self._call("name"))

    @name.setter
    def name(self, value: str) -> None:
        self._call("set_name", _convert.encoded(value))

    @property
    def state(self) -> records.ShellState:
        """Mass, centre, momentum, energies, strain and box."""
        out = _api.sc_shell_state()
        core().sc_shell_state_of(self.world._handle, self._handle, byref(out))
        return _convert.record(records.ShellState, out)

    def section(self, arc: float) -> records.Section:
        """Position, motion, curvature, moment and strain at a place."""
        out = _api.sc_section()
        self._call("section", arc, byref(out))
        return _convert.record(records.Section, out)

    def polyline(self, tolerance: float = 1e-5) -> Floats:
        """The centre line, m, shape (n, 2); deviates from it by at most `tolerance` (m)."""
        return _convert.points(lambda out, capacity: int(self._call("polyline", tolerance, out, capacity)))

    def curvatures(self) -> Floats:
        """Curvature of each element, 1/m, shape (elements,)."""
        count = int(self._call("curvatures", 1.0, None, None, 0))
        out = np.empty(count)
        self._call("curvatures", 1.0, None, out.ctypes.data, count)
        return out

    def pose(self, alpha: float = 1.0) -> tuple[Floats, float, Floats]:
        """Position (m) and angle (rad) of the first end, and curvatures (1/m), between the start (`alpha` 0) and the
        end (1) of the last step."""
        count = int(self._call("curvatures", alpha, None, None, 0))
        out, end = np.empty(count), _api.sc_target()
        self._call("curvatures", alpha, byref(end), out.ctypes.data, count)
        return _convert.array2(end.position), end.angle, out

    def points(self, count: int = 64) -> Floats:
        """`count` points of the centre line at equal distances along it, m, shape (count, 2)."""
        line = self.polyline(1e-5 * self.state.length)
        along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
        at = np.linspace(0.0, along[-1], count)
        return np.column_stack([np.interp(at, along, line[:, 0]), np.interp(at, along, line[:, 1])])

    def teleport(self, position: Point, angle: float = 0.0) -> None:
        """Moves the middle to a position (m) with its tangent at an angle (rad)."""
        self._call("teleport", _convert.point(position), angle)

    def set_velocity(self, velocity: Point, spin: float = 0.0) -> None:
        """Velocity of the middle (m/s) and spin (rad/s) of a rigid motion."""
        self._call("set_velocity", _convert.point(velocity), spin)

    def set_material(self, *, friction: float = np.nan, young_modulus: float = np.nan, density: float = np.nan,
                     damping_ratio: float = np.nan) -> None:
        """Changes the coefficient of friction (1), Young's modulus (Pa), density (kg/m^3), damping ratio (1)."""
        self._call("set_material", byref(_api.sc_material(friction, young_modulus, density, damping_ratio)))

    def set_natural_curvature(self, curvature: ArrayLike) -> None:
        """1/m, one number for all elements or one each."""
        values = _convert.numbers(curvature)
        self._call("set_natural_curvature", _convert.address(values), values.size)

    def set_friction_material(self, material: int) -> None:
        """0: none. World.set_friction gives the coefficient of two materials."""
        self._call("set_friction_material", material)

    @property
    def filter(self) -> records.Filter:
        """Collision filter."""
        out = _api.sc_filter()
        self._call("filter", byref(out))
        return _convert.record(records.Filter, out)

    def set_filter(self, category: int = 1, mask: int = 0xFFFF, group: int = 0) -> None:
        """Collision filter as in Box2D, 16 bits each."""
        self._call("set_filter", byref(_api.sc_filter(category, mask, group, 0)))

    def set_awake(self, awake: bool = True) -> None:
        """Wakes its island, or puts it to sleep."""
        self._call("set_awake", int(awake))

    @property
    def user_data(self) -> int:
        """A number of yours, 64 bits; may be set."""
        out = c_uint64()
        core().sc_shell_user_data(self.world._handle, self._handle, byref(out))
        return out.value

    @user_data.setter
    def user_data(self, value: int) -> None:
        self._call("set_user_data", value)

    def apply_force(self, arc: float, force: Point, torque: float = 0.0) -> None:
        """Force (N) and torque (N m) during the coming step; several add up."""
        self._call("apply_force", arc, _convert.point(force), torque)

    def apply_impulse(self, arc: float, impulse: Point, angular: float = 0.0) -> None:
        """Impulse (N s) and angular impulse (N m s), at once."""
        self._call("apply_impulse", arc, _convert.point(impulse), angular)

    # effects

    @property
    def effects(self) -> list[dict[str, Any]]:
        """Effects with all their values, as in a scene; may be set."""
        return list(json.loads(self._call("effects")))

    @effects.setter
    def effects(self, effects: Sequence[Mapping[str, Any]]) -> None:
        self._call("set_effects", _convert.json_bytes(list(effects)))

    def set_effect(self, key: str, **values: float) -> None:
        """Switches an effect on or changes it: shell.set_effect("planar_drag", f_N_m=0.2)."""
        self._call("set_effect", _convert.json_bytes({"key": key, **values}))

    def remove_effect(self, key: str) -> None:
        """Removes one effect."""
        self._call("remove_effect", _convert.encoded(key))

    # what is attached to it

    def hold(self, arc: float = 0.5, kind: str = "pin", base: str = "fixed") -> Hold:
        """Holds a place where it is. `kind`: "pin", "clamp" (also its angle); `base`: "fixed", or "moving" with the
        crosshead."""
        out = _api.sc_hold()
        core().sc_hold_create(self.world._handle, self._handle, arc, _convert.choice(kind, HOLDS, "kind"),
                              _convert.choice(base, BASES, "base"), byref(out))
        return Hold(self.world, out)

    def join(self, other: Shell | Body | None = None, *, kind: str = "pin", arc: float = 0.5, other_arc: float = 0.5,
             point: Point = (0.0, 0.0), length: float = 0.0, collide_connected: bool = False) -> Joint:
        """Joins a place with another shell, a body, or the world (None). `kind`: "pin", "weld", "tether".

        other_arc: place on the other shell
        point: of a tether to a body or the world: its other end, m
        length: of a tether, m; 0: the present distance
        """
        definition = _api.sc_joint_def()
        core().sc_joint_def_init(byref(definition))
        definition.kind = _convert.choice(kind, JOINTS, "kind")
        definition.shell = self._handle
        if isinstance(other, Shell):
            definition.other = other._handle
        elif other is not None:
            definition.body = other._handle
        definition.arc_fraction, definition.other_fraction = arc, other_arc
        definition.point, definition.length = _convert.point(point), length
        definition.collide_connected = int(collide_connected)
        out = _api.sc_joint()
        core().sc_joint_create(self.world._handle, byref(definition), byref(out))
        return Joint(self.world, out)

    def grab(self, arc: float, target: Point, *, frequency: float | None = None, damping_ratio: float | None = None,
             max_force: float = 0.0) -> MouseJoint:
        """A soft spring from a place to a target (m). Frequency in Hz; `max_force` (N) 0: mass times 1000 m/s^2."""
        definition = _api.sc_mouse_joint_def()
        core().sc_mouse_joint_def_init(byref(definition))
        definition.arc_fraction, definition.target, definition.max_force = arc, _convert.point(target), max_force
        if frequency is not None:
            definition.frequency = frequency
        if damping_ratio is not None:
            definition.damping_ratio = damping_ratio
        out = _api.sc_mouse_joint()
        core().sc_mouse_joint_create(self.world._handle, self._handle, byref(definition), byref(out))
        return MouseJoint(self.world, out)

    def push(self, arc: float, force: Point, torque: float = 0.0) -> Force:
        """Force (N) and torque (N m) that last until they are changed or destroyed."""
        out = _api.sc_force()
        core().sc_force_create(self.world._handle, self._handle, arc, _convert.point(force), torque, byref(out))
        return Force(self.world, out)

    def closest_point(self, to: Point) -> Hit:
        """The point of its surface closest to a point (m)."""
        return self.world._closest(self._handle, to, np.inf, 0xFFFF)


class Hold(Part):
    """A place of a shell that is fixed or driven."""

    _kind = "hold"

    @property
    def target(self) -> records.Target:
        """Where it is, or goes."""
        out = _api.sc_target()
        self._call("target", byref(out))
        return _convert.record(records.Target, out)

    def set_target(self, position: Point, angle: float = 0.0, velocity: Point = (0.0, 0.0), spin: float = 0.0) -> None:
        """Position (m) and angle (rad, clamps only) at the end of the coming step; velocity (m/s) and spin (rad/s) then."""
        self._call("set_target", byref(_convert.target(position, angle, velocity, spin)))

    @property
    def reaction(self) -> records.Reaction:
        """Force (N) and torque (N m) on the shell, mean over the last step."""
        out = _api.sc_reaction()
        self._call("reaction", byref(out))
        return _convert.reaction(out)

    def set_max_force(self, force: float) -> None:
        """Largest force, N; 0: any. A hold that needed more breaks."""
        self._call("set_max_force", force)


class Joint(Part):
    """A joint of a shell with a shell, a body or the world."""

    _kind = "joint"

    @property
    def target(self) -> records.Target:
        """Of a tether to the world: where it is tied to."""
        out = _api.sc_target()
        self._call("target", byref(out))
        return _convert.record(records.Target, out)

    def set_target(self, position: Point, velocity: Point = (0.0, 0.0)) -> None:
        """Moves the point (m) that a tether to the world is tied to; velocity in m/s."""
        self._call("set_target", byref(_convert.target(position, 0.0, velocity, 0.0)))

    @property
    def length(self) -> float:
        """Present length of a tether, m."""
        return float(self._call("length"))

    def set_max_length(self, length: float, rate: float) -> None:
        """Makes a tether longer or shorter at `rate` (m/s) until it has `length` (m)."""
        self._call("set_max_length", length, rate)

    @property
    def reaction(self) -> records.Reaction:
        """Force (N) and torque (N m) on the shell, mean over the last step."""
        out = _api.sc_reaction()
        self._call("reaction", byref(out))
        return _convert.reaction(out)

    def set_max_force(self, force: float) -> None:
        """Largest force, N; 0: any. A joint that needed more breaks."""
        self._call("set_max_force", force)


class MouseJoint(Part):
    """A soft spring from a shell or body to a target."""

    _kind = "mouse_joint"

    def move(self, target: Point) -> None:
        """Moves the target (m)."""
        self._call("move", _convert.point(target))

    @property
    def reaction(self) -> records.Reaction:
        """Of a grabbed body: force (N) on it, mean over the last step."""
        out = _api.sc_reaction()
        self._call("reaction", byref(out))
        return _convert.reaction(out)


class Force(Part):
    """A lasting force on a shell."""

    _kind = "force"

    def set(self, force: Point, torque: float = 0.0) -> None:
        """N and N m."""
        self._call("set", _convert.point(force), torque)


class Body(Part):
    """A rigid body of Box2D. World.create_body and World.add make bodies."""

    _kind = "body"

    @property
    def state(self) -> records.BodyState:
        """Position, motion, mass."""
        out = _api.sc_body_state()
        core().sc_body_state_of(self.world._handle, self._handle, byref(out))
        return _convert.record(records.BodyState, out)

    def set_pose(self, centre: Point, angle: float = 0.0) -> None:
        """Position of the centre of mass (m) and angle (rad)."""
        self._call("set_pose", _convert.point(centre), angle)

    def set_velocity(self, velocity: Point, spin: float = 0.0) -> None:
        """Velocity of the centre of mass (m/s) and spin (rad/s); wakes it."""
        self._call("set_velocity", _convert.point(velocity), spin)

    def apply_impulse(self, impulse: Point, at: Point) -> None:
        """Impulse (N s) at a point (m); wakes it. Dynamic bodies only."""
        self._call("apply_impulse", _convert.point(impulse), _convert.point(at))

    def outlines(self) -> list[Floats]:
        """Outline of each fixture in the world, m, shape (n, 2); a chain is open. Circles have 32 points."""
        def outline(fixture: int) -> Floats:
            return _convert.points(lambda out, capacity: int(self._call("outline", fixture, out, capacity)))

        return [outline(k) for k in range(int(self._call("fixtures")))]

    def set_friction_material(self, material: int) -> None:
        """0: none. World.set_friction gives the coefficient of two materials."""
        self._call("set_friction_material", material)

    def set_surface_speed(self, speed: float, fixture: int = -1) -> None:
        """A conveyor: speed (m/s) of the surface of a fixture, or of all (-1)."""
        self._call("set_surface_speed", fixture, speed)


class Zone(Part):
    """A box whose shells are watched. Zones are not saved."""

    _kind = "zone"

    @property
    def shells(self) -> list[Shell]:
        """The shells inside at the end of the last step."""
        found = _convert.items(_api.sc_shell, lambda out, capacity: int(self._call("shells", out, capacity)))
        return [Shell(self.world, handle) for handle in found]


class Hit:
    """A point on a shell that a query has found.

    shell: the Shell
    point: on the surface, m, shape (2,)
    normal: unit vector out of the shell, shape (2,)
    fraction: of the ray, 0 to 1
    arc: place on the shell, 0 to 1
    distance: of the given point from the surface, negative inside, m; 0 for rays
    """

    def __init__(self, world: World, hit: _api.sc_hit) -> None:
        self.shell = Shell(world, hit.shell)
        self.point = _convert.array2(hit.point)
        self.normal = _convert.array2(hit.normal)
        self.fraction = hit.fraction
        self.arc = hit.arc_fraction
        self.distance = hit.distance

    def __repr__(self) -> str:
        return f"Hit({self.shell}, point={self.point}, arc={self.arc:.4g}, distance={self.distance:.4g})"
