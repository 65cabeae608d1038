#!/bin/sh
# SPDX-License-Identifier: MIT
# demo.sh: installs what is missing, builds, drives the complete HMMWV for 30 s, another one over the road of
# models/scenes/paper_run.scene, and says where pictures, pages and numbers are.
set -e
cd "$(dirname "$0")/.."
sh tests/install.sh
echo "Building ..." >&2
exec make --no-print-directory -s demo
