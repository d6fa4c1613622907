// The other road users at a moment: who is in which place, how they move, and what their lamps show.
import type { Source } from "./data";
import { buildOther, type Fleet, type Vehicle } from "./vehicles";

const BRAKES = -0.8; // m/s2 at which brake lights are lit
const STRIDE = 1.45; // m of a walker's double step
const ASIDE = 0.35; // m/s across its own heading that is a change of lane
const STILL = 0.05; // m/s

export class Traffic {
  private readonly places: Place[];

  constructor(source: Source) {
    this.places = Array.from({ length: source.document.others }, (_, number) => new Place(number, source));
  }

  show(time: number, fleet: Fleet): void {
    for (const place of this.places) place.show(time, fleet);
  }
}

/** Where no brakes are simulated, or of others: by how much it slows down. */
export function slows(source: Source, stem: string, time: number): boolean {
  const past = 4 * (source.document.step || 1);
  const change = source.at(`${stem}.speed`, time) - source.at(`${stem}.speed`, time - past);
  return time - past >= source.span()[0] && change / past < BRAKES;
}

/** A place of a road user, in which another one may be later. */
class Place {
  private vehicle: Vehicle | null = null;
  private who = "";
  private way = 0;
  private last = 0;
  private since = 0;

  constructor(
    private readonly number: number,
    private readonly source: Source,
  ) {}

  show(time: number, fleet: Fleet): void {
    const stem = `other.${this.number}`;
    const held = (name: string): number => this.source.held(`${stem}.${name}`, time);
    const kind = this.source.document.classes[held("class")] ?? "none";
    const who = `${kind} ${held("id")}`;
    if (who !== this.who) this.replace(kind, held, time);
    this.who = who;
    if (!this.vehicle) return;
    // Who comes into the place at the next frame is not drawn on the way there.
    const isLast = this.source.held(`${stem}.id`, time + this.source.document.step) !== held("id");
    const at = (name: string): number => (isLast ? held(name) : this.source.at(`${stem}.${name}`, time));
    const { vehicle } = this;
    vehicle.position.set(at("x"), at("y"), at("z"));
    vehicle.rotation.z = isLast ? held("heading") : this.source.angle(`${stem}.heading`, time);
    this.way += at("speed") * (time - this.last);
    this.last = time;
    vehicle.rolled = this.way;
    vehicle.stride = this.way / STRIDE;
    vehicle.swing = Math.min(1, Math.abs(at("speed")) / 1.2);
    vehicle.brakes = kind !== "bicycle" && slows(this.source, stem, time);
    vehicle.steered = this.steering(stem, time);
    vehicle.indicates = kind === "car" || kind === "truck" || kind === "motorcycle" ? this.indicates(stem, time) : 0;
    fleet.add(vehicle);
  }

  /** The angle of the front wheels that turns it as it turns. */
  private steering(stem: string, time: number): number {
    const past = 2 * (this.source.document.step || 1);
    if (time - past < this.since) return 0;
    const change = this.source.angle(`${stem}.heading`, time) - this.source.angle(`${stem}.heading`, time - past);
    const turned = change - 2 * Math.PI * Math.round(change / (2 * Math.PI));
    const speed = Math.max(this.source.at(`${stem}.speed`, time), 1);
    const base = 0.6 * this.source.held(`${stem}.length`, time);
    return Math.max(-0.6, Math.min(0.6, Math.atan((base * turned) / past / speed)));
  }

  /** The side to which it moves across its heading; no data say what a driver is about to do. */
  private indicates(stem: string, time: number): number {
    const past = 4 * (this.source.document.step || 1);
    if (time - past < this.since) return 0;
    const change = (name: string): number =>
      (this.source.at(`${stem}.${name}`, time) - this.source.at(`${stem}.${name}`, time - past)) / past;
    const heading = this.source.angle(`${stem}.heading`, time);
    // Where it moves straight ahead but turns by itself, the road bends.
    const aside = change("y") * Math.cos(heading) - change("x") * Math.sin(heading);
    if (Math.hypot(change("x"), change("y")) < STILL) return 0;
    return Math.abs(aside) > ASIDE ? Math.sign(aside) : 0;
  }

  private replace(kind: string, held: (name: string) => number, time: number): void {
    this.vehicle = kind === "none" ? null : buildOther(kind, held("id"), held("length"), held("width"), held("height"));
    this.since = time;
    this.way = 0;
    this.last = time;
  }
}
