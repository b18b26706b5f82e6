// Which polylines lie on walls that the map has already, by cells around its sides.

import { transformAll } from "./pose.js";

/** Side of a cell, metres: what lies within one or two of it is known. */
const CELL = 0.15;
/** Cells a row, more than any building has. */
const ROW = 1 << 20;
/** Share of the points of a polyline that have to be known. */
const MOST_KNOWN = 0.8;

/** @param {number} x @param {number} y */
function cellOf(x, y) {
  return Math.floor(x / CELL) + ROW / 2 + (Math.floor(y / CELL) + ROW / 2) * ROW;
}

/**
 * Points along a polyline, a cell apart or less.
 * @param {Float64Array} p
 * @param {(x: number, y: number) => void} each
 */
function sample(p, each) {
  for (let k = 2; k + 1 < p.length; k += 2) {
    const steps = Math.max(1, Math.ceil(Math.hypot(p[k] - p[k - 2], p[k + 1] - p[k - 1]) / CELL));
    for (let i = 0; i <= steps; i += 1) {
      const t = i / steps;
      each(p[k - 2] + t * (p[k] - p[k - 2]), p[k - 1] + t * (p[k + 1] - p[k - 1]));
    }
  }
}

export class KnownWalls {
  constructor() {
    this.version = -1;
    /** @type {Set<number>} */
    this.cells = new Set();
  }

  /** @param {import("./history.js").History} history */
  update(history) {
    if (this.version === history.mapVersion) return;
    this.version = history.mapVersion;
    this.cells = new Set();
    for (const wall of history.map.values()) {
      sample(wall.points, (x, y) => {
        const cell = cellOf(x, y);
        for (const row of [-ROW, 0, ROW]) {
          for (const column of [-1, 0, 1]) this.cells.add(cell + row + column);
        }
      });
    }
  }

  /**
   * @param {Float64Array} points
   * @param {import("./pose.js").Pose} pose
   */
  holds(points, pose) {
    if (this.cells.size === 0) return false;
    let [all, known] = [0, 0];
    sample(transformAll(pose, points), (x, y) => {
      all += 1;
      if (this.cells.has(cellOf(x, y))) known += 1;
    });
    return known >= MOST_KNOWN * all;
  }
}
