// The scan that is shown: returns, polylines, virtual scan, hypotheses, the scanner itself.

import { compose, transform, transformAll } from "./pose.js";
import { strokeWalls, traceAt } from "./draw_map.js";

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
