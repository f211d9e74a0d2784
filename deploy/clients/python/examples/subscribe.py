"""Prints where everything is.    subscribe.py [ENDPOINT]"""

import sys

import rayloc

with rayloc.Subscriber(*sys.argv[1:2], topics=["v1/location/"]) as messages:
    for message in messages:
        if message.location and message.location.HasField("position"):
            where = message.location.position
            print(f"{message.target} {where.x:.2f} {where.y:.2f} {where.z:.2f}", flush=True)
