"""A world with shells and rigid bodies, and scenes played in it."""

from __future__ import annotations

import json
from ctypes import byref, c_int32, string_at
from dataclasses import dataclass, fields
from types import TracebackType
from typing import Any, Mapping, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _api, _convert, _files, records
from ._convert import Floats, Json, Point, SceneSource
from ._loader import core
from .errors import BadInputError, FailedError
from .parts import Body, Force, Hit, Hold, Joint, MouseJoint, Part, Shell, Zone

__all__ = ["World", "Scene", "Event", "Shell", "Hold", "Joint", "MouseJoint", "Force", "Body", "Zone", "Hit", "DrawList", "wav"]
QUALITIES = {"laboratory": _api.SC_QUALITY_LABORATORY, "game": _api.SC_QUALITY_GAME}
CRUSH = {"wait": _api.SC_CRUSH_WAIT, "stop": _api.SC_CRUSH_STOP, "freeze": _api.SC_CRUSH_FREEZE}
EVENTS = {_api.SC_CONTACT_BEGIN: "contact_begin", _api.SC_CONTACT_END: "contact_end", _api.SC_IMPULSE: "impulse",
          _api.SC_SNAP_BEGIN: "snap_begin", _api.SC_SNAP_END: "snap_end", _api.SC_QUARANTINED: "quarantined",
          _api.SC_CRUSHED: "crushed", _api.SC_BROKE: "broke", _api.SC_OVERLAP: "overlap",
          _api.SC_HOLD_BLOCKED: "hold_blocked", _api.SC_ZONE_ENTER: "zone_enter", _api.SC_ZONE_LEAVE: "zone_leave"}
BODIES = {"static": _api.SC_BODY_STATIC, "kinematic": _api.SC_BODY_KINEMATIC, "dynamic": _api.SC_BODY_DYNAMIC}
SHAPES = {"box": _api.SC_SHAPE_BOX, "circle": _api.SC_SHAPE_CIRCLE, "polygon": _api.SC_SHAPE_POLYGON, "line": _api.SC_SHAPE_LINE}
LAYERS = {"bodies": _api.SC_LAYER_BODIES, "shells": _api.SC_LAYER_SHELLS, "strain": _api.SC_LAYER_STRAIN,
          "contacts": _api.SC_LAYER_CONTACTS, "forces": _api.SC_LAYER_FORCES, "holds": _api.SC_LAYER_HOLDS,
          "snaps": _api.SC_LAYER_SNAPS}
P = TypeVar("P", bound=Part)


@dataclass(frozen=True, eq=False)
class Event:
    """Something that happened in the last step; what its kind does not have is None or 0.

    kind: "contact_begin", "contact_end", "impulse", "snap_begin", "snap_end", "quarantined", "crushed", "broke",
        "overlap", "hold_blocked", "zone_enter" or "zone_leave"
    reason: number of the C interface, of "quarantined" and "hold_blocked"
    time: s
    a, b: the shells; `b` is None where the other is a body
    arc_a, arc_b: places on them, 0 to 1
    point: m, shape (2,); normal: towards `a`; force: on the shell, N
    approach_speed: m/s; normal_impulse, friction_impulse: N s; peak_force: N
    energy_released, kinetic_peak: J
    """

    kind: str
    reason: int
    time: float
    a: Shell | None
    b: Shell | None
    body: Body | None
    zone: Zone | None
    hold: Hold | None
    joint: Joint | None
    arc_a: float
    arc_b: float
    point: Floats
    normal: Floats
    force: Floats
    approach_speed: float
    normal_impulse: float
    friction_impulse: float
    peak_force: float
    energy_released: float
    kinetic_peak: float


@dataclass(frozen=True, eq=False)
class DrawList:
    """A picture as operations on pixels (docs/reference/picture.md).

    operations: code and count of numbers of each, shape (n, 2)
    numbers: of all operations, one after the other
    texts: of the text operations, in their order
    """

    operations: NDArray[np.int32]
    numbers: NDArray[np.float32]
    texts: list[str]


