// What the record says so far, and the state of map and poses at any moment of it.
//
// Time is the number of scans shown, 0..length. Going to a moment applies the changes of poses and map since, or takes
// them back, so that a step costs little and a leap costs what happened between.

import { compose, inverse } from "./pose.js";
import { pointsOf } from "./record.js";

/**
 * @typedef {import("./pose.js").Pose} Pose
 * @typedef {import("./record.js").Frame} Frame
 * @typedef {import("./record.js").Line} Line
 * @typedef {import("./record.js").Moved} Moved
 *
 * @typedef {object} Wall A polyline of the map.
 * @property {number} id
 * @property {Float64Array} points
 * @property {number[]} observations
 * @property {number[]} sigma_tenth_mm
 *
 * @typedef {[number, number, number, number]} Box
 *
 * @typedef {object} MapStep
 * @property {number} scans
 * @property {Map<number, Wall | undefined>} after What to put or drop, by id.
 * @property {Map<number, Wall | undefined>} before What was there.
 * @property {Box[] | undefined} boxesAfter
 * @property {Box[]} boxesBefore
 * @property {number} scansBefore
 *
 * @typedef {object} ScanWalls The polylines of a merged scan, laser frame.
 * @property {number} n
 * @property {Float64Array[]} standing
 * @property {Float64Array[]} moving
 *
 * @typedef {{at: number, moved?: Moved, map?: MapStep}} Change
 */

export class History {
  constructor() {
    /** @type {import("./record.js").About | undefined} */
    this.about = undefined;
    /** @type {Frame[]} */
    this.frames = [];
    /** Pose of every scan now; undefined where it has none. @type {(Pose | undefined)[]} */
    this.poses = [];
    /** @type {Change[]} */
    this.changes = [];
    /** Merged scans, ascending. @type {ScanWalls[]} */
    this.walls = [];
    /** @type {import("./record.js").Skipped[]} */
    this.skipped = [];
    /** @type {{partial: string | null} | undefined} */
    this.end = undefined;

    /** The moment shown. */
    this.time = 0;
    /** Changes that are applied. */
    this.applied = 0;
    /** The map at that moment. @type {Map<number, Wall>} */
    this.map = new Map();
    /** @type {Box[]} */
    this.boxes = [];
    /** How many scans the map rests on. */
    this.mapScans = 0;
    /** Grow with every change of the map and of the poses. */
    this.mapVersion = 0;
    this.posesVersion = 0;

    /** The map as the last line left it, which the next line changes. @type {Map<number, Wall>} */
    this.newestMap = new Map();
    /** @type {Box[]} */
    this.newestBoxes = [];
    this.newestMapScans = 0;
  }

  get length() {
    return this.frames.length;
  }

  /** The scan shown, or undefined before the first. */
  get frame() {
    return this.time > 0 ? this.frames[this.time - 1] : undefined;
  }

  /** @param {Line} line */
  take(line) {
    if (line.frame) this.takeFrame(line.frame);
    else if (line.walls) this.takeWalls(line.walls);
    else if (line.moved) this.changes.push({ at: this.length, moved: line.moved });
    else if (line.map) this.changes.push({ at: this.length, map: this.mapStep(line.map) });
    else if (line.skipped) this.skipped.push(line.skipped);
    else if (line.about) this.about = line.about;
    else if (line.end) this.end = line.end;
  }

  /** @param {Frame} frame */
  takeFrame(frame) {
    this.frames.push(frame);
    this.poses.push(frame.pose);
  }

  /** @param {import("./record.js").WallsLine} line */
  takeWalls(line) {
    const moving = new Set(line.moving ?? []);
    const points = line.polylines.map(pointsOf);
    this.walls.push({
      n: line.n,
      standing: points.filter((_, k) => !moving.has(k)),
      moving: points.filter((_, k) => moving.has(k)),
    });
  }

