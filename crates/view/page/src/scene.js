// Puts the drawing together on two canvases: below what stays (grid, map, way), above what changes with every scan.
//
// The lower one is drawn anew when the camera, the map, poses, layers or colours change; while scans go by, their piece
// of the way is only added to it. So a frame costs what is new.

import { readColours } from "./colours.js";
import { drawArcs, drawPairs } from "./draw_match.js";
import { drawArrow, drawHypotheses, drawScan, drawVirtual } from "./draw_scan.js";
import { drawBoxes, drawGrid, freshPath, MapPaths, movingPath, strokeWalls } from "./draw_map.js";
import { drawClosures, drawEllipse, drawEllipses, strokeWay, wayPaths } from "./draw_way.js";
import { KnownWalls } from "./known_walls.js";
import { compose, inverse, transform } from "./pose.js";
import { Surface } from "./surface.js";

/**
 * @typedef {import("./camera.js").Bounds} Bounds
 * @typedef {import("./history.js").History} History
 */

export class Scene {
  /**
   * @param {HTMLCanvasElement} below
   * @param {HTMLCanvasElement} above
   * @param {History} history
   * @param {import("./details.js").Details} details
   * @param {import("./layers.js").Layers} layers
   * @param {import("./camera.js").Camera} camera
   */
  constructor(below, above, history, details, layers, camera) {
    this.below = new Surface(below);
    this.above = new Surface(above);
    this.history = history;
    this.details = details;
    this.layers = layers;
    this.camera = camera;
    this.colours = readColours();
    this.paths = new MapPaths();
    this.known = new KnownWalls();
    this.shown = "";
    this.shownTime = 0;
    /** Paths by name. @type {Map<string, {key: string, value: any}>} */
    this.made = new Map();
    /** @type {number | undefined} */
    this.hypothesis = undefined;
    /** Drawn last, in pixels. @type {((ctx: CanvasRenderingContext2D) => void) | undefined} */
    this.overlay = undefined;
  }

  /**
   * @param {number} width
   * @param {number} height
   */
  resize(width, height) {
    this.below.resize(width, height);
    this.above.resize(width, height);
    this.camera.resize(width, height);
    this.shown = "";
  }

  recolour() {
    this.colours = readColours();
    this.shown = "";
  }

  draw() {
    const { history, camera, layers } = this;
    this.paths.update(history);
    this.known.update(history);
    const key = [camera.version, history.mapVersion, history.posesVersion, layers.version].join();
    if (key !== this.shown || history.time < this.shownTime) this.drawBelow();
    else if (history.time > this.shownTime) this.addBelow(this.shownTime);
    this.shown = key;
    this.shownTime = history.time;
    this.drawAbove();
  }

  drawBelow() {
    const { ctx } = this.below;
    const { camera, colours, history, layers } = this;
    this.below.clear();
    this.below.inPixels();
    drawGrid(ctx, camera, colours);
    if (layers.shows("boxes")) drawBoxes(ctx, history, camera, colours);
    if (layers.shows("map")) {
      this.addFresh(0);
      const width = Math.min(2.6, Math.max(1.1, 0.9 + camera.scale / 60));
      strokeWalls(ctx, this.paths.walls, camera, colours.wall, width);
    }
    this.addWay(0);
    this.below.inPixels();
    if (layers.shows("ellipses")) drawEllipses(ctx, history, camera, colours);
    if (layers.shows("closures")) drawClosures(ctx, history, camera, colours);
  }

  /** Adds what has come since scan `from`. @param {number} from */
  addBelow(from) {
    if (this.layers.shows("map")) this.addFresh(from);
    this.addWay(from);
  }

  /** Walls that the map does not have yet. @param {number} from */
  addFresh(from) {
    const { camera, colours, history } = this;
    camera.apply(this.below.ctx, this.below.ratio);
    const first = Math.max(from, history.mapScans);
    const make = () => freshPath(history, this.known, first, history.time);
    const key = [first, history.time, history.mapVersion, history.posesVersion].join();
    const fresh = this.cached("fresh", key, make);
    strokeWalls(this.below.ctx, fresh, camera, colours.fresh, 1);
  }

  /** The way, what moved, closures. @param {number} from */
  addWay(from) {
    const { ctx } = this.below;
    const { camera, colours, history, layers } = this;
    camera.apply(ctx, this.below.ratio);
    const key = [from, history.time, history.posesVersion].join();
    if (layers.shows("moving")) {
      const moving = this.cached("moving", key, () => movingPath(history));
      strokeWalls(ctx, moving, camera, colours.moving, 1.4);
    }
    if (layers.shows("way")) {
      const { scale } = camera;
      const make = () => wayPaths(history, Math.max(0, from - 1), history.time, scale);
      const way = this.cached("way", `${key},${scale}`, make);
      strokeWay(ctx, way, camera, colours);
    }
    const closed = history.frames.slice(from, history.time).some((f) => f.recognised !== undefined);
    if (from > 0 && closed && layers.shows("closures")) {
      this.below.inPixels();
      drawClosures(ctx, history, camera, colours);
    }
  }

