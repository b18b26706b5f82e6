// Shape matching: pairs of polylines, and the arcs that their shapes consist of.

import { transform, transformAll } from "./pose.js";
import { strokeWalls, trace, traceAt } from "./draw_map.js";

/**
 * @typedef {import("./camera.js").Camera} Camera
 * @typedef {import("./colours.js").Colours} Colours
 * @typedef {import("./pose.js").Pose} Pose
 */

/**
 * Matched pairs as dashed lines between the middles of the polylines, both scans as the scanner saw them, before one is
 * moved onto the other (the paper's Fig. 3): the scan is drawn as if the scanner had not moved since the reference.
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {import("./record.js").Pair[]} pairs
 * @param {Float64Array[]} scan Laser frame.
 * @param {Float64Array[]} reference Frame of the scan before.
 * @param {Pose} before The scan before in the map.
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawPairs(ctx, pairs, scan, reference, before, camera, colours) {
  for (const [polylines, colour] of /** @type {const} */ ([
    [reference, colours.virtual],
    [scan, colours.scan],
  ])) {
    const path = new Path2D();
    for (const points of polylines) traceAt(path, points, before);
    strokeWalls(ctx, path, camera, colour, 1.6);
  }
  const px = 1 / camera.scale;
  ctx.strokeStyle = colours.pair;
  ctx.lineWidth = 1.6 * px;
  ctx.setLineDash([6 * px, 4 * px]);
  /** @type {[number, number][]} */
  const ends = [];
  ctx.beginPath();
  for (const pair of pairs) {
    for (const s of pair.scan) {
      for (const r of pair.reference) {
        if (!scan[s] || !reference[r]) continue;
        const a = transform(before, ...middle(scan[s]));
        const b = transform(before, ...middle(reference[r]));
        ctx.moveTo(a[0], a[1]);
        ctx.lineTo(b[0], b[1]);
        ends.push(a, b);
      }
    }
  }
  ctx.stroke();
  ctx.setLineDash([]);
  ctx.fillStyle = colours.paper;
  for (const [x, y] of ends) {
    ctx.beginPath();
    ctx.arc(x, y, 3 * px, 0, 2 * Math.PI);
    ctx.fill();
    ctx.stroke();
  }
}

/**
 * The point at half the length.
 * @param {Float64Array} p
 * @returns {[number, number]}
 */
function middle(p) {
  return along(p, lengthOf(p) / 2);
}

/** @param {Float64Array} p */
function lengthOf(p) {
  let sum = 0;
  for (let k = 2; k + 1 < p.length; k += 2) sum += Math.hypot(p[k] - p[k - 2], p[k + 1] - p[k - 1]);
  return sum;
}

/**
 * The point at a length from the start.
 * @param {Float64Array} p
 * @param {number} left
 * @returns {[number, number]}
 */
function along(p, left) {
  for (let k = 2; k + 1 < p.length; k += 2) {
    const side = Math.hypot(p[k] - p[k - 2], p[k + 1] - p[k - 1]);
    if (left <= side && side > 0) {
      const t = left / side;
      return [p[k - 2] + t * (p[k] - p[k - 2]), p[k - 1] + t * (p[k + 1] - p[k - 1])];
    }
    left -= side;
  }
  return [p[p.length - 2], p[p.length - 1]];
}

/**
 * The stretch of a polyline between two lengths.
 * @param {Float64Array} p
 * @param {number} from
 * @param {number} to
 */
function stretch(p, from, to) {
  const out = [...along(p, from)];
  let at = 0;
  for (let k = 2; k + 1 < p.length; k += 2) {
    at += Math.hypot(p[k] - p[k - 2], p[k + 1] - p[k - 1]);
    if (at > from && at < to) out.push(p[k], p[k + 1]);
  }
  return Float64Array.from([...out, ...along(p, to)]);
}

/**
 * Maximal convex arcs: those that bend to the left and to the right in a colour each, straight ones grey.
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {[number, number, number][][]} arcs
 * @param {Float64Array[]} polylines
 * @param {Pose} pose
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawArcs(ctx, arcs, polylines, pose, camera, colours) {
  const colourOf = new Map([
    [-1, colours.right],
    [0, colours.pair],
    [1, colours.left],
  ]);
  const px = 1 / camera.scale;
  polylines.forEach((points, k) => {
    for (const [bend, from, to] of arcs[k] ?? []) {
      const path = new Path2D();
      const piece = transformAll(pose, stretch(points, from / 1000, to / 1000));
      trace(path, piece);
      strokeWalls(ctx, path, camera, colourOf.get(bend) ?? colours.pair, 3.4);
      ctx.fillStyle = colourOf.get(bend) ?? colours.pair;
      for (const at of [0, piece.length - 2]) {
        ctx.beginPath();
        ctx.arc(piece[at], piece[at + 1], 2.8 * px, 0, 2 * Math.PI);
        ctx.fill();
      }
    }
  });
}
