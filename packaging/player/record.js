// What is done becomes a motion script, which `unisg simulate --motion` plays and judges, and xAPI statements.
import { worldOf } from "./nodes.js";

const PLACES = [0, 2, 1], SIGNS = [1, -1, 1, 1]; // glTF's y is our z
const ADL = "http://adlnet.gov/expapi/verbs/";
const VERBS = {
  performed: `${ADL}completed`, early: `${ADL}attempted`, failed: `${ADL}failed`, skipped: "http://id.tincanapi.com/verb/skipped",
};
const STEP = 1e-3; // seconds in which a thing goes from one place to the next

function rows(matrix) {
  const found = [], at = [...PLACES, 3];
  for (let r = 0; r < 4; r++) for (let c = 0; c < 4; c++) found.push(SIGNS[r] * SIGNS[c] * matrix.m[at[c] * 4 + at[r]]);
  return found;
}

export class Recorder {
  constructor(room, sheet, movable) {
    this.tracks = new Map(movable.map((number) => [number, []]));
    this.inputs = [];
    this.coming = [];
    this.events = [];
    this.room = room;
    this.sheet = sheet;
    this.last = 0;
  }

  // A key where something has moved, and one just before it: the graph sees no more than one place in a tick.
  tick(seconds) {
    this.inputs.push(...this.coming.map((record) => ({ time: seconds, ...record })));
    this.coming = [];
    for (const [number, keys] of this.tracks) {
      const matrix = rows(worldOf(this.room.nodes[number])), before = keys.at(-1);
      if (before && before.matrix.every((value, k) => Math.abs(value - matrix[k]) < 1e-9)) continue;
      const still = seconds - STEP;
      if (before && still > before.time) keys.push({ time: still, matrix: before.matrix });
      keys.push({ time: seconds, matrix });
    }
    this.last = seconds;
  }

  input(record) {
    this.coming.push(record); // the graph looks at it in the next tick
  }

  event(kind, name) {
    this.events.push({ time: this.last, kind, name });
  }

  script() {
    const tracks = [...this.tracks].map(([number, keys]) => ({ entity: this.sheet.uids[number], frame: "world", keys }));
    return { version: 1, rate: 60, tracks: tracks.filter((track) => track.keys.length > 1), inputs: this.inputs };
  }

  statements(start) {
    return this.events.filter((event) => VERBS[event.kind]).map((event) => ({
      actor: { objectType: "Agent", account: { homePage: "https://localhost", name: "learner" } },
      verb: { id: VERBS[event.kind], display: { en: event.kind } },
      object: { id: `urn:unisg:${encodeURIComponent(event.name)}`, definition: { name: { en: event.name } } },
      timestamp: new Date(start + event.time * 1000).toISOString(),
    }));
  }
}
