// What stands beside the room. Names are shown as text, never as markup.
const MARKS = { waiting: "○", open: "▶", done: "✓", skipped: "–" };
const make = (tag, text, more = {}) => Object.assign(document.createElement(tag), { textContent: text ?? "", ...more });

export class Panel {
  constructor(sheet, movable, acts) {
    Object.assign(this, { sheet, acts, cards: new Map() });
    this.get = (id) => document.getElementById(id);
    this.get("title").textContent = sheet.title;
    document.title = sheet.title;
    this.get("things").append(...movable.map((at) => make("option", sheet.names[at], { value: at })));
    const places = (sheet.tasks ?? []).map((task, at) => [task, at]).filter(([task]) => task.targets.length);
    this.get("places").append(...places.map(([task, at]) => make("option", task.name, { value: at })));
    const thing = () => Number(this.get("things").value);
    this.get("move").onclick = () => acts.move(thing(), Number(this.get("places").value));
    this.get("turn").onclick = () => acts.turnThing(thing());
    this.get("press").onclick = () => {
      const pressed = this.get("press").getAttribute("aria-pressed") !== "true";
      this.get("press").setAttribute("aria-pressed", pressed);
      acts.press(thing(), pressed);
    };
    this.get("again").onclick = () => location.reload();
    for (const kind of ["events", "xapi"]) this.get(kind).onclick = () => this.download(kind);
    this.get("hands").hidden = !movable.length;
    this.get("rest").hidden = !sheet.parts;
  }

  tell(text, kind) {
    this.get("message").textContent = `${{ good: "✓ ", bad: "✗ " }[kind]}${text}`;
    this.get("message").dataset.kind = kind;
  }

  show(status, recorder) {
    const { parts, tasks } = this.sheet;
    if (!parts) return;
    this.get("tree").replaceChildren(...parts.slice(1).map((part, k) => this.line(part, status[k + 1])));
    this.offer(tasks.map((task, at) => [task, at]).filter(([task]) => status[task.leaf] === "open" && task.type !== "Parallel"));
    if (status[0] === "done") {
      const count = (kind) => recorder.events.filter((event) => event.kind === kind).length;
      const seconds = Math.round(recorder.last);
      this.tell(`Finished in ${seconds} s. Too early: ${count("early")}. Wrong answers: ${count("failed")}.`, "good");
    }
  }

  // A card stays as long as its action is open, with what was ticked in it; the keyboard goes on at the next one.
  offer(open) {
    const now = this.get("now"), left = now.contains(document.activeElement);
    const wanted = new Set(open.map(([, at]) => at));
    for (const [at, card] of this.cards) {
      if (wanted.has(at)) continue;
      card.remove();
      this.cards.delete(at);
    }
    for (const [task, at] of open) {
      if (!this.cards.has(at)) this.cards.set(at, this.card(task, at));
      this.cards.get(at).dataset.task = at;
      if (this.cards.get(at).parentNode !== now) now.append(this.cards.get(at));
    }
    if (left && !now.contains(document.activeElement)) (now.querySelector("button, input") ?? this.get("message")).focus(); // no button: a second Enter would press it
    this.get("doing").hidden = !open.length;
  }

  line(part, status) {
    const item = make("li", `${MARKS[status]} ${part.name}${part.optional ? " (optional)" : ""}`, { className: status });
    let depth = 0;
    for (let at = part.parent; at > 0; at = this.sheet.parts[at].parent) depth++;
    item.style.paddingLeft = `${depth}em`;
    item.setAttribute("aria-label", `${part.name}: ${status}`);
    return item;
  }

  card(task, at) {
    const show = make("button", "Show", { className: "show", onclick: () => this.acts.look(at) });
    show.setAttribute("aria-label", `Show: ${task.name}`);
    if (task.type !== "Question") {
      const line = make("div");
      line.append(make("button", task.name, { className: "do", onclick: () => this.acts.perform(at) }), ...(task.targets.length ? [show] : []));
      return line;
    }
    const set = make("fieldset");
    set.append(make("legend", task.name));
    const boxes = task.answers.map((text, k) => {
      const label = make("label"), box = make("input", "", { type: "checkbox", value: k });
      label.append(box, make("span", text));
      set.append(label);
      return box;
    });
    const chosen = () => boxes.flatMap((box, k) => (box.checked ? [k] : []));
    set.append(make("button", "Answer", { className: "answer", onclick: () => this.acts.answer(at, chosen()) }), ...(task.targets.length ? [show] : []));
    return set;
  }

  download(kind) {
    const data = new Blob([JSON.stringify(this.acts.save(kind), null, 1)], { type: "application/json" });
    const link = make("a", "", { href: URL.createObjectURL(data), download: `${kind}.json` });
    link.click();
    URL.revokeObjectURL(link.href);
  }
}
