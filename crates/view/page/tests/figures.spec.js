// The figures that the page has to reach: frame time, first picture, live latency, and what clients cost the mapper.
//
// Other programs on the machine can spoil a measurement. So everything is measured several times, and it is known how
// much of the processors others had meanwhile: what they spoiled is not judged, and of the rest the middle is. What
// cannot be judged is skipped, and said; it is not tried until it passes.

import { createInterface } from "node:readline";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { abuse } from "./abusers.js";
import { expect, frameTimes, median, open, quantile, RAW_INTEL, run, SAMPLE, start, test } from "./polymapper.js";
import { ratioOfPairs } from "./pairs.js";
import { Processors } from "./processors.js";

const FRAME_MS = 33;
/** Share of the processors that others may have in a measurement that counts. */
const MOST_OTHERS = 0.2;

/**
 * Measures until there are enough measurements that count, and judges the one in the middle.
 * @param {string} what
 * @param {number} most Milliseconds.
 * @param {{wanted: number, tries: number}} how
 * @param {() => Promise<number>} measure Milliseconds.
 */
async function judge(what, most, { wanted, tries }, measure) {
  /** @type {number[]} */
  const all = [];
  /** @type {number[]} */
  const counting = [];
  const processors = new Processors();
  for (let k = 0; k < tries && counting.length < wanted; k += 1) {
    processors.othersShare();
    const took = await measure();
    const others = processors.othersShare();
    all.push(took);
    if (others <= MOST_OTHERS) counting.push(took);
    console.log(`${what}: ${took.toFixed(1)} ms; others had ${(100 * others).toFixed(0)} % of the processors`);
  }
  const judged = counting.length >= wanted ? counting : all;
  console.log(`${what}: ${median(judged).toFixed(1)} ms in the middle of ${judged.length}`);
  const isSpoiled = counting.length < wanted && median(all) > most;
  test.skip(isSpoiled, `not judged: other programs had the processors in ${all.length - counting.length} of ${all.length} measurements`);
  expect(median(judged)).toBeLessThanOrEqual(most);
}

/**
 * Judges the times between frames by their 95th percentile.
 * @param {import("@playwright/test").Page} page
 * @param {string} what
 * @param {number} most Milliseconds.
 */
function judgeFrames(page, what, most) {
  const measure = async () => quantile(await frameTimes(page, 2), 0.95);
  return judge(`${what}, p95 of frame times`, most, { wanted: 5, tries: 10 }, measure);
}

/**
 * Plays the last quarter and measures.
 * @param {import("@playwright/test").Page} page
 * @param {string} what
 */
async function playLastQuarter(page, what) {
  await page.locator("#slider").evaluate((slider) => {
    const s = /** @type {HTMLInputElement} */ (slider);
    s.value = String(Math.round(Number(s.max) * 0.75));
    s.dispatchEvent(new Event("input"));
  });
  await page.selectOption("#speed", "20");
  await page.getByRole("button", { name: "Play" }).click();
  await page.waitForTimeout(500);
  await judgeFrames(page, what, FRAME_MS);
  await expect(page.getByRole("button", { name: "Pause" }), "it played all the time").toBeVisible();
}

test("10 000 vertices and 20 000 poses stay fluent", async ({ page, viewing, scratch }) => {
  const { writeRecord } = await import("./made_up.js");
  const folder = join(scratch, "large");
  writeRecord(folder, { scans: 20_000, walls: 2000, vertices: 5, boxes: [] });
  const { url } = await viewing(folder);
  await open(page, url);
  await expect(page.locator("#map-panel")).toContainText("10\u202f000");
  await playLastQuarter(page, "10 000 vertices, 20 000 poses");
});

test("10 000 vertices and 20 000 poses can be moved by hand", async ({ page, viewing, scratch }) => {
  const { writeRecord } = await import("./made_up.js");
  const folder = join(scratch, "large");
  if (!existsSync(folder)) writeRecord(folder, { scans: 20_000, walls: 2000, vertices: 5, boxes: [] });
  const { url } = await viewing(folder);
  await open(page, url);
  // Moving the view draws everything anew in every frame.
  const box = await page.locator("#map").boundingBox();
  const [x, y] = [(box?.x ?? 0) + 400, (box?.y ?? 0) + 300];
  await page.mouse.move(x, y);
  await page.mouse.down();
  let moving = true;
  const moved = (async () => {
    for (let k = 0; moving; k += 1) {
      await page.mouse.move(x + 90 * Math.sin(k / 9), y + 70 * Math.cos(k / 8));
      await page.waitForTimeout(16);
    }
  })();
  try {
    await judgeFrames(page, "10 000 vertices, 20 000 poses, moved by hand", 2 * FRAME_MS);
  } finally {
    moving = false;
    await moved;
  }
});

test("raw intel at full map stays fluent", async ({ page, viewing, scratch }) => {
  test.skip(!existsSync(RAW_INTEL), "skipped: ../shared/data/raw/intel.clf.gz is not there");
  test.setTimeout(180_000);
  const folder = join(scratch, "intel");
  run(["build", RAW_INTEL, "-o", folder]);
  const { url } = await viewing(folder);
  await open(page, url);
  await playLastQuarter(page, "raw intel");
});

test("the first picture is there within a second", async ({ page, viewing }) => {
  await judge("first picture", 1000, { wanted: 5, tries: 10 }, async () => {
    // The browser is open already; what counts is the program and the page.
    const viewer = await viewing(SAMPLE);
    await page.goto(viewer.url);
    await page.waitForFunction(() => {
      const canvas = /** @type {HTMLCanvasElement | null} */ (document.getElementById("above"));
      return canvas?.getContext("2d")?.getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v > 0);
    });
    const took = performance.now() - viewer.startedAt;
    await page.goto("about:blank");
    viewer.process.kill("SIGKILL");
    return took;
  });
});

