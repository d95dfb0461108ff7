// The client's rule for leases: may a device start an action now? Copy it into your program.
// Feed it every message of one hand; ask it before acting, and while a closing goes on.
class Lease {
  constructor(clock = () => performance.now() / 1000) {
    Object.assign(this, { clock, session: null, seq: 0, until: 0 });
  }
  take(message) {
    if (message.session === this.session && message.seq <= this.seq) return; // late, or told twice
    this.session = message.session;
    this.seq = message.seq;
    const granted = message.commitment !== null && message.valid_for !== null;
    this.until = granted ? this.clock() + Math.min(message.valid_for, 0.15) : 0;
  }
  permits() {
    return this.clock() < this.until;
  }
}
