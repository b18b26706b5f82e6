#!/usr/bin/env python3
"""Run the benchmarks and print their tables as Markdown.

    measure.py --tools DIR --data DIR [--work DIR] [--only raw,keyframes,..] [--write]

--tools  the scoring scripts (relations_score.py, map_score.py, keyframe_score.py, extraction_score.py)
--data   the public data sets that docs/benchmarks.md names
--work   where results go [default: target/measure]
--only   some of: sample, raw, reference, keyframes, extraction, small, simulator, locate, join [default: all]
--write  put the tables where docs/benchmarks.md and README.md have a place for them: between
         `<!-- NAME -->` and `<!-- /NAME -->`

The program is built first (release). Everything runs one after the other, so that times mean something. Needs numpy;
the small scanners' bags need `rosbags` (both from PyPI) and are left out, and said, without.
"""
import argparse
import csv
import gzip
import json
import os
import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
DONE_WITH_LOSS = 3
KEYFRAME_LOGS = ("intel", "aces", "csail", "fhw", "edmonton", "infinite-corridor", "orebro")
BUDGETS = (10, 20, 50)
# Step from scan to scan that is wrong, as in the brute-force figures of the data's notes.
WRONG_STEP_M, WRONG_STEP_DEG = 0.25, 3.0

# name, (intel m, deg), (aces m, deg), odometry, source
PUBLISHED_RELATIONS = (
    ("Cartographer (Hess et al. 2016)", "0.0229 / 0.453", "0.0375 / 0.373", "yes"),
    ("Graph mapping (Kümmerle et al. 2009)", "0.031 / 1.3", "0.044 / 0.4", "yes"),
    ("RBPF (Kümmerle et al. 2009)", "0.070 / 3.0", "0.060 / 1.2", "yes"),
    ("LaMa graph SLAM, measured with the same scripts", "0.019 / 0.26", "2.27 / 6.3", "no"),
)
# name, then rmse / f at 10, 20, 50 vertices: real scans
PUBLISHED_EXTRACTION = (
    ("PLE+ (2.3 s a scan)", ("0.0813 / 0.774", "0.0635 / 0.889", "0.0276 / 0.961")),
    ("PLE (1.4 s a scan)", ("0.1112 / 0.774", "0.0864 / 0.889", "0.0358 / 0.961")),
    ("Visvalingam", ("0.273 / 0.553", "0.174 / 0.683", "0.093 / 0.820")),
    ("Split and merge", ("1.78 / 0.879", "1.32 / 0.900", "0.594 / 0.937")),
)


# ------------------------------------------------------------------ running
class Bench:
    """Where everything is, and how to run it."""

    def __init__(self, args):
        self.tools, self.data = args.tools.resolve(), args.data.resolve()
        self.target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
        self.work = (args.work or self.target / "measure").resolve()
        self.work.mkdir(parents=True, exist_ok=True)
        sys.path.insert(0, str(self.tools))

    def compile(self):
        run(["cargo", "build", "--release", "--locked", "--workspace", "--bins", "--examples"], cwd=ROOT)

    @property
    def program(self):
        return self.target / "release" / "polymapper"

    def example(self, name):
        return self.target / "release" / "examples" / name

    def build(self, log, name):
        """`polymapper build`; the folder with its files and the report."""
        out = self.work / name
        tell(f"build {name}")
        run([self.program, "build", log, "-o", out], quiet=True)
        return out, json.loads((out / "report.json").read_text())

    def icp(self, log, name):
        """The baseline's trajectory, and its processor time a scan, ms."""
        out = self.work / f"{name}-icp.csv"
        tell(f"plain ICP {name}")
        cpu_s = run([self.example("plain_icp"), log, out], quiet=True)
        with open(out, newline="") as f:
            return out, 1e3 * cpu_s / max(1, sum(1 for _ in csv.DictReader(f)))

    def score(self, script, *args):
        """The figures of a scoring script."""
        out = self.work / "score.json"
        run([sys.executable, self.tools / script, *args, "--json", out], quiet=True)
        return json.loads(out.read_text())


