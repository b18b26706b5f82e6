// Pointer, wheel and pinch on the map: pan, zoom, tap.

/**
 * @typedef {object} Wishes
 * @property {() => void} moved The camera has moved.
 * @property {(px: number, py: number) => void} hover
 * @property {() => void} leave
 * @property {(px: number, py: number) => void} tap
 */

/** A pointer that moves less between down and up taps. */
const TAP_PX = 5;

export class Gestures {
  /**
   * @param {HTMLElement} area
   * @param {import("./camera.js").Camera} camera
   * @param {Wishes} wishes
   */
  constructor(area, camera, wishes) {
    this.area = area;
    this.camera = camera;
    this.wishes = wishes;
    /** Pointers that are down. @type {Map<number, [number, number]>} */
    this.down = new Map();
    this.way = 0;
    area.addEventListener("pointerdown", (e) => this.press(e));
    area.addEventListener("pointermove", (e) => this.move(e));
    area.addEventListener("pointerup", (e) => this.release(e));
    area.addEventListener("pointercancel", (e) => this.down.delete(e.pointerId));
    area.addEventListener("pointerleave", () => wishes.leave());
    area.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
  }

  /** @param {MouseEvent} e @returns {[number, number]} */
  place(e) {
    const box = this.area.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  }

  /** @param {PointerEvent} e */
  press(e) {
    if (e.button !== 0 || e.target instanceof HTMLButtonElement) return;
    this.area.setPointerCapture(e.pointerId);
    this.down.set(e.pointerId, this.place(e));
    this.way = 0;
  }

  /** @param {PointerEvent} e */
  move(e) {
    const at = this.place(e);
    const was = this.down.get(e.pointerId);
    if (!was) {
      this.wishes.hover(...at);
      return;
    }
    const other = [...this.down].find(([id]) => id !== e.pointerId)?.[1];
    this.down.set(e.pointerId, at);
    this.way += Math.hypot(at[0] - was[0], at[1] - was[1]);
    if (this.way < TAP_PX) return;
    if (other) {
      const grown = Math.hypot(at[0] - other[0], at[1] - other[1]) / Math.max(1, Math.hypot(was[0] - other[0], was[1] - other[1]));
      this.camera.zoom(grown, (at[0] + other[0]) / 2, (at[1] + other[1]) / 2);
      this.camera.pan((at[0] - was[0]) / 2, (at[1] - was[1]) / 2);
    } else {
      this.camera.pan(at[0] - was[0], at[1] - was[1]);
    }
    this.wishes.moved();
  }

  /** @param {PointerEvent} e */
  release(e) {
    const was = this.down.get(e.pointerId);
    this.down.delete(e.pointerId);
    if (was && this.way < TAP_PX) this.wishes.tap(...this.place(e));
  }

  /** @param {WheelEvent} e */
  wheel(e) {
    e.preventDefault();
    const lines = e.deltaMode === WheelEvent.DOM_DELTA_LINE ? 16 : 1;
    this.camera.zoom(Math.exp(-0.0016 * lines * e.deltaY), ...this.place(e));
    this.wishes.moved();
  }
}
