// Babylon.js without a browser plays the graph of a room: node engine_test.mjs ROOM.glb TICKS.json
// A tick has its time in seconds, things that move (node: matrix of the world, column by column), events that it sends,
// and nodes that are selected. Printed: the events of each tick, and the median of milliseconds that one takes.
import fs from "node:fs";
globalThis.XMLHttpRequest = class { open() {} send() {} };
const { PerformanceConfigurator } = await import("@babylonjs/core/Engines/performanceConfigurator.js");
PerformanceConfigurator.SetMatrixPrecision(true);
const { NullEngine } = await import("@babylonjs/core/Engines/nullEngine.js");
const { Scene } = await import("@babylonjs/core/scene.js");
const { FreeCamera } = await import("@babylonjs/core/Cameras/freeCamera.js");
const { AppendSceneAsync } = await import("@babylonjs/core/Loading/sceneLoader.js");
const { Matrix, Vector3 } = await import("@babylonjs/core/Maths/math.vector.js");
const { FlowGraphCoordinator } = await import("@babylonjs/core/FlowGraph/flowGraphCoordinator.js");
const { PickingInfo } = await import("@babylonjs/core/Collisions/pickingInfo.js");
const { PointerEventTypes, PointerInfo } = await import("@babylonjs/core/Events/pointerEvents.js");
await import("@babylonjs/loaders/glTF/2.0/index.js");
const { byNumber, place } = await import("./nodes.js");

const [room, ticks] = process.argv.slice(2).map((name) => fs.readFileSync(name));
const engine = new NullEngine(), scene = new Scene(engine);
scene.useRightHandedSystem = true;
scene.useConstantAnimationDeltaTime = true; // what moves by itself moves for 16 ms in each tick
new FreeCamera("eye", Vector3.Zero(), scene);
await AppendSceneAsync(new Uint8Array(room), scene, { pluginExtension: ".glb" });
for (const mesh of scene.meshes) mesh.isVisible = false; // nothing is drawn here
const nodes = byNumber(scene), told = [], spent = [];
const coordinator = FlowGraphCoordinator.SceneCoordinators.get(scene)?.[0];
FlowGraphCoordinator.MaxEventTypeExecutionPerFrame = 10000;
if (!coordinator) throw new Error("the engine has refused the graph");
for (const event of ["started", "performed", "skipped", "early", "failed"]) {
  coordinator.getCustomEventObservable(`unisg:${event}`).add((values) => {
    const [[name, value]] = Object.entries(values);
    told.at(-1).push([event, name, Number(value?.value ?? value)]);
  });
}
let began = 0, last = null;
scene.onBeforeRenderObservable.add(() => { began = performance.now(); }, -1, true);
scene.onBeforeRenderObservable.add(() => spent.push(performance.now() - began));
for (const { time, moved = {}, sent = [], selected = [] } of JSON.parse(ticks)) {
  told.push([]);
  for (const [node, matrix] of Object.entries(moved)) place(nodes[node], Matrix.FromArray(matrix));
  for (const [event, values] of sent) coordinator.notifyCustomEvent(event, values, false);
  for (const node of selected) select(nodes[node]);
  const step = last === null ? 0 : (time - last) * 1000;
  engine.getDeltaTime = () => step;
  last = time;
  frame();
}
told.push([]);
frame(); // the engine hands on in a frame what the graph sent in the one before
const middle = spent.sort((a, b) => a - b)[spent.length >> 1];
console.log(JSON.stringify({ told: told.slice(1), milliseconds: middle }));

function frame() {
  engine.beginFrame();
  scene.render();
  engine.endFrame();
}

function select(node) {
  const mesh = [node, ...node.getChildMeshes()].find((each) => each.geometry) ?? node;
  const hit = Object.assign(new PickingInfo(), { hit: true, pickedMesh: mesh, pickedPoint: mesh.getAbsolutePosition() });
  scene.onPointerObservable.notifyObservers(new PointerInfo(PointerEventTypes.POINTERPICK, { pointerId: 0 }, hit));
}
