import { deepEqual, equal, ok } from "node:assert/strict";
import test from "node:test";
import { type InstancedMesh, Mesh, PerspectiveCamera, Vector3 } from "three";
import { voicesOf } from "../src/drive/sound";
import { calibrationOf, readWheel } from "../src/drive/wheel";
import { meaningOf } from "../src/drive/words";
import { buildCar, type CarKind } from "../src/scene/bodies/cars";
import { chooseBody } from "../src/scene/bodies/choose";
import { type HalfRing, loft, openEdges, volume } from "../src/scene/bodies/loft";
import type { Document, Strip } from "../src/scene/data";
import { buildLand, type Land } from "../src/scene/land";
import { buildPlanting, plant } from "../src/scene/planting";
import { FINEST, QUALITIES } from "../src/scene/quality";
import { Resolution } from "../src/scene/resolution";
import { buildRoad, outerBorders } from "../src/scene/road";
import { RoadMap } from "../src/scene/roadmap";
import { near } from "./study";

const SIZES: [string, number, number, number][] = [
  ["car", 4.6, 1.84, 1.46],
  ["car", 4.0, 1.75, 1.5],
  ["car", 4.7, 1.9, 1.7],
  ["car", 5.9, 2.0, 2.6],
  ["truck", 16, 2.55, 3.9],
  ["truck", 8, 2.5, 3.4],
  ["truck", 12, 2.55, 3.1],
  ["motorcycle", 2.2, 0.8, 1.5],
  ["bicycle", 1.8, 0.6, 1.75],
  ["pedestrian", 0.5, 0.6, 1.78],
  ["obstacle", 1, 1, 1],
];

test("a loft is closed, looks outwards, and has the volume of its prism", () => {
  const half: HalfRing = [
    [0, 0],
    [1, 0],
    [1, 2],
    [0, 2],
  ];
  const prism = loft(
    [-1.5, 0, 1.5].map((x) => ({ x, half })),
    () => [0xffffff, [0, 0]],
  );
  equal(openEdges(prism), 0);
  ok(near(volume(prism), 3 * 2 * 2));
});

test("shells of all cars are closed at every level, whatever their size", () => {
  for (const kind of ["saloon", "hatchback", "estate", "offroader", "van"] as CarKind[]) {
    for (const length of [3.6, 4.5, 5.8]) {
      const { levels } = buildCar(kind, length, 1.8, kind === "van" ? 2.4 : 1.5, 0.31);
      for (const level of levels) {
        const body = level();
        equal(openEdges(body), 0, `${kind} ${length}`);
        ok(volume(body) > 3, `${kind} ${length}: ${volume(body)}`);
      }
    }
  }
});

test("every body is as long, wide and high as the road user, and stands on the ground", () => {
  for (const [kind, length, width, height] of SIZES) {
    const body = chooseBody(kind, 3, length, width, height).build();
    const geometry = body.levels[0]!();
    geometry.computeBoundingBox();
    const size = geometry.boundingBox!.getSize(new Vector3());
    if (kind === "pedestrian") {
      ok(near(geometry.boundingBox!.max.z, height, 0.06), `${kind} ${geometry.boundingBox!.max.z}`);
      continue;
    }
    if (kind === "motorcycle" || kind === "bicycle") {
      ok(near(Math.max(...body.wheels.map(({ x, radius }) => x + radius)), length / 2, 0.02));
      ok(geometry.boundingBox!.max.z < height + 0.12, kind);
      continue;
    }
    ok(near(size.x, length, 0.25), `${kind} is ${size.x} m long`);
    ok(size.y >= width - 0.02 && size.y < width + 0.6, `${kind} is ${size.y} m wide`); // with its mirrors
    ok(near(geometry.boundingBox!.max.z, height, 0.05), `${kind} is ${geometry.boundingBox!.max.z} m high`);
    ok(geometry.boundingBox!.min.z >= -1e-9);
  }
});

test("wheels have the simulated radius and touch the ground, the front ones steer", () => {
  for (const radius of [0.29, 0.31, 0.35]) {
    const { wheels } = chooseBody("car", 0, 4.5, 1.8, 1.5, radius).build();
    equal(wheels.length, 4);
    for (const wheel of wheels) equal(wheel.radius, radius);
    deepEqual(
      wheels.map(({ isSteered }) => isSteered),
      [true, true, false, false],
    );
    ok(wheels.every(({ x, isSteered }) => isSteered === x > 0));
  }
});

