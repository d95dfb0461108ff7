"""Virtual Dynamixel X motors: protocol 2.0, the registers that igrip uses, the bus watchdog.

After ROBOTIS' e-manual: "Protocol 2.0" and "XL430-W250", control table.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from igrip.devices.base.twin import OutputLog

OPERATING_MODE, TORQUE, BUS_WATCHDOG, GOAL_CURRENT = 11, 64, 98, 102
GOAL_POSITION, PRESENT_POSITION = 116, 132
CURRENT_POSITION = 5
PING, READ, WRITE, STATUS, SYNC_WRITE = 0x01, 0x02, 0x03, 0x55, 0x83
HEADER = b"\xff\xff\xfd\x00"
SPEED = 1500.0  # ticks/s
TOLERANCE = 3  # ticks
MILLIAMPERES = 2.69
BITTEN = 255


def crc16(data: bytes) -> int:
    """Return the CRC-16 of protocol 2.0 (polynomial 0x8005, initial value 0)."""
    register = 0
    for byte in data:
        register ^= byte << 8
        for _ in range(8):
            register = (register << 1 ^ 0x8005 if register & 0x8000 else register << 1) & 0xFFFF
    return register


class DynamixelTwin(OutputLog):
    """Motors on one bus.

    Attributes
    ----------
    tables : dict of int to bytearray
        The control table of each motor.
    """

    def __init__(self, clock: Callable[[], float], motors: Sequence[int]) -> None:
        super().__init__(clock)
        self.tables = {motor: bytearray(256) for motor in motors}
        self._buffer = b""
        self._heard = self._at = clock()

    def receive(self, data: bytes) -> bytes:
        """Answer each whole packet."""
        reply = self.tick()
        self._buffer = (self._buffer + data)[-2048:]
        while True:
            begin = self._buffer.find(HEADER)
            if begin < 0:
                self._buffer = self._buffer[-3:]
                return reply
            self._buffer = self._buffer[begin:]
            if len(self._buffer) < 7:
                return reply
            whole = 7 + int.from_bytes(self._buffer[5:7], "little")
            if not 10 <= whole <= 512:
                self._buffer = self._buffer[1:]
                continue
            if len(self._buffer) < whole:
                return reply
            packet = self._buffer[:whole]
            if int.from_bytes(packet[-2:], "little") == crc16(packet[:-2]):
                self._buffer = self._buffer[whole:]
                reply += self._act(packet[4], packet[7], packet[8:-2].replace(
                    b"\xff\xff\xfd\xfd", b"\xff\xff\xfd"
                ))  # fmt: skip
            else:
                self._buffer = self._buffer[1:]

    def _act(self, motor: int, instruction: int, data: bytes) -> bytes:
        self._heard = self.clock()
        address = int.from_bytes(data[:2], "little")
        if instruction == SYNC_WRITE and len(data) >= 4:
            size = int.from_bytes(data[2:4], "little")
            for k in range(4, len(data) - size, size + 1):
                if data[k] in self.tables:
                    self._write(data[k], address, data[k + 1 : k + 1 + size])
            return b""
        if motor not in self.tables:
            return b""
        if instruction == WRITE and len(data) > 2:
            return self._status(motor, self._write(motor, address, data[2:]))
        if instruction == READ and len(data) == 4 and address < 256:
            size = int.from_bytes(data[2:4], "little")
            return self._status(motor, 0, bytes(self.tables[motor][address : address + size]))
        if instruction == PING:
            return self._status(motor, 0, b"\x24\x04\x30")
        return self._status(motor, 2)

    def _write(self, motor: int, address: int, data: bytes) -> int:
        """Write to a table; return the error number."""
        table = self.tables[motor]
        if address + len(data) > 147:
            return 4
        bitten = table[BUS_WATCHDOG] == BITTEN
        if address == BUS_WATCHDOG and bitten and data[0]:
            return 4
        if bitten and address in (GOAL_POSITION, GOAL_CURRENT):
            return 7
        if address == OPERATING_MODE and table[TORQUE]:
            return 7
        table[address : address + len(data)] = data
        self._note()
        return 0

    def _status(self, motor: int, error: int, data: bytes = b"") -> bytes:
        body = HEADER + bytes((motor,)) + (len(data) + 4).to_bytes(2, "little")
        body += bytes((STATUS, error)) + data
        return body + crc16(body).to_bytes(2, "little")

    def _value(self, motor: int, address: int, size: int) -> int:
        return int.from_bytes(self.tables[motor][address : address + size], "little")

    def tick(self) -> bytes:
        """Move on; stop the motors whose watchdog has heard nothing."""
        now = self.clock()
        step, self._at = int(SPEED * (now - self._at)), now
        for motor, table in self.tables.items():
            watchdog = table[BUS_WATCHDOG]
            if 0 < watchdog < BITTEN and now - self._heard > watchdog * 0.02:
                table[BUS_WATCHDOG] = BITTEN
                table[GOAL_POSITION : GOAL_POSITION + 4] = table[
                    PRESENT_POSITION : PRESENT_POSITION + 4
                ]
            if table[TORQUE] and table[BUS_WATCHDOG] != BITTEN:
                here = self._value(motor, PRESENT_POSITION, 4)
                goal = self._value(motor, GOAL_POSITION, 4)
                here += max(-step, min(step, goal - here))
                table[PRESENT_POSITION : PRESENT_POSITION + 4] = here.to_bytes(4, "little")
        self._note()
        return b""

    def _note(self) -> None:
        moving = [
            motor for motor, table in self.tables.items()
            if table[TORQUE] and table[BUS_WATCHDOG] != BITTEN and abs(
                self._value(motor, GOAL_POSITION, 4) - self._value(motor, PRESENT_POSITION, 4)
            ) > TOLERANCE
        ]  # fmt: skip
        current = max((self._value(m, GOAL_CURRENT, 2) * MILLIAMPERES for m in moving), default=0.0)
        self.note(bool(moving), round(current, 1), f"{len(moving)} motors move" if moving else "")
