// What is left out where pictures take long, from the least to the most that is drawn.

export interface Quality {
  /** Shadows of bodies, or soft patches. */
  shadows: boolean;
  /** Grains of the asphalt. */
  grains: boolean;
  /** m up to which trees and houses are drawn. */
  planting: number;
  /** Multiplies the distances up to which bodies are fine. */
  bodies: number;
  /** Pictures between two of the mirrors; 0: none. */
  mirrors: number;
}

export const QUALITIES: Quality[] = [
  { shadows: false, grains: false, planting: 140, bodies: 0.5, mirrors: 0 },
  { shadows: false, grains: false, planting: 240, bodies: 0.7, mirrors: 6 },
  { shadows: true, grains: false, planting: 380, bodies: 0.8, mirrors: 4 },
  { shadows: true, grains: true, planting: 700, bodies: 1, mirrors: 1 },
];
export const FINEST = QUALITIES.length - 1;