test("a lorry with a trailer has five axles, a bus two, and both differ", () => {
  const axles = (length: number, height: number): number =>
    new Set(
      chooseBody("truck", 1, length, 2.55, height)
        .build()
        .wheels.map(({ x }) => x.toFixed(3)),
    ).size;
  equal(axles(16, 3.9), 5);
  equal(axles(12, 3.1), 2);
  equal(axles(8, 3.5), 2);
  ok(chooseBody("truck", 1, 12, 2.55, 3.1).name !== chooseBody("truck", 1, 12, 2.55, 3.9).name);
});

test("farther bodies have fewer triangles, and no body has more than 4000", () => {
  for (const [kind, length, width, height] of SIZES) {
    if (kind === "obstacle") continue;
    const [fine, middle, coarse] = chooseBody(kind, 2, length, width, height)
      .build()
      .levels.map((level) => level().getAttribute("position").count / 3);
    ok(fine! < 4000, `${kind}: ${fine}`);
    ok(fine! >= middle! && middle! >= coarse! && fine! > coarse!, `${kind}: ${fine} ${middle} ${coarse}`);
  }
});

test("a walker's arms and legs swing against each other", () => {
  const { limbs } = chooseBody("pedestrian", 1, 0.5, 0.5, 1.8).build();
  const [leg, otherLeg, arm, otherArm] = limbs;
  ok(leg!.phase !== otherLeg!.phase);
  ok(leg!.phase !== arm!.phase);
  equal(leg!.phase, otherArm!.phase);
});

const straight = (y: number, isDriven = true): Strip => ({
  left: [0, y + 1.75, 0, 300, y + 1.75, 12, 600, y + 1.75, 12],
  right: [0, y - 1.75, 0, 300, y - 1.75, 12, 600, y - 1.75, 12],
  isDriven,
  isInside: false,
  kind: "driving",
});
const street = (kind: Document["kind"], objects: Document["objects"] = []): Document =>
  ({ strips: [straight(0), straight(3.5)], kind, objects, markings: [], signs: [], areas: [] }) as unknown as Document;

test("only borders with nothing beside them are outer ones", () => {
  const found = outerBorders(street("rural").strips).map(({ line, side }) => [line[1], side]);
  deepEqual(found, [
    [-1.75, -1],
    [5.25, 1],
  ]);
});

test("the land is below the road where they meet, and has hills farther away", () => {
  const roads = new RoadMap(street("rural").strips);
  const land = buildLand(roads, "rural");
  for (let x = 0; x <= 600; x += 7) {
    const road = Math.min(x / 25, 12);
    for (const y of [-1.7, 0, 3.5, 5.2]) ok(land.height(x, y) < road - 0.1, `${x} ${y}`);
    ok(land.height(x, 8) > road - 3.2);
  }
  const far = Array.from({ length: 60 }, (_, i) => land.height(10 * i, 200));
  ok(Math.max(...far) - Math.min(...far) > 4);
});

test("what is planted stands beside the road, and is the same each time", () => {
  for (const kind of ["motorway", "rural", "town"] as const) {
    const document = street(kind);
    const roads = new RoadMap(document.strips);
    const level = { height: (): number => 0 };
    const planted = plant(document, roads, level);
    ok(planted.length > 20, `${kind}: ${planted.length}`);
    for (const each of planted) ok(roads.nearest(each.x, each.y).gap > 0, `${each.kind} on the road`);
    deepEqual(plant(document, roads, level), planted);
    equal(
      planted.some((each) => each.kind === "office"),
      kind === "town",
    );
  }
});

test("only plants that a camera sees within its reach are drawn", () => {
  const document = street("rural");
  const roads = new RoadMap(document.strips);
  const land = { height: (): number => 0 } as unknown as Land;
  const all = plant(document, roads, land).length;
  const planting = buildPlanting(document, roads, land);
  const camera = new PerspectiveCamera(50, 1, 0.3, 3500);
  camera.up.set(0, 0, 1);
  camera.position.set(300, 0, 2);
  const drawn = [1, -1].map((ahead) => {
    camera.lookAt(300 + ahead, 0, 2);
    camera.updateMatrixWorld();
    planting.show(camera, 200);
    const places = planting.group.children.flatMap((child) => {
      const { count, instanceMatrix } = child as InstancedMesh;
      return Array.from({ length: count }, (_, i) => instanceMatrix.array[16 * i + 12]!);
    });
    ok(places.length > 5);
    // Half of the largest crown may be in the picture; houses are seen from a little farther.
    for (const x of places) ok(ahead * (x - 300) > -15 && Math.abs(x - 300) < 260, `${x}`);
    return places.length;
  });
  ok(drawn[0]! + drawn[1]! < all);
});