@dataclass(frozen=True)
class Problem:
    """What is wrong or odd in a scene, sweep or experiment.

    line, column: from 1, 0 if it has no place; pointer: JSON pointer
    what, expected, nearest: the parts; note: whether it is only a remark; text: all in one sentence
    """

    line: int
    column: int
    pointer: str
    what: str
    expected: str
    nearest: str
    note: bool
    text: str


class World:
    """Shells and rigid bodies (Box2D inside). SI units, angles in rad. Closed by `with` or close().

    gravity: m/s^2
    quality: "laboratory" (every step as short as its error bound asks for) or "game" (steps of up to a frame)
    threads: that a step may use; results do not depend on it
    units_per_metre: Box2D length units per metre; about 50 for bodies of some centimetres
    """

    def __init__(self, gravity: Point = (0.0, -9.81), *, quality: str = "laboratory", threads: int = 1,
                 units_per_metre: float = 1.0, velocity_iterations: int = 8, position_iterations: int = 3) -> None:
        self._handle = _api.sc_world()
        definition = _api.sc_world_def()
        core().sc_world_def_init(byref(definition))
        definition.gravity = _convert.point(gravity)
        definition.quality = _convert.choice(quality, QUALITIES, "quality")
        definition.threads, definition.units_per_metre = threads, units_per_metre
        definition.velocity_iterations, definition.position_iterations = velocity_iterations, position_iterations
        core().sc_world_create(byref(definition), byref(self._handle))

    @classmethod
    def for_scene(cls, scene: SceneSource, **settings: Any) -> World:
        """A world with the gravity and Box2D units that a scene wants; `settings` as of World."""
        text, _ = _convert.source_text(scene, _files.find)
        definition = _api.sc_world_def()
        core().sc_world_def_init(byref(definition))
        core().sc_scene_world_def(text, len(text), byref(definition))
        wanted: dict[str, Any] = {"gravity": _convert.array2(definition.gravity), "units_per_metre": definition.units_per_metre}
        return cls(**{**wanted, **settings})

    def close(self) -> None:
        """Ends the world with all that is in it."""
        handle, self._handle = self._handle, _api.sc_world()
        if handle.id:
            core().sc_world_destroy(handle)

    def __repr__(self) -> str:
        if not self._handle.id:
            return "World(closed)"
        return f"World({len(self.shells())} shells, {len(self.bodies())} bodies, time {self.time:.6g} s)"

    def __enter__(self) -> World:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def __del__(self) -> None:
        try:
            self.close()
        except Exception:  # the interpreter may be ending
            pass

    def _call(self, name: str, *arguments: Any) -> Any:
        return getattr(core(), f"sc_world_{name}")(self._handle, *arguments)

    # time

    def step(self, dt: float = 1.0 / 60.0) -> records.Frame:
        """Advances shells and bodies by `dt` (s); 0 is a pause. FailedError has the Frame as `result`."""
        out = _api.sc_frame()
        try:
            core().sc_world_step(self._handle, dt, byref(out))
        except FailedError as error:
            error.result = _convert.record(records.Frame, out)
            raise
        return _convert.record(records.Frame, out)

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return float(self._call("time"))

    @property
    def hash(self) -> int:
        """Of the shells' state; equal states have equal hashes on every machine."""
        return int(self._call("hash"))

    @property
    def energy(self) -> records.Energy:
        """Energy balance of the shells, J."""
        out = _api.sc_energy()
        self._call("energy", byref(out))
        return _convert.record(records.Energy, out)

    @property
    def report(self) -> dict[str, str]:
        """Texts of the last step: "failure", "why", "refused", "note"."""
        return dict(json.loads(self._call("report")))

    def events(self) -> list[Event]:
        """Of the last step, in the order of time."""
        found = _convert.items(_api.sc_event, lambda out, capacity: int(self._call("events", out, capacity)))
        return [self._event(e) for e in found]

    def _event(self, e: _api.sc_event) -> Event:
        def part(kind: type[P], handle: Any) -> P | None:
            return kind(self, handle) if handle.id else None

        return Event(EVENTS.get(e.kind, str(e.kind)), e.reason, e.time, part(Shell, e.a), part(Shell, e.b), part(Body, e.body),
                     part(Zone, e.zone), part(Hold, e.hold), part(Joint, e.joint), e.arc_a, e.arc_b,
                     _convert.array2(e.point), _convert.array2(e.normal), _convert.array2(e.force), e.approach_speed,
                     e.normal_impulse, e.friction_impulse, e.peak_force, e.energy_released, e.kinetic_peak)

    # settings

    @property
    def gravity(self) -> Floats:
        """m/s^2, shape (2,); may be set."""
        out = _api.sc_point()
        self._call("gravity", byref(out))
        return _convert.array2(out)

    @gravity.setter
    def gravity(self, value: Point) -> None:
        self._call("set_gravity", _convert.point(value))

    @property
    def quality(self) -> str:
        """"laboratory" or "game"; setting it resets the numerics."""
        found = self._call("quality")
        return next(name for name, value in QUALITIES.items() if value == found)

    @quality.setter
    def quality(self, value: str) -> None:
        self._call("set_quality", _convert.choice(value, QUALITIES, "quality"))

    def set_threads(self, threads: int) -> None:
        """That a step may use, 1 to 256."""
        self._call("set_threads", threads)

    def set_frame_budget(self, work: int) -> None:
        """Work a step, about 1 us of a core each; 0: no limit. Game quality only."""
        self._call("set_frame_budget", work)

    def set_crush_policy(self, policy: str) -> None:
        """What becomes of crushed shells: "wait", "stop" or "freeze"."""
        self._call("set_crush_policy", _convert.choice(policy, CRUSH, "policy"))

    @property
    def recovery(self) -> records.Recovery:
        """What becomes of quarantined shells."""
        out = _api.sc_recovery()
        self._call("recovery", byref(out))
        return _convert.record(records.Recovery, out)

    def set_recovery(self, release: bool, after: float) -> None:
        """Whether a quarantined shell moves again, and after what time (s)."""
        self._call("set_recovery", byref(_api.sc_recovery(int(release), 0, after)))

    @property
    def sleep(self) -> records.Sleep:
        """When shells at rest fall asleep."""
        out = _api.sc_sleep()
        self._call("sleep", byref(out))
        return _convert.record(records.Sleep, out)

    def set_sleep(self, automatic: bool, drift: float, delay: float) -> None:
        """Largest displacement in thicknesses within `delay` (s)."""
        self._call("set_sleep", byref(_api.sc_sleep(int(automatic), 0, drift, delay)))

    @property
    def event_settings(self) -> records.EventSettings:
        """What counts as an impulse or a snap."""
        out = _api.sc_event_settings()
        self._call("event_settings", byref(out))
        return _convert.record(records.EventSettings, out)

    def set_event_settings(self, impulse_threshold: float, snap_energy: float, snap_time: float) -> None:
        """N s (infinite: no impulse events), B / L, L^2 sqrt(lambda / B)."""
        self._call("set_event_settings", byref(_api.sc_event_settings(impulse_threshold, snap_energy, snap_time)))

    def set_friction(self, a: int, b: int, friction: float) -> None:
        """Coefficient between two friction materials; negative: back to the geometric mean."""
        self._call("set_friction", a, b, friction)

    def shift_origin(self, origin: Point) -> None:
        """Moves the origin of the coordinates to a point (m)."""
        self._call("shift_origin", _convert.point(origin))

    # shells

    def _shell_def(self, values: Mapping[str, Any]) -> _api.sc_shell_def:
        out = _api.sc_shell_def()
        core().sc_shell_def_init(byref(out))
        _convert.fill(out, values, "a shell")
        return out

    def create_shell(self, name: str = "", *, natural_curvature: ArrayLike | None = None,
                     curvature: ArrayLike | None = None, **definition: Any) -> Shell:
        """A new shell; what is not given is as in the paper (PET-G, R = 19.2 mm, h = 0.5 mm, opening 0.75).

        natural_curvature: 1/m, one for all elements or one each; None: 1 / radius
        curvature: at the start, 1/m, one each; None: the natural one
        definition: elements, closed, position (of the middle, m), angle (of the tangent there, rad), opening (angle /
            2 pi), radius (m; infinite: straight), length (m; 0: opening angle times radius), thickness (m), width (m),
            density (kg/m^3), young_modulus (Pa), friction (1), damping_ratio (1), tip_refinement (1), velocity (m/s),
            spin (rad/s), user_data, category, mask, group, material
        """
        out, made = _api.sc_shell(), self._shell_def(definition)
        natural, bent = _convert.numbers(natural_curvature), _convert.numbers(curvature)
        if bent.size:
            core().sc_shell_create_bent(self._handle, byref(made), _convert.encoded(name), _convert.address(natural),
                                        natural.size, _convert.address(bent), bent.size, byref(out))
        else:
            core().sc_shell_create(self._handle, byref(made), _convert.encoded(name), _convert.address(natural), natural.size,
                                   byref(out))
        return Shell(self, out)

    def fits(self, **definition: Any) -> bool:
        """Whether such a shell would cross nothing; `definition` as of create_shell."""
        return bool(core().sc_shell_fits(self._handle, byref(self._shell_def(definition))))

    def shells(self) -> list[Shell]:
        """All shells in the order of creation."""
        return self._shells(lambda out, capacity: int(self._call("shells", out, capacity)))

    def _shells(self, call: Any) -> list[Shell]:
        return [Shell(self, handle) for handle in _convert.items(_api.sc_shell, call)]

    def find_shell(self, name: str) -> Shell:
        """The first shell of that name."""
        out = _api.sc_shell()
        self._call("find_shell", _convert.encoded(name), byref(out))
        return Shell(self, out)

    def shapes(self, points: int = 64) -> Floats:
        """Centre lines of all shells at equal distances along each, m, shape (shells, points, 2)."""
        shells = self.shells()
        return np.stack([s.points(points) for s in shells]) if shells else np.empty((0, points, 2))

    def set_effects(self, effects: Json) -> None:
        """Replaces the effects of all shells by a list, as "effects" of a scene."""
        core().sc_shell_set_effects(self._handle, _api.sc_shell(), _convert.json_bytes(effects))

    def set_effect(self, key: str, **values: float) -> None:
        """Switches an effect of all shells on or changes it."""
        core().sc_shell_set_effect(self._handle, _api.sc_shell(), _convert.json_bytes({"key": key, **values}))

    def remove_effect(self, key: str) -> None:
        """Removes an effect of all shells."""
        core().sc_shell_remove_effect(self._handle, _api.sc_shell(), _convert.encoded(key))

    # bodies

    def create_body(self, name: str = "", *, box: Point | None = None, circle: float | None = None,
                    polygon: ArrayLike | None = None, line: ArrayLike | None = None, type: str = "dynamic",
                    **definition: Any) -> Body:
        """A rigid body of one shape about its origin; several shapes and joints come by add().

        box: width and height (m); circle: radius (m)
        polygon: 3 to 8 corners (m), convex; line: 2 or more points (m), solid from both sides
        type: "static", "kinematic" or "dynamic"
        definition: position (m), angle (rad), velocity (m/s), spin (rad/s), density (1 kg/m^2), friction (0.2),
            restitution, linear_damping (1/s), angular_damping (1/s), gravity_scale, fixed_rotation, bullet, category,
            mask, group
        """
        shapes = {"box": box, "circle": circle, "polygon": polygon, "line": line}
        given = [shape for shape, value in shapes.items() if value is not None]
        if len(given) != 1:
            raise BadInputError(f"a body has one of {', '.join(shapes)}, not {' and '.join(given) or 'none of them'}")
        made, out = _api.sc_body_def(), _api.sc_body()
        core().sc_body_def_init(byref(made))
        _convert.fill(made, definition, "a body", ("type", "shape", "width", "height", "radius"))
        made.type = _convert.choice(type, BODIES, "type")
        made.shape = SHAPES[given[0]]
        if box is not None:
            size = _convert.point(box)
            made.width, made.height = size.x, size.y
        elif circle is not None:
            _convert.fill(made, {"radius": circle}, "a body")
        points = _convert.corners(polygon if polygon is not None else line)
        core().sc_body_create(self._handle, byref(made), _convert.encoded(name or None), _convert.address(points), len(points),
                              byref(out))
        return Body(self, out)

    def add(self, fragment: Json) -> None:
        """Adds bodies, joints, shells, holds and effects from scene JSON; gravity and scale stay.

        The schema line may be left out of a dict.
        """
        if isinstance(fragment, Mapping) and "schema" not in fragment:
            fragment = {"schema": "supercircle-scene/1", **fragment}
        text = _convert.json_bytes(fragment)
        self._call("add", text, len(text))

    def bodies(self) -> list[Body]:
        """All bodies, oldest first."""
        found = _convert.items(_api.sc_body, lambda out, capacity: int(self._call("bodies", out, capacity)))
        return [Body(self, handle) for handle in found]

    def find_body(self, name: str) -> Body:
        """The body of that name."""
        out = _api.sc_body()
        core().sc_body_find(self._handle, _convert.encoded(name), byref(out))
        return Body(self, out)

    def grab_body(self, at: Point, max_force: float = 0.0) -> MouseJoint:
        """Grabs the dynamic body at a point (m) with at most `max_force` (N; 0: mass times 1000 m/s^2)."""
        out = _api.sc_mouse_joint()
        core().sc_body_grab(self._handle, _convert.point(at), max_force, byref(out))
        return MouseJoint(self, out)

    # testing machine

    def attach_crosshead(self, body: str) -> None:
        """The crosshead carries that kinematic body, and holds with base "moving"."""
        core().sc_crosshead_attach(self._handle, _convert.encoded(body))

    def set_crosshead_velocity(self, velocity: Point) -> None:
        """m/s."""
        core().sc_crosshead_set_velocity(self._handle, _convert.point(velocity))

    @property
    def crosshead_force(self) -> Floats:
        """Force of the shells on the crosshead in the last step, N, shape (2,)."""
        out = _api.sc_point()
        core().sc_crosshead_force(self._handle, byref(out))
        return _convert.array2(out)

    # queries: `mask` selects shells by a common bit with their category

    def ray_cast(self, start: Point, end: Point, mask: int = 0xFFFF) -> list[Hit]:
        """Every point where the ray enters a shell, in the order along the ray."""
        a, b = _convert.point(start), _convert.point(end)
        found = _convert.items(_api.sc_hit, lambda out, n: int(core().sc_ray_cast(self._handle, a, b, mask, out, n)))
        return [Hit(self, hit) for hit in found]

    def closest_point(self, to: Point, max_distance: float = np.inf, mask: int = 0xFFFF) -> Hit:
        """The surface point closest to a point (m). RefusedError: none within `max_distance` (m)."""
        return self._closest(_api.sc_shell(), to, max_distance, mask)

    def _closest(self, only: _api.sc_shell, to: Point, max_distance: float, mask: int) -> Hit:
        out = _api.sc_hit()
        core().sc_closest_point(self._handle, only, _convert.point(to), max_distance, mask, byref(out))
        return Hit(self, out)

    def overlap_point(self, at: Point, mask: int = 0xFFFF) -> list[Shell]:
        """The shells whose material is at a point (m)."""
        p = _convert.point(at)
        return self._shells(lambda out, n: int(core().sc_overlap_point(self._handle, p, mask, out, n)))

    def overlap_box(self, lower: Point, upper: Point, mask: int = 0xFFFF) -> list[Shell]:
        """The shells that touch a box (m)."""
        a, b = _convert.point(lower), _convert.point(upper)
        return self._shells(lambda out, n: int(core().sc_overlap_box(self._handle, a, b, mask, out, n)))

    def overlap_circle(self, centre: Point, radius: float, mask: int = 0xFFFF) -> list[Shell]:
        """The shells that touch a circle (m)."""
        p = _convert.point(centre)
        return self._shells(lambda out, n: int(core().sc_overlap_circle(self._handle, p, radius, mask, out, n)))

    def create_zone(self, lower: Point, upper: Point) -> Zone:
        """A box (m) that reports shells which enter and leave it."""
        out = _api.sc_zone()
        core().sc_zone_create(self._handle, _convert.point(lower), _convert.point(upper), byref(out))
        return Zone(self, out)

    # state and log

    def save(self) -> bytes:
        """The state of shells and bodies."""
        return _bytes(lambda out, capacity: int(self._call("save", out, capacity)))

    def restore(self, state: bytes) -> None:
        """Back to a state of a world with the same bodies; those made since then stay. Shells are valid again if it is
        one of the last sixteen saves of this world; else shells() lists new ones."""
        self._call("restore", state, len(state))

    def start_log(self, seed: int = 0) -> None:
        """Records every call that changes shells. `seed` is your own."""
        core().sc_log_start(self._handle, seed)

    def read_log(self) -> bytes:
        """The calls since start_log; goes on recording."""
        return _bytes(lambda out, capacity: int(core().sc_log_read(self._handle, out, capacity)))

    def stop_log(self) -> None:
        """Ends the recording."""
        core().sc_log_stop(self._handle)

    def replay_log(self, log: bytes) -> None:
        """Repeats the calls of a log in a world with the bodies of its start."""
        core().sc_log_replay(self._handle, log, len(log))

    # scenes and pictures

    def load(self, scene: SceneSource, *, seed: int = 1, **parameters: float) -> Scene:
        """Creates bodies, joints, shells and holds of a scene, to be played by Scene.step.

        scene: a dict, a JSON text, a path, or the name of a shipped scene
        seed: of its random drop
        """
        text, name = _convert.source_text(scene, _files.find)
        out = _api.sc_scene()
        core().sc_scene_load(self._handle, text, len(text), name.encode(), _convert.json_bytes(parameters) if parameters else None,
                             seed, byref(out))
        return Scene(self, out)

    def svg(self, width: int = 800, height: int = 600, *, layers: str | None = None, centre: Point | None = None,
            pixels_per_metre: float = 0.0, alpha: float = 1.0) -> str:
        """The world as an SVG element.

        layers: such as "bodies shells", of bodies, shells, strain, contacts, forces, holds; None: all
        centre: m; with `pixels_per_metre`, else everything fits
        """
        return str(core().sc_picture_svg(self._handle, byref(_view(width, height, layers, centre, pixels_per_metre, alpha))))

    def picture(self, width: int = 800, height: int = 600, *, layers: str | None = None, centre: Point | None = None,
                pixels_per_metre: float = 0.0, alpha: float = 1.0, pixel_ratio: float = 1.0, clock: float = 0.0,
                reduced_motion: bool = False) -> DrawList:
        """The world as a list of operations on pixels (docs/reference/picture.md).

        layers, centre, pixels_per_metre: as for svg; another layer is "snaps"
        clock: of the viewer, by which flashes fade, s; 0: simulated time
        reduced_motion: without flashes
        """
        view = _view(width, height, layers, centre, pixels_per_metre, alpha)
        view.pixel_ratio, view.clock, view.reduced_motion = pixel_ratio, clock, reduced_motion
        core().sc_picture_make(self._handle, byref(view))
        operations = _array(core().sc_picture_operations, self._handle, np.int32).reshape(-1, 2)
        texts = _array(core().sc_picture_texts, self._handle, np.uint8).tobytes()
        return DrawList(operations, _array(core().sc_picture_numbers, self._handle, np.float32),
                        texts.decode().split("\0")[:-1])

    def sound(self, seconds: float) -> NDArray[np.float32]:
        """The samples that follow the last ones, in which the steps since then are heard: mono, 48000 a second.

        The first call switches the sound of the world on. seconds: 0 to 10
        """
        core().sc_sound_make(self._handle, seconds)
        return _array(core().sc_sound_samples, self._handle, np.float32)

    def _repr_html_(self) -> str:
        return self.svg(640, 480) if self._handle.id else "<i>closed world</i>"


