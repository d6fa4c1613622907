// Without a graphics card what moves is drawn coarser until it moves, and finer again once there is time for it.
const SLOW = 31; // ms a frame
const WANTED = 27;
const QUICK = 24;
const LATE = 2 * SLOW; // what one picture counts at most: a single one that came late says nothing
const COARSEST = 0.4;
const SETTLED = 12; // pictures
const PATIENCE = 2000; // ms; doubled each time that finer was too fine

export class Fineness {
  value = 1;
  private pace = WANTED;
  private since = 0;
  private pictures = 0;
  private patience = PATIENCE;
  private grew = false;

  /** A picture came at *now*, *passed* ms after the one before. Whether the next is to be of another fineness. */
  tell(now: number, passed: number): boolean {
    this.pace += 0.1 * (Math.min(passed, LATE) - this.pace);
    if (this.pace > QUICK) this.since = now;
    if (++this.pictures < SETTLED) return false;
    // The time goes with the number of pixels.
    const share = Math.min(Math.max(Math.sqrt(WANTED / this.pace), 0.7), 1.25);
    if (this.pace > SLOW && this.value > COARSEST) {
      if (this.grew) this.patience *= 2;
      return this.set(Math.max(this.value * share, COARSEST), false);
    }
    return now - this.since > this.patience && this.value < 1 && this.set(Math.min(this.value * share, 1), true);
  }

  private set(value: number, grew: boolean): boolean {
    [this.value, this.grew, this.pictures, this.pace] = [value, grew, 0, WANTED];
    return true;
  }
}