test("no marking runs across a zebra crossing, and all of them do without one", () => {
  const crossing = { place: [450, 0, 12], heading: 0, kind: "crosswalk", size: [4, 40, 0] };
  const within = (objects: Document["objects"]): number => {
    let found = 0;
    buildRoad(street("town", objects)).traverse((each) => {
      if (!(each instanceof Mesh)) return;
      const points = each.geometry.getAttribute("position");
      const index = each.geometry.index;
      // Marks are 35 mm above the road.
      for (let i = 0; index && i < index.count; i += 3) {
        const corners = [0, 1, 2].map((k) => index.getX(i + k));
        const [low, high] = [Math.min, Math.max].map((of) => of(...corners.map((corner) => points.getX(corner))));
        if (corners.every((corner) => near(points.getZ(corner), 12.035, 1e-4)) && high! > 448.6 && low! < 451.4)
          found++;
      }
    });
    return found;
  };
  equal(within([crossing as Document["objects"][number]]), 0);
  ok(within([{ ...crossing, place: [300, 0, 12] } as Document["objects"][number]]) > 0);
});

test("a file with trees of its own gets no others", () => {
  const tree = { place: [50, 9, 0], heading: 0, kind: "tree", size: [0, 0, 7] } as Document["objects"][number];
  const document = street("rural", [tree]);
  const trees = plant(document, new RoadMap(document.strips), { height: () => 0 }).filter(
    ({ kind }) => kind === "leafy" || kind === "fir",
  );
  equal(trees.length, 1);
  deepEqual(trees[0]!.size, [7, 7, 7]);
});

test("where pictures take long sharpness goes first, then detail, and both come back", () => {
  const resolution = new Resolution(FINEST);
  let now = 0;
  const draw = (passed: number, seconds: number): void => {
    for (const end = now + 1000 * seconds; now < end; now += passed) resolution.tell(now, passed);
  };
  draw(16, 3);
  deepEqual([resolution.value, resolution.detail], [1, FINEST]);
  draw(90, 2.5);
  ok(resolution.value <= 0.8);
  ok(resolution.value > 0.4);
  ok(resolution.detail < FINEST);
  draw(90, 20);
  deepEqual([resolution.value, resolution.detail], [0.4, 0]);
  draw(10, 200);
  deepEqual([resolution.value, resolution.detail], [1, FINEST]);
  ok(QUALITIES.every(({ planting }, i) => i === 0 || planting > QUALITIES[i - 1]!.planting));
});

test("the engine turns with the wheels, tyres squeal only where they slip", () => {
  const rolling = { speed: 20, spin: 20 / 0.31, drive: 0, radius: 0.31, wetness: 0 };
  const calm = voicesOf(rolling);
  equal(calm.squeal, 0);
  ok(voicesOf({ ...rolling, drive: 2000 }).engine > calm.engine);
  ok(voicesOf({ ...rolling, spin: 0 }).squeal > 0.1);
  ok(voicesOf({ ...rolling, wetness: 1 }).tyres > calm.tyres);
  const standing = voicesOf({ ...rolling, speed: 0, spin: 0 });
  ok(standing.pitch > 20 && standing.pitch < 40);
  equal(standing.tyres, 0);
});

test("a steering wheel is read as its driver showed it", () => {
  const rest = [0, 0, 1, 1];
  const found = calibrationOf(rest, [-1, 0, 1, 1], [0.9, 0, 1, 1], [0, 0, -1, 1], [0, 0, 1, -1]);
  ok(typeof found !== "string");
  deepEqual(readWheel(found, [-1, 0, 1, 1]), { accelerate: 0, brake: 0, steer: 1 });
  const right = readWheel(found, [0.9, 0, 0, -1]);
  ok(near(right.steer!, -1));
  ok(near(right.accelerate, 0.5));
  equal(right.brake, 1);
  equal(calibrationOf(rest, rest, rest, rest, rest), "The wheel did not move.");
});

test("pedals that share an axis are two", () => {
  const found = calibrationOf([0, 0], [-1, 0], [1, 0], [0, 1], [0, -1]);
  ok(typeof found !== "string");
  deepEqual(readWheel(found, [0, 1]), { accelerate: 1, brake: 0, steer: null });
  deepEqual(readWheel(found, [0, -0.5]), { accelerate: 0, brake: 0.5, steer: null });
});

test("a driver reads words, never names of signals", () => {
  const cruise = meaningOf(["manual", "standby", "cruise", "override", "emergency"])!;
  equal(cruise.title, "Cruise control");
  deepEqual(cruise.say(4), { text: "EMERGENCY BRAKE", level: "alarm" });
  equal(cruise.say(NaN).text, "\u2013");
  equal(meaningOf(["a", "b"]), null);
});
