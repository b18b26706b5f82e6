"""Reads what `polymapper export` wrote with other people's programs: check.py FORMAT FOLDER.

FOLDER holds map.json, trajectory.csv and the export under the name `map`. Nothing here looks at polymapper's code: what is
expected comes from map.json and trajectory.csv, and from the rules of each format. Ends with an error if something is not so.
"""

import csv
import json
import math
import struct
import subprocess
import sys
from pathlib import Path

FOLDER = Path(sys.argv[2])
MAP = json.loads((FOLDER / "map.json").read_text())
WALLS = {p["id"]: p["vertices"] for p in MAP["polylines"]}
BOXES = [(b["min"], b["max"]) for b in MAP["eraser_boxes"]]


def placed():
    with open(FOLDER / "trajectory.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["outcome"] == "placed"]
    way = [tuple(float(row[k]) for k in ("stamp_s", "x_m", "y_m", "theta_rad")) for row in rows]
    if all(a[0] < b[0] for a, b in zip(way, way[1:])):
        return way
    return [(0.1 * int(row["scan"]), *pose[1:]) for row, pose in zip(rows, way)]


def near(a, b, tolerance=1e-4):
    assert len(a) == len(b), (a, b)
    assert all(abs(x - y) <= tolerance for x, y in zip(a, b)), (a, b)


def same_lines(found, tolerance=1e-4):
    """`found`: id to points. The same ids, the same vertices."""
    assert found.keys() == WALLS.keys(), found.keys() ^ WALLS.keys()
    for name, points in found.items():
        assert len(points) == len(WALLS[name]), name
        for a, b in zip(points, WALLS[name]):
            near(a[:2], b, tolerance)


def dxf():
    import ezdxf

    drawing = ezdxf.readfile(FOLDER / "map.dxf")
    audit = drawing.audit()
    assert not audit.errors, audit.errors
    assert not audit.fixes, audit.fixes
    assert drawing.dxfversion == "AC1009"
    assert drawing.units == ezdxf.units.M
    layers = {layer.dxf.name for layer in drawing.layers}
    assert {"WALLS", "ERASER_BOXES", "WAY"} <= layers, layers
    walls = drawing.modelspace().query('POLYLINE[layer=="WALLS"]')
    same_lines({int(w.get_xdata("POLYMAPPER")[0].value[3:]): [tuple(p) for p in w.points()] for w in walls})
    assert len(drawing.modelspace().query('POLYLINE[layer=="WAY"]')) >= 1
    boxes = drawing.modelspace().query('POLYLINE[layer=="ERASER_BOXES"]')
    assert len(boxes) == len(BOXES) and all(b.is_closed for b in boxes)


def line_of_wkb(wkb):
    """The points of a line in well-known binary."""
    order, kind, count = struct.unpack_from("<BII", wkb)
    assert (order, kind) == (1, 2), (order, kind)
    return [struct.unpack_from("<dd", wkb, 9 + 16 * k) for k in range(count)]


def gis(file, layer):
    """Layer of a file as GDAL reads it: its metadata, {id: points}."""
    import pyogrio

    info, fids, geometries, columns = pyogrio.raw.read(file, layer=layer, return_fids=True)
    names = list(info["fields"])
    ids = columns[names.index("id")] if "id" in names else fids
    layers = columns[names.index("layer")] if "layer" in names else ["walls"] * len(fids)
    rows = zip(ids, layers, geometries)
    return info, {int(k): line_of_wkb(g) for k, of, g in rows if of == "walls"}


def gpkg():
    import pyogrio

    info, walls = gis(FOLDER / "map.gpkg", "walls")
    assert info["geometry_type"] == "LineString", info
    assert "Undefined Cartesian SRS" in info["crs"] and "degree" not in info["crs"].lower(), info["crs"]
    same_lines(walls)
    kinds = dict(pyogrio.list_layers(FOLDER / "map.gpkg").tolist())
    assert kinds.pop("way") == "LineString", kinds
    assert kinds == {"walls": "LineString", **({"eraser_boxes": "Polygon"} if BOXES else {})}, kinds
    if BOXES:
        _, bounds = pyogrio.read_bounds(FOLDER / "map.gpkg", layer="eraser_boxes")
        near([*bounds[:, 0]], [*BOXES[0][0], *BOXES[0][1]])


def json_fg():
    import pyogrio

    file = FOLDER / "map.fg.json"
    assert ["walls", "LineString"] in pyogrio.list_layers(file).tolist(), pyogrio.list_layers(file)
    info, walls = gis(file, "walls")
    # No system on Earth: metres of an engineering drawing. Plain GeoJSON would be EPSG:4326 here.
    assert info["crs"] is None, info["crs"]
    same_lines(walls)


def georef():
    """json-fg, gpkg and geojson of a map at 48° N, 7.8° E with x to the east."""
    lat, lon = 48.0, 7.8
    info, walls = gis(FOLDER / "map.geojson", None)
    assert info["crs"] == "EPSG:4326", info["crs"]
    # Radii of curvature of WGS 84 in the meridian and across it.
    a, e2 = 6378137.0, 0.00669437999014
    w = math.sqrt(1 - e2 * math.sin(math.radians(lat)) ** 2)
    across, along = a / w, a * (1 - e2) / w**3
    for name, points in walls.items():
        for (x, y), (east, north) in zip(points, WALLS.get(name, [])):
            near(
                (math.radians(x - lon) * across * math.cos(math.radians(lat)), math.radians(y - lat) * along),
                (east, north),
                0.01 + 1e-6 * (east**2 + north**2),
            )
    for file in ("map.gpkg", "map.fg.json"):
        info, grid = gis(FOLDER / file, "walls")
        assert info["crs"] == "EPSG:32632", info["crs"]
        # 1.2° west of the middle of the zone, at 48° N: the scale is 0.9996 + 0.0001.
        for name, points in grid.items():
            for (p, q), (u, v) in zip(zip(points, points[1:]), zip(WALLS[name], WALLS[name][1:])):
                assert abs(math.dist(p, q) / math.dist(u, v) - 0.9997) < 1e-4 + 2e-4 / math.dist(u, v)


def mcap():
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    way = placed()
    messages = {}
    with open(FOLDER / "map.mcap", "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        for _, channel, record, message in reader.iter_decoded_messages():
            messages.setdefault(channel.topic, []).append((record.log_time, message))
    assert set(messages) == {"/scan", "/tf", "/path", "/map", "/map_lines"}, set(messages)
    assert len(messages["/scan"]) == len(messages["/tf"]) == len(way)
    times = [time for time, _ in messages["/scan"]]
    assert times == sorted(times)
    for (time, tf), (stamp, x, y, theta) in zip(messages["/tf"], way):
        (transform,) = tf.transforms
        assert (transform.header.frame_id, transform.child_frame_id) == ("map", "laser")
        assert abs(time * 1e-9 - stamp) < 1e-5
        t, r = transform.transform.translation, transform.transform.rotation
        near((t.x, t.y, t.z, r.x, r.y), (x, y, 0, 0, 0))
        assert abs(math.remainder(2 * math.atan2(r.z, r.w) - theta, math.tau)) < 1e-5
    scan = messages["/scan"][0][1]
    assert len(scan.ranges) > 100 and scan.header.frame_id == "laser"
    assert abs(scan.angle_min + scan.angle_increment * (len(scan.ranges) - 1) - scan.angle_max) < 1e-4
    (_, path), = messages["/path"]
    assert len(path.poses) == len(way) and path.header.frame_id == "map"
    (_, lines), = messages["/map_lines"]
    walls = {m.id: [(p.x, p.y) for p in m.points] for m in lines.markers if m.ns == "walls"}
    assert all(m.type == 4 and m.color.a == 1.0 for m in lines.markers)
    same_lines(walls)
    (_, grid), = messages["/map"]
    assert len(grid.data) == grid.info.width * grid.info.height
    assert {-1, 0, 100} == set(grid.data)
    rosbags(messages)


def rosbags(messages):
    """The second reader: rosbags counts and decodes the same."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([FOLDER / "map.mcap"], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        count = dict.fromkeys(messages, 0)
        for connection, _, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            count[connection.topic] += 1
            if connection.topic == "/map_lines":
                assert len(message.markers) == len(messages["/map_lines"][0][1].markers)
    assert count == {topic: len(of) for topic, of in messages.items()}, count


def evo():
    import os

    program = Path(sys.executable).parent / "evo_traj"
    way = placed()
    length = sum(math.dist(a[1:3], b[1:3]) for a, b in zip(way, way[1:]))
    for kind in ("tum", "kitti"):
        home = {**os.environ, "HOME": str(FOLDER), "MPLBACKEND": "Agg"}
        words = [program, kind, FOLDER / f"map.{kind}"]
        said = subprocess.run(words, capture_output=True, text=True, env=home)
        assert said.returncode == 0, said.stdout + said.stderr
        assert f"{len(way)} poses, {length:.3f}m path length" in said.stdout, (said.stdout, len(way), length)
    from evo.tools.file_interface import read_tum_trajectory_file

    trajectory = read_tum_trajectory_file(FOLDER / "map.tum")
    assert trajectory.check()[0], trajectory.check()


def nav2():
    """map.yaml and map.pgm by the rules of nav2_map_server (map_io.cpp), trinary mode."""
    import yaml

    head = yaml.safe_load((FOLDER / "map.yaml").read_text())
    resolution = head["resolution"]
    x0, y0, yaw = head["origin"]
    assert (head["mode"], head["negate"], yaw) == ("trinary", 0, 0.0)
    free_thresh, occupied_thresh = head["free_thresh"], head["occupied_thresh"]
    kind, size, most, pixels = (FOLDER / head["image"]).read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    assert (kind, most, len(pixels)) == (b"P5", b"255", width * height)

    def cell(x, y):
        """-1 unknown, 0 free, 100 occupied at a place of the map; the picture's first row is the topmost."""
        column, row = math.floor((x - x0) / resolution), math.floor((y - y0) / resolution)
        assert 0 <= column < width and 0 <= row < height, (x, y)
        occupancy = (255 - pixels[(height - 1 - row) * width + column]) / 255
        return 100 if occupancy >= occupied_thresh else 0 if occupancy <= free_thresh else -1

    # The middle of every wall is occupied, the way of the scanner nearly all free, the corner of the picture unknown.
    for points in WALLS.values():
        for a, b in zip(points, points[1:]):
            assert cell((a[0] + b[0]) / 2, (a[1] + b[1]) / 2) == 100, (a, b)
    way = [cell(x, y) for _, x, y, _ in placed()]
    assert way.count(0) > 0.99 * len(way), way.count(0) / len(way)
    corners = [cell(x0 + dx, y0 + dy) for dx in (0.01, 0.01 + resolution) for dy in (0.01, 0.01 + resolution)]
    assert corners == [-1] * 4, corners
    assert len({pixels[k] for k in range(len(pixels))} - {0, 205, 254}) == 0
    assert pixels.count(254) > 1000 and pixels.count(205) > 1000


def nav2_vector():
    """map.vector.yaml by the rules of the vector object server (vector_object_shapes.cpp, Polygon::obtainParams)."""
    import yaml

    params = yaml.safe_load((FOLDER / "map.vector.yaml").read_text())["vector_object_server"]["ros__parameters"]
    walls = {}
    for name in params["shapes"]:
        shape = params[name]
        points = shape["points"]
        assert shape["type"] == "polygon" and shape["frame_id"] == "map" and shape["value"] == 100
        # A parameter of doubles with a whole number in it is refused; fewer than three points as well.
        assert all(type(p) is float for p in points), points
        assert len(points) >= 6 and len(points) % 2 == 0
        pairs = [points[k : k + 2] for k in range(0, len(points), 2)]
        if not name.startswith("polyline_"):
            assert shape["closed"] is True
            continue
        assert shape["closed"] is False
        wall = WALLS[int(name.removeprefix("polyline_"))]
        if len(wall) == 2:
            near(pairs.pop(1), [(wall[0][k] + wall[1][k]) / 2 for k in (0, 1)])
        walls[int(name.removeprefix("polyline_"))] = pairs
    same_lines(walls)
    assert len(params["shapes"]) == len(WALLS) + len(BOXES)


def saved_anew():
    """Not a check: the drawings as a CAD program (R2010, light polylines) and GDAL save them, for `import`."""
    import ezdxf
    import pyogrio

    old = ezdxf.readfile(FOLDER / "map.dxf")
    new = ezdxf.new("R2010", units=ezdxf.units.M)
    new.appids.add("POLYMAPPER")
    for line in old.modelspace().query("POLYLINE"):
        points = [(p.x, p.y) for p in line.points()]
        copy = new.modelspace().add_lwpolyline(points, close=line.is_closed, dxfattribs={"layer": line.dxf.layer})
        if line.has_xdata("POLYMAPPER"):
            copy.set_xdata("POLYMAPPER", line.get_xdata("POLYMAPPER"))
    new.saveas(FOLDER / "anew.dxf")
    info, geometries, columns = (pyogrio.raw.read(FOLDER / "map.fg.json", layer="walls")[k] for k in (0, 2, 3))
    kept = [list(info["fields"]).index(name) for name in ("id", "layer")]
    pyogrio.raw.write(
        FOLDER / "anew.geojson",
        geometries,
        [columns[k] for k in kept],
        ["id", "layer"],
        driver="GeoJSON",
        geometry_type="LineString",
        crs="EPSG:4326",
    )


CHECKS = {c.__name__.replace("_", "-"): c for c in (dxf, gpkg, json_fg, georef, mcap, evo, nav2, nav2_vector, saved_anew)}

if __name__ == "__main__":
    CHECKS[sys.argv[1]]()
    print("sound")
