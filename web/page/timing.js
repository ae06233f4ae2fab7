// Durations of cycles.

const KEPT = 4096;

/** The durations of the last cycles, and the rate of cycles. */
export class Timing {
  #durations = new Float64Array(KEPT);
  #count = 0;
  #since = 0;
  #counted = 0;
  #summary = { rate: 0, p50: 0, p99: 0, count: 0 };

  /** @param {number} now ms */
  restart(now) {
    this.#since = now;
    this.#counted = this.#count;
  }

  /** @param {number} milliseconds */
  add(milliseconds) {
    this.#durations[this.#count++ % KEPT] = milliseconds;
  }

  /**
   * Returns cycles per second, the median and the 99th percentile of the last cycles in µs, and the number of all
   * cycles. They are computed anew every half second.
   * @param {boolean} running
   */
  summary(running) {
    const now = performance.now();
    if (running && now - this.#since > 500) {
      const sorted = this.#durations.slice(0, Math.min(this.#count, KEPT)).sort();
      const at = (share) => 1000 * (sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0);
      this.#summary = {
        rate: (1000 * (this.#count - this.#counted)) / (now - this.#since),
        p50: at(0.5), p99: at(0.99), count: this.#count,
      };
      this.restart(now);
    }
    return running ? this.#summary : { ...this.#summary, rate: 0 };
  }
}
