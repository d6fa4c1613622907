// Saloon, hatchback, estate, off-roader and van: one body by its profile, with wheel arches, a glass house and lamps.
import type { BufferGeometry } from "three";
import { box, joined, type Surface } from "../light";
import { axles, BLACK, type Body, CHROME, corners, GLASS, TRIM, WHITE } from "./body";
import { type HalfRing, loft, type Station } from "./loft";

/** Shares of the length, from the rear (0) to the front (1), and of the height. */
interface Profile {
  belt: number;
  nose: number;
  deck: number;
  cowl: number;
  header: number;
  pillar: number;
  tail: number;
  back: number;
  axles: [number, number];
}

const PROFILES = {
  saloon: {
    belt: 0.62,
    nose: 0.5,
    deck: 0.68,
    cowl: 0.69,
    header: 0.55,
    pillar: 0.44,
    tail: 0.25,
    back: 0.13,
    axles: [0.195, 0.8],
  },
  hatchback: {
    belt: 0.61,
    nose: 0.5,
    deck: 0.64,
    cowl: 0.72,
    header: 0.56,
    pillar: 0.42,
    tail: 0.1,
    back: 0.02,
    axles: [0.18, 0.8],
  },
  estate: {
    belt: 0.61,
    nose: 0.49,
    deck: 0.64,
    cowl: 0.69,
    header: 0.55,
    pillar: 0.43,
    tail: 0.085,
    back: 0.015,
    axles: [0.2, 0.8],
  },
  offroader: {
    belt: 0.6,
    nose: 0.52,
    deck: 0.63,
    cowl: 0.71,
    header: 0.57,
    pillar: 0.43,
    tail: 0.08,
    back: 0.015,
    axles: [0.19, 0.8],
  },
  van: {
    belt: 0.46,
    nose: 0.36,
    deck: 0.46,
    cowl: 0.86,
    header: 0.73,
    pillar: 0.6,
    tail: 0.012,
    back: 0.004,
    axles: [0.19, 0.83],
  },
} satisfies Record<string, Profile>;

export type CarKind = keyof typeof PROFILES;

const PAINT: Surface = [1, 0.34];
const PANE: Surface = [0, 0.75];
const MATT: Surface = [0, 0];
const LENS: Surface = [0, 0.6];

/** Which car is drawn for such a size; `id` decides where several are alike. */
export function carKind(id: number, length: number, height: number): CarKind {
  if (height > 1.95 || length > 5.3) return "van";
  if (height > 1.6) return "offroader";
  if (length < 4.25) return "hatchback";
  return (["saloon", "estate", "saloon", "hatchback"] as const)[Math.abs(id) % 4]!;
}

/** What a driver sees of the own car: the bonnet, in the axes of its body. */
export function buildBonnet(length: number, width: number, height: number, radius: number): BufferGeometry {
  const car = new Car(PROFILES.saloon, "saloon", length, width, height, radius);
  return car.bonnet();
}

export function buildCar(kind: CarKind, length: number, width: number, height: number, radius: number): Body {
  const car = new Car(PROFILES[kind], kind, length, width, height, radius);
  const rear = kind === "van" ? 0.42 : 0.56;
  return {
    levels: [() => car.near(), () => car.middle(), () => car.far()],
    wheels: axles([...car.axles].reverse(), width, radius, 0.22),
    lamps: corners(length, width, height * rear, height * (kind === "van" ? 0.31 : 0.44)),
    limbs: [],
    shade: [length, width],
  };
}

class Car {
  readonly axles: [number, number];
  private readonly sides: number;
  private readonly belt: number;

  constructor(
    private readonly profile: Profile,
    private readonly kind: CarKind,
    private readonly length: number,
    width: number,
    private readonly height: number,
    private readonly radius: number,
  ) {
    this.sides = width / 2;
    this.belt = height * profile.belt;
    this.axles = [this.at(profile.axles[0]), this.at(profile.axles[1])];
  }

  near(): BufferGeometry {
    return joined([this.lower(6), this.house(true), ...this.details()]);
  }

