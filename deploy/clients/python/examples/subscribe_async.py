"""Keeps a table of all positions, beginning with the snapshot.

subscribe_async.py [ENDPOINT [SNAPSHOT]]"""

import asyncio
import sys

import rayloc


async def main(endpoint: str = "tcp://127.0.0.1:5560", snapshot: str = "tcp://127.0.0.1:5561") -> None:
    places: dict[str, tuple[float, float]] = {}
    async with rayloc.AsyncSubscriber(endpoint, snapshot=snapshot) as messages:
        while True:
            message = await messages.receive(timeout=1.0)
            if message and message.location and message.location.HasField("position"):
                where = message.location.position
                places[message.target] = (where.x, where.y)
            print(f"{places} lost={messages.lost} stale={messages.stale}", flush=True)


asyncio.run(main(*sys.argv[1:3]))
