// How much of the processors other programs had while something was measured: what is slow then may be their doing.

import { existsSync, readdirSync, readFileSync } from "node:fs";
import { cpus } from "node:os";

/** The system counts time in these, seconds. */
const TICK_S = 0.01;

export class Processors {
  constructor() {
    this.known = existsSync("/proc/stat");
    this.before = this.now();
  }

  /** Share of all processors' time that others had since the last call, 0..1; 0 where the system does not tell. */
  othersShare() {
    const [from, to] = [this.before, this.now()];
    this.before = to;
    const most = ((to.at - from.at) / 1000) * cpus().length;
    return Math.max(0, (to.busy_s - from.busy_s - (to.ours_s - from.ours_s)) / most);
  }

  now() {
    const at = performance.now();
    return this.known ? { at, busy_s: busy_s(), ours_s: ours_s() } : { at, busy_s: 0, ours_s: 0 };
  }
}

/** Time that all programs had, and that another machine on the same hardware took, seconds. */
function busy_s() {
  const [user, nice, system, , , irq, softirq, steal] = (readFileSync("/proc/stat", "utf8").match(/\d+/g) ?? []).map(Number);
  return (user + nice + system + irq + softirq + steal) * TICK_S;
}

/** Time that this program and all that it started had, seconds. */
function ours_s() {
  /** @type {Map<number, {parent: number, used_s: number}>} */
  const all = new Map();
  for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
    const fields = statOf(pid);
    if (fields) all.set(Number(pid), { parent: Number(fields[1]), used_s: usedBy(fields) });
  }
  const isOurs = (/** @type {number} */ pid) => {
    for (let at = pid; at > 0; at = all.get(at)?.parent ?? 0) if (at === process.pid) return true;
    return false;
  };
  return [...all].reduce((sum, [pid, { used_s }]) => (isOurs(pid) ? sum + used_s : sum), 0);
}

/**
 * Time that a program had, and those that it started and that have ended, seconds.
 * @param {string[]} fields Of its `stat`, after the name.
 */
function usedBy(fields) {
  const [user, system, usersOfEnded, systemsOfEnded] = fields.slice(11, 15).map(Number);
  return (user + system + usersOfEnded + systemsOfEnded) * TICK_S;
}

/**
 * Fields after the name of a program.
 * @param {string} pid
 */
function statOf(pid) {
  try {
    return readFileSync(`/proc/${pid}/stat`, "utf8").split(") ").at(-1)?.split(" ");
  } catch {
    // It has ended.
    return undefined;
  }
}
