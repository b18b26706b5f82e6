// Puts the page together: the record, what is drawn, and what people do.

import { Camera } from "./camera.js";
import { Controls } from "./controls.js";
import { Details } from "./details.js";
import { byId } from "./dom.js";
import { count } from "./format.js";
import { Framing } from "./framing.js";
import { Gestures } from "./gestures.js";
import { History } from "./history.js";
import { listenToKeys } from "./keys.js";
import { Layers } from "./layers.js";
import { Measure } from "./measure.js";
import { Panel } from "./panel.js";
import { pick } from "./pick.js";
import { Player, SPEEDS } from "./player.js";
import { drawReport, reportOfPage } from "./report.js";
import { drawScaleBar } from "./scale_bar.js";
import { Scene } from "./scene.js";
import { askServer, followServer, readPacked } from "./source.js";
import { Theme } from "./theme.js";
import { Timeline } from "./timeline.js";
import { Tooltip } from "./tooltip.js";

/** The panel is written anew at most this often while playing: nobody reads faster. */
const PANEL_MS = 80;

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
    this.bar = new Controls(this.history, this.player, Boolean(this.report));
    this.framing = new Framing(this.camera, this.scene, this.player);
    this.panel = new Panel(byId("scan-panel"), byId("map-panel"), byId("search-panel"), this.history, (k) => {
      this.scene.hypothesis = k;
      this.wake();
    });
    this.slider = /** @type {HTMLInputElement} */ (byId("slider"));
    this.timeline = new Timeline(/** @type {HTMLCanvasElement} */ (byId("strip")), this.slider, this.history, (t) => {
      this.player.playing = false;
      this.player.goTo(t);
    });
    this.theme = new Theme(() => this.recolour());
    this.measure = new Measure(this.history, this.camera, byId("readout"));
    this.tooltip = new Tooltip(byId("tooltip"));
    this.scene.overlay = (ctx) => this.measure.draw(ctx, this.scene.colours);
    this.paneled = 0;
    this.last = 0;
    this.awake = false;
  }

  start() {
    document.documentElement.classList.toggle("is-report", Boolean(this.report));
    this.listen();
    this.theme.apply();
    this.resize();
    this.controls();
    void this.read();
  }

  async read() {
    const reader = {
      take: (/** @type {import("./record.js").Line} */ line) => {
        this.history.take(line);
        if (line.about?.missing) this.showResultOnly();
      },
      arrived: () => this.wake(),
      connection: (/** @type {boolean} */ connected) => {
        this.bar.connected = connected;
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

  /** No record was kept: what it would fill is taken away. */
  showResultOnly() {
    document.documentElement.classList.add("is-result");
    this.layers.keepResult();
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
    this.framing.tick(now);
    this.scene.draw();
    this.timeline.draw(this.scene.colours);
    drawScaleBar(byId("scale"), this.camera);
    if (!this.player.playing || now - this.paneled > PANEL_MS) this.drawPanel(now);
    if (this.player.playing) this.wake();
    else if (now - this.paneled < PANEL_MS) setTimeout(() => this.wake(), PANEL_MS);
  }

  /** @param {number} now */
  drawPanel(now) {
    if (this.paneled === now) return;
    const n = this.history.time - 1;
    const key = `${this.history.time}/${this.history.length}`;
    byId("position").textContent = `${count(this.history.time)} / ${count(this.history.length)}`;
    const inMotion = this.player.playing || (this.player.following && !this.history.end);
    this.panel.draw(this.details.held.get(n), this.scene.paths, inMotion);
    if (key !== this.panelKey) this.paneled = now;
    this.panelKey = key;
    this.bar.status();
  }

  panelKey = "";

  fit() {
    this.framing.fit();
    this.wake();
  }

  /**
   * @param {number} first
   * @param {number} last
   */
  showStretch(first, last) {
    this.player.playing = false;
    this.player.goTo(last + 1);
    this.framing.stretch(first, last);
    this.area.scrollIntoView({ block: "center" });
    this.area.focus({ preventScroll: true });
    this.wake();
  }

  resize() {
    const box = this.area.getBoundingClientRect();
    this.scene.resize(box.width, box.height);
    this.timeline.resize();
    if (this.framing.following) this.framing.fit();
    this.wake();
  }

  listen() {
    new ResizeObserver(() => this.resize()).observe(this.area);
    new Gestures(this.area, this.camera, {
      moved: () => {
        this.framing.release();
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
    click("theme", () => this.theme.next());
    click("help", () => this.help());
    click("panel-toggle", () => this.togglePanel());
    click("zoom-in", () => this.zoom(1.4));
    click("zoom-out", () => this.zoom(1 / 1.4));
    listenToKeys({
      player,
      layers: this.layers,
      fit: () => this.fit(),
      measure: () => this.toggleMeasure(),
      theme: () => this.theme.next(),
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
    this.framing.release();
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

  recolour() {
    this.scene.recolour();
    this.wake();
  }

  /** Brings the controls up to date. */
  controls() {
    this.bar.update();
    this.wake();
  }
}

new App().start();
