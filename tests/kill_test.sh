#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Kill runs that replace an earlier run, at random moments. The run folder must
# always be the complete folder of one of the runs, and the next run must remove
# all hidden folders. More kills, of a larger flow:
#   KILLS=100 KILL_FLOW='flows/newton.yaml --set ...' tests/kill_test.sh
set -u
export OPCFLOW_STORE= # no results of earlier runs
kills=${KILLS:-12}
seed=${KILL_SEED:-1}
opcflow=$OPCFLOW_BUILD/opcflow
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
RANDOM=$seed

if [ -z "${KILL_FLOW:-}" ]; then
  export OPCFLOW_PLUGIN_PATH=$OPCFLOW_BUILD/tests
  echo input >in.txt
  { printf 'opcflow: 1\nname: small\nsteps:\n'
    for i in 1 2 3 4 5 6 7 8; do
      echo "  s$i: { use: test.numbers, size: 1 nm, input: in.txt, output: deep/$i.txt }"
    done
    echo '  last: { use: test.kept }'; } >small.yaml
  KILL_FLOW=small.yaml
  held=$work/held
fi

# Print the start time of the run that wrote the folder; fail if the folder is incomplete.
whole() {
  python3 - "$1" <<'PY'
import hashlib, json, os, sys
folder = sys.argv[1]
manifest = json.load(open(folder + '/manifest.json'))
want = {f['path']: f for f in manifest['files']}
have = {os.path.relpath(os.path.join(d, f), folder)
        for d, _, files in os.walk(folder) for f in files}
assert have == set(want) | {'manifest.json'}, have ^ set(want)
for name, f in want.items():
    data = open(os.path.join(folder, name), 'rb').read()
    assert len(data) == f['bytes'], name
    assert hashlib.sha256(data).hexdigest() == f['sha256'], name
assert manifest['result'] == 'complete' and 'metrics.json' in want
print(manifest['started'])
PY
}

run() { "$opcflow" run $KILL_FLOW --output out/x --force --quiet; }
now() { date +%s%N; }
fail() { echo "not ok - $*"; exit 1; }

# Run once, then measure the time of a run that replaces the first one.
run >log 2>&1 || fail "the flow does not run: $(cat log)"
start=$(now)
run >log 2>&1 || fail "an earlier run is not replaced: $(cat log)"
micros=$((($(now) - start) / 1000))
last=$(whole out/x) || fail "the first run is not whole"

lost=0 mixed=0 hidden=0 replaced=0 left=0
for ((i = 1; i <= kills; i++)); do
  signal=KILL
  ((i % 2)) && signal=TERM
  # Kill at up to 1.1 times the run time; every third kill is near the end, when folders are
  # exchanged.
  span=$((micros * 11 / 10)) from=0
  ((i % 3)) || { from=$((micros * 7 / 10)); span=$((micros * 4 / 10)); }
  wait=$((from + (RANDOM * 32768 + RANDOM) % span))
  # On a slow machine, random kills may miss the work. Therefore the first kill waits for the work.
  hold=
  [ $i = 1 ] && signal=KILL hold=${held:+--set last.hold=$held}
  "$opcflow" run $KILL_FLOW $hold --output out/x --force --quiet 2>log &
  pid=$!
  if [ -n "$hold" ]; then
    until [ -e "$held" ]; do kill -0 $pid || fail "the run ended: $(cat log)"; sleep 0.01; done
  else
    sleep "$(printf '%d.%06d' $((wait / 1000000)) $((wait % 1000000)))"
  fi
  kill -s $signal $pid 2>/dev/null
  wait $pid 2>/dev/null
  [ -e out/x ] || { lost=$((lost + 1)); echo "# $i: lost"; }
  if [ -e out/x ]; then
    its=$(whole out/x 2>why) || { mixed=$((mixed + 1)); tail -1 why | sed "s/^/# $i: mixed: /"; }
    [ "$its" = "$last" ] || replaced=$((replaced + 1))
    last=$its
  fi
  rm -rf out/x.failed* # visible folder of a run that did not stop after SIGTERM
  [ "$(ls -A out)" = x ] || left=$((left + 1))
  # The next run, which is not killed, must remove all hidden folders.
  if ((i % 4 == 0 || i == kills)); then
    run >log 2>&1 || { lost=$((lost + 1)); sed "s/^/# $i: next: /" log; }
    last=$(whole out/x) || mixed=$((mixed + 1))
    rest=$(ls -A out | grep -v '^x$')
    [ -z "$rest" ] || { hidden=$((hidden + 1)); echo "# $i: left: $rest"; }
  fi
done
echo "# $kills kills, run of $micros us: $replaced had replaced the earlier run," \
  "$left left hidden folders for the next run"
echo "# lost $lost, mixed $mixed, left hidden after the next run $hidden"
echo 1..1
((lost + mixed + hidden == 0)) || fail "a killed run left no folder, a mixed folder or hidden folders"
((left > 0)) || fail "no kill hit a run during the work: nothing was tested"
echo "ok 1 - killed runs"
