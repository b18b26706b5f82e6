#!/usr/bin/env python3
"""Who is right where a keyframe log's own poses and ours disagree: flirtlib's poses of the same scans as a witness.

    csail_witness.py --tools DIR --data DIR TRAJECTORY.csv

The keyframe log `csail` is a part of the raw log `mit-csail`, scan for scan, and of that log flirtlib has published poses. Prints how
many relations of keyframe_score.py are broken by each pair of the three. Where flirtlib left a scan out, its pose is taken between
those of its neighbours, at most two scans away. Needs numpy.
"""
import argparse
import gzip
import sys
from pathlib import Path

import numpy as np

NO_RETURN_M = 20.0
FARTHEST_NEIGHBOUR = 2


def ranges_of(path):
    """Ranges of every FLASER line, metres, cut at NO_RETURN_M."""
    with gzip.open(path, "rt", errors="replace") as lines:
        tokens = (line.split() for line in lines if line.startswith("FLASER"))
        return np.minimum([[float(v) for v in t[2:2 + int(t[1])]] for t in tokens], NO_RETURN_M)


def witness_pose(poses, scan, wrap):
    """The witness's pose of a scan of the raw log, NaN where it has none."""
    if scan in poses:
        return poses[scan]
    steps = range(1, FARTHEST_NEIGHBOUR + 1)
    before = next((scan - k for k in steps if scan - k in poses), None)
    behind = next((scan + k for k in steps if scan + k in poses), None)
    if before is None or behind is None:
        return np.full(3, np.nan)
    a, b = poses[before], poses[behind]
    share = (scan - before) / (behind - before)
    return np.append(a[:2] + share * (b[:2] - a[:2]), a[2] + share * wrap(b[2] - a[2]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--tools", type=Path, required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("trajectory")
    args = parser.parse_args()
    sys.path.insert(0, str(args.tools))
    import keyframe_score as score

    log = args.data / "keyframes" / "csail.log.gz"
    raw = ranges_of(args.data / "raw" / "mit-csail.clf.gz")
    published = np.loadtxt(args.data / "reference" / "mit-csail.flirtlib.csv", delimiter=",", skiprows=1)
    published = {int(row[0]): row[1:4] for row in published}
    own, stamps = score.read_carmen(log)
    keys, ours = score.read_estimate(args.trajectory)
    index, ours = score.match(keys, ours, stamps, "index")
    off_m = [np.abs(raw - scan).mean(axis=1) for scan in ranges_of(log)]
    if max(off.min() for off in off_m) > 0.0:
        sys.exit("not the same scans")
    witness = np.array([witness_pose(published, int(off.argmin()), score.wrap) for off in off_m])[index]
    own = own[index]

    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(own[:, :2], axis=0).T))])
    i, j = score.local_relations(way)
    seen = np.isfinite(witness[i]).all(1) & np.isfinite(witness[j]).all(1)
    print(f"{len(i)} relations, {seen.sum()} of them with a witness")
    i, j = i[seen], j[seen]
    for name, a, b in (("log and ours", own, ours), ("log and witness", own, witness), ("ours and witness", ours, witness)):
        off_m, off_deg = score.relation_errors(a, b, i, j)
        broken = (off_m > score.BROKEN_M) | (off_deg > score.BROKEN_DEG)
        pairs = ", ".join(f"{index[p]}-{index[q]}" for p, q in zip(i[broken], j[broken]))
        print(f"{name}: {broken.sum()} broken, at most {off_m.max():.2f} m and {off_deg.max():.1f} deg  {pairs}")


if __name__ == "__main__":
    main()
