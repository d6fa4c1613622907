// Without a graphics card what moves is drawn coarser and with less detail until it moves, and finer again once there is
// time for it.
const SLOW = 31; // ms a picture, in the mean
const WANTED = 27;
const QUICK = 25;
const LATE = 100; // ms that one picture counts at most: others have the machine, too
const COARSEST = 0.4;
const SHARP = 0.8; // below which detail goes before more pixels do
const WATCHED = 600; // ms before it is drawn coarser
const PATIENCE = 1500; // ms before it is drawn finer; doubled each time that this was too fine

export class Resolution {
  value = 1;
  private since = -1;
  private pictures = 0;
  private took = 0;
  private patience = PATIENCE;
  private grew = false;
  private readonly most: number;

  /** *detail* levels there are besides 0, from which nothing more can be left out. */
  constructor(public detail = 0) {
    this.most = detail;
  }

  /** A picture came at *now*, *passed* ms after the one before. Whether the next is to be of another resolution. */
  tell(now: number, passed: number): boolean {
    if (this.since < 0) this.since = now;
    this.pictures++;
    this.took += Math.min(passed, LATE);
    const watched = now - this.since;
    if (watched < WATCHED) return false;
    const pace = this.took / this.pictures;
    // The time goes with the number of pixels.
    const share = Math.sqrt(WANTED / pace);
    if (pace > SLOW && (this.value > COARSEST || this.detail > 0)) {
      if (this.grew) this.patience *= 2;
      if (this.detail > 0 && this.value <= SHARP) return this.drop(now);
      return this.set(now, Math.max(this.value * Math.max(share, 0.7), COARSEST), false);
    }
    if (watched < this.patience) return false;
    if (pace < QUICK && this.value < 1) return this.set(now, Math.min(this.value * Math.min(share, 1.25), 1), true);
    if (pace < QUICK && this.detail < this.most) return this.raise(now);
    return this.set(now, this.value, this.grew);
  }

  private drop(now: number): boolean {
    this.detail--;
    this.set(now, this.value, false);
    return true;
  }

  private raise(now: number): boolean {
    this.detail++;
    this.set(now, this.value, true);
    return true;
  }

  private set(now: number, value: number, grew: boolean): boolean {
    const isOther = value !== this.value;
    [this.value, this.grew, this.since, this.pictures, this.took] = [value, grew, now, 0, 0];
    return isOther;
  }
}
