// Colours of the drawing, from the style sheet, so that light and dark are told in one place.

/**
 * @typedef {object} Colours
 * @property {string} paper
 * @property {string} grid
 * @property {string} gridStrong
 * @property {string} wall
 * @property {string} fresh
 * @property {string} scan
 * @property {string} returns
 * @property {string} pair
 * @property {string} virtual
 * @property {string} hypothesis
 * @property {string} box
 * @property {string} moving
 * @property {string} closure
 * @property {string} ellipse
 * @property {string} laser
 * @property {string} measure
 * @property {string} text
 * @property {string} left
 * @property {string} right
 * @property {string[]} quality Worst to best.
 */

const NAMES = /** @type {const} */ ([
  "paper",
  "grid",
  "gridStrong",
  "wall",
  "fresh",
  "scan",
  "returns",
  "pair",
  "virtual",
  "hypothesis",
  "box",
  "moving",
  "closure",
  "ellipse",
  "laser",
  "measure",
  "text",
  "left",
  "right",
]);

export const QUALITY_STEPS = 5;

/** @returns {Colours} */
export function readColours() {
  const style = getComputedStyle(document.documentElement);
  const read = (/** @type {string} */ name) => style.getPropertyValue(`--draw-${name}`).trim();
  /** @type {Record<string, string | string[]>} */
  const out = {};
  for (const name of NAMES) out[name] = read(name.replace(/[A-Z]/g, (c) => `-${c.toLowerCase()}`));
  out.quality = Array.from({ length: QUALITY_STEPS }, (_, k) => read(`quality-${k}`));
  return /** @type {Colours} */ (/** @type {unknown} */ (out));
}

/**
 * Step of quality, 0 worst, of a share of agreeing beams. The first scan has nothing to agree with.
 * @param {number | undefined} fit
 */
export function qualityOf(fit) {
  if (fit === undefined) return QUALITY_STEPS - 1;
  if (fit < 0.6) return 0;
  if (fit < 0.7) return 1;
  if (fit < 0.8) return 2;
  return fit < 0.9 ? 3 : 4;
}