def run(command, cwd=None, quiet=False):
    """Runs to the end; its processor time, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], cwd=cwd, text=True,
                          stdout=subprocess.PIPE if quiet else None, stderr=subprocess.PIPE if quiet else None)
    if done.returncode not in (0, DONE_WITH_LOSS):
        raise SystemExit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stderr or ''}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def tell(text):
    print(f"   {text}", file=sys.stderr, flush=True)


def table(head, rows):
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in row) + " |" for row in lines)


def percent(ratio, digits=1):
    return f"{100 * ratio:.{digits}f} %"


def cpu_ms(report):
    return 1e3 * sum(s["cpu_s"] or 0.0 for s in report["stages"]) / max(1, report["scans"]["read"])


def megabytes(report):
    return f"{(report['peak_memory_bytes'] or 0) / 1e6:.0f} MB"


def placed(report):
    return f"{report['scans']['placed']} / {report['scans']['read']}"


def relation_cell(figures, part):
    t, r = figures[part]["trans_m"], figures[part]["rot_deg"]
    return f"{t['mean']:.4f} / {r['mean']:.3f}" if t else "–"


MAP_HEAD = ("log", "scans placed", "vertices", "length m", "near 5 cm", "duplicate", "seen through", "CPU ms a scan", "peak memory")


def map_row(bench, name, log, out, report):
    s = bench.score("map_score.py", log, out / "trajectory.csv", out / "map.json")
    return (name, placed(report), s["vertices"], f"{s['length_m']:.0f}", percent(s["near_5cm"]), percent(s["duplicate"]),
            percent(s["seen_through"]), f"{cpu_ms(report):.2f}", megabytes(report))


# ----------------------------------------------------------------- sections
def sample(bench):
    """The sample in the repository: the figures of README's caption."""
    log = ROOT / "samples" / "killian.log.gz"
    out, report = bench.build(log, "killian")
    caption = (f"{placed(report)} scans placed without odometry · {report['map']['length_m']:.0f} m of wall in "
               f"{report['map']['vertices']} vertices · {sum(s['wall_s'] for s in report['stages']):.1f} s")
    return {
        "caption": caption,
        "sample": table(MAP_HEAD, [map_row(bench, "Killian Court, first 300 scans", log, out, report)]),
    }


def raw(bench):
    relations, maps, summary = [], [], []
    for name in ("intel", "aces"):
        log, truth = bench.data / f"raw/{name}.clf.gz", bench.data / f"raw/{name}.relations"
        out, report = bench.build(log, f"raw-{name}")
        trajectory, icp_ms = bench.icp(log, f"raw-{name}")
        for system, path, ms in (("polymapper", out / "trajectory.csv", cpu_ms(report)), ("plain ICP", trajectory, icp_ms)):
            figures = bench.score("relations_score.py", log, truth, path)
            relations.append((name, system, *(relation_cell(figures, part) for part in ("all", "short", "loop")),
                              f"{figures['used']} / {figures['relations']}", f"{ms:.2f}"))
            if system == "polymapper":
                summary.append(relation_cell(figures, "all"))
        maps.append(map_row(bench, name, log, out, report))
    log = bench.data / "raw/mit-csail.clf.gz"
    maps.append(map_row(bench, "mit-csail", log, *bench.build(log, "raw-mit-csail")))
    beside = [("**polymapper**", *(f"**{cell}**" for cell in summary), "no"), *PUBLISHED_RELATIONS]
    return {
        "relations": table(("log", "system", "all, m / °", "short", "loops", "relations used", "CPU ms a scan"), relations),
        "published": table(("system", "intel, m / °", "aces, m / °", "odometry"), beside),
        "maps": table(MAP_HEAD, maps),
    }


def reference(bench):
    """mit-csail against a published trajectory, itself the result of a SLAM system."""
    log = bench.data / "raw/mit-csail.clf.gz"
    ref = read_poses(bench.data / "reference/mit-csail.flirtlib.csv")
    out, report = bench.build(log, "raw-mit-csail")
    trajectory, icp_ms = bench.icp(log, "raw-mit-csail")
    rows = [(system, *against(ref, read_poses(path)), f"{ms:.2f}")
            for system, path, ms in (("polymapper", out / "trajectory.csv", cpu_ms(report)), ("plain ICP", trajectory, icp_ms))]
    head = ("system", "scans compared", f"steps off by > {WRONG_STEP_M} m or {WRONG_STEP_DEG:.0f}°", "steps, mean m / °",
            "loops, mean m / °", "CPU ms a scan")
    return {"reference": table(head, rows)}


def read_poses(path):
    """scan -> x, y, theta, of a trajectory.csv or a reference."""
    with open(path, newline="") as f:
        return {int(r.get("scan", r.get("scan_index"))): [float(r.get(a) or r.get(b)) for a, b in
                                                           (("x_m", "x"), ("y_m", "y"), ("theta_rad", "theta"))]
                for r in csv.DictReader(f) if r.get("outcome") != "not_placed"}


