// Which part of the map is in view: it follows the map as it grows, until somebody moves it.

/** While the map grows, the view is widened when something lies outside; looked at this often. */
const REFIT_MS = 250;
/** Poses before a stretch of scans that are shown with it. */
const RUN_UP = 20;
/** What is shown around a stretch of the way, metres. */
const AROUND_M = 3;

export class Framing {
  /**
   * @param {import("./camera.js").Camera} camera
   * @param {import("./scene.js").Scene} scene
   * @param {import("./player.js").Player} player
   */
  constructor(camera, scene, player) {
    this.camera = camera;
    this.scene = scene;
    this.player = player;
    /** Whether the view follows the growing map. */
    this.following = true;
    this.looked = 0;
  }

  /** The view is somebody's choice from now on. */
  release() {
    this.following = false;
  }

  /** The whole map, from now on. */
  fit() {
    this.following = true;
    const bounds = this.scene.bounds();
    if (bounds) this.camera.look(this.camera.fitting(bounds));
  }

  /** Widens the view when the map has outgrown it. @param {number} now Milliseconds. */
  tick(now) {
    if (!this.following || now - this.looked <= REFIT_MS) return;
    this.looked = now;
    const { camera, player } = this;
    const bounds = this.scene.bounds();
    if (!bounds) return;
    const view = camera.visible();
    const inside =
      bounds.left >= view.left && bounds.right <= view.right && bounds.bottom >= view.bottom && bounds.top <= view.top;
    const to = camera.fitting(bounds);
    const settled = !player.playing && (!player.following || player.history.end);
    if (inside && !settled && to.scale <= 2.2 * camera.scale) return;
    // While it grows, some room is left, so that the view is not moved with every scan.
    const aim = { ...to, scale: to.scale * (settled ? 1 : 0.8) };
    const same = Math.abs(aim.scale / camera.scale - 1) < 0.01 && Math.hypot(aim.x - camera.x, aim.y - camera.y) * aim.scale < 2;
    if (!same) camera.look(aim);
  }

  /**
   * A stretch of the way.
   * @param {number} first
   * @param {number} last
   */
  stretch(first, last) {
    const poses = this.scene.history.poses.slice(Math.max(0, first - RUN_UP), last + 1).flatMap((p) => (p ? [p] : []));
    if (poses.length === 0) return;
    this.release();
    const [xs, ys] = [poses.map((p) => p[0]), poses.map((p) => p[1])];
    const bounds = {
      left: Math.min(...xs) - AROUND_M,
      right: Math.max(...xs) + AROUND_M,
      bottom: Math.min(...ys) - AROUND_M,
      top: Math.max(...ys) + AROUND_M,
    };
    this.camera.look(this.camera.fitting(bounds));
  }
}
