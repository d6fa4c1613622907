// The scene at a moment, seen by one of the cameras.
import { LinearSRGBColorSpace, Matrix4, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import type { Source } from "./data";
import { HEADLAMPS, isDrawnByProgram } from "./light";
import { buildLights } from "./lights";
import { buildRoad } from "./road";
import { buildSensing, type Sensing } from "./sensors";
import { buildSurroundings } from "./surroundings";
import { buildHost, buildOther, Fleet, type Vehicle } from "./vehicles";

export type View = "chase" | "driver" | "top" | "side";

export const VIEWS: [View, string][] = [
  ["chase", "Chase"],
  ["driver", "Driver"],
  ["top", "Top"],
  ["side", "Side"],
];

const WHEEL = 0.31;
const BRAKES = -0.8; // m/s2 at which brake lights are lit
const DUSK = 0.15; // the darkness at which lamps are lit
const LAMPS = 0.65; // m over the ground

export interface Stage {
  show(time: number, view: View): void;
  /** In CSS pixels; `resolution` 1 draws each of the screen's. */
  resize(width: number, height: number, resolution: number): void;
  sensing: Sensing;
  /** Gives back what the browser has only few of. */
  close(): void;
}

export function buildStage(canvas: HTMLCanvasElement, source: Source): Stage {
  const isSlow = isDrawnByProgram();
  const renderer = new WebGLRenderer({ canvas, antialias: !isSlow, powerPreference: "high-performance" });
  renderer.outputColorSpace = LinearSRGBColorSpace; // as light.ts says
  const scene = new Scene();
  scene.up.set(0, 0, 1);
  const camera = new PerspectiveCamera(50, 16 / 9, 0.3, 3000);
  camera.up.set(0, 0, 1);
  const { length, width, front } = source.document.host;
  const lights = buildLights(source);
  scene.add(buildRoad(source.document), lights.group);
  const surroundings = buildSurroundings(scene, source);
  const host = buildHost(length, width, front - length / 2);
  const sensing = buildSensing(source, !isSlow);
  scene.add(host.body, sensing.group);
  const fleet = new Fleet(scene, source.document.others + 1);
  const lamps = new Matrix4().makeTranslation(-front, 0, -LAMPS);
  const others = Array.from({ length: source.document.others }, (_, number) => new Place(number, source, scene));
  return {
    sensing,
    close: () => {
      renderer.dispose();
      renderer.forceContextLoss();
    },
    resize: (width, height, resolution) => {
      renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * resolution);
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    },
    show: (time, view) => {
      const at = (name: string): number => source.at(`host.${name}`, time);
      const heading = source.angle("host.heading", time);
      const isInside = view === "driver";
      host.body.position.set(at("x"), at("y"), at("z"));
      host.body.rotation.set(at("roll"), -at("pitch"), heading, "ZYX");
      host.body.visible = !isInside;
      sensing.group.position.copy(host.body.position);
      sensing.group.rotation.copy(host.body.rotation);
      host.spun = source.rolled(time) / WHEEL;
      host.steered = at("steering");
      host.brakes = slows(source, "host", time);
      const dark = source.at("weather.darkness", time);
      fleet.clear(dark > DUSK);
      if (!isInside) fleet.add(host);
      for (const other of others) other.show(time, fleet);
      fleet.finish();
      lights.show(time);
      sensing.show(time);
      look(camera, view, host.body.position, heading);
      surroundings.show(time, camera.position, view === "top");
      HEADLAMPS.lit.value = Math.min(Math.max((dark - DUSK) / 0.5, 0), 1);
      host.body.updateMatrixWorld();
      camera.updateMatrixWorld();
      HEADLAMPS.from.value.copy(host.body.matrixWorld).invert().multiply(camera.matrixWorld).premultiply(lamps);
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
    private readonly source: Source,
    private readonly scene: Scene,
  ) {}

  show(time: number, fleet: Fleet): void {
    const stem = `other.${this.number}`;
    const held = (name: string): number => this.source.held(`${stem}.${name}`, time);
    const kind = this.source.document.classes[held("class")] ?? "none";
    const who = `${kind} ${held("id")}`;
    if (who !== this.who) this.replace(kind, held);
    this.who = who;
    if (!this.vehicle) return;
    // Who comes into the place at the next frame is not drawn on the way there.
    const isLast = this.source.held(`${stem}.id`, time + this.source.document.step) !== held("id");
    const at = (name: string): number => (isLast ? held(name) : this.source.at(`${stem}.${name}`, time));
    this.vehicle.body.position.set(at("x"), at("y"), at("z"));
    this.vehicle.body.rotation.z = isLast ? held("heading") : this.source.angle(`${stem}.heading`, time);
    this.way += at("speed") * (time - this.last);
    this.last = time;
    this.vehicle.spun = this.way / WHEEL;
    this.vehicle.brakes = slows(this.source, stem, time);
    fleet.add(this.vehicle);
  }

  private replace(kind: string, held: (name: string) => number): void {
    if (this.vehicle) {
      this.scene.remove(this.vehicle.body);
      this.vehicle.body.geometry.dispose();
    }
    this.vehicle = kind === "none" ? null : buildOther(kind, held("id"), held("length"), held("width"), held("height"));
    if (this.vehicle) this.scene.add(this.vehicle.body);
  }
}

function slows(source: Source, stem: string, time: number): boolean {
  const past = 4 * (source.document.step || 1);
  const change = source.at(`${stem}.speed`, time) - source.at(`${stem}.speed`, time - past);
  return time - past >= source.span()[0] && change / past < BRAKES;
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
