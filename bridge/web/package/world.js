// A world with shells and rigid bodies, and scenes played in it.

import { badInput } from "../loader/loader.js";
import { Body, Force, Hold, Joint, MouseJoint, Shell, Zone, choice, json, set } from "./parts.js";

const QUALITIES = { laboratory: "SC_QUALITY_LABORATORY", game: "SC_QUALITY_GAME" };
const CRUSH = { wait: "SC_CRUSH_WAIT", stop: "SC_CRUSH_STOP", freeze: "SC_CRUSH_FREEZE" };
const EVENTS = ["contact_begin", "contact_end", "impulse", "snap_begin", "snap_end", "quarantined", "crushed", "broke",
  "overlap", "hold_blocked", "zone_enter", "zone_leave"];
const PARTS_OF_EVENTS = { a: Shell, b: Shell, body: Body, zone: Zone, hold: Hold, joint: Joint };
const BODIES = { static: "SC_BODY_STATIC", kinematic: "SC_BODY_KINEMATIC", dynamic: "SC_BODY_DYNAMIC" };
const SHAPES = { box: "SC_SHAPE_BOX", circle: "SC_SHAPE_CIRCLE", polygon: "SC_SHAPE_POLYGON", line: "SC_SHAPE_LINE" };
const LAYERS = Object.fromEntries(Object.keys(CONSTANTS).filter((name) => name.startsWith("SC_LAYER_")).map((name) => [name.slice(9).toLowerCase(), name]));

/** Worlds that are forgotten without dispose() are ended when their object is collected. */
const forgotten = new FinalizationRegistry(({ core, id }) => {
  if (core.calls.sc_world_valid(id) !== 0) core.calls.sc_world_destroy(id);
});

export class World {
  constructor(core, { gravity = [0, -9.81], quality = "laboratory", unitsPerMetre = 1, velocityIterations = 8, positionIterations = 3 } = {}) {
    this.core = core;
    const def = { ...core.calls.sc_world_def_init(), gravity, quality: choice(quality, QUALITIES, "quality"), unitsPerMetre, velocityIterations, positionIterations };
    this.id = core.calls.sc_world_create(def);
    forgotten.register(this, { core, id: this.id }, this);
  }
  call(name, ...given) {
    return this.core.calls[`sc_world_${name}`](this.id, ...given);
  }
  /** Any call of the C interface whose first argument is the world. */
  with(name, ...given) {
    return this.core.calls[name](this.id, ...given);
  }
  get valid() {
    return this.id !== 0n && this.call("valid") !== 0;
  }
  dispose() {
    const { id } = this;
    if (id === 0n) return;
    this.id = 0n;
    forgotten.unregister(this);
    if (this.core.calls.sc_world_valid(id) !== 0) this.core.calls.sc_world_destroy(id);
  }

  // time
  step(dt = 1 / 60) {
    return this.call("step", dt);
  }
  get time() {
    return this.call("time");
  }
  get hash() {
    return this.call("hash");
  }
  get energy() {
    return this.call("energy");
  }
  get report() {
    return JSON.parse(this.call("report"));
  }
  events() {
    return this.call("events").map((e) => {
      for (const [name, kind] of Object.entries(PARTS_OF_EVENTS)) e[name] = e[name] === 0n ? null : new kind(this, e[name]);
      e.kind = EVENTS[e.kind] ?? String(e.kind);
      return e;
    });
  }

  // settings
  get gravity() {
    return this.call("gravity");
  }
  set gravity(value) {
    this.call("set_gravity", value);
  }
  get quality() {
    const found = this.call("quality");
    return Object.keys(QUALITIES).find((word) => CONSTANTS[QUALITIES[word]] === found);
  }
  set quality(value) {
    this.call("set_quality", choice(value, QUALITIES, "quality"));
  }
  setFrameBudget(work) {
    this.call("set_frame_budget", work);
  }
  setCrushPolicy(policy) {
    this.call("set_crush_policy", choice(policy, CRUSH, "policy"));
  }
  get recovery() {
    return this.call("recovery");
  }
  setRecovery(recovery) {
    this.call("set_recovery", { ...this.recovery, ...set(recovery) });
  }
  get sleep() {
    return this.call("sleep");
  }
  setSleep(sleep) {
    this.call("set_sleep", { ...this.sleep, ...set(sleep) });
  }
  get eventSettings() {
    return this.call("event_settings");
  }
  setEventSettings(settings) {
    this.call("set_event_settings", { ...this.eventSettings, ...set(settings) });
  }
  setFriction(a, b, friction) {
    this.call("set_friction", a, b, friction);
  }
  shiftOrigin(origin) {
    this.call("shift_origin", origin);
  }

  // shells
  createShell({ name = "", naturalCurvature = null, curvature = null, ...definition } = {}) {
    const def = { ...this.core.calls.sc_shell_def_init(), ...set(definition) };
    const id = curvature === null ? this.with("sc_shell_create", def, name, naturalCurvature)
      : this.with("sc_shell_create_bent", def, name, naturalCurvature, curvature);
    return new Shell(this, id);
  }
  fits(definition = {}) {
    return this.with("sc_shell_fits", { ...this.core.calls.sc_shell_def_init(), ...set(definition) }) !== 0;
  }
  shells() {
    return this.call("shells").map((id) => new Shell(this, id));
  }
  findShell(name) {
    return new Shell(this, this.call("find_shell", name));
  }
  shapes(points = 64) {
    return this.shells().map((shell) => shell.points(points));
  }
  setEffects(effects) {
    this.with("sc_shell_set_effects", null, json(effects));
  }
  setEffect(key, values = {}) {
    this.with("sc_shell_set_effect", null, json({ key, ...values }));
  }
  removeEffect(key) {
    this.with("sc_shell_remove_effect", null, key);
  }

