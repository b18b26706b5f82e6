// What people do with the page: open, play, scrub, layers, hover, measure, a phone, a report.

import { copyFileSync, mkdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { drawing, expect, open, test } from "./polymapper.js";

const LAYERS = ["map", "scan", "pairs", "arcs", "hypotheses", "virtual", "way", "closures", "ellipses", "moving"];

/** @param {import("@playwright/test").Page} page @param {number} n */
async function scrubTo(page, n) {
  await page.locator("#slider").evaluate((slider, value) => {
    const s = /** @type {HTMLInputElement} */ (slider);
    s.value = String(value);
    s.dispatchEvent(new Event("input"));
  }, n);
  await expect(page.locator("#position")).toHaveText(`${n} / 300`);
}

test("a finished build opens with its whole map", async ({ page, viewing, built }) => {
  const { url } = await viewing(built);
  await open(page, url);
  await expect(page.locator("h1")).toHaveText("MIT Killian Court, 300 scans");
  await expect(page.locator("#status")).toHaveText("finished");
  await expect(page.locator("#position")).toHaveText("300 / 300");
  const report = JSON.parse(readFileSync(join(built, "report.json"), "utf8"));
  await expect(page.locator("#map-panel")).toContainText(`${report.scans.placed} of 300`);
  await expect(page.locator("#map-panel")).toContainText(`Polylines${report.map.polylines}Vertices${report.map.vertices}`);
  await page.waitForTimeout(500);
  await expect(page).toHaveScreenshot("map.png");
});

test("a build without a replay shows map and way, and says what is missing", async ({ page, viewing, built, scratch }) => {
  const folder = join(scratch, "result");
  mkdirSync(folder, { recursive: true });
  for (const name of ["map.json", "trajectory.csv"]) copyFileSync(join(built, name), join(folder, name));
  const { url } = await viewing(folder);
  await open(page, url);
  await expect(page.locator("#why")).toContainText("There is no replay.jsonl.gz here");
  await expect(page.locator("#layer-list input")).toHaveCount(3);
  await expect(page.locator("#map-panel")).toContainText("Scans placed300 of 300");
  const walls = await page.locator("#map-panel").textContent();
  const whole = await drawing(page);
  await scrubTo(page, 100);
  expect(await drawing(page), "the way is shorter").not.toBe(whole);
  await expect(page.locator("#map-panel")).toContainText(walls?.match(/Polylines\d+/)?.[0] ?? "", { timeout: 1000 });
});

test("it plays from the start, pauses and steps", async ({ page, viewing, built }) => {
  const { url } = await viewing(built);
  await open(page, url);
  await page.getByRole("button", { name: "Play" }).click();
  await expect(page.getByRole("button", { name: "Pause" })).toBeVisible();
  const position = async () => Number((await page.locator("#position").textContent())?.split(" ")[0]);
  await expect.poll(position).toBeGreaterThan(10);
  await page.getByRole("button", { name: "Pause" }).click();
  await page.waitForTimeout(200);
  const paused = await position();
  expect(paused).toBeLessThan(250);
  await page.waitForTimeout(300);
  expect(await position()).toBe(paused);
  await page.getByRole("button", { name: "One scan on" }).click();
  await expect.poll(position).toBe(paused + 1);
  await page.locator("#map").focus();
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowLeft");
  await expect.poll(position).toBe(paused - 1);
  await page.keyboard.press("Shift+ArrowRight");
  await expect.poll(position).toBe(Math.min(300, paused + 99));
  await page.keyboard.press("Home");
  await expect.poll(position).toBe(0);
  await page.keyboard.press("Space");
  await expect.poll(position).toBeGreaterThan(3);
});

test("scrubbing goes back to the same picture", async ({ page, viewing, built }) => {
  const { url } = await viewing(built);
  await open(page, url);
  await page.locator("#map").focus();
  await scrubTo(page, 150);
  await page.keyboard.press("f");
  await page.mouse.wheel(0, 0);
  await page.waitForTimeout(600);
  await expect(page).toHaveScreenshot("scrubbed.png");
  const before = await page.locator("#map-panel").textContent();
  for (const n of [20, 299, 240, 151]) await scrubTo(page, n);
  await scrubTo(page, 150);
  await page.waitForTimeout(300);
  expect(await page.locator("#map-panel").textContent()).toBe(before);
});

test("every layer can be shown and hidden, by click and by key", async ({ page, viewing, built }) => {
  const { url } = await viewing(built);
  await open(page, url);
  // A scan with a search, closures before it.
  await page.getByRole("button", { name: "To the search or recognition before" }).click();
  await expect(page.locator("#outcome")).toHaveText("placed by search");
  await expect(page.locator("#hypotheses tbody tr").first()).toBeVisible();
  const box = await page.locator("#map").boundingBox();
  await page.mouse.move((box?.x ?? 0) + 5, (box?.y ?? 0) + 5);
  for (const layer of LAYERS) {
    await page.waitForTimeout(120);
    const before = await drawing(page);
    await page.locator(`#layer-${layer}`).click();
    await expect.poll(() => drawing(page), { message: layer }).not.toBe(before);
    await page.locator(`#layer-${layer}`).click();
  }
  const way = page.locator("#layer-way");
  await page.locator("#map").focus();
  await page.keyboard.press("7");
  await expect(way).not.toBeChecked();
  await page.keyboard.press("7");
  await expect(way).toBeChecked();
});

test("eraser boxes are drawn where there are some", async ({ page, viewing, scratch }) => {
  const { writeRecord } = await import("./made_up.js");
  const folder = join(scratch, "boxes");
  writeRecord(folder, { scans: 40, walls: 8, boxes: [[-500, -500, 900, 700]] });
  const { url } = await viewing(folder);
  await open(page, url);
  const before = await drawing(page);
  await page.locator("#layer-boxes").click();
  await expect.poll(() => drawing(page)).not.toBe(before);
});

test("the panel says why a scan lies where it does", async ({ page, viewing, built, scratch }) => {
  const { writeRecord } = await import("./made_up.js");
  const folder = join(scratch, "why");
  writeRecord(folder, { scans: 40, walls: 8, boxes: [] });
  const quiet = await viewing(folder);
  await open(page, quiet.url);
  await expect(page.locator("#why")).toContainText("no search was needed");
  const { url } = await viewing(built);
  await open(page, url);
  await scrubTo(page, 1);
  await expect(page.locator("#why")).toContainText("The first scan makes the frame of the map");
  await page.locator("#map").focus();
  await page.keyboard.press("n");
  await expect(page.locator("#why")).toContainText(/Of the poses that matching by shape and search gave/);
  const before = await drawing(page);
  // By keyboard; the pointer does the same, but where it lands hangs on when the panel has scrolled.
  await page.locator("#hypotheses tbody tr").nth(1).focus();
  await expect.poll(() => drawing(page)).not.toBe(before);
});

test("pointing at a wall tells its id, observations and deviation", async ({ page, viewing, scratch }) => {
  const { writeRecord, WALL } = await import("./made_up.js");
  const folder = join(scratch, "hover");
  writeRecord(folder, { scans: 40, walls: 8, boxes: [] });
  const { url } = await viewing(folder);
  await open(page, url);
  await page.locator("#layer-way").uncheck();
  const at = await find(page, WALL.to);
  await page.mouse.move(at[0], at[1]);
  const tip = page.locator("#tooltip");
  await expect(tip).toContainText("Polyline 0, vertex 2 of 2");
  await expect(tip).toContainText("Observations 17");
  await expect(tip).toContainText("Standard deviation 1.2");
  await page.mouse.move(at[0] - 60, at[1] + 1);
  await expect(tip).toContainText("side 1 of 1");
});

test("a distance is measured from vertex to vertex", async ({ page, viewing, scratch }) => {
  const { writeRecord, WALL } = await import("./made_up.js");
  const folder = join(scratch, "measure");
  writeRecord(folder, { scans: 40, walls: 8, boxes: [] });
  const { url } = await viewing(folder);
  await open(page, url);
  await page.getByRole("button", { name: "Measure a distance" }).click();
  await page.mouse.click(...(await find(page, WALL.from)));
  // Two pixels off: the vertex is taken.
  const to = await find(page, WALL.to);
  await page.mouse.click(to[0] + 2, to[1] + 2);
  await expect(page.locator("#readout")).toHaveText(/^4\.00.m · 0\.0°$/);
  await page.keyboard.press("Escape");
  await expect(page.locator("#readout")).toBeHidden();
});

/**
 * Where a point of the made-up map is on the screen, by the scale bar: the view is fitted to it.
 * @param {import("@playwright/test").Page} page
 * @param {readonly [number, number]} point
 * @returns {Promise<[number, number]>}
 */
async function find(page, point) {
  await page.locator("#map").focus();
  await page.keyboard.press("f");
  await page.waitForTimeout(200);
  const { EXTENT } = await import("./made_up.js");
  const scale = await page.locator("#scale").evaluate((bar) => {
    const [value, unit] = (bar.textContent ?? "").split("\u202f");
    return bar.getBoundingClientRect().width / (Number(value) * (unit === "mm" ? 0.001 : 1));
  });
  const box = await page.locator("#map").boundingBox();
  if (!box) throw new Error("the map is not there");
  const x = box.x + box.width / 2 + (point[0] - EXTENT.x) * scale;
  return [x, box.y + box.height / 2 - (point[1] - EXTENT.y) * scale];
}

test("it works at the width of a phone", async ({ page, viewing, built }) => {
  await page.setViewportSize({ width: 390, height: 844 });
  const { url } = await viewing(built);
  await open(page, url);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  expect(wide).toBeLessThanOrEqual(390);
  await page.waitForTimeout(500);
  await expect(page).toHaveScreenshot("phone.png");
  await page.getByRole("button", { name: "Play" }).click();
  await expect(page.getByRole("button", { name: "Pause" })).toBeVisible();
  await page.getByRole("button", { name: "Pause" }).click();
  await page.getByRole("button", { name: "Scan, layers, figures" }).click();
  await page.locator("#layer-arcs").check();
  await expect(page.locator("#layer-arcs")).toBeChecked();
  for (const button of await page.locator("footer button:visible, header button:visible").all()) {
    const box = await button.boundingBox();
    expect(Math.min(box?.width ?? 0, box?.height ?? 0), "large enough for a thumb").toBeGreaterThanOrEqual(40);
  }
});

test("dark and light", async ({ page, viewing, built }) => {
  await page.emulateMedia({ colorScheme: "dark" });
  const { url } = await viewing(built);
  await open(page, url);
  await page.waitForTimeout(500);
  await expect(page).toHaveScreenshot("dark.png");
  await page.keyboard.press("t");
  await expect(page.locator("html")).toHaveAttribute("data-theme", "light");
});

test("everything can be reached and has a name; text stands out from its ground", async ({ page, viewing, built }) => {
  const { url } = await viewing(built);
  for (const scheme of /** @type {const} */ (["light", "dark"])) {
    await page.emulateMedia({ colorScheme: scheme });
    await open(page, url);
    const nameless = await page.evaluate(() =>
      [...document.querySelectorAll("button, input, select, [tabindex]")]
        .filter((e) => !(e.getAttribute("aria-label") ?? e.closest("label")?.textContent ?? e.textContent)?.trim())
        .map((e) => e.outerHTML.slice(0, 80)),
    );
    expect(nameless).toEqual([]);
    const faint = await page.evaluate(faintTexts);
    expect(faint, scheme).toEqual([]);
  }
  await page.keyboard.press("Tab");
  const focused = await page.evaluate(() => getComputedStyle(document.activeElement ?? document.body).outlineStyle);
  expect(focused).not.toBe("none");
  await page.keyboard.press("?");
  await expect(page.getByRole("dialog")).toBeVisible();
  await page.keyboard.press("Escape");
  await expect(page.getByRole("dialog")).toBeHidden();
});

/** Texts with a contrast below 4.5 : 1 (WCAG 2.2 AA). Runs in the page. */
function faintTexts() {
  const parse = (/** @type {string} */ colour) => colour.match(/[\d.]+/g)?.map(Number) ?? [0, 0, 0, 0];
  const luminance = (/** @type {number[]} */ rgb) => {
    const [r, g, b] = rgb.map((v) => (v / 255 <= 0.04045 ? v / 255 / 12.92 : ((v / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (/** @type {Element | null} */ e) => {
    for (let at = e; at; at = at.parentElement) {
      const c = parse(getComputedStyle(at).backgroundColor);
      if (c.length === 3 || c[3] > 0.99) return c;
    }
    return [255, 255, 255];
  };
  return [...document.querySelectorAll("h1, h2, p, dt, dd, span, kbd, th, td, label, select, caption, i")]
    .filter((e) => e.checkVisibility() && [...e.childNodes].some((n) => n.nodeType === 3 && n.textContent?.trim()))
    .flatMap((e) => {
      const [a, b] = [luminance(parse(getComputedStyle(e).color).slice(0, 3)), luminance(ground(e).slice(0, 3))];
      const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      return ratio < 4.5 ? [`${e.textContent?.slice(0, 30)}: ${ratio.toFixed(2)}`] : [];
    });
}

test("report.html is one file that asks for nothing", async ({ page, built }) => {
  /** @type {string[]} */
  const asked = [];
  page.on("request", (request) => asked.push(request.url()));
  await open(page, `file://${join(built, "report.html")}`);
  await expect(page.locator("#report-lead")).toContainText("of the scans placed");
  for (const title of ["What was read", "Time", "Size", "Where it was uncertain", "Places recognised", "Settings"]) {
    await expect(page.getByRole("heading", { name: title })).toBeVisible();
  }
  expect(asked.filter((url) => !url.startsWith("file:") && !url.startsWith("data:") && !url.startsWith("blob:"))).toEqual([]);
  await page.getByText("All values").click();
  await expect(page.locator("pre")).toContainText("side_penalty: 16.0");
  await page.locator(".jumps button").first().click();
  await expect(page.locator("#position")).not.toHaveText("300 / 300");
  await page.getByRole("button", { name: "Play" }).click();
  await expect(page.getByRole("button", { name: "Pause" })).toBeVisible();
});

test("the report looks as it should", async ({ page, built }) => {
  await open(page, `file://${join(built, "report.html")}`);
  await page.waitForTimeout(500);
  // Times differ from run to run, and the text with them.
  await expect(page).toHaveScreenshot("report.png", { fullPage: true, mask: [page.locator("#report-lead"), page.locator("#report-cards")] });
});
