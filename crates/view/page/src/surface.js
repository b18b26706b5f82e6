// A canvas that has as many pixels as the screen shows.

/** More device pixels than this cost time and show nothing. */
const MOST_RATIO = 2;

export class Surface {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    this.ctx = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    this.ratio = 1;
  }

  /**
   * @param {number} width
   * @param {number} height
   */
  resize(width, height) {
    this.ratio = Math.min(MOST_RATIO, window.devicePixelRatio || 1);
    this.canvas.width = Math.round(width * this.ratio);
    this.canvas.height = Math.round(height * this.ratio);
  }

  clear() {
    this.ctx.setTransform(1, 0, 0, 1, 0, 0);
    this.ctx.clearRect(0, 0, this.canvas.width, this.canvas.height);
  }

  /** Draws in pixels of the page from now on. */
  inPixels() {
    this.ctx.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
  }
}
