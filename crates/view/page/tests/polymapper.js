// The program under test: started for a test, ended after it.

import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { test as base } from "@playwright/test";

export const ROOT = resolve(import.meta.dirname, "../../../..");
export const SAMPLE = join(ROOT, "samples/killian.log.gz");
/** Logs that are not ours to ship. */
export const RAW_INTEL = join(process.env.POLYMAPPER_SHARED ?? join(ROOT, "../shared"), "data/raw/intel.clf.gz");

const PROGRAM = process.env.POLYMAPPER ?? join(ROOT, "target/release/polymapper");

/**
 * Runs the program to its end; 3 means that something was left out.
 * @param {string[]} args
 */
export function run(args) {
  const done = spawnSync(PROGRAM, args, { encoding: "utf8" });
  if (done.status !== 0 && done.status !== 3) throw new Error(`${args.join(" ")}: ${done.stderr}`);
  return done;
}

/**
 * Starts the program.
 * @param {string[]} args
 */
export function start(args) {
  const started = spawn(PROGRAM, args, { stdio: ["pipe", "pipe", "pipe"] });
  // It may be ended while something is on its way to it.
  started.stdin.on("error", () => {});
  return started;
}

/**
 * @typedef {object} View
 * @property {string} url
 * @property {import("node:child_process").ChildProcessWithoutNullStreams} process
 * @property {number} startedAt
 * @property {(words: RegExp) => Promise<void>} said Waits until the program has said something.
 */

/**
 * Starts `polymapper view` and waits for its address.
 * @param {string[]} args
 * @returns {Promise<View>}
 */
export function view(args) {
  const startedAt = performance.now();
  const started = start(["view", "--port", "0", ...args]);
  let text = "";
  started.stderr.on("data", (piece) => {
    text += piece;
  });
  /** @type {(words: RegExp) => Promise<void>} */
  const said = (words) =>
    new Promise((found, failed) => {
      const look = () => words.test(text) && found();
      started.stderr.on("data", look);
      started.on("exit", () => failed(new Error(text)));
      look();
    });
  return said(/http:\/\/\S+\s/).then(() => {
    const url = text.match(/http:\/\/\S+/)?.[0] ?? "";
    return { url, process: started, startedAt, said };
  });
}

/**
 * @typedef {object} Worker
 * @property {string} scratch A folder that goes away.
 * @property {string} built The sample's build in it, made once.
 *
 * @typedef {object} Viewing
 * @property {(...args: string[]) => Promise<View>} viewing Starts `view`; ended after the test.
 */

/** @type {import("@playwright/test").Fixtures<Viewing, Worker, import("@playwright/test").PlaywrightTestArgs>} */
const fixtures = {
  scratch: [
    // eslint-disable-next-line no-empty-pattern -- Playwright reads the pattern
    async ({}, use) => {
      const folder = mkdtempSync(join(tmpdir(), "polymapper-page-"));
      await use(folder);
      rmSync(folder, { recursive: true });
    },
    { scope: "worker" },
  ],
  built: [
    async ({ scratch }, use) => {
      const folder = join(scratch, "demo");
      if (!existsSync(folder)) run(["demo", "-o", folder]);
      await use(folder);
    },
    { scope: "worker" },
  ],
  viewing: async ({ page }, use) => {
    /** @type {View[]} */
    const all = [];
    /** @type {string[]} */
    const faults = [];
    page.on("pageerror", (/** @type {Error} */ error) => faults.push(error.message));
    page.on("console", (/** @type {import("@playwright/test").ConsoleMessage} */ message) => {
      if (message.type() === "error") faults.push(message.text());
    });
    await use(async (/** @type {string[]} */ ...args) => {
      const started = await view(args);
      all.push(started);
      return started;
    });
    for (const started of all) started.process.kill("SIGKILL");
    if (faults.length > 0) throw new Error(`the page complained: ${faults.join("; ")}`);
  },
};

export const test = /** @type {import("@playwright/test").TestType<Viewing & import("@playwright/test").PlaywrightTestArgs
  & import("@playwright/test").PlaywrightTestOptions, Worker & import("@playwright/test").PlaywrightWorkerArgs
  & import("@playwright/test").PlaywrightWorkerOptions>} */ (base.extend(fixtures));

export { expect } from "@playwright/test";

/**
 * The page with everything read.
 * @param {import("@playwright/test").Page} page
 * @param {string} url
 */
export async function open(page, url) {
  await page.goto(url);
  await page.waitForFunction(() => !document.getElementById("status")?.textContent?.startsWith("live"));
  await page.waitForFunction(() => !document.getElementById("position")?.textContent?.startsWith("0 "));
}

/**
 * How many pixels of the map differ between two moments; the canvases only.
 * @param {import("@playwright/test").Page} page
 * @returns {Promise<number>} A number that changes when the drawing does.
 */
export function drawing(page) {
  return page.evaluate(
    () =>
      new Promise((done) => {
        // Two frames: one may be on its way.
        requestAnimationFrame(() =>
          requestAnimationFrame(() => {
            let sum = 0;
            for (const id of ["below", "above"]) {
              const canvas = /** @type {HTMLCanvasElement} */ (document.getElementById(id));
              const data = canvas.getContext("2d")?.getImageData(0, 0, canvas.width, canvas.height).data ?? [];
              for (let k = 0; k < data.length; k += 4) {
                sum = (sum * 31 + data[k] + 3 * data[k + 1] + 7 * data[k + 2] + data[k + 3]) % 1_000_000_007;
              }
            }
            done(sum);
          }),
        );
      }),
  );
}

/**
 * Times between frames, milliseconds, ascending.
 * @param {import("@playwright/test").Page} page
 * @param {number} seconds
 * @returns {Promise<number[]>}
 */
export function frameTimes(page, seconds) {
  return page.evaluate(
    (s) =>
      new Promise((done) => {
        /** @type {number[]} */
        const times = [];
        let last = performance.now();
        const end = last + s * 1000;
        const frame = (/** @type {number} */ now) => {
          times.push(now - last);
          last = now;
          if (now < end) requestAnimationFrame(frame);
          else done(times.slice(1).sort((a, b) => a - b));
        };
        requestAnimationFrame(frame);
      }),
    seconds,
  );
}

/** @param {number[]} values */
export function median(values) {
  return quantile([...values].sort((a, b) => a - b), 0.5);
}

/** @param {number[]} sorted @param {number} share */
export function quantile(sorted, share) {
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}
