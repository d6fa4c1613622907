// Which body is drawn for a road user of a class and size.
import { box } from "../light";
import type { Body } from "./body";
import { buildCar, carKind } from "./cars";
import { buildBus, buildLorry, isBus } from "./heavy";
import { buildPedestrian, buildRider } from "./people";

const OTHER_WHEEL = 0.32; // m: no data have the wheels of others

/** `name` is the same for bodies that are the same. */
export interface Choice {
  name: string;
  build(): Body;
}

export function chooseBody(
  kind: string,
  id: number,
  length: number,
  width: number,
  height: number,
  wheel?: number,
): Choice {
  const size = [length, width, height].map((value) => value.toFixed(2)).join(" ");
  const whole = Math.abs(Math.round(id));
  if (kind === "truck") {
    if (isBus(length, height)) return { name: `bus ${size}`, build: () => buildBus(length, width, height) };
    return { name: `lorry ${size}`, build: () => buildLorry(length, width, height) };
  }
  if (kind === "pedestrian") {
    const looks = whole % 20;
    return { name: `pedestrian ${looks} ${height.toFixed(2)}`, build: () => buildPedestrian(looks, height) };
  }
  if (kind === "bicycle" || kind === "motorcycle") {
    const looks = whole % 4;
    return { name: `${kind} ${looks} ${size}`, build: () => buildRider(kind, looks, length, height) };
  }
  if (kind === "obstacle") return { name: `obstacle ${size}`, build: () => buildObstacle(length, width, height) };
  const car = carKind(whole, length, height);
  const radius = wheel ?? OTHER_WHEEL;
  return { name: `${car} ${size} ${radius}`, build: () => buildCar(car, length, width, height, radius) };
}

function buildObstacle(length: number, width: number, height: number): Body {
  const build = () => box([length, width, height], 0xe08c3c, [0, 0, height / 2]);
  return { levels: [build, build, build], wheels: [], lamps: [], limbs: [], shade: [length, width] };
}
