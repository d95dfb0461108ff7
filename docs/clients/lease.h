/* The client's rule for leases: may a device start an action now? Copy it into your program.
   Begin with lease l = {0}. Update it with every message of one hand that has a session; pass 0 for
   valid_for where commitment or valid_for is null. now: any clock that never goes back, in seconds.
   Ask it before acting, and during a closing. */
#include <string.h>

typedef struct { char session[32]; long long seq; double min_delay, until; } lease;

static void lease_update(lease *l, const char *session, long long seq, double sent,
                         double valid_for, double now) {
    int same = strncmp(l->session, session, 31) == 0;
    double delay = now - sent;
    if (same && seq <= l->seq) return; /* late, or a duplicate */
    l->min_delay = same && l->min_delay < delay ? l->min_delay : delay;
    strncpy(l->session, session, 31);
    l->seq = seq;
    if (valid_for > 0.15) valid_for = 0.15;
    l->until = valid_for > 0.0 ? now + valid_for - (delay - l->min_delay) : 0.0;
}

static int lease_permits(const lease *l, double now) { return now < l->until; }
