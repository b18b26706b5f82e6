// Details of scans, fetched in blocks when they are shown, and a few blocks ahead while playing. Old blocks are let go.

import { pointsOf, returnsOf } from "./record.js";

/**
 * @typedef {object} Detail A scan as it is drawn: laser frame, metres.
 * @property {number} n
 * @property {Float64Array} returns
 * @property {Float64Array[]} polylines
 * @property {Set<number>} moving
 * @property {import("./record.js").Search | undefined} search
 * @property {Float64Array[]} virtualScan Frame of the scan placed before.
 *
 * @typedef {object} Compared
 * @property {number} before
 * @property {Float64Array[]} reference
 * @property {import("./record.js").Pair[]} pairs
 * @property {[number, number, number][][]} arcs
 */

const BLOCK = 32;
const MOST_BLOCKS = 64;

export class Details {
  /**
   * @param {((path: string) => Promise<string>) | undefined} ask Undefined where there is nobody to ask.
   * @param {() => void} arrived
   */
  constructor(ask, arrived) {
    this.ask = ask;
    this.arrived = arrived;
    /** @type {Map<number, Detail>} */
    this.held = new Map();
    /** Blocks by age, the newest last. @type {Set<number>} */
    this.blocks = new Set();
    /** Blocks on their way. @type {Set<number>} */
    this.asked = new Set();
    /** @type {{n: number, before: number, found: Compared | undefined} | undefined} */
    this.comparison = undefined;
  }

  /**
   * The detail of a scan, if it is here; if not, it is sent for.
   * @param {number} n
   * @param {number} length How many scans there are.
   */
  get(n, length) {
    this.want(n, length);
    return this.held.get(n);
  }

  /**
   * @param {number} n
   * @param {number} length
   */
  want(n, length) {
    if (!this.ask || n < 0 || n >= length) return;
    const block = Math.floor(n / BLOCK);
    if (this.held.has(n)) {
      this.blocks.delete(block);
      this.blocks.add(block);
      return;
    }
    if (this.asked.has(block)) return;
    this.asked.add(block);
    void this.fetchBlock(block, length);
  }

  /**
   * @param {number} block
   * @param {number} length
   */
  async fetchBlock(block, length) {
    let first = block * BLOCK;
    const last = Math.min(length - 1, first + BLOCK - 1);
    while (first < last && this.held.has(first)) first += 1;
    try {
      const text = await this.ask?.(`detail?first=${first}&last=${last}`);
      for (const line of (text ?? "").split("\n")) {
        if (line) this.keep(JSON.parse(line).detail);
      }
      this.blocks.add(block);
      this.forget();
    } catch {
      // The server is gone or busy: it is asked again when the scan is shown again.
    }
    this.asked.delete(block);
    this.arrived();
  }

  /** @param {import("./record.js").DetailLine} line */
  keep(line) {
    this.held.set(line.n, {
      n: line.n,
      returns: returnsOf(line),
      polylines: line.polylines.map(pointsOf),
      moving: new Set(line.moving ?? []),
      search: line.search,
      virtualScan: (line.search?.virtual_scan ?? []).map(pointsOf),
    });
  }

  forget() {
    for (const block of this.blocks) {
      if (this.blocks.size <= MOST_BLOCKS) return;
      this.blocks.delete(block);
      for (let n = block * BLOCK; n < (block + 1) * BLOCK; n += 1) this.held.delete(n);
    }
  }

  /**
   * Arcs of a scan and its shape matching with an earlier one, if they are here; if not, they are sent for.
   * @param {number} n
   * @param {number} before
   * @param {import("./pose.js").Pose} pose Of scan n in the frame of the earlier one.
   * @returns {Compared | undefined}
   */
  compared(n, before, pose) {
    if (this.comparison?.n === n && this.comparison.before === before) return this.comparison.found;
    // One at a time: the answer for a scan that is no longer shown is of no use.
    if (this.ask && !this.asked.has(-1)) {
      this.asked.add(-1);
      void this.fetchComparison(n, before, pose);
    }
    return undefined;
  }

  /**
   * @param {number} n
   * @param {number} before
   * @param {import("./pose.js").Pose} pose
   */
  async fetchComparison(n, before, [x, y, theta]) {
    /** @type {Compared | undefined} */
    let found;
    try {
      const earlier = before >= 0 ? `&before=${before}&x=${x}&y=${y}&theta=${theta}` : "";
      const text = await this.ask?.(`compare?n=${n}${earlier}`);
      /** @type {import("./record.js").Comparison} */
      const answer = JSON.parse(text ?? "");
      found = { before, reference: answer.reference.map(pointsOf), pairs: answer.pairs, arcs: answer.arcs };
    } catch {
      found = undefined;
    }
    this.comparison = { n, before, found };
    this.asked.delete(-1);
    this.arrived();
  }
}
