// The strip below: how well every scan agreed, what happened where, and where we are.

import { qualityOf } from "./colours.js";
import { Surface } from "./surface.js";

/** Height of a scan of which nothing is known. */
const UNKNOWN_PX = 12;

export class Timeline {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {HTMLInputElement} slider
   * @param {import("./history.js").History} history
   * @param {(time: number) => void} goTo
   */
  constructor(canvas, slider, history, goTo) {
    this.surface = new Surface(canvas);
    this.slider = slider;
    this.history = history;
    this.width = 0;
    this.height = 0;
    this.shown = "";
    slider.addEventListener("input", () => goTo(Number(slider.value)));
  }

  resize() {
    const box = this.surface.canvas.getBoundingClientRect();
    [this.width, this.height] = [box.width, box.height];
    this.surface.resize(box.width, box.height);
    this.shown = "";
  }

  /** @param {import("./colours.js").Colours} colours */
  draw(colours) {
    const { history, slider } = this;
    if (slider.max !== String(history.length)) slider.max = String(history.length);
    if (slider.value !== String(history.time)) slider.value = String(history.time);
    slider.setAttribute("aria-valuetext", `scan ${history.time} of ${history.length}`);
    const key = [history.length, history.time, colours.paper, this.width].join();
    if (key === this.shown) return;
    this.shown = key;
    this.surface.clear();
    this.surface.inPixels();
    this.drawStrip(colours);
    this.drawHead(colours);
  }

  /** @param {import("./colours.js").Colours} colours */
  drawStrip(colours) {
    const { ctx } = this.surface;
    const { about, frames, length, time } = this.history;
    const base = this.height - 7;
    for (let px = 0; px < this.width; px += 2) {
      const from = Math.floor((px / this.width) * length);
      const to = Math.max(from + 1, Math.ceil(((px + 2) / this.width) * length));
      let worst = 1;
      let lost = false;
      let searched = false;
      let closed = false;
      for (let n = from; n < to && n < length; n += 1) {
        const f = frames[n];
        worst = Math.min(worst, f.fit ?? 1);
        lost ||= !f.pose;
        searched ||= f.searched === true;
        closed ||= f.recognised !== undefined;
      }
      if (from >= length) break;
      ctx.globalAlpha = from < time ? 1 : 0.32;
      ctx.fillStyle = lost ? colours.quality[0] : colours.quality[qualityOf(worst)];
      // The lower half of the shares never occurs on a placed scan; it is not given room.
      const high = lost ? base : Math.max(3, (base - 2) * Math.min(1, Math.max(0, (worst - 0.4) / 0.6)));
      if (about?.missing && !lost) {
        // How well it agreed is not known.
        ctx.fillStyle = colours.fresh;
        ctx.fillRect(px, base - UNKNOWN_PX, 1.5, UNKNOWN_PX);
      } else {
        ctx.fillRect(px, base - high, 1.5, high);
      }
      if (searched) {
        ctx.fillStyle = colours.hypothesis;
        ctx.fillRect(px, base + 2, 2, 2);
      }
      if (closed) {
        ctx.fillStyle = colours.closure;
        ctx.fillRect(px, base + 4.5, 2, 2.5);
      }
    }
    ctx.globalAlpha = 1;
  }

  /** @param {import("./colours.js").Colours} colours */
  drawHead(colours) {
    const { ctx } = this.surface;
    const { length, time } = this.history;
    if (length === 0) return;
    const x = Math.min(this.width - 1, Math.max(1, (time / length) * this.width));
    ctx.fillStyle = colours.text;
    ctx.fillRect(x - 1, 0, 2, this.height);
    ctx.beginPath();
    ctx.arc(x, 4, 4, 0, 2 * Math.PI);
    ctx.fill();
  }
}
