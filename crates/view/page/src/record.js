// The lines of a record, as docs/replay-format.md describes them, and how their lists of points are read.

/**
 * @typedef {import("./pose.js").Pose} Pose
 *
 * @typedef {object} About
 * @property {string} format
 * @property {number} version
 * @property {string} generator
 * @property {string} log
 * @property {string} [missing] What cannot be shown, in a sentence.
 *
 * @typedef {object} Frame
 * @property {number} scan
 * @property {number} [stamp_s]
 * @property {Pose} [pose]
 * @property {string} [reason]
 * @property {number} returns
 * @property {number} [fit]
 * @property {number} [known]
 * @property {number} [through]
 * @property {number} [matched]
 * @property {number} [rms_mm]
 * @property {[number, number, number]} [ellipse]
 * @property {number} [open_rad]
 * @property {number} [lead]
 * @property {boolean} [merged]
 * @property {boolean} [searched]
 * @property {number} [recognised]
 *
 * @typedef {object} WallsLine
 * @property {number} n
 * @property {number[][]} polylines
 * @property {number[]} [moving]
 *
 * @typedef {object} Run
 * @property {number} first
 * @property {number} last
 * @property {Pose} by
 *
 * @typedef {object} Moved
 * @property {Run[]} [runs]
 * @property {[number, Pose][]} [found]
 * @property {number[]} [lost]
 *
 * @typedef {object} PolylineRecord
 * @property {number} id
 * @property {number[]} points
 * @property {number[]} observations
 * @property {number[]} sigma_tenth_mm
 *
 * @typedef {object} MapChange
 * @property {number} scans
 * @property {PolylineRecord[]} put
 * @property {number[]} drop
 * @property {[number, number, number, number][]} [boxes]
 *
 * @typedef {object} Skipped
 * @property {number} scan
 * @property {number} line
 * @property {string} why
 *
 * @typedef {object} Hypothesis
 * @property {Pose} pose
 * @property {number} score
 * @property {number} fit
 * @property {number} through
 *
 * @typedef {object} Pair
 * @property {number[]} scan
 * @property {number[]} reference
 * @property {number} cost_rad2
 *
 * @typedef {object} Search
 * @property {number} last
 * @property {number[][]} virtual_scan
 * @property {Hypothesis[]} hypotheses
 * @property {Pair[]} pairs
 *
 * @typedef {object} DetailLine
 * @property {number} n
 * @property {[number, number]} bearings_rad
 * @property {number[][]} returns
 * @property {number[][]} polylines
 * @property {number[]} [moving]
 * @property {Search} [search]
 *
 * @typedef {object} Comparison
 * @property {number} n
 * @property {[number, number, number][][]} arcs
 * @property {number[][]} reference
 * @property {Pair[]} pairs
 *
 * @typedef {object} Line
 * @property {About} [about]
 * @property {Frame} [frame]
 * @property {WallsLine} [walls]
 * @property {Moved} [moved]
 * @property {MapChange} [map]
 * @property {Skipped} [skipped]
 * @property {DetailLine} [detail]
 * @property {{partial: string | null}} [end]
 */

/**
 * Points in metres, [x, y, x, y, ..], of a chain of millimetres and differences.
 * @param {number[]} chain
 * @returns {Float64Array}
 */
export function pointsOf(chain) {
  const out = new Float64Array(chain.length - (chain.length % 2));
  let x = 0;
  let y = 0;
  for (let k = 0; k + 1 < chain.length; k += 2) {
    x += chain[k];
    y += chain[k + 1];
    out[k] = x / 1000;
    out[k + 1] = y / 1000;
  }
  return out;
}

/**
 * The returns of a scan as points of the laser frame, metres.
 * @param {DetailLine} detail
 * @returns {Float64Array}
 */
export function returnsOf(detail) {
  const [first, step] = detail.bearings_rad;
  const points = new Float64Array(2 * detail.returns.reduce((sum, run) => sum + run.length - 1, 0));
  let at = 0;
  for (const run of detail.returns) {
    let range = 0;
    for (let k = 1; k < run.length; k += 1) {
      range += run[k];
      const bearing = first + step * (run[0] + k - 1);
      points[at] = (range / 1000) * Math.cos(bearing);
      points[at + 1] = (range / 1000) * Math.sin(bearing);
      at += 2;
    }
  }
  return points;
}
