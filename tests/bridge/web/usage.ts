// A program in TypeScript that uses every class: `tsc --strict` must accept it, and refuse the lines marked so.
import { drawPicture, load, loadLab, SupercircleError, type Frame, type Shell, type Supercircle, type World } from "supercircle";

const sc: Supercircle = await load();
const world: World = sc.World.forScene({ schema: "supercircle-scene/1" }, { quality: "game" });
const own = new sc.World({ gravity: { x: 0, y: -9.81 } });
const shell: Shell = own.createShell({ name: "a", position: [0, 1], naturalCurvature: [1, 2, 3], youngModulus: 2e9 });
const frame: Frame = own.step(1 / 60);
const line: Float64Array = shell.polyline();
const [x, y] = shell.state.centre;
const hold = shell.hold(0.5, { kind: "clamp", base: "fixed" });
hold.setTarget([x, y], { angle: 0.1 });
const joint = shell.join(own.createShell(), { kind: "weld" });
const spring = shell.grab(0.2, [0, 0], { frequency: 5 });
spring.move({ x: 1, y: 2 });
const push = shell.push(0.1, [0, 1]);
const zone = own.createZone([0, 0], [1, 1]);
for (const event of own.events()) if (event.kind === "snap_end" && event.a !== null) console.log(event.energyReleased, event.a.name);
const scene = world.load("{}", { seed: 2n, parameters: { mu: 0.3 } });
const played: boolean = scene.finished;
const hash: bigint = own.hash;
own.add({ body: [] });
own.findBody("b").setVelocity([0, 1]);
own.createBody({ name: "crate", box: [0.6, 0.4], position: [0, 2], density: 2 }).setPose([1, 1]);
own.createBody({ type: "static", line: [[-1, 0], { x: 1, y: 0 }] });
own.createShell({ ...sc.scaledShell(1, 2, { stiffness: 3 }), position: [0, 4] });
for (const hit of own.rayCast([0, 1], [0, -1])) console.log(hit.shell.id, hit.normal[1]);
const state: Uint8Array = own.save();
const raw: Float64Array = sc.calls.sc_shell_polyline(own, shell, 1e-5);
const svg: string = own.svg({ width: 100, layers: "bodies shells", centre: [0, 0] });
const { operations, numbers, texts } = own.picture({ width: 100, pixelRatio: 2, reducedMotion: true });
const draw = (context: CanvasRenderingContext2D) => drawPicture(context, operations, numbers, texts);
if (shell instanceof sc.Shell) shell.dispose();
try {
  own.step(Number.NaN);
} catch (error) {
  if (error instanceof SupercircleError) console.log(error.kind, error.message);
}
console.log(frame.leftOut, line, joint.reaction.force, push.valid, zone.shells, played, hash, state, raw, svg, draw, sc.effects()[0].key);

const lab = await loadLab(null, (fraction, stage) => fraction < 0.5 || stage === "");
const files: { [name: string]: string } = lab.import({ files: ["a.csv"], content: { "a.csv": new Uint8Array(3) } }).files;
const gap: number | null = lab.replay({ file: "experiment.json", content: files }).curves[0].simulated[0];
console.log(gap);

// @ts-expect-error
lab.replay({ content: { a: 3 } });
// @ts-expect-error
own.createShell({ radus: 1 });
// @ts-expect-error
own.createBody({ circle: "big" });
// @ts-expect-error
own.quality = "best";
// @ts-expect-error
own.step("now");
// @ts-expect-error
shell.hold(0.5, { kind: "glue" });
// @ts-expect-error
sc.calls.sc_world_step(own);
