"""Made by bridge/python/generate.py from bridge/c/api.json: do not edit."""

from __future__ import annotations

from ctypes import CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_int32, c_uint32, c_uint64, c_void_p
from typing import Any

SC_API_VERSION = 1
SC_OK = 0
SC_BAD_INPUT = 1
SC_STALE = 2
SC_BUSY = 3
SC_REFUSED = 4
SC_FAILED = 5
SC_NO_MEMORY = 6
SC_WRONG_VERSION = 7
SC_QUALITY_LABORATORY = 0
SC_QUALITY_GAME = 1
SC_HOLD_PIN = 0
SC_HOLD_CLAMP = 1
SC_BASE_FIXED = 0
SC_BASE_MOVING = 1
SC_JOINT_PIN = 0
SC_JOINT_WELD = 1
SC_JOINT_TETHER = 2
SC_CRUSH_WAIT = 0
SC_CRUSH_STOP = 1
SC_CRUSH_FREEZE = 2
SC_BODY_STATIC = 0
SC_BODY_KINEMATIC = 1
SC_BODY_DYNAMIC = 2
SC_SHAPE_BOX = 0
SC_SHAPE_CIRCLE = 1
SC_SHAPE_POLYGON = 2
SC_SHAPE_LINE = 3
SC_QUARANTINE_NOT_FINITE = 0
SC_QUARANTINE_RUNAWAY = 1
SC_QUARANTINE_CRUSHED = 2
SC_CONTACT_BEGIN = 0
SC_CONTACT_END = 1
SC_IMPULSE = 2
SC_SNAP_BEGIN = 3
SC_SNAP_END = 4
SC_QUARANTINED = 5
SC_CRUSHED = 6
SC_BROKE = 7
SC_OVERLAP = 8
SC_HOLD_BLOCKED = 9
SC_ZONE_ENTER = 10
SC_ZONE_LEAVE = 11
SC_LAYER_BODIES = 1
SC_LAYER_SHELLS = 2
SC_LAYER_STRAIN = 4
SC_LAYER_CONTACTS = 8
SC_LAYER_FORCES = 16
SC_LAYER_HOLDS = 32
SC_LAYER_SNAPS = 64


