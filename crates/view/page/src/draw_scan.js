// The scan that is shown: returns, polylines, arcs, matched pairs, virtual scan, hypotheses, the scanner itself.

import { compose, transform, transformAll } from "./pose.js";
import { strokeWalls, trace, traceAt } from "./draw_map.js";

/**
 * @typedef {import("./camera.js").Camera} Camera
 * @typedef {import("./colours.js").Colours} Colours
 * @typedef {import("./details.js").Detail} Detail
 * @typedef {import("./pose.js").Pose} Pose
 */

/**
 * Returns as dots, polylines as lines.
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {Detail} detail
 * @param {Pose} pose
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawScan(ctx, detail, pose, camera, colours) {
  drawRays(ctx, detail, pose, colours);
  const path = new Path2D();
  const moving = new Path2D();
  detail.polylines.forEach((points, k) => traceAt(detail.moving.has(k) ? moving : path, points, pose));
  strokeWalls(ctx, path, camera, colours.scan, 2.2);
  strokeWalls(ctx, moving, camera, colours.moving, 2.2);
  const half = Math.min(1.5, Math.max(0.6, camera.scale / 40)) / camera.scale;
  const points = transformAll(pose, detail.returns);
  ctx.fillStyle = colours.returns;
  ctx.beginPath();
  for (let k = 0; k + 1 < points.length; k += 2) ctx.rect(points[k] - half, points[k + 1] - half, 2 * half, 2 * half);
  ctx.fill();
}

/**
 * What the scanner sees, as a faint area.
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {Detail} detail
 * @param {Pose} pose
 * @param {Colours} colours
 */
function drawRays(ctx, detail, pose, colours) {
  if (detail.returns.length < 4) return;
  const points = transformAll(pose, detail.returns);
  ctx.beginPath();
  ctx.moveTo(pose[0], pose[1]);
  for (let k = 0; k + 1 < points.length; k += 2) ctx.lineTo(points[k], points[k + 1]);
  ctx.closePath();
  ctx.globalAlpha = 0.07;
  ctx.fillStyle = colours.scan;
  ctx.fill();
  ctx.globalAlpha = 1;
}

/**
 * The polylines of a virtual scan.
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {Float64Array[]} polylines
 * @param {Pose} pose
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawVirtual(ctx, polylines, pose, camera, colours) {
  const path = new Path2D();
  for (const points of polylines) traceAt(path, points, pose);
  strokeWalls(ctx, path, camera, colours.virtual, 4.5);
}

/**
 * Poses that were thought of: an outline of the scan and an arrow each, the best strongest.
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {Detail} detail
 * @param {Pose} last The map from the scan placed before.
 * @param {number | undefined} chosen One to point out.
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawHypotheses(ctx, detail, last, chosen, camera, colours) {
  const all = detail.search?.hypotheses ?? [];
  for (let k = all.length - 1; k >= 0; k -= 1) {
    const pose = compose(last, all[k].pose);
    const outlined = chosen === undefined ? k < 3 : k === chosen;
    ctx.globalAlpha = outlined ? (chosen === undefined ? 0.75 / (k + 1) : 1) : 0.35;
    if (outlined) {
      const path = new Path2D();
      for (const points of detail.polylines) traceAt(path, points, pose);
      strokeWalls(ctx, path, camera, colours.hypothesis, 1.5);
    }
    drawArrow(ctx, pose, camera, colours.hypothesis, 9);
  }
  ctx.globalAlpha = 1;
}

/**
 * A scanner: where it is and where it looks.
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {Pose} pose
 * @param {Camera} camera
 * @param {string} colour
 * @param {number} size Pixels.
 */
export function drawArrow(ctx, pose, camera, colour, size) {
  const s = size / camera.scale;
  ctx.beginPath();
  for (const [x, y] of [
    [1.25 * s, 0],
    [-0.85 * s, 0.8 * s],
    [-0.4 * s, 0],
    [-0.85 * s, -0.8 * s],
  ]) {
    const [mx, my] = transform(pose, x, y);
    ctx.lineTo(mx, my);
  }
  ctx.closePath();
  ctx.fillStyle = colour;
  ctx.fill();
}

/**
 * Pairs as dashed lines between the middles of the polylines (the paper's Fig. 3).
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {import("./record.js").Pair[]} pairs
 * @param {Float64Array[]} scan
 * @param {Pose} pose
 * @param {Float64Array[]} reference
 * @param {Pose} referencePose
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawPairs(ctx, pairs, scan, pose, reference, referencePose, camera, colours) {
  const path = new Path2D();
  for (const points of reference) traceAt(path, points, referencePose);
  strokeWalls(ctx, path, camera, colours.virtual, 1.6);
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
        const a = transform(pose, ...middle(scan[s]));
        const b = transform(referencePose, ...middle(reference[r]));
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
export function middle(p) {
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
