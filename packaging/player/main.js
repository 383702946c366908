// The page: shows what the graph tells, and hands it what the learner does. It knows no rule of a lesson itself.
import { Matrix, Vector3 } from "@babylonjs/core/Maths/math.vector.js";
import { bring, dragThings, settle, takeAway, turn } from "./hands.js";
import { Ghosts } from "./ghosts.js";
import { offerHeadset } from "./headset.js";
import { Panel } from "./panel.js";
import { Recorder } from "./record.js";
import { place } from "./nodes.js";
import { goalOf, lookAt, middleOf, openRoom } from "./room.js";

const STATUS = { started: "open", performed: "done", skipped: "skipped" };
const wait = (seconds) => new Promise((done) => setTimeout(done, seconds * 1000));

async function bytesOfRoom() {
  const inline = document.getElementById("room")?.textContent.trim();
  if (inline) return Uint8Array.from(atob(inline), (letter) => letter.charCodeAt(0));
  const answer = await fetch("room.glb");
  if (!answer.ok) throw new Error(`room.glb: ${answer.status}`);
  return new Uint8Array(await answer.arrayBuffer());
}

async function start() {
  const sheet = JSON.parse(document.getElementById("sheet").textContent);
  const room = await openRoom(document.getElementById("view"), await bytesOfRoom());
  const tasks = sheet.tasks ?? [];
  const movable = [...new Set(tasks.flatMap((task) => [...task.targets, ...task.tools]))].filter((k) => room.nodes[k]);
  const recorder = new Recorder(room, sheet, movable);
  const began = Date.now();
  const status = (sheet.parts ?? []).map(() => "waiting");
  const isOpen = (task) => status[task.leaf] === "open";
  const send = (event, values) => room.coordinator?.notifyCustomEvent(`unisg:${event}`, values, false);
  const ghosts = new Ghosts(room);
  const panel = new Panel(sheet, movable, { perform, answer, move, press, turnThing, save, look });

  function listen(event, told) {
    room.coordinator?.getCustomEventObservable(`unisg:${event}`).add((values) => told(values));
  }
  const number = (value) => Number(value?.value ?? value);
  for (const event of Object.keys(STATUS)) {
    listen(event, (values) => {
      const at = number(values.node);
      status[at] = STATUS[event];
      const { kind, name } = sheet.parts[at];
      if (kind === "action" || at === 0) recorder.event(event, name);
      if (kind === "action" && event === "performed") panel.tell(`Done: ${name}`, "good");
      panel.show(status, recorder);
      ghosts.show(tasks.filter((task) => task.type === "Insert" && isOpen(task)));
    });
  }
  listen("early", (values) => tell("early", tasks[number(values.task)].name, "is too early: something else comes first"));
  listen("failed", (values) => tell("failed", tasks[number(values.task)].name, "not the right answer"));
  function tell(kind, name, text) {
    recorder.event(kind, name);
    panel.tell(`${name}: ${text}`, "bad");
  }

  function trigger(entity, pressed) {
    send("trigger", { entity, pressed });
    recorder.input({ entity: sheet.uids[entity], trigger: pressed });
  }
  function force(entity, newtons) {
    send("force", { entity, newtons });
    recorder.input({ entity: sheet.uids[entity], force: newtons });
  }
  function answer(at, chosen) {
    send("answer", { task: at, chosen: chosen.reduce((bits, k) => bits + 2 ** k, 0) });
    recorder.input({ action: tasks[at].uid, answer: chosen });
  }
  function press(entity, pressed) {
    trigger(entity, pressed);
  }
  function move(thing, at) {
    const task = tasks[at];
    if (task.reference && task.type !== "Remove") place(room.nodes[thing], goalOf(room, task));
    else bring(room.nodes[thing], room.nodes[task.targets[0]]);
  }
  function look(at) {
    const task = tasks[at];
    const node = room.nodes[task.type === "Use" || task.type === "Tool" ? task.tools[0] : task.targets[0]];
    lookAt(room, node);
    ghosts.blink(node);
  }
  function turnThing(thing) {
    turn(room.nodes[thing], Vector3.Up());
  }
  // What an action asks for, done by a button: so that a lesson can be played without dragging.
  async function perform(at) {
    const task = tasks[at], thing = task.type === "Tool" || task.type === "Use" ? task.tools[0] : task.targets[0];
    const node = room.nodes[thing];
    if (task.type === "Insert") place(node, goalOf(room, task));
    else if (task.type === "Remove") takeAway(node, Math.max(0.3, 2 * (task.distance ?? 0)));
    else if (task.type === "Use" || task.type === "Tool") {
      const home = node.computeWorldMatrix(true).clone();
      for (let hit = 0; hit < task.hits; hit++) {
        if (task.reference && task.type === "Tool") place(node, goalOf(room, task));
        else bring(node, room.nodes[task.targets[0]]);
        if (task.force) force(thing, task.force);
        if (task.trigger) trigger(thing, true);
        await wait(task.hold + 0.2);
        if (task.trigger) trigger(thing, false);
        if (task.force) force(thing, 0);
        place(node, home);
        await wait(0.1);
      }
    } else send("confirm", { task: at });
  }
  function save(kind) {
    return kind === "xapi" ? recorder.statements(began) : { ...recorder.script(), events: recorder.events };
  }

  send("dragging", { possible: true });
  dragThings(room, movable, isOpen, tasks);
  const openTasks = () => tasks.map((task, at) => ({ task, at })).filter(({ task }) => isOpen(task) && task.type !== "Parallel");
  await offerHeadset(room, document.getElementById("headset"), movable, {
    answer,
    settle: (number) => settle(room, number, isOpen, tasks),
    told: () => ({ title: sheet.title, message: document.getElementById("message").textContent, open: openTasks() }),
    use(number, pressed) {
      const forces = openTasks().filter(({ task }) => task.tools.includes(number)).map(({ task }) => task.force);
      if (Math.max(0, ...forces)) force(number, pressed ? Math.max(...forces) : 0);
      trigger(number, pressed);
    },
  });
  let first = null;
  room.engine.runRenderLoop(() => {
    const now = performance.now() / 1000;
    first ??= now;
    recorder.tick(now - first);
    room.scene.render();
  });
  panel.show(status, recorder);
  // Where a thing and its place are seen, null where the thing is behind another or outside: for tests.
  function onScreen(task) {
    const view = room.camera.viewport.toGlobal(room.engine.getRenderWidth(), room.engine.getRenderHeight());
    const seen = (point) => Vector3.Project(point, Matrix.Identity(), room.scene.getTransformMatrix(), view);
    const node = room.nodes[task.targets[0]], goal = goalOf(room, task).getTranslation();
    const from = seen(middleOf(node)), to = seen(goal.add(middleOf(node)).subtract(node.getAbsolutePosition()));
    let hit = room.scene.pick(from.x, from.y)?.pickedMesh;
    while (hit && hit !== node) hit = hit.parent;
    return hit ? [[from.x, from.y], [to.x, to.y]] : null;
  }
  const wayTo = (task, thing) => goalOf(room, task).getTranslation().subtract(room.nodes[thing].getAbsolutePosition()).asArray();
  window.unisg = { room, status, recorder, sheet, perform, answer, save, onScreen, wayTo };
  document.body.dataset.ready = "yes";
}

start().catch((error) => {
  document.getElementById("message").textContent = `The room cannot be shown: ${error.message}`;
  document.body.dataset.ready = "failed";
});
