// Types of the package `supercircle`. SI units, angles in rad; arrays are copies. What stands below `Calls` and the
// records above it is made by bridge/web/generate.py from bridge/c/api.json.

/** x and y. */
export type Point = [number, number];
/** What is taken for a point. */
export type PointLike = readonly [number, number] | Float64Array | { x: number; y: number };
/** Points, or x and y in turn. */
export type Points = readonly PointLike[] | Float64Array | null;
/** One number for all elements, or one each. */
export type Numbers = number | ArrayLike<number> | null;
/** A part of a world, or the number that stands for it; null: none. */
export type Handle = bigint | { readonly id: bigint } | null;
/** A scene as an object or as JSON text; a page or program reads its file itself. */
export type SceneSource = object | string;

type Compilable = ArrayBuffer | ArrayBufferView | Global<"Response"> | (typeof globalThis extends { WebAssembly: { Module: { prototype: infer T } } } ? T : never);
/** What a module may come from: bytes, a Response, a WebAssembly.Module, or a promise of one; left out: the file beside the package. */
export type Source = Compilable | Promise<Compilable> | null;
/** The library on an instance of supercircle.wasm. */
export function load(source?: Source): Promise<Supercircle>;

/** Files by path: texts, or bytes in any encoding that an import understands. */
export type Content = { [path: string]: string | Uint8Array };
/** A request as docs/reference/lab_requests.md describes it. */
export interface LabRequest {
  /** The files that the request names. */
  content?: Content;
  [key: string]: unknown;
}
/** The laboratory: a request in, an answer out, as the program's import, replay and diagnose. */
export interface Lab {
  /** Reads exports of testing machines as an experiment: account, and files with experiment.json. */
  import(request: LabRequest): { status: string; account: string; assumed: string[]; missing: string[]; files: { [name: string]: string }; [key: string]: unknown };
  /** Simulates a recorded experiment and compares. */
  replay(request: LabRequest): { status: string; message: string; notes: string[]; replay: object; curves: ReplayedCurve[] };
  /** Finds what physics a simulation of a recorded experiment leaves out. Takes minutes. */
  diagnose(request: LabRequest): { status: string; message: string; notes: string[]; diagnosis?: object };
}
/** Readings of a run and channel, in its unit; null: missing. */
export interface ReplayedCurve {
  /** Name of the run. */
  run: string;
  /** What was recorded, such as force_N. */
  channel: string;
  /** Of recorded and simulated readings. */
  unit: string;
  /** Since the beginning of the run. */
  time_s: (number | null)[];
  /** Of the crosshead. */
  displacement_m: (number | null)[];
  /** By the machine. */
  recorded: (number | null)[];
  /** At the same moments. */
  simulated: (number | null)[];
}
/**
 * The laboratory on an instance of supercircle_lab.wasm. Its calls block until they are done.
 * @param progress called about ten times a second with a number from 0 to 1 and a stage; false cancels
 */
export function loadLab(source?: Source | URL, progress?: ((fraction: number, stage: string) => boolean | void) | null): Promise<Lab>;

/** What a page draws: operations with their numbers and texts, in pixels (docs/reference/picture.md). */
export interface Picture {
  /** Kind and count of numbers of each operation. */
  operations: Int32Array;
  /** Of all operations, one after the other. */
  numbers: Float32Array;
  /** Of all operations, one after the other. */
  texts: string;
}
type Global<Name extends string> = typeof globalThis extends { [name in Name]: { prototype: infer T } } ? T : never;
/** Draws a picture into a 2D context of a canvas. */
export function drawPicture(context: Global<"CanvasRenderingContext2D">, operations: Int32Array, numbers: Float32Array, texts: string | Uint8Array): void;

/** A refused call; it has changed nothing. */
export class SupercircleError extends Error {
  /** Why it was refused. */
  readonly kind: "bad_input" | "stale" | "busy" | "refused" | "failed" | "out_of_memory" | "wrong_version";
  /** The same as a number: SC_BAD_INPUT ... */
  readonly status: number;
  /** The Frame of a failed step. */
  readonly result?: unknown;
}