def _view(width: int, height: int, layers: str | None, centre: Point | None, pixels_per_metre: float, alpha: float) -> _api.sc_view:
    view = _api.sc_view()
    core().sc_view_init(byref(view))
    view.width, view.height, view.pixels_per_metre, view.alpha = width, height, pixels_per_metre, alpha
    if centre is not None:
        view.centre = _convert.point(centre)
    if layers is not None:
        view.layers = sum({_convert.choice(name, LAYERS, "a layer") for name in layers.split()})
    return view


def _array(call: Any, world: _api.sc_world, kind: Any) -> NDArray[Any]:
    """A copy of an array of the library, which tells its number."""
    count = c_int32()
    address = call(world, byref(count))
    return np.frombuffer(string_at(address, count.value * np.dtype(kind).itemsize), dtype=kind).copy()


def wav(samples: ArrayLike) -> bytes:
    """Samples of World.sound as a WAV file: mono, 48000 a second, 32-bit floats."""
    numbers = np.ascontiguousarray(samples, dtype=np.float32)
    return _bytes(lambda out, capacity: core().sc_sound_wav(numbers.ctypes.data, numbers.size, out, capacity))


def _bytes(call: Any) -> bytes:
    capacity = call(None, 0)
    while True:
        out = np.empty(max(capacity, 1), dtype=np.uint8)
        count = call(out.ctypes.data, capacity)
        if count <= capacity:
            return out[:count].tobytes()
        capacity = count


