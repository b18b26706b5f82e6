// The part of a report below the map: what was read, what became of it, where it was uncertain, time, sizes, settings.

import { byId, element } from "./dom.js";
import { count, duration, length, percent, size } from "./format.js";
import { figures } from "./panel.js";

/**
 * @typedef {object} Report As report.json, with sizes.
 * @property {string} generator
 * @property {string | null} partial
 * @property {{name: string, format: string, laser: string | null, lines: number, bytes: number, odometry_used: boolean,
 *   stamps_backwards: number, other_messages: Record<string, number>}} input
 * @property {{read: number, placed: number, not_placed: number, not_placed_by_reason: Record<string, number>}} scans
 * @property {{won: Record<string, number>, narrow_lead: number, open: number, rank: {three: number, two: number, less: number},
 *   largest_sigma_m: number | null, largest_sigma_scan: number | null,
 *   loose?: {from_scan: number, to_scan: number, sigma_m: number, sigma_rad: number}[]}} quality
 * @property {{polylines: number, vertices: number, length_m: number, eraser_boxes: number, bytes: number}} map
 * @property {{stage: string, wall_s: number, cpu_s: number | null}[]} stages
 * @property {number | null} peak_memory_bytes
 * @property {unknown} settings
 * @property {string[]} notes
 * @property {{name: string, bytes: number, how: string}[]} [sizes]
 */

/** Stretches of the log that are worth a look are listed up to this number, the longest. */
const MOST_STRETCHES = 12;
/** Doubtful scans less than this apart are one stretch. */
const SAME_STRETCH = 10;
/** Lines that could not be used are listed up to this number, the first. */
const MOST_LINES = 5;

/** @returns {Report | undefined} */
export function reportOfPage() {
  const text = document.getElementById("report-data")?.textContent;
  return text ? JSON.parse(text) : undefined;
}

/**
 * @param {Report} report
 * @param {import("./history.js").History} history Read to its end.
 * @param {(first: number, last: number) => void} show
 */
export function drawReport(report, history, show) {
  byId("report").hidden = false;
  byId("report-lead").replaceChildren(...lead(report));
  byId("report-cards").replaceChildren(
    card("What was read", figures(inputRows(report)), ...notes(report)),
    card("What became of it", figures(scanRows(report, history)), ...unusable(history)),
    card("How well it was placed", figures(qualityRows(report))),
    card("Time", stages(report)),
    card("Size", sizes(report)),
  );
  byId("report-wide").replaceChildren(
    card("Where it was uncertain", stretches(history, show)),
    card("Places recognised", closures(history, show)),
    card("Settings", settings(report.settings)),
  );
}

/** @param {Report} report */
function lead(report) {
  const { map, scans } = report;
  const seconds = report.stages.reduce((sum, s) => sum + s.wall_s, 0);
  /** @type {[string, string][]} */
  const numbers = [
    [`${percent(scans.placed / Math.max(1, scans.read))}`, "of the scans placed"],
    [length(map.length_m), "of wall"],
    [count(map.vertices), `vertices in ${count(map.polylines)} polylines`],
    [size(map.bytes), "map.json"],
    [duration(seconds), "to make it"],
  ];
  return numbers.map(([value, name]) =>
    element("div", { class: "number" }, element("strong", {}, value), element("span", {}, name)),
  );
}

/**
 * @param {string} title
 * @param {Node[]} content
 */
function card(title, ...content) {
  return element("section", { class: "card" }, element("h2", {}, title), ...content);
}

/**
 * @param {Report} report
 * @returns {[string, string][]}
 */
function inputRows({ input, generator, partial }) {
  /** @type {[string, string][]} */
  const rows = [
    ["Log", input.name.split("/").pop() ?? input.name],
    ["Format", [input.format, input.laser].filter(Boolean).join(", ")],
    ["Lines", count(input.lines)],
    ["Size, unpacked", size(input.bytes)],
    ["Odometry", input.odometry_used ? "used" : "not used"],
  ];
  if (input.stamps_backwards > 0) rows.push(["Stamps that run backwards", count(input.stamps_backwards)]);
  for (const [kind, n] of Object.entries(input.other_messages)) rows.push([`Other lines: ${kind}`, count(n)]);
  rows.push(["Made by", generator]);
  if (partial) rows.push(["Partial", partial]);
  return rows;
}

/** @param {Report} report */
function notes(report) {
  return report.notes.map((text) => element("p", { class: "note" }, text));
}

