// What is under the pointer, in words beside it.

import { length, percent, count } from "./format.js";

/**
 * @param {import("./pick.js").Picked} picked
 * @param {import("./history.js").History} history
 * @returns {[string, string][]} Title first.
 */
function words(picked, history) {
  if (picked.kind === "pose") {
    const frame = history.frames[picked.n];
    /** @type {[string, string][]} */
    const agree = frame.fit === undefined ? [] : [["Beams that agree", percent(frame.fit)]];
    return [["Scan", count(frame.scan)], ...agree, ["Click", "to see it"]];
  }
  const { wall } = picked;
  if (picked.kind === "vertex") {
    const k = picked.vertex;
    return [
      ["Polyline", `${wall.id}, vertex ${k + 1} of ${wall.points.length / 2}`],
      ["Observations", count(wall.observations[k] ?? 0)],
      ["Standard deviation", length((wall.sigma_tenth_mm[k] ?? 0) / 1e4)],
      ["Place", `${picked.x.toFixed(3)}, ${picked.y.toFixed(3)} m`],
    ];
  }
  const k = picked.side;
  const p = wall.points;
  return [
    ["Polyline", `${wall.id}, side ${k + 1} of ${p.length / 2 - 1}`],
    ["Length", length(Math.hypot(p[2 * k + 2] - p[2 * k], p[2 * k + 3] - p[2 * k + 1]))],
    ["Observations", `${count(wall.observations[k] ?? 0)} and ${count(wall.observations[k + 1] ?? 0)}`],
    ["Standard deviation", `${length((wall.sigma_tenth_mm[k] ?? 0) / 1e4)} and ${length((wall.sigma_tenth_mm[k + 1] ?? 0) / 1e4)}`],
  ];
}

export class Tooltip {
  /** @param {HTMLElement} box */
  constructor(box) {
    this.box = box;
  }

  hide() {
    this.box.hidden = true;
  }

  /**
   * @param {import("./pick.js").Picked} picked
   * @param {import("./history.js").History} history
   * @param {import("./camera.js").Camera} camera
   */
  show(picked, history, camera) {
    this.box.replaceChildren(
      ...words(picked, history).map(([name, value], k) => {
        const row = document.createElement("div");
        if (k === 0) row.className = "tip-title";
        const label = document.createElement("span");
        label.textContent = name;
        row.append(label, " ", value);
        return row;
      }),
    );
    this.box.hidden = false;
    const [px, py] = camera.toScreen(picked.x, picked.y);
    const { offsetWidth: w, offsetHeight: h } = this.box;
    const left = px + 14 + w > camera.width ? px - 14 - w : px + 14;
    const top = py - 12 - h < 0 ? py + 14 : py - 12 - h;
    this.box.style.transform = `translate(${Math.round(Math.max(4, left))}px, ${Math.round(Math.max(4, top))}px)`;
  }
}