def against(ref, est):
    import keyframe_score

    scans = sorted(ref)
    known = [k for k, scan in enumerate(scans) if scan in est]
    ref_poses, est_poses = np.array([ref[s] for s in scans]), np.array([est[scans[k]] for k in known])
    steps = np.arange(len(known) - 1)
    m, deg = keyframe_score.relation_errors(ref_poses[known], est_poses, steps, steps + 1)
    off = int(((m > WRONG_STEP_M) | (deg > WRONG_STEP_DEG)).sum())
    figures = keyframe_score.evaluate(ref_poses, np.array(known), est_poses)
    loop = f"{figures['loop_trans_m']['mean']:.3f} / {figures['loop_rot_deg']['mean']:.2f}" if figures["loop_trans_m"] else "–"
    return f"{len(known)} / {len(scans)}", off, f"{m.mean():.4f} / {deg.mean():.3f}", loop


def keyframes(bench):
    rows, verdicts = [], []
    for name in KEYFRAME_LOGS:
        log = bench.data / f"keyframes/{name}.log.gz"
        out, report = bench.build(log, f"keyframes-{name}")
        trajectory, _ = bench.icp(log, f"keyframes-{name}")
        ours, icp = (next(iter(bench.score("keyframe_score.py", log, path).values())) for path in (out / "trajectory.csv", trajectory))
        verdicts.append(ours["verdict"])
        rows.append((name, report["scans"]["read"], report["scans"]["not_placed"], *keyframe_cells(ours), f"{cpu_ms(report):.2f}",
                     *keyframe_cells(icp)))
    head = ("log", "scans", "not placed", "broken", "loops, mean m", "verdict", "CPU ms a scan", "ICP: broken", "loops, mean m", "verdict")
    tell(f"{verdicts.count('ok')} of {len(verdicts)} ok")
    return {"keyframes": table(head, rows)}


def keyframe_cells(figures):
    loop = figures.get("loop_trans_m")
    broken = figures.get("broken")
    return ("–" if broken is None else percent(broken), f"{loop['mean']:.2f}" if loop else "–", figures["verdict"])


def extraction(bench):
    scans = bench.data / "extraction/ple-scans.jsonl.gz"
    log = bench.work / "ple.log"
    run([sys.executable, bench.tools / "extraction_score.py", "make-log", scans, log], quiet=True)
    rows, cells = [], []
    for budget in (*BUDGETS, None):
        out = bench.work / f"ple-{budget}.jsonl"
        tell(f"extract, {budget or 'no'} budget")
        options = ["--vertices", budget] if budget else []
        cpu_s = run([bench.program, "extract", log, "-o", out, *options], quiet=True)
        figures_ = extraction_figures(bench, scans, out)
        for kind, f in figures_.items():
            rows.append((budget or "none", kind, f"{f['vertices']:.1f}", f"{f['rmse_m']:.4f}", f"{f['f']:.3f}", f"{f['capped_m']:.4f}",
                         f"{f['blocked']:.3f}", f"{1e3 * cpu_s / sum(g['scans'] for g in figures_.values()):.2f}"))
        if budget:
            cells.append(f"**{figures_['real']['rmse_m']:.4f} / {figures_['real']['f']:.3f}**")
    beside = [("**polymapper**", *cells), *((name, *values) for name, values in PUBLISHED_EXTRACTION)]
    return {
        "extraction": table(("vertices allowed", "scans", "vertices", "RMSE m", "f", "capped m", "blocked", "CPU ms a scan"), rows),
        "extraction-published": table(("real scans, RMSE m / f", *(f"{b} vertices" for b in BUDGETS)), beside),
    }


def extraction_figures(bench, scans, polylines):
    out = bench.work / "score.json"
    run([sys.executable, bench.tools / "extraction_score.py", "score", scans, polylines, "--json", out], quiet=True)
    return json.loads(out.read_text())


def small(bench):
    logs = [("SICK, 56 m loop", sick_loop(bench)),
            ("wheelchair, SICK 0.5°", bench.data / "small-scanners/wheelchair-sm3.log.gz"),
            ("ROBOTLASER1, interlaced", bench.data / "small-scanners/robotlaser1-sample.log.gz")]
    for name, bag in (("Hokuyo URG in the hand", "small-scanners/urg-handheld-db3"),
                      ("standing Hokuyo, people walking", "moving/people-walking.bag")):
        log = bench.work / f"{Path(bag).stem}.log"
        done = subprocess.run([sys.executable, ROOT / "docs/bag_to_carmen.py", bench.data / bag, log], capture_output=True, text=True)
        if done.returncode:
            tell(f"{name} left out: {done.stderr.strip().splitlines()[-1]}")
        else:
            logs.append((name, log))
    for name, file in (("low-cost scanner, all round", "lowcost-360-a.csv.gz"),
                       ("Hokuyo URG on a robot, half of the beams without return", "urg-encoders-exp1.dat.gz"),
                       ("RPLIDAR A1, short line", "rplidar-a1-24jul.log.gz")):
        log = bench.work / f"{file.split('.')[0]}.log"
        run([bench.program, "convert", bench.data / "small-scanners" / file, log], quiet=True)
        logs.append((name, log))
    return {"small": table(MAP_HEAD, [map_row(bench, name, log, *bench.build(log, f"small-{log.name.split('.')[0]}")) for name, log in logs])}


