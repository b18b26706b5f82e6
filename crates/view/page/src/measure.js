// Measures a distance between two points; points near a vertex or wall of the map are taken onto it.

import { pickWall } from "./pick.js";
import { degrees, length } from "./format.js";

/** @typedef {[number, number]} Place Map, metres. */

export class Measure {
  /**
   * @param {import("./history.js").History} history
   * @param {import("./camera.js").Camera} camera
   * @param {HTMLElement} readout
   */
  constructor(history, camera, readout) {
    this.history = history;
    this.camera = camera;
    this.readout = readout;
    this.on = false;
    /** @type {Place[]} */
    this.ends = [];
    /** The second end while it is not set. @type {Place | undefined} */
    this.loose = undefined;
  }

  /** @param {boolean} on */
  switch(on) {
    this.on = on;
    this.ends = [];
    this.loose = undefined;
    this.tell();
  }

  /** @param {number} px @param {number} py @returns {Place} */
  snap(px, py) {
    const [x, y] = this.camera.toMap(px, py);
    const found = pickWall(this.history, x, y, this.camera.scale);
    return found ? [found.x, found.y] : [x, y];
  }

  /** @param {number} px @param {number} py */
  hover(px, py) {
    if (this.ends.length === 2) return;
    this.loose = this.snap(px, py);
    this.tell();
  }

  /** @param {number} px @param {number} py */
  tap(px, py) {
    if (this.ends.length === 2) this.ends = [];
    this.ends.push(this.snap(px, py));
    this.loose = undefined;
    this.tell();
  }

  tell() {
    const [a, b] = [this.ends[0], this.ends[1] ?? this.loose];
    if (!this.on) this.readout.textContent = "";
    else if (!a) this.readout.textContent = "Click the first point";
    else if (!b) this.readout.textContent = "Click the second point";
    else {
      const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
      this.readout.textContent = `${length(Math.hypot(dx, dy))} · ${degrees(Math.atan2(dy, dx))}`;
    }
    this.readout.hidden = !this.on;
  }

  /**
   * @param {CanvasRenderingContext2D} ctx In pixels.
   * @param {import("./colours.js").Colours} colours
   */
  draw(ctx, colours) {
    if (!this.on) return;
    const places = [...this.ends, ...(this.loose && this.ends.length < 2 ? [this.loose] : [])];
    const points = places.map(([x, y]) => this.camera.toScreen(x, y));
    ctx.strokeStyle = colours.measure;
    ctx.fillStyle = colours.paper;
    ctx.lineWidth = 2;
    if (points.length === 2) {
      ctx.beginPath();
      ctx.moveTo(...points[0]);
      ctx.lineTo(...points[1]);
      ctx.stroke();
    }
    for (const [x, y] of points) {
      ctx.beginPath();
      ctx.arc(x, y, 4.5, 0, 2 * Math.PI);
      ctx.fill();
      ctx.stroke();
    }
  }
}
