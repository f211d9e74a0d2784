#!/usr/bin/env bash
# Proves that check_includes.sh finds what it is there to find: each case is a tree with one bad
# file, which must be reported, and a tree of allowed ones, which must pass.
set -euo pipefail
check=$(cd "$(dirname "$0")" && pwd)/check_includes.sh
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
failed=0

# caught FILE LINE RULE: a tree that holds LINE in FILE fails, names the file, and the rule.
caught() {
  rm -rf "${root:?}"/*
  mkdir -p "$root/$(dirname "$1")"
  printf '// First line.\n%s\n' "$2" >"$root/$1"
  if output=$("$check" "$root"); then
    echo "not caught: $2 in $1"
    failed=1
  elif [[ $output != "$1:2:"*"$3"* ]]; then
    echo "caught without '$1:2:' and '$3': $output"
    failed=1
  fi
}
passes() {
  rm -rf "${root:?}"/*
  while [ $# -gt 0 ]; do
    mkdir -p "$root/$(dirname "$1")"
    printf '%s\n' "$2" >>"$root/$1"
    shift 2
  done
  "$check" "$root" || { echo "reported, though allowed (above)"; failed=1; }
}

caught engine/em/a.h '#include "engine/scene/scene.h"' 'engine/em may include'
caught engine/base/a.cpp '#include "capture/transport/datagram.h"' 'engine/base may include'
caught engine/localize/a.h '#include "daemon/site/model/site.h"' 'engine/localize may include'
caught engine/trace/a.h '  #  include "engine/track/track.h"' 'engine/trace may include'
caught capture/source/a.cpp '#include "engine/scene/scene.h"' 'capture/source may include'
caught capture/source/a.cpp '#include "daemon/site/model/site.h"' 'capture/source may include'
caught daemon/site/model/a.cpp '#include "daemon/pipeline/pipeline.h"' 'daemon/site/model may include'
caught daemon/live/publish/a.cpp '#include "capture/transport/datagram.h"' 'daemon/live/publish may include'
caught daemon/pipeline/a.cpp '#include "daemon/cli/command/verb.h"' 'daemon/pipeline may include'
caught daemon/pipeline/a.cpp '#include "rayloc/v1/location.pb.h"' 'only output'
caught daemon/pipeline/a.h '#include "daemon/messages/location_message.h"' 'only output'
caught daemon/pipeline/output/carried_message.cpp '#include "rayloc/v1/location.pb.h"' 'location.h travels'
caught daemon/lab/draw/a.cpp '#include "daemon/live/http/map_files.h"' 'daemon/lab may include'
caught daemon/site/plan/a.h '#include "daemon/site/import/dxf.h"' 'daemon/site/plan may include'
caught engine/em/a.cpp '#include "../scene/scene.h"' 'quoted includes'
caught engine/scene/a.cpp '#include <embree3/rtcore.h>' 'Embree'
caught engine/localize/a.cpp '#include <hwy/highway.h>' 'Highway'
caught daemon/pipeline/a.cpp '#include <zmq.hpp>' 'ZeroMQ'
caught daemon/live/cluster/a.cpp '#include <nats/nats.h>' 'libnats'
caught daemon/cli/verbs/a.cpp '#include <CLI/CLI.hpp>' 'CLI11'
caught engine/trace/a.cpp '#include <tbb/parallel_for.h>' 'parallel.h'
caught engine/trace/a.cpp '#include <fstream>' 'files'
caught engine/trace/a.cpp '#include <iostream>' 'prints'
caught engine/trace/a.cpp '#include <thread>' 'threads'
caught engine/trace/a.cpp '#include <sys/socket.h>' 'sockets'
caught engine/trace/a.cpp 'auto t = std::chrono::steady_clock::now();' 'clock'
caught engine/trace/a.cpp 'std::random_device seed;' 'entropy'
caught engine/trace/a.cpp '#include <spdlog/spdlog.h>' 'log'
caught capture/source/a.cpp '#include "rayloc/v1/location.pb.h"' 'capture/source may include'

passes engine/scene/bvh.cpp '#include <embree3/rtcore.h>' \
  engine/scene/read/load_scene.cpp '#include <fstream>' \
  engine/localize/grid.cpp '#include "engine/trace/path.h"' \
  capture/source/udp_source.cpp '#include <sys/socket.h>' \
  daemon/live/publish/publisher.cpp '#include <zmq.hpp>' \
  daemon/live/cluster/nats/broker.cpp '#include <nats/nats.h>' \
  daemon/live/publish/publisher.cpp '#include "rayloc/v1/location.pb.h"' \
  daemon/live/output/publisher_stage.h '#include "rayloc/v1/heartbeat.pb.h"' \
  daemon/live/output/publisher_stage.cpp '#include "daemon/messages/location_message.h"' \
  daemon/cli/verbs/sub.cpp '#include "daemon/live/publish/subscriber.h"'

# A new folder must get its row.
rm -rf "${root:?}"/*
mkdir -p "$root/engine/novel" && touch "$root/engine/novel/idea.h"
if "$check" "$root" >/dev/null; then
  echo 'not caught: engine/novel has no row'
  failed=1
fi
exit $failed
