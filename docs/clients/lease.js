// The client's rule for leases: may a device start an action now? Copy it into your program.
// Feed it every message of one hand; ask it before acting, and while a closing goes on.
class Lease {
  constructor(clock = () => performance.now() / 1000) {
    Object.assign(this, { clock, session: null, seq: 0, least: 0, until: 0 });
  }
  take({ session, seq, sent, commitment, valid_for: validFor }) {
    if (session === undefined) return; // no intention
    if (session === this.session && seq <= this.seq) return; // late, or told twice
    const now = this.clock(), way = now - sent;
    this.least = session === this.session ? Math.min(this.least, way) : way;
    Object.assign(this, { session, seq });
    this.until = commitment && validFor ? now + Math.min(validFor, 0.15) - (way - this.least) : 0;
  }
  permits() {
    return this.clock() < this.until;
  }
}
