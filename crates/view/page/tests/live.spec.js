// A stream that is watched as it comes.

import { expect, SAMPLE, start, test } from "./polymapper.js";

test("looking back while it is live, and catching up", async ({ page, viewing }) => {
  const { url, process: viewer } = await viewing("-");
  await page.goto(url);
  const player = start(["play", SAMPLE, "--hz", "60"]);
  player.stdout.pipe(viewer.stdin);
  await expect.poll(() => page.locator("#slider").inputValue().then(Number)).toBeGreaterThan(40);
  await page.locator("#map").focus();
  await page.keyboard.press("ArrowLeft");
  await expect(page.locator("#status")).toHaveText("live, looking back");
  const held = await page.locator("#slider").inputValue();
  await page.waitForTimeout(300);
  expect(await page.locator("#slider").inputValue()).toBe(held);
  await page.keyboard.press("End");
  await expect.poll(() => page.locator("#slider").inputValue().then(Number)).toBeGreaterThan(Number(held) + 10);
  // Nothing may be on its way when the viewer is ended.
  player.stdout.unpipe();
  player.kill();
});
