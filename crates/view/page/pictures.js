// The pictures of the page and of the report in docs/pictures, from the sample log.

import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "@playwright/test";
import { open, ROOT, run, view } from "./tests/polymapper.js";

const folder = process.env.PICTURES ?? join(ROOT, "docs/pictures");
const scratch = mkdtempSync(join(tmpdir(), "polymapper-pictures-"));
const built = join(scratch, "demo");
run(["demo", "-o", built]);
const server = await view([built]);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox"],
});

/**
 * @param {string} name
 * @param {string} url
 * @param {{scheme: "light" | "dark", width: number, height: number, whole?: boolean}} how
 * @param {(page: import("@playwright/test").Page) => Promise<void>} [act]
 */
async function picture(name, url, { scheme, width, height, whole = false }, act) {
  const page = await browser.newPage({ viewport: { width, height }, colorScheme: scheme });
  await open(page, url);
  await act?.(page);
  await page.waitForTimeout(800);
  await page.screenshot({ path: join(folder, name), fullPage: whole });
  await page.close();
}

await picture("view.png", server.url, { scheme: "light", width: 1280, height: 760 }, async (page) => {
  // Where the scanner comes back to the corridor; the scan reaches far.
  await page.locator("#slider").fill("262");
  await page.locator("#slider").blur();
  await page.keyboard.press("f");
  await page.mouse.move(200, 300);
});
await picture("view-dark.png", server.url, { scheme: "dark", width: 1280, height: 760 }, async (page) => {
  await page.keyboard.press("p");
  await page.locator("#layer-virtual").check();
  await page.locator("#layer-ellipses").check();
  const box = await page.locator("#map").boundingBox();
  await page.mouse.move((box?.x ?? 0) + 400, (box?.y ?? 0) + 470);
  for (let k = 0; k < 6; k += 1) await page.mouse.wheel(0, -200);
  await page.mouse.move(5, 200);
});
await picture("view-phone.png", server.url, { scheme: "light", width: 390, height: 760 });
await picture("report.png", `file://${join(built, "report.html")}`, { scheme: "light", width: 1280, height: 860, whole: true });

await browser.close();
server.process.kill("SIGKILL");
rmSync(scratch, { recursive: true });
