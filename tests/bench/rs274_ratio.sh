#!/usr/bin/env bash
# How many times as fast as LinuxCNC reads G-code does the Optimo language go from source to checked tree, and
# from source to object? Both read the same figures, turn by turn in the same rounds; see optimo_language.cc.
#   bash tests/bench/rs274_ratio.sh [ROUNDS]        default: 5
#
# The rival is `rs274 -g` of Debian's linuxcnc-uspace, the interpreter that people measure G-code with. Nothing
# of rmlcell needs it, and it drags in a desktop: so this script alone fetches it, and unpacks it under build/
# with the one library that it lacks, in place of installing it.
set -euo pipefail
cd "$(dirname "$0")/../.."
rounds=${1:-5}
place=$PWD/build/linuxcnc

fetch() {
  mkdir -p "$place"
  (
    cd "$place"
    apt-get download linuxcnc-uspace libboost-python1.74.0 >/dev/null 2>&1
    for package in *.deb; do dpkg-deb -x "$package" tree; done
    rm -- *.deb
  )
  echo "T1 P1 D1.0" >"$place/tool.tbl"  # it does not start without a tool table
  cat >"$place/rs274" <<EOF
#!/bin/sh
cd "$place"
export LD_LIBRARY_PATH="$place/tree/usr/lib:$place/tree/usr/lib/x86_64-linux-gnu"
exec "$place/tree/usr/bin/rs274" -t tool.tbl -v parameters.var -g "\$1"
EOF
  chmod +x "$place/rs274"
}

[ -x "$place/rs274" ] || fetch
cmake --preset release -B build/bench -DRMLCELL_ENGINE_ONLY=ON -DRMLCELL_BENCH=ON -DBUILD_TESTING=ON >/dev/null
nice ninja -C build/bench optimo_language_bench >/dev/null
mkdir -p tests/results
bench=$(find build/bench -name optimo_language_bench -type f -perm -u+x | head -n 1)
{
  "$bench" --rounds "$rounds" --rs274 "$place/rs274"
  # What no load of the machine can disturb.
  if command -v valgrind >/dev/null; then
    for lines in 1000 10000 100000; do
      counted=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null \
        --toggle-collect='rmlcell::optimo::Compile(*' "$bench" --once compile "$lines" 2>&1 |
        sed -n 's/.*Collected : //p')
      echo "{\"compile_instructions_per_line\":{\"lines\":$lines,\"instructions\":$((counted / lines))}}"
    done
  fi
} | tee tests/results/optimo_language.json