  middle(): BufferGeometry {
    return joined([this.lower(3), this.house(true), ...this.lenses()]);
  }

  far(): BufferGeometry {
    return joined([this.lower(0), this.house(false), ...this.lenses()]);
  }

  bonnet(): BufferGeometry {
    return this.lower(6, this.at(this.profile.cowl));
  }

  private at(share: number): number {
    return (share - 0.5) * this.length;
  }

  /** Everything below the windows; *arc* stations over half a wheel arch, none without arches. */
  private lower(arc: number, from = -Infinity): BufferGeometry {
    const half = this.length / 2;
    const reach = this.radius + 0.07;
    const xs = [-half, -half + 0.05, -half + 0.22, half - 0.3, half - 0.08, half, this.at(this.profile.cowl), 0];
    if (this.profile.deck !== this.profile.belt) xs.push(this.at(this.profile.back), this.at(this.profile.tail));
    for (const axle of arc ? this.axles : []) {
      for (let i = 0; i <= 2 * arc; i++) xs.push(axle - reach * Math.cos((i * Math.PI) / (2 * arc)));
    }
    const sorted = [...new Set(xs.map((x) => Math.round(x * 1e4) / 1e4))]
      .sort((a, b) => a - b)
      .filter((x) => x >= from - 1e-3);
    const stations = sorted.map((x): Station => ({ x, half: this.ring(x, arc ? reach : 0) }));
    const inside = (at: number): boolean => {
      const x = (stations[at]!.x + stations[at + 1]!.x) / 2;
      return arc > 0 && this.axles.some((axle) => Math.abs(x - axle) < reach);
    };
    return loft(stations, (at, strip) => {
      if (strip < 0) return [WHITE, PAINT];
      if (strip < 1 || (strip < 3 && inside(at))) return [BLACK, MATT];
      return strip < 3 ? [TRIM, MATT] : [WHITE, PAINT];
    });
  }

  private ring(x: number, reach: number): HalfRing {
    const end = Math.abs(x) / (this.length / 2);
    const isFront = x > 0;
    const w = this.sides * (1 - (isFront ? 0.2 : 0.13) * end ** (isFront ? 7 : 10));
    const lift = Math.max(0, end - 0.86) / 0.14;
    const floor = 0.19 + 0.13 * lift * (isFront ? 0.6 : 1);
    const top = this.deck(x) - (end > 0.985 ? (isFront ? 0.12 : 0.05) : 0);
    const near = this.axles.map((axle) => Math.abs(x - axle)).sort((a, b) => a - b)[0]!;
    // The arch is round about the axle.
    const rise = near < reach ? Math.sqrt(reach ** 2 - near ** 2) : 0;
    const arch = Math.max(floor, Math.min(rise > 0 ? this.radius + rise : floor, top - 0.14));
    const inner = Math.max(w - 0.3, 0.2);
    const middle = Math.max(arch + 0.03, Math.min(this.height * 0.37, top - 0.1));
    return [
      [0, floor],
      [inner, floor],
      [inner, arch],
      [w * 0.97, arch],
      [w, middle],
      [w * 0.975, Math.max(middle + 0.01, top - 0.07)],
      [w * 0.86, top],
      [0, top + 0.035],
    ];
  }

  /** The height of bonnet, belt line and boot lid. */
  private deck(x: number): number {
    const { nose, deck, cowl, back } = this.profile;
    const [low, high] = [this.height * nose, this.belt];
    const start = this.at(cowl);
    if (x >= start) {
      const share = (x - start) / (this.length / 2 - start);
      return high + (low - high) * share ** 1.6;
    }
    const end = this.at(back);
    const lid = Math.min(this.height * deck, this.height * 0.7);
    return x > end ? high + (lid - high) * Math.max(0, Math.min(1, (this.at(0.4) - x) / (this.at(0.4) - end))) : lid;
  }

