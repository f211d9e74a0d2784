#!/usr/bin/env bash
# deploy/quickstart with the programs of this build and without a terminal: one JSON line for each
# spot on standard output, the comparison with the truth on standard error, status 0, nothing left
# running, and nothing written outside build/.
#   quickstart_test.sh BIN_DIR
set -euo pipefail
bin=$(cd "$1" && pwd)
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

changes() { git status --porcelain; }
before=$(changes)
status=0
RAYLOC_BIN_DIR=$bin RAYLOC_QUICKSTART_DIR=$bin/../quickstart-run deploy/quickstart \
  >"$work/out" 2>"$work/err" </dev/null || status=$?
cat "$work/err"
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
