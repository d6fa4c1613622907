// The scene at a moment, seen by one of the cameras.
import { Frustum, Group, LinearSRGBColorSpace, Matrix4, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { buildGrain, setSurface } from "./asphalt";
import { chooseBody } from "./bodies/choose";
import { buildCabin, EYE } from "./cabin";
import type { Source } from "./data";
import { buildLand } from "./land";
import { AIR, HEADLAMPS, isDrawnByProgram, setLight } from "./light";
import { buildLights } from "./lights";
import { buildPlanting } from "./planting";
import { FINEST, QUALITIES } from "./quality";
import { buildRoad } from "./road";
import { RoadMap } from "./roadmap";
import { buildRoadside } from "./roadside";
import { buildSensing, type Sensing } from "./sensors";
import { buildSigns } from "./signs";
import { buildSky } from "./sky";
import { slows, Traffic } from "./traffic";
import { Fleet, HOST_COLOUR, vehicleOf } from "./vehicles";

export type View = "chase" | "driver" | "top" | "side";

export const VIEWS: [View, string][] = [
  ["chase", "Chase"],
  ["driver", "Driver"],
  ["top", "Top"],
  ["side", "Side"],
];

const PRESSED = 20; // N m of the brakes
const DUSK = 0.15; // the darkness at which lamps are lit
const HOST_HEIGHT = 1.5;
const LAMPS = 0.65; // m over the ground
const DENSE = 0.012; // 1/m of fog that takes more than the corners of what is in it
const VEILED = 5; // how thick the air is through which nothing is seen
const BEHIND = 160; // m that mirrors show

export interface Stage {
  show(time: number, view: View): void;
  /** In CSS pixels; `resolution` 1 draws each of the screen's; `detail` is one of `QUALITIES`, the finest at first. */
  resize(width: number, height: number, resolution: number, detail?: number): void;
  sensing: Sensing;
  /** Gives back what the browser has only few of. */
  close(): void;
}

export function buildStage(canvas: HTMLCanvasElement, source: Source): Stage {
  const isSlow = isDrawnByProgram();
  const renderer = new WebGLRenderer({
    canvas,
    antialias: !isSlow,
    stencil: true,
    powerPreference: "high-performance",
  });
  renderer.outputColorSpace = LinearSRGBColorSpace; // as light.ts says
  const scene = new Scene();
  scene.up.set(0, 0, 1);
  const camera = new PerspectiveCamera(50, 16 / 9, 0.3, 3500);
  camera.up.set(0, 0, 1);
  const { length, width, front, wheel } = source.document.host;
  const lights = buildLights(source);
  buildGrain();
  const roads = new RoadMap(source.document.strips);
  const land = buildLand(roads, source.document.kind);
  const planting = buildPlanting(source.document, roads, land);
  scene.add(land.group, planting.group, buildRoad(source.document), buildRoadside(source.document, roads));
  scene.add(buildSigns(source.document.signs), lights.group);
  const sky = buildSky(scene, source);
  const host = vehicleOf(chooseBody("car", 0, length, width, HOST_HEIGHT, wheel), HOST_COLOUR);
  const sensing = buildSensing(source, !isSlow);
  const frame = new Group(); // that of the car's centre of gravity
  const cabin = buildCabin(source.document.host, HOST_HEIGHT, HOST_COLOUR);
  frame.add(cabin.group);
  scene.add(frame, sensing.group);
  let quality = QUALITIES[FINEST]!;
  let pictures = 0;
  const fleet = new Fleet(scene, source.document.others + 1);
  const lamps = new Matrix4().makeTranslation(-front, 0, -LAMPS);
  const traffic = new Traffic(source);
  return {
    sensing,
    close: () => {
      cabin.close();
      renderer.dispose();
      renderer.forceContextLoss();
    },
    resize: (width, height, resolution, detail = FINEST) => {
      quality = QUALITIES[detail]!;
      fleet.detail = { shadows: quality.shadows, reach: quality.bodies };
      renderer.setPixelRatio(Math.min(devicePixelRatio, 2) * resolution);
      renderer.setSize(width, height, false);
      camera.aspect = width / height;
      camera.updateProjectionMatrix();
    },
    show: (time, view) => {
      const at = (name: string): number => source.at(`host.${name}`, time);
      const heading = source.angle("host.heading", time);
      const isInside = view === "driver";
      frame.position.set(at("x"), at("y"), at("z"));
      frame.rotation.set(at("roll"), -at("pitch"), heading, "ZYX");
      frame.updateMatrixWorld();
      sensing.group.position.copy(frame.position);
      sensing.group.rotation.copy(frame.rotation);
      look(camera, view, frame.position, heading);
      camera.updateMatrixWorld();
      const dark = source.at("weather.darkness", time);
      const isAbove = view === "top";
      const density = sky.show(time, camera.position, isAbove);
      const sight = density ? VEILED / density : Infinity;
      setLight(dark > DUSK || density > DENSE);
      setSurface(quality.grains, AIR.wetness.value > 0);
      const isDue = isInside && quality.mirrors > 0 && pictures++ % quality.mirrors === 0;
      seen.setFromProjectionMatrix(whole.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
      fleet.clear(dark > DUSK, time, camera.position, isDue ? null : seen, sight);
      cabin.group.visible = isInside;
      // Bodies are built around their middles, the car is told where its centre of gravity is.
      host.position.set(front - length / 2, 0, 0).applyMatrix4(frame.matrixWorld);
      host.rotation.copy(frame.rotation);
      host.rolled = source.rolled(time);
      host.steered = at("steering");
      host.brakes = source.has("host.brake") ? at("brake") > PRESSED : slows(source, "host", time);
      cabin.show(at("steering"));
      if (!isInside) fleet.add(host);
      traffic.show(time, fleet);
      fleet.lightStreet(planting.lamps);
      fleet.finish();
      lights.show(time);
      sensing.show(time);
      land.show(camera.position.x, camera.position.y, camera.position.z, isAbove);
      // The lamps light what is ahead, and mirrors show what is not.
      HEADLAMPS.from.value.copy(NOWHERE);
      HEADLAMPS.lit.value = Math.min(Math.max((dark - DUSK) / 0.5, 0), 1);
      if (isDue) cabin.mirror(renderer, scene, frame, (back) => planting.show(back, Math.min(BEHIND, sight)));
      else if (!quality.mirrors) cabin.dull();
      HEADLAMPS.from.value.copy(frame.matrixWorld).invert().multiply(camera.matrixWorld).premultiply(lamps);
      planting.show(camera, isAbove ? 1000 : Math.min(quality.planting, sight));
      renderer.render(scene, camera);
    },
  };
}

const looked = new Vector3();
const seen = new Frustum();
const whole = new Matrix4();
const NOWHERE = new Matrix4().makeTranslation(-1e6, 0, 0);

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
    driver: [seen(...EYE), seen(40, 0.36, 0.35)],
    top: [seen(28, 0, 95), seen(28.01, 0, 0)],
    side: [seen(5, -17, 4), seen(8, 0, 0.8)],
  }[view] as [[number, number, number], [number, number, number]];
  camera.position.set(...from);
  camera.lookAt(looked.set(...to));
}
