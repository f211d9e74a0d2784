"""Locations of Wi-Fi devices and people, as raylocd publishes them.

    import rayloc

    with rayloc.Subscriber("tcp://127.0.0.1:5560") as messages:
        for message in messages:
            print(message.topic, message.kind)

`Subscriber` is for ordinary code, `AsyncSubscriber` for asyncio; both take the arguments of
`rayloc.connection.Connection` and know what was lost (`lost`), whether the daemon was restarted
(`restarts`) and whether it is still heard (`stale`). The messages themselves are the classes of
`rayloc.v1`, generated from proto/rayloc/v1.
"""

from rayloc.needs import explained

try:
    from rayloc.asynchronous import AsyncSubscriber
    from rayloc.connection import NoSnapshot
    from rayloc.message import Gap, Message
    from rayloc.options import Curve
    from rayloc.subscriber import Subscriber
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["AsyncSubscriber", "Curve", "Gap", "Message", "NoSnapshot", "Subscriber"]
