// Without a graphics card what moves is drawn coarser until it moves, and finer again once there is time for it.
const SLOW = 31; // ms a frame
const QUICK = 20;
const COARSEST = 0.4;
const PATIENCE = 4000; // ms; doubled each time that finer was too fine

export class Fineness {
  value = 1;
  private pace = 1000 / 60;
  private since = 0;
  private patience = PATIENCE;
  private grew = false;

  /** A picture came at *now*, *passed* ms after the one before. Whether the next is to be of another fineness. */
  tell(now: number, passed: number): boolean {
    this.pace += 0.1 * (Math.min(passed, 200) - this.pace);
    if (this.pace > SLOW && this.value > COARSEST) {
      if (this.grew) this.patience *= 2;
      return this.set(now, Math.max(this.value * 0.8, COARSEST), false);
    }
    if (this.pace > QUICK) this.since = now;
    return now - this.since > this.patience && this.value < 1 && this.set(now, Math.min(this.value * 1.25, 1), true);
  }

  private set(now: number, value: number, grew: boolean): boolean {
    [this.value, this.grew, this.since, this.pace] = [value, grew, now, (SLOW + QUICK) / 2];
    return true;
  }
}
