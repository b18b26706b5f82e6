// Plays, steps, follows.

/** Speeds that are offered, as times the pace at which the log was recorded. */
export const SPEEDS = [1, 2, 5, 10, 20, 50, 100, 200];

/** A whole log is to be seen in about this time, seconds. */
const WHOLE_S = 40;
/** What is taken for the time between scans where the stamps do not tell it, seconds. */
const USUAL_INTERVAL_S = 0.1;

export class Player {
  /**
   * @param {import("./history.js").History} history
   * @param {() => void} changed
   */
  constructor(history, changed) {
    this.history = history;
    this.changed = changed;
    this.playing = false;
    /** Shows what comes as it comes. */
    this.following = true;
    this.speed = 1;
    this.speedChosen = false;
    this.exact = 0;
  }

  /** Scans a second in the log. */
  rate() {
    const { frames } = this.history;
    const first = frames[0]?.stamp_s;
    const last = frames[frames.length - 1]?.stamp_s;
    const interval = first === undefined || last === undefined ? 0 : (last - first) / Math.max(1, frames.length - 1);
    return 1 / (interval > 0.001 && interval < 5 ? interval : USUAL_INTERVAL_S);
  }

  /** The slowest speed at which the whole is seen in a while. */
  suitableSpeed() {
    const whole = this.history.length / this.rate();
    return SPEEDS.find((s) => whole / s <= WHOLE_S) ?? SPEEDS[SPEEDS.length - 1];
  }

  /** @param {number} speed */
  choose(speed) {
    this.speed = speed;
    this.speedChosen = true;
    this.changed();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (!this.speedChosen) this.speed = this.suitableSpeed();
    if (this.history.time >= this.history.length) this.goTo(0);
    this.exact = this.history.time;
    this.playing = true;
    this.following = false;
    this.changed();
  }

  pause() {
    this.playing = false;
    this.following = false;
    this.changed();
  }

  /** @param {number} time */
  goTo(time) {
    this.history.goTo(time);
    this.exact = this.history.time;
    this.following = false;
    this.changed();
  }

  /** @param {number} scans */
  step(scans) {
    this.playing = false;
    this.goTo(this.history.time + scans);
  }

  follow() {
    this.playing = false;
    this.following = true;
    this.history.goTo(this.history.length);
    this.changed();
  }

  /**
   * Time goes by.
   * @param {number} seconds
   * @returns {boolean} Whether something else is shown now.
   */
  tick(seconds) {
    const { history } = this;
    const before = history.time;
    if (this.following) {
      history.goTo(history.length);
    } else if (this.playing) {
      this.exact = Math.min(history.length, this.exact + seconds * this.rate() * this.speed);
      history.goTo(Math.floor(this.exact));
      if (history.time >= history.length) {
        if (history.end) this.pause();
        else this.follow();
      }
    }
    return history.time !== before;
  }

  /**
   * Goes to the next scan before or after this one at which something was decided: not placed, searched, recognised.
   * @param {1 | -1} direction
   */
  seekEvent(direction) {
    const { frames, time, length } = this.history;
    for (let n = time - 1 + direction; n >= 0 && n < length; n += direction) {
      const f = frames[n];
      if (!f.pose || f.searched || f.recognised !== undefined) {
        this.playing = false;
        this.goTo(n + 1);
        return true;
      }
    }
    return false;
  }
}