/**
 * Notes in the page when each scan is first on the screen: the slider is set in the frame that draws it.
 * @param {import("@playwright/test").Page} page
 */
function noteWhatIsShown(page) {
  return page.evaluate(() => {
    /** @type {[number, number][]} */
    const shown = [];
    Object.assign(window, { shown });
    const slider = /** @type {HTMLInputElement} */ (document.getElementById("slider"));
    let last = 0;
    const look = () => {
      const now = Number(slider.value);
      for (let n = last; n < now; n += 1) shown.push([n, Date.now()]);
      last = now;
      requestAnimationFrame(look);
    };
    look();
  });
}

/**
 * Plays a log at 40 scans a second into a viewer that the page follows.
 * @param {string} log
 * @param {import("@playwright/test").Page} page
 * @param {import("./polymapper.js").View} viewer
 * @returns {Promise<number[]>} Milliseconds from sent to shown, ascending.
 */
async function playLive(log, page, viewer) {
  await page.goto(viewer.url);
  await expect(page.locator("#scan-panel")).toContainText("Waiting for the first scan");
  await noteWhatIsShown(page);
  const player = start(["play", log, "--hz", "40"]);
  /** @type {number[]} */
  const sent = [];
  for await (const line of createInterface({ input: player.stdout })) {
    sent.push(Date.now());
    viewer.process.stdin.write(`${line}\n`);
  }
  await page.waitForFunction((n) => /** @type {any} */ (window).shown.length >= n, sent.length);
  /** @type {[number, number][]} */
  const shown = await page.evaluate(() => /** @type {any} */ (window).shown);
  return shown.map(([n, at]) => at - sent[n]).sort((a, b) => a - b);
}

test("a scan of a live stream is shown within 100 ms, at 40 scans a second", async ({ page, viewing, scratch }) => {
  test.setTimeout(180_000);
  // Every scan of a robot that drives, as a live stream has them. The sample keeps one every half metre: at 40 a second that is a
  // drive of 20 m/s, and measures how fast scans without a prediction are searched for.
  const log = join(scratch, "live.log.gz");
  run(["simulate", "--plan", "office", "--scans", "300", "-o", log]);
  await judge("live, p95 of 300 scans", 100, { wanted: 3, tries: 6 }, async () => {
    const viewer = await viewing("-");
    const late = await playLive(log, page, viewer);
    expect(late.length).toBe(300);
    console.log(`live, median of 300 scans: ${quantile(late, 0.5)} ms, worst ${late[late.length - 1]} ms`);
    await expect(page.locator("#status")).toHaveText("live");
    viewer.process.stdin.end();
    await expect(page.locator("#status")).toHaveText("finished");
    await page.goto("about:blank");
    viewer.process.kill("SIGKILL");
    return quantile(late, 0.95);
  });
});

/**
 * Processor time of the thread that maps, seconds, and the most memory of the program, MB.
 * @param {import("./polymapper.js").View} viewer
 */
function costOf({ process: { pid } }) {
  const fields = readFileSync(`/proc/${pid}/task/${pid}/stat`, "utf8").split(") ")[1].split(" ");
  const peak = readFileSync(`/proc/${pid}/status`, "utf8").match(/VmHWM:\s*(\d+)/)?.[1];
  return { cpu_s: (Number(fields[11]) + Number(fields[12])) / 100, peak_mb: Number(peak) / 1000 };
}

/** How the mapper is measured. */
const KINDS = /** @type {const} */ (["alone", "abused"]);

test("two hundred clients slow the mapper by 5 % at most", async ({ viewing }) => {
  test.skip(!existsSync("/proc/self/stat"), "skipped: processor times are read on Linux");
  test.setTimeout(900_000);
  const log = existsSync(RAW_INTEL) ? RAW_INTEL : SAMPLE;
  const MOST = 1.05;
  const [fewest, most] = log === SAMPLE ? [8, 16] : [4, 8];
  /** @type {{alone: ReturnType<typeof costOf>[], abused: ReturnType<typeof costOf>[]}} */
  const costs = { alone: [], abused: [] };
  const ratio = () => ratioOfPairs(costs.alone.map((alone, k) => [alone.cpu_s, costs.abused[k].cpu_s]));
  for (let k = 0; k < most && (k < fewest || ratio().high > MOST); k += 1) {
    // Now one is first, now the other: a machine that becomes slower does so within a pair, too.
    for (const kind of k % 2 === 0 ? KINDS : KINDS.toReversed()) {
      const viewer = await viewing(log);
      const end = kind === "abused" ? abuse(viewer.url) : () => {};
      await viewer.said(/all is read/);
      costs[kind].push(costOf(viewer));
      end();
      viewer.process.kill("SIGKILL");
    }
  }
  const peak = (/** @type {ReturnType<typeof costOf>[]} */ all) => Math.max(...all.map((c) => c.peak_mb)).toFixed(0);
  const times = Object.entries(costs).map(([kind, all]) => `${kind} ${all.map((c) => c.cpu_s.toFixed(2)).join(", ")} s`);
  console.log(`mapper ${times.join("; ")}; memory ${peak(costs.alone)}, ${peak(costs.abused)} MB`);
  const { middle, low, high } = ratio();
  const said = `${middle.toFixed(3)} times as much with 200 clients, ${low.toFixed(3)} to ${high.toFixed(3)} by ${costs.alone.length} pairs`;
  console.log(said);
  expect(Number(peak(costs.abused))).toBeLessThan(Number(peak(costs.alone)) + 100);
  test.skip(middle > MOST && low <= MOST, `not judged: ${said}`);
  expect(middle, said).toBeLessThanOrEqual(MOST);
});
