// The room: what the file shows, where its nodes are, and its graph that judges the lesson.
import { ArcRotateCamera } from "@babylonjs/core/Cameras/arcRotateCamera.js";
import { Ray } from "@babylonjs/core/Culling/ray.js";
import { Engine } from "@babylonjs/core/Engines/engine.js";
import { FlowGraphCoordinator } from "@babylonjs/core/FlowGraph/flowGraphCoordinator.js";
import { HemisphericLight } from "@babylonjs/core/Lights/hemisphericLight.js";
import { LoadAssetContainerAsync } from "@babylonjs/core/Loading/sceneLoader.js";
import { Matrix, Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { Scene } from "@babylonjs/core/scene.js";
import { byNumber, worldOf } from "./nodes.js";
import "@babylonjs/loaders/glTF/glTFFileLoader.js";
import "@babylonjs/loaders/glTF/2.0/glTFLoader.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/KHR_interactivity.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/KHR_lights_punctual.js";
import "@babylonjs/loaders/glTF/2.0/Extensions/KHR_node_selectability.js";

export async function openRoom(canvas, bytes) {
  const engine = new Engine(canvas, true, { useHighPrecisionMatrix: true });
  const scene = new Scene(engine);
  scene.useRightHandedSystem = true; // glTF's own axes: no node is turned around
  scene.clearColor.set(0.93, 0.94, 0.95, 1);
  new HemisphericLight("sky", new Vector3(0.2, 1, 0.3), scene);
  const container = await LoadAssetContainerAsync(bytes, scene, { pluginExtension: ".glb" });
  container.addAllToScene();
  for (const light of container.lights) light.setEnabled(false); // the sky is enough, and the same in every room
  const extent = scene.getWorldExtends((mesh) => mesh.getTotalVertices() > 0);
  const camera = lookAround(scene, canvas, extent);
  FlowGraphCoordinator.MaxEventTypeExecutionPerFrame = 10000; // no event of a large lesson is lost
  const coordinator = FlowGraphCoordinator.SceneCoordinators.get(scene)?.[0];
  window.addEventListener("resize", () => engine.resize());
  return { engine, scene, camera, coordinator, extent, nodes: byNumber(container) };
}

function lookAround(scene, canvas, { min, max }) {
  const middle = Vector3.Center(min, max), size = Math.max(Vector3.Distance(min, max), 1);
  const camera = new ArcRotateCamera("eye", -Math.PI / 3, Math.PI / 3.4, size * 0.55, middle, scene);
  camera.minZ = 0.02;
  camera.maxZ = size * 10;
  camera.wheelDeltaPercentage = 0.02;
  camera.lowerRadiusLimit = 0.3;
  camera.attachControl(canvas, true);
  return camera;
}

// Turn the eye to a thing, from a side on which nothing hides it, as little turned as can be.
export function lookAt({ scene, camera, extent }, node) {
  const middle = middleOf(node), away = Math.max(Vector3.Distance(extent.min, extent.max) * 0.22, 1);
  const radius = Math.min(camera.radius, away), { alpha, beta } = camera;
  const sides = [0, 1, -1, 2, -2, 3, -3, 4].flatMap((k) => [beta, 1.1, 0.5].map((down) => [alpha + (k * Math.PI) / 4, down]));
  const found = sides.find(([turn, down]) => {
    const way = new Vector3(Math.cos(turn) * Math.sin(down), Math.cos(down), Math.sin(turn) * Math.sin(down));
    let hit = scene.pickWithRay(new Ray(middle.add(way.scale(radius)), way.scale(-1), 2 * radius))?.pickedMesh;
    while (hit && hit !== node) hit = hit.parent;
    return hit === node;
  });
  camera.setTarget(middle);
  Object.assign(camera, { radius, alpha: (found ?? [alpha])[0], beta: (found ?? [0, beta])[1] });
}

// Where an action wants a thing: its reference pose, in the frame that it moves with.
export const goalOf = (room, task) =>
  Matrix.FromArray(task.reference).multiply(worldOf(room.nodes[task.frame]));

export function middleOf(node) {
  const { min, max } = node.getHierarchyBoundingVectors(true);
  return Number.isFinite(min.x) && min.x <= max.x ? Vector3.Center(min, max) : worldOf(node).getTranslation();
}
