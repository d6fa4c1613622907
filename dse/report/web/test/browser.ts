// What modules need of a browser when they are loaded; nothing here draws.
class Path2D {
  moveTo(): void {}
  lineTo(): void {}
  closePath(): void {}
}

Object.assign(globalThis, { Path2D, requestAnimationFrame: () => 0 });

export {};
