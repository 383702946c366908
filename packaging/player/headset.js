// With a headset: both controllers grab by their squeeze, the trigger uses what is held, or answers what the board asks.
import { WebXRExperienceHelper } from "@babylonjs/core/XR/webXRExperienceHelper.js";
import { WebXRSessionManager } from "@babylonjs/core/XR/webXRSessionManager.js";
import { Ray } from "@babylonjs/core/Culling/ray.js";
import { Matrix, Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { CreateSphere } from "@babylonjs/core/Meshes/Builders/sphereBuilder.js";
import { Board } from "./board.js";
import { numberOf } from "./hands.js";
import { place, worldOf } from "./nodes.js";

const REACH = 0.12; // metres from a hand within which it grabs a thing
const FAR = 3; // metres within which it grabs what it points at
const SPEED = 1.2; // metres a second, by the thumbstick
const HANDS = ["left", "right"];

export async function offerHeadset(room, button, movable, acts) {
  if (!(await WebXRSessionManager.IsSessionSupportedAsync("immersive-vr").catch(() => false))) return;
  button.hidden = false;
  button.onclick = async () => {
    const xr = await WebXRExperienceHelper.CreateAsync(room.scene);
    xr.camera.compensateOnFirstFrame = false;
    xr.camera.minZ = 0.02;
    await xr.enterXRAsync("immersive-vr", "local-floor");
    new Visit(room, xr, movable, acts);
  };
}

class Visit {
  constructor(room, xr, movable, acts) {
    Object.assign(this, { room, xr, movable, acts, held: {}, poses: {}, marks: {} });
    const { sessionManager } = xr, { session } = sessionManager;
    this.board = new Board(room, acts);
    for (const hand of HANDS) {
      this.marks[hand] = CreateSphere(`${hand} hand`, { diameter: 0.04 }, room.scene);
      this.marks[hand].isPickable = false;
    }
    const on = (event, then) => session.addEventListener(event, ({ inputSource }) => then(inputSource.handedness));
    on("squeezestart", (hand) => this.grab(hand));
    on("squeezeend", (hand) => this.letGo(hand));
    on("selectstart", (hand) => this.use(hand, true));
    on("selectend", (hand) => this.use(hand, false));
    const frames = sessionManager.onXRFrameObservable.add((frame) => this.follow(frame));
    xr.camera.onXRCameraInitializedObservable.addOnce(() => this.stand());
    sessionManager.onXRSessionEnded.addOnce(() => {
      frames.remove();
      for (const hand of HANDS) this.letGo(hand);
      this.board.dispose();
      for (const mark of Object.values(this.marks)) mark.dispose();
    });
    room.visit = this; // for tests
  }

  // Where a person has room to stand, as near to the middle as can be; the board hangs before them.
  stand() {
    const { min, max } = this.room.extent, middle = Vector3.Center(min, max);
    const free = (x, z) => {
      const hit = this.room.scene.pickWithRay(new Ray(new Vector3(x, min.y + 1.9, z), Vector3.Down(), 3));
      return hit?.hit && hit.pickedPoint.y < min.y + 0.15;
    };
    const spots = [];
    for (let x = min.x + 0.5; x < max.x - 0.5; x += 0.3) for (let z = min.z + 0.5; z < max.z - 0.5; z += 0.3) spots.push([x, z]);
    spots.sort((a, b) => Math.hypot(a[0] - middle.x, a[1] - middle.z) - Math.hypot(b[0] - middle.x, b[1] - middle.z));
    const [x, z] = spots.find(([x, z]) => free(x, z)) ?? [middle.x, middle.z];
    this.xr.camera.position = new Vector3(x, this.xr.camera.position.y, z);
    this.board.hang(new Vector3(x, min.y + 1.5, z - 1.4));
  }

  follow(frame) {
    const { session, referenceSpace } = this.xr.sessionManager;
    for (const source of session.inputSources) {
      const hand = source.handedness;
      const grip = source.gripSpace && frame.getPose(source.gripSpace, referenceSpace);
      const ray = frame.getPose(source.targetRaySpace, referenceSpace);
      if (!HANDS.includes(hand) || !grip || !ray) continue;
      this.poses[hand] = { grip: Matrix.FromArray(grip.transform.matrix), ray: Matrix.FromArray(ray.transform.matrix) };
      this.marks[hand].position.copyFrom(this.poses[hand].grip.getTranslation());
      const held = this.held[hand];
      if (held) place(held.node, held.within.multiply(this.poses[hand].grip));
      this.walk(source.gamepad?.axes);
    }
  }

  walk(axes) {
    const [, , sideways = 0, back = 0] = axes ?? [];
    if (Math.hypot(sideways, back) < 0.2) return;
    const ahead = this.xr.camera.getDirection(Vector3.Forward(true)), right = this.xr.camera.getDirection(Vector3.Right());
    const way = ahead.scale(-back).add(right.scale(sideways));
    way.y = 0;
    this.xr.camera.position.addInPlace(way.scale((SPEED * this.room.engine.getDeltaTime()) / 1000));
  }

  pointed(hand, wanted) {
    const { ray } = this.poses[hand];
    const ahead = Vector3.TransformNormal(new Vector3(0, 0, -1), ray);
    return this.room.scene.pickWithRay(new Ray(ray.getTranslation(), ahead, FAR), wanted);
  }

  grab(hand) {
    if (!this.poses[hand]) return;
    const at = this.poses[hand].grip.getTranslation();
    const near = this.movable.map((number) => [gapTo(this.room.nodes[number], at), number]).sort((a, b) => a[0] - b[0])[0];
    let number = near && near[0] <= REACH ? near[1] : null;
    if (number === null) number = numberOf(this.room, this.movable, this.pointed(hand, (mesh) => numberOf(this.room, this.movable, mesh) !== null)?.pickedMesh);
    if (number === null) return;
    for (const other of HANDS) if (this.held[other]?.number === number) this.held[other] = null; // from hand to hand
    const node = this.room.nodes[number];
    this.held[hand] = { number, node, within: worldOf(node).multiply(Matrix.Invert(this.poses[hand].grip)) };
  }

  letGo(hand) {
    const held = this.held[hand];
    this.held[hand] = null;
    if (!held) return;
    if (held.used) this.acts.use(held.number, false);
    this.acts.settle(held.number);
  }

  use(hand, pressed) {
    const held = this.held[hand];
    if (held) {
      held.used = pressed;
      this.acts.use(held.number, pressed);
    } else if (pressed && this.poses[hand]) {
      this.board.press(this.pointed(hand, (mesh) => mesh === this.board.plane));
    }
  }
}

function gapTo(node, point) {
  const { min, max } = node.getHierarchyBoundingVectors(true);
  const gap = (low, high, value) => Math.max(low - value, 0, value - high);
  return Math.hypot(gap(min.x, max.x, point.x), gap(min.y, max.y, point.y), gap(min.z, max.z, point.z));
}