/**
 * @param {Report} report
 * @param {import("./history.js").History} history
 * @returns {[string, string][]}
 */
function scanRows({ scans }, history) {
  /** @type {[string, string][]} */
  const rows = [
    ["Scans read", count(scans.read)],
    ["Placed", count(scans.placed)],
    ["Not placed", count(scans.not_placed)],
  ];
  for (const [reason, n] of Object.entries(scans.not_placed_by_reason)) rows.push([`– ${reason.replaceAll("_", " ")}`, count(n)]);
  const frames = history.frames;
  rows.push(["Merged into the map", count(frames.filter((f) => f.merged).length)]);
  rows.push(["Placed by search", count(frames.filter((f) => f.pose && f.searched).length)]);
  rows.push(["A direction left open", count(frames.filter((f) => f.open_rad !== undefined).length)]);
  const shares = frames.flatMap((f) => f.fit ?? []).sort((a, b) => a - b);
  if (shares.length > 0) {
    rows.push(["Beams that agree, median", percent(shares[shares.length >> 1])]);
    rows.push(["– worst twentieth", percent(shares[Math.floor(shares.length / 20)])]);
  }
  return rows;
}

/** Where poses come from, as people say it; in the order in which guesses are asked. */
const ORIGINS = /** @type {[string, string][]} */ ([
  ["predicted", "As predicted"],
  ["standing", "Standing still"],
  ["wide", "By a wider guess"],
  ["as_before", "By a step made before"],
  ["shape", "By shape"],
  ["search", "By search"],
  ["back", "Back in a map that was left"],
  ["apart", "Nowhere: a map of its own"],
]);

/**
 * @param {Report} report
 * @returns {[string, string][]}
 */
function qualityRows({ quality }) {
  /** @type {[string, string][]} */
  const rows = ORIGINS.filter(([name]) => quality.won[name]).map(([name, words]) => [words, count(quality.won[name])]);
  rows.push(["Next best pose came near", count(quality.narrow_lead)]);
  rows.push(["Walls tell place and heading", count(quality.rank.three)]);
  rows.push(["– all but one direction", count(quality.rank.two)]);
  if (quality.rank.less > 0) rows.push(["– less", count(quality.rank.less)]);
  if (quality.largest_sigma_m !== null) {
    rows.push(["Largest standard deviation", length(quality.largest_sigma_m)]);
    rows.push(["– at scan", count(quality.largest_sigma_scan ?? 0)]);
  }
  // The map may be wrong there.
  const loose = (quality.loose ?? []).toSorted((a, b) => b.sigma_m - a.sigma_m);
  for (const { from_scan, to_scan, sigma_m } of loose.slice(0, MOST_LINES)) {
    rows.push([`Known poorly: scan ${count(from_scan)} to ${count(to_scan)}`, length(sigma_m)]);
  }
  if (loose.length > MOST_LINES) rows.push(["– more in report.json", count(loose.length - MOST_LINES)]);
  return rows;
}

/**
 * Lines of the log without a usable scan, and what is wrong with them.
 * @param {import("./history.js").History} history
 */
function unusable({ skipped }) {
  const lines = skipped.slice(0, MOST_LINES).map(({ line, why }) => element("p", { class: "note" }, `Line ${count(line)}: ${why}`));
  const rest = skipped.length - lines.length;
  return rest > 0 ? [...lines, element("p", { class: "note" }, `and ${count(rest)} more lines`)] : lines;
}

/** @param {Report} report */
function stages({ stages: all, peak_memory_bytes }) {
  const most = Math.max(...all.map((s) => s.wall_s), 1e-9);
  const rows = all.map((s) => barRow(s.stage, duration(s.wall_s), s.wall_s / most));
  const memory = peak_memory_bytes ? [element("p", { class: "note" }, `Most memory held: ${size(peak_memory_bytes)}`)] : [];
  return element("div", { class: "bars" }, ...rows, ...memory);
}

/** @param {Report} report */
function sizes({ map, sizes: others }) {
  const all = [{ name: "This map (map.json)", bytes: map.bytes, how: "" }, ...(others ?? [])];
  const most = Math.max(...all.map((s) => s.bytes));
  const rows = all.map((s) => barRow(s.name, size(s.bytes), s.bytes / most, s.how));
  return element("div", { class: "bars" }, ...rows);
}

/**
 * @param {string} name
 * @param {string} value
 * @param {number} share
 * @param {string} [title]
 */