  /**
   * @param {import("./record.js").MapChange} change
   * @returns {MapStep}
   */
  mapStep(change) {
    /** @type {Map<number, Wall | undefined>} */
    const after = new Map();
    for (const id of change.drop) after.set(id, undefined);
    for (const p of change.put) after.set(p.id, { ...p, points: pointsOf(p.points) });
    /** @type {Map<number, Wall | undefined>} */
    const before = new Map();
    for (const [id, wall] of after) {
      before.set(id, this.newestMap.get(id));
      putOrDrop(this.newestMap, id, wall);
    }
    const boxes = change.boxes?.map((b) => /** @type {Box} */ (b.map((v) => v / 1000)));
    const step = {
      scans: change.scans,
      after,
      before,
      boxesAfter: boxes,
      boxesBefore: this.newestBoxes,
      scansBefore: this.newestMapScans,
    };
    this.newestBoxes = boxes ?? this.newestBoxes;
    this.newestMapScans = change.scans;
    return step;
  }

  /**
   * Shows the moment after `time` scans.
   * @param {number} time
   */
  goTo(time) {
    this.time = Math.max(0, Math.min(this.length, Math.round(time)));
    while (this.applied < this.changes.length && this.changes[this.applied].at <= this.time) {
      this.apply(this.changes[this.applied]);
      this.applied += 1;
    }
    while (this.applied > 0 && this.changes[this.applied - 1].at > this.time) {
      this.applied -= 1;
      this.takeBack(this.changes[this.applied]);
    }
  }

  /** @param {Change} change */
  apply({ moved, map }) {
    if (moved) {
      this.movePoses(moved, (by) => by);
      for (const [n, pose] of moved.found ?? []) this.poses[n] = pose;
      // The pose stays in the frame for the way back.
      for (const n of moved.lost ?? []) this.lose(n);
    }
    if (map) {
      for (const [id, wall] of map.after) putOrDrop(this.map, id, wall);
      this.boxes = map.boxesAfter ?? this.boxes;
      this.mapScans = map.scans;
      this.mapVersion += 1;
    }
  }

  /** @param {Change} change */
  takeBack({ moved, map }) {
    if (moved) {
      for (const [n] of moved.found ?? []) this.poses[n] = undefined;
      for (const n of moved.lost ?? []) this.poses[n] = this.lost.get(n);
      this.movePoses(moved, inverse);
    }
    if (map) {
      for (const [id, wall] of map.before) putOrDrop(this.map, id, wall);
      this.boxes = map.boxesBefore;
      this.mapScans = map.scansBefore;
      this.mapVersion += 1;
    }
  }

  /** Poses of scans that have lost theirs. @type {Map<number, Pose | undefined>} */
  lost = new Map();

  /** @param {number} n */
  lose(n) {
    this.lost.set(n, this.poses[n]);
    this.poses[n] = undefined;
  }

  /**
   * @param {Moved} moved
   * @param {(by: Pose) => Pose} which
   */
  movePoses(moved, which) {
    for (const run of moved.runs ?? []) {
      const by = which(run.by);
      for (let n = run.first; n <= run.last; n += 1) {
        const pose = this.poses[n];
        if (pose) this.poses[n] = compose(by, pose);
      }
    }
    this.posesVersion += 1;
  }

  /** Index of the first merged scan from scan `n` on. @param {number} n */
  wallsFrom(n) {
    let low = 0;
    let high = this.walls.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.walls[middle].n < n) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /**
   * Number of the last scan before `n` that was taken from elsewhere, a metre or 30° away; failing that, of the placed
   * scan before; or −1.
   * @param {number} n
   */
  elsewhereBefore(n) {
    const pose = this.poses[n];
    if (pose) {
      for (let k = n - 1; k >= Math.max(0, n - 2000); k -= 1) {
        const other = this.poses[k];
        if (!other) continue;
        const turn = Math.abs(Math.atan2(Math.sin(pose[2] - other[2]), Math.cos(pose[2] - other[2])));
        if (Math.hypot(pose[0] - other[0], pose[1] - other[1]) > 1 || turn > 0.52) return k;
      }
    }
    return this.placedBefore(n);
  }

  /** Number of the last placed scan before `n`, or −1. @param {number} n */
  placedBefore(n) {
    let k = n - 1;
    while (k >= 0 && !this.poses[k]) k -= 1;
    return k;
  }
}

/**
 * @param {Map<number, Wall>} map
 * @param {number} id
 * @param {Wall | undefined} wall
 */
function putOrDrop(map, id, wall) {
  if (wall) map.set(id, wall);
  else map.delete(id);
}
