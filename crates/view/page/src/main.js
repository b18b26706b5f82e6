// Puts the page together: the record, what is drawn, and what people do.

import { Camera } from "./camera.js";
import { Details } from "./details.js";
import { byId } from "./dom.js";
import { count, length } from "./format.js";
import { Gestures } from "./gestures.js";
import { History } from "./history.js";
import { listenToKeys } from "./keys.js";
import { Layers } from "./layers.js";
import { Measure } from "./measure.js";
import { Panel } from "./panel.js";
import { pick } from "./pick.js";
import { Player, SPEEDS } from "./player.js";
import { drawReport, reportOfPage } from "./report.js";
import { Scene } from "./scene.js";
import { askServer, followServer, readPacked } from "./source.js";
import { Timeline } from "./timeline.js";
import { Tooltip } from "./tooltip.js";

/** While the map grows, the view is widened when something lies outside; looked at this often. */
const REFIT_MS = 250;
/** The panel is written anew at most this often while playing: nobody reads faster. */
const PANEL_MS = 80;

const THEMES = /** @type {const} */ (["auto", "light", "dark"]);

class App {
  constructor() {
    this.report = reportOfPage();
    this.history = new History();
    this.camera = new Camera();
    this.area = byId("map");
    this.details = new Details(this.report ? undefined : askServer, () => this.wake());
    this.layers = new Layers(byId("layer-list"), !this.report, () => this.wake());
    this.scene = new Scene(
      /** @type {HTMLCanvasElement} */ (byId("below")),
      /** @type {HTMLCanvasElement} */ (byId("above")),
      this.history,
      this.details,
      this.layers,
      this.camera,
    );
    this.player = new Player(this.history, () => this.controls());
    this.panel = new Panel(byId("scan-panel"), byId("map-panel"), byId("search-panel"), this.history, (k) => {
      this.scene.hypothesis = k;
      this.wake();
    });
    this.slider = /** @type {HTMLInputElement} */ (byId("slider"));
    this.timeline = new Timeline(/** @type {HTMLCanvasElement} */ (byId("strip")), this.slider, this.history, (t) => {
      this.player.playing = false;
      this.player.goTo(t);
    });
    this.measure = new Measure(this.history, this.camera, byId("readout"));
    this.tooltip = new Tooltip(byId("tooltip"));
    this.scene.overlay = (ctx) => this.measure.draw(ctx, this.scene.colours);
    /** Whether the view follows the growing map. */
    this.fitting = true;
    this.fitted = 0;
    this.paneled = 0;
    this.last = 0;
    this.awake = false;
    this.connected = true;
  }

  start() {
    document.documentElement.classList.toggle("is-report", Boolean(this.report));
    this.listen();
    this.setTheme(localTheme());
    this.resize();
    this.controls();
    void this.read();
  }

  async read() {
    const reader = {
      take: (/** @type {import("./record.js").Line} */ line) => this.history.take(line),
      arrived: () => this.wake(),
      connection: (/** @type {boolean} */ connected) => {
        this.connected = connected;
        this.controls();
      },
    };
    const packed = document.getElementById("record-data")?.textContent;
    if (packed) await readPacked(packed, reader);
    else await followServer(reader);
    this.player.tick(0);
    this.controls();
    if (this.report) {
      drawReport(this.report, this.history, (first, last) => this.showStretch(first, last));
    }
  }

