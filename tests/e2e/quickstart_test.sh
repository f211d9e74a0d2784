#!/usr/bin/env bash
# deploy/quickstart with the programs of this build and without a terminal: one JSON line for each
# spot on standard output, the live map at the address that it states, the comparison with the truth
# on standard error, status 0, nothing left running, and nothing written outside build/.
#   quickstart_test.sh BIN_DIR
set -euo pipefail
bin=$(cd "$1" && pwd)
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
quickstart=
trap '[ -z "$quickstart" ] || kill "$quickstart" 2>/dev/null || true; wait; rm -rf "$work"' EXIT

changes() { git status --porcelain; }
before=$(changes)
status=0
RAYLOC_BIN_DIR=$bin RAYLOC_QUICKSTART_DIR=$bin/../quickstart-run deploy/quickstart \
  >"$work/out" 2>"$work/err" </dev/null &
quickstart=$!
# While it runs, a browser finds the page and the plan of the room at the printed address.
map=
until [ -n "$map" ] || ! kill -0 "$quickstart" 2>/dev/null; do
  sleep 0.1
  map=$(sed -nE 's|.*live map: (http://[0-9.:]+/)$|\1|p' "$work/err")
done
# Reads the page whole before the search: a `grep -q` behind a pipe ends early, and its writer too.
holds() { # holds PATH TEXT
  local page
  page=$(/usr/bin/python3 -c 'import sys, urllib.request as web
print(web.urlopen(sys.argv[1]).read().decode())' "$map$1") && [[ $page == *"$2"* ]]
}
shown=1
if [ -n "$map" ]; then
  holds '' '<title>RayLoc live map</title>' || shown=
  holds api/v1/map '"ap3"' || shown=
else
  shown=
fi
wait "$quickstart" || status=$?
quickstart=
cat "$work/err"
[ -n "$shown" ] || { echo "FAILED: no live map at the address that is stated: ${map:-none}"; exit 1; }
[ $status = 0 ] || { echo "FAILED: status $status"; exit 1; }

spots=$(($(wc -l <tests/data/sites/meeting_room/device_los.csv) - 1))
located=$(grep -c '"location"' "$work/out" || true)
[ "$located" -ge "$spots" ] || { echo "FAILED: $located lines for $spots spots"; exit 1; }
if grep -qv '^{.*}$' "$work/out"; then
  echo 'FAILED: standard output holds more than JSON lines:'
  grep -nv '^{.*}$' "$work/out" | head -n 5
  exit 1
fi
grep -q 'stopped cleanly' "$work/err" || { echo 'FAILED: no clean stop'; exit 1; }
if grep -laF "$bin/../quickstart-run" /proc/[0-9]*/cmdline 2>/dev/null; then
  echo 'FAILED: these processes are left'
  exit 1
fi
[ "$(changes)" = "$before" ] || { echo 'FAILED: the checkout has changed'; git status --short; exit 1; }
