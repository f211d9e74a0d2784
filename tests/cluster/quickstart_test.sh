#!/usr/bin/env bash
# deploy/cluster/quickstart with the programs of this build and without a terminal: three sites on
# one map, a worker is killed and the other one takes over, no location is published twice, all
# processes end cleanly and none is left. Status 77 if no NATS server is installed.
#   quickstart_test.sh BIN_DIR
set -euo pipefail
bin=$(cd "$1" && pwd)
cd "$(dirname "$0")/../.."
[ -x "${RAYLOC_NATS_SERVER:-/usr/sbin/nats-server}" ] || { echo 'skipped: no nats-server'; exit 77; }
work=$(mktemp -d)
quickstart=
trap '[ -z "$quickstart" ] || kill "$quickstart" 2>/dev/null || true; wait; rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }

status=0
RAYLOC_UNCALIBRATED=1 RAYLOC_BIN_DIR=$bin RAYLOC_QUICKSTART_DIR=$bin/../cluster-run \
  deploy/cluster/quickstart --seconds 4 \
  >"$work/out" 2>"$work/err" </dev/null &
quickstart=$!
map=
until [ -n "$map" ] || ! kill -0 "$quickstart" 2>/dev/null; do
  sleep 0.1
  map=$(sed -nE 's|.*one map of all sites: (http://[0-9.:]+/)$|\1|p' "$work/err")
done
sites=$(/usr/bin/python3 -c 'import sys, urllib.request as web
print(web.urlopen(sys.argv[1]).read().decode())' "${map}api/v1/sites" 2>&1) || true
wait "$quickstart" || status=$?
quickstart=
cat "$work/err"
[ $status = 0 ] || fail "status $status"
for site in hall office lab; do
  [[ $sites == *"\"$site\""* ]] || fail "no $site on the map: $sites"
  grep -q "\"site\":\"$site\"" "$work/out" || fail "no location of $site"
done
if grep -qv '^{.*}$' "$work/out"; then fail 'standard output holds more than JSON lines'; fi
read -r victim other < <(sed -nE 's/.* worker (w[12]) is killed; .*/\1/p' "$work/err" |
  sed 's/w1/w1 w2/; t; s/w2/w2 w1/')
[ -n "$victim" ] || fail 'no worker was killed'
taken=$(grep -cE " worker $other takes (hall|office|lab), [0-9.]+ s after the kill" "$work/err" || true)
[ "$taken" -ge 2 ] || fail "$taken sites were taken by $other"
grep -qE 'cluster: [1-9][0-9]* locations of 3 sites, 0 of them twice' "$work/err" || fail 'some twice'
grep -q 'all stopped cleanly' "$work/err" || fail 'no clean stop'
left() { grep -laF -e "$bin/../cluster-run" /proc/[0-9]*/cmdline 2>/dev/null; }
if left; then fail 'these processes are left'; fi

# If quickstart is killed, all its processes end. Its output is not that of the run before.
: >"$work/err_killed"
RAYLOC_UNCALIBRATED=1 RAYLOC_BIN_DIR=$bin RAYLOC_QUICKSTART_DIR=$bin/../cluster-run \
  deploy/cluster/quickstart >/dev/null 2>"$work/err_killed" </dev/null &
quickstart=$!
until grep -q 'one map of all sites' "$work/err_killed" || ! kill -0 "$quickstart" 2>/dev/null; do
  sleep 0.1
done
[ "$(left | wc -l)" -ge 5 ] || { cat "$work/err_killed"; fail 'it has not begun'; }
kill -KILL "$quickstart"
wait "$quickstart" || true
quickstart=
patience=${RAYLOC_PATIENCE:-1}
for _ in $(seq $((100 * ${patience%.*}))); do left >"$work/left" || break; sleep 0.1; done
[ ! -s "$work/left" ] || fail "these are left: $(cat "$work/left")"