class Scene:
    """A scene that is played in a world. `with` ends it; its bodies and shells stay until the world closes."""

    def __init__(self, world: World, handle: _api.sc_scene) -> None:
        self.world = world
        self._handle = handle

    def _call(self, name: str, *arguments: Any) -> Any:
        return getattr(core(), f"sc_scene_{name}")(self._handle, *arguments)

    def step(self, dt: float = 1.0 / 60.0) -> records.Frame:
        """Advances the scene and its world by at most `dt` (s). FailedError has the Frame as `result`."""
        out = _api.sc_frame()
        try:
            self._call("step", dt, byref(out))
        except FailedError as error:
            error.result = _convert.record(records.Frame, out)
            raise
        return _convert.record(records.Frame, out)

    @property
    def finished(self) -> bool:
        """The end of its protocol or duration, or a failure."""
        return bool(self._call("finished"))

    @property
    def phase(self) -> str:
        """"drop 7", "settle", "approach", "load 1", "unload 1", "hold", "free", "done"."""
        return str(self._call("phase"))

    @property
    def name(self) -> str:
        """Its name."""
        return str(self._call("name"))

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """Each with name, value, min, max, unit, about."""
        return list(json.loads(self._call("parameters")))

    @property
    def shells(self) -> list[Shell]:
        """Its shells in the order of creation."""
        return self.world._shells(lambda out, capacity: int(self._call("shells", out, capacity)))

    @property
    def travel(self) -> float:
        """Of the crosshead along its direction, m."""
        return float(self._call("travel"))

    @property
    def force(self) -> float:
        """On the crosshead, N; positive while the specimen resists."""
        return float(self._call("force"))

    @property
    def valid(self) -> bool:
        """Whether it still exists."""
        return bool(self._call("valid"))

    def destroy(self) -> None:
        """Ends the scene; its bodies and shells stay."""
        self._call("destroy")

    def __enter__(self) -> Scene:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self.valid:
            self.destroy()


