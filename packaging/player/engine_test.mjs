// Babylon.js without a browser plays the graphs of rooms: node engine_test.mjs ROOM.glb TICKS.json [ROOM.glb TICKS.json ...]
// A tick has its time in seconds, things that move (node: matrix of the world, column by column), events that it sends,
// and nodes that are selected. Printed, a line for each room: the events of each tick, and the median of milliseconds of processor time.
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

const [, , ...files] = process.argv;
FlowGraphCoordinator.MaxEventTypeExecutionPerFrame = 10000;
for (let k = 0; k < files.length; k += 2) console.log(JSON.stringify(await play(...files.slice(k, k + 2).map((name) => fs.readFileSync(name)))));

async function play(room, ticks) {
  const engine = new NullEngine(), scene = new Scene(engine);
  scene.useRightHandedSystem = true;
  scene.useConstantAnimationDeltaTime = true; // what moves by itself moves for 16 ms in each tick
  new FreeCamera("eye", Vector3.Zero(), scene);
  await AppendSceneAsync(new Uint8Array(room), scene, { pluginExtension: ".glb" });
  for (const mesh of scene.meshes) mesh.isVisible = false; // nothing is drawn here
  const nodes = byNumber(scene), told = [], spent = [];
  const coordinator = FlowGraphCoordinator.SceneCoordinators.get(scene)?.[0];
  if (!coordinator) throw new Error("the engine has refused the graph");
  for (const event of ["started", "performed", "skipped", "early", "failed"]) {
    coordinator.getCustomEventObservable(`unisg:${event}`).add((values) => {
      const [[name, value]] = Object.entries(values);
      told.at(-1).push([event, name, Number(value?.value ?? value)]);
    });
  }
  let began = 0;
  scene.onBeforeRenderObservable.add(() => { began = used(); }, -1, true);
  scene.onBeforeRenderObservable.add(() => spent.push(used() - began));
  const all = JSON.parse(ticks);
  for (const [k, { time, moved = {}, sent = [], selected = [] }] of all.entries()) {
    told.push([]);
    for (const [node, matrix] of Object.entries(moved)) place(nodes[node], Matrix.FromArray(matrix));
    for (const [event, values] of sent) coordinator.notifyCustomEvent(event, values, false);
    for (const node of selected) select(scene, nodes[node]);
    const step = ((all[k + 1]?.time ?? time) - time) * 1000;
    engine.getDeltaTime = () => step; // the engine's clock goes on after a tick, not before it
    frame(engine, scene);
  }
  told.push([]);
  frame(engine, scene); // the engine hands on in a frame what the graph sent in the one before
  engine.dispose();
  return { told: told.slice(1), milliseconds: spent.sort((a, b) => a - b)[spent.length >> 1] };
}

// Milliseconds of this process, however many others wait for the processor.
function used() {
  const { user, system } = process.cpuUsage();
  return (user + system) / 1000;
}

function frame(engine, scene) {
  engine.beginFrame();
  scene.render();
  engine.endFrame();
}

function select(scene, node) {
  const mesh = [node, ...node.getChildMeshes()].find((each) => each.geometry) ?? node;
  const hit = Object.assign(new PickingInfo(), { hit: true, pickedMesh: mesh, pickedPoint: mesh.getAbsolutePosition() });
  scene.onPointerObservable.notifyObservers(new PointerInfo(PointerEventTypes.POINTERPICK, { pointerId: 0 }, hit));
}
