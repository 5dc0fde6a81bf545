#!/usr/bin/env bash
# Compares the planner with that of LinuxCNC, off-line: its real-time module tpmod.so is opened like any
# library. Fetches the Debian packages linuxcnc-uspace (the module) and linuxcnc-uspace-dev (the headers
# that say what its structures look like) and unpacks them under build/; nothing is installed.
#   bash tests/bench/motion_linuxcnc.sh [BUILD]      default: build/release, made with -DRMLCELL_BENCH=ON
set -euo pipefail
cd "$(dirname "$0")/../.."
build=${1:-build/release}
peer=$build/linuxcnc
nice ninja -C "$build" motion_linuxcnc_bench >/dev/null

if [ ! -e "$peer/tpmod.so" ]; then
  mkdir -p "$peer/packages"
  (cd "$peer/packages" && apt-get download -qq linuxcnc-uspace linuxcnc-uspace-dev 2>/dev/null)
  for package in "$peer"/packages/*.deb; do dpkg-deb -x "$package" "$peer/root"; done
  cp "$peer/root/usr/lib/linuxcnc/modules/tpmod.so" "$peer/tpmod.so"
fi
gcc -O2 -std=gnu11 -fPIC -shared -w -DRTAPI -I"$peer/root/usr/include/linuxcnc" tests/bench/linuxcnc_planner.c \
  -o "$peer/libpeer.so" "$peer/tpmod.so" -Wl,-rpath,"\$ORIGIN"
dpkg-deb -f "$(ls "$peer"/packages/linuxcnc-uspace_*.deb)" Package Version | paste -sd' '
exec "$build/bin/motion_linuxcnc_bench" "$PWD/$peer/libpeer.so"
