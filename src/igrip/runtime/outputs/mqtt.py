"""Intentions by MQTT 5, on a topic for each hand.

Nothing is retained and nothing repeated (QoS 0): a lease that comes late permits nothing. Each
message expires after a second, the shortest time that MQTT knows.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from igrip.errors import IgripError, requires_extra
from igrip.runtime.envelope import Envelope
from igrip.runtime.loop import Loop
from igrip.runtime.options import Options
from igrip.runtime.outputs import OUTPUTS
from igrip.runtime.outputs._datagrams import parse_address

with requires_extra("paho-mqtt", "mqtt", "MQTT"):
    from paho.mqtt.client import Client
    from paho.mqtt.enums import CallbackAPIVersion, MQTTErrorCode, MQTTProtocolVersion
    from paho.mqtt.packettypes import PacketTypes
    from paho.mqtt.properties import Properties

MAX_QUEUED = 64


@OUTPUTS.register("mqtt")
class MqttOutput:
    """``igrip/HAND/intention``; ``igrip/status`` is ``online``, and ``offline`` by the broker."""

    def __init__(self, options: Options) -> None:
        self._address = parse_address(options.mqtt_broker, "--mqtt-broker")
        self._prefix = options.stream_name
        self._counts: Counter[str] = Counter()
        self._properties = Properties(PacketTypes.PUBLISH)
        self._properties.MessageExpiryInterval = 1
        self._client = Client(CallbackAPIVersion.VERSION2, protocol=MQTTProtocolVersion.MQTTv5)
        self._client.max_queued_messages_set(MAX_QUEUED)
        self._client.reconnect_delay_set(1, 5)
        self._client.on_connect = self._connected
        self._client.will_set(f"{self._prefix}/status", b"offline", qos=1)

    def start(self, loop: Loop) -> None:
        """Connect; a broker that goes is connected to again.

        Raises
        ------
        IgripError
            If there is none.
        """
        host, port = self._address
        try:
            self._client.connect(host, port, keepalive=5)
        except OSError as error:
            reason = error.strerror or error
            raise IgripError(f"no MQTT broker at {host}:{port}: {reason}") from error
        self._client.loop_start()

    def _connected(self, client: Any, *_: object) -> None:
        client.publish(f"{self._prefix}/status", b"online", qos=1)

    def send(self, envelope: Envelope) -> None:
        """Publish one, or lose it; what cannot be sent now is not kept."""
        hand = "".join("_" if sign in "+#/\0" else sign for sign in envelope.intention.hand)
        if not self._client.is_connected():
            self._counts["lost"] += 1
            return
        done = self._client.publish(
            f"{self._prefix}/{hand}/intention", envelope.to_json(), properties=self._properties
        )
        self._counts["sent" if done.rc == MQTTErrorCode.MQTT_ERR_SUCCESS else "lost"] += 1

    def counts(self) -> dict[str, int]:
        """Return how many were handed to the broker, and how many were lost."""
        return dict(self._counts)

    def close(self) -> None:
        """Say goodbye and disconnect."""
        if self._client.is_connected():
            self._client.publish(f"{self._prefix}/status", b"offline", qos=1)
        self._client.disconnect()
        self._client.loop_stop()
