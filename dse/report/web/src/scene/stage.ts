// The scene at a moment, seen by one of the cameras.
import { PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import type { Recording } from "./data";
import { buildLights } from "./lights";
import { buildRoad } from "./road";
import { buildSensing, type Sensing } from "./sensing";
import { buildSurroundings } from "./surroundings";
import { buildHost, buildOther, type Vehicle } from "./vehicles";

export type View = "chase" | "driver" | "top" | "side";

export const VIEWS: [View, string][] = [
  ["chase", "Chase"],
  ["driver", "Driver"],
  ["top", "Top"],
  ["side", "Side"],
];

const WHEEL = 0.31;
const BRAKES = -0.8; // m/s2 at which brake lights are lit

export interface Stage {
  show(time: number, view: View): void;
  /** In CSS pixels; `fineness` 1 draws each of the screen's. */
  resize(width: number, height: number, fineness: number): void;
  sensing: Sensing;
}

export function buildStage(canvas: HTMLCanvasElement, recording: Recording): Stage {
  const renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  const scene = new Scene();
  scene.up.set(0, 0, 1);
  const camera = new PerspectiveCamera(50, 16 / 9, 0.3, 3000);
  camera.up.set(0, 0, 1);
  scene.add(buildRoad(recording.document));
  const lights = buildLights(recording);
  scene.add(lights.group);
  const surroundings = buildSurroundings(scene, recording);
  const host = buildHost(recording.document.host.length, recording.document.host.width);
  // Bodies are drawn around their middles, the car is told where its centre of gravity is.
  for (const child of host.group.children) child.position.x += recording.document.host.front - recording.document.host.length / 2;
  const sensing = buildSensing(recording);
  host.group.add(sensing.group);
  scene.add(host.group);
  const others = Array.from({ length: recording.document.others }, (_, number) => new Place(number, recording, scene));
  const turned = distances(recording);
  return {
    sensing,
    resize: (width, height, fineness) => {
      renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * fineness);
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    },
    show: (time, view) => {
      const at = (name: string): number => recording.at(`host.${name}`, time);
      const heading = recording.angle("host.heading", time);
      host.group.position.set(at("x"), at("y"), at("z"));
      host.group.rotation.set(at("roll"), -at("pitch"), heading, "ZYX");
      host.wheels(turned(time) / WHEEL, at("steering"));
      host.brake(slows(recording, "host", time));
      for (const other of others) other.show(time);
      lights.show(time);
      sensing.show(time);
      look(camera, view, host.group.position, heading);
      host.group.traverse((each) => each.layers.set(view === "driver" ? 1 : 0));
      sensing.group.traverse((each) => each.layers.set(0));
      surroundings.show(time, camera.position, view === "top");
      renderer.render(scene, camera);
    },
  };
}

/** A place of a road user, in whom another one may be later. */
class Place {
  private vehicle: Vehicle | null = null;
  private who = "";
  private way = 0;
  private last = 0;

  constructor(
    private readonly number: number,
    private readonly recording: Recording,
    private readonly scene: Scene,
  ) {}

  show(time: number): void {
    const stem = `other.${this.number}`;
    const held = (name: string): number => this.recording.held(`${stem}.${name}`, time);
    const kind = this.recording.document.classes[held("class")] ?? "none";
    const who = `${kind} ${held("id")}`;
    if (who !== this.who) this.replace(kind, held);
    this.who = who;
    if (!this.vehicle) return;
    // Who comes into the place at the next frame is not drawn on the way there.
    const isLast = this.recording.held(`${stem}.id`, time + this.recording.document.step) !== held("id");
    const at = (name: string): number => (isLast ? held(name) : this.recording.at(`${stem}.${name}`, time));
    this.vehicle.group.position.set(at("x"), at("y"), at("z"));
    this.vehicle.group.rotation.z = isLast ? held("heading") : this.recording.angle(`${stem}.heading`, time);
    this.way += at("speed") * (time - this.last);
    this.last = time;
    this.vehicle.wheels(this.way / WHEEL, 0);
    this.vehicle.brake(slows(this.recording, stem, time));
  }

  private replace(kind: string, held: (name: string) => number): void {
    if (this.vehicle) this.scene.remove(this.vehicle.group);
    this.vehicle = kind === "none" ? null : buildOther(kind, held("id"), held("length"), held("width"), held("height"));
    if (this.vehicle) this.scene.add(this.vehicle.group);
  }
}

function slows(recording: Recording, stem: string, time: number): boolean {
  const step = recording.document.step || 1;
  const change = recording.at(`${stem}.speed`, time) - recording.at(`${stem}.speed`, time - 4 * step);
  return time >= 4 * step && change / (4 * step) < BRAKES;
}

/** The way the host's wheels have rolled, at any time. */
function distances(recording: Recording): (time: number) => number {
  const { steps, step } = recording.document;
  const speed = recording.column("host.speed");
  const sums = new Float64Array(steps);
  for (let i = 1; i < steps; i++) sums[i] = sums[i - 1]! + (step * ((speed?.[i - 1] ?? 0) + (speed?.[i] ?? 0))) / 2;
  return (time) => {
    const frame = Math.min(Math.max(Math.floor(time / (step || 1)), 0), steps - 1);
    return sums[frame]! + (speed?.[frame] ?? 0) * (time - frame * step);
  };
}

const looked = new Vector3();

function look(camera: PerspectiveCamera, view: View, place: Vector3, heading: number): void {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  const seen = (ahead: number, left: number, above: number): [number, number, number] => [
    place.x + ahead * c - left * s,
    place.y + ahead * s + left * c,
    place.z + above,
  ];
  camera.up.set(view === "top" ? c : 0, view === "top" ? s : 0, view === "top" ? 0 : 1);
  const [from, to] = {
    chase: [seen(-11, 0, 4.2), seen(18, 0, 0.6)],
    driver: [seen(0.3, 0.35, 1.25), seen(40, 0, 0.8)],
    top: [seen(28, 0, 95), seen(28.01, 0, 0)],
    side: [seen(5, -17, 4), seen(8, 0, 0.8)],
  }[view] as [[number, number, number], [number, number, number]];
  camera.position.set(...from);
  camera.lookAt(looked.set(...to));
}
