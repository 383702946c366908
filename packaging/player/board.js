// What the panel tells, as a board in the room: a headset shows no page.
import { DynamicTexture } from "@babylonjs/core/Materials/Textures/dynamicTexture.js";
import { StandardMaterial } from "@babylonjs/core/Materials/standardMaterial.js";
import { Color3 } from "@babylonjs/core/Maths/math.color.js";
import { Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { CreatePlane } from "@babylonjs/core/Meshes/Builders/planeBuilder.js";

const WIDTH = 1024, HEIGHT = 768, LINE = 52;

export class Board {
  constructor(room, acts) {
    this.acts = acts;
    this.plane = CreatePlane("board", { width: 1.2, height: 0.9 }, room.scene);
    this.texture = new DynamicTexture("board", { width: WIDTH, height: HEIGHT }, room.scene);
    this.plane.material = new StandardMaterial("board", room.scene);
    this.plane.material.emissiveTexture = this.texture;
    this.plane.material.disableLighting = true;
    this.plane.material.backFaceCulling = false;
    this.plane.material.diffuseColor = Color3.Black();
    this.watch = setInterval(() => this.draw(), 250);
    this.lines = [];
  }

  hang(at) {
    this.plane.position = at;
    this.draw();
  }

  draw() {
    const { title, message, open } = this.acts.told();
    const lines = [{ text: title }, { text: message }, { text: "" }];
    for (const { task, at } of open) {
      lines.push({ text: `▶ ${task.name}` });
      if (task.type === "Question") task.answers.forEach((text, k) => lines.push({ text: `      ${text}`, answer: [at, k] }));
    }
    const seen = JSON.stringify(lines);
    if (seen === this.seen) return;
    Object.assign(this, { lines, seen });
    const context = this.texture.getContext();
    context.fillStyle = "#ffffff";
    context.fillRect(0, 0, WIDTH, HEIGHT);
    lines.forEach(({ text, answer }, k) => {
      context.fillStyle = answer ? "#2f6f9f" : "#1d2430";
      context.font = `${k ? "" : "bold "}${k ? 32 : 40}px sans-serif`;
      context.fillText(text, 30, (k + 1) * LINE, WIDTH - 60);
    });
    this.texture.update();
  }

  middleOfLine(line) {
    const down = 0.45 - (0.9 * (line + 0.85) * LINE) / HEIGHT;
    return this.plane.position.add(new Vector3(0, down, 0));
  }

  // Answer by pointing: a line of the board is one answer.
  press(hit) {
    const uv = hit?.hit && hit.getTextureCoordinates();
    const line = uv && this.lines[Math.floor(((1 - uv.y) * HEIGHT - LINE * 0.35) / LINE)];
    if (line?.answer) this.acts.answer(line.answer[0], [line.answer[1]]);
  }

  dispose() {
    clearInterval(this.watch);
    this.plane.dispose(false, true);
  }
}
