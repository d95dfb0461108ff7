"""The node of a run on ROS 2, which input and output share."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import Any

from igrip.errors import IgripError, requires_extra
from igrip.runtime.options import Options

with (
    requires_extra("ros-rclpy", "ros", "ROS 2"),
    warnings.catch_warnings(),  # what rclpy imports uses parts of Python that are deprecated
):
    warnings.simplefilter("ignore")
    import rclpy
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerOptions

SPIN = 0.1  # s after which the thread looks whether it shall end


class RosNode:
    """A node in a context of its own, and the thread in which its callbacks are called.

    Attributes
    ----------
    node : rclpy.node.Node
        There between :meth:`open` and :meth:`close`.
    """

    def __init__(self) -> None:
        self._users = 0
        self._lock = threading.Lock()
        self.node: Any = None

    @classmethod
    def shared(cls, options: Options) -> RosNode:
        """Return the node of the run that these options belong to."""
        node: RosNode = options.shared.setdefault("ros2", cls())
        return node

    def open(self, session: str) -> Any:
        """Return the node; each call needs a :meth:`close`.

        Raises
        ------
        IgripError
            If ROS 2 cannot be started.
        """
        with self._lock:
            self._users += 1
            if self._users == 1:
                try:
                    self._start(session)
                except Exception as error:  # rclpy raises errors of many kinds of its parts
                    self._users = 0
                    raise IgripError(f"ros2: cannot be started: {error!r:.300}") from error
            return self.node

    def _start(self, session: str) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self._context = rclpy.Context()
            # Ctrl-C stays the command's own
            rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
            self.node = Node(f"igrip_{session}", context=self._context)
            self._executor = SingleThreadedExecutor(context=self._context)
            self._executor.add_node(self.node)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="igrip-ros2", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            while not self._stop.is_set():
                self._executor.spin_once(timeout_sec=SPIN)

    def close(self) -> None:
        """End the node with the last of those that opened it."""
        with self._lock:
            if self._users == 0:
                return
            self._users -= 1
            if self._users:
                return
            self._stop.set()
            self._thread.join(timeout=5.0)
            self._executor.shutdown(timeout_sec=1.0)
            self.node.destroy_node()
            self._context.try_shutdown()
            self.node = None


def message_type(name: str) -> Callable[[], Any] | None:
    """Return the class of messages such as ``geometry_msgs/msg/PoseStamped``; None: not there."""
    package, _, kind = name.partition("/msg/")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found: Callable[[], Any] | None = getattr(import_module(f"{package}.msg"), kind, None)
    except ImportError:
        return None
    return found
