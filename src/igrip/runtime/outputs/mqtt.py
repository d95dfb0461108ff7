"""Intentions to an MQTT broker: ``PREFIX/HAND/intention``, JSON, never retained.

A retained lease would be one of the past. Messages expire at the broker, and what could not be sent
at once is not sent later: quality of service 0. ``PREFIX/status`` is retained, ``online`` or, by
the last will, ``offline``.
"""

from __future__ import annotations

import re
import ssl
from collections import deque
from contextlib import suppress
from typing import Any
from urllib.parse import unquote, urlsplit

from igrip.errors import IgripError, requires_extra
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS

with requires_extra("paho-mqtt", "outputs", "MQTT"):
    from paho.mqtt.client import Client, MQTTMessageInfo, MQTTv5
    from paho.mqtt.enums import CallbackAPIVersion
    from paho.mqtt.packettypes import PacketTypes
    from paho.mqtt.properties import Properties

KEEP_ALIVE = 5  # s without a sign of the broker, and half as long again, after which it is gone
CONNECT_TIMEOUT = 5.0  # s
MAX_UNSENT = 64  # messages that may wait for the network; those after them are lost
EXPIRY = 1  # s, the least that MQTT can say; the lease itself is in the message
PORTS = {"mqtt": 1883, "mqtts": 8883}


@OUTPUTS.register("mqtt")
class MqttOutput:
    """Publishes each intention; a broker that goes away is connected to again."""

    def __init__(self, options: Options) -> None:
        parts = urlsplit(options.mqtt)
        try:
            self._port = parts.port or PORTS.get(parts.scheme, 0)
        except ValueError:
            self._port = 0
        if not parts.hostname or not self._port or parts.scheme not in PORTS:
            raise IgripError("--mqtt: must be mqtt://HOST[:PORT][/PREFIX], or mqtts://…")
        self._host, self._url = parts.hostname, parts
        self._prefix = _topic(parts.path.strip("/")) or "igrip"
        self._unsent: deque[MQTTMessageInfo] = deque()
        self._sent = self._lost = 0
        self._client: Any = None

    def start(self, loop: Loop) -> None:
        """Connect to the broker.

        Raises
        ------
        IgripError
            If it does not answer or refuses.
        """
        client = Client(CallbackAPIVersion.VERSION2, f"igrip-{loop.session}", protocol=MQTTv5)
        if self._url.username:
            client.username_pw_set(unquote(self._url.username), unquote(self._url.password or ""))
        if self._url.scheme == "mqtts":
            client.tls_set_context(ssl.create_default_context())
        client.will_set(f"{self._prefix}/status", "offline", qos=1, retain=True)
        client.reconnect_delay_set(1, 5)
        client.connect_timeout = CONNECT_TIMEOUT
        client.on_connect = self._on_connect
        self._warn = loop.warn
        where = f"{self._host}:{self._port}"
        try:
            client.connect(self._host, self._port, KEEP_ALIVE)
        except (OSError, ValueError) as error:
            raise IgripError(f"--mqtt: no broker answers at {where}: {error}") from error
        client.loop_start()
        self._client = client
        loop.announce(f"{self._url.scheme}://{where}/{self._prefix}")

    def _on_connect(
        self, client: Any, userdata: Any, flags: Any, reason: Any, properties: Any
    ) -> None:
        if reason.is_failure:
            self._warn(f"mqtt: the broker refuses: {reason}")
        else:
            client.publish(f"{self._prefix}/status", "online", qos=1, retain=True)

    def send(self, envelope: Envelope) -> None:
        """Hand one message to the client's thread; without a connection it is lost."""
        while self._unsent and self._unsent[0].is_published():
            self._unsent.popleft()
            self._sent += 1
        if not self._client.is_connected() or len(self._unsent) >= MAX_UNSENT:
            self._lost += 1
            if not self._client.is_connected():
                self._lost += len(self._unsent)  # the client drops them with the connection
                self._unsent.clear()
            return
        properties = Properties(PacketTypes.PUBLISH)
        properties.MessageExpiryInterval = EXPIRY
        topic = f"{self._prefix}/{_topic(envelope.intention.hand) or 'hand'}/intention"
        info = self._client.publish(topic, envelope.to_json(), qos=0, properties=properties)
        self._unsent.append(info)

    def counts(self) -> dict[str, int]:
        """Return how many messages were sent, and how many lost."""
        waiting = [info.is_published() for info in list(self._unsent)]
        return {"sent": self._sent + sum(waiting), "lost": self._lost}

    def close(self) -> None:
        """Say that no more comes, and disconnect."""
        if self._client is None:
            return
        client, self._client = self._client, None
        with suppress(RuntimeError, ValueError):
            client.publish(
                f"{self._prefix}/status", "offline", qos=1, retain=True
            ).wait_for_publish(1.0)
        client.disconnect()
        client.loop_stop()


def _topic(text: str) -> str:
    """Return a part of a topic: wildcards and what no topic may begin with become ``_``."""
    return re.sub(r"[+#\x00-\x1f]|^\$", "_", text)
