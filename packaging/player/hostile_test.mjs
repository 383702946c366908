// Looks at a site whatever is in it, performs what can be performed by a button, and prints what a learner would see.
// node hostile_test.mjs SITE; exit status 1 where something throws or an address outside the page is asked for.
import assert from "node:assert/strict";
import { openPage, withBrowser } from "./served_site.mjs";

await withBrowser(process.argv[2], async (browser, own) => {
  const page = await browser.newPage({ viewport: { width: 640, height: 400 } });
  const dialogs = [];
  page.on("dialog", (dialog) => dialogs.push(dialog.message()) && dialog.dismiss());
  const { faults, foreign } = await openPage(page, own);
  const button = page.locator("#now .do").first();
  if (await button.isVisible()) {
    const now = await page.textContent("#now");
    await button.click();
    await page.waitForFunction((now) => document.getElementById("now").textContent !== now, now, { timeout: 60000 });
  }
  await page.waitForTimeout(300);
  const seen = await page.evaluate(() => ({
    ready: document.body.dataset.ready,
    evil: window.evil ?? null,
    images: document.images.length,
    title: document.getElementById("title").textContent,
    now: document.getElementById("now").textContent,
    message: document.getElementById("message").textContent,
    rest: !document.getElementById("rest").hidden,
    nodes: window.unisg?.room.nodes.filter(Boolean).length ?? 0,
    finished: window.unisg?.status[0] === "done",
  }));
  assert.deepEqual([faults, foreign, dialogs], [[], [], []]);
  console.log(JSON.stringify(seen));
});