function barRow(name, value, share, title) {
  const fill = element("span", { class: "bar-fill" });
  fill.style.width = `${Math.max(0.4, 100 * share).toFixed(1)}%`;
  return element(
    "div",
    { class: "bar-row", title },
    element("span", { class: "bar-name" }, name),
    element("span", { class: "bar-value" }, value),
    element("span", { class: "bar" }, fill),
  );
}

/**
 * Stretches of scans that were not placed, agreed badly, or where a direction was open.
 * @param {import("./history.js").History} history
 * @param {(first: number, last: number) => void} show
 */
function stretches(history, show) {
  /** @type {{first: number, last: number, lost: number, worst: number, open: number, scans: number}[]} */
  const found = [];
  history.frames.forEach((f, n) => {
    const lost = !f.pose;
    const open = f.open_rad !== undefined;
    if (!lost && !open && (f.fit ?? 1) >= 0.7) return;
    let stretch = found[found.length - 1];
    if (!stretch || n - stretch.last > SAME_STRETCH) {
      stretch = { first: n, last: n, lost: 0, worst: 1, open: 0, scans: 0 };
      found.push(stretch);
    }
    stretch.last = n;
    stretch.scans += 1;
    stretch.lost += lost ? 1 : 0;
    stretch.open += open ? 1 : 0;
    stretch.worst = Math.min(stretch.worst, f.fit ?? 1);
  });
  if (found.length === 0) return element("p", { class: "note" }, "Nowhere: every scan agrees with the map.");
  const shown = [...found].sort((a, b) => b.lost - a.lost || b.scans - a.scans).slice(0, MOST_STRETCHES);
  shown.sort((a, b) => a.first - b.first);
  const items = shown.map((s) => {
    const words = [];
    const one = s.first === s.last;
    if (s.lost > 0) words.push(one ? "not placed" : `${count(s.lost)} not placed`);
    if (s.open > 0) words.push(one ? "a direction is open" : `${count(s.open)} with a direction open`);
    if (s.worst < 0.7) words.push(`${percent(s.worst)} of the beams agree at worst`);
    return jump(history, s.first, s.last, words.join(", "), show);
  });
  const rest = found.length - shown.length;
  const more = rest > 0 ? [element("p", { class: "note" }, `and ${count(rest)} shorter stretches`)] : [];
  return element("div", {}, element("ul", { class: "jumps" }, ...items), ...more);
}

/**
 * @param {import("./history.js").History} history
 * @param {(first: number, last: number) => void} show
 */
function closures(history, show) {
  const all = history.frames.flatMap((f, n) => (f.recognised === undefined ? [] : [{ n, old: f.recognised }]));
  if (all.length === 0) return element("p", { class: "note" }, "None.");
  const items = all
    .slice(0, MOST_STRETCHES)
    .map(({ n, old }) => jump(history, n, n, `at the place of scan ${count(history.frames[old]?.scan ?? old)}`, show));
  const rest = all.length - items.length;
  const more = rest > 0 ? [element("p", { class: "note" }, `and ${count(rest)} more`)] : [];
  return element("div", {}, element("ul", { class: "jumps" }, ...items), ...more);
}

/**
 * @param {import("./history.js").History} history
 * @param {number} first
 * @param {number} last
 * @param {string} words
 * @param {(first: number, last: number) => void} show
 */
function jump(history, first, last, words, show) {
  const scan = (/** @type {number} */ n) => count(history.frames[n].scan);
  const name = first === last ? `Scan ${scan(first)}` : `Scans ${scan(first)}–${scan(last)}`;
  const button = element("button", { type: "button", class: "link" }, name);
  button.addEventListener("click", () => show(first, last));
  return element("li", {}, button, element("span", {}, words));
}

/** @param {unknown} value */
function settings(value) {
  const text = typeof value === "string" ? value : JSON.stringify(value, null, 1);
  // The settings come as one line of nested braces; a line each is easier to read.
  const lines = text.replace(/\{ /g, "{\n").replace(/ \}/g, "\n}").replace(/, /g, ",\n").split("\n");
  let depth = 0;
  const shown = lines.map((line) => {
    if (line.startsWith("}")) depth -= 1;
    const indented = "  ".repeat(Math.max(0, depth)) + line;
    if (line.endsWith("{")) depth += 1;
    return indented;
  });
  const details = element("details", {}, element("summary", {}, "All values"), element("pre", {}, shown.join("\n")));
  return details;
}