  /** Windows, pillars and roof; *fine* with a pillar between the doors. */
  private house(fine: boolean): BufferGeometry {
    const { cowl, header, pillar, tail, back } = this.profile;
    const top = this.height;
    const base = this.sides * 0.9;
    const isVan = this.kind === "van";
    const roof = this.sides * (isVan ? 0.86 : 0.7);
    const ring = (x: number, raised: number): Station => {
      const foot = this.deck(x) - 0.03;
      const head = foot + 0.02 + (top - foot - 0.02) * raised;
      const edge = Math.max(head - 0.07, foot + 0.02 * raised + 0.001);
      const across = base + (roof - base) * raised;
      return {
        x,
        half: [
          [0, foot - 0.06],
          [base, foot],
          [across, edge],
          [across * 0.84, head - 0.012 * raised],
          [0, head + 0.0005],
        ],
      };
    };
    const columns = fine ? [pillar + 0.012, pillar - 0.012] : [];
    const shares = [
      [back, isVan ? 0.55 : 0.04],
      [tail, 0.985],
      ...(fine ? [[tail + (isVan ? 0.33 : 0.05), 0.997]] : []),
      ...columns.reverse().map((share) => [share, 1]),
      [header, 0.985],
      [cowl, 0.02],
    ] as [number, number][];
    const stations = shares.map(([share, raised]) => ring(this.at(share), raised));
    const last = stations.length - 2;
    return loft(
      stations,
      (at, strip) => {
        const isGlassy = at === last || (at === 0 && !isVan);
        if (strip < 0) return [isVan ? WHITE : BLACK, isVan ? PAINT : MATT];
        if (strip === 0) return [BLACK, MATT];
        if (strip === 1) {
          if (isVan) return at === last || at === last - 1 ? [GLASS, PANE] : [WHITE, PAINT];
          const isPillar = fine && (at === 3 || at === 1);
          return isPillar ? [at === 3 ? BLACK : WHITE, at === 3 ? MATT : PAINT] : [GLASS, PANE];
        }
        return isGlassy ? [GLASS, PANE] : [WHITE, PAINT];
      },
      0.5,
    );
  }

  private lenses(): BufferGeometry[] {
    const half = this.length / 2;
    const isVan = this.kind === "van";
    const [rear, front] = [this.height * (isVan ? 0.42 : 0.56), this.height * (isVan ? 0.31 : 0.44)];
    const parts = [1, -1].flatMap((side) => [
      box([0.16, 0.34, isVan ? 0.4 : 0.15], 0x8c1512, [-half + 0.07, side * (this.sides - 0.21), rear], 0, LENS),
      box([0.2, 0.34, 0.14], 0xdfe6ea, [half - 0.12, side * (this.sides - 0.22), front], 0.03, LENS),
    ]);
    parts.push(box([0.06, this.sides * 1.0, 0.13], BLACK, [half - 0.02, 0, front - 0.06]));
    parts.push(box([0.05, 0.52, 0.11], 0xf2f2f0, [-half - 0.005, 0, rear - 0.2]));
    return parts;
  }

  mirrors(): BufferGeometry[] {
    const x = this.at(this.profile.cowl) + 0.06;
    return [1, -1].map((side) =>
      box([0.14, 0.2, 0.13], WHITE, [x, side * (this.sides + 0.06), this.belt + 0.08], 0.02, PAINT),
    );
  }

  private details(): BufferGeometry[] {
    const half = this.length / 2;
    const front = this.height * (this.kind === "van" ? 0.31 : 0.44);
    return [
      ...this.lenses(),
      ...this.mirrors(),
      ...[1, -1].flatMap((side) => [
        box([0.2, 0.025, 0.03], CHROME, [-0.02 * this.length, side * this.sides * 0.985, this.belt - 0.11], 0, LENS),
        box([0.2, 0.025, 0.03], CHROME, [-0.2 * this.length, side * this.sides * 0.98, this.belt - 0.11], 0, LENS),
      ]),
      box([0.1, this.sides * 1.3, 0.16], TRIM, [half - 0.035, 0, 0.32]),
      box([0.1, this.sides * 1.5, 0.15], TRIM, [-half + 0.035, 0, 0.36]),
      box([0.04, 0.5, 0.11], 0xf2f2f0, [half + 0.012, 0, front - 0.2]),
    ];
  }
}
