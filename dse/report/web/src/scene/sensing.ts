// What sensors reach, and what they say of what is there.
import {
  BufferGeometry,
  DoubleSide,
  Float32BufferAttribute,
  Group,
  Mesh,
  MeshBasicMaterial,
  OctahedronGeometry,
  type Object3D,
} from "three";
import type { Recording } from "./data";

const COLOURS = [0xffb21f, 0x35c7ff, 0xd070ff, 0x7be06a];
const ABOVE = 0.55;
const PIECES = 24;

export interface Sensing {
  group: Group;
  show(time: number): void;
  set(shown: boolean): void;
}

/** In the axes of the car. */
export function buildSensing(recording: Recording): Sensing {
  const group = new Group();
  const marks: { mark: Object3D; stem: string; mount: number }[] = [];
  recording.document.sensors.forEach((sensor, number) => {
    const colour = COLOURS[number % COLOURS.length]!;
    if (sensor.reach > 0 && sensor.angle > 0) {
      const area = fan(sensor.mount, sensor.reach, sensor.angle, colour);
      area.position.z = ABOVE - 0.03 * number;
      group.add(area);
    }
    for (let i = 0; i < sensor.returns; i++) {
      const mark = new Mesh(new OctahedronGeometry(0.45), new MeshBasicMaterial({ color: colour, depthTest: false, fog: false, transparent: true }));
      mark.renderOrder = 2;
      group.add(mark);
      marks.push({ mark, stem: `sensor.${number}.${i}`, mount: sensor.mount });
    }
  });
  return {
    group,
    set: (shown) => (group.visible = shown),
    show: (time) => {
      for (const { mark, stem, mount } of marks) {
        mark.visible = recording.held(`${stem}.valid`, time) > 0.5;
        const [range, azimuth] = [recording.held(`${stem}.range`, time), recording.held(`${stem}.azimuth`, time)];
        mark.position.set(mount + range * Math.cos(azimuth), range * Math.sin(azimuth), 1);
      }
    },
  };
}

export function sensorColour(number: number): string {
  return `#${COLOURS[number % COLOURS.length]!.toString(16).padStart(6, "0")}`;
}

function fan(mount: number, reach: number, angle: number, colour: number): Mesh {
  const points = [mount, 0, 0];
  const corners: number[] = [];
  for (let i = 0; i <= PIECES; i++) {
    const turned = Math.min(angle, 2 * Math.PI) * (i / PIECES - 0.5);
    points.push(mount + reach * Math.cos(turned), reach * Math.sin(turned), 0);
    if (i > 0) corners.push(0, i, i + 1);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setIndex(corners);
  const material = new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.13, side: DoubleSide, depthWrite: false, fog: false });
  return new Mesh(geometry, material);
}
