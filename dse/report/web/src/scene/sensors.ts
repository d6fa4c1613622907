// What sensors reach, and what they say of what is there.
import {
  BufferGeometry,
  DoubleSide,
  Float32BufferAttribute,
  Group,
  InstancedMesh,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  OctahedronGeometry,
} from "three";
import type { Source } from "./data";

const COLOURS = [0xffb21f, 0x35c7ff, 0xd070ff, 0x7be06a, 0xff6b6b, 0xfff36b, 0xffffff];
const ABOVE = 0.55;
const PIECES = 24;
const RAYS = 6;

export interface Sensing {
  group: Group;
  show(time: number): void;
  set(shown: boolean): void;
}

/** In the axes of the car. What is filled covers half the picture, which a program in place of a card draws slowly. */
export function buildSensing(source: Source, isFilled: boolean): Sensing {
  const group = new Group();
  const parts = source.document.sensors.map((sensor, number) => {
    const colour = COLOURS[number % COLOURS.length]!;
    const axes = new Group();
    axes.position.set(sensor.mount, sensor.left, 0);
    axes.rotation.z = sensor.turn;
    group.add(axes);
    if (sensor.reach > 0 && sensor.angle > 0) {
      const points = rim(sensor.reach, sensor.angle);
      const area = isFilled ? [filled(points, colour)] : [];
      for (const each of [...area, rays(points, colour)]) {
        each.position.z = ABOVE - 0.03 * number;
        axes.add(each);
      }
    }
    const material = new MeshBasicMaterial({ color: colour, depthTest: false, fog: false, transparent: true });
    const marks = new InstancedMesh(new OctahedronGeometry(0.45), material, Math.max(sensor.returns, 1));
    marks.renderOrder = 2;
    marks.frustumCulled = false;
    axes.add(marks);
    return { marks, sensor, number };
  });
  return {
    group,
    set: (shown) => (group.visible = shown),
    show: (time) => {
      for (const { marks, sensor, number } of parts) {
        marks.count = 0;
        for (let i = 0; i < sensor.returns; i++) {
          const held = (name: string): number => source.held(`sensor.${number}.${i}.${name}`, time);
          if (held("valid") < 0.5) continue;
          const [range, azimuth] = [held("range"), held("azimuth")];
          marks.setMatrixAt(
            marks.count++,
            place.makeTranslation(range * Math.cos(azimuth), range * Math.sin(azimuth), 1),
          );
        }
        marks.instanceMatrix.needsUpdate = true;
      }
    },
  };
}

const place = new Matrix4();

export function sensorColour(number: number): string {
  return `#${COLOURS[number % COLOURS.length]!.toString(16).padStart(6, "0")}`;
}

/** The sensor, then the border of what it reaches. */
function rim(reach: number, angle: number): number[] {
  const points = [0, 0, 0];
  for (let i = 0; i <= PIECES; i++) {
    const turned = Math.min(angle, 2 * Math.PI) * (i / PIECES - 0.5);
    points.push(reach * Math.cos(turned), reach * Math.sin(turned), 0);
  }
  return points;
}

function filled(points: number[], colour: number): Mesh {
  const corners = Array.from({ length: PIECES }, (_, i) => [0, i + 1, i + 2]).flat();
  const material = new MeshBasicMaterial({
    color: colour,
    transparent: true,
    opacity: 0.13,
    side: DoubleSide,
    depthWrite: false,
    fog: false,
  });
  return new Mesh(shape(points, corners), material);
}

function rays(points: number[], colour: number): LineSegments {
  const corners = Array.from({ length: PIECES }, (_, i) => [i + 1, i + 2]).flat();
  for (let i = 0; i <= RAYS; i++) corners.push(0, 1 + (i * PIECES) / RAYS);
  return new LineSegments(
    shape(points, corners),
    new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.55, depthWrite: false, fog: false }),
  );
}

function shape(points: number[], corners: number[]): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setIndex(corners);
  return geometry;
}
