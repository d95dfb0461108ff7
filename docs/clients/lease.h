/* The client's rule for leases: may a device start an action now? Copy it into your program.
   Begin with lease l = {0}. Feed it every message of one hand that has a session, valid_for 0 where
   commitment or valid_for is null; now: any clock that never goes back, in seconds. Ask before
   acting, and while a closing goes on. */
#include <string.h>

typedef struct { char session[32]; long long seq; double least, until; } lease;

static void lease_take(lease *l, const char *session, long long seq, double sent, double valid_for,
                       double now) {
    int same = strncmp(l->session, session, 31) == 0;
    double way = now - sent;
    if (same && seq <= l->seq) return; /* late, or told twice */
    l->least = same && l->least < way ? l->least : way;
    strncpy(l->session, session, 31);
    l->seq = seq;
    if (valid_for > 0.15) valid_for = 0.15;
    l->until = valid_for > 0.0 ? now + valid_for - (way - l->least) : 0.0;
}

static int lease_permits(const lease *l, double now) { return now < l->until; }
