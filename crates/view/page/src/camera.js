// Where on the map the window looks: the centre in metres and pixels a metre; y goes up on the map, down on the screen.

/**
 * @typedef {object} Bounds
 * @property {number} left
 * @property {number} bottom
 * @property {number} right
 * @property {number} top
 */

const MIN_SCALE = 0.5;
const MAX_SCALE = 4000;

export class Camera {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 40;
    this.width = 1;
    this.height = 1;
    /** Grows with every change. */
    this.version = 0;
  }

  /**
   * @param {number} width
   * @param {number} height
   */
  resize(width, height) {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    this.version += 1;
  }

  /** @param {number} x @param {number} y @returns {[number, number]} */
  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  /** @param {number} px @param {number} py @returns {[number, number]} */
  toMap(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
  }

  /** @param {number} dx @param {number} dy Pixels. */
  pan(dx, dy) {
    this.x -= dx / this.scale;
    this.y += dy / this.scale;
    this.version += 1;
  }

  /**
   * Zooms so that the point under the pixel stays there.
   * @param {number} factor
   * @param {number} px
   * @param {number} py
   */
  zoom(factor, px, py) {
    const [x, y] = this.toMap(px, py);
    this.scale = Math.min(MAX_SCALE, Math.max(MIN_SCALE, this.scale * factor));
    const [nx, ny] = this.toMap(px, py);
    this.x += x - nx;
    this.y += y - ny;
    this.version += 1;
  }

  /**
   * What shows the bounds with a margin.
   * @param {Bounds} b
   * @returns {{x: number, y: number, scale: number}}
   */
  fitting(b) {
    const margin = Math.max(24, Math.min(72, 0.07 * Math.min(this.width, this.height)));
    const fit = Math.min(
      (this.width - 2 * margin) / Math.max(b.right - b.left, 2),
      (this.height - 2 * margin) / Math.max(b.top - b.bottom, 2),
    );
    return {
      x: (b.left + b.right) / 2,
      y: (b.bottom + b.top) / 2,
      scale: Math.min(MAX_SCALE, Math.max(MIN_SCALE, fit)),
    };
  }

  /** @param {{x: number, y: number, scale: number}} to */
  look(to) {
    this.x = to.x;
    this.y = to.y;
    this.scale = to.scale;
    this.version += 1;
  }

  /** @returns {Bounds} */
  visible() {
    const [left, top] = this.toMap(0, 0);
    const [right, bottom] = this.toMap(this.width, this.height);
    return { left, bottom, right, top };
  }

  /** Makes the context draw in metres. @param {CanvasRenderingContext2D} ctx @param {number} ratio */
  apply(ctx, ratio) {
    const s = this.scale * ratio;
    ctx.setTransform(s, 0, 0, -s, (this.width * ratio) / 2 - this.x * s, (this.height * ratio) / 2 + this.y * s);
  }
}