  /** Asks for a frame. */
  wake() {
    if (this.awake) return;
    this.awake = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  /** @param {number} now */
  frame(now) {
    this.awake = false;
    const seconds = Math.min(0.25, (now - this.last) / 1000);
    this.last = now;
    this.player.tick(seconds);
    if (this.player.playing) {
      this.details.want(this.history.time + 40, this.history.length);
    }
    if (this.fitting && now - this.fitted > REFIT_MS) this.refit(now);
    this.scene.draw();
    this.timeline.draw(this.scene.colours);
    this.drawScale();
    if (!this.player.playing || now - this.paneled > PANEL_MS) this.drawPanel(now);
    if (this.player.playing || this.gliding) this.wake();
    else if (now - this.paneled < PANEL_MS) setTimeout(() => this.wake(), PANEL_MS);
  }

  /** @param {number} now */
  drawPanel(now) {
    if (this.paneled === now) return;
    const n = this.history.time - 1;
    const key = `${this.history.time}/${this.history.length}`;
    byId("position").textContent = `${count(this.history.time)} / ${count(this.history.length)}`;
    this.panel.draw(this.details.held.get(n), this.scene.paths);
    if (key !== this.panelKey) this.paneled = now;
    this.panelKey = key;
    this.status();
  }

  panelKey = "";
  gliding = false;

  /** Widens the view when the map has outgrown it. @param {number} now */
  refit(now) {
    this.fitted = now;
    const bounds = this.scene.bounds();
    if (!bounds) return;
    const view = this.camera.visible();
    const inside =
      bounds.left >= view.left && bounds.right <= view.right && bounds.bottom >= view.bottom && bounds.top <= view.top;
    const to = this.camera.fitting(bounds);
    const settled = !this.player.playing && (!this.player.following || this.history.end);
    if (!inside || settled || to.scale > 2.2 * this.camera.scale) {
      // While it grows, some room is left, so that the view is not moved with every scan.
      const room = settled ? 1 : 0.8;
      const aim = { ...to, scale: to.scale * room };
      const same = Math.abs(aim.scale / this.camera.scale - 1) < 0.01 && Math.hypot(aim.x - this.camera.x, aim.y - this.camera.y) * aim.scale < 2;
      if (!same) this.camera.look(aim);
    }
  }

  fit() {
    this.fitting = true;
    const bounds = this.scene.bounds();
    if (bounds) this.camera.look(this.camera.fitting(bounds));
    this.wake();
  }

  /**
   * @param {number} first
   * @param {number} last
   */
  showStretch(first, last) {
    this.player.playing = false;
    this.player.goTo(last + 1);
    const poses = this.history.poses.slice(Math.max(0, first - 20), last + 1).flatMap((p) => (p ? [p] : []));
    if (poses.length > 0) {
      this.fitting = false;
      const [xs, ys] = [poses.map((p) => p[0]), poses.map((p) => p[1])];
      const around = 3;
      this.camera.look(
        this.camera.fitting({
          left: Math.min(...xs) - around,
          right: Math.max(...xs) + around,
          bottom: Math.min(...ys) - around,
          top: Math.max(...ys) + around,
        }),
      );
    }
    this.area.scrollIntoView({ block: "center" });
    this.area.focus({ preventScroll: true });
    this.wake();
  }

  resize() {
    const box = this.area.getBoundingClientRect();
    this.scene.resize(box.width, box.height);
    this.timeline.resize();
    if (this.fitting) this.fit();
    this.wake();
  }

  listen() {
    new ResizeObserver(() => this.resize()).observe(this.area);
    new Gestures(this.area, this.camera, {
      moved: () => {
        this.fitting = false;
        this.tooltip.hide();
        this.wake();
      },
      hover: (px, py) => this.hover(px, py),
      leave: () => this.tooltip.hide(),
      tap: (px, py) => this.tap(px, py),
    });
    const click = (/** @type {string} */ id, /** @type {() => void} */ order) =>
      byId(id).addEventListener("click", order);
    const { player } = this;
    click("play", () => player.toggle());
    click("to-start", () => player.step(-this.history.length));
    click("back", () => player.step(-1));
    click("forward", () => player.step(1));
    click("to-end", () => player.follow());
    click("previous-event", () => player.seekEvent(-1));
    click("next-event", () => player.seekEvent(1));
    click("fit", () => this.fit());
    click("measure", () => this.toggleMeasure());
    click("theme", () => this.nextTheme());
    click("help", () => this.help());
    click("panel-toggle", () => this.togglePanel());
    click("zoom-in", () => this.zoom(1.4));
    click("zoom-out", () => this.zoom(1 / 1.4));
    byId("speed").addEventListener("change", (e) => player.choose(Number(/** @type {HTMLSelectElement} */ (e.target).value)));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.setTheme(localTheme()));
    listenToKeys({
      player,
      layers: this.layers,
      fit: () => this.fit(),
      measure: () => this.toggleMeasure(),
      theme: () => this.nextTheme(),
      help: () => this.help(),
      escape: () => {
        if (this.measure.on) this.toggleMeasure();
        this.closePanel();
      },
      speed: (direction) => this.changeSpeed(direction),
      zoom: (factor) => this.zoom(factor),
    });
  }

  /** @param {number} factor */
  zoom(factor) {
    this.fitting = false;
    this.camera.zoom(factor, this.camera.width / 2, this.camera.height / 2);
    this.wake();
  }

