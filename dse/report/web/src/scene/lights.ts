// Traffic lights with what they show, and the lines to stop at before them.
import {
  type BufferGeometry,
  CircleGeometry,
  CylinderGeometry,
  Group,
  type Material,
  Mesh,
  MeshBasicMaterial,
} from "three";
import type { Light, Source } from "./data";
import { box, joined, LIT, painted } from "./light";
import { laid } from "./road";

const SHOWN: Record<string, [boolean, boolean, boolean]> = {
  red: [true, false, false],
  red_yellow: [true, true, false],
  yellow: [false, true, false],
  green: [false, false, true],
};
const LAMPS = [
  [0xff3626, 0x3a1512],
  [0xffc02a, 0x3a2c10],
  [0x2fe56a, 0x0f2f1a],
] as const;
const HEIGHT = 3.2; // m of the head's middle, over the line's end
const LINE = 0.5;

export interface Lights {
  group: Group;
  show(time: number): void;
}

export function buildLights(source: Pick<Source, "document" | "held">): Lights {
  const group = new Group();
  const pole = new CylinderGeometry(0.07, 0.07, HEIGHT - 0.5, 8).rotateX(Math.PI / 2);
  const body = joined([
    painted(pole, 0x7a828c, 0, 0, (HEIGHT - 0.5) / 2),
    box([0.24, 0.42, 1.15], 0x20242a, [0, 0, HEIGHT]),
  ]);
  const lens = new CircleGeometry(0.145, 16);
  // Lamps are seen through fog and by night, as far as the fog lets anything through.
  const lamps = LAMPS.map(
    ([on, off]) => [new MeshBasicMaterial({ color: on }), new MeshBasicMaterial({ color: off })] as const,
  );
  const shown: { light: Light; lenses: Mesh<BufferGeometry, Material>[] }[] = [];
  for (const light of source.document.lights) {
    const head = new Group();
    head.add(new Mesh(body, LIT));
    const lenses = [0.36, 0, -0.36].map((above, i) => {
      const mesh = new Mesh<BufferGeometry, Material>(lens, lamps[i]![1]);
      // A circle looks along z; lamps look at who comes.
      mesh.rotation.set(0, -Math.PI / 2, 0);
      mesh.position.set(-0.125, 0, HEIGHT + above);
      head.add(mesh);
      return mesh;
    });
    head.position.set(...light.place);
    head.rotation.z = light.heading;
    group.add(head);
    shown.push({ light, lenses });
  }
  if (shown.length) group.add(lines(source.document.lights));
  return {
    group,
    show: (time) => {
      for (const { light, lenses } of shown) {
        const colour = light.told < 0 ? "" : source.document.colours[source.held(`light.${light.told}`, time)];
        const lit = SHOWN[colour ?? ""];
        lenses.forEach((lens, i) => (lens.material = lamps[i]![lit?.[i] ? 0 : 1]));
      }
    },
  };
}

function lines(lights: Light[]): Mesh {
  const points: number[] = [];
  const corners: number[] = [];
  for (const { line, heading } of lights) {
    const first = points.length / 3;
    for (const back of [0, LINE]) {
      for (const end of [0, 3])
        points.push(
          line[end]! - back * Math.cos(heading),
          line[end + 1]! - back * Math.sin(heading),
          line[end + 2]! + 0.05,
        );
    }
    corners.push(first, first + 1, first + 2, first + 1, first + 3, first + 2);
  }
  return laid(points, corners, 0xf2f2ee);
}
