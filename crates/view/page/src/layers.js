// What can be shown and hidden.

import { element } from "./dom.js";

/**
 * @typedef {"map" | "scan" | "pairs" | "arcs" | "hypotheses" | "virtual" | "boxes" | "moving" | "way" | "closures"
 *   | "ellipses"} Layer
 *
 * @typedef {object} LayerInfo
 * @property {Layer} id
 * @property {string} key
 * @property {string} name
 * @property {string} title
 * @property {boolean} on At first.
 * @property {"result" | "record" | "details"} from What it needs: a report holds no details, a result without a record only
 *   map and poses.
 */

/** @type {LayerInfo[]} */
export const LAYERS = [
  { id: "map", key: "1", name: "Map", title: "Walls of the map, and in grey what was merged since it was made", on: true, from: "result" },
  { id: "scan", key: "2", name: "Scan", title: "Returns and polylines of the scan", on: true, from: "details" },
  { id: "pairs", key: "3", name: "Matched pairs", title: "Polylines matched by shape, joined by dashed lines: the scan as if the scanner had not moved, and the virtual scan where there was a search, else a scan from a metre away", on: false, from: "details" },
  { id: "arcs", key: "4", name: "Arcs", title: "Maximal convex arcs of the scan's polylines", on: false, from: "details" },
  { id: "hypotheses", key: "5", name: "Hypotheses", title: "Poses that were thought of", on: true, from: "details" },
  { id: "virtual", key: "6", name: "Virtual scan", title: "The part of the map that the scan was matched with", on: false, from: "details" },
  { id: "way", key: "7", name: "Way of the scanner", title: "By the share of beams that agree with the map", on: true, from: "result" },
  { id: "closures", key: "8", name: "Closures", title: "Places that were recognised", on: true, from: "record" },
  { id: "ellipses", key: "9", name: "Uncertainty", title: "Standard deviation of the place, 20 times enlarged; a bar where the walls leave a direction open", on: false, from: "record" },
  { id: "boxes", key: "0", name: "Eraser boxes", title: "Where nothing is merged: no stable shape", on: true, from: "result" },
  { id: "moving", key: "o", name: "Moving objects", title: "What was found to move, and left out of the map", on: true, from: "record" },
];

export class Layers {
  /**
   * @param {HTMLElement} list
   * @param {boolean} hasDetails
   * @param {() => void} changed
   */
  constructor(list, hasDetails, changed) {
    this.version = 0;
    this.changed = changed;
    /** @type {Map<Layer, HTMLInputElement>} */
    this.boxes = new Map();
    for (const layer of LAYERS) {
      if (layer.from === "details" && !hasDetails) continue;
      const box = /** @type {HTMLInputElement} */ (
        element("input", { type: "checkbox", id: `layer-${layer.id}`, "data-layer": layer.id })
      );
      box.checked = layer.on;
      box.addEventListener("change", () => this.touch());
      this.boxes.set(layer.id, box);
      list.append(
        element(
          "li",
          {},
          element(
            "label",
            { title: layer.title },
            box,
            element("span", { class: `swatch swatch-${layer.id}`, "aria-hidden": "true" }),
            element("span", { class: "layer-name" }, layer.name),
            element("kbd", {}, layer.key.toUpperCase()),
          ),
        ),
      );
    }
  }

  /** Takes those out that need more than a result. */
  keepResult() {
    for (const { id, from } of LAYERS) {
      if (from === "result") continue;
      this.boxes.get(id)?.closest("li")?.remove();
      this.boxes.delete(id);
    }
    this.touch();
  }

  /** @param {Layer} id */
  shows(id) {
    return this.boxes.get(id)?.checked ?? false;
  }

  /**
   * Shows or hides the layer of a key; whether there is one.
   * @param {string} key
   */
  toggleByKey(key) {
    const layer = LAYERS.find((l) => l.key === key);
    const box = layer && this.boxes.get(layer.id);
    if (!box) return false;
    box.checked = !box.checked;
    this.touch();
    return true;
  }

  touch() {
    this.version += 1;
    this.changed();
  }
}
