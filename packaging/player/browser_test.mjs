// Plays a site in a browser as a learner does: one thing too early, one answer wrong, by the mouse or by keys alone.
// node browser_test.mjs SITE EVENTS.json mouse|keys [PICTURE.png]; exit status 1 where the lesson does not end well.
import assert from "node:assert/strict";
import fs from "node:fs";
import { openPage, withBrowser } from "./served_site.mjs";

const [site, events, hands, picture] = process.argv.slice(2);
const viewport = picture ? { width: 1280, height: 800 } : { width: 640, height: 400 };
await withBrowser(site, async (browser, own) => play(await browser.newPage({ viewport }), own));

async function play(page, own) {
  const { faults, foreign } = await openPage(page, own);
  assert.equal(await page.evaluate(() => document.body.dataset.ready), "yes");
  await page.waitForFunction(() => unisg.status[0] === "open");
  if (picture) await page.screenshot({ path: picture });
  if (hands === "mouse") await tooEarly(page);
  let dragged = false;
  for (let round = 0; round < 200 && (await statusOf(page, 0)) !== "done"; round++) {
    const task = await nextTask(page);
    if (!task) { await page.waitForTimeout(100); continue; }
    if (task.type === "Question") await answer(page, task);
    else if (hands === "keys") await press(page, `#now [data-task="${task.at}"] .do`, "Enter");
    else if (task.type === "Insert" && !dragged) dragged = await drag(page, task);
    else await page.click(`#now [data-task="${task.at}"] .do`, { timeout: 5000 }).catch(() => {}); // it may be done by itself
    await page.waitForTimeout(250);
  }
  fs.writeFileSync(events, JSON.stringify(await page.evaluate(() => unisg.save("events"))));
  if (picture) {
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForTimeout(500);
    await page.screenshot({ path: picture.replace(".png", "-small.png") });
  }
  assert.equal(await statusOf(page, 0), "done", "the lesson has not ended");
  assert.match(await page.textContent("#message"), /Finished/);
  assert.deepEqual([faults, foreign], [[], []]);
  console.log(JSON.stringify({ finished: true, dragged, events: await page.evaluate(() => unisg.recorder.events.length) }));
}

function statusOf(page, part) {
  return page.evaluate((at) => unisg.status[at], part);
}

// The open action that was tried least.
function nextTask(page) {
  return page.evaluate(() => {
    const open = unisg.sheet.tasks.map((task, at) => ({ ...task, at })).filter((task) =>
      unisg.status[task.leaf] === "open" && task.type !== "Parallel");
    unisg.tried ??= {};
    open.sort((a, b) => (unisg.tried[a.at] ?? 0) - (unisg.tried[b.at] ?? 0));
    if (open[0]) unisg.tried[open[0].at] = (unisg.tried[open[0].at] ?? 0) + 1;
    return open[0] ?? null;
  });
}

// Put things where they belong before their turn, by hand, until one is told to be too early.
async function tooEarly(page) {
  const waiting = await page.evaluate(() => unisg.sheet.tasks.map((task, at) => ({ ...task, at })).filter((task) =>
    unisg.status[task.leaf] === "waiting" && task.type === "Insert"));
  await page.click("#hands summary");
  for (const task of waiting) {
    await page.selectOption("#things", String(task.targets[0]));
    await page.selectOption("#places", String(task.at));
    await page.click("#move");
    await page.waitForTimeout(1000 * task.hold + 400);
    if (await page.evaluate(() => unisg.recorder.events.some(({ kind }) => kind === "early"))) {
      assert.match(await page.textContent("#message"), /too early/);
      return;
    }
  }
  assert.fail("nothing was told to be too early");
}

// Go to something by the Tab key, and press another one there.
async function press(page, selector, key) {
  for (let steps = 0; steps < 80; steps++) {
    if (await page.evaluate((wanted) => document.activeElement?.matches(wanted), selector)) return page.keyboard.press(key);
    await page.keyboard.press("Tab");
  }
  assert.fail(`${selector} is not reached by the Tab key`);
}

async function answer(page, task) {
  const card = `#now [data-task="${task.at}"]`;
  const use = (what, key) => (hands === "keys" ? press(page, `${card} ${what}`, key) : page.click(`${card} ${what}`));
  for (let chosen = task.answers.length - 1; chosen >= 0; chosen--) { // the last first: mostly wrong
    await use(`input[value="${chosen}"]`, "Space");
    const wrong = () => unisg.recorder.events.filter(({ kind }) => kind === "failed").length;
    const before = await page.evaluate(wrong);
    await use(".answer", "Enter");
    await page.waitForFunction(([leaf, before]) => unisg.status[leaf] !== "open" ||
      unisg.recorder.events.filter(({ kind }) => kind === "failed").length > before, [task.leaf, before]);
    if ((await statusOf(page, task.leaf)) !== "open") return;
    await use(`input[value="${chosen}"]`, "Space");
  }
}

async function drag(page, task) {
  if (!(await page.click(`#now [data-task="${task.at}"] .show`, { timeout: 5000 }).then(() => true, () => false))) return false;
  let ends = null;
  for (let far = 0; far < 8; far++) { // as far away as both the thing and its place are seen from
    await page.waitForTimeout(150);
    ends = await page.evaluate((at) => unisg.onScreen(unisg.sheet.tasks[at]), task.at);
    const { width, height } = await page.locator("#view").boundingBox();
    if (ends?.every(([x, y]) => x > 0 && y > 0 && x < width && y < height)) break;
    ends = null;
    await page.mouse.move(width / 2, height / 2);
    await page.mouse.wheel(0, 300);
  }
  if (!ends) return false;
  await page.mouse.move(...ends[0]);
  await page.mouse.down();
  for (let k = 1; k <= 8; k++) {
    await page.mouse.move(ends[0][0] + ((ends[1][0] - ends[0][0]) * k) / 8, ends[0][1] + ((ends[1][1] - ends[0][1]) * k) / 8);
    await page.waitForTimeout(60);
  }
  await page.mouse.up();
  await page.waitForTimeout(1000 * task.hold + 500);
  return (await statusOf(page, task.leaf)) === "done";
}
