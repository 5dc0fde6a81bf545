#!/usr/bin/env bash
# The kill and crash tests again and again: what a rare interleaving would break shows here.
#   ROUNDS=200 bash tests/long.sh      needs build/release, as tests/run.sh leaves it
set -euo pipefail
cd "$(dirname "$0")/.."
rounds=${ROUNDS:-100}
export RMLCELL_BIN=$PWD/build/release/bin RMLCELL_STUBS=$PWD/build/release/tests/integration/stubs
export RMLCELL_SHARED=${RMLCELL_SHARED:-$PWD/../shared}

failed=0
log=$(mktemp)
trap 'rm -f "$log"' EXIT
for round in $(seq "$rounds"); do
  if ! /usr/bin/python3 -B tests/integration/test_cell.py >"$log" 2>&1; then
    failed=$((failed + 1))
    echo "round $round failed:"
    tail -n 30 "$log"
  fi
done
echo "$rounds rounds against the real server and its workers, $failed failed"
[ "$failed" -eq 0 ]