/** The library that `load` gives. */
export interface Supercircle {
  /** Such as "0.2.0". */
  readonly version: string;
  readonly World: {
    /** An empty world. */
    new (options?: WorldOptions): World;
    /** A world with the gravity and Box2D units that a scene wants. */
    forScene(scene: SceneSource, settings?: WorldOptions): World;
  };
  /** Problems of a scene; [] if it is valid and there is nothing to remark. */
  checkScene(scene: SceneSource, file?: string): Problem[];
  /** The catalogue of effects, for setEffect. */
  effects(): EffectInfo[];
  /** For games: a shell of radius (m) and mass (kg) that sags, rolls and snaps as the paper's does, for createShell. */
  scaledShell(radius: number, mass: number, options?: { /** opening angle / 2 pi, 0.75 */ opening?: number; /** times the paper's bending stiffness, 1 */ stiffness?: number }): ShellDef;
  /** Samples of World.sound as a WAV file: mono, 48000 a second. */
  wav(samples: Float32Array): Uint8Array;
  /** The C interface, call by call. */
  readonly calls: Calls;
  /** Of the C interface, such as SC_BODY_DYNAMIC. */
  readonly constants: Constants;
  /** For `instanceof`. */
  readonly Scene: abstract new (...given: never[]) => Scene;
  readonly Shell: abstract new (...given: never[]) => Shell;
  readonly Hold: abstract new (...given: never[]) => Hold;
  readonly Joint: abstract new (...given: never[]) => Joint;
  readonly MouseJoint: abstract new (...given: never[]) => MouseJoint;
  readonly Force: abstract new (...given: never[]) => Force;
  readonly Body: abstract new (...given: never[]) => Body;
  readonly Zone: abstract new (...given: never[]) => Zone;
}

/** Of a new world; left out: earth's gravity, laboratory quality, metres. */
export interface WorldOptions {
  /** Acceleration of everything, m/s^2. */
  gravity?: PointLike;
  /** "laboratory": every step as short as its error bound asks for; "game": steps of up to a frame. */
  quality?: Quality;
  /** Box2D length units per metre; about 50 for bodies of some centimetres. */
  unitsPerMetre?: number;
  /** Of Box2D, 8. */
  velocityIterations?: number;
  /** Of Box2D, 3. */
  positionIterations?: number;
}
/** How exactly shells are simulated: "laboratory" for measurements, "game" for frames in time. */
export type Quality = "laboratory" | "game";

/** Shells and rigid bodies (Box2D inside). dispose() ends it; a world that is forgotten ends when it is collected. */
export interface World {
  /** Its handle; 0n once it has ended. */
  readonly id: bigint;
  /** Whether it still exists. */
  readonly valid: boolean;
  /** Ends the world with all that is in it. */
  dispose(): void;
  /** Any call of the C interface whose first argument is the world. */
  with(name: keyof Calls, ...given: unknown[]): unknown;

  /** Advances shells and bodies by `dt` (s); 0 is a pause. An error of kind "failed" has the Frame as `result`. */
  step(dt?: number): Frame;
  /** Simulated time, s. */
  readonly time: number;
  /** Hash of the shells' state; equal states have equal hashes on every machine. */
  readonly hash: bigint;
  /** Energy balance of the shells. */
  readonly energy: Energy;
  /** Texts of the last step. */
  readonly report: { failure: string; why: string; refused: string; note: string };
  /** What happened in the last step, in the order of time. */
  events(): WorldEvent[];

  /** Acceleration of everything, m/s^2. */
  get gravity(): Point;
  set gravity(value: PointLike);
  /** "laboratory" or "game"; setting it resets the numerics. */
  quality: Quality;
  /** Work a step, about 1 us of a core each; 0: no limit. Game quality only. */
  setFrameBudget(work: number): void;
  /** What becomes of crushed shells. */
  setCrushPolicy(policy: "wait" | "stop" | "freeze"): void;
  /** Whether quarantined shells move again. */
  readonly recovery: Recovery;
  /** What becomes of quarantined shells. */
  setRecovery(recovery: Partial<Recovery>): void;
  /** The present settings of sleep. */
  readonly sleep: Sleep;
  /** When shells at rest fall asleep. */
  setSleep(sleep: Partial<Sleep>): void;
  /** The present thresholds of events. */
  readonly eventSettings: EventSettings;
  /** What counts as an impulse or a snap. */
  setEventSettings(settings: Partial<EventSettings>): void;
  /** Coefficient between two friction materials; negative: back to the geometric mean. */
  setFriction(a: number, b: number, friction: number): void;
  /** Moves the origin of the coordinates to a point (m). */
  shiftOrigin(origin: PointLike): void;

