// What lies under the pointer: a vertex of the map, a side, a scan of the way.

/**
 * @typedef {import("./history.js").Wall} Wall
 *
 * @typedef {{kind: "vertex", wall: Wall, vertex: number, x: number, y: number}
 *   | {kind: "side", wall: Wall, side: number, x: number, y: number}
 *   | {kind: "pose", n: number, x: number, y: number}} Picked
 */

/** How near the pointer has to be, pixels. */
const VERTEX_PX = 9;
const SIDE_PX = 6;
const POSE_PX = 7;

/**
 * @param {import("./history.js").History} history
 * @param {import("./camera.js").Camera} camera
 * @param {import("./layers.js").Layers} layers
 * @param {number} px
 * @param {number} py
 * @returns {Picked | undefined}
 */
export function pick(history, camera, layers, px, py) {
  const [x, y] = camera.toMap(px, py);
  const wall = layers.shows("map") ? pickWall(history, x, y, camera.scale) : undefined;
  if (wall?.kind === "vertex") return wall;
  const pose = layers.shows("way") ? pickPose(history, x, y, POSE_PX / camera.scale) : undefined;
  return pose ?? wall;
}

/**
 * @param {import("./history.js").History} history
 * @param {number} x
 * @param {number} y
 * @param {number} scale
 * @returns {Picked | undefined}
 */
export function pickWall(history, x, y, scale) {
  /** @type {Picked | undefined} */
  let vertex;
  /** @type {Picked | undefined} */
  let side;
  let nearVertex = VERTEX_PX / scale;
  let nearSide = SIDE_PX / scale;
  for (const wall of history.map.values()) {
    const p = wall.points;
    for (let k = 0; k + 1 < p.length; k += 2) {
      const distance = Math.hypot(p[k] - x, p[k + 1] - y);
      if (distance < nearVertex) {
        nearVertex = distance;
        vertex = { kind: "vertex", wall, vertex: k / 2, x: p[k], y: p[k + 1] };
      }
      if (k === 0) continue;
      const [cx, cy] = nearestOnSide(p[k - 2], p[k - 1], p[k], p[k + 1], x, y);
      const off = Math.hypot(cx - x, cy - y);
      if (off < nearSide) {
        nearSide = off;
        side = { kind: "side", wall, side: k / 2 - 1, x: cx, y: cy };
      }
    }
  }
  return vertex ?? side;
}

/**
 * @param {number} ax @param {number} ay @param {number} bx @param {number} by @param {number} x @param {number} y
 * @returns {[number, number]}
 */
function nearestOnSide(ax, ay, bx, by, x, y) {
  const [dx, dy] = [bx - ax, by - ay];
  const square = dx * dx + dy * dy;
  const t = square > 0 ? Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / square)) : 0;
  return [ax + t * dx, ay + t * dy];
}

/**
 * @param {import("./history.js").History} history
 * @param {number} x
 * @param {number} y
 * @param {number} near
 * @returns {Picked | undefined}
 */
function pickPose(history, x, y, near) {
  /** @type {Picked | undefined} */
  let found;
  for (let n = 0; n < history.time; n += 1) {
    const pose = history.poses[n];
    if (!pose) continue;
    const distance = Math.hypot(pose[0] - x, pose[1] - y);
    if (distance < near) {
      near = distance;
      found = { kind: "pose", n, x: pose[0], y: pose[1] };
    }
  }
  return found;
}
