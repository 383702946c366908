// Where things have to go: see-through copies at their reference poses, as long as these are asked for.
import { StandardMaterial } from "@babylonjs/core/Materials/standardMaterial.js";
import { Color3, Matrix } from "@babylonjs/core/Maths/math.js";
import { worldOf } from "./nodes.js";
import { goalOf } from "./room.js";

const BEATS = 5, BEAT = 300; // how often a mark changes, and milliseconds between

export class Ghosts {
  constructor(room) {
    this.room = room;
    this.shown = new Map();
    this.material = new StandardMaterial("ghost", room.scene);
    this.material.emissiveColor = new Color3(0.2, 0.55, 0.8);
    this.material.disableLighting = true;
    this.material.alpha = 0.35;
    this.mark = this.material.clone("mark");
    this.mark.alpha = 0.6;
    this.mark.zOffset = -2; // before what it marks
    room.scene.onBeforeRenderObservable.add(() => this.follow());
  }

  show(tasks) {
    for (const [task, copies] of this.shown) {
      if (tasks.includes(task)) continue;
      for (const { copy } of copies) copy.dispose();
      this.shown.delete(task);
    }
    for (const task of tasks) if (!this.shown.has(task)) this.shown.set(task, this.copies(this.room.nodes[task.targets[0]]));
  }

  copies(thing) {
    const home = Matrix.Invert(worldOf(thing));
    return [thing, ...thing.getChildMeshes(false)].filter((mesh) => mesh.geometry).map((mesh) => {
      const copy = (mesh.sourceMesh ?? mesh).clone(`${mesh.name} ghost`, null, true); // an instance has no material of its own
      copy.material = this.material;
      copy.isPickable = false;
      copy.isVisible = true;
      return { copy, within: worldOf(mesh).multiply(home) };
    });
  }

  // Show where a thing is: a copy over it comes and goes three times.
  blink(thing) {
    const copies = this.copies(thing);
    for (const { copy, within } of copies) {
      copy.material = this.mark;
      copy.freezeWorldMatrix(within.multiply(worldOf(thing)));
    }
    for (let beat = 1; beat < BEATS; beat++) {
      setTimeout(() => { for (const { copy } of copies) copy.isVisible = beat % 2 === 0; }, beat * BEAT);
    }
    setTimeout(() => { for (const { copy } of copies) copy.dispose(); }, BEATS * BEAT);
  }

  follow() {
    for (const [task, copies] of this.shown) {
      const goal = goalOf(this.room, task);
      for (const { copy, within } of copies) {
        copy.freezeWorldMatrix(within.multiply(goal));
      }
    }
  }
}
