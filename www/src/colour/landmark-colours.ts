/** Okabe and Ito's colours again, each with the colour that is legible on it; the number on a marker says the same without them. */
const colours = [
  { fill: '#0072b2', ink: '#ffffff' },
  { fill: '#e69f00', ink: '#000000' },
  { fill: '#cc79a7', ink: '#000000' },
  { fill: '#f0e442', ink: '#000000' },
  { fill: '#009e73', ink: '#000000' },
  { fill: '#d55e00', ink: '#000000' },
  { fill: '#56b4e9', ink: '#000000' },
] as const;

/** Colour of the landmark with this place in the list, counted from 0: the same on both bodies and in the list. */
export const landmarkColour = (order: number): { readonly fill: string; readonly ink: string } => colours[order % colours.length];
