#!/usr/bin/env bash
# Installs the programs that `cargo test --test outside` reads the exports with, into target/outside (thrown away
# with it): ezdxf, GDAL (in pyogrio), mcap, rosbags and evo from the Python package index, and Open-RMF's
# rmf_site_format, compiled. Without them those tests say that they were skipped. Needs python3 with venv; nothing
# outside target is touched.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
place="$(cd "$here/../../../.." && pwd)/target/outside"

if ! cmp --silent "$here/requirements.txt" "$place/venv/requirements.txt"; then
    rm -rf "$place/venv"
    python3 -m venv "$place/venv"
    "$place/venv/bin/pip" install --quiet --disable-pip-version-check -r "$here/requirements.txt"
    cp "$here/requirements.txt" "$place/venv/requirements.txt"
fi
cargo build --quiet --locked --manifest-path "$here/rmf/Cargo.toml" --target-dir "$place/rmf"
