// Numbers as people read them.

const THIN = "\u202f";

/** @param {number} value */
export function count(value) {
  return Math.round(value)
    .toString()
    .replace(/\B(?=(\d{3})+$)/g, THIN);
}

/** @param {number} metres */
export function length(metres) {
  const far = Math.abs(metres);
  if (far < 0.1) return `${(metres * 1000).toFixed(far < 0.01 ? 1 : 0)}${THIN}mm`;
  if (far < 100) return `${metres.toFixed(far < 10 ? 2 : 1)}${THIN}m`;
  return `${count(metres)}${THIN}m`;
}

/** @param {number} value @param {number} digits */
export function signed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
}

/** A point of the map. @param {number} x @param {number} y */
export function place(x, y) {
  return `${signed(x, 2)}, ${signed(y, 2)}${THIN}m`;
}

/** @param {number | undefined} share */
export function percent(share) {
  if (share === undefined) return "–";
  const value = share * 100;
  return `${value.toFixed(value >= 99.95 || value === 0 ? 0 : 1)}${THIN}%`;
}

/** @param {number} radians */
export function degrees(radians) {
  const value = (radians * 180) / Math.PI;
  const wrapped = ((((value + 180) % 360) + 360) % 360) - 180;
  return `${signed(wrapped, 1)}°`;
}

/** @param {number} seconds */
export function duration(seconds) {
  if (seconds < 0.1) return `${(seconds * 1000).toFixed(1)}${THIN}ms`;
  if (seconds < 60) return `${seconds.toFixed(seconds < 10 ? 2 : 1)}${THIN}s`;
  const whole = Math.round(seconds);
  const two = (/** @type {number} */ v) => v.toString().padStart(2, "0");
  if (whole < 3600) return `${Math.floor(whole / 60)}:${two(whole % 60)}`;
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
}

/** @param {number} bytes */
export function size(bytes) {
  if (bytes < 1000) return `${bytes}${THIN}B`;
  if (bytes < 1e6) return `${(bytes / 1e3).toFixed(bytes < 1e5 ? 1 : 0)}${THIN}kB`;
  return `${(bytes / 1e6).toFixed(1)}${THIN}MB`;
}
