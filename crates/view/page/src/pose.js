// Poses of the plane: [x, y, theta], metres and radians. `aFromB` takes points of frame b to frame a.

/** @typedef {[number, number, number]} Pose */

/** @type {Pose} */
export const IDENTITY = [0, 0, 0];

/**
 * First b, then a.
 * @param {Pose} a
 * @param {Pose} b
 * @returns {Pose}
 */
export function compose(a, b) {
  const cos = Math.cos(a[2]);
  const sin = Math.sin(a[2]);
  return [a[0] + cos * b[0] - sin * b[1], a[1] + sin * b[0] + cos * b[1], a[2] + b[2]];
}

/**
 * @param {Pose} a
 * @returns {Pose}
 */
export function inverse(a) {
  const cos = Math.cos(a[2]);
  const sin = Math.sin(a[2]);
  return [-cos * a[0] - sin * a[1], sin * a[0] - cos * a[1], -a[2]];
}

/**
 * @param {Pose} a
 * @param {number} x
 * @param {number} y
 * @returns {[number, number]}
 */
export function transform(a, x, y) {
  const cos = Math.cos(a[2]);
  const sin = Math.sin(a[2]);
  return [a[0] + cos * x - sin * y, a[1] + sin * x + cos * y];
}

/**
 * All points of a list [x, y, x, y, ..].
 * @param {Pose} a
 * @param {Float64Array} points
 * @returns {Float64Array}
 */
export function transformAll(a, points) {
  const cos = Math.cos(a[2]);
  const sin = Math.sin(a[2]);
  const out = new Float64Array(points.length);
  for (let k = 0; k + 1 < points.length; k += 2) {
    out[k] = a[0] + cos * points[k] - sin * points[k + 1];
    out[k + 1] = a[1] + sin * points[k] + cos * points[k + 1];
  }
  return out;
}
