#!/usr/bin/env python3
"""Write the laser scans of a ROS bag as a CARMEN log (ROBOTLASER1, geometry in the line).

    bag_to_carmen.py BAG OUT.log [--topic NAME]

BAG is a ROS 1 bag, or the folder of a ROS 2 recording (sqlite3 or mcap). Needs the package `rosbags` from PyPI.
Ranges that are no numbers pass as they are; pose fields are zero: a bag's odometry is not looked at.
"""
import argparse
from pathlib import Path

from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

LASER_SCAN = "sensor_msgs/msg/LaserScan"
FRONT_LASER = 0


def line(scan, stamp_s):
    count = len(scan.ranges)
    ranges = " ".join(f"{r:.4f}" for r in scan.ranges)
    width = (count - 1) * scan.angle_increment
    return (f"ROBOTLASER1 {FRONT_LASER} {scan.angle_min:.9f} {width:.9f} {scan.angle_increment:.12f} {scan.range_max:.3f} 0.01 0 "
            f"{count} {ranges} 0 0 0 0 0 0 0 0 0 0 0 0 {stamp_s:.6f} bag {stamp_s:.6f}\n")


def main():
    p = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    p.add_argument("bag", type=Path)
    p.add_argument("out")
    p.add_argument("--topic", help="where the bag has scans of several lasers [default: the first]")
    a = p.parse_args()
    written = 0
    with AnyReader([a.bag], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as bag, open(a.out, "w") as out:
        lasers = [c for c in bag.connections if c.msgtype == LASER_SCAN]
        topic = a.topic or (lasers[0].topic if lasers else None)
        for connection, _, raw in bag.messages(connections=[c for c in lasers if c.topic == topic]):
            scan = bag.deserialize(raw, connection.msgtype)
            out.write(line(scan, scan.header.stamp.sec + scan.header.stamp.nanosec * 1e-9))
            written += 1
    if not written:
        raise SystemExit(f"{a.bag} has no {LASER_SCAN}" + (f" on {a.topic}" if a.topic else ""))
    print(f"{written} scans of {topic}")


if __name__ == "__main__":
    main()