def sick_loop(bench):
    """`Laser n r..` lines as FLASER, their odometry left behind."""
    log = bench.work / "sick-loop5.log"
    with gzip.open(bench.data / "small-scanners/sick-loop5.log.gz", "rt") as f, open(log, "w") as out:
        for k, words in enumerate(line.split() for line in f if line.startswith("Laser")):
            out.write(f"FLASER {' '.join(words[1:2 + int(words[1])])} 0 0 0 0 0 0 {k}.0 sick {k}.0\n")
    return log


def simulator(bench):
    rows = []
    for motion, people in (("full", 0), ("full", 3), ("keyframes", 0)):
        rows += simulated(bench, "all", "all", motion, people)
    head = ("plan", "scanner", "motion", "people", "not placed", "F at 5 cm", "F at 2 cm", "doubled %", "people %", "poses off, mean m", "max m")
    return {"simulator": table(head, rows)}


def simulated(bench, plans, scanners, motion, people):
    tell(f"simulator, {motion}, {people} people")
    done = subprocess.run([bench.example("score_simulated"), plans, scanners, motion, str(people), "1"],
                          capture_output=True, text=True, check=True)
    rows = []
    for line in done.stdout.splitlines()[1:]:
        w = line.split()
        rows.append((w[0], w[1], w[2], w[3], f"{w[6]} / {w[5]}", w[9], w[10], w[11], w[12], w[13], w[14]))
    return rows


# Log, every how many scans one is held back. A pose is right within 0.3 m and 5 degrees.
HELD_BACK = (("raw/intel.clf.gz", 50), ("raw/aces.clf.gz", 50), ("raw/mit-csail.clf.gz", 10),
             ("keyframes/intel.log.gz", 10), ("keyframes/aces.log.gz", 10), ("keyframes/csail.log.gz", 10))
RIGHT_M, RIGHT_DEG = 0.3, 5.0


def locate(bench):
    """Scans that a map was built without, found in it one by one."""
    rows = []
    for name, every in HELD_BACK:
        log = bench.data / name
        stem = name.split(".")[0].replace("/", "-")
        rest, held = hold_back(bench, log, stem, every)
        out, _ = bench.build(rest, f"locate-{stem}")
        found = bench.work / f"locate-{stem}.csv"
        tell(f"locate {stem}")
        cpu_s = run([bench.program, "locate", "--map", out / "map.json", held, "--alone", "--out", found], quiet=True)
        rows.append((name.split(".")[0], f"every {every}th", *locate_cells(log, out, found, every, cpu_s)))
    head = ("log", "held back", "scans", "right and sure", "wrong and sure", "best pose right", "ambiguous", "not found", "CPU ms a scan")
    return {"locate": table(head, rows)}


def laser_lines(log):
    opener = gzip.open if log.suffix == ".gz" else open
    with opener(log, "rt", errors="replace") as f:
        return [line for line in f if line.startswith("FLASER")]


def hold_back(bench, log, stem, every):
    """The log without every N-th scan, and these."""
    rest, held = bench.work / f"{stem}-rest.log", bench.work / f"{stem}-held.log"
    with open(rest, "w") as r, open(held, "w") as h:
        for k, line in enumerate(laser_lines(log)):
            (h if k % every == every - 1 else r).write(line)
    return rest, held


def locate_cells(log, out, found, every, cpu_s):
    poses = read_poses(out / "trajectory.csv")
    steps = logged_steps(log) if "keyframes" in str(log) else None
    n = right = wrong = best = 0
    outcomes = {"located": 0, "ambiguous": 0, "not_found": 0}
    with open(found, newline="") as f:
        located = list(csv.DictReader(f))
    for r in located:
        truth = held_pose(int(r["scan"]), every, poses, steps)
        if truth is None:
            continue
        n += 1
        outcomes[r["outcome"]] += 1
        ok = r["x_m"] != "" and is_right(truth, [float(r[c]) for c in ("x_m", "y_m", "theta_rad")])
        best += ok
        right += ok and r["outcome"] == "located"
        wrong += not ok and r["outcome"] == "located"
    return (n, percent(right / n), wrong, percent(best / n), outcomes["ambiguous"], outcomes["not_found"],
            f"{1e3 * cpu_s / len(located):.1f}")


