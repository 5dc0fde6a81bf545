#!/usr/bin/env bash
# What takes hours: rare interleavings, races, and inputs that nobody thought of. Writes a summary to
# tests/results/long.txt. Needs build/release, as tests/run.sh leaves it.
#   bash tests/long.sh [kills] [hosts] [crashes] [races] [fuzz] [load] [mutation] [behaviour]      default: all
# ROUNDS=100, FUZZ_SECONDS=600, LOAD_ROUNDS=20, MUTATIONS=300 and SEED=1 say how much.
set -euo pipefail
cd "$(dirname "$0")/.."
rounds=${ROUNDS:-100}
seconds=${FUZZ_SECONDS:-600}
parts=${*:-kills hosts crashes races fuzz load mutation behaviour}
export RMLCELL_BIN=$PWD/build/release/bin RMLCELL_STUBS=$PWD/build/release/tests/integration/stubs
export RMLCELL_SHARED=${RMLCELL_SHARED:-$PWD/../shared}

mkdir -p tests/results build/long
summary=tests/results/long.txt
failed=0
stamp="$(git rev-parse --short HEAD 2>/dev/null || echo unknown), $(date -u +%F), $(nproc) cores"
note() { echo "$* ($stamp)" | tee -a "$summary"; }
fail() { failed=1; note "FAILED: $*"; }

# The server and its workers are killed in the middle of jobs and submissions.
kills() {
  local bad=0
  for round in $(seq "$rounds"); do
    if ! /usr/bin/python3 -B tests/integration/test_cell.py >build/long/kills.log 2>&1; then
      bad=$((bad + 1))
      cp build/long/kills.log "build/long/kills-$round.log"
      tail -n 30 build/long/kills.log
    fi
  done
  note "kills: $rounds rounds against the real server and its workers, $bad failed"
  [ $bad -eq 0 ] || fail kills
}

# Hosts of machines, the server, or both are killed in the middle of runs, of RUN jobs, of jogs, of teaching and of
# recovery, and stopped for up to 20 s.
hosts() {
  local test
  for test in test_live.LiveTest.test_crash_rounds test_runs.RunsTest.test_crash_rounds test_live_crashes.LiveCrashesTest; do
    if (cd tests/integration && LIVE_ROUNDS=$rounds LIVE_STOPPED_S=20 LIVE_SEED=${SEED:-1} /usr/bin/python3 -B -m unittest "$test") \
      >"build/long/$test.log" 2>&1; then
      note "hosts: $rounds rounds of $test, none failed"
    else
      fail "hosts, see build/long/$test.log"
    fi
  done
}

# The store at every operation of the disk.
crashes() {
  if RMLCELL_LONG=1 build/release/tests/storage_sqlite_crash_test >build/long/crashes.log 2>&1; then
    note "crashes: $(tail -n 1 build/long/crashes.log), a crash at every operation of the disk"
  else
    fail crashes, see build/long/crashes.log
  fi
}

# What has threads under ThreadSanitizer.
races() {
  local targets=(server_events_test server_log_test server_jobs_test server_host_test
    server_host_threads_test server_machines_test server_runs_test storage_sqlite_test storage_sqlite_conformance_test)
  cmake --preset tsan >/dev/null
  ninja -C build/tsan "${targets[@]}" >build/long/tsan.log
  for target in "${targets[@]}"; do
    if "build/tsan/tests/$target" >"build/long/$target.log" 2>&1; then
      note "races: $target, $(grep 'PASSED' "build/long/$target.log" | tail -n 1)"
    else
      fail "races in $target, see build/long/$target.log"
    fi
  done
}

# One decoder of foreign bytes, from its committed seeds. What is found is kept beside the log.
fuzz_one() {
  local target=$1 program seeds=tests/fuzz/corpus/$1 found=build/long/$1
  program=$(find build/fuzz build/fuzz-server -name "$target" -type f -perm -u+x | head -n 1)
  case $target in
    optimo_*) seeds=tests/fuzz/corpus/optimo-$(echo "$target" | cut -d_ -f2) ;;
    host_*) seeds=tests/fuzz/corpus/host-$(echo "$target" | cut -d_ -f2) ;;
    machine_*) seeds=tests/fuzz/corpus/machine-$(echo "$target" | cut -d_ -f2) ;;
    rml1_device*) seeds=tests/fuzz/corpus/rml1 ;;
    rml1_*) seeds=tests/fuzz/corpus/rml1-$(echo "$target" | cut -d_ -f2) ;;
    lsp_*) seeds=tests/fuzz/corpus/lsp ;;
  esac
  mkdir -p "$found"
  local inputs=("$found")
  [ -d "$seeds" ] && inputs+=("$seeds")
  "$program" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=4096 -print_final_stats=1 \
    -artifact_prefix="build/long/$target-" "${inputs[@]}" >"build/long/$target.log" 2>&1
}

