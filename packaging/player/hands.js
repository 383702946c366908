// What a learner's hands do: drag things, let them find their place, use tools. Everything is judged by the graph.
import { Matrix, Plane, Quaternion, Vector3 } from "@babylonjs/core/Maths/math.js";
import { PointerEventTypes } from "@babylonjs/core/Events/pointerEvents.js";
import { parts, place, worldOf } from "./nodes.js";
import { goalOf, middleOf } from "./room.js";

const REACH = 0.15; // metres from its place at which a thing that is let go finds it

export function dragThings(room, movable, isOpen, tasks) {
  const numbers = new Map(movable.map((number) => [room.nodes[number], number]));
  let held = null;
  const thingOf = (node) => {
    for (; node; node = node.parent) if (numbers.has(node)) return node;
    return null;
  };
  room.scene.onPointerObservable.add(({ type, event }) => {
    if (type === PointerEventTypes.POINTERDOWN) {
      const hit = room.scene.pick(room.scene.pointerX, room.scene.pointerY, (mesh) => thingOf(mesh) !== null);
      if (!hit.hit) return;
      const node = thingOf(hit.pickedMesh);
      const plane = Plane.FromPositionAndNormal(hit.pickedPoint, room.camera.getForwardRay().direction);
      held = { node, plane, offset: node.getAbsolutePosition().subtract(hit.pickedPoint) };
      room.camera.detachControl();
    } else if (type === PointerEventTypes.POINTERMOVE && held) {
      const ray = room.scene.createPickingRay(room.scene.pointerX, room.scene.pointerY, Matrix.Identity(), room.camera);
      const far = ray.intersectsPlane(held.plane);
      if (far !== null) held.node.setAbsolutePosition(ray.origin.add(ray.direction.scale(far)).add(held.offset));
    } else if (type === PointerEventTypes.POINTERUP && held) {
      settle(room, numbers.get(held.node), isOpen, tasks, room.camera.getForwardRay().direction);
      held = null;
      room.camera.attachControl(room.engine.getRenderingCanvas(), true);
    }
  });
}

// The number of the thing that a mesh is part of, null for none.
export function numberOf(room, movable, mesh) {
  for (let node = mesh; node; node = node.parent) {
    const number = movable.find((each) => room.nodes[each] === node);
    if (number !== undefined) return number;
  }
  return null;
}

// What is let go near its place finds it; along a direction of sight, where depth is hard to judge, that counts as near.
export function settle(room, number, isOpen, tasks, ahead = Vector3.Zero()) {
  const node = room.nodes[number];
  for (const task of tasks) {
    const asked = task.type === "Tool" ? task.tools : task.targets;
    if (!task.reference || task.type === "Remove" || !isOpen(task) || !asked.includes(number)) continue;
    const goal = goalOf(room, task);
    const way = parts(goal).position.subtract(worldOf(node).getTranslation());
    const gap = way.subtract(ahead.scale(Vector3.Dot(way, ahead))).length();
    if (gap <= Math.max(REACH, 2 * (task.distance ?? 0))) return place(node, goal);
  }
}

export function turn(node, axis) {
  const { rotation, position } = parts(worldOf(node));
  const turned = Quaternion.RotationAxis(axis, Math.PI / 12).multiply(rotation);
  place(node, Matrix.Compose(Vector3.One(), turned, position));
}

// Bring one thing to another's middle.
export function bring(node, other) {
  node.setAbsolutePosition(node.getAbsolutePosition().add(middleOf(other).subtract(middleOf(node))));
}

// Take a thing away from where it is, and turn it.
export function takeAway(node, distance) {
  node.setAbsolutePosition(node.getAbsolutePosition().add(new Vector3(0, distance, 0)));
  turn(node, Vector3.Right());
}
