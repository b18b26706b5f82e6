// Records that nobody mapped: known to the millimetre, or as large as is asked for.

import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { gzipSync } from "node:zlib";

/** The first wall of every made-up map, metres. */
export const WALL = { from: /** @type {const} */ ([-2, 3]), to: /** @type {const} */ ([2, 3]) };
/** The middle of the map of eight walls, metres. */
export const EXTENT = { x: 0, y: 0 };

/**
 * Eight walls around the origin, or many more beyond.
 * @param {number} k
 * @returns {[number, number, number, number]} From and to, metres.
 */
function wall(k) {
  if (k < 8) {
    const y = k % 2 === 0 ? 3 : -3;
    const x = [0, 0, -4, -4, 4, 4, 0, 0][k];
    return k < 6 ? [x - 2, y, x + 2, y] : [k === 6 ? -6 : 6, -2, k === 6 ? -6 : 6, 2];
  }
  const [row, column] = [Math.floor(k / 50), k % 50];
  return [column * 2, row * 2 + 8, column * 2 + 1.5, row * 2 + 8.3 * (1 + 0.01 * (k % 7))];
}

/**
 * Writes a record into a folder.
 * @param {string} folder
 * @param {{scans: number, walls: number, vertices?: number, boxes: number[][]}} what
 */
export function writeRecord(folder, { scans, walls, vertices = 2, boxes }) {
  const lines = [{ about: { format: "polymapper-replay", version: 1, generator: "made up", log: "made-up" } }];
  /** @type {object[]} */
  const rest = [];
  for (let n = 0; n < scans; n += 1) {
    const t = (n / scans) * 40 * Math.PI;
    const radius = scans > 1000 ? 20 + n / 500 : 1;
    const middle = scans > 1000 ? 50 : 0;
    const pose = [middle + radius * Math.cos(t), middle + radius * Math.sin(t), t].map((v) => Math.round(v * 1e4) / 1e4);
    const ranges = Array.from({ length: 180 }, (_, k) => (k === 0 ? 3000 : (k % 5) - 2));
    rest.push({ detail: { n, bearings_rad: [-1.57, 0.01745], returns: [[0, ...ranges]], polylines: [[1000, -2000, 0, 4000]] } });
    rest.push({ frame: { scan: n, stamp_s: n * 0.1, pose, returns: 180, fit: 1 - ((n * 7) % 50) / 100, known: 0.9, merged: n % 5 === 0 } });
    if (n % 5 === 0) rest.push({ walls: { n, polylines: [[1000, -2000, 0, 4000]] } });
    if (scans > 1000 && n % 1000 === 500) rest.push({ map: change(n, Math.floor((walls * n) / scans), vertices, undefined) });
  }
  rest.push({ map: change(scans, walls, vertices, boxes) }, { end: { partial: null } });
  const text = [...lines, ...rest].map((line) => JSON.stringify(line)).join("\n");
  mkdirSync(folder, { recursive: true });
  writeFileSync(join(folder, "replay.jsonl.gz"), gzipSync(`${text}\n`, { level: 1 }));
}

/**
 * @param {number} scans
 * @param {number} walls
 * @param {number} vertices
 * @param {number[][] | undefined} boxes
 */
function change(scans, walls, vertices, boxes) {
  const put = Array.from({ length: walls }, (_, id) => {
    const [ax, ay, bx, by] = wall(id).map((v) => Math.round(v * 1000));
    const points = [ax, ay];
    for (let v = 1; v < vertices; v += 1) {
      const [from, to] = [(v - 1) / (vertices - 1), v / (vertices - 1)];
      points.push(Math.round(bx * to + ax * (1 - to)) - Math.round(bx * from + ax * (1 - from)));
      points.push(Math.round(by * to + ay * (1 - to)) - Math.round(by * from + ay * (1 - from)));
    }
    return { id, points, observations: Array(vertices).fill(17), sigma_tenth_mm: Array(vertices).fill(12) };
  });
  return { scans, put, drop: [], boxes };
}
