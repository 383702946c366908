// Plays a site in a browser as a learner does: by dragging, by buttons, one answer wrong, one thing too early.
// node browser_test.mjs SITE EVENTS.json [PICTURE.png]; exit status 1 where the lesson does not end as it should.
import assert from "node:assert/strict";
import fs from "node:fs";
import { openPage, withBrowser } from "./served_site.mjs";

const [site, events, picture] = process.argv.slice(2);
const viewport = picture ? { width: 1280, height: 800 } : { width: 640, height: 400 };
await withBrowser(site, async (browser, own) => play(await browser.newPage({ viewport }), own));

async function play(page, own) {
  const { faults, foreign } = await openPage(page, own);
  assert.equal(await page.evaluate(() => document.body.dataset.ready), "yes");
  await page.waitForFunction(() => unisg.status[0] === "open");
  if (picture) await page.screenshot({ path: picture });
  let dragged = false;
  for (let round = 0; round < 200 && !(await page.evaluate(() => unisg.status[0] === "done")); round++) {
    const task = await page.evaluate(() => {
      const open = unisg.sheet.tasks.map((task, at) => ({ ...task, at })).filter((task) =>
        unisg.status[task.leaf] === "open" && task.type !== "Parallel");
      unisg.tried ??= {};
      open.sort((a, b) => (unisg.tried[a.at] ?? 0) - (unisg.tried[b.at] ?? 0));
      if (open[0]) unisg.tried[open[0].at] = (unisg.tried[open[0].at] ?? 0) + 1;
      return open[0] ? { ...open[0], tries: unisg.tried[open[0].at] } : null;
    });
    if (!task) { await page.waitForTimeout(100); continue; }
    if (task.type === "Question") await answer(page, task);
    else if (task.type === "Insert" && !dragged && task.tries === 1) dragged = await drag(page, task);
    else await page.evaluate((at) => unisg.perform(at), task.at);
    await page.waitForTimeout(250);
  }
  fs.writeFileSync(events, JSON.stringify(await page.evaluate(() => unisg.save("events"))));
  if (picture) {
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForTimeout(500);
    await page.screenshot({ path: picture.replace(".png", "-small.png") });
  }
  assert.equal(await page.evaluate(() => unisg.status[0]), "done", "the lesson has not ended");
  assert.deepEqual([faults, foreign], [[], []]);
  console.log(JSON.stringify({ finished: true, dragged, events: await page.evaluate(() => unisg.recorder.events.length) }));
}

async function answer(page, task) {
  for (let chosen = task.answers.length - 1; chosen >= 0; chosen--) { // the last first: mostly wrong
    await page.evaluate(([at, k]) => unisg.answer(at, [k]), [task.at, chosen]);
    await page.waitForTimeout(300);
    if (await page.evaluate((leaf) => unisg.status[leaf] !== "open", task.leaf)) return;
  }
}

async function drag(page, task) {
  const ends = await page.evaluate((at) => unisg.onScreen(unisg.sheet.tasks[at]), task.at);
  if (!ends) return false;
  await page.mouse.move(...ends[0]);
  await page.mouse.down();
  for (let k = 1; k <= 8; k++) {
    await page.mouse.move(ends[0][0] + ((ends[1][0] - ends[0][0]) * k) / 8, ends[0][1] + ((ends[1][1] - ends[0][1]) * k) / 8);
    await page.waitForTimeout(60);
  }
  await page.mouse.up();
  await page.waitForTimeout(400);
  return page.evaluate((leaf) => unisg.status[leaf] === "done", task.leaf);
}
