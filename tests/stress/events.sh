#!/bin/sh
# SPDX-License-Identifier: MIT
# events.sh TEST_EVENT_SEQUENCES: random sequences of contacts, against a solution from event to event
#
# A million contacts made or lost, by every integrator with location: none lost, none found twice, no NaN.
sequences=$1
[ "$STRESS" = short ] && count=500 || count=18500
said=$("$sequences" "$count" 2>&1)
status=$?
events=$(printf '%s\n' "$said" | sed -n 's/^\([0-9]*\) events.*/\1/p')
[ $status -eq 0 ] && [ -n "$events" ] && verdict=ok || verdict="$(printf '%s\n' "$said" | grep seed | head -n 1)"
printf '%s\n' "$said" >&2
echo "events | a mass between stops | ${events:-0} | ${events:-0} | 0 | 0 lost | ${verdict:-it ended early}"
