// The way of the scanner by quality, closures, ellipses of uncertainty.

import { QUALITY_STEPS, qualityOf } from "./colours.js";

/**
 * @typedef {import("./camera.js").Camera} Camera
 * @typedef {import("./colours.js").Colours} Colours
 * @typedef {import("./history.js").History} History
 */

/** Poses nearer than this to the last one drawn are left out of the line, pixels. */
const STEP_PX = 1.5;

/**
 * The way from scan `from` to scan `to`, a path for each step of quality, and gaps.
 * @param {History} history
 * @param {number} from
 * @param {number} to The scan after the last.
 * @param {number} scale
 */
export function wayPaths(history, from, to, scale) {
  const paths = Array.from({ length: QUALITY_STEPS }, () => new Path2D());
  const gaps = new Path2D();
  const step = STEP_PX / scale;
  let open = -1;
  /** @type {import("./pose.js").Pose | undefined} */
  let drawn;
  let lost = false;
  for (let n = from; n < to; n += 1) {
    const pose = history.poses[n];
    if (!pose) {
      lost = true;
      open = -1;
      continue;
    }
    const quality = qualityOf(history.frames[n].fit);
    const goesOn = open === quality && !lost;
    if (drawn && goesOn && n + 1 < to && Math.abs(pose[0] - drawn[0]) + Math.abs(pose[1] - drawn[1]) < step) continue;
    if (drawn && lost) {
      gaps.moveTo(drawn[0], drawn[1]);
      gaps.lineTo(pose[0], pose[1]);
    } else if (drawn) {
      if (!goesOn) paths[quality].moveTo(drawn[0], drawn[1]);
      paths[quality].lineTo(pose[0], pose[1]);
    } else {
      paths[quality].moveTo(pose[0], pose[1]);
    }
    if (lost) paths[quality].moveTo(pose[0], pose[1]);
    [drawn, open, lost] = [pose, quality, false];
  }
  return { paths, gaps };
}

/**
 * @param {CanvasRenderingContext2D} ctx In metres.
 * @param {{paths: Path2D[], gaps: Path2D}} way
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function strokeWay(ctx, way, camera, colours) {
  ctx.lineJoin = "round";
  ctx.lineCap = "butt";
  ctx.lineWidth = 1.2 / camera.scale;
  ctx.setLineDash([2 / camera.scale, 4 / camera.scale]);
  ctx.strokeStyle = colours.quality[0];
  ctx.stroke(way.gaps);
  ctx.setLineDash([]);
  // The worst on top: it is what has to be seen.
  for (let q = QUALITY_STEPS - 1; q >= 0; q -= 1) {
    const far = camera.scale < 16 ? 0.75 : 1;
    ctx.lineWidth = (far * (q === QUALITY_STEPS - 1 ? 1.5 : 2.4)) / camera.scale;
    ctx.strokeStyle = colours.quality[q];
    ctx.stroke(way.paths[q]);
  }
}

/**
 * Closures as bows between the two scans.
 * @param {CanvasRenderingContext2D} ctx In pixels.
 * @param {History} history
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawClosures(ctx, history, camera, colours) {
  ctx.strokeStyle = colours.closure;
  ctx.fillStyle = colours.closure;
  ctx.lineWidth = 1;
  const dot = camera.scale < 16 ? 1.5 : 2.1;
  for (let n = 0; n < history.time; n += 1) {
    const old = history.frames[n].recognised;
    if (old === undefined) continue;
    const [a, b] = [history.poses[n], history.poses[old]];
    if (!a || !b) continue;
    const [ax, ay] = camera.toScreen(a[0], a[1]);
    const [bx, by] = camera.toScreen(b[0], b[1]);
    const bow = 10 + 0.15 * Math.hypot(bx - ax, by - ay);
    const away = Math.atan2(by - ay, bx - ax) + Math.PI / 2;
    ctx.beginPath();
    ctx.moveTo(ax, ay);
    ctx.globalAlpha = 0.65;
    ctx.quadraticCurveTo((ax + bx) / 2 + bow * Math.cos(away), (ay + by) / 2 + bow * Math.sin(away), bx, by);
    ctx.stroke();
    ctx.globalAlpha = 1;
    for (const [x, y] of [
      [ax, ay],
      [bx, by],
    ]) {
      ctx.beginPath();
      ctx.arc(x, y, dot, 0, 2 * Math.PI);
      ctx.fill();
    }
  }
}

/** How much larger than one standard deviation the ellipses are drawn: they are millimetres. */
export const ELLIPSE_TIMES = 20;

/**
 * Ellipses of the place along the way, and bars where a direction is open.
 * @param {CanvasRenderingContext2D} ctx In pixels.
 * @param {History} history
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawEllipses(ctx, history, camera, colours) {
  const apart = 26 / camera.scale;
  let [x, y] = [Infinity, Infinity];
  ctx.strokeStyle = colours.ellipse;
  ctx.fillStyle = colours.ellipse;
  ctx.lineWidth = 1.25;
  for (let n = 0; n < history.time; n += 1) {
    const [pose, frame] = [history.poses[n], history.frames[n]];
    if (!pose || Math.hypot(pose[0] - x, pose[1] - y) < apart) continue;
    [x, y] = pose;
    drawEllipse(ctx, camera, pose, frame);
  }
}

/**
 * @param {CanvasRenderingContext2D} ctx In pixels, colours set.
 * @param {Camera} camera
 * @param {import("./pose.js").Pose} pose
 * @param {import("./record.js").Frame} frame
 */
export function drawEllipse(ctx, camera, pose, frame) {
  const [px, py] = camera.toScreen(pose[0], pose[1]);
  if (frame.open_rad !== undefined) {
    const [dx, dy] = [14 * Math.cos(frame.open_rad), -14 * Math.sin(frame.open_rad)];
    ctx.beginPath();
    ctx.moveTo(px - dx, py - dy);
    ctx.lineTo(px + dx, py + dy);
    for (const s of [-1, 1]) {
      ctx.moveTo(px + s * dx + 0.3 * dy, py + s * dy - 0.3 * dx);
      ctx.lineTo(px + s * dx - 0.3 * dy, py + s * dy + 0.3 * dx);
    }
    ctx.stroke();
    return;
  }
  if (!frame.ellipse) return;
  const [major, minor, along] = frame.ellipse;
  const radius = (/** @type {number} */ m) => Math.min(60, Math.max(1, ELLIPSE_TIMES * m * camera.scale));
  ctx.beginPath();
  ctx.ellipse(px, py, radius(major), radius(minor), -along, 0, 2 * Math.PI);
  ctx.stroke();
  ctx.globalAlpha = 0.15;
  ctx.fill();
  ctx.globalAlpha = 1;
}
