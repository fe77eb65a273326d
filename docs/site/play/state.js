// What the page knows, and what it says. The files of the page are joined into one function, in the order of build.py.

const $ = (id) => document.getElementById(id);
const still = matchMedia("(prefers-reduced-motion: reduce)");
const texts = JSON.parse($("scene-texts").textContent);
const FRAME = 1 / 60; // s

const state = {
  name: "snap", text: "", scene: scenes.snap, parameters: {}, known: [], camera: { x: 0, y: 0, scale: 100 }, byHand: false,
  press: 0, drag: undefined, grab: null, release: false, pointer: null, paused: false, slow: false, single: 0, left: 0,
  frame: null, ratio: Math.min(2, devicePixelRatio || 1), simulation: 0, drawing: 0, late: 0, ghost: false, slowUntil: 0,
};

let said = -1000; // ms
/** For screen readers; what is said at one moment is one text. */
function say(words) {
  const now = performance.now();
  $("live").textContent = now - said < 50 ? `${$("live").textContent}. ${words}` : words;
  said = now;
}
/** Offers a text as a file. */
function saveFile(name, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text]));
  link.download = name;
  link.click();
}
const hint = (words) => { $("hint").textContent = words; };

const curve = new Curve($("curve"));
const energies = new Energies($("energy"));
const goals = new Goals($("goals"), say);
const sound = new Sound($("sound"));
const editor = new Editor($("text"), $("problems"), async (text) => {
  const answer = await engine.ask({ kind: "check", text, name: "scene" });
  editor.show(answer.problems ?? []);
});
const pad = new Pad($("pad"), (opening, friction) => {
  touched();
  change({ phi_bar: opening, mu: friction });
});

let engine = null;
let reload = 0, wanted = null; // parameters that are on their way
