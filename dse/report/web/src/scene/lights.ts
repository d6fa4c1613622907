// Traffic lights with what they show, and the lines to stop at before them.
import { BoxGeometry, BufferGeometry, CircleGeometry, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group, Mesh, MeshBasicMaterial, MeshLambertMaterial, type Material } from "three";
import type { Light, Recording } from "./data";

const LIT: Record<string, [boolean, boolean, boolean]> = {
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

export function buildLights(recording: Pick<Recording, "document" | "held">): Lights {
  const group = new Group();
  const pole = new CylinderGeometry(0.07, 0.07, HEIGHT - 0.5, 8);
  const box = new BoxGeometry(0.24, 0.42, 1.15);
  const lens = new CircleGeometry(0.145, 16);
  const grey = new MeshLambertMaterial({ color: 0x5a6068 });
  const black = new MeshLambertMaterial({ color: 0x15181c });
  // Lamps are seen through fog and by night, as far as the fog lets anything through.
  const lamps = LAMPS.map(([on, off]) => [new MeshBasicMaterial({ color: on }), new MeshBasicMaterial({ color: off })] as const);
  const shown: { light: Light; lenses: Mesh<BufferGeometry, Material>[] }[] = [];
  for (const light of recording.document.lights) {
    const head = new Group();
    const mast = new Mesh(pole, grey);
    mast.rotation.x = Math.PI / 2;
    mast.position.z = (HEIGHT - 0.5) / 2;
    const housing = new Mesh(box, black);
    housing.position.z = HEIGHT;
    head.add(mast, housing);
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
  if (shown.length) group.add(lines(recording.document.lights));
  return {
    group,
    show: (time) => {
      for (const { light, lenses } of shown) {
        const colour = light.told < 0 ? "" : recording.document.colours[recording.held(`light.${light.told}`, time)];
        const lit = LIT[colour ?? ""];
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
      for (const end of [0, 3]) points.push(line[end]! - back * Math.cos(heading), line[end + 1]! - back * Math.sin(heading), line[end + 2]! + 0.05);
    }
    corners.push(first, first + 1, first + 2, first + 1, first + 3, first + 2);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setIndex(corners);
  return new Mesh(geometry, new MeshBasicMaterial({ color: 0xf2f2ee, side: DoubleSide }));
}
