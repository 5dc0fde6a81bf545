#!/usr/bin/env bash
# Installs every Debian package that rmlcell needs: to build (always), to test (--tests), to fuzz (--fuzz).
# As root, or by sudo. Quiet and quick when nothing is missing.
set -euo pipefail

packages() {
  sed -e 's/#.*//' -e '/^[[:space:]]*$/d' <<'LIST'
# --- build
g++                     # the compiler, 12 or later
cmake                   # build description, 3.25 or later
ninja-build             # build
ccache                  # a second build takes seconds
lld                     # links in a third of the time
pkg-config              # finds zstd, which has no CMake file
ca-certificates         # for package managers
# --- libraries
libeigen3-dev           # vectors, rotations, frames, solves (headers only)
libpng-dev              # pictures of what a mill leaves
libgrpc++-dev           # calls and streams
protobuf-compiler-grpc  # generates the services
libprotobuf-dev         # messages
protobuf-compiler       # generates the messages
libsqlite3-dev          # the embedded store
libzstd-dev             # compresses what the store keeps
libarchive-dev          # projects as one file
libssl-dev              # SHA-256 of programs and products
libspdlog-dev           # logs
libfmt-dev              # spdlog's formatting
libcli11-dev            # command lines
libtomlplusplus-dev     # configuration and machine files
nlohmann-json3-dev      # JSON: error details on the web port, messages of the language server
libboost-dev            # Beast and Asio: the web port and the thread pool (headers only)
libpng-dev              # pictures of circuit boards
LIST
}

test_packages() {
  sed -e 's/#.*//' -e '/^[[:space:]]*$/d' <<'LIST'
libgtest-dev            # the test framework
libgmock-dev            # its matchers
librapidcheck-dev       # properties over random inputs
libbenchmark-dev        # benchmarks
clang-format            # the shape of the sources
python3-grpcio          # a client in another language
python3-protobuf        # its messages
valgrind                # counts instructions: the gate of the planner's cost
curl                    # the web port as people use it
nodejs                  # runs the web clients; too old for some, see tests/run.sh
npm                     # brings buf and the web clients
LIST
}

fuzz_packages() {
  sed -e 's/#.*//' -e '/^[[:space:]]*$/d' <<'LIST'
clang                   # libFuzzer
llvm                    # symbols in its findings
LIST
}

wanted=$(packages)
case ${1:-} in
  --tests) wanted+=" $(test_packages)" ;;
  --fuzz) wanted+=" $(test_packages) $(fuzz_packages)" ;;
esac

missing=()
for package in $wanted; do
  case $package in
    # A newer Node may have been installed by other means.
    nodejs) command -v node >/dev/null && continue ;;
    npm) command -v npm >/dev/null && continue ;;
  esac
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

echo "installing: ${missing[*]}"
sudo=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup.sh: run as root, or install sudo" >&2; exit 1; }
  sudo=(sudo)
fi
export DEBIAN_FRONTEND=noninteractive
"${sudo[@]}" apt-get update -qq
"${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