  /** A new shell; what is not given is as in the paper (PET-G, R = 19.2 mm, h = 0.5 mm, opening 0.75). */
  createShell(definition?: ShellDefinition): Shell;
  /** Whether such a shell would cross nothing. */
  fits(definition?: ShellDefinition): boolean;
  /** All shells in the order of creation. */
  shells(): Shell[];
  /** The first shell of that name. */
  findShell(name: string): Shell;
  /** Centre lines of all shells at equal distances along each, m: x and y in turn. */
  shapes(points?: number): Float64Array[];
  /** Replaces the effects of all shells by a list, as "effects" of a scene. */
  setEffects(effects: object[] | string): void;
  /** Switches an effect of all shells on or changes it. */
  setEffect(key: string, values?: Record<string, number | string>): void;
  /** Removes an effect of all shells. */
  removeEffect(key: string): void;

  /** A rigid body of one shape about its origin; several shapes and joints come by add(). */
  createBody(definition: BodyDefinition): Body;
  /** Adds bodies, joints, shells, holds and effects from scene JSON; gravity and scale stay. */
  add(fragment: SceneSource): void;
  /** All bodies, oldest first. */
  bodies(): Body[];
  /** The body of that name. */
  findBody(name: string): Body;
  /** Grabs the dynamic body at a point (m) with at most `maxForce` (N; 0: mass times 1000 m/s^2). */
  grabBody(at: PointLike, maxForce?: number): MouseJoint;

  /** The crosshead carries that kinematic body, and holds with base "moving". */
  attachCrosshead(body: string): void;
  /** Velocity of the crosshead, m/s. */
  setCrossheadVelocity(velocity: PointLike): void;
  /** Force of the shells on the crosshead in the last step, N. */
  readonly crossheadForce: Point;

  /** Every point where the ray enters a shell, in the order along the ray. */
  rayCast(start: PointLike, end: PointLike, mask?: number): HitPoint[];
  /** The surface point closest to a point (m). Refused: none within `maxDistance` (m). */
  closestPoint(to: PointLike, maxDistance?: number, mask?: number): HitPoint;
  /** The shells whose material is at a point (m). */
  overlapPoint(at: PointLike, mask?: number): Shell[];
  /** The shells that touch a box (m). */
  overlapBox(lower: PointLike, upper: PointLike, mask?: number): Shell[];
  /** The shells that touch a circle (m). */
  overlapCircle(centre: PointLike, radius: number, mask?: number): Shell[];
  /** A box (m) that reports shells which enter and leave it. */
  createZone(lower: PointLike, upper: PointLike): Zone;

  /** The state of shells and bodies. */
  save(): Uint8Array;
  /** Back to a state of a world with the same bodies; those made since then stay. Shells are valid again if it is one of the last sixteen saves of
   * this world; else shells() lists new ones. */
  restore(state: Uint8Array): void;
  /** Records every call that changes shells. `seed` is your own. */
  startLog(seed?: number | bigint): void;
  /** The calls since startLog; goes on recording. */
  readLog(): Uint8Array;
  /** Ends the recording. */
  stopLog(): void;
  /** Repeats the calls of a log in a world with the bodies of its start. */
  replayLog(log: Uint8Array): void;

  /** Creates bodies, joints, shells and holds of a scene, to be played by Scene.step. */
  load(scene: SceneSource, options?: { /** of its random drop */ seed?: number | bigint; parameters?: Record<string, number>; /** in messages */ file?: string }): Scene;
  /** The definition of a picture. */
  view(options?: ViewOptions): View;
  /** The draw list of drawPicture. */
  picture(options?: ViewOptions): Picture;
  /** The next `seconds` of what is heard: mono, 48000 samples a second between -1 and 1. */
  sound(seconds: number): Float32Array;
  /** The world as an SVG element. */
  svg(options?: ViewOptions): string;
}

