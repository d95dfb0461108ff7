"""MQTT through a real broker, Debian's mosquitto, which each test starts for itself."""

from __future__ import annotations

import json
import queue
import shutil
import socket
import subprocess
from contextlib import contextmanager

import pytest
from paho.mqtt.client import Client, MQTTv5
from paho.mqtt.enums import CallbackAPIVersion

from igrip.errors import IgripError
from igrip.runtime.options import Options
from igrip.runtime.outputs.mqtt import MAX_UNSENT, MqttOutput
from runtime_fakes import PATIENCE, until
from wire import PERMITTED, STORY, FakeLoop, envelopes

BROKER = shutil.which("mosquitto") or shutil.which("mosquitto", path="/usr/sbin")
needs_broker = pytest.mark.skipif(BROKER is None, reason="needs mosquitto (make system)")


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@contextmanager
def broker(folder, port, extra="allow_anonymous true"):
    """Run a broker on this machine alone."""
    config = folder / "mosquitto.conf"
    config.write_text(
        f"user root\nlistener {port} 127.0.0.1\n{extra}\n"
    )  # pytest's folder is the user's
    process = subprocess.Popen(
        [BROKER, "-c", config], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        until(lambda: _answers(port))
        yield process
    finally:
        process.kill()
        process.wait()


def _answers(port):
    try:
        socket.create_connection(("127.0.0.1", port), timeout=1.0).close()
    except OSError:
        return False
    return True


@contextmanager
def subscriber(port, topic="#"):
    """Yield a queue of what a client of the broker gets."""
    got, ready = queue.Queue(), queue.Queue()
    client = Client(CallbackAPIVersion.VERSION2, protocol=MQTTv5)
    client.on_message = lambda client, data, message: got.put(message)
    client.on_subscribe = lambda *arguments: ready.put(True)
    client.connect("127.0.0.1", port)
    client.subscribe(topic)
    client.loop_start()
    ready.get(timeout=PATIENCE)
    try:
        yield got
    finally:
        client.disconnect()
        client.loop_stop()


def started(port, prefix="lab/igrip"):
    output = MqttOutput(Options(mqtt=f"mqtt://127.0.0.1:{port}/{prefix}"))
    output.start(FakeLoop())
    return output


def take(got, topic):
    """Return the next message of a topic."""
    while True:
        message = got.get(timeout=PATIENCE)
        if message.topic == topic:
            return message


@needs_broker
def test_a_subscriber_gets_every_intention_and_a_late_one_no_lease(tmp_path):
    port = free_port()
    with broker(tmp_path, port):
        with subscriber(port) as got:
            output = started(port)
            assert take(got, "lab/igrip/status").payload == b"online"
            until(output._client.is_connected)
            for envelope in envelopes():
                output.send(envelope)
            messages = [take(got, "lab/igrip/right/intention") for _ in STORY]
            left = [json.loads(message.payload)["valid_for"] or 0.0 for message in messages]
            assert left == pytest.approx(PERMITTED)
            assert not any(message.retain for message in messages)
            until(lambda: output.counts() == {"sent": len(STORY), "lost": 0})
        with subscriber(port) as late:
            assert take(late, "lab/igrip/status").payload == b"online"
            output.close()
            assert take(late, "lab/igrip/status").payload == b"offline"
            assert late.empty()  # and nothing of what was said before


@needs_broker
def test_the_last_will_says_offline_when_the_connection_breaks(tmp_path):
    port = free_port()
    with broker(tmp_path, port), subscriber(port) as got:
        output = started(port)
        assert take(got, "lab/igrip/status").payload == b"online"
        output._client.socket().shutdown(socket.SHUT_RDWR)  # as if the process had been killed
        assert take(got, "lab/igrip/status").payload == b"offline"
        output.close()


@needs_broker
def test_without_the_broker_messages_are_lost_and_not_sent_later(tmp_path):
    port = free_port()
    with broker(tmp_path, port):
        output = started(port)
        until(output._client.is_connected)
    until(lambda: not output._client.is_connected())
    for _ in range(2 * MAX_UNSENT):
        for envelope in envelopes():
            output.send(envelope)
    assert output.counts()["lost"] == 2 * MAX_UNSENT * len(STORY)
    with broker(tmp_path, port), subscriber(port) as got:
        until(output._client.is_connected)
        last = next(iter(envelopes()))
        output.send(last)
        assert json.loads(take(got, "lab/igrip/right/intention").payload)["seq"] == last.seq
        output.close()


@needs_broker
def test_a_password_is_used_and_a_wrong_one_refused(tmp_path):
    passwords = tmp_path / "passwords"
    tool = shutil.which("mosquitto_passwd") or "/usr/bin/mosquitto_passwd"
    subprocess.run([tool, "-b", "-c", passwords, "anna", "s3/cret"], check=True)
    passwords.chmod(0o644)
    port = free_port()
    with broker(tmp_path, port, f"allow_anonymous false\npassword_file {passwords}"):
        right = MqttOutput(Options(mqtt=f"mqtt://anna:s3%2Fcret@127.0.0.1:{port}"))
        right.start(FakeLoop())
        until(right._client.is_connected)
        right.close()
        loop = FakeLoop()
        wrong = MqttOutput(Options(mqtt=f"mqtt://anna:guess@127.0.0.1:{port}"))
        wrong.start(loop)
        until(lambda: loop.warnings)
        assert "refuses" in loop.warnings[0]
        assert "guess" not in " ".join([*loop.warnings, *loop.announced])
        wrong.close()


def test_no_broker_is_an_error_that_names_the_place():
    port = free_port()
    output = MqttOutput(Options(mqtt=f"mqtt://127.0.0.1:{port}"))
    with pytest.raises(IgripError, match=f"127.0.0.1:{port}"):
        output.start(FakeLoop())
    output.close()


@pytest.mark.parametrize(
    "url", ["127.0.0.1", "http://a", "mqtt://", "mqtt://a:x", "mqtt://a:70000"]
)
def test_what_is_no_broker_is_named(url):
    with pytest.raises(IgripError, match="--mqtt"):
        MqttOutput(Options(mqtt=url))
