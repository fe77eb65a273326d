// What lives in a world: shells, holds, joints, springs, forces, bodies, zones. A stale one is refused with kind "stale".

import { badInput } from "../loader/loader.js";
import { show } from "../loader/calls.js";

const HOLDS = { pin: "SC_HOLD_PIN", clamp: "SC_HOLD_CLAMP" };
const BASES = { fixed: "SC_BASE_FIXED", moving: "SC_BASE_MOVING" };
const JOINTS = { pin: "SC_JOINT_PIN", weld: "SC_JOINT_WELD", tether: "SC_JOINT_TETHER" };

/** The constant of a word. */
export function choice(word, known, what) {
  if (!Object.hasOwn(known, word)) throw badInput(`${what} is ${show(word)}, not one of ${Object.keys(known).join(", ")}`);
  return CONSTANTS[known[word]];
}

/** A text as it is, anything else as JSON. */
export function json(value) {
  return typeof value === "string" ? value : JSON.stringify(value);
}

/** `given` without the members that are undefined. */
export function set(given) {
  return Object.fromEntries(Object.entries(given).filter(([, value]) => value !== undefined));
}

/** Something in a world. */
export class Part {
  constructor(world, id) {
    this.world = world;
    this.id = id;
  }
  call(name, ...given) {
    return this.world.core.calls[`sc_${this.kind}_${name}`](this.world.id, this.id, ...given);
  }
  get valid() {
    return this.call("valid") !== 0;
  }
  equals(other) {
    return other instanceof Part && other.kind === this.kind && other.id === this.id;
  }
  destroy() {
    this.call("destroy");
  }
  dispose() {
    if (this.world.id !== 0n && this.valid) this.destroy();
  }
}

export class Shell extends Part {
  get kind() {
    return "shell";
  }
  get name() {
    return this.call("name");
  }
  set name(value) {
    this.call("set_name", value);
  }
  get state() {
    return this.call("state_of");
  }
  section(arc) {
    return this.call("section", arc);
  }
  polyline(tolerance = 1e-5) {
    return this.call("polyline", tolerance);
  }
  curvatures() {
    return this.call("curvatures", 1).out;
  }
  pose(alpha = 1) {
    const { firstEnd, out } = this.call("curvatures", alpha);
    return { position: firstEnd.position, angle: firstEnd.angle, curvatures: out };
  }
  /** Places at equal distances along the centre line. */
  points(count = 64) {
    const line = this.polyline(1e-5 * this.state.length);
    const along = new Float64Array(line.length / 2);
    for (let i = 1; i < along.length; ++i)
      along[i] = along[i - 1] + Math.hypot(line[2 * i] - line[2 * i - 2], line[2 * i + 1] - line[2 * i - 1]);
    const out = new Float64Array(2 * count);
    for (let k = 0, i = 1; k < count; ++k) {
      const at = count > 1 ? (along[along.length - 1] * k) / (count - 1) : 0;
      while (i < along.length - 1 && along[i] < at) ++i;
      const part = Math.min(1, (at - along[i - 1]) / (along[i] - along[i - 1]));
      for (const c of [0, 1]) out[2 * k + c] = line[2 * i - 2 + c] + part * (line[2 * i + c] - line[2 * i - 2 + c]);
    }
    return out;
  }
  teleport(position, angle = 0) {
    this.call("teleport", position, angle);
  }
  setVelocity(velocity, spin = 0) {
    this.call("set_velocity", velocity, spin);
  }
  setMaterial(change) {
    const kept = { friction: NaN, youngModulus: NaN, density: NaN, dampingRatio: NaN };
    this.call("set_material", { ...kept, ...set(change) });
  }
  setNaturalCurvature(curvature) {
    this.call("set_natural_curvature", curvature);
  }
  setFrictionMaterial(material) {
    this.call("set_friction_material", material);
  }
  get filter() {
    return this.call("filter");
  }
  setFilter(filter) {
    this.call("set_filter", { category: 1, mask: 0xffff, group: 0, ...set(filter) });
  }
  setAwake(awake = true) {
    this.call("set_awake", awake);
  }
  get userData() {
    return this.call("user_data");
  }
  set userData(value) {
    this.call("set_user_data", value);
  }
  applyForce(arc, force, torque = 0) {
    this.call("apply_force", arc, force, torque);
  }
  applyImpulse(arc, impulse, angular = 0) {
    this.call("apply_impulse", arc, impulse, angular);
  }
  get effects() {
    return JSON.parse(this.call("effects"));
  }
  set effects(effects) {
    this.call("set_effects", json(effects));
  }
  setEffect(key, values = {}) {
    this.call("set_effect", json({ key, ...values }));
  }
  removeEffect(key) {
    this.call("remove_effect", key);
  }
  hold(arc = 0.5, { kind = "pin", base = "fixed" } = {}) {
    const { core, id } = this.world;
    return new Hold(this.world, core.calls.sc_hold_create(id, this, arc, choice(kind, HOLDS, "kind"), choice(base, BASES, "base")));
  }
  join(other = null, { kind = "pin", arc = 0.5, otherArc = 0.5, point = [0, 0], length = 0, collideConnected = false } = {}) {
    const { core, id } = this.world;
    const end = other instanceof Shell ? { other } : { body: other };
    const def = { ...core.calls.sc_joint_def_init(), kind: choice(kind, JOINTS, "kind"), shell: this, ...end,
      arcFraction: arc, otherFraction: otherArc, point, length, collideConnected };
    return new Joint(this.world, core.calls.sc_joint_create(id, def));
  }
  grab(arc, target, options = {}) {
    const { core, id } = this.world;
    const def = { ...core.calls.sc_mouse_joint_def_init(), arcFraction: arc, target, ...set(options) };
    return new MouseJoint(this.world, core.calls.sc_mouse_joint_create(id, this, def));
  }
  push(arc, force, torque = 0) {
    return new Force(this.world, this.world.core.calls.sc_force_create(this.world.id, this, arc, force, torque));
  }
  closestPoint(to) {
    return this.world.closest(this, to, Infinity, 0xffff);
  }
}