  /** @param {1 | -1} direction */
  changeSpeed(direction) {
    const k = SPEEDS.indexOf(this.player.speed) + direction;
    if (SPEEDS[k]) this.player.choose(SPEEDS[k]);
  }

  /** @param {number} px @param {number} py */
  hover(px, py) {
    if (this.measure.on) {
      this.measure.hover(px, py);
      this.wake();
      return;
    }
    const picked = pick(this.history, this.camera, this.layers, px, py);
    this.area.classList.toggle("over-pose", picked?.kind === "pose");
    if (picked) this.tooltip.show(picked, this.history, this.camera);
    else this.tooltip.hide();
  }

  /** @param {number} px @param {number} py */
  tap(px, py) {
    if (this.measure.on) {
      this.measure.tap(px, py);
      this.wake();
      return;
    }
    const picked = pick(this.history, this.camera, this.layers, px, py);
    if (picked?.kind === "pose") {
      this.player.playing = false;
      this.player.goTo(picked.n + 1);
    }
    if (picked) this.tooltip.show(picked, this.history, this.camera);
    else this.tooltip.hide();
  }

  toggleMeasure() {
    this.measure.switch(!this.measure.on);
    byId("measure").setAttribute("aria-pressed", String(this.measure.on));
    this.area.classList.toggle("measuring", this.measure.on);
    this.tooltip.hide();
    this.wake();
  }

  help() {
    /** @type {HTMLDialogElement} */ (byId("help-dialog")).showModal();
  }

  togglePanel() {
    const open = document.documentElement.classList.toggle("panel-open");
    byId("panel-toggle").setAttribute("aria-expanded", String(open));
  }

  closePanel() {
    document.documentElement.classList.remove("panel-open");
    byId("panel-toggle").setAttribute("aria-expanded", "false");
  }

  nextTheme() {
    const theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    try {
      localStorage.setItem("theme", theme);
    } catch {
      // A page without storage forgets the choice.
    }
    this.setTheme(theme);
  }

  /** @param {typeof THEMES[number]} theme */
  setTheme(theme) {
    document.documentElement.dataset.theme = theme === "auto" ? (prefersDark() ? "dark" : "light") : theme;
    this.recolour();
  }

  recolour() {
    this.scene.recolour();
    this.wake();
  }

  /** Brings the controls up to date. */
  controls() {
    const { player } = this;
    const play = byId("play");
    play.setAttribute("aria-label", player.playing ? "Pause" : "Play");
    play.classList.toggle("playing", player.playing);
    const speed = /** @type {HTMLSelectElement} */ (byId("speed"));
    if (speed.options.length === 0) {
      for (const s of SPEEDS) speed.append(new Option(`${s}×`, String(s)));
    }
    if (!player.speedChosen && !player.playing) player.speed = player.suitableSpeed();
    speed.value = String(player.speed);
    this.status();
    this.wake();
  }

  status() {
    const { history, player } = this;
    const name = (history.about?.log ?? "").split("/").pop() || "polymapper";
    byId("log-name").textContent = name;
    if (!this.report) document.title = `${name} – polymapper`;
    const status = byId("status");
    let [word, tone] = ["live", "live"];
    if (!this.connected) [word, tone] = ["connection lost", "bad"];
    else if (history.end?.partial) [word, tone] = [`partial: ${history.end.partial}`, "bad"];
    else if (history.end) [word, tone] = [this.report ? "report" : "finished", ""];
    else if (!player.following) [word, tone] = ["live, looking back", "back"];
    if (status.textContent !== word) status.textContent = word;
    status.className = `chip ${tone}`;
  }

  drawScale() {
    const { scale, width } = this.camera;
    const steps = [0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
    const step = steps.findLast((s) => s * scale <= Math.min(140, width / 4)) ?? steps[0];
    const text = length(step).replace(/\.0+(?=\D)/, "");
    const label = byId("scale");
    if (label.textContent !== text) label.textContent = text;
    label.style.width = `${(step * scale).toFixed(1)}px`;
  }
}

/** @returns {typeof THEMES[number]} */
function localTheme() {
  try {
    return THEMES.find((t) => t === localStorage.getItem("theme")) ?? "auto";
  } catch {
    return "auto";
  }
}

function prefersDark() {
  return matchMedia("(prefers-color-scheme: dark)").matches;
}

new App().start();