  // bodies
  createBody({ name = "", type = "dynamic", box, circle, polygon, line, ...definition } = {}) {
    const given = Object.entries({ box, circle, polygon, line }).filter(([, value]) => value !== undefined && value !== null);
    if (given.length !== 1) throw badInput(`a body has one of ${Object.keys(SHAPES).join(", ")}, not ${given.map(([shape]) => shape).join(" and ") || "none of them"}`);
    const [[shape, value]] = given;
    const size = shape === "box" ? { width: value[0] ?? value.x, height: value[1] ?? value.y } : shape === "circle" ? { radius: value } : {};
    const def = { ...this.core.calls.sc_body_def_init(), ...set(definition), ...size, type: choice(type, BODIES, "type"), shape: choice(shape, SHAPES, "shape") };
    return new Body(this, this.with("sc_body_create", def, name, shape === "polygon" || shape === "line" ? value : null));
  }
  add(fragment) {
    this.call("add", json(typeof fragment === "object" ? { schema: "supercircle-scene/1", ...fragment } : fragment));
  }
  bodies() {
    return this.call("bodies").map((id) => new Body(this, id));
  }
  findBody(name) {
    return new Body(this, this.with("sc_body_find", name));
  }
  grabBody(at, maxForce = 0) {
    return new MouseJoint(this, this.with("sc_body_grab", at, maxForce));
  }

  // testing machine
  attachCrosshead(body) {
    this.with("sc_crosshead_attach", body);
  }
  setCrossheadVelocity(velocity) {
    this.with("sc_crosshead_set_velocity", velocity);
  }
  get crossheadForce() {
    return this.with("sc_crosshead_force");
  }

  // queries
  hit({ shell, arcFraction, ...rest }) {
    return { shell: new Shell(this, shell), arc: arcFraction, ...rest };
  }
  rayCast(start, end, mask = 0xffff) {
    return this.with("sc_ray_cast", start, end, mask).map((found) => this.hit(found));
  }
  closest(only, to, maxDistance, mask) {
    return this.hit(this.with("sc_closest_point", only, to, maxDistance, mask));
  }
  closestPoint(to, maxDistance = Infinity, mask = 0xffff) {
    return this.closest(null, to, maxDistance, mask);
  }
  overlapPoint(at, mask = 0xffff) {
    return this.with("sc_overlap_point", at, mask).map((id) => new Shell(this, id));
  }
  overlapBox(lower, upper, mask = 0xffff) {
    return this.with("sc_overlap_box", lower, upper, mask).map((id) => new Shell(this, id));
  }
  overlapCircle(centre, radius, mask = 0xffff) {
    return this.with("sc_overlap_circle", centre, radius, mask).map((id) => new Shell(this, id));
  }
  createZone(lower, upper) {
    return new Zone(this, this.with("sc_zone_create", lower, upper));
  }

  // state and log
  save() {
    return this.call("save");
  }
  restore(state) {
    this.call("restore", state);
  }
  startLog(seed = 0) {
    this.with("sc_log_start", seed);
  }
  readLog() {
    return this.with("sc_log_read");
  }
  stopLog() {
    this.with("sc_log_stop");
  }
  replayLog(log) {
    this.with("sc_log_replay", log);
  }

  // scenes and pictures
  load(scene, { seed = 1, parameters = null, file = "scene" } = {}) {
    const id = this.with("sc_scene_load", json(scene), file, parameters === null ? null : json(parameters), seed);
    return new Scene(this, id);
  }
  /** sc_view of options; `layers` is such as "bodies shells". */
  view({ layers, ...options } = {}) {
    const view = { ...this.core.calls.sc_view_init(), ...set(options) };
    if (layers !== undefined) {
      const words = typeof layers === "string" ? layers.split(" ").filter((word) => word !== "") : layers;
      view.layers = words.reduce((sum, word) => sum | choice(word, LAYERS, "a layer"), 0);
    }
    return view;
  }
  /** The draw list of drawPicture(). */
  picture(options = {}) {
    this.with("sc_picture_make", this.view(options));
    return { operations: this.with("sc_picture_operations"), numbers: this.with("sc_picture_numbers"), texts: this.with("sc_picture_texts") };
  }
  sound(seconds) {
    this.with("sc_sound_make", seconds);
    return this.with("sc_sound_samples");
  }
  svg(options = {}) {
    return this.with("sc_picture_svg", this.view(options));
  }
}

export class Scene {
  constructor(world, id) {
    this.world = world;
    this.id = id;
  }
  call(name, ...given) {
    return this.world.core.calls[`sc_scene_${name}`](this.id, ...given);
  }
  step(dt = 1 / 60) {
    return this.call("step", dt);
  }
  get finished() {
    return this.call("finished") !== 0;
  }
  get phase() {
    return this.call("phase");
  }
  get name() {
    return this.call("name");
  }
  get parameters() {
    return JSON.parse(this.call("parameters"));
  }
  get shells() {
    return this.call("shells").map((id) => new Shell(this.world, id));
  }
  get travel() {
    return this.call("travel");
  }
  get force() {
    return this.call("force");
  }
  get valid() {
    return this.call("valid") !== 0;
  }
  destroy() {
    this.call("destroy");
  }
  dispose() {
    if (this.world.id !== 0n && this.valid) this.destroy();
  }
}