/** What a picture shows; left out: everything, and it fits. */
export type ViewOptions = Omit<Partial<View>, "layers" | "centre"> & {
  /** Such as "bodies shells", of bodies, shells, strain, contacts, forces, holds, snaps; left out: all. */
  layers?: string | readonly string[];
  /** Of the picture, m. */
  centre?: PointLike;
};
/** A shell; what is left out is as in the paper. */
export type ShellDefinition = Omit<Partial<ShellDef>, "position" | "velocity"> & {
  /** By which findShell finds it. */
  name?: string;
  /** Of the middle of the shell, m. */
  position?: PointLike;
  /** Of all its points, m/s. */
  velocity?: PointLike;
  /** 1/m; left out: 1 / radius */
  naturalCurvature?: Numbers;
  /** At the start, 1/m, one each; left out: the natural one. */
  curvature?: ArrayLike<number> | null;
};

/** One of box, circle, polygon and line. */
export type BodyDefinition = Omit<Partial<BodyDef>, "type" | "shape" | "width" | "height" | "radius" | "position" | "velocity"> & {
  /** By which findBody finds it. */
  name?: string;
  /** "dynamic" if left out. */
  type?: "static" | "kinematic" | "dynamic";
  /** Width and height, m. */
  box?: PointLike;
  /** Radius, m. */
  circle?: number;
  /** 3 to 8 corners, m, convex. */
  polygon?: Points;
  /** 2 or more points, m, solid from both sides. */
  line?: Points;
  /** Of its origin, m. */
  position?: PointLike;
  /** m/s */
  velocity?: PointLike;
};

/** A scene that is played in a world. */
export interface Scene {
  /** In which it is played. */
  readonly world: World;
  /** Its handle. */
  readonly id: bigint;
  /** Advances the scene and its world by at most `dt` (s). */
  step(dt?: number): Frame;
  /** Whether it reached the end of its protocol or duration, or failed. */
  readonly finished: boolean;
  /** What its protocol does: "drop 7", "settle", "approach", "load 1", "unload 1", "hold", "free", "done". */
  readonly phase: string;
  /** Of the scene. */
  readonly name: string;
  /** Values in use, with bounds, unit and meaning. */
  readonly parameters: { name: string; value: number; min: number | null; max: number | null; unit: string; about: string }[];
  /** Its shells in the order of creation. */
  readonly shells: Shell[];
  /** Displacement of the crosshead along its direction, m. */
  readonly travel: number;
  /** Force on the crosshead, N; positive while the specimen resists. */
  readonly force: number;
  /** Whether it still exists. */
  readonly valid: boolean;
  /** Ends the scene; its bodies and shells stay. */
  destroy(): void;
  /** Ends it if it still exists. */
  dispose(): void;
}

/** Something in a world. */
export interface Part {
  /** In which it is. */
  readonly world: World;
  /** Its handle: a key for maps. */
  readonly id: bigint;
  /** Such as "shell". */
  readonly kind: string;
  /** Whether it still exists. */
  readonly valid: boolean;
  /** Whether both stand for the same thing. */
  equals(other: unknown): boolean;
  /** Removes it from the world. */
  destroy(): void;
  /** Removes it if it still exists. */
  dispose(): void;
}