  drawAbove() {
    const { ctx } = this.above;
    const { camera, colours, history, layers } = this;
    this.above.clear();
    const n = history.time - 1;
    const pose = history.poses[n];
    const detail = n >= 0 ? this.details.get(n, history.length) : undefined;
    camera.apply(ctx, this.above.ratio);
    if (detail && n >= 0) this.drawDetail(ctx, detail, pose);
    if (pose && history.frames[n]) {
      drawArrow(ctx, pose, camera, colours.paper, 12.5);
      drawArrow(ctx, pose, camera, colours.laser, 9);
      this.above.inPixels();
      if (layers.shows("ellipses")) {
        ctx.strokeStyle = colours.ellipse;
        ctx.fillStyle = colours.ellipse;
        ctx.lineWidth = 2;
        drawEllipse(ctx, camera, pose, history.frames[n]);
      }
    }
    this.above.inPixels();
    this.overlay?.(ctx);
  }

  /**
   * @param {CanvasRenderingContext2D} ctx
   * @param {import("./details.js").Detail} detail
   * @param {import("./pose.js").Pose | undefined} placed
   */
  drawDetail(ctx, detail, placed) {
    const { camera, colours, history, layers } = this;
    const before = history.placedBefore(detail.n);
    const last = detail.search ? history.poses[detail.search.last] : history.poses[before];
    if (layers.shows("virtual") && detail.search && last) {
      drawVirtual(ctx, detail.virtualScan, last, camera, colours);
    }
    // A scan without a place is shown where the scanner was last, faint.
    const pose = placed ?? last;
    if (!pose) return;
    ctx.globalAlpha = placed ? 1 : 0.35;
    if (layers.shows("scan")) drawScan(ctx, detail, pose, camera, colours);
    ctx.globalAlpha = 1;
    if (layers.shows("arcs") || (layers.shows("pairs") && !detail.search)) {
      this.drawCompared(ctx, detail, pose);
    }
    if (layers.shows("pairs") && detail.search && last) {
      const { pairs } = detail.search;
      drawPairs(ctx, pairs, detail.polylines, detail.virtualScan, last, camera, colours);
    }
    if (layers.shows("hypotheses") && last) {
      drawHypotheses(ctx, detail, last, this.hypothesis, camera, colours);
    }
  }

  /**
   * @param {CanvasRenderingContext2D} ctx
   * @param {import("./details.js").Detail} detail
   * @param {import("./pose.js").Pose} pose
   */
  drawCompared(ctx, detail, pose) {
    const before = this.history.elsewhereBefore(detail.n);
    const earlier = before >= 0 ? this.history.poses[before] : undefined;
    const found = this.details.compared(detail.n, before, earlier ? compose(inverse(earlier), pose) : [0, 0, 0]);
    if (!found) return;
    const { camera, colours, layers } = this;
    if (layers.shows("arcs")) drawArcs(ctx, found.arcs, detail.polylines, pose, camera, colours);
    if (layers.shows("pairs") && !detail.search && earlier) {
      drawPairs(ctx, found.pairs, detail.polylines, found.reference, earlier, camera, colours);
    }
  }

  /**
   * What was made for the same key the last time; made anew for another. Moving the view makes no new paths.
   * @template T
   * @param {string} name
   * @param {string} key
   * @param {() => T} make
   * @returns {T}
   */
  cached(name, key, make) {
    const held = this.made.get(name);
    if (held?.key === key) return held.value;
    const value = make();
    this.made.set(name, { key, value });
    return value;
  }

  /** The extent of what there is to see; undefined where there is nothing. @returns {Bounds | undefined} */
  bounds() {
    const { history } = this;
    this.paths.update(history);
    const [l, b, r, t] = this.paths.bounds ?? [Infinity, Infinity, -Infinity, -Infinity];
    const bounds = { left: l, bottom: b, right: r, top: t };
    const take = (/** @type {number} */ x, /** @type {number} */ y) => {
      bounds.left = Math.min(bounds.left, x);
      bounds.right = Math.max(bounds.right, x);
      bounds.bottom = Math.min(bounds.bottom, y);
      bounds.top = Math.max(bounds.top, y);
    };
    for (let n = 0; n < history.time; n += 1) {
      const pose = history.poses[n];
      if (pose) take(pose[0], pose[1]);
    }
    for (let k = history.wallsFrom(history.mapScans); k < history.walls.length; k += 1) {
      const { n, standing } = history.walls[k];
      const pose = history.poses[n];
      if (n >= history.time) break;
      if (!pose) continue;
      for (const points of standing) {
        for (let i = 0; i + 1 < points.length; i += 2) take(...transform(pose, points[i], points[i + 1]));
      }
    }
    return bounds.left <= bounds.right ? bounds : undefined;
  }
}
