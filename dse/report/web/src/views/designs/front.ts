// The Pareto front, as front_of in dse/exploration/designs.py: equal points are on it together, what is NaN on none.

export interface Aim {
  values: Float64Array;
  maximize: boolean;
}

/** Which of the points *among*, 1 for each, no other one is at least as good as in all aims and better in one. */
export function frontOf(aims: readonly Aim[], among: Uint8Array): Uint8Array {
  const front = new Uint8Array(among.length);
  if (!aims.length) return front;
  const columns = aims.map(({ values, maximize }) => (maximize ? values.map((value) => -value) : values));
  const sound: number[] = [];
  for (let point = 0; point < among.length; point++) {
    if (among[point] && columns.every((column) => !Number.isNaN(column[point]!))) sound.push(point);
  }
  sound.sort((a, b) => {
    for (const column of columns) if (column[a] !== column[b]) return column[a]! < column[b]! ? -1 : 1;
    return a - b;
  });
  const kept: number[] = [];
  for (const point of sound) {
    // With two aims the last one kept is the best in the second; with more, any may dominate.
    const rivals = columns.length <= 2 ? kept.slice(-1) : kept;
    if (rivals.some((rival) => dominates(columns, rival, point))) continue;
    kept.push(point);
    front[point] = 1;
  }
  return front;
}

// *a* comes before *b*: it is not worse in the first aim.
function dominates(columns: Float64Array[], a: number, b: number): boolean {
  let better = false;
  for (const column of columns) {
    if (column[a]! > column[b]!) return false;
    if (column[a]! < column[b]!) better = true;
  }
  return better;
}
