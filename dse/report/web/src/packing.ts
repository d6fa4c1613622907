// Reads the blocks written by dse/report/page/encoding.py. Browsers are little-endian on every machine they run on.

export interface Entry {
  name: string;
  kind: "f8" | "f4" | "i4" | "u2" | "u1";
  length: number;
}

export type Numbers = Float64Array | Float32Array | Int32Array | Uint16Array | Uint8Array;

const TYPES = { f8: Float64Array, f4: Float32Array, i4: Int32Array, u2: Uint16Array, u1: Uint8Array };

export async function unpack(directory: Entry[], base64: string): Promise<Map<string, Numbers>> {
  const bytes = await inflate(base64);
  const arrays = new Map<string, Numbers>();
  let offset = 0;
  for (const { name, kind, length } of directory) {
    const type = TYPES[kind];
    const size = type.BYTES_PER_ELEMENT;
    arrays.set(name, new type(gather(bytes, offset, length, size)));
    offset += length * size;
  }
  return arrays;
}

/** Packed bytes, as dse/report/page/encoding.py packs them. */
export async function inflate(base64: string): Promise<Uint8Array<ArrayBuffer>> {
  const letters = atob(base64);
  const packed = new Uint8Array(letters.length);
  // A callback for each of ten million letters takes half a second.
  for (let i = 0; i < packed.length; i++) packed[i] = letters.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// The bytes of each number lie `length` apart: all first bytes, then all second bytes, …
function gather(bytes: Uint8Array, offset: number, length: number, size: number): ArrayBuffer {
  const whole = new Uint8Array(length * size);
  for (let byte = 0; byte < size; byte++) {
    const from = offset + byte * length;
    for (let i = 0; i < length; i++) whole[i * size + byte] = bytes[from + i]!;
  }
  return whole.buffer;
}
