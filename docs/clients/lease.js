// The client's rule for leases: may a device start an action now? Copy it into your program.
// Update it with every message of one hand; ask it before acting, and during a closing.
class Lease {
  constructor(clock = () => performance.now() / 1000) {
    Object.assign(this, { clock, session: null, seq: 0, minDelay: 0, until: 0 });
  }
  update({ session, seq, sent, commitment, valid_for: validFor }) {
    if (session === undefined) return; // not an intention
    if (session === this.session && seq <= this.seq) return; // late, or a duplicate
    const now = this.clock(), delay = now - sent;
    this.minDelay = session === this.session ? Math.min(this.minDelay, delay) : delay;
    Object.assign(this, { session, seq });
    const late = delay - this.minDelay;
    this.until = commitment && validFor ? now + Math.min(validFor, 0.15) - late : 0;
  }
  permits() {
    return this.clock() < this.until;
  }
}
