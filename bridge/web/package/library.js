// What load() gives: the classes, bound to one instance of the module.

import { Core, compile } from "../loader/loader.js";
import { makeCalls } from "../loader/calls.js";
import { Body, Force, Hold, Joint, MouseJoint, Part, Shell, Zone, json } from "./parts.js";
import { Scene, World } from "./world.js";

if (Symbol.dispose) for (const kind of [Part, Scene, World]) kind.prototype[Symbol.dispose] = kind.prototype.dispose;

/** The library on an instance of supercircle.wasm: of its bytes, a WebAssembly.Module, a Response, or the file beside. */
export async function load(source = null) {
  const core = await Core.make(await compile(await source));
  core.calls = makeCalls(core);
  class OwnWorld extends World {
    constructor(options) {
      super(core, options);
    }
    static forScene(scene, settings = {}) {
      const { gravity, unitsPerMetre } = core.calls.sc_scene_world_def(json(scene), core.calls.sc_world_def_init());
      return new OwnWorld({ gravity, unitsPerMetre, ...settings });
    }
  }
  Object.defineProperty(OwnWorld, "name", { value: "World" });
  return {
    version: core.calls.sc_version(),
    World: OwnWorld,
    Scene, Shell, Hold, Joint, MouseJoint, Force, Body, Zone,
    checkScene: (scene, file = "scene") => JSON.parse(core.calls.sc_scene_check(json(scene), file)),
    effects: () => JSON.parse(core.calls.sc_effects()),
    scaledShell: (radius, mass, { opening = 0.75, stiffness = 1 } = {}) => core.calls.sc_shell_def_scaled_init(radius, mass, opening, stiffness),
    wav: (samples) => core.calls.sc_sound_wav(samples),
    calls: core.calls,
    constants: CONSTANTS,
  };
}