/** With a target, a reaction and a largest force. */
export class Driven extends Part {
  get target() {
    return this.call("target");
  }
  get reaction() {
    return this.call("reaction");
  }
  setMaxForce(force) {
    this.call("set_max_force", force);
  }
}

export class Hold extends Driven {
  get kind() {
    return "hold";
  }
  setTarget(position, { angle = 0, velocity = [0, 0], spin = 0 } = {}) {
    this.call("set_target", { position, angle, velocity, spin });
  }
}

export class Joint extends Driven {
  get kind() {
    return "joint";
  }
  setTarget(position, { velocity = [0, 0] } = {}) {
    this.call("set_target", { position, velocity });
  }
  get length() {
    return this.call("length");
  }
  setMaxLength(length, rate) {
    this.call("set_max_length", length, rate);
  }
}

export class MouseJoint extends Part {
  get kind() {
    return "mouse_joint";
  }
  move(target) {
    this.call("move", target);
  }
  get reaction() {
    return this.call("reaction");
  }
}

export class Force extends Part {
  get kind() {
    return "force";
  }
  set(force, torque = 0) {
    this.call("set", force, torque);
  }
}

export class Body extends Part {
  get kind() {
    return "body";
  }
  get state() {
    return this.call("state_of");
  }
  setPose(centre, angle = 0) {
    this.call("set_pose", centre, angle);
  }
  setVelocity(velocity, spin = 0) {
    this.call("set_velocity", velocity, spin);
  }
  applyImpulse(impulse, at) {
    this.call("apply_impulse", impulse, at);
  }
  outlines() {
    return Array.from({ length: this.call("fixtures") }, (_, fixture) => this.call("outline", fixture));
  }
  setFrictionMaterial(material) {
    this.call("set_friction_material", material);
  }
  setSurfaceSpeed(speed, fixture = -1) {
    this.call("set_surface_speed", fixture, speed);
  }
}

export class Zone extends Part {
  get kind() {
    return "zone";
  }
  get shells() {
    return this.call("shells").map((id) => new Shell(this.world, id));
  }
}
