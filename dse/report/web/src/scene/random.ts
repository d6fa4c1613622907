// Numbers that look random and are the same each time: from a seed, or from a place.

/** Numbers from 0 to 1 (Park and Miller). */
export function sequence(seed: number): () => number {
  let state = (Math.abs(Math.round(seed)) % 2147483646) + 1;
  return () => {
    state = (state * 16807) % 2147483647;
    return state / 2147483647;
  };
}

/** A number from 0 to 1 of a point of the integer lattice. */
export function hash(x: number, y: number, salt = 0): number {
  let h = (Math.imul(x | 0, 374761393) + Math.imul(y | 0, 668265263) + Math.imul(salt | 0, 2147483647)) | 0;
  h = Math.imul(h ^ (h >>> 13), 1274126177);
  return ((h ^ (h >>> 16)) >>> 0) / 4294967296;
}

/** Smooth noise from 0 to 1 with a lattice of 1. */
export function noise(x: number, y: number): number {
  const [i, j] = [Math.floor(x), Math.floor(y)];
  const ease = (t: number): number => t * t * (3 - 2 * t);
  const [u, v] = [ease(x - i), ease(y - j)];
  const below = hash(i, j) + (hash(i + 1, j) - hash(i, j)) * u;
  const above = hash(i, j + 1) + (hash(i + 1, j + 1) - hash(i, j + 1)) * u;
  return below + (above - below) * v;
}
