// Grid, walls of the map, walls merged since, eraser boxes, what was found to move.

import { transform } from "./pose.js";

/**
 * @typedef {import("./camera.js").Camera} Camera
 * @typedef {import("./colours.js").Colours} Colours
 * @typedef {import("./history.js").History} History
 * @typedef {import("./known_walls.js").KnownWalls} KnownWalls
 */

/**
 * Adds a polyline to a path.
 * @param {Path2D | CanvasRenderingContext2D} path
 * @param {Float64Array} points
 */
export function trace(path, points) {
  if (points.length < 4) return;
  path.moveTo(points[0], points[1]);
  for (let k = 2; k + 1 < points.length; k += 2) path.lineTo(points[k], points[k + 1]);
}

/**
 * Adds a polyline of a scan to a path, in the map.
 * @param {Path2D} path
 * @param {Float64Array} points
 * @param {import("./pose.js").Pose} pose
 */
export function traceAt(path, points, pose) {
  for (let k = 0; k + 1 < points.length; k += 2) {
    const [x, y] = transform(pose, points[k], points[k + 1]);
    if (k === 0) path.moveTo(x, y);
    else path.lineTo(x, y);
  }
}

/** Fine and strong steps of the grid, metres. @type {[number, number][]} */
const GRID = [
  [0.1, 1],
  [0.5, 5],
  [1, 5],
  [5, 50],
  [10, 50],
  [50, 500],
  [100, 500],
];

/** Steps of the grid at a scale: fine lines are 14 pixels apart or more. @param {number} scale */
export function gridSteps(scale) {
  return GRID.find(([fine]) => fine * scale >= 14) ?? [500, 5000];
}

/**
 * Fine lines, and every fifth or tenth stronger.
 * @param {CanvasRenderingContext2D} ctx
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawGrid(ctx, camera, colours) {
  const [fine, strong] = gridSteps(camera.scale);
  const view = camera.visible();
  for (const [step, colour] of /** @type {[number, string][]} */ ([
    [fine, colours.grid],
    [strong, colours.gridStrong],
  ])) {
    ctx.beginPath();
    for (let x = Math.ceil(view.left / step) * step; x <= view.right; x += step) {
      const px = Math.round(camera.toScreen(x, 0)[0]) + 0.5;
      ctx.moveTo(px, 0);
      ctx.lineTo(px, camera.height);
    }
    for (let y = Math.ceil(view.bottom / step) * step; y <= view.top; y += step) {
      const py = Math.round(camera.toScreen(0, y)[1]) + 0.5;
      ctx.moveTo(0, py);
      ctx.lineTo(camera.width, py);
    }
    ctx.strokeStyle = colour;
    ctx.lineWidth = 1;
    ctx.stroke();
  }
}

/** Paths of the map, made anew when it changes. */
export class MapPaths {
  constructor() {
    this.version = -1;
    this.walls = new Path2D();
    /** @type {[number, number, number, number] | undefined} */
    this.bounds = undefined;
    this.vertices = 0;
    this.length_m = 0;
  }

  /** @param {History} history */
  update(history) {
    if (this.version === history.mapVersion) return;
    this.version = history.mapVersion;
    this.walls = new Path2D();
    this.vertices = 0;
    this.length_m = 0;
    /** Ends of sides and what they weigh. @type {[number, number, number][]} */
    const sides = [];
    let weight = 0;
    for (const wall of history.map.values()) {
      const p = wall.points;
      trace(this.walls, p);
      this.vertices += p.length / 2;
      for (let k = 0; k + 1 < p.length; k += 2) {
        if (k === 0) continue;
        const side = Math.hypot(p[k] - p[k - 2], p[k + 1] - p[k - 1]);
        this.length_m += side;
        const seen = Math.min(wall.observations[k / 2] ?? 1, wall.observations[k / 2 - 1] ?? 1, MOST_SEEN);
        weight += side * seen;
        sides.push([p[k], p[k + 1], (side * seen) / 2], [p[k - 2], p[k - 1], (side * seen) / 2]);
      }
    }
    this.bounds = mainExtent(sides, weight);
  }
}

/** Share of the walls that may lie outside at each edge: a few strays, seen through a window, make no map small. */
const STRAY_SHARE = 0.01;
/** A wall weighs by how often it was seen, up to this: strays are seen once or twice. */
const MOST_SEEN = 10;

/**
 * The box that holds nearly all of the walls: [left, bottom, right, top].
 * @param {[number, number, number][]} ends Ends of sides, and what each weighs.
 * @param {number} whole Weight of all.
 * @returns {[number, number, number, number] | undefined}
 */
function mainExtent(ends, whole) {
  if (ends.length === 0) return undefined;
  const edge = (/** @type {0 | 1} */ axis, /** @type {1 | -1} */ direction) => {
    const sorted = [...ends].sort((a, b) => direction * (a[axis] - b[axis]));
    let sum = 0;
    const found = sorted.find((end) => {
      sum += end[2];
      return sum > STRAY_SHARE * whole;
    });
    return (found ?? sorted[0])[axis];
  };
  return [edge(0, 1), edge(1, 1), edge(0, -1), edge(1, -1)];
}

/**
 * Walls in metres.
 * @param {CanvasRenderingContext2D} ctx
 * @param {Path2D} path
 * @param {Camera} camera
 * @param {string} colour
 * @param {number} width Pixels.
 */
export function strokeWalls(ctx, path, camera, colour, width) {
  ctx.strokeStyle = colour;
  ctx.lineWidth = width / camera.scale;
  ctx.lineJoin = "round";
  ctx.lineCap = "round";
  ctx.stroke(path);
}

/**
 * The polylines of scans merged since the map was made, but for those that lie on its walls.
 * @param {History} history
 * @param {KnownWalls} known
 * @param {number} from First scan.
 * @param {number} to The scan after the last.
 */
export function freshPath(history, known, from, to) {
  const path = new Path2D();
  for (let k = history.wallsFrom(from); k < history.walls.length && history.walls[k].n < to; k += 1) {
    const { n, standing } = history.walls[k];
    const pose = history.poses[n];
    if (!pose) continue;
    for (const points of standing) if (!known.holds(points, pose)) traceAt(path, points, pose);
  }
  return path;
}

/**
 * What was found to move, up to now.
 * @param {History} history
 */
export function movingPath(history) {
  const path = new Path2D();
  for (const { n, moving } of history.walls) {
    if (n >= history.time) break;
    const pose = history.poses[n];
    if (pose) for (const points of moving) traceAt(path, points, pose);
  }
  return path;
}

/**
 * Boxes, hatched.
 * @param {CanvasRenderingContext2D} ctx
 * @param {History} history
 * @param {Camera} camera
 * @param {Colours} colours
 */
export function drawBoxes(ctx, history, camera, colours) {
  for (const [left, bottom, right, top] of history.boxes) {
    const [x, y] = camera.toScreen(left, top);
    const [w, h] = [(right - left) * camera.scale, (top - bottom) * camera.scale];
    ctx.save();
    ctx.beginPath();
    ctx.rect(x, y, w, h);
    ctx.strokeStyle = colours.box;
    ctx.lineWidth = 1.25;
    ctx.stroke();
    ctx.clip();
    ctx.globalAlpha = 0.45;
    ctx.beginPath();
    const reach = Math.min(w + h, camera.width + camera.height + w);
    for (let d = 0; d < reach; d += 7) {
      ctx.moveTo(x + d, y);
      ctx.lineTo(x + d - h, y + h);
    }
    ctx.lineWidth = 1;
    ctx.stroke();
    ctx.restore();
  }
}