class sc_world(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_shell(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_body(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_hold(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_joint(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_mouse_joint(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_force(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_zone(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_scene(Structure):
    id: int
    _fields_ = [("id", c_uint64)]


class sc_point(Structure):
    x: float
    y: float
    _fields_ = [("x", c_double), ("y", c_double)]


class sc_world_def(Structure):
    size: int
    quality: int
    threads: int
    velocity_iterations: int
    position_iterations: int
    reserved: int
    gravity: sc_point
    units_per_metre: float
    _fields_ = [("size", c_int32), ("quality", c_int32), ("threads", c_int32), ("velocity_iterations", c_int32), ("position_iterations", c_int32), ("reserved", c_int32), ("gravity", sc_point), ("units_per_metre", c_double)]


class sc_frame(Structure):
    advanced: float
    work: float
    injected: float
    energy_gained: float
    steps: int
    unconverged: int
    budget_exhausted: int
    quarantined: int
    left_out: int
    reserved: int
    _fields_ = [("advanced", c_double), ("work", c_double), ("injected", c_double), ("energy_gained", c_double), ("steps", c_uint64), ("unconverged", c_uint64), ("budget_exhausted", c_int32), ("quarantined", c_int32), ("left_out", c_int32), ("reserved", c_int32)]


class sc_energy(Structure):
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
    _fields_ = [("kinetic", c_double), ("bending", c_double), ("gravity", c_double), ("added", c_double), ("work", c_double), ("friction", c_double), ("impact", c_double), ("numerical", c_double), ("position_correction", c_double), ("injected", c_double), ("effects", c_double), ("damping", c_double), ("to_bodies", c_double), ("residual", c_double)]


class sc_sleep(Structure):
    automatic: int
    reserved: int
    drift: float
    delay: float
    _fields_ = [("automatic", c_int32), ("reserved", c_int32), ("drift", c_double), ("delay", c_double)]


class sc_recovery(Structure):
    release: int
    reserved: int
    after: float
    _fields_ = [("release", c_int32), ("reserved", c_int32), ("after", c_double)]


class sc_shell_def(Structure):
    size: int
    elements: int
    closed: int
    reserved: int
    position: sc_point
    angle: float
    opening: float
    radius: float
    length: float
    thickness: float
    width: float
    density: float
    young_modulus: float
    friction: float
    damping_ratio: float
    tip_refinement: float
    velocity: sc_point
    spin: float
    user_data: int
    category: int
    mask: int
    group: int
    material: int
    _fields_ = [("size", c_int32), ("elements", c_int32), ("closed", c_int32), ("reserved", c_int32), ("position", sc_point), ("angle", c_double), ("opening", c_double), ("radius", c_double), ("length", c_double), ("thickness", c_double), ("width", c_double), ("density", c_double), ("young_modulus", c_double), ("friction", c_double), ("damping_ratio", c_double), ("tip_refinement", c_double), ("velocity", sc_point), ("spin", c_double), ("user_data", c_uint64), ("category", c_uint32), ("mask", c_uint32), ("group", c_int32), ("material", c_uint32)]


class sc_shell_state(Structure):
    length: float
    mass: float
    centre: sc_point
    momentum: sc_point
    angular_momentum: float
    kinetic: float
    stored: float
    max_strain: float
    lower: sc_point
    upper: sc_point
    quarantined: int
    asleep: int
    _fields_ = [("length", c_double), ("mass", c_double), ("centre", sc_point), ("momentum", sc_point), ("angular_momentum", c_double), ("kinetic", c_double), ("stored", c_double), ("max_strain", c_double), ("lower", sc_point), ("upper", sc_point), ("quarantined", c_int32), ("asleep", c_int32)]


class sc_section(Structure):
    position: sc_point
    tangent: sc_point
    angle: float
    velocity: sc_point
    spin: float
    curvature: float
    natural_curvature: float
    moment: float
    strain: float
    energy_density: float
    _fields_ = [("position", sc_point), ("tangent", sc_point), ("angle", c_double), ("velocity", sc_point), ("spin", c_double), ("curvature", c_double), ("natural_curvature", c_double), ("moment", c_double), ("strain", c_double), ("energy_density", c_double)]


class sc_material(Structure):
    friction: float
    young_modulus: float
    density: float
    damping_ratio: float
    _fields_ = [("friction", c_double), ("young_modulus", c_double), ("density", c_double), ("damping_ratio", c_double)]


class sc_filter(Structure):
    category: int
    mask: int
    group: int
    reserved: int
    _fields_ = [("category", c_uint32), ("mask", c_uint32), ("group", c_int32), ("reserved", c_int32)]


class sc_target(Structure):
    position: sc_point
    angle: float
    velocity: sc_point
    spin: float
    _fields_ = [("position", sc_point), ("angle", c_double), ("velocity", sc_point), ("spin", c_double)]


class sc_reaction(Structure):
    force: sc_point
    torque: float
    _fields_ = [("force", sc_point), ("torque", c_double)]


class sc_joint_def(Structure):
    size: int
    kind: int
    shell: sc_shell
    other: sc_shell
    body: sc_body
    arc_fraction: float
    other_fraction: float
    point: sc_point
    length: float
    collide_connected: int
    reserved: int
    _fields_ = [("size", c_int32), ("kind", c_int32), ("shell", sc_shell), ("other", sc_shell), ("body", sc_body), ("arc_fraction", c_double), ("other_fraction", c_double), ("point", sc_point), ("length", c_double), ("collide_connected", c_int32), ("reserved", c_int32)]


class sc_mouse_joint_def(Structure):
    size: int
    reserved: int
    arc_fraction: float
    target: sc_point
    frequency: float
    damping_ratio: float
    max_force: float
    _fields_ = [("size", c_int32), ("reserved", c_int32), ("arc_fraction", c_double), ("target", sc_point), ("frequency", c_double), ("damping_ratio", c_double), ("max_force", c_double)]


class sc_hit(Structure):
    shell: sc_shell
    point: sc_point
    normal: sc_point
    fraction: float
    arc_fraction: float
    distance: float
    _fields_ = [("shell", sc_shell), ("point", sc_point), ("normal", sc_point), ("fraction", c_double), ("arc_fraction", c_double), ("distance", c_double)]


class sc_event(Structure):
    kind: int
    reason: int
    time: float
    a: sc_shell
    b: sc_shell
    body: sc_body
    zone: sc_zone
    hold: sc_hold
    joint: sc_joint
    arc_a: float
    arc_b: float
    point: sc_point
    normal: sc_point
    force: sc_point
    approach_speed: float
    normal_impulse: float
    friction_impulse: float
    peak_force: float
    energy_released: float
    kinetic_peak: float
    _fields_ = [("kind", c_int32), ("reason", c_int32), ("time", c_double), ("a", sc_shell), ("b", sc_shell), ("body", sc_body), ("zone", sc_zone), ("hold", sc_hold), ("joint", sc_joint), ("arc_a", c_double), ("arc_b", c_double), ("point", sc_point), ("normal", sc_point), ("force", sc_point), ("approach_speed", c_double), ("normal_impulse", c_double), ("friction_impulse", c_double), ("peak_force", c_double), ("energy_released", c_double), ("kinetic_peak", c_double)]


class sc_event_settings(Structure):
    impulse_threshold: float
    snap_energy: float
    snap_time: float
    _fields_ = [("impulse_threshold", c_double), ("snap_energy", c_double), ("snap_time", c_double)]


class sc_body_def(Structure):
    size: int
    type: int
    shape: int
    fixed_rotation: int
    position: sc_point
    angle: float
    velocity: sc_point
    spin: float
    width: float
    height: float
    radius: float
    density: float
    friction: float
    restitution: float
    linear_damping: float
    angular_damping: float
    gravity_scale: float
    category: int
    mask: int
    group: int
    bullet: int
    _fields_ = [("size", c_int32), ("type", c_int32), ("shape", c_int32), ("fixed_rotation", c_int32), ("position", sc_point), ("angle", c_double), ("velocity", sc_point), ("spin", c_double), ("width", c_double), ("height", c_double), ("radius", c_double), ("density", c_double), ("friction", c_double), ("restitution", c_double), ("linear_damping", c_double), ("angular_damping", c_double), ("gravity_scale", c_double), ("category", c_uint32), ("mask", c_uint32), ("group", c_int32), ("bullet", c_int32)]


class sc_body_state(Structure):
    centre: sc_point
    angle: float
    velocity: sc_point
    spin: float
    mass: float
    inertia: float
    type: int
    awake: int
    _fields_ = [("centre", sc_point), ("angle", c_double), ("velocity", sc_point), ("spin", c_double), ("mass", c_double), ("inertia", c_double), ("type", c_int32), ("awake", c_int32)]


class sc_view(Structure):
    size: int
    width: int
    height: int
    layers: int
    centre: sc_point
    pixels_per_metre: float
    alpha: float
    pixel_ratio: float
    clock: float
    reduced_motion: int
    reserved: int
    _fields_ = [("size", c_int32), ("width", c_int32), ("height", c_int32), ("layers", c_int32), ("centre", sc_point), ("pixels_per_metre", c_double), ("alpha", c_double), ("pixel_ratio", c_double), ("clock", c_double), ("reduced_motion", c_int32), ("reserved", c_int32)]


class STATUS(c_int32):
    """An sc_status: other than 0 the call was refused."""


sc_lab_progress = CFUNCTYPE(c_int32, c_void_p, c_double, c_char_p)

Prototypes = dict[str, tuple[Any, tuple[Any, ...]]]
# name: (result, parameters)
CALLS: Prototypes = {
    "sc_api_version": (c_int32, ()),
    "sc_version": (c_char_p, ()),
    "sc_error": (c_char_p, ()),
    "sc_error_status": (STATUS, ()),
    "sc_alloc": (c_void_p, (c_int32, )),
    "sc_free": (None, (c_void_p, )),
    "sc_layout": (c_char_p, ()),
    "sc_world_def_init": (None, (POINTER(sc_world_def), )),
    "sc_world_create": (STATUS, (POINTER(sc_world_def), POINTER(sc_world), )),
    "sc_world_destroy": (STATUS, (sc_world, )),
    "sc_world_valid": (c_int32, (sc_world, )),
    "sc_world_step": (STATUS, (sc_world, c_double, POINTER(sc_frame), )),
    "sc_world_report": (c_char_p, (sc_world, )),
    "sc_world_set_quality": (STATUS, (sc_world, c_int32, )),
    "sc_world_quality": (c_int32, (sc_world, )),
    "sc_world_set_frame_budget": (STATUS, (sc_world, c_uint64, )),
    "sc_world_set_crush_policy": (STATUS, (sc_world, c_int32, )),
    "sc_world_set_recovery": (STATUS, (sc_world, POINTER(sc_recovery), )),
    "sc_world_recovery": (STATUS, (sc_world, POINTER(sc_recovery), )),
    "sc_world_set_threads": (STATUS, (sc_world, c_int32, )),
    "sc_world_set_gravity": (STATUS, (sc_world, sc_point, )),
    "sc_world_gravity": (STATUS, (sc_world, c_void_p, )),
    "sc_world_set_sleep": (STATUS, (sc_world, POINTER(sc_sleep), )),
    "sc_world_sleep": (STATUS, (sc_world, POINTER(sc_sleep), )),
    "sc_world_set_friction": (STATUS, (sc_world, c_uint32, c_uint32, c_double, )),
    "sc_world_shift_origin": (STATUS, (sc_world, sc_point, )),
    "sc_world_time": (c_double, (sc_world, )),
    "sc_world_hash": (c_uint64, (sc_world, )),
    "sc_world_energy": (STATUS, (sc_world, POINTER(sc_energy), )),
    "sc_world_shells": (c_int32, (sc_world, c_void_p, c_int32, )),
    "sc_world_find_shell": (STATUS, (sc_world, c_char_p, c_void_p, )),
    "sc_shell_def_init": (None, (POINTER(sc_shell_def), )),
    "sc_shell_def_scaled_init": (STATUS, (POINTER(sc_shell_def), c_double, c_double, c_double, c_double, )),
    "sc_shell_create": (STATUS, (sc_world, POINTER(sc_shell_def), c_char_p, c_void_p, c_int32, c_void_p, )),
    "sc_shell_create_bent": (STATUS, (sc_world, POINTER(sc_shell_def), c_char_p, c_void_p, c_int32, c_void_p, c_int32, c_void_p, )),
    "sc_shell_fits": (c_int32, (sc_world, POINTER(sc_shell_def), )),
    "sc_shell_destroy": (STATUS, (sc_world, sc_shell, )),
    "sc_shell_valid": (c_int32, (sc_world, sc_shell, )),
    "sc_shell_curvatures": (c_int32, (sc_world, sc_shell, c_double, POINTER(sc_target), c_void_p, c_int32, )),
    "sc_shell_polyline": (c_int32, (sc_world, sc_shell, c_double, c_void_p, c_int32, )),
    "sc_shell_state_of": (STATUS, (sc_world, sc_shell, POINTER(sc_shell_state), )),
    "sc_shell_section": (STATUS, (sc_world, sc_shell, c_double, POINTER(sc_section), )),
    "sc_shell_teleport": (STATUS, (sc_world, sc_shell, sc_point, c_double, )),
    "sc_shell_set_velocity": (STATUS, (sc_world, sc_shell, sc_point, c_double, )),
    "sc_shell_set_material": (STATUS, (sc_world, sc_shell, POINTER(sc_material), )),
    "sc_shell_set_natural_curvature": (STATUS, (sc_world, sc_shell, c_void_p, c_int32, )),
    "sc_shell_set_friction_material": (STATUS, (sc_world, sc_shell, c_uint32, )),
    "sc_shell_set_filter": (STATUS, (sc_world, sc_shell, POINTER(sc_filter), )),
    "sc_shell_filter": (STATUS, (sc_world, sc_shell, POINTER(sc_filter), )),
    "sc_shell_set_awake": (STATUS, (sc_world, sc_shell, c_int32, )),
    "sc_shell_name": (c_char_p, (sc_world, sc_shell, )),
    "sc_shell_set_name": (STATUS, (sc_world, sc_shell, c_char_p, )),
    "sc_shell_user_data": (STATUS, (sc_world, sc_shell, c_void_p, )),
    "sc_shell_set_user_data": (STATUS, (sc_world, sc_shell, c_uint64, )),
    "sc_shell_apply_force": (STATUS, (sc_world, sc_shell, c_double, sc_point, c_double, )),
    "sc_shell_apply_impulse": (STATUS, (sc_world, sc_shell, c_double, sc_point, c_double, )),
    "sc_effects": (c_char_p, ()),
    "sc_shell_set_effects": (STATUS, (sc_world, sc_shell, c_char_p, )),
    "sc_shell_set_effect": (STATUS, (sc_world, sc_shell, c_char_p, )),
    "sc_shell_remove_effect": (STATUS, (sc_world, sc_shell, c_char_p, )),
    "sc_shell_effects": (c_char_p, (sc_world, sc_shell, )),
    "sc_hold_create": (STATUS, (sc_world, sc_shell, c_double, c_int32, c_int32, POINTER(sc_hold), )),
    "sc_hold_valid": (c_int32, (sc_world, sc_hold, )),
    "sc_hold_set_target": (STATUS, (sc_world, sc_hold, POINTER(sc_target), )),
    "sc_hold_target": (STATUS, (sc_world, sc_hold, POINTER(sc_target), )),
    "sc_hold_reaction": (STATUS, (sc_world, sc_hold, POINTER(sc_reaction), )),
    "sc_hold_set_max_force": (STATUS, (sc_world, sc_hold, c_double, )),
    "sc_hold_destroy": (STATUS, (sc_world, sc_hold, )),
    "sc_joint_def_init": (None, (POINTER(sc_joint_def), )),
    "sc_joint_create": (STATUS, (sc_world, POINTER(sc_joint_def), POINTER(sc_joint), )),
    "sc_joint_valid": (c_int32, (sc_world, sc_joint, )),
    "sc_joint_set_target": (STATUS, (sc_world, sc_joint, POINTER(sc_target), )),
    "sc_joint_target": (STATUS, (sc_world, sc_joint, POINTER(sc_target), )),
    "sc_joint_set_max_length": (STATUS, (sc_world, sc_joint, c_double, c_double, )),
    "sc_joint_length": (c_double, (sc_world, sc_joint, )),
    "sc_joint_reaction": (STATUS, (sc_world, sc_joint, POINTER(sc_reaction), )),
    "sc_joint_set_max_force": (STATUS, (sc_world, sc_joint, c_double, )),
    "sc_joint_destroy": (STATUS, (sc_world, sc_joint, )),
    "sc_mouse_joint_def_init": (None, (POINTER(sc_mouse_joint_def), )),
    "sc_mouse_joint_create": (STATUS, (sc_world, sc_shell, POINTER(sc_mouse_joint_def), POINTER(sc_mouse_joint), )),
    "sc_body_grab": (STATUS, (sc_world, sc_point, c_double, POINTER(sc_mouse_joint), )),
    "sc_mouse_joint_valid": (c_int32, (sc_world, sc_mouse_joint, )),
    "sc_mouse_joint_move": (STATUS, (sc_world, sc_mouse_joint, sc_point, )),
    "sc_mouse_joint_reaction": (STATUS, (sc_world, sc_mouse_joint, POINTER(sc_reaction), )),
    "sc_mouse_joint_destroy": (STATUS, (sc_world, sc_mouse_joint, )),
    "sc_force_create": (STATUS, (sc_world, sc_shell, c_double, sc_point, c_double, POINTER(sc_force), )),
    "sc_force_valid": (c_int32, (sc_world, sc_force, )),
    "sc_force_set": (STATUS, (sc_world, sc_force, sc_point, c_double, )),
    "sc_force_destroy": (STATUS, (sc_world, sc_force, )),
    "sc_body_def_init": (None, (POINTER(sc_body_def), )),
    "sc_body_create": (STATUS, (sc_world, POINTER(sc_body_def), c_char_p, c_void_p, c_int32, c_void_p, )),
    "sc_world_add": (STATUS, (sc_world, c_char_p, c_int32, )),
    "sc_body_find": (STATUS, (sc_world, c_char_p, c_void_p, )),
    "sc_world_bodies": (c_int32, (sc_world, c_void_p, c_int32, )),
    "sc_body_valid": (c_int32, (sc_world, sc_body, )),
    "sc_body_state_of": (STATUS, (sc_world, sc_body, POINTER(sc_body_state), )),
    "sc_body_set_pose": (STATUS, (sc_world, sc_body, sc_point, c_double, )),
    "sc_body_set_velocity": (STATUS, (sc_world, sc_body, sc_point, c_double, )),
    "sc_body_apply_impulse": (STATUS, (sc_world, sc_body, sc_point, sc_point, )),
    "sc_body_outline": (c_int32, (sc_world, sc_body, c_int32, c_void_p, c_int32, )),
    "sc_body_fixtures": (c_int32, (sc_world, sc_body, )),
    "sc_body_set_friction_material": (STATUS, (sc_world, sc_body, c_uint32, )),
    "sc_body_set_surface_speed": (STATUS, (sc_world, sc_body, c_int32, c_double, )),
    "sc_body_destroy": (STATUS, (sc_world, sc_body, )),
    "sc_crosshead_attach": (STATUS, (sc_world, c_char_p, )),
    "sc_crosshead_set_velocity": (STATUS, (sc_world, sc_point, )),
    "sc_crosshead_force": (STATUS, (sc_world, c_void_p, )),
    "sc_ray_cast": (c_int32, (sc_world, sc_point, sc_point, c_uint32, POINTER(sc_hit), c_int32, )),
    "sc_closest_point": (STATUS, (sc_world, sc_shell, sc_point, c_double, c_uint32, POINTER(sc_hit), )),
    "sc_overlap_point": (c_int32, (sc_world, sc_point, c_uint32, c_void_p, c_int32, )),
    "sc_overlap_box": (c_int32, (sc_world, sc_point, sc_point, c_uint32, c_void_p, c_int32, )),
    "sc_overlap_circle": (c_int32, (sc_world, sc_point, c_double, c_uint32, c_void_p, c_int32, )),
    "sc_zone_create": (STATUS, (sc_world, sc_point, sc_point, POINTER(sc_zone), )),
    "sc_zone_valid": (c_int32, (sc_world, sc_zone, )),
    "sc_zone_shells": (c_int32, (sc_world, sc_zone, c_void_p, c_int32, )),
    "sc_zone_destroy": (STATUS, (sc_world, sc_zone, )),
    "sc_world_events": (c_int32, (sc_world, POINTER(sc_event), c_int32, )),
    "sc_world_set_event_settings": (STATUS, (sc_world, POINTER(sc_event_settings), )),
    "sc_world_event_settings": (STATUS, (sc_world, POINTER(sc_event_settings), )),
    "sc_world_save": (c_int32, (sc_world, c_void_p, c_int32, )),
    "sc_world_restore": (STATUS, (sc_world, c_void_p, c_int32, )),
    "sc_log_start": (STATUS, (sc_world, c_uint64, )),
    "sc_log_read": (c_int32, (sc_world, c_void_p, c_int32, )),
    "sc_log_stop": (STATUS, (sc_world, )),
    "sc_log_replay": (STATUS, (sc_world, c_void_p, c_int32, )),
    "sc_scene_check": (c_char_p, (c_char_p, c_int32, c_char_p, )),
    "sc_scene_world_def": (STATUS, (c_char_p, c_int32, POINTER(sc_world_def), )),
    "sc_scene_load": (STATUS, (sc_world, c_char_p, c_int32, c_char_p, c_char_p, c_uint64, POINTER(sc_scene), )),
    "sc_scene_valid": (c_int32, (sc_scene, )),
    "sc_scene_step": (STATUS, (sc_scene, c_double, POINTER(sc_frame), )),
    "sc_scene_finished": (c_int32, (sc_scene, )),
    "sc_scene_phase": (c_char_p, (sc_scene, )),
    "sc_scene_name": (c_char_p, (sc_scene, )),
    "sc_scene_parameters": (c_char_p, (sc_scene, )),
    "sc_scene_shells": (c_int32, (sc_scene, c_void_p, c_int32, )),
    "sc_scene_travel": (c_double, (sc_scene, )),
    "sc_scene_force": (c_double, (sc_scene, )),
    "sc_scene_destroy": (STATUS, (sc_scene, )),
    "sc_view_init": (None, (POINTER(sc_view), )),
    "sc_picture_make": (STATUS, (sc_world, POINTER(sc_view), )),
    "sc_picture_operations": (c_void_p, (sc_world, c_void_p, )),
    "sc_picture_numbers": (c_void_p, (sc_world, c_void_p, )),
    "sc_picture_texts": (c_void_p, (sc_world, c_void_p, )),
    "sc_picture_svg": (c_char_p, (sc_world, POINTER(sc_view), )),
    "sc_sound_make": (STATUS, (sc_world, c_double, )),
    "sc_sound_samples": (c_void_p, (sc_world, c_void_p, )),
    "sc_sound_wav": (c_int32, (c_void_p, c_int32, c_void_p, c_int32, )),
}
LAB_CALLS: Prototypes = {
    "sc_lab_api_version": (c_int32, ()),
    "sc_lab_error": (c_char_p, ()),
    "sc_lab_status": (STATUS, ()),
    "sc_lab_run": (c_char_p, (c_char_p, sc_lab_progress, c_void_p, )),
    "sc_lab_sweep": (c_char_p, (c_char_p, sc_lab_progress, c_void_p, )),
    "sc_lab_import": (c_char_p, (c_char_p, sc_lab_progress, c_void_p, )),
    "sc_lab_replay": (c_char_p, (c_char_p, sc_lab_progress, c_void_p, )),
    "sc_lab_diagnose": (c_char_p, (c_char_p, sc_lab_progress, c_void_p, )),
    "sc_lab_check": (c_char_p, (c_char_p, sc_lab_progress, c_void_p, )),
}
# name: (bytes, offset of each member)
LAYOUT: dict[str, tuple[int, dict[str, int]]] = {
    "sc_world": (8, {"id": 0}),
    "sc_shell": (8, {"id": 0}),
    "sc_body": (8, {"id": 0}),
    "sc_hold": (8, {"id": 0}),
    "sc_joint": (8, {"id": 0}),
    "sc_mouse_joint": (8, {"id": 0}),
    "sc_force": (8, {"id": 0}),
    "sc_zone": (8, {"id": 0}),
    "sc_scene": (8, {"id": 0}),
    "sc_point": (16, {"x": 0, "y": 8}),
    "sc_world_def": (48, {"size": 0, "quality": 4, "threads": 8, "velocity_iterations": 12, "position_iterations": 16, "reserved": 20, "gravity": 24, "units_per_metre": 40}),
    "sc_frame": (64, {"advanced": 0, "work": 8, "injected": 16, "energy_gained": 24, "steps": 32, "unconverged": 40, "budget_exhausted": 48, "quarantined": 52, "left_out": 56, "reserved": 60}),
    "sc_energy": (112, {"kinetic": 0, "bending": 8, "gravity": 16, "added": 24, "work": 32, "friction": 40, "impact": 48, "numerical": 56, "position_correction": 64, "injected": 72, "effects": 80, "damping": 88, "to_bodies": 96, "residual": 104}),
    "sc_sleep": (24, {"automatic": 0, "reserved": 4, "drift": 8, "delay": 16}),
    "sc_recovery": (16, {"release": 0, "reserved": 4, "after": 8}),
    "sc_shell_def": (168, {"size": 0, "elements": 4, "closed": 8, "reserved": 12, "position": 16, "angle": 32, "opening": 40, "radius": 48, "length": 56, "thickness": 64, "width": 72, "density": 80, "young_modulus": 88, "friction": 96, "damping_ratio": 104, "tip_refinement": 112, "velocity": 120, "spin": 136, "user_data": 144, "category": 152, "mask": 156, "group": 160, "material": 164}),
    "sc_shell_state": (120, {"length": 0, "mass": 8, "centre": 16, "momentum": 32, "angular_momentum": 48, "kinetic": 56, "stored": 64, "max_strain": 72, "lower": 80, "upper": 96, "quarantined": 112, "asleep": 116}),
    "sc_section": (104, {"position": 0, "tangent": 16, "angle": 32, "velocity": 40, "spin": 56, "curvature": 64, "natural_curvature": 72, "moment": 80, "strain": 88, "energy_density": 96}),
    "sc_material": (32, {"friction": 0, "young_modulus": 8, "density": 16, "damping_ratio": 24}),
    "sc_filter": (16, {"category": 0, "mask": 4, "group": 8, "reserved": 12}),
    "sc_target": (48, {"position": 0, "angle": 16, "velocity": 24, "spin": 40}),
    "sc_reaction": (24, {"force": 0, "torque": 16}),
    "sc_joint_def": (80, {"size": 0, "kind": 4, "shell": 8, "other": 16, "body": 24, "arc_fraction": 32, "other_fraction": 40, "point": 48, "length": 64, "collide_connected": 72, "reserved": 76}),
    "sc_mouse_joint_def": (56, {"size": 0, "reserved": 4, "arc_fraction": 8, "target": 16, "frequency": 32, "damping_ratio": 40, "max_force": 48}),
    "sc_hit": (64, {"shell": 0, "point": 8, "normal": 24, "fraction": 40, "arc_fraction": 48, "distance": 56}),
    "sc_event": (176, {"kind": 0, "reason": 4, "time": 8, "a": 16, "b": 24, "body": 32, "zone": 40, "hold": 48, "joint": 56, "arc_a": 64, "arc_b": 72, "point": 80, "normal": 96, "force": 112, "approach_speed": 128, "normal_impulse": 136, "friction_impulse": 144, "peak_force": 152, "energy_released": 160, "kinetic_peak": 168}),
    "sc_event_settings": (24, {"impulse_threshold": 0, "snap_energy": 8, "snap_time": 16}),
    "sc_body_def": (152, {"size": 0, "type": 4, "shape": 8, "fixed_rotation": 12, "position": 16, "angle": 32, "velocity": 40, "spin": 56, "width": 64, "height": 72, "radius": 80, "density": 88, "friction": 96, "restitution": 104, "linear_damping": 112, "angular_damping": 120, "gravity_scale": 128, "category": 136, "mask": 140, "group": 144, "bullet": 148}),
    "sc_body_state": (72, {"centre": 0, "angle": 16, "velocity": 24, "spin": 40, "mass": 48, "inertia": 56, "type": 64, "awake": 68}),
    "sc_view": (72, {"size": 0, "width": 4, "height": 8, "layers": 12, "centre": 16, "pixels_per_metre": 32, "alpha": 40, "pixel_ratio": 48, "clock": 56, "reduced_motion": 64, "reserved": 68}),
}