def problems_of(found: list[dict[str, Any]]) -> list[Problem]:
    return [Problem(**{f.name: p[f.name] for f in fields(Problem)}) for p in found]


def check_scene(scene: SceneSource) -> list[Problem]:
    """Problems of a scene; [] if it is valid and there is nothing to remark. `scene` as of World.load."""
    text, name = _convert.source_text(scene, _files.find)
    return problems_of(json.loads(core().sc_scene_check(text, len(text), name.encode())))


def scaled_shell(radius: float, mass: float, opening: float = 0.75, stiffness: float = 1.0) -> dict[str, Any]:
    """For games: definition of a shell that sags, rolls and snaps under 9.81 m/s^2 as the paper's does, for
    world.create_shell(**sc.scaled_shell(1.0, 2.0), position=(0, 4)).

    radius: m; mass: kg; opening: angle / 2 pi; stiffness: factor of the bending stiffness
    """
    made = _api.sc_shell_def()
    core().sc_shell_def_scaled_init(byref(made), radius, mass, opening, stiffness)
    return {name: getattr(made, name) for name in ("radius", "opening", "thickness", "width", "density", "young_modulus")}


def effects() -> list[dict[str, Any]]:
    """The catalogue: key, slot, about, law, parameters."""
    return list(json.loads(core().sc_effects()))
