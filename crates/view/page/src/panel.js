// What is known of the scan shown: its outcome, why, in figures; and the map in figures.

import { element } from "./dom.js";
import { count, degrees, duration, length, percent, place } from "./format.js";

/**
 * @typedef {import("./record.js").Frame} Frame
 * @typedef {import("./history.js").History} History
 */

export class Panel {
  /**
   * @param {HTMLElement} scan
   * @param {HTMLElement} map
   * @param {HTMLElement} search
   * @param {History} history
   * @param {(hypothesis: number | undefined) => void} point
   */
  constructor(scan, map, search, history, point) {
    this.scan = scan;
    this.map = map;
    this.search = search;
    this.history = history;
    this.point = point;
    this.shown = "";
  }

  /**
   * @param {import("./details.js").Detail | undefined} detail
   * @param {{vertices: number, length_m: number}} totals
   * @param {boolean} inMotion Whether the next scan is shown before anybody can read.
   */
  draw(detail, totals, inMotion) {
    const { history } = this;
    const key = [history.time, history.length, history.mapVersion, history.posesVersion, detail?.n, Boolean(history.end), inMotion].join();
    if (key === this.shown) return;
    this.shown = key;
    const frame = history.frame;
    this.scan.replaceChildren(...(frame ? this.scanParts(frame, detail) : [nothing(history)]));
    this.map.replaceChildren(figures(this.mapRows(totals)));
    const hypotheses = (frame && detail?.search?.hypotheses) || [];
    // While it goes on, a table that comes and goes would move all that is below it.
    const words = inMotion && hypotheses.length > 0 ? searched(hypotheses) : noSearch(frame, detail);
    const table = hypotheses.length > 0 && !inMotion;
    this.search.replaceChildren(table ? this.hypothesesTable(hypotheses) : element("p", { class: "note" }, words));
  }

  /**
   * @param {Frame} frame
   * @param {import("./details.js").Detail | undefined} detail
   */
  scanParts(frame, detail) {
    const n = this.history.time - 1;
    const [tone, word] = outcome(frame, Boolean(this.history.poses[n]));
    const missing = this.history.about?.missing;
    const parts = [
      element(
        "div",
        { class: "scan-head" },
        element("span", { class: "scan-number" }, count(frame.scan)),
        element("span", { class: `chip ${tone}`, id: "outcome" }, word),
      ),
      element("p", { class: "why", id: "why" }, [why(frame, detail, this.history.placedBefore(n) < 0), missing].filter(Boolean).join(" ")),
    ];
    if (frame.fit !== undefined) parts.push(bars(frame));
    parts.push(figures(this.scanRows(frame, n)));
    return parts;
  }

  /**
   * @param {Frame} frame
   * @param {number} n
   * @returns {[string, string][]}
   */
  scanRows(frame, n) {
    const pose = this.history.poses[n];
    /** @type {[string, string][]} */
    const rows = [];
    if (pose) {
      rows.push(["Place", place(pose[0], pose[1])]);
      rows.push(["Heading", degrees(pose[2])]);
    }
    if (frame.ellipse) {
      rows.push(["Standard deviation", `${length(frame.ellipse[0])} × ${length(frame.ellipse[1])}`]);
    }
    if (frame.open_rad !== undefined) rows.push(["Left open by walls", `along ${degrees(frame.open_rad)}`]);
    if (frame.rms_mm !== undefined) rows.push(["Returns off walls, rms", length(frame.rms_mm / 1000)]);
    if (frame.lead !== undefined) rows.push(["Lead over next pose", frame.lead.toFixed(2)]);
    if (!this.history.about?.missing) rows.push(["Returns", count(frame.returns)]);
    const stamp = frame.stamp_s;
    const first = this.history.frames[0]?.stamp_s;
    if (stamp !== undefined && first !== undefined && stamp >= first) rows.push(["Time", duration(stamp - first)]);
    return rows;
  }

  /** @param {import("./record.js").Hypothesis[]} hypotheses */
  hypothesesTable(hypotheses) {
    const best = hypotheses[0].score;
    const worst = Math.min(...hypotheses.map((h) => h.score));
    const rows = hypotheses.slice(0, 8).map((h, k) => {
      const share = best > worst ? (h.score - worst) / (best - worst) : 1;
      const bar = element("span", { class: "bar-fill" });
      bar.style.width = `${(8 + 92 * share).toFixed(0)}%`;
      const row = element(
        "tr",
        { tabindex: "0" },
        element("td", {}, String(k + 1)),
        element("td", { class: "bar-cell" }, element("span", { class: "bar" }, bar)),
        element("td", {}, h.score.toFixed(2)),
        element("td", {}, percent(h.fit)),
        element("td", {}, percent(h.through)),
        element("td", {}, k === 0 ? "" : away(hypotheses[0].pose, h.pose)),
      );
      for (const kind of ["pointerenter", "focus"]) row.addEventListener(kind, () => this.point(k));
      for (const kind of ["pointerleave", "blur"]) row.addEventListener(kind, () => this.point(undefined));
      return row;
    });
    const head = ["", "Score", "", "agree", "through", "away"].map((text) => element("th", { scope: "col" }, text));
    return element(
      "table",
      { class: "hypotheses", id: "hypotheses" },
      element("caption", {}, `${hypotheses.length} poses; point at one to see it`),
      element("thead", {}, element("tr", {}, ...head)),
      element("tbody", {}, ...rows),
    );
  }

