// What the buttons and the line on top say: playing or not, how fast, live or finished.

import { byId } from "./dom.js";
import { SPEEDS } from "./player.js";

export class Controls {
  /**
   * @param {import("./history.js").History} history
   * @param {import("./player.js").Player} player
   * @param {boolean} isReport
   */
  constructor(history, player, isReport) {
    this.history = history;
    this.player = player;
    this.isReport = isReport;
    /** Whether the server answers. */
    this.connected = true;
    this.speed = /** @type {HTMLSelectElement} */ (byId("speed"));
    this.speed.append(...SPEEDS.map((s) => new Option(`${s}×`, String(s))));
    this.speed.addEventListener("change", () => player.choose(Number(this.speed.value)));
  }

  /** Brings all up to date. */
  update() {
    const { player } = this;
    const play = byId("play");
    play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    play.classList.toggle("playing", player.playing);
    if (!player.speedChosen && !player.playing) player.speed = player.suitableSpeed();
    this.speed.value = String(player.speed);
    this.status();
  }

  /** The name of the log, and how it stands with it. */
  status() {
    const name = (this.history.about?.log ?? "").split("/").pop() || "polymapper";
    byId("log-name").textContent = name;
    if (!this.isReport) document.title = `${name} – polymapper`;
    const [word, tone] = this.state();
    const status = byId("status");
    if (status.textContent !== word) {
      status.textContent = word;
      // It is cut where there is no room for it.
      status.title = word;
    }
    status.className = `chip ${tone}`;
  }

  /** @returns {[string, string]} Word and tone. */
  state() {
    const { end } = this.history;
    if (!this.connected) return ["connection lost", "bad"];
    if (end?.partial) return [`partial: ${end.partial}`, "bad"];
    if (end) return [this.isReport ? "report" : "finished", "quiet"];
    return this.player.following ? ["live", "live"] : ["live, looking back", "back"];
  }
}
