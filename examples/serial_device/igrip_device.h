/* The microcontroller's side of igrip's serial device (docs/devices.md). Copy it into your sketch,
   write igrip_act, igrip_rest and igrip_send, call igrip_byte with each byte that comes and
   igrip_tick at least every 5 ms. It stops by itself when nothing allows it to act any more. */
#include <stdint.h>

void igrip_act(uint8_t grip, uint8_t phase, uint8_t level); /* phase 0: reach, 1: grasp */
void igrip_rest(void);                                      /* stop at once */
void igrip_send(const uint8_t *bytes, uint8_t count);

static struct { uint8_t frame[38], count, last, condition, level; uint32_t now, until; } igrip;

static uint16_t igrip_crc(const uint8_t *p, uint8_t n) { /* CRC-16/CCITT, from 0xFFFF */
    uint16_t crc = 0xFFFF;
    for (; n--; p++) {
        crc ^= (uint16_t)(*p << 8);
        for (int k = 0; k < 8; k++) crc = crc & 0x8000 ? (uint16_t)(crc << 1) ^ 0x1021 : (uint16_t)(crc << 1);
    }
    return crc;
}
static void igrip_stop(void) { igrip.condition = igrip.level = 0; igrip_rest(); }
static void igrip_report(void) {
    uint8_t f[9] = {0xA5, 3, igrip.last, 0x81, igrip.condition, igrip.level, igrip.last, 0, 0};
    uint16_t crc = igrip_crc(f + 1, 6);
    f[7] = (uint8_t)(crc >> 8); f[8] = (uint8_t)crc;
    igrip_send(f, 9);
}
static void igrip_tick(uint32_t ms) { /* ms: any clock that counts up */
    igrip.now = ms;
    if (igrip.condition && (int32_t)(igrip.now - igrip.until) >= 0) igrip_stop();
}
static void igrip_frame(const uint8_t *f) { /* f: length, sequence, type, payload */
    uint8_t ahead = (uint8_t)(f[1] - igrip.last);
    if (f[2] != 0 && (ahead == 0 || ahead > 127)) return; /* seen already, or late */
    igrip.last = f[1];
    if (f[2] == 0 || f[2] == 2) igrip_stop(); /* hello, stop */
    if (f[2] == 1 && f[0] == 5) {             /* allow: time to live, grip, phase, level */
        uint16_t ttl = (uint16_t)(f[3] << 8 | f[4]);
        igrip.until = igrip.now + (ttl > 150 ? 150 : ttl);
        igrip.condition = f[6] ? 2 : 1; igrip.level = f[7];
        igrip_act(f[5], f[6], f[7]);
    }
    if (f[2] != 0) igrip_report();
}
static void igrip_byte(uint8_t byte) {
    uint8_t *f = igrip.frame;
    f[igrip.count++] = byte;
    while (igrip.count) { /* a frame, the beginning of one, or none: then the next A5 may begin it */
        uint8_t whole = igrip.count < 2 ? 0 : (uint8_t)(f[1] + 6), used = 1;
        if (f[0] == 0xA5 && (whole == 0 || (whole <= 38 && igrip.count < whole))) return;
        if (f[0] == 0xA5 && whole <= 38
            && igrip_crc(f + 1, whole - 3) == (uint16_t)(f[whole - 2] << 8 | f[whole - 1])) {
            igrip_frame(f + 1);
            used = whole;
        }
        igrip.count -= used;
        for (uint8_t k = 0; k < igrip.count; k++) f[k] = f[k + used];
    }
}
