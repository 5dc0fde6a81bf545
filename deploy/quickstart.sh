#!/usr/bin/env bash
# From a fresh clone to a real job: set-up, release build, a server on loopback with its embedded defaults,
# one job for a mill and one for the laser, watched live, with report and picture. Cleans up after itself.
set -euo pipefail
cd "$(dirname "$0")/.."

say() { printf '\n\033[1m%s\033[0m\n' "$*"; }
show() { printf '\033[2m$ %s\033[0m\n' "$*" >&2; "$@"; }

say "1/4  what is missing is installed"
bash deploy/setup.sh

say "2/4  release build (the first one takes some minutes)"
cmake --preset release -DBUILD_TESTING=OFF >/dev/null
ninja -C build/release rmlcelld rmlcell-worker rmlcell
export PATH="$PWD/build/release/bin:$PATH"

say "3/4  a server on loopback"
state=$(mktemp -d)
server=
clean_up() {
  if [ -n "$server" ] && kill -0 "$server" 2>/dev/null; then
    # Their hosts would outlive the server for a while.
    for machine in mill-1 optimo-1; do rmlcell machine disable "$machine" >/dev/null 2>&1 || true; done
    kill "$server"
    wait "$server" 2>/dev/null || true
  fi
  rm -rf "$state"
}
trap clean_up EXIT
# Ports of its own choice, so that it never meets a server that runs already.
rmlcelld --state.directory "$state/store" --listen.grpc 127.0.0.1:0 --listen.web 127.0.0.1:0 \
  --log.file "$state/log" &
server=$!
for _ in $(seq 100); do
  grep -q 'is ready' "$state/log" 2>/dev/null && break
  kill -0 "$server" 2>/dev/null || { cat "$state/log" >&2; exit 1; }
  sleep 0.1
done
RMLCELL_SERVER=$(sed -n 's/.*gRPC on //p' "$state/log")
export RMLCELL_SERVER
web=$(sed -n 's/.*web on //p' "$state/log")
echo "gRPC on $RMLCELL_SERVER, web page on $web"
show rmlcell machines

say "4/4  two jobs, watched live"
mkdir -p build/quickstart
job() {  # machine, slot, program, picture
  local name
  show rmlcell put "$1" "$2" "$3"
  name=$(show rmlcell submit "$1" --slot "$2")
  show rmlcell watch "$name"
  show rmlcell report "$name"
  show rmlcell picture "$name" -o "$4"
  curl -sf "${web}v1/$name/artifacts/report" >/dev/null
  echo "picture: $4"
}
job mill-1 7 deploy/examples/coaster.rml build/quickstart/coaster.svg
job optimo-1 12 deploy/examples/bracket.S build/quickstart/bracket.svg
show rmlcell machine status mill-1  # it stands there between jobs

say "It works. What to try next:"
cat <<TEXT
  export PATH="\$PWD/build/release/bin:\$PATH"
  rmlcelld &                                        the server; page on http://127.0.0.1:50080/
  rmlcell simulate deploy/examples/bracket.S        on a laptop, with no server
  rmlcell --help
  grpcurl -plaintext 127.0.0.1:50051 list
  grpcurl -plaintext 127.0.0.1:50051 rmlcell.v1.MachineService/ListMachines
  curl -H 'Content-Type: application/json' -d '{}' http://127.0.0.1:50080/rmlcell.v1.MachineService/ListMachines
TEXT