/** A flexible shell. Places on it are arc fractions from 0 to 1; 0.5 is the middle. */
export interface Shell extends Part {
  /** Its name; may be set. */
  name: string;
  /** Mass, centre, momentum, energies, strain and box. */
  readonly state: ShellState;
  /** Position, motion, curvature, moment and strain at a place. */
  section(arc: number): Section;
  /** The centre line, m, x and y in turn; deviates from it by at most `tolerance` (m). */
  polyline(tolerance?: number): Float64Array;
  /** Curvature of each element, 1/m. */
  curvatures(): Float64Array;
  /** Position (m) and angle (rad) of the first end, and curvatures (1/m), between the start (0) and the end (1) of the
   * last step. */
  pose(alpha?: number): { position: Point; angle: number; curvatures: Float64Array };
  /** Points of the centre line at equal distances along it, m, x and y in turn. */
  points(count?: number): Float64Array;
  /** Moves the middle to a position (m) with its tangent at an angle (rad). */
  teleport(position: PointLike, angle?: number): void;
  /** Velocity of the middle (m/s) and spin (rad/s) of a rigid motion. */
  setVelocity(velocity: PointLike, spin?: number): void;
  /** Friction, stiffness, density, damping; what is not given stays. */
  setMaterial(change: Partial<Material>): void;
  /** Curvature at rest, 1/m: one number for all elements or one each. */
  setNaturalCurvature(curvature: Numbers): void;
  /** A number of yours; 0: none. World.setFriction gives the coefficient of two materials. */
  setFrictionMaterial(material: number): void;
  /** Which other shells and bodies it meets. */
  readonly filter: Filter;
  /** Category, mask and group as in Box2D, 16 bits each. */
  setFilter(filter: Partial<Filter>): void;
  /** Wakes its island, or puts it to sleep. */
  setAwake(awake?: boolean): void;
  /** A number of yours, 64 bits. */
  get userData(): bigint;
  set userData(value: number | bigint);
  /** Force (N) and torque (N m) during the coming step; several add up. */
  applyForce(arc: number, force: PointLike, torque?: number): void;
  /** Impulse (N s) and angular impulse (N m s), at once. */
  applyImpulse(arc: number, impulse: PointLike, angular?: number): void;
  /** Effects with all their values, as in a scene. */
  get effects(): Record<string, unknown>[];
  set effects(effects: object[] | string);
  /** Switches an effect on or changes it: shell.setEffect("planar_drag", { f_N_m: 0.2 }). */
  setEffect(key: string, values?: Record<string, number | string>): void;
  /** Switches an effect off. */
  removeEffect(key: string): void;
  /** Holds a place where it is: a clamp also its angle; a "moving" base goes with the crosshead. */
  hold(arc?: number, options?: { kind?: "pin" | "clamp"; base?: "fixed" | "moving" }): Hold;
  /** Joins a place with another shell, a body, or the world (null). */
  join(other?: Shell | Body | null, options?: JoinOptions): Joint;
  /** A soft spring from a place to a target (m). */
  grab(arc: number, target: PointLike, options?: { /** Hz */ frequency?: number; dampingRatio?: number; /** N; 0: mass times 1000 m/s^2 */ maxForce?: number }): MouseJoint;
  /** Force (N) and torque (N m) that last until they are changed or destroyed. */
  push(arc: number, force: PointLike, torque?: number): Force;
  /** The point of its surface closest to a point (m). */
  closestPoint(to: PointLike): HitPoint;
}

/** How two places are joined. */
export interface JoinOptions {
  /** "pin" turns freely, "weld" does not, "tether" is a rope. */
  kind?: "pin" | "weld" | "tether";
  /** Place on this shell. */
  arc?: number;
  /** Place on the other shell. */
  otherArc?: number;
  /** Of a tether to a body or the world: its other end, m. */
  point?: PointLike;
  /** Of a tether, m; 0: the present distance. */
  length?: number;
  /** Whether the two collide with each other. */
  collideConnected?: boolean;
}

/** A place of a shell that is fixed or driven. */
export interface Hold extends Part {
  /** Where it is to be at the end of the coming step. */
  readonly target: Target;
  /** Position (m) and angle (rad, clamps only) at the end of the coming step; velocity (m/s) and spin (rad/s) then. */
  setTarget(position: PointLike, options?: { angle?: number; velocity?: PointLike; spin?: number }): void;
  /** Force (N) and torque (N m) on the shell, mean over the last step. */
  readonly reaction: Reaction;
  /** Sets the largest force, N; 0: any. A hold that needed more breaks. */
  setMaxForce(force: number): void;
}

