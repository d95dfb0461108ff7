/* The device of igrip_device.h on a terminal of Linux: ./pty_main /dev/pts/N prints what it does. */
#include "igrip_device.h"
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static int port;
static uint32_t clock_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint32_t)(t.tv_sec * 1000 + t.tv_nsec / 1000000);
}
void igrip_act(uint8_t grip, uint8_t phase, uint8_t level) {
    printf("%u act %u %u %u\n", clock_ms(), grip, phase, level);
}
void igrip_rest(void) { printf("%u rest\n", clock_ms()); }
void igrip_send(const uint8_t *bytes, uint8_t count) {
    if (write(port, bytes, count) != count) printf("%u unsent\n", clock_ms());
}
int main(int count, char **names) {
    uint8_t bytes[64];
    if (count < 2 || (port = open(names[1], O_RDWR | O_NOCTTY)) < 0) return 1;
    setvbuf(stdout, NULL, _IOLBF, 0);
    printf("%u ready\n", clock_ms());
    for (;;) {
        struct pollfd wait = {port, POLLIN, 0};
        poll(&wait, 1, 2);
        igrip_tick(clock_ms());
        if (wait.revents & (POLLHUP | POLLERR)) return 0;
        if (!(wait.revents & POLLIN)) continue;
        ssize_t got = read(port, bytes, sizeof bytes);
        if (got <= 0) return 0;
        for (ssize_t k = 0; k < got; k++) igrip_byte(bytes[k]);
    }
}
