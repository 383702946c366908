// A site at an address of this machine, and Chromium to look at it.
import fs from "node:fs";
import http from "node:http";
import path from "node:path";
import { chromium } from "playwright-core";

const KINDS = { ".html": "text/html; charset=utf-8", ".js": "text/javascript" };
const FLAGS = ["--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export async function withBrowser(site, work) {
  const server = http.createServer((request, answer) => {
    const file = path.join(site, request.url === "/" ? "index.html" : path.basename(request.url));
    if (!fs.existsSync(file)) return answer.writeHead(404).end();
    answer.writeHead(200, { "content-type": KINDS[path.extname(file)] ?? "application/octet-stream" });
    answer.end(fs.readFileSync(file));
  }).listen(0);
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: FLAGS });
  try {
    await work(browser, `http://127.0.0.1:${server.address().port}/`);
  } finally {
    await browser.close();
    server.close();
  }
}

// Open a page and wait for its room; collects faults, and addresses that are not its own.
export async function openPage(page, own) {
  const faults = [], foreign = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("request", (request) => /^(data|blob):/.test(request.url()) || request.url().startsWith(own) || foreign.push(request.url()));
  await page.goto(own);
  await page.waitForFunction(() => document.body.dataset.ready, null, { timeout: 60000 });
  return { faults, foreign };
}
