#!/usr/bin/env python3
"""Cuts the sample log out of the data package of the Robotics Toolbox for Python.

    pip download rtb-data==2.0.0 --no-deps --no-binary :all:
    samples/cut_killian.py rtb_data-2.0.0.tar.gz samples/killian.log.gz

In the package, killian.g2o.zip holds a pose graph with the laser line of every vertex. The first SCANS of
these lines are written as they stand, a CARMEN log. Same bytes every time: no name and no date in the gzip.
Only Python's own library is needed.
"""
import gzip
import io
import sys
import tarfile
import zipfile

FIRST = 0
SCANS = 300
MEMBER = "rtbdata/data/killian.g2o.zip"
HEAD = """\
# MIT Killian Court, recorded by Mike Bosse and John Leonard: scans {first} to {last} of killian.g2o.zip
# from the Python package rtb-data 2.0.0 (MIT licence, see samples/README.md).
# The pose fields hold the poses of the published pose graph, not raw odometry.
"""


def graph_lines(package):
    """The lines of killian.g2o inside the source package."""
    with tarfile.open(package) as tar:
        name = next(n for n in tar.getnames() if n.endswith(MEMBER))
        packed = io.BytesIO(tar.extractfile(name).read())
    with zipfile.ZipFile(packed) as archive:
        return archive.read("killian.g2o").decode("ascii", errors="replace").splitlines()


def main():
    package, out = sys.argv[1:]
    scans = [line.strip() for line in graph_lines(package) if line.startswith("ROBOTLASER1 ")]
    cut = scans[FIRST:FIRST + SCANS]
    text = HEAD.format(first=FIRST, last=FIRST + SCANS - 1) + "".join(line + "\n" for line in cut)
    with open(out, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as packed:
        packed.write(text.encode("ascii"))


if __name__ == "__main__":
    main()