/** A joint of a shell with a shell, a body or the world. */
export interface Joint extends Part {
  /** Of a tether to the world: where it is tied to. */
  readonly target: Target;
  /** Of a tether to the world: its other end moves there (m), with that velocity (m/s). */
  setTarget(position: PointLike, options?: { velocity?: PointLike }): void;
  /** Present length of a tether, m. */
  readonly length: number;
  /** Makes a tether longer or shorter at `rate` (m/s) until it has `length` (m). */
  setMaxLength(length: number, rate: number): void;
  /** Force (N) and torque (N m) on the shell, mean over the last step. */
  readonly reaction: Reaction;
  /** Sets the largest force, N; 0: any. A joint that needed more breaks. */
  setMaxForce(force: number): void;
}

/** A soft spring from a shell or body to a target. */
export interface MouseJoint extends Part {
  /** The target moves to a point (m). */
  move(target: PointLike): void;
  /** Of a grabbed body: force (N) on it, mean over the last step. */
  readonly reaction: Reaction;
}

/** A lasting force on a shell. */
export interface Force extends Part {
  /** Changes force (N) and torque (N m). */
  set(force: PointLike, torque?: number): void;
}

/** A rigid body of Box2D. World.add makes bodies from scene JSON. */
export interface Body extends Part {
  /** Motion, mass and type. */
  readonly state: BodyState;
  /** Position of the centre of mass (m) and angle (rad). */
  setPose(centre: PointLike, angle?: number): void;
  /** Velocity of the centre of mass (m/s) and spin (rad/s); wakes it. */
  setVelocity(velocity: PointLike, spin?: number): void;
  /** Impulse (N s) at a point (m); wakes it. Dynamic bodies only. */
  applyImpulse(impulse: PointLike, at: PointLike): void;
  /** Outline of each fixture in the world, m, x and y in turn; a chain is open. Circles have 32 points. */
  outlines(): Float64Array[];
  /** A number of yours; 0: none. World.setFriction gives the coefficient of two materials. */
  setFrictionMaterial(material: number): void;
  /** A conveyor: speed (m/s) of the surface of a fixture, or of all (-1). */
  setSurfaceSpeed(speed: number, fixture?: number): void;
}

/** A box whose shells are watched. Zones are not saved. */
export interface Zone extends Part {
  /** The shells inside at the end of the last step. */
  readonly shells: Shell[];
}

/** A point on a shell that a query has found. */
export type HitPoint = Omit<Hit, "shell" | "arcFraction"> & {
  /** The shell that was found. */
  shell: Shell;
  /** Arc fraction of the closest point of its centre line. */
  arc: number;
};
/** Something that happened in the last step; what its kind does not have is null or 0. */
export type WorldEvent = Omit<Event, "kind" | "a" | "b" | "body" | "zone" | "hold" | "joint"> & {
  /** What happened. */
  kind: "contact_begin" | "contact_end" | "impulse" | "snap_begin" | "snap_end" | "quarantined" | "crushed" | "broke" | "overlap" | "hold_blocked" | "zone_enter" | "zone_leave";
  /** The shell that it happened to. */
  a: Shell | null;
  /** The other shell; null where the other is a body. */
  b: Shell | null;
  /** The other body. */
  body: Body | null;
  /** Of zone_enter and zone_leave. */
  zone: Zone | null;
  /** Of broke and hold_blocked. */
  hold: Hold | null;
  /** Of broke. */
  joint: Joint | null;
};
/** What is wrong or odd in a scene. Line and column count from 1; 0: it has no place. */
export interface Problem {
  /** From 1. */
  line: number;
  /** From 1. */
  column: number;
  /** JSON pointer of the place. */
  pointer: string;
  /** What is wrong. */
  what: string;
  /** What could stand there. */
  expected: string;
  /** The known name that was perhaps meant. */
  nearest: string;
  /** Whether it is only a remark. */
  note: boolean;
  /** All in one sentence. */
  text: string;
}
/** An entry of the catalogue of effects. */
export interface EffectInfo {
  /** For setEffect. */
  key: string;
  /** material, load, contact, apparatus or sensor. */
  slot: string;
  /** In words. */
  about: string;
  /** Its formula. */
  law: string;
  /** Name, unit, bounds and default of each. */
  parameters: Record<string, unknown>[];
}
