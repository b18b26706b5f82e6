// The bar that tells how long a metre is.

import { length } from "./format.js";

const STEPS_M = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
/** The longest bar, pixels. */
const LONGEST_PX = 140;

/**
 * @param {HTMLElement} bar
 * @param {import("./camera.js").Camera} camera
 */
export function drawScaleBar(bar, { scale, width }) {
  const step = STEPS_M.findLast((s) => s * scale <= Math.min(LONGEST_PX, width / 4)) ?? STEPS_M[0];
  const text = length(step).replace(/\.0+(?=\D)/, "");
  if (bar.textContent !== text) bar.textContent = text;
  bar.style.width = `${(step * scale).toFixed(1)}px`;
}
