// Plays a site with an emulated headset (iwer): hands grab, place, use tools and point at answers.
// node headset_test.mjs SITE [PICTURE.png]; exit status 1 where the lesson does not end as it should.
import assert from "node:assert/strict";
import fs from "node:fs";
import { openPage, withBrowser } from "./served_site.mjs";

const [site, picture] = process.argv.slice(2);
const emulator = fs.readFileSync(new URL("./node_modules/iwer/build/iwer.min.js", import.meta.url), "utf8");

await withBrowser(site, async (browser, own) => {
  const page = await browser.newPage({ viewport: { width: 640, height: 400 } });
  await page.addInitScript(`${emulator}
    window.headset = new IWER.XRDevice(IWER.metaQuest3);
    headset.installRuntime({ forceInstall: true });`);
  const { faults, foreign } = await openPage(page, own);
  await page.click("#headset");
  await page.waitForFunction(() => unisg.room.visit?.poses.right && unisg.room.visit.board.lines.length, null, { timeout: 30000 });
  const did = [];
  for (let round = 0; round < 60 && (await statusOf(page, 0)) !== "done"; round++) {
    const task = await page.evaluate(() => {
      const open = unisg.sheet.tasks.map((task, at) => ({ ...task, at })).filter((task) =>
        unisg.status[task.leaf] === "open" && task.type !== "Parallel" && !(unisg.did ??= new Set()).has(task.at));
      if (open[0]) unisg.did.add(open[0].at);
      else unisg.did.clear();
      return open[0] ?? null;
    });
    if (!task) { await page.waitForTimeout(200); continue; }
    if (task.type === "Question") await point(page, task);
    else await handle(page, task);
    if (picture && round === 0) await page.screenshot({ path: picture });
    await page.waitForTimeout(400);
    did.push(`${task.type} ${await statusOf(page, task.leaf)}`);
  }
  assert.equal(await statusOf(page, 0), "done", `the lesson has not ended: ${did.join(", ")}`);
  assert.deepEqual([faults, foreign], [[], []]);
  console.log(JSON.stringify({ finished: true, did }));
});

function statusOf(page, part) {
  return page.evaluate((at) => unisg.status[at], part);
}

// Grab what a task is about, bring it where it has to be, use it if it is a tool, and let it go.
async function handle(page, task) {
  const thing = task.type === "Use" || task.type === "Tool" ? task.tools[0] : task.targets[0];
  const middle = (number) => page.evaluate((at) => {
    const { min, max } = unisg.room.nodes[at].getHierarchyBoundingVectors(true);
    return min.add(max).scale(0.5).asArray();
  }, number);
  const from = await middle(thing);
  await hand(page, from);
  await button(page, "squeeze", 1);
  assert.equal(await page.evaluate(() => unisg.room.visit.held.right?.number ?? null), thing, `${task.name}: nothing is grabbed`);
  let way = [0, 0.5, 0];
  if (task.type === "Insert") way = await page.evaluate(([at, thing]) => unisg.wayTo(unisg.sheet.tasks[at], thing), [task.at, thing]);
  else if (task.type !== "Remove") way = (await middle(task.targets[0])).map((value, k) => value - from[k]);
  const there = from.map((value, k) => value + way[k]);
  for (let hit = 0; hit < task.hits; hit++) {
    for (const share of [0.5, 1]) await hand(page, from.map((value, k) => value + share * way[k]));
    if (task.type === "Use" || task.type === "Tool") {
      await button(page, "trigger", 1);
      await page.waitForTimeout(1000 * task.hold + 300);
      await button(page, "trigger", 0);
      await hand(page, [there[0], there[1] + 1, there[2]]);
    }
  }
  await button(page, "squeeze", 0);
}

async function point(page, task) {
  for (let chosen = 0; chosen < task.answers.length && (await statusOf(page, task.leaf)) === "open"; chosen++) {
    const at = await page.evaluate(([task, chosen]) => {
      const { board } = unisg.room.visit;
      board.draw();
      const line = board.lines.findIndex(({ answer }) => answer?.[0] === task && answer[1] === chosen);
      return board.middleOfLine(line).asArray();
    }, [task.at, chosen]);
    await hand(page, [at[0], at[1], at[2] + 0.4]);
    await button(page, "trigger", 1);
    await button(page, "trigger", 0);
    await page.waitForTimeout(300);
  }
}

async function hand(page, place) {
  await page.evaluate(([x, y, z]) => {
    const offset = unisg.room.visit.xr.camera.position, head = headset.position;
    headset.controllers.right.position.set(x - offset.x + head.x, y - offset.y + head.y, z - offset.z + head.z);
    headset.controllers.right.quaternion.set(0, 0, 0, 1);
  }, place);
  await page.waitForTimeout(150);
}

async function button(page, name, value) {
  await page.evaluate(([name, value]) => headset.controllers.right.updateButtonValue(name, value), [name, value]);
  await page.waitForTimeout(150);
}