  /**
   * @param {{vertices: number, length_m: number}} totals
   * @returns {[string, string][]}
   */
  mapRows(totals) {
    const { frames, map, mapScans, poses, time } = this.history;
    let [placed, way] = [0, 0];
    /** @type {import("./pose.js").Pose | undefined} */
    let last;
    for (let n = 0; n < time; n += 1) {
      const pose = poses[n];
      if (pose) {
        placed += 1;
        if (last) way += Math.hypot(pose[0] - last[0], pose[1] - last[1]);
      }
      last = pose;
    }
    return [
      ["Scans placed", `${count(placed)} of ${count(time)}`],
      ["Way", length(way)],
      ["Polylines", count(map.size)],
      ["Vertices", count(totals.vertices)],
      ["Walls", length(totals.length_m)],
      ["Map made after scan", mapScans > 0 ? count(frames[mapScans - 1]?.scan ?? mapScans) : "–"],
    ];
  }
}

/** @param {History} history */
function nothing({ about, end }) {
  const words = about?.missing ?? (end ? "Nothing is shown before the first scan." : "Waiting for the first scan.");
  return element("p", { class: "why" }, words);
}

/**
 * @param {Frame} frame
 * @param {boolean} placedNow
 * @returns {[string, string]} Tone and word.
 */
function outcome(frame, placedNow) {
  if (!frame.pose) return placedNow ? ["good", "placed later"] : ["bad", "not placed"];
  if (frame.recognised !== undefined) return ["known", "place recognised"];
  if (frame.searched) return ["searched", "placed by search"];
  return ["good", frame.merged ? "placed, merged" : "placed"];
}

/**
 * How far one pose is from another: the distance, or the turn where there is hardly any.
 * @param {import("./pose.js").Pose} from
 * @param {import("./pose.js").Pose} to
 */
function away(from, to) {
  const distance = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const turn = Math.atan2(Math.sin(to[2] - from[2]), Math.cos(to[2] - from[2]));
  return distance < 0.05 ? degrees(turn) : length(distance);
}

/** @param {import("./record.js").Hypothesis[]} hypotheses */
function searched(hypotheses) {
  return `${hypotheses.length} poses were looked at, scores ${hypotheses[0].score.toFixed(2)} to ${hypotheses[hypotheses.length - 1].score.toFixed(2)}. Pause to compare them.`;
}

/**
 * Why no poses are listed, in words.
 * @param {Frame | undefined} frame
 * @param {import("./details.js").Detail | undefined} detail
 */
function noSearch(frame, detail) {
  if (!frame?.searched) return "This scan needed none: the motion so far settled its place.";
  return detail ? "It was searched in a map of its own, which has no place in this one." : "Being fetched.";
}

/**
 * Why this pose, in words.
 * @param {Frame} frame
 * @param {import("./details.js").Detail | undefined} detail
 * @param {boolean} isFirst Whether none was placed before.
 */
function why(frame, detail, isFirst) {
  const poses = detail?.search?.hypotheses.length ?? 0;
  if (!frame.pose) return `Not placed: ${frame.reason ?? "no reason given"}.`;
  const parts = [];
  if (isFirst) parts.push("The first scan makes the frame of the map.");
  else if (frame.fit !== undefined && !frame.searched) {
    parts.push(`The motion so far led to a pose at which ${percent(frame.fit)} of the beams that the map knows end on a wall; no search was needed.`);
  } else if (frame.searched) {
    const lead = frame.lead === undefined ? "no other pose comes near" : `the best leads by ${frame.lead.toFixed(2)}`;
    parts.push(`The motion so far did not settle the place. ${poses > 0 ? `Of the poses that matching by shape and search gave, ${poses} are listed; ` : ""}${lead}.`);
  }
  if (frame.open_rad !== undefined) parts.push("The walls leave a direction open; there the motion decided.");
  if (frame.recognised !== undefined) parts.push(`The place of scan ${count(frame.recognised)} was recognised.`);
  return parts.join(" ");
}

/** @param {Frame} frame */
function bars(frame) {
  /** @type {[string, number | undefined, string][]} */
  const shares = [
    ["Beams that agree", frame.fit, "of the beams that the map knows, the share that ends on a wall"],
    ["Beams known", frame.known, "share of the beams that the map says something of"],
    ["Returns matched", frame.matched, "share of the returns that found a wall"],
    ["Beams through walls", frame.through, "share of the beams that return from behind a wall"],
  ];
  const rows = shares
    .filter(([, share]) => share !== undefined)
    .map(([name, share, title]) => {
      const fill = element("span", { class: "bar-fill" });
      fill.style.width = `${(100 * (share ?? 0)).toFixed(1)}%`;
      return element(
        "div",
        { class: "bar-row", title },
        element("span", { class: "bar-name" }, name),
        element("span", { class: "bar-value" }, percent(share)),
        element("span", { class: "bar" }, fill),
      );
    });
  return element("div", { class: "bars" }, ...rows);
}

/** @param {[string, string][]} rows */
export function figures(rows) {
  const parts = rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]);
  return element("dl", { class: "figures" }, ...parts);
}
