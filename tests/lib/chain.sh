#!/bin/sh
# SPDX-License-Identifier: MIT
# chain.sh LINKS [planar|spatial] [fixed|free]: prints the model of an open chain of rods of 1 m and 1 kg, drawn straight,
# with hinges that are all parallel or turn by a quarter from one to the next, on the ground or on a free body.
awk -v n="$1" -v kind="${2:-planar}" -v base="${3:-fixed}" '
function axis(i) { return (kind == "planar" || i % 2) ? "[0, 1, 0]" : "[0, 0, 1]" }
function before(i) { return i > 1 ? "link_" (i - 1) : base == "fixed" ? "ground" : "root" }
BEGIN {
  print "# SPDX-License-Identifier: MIT\ngicgen: 1\nmodel: chain\nbase: " (base == "fixed" ? "ground" : "root") "\nbodies:"
  if (base == "free") print "  root: {mass: 5, position: [0, 0, 0], com: [0, 0, 0], inertia: [1, 1, 1]}"
  for (i = 1; i <= n; ++i) printf "  link_%d: {mass: 1, com: [%.1f, 0, 0], inertia: [0.01, 0.1, 0.1]}\n", i, i-0.5
  print "joints:"
  for (i = 1; i <= n; ++i) printf "  pin_%d: {type: revolute, bodies: [%s, link_%d], point: [%d, 0, 0], axis: %s}\n", i, before(i), i, i-1, axis(i)
  print "coordinates:"
  for (i = 1; i <= n; ++i) printf "  turn_%d: {type: angle, bodies: [%s, link_%d], axis: %s, range: [-3, 3]}\n", i, before(i), i, axis(i)
  print "outputs:\n  tip: {type: acceleration, body: link_" n ", point: [" n ", 0, 0]}\n  energy: {type: energy}"
}'
