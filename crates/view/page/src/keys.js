// The keyboard.

/**
 * @typedef {object} Orders
 * @property {import("./player.js").Player} player
 * @property {import("./layers.js").Layers} layers
 * @property {() => void} fit
 * @property {() => void} measure
 * @property {() => void} theme
 * @property {() => void} help
 * @property {() => void} escape
 * @property {(direction: 1 | -1) => void} speed
 * @property {(factor: number) => void} zoom
 */

/** Scans that a step with the shift key goes. */
const LONG_STEP = 100;

/**
 * What a key does; undefined if nothing.
 * @param {KeyboardEvent} e
 * @param {Orders} orders
 * @returns {(() => void) | undefined}
 */
function orderOf(e, orders) {
  const { player } = orders;
  const far = e.shiftKey ? LONG_STEP : 1;
  /** @type {Record<string, () => void>} */
  const table = {
    " ": () => player.toggle(),
    ArrowLeft: () => player.step(-far),
    ArrowRight: () => player.step(far),
    Home: () => player.step(-player.history.length),
    End: () => player.follow(),
    n: () => player.seekEvent(1),
    p: () => player.seekEvent(-1),
    f: orders.fit,
    m: orders.measure,
    t: orders.theme,
    "?": orders.help,
    "+": () => orders.zoom(1.3),
    "=": () => orders.zoom(1.3),
    "-": () => orders.zoom(1 / 1.3),
    "]": () => orders.speed(1),
    "[": () => orders.speed(-1),
    Escape: orders.escape,
  };
  return table[e.key.length === 1 ? e.key.toLowerCase() : e.key];
}

/** @param {Orders} orders */
export function listenToKeys(orders) {
  document.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const at = e.target instanceof HTMLElement ? e.target : document.body;
    // Controls keep the keys that they understand themselves.
    const typing = at instanceof HTMLSelectElement;
    const pressing = (e.key === " " || e.key === "Enter") && at.matches("button, input[type=checkbox], summary, a");
    const sliding = at.matches("input[type=range]") && /^(Arrow(Up|Down)|Page)/.test(e.key);
    if (typing || pressing || sliding || document.querySelector("dialog[open]")) return;
    const order = orderOf(e, orders);
    if (order) order();
    else if (!orders.layers.toggleByKey(e.key.toLowerCase())) return;
    e.preventDefault();
  });
}