# As many at a time as the machine has cores.
fuzz() {
  command -v clang++ >/dev/null || bash deploy/setup.sh --fuzz
  cmake --preset fuzz >/dev/null
  local targets=(motion_planner_fuzz optimo_text_fuzz optimo_object_fuzz optimo_convert_fuzz optimo_compensate_fuzz
                 optimo_run_fuzz machine_state_fuzz machine_keys_fuzz machine_inputs_fuzz material_fuzz profile_fuzz
                 rml1_device_fuzz rml1_walk_fuzz rml1_gcode_fuzz rml1_png_fuzz lsp_fuzz)
  ninja -C build/fuzz "${targets[@]}" >build/long/fuzz_build.log
  # What reads messages needs all of the server.
  local of_server=(host_journal_fuzz host_messages_fuzz)
  cmake --preset fuzz-server >/dev/null
  ninja -C build/fuzz-server "${of_server[@]}" >>build/long/fuzz_build.log
  targets+=("${of_server[@]}")
  export -f fuzz_one
  export seconds
  printf '%s\n' "${targets[@]}" |
    xargs -P "$(nproc)" -I '{}' bash -c 'fuzz_one {} && touch build/long/{}.good || rm -f build/long/{}.good' || true
  for target in "${targets[@]}"; do
    if [ -e "build/long/$target.good" ]; then
      note "fuzz: $target, $seconds s, $(sed -n 's/.*number_of_executed_units: *//p' "build/long/$target.log") inputs, nothing found"
    else
      fail "$target, see build/long/$target.log"
    fi
  done
}

# The release tests again and again with busy loops beside them, several at a time: none may depend on being served at
# once. Rounds that were passed in a row count, each with the commit that it was run on; one that fails ends the row.
load() {
  local wanted=${LOAD_ROUNDS:-20} log=tests/results/load.txt loops=() commit passed
  commit=$(git log -1 --format=%h -- . ':!tests/results')
  if [ ! -f "$log" ] || grep -q '^failed' "$log"; then
    echo "Release tests, $(nproc) cores, four busy loops beside them, three tests a core at a time" >"$log"
  fi
  for _ in 1 2 3 4; do
    (while :; do :; done) &
    loops+=($!)
  done
  # shellcheck disable=SC2064
  trap "kill ${loops[*]} 2>/dev/null || true" EXIT
  while passed=$(grep -c '^round' "$log" || true); [ "$passed" -lt "$wanted" ]; do
    local begin=$SECONDS good=1
    ctest --test-dir build/release --output-on-failure -j $((3 * $(nproc))) --test-output-truncation head \
      --output-junit "$PWD/build/long/load.xml" >build/long/load.log 2>&1 || good=0
    local counted
    counted=$(python3 tests/count_results.py build/long/load.xml | tail -n 1)
    if [ $good -eq 0 ]; then
      cp build/long/load.log "build/long/load-failed-$((passed + 1)).log"
      echo "failed: $commit: $counted, $((SECONDS - begin)) s: $(grep -A 20 'tests FAILED' build/long/load.log | tr '\n' ' ')" >>"$log"
      break
    fi
    echo "round $((passed + 1)): $commit: $counted, $((SECONDS - begin)) s" >>"$log"
  done
  kill "${loops[@]}" 2>/dev/null || true
  trap - EXIT
  note "load: $(grep -c '^round' "$log" || true) rounds of $wanted passed, see $log"
  [ "$(grep -c '^round' "$log" || true)" -ge "$wanted" ] || fail load
}

# What the tests notice of changes of meaning.
mutation() {
  if python3 -B tests/mutation/mutate.py --seed "${SEED:-1}" --count "${MUTATIONS:-300}" \
      --results "tests/results/mutation-${SEED:-1}.txt" >build/long/mutation.log 2>&1; then
    note "mutation: at least 95 of 100 changes noticed in every area, see tests/results/mutation-${SEED:-1}.txt"
  else
    tail -n 3 build/long/mutation.log
    fail "mutation, see build/long/mutation.log and tests/results/mutation-${SEED:-1}.txt"
  fi
}

# What is known of parts that are not run now stays.
if [ -f "$summary" ]; then
  kept=$(grep -vE "^(FAILED: )?(${parts// /|})\\b" "$summary" || true)
  printf '%s' "${kept:+$kept
}" >"$summary"
fi
# What 2,500 programs say, byte by byte, against the committed hashes.
behaviour() {
  if python3 -B tests/behaviour/behaviour.py check "$RMLCELL_BIN" tests/behaviour/hashes.txt >build/long/behaviour.log
  then
    note "behaviour: $(tail -n 1 build/long/behaviour.log)"
  else
    fail "behaviour, see build/long/behaviour.log"
  fi
}

for part in $parts; do
  case $part in
    kills | hosts | crashes | races | fuzz | load | mutation | behaviour) $part ;;
    *) echo "usage: bash tests/long.sh [kills] [hosts] [crashes] [races] [fuzz] [load] [mutation] [behaviour]" >&2; exit 2 ;;
  esac
done
exit $failed
