// Engine, tyres and wind as the simulated values have them, and a horn; silent until it is switched on.

export interface Heard {
  /** m/s. */
  speed: number;
  /** rad/s of the driven wheels; NaN where it is not simulated. */
  spin: number;
  /** N m at the wheels. */
  drive: number;
  /** m, of the wheels. */
  radius: number;
  /** 0 ... 1. */
  wetness: number;
}

const GEARS = [13, 8, 5.4, 4.1, 3.3, 2.8]; // engine to wheels
const IDLE = 85; // rad/s
const SHIFT = 300;
const FIRINGS = 2; // a turn, of four cylinders
const LOUD = 3000; // N m

/** What is heard, as numbers: pitch of the engine in Hz, and how loud each part is. */
export function voicesOf({
  speed,
  spin,
  drive,
  radius,
  wetness,
}: Heard): Record<"pitch" | "engine" | "tyres" | "squeal" | "wind", number> {
  const wheel = Number.isFinite(spin) ? Math.abs(spin) : Math.abs(speed) / radius;
  const gear = GEARS.find((ratio) => wheel * ratio < SHIFT) ?? GEARS.at(-1)!;
  const turns = Math.max(wheel * gear, IDLE);
  const load = Math.min(1, Math.max(drive, 0) / LOUD);
  const slip = Number.isFinite(spin) ? Math.abs(wheel * radius - Math.abs(speed)) / Math.max(Math.abs(speed), 3) : 0;
  const pace = Math.min(1, Math.abs(speed) / 40);
  return {
    pitch: (turns * FIRINGS) / (2 * Math.PI),
    engine: 0.12 + 0.2 * load + 0.06 * Math.min(1, turns / 500),
    tyres: 0.2 * pace * (1 + 0.8 * wetness),
    squeal: wetness > 0.5 ? 0 : 0.9 * Math.min(1, Math.max(0, slip - 0.12) / 0.3) * Math.min(1, Math.abs(speed) / 3),
    wind: 0.18 * pace ** 2,
  };
}

export class Sound {
  /** Whether the car is heard; the horn is also without. */
  isOn = false;
  private context: AudioContext | null = null;
  private voices: Voices | null = null;

  /** Browsers allow sound only from a click or a key. */
  toggle(): void {
    this.isOn = !this.isOn;
    if (this.isOn) this.wake();
    else this.voices?.hush();
  }

  hear(heard: Heard): void {
    if (this.isOn) this.voices?.hear(heard);
  }

  horn(isPressed: boolean): void {
    if (isPressed) this.wake();
    this.voices?.horn(isPressed);
  }

  close(): void {
    void this.context?.close();
    this.context = null;
    this.voices = null;
  }

  private wake(): void {
    this.context ??= new AudioContext();
    this.voices ??= buildVoices(this.context);
    if (this.context.state === "suspended") void this.context.resume();
  }
}

export interface Voices {
  hear(heard: Heard): void;
  horn(isPressed: boolean): void;
  /** The car falls silent. */
  hush(): void;
}

/** All that can be heard, silent at first. */
export function buildVoices(context: BaseAudioContext): Voices {
  const { engine, gains, horn } = build(context);
  return {
    hear: (heard) => {
      const now = context.currentTime;
      const { pitch, ...loud } = voicesOf(heard);
      engine.forEach((each, i) => each.frequency.setTargetAtTime(pitch * [0.5, 1, 2][i]!, now, 0.05));
      for (const name of Object.keys(gains) as (keyof typeof gains)[])
        gains[name].gain.setTargetAtTime(loud[name], now, 0.08);
    },
    horn: (isPressed) => horn.gain.setTargetAtTime(isPressed ? 0.3 : 0, context.currentTime, 0.015),
    hush: () => {
      for (const each of Object.values(gains)) each.gain.setTargetAtTime(0, context.currentTime, 0.02);
    },
  };
}

function build(context: BaseAudioContext) {
  const gain = (value: number, to: AudioNode = context.destination): GainNode => {
    const node = new GainNode(context, { gain: value });
    node.connect(to);
    return node;
  };
  const filter = (type: BiquadFilterType, frequency: number, to: AudioNode, quality = 0.7): BiquadFilterNode => {
    const node = new BiquadFilterNode(context, { type, frequency, Q: quality });
    node.connect(to);
    return node;
  };
  const tone = (type: OscillatorType, frequency: number, to: AudioNode): OscillatorNode => {
    const node = new OscillatorNode(context, { type, frequency });
    node.connect(to);
    node.start();
    return node;
  };
  const noise = (to: AudioNode): void => {
    const buffer = new AudioBuffer({ length: 2 * context.sampleRate, sampleRate: context.sampleRate });
    const data = buffer.getChannelData(0);
    let seed = 1;
    for (let i = 0; i < data.length; i++) {
      seed = (seed * 16807) % 2147483647;
      data[i] = seed / 1073741823.5 - 1;
    }
    const node = new AudioBufferSourceNode(context, { buffer, loop: true });
    node.connect(to);
    node.start();
  };
  const gains = { engine: gain(0), tyres: gain(0), squeal: gain(0), wind: gain(0) };
  const muffled = filter("lowpass", 420, gains.engine);
  const engine = [
    // Loudest as often as it fires, beside the turns of its crankshaft.
    tone("sawtooth", 20, gain(0.45, muffled)),
    tone("triangle", 40, muffled),
    tone("square", 80, gain(0.25, muffled)),
  ];
  noise(filter("lowpass", 700, gains.tyres));
  noise(filter("bandpass", 950, gains.squeal, 12));
  noise(filter("highpass", 1200, gains.wind));
  const horn = gain(0);
  for (const pitch of [405, 508]) tone("square", pitch, filter("lowpass", 1800, gain(0.5, horn)));
  return { engine, gains, horn };
}