def logged_steps(log):
    """Keyframe logs: the published poses, as steps from a scan to its neighbours."""
    words = [line.split() for line in laser_lines(log)]
    return [[float(v) for v in w[2 + int(w[1]):5 + int(w[1])]] for w in words]


def held_pose(k, every, poses, logged):
    """Where a scan that was held back is in the map, from the scans before and after; None where they disagree."""
    before, after = poses.get((every - 1) * (k + 1) - 1), poses.get((every - 1) * (k + 1))
    if before is None or after is None:
        return None
    scan = every * (k + 1) - 1
    if logged:
        before = compose(before, compose(inverse(logged[scan - 1]), logged[scan]))
        after = compose(after, compose(inverse(logged[scan + 1]), logged[scan]))
    turn = wrapped(after[2] - before[2])
    # Full rate: between two scans that may themselves be a step apart. Keyframes: both say where this one is.
    most_m, most_deg = (0.2, 6.0) if logged else (2 * RIGHT_M, 2 * RIGHT_DEG)
    if np.hypot(after[0] - before[0], after[1] - before[1]) > most_m or abs(turn) > np.radians(most_deg):
        return None
    return [(before[0] + after[0]) / 2, (before[1] + after[1]) / 2, before[2] + turn / 2]


def compose(a, b):
    c, s = np.cos(a[2]), np.sin(a[2])
    return [a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]]


def inverse(a):
    c, s = np.cos(a[2]), np.sin(a[2])
    return [-c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]]


def wrapped(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


def is_right(truth, pose):
    return bool(np.hypot(truth[0] - pose[0], truth[1] - pose[1]) <= RIGHT_M
                and abs(wrapped(truth[2] - pose[2])) <= np.radians(RIGHT_DEG))


def join(bench):
    """The halves of a log built apart and merged, against the whole."""
    log, truth = bench.data / "raw/intel.clf.gz", bench.data / "raw/intel.relations"
    lines = laser_lines(log)
    halves = []
    for name, part in (("first", lines[:len(lines) // 2]), ("second", lines[len(lines) // 2:])):
        half = bench.work / f"intel-{name}.log"
        half.write_text("".join(part))
        halves.append(bench.build(half, f"intel-{name}")[0])
    merged = bench.work / "intel-merged"
    run([bench.program, "merge", *halves, "--out", merged], quiet=True)
    whole, _ = bench.build(log, "raw-intel")
    rows = []
    for name, out in (("whole", whole), ("halves merged", merged)):
        figures = bench.score("relations_score.py", log, truth, out / "trajectory.csv")
        s = bench.score("map_score.py", log, out / "trajectory.csv", out / "map.json")
        rows.append((name, relation_cell(figures, "all"), relation_cell(figures, "loop"), s["vertices"], f"{s['length_m']:.0f}",
                     percent(s["near_5cm"]), percent(s["duplicate"]), percent(s["seen_through"])))
    head = ("intel", "all, m / °", "loops", "vertices", "length m", "near 5 cm", "duplicate", "seen through")
    return {"join": table(head, rows)}


SECTIONS = {f.__name__: f for f in (sample, raw, reference, keyframes, extraction, small, simulator, locate, join)}


# ------------------------------------------------------------------ writing
def write(tables):
    """Puts tables where the documents have a place for them."""
    for path in (ROOT / "docs/benchmarks.md", ROOT / "README.md"):
        text = old = path.read_text()
        for name, body in tables.items():
            place = re.compile(rf"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
            text = place.sub(lambda m, body=body: f"{m[1]}\n{body.strip()}\n\n{m[2]}", text)
        if text != old:
            path.write_text(text)
            tell(f"{path.relative_to(ROOT)} written")


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("--tools", type=Path, required=True)
    p.add_argument("--data", type=Path, required=True)
    p.add_argument("--work", type=Path)
    p.add_argument("--only", default=",".join(SECTIONS))
    p.add_argument("--write", action="store_true")
    a = p.parse_args()
    wanted = a.only.split(",")
    if unknown := [name for name in wanted if name not in SECTIONS]:
        p.error(f"no section {', '.join(unknown)}; there are {', '.join(SECTIONS)}")
    bench = Bench(a)
    bench.compile()
    for name in wanted:
        tables = SECTIONS[name](bench)
        for part, body in tables.items():
            print(f"## {part}\n\n{body}\n", flush=True)
        if a.write:
            write(tables)


if __name__ == "__main__":
    main()
