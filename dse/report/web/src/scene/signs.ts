// Signs with what is on them.
import { CanvasTexture, CylinderGeometry, Group, Mesh, MeshBasicMaterial, PlaneGeometry } from "three";
import type { Sign } from "./data";
import { ALL_LIT, box, joined, LIT, painted } from "./light";

const SIDE = 128;
const HEIGHT = 2.35; // m of the middle over the ground
const WIDE = 0.85;

export function buildSigns(signs: Sign[]): Group {
  const group = new Group();
  if (!signs.length) return group;
  const post = joined([
    painted(
      new CylinderGeometry(0.035, 0.035, HEIGHT + 0.3, 6).rotateX(Math.PI / 2),
      0x8f979d,
      0.05,
      0,
      (HEIGHT + 0.3) / 2,
    ),
    box([0.03, 0.5, 0.5], 0x8f979d, [0.02, 0, HEIGHT]),
  ]);
  // It faces who comes: a plane looks along z.
  const plate = new PlaneGeometry(WIDE, WIDE).rotateX(Math.PI / 2).rotateZ(-Math.PI / 2);
  const faces = new Map<string, MeshBasicMaterial>();
  for (const { place, heading, kind, text } of signs) {
    const name = `${kind} ${text}`;
    let material = faces.get(name);
    if (!material) {
      material = new MeshBasicMaterial({ map: face(kind, text), alphaTest: 0.5 });
      faces.set(name, material);
      ALL_LIT.push(material);
    }
    const sign = new Group();
    const front = new Mesh(plate, material);
    front.position.set(-0.012, 0, HEIGHT);
    sign.add(new Mesh(post, LIT), front);
    sign.position.set(...place);
    sign.rotation.z = heading;
    group.add(sign);
  }
  return group;
}

function face(kind: string, text: string): CanvasTexture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = SIDE;
  const pen = canvas.getContext("2d")!;
  pen.translate(SIDE / 2, SIDE / 2);
  const shape = (sides: number, turned: number, radius: number, colour: string): void => {
    pen.beginPath();
    for (let i = 0; i < sides; i++) {
      const angle = turned + (2 * Math.PI * i) / sides;
      pen.lineTo(radius * Math.cos(angle), radius * Math.sin(angle));
    }
    pen.closePath();
    pen.fillStyle = colour;
    pen.fill();
  };
  const write = (words: string, size: number, colour: string): void => {
    pen.fillStyle = colour;
    pen.font = `bold ${size}px system-ui, sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillText(words, 0, 3);
  };
  if (kind === "205") {
    shape(3, Math.PI / 2, 62, "#c1121c");
    shape(3, Math.PI / 2, 42, "#fff");
  } else if (kind === "206") {
    shape(8, Math.PI / 8, 62, "#fff");
    shape(8, Math.PI / 8, 57, "#c1121c");
    write("STOP", 34, "#fff");
  } else if (kind === "301") {
    shape(3, -Math.PI / 2, 62, "#c1121c");
    shape(3, -Math.PI / 2, 44, "#fff");
    pen.fillStyle = "#111";
    pen.fillRect(-5, -18, 10, 38);
    pen.fillRect(-16, 2, 32, 7);
  } else if (kind === "306" || kind === "307") {
    shape(4, 0, 62, "#fff");
    shape(4, 0, 44, "#f7b500");
    if (kind === "307") {
      pen.strokeStyle = "#222";
      pen.lineWidth = 6;
      for (const k of [-9, 0, 9]) {
        pen.beginPath();
        pen.moveTo(-40 + k, 40 + k);
        pen.lineTo(40 + k, -40 + k);
        pen.stroke();
      }
    }
  } else {
    shape(48, 0, 62, "#c1121c");
    shape(48, 0, 46, "#fff");
    write(text, text.length > 2 ? 44 : 58, "#111");
  }
  return new CanvasTexture(canvas);
}
