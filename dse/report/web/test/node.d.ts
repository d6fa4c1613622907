// What the tests use of Node; its own types would have the page's sources see Node's globals, too.
declare module "node:test" {
  export default function test(name: string, run: () => void | Promise<void>): void;
}

declare module "node:assert/strict" {
  export function equal<T>(actual: T, expected: T, message?: string): void;
  export function deepEqual<T>(actual: T, expected: T, message?: string): void;
  export function ok(value: unknown, message?: string): asserts value;
  export function throws(run: () => unknown, expected: RegExp): void;
}

declare module "node:zlib" {
  export function deflateSync(data: Uint8Array): Uint8Array;
}
