#!/usr/bin/env bash
# Makes the bundled site from the simulated datasets (README.md here). Needed again only when the
# datasets change; the result is committed.
#   make_meeting_room.sh DATASETS/meeting_room
set -euo pipefail
from=$(cd "$1" && pwd)
cd "$(dirname "$0")"
site=meeting_room
mkdir -p "$site/meshes"
cp "$from/scene.xml" "$site/"
cp "$from"/meshes/*.ply "$site/meshes/"
sed -e '1s/.*/# A furnished meeting room with three access points, 40 MHz./' \
    -e 's|^scene = .*|scene = "scene.xml"|' "$from/three_aps/site.toml" >"$site/site.toml"
chmod -R u+w "$site"

cut() { ./cut_recording.py "$@"; }
# Every second point; five frames a point (access points 2 and 3 were recorded with five).
calibration=(--every-spot 2 --spots-out "$site/calibration.csv")
cut "$from/calibration.pcap" "$from/calibration.csv" "${calibration[@]}" \
  --every-frame 2 --out "$site/calibration-ap1.pcap.gz"
# The first twenty of fifty spots, 102 seconds; ten frames a spot.
spots=(--first 20 --spots-out "$site/device_los.csv")
cut "$from/device_los.pcap" "$from/answers/device_los.csv" "${spots[@]}" \
  --every-frame 2 --out "$site/device_los-ap1.pcap.gz"
for ap in ap2 ap3; do
  cut "$from/$ap/calibration.pcap" "$from/$ap/calibration.csv" "${calibration[@]}" \
    --out "$site/calibration-$ap.pcap.gz"
  cut "$from/$ap/device_los.pcap" "$from/$ap/answers/device_los.csv" "${spots[@]}" \
    --out "$site/device_los-$ap.pcap.gz"
done
# The first nine seconds of a walk, ten frames a second, and where the device was.
from_to=$(awk -F, 'NR == 2 { printf "%.4f,%.4f", $1 - 0.02, $1 + 9 }' "$from/answers/walk.csv")
awk -F, -v end="${from_to#*,}" 'NR == 1 || $1 <= end' "$from/answers/walk.csv" >"$site/walk.csv"
for ap in ap1 ap2 ap3; do
  walk=$from/$ap/walk.pcap
  [ "$ap" != ap1 ] || walk=$from/walk.pcap
  cut "$walk" <(printf 't_start,t_end\n%s\n' "$from_to") --margin 0 \
    --every-frame 2 --out "$site/walk-$ap.pcap.gz"
done
